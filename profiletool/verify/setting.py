"""The pressure at which a finished actuator fits, from its tip or its angles.

Rubber, wall and pressure are one direction: what is c times as stiff as planned stands at a
pressure P where the nominal actuator stands at P / c. The trim table says where that is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import floor

import numpy as np
from scipy.optimize import minimize_scalar

from profiletool.errors import Infeasible, UsageError
from profiletool.records.design import Design
from profiletool.records.setting import AngleReading, PressureSetting
from profiletool.records.units import FloatArray
from profiletool.verify.readings import Readings, joints_off
from profiletool.verify.trim_curves import Curves, curves_of

MOST_BAR = 20.0
_FINE = 400  # places on the tip's way between two rows of the table
_OUTSIDE_MM = 0.1  # of the end of the tip's way, along it, before a tip lies beyond
_OFF_SHARE = 0.03  # of the tube's length: a tip further off its way is not off by stiffness alone
_SCATTER = 3.0  # standard deviations that angles may scatter by
_ROUNDING_BAR = 5e-3  # half of what a pressure is rounded to
_TURNS = 8  # of choosing the readings within the table


def trim_pressure(
    design: Design,
    *,
    tip_mm: tuple[float, float] | None = None,
    at_bar: float | None = None,
    angles: Sequence[AngleReading] | None = None,
) -> PressureSetting:
    """Find the pressure at which a finished actuator fits.

    Parameters
    ----------
    design : Design
        Verified, with its trim table: what the actuator was built from.
    tip_mm : (x, y), optional
        Where its tip stands, the end of the object-facing line, in the object's frame.
    at_bar : float, optional
        The pressure that it stands there at.
    angles : sequence of AngleReading, optional
        In place of the tip: angles of its joints, measured near the planned pressure; `read_angles`
        takes them from a file.

    Returns
    -------
    PressureSetting
        ``pressure_bar`` is to be set.

    Raises
    ------
    UsageError, UnreadableInput
    Infeasible
        It would take more pressure than finite elements checked.
    """
    if (angles is None) != (tip_mm is not None) or (tip_mm is None) != (at_bar is None):
        raise UsageError("give either `tip_mm` and `at_bar`, or `angles`")
    if tip_mm is not None and at_bar is not None:
        return by_tip(design, tip_mm, at_bar)
    return by_angles(design, angles or ())


def by_tip(design: Design, tip_mm: tuple[float, float], at_bar: float) -> PressureSetting:
    """Find the pressure at which an actuator fits from where its tip stands.

    Parameters
    ----------
    design : Design
        With a trim table.
    tip_mm : (x, y)
        End of the object-facing line, in the object's frame.
    at_bar : float
        The pressure that was set.

    Raises
    ------
    UsageError, UnreadableInput, Infeasible
    """
    curves = curves_of(design)
    if not 0.0 < at_bar <= MOST_BAR:
        raise UsageError(f"the tip stands at 0 to {MOST_BAR:g} bar, not at {at_bar:g}")
    if not np.isfinite(tip_mm).all():
        raise UsageError("the tip has two finite numbers, x and y in mm")
    tip = np.asarray(tip_mm)
    bar, outside = _nearest(curves, tip)
    off = float(np.linalg.norm(curves.tip(bar) - tip))
    notes = []
    if not outside and off > _OFF_SHARE * curves.length_mm:
        notes.append(
            f"the tip lies {off:.1f} mm off its way, which no stiffness explains: a joint is off "
            "by itself, or the clamp is; the angles of all joints would tell"
        )
    found = PressureSetting(0.0, curves.planned, at_bar / bar, off_mm=off, notes=tuple(notes))
    return _set(design, curves, found, outside)


def by_angles(design: Design, readings: Sequence[AngleReading]) -> PressureSetting:
    """Find the pressure at which an actuator fits from angles of its joints.

    One stiffness is fitted to all readings by least squares, each over its standard deviation.
    Readings at pressures outside the table do not count.

    Parameters
    ----------
    design : Design
        With a trim table.
    readings : sequence of AngleReading

    Raises
    ------
    UsageError, UnreadableInput, Infeasible
    """
    curves = curves_of(design)
    if not readings:
        raise UsageError("no angles given")
    data = Readings.of(readings, curves)
    stiffness = data.stiffness(curves)
    used = data
    for _ in range(_TURNS):
        inside = data.inside(curves, stiffness)
        if not inside.any():
            break
        used = data.chosen(inside)
        last, stiffness = stiffness, used.stiffness(curves)
        if abs(last - stiffness) < 1e-9:
            break
    inside = data.inside(curves, stiffness)
    outside = 0
    if not inside.any():
        used, middle = data, float(np.median(data.bars)) / stiffness
        outside = 1 if middle > curves.top else -1
    off = used.off(curves, stiffness)
    rms = float(np.sqrt(np.mean(off**2)))
    apart = joints_off(used, curves)
    notes = [
        f"joint {joint} is {mean:+.1f} deg off by itself, which no pressure takes out: look at its "
        "slits, threads and welds"
        for joint, mean in apart.items()
    ]
    if not apart and rms > _SCATTER * float(np.median(used.sigma)):
        notes.append(
            f"the angles scatter by {rms:.1f} deg about what one stiffness explains: measure again"
        )
    if (left := int((~inside).sum())) and not outside:
        notes.append(f"{left} of {len(inside)} angles lie outside the trim table and do not count")
    found = PressureSetting(
        0.0, curves.planned, stiffness, rms_deg=rms, joints_off=tuple(apart), notes=tuple(notes)
    )
    return _set(design, curves, found, outside)


def _nearest(curves: Curves, tip: FloatArray) -> tuple[float, int]:
    """Find the pressure, bar, whose tip is nearest; and +1, -1 where a tip lies beyond an end."""
    fine = np.linspace(curves.bars[0], curves.top, _FINE * (len(curves.bars) - 1) + 1)
    k = int(np.argmin(np.linalg.norm(curves.tip(fine) - tip, axis=1)))
    near = minimize_scalar(
        lambda bar: float(((curves.tip(bar) - tip) ** 2).sum()),
        bounds=(fine[max(k - 1, 0)], fine[min(k + 1, len(fine) - 1)]),
        method="bounded",
        options={"xatol": 1e-9},
    )
    outside = 0
    for end, way in ((0, -1), (len(fine) - 1, 1)):
        ahead = curves.tip(fine[end], 1)
        beyond = way * float((tip - curves.tip(fine[end])) @ ahead) / float(np.linalg.norm(ahead))
        outside = way if k == end and beyond > _OUTSIDE_MM else outside
    return float(near.x), outside


def _set(design: Design, curves: Curves, found: PressureSetting, outside: int) -> PressureSetting:
    """Round the pressure to set, and refuse one that finite elements have not seen.

    ``outside``: +1 where it was measured beyond the table's top, -1 below its first row.
    """
    low, top, notes = curves.bars[0], curves.top, list(found.notes)
    fits = found.stiffness * curves.planned
    bar = min(round(fits, 2), floor(100.0 * top + 1e-6) / 100.0)
    if fits > top + _ROUNDING_BAR:
        least = "at least " if outside < 0 else ""
        raise Infeasible(
            f"this actuator is {least}{found.stiffness:.2f} times as stiff as planned and would "
            f"need {least}{fits:.2f} bar, but finite elements checked it up to {top:.2f} bar only: "
            "cast it softer or thinner, or design it anew for its own rubber"
        )
    if outside:
        bound = "at most" if outside > 0 else "at least"
        notes.append(
            f"it was measured beyond the trim table ({low:.2f} to {top:.2f} bar): {bound} "
            f"{bar:.2f} bar fits; set that, and measure again"
        )
    operate = None if outside else on_object(design, found.stiffness)
    return replace(
        found, pressure_bar=bar, beyond=bool(outside), operate_bar=operate, notes=tuple(notes)
    )


def on_object(design: Design, stiffness: float, dead_bar: float = 0.0) -> float | None:
    """Pressure to set against the object on an actuator of a stiffness, bar."""
    at = design.operate_bar
    return None if at is None else round(stiffness * at + dead_bar, 2)
