"""The finger on its object by finite elements: from a design to forces and payload."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from fem.against import solve_against
from fem.body import Body
from fem.contact import ORDERS
from fem.element import gauss
from fem.gap import Obstacle
from fem.grasp import Contacts, Touch
from fem.release import Released
from fem.solution import Solution, State
from fem.solver import solve
from profiletool.joints.misfit import misfit_to
from profiletool.records.design import Design
from profiletool.records.frames import base_axes
from profiletool.records.grip import Grip, GripState, LetGo, Pad
from profiletool.records.grip_request import GripRequest
from profiletool.records.side import side_sign
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.lines import Placement, placed_shape
from profiletool.verify.payload import payload_of
from profiletool.verify.run import pressures_to
from profiletool.verify.solid import body_of, given_obstacle, object_of
from profiletool.verify.tube import actuator_of

MARGINS = (1.0, 1.05, 1.1, 1.15, 1.2)  # times the design's pressure, where nothing else is asked
_DISC_MM = 2.0  # radius of the discs that contact pressures are means over
_KPA_PER_MPA = 1e3
Progress = Callable[[float], None]


def run_grip(
    design: Design, target: FloatArray, asked: GripRequest, progress: Progress | None = None
) -> Grip:
    """Inflate a finger beside its object, and press it on.

    Parameters
    ----------
    design : Design
    target : (N, 2) mm
        The profile, object frame.
    asked : GripRequest
    progress : callable, optional
        Takes the pressure reached so far, bar.

    Raises
    ------
    fem.errors.NotConverged, fem.errors.BadGeometry
        From the run without the object.
    UsageError
        No object can be made of the profile.
    """
    if asked.against is None:
        obstacle, made = object_of(design, target, asked.solid, asked.clearance_mm)
    else:
        obstacle, made = given_obstacle(design, asked.against)
    bars = tuple(sorted(asked.pressures_bar)) or tuple(
        round(share * design.pressure_bar, 4) for share in MARGINS
    )
    body = None if asked.free_N is None else body_of(design, asked.free_N, asked.fingers)
    free_bar = min(bars[-1], design.pressure_bar)
    free = solve(actuator_of(design), [p / BAR_PER_MPA for p in pressures_to(free_bar)])
    held = pressed(free, obstacle, bars, progress, body=body)
    return grip_of(design, target, held, made, asked)


def pressed(
    free: Solution,
    obstacle: Obstacle,
    bars: Sequence[float],
    progress: Progress | None = None,
    *,
    settle: bool = True,
    body: Body | None = None,
) -> Contacts:
    """Press a finger on its object at pressures in bar; see `fem.against`."""

    def told(pressure: float) -> None:
        if progress is not None:
            progress(BAR_PER_MPA * pressure)

    return solve_against(
        free, obstacle, [bar / BAR_PER_MPA for bar in bars], settle=settle, body=body,
        progress=told,
    )  # fmt: skip


def grip_of(
    design: Design, target: FloatArray, held: Contacts, solid: str, asked: GripRequest
) -> Grip:
    """Read a run against the object off, with the payload at its highest pressure."""
    place = _Place(design, held.free, target)
    states = tuple(
        place.state(state, touch) for state, touch in zip(held.states, held.touches, strict=True)
    )
    if held.released:
        up = body_of(design, 0.0, 1).ways[0]
        states = tuple(
            replace(state, let_go=place.let_go(let, float(up @ let.motion)))
            for state, let in zip(states, held.released, strict=True)
        )
    first = held.first_touch
    found = Grip(
        solid=solid,
        states=states,
        asked_bar=max(asked.pressures_bar, default=MARGINS[-1] * design.pressure_bar),
        first_touch_bar=None if first is None else BAR_PER_MPA * first,
        failure=held.failure,
        factorisations=held.factorisations,
        seconds=held.seconds,
    )
    if not states or asked.against is not None:
        return found
    last = states[-1]
    carried = payload_of(last.pad, asked.fingers, asked.friction, last.pressure_bar)
    return replace(found, payload=carried)


class _Place:
    """Readings of contact in the object's frame."""

    def __init__(self, design: Design, free: Solution, target: FloatArray) -> None:
        mesh = free.mesh
        self._rest, self._design = free.states[0].volume, design
        sign = side_sign(design.source.side)
        self._mesh, self._target, self._sign = mesh, target, sign
        self._place = Placement(design.base_pose, sign, mesh.actuator.radius)
        heading = float(np.radians(design.base_pose.heading_deg))
        self._axes = np.stack(base_axes(heading, sign))

    def state(self, state: State, touch: Touch) -> GripState:
        """Read one state off."""
        mesh, touching = self._mesh, touch.pressed
        twice = 2.0 if mesh.half else 1.0
        push = twice * (touching.area * touching.pressure).sum(axis=(1, 2))  # by layer
        by_segment = np.bincount(mesh.segment, push, mesh.segment.max() + 1)
        free = mesh.segment > 0
        force = twice * self._vectors(touching.force[free].sum(axis=(0, 1, 2))[None])[0]
        shape = placed_shape(mesh, state, self._place)
        off = misfit_to(shape, self._target)
        pad = self._pad(touch)
        normal = float(push[free].sum())
        return GripState(
            pressure_bar=BAR_PER_MPA * state.pressure,
            normal_N=normal,
            radial_N=float(self._sign * force[0]),
            axial_N=float(force[1]),
            peak_kPa=float(pad.kPa.max(initial=0.0)),
            mean_kPa=pad.mean_kPa,
            contact_share=self._share(touching.pressure),
            misfit_rms_mm=off.rms_mm,
            misfit_max_mm=off.max_mm,
            joint_normal_N=tuple((by_segment[1::2] + by_segment[2::2]).tolist()),
            clamped_N=float(push[~free].sum()),
            clamp_N=(float(touch.clamp[2]), float(touch.clamp[1])),
            depth_mm=touch.depth,
            energy_error=state.energy_error,
            shape=shape,
            theta_deg=self._angles(state),
            air_ml=1e-3 * (state.volume - self._rest),
            pad=pad,
        )

    def let_go(self, released: Released, moved_mm: float) -> LetGo:
        """Read what became of the object."""
        pressed, twice = released.pressed, 2.0 if self._mesh.half else 1.0
        push = (pressed.area * pressed.pressure)[self._mesh.segment > 0]
        return LetGo(moved_mm, released.end, twice * float(push.sum()), released.unbalanced)

    def _angles(self, state: State) -> tuple[float, ...]:
        """Angles of the joints, deg: beyond half a turn they go on."""
        planned = np.array([joint.theta_target_deg for joint in self._design.joints])
        theta = np.degrees(state.theta)
        return tuple((theta + 360.0 * np.rint((planned - theta) / 360.0)).tolist())

    def _vectors(self, v: FloatArray) -> FloatArray:
        """Vectors (n, 3) of the model in the object's frame, its third axis across the picture."""
        return np.column_stack([v[:, [2, 1]] @ self._axes, v[:, 0]])

    def _whole(self, touch: Touch) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Points (n, 3) mm, areas, pressures, forces of all but the clamped sector; both halves."""
        free, found = self._mesh.segment > 0, touch.pressed
        x, f = (rows[free].reshape(-1, 3) for rows in (found.points, found.force))
        area, pressure = (rows[free].ravel() for rows in (found.area, found.pressure))
        if self._mesh.half:
            mirror = np.array([-1.0, 1.0, 1.0])
            x, f = (np.concatenate([rows, rows * mirror]) for rows in (x, f))
            area, pressure = np.tile(area, 2), np.tile(pressure, 2)
        return x, area, pressure, f

    def _pad(self, touch: Touch) -> Pad:
        """Points that touch, with the mean pressure over a disc of the finger about each."""
        x, area, pressure, force = self._whole(touch)
        on = pressure > 0.0
        points = np.column_stack([self._place(x[on]), x[on, 0]])
        push = area * pressure
        means = [
            push[k].sum() / area[k].sum() for k in cKDTree(x).query_ball_point(x[on], _DISC_MM)
        ]
        return Pad(points, self._vectors(force[on]), _KPA_PER_MPA * np.array(means))

    def _share(self, pressure: FloatArray) -> float:
        """Share of the tube's length that touches."""
        along = pressure.reshape(*pressure.shape[:2], *ORDERS).max(axis=(1, 2)) > 0.0
        _, w = gauss(ORDERS[1:])
        heights = self._mesh.heights
        return float((heights[:, None] * along * w).sum() / (w.sum() * heights.sum()))
