"""Finite elements in the loop, on a small actuator of two opposite joints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fem.equilibrium import Critical
from fem.errors import BadGeometry, NotConverged
from fem.meshsize import MeshSize
from fem.solution import Solution
from profiletool.bending.model import centers_of
from profiletool.bending.response import Response
from profiletool.joints.bounds import Limits
from profiletool.joints.closest import closest_points, distance_jacobian
from profiletool.joints.correction.correct import CannotBend, Iterate, StepSizes, correct
from profiletool.joints.correction.parameters import Parameters
from profiletool.joints.expected import Aim
from profiletool.profile.curve import arc_length
from profiletool.records.frames import Shape
from profiletool.records.profile import Profile
from profiletool.records.request import TubeSpec
from profiletool.records.units import FloatArray
from profiletool.verify.forward import FeForwardModel

MESH = MeshSize(beside=0.0)  # kinks at the cuts' edges are as sharp as the layers there are thin
LIMITS = Limits((1.2, 3.0), (0.02, 0.2), 2.0, 4.0, 10.0, 250.0, 0.2, 3.0)
NUMBERS = Parameters(
    openF=np.array([8.0, 6.0]),
    alpha_center=centers_of(np.array([1.0, -1.0])),
    end_mm=6.0,
    start=(3.0, -2.0),
    heading=2.5,
    sign=1.0,
    limits=LIMITS,
)
#                  alpha     wrapped place press turn offset
VECTOR = np.array([1.9, 2.1, 7.0, 13.0, 0.1, 0.05, 0.4])
NAMES = ("alpha 1", "alpha 2", "wrapped", "place", "pressure", "turn", "offset")
# Share of the motion that may be missed. Where the tube slides along itself, the line's kinks at
# the cuts' edges pass the feet: that share is of the differences, not of the derivatives.
MISSED = (0.01, 0.03, 0.12, 0.07, 0.01, 0.001, 0.001)


def iterate_at(
    vector: FloatArray, forward: FeForwardModel, near: Iterate[Solution] | None
) -> Iterate[Solution]:
    shape, state = forward.bend(NUMBERS.unpack(vector), NUMBERS.sign, near)
    return Iterate(NUMBERS, vector, shape, closest_points(shape.facing, shape.facing, 1.0), state)


@pytest.fixture(scope="module")
def bent() -> Iterate[Solution]:
    return iterate_at(VECTOR, FeForwardModel(TubeSpec()), None)


def beside(shape: Shape, off_mm: float = 0.7) -> FloatArray:
    """Points off a tube's line, on the object's side; not next to the ends."""
    outward = shape.far - shape.facing
    outward /= np.hypot(*outward.T)[:, None]
    points: FloatArray = (shape.facing - off_mm * outward)[6:-6:2]
    return points


def test_motion_against_differences(bent: Iterate[Solution]) -> None:
    forward = FeForwardModel(TubeSpec())
    points = beside(bent.shape)
    jacobian = distance_jacobian(
        closest_points(bent.shape.facing, points, 1.0), forward.motion(bent)
    )
    assert jacobian.shape == (len(points), len(NAMES))
    for k, (name, scale, most) in enumerate(zip(NAMES, NUMBERS.scale(), MISSED, strict=True)):
        step = 0.1 * scale * np.eye(len(NAMES))[k]
        ahead, behind = (
            closest_points(
                iterate_at(VECTOR + by, forward, bent).shape.facing, points, 1.0
            ).distance
            for by in (step, -step)
        )
        slope = (ahead - behind) / (2.0 * step[k])
        missed = np.linalg.norm(jacobian[:, k] - slope) / np.linalg.norm(slope)
        assert np.abs(slope).max() * scale > 0.01, name
        assert missed < most, f"{name}: {missed:.3f}"


def test_a_short_root_lets_the_tube_slide() -> None:
    # Joint 1 nearer to the profile's start than its root is long.
    vector = VECTOR.copy()
    vector[3] = 4.0
    forward = FeForwardModel(TubeSpec())
    at = iterate_at(vector, forward, None)
    heading = 2.5 + vector[-2]
    slide = forward.motion(at)[3]
    assert slide == pytest.approx(np.tile([np.cos(heading), np.sin(heading)], (len(slide), 1)))


def target_of(shape: Shape) -> Profile:
    """A profile along a bent tube's line, but for its end."""
    at = arc_length(shape.facing)
    s = np.arange(0.0, at[-1] - 3.0, 0.1)
    points = np.column_stack([np.interp(s, at, shape.facing[:, k]) for k in (0, 1)])
    heading = np.unwrap(np.arctan2(*np.gradient(points, axis=0).T[::-1]))
    nothing = np.zeros(len(s))
    return Profile(points, s, heading, nothing, nothing.astype(bool), "left", None)


@pytest.mark.slow
def test_a_target_made_by_fe_is_reached(bent: Iterate[Solution]) -> None:
    off = np.array([0.3, 0.3, 1.0, 1.5, -0.01, 0.0, -0.3])
    said: list[str] = []
    found = correct(
        FeForwardModel(TubeSpec()), Response.load(), NUMBERS, VECTOR + off, target_of(bent.shape),
        StepSizes(0.0, 0.0, 0.0), Aim(0.3), said.append,
    )  # fmt: skip
    assert found.rms_mm[0] > 0.3
    assert np.sqrt(np.mean(found.best.closest.distance[:-3] ** 2)) < 0.1
    assert len(found.rms_mm) == len(said) <= 6
    # The state is one of the actuator that is handed back.
    alone, _ = FeForwardModel(TubeSpec()).bend(found.best.posed, 1.0, None)
    assert found.best.shape.facing == pytest.approx(alone.facing, abs=0.02)


def failing(error: Exception) -> Callable[..., Solution]:
    def fails(*_: object, **__: object) -> Solution:
        raise error

    return fails


@pytest.mark.parametrize(
    ("error", "says", "reached"),
    [
        (NotConverged("inverted", (), 0.12), "no equilibrium found beyond 1.20 bar", 0.12),
        (BadGeometry("a cut of 0 mm"), "cannot be modelled: a cut of 0 mm", 0.0),
    ],
)
def test_what_cannot_be_bent(
    error: Exception, says: str, reached: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("profiletool.verify.forward.solve", failing(error))
    with pytest.raises(CannotBend) as caught:
        FeForwardModel(TubeSpec()).bend(NUMBERS.unpack(VECTOR), 1.0, None)
    assert str(caught.value) == says
    assert caught.value.reached == reached


def test_a_path_that_ends_cannot_be_bent(
    bent: Iterate[Solution], monkeypatch: pytest.MonkeyPatch
) -> None:
    ended = replace(bent.state, critical=Critical("limit point", 0.09))
    monkeypatch.setattr("profiletool.verify.forward.solve", lambda *_, **__: ended)
    with pytest.raises(CannotBend, match=r"limit point at 0\.90 bar") as caught:
        FeForwardModel(TubeSpec()).bend(NUMBERS.unpack(VECTOR), 1.0, None)
    assert caught.value.reached == 0.09


def test_too_far_from_a_known_state_it_goes_from_rest(
    bent: Iterate[Solution], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "profiletool.verify.forward.solve_near", failing(NotConverged("far", (), 0.0))
    )
    monkeypatch.setattr("profiletool.verify.forward.solve", lambda *_, **__: bent.state)
    _, state = FeForwardModel(TubeSpec()).bend(NUMBERS.unpack(VECTOR), 1.0, bent)
    assert state is bent.state
