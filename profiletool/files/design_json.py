"""design.json: a Design as text, and back."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from formula.rubber import read_rubber
from profiletool.errors import UnreadableInput, UsageError
from profiletool.files.read import read_file
from profiletool.records.design import Design
from profiletool.records.model import check_model
from profiletool.records.rubber import law_of
from profiletool.records.seal import proven, values_of

if TYPE_CHECKING:
    from pydantic import TypeAdapter

SCHEMA = "profiletool.design/3"
# Older files have no seal, those of the first no `built`, `trim` and `model`.
_READ = (SCHEMA, "profiletool.design/2", "profiletool.design/1")
_SAME_MM = 0.001  # facts that are stored twice agree to this
EDITED = "NOT VERIFIED: {} since finite elements verified it; the command report verifies it anew"
_MOST_BYTES = 5_000_000


def to_json(design: Design) -> str:
    """Write a design as design.json: the same design gives the same bytes."""
    tree = {"schema": SCHEMA, **values_of(design)}
    return json.dumps(tree, indent=1, allow_nan=False) + "\n"


def from_json(text: str | bytes, file: str) -> Design:
    """Read a design back.

    Raises
    ------
    UnreadableInput
        Naming the file and the first field that is missing, unknown or makes no sense.
    """
    from pydantic import ValidationError  # heavy, and writing does not need it

    try:
        tree = json.loads(
            text, parse_constant=_refuse_constant, object_pairs_hook=_refuse_duplicates
        )
    except (ValueError, RecursionError) as error:
        raise UnreadableInput(f"{file} is not JSON: {error}") from error
    if not isinstance(tree, dict) or tree.get("schema") not in _READ:
        raise UnreadableInput(f'{file} is no design: its "schema" is not "{SCHEMA}"')
    try:
        design = _schema().validate_python(_with_law(tree, file))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise UnreadableInput(f"{file}: {where}: {first['msg']}") from error
    for path in _unknown(tree, {"schema": "", **asdict(design)}):
        raise UnreadableInput(f"{file}: {path}: no key of a design")
    _check(design, file)
    return _judged(design, str(tree["schema"]))


@cache
def _schema() -> TypeAdapter[Design]:
    from pydantic import TypeAdapter

    return TypeAdapter(Design)


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


def _refuse_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    tree = dict(pairs)
    if len(tree) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"the key {max(names, key=names.count)!r} stands twice in one place")
    return tree


def _unknown(tree: Any, known: Any, path: str = "") -> Iterator[str]:
    """Yield the keys of a tree that a design does not have; a rubber's constants are its own."""
    if isinstance(tree, dict) and isinstance(known, dict) and path != "tube.rubber":
        for key, value in tree.items():
            here = f"{path}.{key}" if path else key
            if key in known:
                yield from _unknown(value, known[key], here)
            else:
                yield here
    elif isinstance(tree, list) and isinstance(known, list | tuple):
        for k, (one, other) in enumerate(zip(tree, known, strict=True)):
            yield from _unknown(one, other, f"{path}.{k}")


def _judged(design: Design, schema: str) -> Design:
    """Take the verdict back where the design is not the one that was verified."""
    if not design.verified or proven(design):
        return design
    why = "it was changed" if schema == SCHEMA else "nothing tells whether it was changed"
    return replace(design, verified=False, warnings=(EDITED.format(why), *design.warnings))


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
    force, clearance = design.grip.force_N, design.grip.clearance_mm
    if not ((force is None or 0.0 < force <= 1e4) and 0.0 <= clearance <= 1e4):
        raise UnreadableInput(f"{file}: grip: no force and clearance can be so")
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
    _check_twice(design, file)


def _check_twice(design: Design, file: str) -> None:
    """Compare the facts that a design holds twice: joints' places and the lengths between them."""
    joints, tube = design.joints, design.tube
    said = [("tube.root_mm", tube.root_mm, joints[0].centre_mm)]
    said += [
        (f"F_mm of joint {a.number}", a.F_mm, b.centre_mm - a.centre_mm)
        for a, b in pairwise(joints)
    ]
    for what, value, places in said:
        if not abs(value - places) <= _SAME_MM:
            raise UnreadableInput(
                f"{file}: {what} is {value:g} mm, by the joints' places (centre_mm) {places:g}: "
                "change both, or let the command edit do it"
            )
    last = joints[-1]
    if not last.F_mm <= tube.length_mm - last.centre_mm + _SAME_MM:
        raise UnreadableInput(f"{file}: F_mm of joint {last.number} goes beyond the tube's end")
