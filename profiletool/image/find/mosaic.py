"""A picture as a mosaic of small patches that keep to its edges, and cuts of it by colour."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

from profiletool.image.find.colours import cells, histogram
from profiletool.image.find.ground import BoolImage, FloatImage
from profiletool.image.find.masks import largest_filled, window_of

_PATCH_PX = 6  # between the seeds of two patches
_STIFF = 12.0  # what a pixel of a cut costs where it follows no edge
_LIKELIEST = 4.0  # logarithm of odds that one pixel's colour counts for at most
_FLOOR = 1e-4
_UNIT = 64.0  # capacities are whole numbers
_FIRMEST = 1_000_000_000
_RING_SHARE, _NEAR_SHARE = 0.05, 0.3  # of a region's size: of the open ring, of the ground near it
_LEAST_SIZE = 8.0


@dataclass(frozen=True)
class Mosaic:
    """Patches of a picture and what parting two neighbours costs.

    Attributes
    ----------
    patch : (H, W) int32
        The patch of every pixel.
    cell : (H, W) int32
        The cell of every pixel's colour, as `colours.cells` numbers them.
    size : (P,)
        Pixels of every patch.
    pairs : (E, 2)
        Neighbours.
    bond : (E,)
        What parting them costs.
    """

    patch: NDArray[np.int32]
    cell: NDArray[np.int32]
    size: NDArray[np.float64]
    pairs: NDArray[np.int64]
    bond: NDArray[np.float64]

    def share(self, mask: BoolImage) -> NDArray[np.float64]:
        """Share of every patch that a mask (H, W) covers."""
        counts = np.bincount(self.patch[mask], minlength=len(self.size))
        return np.asarray(counts / self.size)


def mosaic_of(lab: FloatImage, patch_px: int = _PATCH_PX) -> Mosaic:
    """Lay out the patches of a picture (H, W, 3) in CIE Lab, about so large."""
    steep = _steepness(lab)
    seeds = _seeds(steep, patch_px)
    relief = np.clip(steep * 8.0, 0, 255).astype(np.uint8)
    flooded = np.asarray(cv2.watershed(np.dstack([relief] * 3), seeds), np.int32)
    return _laid_out(lab, _without_seams(flooded))


def ring_mosaic(lab: FloatImage, inner: BoolImage, outer: BoolImage) -> Mosaic:
    """Lay out the pixels between two masks one by one, with a patch within and one beyond."""
    patch = np.full(inner.shape, 1, np.int32)
    patch[inner] = 0
    open_ = outer & ~inner
    patch[open_] = np.arange(2, 2 + int(open_.sum()))
    return _laid_out(lab, patch)


def _laid_out(lab: FloatImage, patch: NDArray[np.int32]) -> Mosaic:
    size = np.bincount(patch.ravel()).astype(np.float64)
    pairs, bond = _bonds(patch, lab)
    return Mosaic(patch, cells(lab), np.maximum(size, 1.0), pairs, bond)


def _steepness(lab: FloatImage) -> FloatImage:
    along = [cv2.Sobel(lab, cv2.CV_32F, *way, scale=0.125) for way in ((1, 0), (0, 1))]
    return np.asarray(np.sqrt(sum((step**2).sum(axis=2) for step in along)), np.float32)


def _seeds(steep: FloatImage, side: int) -> NDArray[np.int32]:
    """Give the calmest pixel of every square of a grid a number."""
    height, width = steep.shape
    rows, columns = -(-height // side), -(-width // side)
    margin = (0, rows * side - height), (0, columns * side - width)
    whole = np.pad(steep, margin, constant_values=np.inf)
    squares = whole.reshape(rows, side, columns, side).swapaxes(1, 2)
    calmest = squares.reshape(rows, columns, -1).argmin(axis=2)
    v = np.arange(rows)[:, None] * side + calmest // side
    u = np.arange(columns)[None] * side + calmest % side
    seeds = np.zeros((height, width), np.int32)
    seeds[v, u] = np.arange(1, rows * columns + 1).reshape(rows, columns)
    return seeds


def _without_seams(flooded: NDArray[np.int32]) -> NDArray[np.int32]:
    """Give every seam pixel to a patch beside it, and number the patches from 0."""
    patch = flooded.copy()
    while (seam := patch < 1).any():
        grown = cv2.dilate(patch.astype(np.float32), np.ones((3, 3), np.uint8))
        patch[seam] = grown[seam].astype(np.int32)
    numbers = np.unique(patch, return_inverse=True)[1]
    return np.asarray(numbers.reshape(patch.shape), np.int32)


def _bonds(
    patch: NDArray[np.int32], lab: FloatImage
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Neighbours, and what all pairs of pixels on their common border cost to part."""
    sides = ((patch[:, 1:], patch[:, :-1]), (patch[1:], patch[:-1]))
    steps = [
        ((one - other) ** 2).sum(axis=2)
        for one, other in ((lab[:, 1:], lab[:, :-1]), (lab[1:], lab[:-1]))
    ]
    typical = max(float(np.mean([step.mean() for step in steps])), 1e-3)
    keys, costs = [], []
    count = int(patch.max()) + 1
    for (one, other), step in zip(sides, steps, strict=True):
        apart = one != other
        low, high = np.minimum(one, other)[apart], np.maximum(one, other)[apart]
        keys.append(low.astype(np.int64) * count + high)
        costs.append(np.exp(-step[apart] / (2.0 * typical)).astype(np.float64))
    key, place = np.unique(np.concatenate(keys), return_inverse=True)
    cost = np.bincount(place, weights=np.concatenate(costs))
    pairs = np.stack([key // count, key % count], axis=1)
    return np.asarray(pairs, np.int64), np.asarray(_STIFF * cost, np.float64)


def cut(
    mosaic: Mosaic, guess: BoolImage, ground: BoolImage, core: BoolImage | None = None,
    near: BoolImage | None = None, rounds: int = 4,
) -> BoolImage:  # fmt: skip
    """Part object and ground by their colours, along edges; all masks are (H, W).

    Parameters
    ----------
    mosaic : Mosaic
    guess : where the object may be, whose colours the search starts from
    ground, core : where there is none, and where it is, for certain
    near : where the ground is looked at; None for everywhere
    rounds : int
        Colours are taken anew each time.
    """
    patch = mosaic.patch
    barred = mosaic.share(ground) > 0.5
    kept = np.zeros(len(barred), bool) if core is None else mosaic.share(core) > 0.5
    inside = ((mosaic.share(guess) > 0.5) | kept) & ~barred
    for _ in range(rounds):
        mask = inside[patch]
        seen = ~mask if near is None else ~mask & near
        if not mask.any() or not seen.any():
            break
        odds = _odds(mosaic, mask, seen)
        parted = _parted(mosaic, np.where(barred, -_FIRMEST, np.where(kept, _FIRMEST, odds)))
        if np.array_equal(parted, inside):
            break
        inside = parted
    return np.asarray(inside[patch])


def _odds(mosaic: Mosaic, mask: BoolImage, seen: BoolImage) -> NDArray[np.float64]:
    """How much likelier the colours of every patch are inside than outside, as a logarithm."""
    one, other = histogram(mosaic.cell, mask), histogram(mosaic.cell, seen)
    odds = np.clip(np.log((one + _FLOOR) / (other + _FLOOR)), -_LIKELIEST, _LIKELIEST)
    total = np.bincount(
        mosaic.patch.ravel(), weights=odds[mosaic.cell].ravel(), minlength=len(mosaic.size)
    )
    return np.asarray(total)


def _parted(mosaic: Mosaic, odds: NDArray[np.float64]) -> BoolImage:
    """Find the least cut between patches that are likelier inside and those that are not."""
    count = len(odds)
    source, sink = count, count + 1
    i, j = mosaic.pairs.T
    gain = np.clip(odds * _UNIT, -_FIRMEST, _FIRMEST)
    places = np.arange(count)
    bond = mosaic.bond * _UNIT
    rows = np.concatenate([i, j, np.full(count, source), places])
    columns = np.concatenate([j, i, places, np.full(count, sink)])
    capacity = np.concatenate([bond, bond, np.maximum(gain, 0.0), np.maximum(-gain, 0.0)])
    table = coo_array(
        (np.round(capacity).astype(np.int32), (rows, columns)), shape=(count + 2, count + 2)
    ).tocsr()
    left = table - maximum_flow(table, source, sink).flow
    left.data = np.maximum(left.data, 0)
    left.eliminate_zeros()
    reached = breadth_first_order(left, source, return_predecessors=False)
    inside = np.zeros(count + 2, bool)
    inside[reached] = True
    return np.asarray(inside[:count])


def polished(lab: FloatImage, mask: BoolImage, share: float = _RING_SHARE) -> BoolImage:
    """Draw a mask's outline anew, pixel by pixel, by the colours on both sides of it.

    Its core and all that is farther off stay what they are; between them lies an open ring.

    Parameters
    ----------
    lab : (H, W, 3)
    mask : (H, W)
        One region.
    share : float
        Width of the ring either way, of the region's size.
    """
    size = float(np.sqrt(mask.sum()))
    if size < _LEAST_SIZE:
        return mask
    reach, near = max(2, round(share * size)), max(6, round(_NEAR_SHARE * size))
    window = window_of(mask, near + 1)
    lab, whole = lab[window], mask[window]
    for _ in range(2):
        if not whole.any() or whole.all():
            return mask
        deep = cv2.distanceTransform(whole.view(np.uint8), cv2.DIST_L2, 3)
        off = cv2.distanceTransform((~whole).view(np.uint8), cv2.DIST_L2, 3)
        core, outside = deep > min(reach, max(2.0, 0.5 * float(deep.max()))), off > reach
        ring = ring_mosaic(lab, core, ~outside)
        whole = largest_filled(cut(ring, whole, outside, core, off <= near, rounds=2))
    drawn = np.zeros(mask.shape, bool)
    drawn[window] = whole
    return drawn
