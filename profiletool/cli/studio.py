"""The command `studio`: parse, call, print, exit codes; nothing else."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from profiletool.cli.console import Debug, Quiet, exit_codes, speaker
from profiletool.errors import UsageError


def studio(
    file: Annotated[
        Path | None,
        typer.Argument(
            metavar="[PICTURE|DESIGN.json]", help="A picture, a drawing or a design to begin with."
        ),
    ] = None,
    port: Annotated[int, typer.Option(help="Of this machine, 0 for any.", min=0, max=65535)] = 8741,
    browser: Annotated[bool, typer.Option(help="Open the page in a browser.")] = True,
    out: Annotated[
        Path | None,
        typer.Option(help="Work folder (default: the picture's name + _studio)."),
    ] = None,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Design on a page of this machine: see the object, drag the joints, take the files."""
    with exit_codes(debug, "the studio has ended; its work folder stays"):
        if find_spec("starlette") is None or find_spec("uvicorn") is None:
            raise UsageError(
                "the studio needs two small packages more: python -m pip install "
                "'profiletool[studio]', in a clone of the repository '.[studio]'"
            )
        from profiletool.studio.server import serve

        folder = out or Path("profiletool_studio" if file is None else f"{_stem(file)}_studio")
        say = speaker(quiet)
        serve(folder.absolute(), file, port, browse=browser, say=say)


def _stem(file: Path) -> str:
    """Name what a file is of; a design is named by its folder."""
    return file.absolute().parent.name if file.name == "design.json" else file.stem
