"""Which pixels are the object, roughly: to a pixel or two, but the right thing and all of it."""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.errors import NoObject
from profiletool.image.ground import BoolImage, FloatImage, Ground

_ADVICE = "photograph one object on a plain ground of another colour"
_MIN_SHARE = 5e-4  # of the frame: smaller regions are specks
_ALIKE = 0.4  # a second region of this part of the largest's area is another object
_FULL_EDGE = 0.9  # a region along this much of a frame edge is ground
_WHOLE_FRAME = 0.95

# Edge strengths in Lab units per pixel: an object's edge against a shadow's.
_FIRM_EDGE = 3.0
_FAINT_RIM = 0.015  # widest gap in a rim, half of it, of the object's size
_WEAK_EDGE, _MOST_WEAK = 2.2, 0.35
_FLOOD_LEVELS = (1.0, 1.5, 2.2, 3.2, 4.7, np.inf)
_SHADOW_DARKEST, _SHADOW_BRIGHTEST = 0.35, 1.04
_SHADOW_TINT = 4.5
_LIGHT_BRIGHTEST, _GENTLE = 1.5, 1.5


def fill_holes(mask: BoolImage) -> BoolImage:
    """Fill what the region encloses; a gap open to the frame is no hole."""
    filled = np.zeros(mask.shape, np.uint8)
    outlines, _ = cv2.findContours(
        np.ascontiguousarray(mask).view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
    )
    cv2.drawContours(filled, outlines, -1, 1, cv2.FILLED)
    return filled.view(bool)


def largest_filled(mask: BoolImage) -> BoolImage:
    """The largest region of a mask, its holes filled; empty where there is none."""
    outlines, _ = cv2.findContours(
        np.ascontiguousarray(mask).view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
    )
    largest = np.zeros(mask.shape, np.uint8)
    if outlines:
        cv2.drawContours(largest, [max(outlines, key=cv2.contourArea)], -1, 1, cv2.FILLED)
    return largest.view(bool)


def _connected_to(seeds: BoolImage, mask: BoolImage) -> BoolImage:
    """The regions of a mask that hold a seed."""
    count, labels = cv2.connectedComponents(mask.view(np.uint8), connectivity=4)
    kept = np.zeros(count, bool)
    kept[labels[seeds & mask]] = True
    return kept[labels]


def edges_touched(mask: BoolImage) -> frozenset[str]:
    """The frame edges that a region reaches."""
    sides = {"top": mask[0], "bottom": mask[-1], "left": mask[:, 0], "right": mask[:, -1]}
    return frozenset(name for name, side in sides.items() if side.any())


def choose_object(mask: BoolImage) -> BoolImage:
    """The one object among the regions of a mask, its holes filled.

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
    """What stands out from a plain ground, without the soft shadow it casts.

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
    region = choose_object(_closed(_connected_to(ground.distance > 1.6 * low, marked)))
    window = _window(region, margin=6)
    cut = replace(ground, surface=ground.surface[window], distance=ground.distance[window])
    whole = _sealed(region[window])
    region[window] = _tightened(_sealed(_without_shadow(whole, lab[window], cut)), cut)
    return region


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


def _window(region: BoolImage, margin: int) -> tuple[slice, slice]:
    rows, columns = np.flatnonzero(region.any(axis=1)), np.flatnonzero(region.any(axis=0))
    return (
        slice(max(rows[0] - margin, 0), rows[-1] + margin + 1),
        slice(max(columns[0] - margin, 0), columns[-1] + margin + 1),
    )


def _tightened(region: BoolImage, ground: Ground) -> BoolImage:
    """Draw an outline in from where the object's blur ends to about its half height."""
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (7, 7))
    core = cv2.erode(region.view(np.uint8), disc, borderType=cv2.BORDER_REPLICATE) > 0
    height = cv2.dilate(np.where(region, ground.distance, 0), disc)
    return core | (region & (ground.distance > 0.4 * height))


def _closed(mask: BoolImage) -> BoolImage:
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (3, 3))
    padded = np.pad(mask, 2).view(np.uint8)
    return np.asarray(cv2.morphologyEx(padded, cv2.MORPH_CLOSE, disc)[2:-2, 2:-2] > 0)


def edge_strength(lab: FloatImage) -> FloatImage:
    """Colour gradient in Lab units per pixel, (H, W)."""
    along_x = cv2.Sobel(lab, cv2.CV_32F, 1, 0, scale=0.125)
    along_y = cv2.Sobel(lab, cv2.CV_32F, 0, 1, scale=0.125)
    return np.asarray(np.sqrt((along_x**2 + along_y**2).sum(axis=2)), np.float32)


