"""Pictures of a tube's own outline, flat and with known turns: quick to draw."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from profiletool.files.design_json import load_design
from profiletool.records.picture import Picture
from profiletool.subject.tube.camera import Camera, FlatCamera, Place
from profiletool.subject.tube.family import Family, family_of
from profiletool.verify.predicted import predicted_by_response

MM_PER_PX = 0.2
PLACE = Place(60.0, 25.0, 1.5, 1.0)
FINE = 4


def family(samples: Path, most_bar: float = 1.0) -> Family:
    return family_of(predicted_by_response(load_design(samples / "paper_bulb.json"), most_bar))


def picture(
    known: Family,
    bar: float,
    turn_deg: np.ndarray | None = None,
    *,
    place: Place = PLACE,
    size: tuple[int, int] = (760, 760),
    ground: tuple[int, int, int] = (232, 228, 220),
    patch: tuple[int, int, int, int] | None = None,
    noise: float = 2.0,
    camera: Camera | None = None,
) -> Picture:
    """Draw a tube on a plain ground; where a ``patch`` (x0, y0, x1, y1) lies, the ground is
    of its own colour.
    """
    turn = np.zeros(known.joints) if turn_deg is None else np.radians(turn_deg)
    seen = camera or FlatCamera(MM_PER_PX)
    lines = seen.lines(known.outline(bar, turn, np.zeros(known.joints)), place, 0.0)
    ring = np.concatenate([lines[0], lines[1, ::-1]])
    width, height = size
    image = np.full((FINE * height, FINE * width, 3), ground, np.uint8)
    colour = (120, 126, 132)
    if patch is not None:
        x0, y0, x1, y1 = (FINE * side for side in patch)
        image[y0:y1, x0:x1] = colour
    corners = np.round(16 * (FINE * (ring + 0.5) - 0.5)).astype(np.int32)
    cv2.fillPoly(image, [corners], colour, shift=4)
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA).astype(float)
    small = cv2.GaussianBlur(small, (0, 0), 0.7)
    small += np.random.default_rng(0).normal(0.0, noise, small.shape)
    return Picture(np.clip(np.round(small), 0, 255).astype(np.uint8), None, None, "PNG")
