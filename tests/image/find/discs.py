"""Pictures of discs."""

from __future__ import annotations

import numpy as np

from profiletool.records.picture import Picture

SHAPE = (240, 320)


Y, X = np.mgrid[: SHAPE[0], : SHAPE[1]]


def disc(x: float, y: float, radius: float) -> np.ndarray:
    return np.clip(radius + 0.5 - np.hypot(X - x, Y - y), 0, 1)


def picture_of(rgb: np.ndarray) -> Picture:
    return Picture(np.clip(np.round(rgb), 0, 255).astype(np.uint8), None, None, "PNG")


def laid(cover: np.ndarray, ground: np.ndarray | None = None) -> Picture:
    below = np.full((*SHAPE, 3), (200.0, 198, 190)) if ground is None else ground
    return picture_of(below * (1 - cover[..., None]) + np.array([150, 60, 40]) * cover[..., None])


def checks() -> np.ndarray:
    return np.where((X // 20 + Y // 20) % 2 == 0, 90, 200)[..., None] * np.array([0.5, 0.9, 0.6])
