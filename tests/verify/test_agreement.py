"""Measured against predicted angles."""

from __future__ import annotations

import numpy as np
import pytest

from profiletool.verify.agreement import agreement, agreements


def test_a_model_too_stiff_has_a_high_r2_and_the_wrong_slope() -> None:
    true = np.linspace(2.0, 60.0, 12)
    found = agreement(true, true / 1.3)
    assert found is not None
    assert found.r2 > 0.999
    assert found.slope == pytest.approx(1.3)
    assert found.bias_deg == pytest.approx(float(np.mean(true - true / 1.3)))


def test_bias_and_limits() -> None:
    model = np.array([10.0, 20.0, 30.0, 40.0])
    off = np.array([1.0, 3.0, 1.0, 3.0])
    found = agreement(model + off, model)
    assert found is not None
    assert found.bias_deg == pytest.approx(2.0)
    assert found.rmse_deg == pytest.approx(np.sqrt(5.0))
    width = 1.96 * np.std(off, ddof=1)
    assert found.limits_deg == pytest.approx((2.0 - width, 2.0 + width))


def test_lost_angles_do_not_count() -> None:
    model = np.array([[10.0, 5.0], [20.0, 9.0], [30.0, 12.0]])
    measured = model + 1.0
    measured[1, 1] = np.nan
    each, whole = agreements(measured, model)
    assert [one.count for one in each if one is not None] == [3, 2]
    assert whole is not None
    assert whole.count == 5
    assert agreement(measured[:1, 0], model[:1, 0]) is None
