"""The pressure to work at against the object, and the misfit to expect there.

Pressure, rubber and wall are one direction: all of them act as r, the pressure over that which
this actuator would need to stand as the nominal one does free. So the misfit against the object
over r is one curve. Short of r = 1 the finger does not reach; beyond, the object stops it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import floor

import numpy as np
from scipy.interpolate import PchipInterpolator

from fem.solution import Solution
from profiletool.errors import UsageError
from profiletool.joints.misfit import misfit_to
from profiletool.records.built import BuildErrors, Built
from profiletool.records.design import Design
from profiletool.records.grip import Grip
from profiletool.records.grip_request import GripRequest
from profiletool.records.side import side_sign
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.built import P95, draws, groups_of, trimmed
from profiletool.verify.fields import ErrorFields
from profiletool.verify.grip import grip_of, pressed
from profiletool.verify.lines import shape_of
from profiletool.verify.solid import object_of

SHARES = (0.96, 1.0, 1.04, 1.1, 1.18, 1.28)  # of the free pressure, pressed on the object
_FURTHER = (1.4, 1.55, 1.75, 2.0, 2.5, 3.0)  # where a force is asked for
_FREE_FROM = 0.65  # of it, from which on free states count
_SAMPLES = 20_000
_STEP_BAR = 0.01
_DECIMALS = 3


@dataclass(frozen=True)
class InContact:
    """A design that is to work against its object.

    Attributes
    ----------
    design : Design
        With ``operate_bar``, and the misfit in contact to expect.
    grip : Grip or None
        The finger on its object, with what was in the way; None where it was not pressed on it.
    """

    design: Design
    grip: Grip | None


def in_contact(
    design: Design,
    free: Solution,
    target: FloatArray,
    fields: ErrorFields,
    asked: GripRequest,
    most_bar: float,
    force_N: float | None = None,
) -> InContact:
    """Choose the pressure to work at against the object: the least expected misfit, or a force.

    Parameters
    ----------
    design : Design
        Verified, with what to expect of the built actuator.
    free : Solution
        Its finite-element run without the object.
    target : (N, 2) mm
        The profile.
    fields : ErrorFields
        Of the design.
    asked : GripRequest
        What the object is like.
    most_bar : float
        Highest pressure that is allowed.
    force_N : float or None
        Normal force of the finger to choose the pressure by; the highest pressure where it is
        not reached.
    """
    if design.built is None:
        return InContact(design, None)
    bars = tuple(share * design.pressure_bar for share in SHARES)
    try:
        obstacle, solid = object_of(design, target, asked.solid, asked.clearance_mm)
    except UsageError as error:
        return InContact(design, Grip(asked.solid, (), bars[-1], None, str(error), 0, 0.0))
    if force_N is not None:
        further = (share * design.pressure_bar for share in _FURTHER)
        bars = (*bars, *(bar for bar in further if bar < most_bar), max(most_bar, bars[-1]))
    held = pressed(free, obstacle, bars, settle=False)
    grip = grip_of(design, target, held, solid, replace(asked, pressures_bar=bars))
    curve = _curve(design, free, target, grip)
    if curve is None:
        return InContact(design, grip)
    most = min(most_bar, grip.states[-1].pressure_bar)
    at = None
    if force_N is not None:
        at = min(most, max(design.pressure_bar, grip.bar_at(force_N)))
    return InContact(_with(design, design.built, fields, curve, (at, most)), grip)


@dataclass(frozen=True)
class _Curve:
    """Misfit, mm RMS, over the share r of the free pressure; straight on beyond its ends."""

    r: FloatArray
    rms: FloatArray

    def __call__(self, r: FloatArray) -> FloatArray:
        inside = np.clip(r, self.r[0], self.r[-1])
        curve = PchipInterpolator(self.r, self.rms)
        beyond = (r - inside) * curve(inside, 1)
        return np.asarray(np.maximum(curve(inside) + beyond, 0.0))


def _curve(design: Design, free: Solution, target: FloatArray, grip: Grip) -> _Curve | None:
    """Put free states below, and those against the object above, into one curve."""
    sign, planned = side_sign(design.source.side), design.pressure_bar
    known = {s.pressure_bar / planned: s.misfit_rms_mm for s in grip.states}
    if len(known) < 2:
        return None
    first = min(known)
    for state in free.states:
        r = BAR_PER_MPA * state.pressure / planned
        if _FREE_FROM <= r < first - 1e-3:
            shape = shape_of(free.mesh, state, design.base_pose, sign)
            known[r] = misfit_to(shape, target).rms_mm
    r, rms = np.array(sorted(known.items())).T
    return _Curve(r, rms)


def _with(
    design: Design,
    built: Built,
    fields: ErrorFields,
    curve: _Curve,
    limits: tuple[float | None, float],
) -> Design:
    """Take a given pressure, or that of the least expected misfit, and say what to expect there.

    ``limits`` are the given pressure and the highest one, bar.
    """
    given, most_bar = limits
    stiffness, off_bar, rest = _draws(design, fields, built.build)
    planned = design.pressure_bar
    top = floor(most_bar / _STEP_BAR + 1e-6) * _STEP_BAR
    count = max(round((top - planned) / _STEP_BAR), 0)
    bars = planned + _STEP_BAR * np.arange(count + 1) if given is None else np.array([given])

    def rms(bar: float) -> FloatArray:
        found = curve((bar + off_bar) / (planned * stiffness))
        return np.asarray(np.sqrt(found**2 + rest**2))

    expected = [float(np.sqrt(np.mean(rms(bar) ** 2))) for bar in bars]
    best = int(np.argmin(expected))
    most = float(np.percentile(rms(bars[best]), P95))
    return replace(
        design,
        operate_bar=round(float(bars[best]), 4),
        built=replace(
            built,
            expected_rms_mm=replace(
                built.expected_rms_mm, in_contact=round(expected[best], _DECIMALS)
            ),
            p95_rms_mm=replace(built.p95_rms_mm, in_contact=round(most, _DECIMALS)),
        ),
    )


def _draws(
    design: Design, fields: ErrorFields, build: BuildErrors
) -> tuple[FloatArray, FloatArray, float]:
    """Draw builds: how stiff (S,), pressure off by (S,) bar, and what no pressure takes out, mm.

    Every error but the pressure's moves the line along the pressure's own field, which makes the
    actuator act stiffer or softer, and across it.
    """
    along = fields.pressure / float(fields.pressure @ fields.pressure)  # MPa per mm
    groups = groups_of(design, fields, build)
    shares = [
        -BAR_PER_MPA * group.moved @ along / design.pressure_bar
        for group in groups
        if group.what not in ("pressure", "rubber")
    ]
    each = np.concatenate(shares)
    amounts = draws((_SAMPLES, 2 + len(each)))
    stiffness = 1.0 + build.sigma("rubber") * 0.01 * amounts[:, 0] + amounts[:, 2:] @ each
    left = trimmed(groups, fields.pressure)
    rest = np.sqrt(sum(group.rms() ** 2 for group in left if group.what != "pressure"))
    return stiffness, build.sigma("pressure") * amounts[:, 1], float(rest)
