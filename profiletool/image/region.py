"""Which pixels are the object, roughly: to a pixel or two, but the right thing and all of it."""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.errors import NoObject
from profiletool.image.ground import BoolImage, FloatImage, Ground
from profiletool.image.masks import connected_to, edges_touched, fill_holes, window_of
from profiletool.image.shadow import edge_strength, refuse_faded, without_shadow

_ADVICE = "photograph one object on a plain ground of another colour"
_MIN_SHARE = 2e-3  # of the frame: smaller regions are specks
_ALIKE = 0.4  # a second region of this part of the largest's area is another object
_FULL_EDGE = 0.9  # a region along this much of a frame edge is ground
_WHOLE_FRAME = 0.95
_FAINT_RIM = 0.015  # widest gap in a rim, half of it, of the object's size


def choose_object(mask: BoolImage) -> BoolImage:
    """Choose the one object among the regions of a mask, and fill its holes.

    Parameters
    ----------
    mask : (H, W)
        Everything that is not ground.

    Raises
    ------
    NoObject
        There is none, there are several alike, or it covers the whole frame.
    """
    if mask.mean() > _WHOLE_FRAME:
        raise NoObject(
            f"the object covers the whole picture; leave some ground round it, {_ADVICE}"
        )
    filled = fill_holes(mask)
    count, labels, stats, centres = cv2.connectedComponentsWithStats(
        filled.view(np.uint8), connectivity=4
    )
    smallest = max(16.0, _MIN_SHARE * mask.size)
    regions = [k for k in range(1, count) if stats[k, cv2.CC_STAT_AREA] >= smallest]
    regions = [k for k in regions if not _is_ground(labels == k)]
    if not regions:
        raise NoObject(f"no object found in the picture; {_ADVICE}")
    inside = [k for k in regions if not edges_touched(labels == k)]
    areas = {k: float(stats[k, cv2.CC_STAT_AREA]) for k in regions}
    largest = max(areas.values())
    if inside and max(areas[k] for k in inside) > 0.1 * largest:
        alike = sum(areas[k] >= _ALIKE * max(areas[j] for j in inside) for k in inside)
        if alike > 1:
            raise NoObject(f"{alike} objects alike in the picture; {_ADVICE}")
        regions = inside
    middle = np.array([mask.shape[1], mask.shape[0]]) / 2.0
    reach = float(np.hypot(*middle))

    def merit(k: int) -> float:
        return areas[k] * (1.5 - float(np.hypot(*(centres[k] - middle))) / reach)

    return np.asarray(labels == max(regions, key=merit))


def _is_ground(region: BoolImage) -> bool:
    """Whether a region runs along the frame as a table's edge or a wall does."""
    sides = (region[0], region[-1], region[:, 0], region[:, -1])
    return any(side.mean() > _FULL_EDGE for side in sides) or len(edges_touched(region)) > 3


def region_on_ground(lab: FloatImage, ground: Ground) -> BoolImage:
    """Find what stands out from a plain ground, without the soft shadow it casts.

    Parameters
    ----------
    lab : (H, W, 3)
        Picture in CIE Lab, lightly blurred.
    ground : Ground
        Fitted to the same picture.

    Raises
    ------
    NoObject
        As `choose_object`.
    """
    low = max(2.5, 1.3 * ground.noise)
    marked = ground.distance > low
    # Hysteresis: a region counts when some part of it stands out clearly.
    region = choose_object(_closed(connected_to(ground.distance > 1.6 * low, marked)))
    window = window_of(region, margin=6)
    cut = replace(ground, surface=ground.surface[window], distance=ground.distance[window])
    whole = _sealed(region[window])
    region[window] = _tightened(_sealed(without_shadow(whole, lab[window], cut)), cut)
    return region


def _tightened(region: BoolImage, ground: Ground) -> BoolImage:
    """Draw an outline in from where the object's blur ends to about its half height."""
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (7, 7))
    core = cv2.erode(region.view(np.uint8), disc, borderType=cv2.BORDER_REPLICATE) > 0
    height = cv2.dilate(np.where(region, ground.distance, 0), disc)
    return np.asarray(core | (region & (ground.distance > 0.4 * height)))


def _sealed(region: BoolImage) -> BoolImage:
    """Fill bays whose mouth is narrow: there the rim is only too faint to be seen."""
    radius = max(1, round(_FAINT_RIM * math.sqrt(region.sum())))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
    padded = np.pad(region, 2 * radius).view(np.uint8)
    closed = cv2.morphologyEx(padded, cv2.MORPH_CLOSE, disc) > 0
    closed = closed[2 * radius : -2 * radius, 2 * radius : -2 * radius]
    filled = fill_holes(closed)
    bays = (filled & ~closed).view(np.uint8)
    return region | (filled & (cv2.dilate(bays, disc) > 0))


def _closed(mask: BoolImage) -> BoolImage:
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (3, 3))
    padded = np.pad(mask, 2).view(np.uint8)
    return np.asarray(cv2.morphologyEx(padded, cv2.MORPH_CLOSE, disc)[2:-2, 2:-2] > 0)


def grabcut_region(
    rgb: NDArray[np.uint8], lab: FloatImage, distance: FloatImage, barred: BoolImage
) -> BoolImage:
    """Separate by colour mixtures where no plain ground explains the border.

    Parameters
    ----------
    rgb, lab : (H, W, 3)
        The picture, 8 bit and in CIE Lab.
    distance : (H, W)
        A first guess: what is far from the ground is probably object.
    barred : (H, W)
        Pixels that are ground for certain.

    Raises
    ------
    NoObject
        As `choose_object`, or what is found is too small or too large to be trusted.
    """
    far = distance / max(float(np.quantile(distance, 0.99)), 1e-6)
    level, _ = cv2.threshold(
        np.clip(far * 255, 0, 255).astype(np.uint8), 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU
    )
    height, width = far.shape
    labels = np.where(far * 255 > level, cv2.GC_PR_FGD, cv2.GC_PR_BGD).astype(np.uint8)
    margin = max(2, round(0.03 * min(height, width)))
    frame = np.ones(far.shape, bool)
    frame[margin:-margin, margin:-margin] = False
    labels[frame | barred] = cv2.GC_BGD
    if not (labels == cv2.GC_PR_FGD).any():
        raise NoObject(f"no object found in the picture; {_ADVICE}")
    cv2.setRNGSeed(0)  # its colour clusters start from random ones
    models = np.zeros((1, 65)), np.zeros((1, 65))
    cv2.grabCut(
        np.ascontiguousarray(rgb[..., ::-1]),
        labels,
        (0, 0, 1, 1),  # unused with a mask
        models[0],
        models[1],
        4,
        cv2.GC_INIT_WITH_MASK,
    )
    found = np.isin(labels, (cv2.GC_FGD, cv2.GC_PR_FGD))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (5, 5))
    opened = cv2.morphologyEx(found.view(np.uint8), cv2.MORPH_OPEN, disc) > 0
    region = choose_object(opened)
    if not 0.01 < region.mean() < 0.8:
        raise NoObject(f"the object cannot be told from the ground; {_ADVICE}")
    refuse_faded(region, edge_strength(lab))
    return region
