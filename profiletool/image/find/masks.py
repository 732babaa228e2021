"""Small operations on masks."""

from __future__ import annotations

import cv2
import numpy as np

from profiletool.image.find.ground import BoolImage
from profiletool.records.units import FloatArray

_SPUR_SHARE = 0.006


def fill_holes(mask: BoolImage) -> BoolImage:
    """Fill what the region encloses; a gap open to the frame is no hole."""
    filled = np.zeros(mask.shape, np.uint8)
    outlines, _ = cv2.findContours(
        np.ascontiguousarray(mask).view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
    )
    cv2.drawContours(filled, outlines, -1, 1, cv2.FILLED)
    return filled.view(bool)


def largest_filled(mask: BoolImage) -> BoolImage:
    """Give the largest region of a mask, its holes filled; empty where there is none."""
    outlines, _ = cv2.findContours(
        np.ascontiguousarray(mask).view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE
    )
    largest = np.zeros(mask.shape, np.uint8)
    if outlines:
        cv2.drawContours(largest, [max(outlines, key=cv2.contourArea)], -1, 1, cv2.FILLED)
    return largest.view(bool)


def without_spurs(mask: BoolImage) -> BoolImage:
    """Cut off what sticks out of a region as a thin spur; corners stay.

    A spur is narrower than about a hundredth of the region and reaches further out than any
    corner's tip does beyond the disc that fits into it.
    """
    radius = round(_SPUR_SHARE * np.sqrt(mask.sum()))
    if radius < 1:
        return mask
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
    padded = np.pad(mask, radius, mode="edge").view(np.uint8)
    opened = cv2.morphologyEx(padded, cv2.MORPH_OPEN, disc)[radius:-radius, radius:-radius] > 0
    tips = mask & ~opened
    reach = cv2.distanceTransform((~opened).view(np.uint8), cv2.DIST_L2, 3)
    return np.asarray(mask & ~connected_to(tips & (reach > 0.7 * radius + 1.0), tips))


def rim(mask: BoolImage) -> BoolImage:
    """Keep the pixels of a mask that touch one outside it; the frame itself is no outside."""
    inner = cv2.erode(
        mask.view(np.uint8), np.ones((3, 3), np.uint8), borderType=cv2.BORDER_REPLICATE
    )
    return np.asarray(mask & (inner == 0))


def connected_to(seeds: BoolImage, mask: BoolImage) -> BoolImage:
    """Keep the regions of a mask that hold a seed."""
    count, labels = cv2.connectedComponents(mask.view(np.uint8), connectivity=4)
    kept = np.zeros(count, bool)
    kept[labels[seeds & mask]] = True
    return np.asarray(kept[labels])


def overlap(one: BoolImage, other: BoolImage) -> float:
    """Area in common over the area of both together; 0 for two empty masks."""
    return float((one & other).sum() / max(int((one | other).sum()), 1))


def thickness(contour: FloatArray) -> float:
    """Give the shorter side of the smallest rectangle, at any angle, round points (N, 2)."""
    return float(min(cv2.minAreaRect(contour.astype(np.float32))[1]))


def edges_touched(mask: BoolImage) -> frozenset[str]:
    """Name the frame edges that a region reaches."""
    sides = {"top": mask[0], "bottom": mask[-1], "left": mask[:, 0], "right": mask[:, -1]}
    return frozenset(name for name, side in sides.items() if side.any())


def window_of(region: BoolImage, margin: int) -> tuple[slice, slice]:
    """Rows and columns of a region with a margin round it."""
    rows, columns = np.flatnonzero(region.any(axis=1)), np.flatnonzero(region.any(axis=0))
    return (
        slice(max(rows[0] - margin, 0), rows[-1] + margin + 1),
        slice(max(columns[0] - margin, 0), columns[-1] + margin + 1),
    )
