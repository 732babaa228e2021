"""What all plots share: size, grid, colours, and PNG that is the same for the same plot."""

from __future__ import annotations

import io
from collections.abc import Sequence
from itertools import cycle, islice
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from profiletool.report.palette import BLUE, GREEN, INK, ORANGE, PURPLE, RED, SKY

_COLOURS = (BLUE, RED, GREEN, ORANGE, PURPLE, SKY, INK)
_MARKERS = ("o", "s", "^", "D", "v", "P", "X")
_DPI = 120


def styles(count: int) -> list[tuple[str, str]]:
    """Give so many pairs of colour and marker."""
    return list(islice(cycle(zip(_COLOURS, _MARKERS, strict=True)), count))


def panels(
    count: int, wide: float, tall: float, *, sharey: bool = False
) -> tuple[Figure, Sequence[Any]]:
    """Make a figure of panels side by side, ``wide`` by ``tall`` inches in all."""
    figure = Figure(figsize=(wide, tall), dpi=_DPI, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    row: Sequence[Any] = figure.subplots(1, count, sharey=sharey, squeeze=False)[0]
    for axes in row:
        axes.grid(color="#dddddd", lw=0.6, zorder=0)
        axes.spines[["top", "right"]].set_visible(False)
        axes.set_axisbelow(True)
    return figure, row


def png(figure: Figure) -> bytes:
    """Render a figure as PNG."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()
