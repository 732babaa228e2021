"""Allowance for the width that a beam or blade burns away: the finished piece keeps its size."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from shapely import Polygon
from shapely.geometry.polygon import orient

from profiletool.errors import UsageError
from profiletool.records.units import FloatArray
from profiletool.template.drawing import Line, polyline
from profiletool.template.unroll import SAME_MM, Slit

_MITRE_LIMIT = 10.0  # keeps every corner of an outline sharp


def check_kerf(kerf_mm: float, pitch_mm: float, thread_mm: float) -> None:
    """Refuse a kerf that burns into the hoop threads, or is none.

    Raises
    ------
    UsageError
    """
    room = pitch_mm - thread_mm
    if not 0.0 <= kerf_mm < room:
        raise UsageError(
            f"`kerf_mm`: {kerf_mm:g} mm does not pass between hoop threads {room:g} mm apart"
        )


def outline_path(outline: FloatArray, kerf_mm: float) -> FloatArray:
    """Return where the middle of the cut runs around an outline (N, 2) mm: outside it."""
    if kerf_mm == 0.0:
        return outline
    grown = Polygon(outline).buffer(kerf_mm / 2, join_style="mitre", mitre_limit=_MITRE_LIMIT)
    return np.array(orient(grown).exterior.coords)[:-1]


def slit_paths(slits: Sequence[Slit], roll_mm: float, kerf_mm: float) -> tuple[Line, ...]:
    """Return where the middle of the cut runs: short of a slit's ends, but for the sheet's edges.

    A slit no longer than the kerf is a mere point and left out.
    """
    lines = []
    for slit in slits:
        start = slit.y_start_mm + (kerf_mm / 2 if slit.y_start_mm > SAME_MM else 0.0)
        end = slit.y_end_mm - (kerf_mm / 2 if slit.y_end_mm < roll_mm - SAME_MM else 0.0)
        if end - start > SAME_MM:
            lines.append(polyline("CUT_INNER", (slit.x_mm, start), (slit.x_mm, end)))
    return tuple(lines)
