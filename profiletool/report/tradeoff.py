"""What more joints and more pressure bring: a table and a plot."""

from __future__ import annotations

import numpy as np

from profiletool.joints.optimal import TradeOff
from profiletool.records import Design
from profiletool.report.figure import panels, png
from profiletool.report.palette import BLUE, GREEN, GREY, INK, PURPLE, RED, SKY

_BAR = 10.0  # in a MPa
_COLOURS = (BLUE, RED, GREEN, PURPLE, SKY, GREY)
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
                rows.append(f"{j + 1},{_BAR * pressure:.2f},{rms:.4f},{last}")
    return ("\n".join(rows) + "\n").encode()


def draw_trade_off(found: TradeOff, design: Design) -> bytes:
    """Draw the error against the number of joints, and against pressure, as PNG."""
    figure, (left, right) = panels(2, 10.0, 4.4)
    numbers = np.arange(1, found.rms_mm.shape[1] + 1)
    best = found.rms_mm.min(axis=0)
    known = np.isfinite(best)
    left.plot(numbers[known], best[known], color=BLUE, marker="o", ms=4, label="best of the grid")
    polished = np.isfinite(found.polished_mm)
    left.plot(
        numbers[polished], found.polished_mm[polished], color=RED, marker="s", ms=5, ls="none",
        label="polished",
    )  # fmt: skip
    chosen, fit = len(design.joints), design.fit.fe or design.fit.response or design.fit.formula
    by = "FE" if design.fit.fe is not None else "predicted"
    left.plot(
        [chosen], [fit.rms_mm], color=INK, marker="*", ms=13, ls="none", label=f"chosen ({by})"
    )
    left.set_xlabel("joints")
    some = numbers[known][:: max(1, int(np.ceil(known.sum() / _SHOWN)))]
    shown = sorted({*some.tolist(), *([chosen] if chosen in numbers[known] else [])})
    for k, number in enumerate(shown):
        right.plot(
            _BAR * found.pressure, found.rms_mm[:, number - 1], color=_COLOURS[k % len(_COLOURS)],
            marker="o", ms=4, lw=2.4 if number == chosen else 1.3,
            label=f"{number} joint{'s' * (number > 1)}",
        )  # fmt: skip
    right.axvline(design.pressure_bar, color=INK, lw=1.0, ls=(0, (4, 3)), label="chosen")
    right.set_xlabel("pressure (bar)")
    for axes in (left, right):
        axes.set_ylabel("RMS distance to the profile (mm)")
        axes.set_yscale("log")
        for ticks in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
            ticks("{x:g}")
        axes.tick_params(axis="y", which="minor", labelsize=7)
        axes.grid(visible=True, which="both", alpha=0.25)
        axes.legend(fontsize=8, frameon=False)
    return png(figure)
