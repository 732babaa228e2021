"""The target profile of a design.json, where what lies beside it still tells."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from profiletool.errors import ProfiletoolError
from profiletool.files.read import read_file
from profiletool.profile.curve import arc_length
from profiletool.profile.drawing.load import SUFFIXES, load_vector
from profiletool.profile.shape_csv import read_shape_csv
from profiletool.profile.target import Reach, profile_of_line, profile_of_object
from profiletool.records.design import Design
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


def _tabulated(path: Path) -> FloatArray | None:
    try:
        text = read_file(path, _MOST_BYTES, "a table").decode()
        return read_shape_csv(text, "target")
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
