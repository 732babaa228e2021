"""What both writers draw: plain polylines on layers, mm, x along the tube, y up along the roll."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from profiletool.records import FloatArray
from profiletool.template.strokes import text_strokes, text_width
from profiletool.template.unroll import SeamChoice, Slit

LayerName = Literal["CUT_OUTER", "CUT_INNER", "MARK", "NOTE", "REF"]
Anchor = Literal["left", "centre", "right"]
Box = tuple[float, float, float, float]

# Layer: (AutoCAD colour index, the same colour for SVG).
COLOURS: dict[LayerName, tuple[int, str]] = {
    "CUT_OUTER": (7, "#000000"),
    "CUT_INNER": (5, "#0000ff"),
    "MARK": (3, "#00a000"),
    "NOTE": (1, "#ff0000"),
    "REF": (8, "#808080"),
}
# Coordinates end at a nanometre: the last bits of a sum are not the same on every machine.
DECIMALS = 6


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
    """An open polyline on a layer: ``points`` (N, 2) mm."""

    layer: LayerName
    points: FloatArray


@dataclass(frozen=True)
class Layer:
    """The polylines of one layer, (N, 2) mm each; ``closed`` ones do not repeat a point."""

    name: LayerName
    lines: tuple[FloatArray, ...]
    closed: bool = False


@dataclass(frozen=True)
class Sheet:
    """A cut template.

    Attributes
    ----------
    title : str
        What it is a template of.
    size_mm : (float, float)
        The piece of gauze: along the tube, along the roll.
    outline : (N, 2) float
        Its closed outline, first point not repeated, counter-clockwise.
    slits : tuple of Slit
        Joint by joint, row by row, along the roll.
    drawn : tuple of Line
        What is drawn on MARK, NOTE and REF other than lettering.
    texts : tuple of Text
        The lettering.
    seam : SeamChoice
        The weld line and what it crosses.
    """

    title: str
    size_mm: tuple[float, float]
    outline: FloatArray
    slits: tuple[Slit, ...]
    drawn: tuple[Line, ...]
    texts: tuple[Text, ...]
    seam: SeamChoice

    @property
    def layers(self) -> tuple[Layer, ...]:
        """All that is to be drawn, layer by layer, in the order to draw it."""
        cuts = tuple(np.array([[s.x_mm, s.y_start_mm], [s.x_mm, s.y_end_mm]]) for s in self.slits)
        found: dict[LayerName, list[FloatArray]] = {name: [] for name in COLOURS}
        found["CUT_OUTER"].append(self.outline)
        found["CUT_INNER"].extend(cuts)
        for line in self.drawn:
            found[line.layer].append(line.points)
        for text in self.texts:
            found[text.layer].extend(text.lines())
        return tuple(
            Layer(name, tuple(_rounded(line) for line in found[name]), name == "CUT_OUTER")
            for name in COLOURS
        )

    @property
    def bounds(self) -> Box:
        """The extent of everything drawn: x min, y min, x max, y max, mm."""
        points = np.concatenate([line for layer in self.layers for line in layer.lines])
        (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        return x0, y0, x1, y1


def _rounded(line: FloatArray) -> FloatArray:
    """Return the points at ``DECIMALS``, with no negative zero."""
    return np.asarray(np.round(line, DECIMALS) + 0.0)
