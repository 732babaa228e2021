"""A hand that holds the object: the outline ends where the fingers begin."""

from __future__ import annotations

from enum import Enum

import cv2
import numpy as np

from profiletool.image.find.colours import histogram
from profiletool.image.find.ground import BoolImage, frame_of
from profiletool.image.find.masks import connected_to, rim
from profiletool.image.find.shadow import edge_strength
from profiletool.image.find.view import View

# Skin of every tone has much the same hue (Xiao et al., Skin Res. Technol. 23 (2017) 21); in CIE
# Lab, with room for the light it is seen in.
_SKIN = (12.0, 4.0, 4.0), (92.0, 27.0, 45.0)
_STRIP_SHARE = 0.04  # width of the strips along the frame, of its shorter side
_COMMON = 0.015  # a colour of so much of two opposite strips is the ground's
_GAP_PX, _NEAR_PX = 5, 7
_FINGER_SHARE = 0.02  # of the shorter side: no finger is thinner
_FIRM_LAB, _ROUGH_PX = 1.5, 13  # a step per pixel, within so much of a hand's rough outline
_HIDDEN, _COVERED = 0.05, 0.15  # more of an outline than this lies along a hand: said, refused
_SLEEVE, _BEYOND = 0.03, 0.1  # more of a mask than this comes before the hand, and after it


class Hand(Enum):
    """What a hand does to an object: nothing, hides a little of its outline, covers it."""

    NONE = 0
    NEAR = 1
    COVERS = 2


def hand_at(view: View, mask: BoolImage) -> Hand:
    """Say what a hand does to the object that a mask (H, W) shows.

    A hand has the colour of skin, which the ground has not, and comes in over the frame, by
    itself or in a sleeve.
    """
    skin = _skin(view)
    if _sleeved(skin, mask):
        return Hand.COVERS
    hand = connected_to(frame_of(skin.shape, 0.0), skin)
    if not _ends_firmly(view, hand, mask):
        return Hand.NONE  # a warm shadow
    hand &= ~view.barred
    if (mask & ~hand).sum() < _BEYOND * mask.sum():
        return Hand.NONE  # one thing, cut off by the frame
    outline = rim(mask)
    along = outline & _morphed(cv2.MORPH_DILATE, hand, _NEAR_PX)
    share = float(along.sum() / max(int(outline.sum()), 1))
    if share > _COVERED:
        return Hand.COVERS
    return Hand.NEAR if share > _HIDDEN else Hand.NONE


def _sleeved(skin: BoolImage, mask: BoolImage) -> bool:
    """Whether skin parts the most of a mask from what it shows along the frame."""
    rest = mask & ~skin
    sleeve = connected_to(frame_of(mask.shape, 0.0), rest)
    beyond = rest & ~sleeve
    area = mask.sum()
    return bool(sleeve.sum() > _SLEEVE * area and beyond.sum() > _BEYOND * area)


def _ends_firmly(view: View, hand: BoolImage, mask: BoolImage) -> bool:
    """Whether most of a hand's outline has a firm edge nearby, away from a mask and the frame."""
    outline = rim(hand) & ~frame_of(mask.shape, 0.0)
    outline &= ~_morphed(cv2.MORPH_DILATE, mask, 2 * _ROUGH_PX)
    calm = np.asarray(cv2.GaussianBlur(view.lab, (0, 0), 2.0), np.float32)
    firm = _morphed(cv2.MORPH_DILATE, edge_strength(calm) > _FIRM_LAB, _ROUGH_PX)
    return not outline.any() or bool(firm[outline].mean() > 0.5)


def _skin(view: View) -> BoolImage:
    """Mask what has a colour of skin that is not the ground's."""
    coloured = cv2.inRange(view.lab, *(np.array(bound) for bound in _SKIN)) > 0
    wide = max(2, round(_STRIP_SHARE * min(coloured.shape)))
    cell = view.cell
    strips = cell[:wide], cell[-wide:], cell[:, :wide], cell[:, -wide:]
    top, bottom, left, right = (histogram(s, np.ones(s.shape, bool)) > _COMMON for s in strips)
    # The ground is along opposite sides, an arm comes in over one or over a corner.
    ground = (top & bottom) | (left & right)
    closed = _morphed(cv2.MORPH_CLOSE, coloured & ~ground[cell], _GAP_PX)
    return _morphed(cv2.MORPH_OPEN, closed, round(_FINGER_SHARE * min(closed.shape)) | 1)


def _morphed(how: int, mask: BoolImage, size: int) -> BoolImage:
    return np.asarray(
        cv2.morphologyEx(mask.view(np.uint8), how, np.ones((size, size), np.uint8)) > 0
    )
