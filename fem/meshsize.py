"""Fineness of a mesh, and the one brick that all others are copies of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.actuator import Actuator
from fem.arrays import FloatArray
from fem.element import Kind, natural_nodes


@dataclass(frozen=True)
class MeshSize:
    """How fine the mesh is; lengths in mm for a tube of 20 mm, others in proportion.

    Attributes
    ----------
    around : int
        Bricks in half of the circumference, if all were as wide as the widest.
    beside : float
        Width of the bricks beside the edge of an uncut sector, rad; 0 for bricks all alike.
        Widths double from one brick to the next.
    edge, window, wrapped, end : float
        Height of a layer at a window's edge, at most in windows and in wrapped sectors, and at
        the clamped end and the plug.
    growth : float
        Of the heights from one layer to the next.
    kind : {"hex20", "hex8"}
    through : int
        Bricks through the wall.
    orders : (int, int, int)
        Gauss points through the wall, around, along.
    mean_dilatation : bool
        Take the volume change from the brick's mean: the cure that 8-node bricks need.
    """

    around: int = 4
    beside: float = float(np.radians(12.0))
    edge: float = 0.2
    window: float = 2.5
    wrapped: float = 8.0
    end: float = 4.0
    growth: float = 3.0
    kind: Kind = "hex20"
    through: int = 1
    orders: tuple[int, int, int] = (2, 3, 2)
    mean_dilatation: bool = False


DEFAULT_MESH = MeshSize()
# The paper's: 8-node bricks of 1 mm by 6 deg, two through the wall.
PAPER_MESH = MeshSize(31, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, "hex8", 2, (2, 2, 2), mean_dilatation=True)


def start_angle() -> float:
    """Angular position where the first brick begins: the side that faces the object."""
    return -0.5 * np.pi


def one_brick(actuator: Actuator, size: MeshSize, span: float, deep: int) -> FloatArray:
    """Nodes of a brick 2 mm high, ``deep`` bricks from the inside, its middle on +x."""
    natural = natural_nodes(size.kind).astype(float)
    share = (deep + 0.5 * (natural[:, 0] + 1.0)) / size.through
    r = actuator.radius - actuator.wall * (1.0 - share)
    phi = 0.5 * span * natural[:, 1]
    return np.column_stack([r * np.cos(phi), r * np.sin(phi), natural[:, 2]])
