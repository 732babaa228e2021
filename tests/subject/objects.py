"""Pictures and drawings of a pear, and how they are looked at."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from PIL import Image

from profiletool.image.load import load_picture
from profiletool.records.request import Look, ScaleRequest
from profiletool.records.units import FloatArray
from profiletool.subject.photo import Seen, see
from tests.image.views import Shot

T = np.linspace(0.0, 2.0 * np.pi, 1201)[:-1]


# Narrow above, heavy below: 80 wide and 120 high, y up.
PEAR = np.column_stack([40.0 * np.cos(T) * (1.0 - 0.35 * np.sin(T)), 60.0 * np.sin(T)])


PEAR_WIDTH, PEAR_HEIGHT = np.ptp(PEAR, axis=0).tolist()


HEIGHT = ScaleRequest(height_mm=PEAR_HEIGHT)


SHOT = Shot(600, 25, 30, k1=-0.08, fill=0.7, size=(720, 960))


def drawn(
    path: Path,
    outlines: list[FloatArray],
    size: tuple[int, int] = (480, 400),
    k: float = 2.0,
) -> Path:
    """Fill outlines, mm, y up, off the middle of a picture of (width, height)."""
    fine = 4
    width, height = (fine * side for side in size)
    image = np.full((height, width, 3), 236, np.uint8)
    for outline in outlines:
        px = (outline * [k * fine, -k * fine] + [width / 2.0, height / 2.0]).round().astype(int)
        cv2.fillPoly(image, [px.astype(np.int32)], (60, 90, 50))
    Image.fromarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA)).save(path)
    return path


def look_at(file: Path, asked: ScaleRequest = HEIGHT, **look: object) -> Seen:
    return see(load_picture(file), asked, Look(**look), lambda line: None)  # type: ignore[arg-type]


def size_of(seen: Seen) -> tuple[float, float]:
    width, height = np.ptp(seen.silhouette.contour_px, axis=0) * seen.scale.mm_per_px
    return float(width), float(height)


def csv(path: Path, points: FloatArray) -> Path:
    path.write_text("x,y\n" + "".join(f"{x:.4f},{y:.4f}\n" for x, y in points))
    return path
