from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formula.files import load_formula
from profiletool.bending.constant_curvature import FormulaModel
from profiletool.bending.model import centers_of
from profiletool.joints.bounds import Limits
from profiletool.joints.closest import closest_points, distance_jacobian
from profiletool.joints.correction.parameters import Parameters, facing_motion
from profiletool.records.units import FloatArray

MODEL = FormulaModel(load_formula(), 10.0)
LIMITS = Limits(MODEL.alpha, (0.02, 0.2), 2.0, 4.0, 10.0, 250.0)
PARAMETERS = Parameters(
    openF=np.array([8.0, 10.0, 6.0]),
    alpha_center=centers_of(np.array([1.0, 1.0, -1.0])),
    end_mm=20.0,
    start=(3.0, -2.0),
    heading=2.5,
    sign=1.0,
    limits=LIMITS,
)
VECTOR = np.array([1.8, 2.0, 2.2, 7.0, 9.0, 12.0, 0.17])


def freed(sign: float = 1.0) -> Parameters:
    return replace(
        PARAMETERS, sign=sign, limits=replace(LIMITS, base_turn_rad=0.2, base_offset_mm=3.0)
    )


def facing(parameters: Parameters, vector: FloatArray) -> FloatArray:
    at = parameters.unpack(vector)
    return MODEL.shape(at.chain, at.pressure, at.pose, parameters.sign).facing


@given(place=st.floats(-20.0, 60.0), turn=st.floats(-0.2, 0.2), offset=st.floats(-3.0, 3.0))
def test_pack_undoes_unpack(place: float, turn: float, offset: float) -> None:
    for sign in (1.0, -1.0):
        parameters = freed(sign)
        vector = np.concatenate([VECTOR, [turn, offset]])
        vector[5] = place
        assert parameters.pack(parameters.unpack(vector)) == pytest.approx(vector, abs=1e-9)
    vector = np.concatenate([VECTOR[:5], [place, 0.1]])
    assert PARAMETERS.pack(PARAMETERS.unpack(vector)) == pytest.approx(vector, abs=1e-9)


def test_the_base_starts_behind_the_profile_only_where_the_root_needs_it() -> None:
    at = PARAMETERS.unpack(VECTOR)
    assert (at.pose.x_mm, at.pose.y_mm) == pytest.approx(PARAMETERS.start)
    assert at.chain.centre.tolist() == [12.0, 28.0, 45.0]
    assert at.chain.length == 45.0 + 3.0 + 20.0
    near = VECTOR.copy()
    near[5] = 4.0
    moved = PARAMETERS.unpack(near)
    assert moved.chain.centre[0] == LIMITS.root_mm
    back = np.array([moved.pose.x_mm, moved.pose.y_mm]) - PARAMETERS.start
    assert back == pytest.approx(-6.0 * np.array([np.cos(2.5), np.sin(2.5)]))


def test_bounds_hold_the_limits() -> None:
    low, high = freed().bounds()
    assert low.shape == high.shape == (freed().size,) == freed().scale().shape
    assert low[3:5].tolist() == [2.0, 2.0]
    assert (low[-2:].tolist(), high[-2:].tolist()) == ([-0.2, -3.0], [0.2, 3.0])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_jacobian_of_the_residuals_against_differences(sign: float) -> None:
    parameters = freed(sign)
    vector = np.concatenate([VECTOR, [0.05, 0.5]])
    line = facing(parameters, vector)
    rng = np.random.default_rng(1)
    points = line[4:-4:5] + rng.normal(0.0, 0.7, (len(line[4:-4:5]), 2))
    at = parameters.unpack(vector)
    shape = MODEL.shape(at.chain, at.pressure, at.pose, sign)
    motion = facing_motion(parameters, MODEL, vector, shape)
    jacobian = distance_jacobian(closest_points(line, points, sign), motion)
    for k, scale in enumerate(parameters.scale()):
        step = np.zeros(parameters.size)
        step[k] = 0.01 * scale
        ahead, behind = (
            closest_points(facing(parameters, vector + s), points, sign) for s in (step, -step)
        )
        slope = (ahead.distance - behind.distance) / (2.0 * step[k])
        assert np.median(np.abs(jacobian[:, k] - slope)) * scale < 2e-3
        assert np.abs(jacobian[:, k] - slope).max() * scale < 0.05
