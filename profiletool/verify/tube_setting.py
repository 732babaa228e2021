"""The pressure at which a finished actuator fits, by finite elements of its calibrated tube."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from fem.errors import BadGeometry, NotConverged
from profiletool.errors import Infeasible, NotVerified
from profiletool.joints.misfit import misfit_to
from profiletool.records.calibrated import CalibratedTube, with_tube
from profiletool.records.design import Design
from profiletool.records.fe import Verification
from profiletool.records.frames import Shape
from profiletool.records.setting import PressureSetting
from profiletool.records.side import side_sign
from profiletool.records.units import FloatArray
from profiletool.verify.run import inflate, reason, shortly
from profiletool.verify.setting import on_object
from profiletool.verify.tube import actuator_of

_ABOUT = np.array([0.84, 0.9, 0.96, 1.02, 1.08, 1.14])  # of a guess: where the states are
_STEP_BAR = 0.005
_TURNS = 3  # of guesses


def by_tube(design: Design, tube: CalibratedTube, target: FloatArray) -> PressureSetting:
    """Find the pressure at which an actuator of a calibrated tube fits its profile best.

    Parameters
    ----------
    design : Design
        What the actuator was built from.
    tube : CalibratedTube
    target : (N, 2) mm
        The profile, in the object's frame.

    Raises
    ------
    UsageError
        The tube is of another diameter.
    NotVerified
        Finite elements do not come that far.
    Infeasible
        The actuator is too soft or too stiff for any pressure about the planned one.
    """
    built = with_tube(design, tube)
    planned = design.pressure_bar
    guess = planned * float(np.exp(_value(tube, "rubber"))) * tube.wall_mm / design.tube.wall_mm
    for _ in range(_TURNS):
        bars = guess * _ABOUT
        found = _states(built, bars)
        bar, fit = _best(found, bars[: len(found.states)], target)
        if bars[0] < bar - _STEP_BAR and bar + _STEP_BAR < bars[-1]:
            dead = tube.dead_bar
            return PressureSetting(
                round(bar + dead, 2), planned, bar / planned, fit_mm=fit, dead_bar=round(dead, 3),
                operate_bar=on_object(design, bar / planned, dead),
            )  # fmt: skip
        guess = bar
    raise Infeasible(
        f"no pressure about the {planned:.2f} bar planned brings this tube onto the profile: "
        "design it anew for it, with `tube`"
    )


def _value(tube: CalibratedTube, name: str) -> float:
    return next((one.value for one in tube.fitted if one.name == name), 0.0)


def _states(built: Design, bars: FloatArray) -> Verification:
    sign = side_sign(built.source.side)
    try:
        run = inflate(actuator_of(built), bars.tolist(), built.base_pose, sign)
    except NotConverged as error:
        raise NotVerified(f"finite elements of this tube: {shortly(error)}") from error
    except BadGeometry as error:
        raise NotVerified(f"finite elements of this tube: {error}") from error
    found = run.verification
    if len(found.states) < 3:
        raise NotVerified(f"finite elements of this tube: {reason(found)}")
    return found


def _best(found: Verification, bars: FloatArray, target: FloatArray) -> tuple[float, float]:
    """Pressure, bar, and RMS, mm, of the state that lies nearest to the profile."""
    shapes = [state.shape for state in found.states]
    lines = CubicSpline(bars, np.array([[s.facing, s.axis, s.far] for s in shapes]))
    fine = np.arange(bars[0], bars[-1] + 1e-9, _STEP_BAR)
    off = [misfit_to(Shape(shapes[0].along, *lines(bar)), target).rms_mm for bar in fine]
    k = int(np.argmin(off))
    return float(fine[k]), float(off[k])
