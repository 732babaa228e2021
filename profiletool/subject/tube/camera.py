"""Cameras: where the lines of a tube are seen.

The plane that the tube bends in: mm, x to the right, y down as in the picture. A `Place` puts the
tube there.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from profiletool.image.sheet.lens import View
from profiletool.records.units import FloatArray
from profiletool.subject.tube.family import Outline


@dataclass(frozen=True)
class Place:
    """Where the clamped end of the tube's axis lies, and which way it points.

    Attributes
    ----------
    x, y : float, mm
    heading : float, rad
        Clockwise as seen, from the right.
    hand : float
        +1 where a turn toward the object is counter-clockwise as seen.
    """

    x: float
    y: float
    heading: float
    hand: float

    def __call__(self, vectors: FloatArray) -> FloatArray:
        """Turn vectors (..., 2) of the tube's frame into the plane's."""
        c, s = np.cos(self.heading), np.sin(self.heading)
        x, y = vectors[..., 0], -self.hand * vectors[..., 1]
        return np.stack([c * x - s * y, s * x + c * y], axis=-1)

    @property
    def point(self) -> FloatArray:
        """Its place, (2,)."""
        return np.array([self.x, self.y])


class Camera(Protocol):
    """What sees a tube; ``size`` is what is not known of its scale, 0 at first."""

    @property
    def sigma(self) -> float:
        """Standard deviation of ``size``."""

    def lines(self, outline: Outline, place: Place, size: float) -> FloatArray:
        """Both lines of a tube in the picture, facing first: (2, S, 2) px."""

    def px(self, points: FloatArray, size: float) -> FloatArray:
        """Points (..., 2) mm of the plane in the picture, px."""

    def mm(self, px: FloatArray) -> FloatArray:
        """Points (..., 2) px in the plane, mm."""


@dataclass(frozen=True)
class FlatCamera:
    """Looks straight at the plane from afar; ``size`` is the log of its scale over the given."""

    mm_per_px: float
    sigma: float = 0.02

    def px(self, points: FloatArray, size: float) -> FloatArray:
        """Bring points of the plane into the picture."""
        return np.asarray(points * (np.exp(size) / self.mm_per_px))

    def mm(self, px: FloatArray) -> FloatArray:
        """Bring points of the picture into the plane."""
        return np.asarray(px * self.mm_per_px)

    def lines(self, outline: Outline, place: Place, size: float) -> FloatArray:
        """Lay a tube's lines into the picture."""
        axis = place(outline.axis) + place.point
        off = outline.half[:, None] * place(outline.out)
        return self.px(np.stack([axis - off, axis + off]), size)


@dataclass(frozen=True)
class SheetCamera:
    """Sees the printed sheet, too, that the tube lies on; ``size`` is mm that its axis is higher.

    Attributes
    ----------
    view : View
    radius : float, mm
        Of the tube: the height of its axis.
    sigma : float, mm
    """

    view: View
    radius: float
    sigma: float = 2.0
    camera: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "camera", self.view.camera_mm)

    def px(self, points: FloatArray, size: float) -> FloatArray:
        """Bring points at the height of the axis into the picture."""
        height = np.full((*points.shape[:-1], 1), self.radius + size)
        return self._seen(np.concatenate([points, height], axis=-1))

    def mm(self, px: FloatArray) -> FloatArray:
        """Bring points of the picture to the height of the axis."""
        spots, foot = self.view.sheet_of(px), self.camera[:2]
        return np.asarray(foot + (spots - foot) * (1.0 - self.radius / self.camera[2]))

    def lines(self, outline: Outline, place: Place, size: float) -> FloatArray:
        """Where rays touch the tube: its section is a circle across its line."""
        out = place(outline.out)
        axis = place(outline.axis) + place.point
        flat = np.zeros(len(axis))
        centre = np.column_stack([axis, flat + self.radius + size])
        across = np.column_stack([out, flat])
        along = np.column_stack([-out[:, 1], out[:, 0], flat])
        sight = self.camera - centre
        sight -= np.einsum("sk,sk->s", sight, along)[:, None] * along
        depth = np.linalg.norm(sight, axis=1, keepdims=True)
        toward = sight / depth
        aside = across - np.einsum("sk,sk->s", across, toward)[:, None] * toward
        aside /= np.linalg.norm(aside, axis=1, keepdims=True)
        half = outline.half[:, None]
        sine = half / depth
        cosine = np.sqrt(1.0 - sine**2)
        rims = [centre + half * (sine * toward + s * cosine * aside) for s in (-1.0, 1.0)]
        return self._seen(np.stack(rims))

    def _seen(self, points: FloatArray) -> FloatArray:
        share = self.camera[2] / (self.camera[2] - points[..., 2:])
        spots = self.camera[:2] + (points[..., :2] - self.camera[:2]) * share
        return self.view.picture_of(spots)
