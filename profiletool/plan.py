"""From a profile to a plan of joints: the paper's way, or the best that one pressure allows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from formula.errors import OutOfRange
from formula.theta import Formula, theta_deg
from profiletool.errors import Infeasible, NoObject, UsageError
from profiletool.joints.allowed import BAR_PER_MPA
from profiletool.joints.assign import Layout, joint_rules, lay_out, theta_table
from profiletool.joints.correct import Bench, CannotBend, ModelBench, Steps, correct
from profiletool.joints.hinge import FormulaModel
from profiletool.joints.kinematics import deform
from profiletool.joints.limits import shortfalls
from profiletool.joints.model import Chain, Model
from profiletool.joints.optimal import TOLERANCE_MM, Choice, TradeOff, Wish, choose
from profiletool.joints.parameters import Actuator, parameters_of
from profiletool.joints.reach import Missed, missed
from profiletool.joints.response import Response
from profiletool.joints.sectors import Sector, discretise
from profiletool.records import (
    AWAY_DEG,
    TOWARD_DEG,
    Design,
    FloatArray,
    Joint,
    Material,
    Profile,
    Shape,
)
from profiletool.refine import FeBench
from profiletool.rubber import law_of
from profiletool.subject import Request

S = TypeVar("S")

PAPER_TOLERANCE_MM = 1.0
GOOD_SHARE = 0.01  # of the profile's length: RMS of a shape that is called good
_PRESSURE_STEP = 0.001  # MPa: what a gauge can be set to
_SLACK_MM = 0.05  # that nobody can see
_AGAIN = 0.97  # of the pressure that a tube stands, where it does not stand the one asked


@dataclass(frozen=True)
class Plan:
    """Joints for a profile.

    Attributes
    ----------
    layout : Layout
    by : str
        What the joints were chosen by: "formula" or "joint response".
    bent : Shape
        The tube as that bends it.
    places : (n,) mm
        Where the joints lie along the profile.
    reasons : tuple of str
        Why the plan is beyond the limits; none where it is within them.
    notes : tuple of str
    sectors : tuple of Sector
        Of the paper's method; empty for the other.
    choice : Choice or None
    model : Model or None
        Of the optimal method.
    """

    layout: Layout
    by: str
    bent: Shape
    places: FloatArray
    reasons: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    sectors: tuple[Sector, ...] = ()
    choice: Choice | None = None
    model: Model | None = None

    @property
    def trade_off(self) -> TradeOff | None:
        """What more joints and more pressure bring."""
        return None if self.choice is None else self.choice.trade_off


def paper_plan(
    request: Request, profile: Profile, formula: Formula, say: Callable[[str], None]
) -> Plan:
    """Read joints off the profile and look their angles up, as the paper does.

    Raises
    ------
    UsageError, NoObject, Infeasible
    """
    material = request.material
    try:
        table = theta_table(formula, material)
    except OutOfRange as error:
        raise UsageError(f"{error}; change --pitch, --max-pressure or --formula") from error
    tolerance = request.tolerance_mm or PAPER_TOLERANCE_MM
    rules = joint_rules(table, material, tolerance)
    sectors = discretise(profile, rules, request.joints)
    if not sectors:
        raise NoObject(
            f"the profile is straight to {tolerance:g} mm: there is nothing to bend; "
            "take another --side or stretch, or a smaller --tolerance"
        )
    try:
        layout = lay_out(profile, sectors, table, material)
    except OutOfRange as error:
        raise Infeasible(f"no pressure serves all joints: {error}") from error
    say(f"joints: {len(sectors)} at {layout.pressure_bar:.2f} bar")

    return Plan(
        layout=layout,
        by="formula",
        bent=deform(
            layout.bends(), layout.length_mm, material.radius_mm, layout.pose, profile.sign
        ),
        places=np.array([sector.centre for sector in sectors]),
        reasons=shortfalls(
            sectors, layout, rules, material, formula, request.joints, _placer(request, profile)
        ),
        sectors=sectors,
    )


def _placer(request: Request, profile: Profile) -> Callable[[float], str]:
    """Say in words where an arc length on the profile is."""

    def place(s: float) -> str:
        share = request.start_pct + s / profile.length_mm * (request.end_pct - request.start_pct)
        return f"{s:.0f} mm down the profile ({share:.0f} % of the side)"

    return place


def optimal_plan(
    request: Request, profile: Profile, formula: Formula, say: Callable[[str], None]
) -> Plan:
    """Choose all joints at once, go to numbers that can be built, and let FE correct them.

    Raises
    ------
    UsageError, NoObject
    """
    model = _model(request, formula)
    if request.material.max_pressure_bar < BAR_PER_MPA * model.pressure[0]:
        raise UsageError(
            f"--max-pressure {request.material.max_pressure_bar:g} bar is less than the "
            f"{BAR_PER_MPA * model.pressure[0]:g} bar from which on the joints are known by the "
            f"{_by(model)}"
        )
    wish = Wish(
        tolerance_mm=request.tolerance_mm or TOLERANCE_MM,
        interference_mm=request.interference_mm,
        count=request.joints,
        base_free=request.base_free,
    )

    def by_model(choice: Choice) -> Actuator:
        return _corrected(request, ModelBench(model), profile, model, choice, lambda line: None)

    def say_fe(line: str) -> None:
        say(f"finite elements, {line}")

    material, notes = request.material, list[str]()
    for _ in range(2):
        choice = _chosen(profile, model, material, wish)
        say(
            f"joints: {len(choice.chain.openF)} at {BAR_PER_MPA * choice.pressure:.2f} bar, "
            f"{choice.misfit.rms_mm:.2f} mm RMS off the profile by the {_by(model)}"
        )
        if not (request.verify and request.refine):
            actuator = by_model(choice)
            break
        try:
            bench = FeBench(material)
            actuator = _corrected(request, bench, profile, model, choice, say_fe)
            break
        except CannotBend as problem:
            notes.append(f"the first choice of joints did not stand by FE: {problem}")
            say(notes[-1])
            actuator = by_model(choice)
            material = replace(material, max_pressure_bar=BAR_PER_MPA * _AGAIN * problem.reached)
            if problem.reached <= choice.limits.pressure[0]:
                break
    bent = model.shape(actuator.chain, actuator.pressure, actuator.pose, profile.sign)
    return Plan(
        layout=_layout(actuator, choice, bent, model, formula),
        by=_by(model),
        bent=bent,
        places=_places(bent, actuator.chain, profile),
        notes=tuple(notes),
        choice=choice,
        model=model,
    )


def _model(request: Request, formula: Formula) -> Model:
    material = request.material
    if request.formula is not None:
        return FormulaModel(formula, material.radius_mm)
    law = law_of(material.rubber)
    return Response.load().scaled(
        material.outer_diameter_mm, material.wall_mm, stiffness=law.C10 + law.C01
    )


def _by(model: Model) -> str:
    return "joint response" if isinstance(model, Response) else "formula"


def _chosen(profile: Profile, model: Model, material: Material, wish: Wish) -> Choice:
    try:
        return choose(profile, model, material, wish)
    except OutOfRange as error:
        raise UsageError(f"{error}; change --pitch, --max-pressure or --formula") from error


def _steps(request: Request) -> Steps:
    material = request.material
    thread = material.pitch_mm / material.radius_mm
    alpha = request.alpha_step_deg
    return Steps(
        alpha=thread if alpha is None else float(np.radians(alpha)),
        place=request.place_step_mm,
        pressure=_PRESSURE_STEP,
    )


def _corrected(
    request: Request,
    bench: Bench[S],
    profile: Profile,
    model: Model,
    choice: Choice,
    say: Callable[[str], None],
) -> Actuator:
    """Correct a choice on a bench, in numbers that can be built."""
    parameters = parameters_of(choice.chain, profile, choice.limits)
    vector = parameters.pack(Actuator(choice.chain, choice.pressure, choice.pose))
    found = correct(
        bench, model, parameters, vector, profile, _steps(request), request.interference_mm, say
    )
    return found.best.actuator


def _layout(
    actuator: Actuator, choice: Choice, bent: Shape, model: Model, formula: Formula
) -> Layout:
    chain, pressure_bar = actuator.chain, BAR_PER_MPA * actuator.pressure
    alpha = np.degrees(chain.alpha)
    wanted = np.abs(np.degrees(angles(choice.shape, choice.chain)))
    response = np.abs(np.degrees(angles(bent, chain)))
    by_formula = theta_deg(formula, alpha, chain.openF, pressure_bar)
    F = np.diff(np.append(chain.centre, chain.length))
    joints = tuple(
        Joint(
            number=k + 1,
            F_mm=float(F[k]),
            openF_mm=float(chain.openF[k]),
            alpha_closed_deg=float(alpha[k]),
            alpha_center_deg=TOWARD_DEG if chain.sense[k] > 0.0 else AWAY_DEG,
            theta_target_deg=float(wanted[k]),
            theta_formula_deg=float(by_formula[k]),
            theta_fe_deg=None,
            centre_mm=float(chain.centre[k]),
            theta_response_deg=float(response[k]) if isinstance(model, Response) else None,
        )
        for k in range(len(F))
    )
    root = float(chain.centre[0])
    return Layout(joints, root, chain.length, round(pressure_bar, 6), actuator.pose)


def angles(shape: Shape, chain: Chain) -> FloatArray:
    """Angle of every joint between the lines across the middles of its neighbours, rad: (n,).

    As FE reads it; unsigned turns are the caller's matter.
    """
    starts, ends = chain.centre - 0.5 * chain.openF, chain.centre + 0.5 * chain.openF
    edges = np.concatenate([[0.0], np.column_stack([starts, ends]).ravel(), [chain.length]])
    middles = 0.5 * (edges[::2] + edges[1::2])
    across = shape.far - shape.facing
    x, y = (np.interp(middles, shape.along, across[:, k]) for k in (0, 1))
    turns = np.diff(np.unwrap(np.arctan2(y, x)))
    return np.asarray(turns, dtype=float)


def _places(shape: Shape, chain: Chain, profile: Profile) -> FloatArray:
    """Arc length of the profile's points nearest to the joints on the bent tube: (n,) mm."""
    at = np.column_stack([np.interp(chain.centre, shape.along, shape.facing[:, k]) for k in (0, 1)])
    away = np.hypot(*np.moveaxis(profile.points[:, None] - at, -1, 0))
    return np.asarray(profile.s[np.argmin(away, axis=0)], dtype=float)


