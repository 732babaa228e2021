"""An egg to draw in every unit and dialect, and what it is when it is read rightly."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from profiletool import find_subject
from profiletool.records.units import FloatArray

_T = np.linspace(0.0, 2.0 * np.pi, 160, endpoint=False)
EGG: FloatArray = np.column_stack(
    [(30.0 - 4.0 * np.sin(_T)) * np.cos(_T) - 3.0 * np.cos(_T) ** 2, 45.0 * np.sin(_T)]
)  # mm, y up
SIZE = tuple(np.ptp(EGG, axis=0).tolist())


def size_of(path: Path, **options: object) -> tuple[float, float]:
    """Width and height of the outline that is read, mm."""
    outline = find_subject(path, **options).profile.outline
    assert outline is not None
    width, height = np.ptp(outline, axis=0).tolist()
    return width, height


def path_data(x: float = 50.0, y: float = 55.0, scale: float = 1.0) -> str:
    """The egg as an SVG path about a point."""
    points = " ".join(f"{x + scale * a:.4f},{y - scale * b:.4f}" for a, b in EGG)
    return f"M{points}Z"
