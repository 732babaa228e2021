"""Profiles drawn in DXF."""

from __future__ import annotations

import logging
import struct
from collections.abc import Iterable, Iterator
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.profile.drawing.chain import (
    FLAT_MM,
    MAX_COORDINATE_MM,
    MAX_POINTS,
    clean,
    join,
)
from profiletool.profile.drawing.drawn import FAR_TIMES, Drawn, placed
from profiletool.profile.drawing.dxf_entities import drawn_entities
from profiletool.profile.drawing.dxf_spline import spline_points
from profiletool.profile.drawing.dxf_unit import unit_of
from profiletool.records.units import FloatArray

if TYPE_CHECKING:
    from ezdxf.document import Drawing

MAX_SPLINE_POINTS = 15_000  # of all splines: they are slow
MAX_LINES = 300_000  # of text
MAX_BINARY_BYTES = 2_000_000
_HEADER = b"0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n0\nENDSEC\n"
_FRAME_FLAG = 16  # of a polyline's vertex: a control point
_FLAT_SHARE = 1e-6  # of a drawing's size
_ARC_PIECES = 16  # Bézier curves per full ellipse: off by less than 1e-7 of the radius

# What ezdxf throws on damaged data, apart from its own DXFError.
_DAMAGE = (
    OSError,
    ValueError,
    TypeError,
    KeyError,
    IndexError,
    AttributeError,
    ArithmeticError,
    AssertionError,
    EOFError,
    StopIteration,
    RuntimeError,
    MemoryError,
    struct.error,
)

# Its remarks on damaged files would reach stderr where no one has set up logging.
logging.getLogger("ezdxf").addHandler(logging.NullHandler())


def read_dxf(path: Path, layer: str | None = None) -> Drawn:
    """Read the chains of a drawing's model space, or of its paper space if that holds all.

    Parameters
    ----------
    path : Path
        ASCII or binary DXF. Slight damage is repaired.
    layer : str or None
        To read alone.

    Returns
    -------
    Drawn
        Entities joined end to end, those of blocks with them. Layers that are off or frozen,
        invisible entities and external references are left out. What stands in the plane of a
        front or side view is seen from there.

    Raises
    ------
    UnreadableInput
        The file is no DXF, is damaged beyond repair, or holds absurd or too many coordinates.
    NoObject
        Nothing but what no line stands for.
    UsageError
        No such layer.
    """
    from ezdxf.lldxf.const import DXFError

    data = path.read_bytes()
    _check_length(data)
    try:
        drawing = _open(path)
        unit = unit_of(drawing, data)
        entities, notes = drawn_entities(drawing, layer)
        with np.errstate(all="ignore"):  # absurd numbers: the outcome is checked
            pieces = _pieces(entities, unit.mm)
    except (DXFError, *_DAMAGE) as error:
        raise UnreadableInput(f"no sound DXF ({error}); export it again as DXF R2000") from None
    flat, seen = _in_plane([points for points, _ in pieces])
    near, moved = placed(flat)
    chains = [clean(p, closed) for p, (_, closed) in zip(near, pieces, strict=True)]
    return Drawn(join(chains), unit, (*notes, *seen, *moved))


def _check_length(data: bytes) -> None:
    """Refuse what would take for ever to parse."""
    if max(data.count(b"\n"), data.count(b"\r")) > MAX_LINES:
        raise UnreadableInput(f"more than {MAX_LINES} lines of text; delete what is no profile")
    if data.startswith(b"AutoCAD Binary DXF") and len(data) > MAX_BINARY_BYTES:
        raise UnreadableInput(
            f"more than {MAX_BINARY_BYTES / 1e6:g} MB of binary DXF; delete what is no profile"
        )


def _open(path: Path) -> Drawing:
    from ezdxf import recover
    from ezdxf.filemanagement import readfile
    from ezdxf.lldxf.const import DXFError, DXFStructureError

    try:
        return readfile(path)
    except (DXFError, *_DAMAGE):
        pass
    try:
        drawing, auditor = recover.readfile(path)
    except (DXFError, *_DAMAGE):
        data = path.read_bytes()
        if b"$ACADVER" in data:
            raise
        # Without a header ezdxf takes it for R12, which knows no LWPOLYLINE.
        drawing, auditor = recover.read(BytesIO(_HEADER + data))
    if auditor.has_errors:
        raise DXFStructureError(f"{len(auditor.errors)} errors beyond repair")
    return drawing


