"""A drawing for the writers: plain polylines on layers, mm, y up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from profiletool.records.units import FloatArray
from profiletool.template.strokes import text_strokes, text_width

LayerName = Literal["MARK", "CUT_INNER", "CUT_OUTER", "NOTE", "REF"]
Anchor = Literal["left", "centre", "right"]
Box = tuple[float, float, float, float]

# Layer: (AutoCAD colour index, the same colour for SVG), in the order of the files: a part that
# is cut loose first moves, so its marks and inner cuts come before its outline.
COLOURS: dict[LayerName, tuple[int, str]] = {
    "MARK": (3, "#00a000"),
    "CUT_INNER": (5, "#0000ff"),
    "CUT_OUTER": (7, "#000000"),
    "NOTE": (1, "#ff0000"),
    "REF": (8, "#808080"),
}
# Coordinates end at a nanometre: the last bits of a sum are not the same on every machine.
DECIMALS = 6
# Curves are drawn as chords that lie off them by no more than this.
FLATTENING_MM = 0.01
RULER_MM = 100.0


@dataclass(frozen=True)
class Text:
    """One line of lettering.

    Attributes
    ----------
    layer : str
        The layer that it is drawn on.
    text : str
        What it says.
    x, y : float
        Where its baseline is held, mm.
    height : float
        Height of its capitals, mm.
    anchor : {"left", "centre", "right"}
        Which part of the baseline (x, y) is.
    upward : bool
        Reads from below to above instead of from left to right.
    """

    layer: LayerName
    text: str
    x: float
    y: float
    height: float
    anchor: Anchor = "left"
    upward: bool = False

    @property
    def width(self) -> float:
        """Length of the line of lettering, mm."""
        return text_width(self.text, self.height)

    @property
    def box(self) -> Box:
        """Where it is drawn: x min, y min, x max, y max, mm."""
        back = self._back()
        if self.upward:
            return self.x - self.height, self.y - back, self.x, self.y - back + self.width
        return self.x - back, self.y, self.x - back + self.width, self.y + self.height

    def lines(self) -> tuple[FloatArray, ...]:
        """Return its strokes as polylines, (N, 2) mm each."""
        start = np.array([self._back(), 0.0])
        place = np.array([self.x, self.y])
        strokes = (stroke - start for stroke in text_strokes(self.text, self.height))
        if self.upward:
            strokes = (stroke[:, ::-1] * np.array([-1.0, 1.0]) for stroke in strokes)
        return tuple(stroke + place for stroke in strokes)

    def _back(self) -> float:
        return self.width * {"left": 0.0, "centre": 0.5, "right": 1.0}[self.anchor]


@dataclass(frozen=True)
class Line:
    """A polyline on a layer: ``points`` (N, 2) mm; a closed one does not repeat a point."""

    layer: LayerName
    points: FloatArray
    closed: bool = False


@dataclass(frozen=True)
class Layer:
    """The polylines of one layer."""

    name: LayerName
    lines: tuple[Line, ...]


@dataclass(frozen=True)
class Drawing:
    """What the writers write: polylines and lettering, mm, y up.

    Attributes
    ----------
    title : str
    drawn : tuple of Line
        On each layer in the order to draw them.
    texts : tuple of Text
    """

    title: str
    drawn: tuple[Line, ...]
    texts: tuple[Text, ...]

    @cached_property
    def layers(self) -> tuple[Layer, ...]:
        """All that is to be drawn, lettering as strokes, layer by layer, in the order to draw."""
        found: dict[LayerName, list[Line]] = {name: [] for name in COLOURS}
        for line in self.drawn:
            found[line.layer].append(line)
        for text in self.texts:
            found[text.layer].extend(Line(text.layer, stroke) for stroke in text.lines())
        return tuple(
            Layer(name, tuple(replace(line, points=_rounded(line.points)) for line in lines))
            for name, lines in found.items()
        )

    @property
    def bounds(self) -> Box:
        """The extent of everything drawn: x min, y min, x max, y max, mm."""
        return extent([line for layer in self.layers for line in layer.lines])


def arrow(
    layer: LayerName, start: FloatArray, end: FloatArray, both: bool = False, head: float = 2.5
) -> tuple[Line, ...]:
    """Return a shaft from ``start`` to ``end`` (2,) mm with an open head, or one at both ends."""
    along = (end - start) / np.hypot(*(end - start))
    across = np.array([-along[1], along[0]])
    lines = [Line(layer, np.array([start, end]))]
    for tip, sign in ((end, 1), (start, -1))[: 2 if both else 1]:
        back = tip - sign * head * along
        lines.append(
            Line(layer, np.array([back + head / 3 * across, tip, back - head / 3 * across]))
        )
    return tuple(lines)


def extent(lines: Sequence[Line]) -> Box:
    """Return x min, y min, x max, y max of ``lines``, mm."""
    points = np.concatenate([line.points for line in lines])
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return x0, y0, x1, y1


def polyline(layer: LayerName, *points: Sequence[float]) -> Line:
    """Return an open line through ``points``, (x, y) mm each."""
    return Line(layer, np.array(points, dtype=float))


def circle(layer: LayerName, x: float, y: float, radius: float) -> Line:
    """Return a closed circle, flat to `FLATTENING_MM`."""
    step = 2 * np.arccos(1 - FLATTENING_MM / radius)
    around = np.linspace(0.0, 2 * np.pi, int(np.ceil(2 * np.pi / step)), endpoint=False)
    ring = np.stack([x + radius * np.cos(around), y + radius * np.sin(around)], axis=1)
    return Line(layer, ring, closed=True)


def ruler(left: float, y: float) -> tuple[Line, ...]:
    """Return a bar of `RULER_MM` from (``left``, ``y``) on, with ticks above it."""
    lines = [polyline("REF", (left, y), (left + RULER_MM, y))]
    for k in range(11):
        x, length = left + k * RULER_MM / 10, 3.0 if k % 5 == 0 else 1.5
        lines.append(polyline("REF", (x, y + length), (x, y)))
    return tuple(lines)


def wrapped(text: str, height: float, width: float) -> list[str]:
    """Break ``text`` into lines no wider than ``width``; a longer word stays whole."""
    rows: list[str] = []
    for word in text.split(" "):
        if rows and text_width(f"{rows[-1]} {word}", height) <= width:
            rows[-1] += f" {word}"
        else:
            rows.append(word)
    return rows


def _rounded(line: FloatArray) -> FloatArray:
    """Return the points at ``DECIMALS``, with no negative zero."""
    return np.asarray(np.round(line, DECIMALS) + 0.0)
