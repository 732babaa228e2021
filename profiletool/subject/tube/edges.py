"""Edges of a tube in a picture: where across a predicted line its colour changes, sub-pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from profiletool.records.units import BoolArray, Float32, FloatArray, IntArray

_STEP_PX = 0.5  # of the samples across a line
_BLUR_PX = 1.0  # of the derivative: what is finer is grain
_ALONG_PX = (-2.5, -1.25, 0.0, 1.25, 2.5)  # over which a sample is averaged along the line
_CLEAR = 4.0  # noises of the picture, that an edge must rise above
_PEAKS = 4  # that are looked at across a place, where a line's edge is chosen by the other's
_WIDTHS = 3.0  # standard deviations that a tube's width may be off
_FAINT = 0.4  # of the usual rise along a line: what is less is texture


@dataclass(frozen=True)
class Edges:
    """Edges across N places of a line.

    Attributes
    ----------
    off : (N,) px
        From the predicted place, outward.
    rise : (N,)
        Of the colour, in levels a pixel.
    seen : (N,) bool
        Whether it is an edge at all.
    """

    off: FloatArray
    rise: FloatArray
    seen: BoolArray


@dataclass(frozen=True)
class Shown:
    """A picture as edges are looked for in it.

    Attributes
    ----------
    colour : (H, W, 3) float32
    noise : float
        Standard deviation of the rise that grain alone makes.
    """

    colour: Float32
    noise: float

    @property
    def size(self) -> FloatArray:
        """Width and height, px."""
        return np.array(self.colour.shape[1::-1], float)

    def inside(self, px: FloatArray, margin: float = 2.0) -> BoolArray:
        """Whether points (..., 2) lie in the picture."""
        return np.asarray(((px >= margin) & (px <= self.size - 1.0 - margin)).all(axis=-1))


def shown(rgb: NDArray[np.uint8]) -> Shown:
    """Prepare a picture (H, W, 3) for `edges_across`."""
    colour = rgb.astype(np.float32)
    grey = colour.mean(axis=2)
    # Second differences of neighbours: of grain they are mostly made, where edges are few.
    rough = np.abs(grey[1:-1, 2:] - 2.0 * grey[1:-1, 1:-1] + grey[1:-1, :-2])
    grain = float(np.median(rough)) / 0.6745 / np.sqrt(6.0)
    return Shown(colour, max(grain, 0.3) * 0.35)


def edges_across(
    picture: Shown, px: FloatArray, normal: FloatArray, reach: float, trusted: float
) -> Edges:
    """Find the strongest change of colour across a line, the nearest of those alike.

    Parameters
    ----------
    picture : Shown
    px, normal : (N, 2)
        Places, and unit vectors outward.
    reach : float, px
        How far to look, both ways.
    trusted : float, px
        Standard deviation of the predicted place.
    """
    return _peaks_across(picture, px, normal, reach, trusted).first()


def edge_pairs(
    picture: Shown, px: FloatArray, normal: FloatArray, reach: float, trusted: float, width: float
) -> tuple[Edges, Edges]:
    """Find the edges across both lines of a tube, together: as far apart as the tube is wide.

    What lies beside the tube, as an object's edge, or a thread in it, makes edges of another
    distance. Where no two edges fit, neither is believed.

    Parameters
    ----------
    picture, reach, trusted
        As in `edges_across`.
    px, normal : (2, N, 2)
        Places of both lines, and unit vectors outward.
    width : float, px
        Standard deviation of the tube's width from place to place.
    """
    one, other = (
        _peaks_across(picture, at, out, reach, trusted) for at, out in zip(px, normal, strict=True)
    )
    a, b = one.first(), other.first()
    both = a.seen & b.seen
    usual = float(np.median((a.off + b.off)[both])) if both.any() else 0.0
    excess = one.off[:, :, None] + other.off[:, None, :] - usual
    known = (one.score > 0.0)[:, :, None] & (other.score > 0.0)[:, None, :]
    fits = known & (np.abs(excess) < _WIDTHS * width)
    worth = (one.score[:, :, None] + other.score[:, None, :]) * np.exp(-0.5 * (excess / width) ** 2)
    best = np.where(fits, worth, 0.0).reshape(len(excess), -1).argmax(axis=1)
    alone = ~known.any(axis=(1, 2))  # a line whose other has no edge is taken as it is
    wanted = np.asarray(fits.any(axis=(1, 2)) | alone)
    i, j = np.divmod(best, _PEAKS)
    return one.chosen(i, wanted), other.chosen(j, wanted)


@dataclass(frozen=True)
class _Peaks:
    """The changes of colour across N places of a line, the likeliest first.

    Attributes
    ----------
    off, rise : (N, K)
        As in `Edges`.
    score : (N, K)
        0 where there is no edge.
    """

    off: FloatArray
    rise: FloatArray
    score: FloatArray

    def first(self) -> Edges:
        """Take the likeliest."""
        return self.chosen(np.zeros(len(self.off), np.int64), np.ones(len(self.off), bool))

    def chosen(self, k: IntArray, wanted: BoolArray) -> Edges:
        """Take one at every place."""
        rows = np.arange(len(k))
        return Edges(self.off[rows, k], self.rise[rows, k], wanted & (self.score[rows, k] > 0.0))


def _peaks_across(
    picture: Shown, px: FloatArray, normal: FloatArray, reach: float, trusted: float
) -> _Peaks:
    count = int(np.ceil(reach / _STEP_PX))
    places = np.asarray(_STEP_PX * np.arange(-count - 4, count + 5), np.float64)
    profile = _profiles(picture, px, normal, places)
    slope = np.gradient(_smooth(profile), _STEP_PX, axis=1)
    rise = np.sqrt((slope**2).sum(axis=2))
    span = np.s_[4 : len(places) - 4]
    peak = (rise[:, 4:-4] >= rise[:, 3:-5]) & (rise[:, 4:-4] > rise[:, 5:-3])
    near = np.exp(-0.5 * (places[span] / trusted) ** 2)
    score = np.where(peak, rise[:, span] * near, 0.0)
    k = np.argsort(-score, axis=1, kind="stable")[:, :_PEAKS]
    rows = np.arange(len(px))[:, None]
    score = score[rows, k]
    k = k + 4
    low, top, high = (rise[rows, k + d] for d in (-1, 0, 1))
    curve = low - 2.0 * top + high
    shift = np.where(curve < 0.0, 0.5 * (low - high) / np.where(curve < 0.0, curve, 1.0), 0.0)
    off = places[k] + _STEP_PX * np.clip(shift, -1.0, 1.0)
    clear = top[:, 0] > _CLEAR * picture.noise
    usual = float(np.median(top[clear, 0])) if clear.any() else 0.0
    enough = max(_CLEAR * picture.noise, _FAINT * usual)
    seen = (top > enough) & (np.abs(off) <= reach)
    seen &= picture.inside(px[:, None] + off[..., None] * normal[:, None])
    return _Peaks(off, top, np.where(seen, score, 0.0))


def _profiles(picture: Shown, px: FloatArray, normal: FloatArray, places: FloatArray) -> FloatArray:
    """Colours across a line, averaged a little along it: (N, M, 3)."""
    tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
    total = np.zeros((len(px), len(places), 3))
    for shift in _ALONG_PX:
        spots = (px + shift * tangent)[:, None] + places[None, :, None] * normal[:, None]
        total += sampled(picture.colour, spots)
    return total / len(_ALONG_PX)


def sampled(image: Float32, px: FloatArray) -> FloatArray:
    """Interpolate an image (H, W, C) at points (..., 2) px; beyond it counts its border: (..., C).

    OpenCV's remap leaves the ends of odd rows as they were in memory (5.0.0).
    """
    h, w = image.shape[:2]
    x = np.clip(px[..., 0], 0.0, w - 1.001)
    y = np.clip(px[..., 1], 0.0, h - 1.001)
    i, j = x.astype(np.int64), y.astype(np.int64)
    a, b = (x - i)[..., None], (y - j)[..., None]
    top = (1.0 - a) * image[j, i] + a * image[j, i + 1]
    low = (1.0 - a) * image[j + 1, i] + a * image[j + 1, i + 1]
    return np.asarray((1.0 - b) * top + b * low)


def _smooth(profile: FloatArray) -> FloatArray:
    reach = int(np.ceil(3.0 * _BLUR_PX / _STEP_PX))
    kernel = np.exp(-0.5 * (_STEP_PX * np.arange(-reach, reach + 1) / _BLUR_PX) ** 2)
    kernel /= kernel.sum()
    padded = np.pad(profile, ((0, 0), (reach, reach), (0, 0)), mode="edge")
    return np.asarray(
        sum(w * padded[:, k : k + profile.shape[1]] for k, w in enumerate(kernel.tolist()))
    )
