"""The command line as `python -m profiletool`."""

from profiletool.cli.main import main

if __name__ == "__main__":
    main()
