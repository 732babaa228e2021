"""The command line: two console scripts, the table of commands, and what bad usage ends in."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Annotated, Any, cast

import typer

from profiletool.cli import (
    again,
    calibrate,
    deck,
    derive,
    design,
    fe,
    grip,
    measure,
    studio,
    table,
    template,
    trim,
    verify,
)
from profiletool.cli.config import configured
from profiletool.cli.console import KEPT
from profiletool.cli.rows import parameters_of, with_signature
from profiletool.errors import UsageError
from profiletool.records.version import VERSION

_LOOK: dict[str, Any] = {
    "pretty_exceptions_enable": False,
    "rich_markup_mode": "rich",  # panels in the help; rich is loaded for it alone
    "context_settings": {"help_option_names": ["-h", "--help"]},
}
app = typer.Typer(
    name="profiletool",
    help="From the picture of an object to a soft bending actuator that mirrors its shape.",
    no_args_is_help=True,
    **_LOOK,
)
design_app = typer.Typer(**_LOOK)
# What typer raises for words it cannot take; its own base classes have no public name.
_BadUsage = cast(type[typer.BadParameter], typer.BadParameter.__bases__[0])


def main() -> None:
    """Run `profiletool`."""
    _run(app)


def design_main() -> None:
    """Run `design`, which is `profiletool design`."""
    _run(design_app)


def _run(commands: typer.Typer) -> None:
    """Run a command line; bad usage ends in one line too."""
    try:
        code = commands(standalone_mode=False)
    except (typer.Abort, KeyboardInterrupt):
        typer.echo(KEPT, err=True)
        code = 130
    except _BadUsage as problem:
        code = UsageError.exit_code
        message = problem.format_message().replace("Value error, ", "").rstrip(".")
        # No arguments at all: the help page is printed already, or is the message.
        if message:
            page = message.lstrip().startswith("Usage:")
            words = " ".join(message.split())
            typer.echo(message if page else f"error: {words}; see --help", err=True)
    sys.exit(code or 0)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"profiletool {VERSION}")
        raise typer.Exit


Version = Annotated[
    bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
]


@app.callback()
def _profiletool(version: Version = False) -> None:
    pass


def _alone() -> Callable[..., None]:
    """Give the command `design` as a program of its own, which knows its version."""
    command = configured(design.design)

    def alone(**values: Any) -> None:
        del values["version"]
        command(**values)

    with_signature(alone, parameters_of(command), parameters_of(_profiletool))
    alone.__doc__ = command.__doc__
    return alone


design_app.command(epilog="Example:  design bulb.png --height 107.5 --side left --out bulb")(
    _alone()
)
for _command, _example in (
    (design.design, "profiletool design bulb.png --height 107.5 --out bulb"),
    (verify.verify, "profiletool verify bulb_design/design.json"),
    (fe.joint, "profiletool joint --openF 10 --alpha 84 --pressure 2.0"),
    (fe.finger, "profiletool finger --out finger"),
    (derive.derive, "profiletool derive --diameter 16 --wall 1.6 --out tube16.json"),
    (table.table, "profiletool table --openF 6,8,10 --csv"),
    (table.assign, "profiletool assign --openF 8,8,8,8,6,10 --theta 30,30,30,25,20,45"),
    (trim.trim, "profiletool trim bulb_design/design.json --tip -22.4,-96.6 --at 1.67"),
    (grip.grip, "profiletool grip bulb_design/design.json --friction 0.5 --fingers 3"),
    (
        measure.measure,
        "profiletool measure bulb_design p0.jpg p1.jpg --pressures 0,0.6 --mm-per-px 0.12",
    ),
    (calibrate.calibrate, "profiletool calibrate bulb_design angles.csv --out tube.json"),
    (deck.deck, "profiletool deck bulb_design/design.json --for calculix --out bulb_calculix"),
    (again.edit, "profiletool edit bulb_design --joint 3 --alpha 132 --move 1 --out other"),
    (again.report, "profiletool report bulb_design/design.json --out whole"),
    (again.refine, "profiletool refine bulb_design/design.json --out better"),
    (studio.studio, "profiletool studio bulb.png"),
    (template.template, "profiletool template bulb_design/design.json --variant strip"),
    (template.sheet, "profiletool sheet --paper letter --out sheet.pdf"),
):
    app.command(epilog=f"Example:  {_example}")(configured(_command))
if __name__ == "__main__":
    main()
