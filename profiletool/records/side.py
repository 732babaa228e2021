"""The side of an object that a tube follows, and the sense of turns along it."""

from __future__ import annotations

from typing import Literal

Side = Literal["left", "right"]


def side_sign(side: Side) -> float:
    """Return +1 where a convex turn is counter-clockwise (left side), else -1."""
    return 1.0 if side == "left" else -1.0
