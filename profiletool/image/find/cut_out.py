"""Cut-outs: what an alpha channel says of the object, and where it says something else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from profiletool.errors import NoObject
from profiletool.image.find.ground import BoolImage, FloatImage
from profiletool.image.find.masks import largest_filled, rim, window_of
from profiletool.records.picture import Picture

_WHOLE = 0.98  # of a picture: an alpha channel that leaves out less only rounds its corners
_OPAQUE, _FIRMER = 0.8, 2.5  # where a shadow's alpha ends, and how much steeper the rest is made
_RIM_PX = 2.0  # what an edge may be wide; a shadow's is wider
_FULL = 0.97  # of its box: a region that fills so much is a page
_SHADOWED = 0.7  # confidence in a cut-out that came with its shadow


def cuts_out(alpha: NDArray[np.uint8]) -> bool:
    """Whether an alpha channel cuts something out; rounded corners alone do not.

    Raises
    ------
    NoObject
        It is transparent everywhere.
    """
    share = float((alpha >= 128).mean())
    if share == 0.0:
        raise NoObject("the picture is transparent everywhere; export it with its content")
    return share < _WHOLE


def page_in(picture: Picture) -> tuple[slice, slice] | None:
    """Rows and columns of a page or window that was saved with its shadow round it."""
    if picture.alpha is None or not cuts_out(picture.alpha):
        return None
    region = largest_filled(picture.alpha >= 128)
    window = window_of(region, 0)
    soft = ((picture.alpha > 8) & (picture.alpha < 128)).sum()
    if region[window].mean() < _FULL or soft < 4.0 * _RIM_PX * rim(region).sum():
        return None
    inset = max(2, round(0.03 * min(region[window].shape)))  # its rounded corners
    rows, columns = window
    return (
        slice(rows.start + inset, rows.stop - inset),
        slice(columns.start + inset, columns.stop - inset),
    )


def without_alpha(picture: Picture) -> Picture:
    """Give a picture without its alpha channel."""
    return replace(picture, alpha=None)


def opaque_part(share: FloatImage) -> tuple[FloatImage, float]:
    """Leave a shadow out of a cut-out's share of object (H, W); say how far it is believed."""
    whole, firm = largest_filled(share > 0.5), largest_filled(share > _OPAQUE)
    shadow = float(whole.sum()) - float(firm.sum())
    if not _is_rim(whole, firm, shadow) and firm.sum() > 0.5 * whole.sum():
        steeper = np.clip(0.5 + (share - _OPAQUE) * _FIRMER, 0.0, 1.0)
        return np.asarray(steeper, np.float32), _SHADOWED
    return share, 1.0


def _is_rim(whole: BoolImage, firm: BoolImage, between: float) -> bool:
    """Whether what lies between two regions is no wider than an edge, taken over all of it."""
    return between < 0.25 * _RIM_PX * float(rim(whole).sum()) or not firm.any()
