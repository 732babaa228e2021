"""The trade-off of joints and pressure against the distance off the profile: table and plot."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from profiletool.joints.optimal.choose import TradeOff
from profiletool.records.design import Design
from profiletool.records.units import BAR_PER_MPA
from profiletool.report.figure import WIDE_IN, panels
from profiletool.report.palette import BLUE, GREEN, GREY, GRID, INK, PURPLE, RED, SKY

_COLOURS = (BLUE, RED, GREEN, PURPLE, SKY, GREY)
_MARKERS = ("o", "s", "^", "D", "v", "P")
_SHOWN = 6  # numbers of joints drawn against pressure


def trade_off_csv(found: TradeOff) -> bytes:
    """Tabulate the best RMS, mm, over pressure and number of joints; empty where there is none."""
    rows = ["joints,pressure_bar,rms_mm,polished_rms_mm"]
    for j in range(found.rms_mm.shape[1]):
        polished = found.polished_mm[j]
        for p, pressure in enumerate(found.pressure):
            rms = found.rms_mm[p, j]
            if np.isfinite(rms):
                last = f"{polished:.4f}" if np.isfinite(polished) else ""
                rows.append(f"{j + 1},{BAR_PER_MPA * pressure:.2f},{rms:.4f},{last}")
    return ("\n".join(rows) + "\n").encode()


def trade_off_figure(found: TradeOff, design: Design) -> Figure:
    """Draw the RMS distance over the number of joints, and over pressure; the design is marked."""
    figure, (upper, lower) = panels(2, WIDE_IN, 7.2, below=True)
    _draw_numbers(upper, found, design)
    _draw_pressures(lower, found, design)
    for axes in (upper, lower):
        axes.set_ylabel("RMS distance to the profile (mm)")
        axes.set_yscale("log")
        axes.yaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
        for ticks in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
            ticks("{x:g}")
        axes.tick_params(axis="y", which="minor", labelsize=8)
        axes.grid(visible=True, which="both", color=GRID, lw=0.6)
        axes.legend(fontsize=9, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return figure


def _draw_numbers(axes: Any, found: TradeOff, design: Design) -> None:
    numbers = np.arange(1, found.rms_mm.shape[1] + 1)
    best = found.rms_mm.min(axis=0)
    known = np.isfinite(best)
    axes.plot(numbers[known], best[known], color=BLUE, marker="o", ms=4, label="best of\nthe grid")
    polished = np.isfinite(found.polished_mm)
    axes.plot(
        numbers[polished], found.polished_mm[polished], color=RED, marker="s", ms=5, ls="none",
        label="polished",
    )  # fmt: skip
    fit = design.fit.fe or design.fit.response or design.fit.formula
    by = "FE" if design.fit.fe is not None else "predicted"
    axes.plot(
        [len(design.joints)], [fit.rms_mm], color=INK, marker="*", ms=13, ls="none",
        label=f"chosen\n({by})",
    )  # fmt: skip
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.set_xlabel("joints")


def _draw_pressures(axes: Any, found: TradeOff, design: Design) -> None:
    chosen = len(design.joints)
    known = np.flatnonzero(np.isfinite(found.rms_mm.min(axis=0))) + 1
    some = known[:: max(1, int(np.ceil(len(known) / _SHOWN)))]
    shown = sorted({*some.tolist(), *({chosen} & set(known.tolist()))})
    for k, number in enumerate(shown):
        axes.plot(
            BAR_PER_MPA * found.pressure,
            found.rms_mm[:, number - 1], color=_COLOURS[k % len(_COLOURS)],
            marker=_MARKERS[k % len(_MARKERS)], ms=4, lw=2.4 if number == chosen else 1.3,
            label=f"{number} joint{'s' * (number > 1)}",
        )  # fmt: skip
    axes.axvline(design.pressure_bar, color=INK, lw=1.0, ls=(0, (4, 3)), label="chosen")
    axes.set_xlabel("pressure (bar)")
