"""Options from a TOML file, taken as defaults of any command."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from profiletool.cli.console import OUTPUT, exit_codes
from profiletool.cli.rows import parameters_of, with_signature
from profiletool.errors import UnreadableInput, UsageError

_MOST_CONFIG_BYTES = 10_000


def take_config(context: typer.Context, path: Path | None) -> Path | None:
    """Take the options of a TOML file as defaults; the command line wins."""
    if path is None:
        return None
    with exit_codes(debug=False):
        context.default_map = {**(context.default_map or {}), **_read_config(context, path)}
    return path


def _read_config(context: typer.Context, path: Path) -> dict[str, Any]:
    from profiletool.files.read import read_file

    try:
        data = read_file(path, _MOST_CONFIG_BYTES, "a file of options")
        tree = tomllib.loads(data.decode("utf-8-sig"))
    except UnreadableInput as error:
        raise UnreadableInput(f"cannot read {path}: {error}") from None
    except (ValueError, RecursionError) as error:
        raise UnreadableInput(f"{path} is not TOML: {error}") from error
    names = {
        option.removeprefix("--"): parameter
        for parameter in context.command.params
        for option in parameter.opts
        if option.startswith("--") and parameter.name not in (None, "config", "debug")
    }
    off = {
        parameter.secondary_opts[0].removeprefix("--"): str(parameter.name)
        for parameter in context.command.params
        if parameter.secondary_opts and not any(o.startswith("--") for o in parameter.opts)
    }
    known = {}
    for key, value in tree.items():
        flag = key.replace("_", "-")
        if isinstance(value, bool) and (flag in off or f"no-{flag}" in off):  # --no-grip
            known[off.get(flag) or off[f"no-{flag}"]] = value != (flag in off)
            continue
        parameter = names.get(flag)
        if parameter is None and flag.removeprefix("no-") in names:
            raise UsageError(f'{path}: write "{flag[3:]} = false" in place of "{key}"')
        if isinstance(value, list) and "," in str(getattr(parameter, "metavar", "")):
            value = ",".join(str(part) for part in value)
        if isinstance(value, dict) and "=" in str(getattr(parameter, "metavar", "")):
            value = ",".join(f"{name}={bound}" for name, bound in value.items())
        if parameter is None or isinstance(value, dict | list):
            command = context.info_name
            raise UsageError(f'{path}: "{key}" is no option of {command}; see {command} --help')
        if isinstance(value, bool) != bool(getattr(parameter, "is_flag", False)):
            raise UsageError(f'{path}: "{key}" cannot be {json.dumps(value, default=str)}')
        known[str(parameter.name)] = value
    return known


Config = Annotated[
    Path | None,
    typer.Option(
        callback=take_config, is_eager=True, rich_help_panel=OUTPUT,
        help="TOML file with any of these options.",
    ),
]  # fmt: skip


def configured(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the option --config."""

    def run(**values: Any) -> None:
        del values["config"]  # taken already, as defaults
        command(**values)

    def more(config: Config = None) -> None:
        """Stand for the parameter."""

    with_signature(run, parameters_of(command), parameters_of(more))
    run.__name__, run.__doc__ = command.__name__, command.__doc__
    return run
