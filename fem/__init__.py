"""Finite elements of the actuator; numpy and scipy only, no pictures, designs or formulas.

The names in ``__all__`` are for users: an `Actuator`, laid out by `chain`, is inflated by `solve`,
whose `Solution` holds a `State` a pressure; `sensitivities` differentiate a state. All others,
in the modules, are the engine's own.

Glossary
--------
X, x : reference and current position, mm
F, J : deformation gradient dx/dX and its determinant
H : cofactor of F, dJ/dF
P : first Piola-Kirchhoff stress dW/dF, MPa (in kernels); the gauge pressure is ``pressure``
W : stored energy per reference volume, MPa
lam : stretch of a thread, current length over length at rest
ring, mid : the nodes of one cross-section between two layers of elements, and half-way in a layer
layer : the elements between two rings
window : the axial stretch of a joint in which the axial threads are cut, but for a sector

Frame: z along the tube from the clamped end, x and y across; an angular position phi is measured
counter-clockwise from +x as seen from the closed end. The object faces phi = 270 deg (-y). A
positive joint angle turns the closed end toward -y. Lengths in mm, stresses in MPa, angles in rad.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fem.actuator import AWAY, TOWARD, Actuator, Window, chain
    from fem.equilibrium import Critical
    from fem.errors import Attempt, BadGeometry, FemError, NotConverged
    from fem.gauze import PAPER_GAUZE, AxialLines, Gauze
    from fem.items import Batch, Item
    from fem.loadpath import DEFAULT_OPTIONS, Options
    from fem.material import (
        PAPER_RUBBER,
        InvariantLaw,
        Law,
        MooneyRivlin,
        NeoHooke,
        Ogden,
        Yeoh,
        law,
    )
    from fem.mesh import Mesh
    from fem.meshsize import DEFAULT_MESH, PAPER_MESH, MeshSize
    from fem.near import solve_near
    from fem.onward import solve_onward
    from fem.rates import Rate, Sensitivities, flow_to
    from fem.sensitivity import rates_by, sensitivities
    from fem.solution import Solution, State
    from fem.solver import solve
    from fem.weight import Weight

__all__ = [
    "AWAY",
    "DEFAULT_MESH",
    "DEFAULT_OPTIONS",
    "PAPER_GAUZE",
    "PAPER_MESH",
    "PAPER_RUBBER",
    "TOWARD",
    "Actuator",
    "Attempt",
    "AxialLines",
    "BadGeometry",
    "Batch",
    "Critical",
    "FemError",
    "Gauze",
    "InvariantLaw",
    "Item",
    "Law",
    "Mesh",
    "MeshSize",
    "MooneyRivlin",
    "NeoHooke",
    "NotConverged",
    "Ogden",
    "Options",
    "Rate",
    "Sensitivities",
    "Solution",
    "State",
    "Weight",
    "Window",
    "Yeoh",
    "chain",
    "flow_to",
    "law",
    "rates_by",
    "sensitivities",
    "solve",
    "solve_near",
    "solve_onward",
]

# The module that each public name comes from.
_HOMES = {
    "AWAY": "actuator",
    "TOWARD": "actuator",
    "Actuator": "actuator",
    "Window": "actuator",
    "chain": "actuator",
    "Critical": "equilibrium",
    "Attempt": "errors",
    "BadGeometry": "errors",
    "FemError": "errors",
    "NotConverged": "errors",
    "PAPER_GAUZE": "gauze",
    "AxialLines": "gauze",
    "Gauze": "gauze",
    "Batch": "items",
    "Item": "items",
    "DEFAULT_OPTIONS": "loadpath",
    "Options": "loadpath",
    "PAPER_RUBBER": "material",
    "InvariantLaw": "material",
    "Law": "material",
    "MooneyRivlin": "material",
    "NeoHooke": "material",
    "Ogden": "material",
    "Yeoh": "material",
    "law": "material",
    "Mesh": "mesh",
    "DEFAULT_MESH": "meshsize",
    "PAPER_MESH": "meshsize",
    "MeshSize": "meshsize",
    "solve_near": "near",
    "solve_onward": "onward",
    "Rate": "rates",
    "Sensitivities": "rates",
    "flow_to": "rates",
    "rates_by": "sensitivity",
    "sensitivities": "sensitivity",
    "Solution": "solution",
    "State": "solution",
    "solve": "solver",
    "Weight": "weight",
}


def __getattr__(name: str) -> Any:
    """Import a public name at its first use: scipy takes its time to load."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"fem.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    """List the public names beside what is loaded."""
    return sorted({*globals(), *__all__})
