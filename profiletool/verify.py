"""Finite elements of an actuator: from a design to what it does under pressure.

FE frame: z along the tube from the clamped end, the object at -y; MPa and rad. Here they become
the object frame, bar and degrees. Joints out of the bending plane are seen along x, as a picture
would show them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.actuator import AWAY, TOWARD, Actuator, Window, chain
from fem.element import face_nodes, natural_nodes, shape
from fem.equilibrium import Critical as FemCritical
from fem.errors import BadGeometry, NotConverged
from fem.gauze import THREAD_EA, Gauze
from fem.mesh import Mesh
from fem.solution import Solution, State
from fem.solver import solve
from profiletool.joints.kinematics import STEP_MM, misfit
from profiletool.joints.model import Chain
from profiletool.records import (
    Critical,
    Design,
    FeState,
    FloatArray,
    Material,
    Pose,
    Profile,
    Shape,
    Verification,
    side_sign,
)
from profiletool.records import Gauze as DesignGauze
from profiletool.records import Tube as DesignTube
from profiletool.rubber import law_of

STEPS = 10  # pressures that are reported where nothing else is asked for
DECIMALS = 4  # of what FE puts into design.json: far above the noise of the last bits
LYING = Pose(0.0, 0.0, 0.0)  # an actuator without an object lies along x ...
DOWN = -1.0  # ... and bends down
_BAR = 10.0  # in a MPa
_PAPER_THREAD_MM = 0.25

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Run:
    """A finite-element run: what it says, and the solution it says it from."""

    verification: Verification
    solution: Solution


@dataclass(frozen=True)
class Check:
    """A design after its finite-element run.

    Attributes
    ----------
    design : Design
        Verified where the run reached the operating pressure.
    run : Run or None
        None where there is not even a part of it.
    failure : str or None
        Why the design is not verified.
    """

    design: Design
    run: Run | None
    failure: str | None

    @property
    def shape(self) -> Shape | None:
        """The tube at the operating pressure; None where FE did not get there."""
        done = self.run is not None and self.failure is None
        return self.run.verification.last.shape if done and self.run is not None else None


def pressures_to(pressure_bar: float, step_bar: float | None = None) -> tuple[float, ...]:
    """Give the pressures up to one, bar: `STEPS` equal steps, or steps of a given size."""
    if step_bar is None:
        return tuple(pressure_bar * (k + 1) / STEPS for k in range(STEPS))
    count = int(np.ceil(pressure_bar / step_bar - 1e-9))
    return (*(round(step_bar * k, 9) for k in range(1, count)), pressure_bar)


def actuator_of(design: Design) -> Actuator:
    """Model a design; its closed end is rigid over its last millimetre.

    Raises
    ------
    fem.errors.BadGeometry
        When no such actuator can be modelled.
    """
    tube, gauze = design.tube, design.gauze
    windows = tuple(
        Window(j.centre_mm, j.openF_mm, np.radians(j.alpha_closed_deg), _center(j.alpha_center_deg))
        for j in design.joints
    )
    return _tube(tube.length_mm, windows, tube, gauze)


def tube_of(chain: Chain, material: Material) -> Actuator:
    """Model a chain of joints before it is a design.

    Raises
    ------
    fem.errors.BadGeometry
        When no such actuator can be modelled.
    """
    windows = tuple(
        Window(float(centre), float(openF), float(alpha), float(TOWARD if sense > 0.0 else AWAY))
        for centre, openF, alpha, sense in zip(
            chain.centre, chain.openF, chain.alpha, chain.sense, strict=True
        )
    )
    return _tube(chain.length, windows, material, material)


def _tube(
    length: float,
    windows: tuple[Window, ...],
    tube: DesignTube | Material,
    gauze: DesignGauze | Material,
) -> Actuator:
    thread = THREAD_EA * (gauze.thread_mm / _PAPER_THREAD_MM) ** 2
    return Actuator(
        length,
        windows,
        diameter=tube.outer_diameter_mm,
        wall=tube.wall_mm,
        rubber=law_of(tube.rubber),
        gauze=Gauze(stiffness=thread * gauze.turns / gauze.pitch_mm),
    )


def joint_actuator(
    openF_mm: float, alpha_deg: float, center_deg: float, material: Material
) -> Actuator:
    """Model one joint as the paper does: Root = F1 = 30 mm."""
    return chain(
        30.0, [30.0], [openF_mm], [float(np.radians(alpha_deg))], [_center(center_deg)],
        diameter=material.outer_diameter_mm, wall=material.wall_mm,
        rubber=law_of(material.rubber),
    )  # fmt: skip


def finger_actuator() -> Actuator:
    """Model the finger of the paper's Table 2."""
    quarter = float(np.radians(90.0))
    return chain(10.0, [40.0, 22.0, 20.0], [14.0, 16.0, 12.0], [quarter] * 3)


