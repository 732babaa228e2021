"""The section on setting the pressure of a finished actuator: what to do, and the trim table."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot

from profiletool.records.built import TrimPoint
from profiletool.records.design import Design
from profiletool.records.options import FLAGS
from profiletool.report.markup import Markup, joined, signed, table, tag
from profiletool.report.steps import Step, origin_of
from profiletool.template.notes import CYCLES, alone

_NOTHING = "–"
_FULL = 1.0999  # of the planned pressure: what the table should reach
_ROUNDING_BAR = 5e-3


def trimming(design: Design, most_bar: float) -> Markup:
    """Tell how to set the pressure on a finished actuator.

    Parameters
    ----------
    design : Design
        With a trim table.
    most_bar : float
        Highest pressure that was asked for.
    """
    told = (tag("li", tag("h3", step.title), step.body) for step in _steps(design, most_bar))
    return joined((tag("ol", *told, class_="steps"), trim_table(design)))


def trim_table(design: Design) -> Markup:
    """Tabulate tip and angles around the planned pressure, and what to set on an actuator there."""
    planned = design.planned
    heads = (
        "P (bar)", "tip x (mm)", "tip y (mm)", "off the planned tip (mm)",
        *(f"θ{joint.number} (°)" for joint in design.joints), "set (bar)",
    )  # fmt: skip
    rows = [_row(point, planned, design.trim[-1].pressure_bar) for point in design.trim]
    said = (
        "Where an actuator as planned stands at pressures around the planned one, by finite "
        f"elements: its tip from {origin_of(design)}, x to the right and y up, and its angles, "
        "positive toward the object. Last column: what to set on an actuator that stands there at "
        f"{planned.pressure_bar:.2f} bar; no number where that is more than was checked."
    )
    return table(heads, rows, said)


def _steps(design: Design, most_bar: float) -> Iterator[Step]:
    planned, top = design.planned, design.trim[-1].pressure_bar
    why = (
        "It is 1.1 times the planned pressure, and the highest that finite elements checked"
        if top > _FULL * planned.pressure_bar
        else "It is the highest at which finite elements found the actuator stable"
    )
    more = f" It is above the {most_bar:.2f} bar asked for: see that supply and fittings bear it."
    said = (
        f"Inflate {CYCLES} times to {top:.2f} bar and let the air out again: silicone softens in "
        f"its first cycles. {why}. Never go above it{alone(design)}."
        f"{more if top > most_bar else ''}"
    )
    yield Step("Precondition", tag("p", said))
    said = (
        "Take the object away, for the finger must not touch it. Set "
        f"{planned.pressure_bar:.2f} bar and wait for a minute: the rubber gives way by some 5 % "
        "within minutes."
    )
    yield Step("Wait a minute", tag("p", said))
    x, y = (signed(value) for value in planned.tip_mm)
    said = (
        "The tip is the end of the line that faces the object, at the closed end. As planned it "
        f"stands at x {x} mm, y {y} mm from {origin_of(design)}, x to the right and y up; "
    )
    shown = (tag("code", "mounting.pdf"), " shows it at true scale.")
    yield Step("Measure the tip, or the angles", tag("p", said, *shown))
    yield Step("Set the pressure", joined(_setting(design, planned)))


def _setting(design: Design, planned: TrimPoint) -> Iterator[Markup]:
    x, y = planned.tip_mm
    bar = planned.pressure_bar
    tip, at, angles = (FLAGS[name] for name in ("tip_mm", "at_bar", "angles"))
    yield tag(
        "p",
        "Stiffer rubber or a thicker wall acts as less pressure would, softer rubber as more. Find "
        "the row of the table where the actuator stands, and set what its last column says. To "
        "interpolate, and to see whether a joint is off by itself, take ",
        tag("code", f"profiletool trim design.json {tip} {x:.1f},{y:.1f} {at} {bar:.2f}"),
        " with the tip that you measured, or ",
        tag("code", f"{angles} FILE.csv"),
        " with the angles.",
    )
    if design.trim[-1].pressure_bar <= bar:
        yield tag(
            "p",
            f"Finite elements found no stable state above {bar:.2f} bar: an actuator that turns "
            "out stiffer than planned cannot be set. A lower operating pressure leaves room.",
            class_="mind",
        )


def _row(point: TrimPoint, planned: TrimPoint, top: float) -> tuple[str, ...]:
    bar = planned.pressure_bar
    fits = bar**2 / point.pressure_bar
    off = hypot(*(a - b for a, b in zip(point.tip_mm, planned.tip_mm, strict=True)))
    cells = (
        f"{point.pressure_bar:.3g}" if point.pressure_bar < 0.1 else f"{point.pressure_bar:.2f}",
        *(signed(value) for value in point.tip_mm),
        f"{off:.1f}",
        *(signed(theta) for theta in point.theta_deg),
        f"{fits:.2f}" if fits <= top + _ROUNDING_BAR else _NOTHING,
    )
    if point is not planned:
        return cells
    first, *rest = (tag("strong", cell) for cell in cells)
    return (joined((first, " planned")), *rest)
