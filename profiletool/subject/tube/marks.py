"""Dots and rings painted on the wrapped sectors: lines through them.

A mark is a spot of strong colour within the predicted tube. Two dots on a sector lie along it, one
beside the other; a ring runs around it.
"""

from __future__ import annotations

import cv2
import numpy as np

from profiletool.records.units import FloatArray
from profiletool.subject.tube.camera import Camera
from profiletool.subject.tube.edges import Shown
from profiletool.subject.tube.family import Family
from profiletool.subject.tube.values import Line, Tube

_STRONG = 60.0  # levels between a mark's strongest and weakest channel
_LEAST_MM2, _MOST_MM2 = 0.4, 60.0
_LONG = 2.5  # length over width, from which a spot is a ring


def mark_lines(picture: Shown, camera: Camera, family: Family, tube: Tube) -> dict[int, Line]:
    """Find painted marks: a line for every wrapped sector that has a ring, or two dots."""
    outline = tube.outline(family)
    lines = camera.lines(outline, tube.place, tube.size)
    px_per_mm = float(np.linalg.norm(lines[1, 0] - lines[0, 0])) / (2.0 * float(outline.half[0]))
    spots = _spots(picture, lines, px_per_mm)
    found: dict[int, Line] = {}
    for number in range(family.joints + 1):
        own = [spot for spot in spots if _sector(spot, lines, family) == number]
        rings = [spot for spot in own if spot.long > _LONG]
        dots = [spot.centre for spot in own if spot.long <= _LONG]
        if rings:
            ring = max(rings, key=lambda spot: spot.long)
            half = ring.reach * ring.way
            ends = np.stack([ring.centre - half, ring.centre + half])
            found[number] = Line(ends, across=True, by_hand=False, sigma_px=0.5)
        elif len(dots) == 2:
            found[number] = Line(np.stack(dots), by_hand=False, sigma_px=0.3)
    return found


class _Spot:
    """A spot: its centre, direction, half length, and length over width."""

    def __init__(self, px: FloatArray) -> None:
        self.centre = px.mean(axis=0)
        values, vectors = np.linalg.eigh(np.cov(px.T) + 0.1 * np.eye(2))
        self.way = vectors[:, 1]
        self.reach = float(np.sqrt(3.0 * values[1]))
        self.long = float(np.sqrt(values[1] / values[0]))


def _spots(picture: Shown, lines: FloatArray, px_per_mm: float) -> list[_Spot]:
    """Strongly coloured spots within the tube's lines."""
    inside = np.zeros(picture.colour.shape[:2], np.uint8)
    around = np.concatenate([lines[0], lines[1, ::-1]])
    cv2.fillPoly(inside, [np.round(around).astype(np.int32)], 1)
    strength = picture.colour.max(axis=2) - picture.colour.min(axis=2)
    usual = float(np.median(strength[inside > 0])) if inside.any() else 0.0
    strong = ((strength > usual + _STRONG) & (inside > 0)).astype(np.uint8)
    count, labels, stats, _ = cv2.connectedComponentsWithStats(strong, connectivity=8)
    least, most = _LEAST_MM2 * px_per_mm**2, _MOST_MM2 * px_per_mm**2
    found = []
    for k in range(1, count):
        if least <= stats[k, cv2.CC_STAT_AREA] <= most:
            rows, columns = np.nonzero(labels == k)
            found.append(_Spot(np.column_stack([columns, rows]).astype(float)))
    return found


def _sector(spot: _Spot, lines: FloatArray, family: Family) -> int:
    """Find the wrapped sector that a spot lies on; -1 in a cut."""
    middle = lines.mean(axis=0)
    return int(family.sector[int(np.linalg.norm(middle - spot.centre, axis=1).argmin())])
