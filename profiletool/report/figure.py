"""The style of all plots, and their output as PNG or SVG that is the same for the same plot."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from profiletool.report.palette import BLUE, GREEN, GRID, INK, NAMES, ORANGE, PURPLE, RED, SKY

_COLOURS = (BLUE, RED, GREEN, ORANGE, PURPLE, SKY, INK)
_MARKERS = ("o", "s", "^", "D", "v", "P", "X")
_DPI = 120
WIDE_IN = 5.4  # of a plot that is read on a telephone too


def styles(count: int) -> list[tuple[str, str]]:
    """Pair colours with markers, ``count`` times; none of the first 49 pairs twice."""
    n = len(_COLOURS)
    return [(_COLOURS[k % n], _MARKERS[(k + k // n) % n]) for k in range(count)]


def panels(
    count: int, wide: float, tall: float, *, sharey: bool = False, below: bool = False
) -> tuple[Figure, Sequence[Any]]:
    """Make a figure of panels, ``wide`` by ``tall`` inches in all.

    They stand side by side, or ``below`` each other; then all have the uppermost one's x.
    """
    figure = Figure(figsize=(wide, tall), dpi=_DPI, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    rows, columns = (count, 1) if below else (1, count)
    found: list[Any] = figure.subplots(rows, columns, sharey=sharey, squeeze=False).ravel().tolist()
    for axes in found:
        axes.grid(color=GRID, lw=0.6, zorder=0)
        axes.spines[["top", "right"]].set_visible(False)
        axes.set_axisbelow(True)
    return figure, found


def titled(axes: Any, title: str) -> None:
    """Put a title above a panel, as it is: a file's name is no mathematics."""
    if title:
        axes.set_title(title, fontsize=11, loc="left", parse_math=False)


def legend_below(figure: Figure, axes: Any, columns: int) -> None:
    """Put the legend of a panel below all panels, with so many columns."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside lower left", ncols=columns, frameon=False, fontsize=9.5,
        handlelength=2.2, columnspacing=1.4,
    )  # fmt: skip


def png(figure: Figure) -> bytes:
    """Render a figure as PNG."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()


def svg(figure: Figure) -> str:
    """Render a figure as an SVG element for a page.

    Its texts are text, in the page's font; its colours are the page's: ``var(--blue)`` and so on,
    by the palette's names. Nothing lies behind it.
    """
    buffer = io.StringIO()
    nothing = dict.fromkeys(("Date", "Creator", "Format", "Type"))
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "profiletool"}):
        figure.savefig(buffer, format="svg", transparent=True, metadata=nothing)
    return _for_a_page(buffer.getvalue())


def _for_a_page(document: str) -> str:
    """Take from an SVG file what would act on all of a page, and its own fonts and colours."""
    element = document[document.index("<svg") :].strip()
    element = re.sub(r"<style.*?</style>", "", element, flags=re.DOTALL)
    element = re.sub(r"font-family: [^;\"]*", "font-family: inherit", element)
    element = re.sub(r'(<svg[^>]*?) width="[^"]*" height="[^"]*"', r"\1", element, count=1)
    for colour, name in NAMES.items():
        element = element.replace(colour, f"var(--{name})")
    return element


def mask_png(mask: NDArray[np.bool_]) -> bytes:
    """Encode a mask (H, W): white object on black."""
    buffer = io.BytesIO()
    Image.fromarray(mask).save(buffer, "PNG", compress_level=1)
    return buffer.getvalue()
