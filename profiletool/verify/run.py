"""Finite-element runs of actuators, from pressures to records."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.actuator import Actuator
from fem.equilibrium import Critical
from fem.errors import NotConverged
from fem.loadpath import Options
from fem.mesh import Mesh
from fem.solution import Solution, State
from fem.solver import solve
from formula.rubber import RubberLaw
from profiletool.records.design import Design, joints_too_near
from profiletool.records.fe import CriticalPoint, FeState, Verification
from profiletool.records.frames import Pose
from profiletool.records.rubber import breaking_stretch
from profiletool.records.side import side_sign
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.lines import Placement, placed_shape
from profiletool.verify.tube import actuator_of

MARGIN = 0.05  # of the operating pressure, by which a tube must stand more
STEPS = 10  # pressures that are reported where nothing else is asked for
LYING = Pose(0.0, 0.0, 0.0)  # an actuator without an object lies along x ...
DOWN = -1.0  # ... and bends down
Progress = Callable[[float], None]


@dataclass(frozen=True)
class Run:
    """A finite-element run: what it says, and the solution it says it from."""

    verification: Verification
    solution: Solution


def pressures_to(pressure_bar: float, step_bar: float | None = None) -> tuple[float, ...]:
    """Give the pressures up to one, bar: `STEPS` equal steps, or steps of a given size."""
    if step_bar is None:
        return tuple(pressure_bar * (k + 1) / STEPS for k in range(STEPS))
    count = int(np.ceil(pressure_bar / step_bar - 1e-9))
    return (*(round(step_bar * k, 9) for k in range(1, count)), pressure_bar)


def inflate(
    actuator: Actuator,
    pressures_bar: Sequence[float],
    pose: Pose,
    sign: float,
    *,
    thread_pitch_mm: float = 1.0,
    threads: int = 2,
    progress: Progress | None = None,
    margin: float = 0.0,
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
    margin : float
        Share of the last pressure by which to look beyond it for what ends the path.

    Returns
    -------
    Run
        As far as it goes: ``verification`` says whether, and why not, it reached all pressures.

    Raises
    ------
    fem.errors.NotConverged
        When no equilibrium is found at the first pressure.
    """
    most = max(pressures_bar)

    def told(pressure: float) -> None:
        if progress is not None:
            progress(min(BAR_PER_MPA * pressure, most))

    asked = [p / BAR_PER_MPA for p in pressures_bar]
    options = Options(ahead=margin * most / BAR_PER_MPA)
    failure = None
    try:
        solution = solve(actuator, asked, options=options, threads=threads, progress=told)
    except NotConverged as error:
        part = error.solution
        if not isinstance(part, Solution) or len(part.states) < 2:
            raise
        solution, failure = part, shortly(error)
    place = Placement(pose, sign, actuator.radius)
    found = _verification(solution, most, place, thread_pitch_mm)
    return Run(replace(found, failure=failure), solution)


def _verification(
    found: Solution, asked_bar: float, place: Placement, thread_pitch_mm: float
) -> Verification:
    """Read a solution off, its lines placed beside the object."""
    # Beyond half a turn the angles go on, and do not start again from the other side.
    angles = np.unwrap([np.degrees(s.theta) for s in found.states], period=360.0, axis=0)
    rest, *loaded = (
        _state(found, state, theta, place, thread_pitch_mm)
        for state, theta in zip(found.states, angles, strict=True)
    )
    mesh = found.mesh
    return Verification(
        rest=rest,
        states=tuple(loaded),
        asked_bar=asked_bar,
        critical=None if found.critical is None else ended(found.critical),
        ahead=None if found.ahead is None else ended(found.ahead),
        theta_uncertain=joints_too_near(
            [end - start for start, end in mesh.actuator.wrapped[1:-1]], mesh.actuator.diameter
        ),
        elements=mesh.elements,
        nodes=mesh.nodes,
        dofs=_dofs(mesh),
        newton_iterations=found.newton_iterations,
        seconds=found.seconds,
    )


def run_design(design: Design, pressure_bar: float, progress: Progress | None = None) -> Run:
    """Run a design up to a pressure, in its own base pose.

    At its operating pressure it looks `MARGIN` further, for what ends the path there.

    Raises
    ------
    fem.errors.NotConverged, fem.errors.BadGeometry
    """
    run = inflate(
        actuator_of(design),
        pressures_to(pressure_bar),
        design.base_pose,
        side_sign(design.source.side),
        thread_pitch_mm=design.gauze.pitch_mm / design.gauze.turns,
        progress=progress,
        margin=MARGIN if abs(pressure_bar - design.pressure_bar) < 1e-6 else 0.0,
    )
    return breaking(run, design.tube.rubber)


def breaking(run: Run, rubber: RubberLaw | None) -> Run:
    """Tell a run at which stretch its rubber breaks."""
    breaks = breaking_stretch(rubber)
    return replace(run, verification=replace(run.verification, breaks=breaks))


def shortly(error: NotConverged) -> str:
    """Say in a few words how far a run came that did not converge."""
    return f"no equilibrium found beyond {BAR_PER_MPA * error.reached:.2f} bar"


def ended(critical: Critical) -> CriticalPoint:
    """Give what ended a run in bar."""
    return CriticalPoint(critical.kind, BAR_PER_MPA * critical.pressure)


def reason(found: Verification) -> str:
    """Say what ended a run before its last pressure; empty where nothing did."""
    return said(found.critical) if found.critical is not None else found.failure or ""


def said(critical: CriticalPoint) -> str:
    """Say what ended a run."""
    where = "beyond" if critical.kind == "no equilibrium" else "at"
    return f"{critical.kind} {where} {critical.pressure_bar:.2f} bar"


def too_little(found: Verification) -> str:
    """Say what ends the path too soon beyond the pressure asked for; empty where nothing does."""
    if found.ahead is None:
        return ""
    return f"{said(found.ahead)}, less than {100.0 * MARGIN:g} % above {found.asked_bar:.2f} bar"


def _dofs(mesh: Mesh) -> int:
    """Count the unknowns: free nodes between the clamped ring and the plug, and the plug's own."""
    ring, mid = (int((~held).sum()) for held in (mesh.fixed_ring, mesh.fixed_mid))
    return (mesh.layers - 1) * ring + mesh.layers * mid + (3 if mesh.half else 6)


def _bulges(found: Solution, state: State) -> tuple[float, ...]:
    """Largest bulge in every window, over the radius."""
    actuator, shape = found.mesh.actuator, state.shape
    bulge = shape.bulge / actuator.radius
    inside = ((shape.z >= w.start) & (shape.z <= w.end) for w in actuator.windows)
    return tuple(float(bulge[own].max(initial=0.0)) for own in inside)


def _state(
    found: Solution, state: State, theta_deg: FloatArray, place: Placement, pitch: float
) -> FeState:
    return FeState(
        pressure_bar=BAR_PER_MPA * state.pressure,
        theta_deg=tuple(theta_deg.tolist()),
        shape=placed_shape(found.mesh, state, place),
        phalanges=place(np.array([sector.centre for sector in state.sectors])),
        air_ml=1e-3 * (state.volume - found.states[0].volume),
        joint_stretch=tuple(state.stretches.tolist()[: len(theta_deg)]),
        largest_stretch=state.largest_stretch,
        slack_share=state.threads.slack_share,
        least_J=state.least_J,
        thread_N=pitch * max(state.threads.axial_force, state.threads.hoop_force),
        residual=state.residual,
        energy_error=state.energy_error,
        touches=state.touches,
        overlap_mm=state.overlap,
        joint_bulge=_bulges(found, state),
    )
