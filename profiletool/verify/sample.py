"""Single builds with errors of their own, by finite elements: the check of the linear figures.

Rubber that is c times as stiff, at a pressure P, bends as the nominal one at P / c in a gauze that
is 1 / c times as stiff, and 1 / c times as heavy.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fem.equilibrium import lagrange
from fem.errors import BadGeometry, NotConverged
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

# Of the nominal pressure, in rubber of nominal stiffness: where the best pressure is looked for.
_ABOUT = np.array([0.92, 0.96, 1.0, 1.04, 1.08])
_APART = 0.01  # of it: nearer states tell no more than one
_ROUNDS, _STEP_SHARE = 4, 1e-3  # of Gauss-Newton, and of its differences
_SLACK = 1e-9  # MPa


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
    thread = float(np.degrees(design.thread_rad))
    joints = tuple(
        replace(
            joint,
            alpha_closed_deg=joint.alpha_closed_deg + thread * threads,
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
    weight = actuator.weight
    if weight is not None:
        rubber, cloth = weight.rubber / stiffer, weight.gauze / stiffer
        weight = replace(weight, rubber=rubber, gauze=cloth)
    nominal = design.pressure_bar / BAR_PER_MPA
    off = draw.pressure_bar / BAR_PER_MPA / stiffer
    as_set = nominal / stiffer + off
    about = nominal * _ABOUT
    asked = sorted([as_set, *about[np.abs(about - as_set) > _APART * nominal].tolist()])
    try:
        solution = solve(replace(actuator, gauze=gauze, weight=weight), asked, threads=1)
    except NotConverged as error:
        if not isinstance(error.solution, Solution):
            return SampledBuild(np.nan, np.nan, shortly(error))
        solution = error.solution
    except BadGeometry as error:
        return SampledBuild(np.nan, np.nan, str(error))
    line = _Lines(solution, design, points)
    trim = line.best_pressure(nominal)
    if not line.pressure[0] < trim < line.pressure[-1]:
        return SampledBuild(np.nan, np.nan, "its best pressure is beyond those looked at")
    if max(as_set, trim + off) > line.pressure[-1] + _SLACK:
        why = "" if solution.critical is None else f": {said(ended(solution.critical))}"
        return SampledBuild(np.nan, np.nan, f"it does not bear the pressure{why}")
    return SampledBuild(line.rms(as_set), line.rms(trim + off))


class _Lines:
    """The line of one build at any pressure: a polynomial through the states of its run."""

    def __init__(self, solution: Solution, design: Design, points: FloatArray) -> None:
        self._points, self._sign = points, side_sign(design.source.side)
        states = [state for state in solution.states if state.pressure > 0.0]
        self.pressure = np.array([state.pressure for state in states])
        self._facing = np.array(
            [
                shape_of(solution.mesh, state, design.base_pose, self._sign).facing
                for state in states
            ]
        )

    def gaps(self, pressure: float) -> FloatArray:
        """Signed distances at a pressure in MPa: (M,) mm."""
        facing = np.tensordot(lagrange(self.pressure, pressure), self._facing, 1)
        return closest_points(facing, self._points, self._sign).distance

    def rms(self, pressure: float) -> float:
        """Root mean square of the distances at a pressure in MPa, mm."""
        return float(np.sqrt(np.mean(self.gaps(pressure) ** 2)))

    def best_pressure(self, guess: float) -> float:
        """Give the pressure at which the build fits best, MPa, within what its states span."""
        low, high = self.pressure[0], self.pressure[-1]
        at = float(np.clip(guess, low, high))
        for _ in range(_ROUNDS):
            step = _STEP_SHARE * at
            gap = self.gaps(at)
            slope = (self.gaps(at + step) - self.gaps(at - step)) / (2.0 * step)
            at = float(np.clip(at - float(gap @ slope) / float(slope @ slope), low, high))
        return at
