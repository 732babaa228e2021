"""Lines made of pieces that turn evenly."""

from __future__ import annotations

import numpy as np

from profiletool.records.units import FloatArray


def turning_line(*pieces: tuple[float, float], steps: int = 100) -> FloatArray:
    """Points of (length, turn in deg) pieces, from heading straight down; right turns negative."""
    points, heading = [np.zeros(2)], -np.pi / 2
    for length, turn in pieces:
        for _ in range(steps):
            heading += np.radians(turn) / (2 * steps)
            step = length / steps * np.array([np.cos(heading), np.sin(heading)])
            points.append(points[-1] + step)
            heading += np.radians(turn) / (2 * steps)
    return np.array(points)
