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
from profiletool.joints.correction.correct import Bench, CannotBend, ModelBench, Steps, correct
from profiletool.joints.correction.parameters import Actuator, parameters_of
from profiletool.joints.optimal.choose import TOLERANCE_MM, Choice, Wish, choose
from profiletool.joints.paper.assign import Layout
from profiletool.joints.plan import Plan
from profiletool.records.design import AWAY_DEG, TOWARD_DEG, Joint
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.request import Request, TubeSpec
from profiletool.records.rubber import law_of
from profiletool.records.units import BAR_PER_MPA, FloatArray

S = TypeVar("S")
_PRESSURE_STEP = 0.001  # MPa: what a gauge can be set to
_AGAIN = 0.97  # of the pressure that a tube stands, where it does not stand the one asked


def optimal_plan(
    request: Request,
    profile: Profile,
    formula: Formula,
    say: Callable[[str], None],
    bench: Bench[S] | None = None,
) -> Plan:
    """Choose all joints at once, go to numbers that can be built, and correct them on a bench.

    ``bench`` is the forward model of the correction, such as finite elements of the whole
    actuator; None for the model that the joints were chosen by.

    Raises
    ------
    UsageError, NoObject
    """
    model = _model(request, formula)
    if request.tube.max_pressure_bar < BAR_PER_MPA * model.pressure[0]:
        raise UsageError(
            f"`max_pressure_bar` {request.tube.max_pressure_bar:g} bar is less than the "
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

    material, notes = request.tube, list[str]()
    for _ in range(2):
        choice = _chosen(profile, model, material, wish)
        say(
            f"joints: {len(choice.chain.openF)} at {BAR_PER_MPA * choice.pressure:.2f} bar, "
            f"{choice.misfit.rms_mm:.2f} mm RMS off the profile by the {_by(model)}"
        )
        if bench is None:
            actuator = by_model(choice)
            break
        try:
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
    material = request.tube
    if request.formula is not None:
        return FormulaModel(formula, material.radius_mm)
    law = law_of(material.rubber)
    return Response.load().scaled(
        material.outer_diameter_mm, material.wall_mm, stiffness=0.5 * law.shear_modulus
    )


def _by(model: Model) -> str:
    return "joint response" if isinstance(model, Response) else "formula"


def _chosen(profile: Profile, model: Model, material: TubeSpec, wish: Wish) -> Choice:
    try:
        return choose(profile, model, material, wish)
    except OutOfRange as error:
        raise UsageError(f"{error}; change `pitch_mm`, `max_pressure_bar` or `formula`") from error


def _steps(request: Request) -> Steps:
    material = request.tube
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
