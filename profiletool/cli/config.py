"""Options from a TOML file, taken as defaults of a command."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import typer

from profiletool.cli.console import exit_codes
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
    known = {}
    for key, value in tree.items():
        parameter = names.get(key.replace("_", "-"))
        if isinstance(value, list) and "," in str(getattr(parameter, "metavar", "")):
            value = ",".join(str(part) for part in value)
        if isinstance(value, dict) and "=" in str(getattr(parameter, "metavar", "")):
            value = ",".join(f"{name}={bound}" for name, bound in value.items())
        if parameter is None or isinstance(value, dict | list):
            raise UsageError(f'{path}: "{key}" is no option of design; see design --help')
        if isinstance(value, bool) != bool(getattr(parameter, "is_flag", False)):
            raise UsageError(f'{path}: "{key}" cannot be {json.dumps(value, default=str)}')
        known[str(parameter.name)] = value
    return known
