"""The picture of the candidates, for a user who is asked which of them is the object."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from contourpy import contour_generator
from numpy.typing import NDArray

from profiletool.records.units import FloatArray
from profiletool.report.figure import panels, png, titled
from profiletool.report.palette import INK, RED

_MOST = 4
_PANEL_IN = 3.6
_LONGEST_PX = 480  # side of a panel's picture; more would not be seen

Candidates = Sequence[tuple[NDArray[np.bool_], float, str]]


def draw_candidates(rgb: NDArray[np.uint8], candidates: Candidates) -> bytes:
    """Draw a picture with up to four candidates, each outlined in a panel of its own.

    Parameters
    ----------
    rgb : (H, W, 3) uint8
        The picture.
    candidates : sequence of (mask, confidence, method)
        At least one, the best first; masks are (H, W) bool, confidences 0 to 1.

    Returns
    -------
    bytes
        PNG. The axes are numbered in the picture's pixels, for `box` and `point`.
    """
    shown = candidates[:_MOST]
    height, width = rgb.shape[:2]
    tall = min(max(_PANEL_IN * height / width, 1.5), 8.0) + 0.6
    figure, axes = panels(len(shown), _PANEL_IN * len(shown), tall)
    for number, (panel, candidate) in enumerate(zip(axes, shown, strict=True), start=1):
        _draw(panel, rgb, *candidate, number)
    return png(figure)


def _draw(
    panel: Any,
    rgb: NDArray[np.uint8],
    mask: NDArray[np.bool_],
    confidence: float,
    method: str,
    number: int,
) -> None:
    height, width = mask.shape
    step = max(1, -(-max(height, width) // _LONGEST_PX))
    extent = (-0.5, width - 0.5, height - 0.5, -0.5)
    panel.grid(visible=False)
    panel.imshow(rgb[::step, ::step], extent=extent, interpolation="nearest")
    for line in _outlines(mask[::step, ::step]):
        x, y = line.T * step
        # Light beneath dark, to be seen on any picture.
        panel.plot(x, y, color="white", lw=3.0)
        panel.plot(x, y, color=RED, lw=1.4)
    panel.tick_params(labelsize=8, colors=INK)
    titled(panel, f"{number}: {method}, {100.0 * confidence:.0f} %")


def _outlines(mask: NDArray[np.bool_]) -> list[FloatArray]:
    """Half-level lines of a mask, x and y in its pixels; along the frame too."""
    padded = np.pad(mask.astype(np.float64), 1)
    lines = contour_generator(z=padded).lines(0.5)
    return [np.asarray(line, np.float64) - 1.0 for line in lines]
