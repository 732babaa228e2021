"""Tube files: a calibrated tube as JSON, and back."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from formula.rubber import read_rubber
from profiletool.errors import UnreadableInput
from profiletool.files.read import read_file
from profiletool.records.calibrated import CalibratedTube
from profiletool.records.rubber import law_of

SCHEMA = "profiletool.tube/1"
_MOST_BYTES = 1_000_000
_DECIMALS = 6


def tube_json(tube: CalibratedTube) -> bytes:
    """Write a tube file: the same tube gives the same bytes."""
    tree = {"schema": SCHEMA, **asdict(tube)}
    return (json.dumps(_rounded(tree), indent=1, allow_nan=False) + "\n").encode()


def load_tube(path: Path | str) -> CalibratedTube:
    """Read a tube file.

    Parameters
    ----------
    path : Path or str
        As `calibrate` on the command line writes it.

    Raises
    ------
    UnreadableInput
        Naming the file and what is wrong in it.
    """
    from pydantic import TypeAdapter, ValidationError

    path = Path(path)
    try:
        data = read_file(path, _MOST_BYTES, "a tube file, as calibrate writes it")
    except UnreadableInput as error:
        raise UnreadableInput(f"cannot read {path}: {error}") from None
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise UnreadableInput(f"{path} is not JSON: {error}") from error
    if not isinstance(tree, dict) or tree.pop("schema", None) != SCHEMA:
        raise UnreadableInput(f'{path} is no tube file: its "schema" is not "{SCHEMA}"')
    try:
        if isinstance(tree.get("rubber"), dict):
            tree["rubber"] = read_rubber(tree["rubber"])
        tube = TypeAdapter(CalibratedTube).validate_python(tree)
        law_of(tube.rubber, tube.nu)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise UnreadableInput(f"{path}: {where}: {first['msg']}") from error
    except ValueError as error:
        raise UnreadableInput(f"{path}: rubber: {error}") from error
    if not 0.0 < tube.wall_mm < 0.5 * tube.outer_diameter_mm:
        raise UnreadableInput(f"{path}: no tube can have such a wall")
    return tube


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, _DECIMALS) + 0.0
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(item) for item in value]
    return value
