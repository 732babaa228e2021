"""A picture as small as the search needs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.colours import cells
from profiletool.image.find.ground import BoolImage, FloatImage, Ground, fit_ground, to_lab
from profiletool.records.request import Point

_BLUR_PX = 0.8
# A ground that scatters more than this is not told by a smooth surface; less, and it is clean.
_MOTTLED_LAB, _CLEAN_LAB = 3.0, 1.0


@dataclass(frozen=True)
class View:
    """A picture as small as the search needs.

    Attributes
    ----------
    rgb : (H, W, 3) uint8
    lab : (H, W, 3)
        The same in CIE Lab, lightly blurred.
    cell : (H, W) int32
        The cell of every pixel's colour, as `colours.cells` numbers them.
    ground : Ground
        Fitted to all of it but the markers; its distance is 0 where there is no object for certain.
    barred : (H, W) bool
        Where there is no object for certain.
    point : (x, y), or None
        Pixels of this view; inside the object for certain.
    boxed : bool
        Whether all but a box is barred.
    """

    rgb: NDArray[np.uint8]
    lab: FloatImage
    cell: NDArray[np.int32]
    ground: Ground
    barred: BoolImage
    point: Point | None = None
    boxed: bool = False

    @property
    def plain(self) -> bool:
        """Whether a smooth colour surface tells all of the ground."""
        return self.ground.scatter_lab < _MOTTLED_LAB

    @property
    def clean(self) -> bool:
        """Whether the ground shows nothing but a smooth colour and noise."""
        return self.ground.scatter_lab < _CLEAN_LAB

    @property
    def told(self) -> bool:
        """Whether the user has said where the object is."""
        return self.boxed or self.point is not None


def view_of(
    rgb: NDArray[np.uint8],
    ignored: BoolImage,
    outside: BoolImage | None = None,
    point: Point | None = None,
) -> View:
    """Make a view of an (H, W, 3) picture, ``outside`` being ground for certain too."""
    barred = ignored if outside is None else ignored | outside
    lab = soft_lab(rgb)
    ground = fit_ground(lab, ~ignored)
    ground = replace(ground, distance=np.where(barred, np.float32(0), ground.distance))
    return View(rgb, lab, cells(lab), ground, barred, point, outside is not None)


def soft_lab(rgb: NDArray[np.uint8]) -> FloatImage:
    """CIE Lab of an (H, W, 3) picture, lightly blurred."""
    return np.asarray(cv2.GaussianBlur(to_lab(rgb), (0, 0), _BLUR_PX), np.float32)
