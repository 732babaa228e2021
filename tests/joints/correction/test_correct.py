"""Corrections by forward models whose truth is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from formula.files import load_formula
from profiletool.bending.constant_curvature import FormulaModel
from profiletool.bending.kinematics import Bend, deform
from profiletool.bending.model import Chain, Model, centers_of
from profiletool.bending.response import Response
from profiletool.joints.bounds import Limits
from profiletool.joints.closest import closest_points
from profiletool.joints.correction.by_model import BendingForwardModel
from profiletool.joints.correction.correct import (
    CannotBend,
    Corrected,
    ForwardModel,
    Iterate,
    StepSizes,
    correct,
)
from profiletool.joints.correction.parameters import Parameters, PosedChain
from profiletool.joints.expected import Aim
from profiletool.profile.curve import arc_length
from profiletool.records.frames import Pose, Shape
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray

FORMULA = FormulaModel(load_formula(), 10.0)
LIMITS = Limits((1.3, 3.0), (0.02, 0.2), 2.0, 4.0, 10.0, 250.0)
FREE = StepSizes(0.0, 0.0, 0.0)
BUILT = StepSizes(0.2, 1.0, 0.001)
TRUE = np.array([1.9, 2.2, 1.8, 9.0, 12.0, 14.0, 0.15])
OFF = np.array([0.1, -0.12, 0.08, 1.0, -1.2, 0.7, -0.006])


def numbers(sign: float = 1.0) -> Parameters:
    return Parameters(
        openF=np.array([8.0, 10.0, 6.0]),
        alpha_center=centers_of(np.array([1.0, -1.0, 1.0])),
        end_mm=20.0,
        start=(3.0, -2.0),
        heading=2.5,
        sign=sign,
        limits=LIMITS,
    )


def bent(model: Model, parameters: Parameters, vector: FloatArray) -> Shape:
    at = parameters.unpack(vector)
    return model.shape(at.chain, at.pressure, at.pose, parameters.sign)


def profile_along(shape: Shape, side: str, less_mm: float = 10.0) -> Profile:
    """A target that runs along a bent tube's line, but for its end."""
    s = np.arange(0.0, arc_length(shape.facing)[-1] - less_mm, 0.1)
    at = arc_length(shape.facing)
    points = np.column_stack([np.interp(s, at, shape.facing[:, k]) for k in (0, 1)])
    heading = np.unwrap(np.arctan2(*np.gradient(points, axis=0).T[::-1]))
    nothing = np.zeros(len(s))
    assert side in ("left", "right")
    return Profile(
        points, s, heading, nothing, nothing.astype(bool),
        "left" if side == "left" else "right", None,
    )  # fmt: skip


def corrected(
    forward: ForwardModel[None],
    model: Model,
    profile: Profile,
    steps: StepSizes = FREE,
    off: FloatArray = OFF,
    said: list[str] | None = None,
) -> Corrected[None]:
    told: list[str] = [] if said is None else said
    return correct(
        forward, model, numbers(profile.sign), TRUE + off, profile, steps, Aim(0.3), told.append
    )


NEAR_MM = 0.07  # of 0.8 to 1 mm: where a step's damping promises too little to go on
END = 3  # points: the tube's end follows the iterate before, and may be a millimetre short


def rms(found: Corrected[None]) -> float:
    return float(np.sqrt(np.mean(found.best.closest.distance[:-END] ** 2)))


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("by", ["formula", "response"])
def test_a_known_actuator_is_found_back(by: str, side: str) -> None:
    model: Model = FORMULA if by == "formula" else Response.load()
    sign = 1.0 if side == "left" else -1.0
    target = profile_along(bent(model, numbers(sign), TRUE), side)
    said: list[str] = []
    found = corrected(BendingForwardModel(model), model, target, said=said)
    assert found.rms_mm[0] > 0.8
    assert rms(found) < NEAR_MM
    assert np.sqrt(np.mean(found.best.closest.distance**2)) == pytest.approx(min(found.rms_mm))
    assert len(said) == len(found.rms_mm) <= 7
    at, true = found.best.posed, numbers(sign).unpack(TRUE)
    turns = [np.degrees(model.theta(a.chain.openF, a.chain.alpha, a.pressure)) for a in (at, true)]
    assert turns[0] == pytest.approx(turns[1], abs=1.5)
    assert at.chain.centre == pytest.approx(true.chain.centre, abs=1.0)


class Eager(FormulaModel):
    """Joints that bend a tenth more than the formula says."""

    def shape(self, chain: Chain, pressure: float, pose: Pose, sign: float) -> Shape:
        turns = 1.1 * chain.sense * self.theta(chain.openF, chain.alpha, pressure)
        bends = [Bend(*three) for three in zip(chain.centre, chain.openF, turns, strict=True)]
        return deform(bends, chain.length, self.radius, pose, sign)


def test_a_forward_model_that_bends_more_than_the_model_says() -> None:
    truth = Eager(load_formula(), 10.0)
    target = profile_along(bent(truth, numbers(), TRUE), "left")
    found = corrected(BendingForwardModel(truth), FORMULA, target)
    assert rms(found) < NEAR_MM
    turns = 1.1 * FORMULA.theta(
        found.best.posed.chain.openF, found.best.posed.chain.alpha,
        found.best.posed.pressure,
    )  # fmt: skip
    wanted = 1.1 * FORMULA.theta(numbers().openF, TRUE[:3], TRUE[-1])
    assert np.degrees(turns) == pytest.approx(np.degrees(wanted), abs=1.5)