def misses(plan: Plan, shape: Shape, profile: Profile, request: Request) -> tuple[Missed, ...]:
    """Find the stretches of the profile that an optimal plan's bent shape is far off, with why."""
    if plan.choice is None or plan.model is None:
        return ()
    bent = replace(plan.choice, shape=shape)
    place = _placer(request, profile)
    return missed(profile, bent, plan.model, request.material, TOLERANCE_MM, place)


def not_good(
    design: Design, profile: Profile, request: Request, places: Sequence[Missed]
) -> tuple[str, ...]:
    """Give reasons why an optimal plan is no design; none where it is good enough."""
    fit = design.fit.fe or design.fit.response or design.fit.formula
    limit = request.tolerance_mm or GOOD_SHARE * profile.length_mm
    reasons = []
    if fit.rms_mm > limit:
        reasons.append(
            f"the best shape found lies {fit.rms_mm:.2f} mm RMS and up to {fit.max_mm:.2f} mm off "
            f"the profile, more than {limit:.2f} mm RMS"
        )
        reasons += [place.reason for place in places]
    if request.joints is not None and len(design.joints) < request.joints:
        reasons.append(
            f"there is no room for {request.joints} joints on this profile, only "
            f"{len(design.joints)}"
        )
    longest = request.material.max_length_mm
    if design.tube.length_mm > longest + _SLACK_MM:
        reasons.append(
            f"the tube would be {design.tube.length_mm:.1f} mm long, more than {longest:g} mm; "
            "shorten the stretch (--from, --to), or raise --max-length"
        )
    return tuple(reasons)
