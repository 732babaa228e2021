"""Single builds with errors of their own, by finite elements: the check of the linear figures.

Rubber that is c times as stiff, at a pressure P, bends as the nominal one at P / c in a gauze that
is 1 / c times as stiff.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fem.errors import BadGeometry, NotConverged
from fem.near import solve_near
from fem.solution import Solution
from fem.solver import solve
from profiletool.joints.closest import closest_points
from profiletool.records.built import BuildErrors
from profiletool.records.design import Design
from profiletool.records.side import side_sign
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.built import draws
from profiletool.verify.lines import shape_of
from profiletool.verify.run import ended, said, shortly
from profiletool.verify.tube import actuator_of

_TRIAL_SHARE = 0.01  # of the pressure: the first step of a trim
_TRIMS = 2


@dataclass(frozen=True)
class BuildDraw:
    """The errors of one build: bar, threads, shares of rubber and wall, mm; n joints.

    Attributes
    ----------
    pressure_bar, rubber, wall : float
    threads, cut_mm, place_mm : tuple of float
        (n,) each.
    """

    pressure_bar: float
    threads: tuple[float, ...]
    rubber: float
    wall: float
    cut_mm: tuple[float, ...]
    place_mm: tuple[float, ...]


@dataclass(frozen=True)
class SampledBuild:
    """How far one build lies off the profile, RMS in mm, and why it is not known where it is not.

    Attributes
    ----------
    as_set_mm, trimmed_mm : float
        Before and after the pressure was set on it; NaN where ``failure`` says why.
    failure : str or None
    """

    as_set_mm: float
    trimmed_mm: float
    failure: str | None = None


def draws_of(build: BuildErrors, joints: int, count: int) -> tuple[BuildDraw, ...]:
    """Draw the errors of builds: the same every time."""
    amounts = draws((count, 3 + 3 * joints))
    names = ["pressure", "rubber", "wall"]
    names += [name for name in ("thread", "cut", "place") for _ in range(joints)]
    amounts *= [build.sigma(name) for name in names]
    many = [amounts[:, 3 + k * joints : 3 + (k + 1) * joints].tolist() for k in range(3)]
    return tuple(
        BuildDraw(pressure, tuple(threads), 0.01 * rubber, 0.01 * wall, tuple(cut), tuple(place))
        for (pressure, rubber, wall), threads, cut, place in zip(
            amounts[:, :3].tolist(), *many, strict=True
        )
    )


def drawn(design: Design, draw: BuildDraw) -> Design:
    """Design with the threads, the cuts, the places and the wall of a build."""
    thread = np.degrees(2.0 * design.gauze.pitch_mm / design.tube.outer_diameter_mm)
    joints = tuple(
        replace(
            joint,
            alpha_closed_deg=joint.alpha_closed_deg + float(thread) * threads,
            openF_mm=joint.openF_mm + cut,
            centre_mm=joint.centre_mm + place,
        )
        for joint, threads, cut, place in zip(
            design.joints, draw.threads, draw.cut_mm, draw.place_mm, strict=True
        )
    )
    wall = design.tube.wall_mm * (1.0 + draw.wall)
    return replace(design, joints=joints, tube=replace(design.tube, wall_mm=wall))


def run_draw(design: Design, draw: BuildDraw, points: FloatArray) -> SampledBuild:
    """Run one build, set its pressure, and measure it both times.

    Parameters
    ----------
    design : Design
    draw : BuildDraw
    points : (M, 2) mm
        Of the profile, evenly spaced.
    """
    stiffer = 1.0 + draw.rubber
    actuator = actuator_of(drawn(design, draw))
    gauze = replace(actuator.gauze, stiffness=actuator.gauze.stiffness / stiffer)
    actuator = replace(actuator, gauze=gauze)
    planned = design.pressure_bar / BAR_PER_MPA / stiffer
    off = draw.pressure_bar / BAR_PER_MPA / stiffer
    sign = side_sign(design.source.side)

    def gaps(solution: Solution) -> FloatArray:
        if solution.critical is not None:
            raise _Ended(said(ended(solution.critical)))
        shape = shape_of(solution.mesh, solution.states[-1], design.base_pose, sign)
        return closest_points(shape.facing, points, sign).distance

    def near(known: Solution, pressure: float) -> Solution:
        return solve_near(actuator, known, pressure, threads=1)

    try:
        planned_state = solve(actuator, [planned], threads=1)
        trim = _trimmed(near, gaps, planned_state, planned)
        states = (near(planned_state, planned + off), near(planned_state, trim + off))
        as_set, trimmed = (float(np.sqrt(np.mean(gaps(state) ** 2))) for state in states)
    except NotConverged as error:
        return SampledBuild(np.nan, np.nan, shortly(error))
    except (BadGeometry, _Ended) as error:
        return SampledBuild(np.nan, np.nan, str(error))
    return SampledBuild(as_set, trimmed)


class _Ended(Exception):
    """A build ended at a limit point."""


def _trimmed(
    near: Callable[[Solution, float], Solution],
    gaps: Callable[[Solution], FloatArray],
    known: Solution,
    planned: float,
) -> float:
    """Give the pressure at which a build fits best, MPa: Gauss-Newton with secants."""
    before, gap = planned, gaps(known)
    at = planned * (1.0 + _TRIAL_SHARE)
    for _ in range(_TRIMS):
        known = near(known, at)
        now = gaps(known)
        slope = (now - gap) / (at - before)
        before, gap = at, now
        at = at - float(now @ slope) / float(slope @ slope)
    return at
