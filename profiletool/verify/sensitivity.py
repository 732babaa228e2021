"""Sensitivity of the bent shape to small errors of the build, by FE's own derivatives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from fem.errors import FemError
from fem.sensitivity import Rate, sensitivities
from profiletool.joints.closest import closest_points, target_points
from profiletool.records.design import Design, Sensitivity
from profiletool.records.frames import base_axes
from profiletool.records.profile import Profile
from profiletool.records.side import side_sign
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.check import DECIMALS
from profiletool.verify.forward import placed_motion
from profiletool.verify.run import Run

_PRESSURE_BAR, _WALL_SHARE, _OPENF_MM, _PLACE_MM, _SCALE_SHARE = 0.05, 0.05, 2.0, 1.0, 0.01


def sensitivity_of(design: Design, run: Run, profile: Profile) -> tuple[Sensitivity, ...]:
    """Say how far the object-facing line moves for usual errors, to first order.

    Of what every joint has, the joint that matters most counts. Empty where FE's tangent does
    not allow derivatives.
    """
    solution, shape = run.solution, run.verification.last.shape
    try:
        rates = sensitivities(
            solution.mesh,
            solution.states[-1].x,
            design.pressure_bar / BAR_PER_MPA,
            angles=False,
        )
    except FemError:
        return ()
    sign = side_sign(design.source.side)
    axes = base_axes(float(np.radians(design.base_pose.heading_deg)), sign)
    points = target_points(profile)
    closest = closest_points(shape.facing, points, sign)

    def off(rate: Rate, amount: float) -> FloatArray:
        motion = placed_motion(rate, shape, solution.mesh, axes)
        moved: FloatArray = amount * np.einsum("mk,mk->m", closest.normal, closest.at(motion))
        return moved

    def worst(what: str, some: Sequence[Rate], amount: float) -> Iterator[Sensitivity]:
        moved = [off(rate, amount) for rate in some]
        k = int(np.argmax([np.mean(one**2) for one in moved]))
        yield _told(what, k + 1, moved[k])

    thread = 2.0 * design.gauze.pitch_mm / design.tube.outer_diameter_mm
    wall = _WALL_SHARE * design.tube.wall_mm
    scale = design.source.scale_error_share or _SCALE_SHARE
    # What lies off the start grows with the scale.
    grown = scale * np.einsum("mk,mk->m", closest.normal, points - points[0])
    return (
        _told(
            f"pressure {_PRESSURE_BAR:g} bar off",
            None,
            off(rates.pressure, _PRESSURE_BAR / BAR_PER_MPA),
        ),
        *worst("one thread more or less uncut", rates.alpha, thread),
        *worst(f"cut {_OPENF_MM:g} mm longer or shorter", rates.openF, _OPENF_MM),
        *worst(f"joint {_PLACE_MM:g} mm off its place", rates.wrapped[:-1], _PLACE_MM),
        _told(f"wall {100.0 * _WALL_SHARE:g} % off", None, off(rates.wall, wall)),
        _told(f"scale {100.0 * scale:.2g} % off", None, grown),
    )


def _told(what: str, joint: int | None, moved: FloatArray) -> Sensitivity:
    rms, most = float(np.sqrt(np.mean(moved**2))), float(np.abs(moved).max())
    return Sensitivity(what, joint, round(rms, DECIMALS - 2), round(most, DECIMALS - 2))
