"""Figures of a finite-element run: angles against pressure, and trajectories of the phalanges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from profiletool.records.fe import FeState, Verification
from profiletool.records.units import FloatArray
from profiletool.report.figure import WIDE_IN, legend_below, panels, styles, titled
from profiletool.report.palette import GREY, RED

_SHOWN = 5  # outlines of the tube between rest and the highest pressure, both among them
_COLUMNS = 4  # of a legend


@dataclass(frozen=True)
class Mark:
    """Angles at one pressure to compare with: deg, signed as FE's, one a joint."""

    label: str
    pressure_bar: float
    theta_deg: Sequence[float]


def theta_figure(found: Verification, title: str, marks: Sequence[Mark] = ()) -> Figure:
    """Draw the angle of every joint against pressure."""
    rows = found.theta_deg
    figure, (axes,) = panels(1, WIDE_IN, 4.2 + 0.2 * ((len(rows) + len(marks)) // _COLUMNS))
    pressures = [0.0, *found.pressures_bar]
    axes.axhline(0.0, color=GREY, lw=0.8, zorder=1)
    for k, (theta, (colour, marker)) in enumerate(zip(rows, styles(len(rows)), strict=True)):
        axes.plot(
            pressures, [0.0, *theta], color=colour, marker=marker, ms=4.5, lw=1.6, zorder=3,
            label=f"joint {k + 1}",
        )  # fmt: skip
    for mark in marks:
        for k, (theta_deg, (colour, marker)) in enumerate(
            zip(mark.theta_deg, styles(len(rows)), strict=True)
        ):
            axes.plot(
                [mark.pressure_bar], [theta_deg], color=colour, marker=marker, ms=9, mfc="none",
                mew=1.5, ls="none", zorder=4, label=mark.label if k == 0 else None,
            )  # fmt: skip
    if found.critical is not None:
        axes.axvline(
            found.critical.pressure_bar, color=RED, lw=1.2, ls=(0, (4, 3)), zorder=2,
            label=found.critical.kind,
        )  # fmt: skip
    axes.set_xlim(0.0, 1.04 * max(found.asked_bar, *pressures))
    axes.set_xlabel("pressure (bar)")
    axes.set_ylabel("joint angle θ (deg), positive toward the object")
    titled(axes, title)
    legend_below(figure, axes, _COLUMNS)
    return figure


def trajectories_figure(found: Verification, title: str) -> Figure:
    """Draw the ways of the phalanges' midpoints as the pressure rises (paper, Fig. 4)."""
    states = [found.rest, *found.states]
    figure, (axes,) = panels(1, 7.6, 6.4)
    _draw_outlines(axes, states)
    ways = np.array([state.phalanges for state in states])
    for k, (colour, marker) in enumerate(styles(ways.shape[1] - 1), start=1):
        axes.plot(
            *ways[:, k].T, color=colour, marker=marker, ms=4, lw=1.6, zorder=4,
            label=f"phalanx {k}",
        )  # fmt: skip
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.1)
    axes.set_xlabel("x (mm), along the tube at rest")
    axes.set_ylabel("y (mm)")
    steps = "" if len(states) < 3 else f", a mark every {np.diff(found.pressures_bar)[0]:.2g} bar"
    titled(axes, f"{title}{steps}")
    axes.legend(loc="lower left", frameon=False, fontsize=9.5)
    return figure


def _draw_outlines(axes: Any, states: Sequence[FeState]) -> None:
    """Draw the tube at rest and at some pressures, said at its end."""
    shown = sorted({round(k) for k in np.linspace(0, len(states) - 1, _SHOWN)})
    for k in shown:
        shape = states[k].shape
        ring = np.concatenate([shape.facing, shape.far[::-1], shape.facing[:1]])
        axes.plot(*ring.T, color=GREY, lw=0.9, alpha=0.75, zorder=2)
        axes.annotate(
            f"{states[k].pressure_bar:.2g} bar", shape.axis[-1], xytext=_beyond(shape.axis),
            textcoords="offset points", ha="center", va="center", fontsize=9, color=GREY,
            zorder=5, bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none"},
        )  # fmt: skip


def _beyond(axis: FloatArray) -> tuple[float, float]:
    """Offset in points that sets a label beyond the tube's end."""
    along = axis[-1] - axis[-5]
    x, y = 26.0 * along / np.hypot(*along)
    return float(x), float(y)
