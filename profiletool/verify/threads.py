"""Finite elements with the single axial threads of each sector in place of a smeared sector.

Two patterns of threads can be run. The sheet's own are those of the template, all turns where
they lie. They are not alike on both sides of the plane of bending; each counts half, and its
mirror image the other half, which changes nothing of the bending to first order and lets half of
the tube do. The even pattern has a whole number of threads in each sector, one pitch apart on the
tube and all turns upon each other: with an even number a gap between two threads lies on the
plane of symmetry, with an odd number a thread does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from fem.actuator import Actuator
from fem.errors import FemError, NotConverged
from fem.gauze import AxialLines
from fem.near import solve_near
from fem.sensitivity import sensitivities
from fem.solution import Solution
from fem.solver import solve
from profiletool.joints.closest import closest_points
from profiletool.joints.threads import whole_angles
from profiletool.records.built import BuiltMisfit, mm_text
from profiletool.records.design import Design
from profiletool.records.frames import Shape, base_axes
from profiletool.records.side import side_sign
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.forward import placed_motion
from profiletool.verify.lines import shape_of
from profiletool.verify.tube import actuator_of

_NOTED_MM = 0.5  # a difference after the trim that a design says
_ROUNDS = 3  # of the trim
_LINEAR_MM = 2.0  # RMS that the shape may move by derivatives alone
_DECIMALS = 3


def sheet_lines(design: Design, whole_deg: Sequence[FloatArray]) -> AxialLines:
    """Single threads at the angles where a sheet has them.

    Parameters
    ----------
    design : Design
    whole_deg : sequence of (n,)
        Angles on the tube of the threads of all turns that each joint leaves whole.
    """
    gauze = actuator_of(design).gauze
    angles = [np.radians(np.concatenate([whole, 180.0 - whole])) for whole in whole_deg]
    one = gauze.stiffness * design.gauze.pitch_mm / design.gauze.turns
    return AxialLines(tuple(tuple(own.tolist()) for own in angles), 0.5 * one)


def even_lines(design: Design) -> AxialLines:
    """Whole numbers of threads, one pitch apart on the tube, even about the plane of bending."""
    actuator = actuator_of(design)
    step = design.gauze.pitch_mm / actuator.radius

    def own(alpha: float, center: float) -> tuple[float, ...]:
        count = max(round(alpha / step), 1)
        return tuple((center + step * (np.arange(count) - 0.5 * (count - 1))).tolist())

    angles = tuple(own(window.alpha, window.center) for window in actuator.windows)
    return AxialLines(angles, actuator.gauze.stiffness * design.gauze.pitch_mm)


def threads_off(design: Design, lines: AxialLines, smeared: Solution | None = None) -> BuiltMisfit:
    """Say how far single threads move the object-facing line from that of the smeared gauze.

    Parameters
    ----------
    design : Design
    lines : AxialLines
    smeared : Solution, optional
        Of the design at its pressure. The single threads' state is then looked for near it alone;
        where none is given, both are run from rest if need be, which may take minutes.

    Returns
    -------
    BuiltMisfit
        mm RMS along the normals of the smeared gauze's line: at the design's pressure, and after
        the pressure was set so that the lines differ least.

    Raises
    ------
    fem.errors.FemError
        Where one of the runs has no state at the pressure.
    """
    actuator, pressure = actuator_of(design), design.pressure_bar / BAR_PER_MPA
    known = smeared if smeared is not None else _solved(actuator, pressure)
    facing = _shape(design, known).facing
    single, from_rest = replace(actuator, lines=lines), smeared is None
    found = _near(single, known, pressure, from_rest=from_rest)
    off, rate, flow = _gap(design, found, facing, pressure)
    as_set = _rms(off)
    for _ in range(_ROUNDS):
        rise = _trim(off, rate)
        if _rms(rise * rate) <= _LINEAR_MM:
            break
        pressure += rise
        found = _near(single, found, pressure, rise * flow, from_rest=from_rest)
        off, rate, flow = _gap(design, found, facing, pressure)
    trimmed = _rms(off + _trim(off, rate) * rate)
    return BuiltMisfit(round(as_set, _DECIMALS), round(trimmed, _DECIMALS))


def sheet_off(design: Design, smeared: Solution | None = None) -> BuiltMisfit:
    """Say how far the single threads of a design's own sheet move it; see `threads_off`."""
    return threads_off(design, sheet_lines(design, whole_angles(design)), smeared)


def threads_note(off: BuiltMisfit) -> Iterator[str]:
    """Say by how much the sheet's threads differ from the smeared gauze, where that is much."""
    if off.trimmed is not None and off.trimmed > _NOTED_MM:
        yield (
            "the sheet's single threads bend the tube otherwise than the smeared gauze: "
            f"{off.trimmed:.1f} mm RMS apart once the pressure is set, "
            f"{mm_text(off.as_set, 1)} before"
        )


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _trim(off: FloatArray, rate: FloatArray) -> float:
    """Change of the pressure that leaves least of distances (N,), by their rates (N,)."""
    return -float(rate @ off) / float(rate @ rate)


def _near(
    actuator: Actuator,
    known: Solution,
    pressure: float,
    flow: FloatArray | None = None,
    *,
    from_rest: bool,
) -> Solution:
    try:
        return solve_near(actuator, known, pressure, flow=flow)
    except NotConverged:
        if not from_rest:
            raise
        return _solved(actuator, pressure)


def _solved(actuator: Actuator, pressure: float) -> Solution:
    found = solve(actuator, [pressure])
    if found.critical is not None:
        raise FemError(f"{found.critical.kind} at {BAR_PER_MPA * found.critical.pressure:.2f} bar")
    return found


def _shape(design: Design, found: Solution) -> Shape:
    sign = side_sign(design.source.side)
    return shape_of(found.mesh, found.states[-1], design.base_pose, sign)


def _gap(
    design: Design, found: Solution, facing: FloatArray, pressure: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Distances off a line (N, 2): (N,) mm; their rate, mm/MPa; all nodes' rate."""
    sign, shape = side_sign(design.source.side), _shape(design, found)
    closest = closest_points(shape.facing, facing, sign)
    rate = sensitivities(found.mesh, found.states[-1].x, pressure, angles=False).pressure
    axes = base_axes(float(np.radians(design.base_pose.heading_deg)), sign)
    motion = closest.at(placed_motion(rate, shape, found.mesh, axes))
    return closest.distance, np.einsum("mk,mk->m", closest.normal, motion), rate.moved
