"""The plot of the distance between bent tube and profile, by formula, joint response and FE."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from profiletool.joints.closest import closest_points, target_points
from profiletool.records.design import Fit, Misfit
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray
from profiletool.report.figure import WIDE_IN, legend_below, panels, titled
from profiletool.report.palette import BLUE, GREEN, GREY, INK, PURPLE
from profiletool.report.scene import Scene

_APART = 4.0  # times as large: a curve that would flatten the others


@dataclass(frozen=True)
class ErrorCurve:
    """Signed distance (mm) over the profile's arc length (mm), (M,) each, and how it is drawn."""

    label: str
    gap: FloatArray
    colour: str
    dash: Any
    width: float

    @property
    def most(self) -> float:
        """Largest distance, mm."""
        return float(np.abs(self.gap).max())


def gap_along(shape: Shape, profile: Profile) -> tuple[FloatArray, FloatArray]:
    """Sample the tube's distance from the profile along the arc.

    Returns
    -------
    s, gap : (M,) mm
        Arc lengths on the profile, and signed distances there: positive where the tube stands
        off the object, negative where it is pressed into it.
    """
    points = target_points(profile)
    s = np.linspace(0.0, profile.length_mm, len(points))
    return s, closest_points(shape.facing, points, profile.sign).distance


def error_figure(scene: Scene, by_formula: Shape, title: str = "") -> Figure:
    """Draw the distances between tube and profile over the profile's arc length.

    Where one of them is far larger than the best known one, that gets a panel of its own, above
    one with all. ``by_formula`` is the tube as the formula bends it.
    """
    s, _ = gap_along(by_formula, scene.profile)
    curves = _curves(scene, by_formula)
    fine = [curve for curve in curves if curve.most <= _APART * curves[-1].most]
    rows = [fine, curves] if len(fine) < len(curves) else [curves]
    figure, panes = panels(len(rows), WIDE_IN, 1.6 + 2.4 * len(rows), below=True)
    for axes, shown in zip(panes, rows, strict=True):
        for curve in shown:
            axes.plot(
                s, curve.gap, color=curve.colour, ls=curve.dash, lw=curve.width, label=curve.label,
                zorder=2 if curve.dash == "-" else 3,
            )  # fmt: skip
        _dress(axes, scene, s, [curve.most for curve in shown])
    panes[-1].set_xlabel("arc length along the profile, from its start (mm)")
    titled(panes[0], title)
    legend_below(figure, panes[-1], 1)
    return figure


def _curves(scene: Scene, by_formula: Shape) -> list[ErrorCurve]:
    """Gather what is known, the most believable last."""
    fit: Fit = scene.design.fit
    rows: list[tuple[str, Shape | None, Misfit | None, str, Any, float]] = [
        ("formula", by_formula, fit.formula, BLUE, (0, (2, 1.5)), 1.5),
        ("joint response", scene.bent, fit.response, GREEN, (0, (6, 2)), 1.5),
        ("finite elements", scene.fe, fit.fe, PURPLE, "-", 2.2),
    ]
    return [
        ErrorCurve(
            f"{by}: {off.rms_mm:.2f} mm RMS, {off.max_mm:.2f} mm at most",
            gap_along(shape, scene.profile)[1],
            colour,
            dash,
            width,
        )
        for by, shape, off, colour, dash, width in rows
        if shape is not None and off is not None
    ]


def _dress(axes: Any, scene: Scene, s: FloatArray, most: Sequence[float]) -> None:
    """Give a panel its scale, the joints' places and the sides that the sign stands for."""
    reach = 1.3 * max(*most, 0.02)
    axes.set_xlim(float(s[0]), float(s[-1]))
    axes.set_ylim(-reach, reach)
    axes.set_ylabel("distance (mm)")
    axes.axhline(0.0, color=INK, lw=0.9, zorder=1)
    for place, joint in zip(scene.places, scene.design.joints, strict=True):
        half = 0.5 * joint.openF_mm
        axes.axvspan(place - half, place + half, color=GREY, alpha=0.13, lw=0.0, zorder=0)
        axes.text(
            place, 0.97, f"{joint.number}", transform=axes.get_xaxis_transform(), ha="center",
            va="top", fontsize=9, color=GREY, clip_on=True,
        )  # fmt: skip
    for y, va, what in ((0.9, "top", "off the object"), (0.03, "bottom", "pressed into it")):
        axes.text(
            0.012, y, what, transform=axes.transAxes, ha="left", va=va, fontsize=9, color=GREY,
            style="italic",
        )  # fmt: skip
