"""The tube found in a picture, wherever it lies: its outline laid over all edges at once.

The edges' structure tensor, normalised, makes the fit of an outline at every place a sum of three
correlations, which the fast Fourier transform finds for all places together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import fft

from profiletool.records.units import BoolArray, Float32, FloatArray
from profiletool.subject.tube.camera import Place
from profiletool.subject.tube.edges import sampled
from profiletool.subject.tube.family import Family

COARSE_MM, FINE_MM = 2.0, 1.0  # a pixel of the pictures that are searched
_TURNS = 90  # headings that are tried all around
_BEST, _MANY = 10, 120  # of the coarse places, that are looked at closely: all, and some allowed
_STEP_MM = 1.0  # of an outline's points


@dataclass(frozen=True)
class Found:
    """A place, the model's pressure there (bar), and the share of the outline on edges."""

    place: Place
    bar: float
    score: float


@dataclass(frozen=True)
class Plane:
    """A picture of the tube's plane, seen squarely.

    Attributes
    ----------
    rgb : (H, W, 3) uint8
    mm_per_px : float
    origin : (2,) mm
        Of the picture's first pixel in the plane.
    right : (2,)
        Unit vector of the picture's x in the plane; y is a quarter turn clockwise on.
    """

    rgb: NDArray[np.uint8]
    mm_per_px: float
    origin: FloatArray
    right: FloatArray

    def shrunk(self, mm_per_px: float) -> NDArray[np.uint8]:
        """Give the picture at another scale."""
        share = self.mm_per_px / mm_per_px
        h, w = self.rgb.shape[:2]
        size = max(1, round(w * share)), max(1, round(h * share))
        return np.asarray(cv2.resize(self.rgb, size, interpolation=cv2.INTER_AREA), np.uint8)

    def place(self, x: float, y: float, heading: float, hand: float) -> Place:
        """Bring a place from the picture, mm from its first pixel, into the plane."""
        down = np.array([-self.right[1], self.right[0]])
        at = self.origin + x * self.right + y * down
        turn = float(np.arctan2(self.right[1], self.right[0]))
        return Place(float(at[0]), float(at[1]), heading + turn, hand)

    def seen(self, points: FloatArray) -> FloatArray:
        """Bring points (..., 2) of the plane into the picture, mm from its first pixel."""
        down = np.array([-self.right[1], self.right[0]])
        off = points - self.origin
        return np.stack([off @ self.right, off @ down], axis=-1)


def find_tube(
    plane: Plane,
    family: Family,
    bars: Sequence[float],
    hands: Sequence[float],
    allowed: NDArray[np.bool_] | None = None,
    point: FloatArray | None = None,
) -> list[Found]:
    """Find where a tube lies, the likeliest first; empty where none fits in the picture.

    Parameters
    ----------
    plane : Plane
    family : Family
    bars : sequence of float
        The model's pressures that are tried.
    hands : sequence of float
        As in `Place`.
    allowed : (H, W) bool, optional
        Where in the picture it may lie.
    point : (2,), optional
        In the picture, px, that the tube covers.
    """
    coarse = _tensor(plane.shrunk(COARSE_MM))
    shapes = [(bar, hand, *_outline(family, bar)) for bar in bars for hand in hands]
    headings = 2.0 * np.pi * np.arange(_TURNS) / _TURNS
    spectrum = _spectrum(coarse)
    found: list[tuple[float, float, float, float, float, float]] = []
    for bar, hand, points, normals in shapes:
        for heading in headings:
            place = Place(0.0, 0.0, float(heading), hand)
            score = _scores(spectrum, place(points) / COARSE_MM, place(normals), coarse.shape[1:])
            if score is None:
                continue
            offset, values = score
            y, x = np.unravel_index(int(values.argmax()), values.shape)
            at = (np.array([x, y]) + offset) * COARSE_MM
            found.append((float(values.max()), bar, hand, float(heading), at[0], at[1]))
    found.sort(reverse=True)
    fine = _tensor(plane.shrunk(FINE_MM))
    limits = None if allowed is None else _shrunk_mask(allowed, fine.shape[1:])
    spot = None if point is None else np.asarray(point) * plane.mm_per_px
    wide = _BEST if spot is None and limits is None else _MANY
    best = [_closer(fine, family, one, limits, spot) for one in found[:wide]]
    ranked = sorted((one for one in best if one[0] > 0.0), reverse=True)
    return [
        Found(plane.place(x, y, heading, hand), bar, score)
        for score, bar, hand, heading, x, y in ranked
    ]


Candidate = tuple[float, float, float, float, float, float]


def _outline(family: Family, bar: float) -> tuple[FloatArray, FloatArray]:
    """Points of both lines and of the end, with their normals, (N, 2) each."""
    none = np.zeros(family.joints)
    line = family.outline(bar, none, none)
    step = max(1, round(_STEP_MM / float(family.along[1] - family.along[0])))
    some = np.s_[2 * step :: step]
    off = (line.half[:, None] * line.out)[some]
    axis, out = line.axis[some], line.out[some]
    tip = np.array([-out[-1, 1], out[-1, 0]])
    cap = line.axis[-1] + np.linspace(-0.9, 0.9, 19)[:, None] * off[-1]
    points = np.concatenate([axis - off, axis + off, cap])
    return points, np.concatenate([out, out, np.repeat(tip[None], len(cap), axis=0)])


