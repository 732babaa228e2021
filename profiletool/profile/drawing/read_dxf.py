"""Profiles drawn in DXF."""

from __future__ import annotations

import logging
import struct
from collections.abc import Iterable
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from profiletool.errors import NoObject, UnreadableInput
from profiletool.profile.drawing.chain import (
    FLAT_MM,
    MAX_COORDINATE_MM,
    MAX_POINTS,
    Polyline,
    clean,
    join,
)
from profiletool.records.units import FloatArray

if TYPE_CHECKING:
    from ezdxf.document import Drawing

KINDS = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "LWPOLYLINE", "POLYLINE", "SPLINE")
_NEVER_PLOTTED = "defpoints"  # where CAD programs keep the points of dimensions
MAX_SPLINE_POINTS = 15_000  # of all splines: they are slow
MAX_LINES = 300_000  # of text
MAX_BINARY_BYTES = 2_000_000
MAX_ENTITIES = 10_000
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


def read_dxf(path: Path) -> list[Polyline]:
    """Read the chains of a drawing's model space.

    Parameters
    ----------
    path : Path
        ASCII or binary DXF. Slight damage is repaired.

    Returns
    -------
    list of Polyline
        In mm (unitless drawings are taken as mm), y up, entities joined end to end. Layers that
        are off or frozen, invisible entities, blocks and paper space are left out.

    Raises
    ------
    UnreadableInput
        The file is no DXF, is damaged beyond repair, or holds absurd or too many coordinates.
    NoObject
        All there is hides in blocks.
    """
    from ezdxf.lldxf.const import DXFError

    _check_length(path.read_bytes())
    try:
        drawing = _open(path)
        factor = _mm_per_unit(drawing)
        entities = _visible(drawing)
        if len(entities) > MAX_ENTITIES:
            raise UnreadableInput(f"more than {MAX_ENTITIES} lines and curves; simplify it")
        with np.errstate(all="ignore"):  # absurd numbers: the outcome is checked
            pieces = _pieces(entities, factor)
        blocks = not entities and bool(drawing.modelspace().query("INSERT"))
    except (DXFError, *_DAMAGE) as error:
        raise UnreadableInput(f"no sound DXF ({error}); export it again as DXF R2000") from None
    if blocks:
        raise NoObject("the drawing holds blocks alone; explode them and save again")
    return join(pieces)


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
        drawing, auditor = recover.readfile(path)
    if auditor.has_errors:
        raise DXFStructureError(f"{len(auditor.errors)} errors beyond repair")
    return drawing


def _mm_per_unit(drawing: Drawing) -> float:
    from ezdxf.enums import InsertUnits
    from ezdxf.units import conversion_factor

    unit = InsertUnits(drawing.units)
    if unit is InsertUnits.Unitless:
        return 1.0
    return conversion_factor(unit, InsertUnits.Millimeters)


def _visible(drawing: Drawing) -> list[Any]:
    hidden = {_NEVER_PLOTTED}
    for layer in drawing.layers:
        if layer.is_off() or layer.is_frozen():
            hidden.add(layer.dxf.name.lower())
    return [
        entity
        for entity in drawing.modelspace()
        if entity.dxftype() in KINDS
        and not entity.dxf.get("invisible", 0)
        and entity.dxf.get("layer", "0").lower() not in hidden
    ]


def _pieces(entities: Iterable[Any], factor: float) -> list[Polyline]:
    left, left_of_splines, pieces = MAX_POINTS, MAX_SPLINE_POINTS, []
    for entity in entities:
        spline = entity.dxftype() == "SPLINE"
        points = np.array(
            [
                (v.x, v.y)
                for v in islice(
                    _flattened(entity, factor), min(left, left_of_splines) if spline else left
                )
            ],
            dtype=np.float64,
        ).reshape(-1, 2)
        left -= len(points)
        left_of_splines -= len(points) if spline else 0
        if left_of_splines <= 0:
            raise UnreadableInput(
                f"splines of more than {MAX_SPLINE_POINTS} points; export them as polylines"
            )
        if left <= 0:
            raise UnreadableInput(f"more than {MAX_POINTS} points; simplify the drawing")
        if len(points) > 1:
            pieces.append(clean(points * factor, _closed(entity)))
    return pieces


def _flattened(entity: Any, factor: float) -> Iterable[Any]:
    """Yield the points of an entity in drawing units, world frame, within FLAT_MM of it."""
    from ezdxf.path import make_path

    distance = FLAT_MM / factor
    if entity.dxftype() == "SPLINE":
        # Its path form is exact for cubic splines only.
        tool = entity.construction_tool()
        _check(tool.control_points, factor)
        flat: Iterable[Any] = tool.flattening(distance, segments=4)
        return flat
    if entity.dxftype() == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline):
        return ()
    path = make_path(entity, segments=_ARC_PIECES)
    _check(path.control_vertices(), factor)
    return path.flattening(distance)


def _check(vertices: Iterable[Any], factor: float) -> None:
    """Refuse what would take for ever to flatten; heights count, as flattening is spatial."""
    places = np.array([(v.x, v.y, v.z) for v in vertices], dtype=np.float64)
    reach: FloatArray = np.abs(places) * factor
    if not np.all(reach <= MAX_COORDINATE_MM):
        raise UnreadableInput(
            f"coordinates beyond {MAX_COORDINATE_MM:g} mm or not finite; check the drawing's units"
        )


def _closed(entity: Any) -> bool:
    kind = entity.dxftype()
    return kind == "CIRCLE" or (
        kind in ("LWPOLYLINE", "POLYLINE", "SPLINE")
        and bool(entity.closed if kind != "POLYLINE" else entity.is_closed)
    )
