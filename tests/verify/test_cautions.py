"""Cautions about runs that converged, from numbers made up and from a soft tube."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fem.actuator import chain
from formula.rubber import RubberLaw
from profiletool.records.design import joints_too_near
from profiletool.records.fe import CriticalPoint, FeState, Verification
from profiletool.records.frames import Shape
from profiletool.records.rubber import BREAKS, PAPER_BREAKS, breaking_stretch
from profiletool.rubber.presets import PRESETS
from profiletool.verify.cautions import LAW_HOLDS, cautions
from profiletool.verify.run import DOWN, LYING, breaking, inflate

LINE = np.column_stack([np.linspace(0.0, 90.0, 10), np.zeros(10)])
SHAPE = Shape(LINE[:, 0], LINE, LINE, LINE)
STATE = FeState(
    1.0, (20.0, 30.0), SHAPE, LINE[:3], 1.0, (1.4, 1.6), 1.6, 0.9, 0.0, 5.0, 1e-7, 1e-4, False,
    joint_bulge=(0.03, 0.05),
)  # fmt: skip


def run(**change: object) -> Verification:
    return Verification(STATE, (replace(STATE, **change),), 1.0, None, 1, 1, 1, 1, 1.0, breaks=9.5)


def test_an_ordinary_run_has_none() -> None:
    assert cautions(run()) == ()
    assert cautions(run(joint_stretch=(1.4, 2.9), largest_stretch=0.99 * LAW_HOLDS)) == ()


def test_rubber_beyond_its_law() -> None:
    (said,) = cautions(run(joint_stretch=(1.4, 3.4), largest_stretch=3.4))
    assert said.startswith("the rubber is stretched 3.4 times at joint 2: its law holds to about 3")
    tears, law = cautions(run(joint_stretch=(5.0, 3.4), largest_stretch=5.0))
    assert "more than half of what it breaks at" in tears
    assert "at joints 1 and 2" in law
    torn, _ = cautions(run(joint_stretch=(10.0, 3.4), largest_stretch=1.01 * PAPER_BREAKS))
    assert "more than what it breaks at" in torn


def test_every_rubber_breaks_where_its_own_data_sheet_says() -> None:
    strong, soft = (RubberLaw(name, "neo-hooke", {}) for name in ("dragon-skin-10", "my own"))
    assert (breaking_stretch(None), breaking_stretch(strong)) == (9.5, 11.0)
    assert breaking_stretch(soft) is None
    stretched = run(joint_stretch=(5.0, 3.4), largest_stretch=5.0)
    for breaks, count in ((11.0, 1), (4.6, 2), (None, 1)):
        assert len(cautions(replace(stretched, breaks=breaks))) == count
    assert set(PRESETS) <= set(BREAKS)


def test_a_tube_that_balloons() -> None:
    (said,) = cautions(run(joint_bulge=(0.05, 0.13)))
    assert said == "the tube balloons at joint 2: it stands out by 13 % of its radius"


def test_a_tube_in_itself_and_a_limit_ahead() -> None:
    touching, ahead = cautions(
        replace(run(touches=True, overlap_mm=2.34), ahead=CriticalPoint("no equilibrium", 1.03))
    )
    assert "from 1.00 bar on" in touching
    assert "2.3 mm deep" in touching
    assert ahead == "no equilibrium beyond 1.03 bar, less than 5 % above 1.00 bar"


@pytest.mark.parametrize(
    ("between", "numbers"),
    [((), ()), ((5.0,), ()), ((4.9,), (1, 2)), ((8.0, 4.0, 4.0, 9.0), (2, 3, 4))],
)
def test_joints_too_near(between: tuple[float, ...], numbers: tuple[int, ...]) -> None:
    assert joints_too_near(between, 20.0) == numbers
    assert joints_too_near([0.6 * b for b in between], 12.0) == numbers


def test_a_thin_wall_at_high_pressure_is_cautioned_about() -> None:
    """Converged at a stretch of about 10, as the tube that was measured."""
    thin = chain(20.0, [20.0], [10.0], [np.radians(84.0)], wall=0.8)
    found = breaking(inflate(thin, [1.5], LYING, DOWN), None).verification
    assert found.converged
    assert 8.0 < found.last.largest_stretch < 13.0
    assert any("what it breaks at" in said for said in cautions(found))
    assert found.last.joint_bulge[0] > 0.08
