"""Good and bad photographs for the guide, drawn: ``python docs/photographs.py``."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

FloatImage = NDArray[np.float64]

_SHAPE = 260, 260
_ROW, _COLUMN = np.indices(_SHAPE).astype(float)
_GREEN = np.array((96.0, 128.0, 112.0))
_CREAM, _DARK = np.array((236.0, 228.0, 210.0)), np.array((58.0, 52.0, 50.0))


def _ball(x: float, y: float, wide: float, tall: float) -> FloatImage:
    """Cover of a softly edged egg, (H, W)."""
    off = np.hypot((_COLUMN - x) / wide, (_ROW - y) / (tall * (1.0 + 0.12 * (y < _ROW))))
    return np.asarray(np.clip((1.0 - off) * 0.7 * wide + 0.5, 0.0, 1.0))


def _laid(ground: FloatImage, x: float = 130.0, y: float = 125.0) -> FloatImage:
    """Lay a lit egg on a ground."""
    light = 1.0 - 0.35 * np.clip(np.hypot(_COLUMN - x + 25, _ROW - y + 30) / 110.0, 0.0, 1.0) ** 2
    cover = _ball(x, y, 55, 75)[..., None]
    return np.asarray(ground * (1.0 - cover) + _CREAM * light[..., None] * cover)


def _ground(colour: FloatImage) -> FloatImage:
    fall = 1.0 - 0.0004 * (_COLUMN - 60.0)
    return np.asarray(colour * fall[..., None])


def _shaded(ground: FloatImage, blur: float, depth: float, right: float) -> FloatImage:
    shadow = cv2.GaussianBlur(_ball(130 + right, 140, 58, 72), (0, 0), blur)[..., None]
    return np.asarray(ground * (1.0 - depth * shadow))


def panels() -> list[FloatImage]:
    """Six photographs: one that works, then cut off, own colour, shadow, reflection, neighbour."""
    soft = _shaded(_ground(_GREEN), 12.0, 0.25, 4.0)
    mirror = _laid(_ground(_DARK), y=100.0)
    foot = 182
    mirror[foot:] = 0.5 * mirror[foot:] + 0.5 * mirror[foot - 1 : 2 * foot - 261 : -1][:78]
    neighbour = _laid(soft)
    cover = _ball(218, 150, 40, 40)[..., None]
    neighbour = neighbour * (1.0 - cover) + np.array([196.0, 178.0, 150.0]) * cover
    return [
        _laid(soft),
        _laid(_ground(_GREEN), y=40.0),
        _laid(_shaded(_ground(_CREAM), 12.0, 0.06, 4.0)),
        _laid(_shaded(_ground(_GREEN), 1.5, 0.72, 34.0)),
        mirror,
        neighbour,
    ]


def main() -> None:
    """Write the picture."""
    rows = []
    for number, panel in enumerate(panels(), start=1):
        shown = np.clip(np.round(panel), 0, 255).astype(np.uint8).copy()
        for ink, thick in ((0, 6), (255, 2)):
            place, font = (10, 32), cv2.FONT_HERSHEY_SIMPLEX
            cv2.putText(shown, str(number), place, font, 1.0, (ink, ink, ink), thick)
        rows.append(np.pad(shown, ((4, 4), (4, 4), (0, 0)), constant_values=255))
    whole = np.vstack([np.hstack(rows[:3]), np.hstack(rows[3:])])
    file = Path(__file__).parent / "pictures" / "photographs.jpg"
    Image.fromarray(whole).save(file, quality=84, optimize=True)


if __name__ == "__main__":
    main()
