"""Telling an object from the soft shadow it casts."""

from __future__ import annotations

import cv2
import numpy as np

from profiletool.image.find.ground import BoolImage, FloatImage, Ground
from profiletool.image.find.masks import connected_to, largest_filled, rim

# Edge strengths in Lab units per pixel: an object's edge against a shadow's.
_FIRM_EDGE = 3.0
_WEAK_EDGE, _MOST_WEAK = 2.2, 0.35
_FLOOD_LEVELS = (1.0, 1.5, 2.2, 3.2, 4.7, np.inf)
_SHADOW_DARKEST, _SHADOW_BRIGHTEST = 0.35, 1.04
_SHADOW_TINT = 4.5
_LIGHT_BRIGHTEST, _GENTLE = 1.5, 1.5


def edge_strength(lab: FloatImage) -> FloatImage:
    """Colour gradient in Lab units per pixel, (H, W)."""
    along_x = cv2.Sobel(lab, cv2.CV_32F, 1, 0, scale=0.125)
    along_y = cv2.Sobel(lab, cv2.CV_32F, 0, 1, scale=0.125)
    return np.asarray(np.sqrt((along_x**2 + along_y**2).sum(axis=2)), np.float32)


def _rim_strength(mask: BoolImage, strength: FloatImage) -> FloatImage:
    reach = cv2.dilate(strength, np.ones((3, 3), np.uint8))
    return np.asarray(reach[rim(mask)])


def without_shadow(region: BoolImage, lab: FloatImage, ground: Ground) -> BoolImage:
    """Let the ground flood in over gentle gradients, as far as a firmer outline lies behind.

    A shadow keeps the ground's hue and ends softly; the flood goes through it and halts at the
    object's edge. Only pixels that could be shadow are flooded.
    """
    strength = edge_strength(lab)
    shadow = _could_be_shadow(lab, ground, strength)
    around = _rim_strength(region, strength)
    firm = max(_FIRM_EDGE, 0.6 * float(np.quantile(around, 0.8))) if len(around) else _FIRM_EDGE

    def firmness(mask: BoolImage) -> float:
        along = _rim_strength(mask, strength)
        return float(np.minimum(along / firm, 1.0).mean()) if len(along) else 0.0

    candidates = [region]
    for level in _FLOOD_LEVELS:
        floodable = ~region | (shadow & (strength < level))
        candidates.append(_flooded(region, floodable))
    candidates += _standing_out(region, ground.distance)
    area = region.sum()
    scored = [(firmness(c), c) for c in candidates if c.sum() > 0.4 * area]
    best = max(score for score, _ in scored)
    if best >= scored[0][0] + 0.08:
        # The largest of the nearly best: a flood too many eats into the object.
        region = next(c for score, c in scored if score > best - 0.04)
    return region


def _standing_out(region: BoolImage, distance: FloatImage) -> list[BoolImage]:
    """Split a region by Otsu's threshold: shadows, coloured ones too, lie nearer to the ground."""
    inside = distance[region]
    if inside.size == 0:
        return []
    unit = max(float(np.quantile(inside, 0.95)), 1e-6) / 255.0
    grey = np.clip(inside / unit, 0.0, 255.0).astype(np.uint8).reshape(1, -1)
    level, _ = cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY | cv2.THRESH_OTSU)
    return [largest_filled(region & (distance > level * unit))]


def _flooded(region: BoolImage, floodable: BoolImage) -> BoolImage:
    """Take from a region what the ground reaches through gaps at least three pixels wide."""
    square = np.ones((3, 3), np.uint8)
    wide = cv2.erode(floodable.view(np.uint8), square, borderType=cv2.BORDER_REPLICATE) > 0
    water = cv2.dilate(connected_to(wide & ~region, wide).view(np.uint8), square) > 0
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
