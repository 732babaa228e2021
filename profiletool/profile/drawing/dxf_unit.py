"""Unit of a DXF's numbers: what its header says, and what is taken where it says nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from profiletool.records.profile import DrawnUnit
from profiletool.records.units import MM_PER_INCH

if TYPE_CHECKING:
    from ezdxf.document import Drawing

_RARE_MM = {
    "microinches": 25.4e-6,
    "mils": 0.0254,
    "yards": 914.4,
    "miles": 1609.344e3,
}  # not ezdxf's


def unit_of(drawing: Drawing, data: bytes) -> DrawnUnit:
    """Give the unit of a drawing.

    Parameters
    ----------
    drawing : ezdxf.document.Drawing
    data : bytes
        The file: ezdxf invents header variables, metres among them, where it has none.
    """
    from ezdxf.enums import InsertUnits
    from ezdxf.units import conversion_factor

    unit = InsertUnits.Unitless
    if b"$INSUNITS" in data:
        unit = InsertUnits(drawing.header.get("$INSUNITS", 0))
    if unit is not InsertUnits.Unitless:
        name = unit.name.lower()
        mm = _RARE_MM.get(name)
        mm = conversion_factor(unit, InsertUnits.Millimeters) if mm is None else mm
        return DrawnUnit(mm, f"the drawing's unit is {name}")
    if b"$MEASUREMENT" in data and drawing.header.get("$MEASUREMENT", 1) == 0:
        return DrawnUnit(
            MM_PER_INCH, "the drawing names no unit, and its $MEASUREMENT says inches",
            assumed=True,
        )  # fmt: skip
    return DrawnUnit(
        1.0, "the drawing names no unit, so its numbers were taken for mm", assumed=True
    )
