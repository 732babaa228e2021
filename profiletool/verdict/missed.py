"""Stretches of a profile that a chosen actuator misses: where they lie, and why."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from profiletool.bending.model import Model
from profiletool.joints.bounds import cuts_of, wrap_mm
from profiletool.joints.closest import STEP_MM, closest_points, target_points
from profiletool.joints.optimal.bends import tabulate
from profiletool.joints.optimal.choose import Choice
from profiletool.records.profile import Profile
from profiletool.records.request import TubeSpec
from profiletool.records.units import BAR_PER_MPA, FloatArray

FAR_OFF = 4.0  # times the tolerance: a place that is missed
_NEAR_MM = 10.0  # missed places so near each other are one; what lies so near may be the cause
_HALF_MM = 2.5  # each way, over which the profile's curvature counts
_SLACK_MM = 0.05
_SENSES = {1.0: "toward the object", -1.0: "away from the object"}


@dataclass(frozen=True)
class Missed:
    """A stretch of the profile that the actuator does not follow.

    Attributes
    ----------
    start, end : float, mm
        Arc lengths.
    off_mm : float
        Distance of its worst point.
    reason : str
    """

    start: float
    end: float
    off_mm: float
    reason: str


def tightest_radius(model: Model, spec: TubeSpec, pressure: float, sense: float) -> float:
    """Give the least radius of an arc that joints in a row follow, mm.

    The circle that touches the wrapped sectors of equal joints, as close to each other as they
    may be; infinite where no joint bends.

    Parameters
    ----------
    model : Model
    spec : TubeSpec
    pressure : float, MPa
    sense : float
        +1 toward the object, -1 away from it.
    """
    bends = tabulate(model, pressure, cuts_of(model, spec), sense)
    wrap = 0.5 * wrap_mm(spec)
    radii = [np.inf]
    for least, most, reach in zip(bends.least, bends.most, bends.reach, strict=True):
        if most > least:
            turn = np.linspace(least, most, len(reach))
            radii.append(float(np.min((reach + wrap) / np.tan(0.5 * turn))))
    return min(radii)


def missed(
    profile: Profile,
    choice: Choice,
    model: Model,
    spec: TubeSpec,
    tolerance_mm: float,
    place: Callable[[float], str] | None = None,
) -> tuple[Missed, ...]:
    """Find the stretches that a choice misses by more than `FAR_OFF` tolerances, and say why.

    ``place`` says in words where an arc length on the profile is.
    """
    say = place or (lambda s: f"{s:.0f} mm down the profile")
    points = target_points(profile)
    s = np.linspace(0.0, profile.length_mm, len(points))
    off = np.abs(closest_points(choice.shape.facing, points, profile.sign).distance)
    most = choice.limits.pressure[1]
    radii = {sense: tightest_radius(model, spec, most, sense) for sense in _SENSES}
    tip = np.hypot(*(points - choice.shape.facing[-1]).T)
    # As much more tube as the last point is away would be too much.
    short = choice.chain.length + tip[-1] > spec.max_length_mm + _SLACK_MM
    results = []
    for first, last in _runs(off > FAR_OFF * tolerance_mm):
        start, end, worst = float(s[first]), float(s[last]), float(off[first : last + 1].max())
        here = f"{say(start)} to {say(end)}" if end - start > 1.0 else say(start)
        ends = last == len(s) - 1 and short and tip[last] <= off[last] + _SLACK_MM
        if ends:
            why = (
                f"the tube ends here: it may be {spec.max_length_mm:g} mm long, and the "
                f"profile is {profile.length_mm:.0f} mm; take a shorter stretch "
                "(`start_pct`, `end_pct`) or raise `max_length_mm`"
            )
        else:
            tight = _tightest(profile, start - _NEAR_MM, end + _NEAR_MM, radii)
            why = tight.format(bar=BAR_PER_MPA * most) if tight else _other(choice)
        results.append(Missed(start, end, worst, f"{here}: up to {worst:.1f} mm off; {why}"))
    return tuple(results)


def reasons(
    profile: Profile,
    choice: Choice,
    model: Model,
    spec: TubeSpec,
    tolerance_mm: float,
    place: Callable[[float], str] | None = None,
) -> tuple[str, ...]:
    """Reasons why a profile cannot be followed to the tolerance; none where it is."""
    texts = [m.reason for m in missed(profile, choice, model, spec, tolerance_mm, place)]
    if choice.chain.length > spec.max_length_mm + _SLACK_MM:
        texts.append(
            f"the tube would be {choice.chain.length:.1f} mm long, more than "
            f"{spec.max_length_mm:g} mm; shorten the stretch (`start_pct`, `end_pct`), or "
            "raise `max_length_mm`"
        )
    if choice.misfit.rms_mm > tolerance_mm and not texts:
        texts.append(
            f"the shape lies {choice.misfit.rms_mm:.2f} mm RMS off the profile, more than "
            f"{tolerance_mm:g} mm; {_other(choice)}"
        )
    return tuple(texts)


def _runs(where: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last indices of stretches of True, those near each other joined."""
    runs: list[tuple[int, int]] = []
    for index in np.flatnonzero(where):
        if runs and (index - runs[-1][1]) * STEP_MM <= _NEAR_MM:
            runs[-1] = (runs[-1][0], int(index))
        else:
            runs.append((int(index), int(index)))
    return runs


def _tightest(profile: Profile, start: float, end: float, radii: dict[float, float]) -> str:
    """Name the place between two arc lengths where the profile turns too fast; empty for none."""
    s = np.arange(max(start, 0.0), min(end, profile.length_mm), STEP_MM)
    low, high = (np.clip(s + half, 0.0, profile.length_mm) for half in (-_HALF_MM, _HALF_MM))
    turned = profile.sign * (_heading(profile, high) - _heading(profile, low))
    curvature = turned / (high - low)
    excess = {sense: float(np.max(sense * curvature * radii[sense])) for sense in radii}
    sense = max(excess, key=lambda key: excess[key])
    if excess[sense] <= 1.0:
        return ""
    tight = sense * curvature * radii[sense] > 1.0
    worst = int(np.argmax(sense * curvature))
    before = np.flatnonzero(~tight[: worst + 1])
    after = np.flatnonzero(~tight[worst:])
    a = low[before[-1] + 1] if before.size else low[0]
    b = high[worst + after[0] - 1] if after.size else high[-1]
    turn = np.degrees(abs(float(_heading(profile, b) - _heading(profile, a))))
    radius = 1.0 / float(sense * curvature[worst])
    return (
        f"from {a:.0f} to {b:.0f} mm the profile turns {turn:.0f} deg {_SENSES[sense]}, at a "
        f"radius down to {radius:.0f} mm, and joints in a row follow none tighter than "
        f"{radii[sense]:.0f} mm at {{bar:.2f}} bar"
    )


def _heading(profile: Profile, s: FloatArray) -> FloatArray:
    return np.asarray(np.interp(s, profile.s, profile.heading))


def _other(choice: Choice) -> str:
    count = len(choice.chain.openF)
    these = "this one" if count == 1 else f"these {count}"
    return f"no other choice of joints comes nearer than {these} by enough to be worth it"
