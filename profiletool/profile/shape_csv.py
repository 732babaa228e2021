"""The plain data files of a design."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from profiletool.profile.curve import arc_length
from profiletool.profile.drawing.chain import MAX_COORDINATE_MM
from profiletool.records.units import FloatArray


def shape_csv(lines: Mapping[str, FloatArray]) -> bytes:
    """Tabulate named lines (N, 2) in mm, object frame, with the arc length along each."""
    rows = ["curve,s_mm,x_mm,y_mm"]
    for name, points in lines.items():
        rows += _rows(name, points)
    return ("\n".join(rows) + "\n").encode()


def read_shape_csv(text: str, name: str) -> FloatArray:
    """Read one line of a shape.csv back: (N, 2) mm; empty where there is none of that name.

    Raises
    ------
    ValueError
        When the text is no such table, or of absurd numbers.
    """
    rows = [row.split(",") for row in text.splitlines()]
    points = np.array([[float(x), float(y)] for curve, _, x, y in rows if curve == name])
    if not np.all(np.abs(points) <= MAX_COORDINATE_MM):
        raise ValueError(f"coordinates beyond {MAX_COORDINATE_MM:g} mm or not finite")
    return points.reshape(-1, 2)


def _rows(name: str, points: FloatArray) -> list[str]:
    table = np.column_stack([arc_length(points), points])
    return [f"{name},{s:.3f},{x:.4f},{y:.4f}" for s, x, y in table.tolist()]
