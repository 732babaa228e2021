"""One-joint runs: tasks, keys, outcomes and the model behind them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Literal

import numpy as np

from fem.actuator import Actuator, chain
from fem.errors import FemError, NotConverged
from fem.gauze import PAPER_GAUZE, Gauze, slack_on
from fem.loadpath import DEFAULT_OPTIONS, Options
from fem.material import Law
from fem.measure import Sector
from fem.meshsize import DEFAULT_MESH, PAPER_MESH, MeshSize
from fem.solution import Solution, State
from fem.solver import solve
from profiletool.campaign.keys import key_of, seal, unseal
from profiletool.campaign.kind import RunKind
from profiletool.records.units import BAR_PER_MPA

Model = Literal["converged", "paper"]

SCHEMA = "profiletool.run/1"  # to be raised also where `run` reads other numbers off a solution
_ROOT, _PLUG = 1.5, 0.05  # of the diameter: the paper's 30 mm, and the rigid last millimetre
_PAPER_DIAMETER = 20.0
_NUMBERS = ("pressures_bar", "theta_deg", "dx_mm", "dy_mm")


@dataclass(frozen=True)
class Task:
    """One joint on a straight tube, Root = F1 = 1.5 diameters, that bends toward 270 deg.

    Attributes
    ----------
    openF_mm, alpha_deg : float
        Axial length of the cut, and extent of the uncut sector.
    diameter_mm, wall_mm : float
    rubber : fem.material.Law
        MPa.
    pressures_bar : tuple of float
        Rising, above 0.
    model : {"converged", "paper"}
        The default mesh and gauze, or the joint as the paper modelled it: 8-node bricks of 1 mm,
        threads that resist compression too, and states kept that are not stable.

    Raises
    ------
    ValueError
        When the pressures do not rise from above 0, or there is no such model.
    """

    openF_mm: float
    alpha_deg: float
    diameter_mm: float
    wall_mm: float
    rubber: Law
    pressures_bar: tuple[float, ...]
    model: Model = "converged"

    def __post_init__(self) -> None:
        steps = np.diff([0.0, *self.pressures_bar])
        if not (np.isfinite(steps).all() and (steps > 0.0).all()):
            raise ValueError("pressures must be finite numbers that rise from above 0")
        if self.model not in _SETTINGS:
            raise ValueError(f'there is no model "{self.model}"')


@dataclass(frozen=True)
class Outcome:
    """The outcome of a run; N pressures were reached.

    The joint's rigid motion is that of the point that lies on the tube's axis at the cut's
    centre at rest. The wrapped sector beyond the joint carries it along as if it reached there,
    and its displacement is seen from the wrapped sector before the joint, each sector as rigid
    as its middle section. So what little the gauze gives between the joint and the middles of
    its neighbours belongs to the joint.

    Attributes
    ----------
    pressures_bar : tuple of float, (N,)
        The asked ones that were reached, exactly as they were asked for.
    theta_deg : tuple of float, (N,)
        Positive toward the object; see `fem.measure.joint_angles`. Beyond half a turn it goes on.
    dx_mm, dy_mm : tuple of float, (N,)
        Displacement along the tube from the clamped end on, and toward the object.
    failure : str or None
        Why the run ended before the last asked pressure.
    """

    pressures_bar: tuple[float, ...]
    theta_deg: tuple[float, ...]
    dx_mm: tuple[float, ...]
    dy_mm: tuple[float, ...]
    failure: str | None


DIED = Outcome((), (), (), (), "its process died")


@dataclass(frozen=True)
class _Settings:
    gauze: Gauze  # of a tube of 20 mm
    size: MeshSize
    options: Options


_SETTINGS: Mapping[str, _Settings] = {
    # What is kept of a pressure must not depend on which others are asked for.
    "converged": _Settings(Gauze(), DEFAULT_MESH, Options(before=DEFAULT_OPTIONS.tolerance)),
    # Threads in compression buckle: the paper's model has no stable state above 0.3 to 1 bar.
    "paper": _Settings(PAPER_GAUZE, PAPER_MESH, Options(stable=False)),
}


def actuator_of(task: Task) -> Actuator:
    """Model a joint; at a diameter of 20 mm it is that of `profiletool.verify.tube.joint_actuator`.

    All lengths but those asked for go with the diameter: the plug, and the pitch of single
    threads, which run along the bricks' edges.

    Raises
    ------
    fem.errors.BadGeometry
        When no such actuator can be modelled.
    """
    root = _ROOT * task.diameter_mm
    plain = chain(
        root, [root], [task.openF_mm], [float(np.radians(task.alpha_deg))],
        diameter=task.diameter_mm, wall=task.wall_mm, rubber=task.rubber,
        plug=_PLUG * task.diameter_mm,
    )  # fmt: skip
    gauze = _SETTINGS[task.model].gauze
    if gauze.pitch is not None:
        gauze = replace(gauze, pitch=gauze.pitch * (task.diameter_mm / _PAPER_DIAMETER))
    else:
        gauze = replace(gauze, slack=slack_on(task.rubber.shear_modulus * task.wall_mm))
    return replace(plain, gauze=gauze)


def key(task: Task) -> str:
    """Name a run by all that its outcome depends on, the model's own source files included."""
    asked = {
        "schema": SCHEMA,
        "openF_mm": float(task.openF_mm),
        "alpha_deg": float(task.alpha_deg),
        "diameter_mm": float(task.diameter_mm),
        "wall_mm": float(task.wall_mm),
        "rubber": {"law": task.rubber.name, **task.rubber.constants},
        "pressures_bar": [float(p) for p in task.pressures_bar],
        "model": task.model,
        "settings": asdict(_SETTINGS[task.model]),
        "root": _ROOT,
        "plug": _PLUG,
    }
    return key_of(asked)