def inflate(
    actuator: Actuator,
    pressures_bar: Sequence[float],
    pose: Pose,
    sign: float,
    *,
    thread_pitch_mm: float = 1.0,
    threads: int = 2,
    progress: Progress | None = None,
) -> Run:
    """Run finite elements from rest through the given pressures.

    Parameters
    ----------
    actuator : Actuator
    pressures_bar : sequence of float
    pose : Pose
        Of the object-facing line at the clamped end.
    sign : float
        +1 where a turn toward the object is counter-clockwise (see `Profile.sign`).
    thread_pitch_mm : float
        Width that a single thread stands for, all turns of the gauze together.
    threads : {1, 2}
        Of the computer, not of the gauze.
    progress : callable, optional
        Takes the pressure reached so far, bar.

    Raises
    ------
    fem.errors.NotConverged
        When no equilibrium is found at some pressure.
    """

    def told(pressure: float) -> None:
        if progress is not None:
            progress(_BAR * pressure)

    asked = [p / _BAR for p in pressures_bar]
    found = solve(actuator, asked, threads=threads, progress=told)
    # Beyond half a turn the angles go on, and do not start again from the other side.
    angles = np.unwrap([np.degrees(s.theta) for s in found.states], period=360.0, axis=0)
    place = _Place(pose, sign, actuator.radius)
    rest, *loaded = (
        _state(found, state, theta, place, thread_pitch_mm)
        for state, theta in zip(found.states, angles, strict=True)
    )
    mesh = found.mesh
    return Run(
        Verification(
            rest=rest,
            states=tuple(loaded),
            asked_bar=max(pressures_bar),
            critical=None if found.critical is None else ended(found.critical),
            elements=mesh.elements,
            nodes=mesh.nodes,
            dofs=_dofs(mesh),
            newton_iterations=found.newton_iterations,
            seconds=found.seconds,
        ),
        found,
    )


def run_design(design: Design, pressure_bar: float, progress: Progress | None = None) -> Run:
    """Run a design up to a pressure, in its own base pose.

    Raises
    ------
    fem.errors.NotConverged, fem.errors.BadGeometry
    """
    return inflate(
        actuator_of(design),
        pressures_to(pressure_bar),
        design.base_pose,
        side_sign(design.source.side),
        thread_pitch_mm=design.gauze.pitch_mm / design.gauze.turns,
        progress=progress,
    )


def check(design: Design, profile: Profile, progress: Progress | None = None) -> Check:
    """Verify a design at its operating pressure; a failure leaves it unverified and says why."""
    try:
        run = run_design(design, design.pressure_bar, progress)
    except NotConverged as error:
        return Check(design, None, shortly(error))
    except BadGeometry as error:
        return Check(design, None, f"cannot be modelled: {error}")
    found = run.verification
    if found.critical is not None:
        return Check(design, run, said(found.critical))
    by_joint = zip(design.joints, found.last.theta_deg, found.last.joint_stretch, strict=True)
    joints = tuple(
        replace(
            joint,
            theta_fe_deg=round(magnitude(theta, joint.alpha_center_deg), DECIMALS),
            stretch_fe=round(stretch, DECIMALS - 1),
        )
        for joint, theta, stretch in by_joint
    )
    off = misfit(found.last.shape, profile)
    off = replace(off, rms_mm=round(off.rms_mm, DECIMALS), max_mm=round(off.max_mm, DECIMALS))
    fit = replace(design.fit, fe=off)
    return Check(replace(design, joints=joints, fit=fit, verified=True), run, None)


def magnitude(theta_deg: float, center_deg: float) -> float:
    """Turn a signed angle into the one toward the uncut sector: negative only if it bends off."""
    return -theta_deg if np.sin(_center(center_deg)) > 1e-12 else theta_deg


def shortly(error: NotConverged) -> str:
    """Say in a few words how far a run came that did not converge."""
    return f"no equilibrium found beyond {_BAR * error.reached:.2f} bar"


def ended(critical: FemCritical) -> Critical:
    """Give what ended a run in bar."""
    return Critical(critical.kind, _BAR * critical.pressure)


def said(critical: Critical) -> str:
    """Say what ended a run."""
    return f"{critical.kind} at {critical.pressure_bar:.2f} bar"


def _center(degrees: float) -> float:
    return float(np.radians(degrees))


