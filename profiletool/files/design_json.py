"""design.json: a Design as text, and back."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from formula.rubber import read_rubber
from profiletool.errors import UnreadableInput, UsageError
from profiletool.files.read import read_file
from profiletool.records.design import Design
from profiletool.records.model import check_model
from profiletool.records.rubber import law_of

SCHEMA = "profiletool.design/2"
_READ = (SCHEMA, "profiletool.design/1")  # the first has no `built`, `trim` and `model`
_DECIMALS = 6  # a nanometre; keeps the last bits of the arithmetic out of the file
_MOST_BYTES = 5_000_000


def to_json(design: Design) -> str:
    """Write a design as design.json: the same design gives the same bytes."""
    tree = {"schema": SCHEMA, **_rounded(asdict(design))}
    return json.dumps(tree, indent=1, allow_nan=False) + "\n"


def from_json(text: str | bytes, file: str) -> Design:
    """Read a design back.

    Raises
    ------
    UnreadableInput
        Naming the file and the first field that is missing or makes no sense.
    """
    from pydantic import TypeAdapter, ValidationError  # heavy, and writing does not need it

    try:
        tree = json.loads(text, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise UnreadableInput(f"{file} is not JSON: {error}") from error
    if not isinstance(tree, dict) or tree.get("schema") not in _READ:
        raise UnreadableInput(f'{file} is no design: its "schema" is not "{SCHEMA}"')
    try:
        design = TypeAdapter(Design).validate_python(_with_law(tree, file))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise UnreadableInput(f"{file}: {where}: {first['msg']}") from error
    _check(design, file)
    return design


def load_design(path: Path | str) -> Design:
    """Read a design.json.

    Parameters
    ----------
    path : Path or str

    Returns
    -------
    Design

    Raises
    ------
    UnreadableInput
        When the file cannot be read or holds no design.
    """
    path = Path(path)
    try:
        data = read_file(path, _MOST_BYTES, "a design.json")
    except UnreadableInput as error:
        raise UnreadableInput(f"cannot read {path}: {error}") from None
    return from_json(data, path.name)


def _with_law(tree: dict[str, Any], file: str) -> dict[str, Any]:
    """Read the rubber, which older files hold in another form."""
    tube = tree.get("tube")
    if not isinstance(tube, dict) or not isinstance(rubber := tube.get("rubber"), dict):
        return tree
    try:
        return tree | {"tube": {**tube, "rubber": read_rubber(rubber)}}
    except ValueError as error:
        raise UnreadableInput(f"{file}: tube.rubber: {error}") from error


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is no number")


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, _DECIMALS) + 0.0  # no "-0.0"
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(item) for item in value]
    return value


def _check(design: Design, file: str) -> None:
    """Refuse numbers that no actuator can have."""
    tube, gauze = design.tube, design.gauze
    lengths = (tube.outer_diameter_mm, tube.wall_mm, tube.root_mm, tube.length_mm, gauze.pitch_mm)
    sane = (
        all(0.1 <= value <= 1e4 for value in lengths)
        and tube.wall_mm < 0.5 * tube.outer_diameter_mm
        and 0.0 < gauze.thread_mm < gauze.pitch_mm
        and 1 <= gauze.turns <= 10
        and -360.0 <= gauze.seam_deg <= 720.0
    )
    if not sane:
        raise UnreadableInput(f"{file}: no tube and gauze can have such sizes")
    try:
        check_model(design.model)
    except UsageError as error:
        raise UnreadableInput(f"{file}: model: {error}") from error
    try:
        law_of(tube.rubber, design.model.nu)
    except ValueError as error:
        raise UnreadableInput(f"{file}: tube.rubber: {error}") from error
    if not design.joints:
        raise UnreadableInput(f"{file} has no joints")
    end = 0.0
    for number, joint in enumerate(design.joints, start=1):
        start = joint.centre_mm - 0.5 * joint.openF_mm
        if joint.number != number:
            raise UnreadableInput(f"{file}: joint {joint.number} stands where {number} should")
        if not (joint.openF_mm > 0.0 and start >= end - 1e-6):
            raise UnreadableInput(f"{file}: joint {number} overlaps the one before it")
        if not 0.0 < joint.alpha_closed_deg < 360.0:
            raise UnreadableInput(f"{file}: joint {number}: alpha_closed_deg is out of range")
        if not 0.0 <= joint.alpha_center_deg <= 360.0:
            raise UnreadableInput(f"{file}: joint {number}: alpha_center_deg is out of range")
        end = joint.centre_mm + 0.5 * joint.openF_mm
    if not end <= tube.length_mm + 1e-6:
        raise UnreadableInput(
            f"{file}: joint {design.joints[-1].number} lies beyond the tube's end"
        )
