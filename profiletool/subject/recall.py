"""The target profile of a design.json, where what lies beside it still tells."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from profiletool.errors import ProfiletoolError, UnreadableInput
from profiletool.files.read import read_file
from profiletool.profile.curve import arc_length, make_curve
from profiletool.profile.drawing.load import SUFFIXES, load_vector
from profiletool.profile.shape_csv import read_shape_csv
from profiletool.profile.target import (
    LEAST_WINDOW,
    STEP_MM,
    Reach,
    profile_of_line,
    profile_of_object,
)
from profiletool.records.design import Design
from profiletool.records.profile import Profile
from profiletool.records.side import side_sign
from profiletool.records.units import FloatArray
from profiletool.subject.photo import changed

_MOST_BYTES = 50_000_000
_SAME_MM = 0.02  # lengths nearer than this are of the same profile


@dataclass(frozen=True)
class Target:
    """A target profile (N, 2) mm, object frame, and the name of the file that it comes from."""

    points: FloatArray
    file: str


def target_of(design: Design, file: Path) -> Target | None:
    """Find the target of a design read from ``file``: in its shape.csv, else in its drawing.

    A drawing counts when it is the very file that the design was made from, and lies in the
    folder of ``file`` or below: a name in a file never leads out of there. In both cases the
    profile must be as long as the design says, for neither knows of options such as `start_pct`.
    """
    for name, points in (
        ("shape.csv", _tabulated(file.with_name("shape.csv"))),
        (design.source.file, _drawn(design, file.parent)),
    ):
        if points is None or len(points) < 2:
            continue
        if abs(float(arc_length(points)[-1]) - design.source.profile_length_mm) < _SAME_MM:
            return Target(points, name)
    return None


def profile_of(design: Design, file: Path) -> Profile:
    """Find the profile of a design read from ``file``, with the object's outline where it is kept.

    Raises
    ------
    UnreadableInput
        When neither shape.csv nor the drawing lies beside it.
    """
    target = target_of(design, file)
    if target is None:
        raise UnreadableInput(
            f"{file}: no target beside it: shape.csv of its folder tells what the tube shall "
            "follow; keep both together"
        )
    outline = _tabulated(file.with_name("shape.csv"), "outline")
    closed = outline is not None and len(outline) > 2
    return profile_along(target.points, design, outline if closed else None)


def profile_along(points: FloatArray, design: Design, outline: FloatArray | None) -> Profile:
    """Take a line of points (N, 2) mm for the profile of a design."""
    s = arc_length(points)
    smooth = make_curve(points, STEP_MM, LEAST_WINDOW * 0.5 * design.tube.outer_diameter_mm)
    heading = np.interp(s, smooth.s, smooth.heading)
    # Level at the top is pi on the left side, as in a profile of an object.
    turns = np.floor((heading[0] - (0.0 if design.source.side == "left" else -np.pi)) / (2 * np.pi))
    return Profile(
        points=points,
        s=s,
        heading=heading - 2.0 * np.pi * turns,
        curvature=side_sign(design.source.side) * np.interp(s, smooth.s, smooth.curvature),
        bridged=np.zeros(len(s), dtype=bool),
        side=design.source.side,
        outline=outline,
    )


def _tabulated(path: Path, name: str = "target") -> FloatArray | None:
    try:
        text = read_file(path, _MOST_BYTES, "a table").decode()
        return read_shape_csv(text, name)
    except (ProfiletoolError, ValueError):
        return None


def _drawn(design: Design, folder: Path) -> FloatArray | None:
    try:
        path = (folder / design.source.file).resolve()  # links are followed, then judged
        if path.suffix.lower() not in SUFFIXES or not path.is_relative_to(folder.resolve()):
            return None
        data = read_file(path, _MOST_BYTES, "a drawing")
        if hashlib.sha256(data).hexdigest() != design.source.sha256:
            return None
        source = design.source
        if source.scale_source != "vector":  # sized by an option that the design does not keep
            return None
        drawn = load_vector(path)
        make = profile_of_object if drawn.closed else profile_of_line
        reach = Reach(source.side, 0.5 * design.tube.outer_diameter_mm)
        points = changed(drawn.points, source.rotated_deg, source.symmetric)
        return make(points, reach).points
    except (OSError, ValueError, RuntimeError, ProfiletoolError):  # no such place, or no profile
        return None
