"""The pixels of the object, to a pixel or two: the right thing, and all of it."""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np

from profiletool.errors import NoObject
from profiletool.image.find.ground import BoolImage, FloatImage, Ground
from profiletool.image.find.masks import connected_to, edges_touched, fill_holes, window_of
from profiletool.image.find.shadow import without_shadow
from profiletool.records.request import Point

ADVICE = "photograph one object on a plain ground of another colour"
_MIN_SHARE = 2e-3  # of the frame: smaller regions are specks
ALIKE = 0.4  # a second region of this part of the largest's area is another object
_FULL_EDGE = 0.9  # a region along this much of a frame edge is ground
_WHOLE_FRAME = 0.95
_FAINT_RIM = 0.015  # widest gap in a rim, half of it, of the object's size


class SeveralAlike(NoObject):
    """Several objects alike; ``regions`` are their masks, (H, W) bool."""

    def __init__(self, regions: list[BoolImage]) -> None:
        super().__init__(f"{len(regions)} objects alike in the picture; {ADVICE}")
        self.regions = regions


def choose_object(mask: BoolImage, point: Point | None = None) -> BoolImage:
    """Choose the one object among the regions of a mask, and fill its holes.

    Parameters
    ----------
    mask : (H, W)
        Everything that is not ground.
    point : (x, y), or None
        Pixels; the object is the region that holds it.

    Raises
    ------
    NoObject
        There is none, there are several alike, or it covers the whole frame.
    """
    if mask.mean() > _WHOLE_FRAME:
        raise NoObject(f"the object covers the whole picture; leave some ground round it, {ADVICE}")
    filled = fill_holes(mask)
    if point is not None:
        return _region_at(filled, point)
    count, labels, stats, centres = cv2.connectedComponentsWithStats(
        filled.view(np.uint8), connectivity=4
    )
    smallest = max(16.0, _MIN_SHARE * mask.size)
    regions = [k for k in range(1, count) if stats[k, cv2.CC_STAT_AREA] >= smallest]
    regions = [k for k in regions if not _is_ground(labels == k)]
    if not regions:
        raise NoObject(f"no object found in the picture; {ADVICE}")
    inside = [k for k in regions if not edges_touched(labels == k)]
    areas = {k: float(stats[k, cv2.CC_STAT_AREA]) for k in regions}
    largest = max(areas.values())
    if inside and max(areas[k] for k in inside) > 0.1 * largest:
        alike = [k for k in inside if areas[k] >= ALIKE * max(areas[j] for j in inside)]
        if len(alike) > 1:
            raise SeveralAlike([np.asarray(labels == k) for k in alike])
        regions = inside
    middle = np.array([mask.shape[1], mask.shape[0]]) / 2.0
    reach = float(np.hypot(*middle))

    def merit(k: int) -> float:
        return areas[k] * (1.5 - float(np.hypot(*(centres[k] - middle))) / reach)

    return np.asarray(labels == max(regions, key=merit))


def pixel_at(point: Point, shape: tuple[int, ...]) -> tuple[int, int]:
    """Row and column of the pixel that holds a point of a picture (H, W)."""
    return min(round(point[1]), shape[0] - 1), min(round(point[0]), shape[1] - 1)


def _region_at(filled: BoolImage, point: Point) -> BoolImage:
    seed = np.zeros(filled.shape, bool)
    seed[pixel_at(point, filled.shape)] = True
    region = connected_to(seed, filled)
    if region.sum() < 16:
        raise NoObject("no object at the point that was given; give a point well inside it")
    return region


def _is_ground(region: BoolImage) -> bool:
    """Whether a region runs along the frame as a table's edge or a wall does."""
    sides = (region[0], region[-1], region[:, 0], region[:, -1])
    return any(side.mean() > _FULL_EDGE for side in sides) or len(edges_touched(region)) > 3


def region_on_ground(lab: FloatImage, ground: Ground, point: Point | None = None) -> BoolImage:
    """Find what stands out from a plain ground, without the soft shadow it casts.

    Parameters
    ----------
    lab : (H, W, 3)
        Picture in CIE Lab, lightly blurred.
    ground : Ground
        Fitted to the same picture.
    point : (x, y), or None
        As in `choose_object`.

    Raises
    ------
    NoObject
        As `choose_object`.
    """
    marked = ground.standing
    # Hysteresis: a region counts when some part of it stands out clearly.
    standing_out = connected_to(ground.distance > 1.6 * ground.level, marked)
    region = choose_object(_closed(standing_out), point)
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