def _tensor(rgb: NDArray[np.uint8]) -> Float32:
    """Structure of the edges, each about 1 where it is sure: (3, H, W) of xx, xy, yy."""
    colour = cv2.GaussianBlur(rgb.astype(np.float32), (0, 0), 0.8)
    parts = []
    for channel in range(3):
        gx, gy = (
            cv2.Sobel(colour[..., channel], cv2.CV_32F, *way, scale=0.125)
            for way in ((1, 0), (0, 1))
        )
        parts.append(np.stack([gx * gx, gx * gy, gy * gy]))
    tensor = np.sum(parts, axis=0)
    size = tensor[0] + tensor[2]
    enough = 4.0 * float(np.median(size)) + 4.0
    tensor /= size + enough
    return np.stack([cv2.GaussianBlur(part, (0, 0), 0.8) for part in tensor]).astype(np.float32)


def _spectrum(tensor: Float32) -> NDArray[np.complex64]:
    size = [fft.next_fast_len(side, real=True) for side in tensor.shape[1:]]
    return np.asarray(fft.rfft2(tensor, s=size, axes=(1, 2)), np.complex64)


def _scores(
    spectrum: NDArray[np.complex64], points: FloatArray, normals: FloatArray, size: tuple[int, ...]
) -> tuple[FloatArray, FloatArray] | None:
    """Fit at every place where the whole outline lies in the picture; None where it never does."""
    low, high = points.min(axis=0), points.max(axis=0)
    room = np.array(size[::-1]) - 1 - np.ceil(high - low).astype(int)
    if (room < 1).any():
        return None
    at = np.round(points - low).astype(int)
    cell, cells = at[:, 1] * size[1] + at[:, 0], size[0] * size[1]
    nx, ny = normals.T
    weights = np.stack(
        [np.bincount(cell, w, cells) for w in (nx * nx, 2.0 * nx * ny, ny * ny)]
    ).astype(np.float32)
    product = (spectrum * np.conj(_spectrum(weights.reshape(3, *size)))).sum(axis=0)
    padded = [fft.next_fast_len(side, real=True) for side in size]
    whole = fft.irfft2(product, s=padded)
    values: FloatArray = whole[: room[1], : room[0]] / len(points)
    return -low, values


def _score(
    tensor: Float32, points: FloatArray, normals: FloatArray, limits: BoolArray | None
) -> float:
    """Fit of an outline at one place, its points (N, 2) in pixels."""
    xx, xy, yy = sampled(np.moveaxis(tensor, 0, -1), points).T
    nx, ny = normals.T
    values = xx * nx * nx + 2.0 * xy * nx * ny + yy * ny * ny
    size = np.array(tensor.shape[:0:-1])
    values = np.where(((points >= 0.0) & (points <= size - 1.0)).all(axis=1), values, 0.0)
    if limits is not None:
        x, y = np.clip(np.round(points).astype(int), 0, np.array(limits.shape[::-1]) - 1).T
        values = np.where(limits[y, x], values, 0.0)
    return float(values.mean())


def _closer(
    tensor: Float32,
    family: Family,
    one: Candidate,
    limits: BoolArray | None,
    spot: FloatArray | None,
) -> Candidate:
    """Better a place by small steps in all that it has, each half of the last."""
    _, bar, hand, heading, x, y = one
    values = np.array([bar, heading, x, y])
    steps = np.array([0.05 * family.top, np.radians(2.0), COARSE_MM, COARSE_MM])
    shapes: dict[float, tuple[FloatArray, FloatArray]] = {}

    def score(at: FloatArray) -> float:
        key = float(at[0])
        points, normals = shapes.setdefault(key, _outline(family, key))
        place = Place(float(at[2]), float(at[3]), float(at[1]), hand)
        return _score(tensor, (place(points) + place.point) / FINE_MM, place(normals), limits)

    best = score(values)
    for _ in range(4):
        for k in (2, 3, 1, 0, 2, 3, 1):
            for way in (1.0, -1.0):
                trial = values.copy()
                trial[k] += way * steps[k]
                while 0.0 <= trial[0] <= family.top and (better := score(trial)) > best:
                    best, values = better, trial.copy()
                    trial[k] += way * steps[k]
        steps = 0.5 * steps
    if spot is not None:
        none = np.zeros(family.joints)
        place = Place(float(values[2]), float(values[3]), float(values[1]), hand)
        axis = place(family.outline(float(values[0]), none, none).axis) + place.point
        if np.linalg.norm(axis - spot, axis=1).min() > family.radius:
            best = 0.0
    return best, float(values[0]), hand, float(values[1]), float(values[2]), float(values[3])


def _shrunk_mask(mask: NDArray[np.bool_], size: tuple[int, ...]) -> BoolArray:
    small = cv2.resize(mask.view(np.uint8), (size[1], size[0]), interpolation=cv2.INTER_NEAREST)
    return np.asarray(small, bool)
