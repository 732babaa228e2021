"""The theta(alpha, openF, P) of a joint: formula, table, look-up and inverse.

Glossary
--------
alpha : angular extent of the uncut sector of the gauze, deg ("alpha_closed")
openF : axial length of the cut, mm
P : gauge pressure, bar
theta : bending angle of the joint, deg

The formula's coefficients are given for degrees, mm and bar, so this package keeps those units
and says them in its names.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from formula.errors import BadFormula, OutOfRange
    from formula.files import load_formula, shipped
    from formula.inverse import alpha_deg, theta_range_deg
    from formula.rubber import RubberLaw
    from formula.table import Assignment, Table, assign, make_table
    from formula.theta import Formula, theta_deg

__all__ = [
    "Assignment",
    "BadFormula",
    "Formula",
    "OutOfRange",
    "RubberLaw",
    "Table",
    "alpha_deg",
    "assign",
    "load_formula",
    "make_table",
    "shipped",
    "theta_deg",
    "theta_range_deg",
]

# The module that each public name comes from.
_HOMES = {
    "BadFormula": "errors",
    "OutOfRange": "errors",
    "load_formula": "files",
    "shipped": "files",
    "alpha_deg": "inverse",
    "theta_range_deg": "inverse",
    "Assignment": "table",
    "Table": "table",
    "assign": "table",
    "make_table": "table",
    "Formula": "theta",
    "RubberLaw": "rubber",
    "theta_deg": "theta",
}


def __getattr__(name: str) -> Any:
    """Import a public name at its first use: numpy takes its time to load."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"formula.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    """List the public names beside what is loaded."""
    return sorted({*globals(), *__all__})