def run(task: Task) -> Outcome:
    """Run a task on one thread, as far as it goes; what the model refuses ends up in `failure`."""
    settings = _SETTINGS[task.model]
    asked = [p / BAR_PER_MPA for p in task.pressures_bar]
    try:
        found = solve(actuator_of(task), asked, settings.size, settings.options, threads=1)
    except NotConverged as error:
        failure = f"not converged beyond {BAR_PER_MPA * error.reached:.2f} bar"
        if isinstance(error.solution, Solution):
            return _read_off(error.solution, task.pressures_bar, failure)
    except FemError as error:
        failure = str(error)
    else:
        return _read_off(found, task.pressures_bar, _ended(found))
    return Outcome((), (), (), (), failure)


def _ended(found: Solution) -> str | None:
    if found.critical is None:
        return None
    return f"{found.critical.kind} at {BAR_PER_MPA * found.critical.pressure:.2f} bar"


def _read_off(found: Solution, pressures: tuple[float, ...], failure: str | None) -> Outcome:
    """Read the reached pressures off a solution; there may be none."""
    rest, *loaded = found.states
    (window,) = found.mesh.actuator.windows
    moved = [rigid_motion(rest.sectors, state.sectors, window.centre) for state in loaded]
    return Outcome(
        pressures_bar=tuple(float(p) for p in pressures[: len(loaded)]),
        theta_deg=tuple(_theta_deg(state) for state in loaded),
        dx_mm=tuple(dx for dx, _ in moved),
        dy_mm=tuple(dy for _, dy in moved),
        failure=failure,
    )


def _theta_deg(state: State) -> float:
    """Angle of the joint with its whole turns, which are counted along the tube.

    Counted from pressure to pressure they would depend on which pressures are asked for.
    """
    R = state.shape.rotation  # about x where the tube bends toward -y
    along = np.unwrap(np.arctan2(R[:, 2, 1], R[:, 1, 1]))
    theta = float(np.degrees(state.theta[0]))
    return theta + 360.0 * round((float(np.degrees(along[-1] - along[0])) - theta) / 360.0)


def rigid_motion(
    rest: tuple[Sector, ...], now: tuple[Sector, ...], centre: float
) -> tuple[float, float]:
    """Displacement (dx, dy) of the axis at a cut's centre, mm; see `Outcome`.

    Parameters
    ----------
    rest, now : (Sector, Sector)
        Before and beyond the joint, in the frame of `fem`: z along the tube, the object at -y.
    centre : float
        Of the cut, from the clamped end, mm.
    """
    point = np.array([0.0, 0.0, centre])
    carried = now[1].centre + now[1].rotation @ (point - rest[1].centre)
    seen = rest[0].centre + now[0].rotation.T @ (carried - now[0].centre)
    _, up, along = (seen - point).tolist()
    return along, -up


def to_json(outcome: Outcome) -> bytes:
    """Write an outcome, with a checksum; the same outcome gives the same bytes."""
    return seal(SCHEMA, asdict(outcome))


def from_json(data: bytes) -> Outcome:
    """Read what `to_json` wrote, and nothing else.

    Raises
    ------
    ValueError
        When a single byte is not as it was written.
    """
    body = unseal(SCHEMA, data)
    if set(body) != {*_NUMBERS, "failure"}:
        raise ValueError("this is no run")
    columns = [_column(body[name]) for name in _NUMBERS]
    if len({len(column) for column in columns}) != 1:
        raise ValueError("a run holds lists of one length")
    failure = body["failure"]
    if not (failure is None or isinstance(failure, str)):
        raise ValueError("a run says in words why it ended")
    pressures, theta, dx, dy = columns
    return Outcome(pressures, theta, dx, dy, failure)


def _column(values: object) -> tuple[float, ...]:
    if not isinstance(values, list) or any(type(value) is not float for value in values):
        raise ValueError("a run holds lists of numbers")
    return tuple(values)


def _order(task: Task) -> tuple[bool, float, float]:
    """Sort key that puts the longest runs first."""
    return task.model == "converged", -task.openF_mm / task.diameter_mm, task.alpha_deg


def _died(_: Task) -> Outcome:
    return DIED


JOINT_RUN = RunKind(run, key, _order, _died, to_json, from_json)
