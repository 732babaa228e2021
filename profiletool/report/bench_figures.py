"""Figures of a measurement: the paper's Figs. 3 and 4, and measured against predicted angles."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from profiletool.report.bench import NAMES, BenchOutput
from profiletool.report.figure import WIDE_IN, legend_below, panels, styles, titled
from profiletool.report.palette import GREY

_BARS = 2.0  # standard deviations that an error bar shows
_COLUMNS = 4


def angles_figure(output: BenchOutput) -> Figure:
    """Draw measured angles against pressure, with those predicted (paper, Fig. 3)."""
    theta, sigma = output.measured
    count = theta.shape[1]
    figure, (axes,) = panels(1, WIDE_IN + 1.0, 4.6 + 0.2 * (count // _COLUMNS))
    bars = np.array([one.pressure_bar for one in output.seen])
    fine = np.linspace(0.0, bars.max(initial=0.1), 80)
    predicted = output.predicted
    axes.axhline(0.0, color=GREY, lw=0.8, zorder=1)
    order = np.argsort(bars, kind="stable")
    for k, (colour, marker) in enumerate(styles(count)):
        axes.errorbar(
            bars, theta[:, k], yerr=_BARS * sigma[:, k], color=colour, marker=marker, ms=4.5,
            ls="none", capsize=2.5, zorder=4, label=f"joint {k + 1}, measured",
        )  # fmt: skip
        curve = np.interp(fine, predicted.pressure_bar, predicted.theta_deg[:, k])
        first = k == 0
        axes.plot(fine, curve, color=colour, lw=1.5, label=NAMES[output.by] if first else None)
        axes.plot(
            bars[order], output.formula[order, k], color=colour, lw=1.0, ls=(0, (4, 3)),
            label="the formula" if first else None,
        )  # fmt: skip
    axes.set_xlabel("pressure (bar)")
    axes.set_ylabel("joint angle θ (deg), positive toward the object")
    titled(axes, "Bars: two standard deviations")
    legend_below(figure, axes, 3)
    return figure


def regression_figure(output: BenchOutput) -> Figure:
    """Draw measured against predicted angles, and what is between them."""
    figure, (left, right) = panels(2, 9.6, 4.6)
    theta = output.measured[0]
    styled = styles(theta.shape[1])
    for k, (colour, marker) in enumerate(styled):
        style: dict[str, Any] = {"color": colour, "marker": marker, "ms": 4.5, "ls": "none"}
        left.plot(output.fe[:, k], theta[:, k], label=f"joint {k + 1}", **style)
        mean = 0.5 * (output.fe[:, k] + theta[:, k])
        right.plot(mean, theta[:, k] - output.fe[:, k], **style)
    ends = np.array([np.nanmin(output.fe), np.nanmax(output.fe)])
    left.plot(ends, ends, color=GREY, lw=1.0)
    whole = output.compared[output.by][1]
    if whole is not None:
        left.plot(ends, whole.slope * ends + whole.intercept_deg, color=GREY, lw=1.0, ls="--")
        for at in (whole.bias_deg, *whole.limits_deg):
            right.axhline(at, color=GREY, lw=1.0, ls="-" if at == whole.bias_deg else "--")
        titled(left, f"slope {whole.slope:.3f}, R² {whole.r2:.4f}")
        titled(right, f"bias {whole.bias_deg:+.2f}°, limits of agreement dashed")
    name = NAMES[output.by]
    left.set_xlabel(f"by {name} (deg)")
    left.set_ylabel("measured (deg)")
    right.set_xlabel("mean of both (deg)")
    right.set_ylabel(f"measured less {name} (deg)")
    left.legend(frameon=False, fontsize=9)
    return figure


def ways_figure(output: BenchOutput) -> Figure:
    """Draw the ways of the phalanxes' midpoints, measured and predicted (paper, Fig. 4)."""
    figure, (axes,) = panels(1, 7.2, 5.6)
    order = sorted(range(len(output.seen)), key=lambda k: output.seen[k].pressure_bar)
    ways = np.array([output.seen[k].phalanges_mm for k in order])
    for k, (colour, marker) in enumerate(styles(ways.shape[1] - 1), start=1):
        axes.plot(*ways[:, k].T, color=colour, marker=marker, ms=4.5, lw=1.2, label=f"phalanx {k}")
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.1)
    axes.set_xlabel("x (mm), along the clamped tube")
    axes.set_ylabel("y (mm), toward the object")
    titled(axes, "Midpoints of the wrapped sectors, as measured")
    axes.legend(frameon=False, fontsize=9.5)
    return figure