@pytest.mark.parametrize("by", ["formula", "response"])
def test_what_can_be_built_is_whole_and_nearly_as_good(by: str) -> None:
    model: Model = FORMULA if by == "formula" else Response.load()
    target = profile_along(bent(model, numbers(), TRUE), "left")
    found = corrected(BendingForwardModel(model), model, target, BUILT)
    vector = found.best.vector
    for some, step in ((vector[:3], 0.2), (vector[3:6], 1.0), (vector[6:], 0.001)):
        assert some / step == pytest.approx(np.round(some / step), abs=1e-6)
    free = corrected(BendingForwardModel(model), model, target)
    naive = free.best.vector.copy()
    for some, step in ((naive[:3], 0.2), (naive[3:6], 1.0), (naive[6:], 0.001)):
        some[:] = np.round(some / step) * step
    points = target.points[::5]
    rounded = closest_points(bent(model, numbers(), naive).facing, points, 1.0).distance
    best = closest_points(found.best.shape.facing, points, 1.0).distance
    assert np.sqrt(np.mean(best**2)) < 0.7 * np.sqrt(np.mean(rounded**2))
    low, high = found.best.parameters.bounds()
    assert ((vector >= low - 1e-9) & (vector <= high + 1e-9)).all()


def test_a_tube_that_slides_as_a_whole_needs_no_whole_place() -> None:
    # Joint 1 nearer to the profile's start than the root allows: the root keeps its length.
    true = TRUE + np.array([0.0] * 5 + [-8.63, 0.0])
    target = replace(profile_along(bent(FORMULA, numbers(), true), "left"))
    start = numbers().start
    away = np.hypot(*(target.points - start).T)
    first = int(np.argmin(away))
    rest = replace(
        target, **{k: getattr(target, k)[first:] for k in ("points", "heading", "curvature")},
        s=target.s[first:] - target.s[first], bridged=target.bridged[first:],
    )  # fmt: skip
    found = corrected(BendingForwardModel(FORMULA), FORMULA, rest, BUILT, true - TRUE + OFF)
    place = found.best.vector[5]
    assert not found.best.parameters.root_grows(found.best.vector)
    assert abs(place - round(place)) > 1e-3
    assert rms(found) < 0.5


def test_the_tube_ends_where_the_profile_does() -> None:
    target = profile_along(bent(FORMULA, numbers(), TRUE), "left")
    found = corrected(BendingForwardModel(FORMULA), FORMULA, target)
    beyond = arc_length(found.best.shape.facing)[-1] - target.length_mm
    assert -0.5 * END <= beyond <= 2.5
    assert found.best.parameters.end_mm == round(found.best.parameters.end_mm)


class Failing(BendingForwardModel):
    """Cannot bend some of the iterates, counted from 0."""

    def __init__(self, model: Model, *failing: int) -> None:
        super().__init__(model)
        self.failing, self.count = failing, 0

    def bend(
        self, posed: PosedChain, sign: float, near: Iterate[None] | None
    ) -> tuple[Shape, None]:
        self.count += 1
        if self.count - 1 in self.failing:
            raise CannotBend("limit point at 1.40 bar", 0.14)
        return super().bend(posed, sign, near)


TARGET = profile_along(bent(FORMULA, numbers(), TRUE), "left")


def test_a_first_guess_that_cannot_be_bent_is_raised() -> None:
    with pytest.raises(CannotBend, match=r"limit point at 1\.40 bar") as caught:
        corrected(Failing(FORMULA, 0), FORMULA, TARGET)
    assert caught.value.reached == 0.14


def test_later_ones_are_survived() -> None:
    said: list[str] = []
    forward = Failing(FORMULA, 1)
    found = corrected(forward, FORMULA, TARGET, said=said)
    assert "all numbers free: limit point at 1.40 bar" in said
    assert rms(found) < 0.3 * found.rms_mm[0]  # by a shorter step
    assert forward.count == len(found.rms_mm) + 1


def test_the_best_that_could_be_bent_is_kept() -> None:
    found = corrected(Failing(FORMULA, *range(1, 100)), FORMULA, TARGET)
    assert len(found.rms_mm) == 1
    assert (found.best.vector == TRUE + OFF).all()


def test_numbers_that_cannot_be_built_are_never_given() -> None:
    with pytest.raises(CannotBend, match=r"limit point at 1\.40 bar"):
        corrected(Failing(FORMULA, *range(1, 100)), FORMULA, TARGET, BUILT)


def test_where_one_rounding_cannot_be_bent_another_is_tried() -> None:
    said: list[str] = []
    usual = corrected(BendingForwardModel(FORMULA), FORMULA, TARGET, BUILT, said=said)
    first = said.index(next(line for line in said if "can be built" in line))
    forward = Failing(FORMULA, first)
    found = corrected(forward, FORMULA, TARGET, BUILT)
    assert usual.best.posed.pressure > 0.97 * 0.14
    assert found.best.posed.pressure <= 0.97 * 0.14 + 1e-9
    assert found.best.vector[:3] / 0.2 == pytest.approx(np.round(found.best.vector[:3] / 0.2))