def _pieces(entities: Iterable[Any], factor: float) -> list[tuple[FloatArray, bool]]:
    """Points (N, 3), mm, of every run of every entity, and whether it is closed."""
    left, left_of_splines = MAX_POINTS, MAX_SPLINE_POINTS
    pieces: list[tuple[FloatArray, bool]] = []
    for entity in entities:
        spline = entity.dxftype() == "SPLINE"
        for run, closed in _runs(entity, factor):
            most = min(left, left_of_splines) if spline else left
            points = np.array([tuple(v) for v in islice(run, most)], dtype=np.float64)
            left -= len(points)
            left_of_splines -= len(points) if spline else 0
            if left_of_splines <= 0:
                raise UnreadableInput(
                    f"splines of more than {MAX_SPLINE_POINTS} points; export them as polylines"
                )
            if left <= 0:
                raise UnreadableInput(f"more than {MAX_POINTS} points; simplify the drawing")
            if len(points) > 1:
                pieces.append((points.reshape(-1, 3) * factor, closed))
    return pieces


def _runs(entity: Any, factor: float) -> Iterator[tuple[Iterable[Any], bool]]:
    """Yield the points of an entity in drawing units, world frame, within FLAT_MM of it.

    With each run comes whether it is closed.
    """
    from ezdxf.path import from_hatch, make_path

    distance, kind = FLAT_MM / factor, entity.dxftype()
    if kind == "SPLINE":
        # Its path form is exact for cubic splines only.
        tool = entity.construction_tool()
        _check(tool.control_points, factor)
        yield spline_points(tool, distance, MAX_SPLINE_POINTS), bool(entity.closed)
        return
    if kind == "POLYLINE":
        if not (entity.is_2d_polyline or entity.is_3d_polyline):
            return
        _drop_frame(entity)
    closed = kind in ("CIRCLE", "HATCH", "MPOLYGON", "SOLID", "TRACE", "3DFACE")
    if kind in ("LWPOLYLINE", "POLYLINE"):
        closed = bool(entity.closed if kind == "LWPOLYLINE" else entity.is_closed)
    paths = from_hatch(entity) if kind in ("HATCH", "MPOLYGON") else [
        make_path(entity, segments=_ARC_PIECES)
        if kind in ("CIRCLE", "ARC", "ELLIPSE", "LWPOLYLINE", "POLYLINE")
        else make_path(entity)
    ]  # fmt: skip
    for path in paths:
        _check(path.control_vertices(), factor)
        if len(path) > 0:
            yield path.flattening(distance), closed


def _drop_frame(polyline: Any) -> None:
    """Leave out the control points of a curve that was fitted: only its own points are drawn."""
    drawn = [v for v in polyline.vertices if not v.dxf.get("flags", 0) & _FRAME_FLAG]
    if 2 <= len(drawn) < len(polyline.vertices):
        polyline.vertices[:] = drawn


def _check(vertices: Iterable[Any], factor: float) -> None:
    """Refuse what would take for ever to flatten; heights count, as flattening is spatial."""
    places = np.array([(v.x, v.y, v.z) for v in vertices], dtype=np.float64).reshape(-1, 3)
    if len(places) == 0:
        return
    reach = max(np.ptp(places, axis=0).max(), np.abs(places).max() / FAR_TIMES) * factor
    if not reach <= 4.0 * MAX_COORDINATE_MM:
        raise UnreadableInput(
            f"coordinates beyond {MAX_COORDINATE_MM:g} mm or not finite; check the drawing's units"
        )


def _in_plane(pieces: list[FloatArray]) -> tuple[list[FloatArray], tuple[str, ...]]:
    """See (N, 3) from above; what stands upright, in a plane, from the front or the side."""
    if not pieces:
        return [], ()
    spans = np.ptp(np.concatenate(pieces), axis=0)
    flat = spans <= _FLAT_SHARE * spans.max()
    for deep, axes, view in ((1, (0, 2), "front"), (0, (1, 2), "side")):
        if flat[deep] and not flat[2] and not flat[axes[0]]:
            note = f"the drawing stands upright in space: it was seen from the {view}"
            return [piece[:, axes] for piece in pieces], (note,)
    note = "the drawing is not flat: it was seen from above"
    return [piece[:, :2] for piece in pieces], (note,) if not flat[2] and spans.max() > 0 else ()
