"""Error fields: how far the object-facing line moves off itself for a unit of each input."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.errors import FemError
from fem.rates import Rate
from fem.sensitivity import sensitivities
from profiletool.joints.closest import closest_points, spaced
from profiletool.records.design import Design
from profiletool.records.frames import base_axes
from profiletool.records.side import side_sign
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.forward import placed_motion
from profiletool.verify.run import Run


@dataclass(frozen=True)
class ErrorFields:
    """Normal motion of the line at the profile's points, to first order; n joints, M points.

    Attributes
    ----------
    gap : (M,) mm
        Signed distance of the line as it is.
    closest, normal : (M, 2)
        Points of the line, mm, and the directions of motion that count.
    pressure : (M,) mm per MPa
    alpha : (n, M) mm per rad
    openF : (n, M)
        By the cuts' lengths, the wrapped lengths kept.
    wrapped : (n + 1, M)
        By the wrapped lengths, the cuts' kept.
    wall : (M,)
        By the wall's thickness, the outer diameter kept.
    rubber : (M,) mm per share of itself
        By the rubber's stiffness.
    """

    gap: FloatArray
    closest: FloatArray
    normal: FloatArray
    pressure: FloatArray
    alpha: FloatArray
    openF: FloatArray
    wrapped: FloatArray
    wall: FloatArray
    rubber: FloatArray


def fields_of(design: Design, run: Run, points: FloatArray) -> ErrorFields | None:
    """Differentiate a verified design's line; None where FE's tangent does not allow it.

    Parameters
    ----------
    design : Design
    run : Run
        Of the design, up to its operating pressure.
    points : (M, 2) mm
        Of the profile, evenly spaced.
    """
    solution, shape = run.solution, run.verification.last.shape
    pressure = design.pressure_bar / BAR_PER_MPA
    try:
        rates = sensitivities(solution.mesh, solution.states[-1].x, pressure, angles=False)
    except FemError:
        return None
    sign = side_sign(design.source.side)
    axes = base_axes(float(np.radians(design.base_pose.heading_deg)), sign)
    closest = closest_points(shape.facing, points, sign)

    def off(*some: Rate) -> FloatArray:
        motion = np.stack([placed_motion(rate, shape, solution.mesh, axes) for rate in some])
        return np.asarray(np.einsum("mk,qmk->qm", closest.normal, closest.at(motion)))

    (by_pressure,), (by_wall,) = off(rates.pressure), off(rates.wall)
    (by_rubber,) = off(rates.rubber(pressure))
    return ErrorFields(
        closest.distance,
        closest.at(shape.facing),
        closest.normal,
        by_pressure,
        off(*rates.alpha),
        off(*rates.openF),
        off(*rates.wrapped),
        by_wall,
        by_rubber,
    )


def even_points(target: FloatArray) -> FloatArray:
    """Space a target's points (N, 2) mm evenly, as the fields are to be found at: (M, 2)."""
    return spaced(target)
