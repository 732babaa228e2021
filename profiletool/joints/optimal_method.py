"""The optimal method: all joints chosen at once, then corrected on a forward model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from formula.errors import OutOfRange
from formula.theta import Formula, theta_deg
from profiletool.bending.constant_curvature import FormulaModel
from profiletool.bending.model import Chain, Model
from profiletool.bending.response import Response
from profiletool.errors import UsageError
from profiletool.joints.bounds import PRESSURE_STEP, Limits
from profiletool.joints.correction.by_model import BendingForwardModel
from profiletool.joints.correction.correct import (
    CannotBend,
    Corrected,
    ForwardModel,
    StepSizes,
    correct,
)
from profiletool.joints.correction.parameters import PosedChain, parameters_of
from profiletool.joints.expected import Aim, ErrorSizes, Expected, error_sizes
from profiletool.joints.layout import Layout
from profiletool.joints.misfit import misfit
from profiletool.joints.optimal.choose import TOLERANCE_MM, Choice, ChoiceOptions, choose
from profiletool.joints.plan import Plan, out_of_reach
from profiletool.profile.curve import points_at
from profiletool.records.design import AWAY_DEG, TOWARD_DEG, Joint
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.request import PLACE_STEP_MM, Request, TubeSpec
from profiletool.records.rubber import law_of
from profiletool.records.units import BAR_PER_MPA, FloatArray

S = TypeVar("S")
_CHOICES = 2
_MESH_COSTS_MM = 0.1  # RMS: what nobody sees, where every cut falls on whole threads
_AGAIN = 0.97  # of the pressure that a tube stands, where it does not stand the one asked


def optimal_plan(
    request: Request,
    profile: Profile,
    formula: Formula,
    say: Callable[[str], None],
    forward: ForwardModel[S] | None = None,
    *,
    neighbours: bool = False,
) -> Plan:
    """Choose all joints at once, go to numbers that can be built, and correct them.

    Parameters
    ----------
    request : Request
    profile : Profile
    formula : Formula
        For the angles of the design's table; the joints are chosen by it where the user gave it.
    say : callable
        Takes one line of progress at a time.
    forward : ForwardModel, optional
        Of the correction, such as finite elements of the whole actuator; by default the model
        that the joints are chosen by.
    neighbours : bool
        Whether the choice tells of its neighbours, too; see `Choice`.

    Raises
    ------
    UsageError
        When the request leaves no cut or pressure that the joints are known for.
    NoObject
        When the profile is straight.
    Infeasible
        When no joints follow the profile even roughly.
    """
    model = model_of(request, formula)
    _check_pressures(request.tube, model)
    posed, choice, notes, hopeless = _standing(request, profile, model, say, forward, neighbours)
    bent = model.shape(posed.chain, posed.pressure, posed.pose, profile.sign)
    return Plan(
        layout=_layout(posed, choice, bent, model, formula),
        by=_by(model),
        bent=bent,
        places=places_of(bent, posed.chain, profile),
        notes=notes,
        choice=choice,
        model=model,
        hopeless=hopeless,
    )


def _standing(
    request: Request,
    profile: Profile,
    model: Model,
    say: Callable[[str], None],
    forward: ForwardModel[S] | None,
    neighbours: bool,
) -> tuple[PosedChain, Choice, tuple[str, ...], str]:
    """Choose and correct joints; where the forward model cannot bend them, again at less pressure.

    Where it cannot bend the second choice either, or the first is out of reach, that stays as the
    bending model corrects it. The notes say so, and the last why it is out of reach.
    """

    def say_fe(line: str) -> None:
        say(f"finite elements, {line}")

    spec, notes = request.tube, list[str]()
    for _ in range(_CHOICES):
        choice = _chosen(request, profile, model, spec, neighbours)
        say(
            f"joints: {len(choice.chain.openF)} at {BAR_PER_MPA * choice.pressure:.2f} bar, "
            f"{choice.misfit.rms_mm:.2f} mm RMS off the profile by the {_by(model)}"
        )
        hopeless = out_of_reach(profile.length_mm, choice.misfit.rms_mm, request)
        steps, posed = _settled(request, choice, profile, model)
        if forward is None or hopeless:
            return posed, choice, tuple(notes), hopeless
        try:
            found = correction(steps, forward, profile, model, start_of(choice), say_fe)
            return found.best.posed, choice, tuple(notes), ""
        except CannotBend as problem:
            notes.append(f"the first choice of joints did not stand by FE: {problem}")
            say(notes[-1])
            spec = replace(spec, max_pressure_bar=BAR_PER_MPA * _AGAIN * problem.reached)
            if problem.reached <= choice.limits.pressure[0]:  # as where the pressure is given
                break
    return posed, choice, tuple(notes), ""


def _settled(
    request: Request, choice: Choice, profile: Profile, model: Model
) -> tuple[Request, PosedChain]:
    """Settle the step of the places (see `Request`), and correct a choice by the bending model."""
    asked = [request]
    if request.place_step_mm is None:
        steps = (PLACE_STEP_MM, request.tube.pitch_mm)
        asked = [replace(request, place_step_mm=step) for step in steps]
    bending, start = BendingForwardModel(model), start_of(choice)
    found = [correction(one, bending, profile, model, start, lambda line: None) for one in asked]
    fits = [misfit(one.best.shape, profile).rms_mm for one in found]
    best = 1 if len(fits) > 1 and fits[1] < fits[0] + _MESH_COSTS_MM else 0
    return asked[best], found[best].best.posed


def _check_pressures(spec: TubeSpec, model: Model) -> None:
    """Refuse pressures that the joints are not known for."""
    low, high = (BAR_PER_MPA * pressure for pressure in model.pressure)
    if spec.max_pressure_bar < low:
        raise UsageError(
            f"`max_pressure_bar` {spec.max_pressure_bar:g} bar is less than the {low:g} bar from "
            f"which on the joints are known by the {_by(model)}"
        )
    given = spec.pressure_bar
    if given is not None and not low - 1e-9 <= given <= high + 1e-9:
        raise UsageError(
            f"`pressure_bar` {given:g} bar is not within the {low:g} to {high:g} bar that the "
            f"joints are known for by the {_by(model)}"
        )


def model_of(request: Request, formula: Formula) -> Model:
    """Model that joints are chosen by: the joint response, or the formula that the user gave."""
    spec = request.tube
    if request.formula is not None:
        return FormulaModel(formula, spec.radius_mm)
    law = law_of(spec.rubber)
    return Response.load().scaled(
        spec.outer_diameter_mm, spec.wall_mm, stiffness=0.5 * law.shear_modulus
    )


def _by(model: Model) -> str:
    return "joint response" if isinstance(model, Response) else "formula"


def _chosen(
    request: Request, profile: Profile, model: Model, spec: TubeSpec, neighbours: bool
) -> Choice:
    options = ChoiceOptions(
        tolerance_mm=request.tolerance_mm or TOLERANCE_MM,
        interference_mm=request.interference_mm,
        count=request.joints,
        base_free=request.base_free,
        sizes=_sizes(request),
        neighbours=neighbours,
    )
    try:
        return choose(profile, model, spec, options)
    except OutOfRange as error:
        raise UsageError(f"{error}; change `pitch_mm`, `max_pressure_bar` or `formula`") from error


def _sizes(request: Request) -> ErrorSizes | None:
    """Errors that count in the choice; none where perfect parts are asked for."""
    return None if request.objective == "nominal" else error_sizes(request.build, request.tube)


def _aim(request: Request, model: Model) -> Aim:
    sizes = _sizes(request)
    expected = None if sizes is None else Expected(model, sizes)
    return Aim(request.interference_mm, expected)


def _step_sizes(request: Request) -> StepSizes:
    spec = request.tube
    alpha, place = request.alpha_step_deg, request.place_step_mm
    return StepSizes(
        alpha=spec.thread_rad if alpha is None else float(np.radians(alpha)),
        place=PLACE_STEP_MM if place is None else place,
        pressure=PRESSURE_STEP,
    )


def start_of(choice: Choice) -> tuple[PosedChain, Limits]:
    """Give what the correction of a choice starts from, and its bounds."""
    return PosedChain(choice.chain, choice.pressure, choice.pose), choice.limits


def correction(
    request: Request,
    forward: ForwardModel[S],
    profile: Profile,
    model: Model,
    start: tuple[PosedChain, Limits],
    say: Callable[[str], None],
) -> Corrected[S]:
    """Correct an actuator by a forward model, in numbers that can be built."""
    posed, limits = start
    parameters, aim = parameters_of(posed.chain, profile, limits), _aim(request, model)
    vector, steps = parameters.pack(posed), _step_sizes(request)
    return correct(forward, model, parameters, vector, profile, steps, aim, say)


def _layout(
    posed: PosedChain, choice: Choice, bent: Shape, model: Model, formula: Formula
) -> Layout:
    chain, pressure_bar = posed.chain, BAR_PER_MPA * posed.pressure
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
    return Layout(joints, root, chain.length, round(pressure_bar, 6), posed.pose)


def angles(shape: Shape, chain: Chain) -> FloatArray:
    """Angle of every joint between the lines across the middles of its neighbours, rad: (n,).

    As FE reads it; unsigned turns are the caller's matter.
    """
    starts, ends = chain.centre - 0.5 * chain.openF, chain.centre + 0.5 * chain.openF
    edges = np.concatenate([[0.0], np.column_stack([starts, ends]).ravel(), [chain.length]])
    middles = 0.5 * (edges[::2] + edges[1::2])
    across = shape.far - shape.facing
    x, y = points_at(middles, shape.along, across).T
    turns = np.diff(np.unwrap(np.arctan2(y, x)))
    return np.asarray(turns, dtype=float)


def places_of(shape: Shape, chain: Chain, profile: Profile) -> FloatArray:
    """Arc length of the profile's points nearest to the joints on the bent tube: (n,) mm."""
    at = points_at(chain.centre, shape.along, shape.facing)
    away = np.hypot(*np.moveaxis(profile.points[:, None] - at, -1, 0))
    return np.asarray(profile.s[np.argmin(away, axis=0)], dtype=float)
