"""A map of what is not connected to the frame by paths of its own colour."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from profiletool.image.find.ground import FloatImage
from profiletool.image.find.mosaic import Mosaic, mosaic_of
from profiletool.records.units import FloatArray

_PATCHES = 300
# W. Zhu et al., Saliency optimization from robust background detection, CVPR 2014, and what it
# sets: how alike two colours are (Lab), how near two patches (of the longer side), and how much
# ground, object and neighbours count.
_ALIKE, _NEAR = 10.0, 0.4
_AS_GROUND, _AS_OBJECT, _AT_LEAST = 5.0, 1.0, 0.1


def unconnected(lab: FloatImage) -> FloatImage:
    """How little of every patch of a picture (H, W, 3) in CIE Lab belongs to the frame, (H, W)."""
    height, width = lab.shape[:2]
    mosaic = mosaic_of(lab, max(6, round(float(np.sqrt(height * width / _PATCHES)))))
    patch = mosaic.patch
    apart = _apart(_means(mosaic, lab))
    at_frame = np.zeros(len(mosaic.size), bool)
    at_frame[np.concatenate([patch[0], patch[-1], patch[:, 0], patch[:, -1]])] = True
    beside = np.zeros(apart.shape, bool)
    beside[tuple(mosaic.pairs.T)] = True
    beside |= beside.T | (at_frame[:, None] & at_frame)
    np.fill_diagonal(beside, False)
    ground = _groundlike(apart, beside, at_frame)
    v, u = np.mgrid[:height, :width].astype(np.float32) / np.float32(max(height, width))
    far = _apart(_means(mosaic, np.dstack([u, v])))
    strange = _spread(np.asarray((apart * np.exp(-(far**2) / (2.0 * _NEAR**2))) @ ground))
    bond = np.where(beside, np.exp(-(apart**2) / (2.0 * _ALIKE**2)) + _AT_LEAST, 0.0)
    held = np.diag(_AS_GROUND * ground + _AS_OBJECT * strange + 1e-3)
    stiffness = held + np.diag(bond.sum(axis=1)) - bond
    smooth = np.asarray(np.linalg.solve(stiffness, _AS_OBJECT * strange))
    return np.asarray(_spread(smooth)[patch], np.float32)


def _groundlike(
    apart: FloatArray, beside: NDArray[np.bool_], at_frame: NDArray[np.bool_]
) -> FloatArray:
    """How much of the region of a patch's own colour lies along the frame, 0 to 1."""
    nearest = np.where(beside, apart, np.inf).min(axis=1)
    step = np.where(beside, np.maximum(apart - nearest[np.isfinite(nearest)].mean(), 1e-4), 0.0)
    way = dijkstra(coo_array(step).tocsr(), directed=False)
    one = np.exp(-(way**2) / (2.0 * _ALIKE**2))
    length = one[:, at_frame].sum(axis=1) / np.sqrt(one.sum(axis=1))
    return np.asarray(1.0 - np.exp(-(length**2) / 2.0))


def _means(mosaic: Mosaic, image: FloatImage) -> FloatArray:
    """Mean of an (H, W, C) image over every patch, (P, C)."""
    flat = mosaic.patch.ravel()
    planes = np.moveaxis(image, 2, 0)
    sums = [np.bincount(flat, plane.ravel(), len(mosaic.size)) for plane in planes]
    return np.stack(sums, axis=1) / mosaic.size[:, None]


def _apart(points: FloatArray) -> FloatArray:
    return np.asarray(np.linalg.norm(points[:, None] - points, axis=2))


def _spread(values: FloatArray) -> FloatArray:
    return np.asarray((values - values.min()) / max(float(np.ptp(values)), 1e-6))
