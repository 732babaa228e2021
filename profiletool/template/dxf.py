"""Drawings as DXF in mm: R2000, or R12 for machines that read nothing newer."""

from __future__ import annotations

import io
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal

from ezdxf import options, units  # type: ignore[attr-defined]
from ezdxf.filemanagement import new

from profiletool.template.drawing import COLOURS, Drawing

Version = Literal["R2000", "R12"]


def write_dxf(drawing: Drawing, version: Version = "R2000") -> bytes:
    """Return the bytes of a DXF file of ``drawing``.

    Every line is an LWPOLYLINE on its layer (R12: a POLYLINE), closed contours closed ones. R12
    knows no units: the reader must be told mm. The same drawing gives the same bytes: times and
    identifiers are fixed.
    """
    with _fixed_metadata():
        doc = new(version, units=units.MM)
        # ezdxf takes the unit of length along, but leaves the measurement system to the caller.
        doc.header["$MEASUREMENT"] = 1
        modelspace = doc.modelspace()
        add = modelspace.add_polyline2d if version == "R12" else modelspace.add_lwpolyline
        for layer in drawing.layers:
            doc.layers.add(layer.name, color=COLOURS[layer.name][0])
            for line in layer.lines:
                add(line.points.tolist(), close=line.closed, dxfattribs={"layer": layer.name})
        x0, y0, x1, y1 = drawing.bounds
        modelspace.reset_extents((x0, y0, 0), (x1, y1, 0))
        modelspace.reset_limits((x0, y0), (x1, y1))
        doc.set_modelspace_vport(
            height=1.1 * max(x1 - x0, y1 - y0), center=((x0 + x1) / 2, (y0 + y1) / 2)
        )
        stream = io.StringIO()
        doc.write(stream)
        return bytes(doc.encode(stream.getvalue()))


@contextmanager
def _fixed_metadata() -> Iterator[None]:
    """Have ezdxf write fixed times, identifiers and version; put its options back at the end.

    It is kept from logging that R12 has no units.
    """
    log = logging.getLogger("ezdxf")
    before = options.write_fixed_meta_data_for_testing, log.level
    options.write_fixed_meta_data_for_testing = True
    log.setLevel(logging.ERROR)
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before[0]
        log.setLevel(before[1])