def _dofs(mesh: Mesh) -> int:
    """Count the unknowns: free nodes between the clamped ring and the plug, and the plug's own."""
    ring, mid = (int((~held).sum()) for held in (mesh.fixed_ring, mesh.fixed_mid))
    return (mesh.layers - 1) * ring + mesh.layers * mid + (3 if mesh.half else 6)


def _state(
    found: Solution, state: State, theta_deg: FloatArray, place: _Place, pitch: float
) -> FeState:
    return FeState(
        pressure_bar=_BAR * state.pressure,
        theta_deg=tuple(theta_deg.tolist()),
        shape=_shape(found.mesh, state, place),
        phalanges=place(np.array([sector.centre for sector in state.sectors])),
        air_ml=1e-3 * (state.volume - found.states[0].volume),
        joint_stretch=tuple(
            float(state.stretches[found.mesh.segment == 2 * k + 1].max(initial=1.0))
            for k in range(len(theta_deg))
        ),
        largest_stretch=state.largest_stretch,
        slack_share=state.threads.slack_share,
        least_J=state.least_J,
        thread_N=pitch * max(state.threads.axial_force, state.threads.hoop_force),
        residual=state.residual,
        energy_error=state.energy_error,
        touches=state.touches,
    )


@dataclass(frozen=True)
class _Place:
    """From the FE frame into the object frame."""

    pose: Pose
    sign: float
    radius: float

    def __call__(self, points: FloatArray) -> FloatArray:
        heading = np.radians(self.pose.heading_deg)
        along = np.array([np.cos(heading), np.sin(heading)])
        outward = self.sign * np.array([np.sin(heading), -np.cos(heading)])
        start = np.array([self.pose.x_mm, self.pose.y_mm])
        off = points[:, 1, None] + self.radius
        placed: FloatArray = start + points[:, 2, None] * along + off * outward
        return placed


def shape_of(mesh: Mesh, state: State, pose: Pose, sign: float) -> Shape:
    """Lines of a state's tube in the object frame; ``pose`` and ``sign`` as in `inflate`."""
    return _shape(mesh, state, _Place(pose, sign, mesh.actuator.radius))


def _shape(mesh: Mesh, state: State, place: _Place) -> Shape:
    """Lines of the tube at even places, by the elements' own interpolation; then the plug."""
    length = mesh.actuator.length
    along = np.linspace(0.0, length, round(length / STEP_MM) + 1)
    beyond = np.maximum(along - mesh.actuator.free_length, 0.0)[:, None]
    end = beyond * (state.shape.rotation[-1] @ [0.0, 0.0, 1.0])
    facing, far = (
        place(on_line(mesh, state.x, along, phi) + end) for phi in (-0.5 * np.pi, 0.5 * np.pi)
    )
    return Shape(along, facing, 0.5 * (facing + far), far)


def on_line(
    mesh: Mesh, nodal: FloatArray, along: FloatArray, phi: float = -0.5 * np.pi
) -> FloatArray:
    """Interpolate nodal values to a surface line: (S, 3).

    Parameters
    ----------
    mesh : Mesh
    nodal : (layers + 1, ring + mid, 3)
    along : (S,) mm
        Places on the straight tube; beyond the plug's inner face its values count.
    phi : float
        rad; by default the object-facing line.
    """
    inside = np.minimum(along, mesh.actuator.free_length)
    layer = np.clip(np.searchsorted(mesh.z, inside, side="right") - 1, 0, mesh.layers - 1)
    t = (inside - mesh.z[layer]) / mesh.heights[layer]
    nodes = mesh.outer + (layer * (mesh.ring + mesh.mid))[:, None, None]
    k, N = _on_bricks(mesh, 2.0 * t - 1.0, phi)
    values: FloatArray = np.einsum("sn,snj->sj", N, nodal.reshape(-1, 3)[nodes[:, k]])
    return values


def _on_bricks(mesh: Mesh, zeta: FloatArray, phi: float) -> tuple[int, FloatArray]:
    """Brick around that has the surface line at phi (rad, from 270 deg on), and its weights there.

    Returns
    -------
    k : int
    N : (S, n)
        Shape functions of the brick's outer face, one row for each natural coordinate zeta.
    """
    k = int(np.clip(np.searchsorted(mesh.columns, phi + 1e-9) - 1, 0, mesh.around - 1))
    low, high = mesh.columns[k : k + 2]
    eta = np.clip(2.0 * (phi - low) / (high - low) - 1.0, -1.0, 1.0)
    kind = mesh.size.kind
    face = natural_nodes(kind)[-face_nodes(kind) :, 1:]
    N, _ = shape(face, np.column_stack([np.full(len(zeta), eta), zeta]))
    return k, N