def _rim_strength(mask: BoolImage, strength: FloatImage) -> FloatImage:
    reach = cv2.dilate(strength, np.ones((3, 3), np.uint8))
    inner = cv2.erode(
        mask.view(np.uint8), np.ones((3, 3), np.uint8), borderType=cv2.BORDER_REPLICATE
    )
    return np.asarray(reach[mask & (inner == 0)])


def _without_shadow(region: BoolImage, lab: FloatImage, ground: Ground) -> BoolImage:
    """Let the ground flood in over gentle gradients, as far as a firmer outline lies behind.

    A shadow keeps the ground's hue and ends softly; the flood goes through it and halts at the
    object's edge. Only pixels that could be shadow are flooded.
    """
    strength = edge_strength(lab)
    shadow = _could_be_shadow(lab, ground, strength)
    rim = _rim_strength(region, strength)
    firm = max(_FIRM_EDGE, 0.6 * float(np.quantile(rim, 0.8))) if len(rim) else _FIRM_EDGE

    def firmness(mask: BoolImage) -> float:
        along = _rim_strength(mask, strength)
        return float(np.minimum(along / firm, 1.0).mean()) if len(along) else 0.0

    candidates = [region]
    for level in _FLOOD_LEVELS:
        floodable = ~region | (shadow & (strength < level))
        candidates.append(_flooded(region, floodable))
    area = region.sum()
    scored = [(firmness(c), c) for c in candidates if c.sum() > 0.4 * area]
    best = max(score for score, _ in scored)
    if best >= scored[0][0] + 0.08:
        # The largest of the nearly best: a flood too many eats into the object.
        region = next(c for score, c in scored if score > best - 0.04)
    _refuse_faded(region, strength)
    return region


def _refuse_faded(region: BoolImage, strength: FloatImage) -> None:
    """Better no outline than one that follows a shadow."""
    rim = _rim_strength(region, strength)
    if len(rim) == 0:
        return
    weak = min(_WEAK_EDGE, 0.45 * float(np.quantile(rim, 0.8)))
    if float((rim < weak).mean()) > _MOST_WEAK:
        raise NoObject(
            "the object's outline fades into the ground or a shadow; use softer light or a ground "
            "of another colour"
        )


def _flooded(region: BoolImage, floodable: BoolImage) -> BoolImage:
    """Take from a region what the ground reaches through gaps at least three pixels wide."""
    square = np.ones((3, 3), np.uint8)
    wide = cv2.erode(floodable.view(np.uint8), square, borderType=cv2.BORDER_REPLICATE) > 0
    water = cv2.dilate(_connected_to(wide & ~region, wide).view(np.uint8), square) > 0
    return largest_filled(region & ~water)


def _could_be_shadow(lab: FloatImage, ground: Ground, strength: FloatImage) -> BoolImage:
    """Pixels of the ground's hue, darker; or brighter where the light changes gently."""
    seen = cv2.cvtColor(lab, cv2.COLOR_LAB2RGB)
    lit = cv2.cvtColor(ground.surface, cv2.COLOR_LAB2RGB)
    factor = (seen * lit).sum(axis=2) / np.maximum((lit * lit).sum(axis=2), 1e-4)
    shaded = cv2.cvtColor(np.clip(factor[..., None] * lit, 0, 1), cv2.COLOR_RGB2LAB)
    tint = np.linalg.norm(lab - shaded, axis=2)
    darker = (factor > _SHADOW_DARKEST) & (factor < _SHADOW_BRIGHTEST)
    gently_lit = (factor < _LIGHT_BRIGHTEST) & (strength < _GENTLE)
    return np.asarray((tint < _SHADOW_TINT) & (darker | gently_lit))


def grabcut_region(rgb: NDArray[np.uint8], distance: FloatImage, barred: BoolImage) -> BoolImage:
    """Separate by colour mixtures where no plain ground explains the border.

    Parameters
    ----------
    rgb : (H, W, 3)
        The picture.
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
        np.ascontiguousarray(rgb[..., ::-1]), labels, None, *models, 4, cv2.GC_INIT_WITH_MASK
    )
    found = np.isin(labels, (cv2.GC_FGD, cv2.GC_PR_FGD))
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (5, 5))
    opened = cv2.morphologyEx(found.view(np.uint8), cv2.MORPH_OPEN, disc) > 0
    region = choose_object(opened)
    if not 0.01 < region.mean() < 0.8:
        raise NoObject(f"the object cannot be told from the ground; {_ADVICE}")
    return region
