"""A prototype's numbers from its angles: on a surrogate that is known, and by finite elements."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import fem
from profiletool.errors import UnreadableInput, UsageError
from profiletool.files.design_json import load_design
from profiletool.files.tube_json import load_tube, tube_json
from profiletool.records.calibrated import CalibratedTube, request_with, with_tube
from profiletool.records.design import Design
from profiletool.records.request import Request
from profiletool.records.setting import AngleReading
from profiletool.verify.calibration import (
    NAMES,
    PRIOR,
    Data,
    _tube,
    calibrate,
    fitted,
    held_out,
)
from profiletool.verify.surrogate import DEAD, RUBBER, Surrogate, surrogate_at, tube_by
from tests.verify.conftest import COARSE

BARS = np.array([0.4, 0.7, 1.0, 1.3, 1.6])
JOINTS = 6
NOISE = 0.5


def known() -> Surrogate:
    """Angles that grow with the pressure as those of the bulb do, each joint's sector its own."""
    bars = np.linspace(0.0, 2.4, 13)
    size = np.array([9.0, 10.0, 8.0, 11.0, 6.0, -9.0])
    threads = np.array([-0.2, -0.9, -0.4, -0.7, -0.1, 0.8])
    course = bars + 0.45 * bars**2.4
    gain = CubicSpline(bars, course[:, None] * size)
    return Surrogate(
        np.zeros(4), 2.4, gain,
        CubicSpline(bars, 0.09 * course[:, None] * threads * 4.0),
        CubicSpline(bars, (-0.42 * np.gradient(course, bars) * bars)[:, None] * size),
        CubicSpline(bars, 0.02 * course[:, None] * size),
    )  # fmt: skip


def data(values: np.ndarray, seed: int, noise: float = NOISE) -> Data:
    bars, joints = (a.ravel() for a in np.meshgrid(BARS, np.arange(JOINTS), indexing="ij"))
    true = known().angles(values, bars, joints)
    off = np.random.default_rng(seed).normal(0.0, noise, len(bars))
    return Data(bars, joints, true + off, np.full(len(bars), noise))


def drawn(seed: int) -> np.ndarray:
    """A tube off by as much as the purpose says: stiffness 0.8 to 1.25, dead pressure to 0.1."""
    rng = np.random.default_rng(1000 + seed)
    return np.array(
        [rng.uniform(np.log(0.8), np.log(1.25)), rng.uniform(0.0, 0.1),
         rng.uniform(-5.7, 5.7), rng.uniform(-0.1, 0.1)]
    )  # fmt: skip


def the_design(samples: Path) -> Design:
    return load_design(samples / "paper_bulb.json")


@pytest.mark.slow
def test_sixty_twins_lie_within_two_sigma_and_predict_what_was_held_out(samples: Path) -> None:
    design = the_design(samples)
    inside, ratios = [], []
    for seed in range(60):
        true = drawn(seed)
        seen = data(true, seed)
        values = fitted(seen, known(), np.zeros(4))
        tube = _tube(design, seen, known(), values, "", None)
        off = np.array([one.value for one in tube.fitted]) - true
        sigma = np.array([one.sigma for one in tube.fitted])
        inside.append((np.abs(off) < 2.0 * sigma) | ~np.array([one.told for one in tube.fitted]))
        assert tube.held_out_deg is not None
        ratios.append(tube.held_out_deg / NOISE)
    assert np.mean(inside) >= 0.93
    assert np.median(ratios) <= 1.2


def test_a_fit_with_the_stiffness_held_wrong_is_visibly_worse() -> None:
    true = np.array([np.log(1.2), 0.05, 0.0, 0.0])
    seen = data(true, 3)
    free = fitted(seen, known(), np.zeros(4))
    held = fitted(seen, known(), np.zeros(4), {RUBBER: np.log(0.8), 3: 0.0})
    rms = [float(np.sqrt(np.mean(seen.off(known(), v) ** 2))) for v in (free, held)]
    assert rms[1] > 1.5 * rms[0]
    assert held[RUBBER] == np.log(0.8)


def test_what_the_data_cannot_tell_is_named(samples: Path) -> None:
    seen = data(np.zeros(4), 5)
    tube = _tube(the_design(samples), seen, known(), np.zeros(4), "", None)
    assert tube.singular_values[0] > 10.0
    assert min(tube.singular_values) < 1.0
    assert len(tube.untold) == 1
    assert "wall" in tube.untold[0]  # in this surrogate the wall moves least of all


def test_one_pressure_holds_none_out() -> None:
    seen = data(np.zeros(4), 5)
    assert held_out(seen.chosen(seen.bars == BARS[2]), known(), np.zeros(4)) is None


def test_magnitudes_get_their_sign_and_rest_does_not_count(samples: Path) -> None:
    design = the_design(samples)
    away = next(joint.number for joint in design.joints if joint.away)
    readings = [AngleReading(0.0, 1, 0.3), *(AngleReading(p, away, 20.0) for p in (0.8, 1.0, 1.2))]
    taken = Data.of(readings, design)
    assert taken.theta.tolist() == [-20.0] * 3
    assert taken.bars.tolist() == [0.8, 1.0, 1.2]


@pytest.mark.parametrize(
    ("readings", "said"),
    [
        ([AngleReading(1.0, 9, 10.0)] * 4, "joint 9, but the design has 6"),
        ([AngleReading(1.0, 1, 10.0)] * 2, "2 angles under pressure"),
        ([AngleReading(0.0, 1, 0.0)] * 5, "0 angles under pressure"),
    ],
)
def test_too_little_to_calibrate(readings: list[AngleReading], said: str, samples: Path) -> None:
    with pytest.raises(UnreadableInput, match=said):
        Data.of(readings, the_design(samples))


@pytest.mark.slow
def test_finite_elements_find_a_twin(samples: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("profiletool.verify.surrogate.solve", partial(fem.solve, size=COARSE))
    design = the_design(samples)
    true = np.array([np.log(0.88), 0.05, 0.0, 0.0])
    twin = surrogate_at(design, np.array([true[RUBBER], 0.0, 0.0, 0.0]), 1.25)
    bars, joints = (a.ravel() for a in np.meshgrid(BARS[:4], np.arange(6), indexing="ij"))
    theta = twin.angles(np.array([true[RUBBER], true[DEAD], 0.0, 0.0]), bars, joints)
    off = np.random.default_rng(2).normal(0.0, 0.3, len(bars))
    readings = [
        AngleReading(float(p), int(k) + 1, float(t), 0.3)
        for p, k, t in zip(bars, joints, theta + off, strict=True)
    ]
    tube = calibrate(design, readings, date="2026-03-01", cycles=5)
    for one, value in zip(tube.fitted, true, strict=True):
        assert abs(one.value - value) < 2.5 * one.sigma
    assert tube.rmse_deg < 1.2 * tube.expected_deg
    assert tube.held_out_deg is not None
    assert tube.held_out_deg < 1.3 * 0.3


def tube_of(samples: Path) -> CalibratedTube:
    seen = data(np.array([0.1, 0.02, 1.0, 0.05]), 1)
    values = fitted(seen, known(), np.zeros(4))
    return _tube(the_design(samples), seen, known(), values, "2026-03-01", 5)


def test_a_tube_file_comes_back(samples: Path, tmp_path: Path) -> None:
    tube = tube_of(samples)
    (tmp_path / "tube.json").write_bytes(tube_json(tube))
    again = load_tube(tmp_path / "tube.json")
    assert tube_json(again) == tube_json(tube)
    assert again.cycles == 5
    assert [one.name for one in again.fitted] == list(NAMES)
    assert [one.prior_sigma for one in again.fitted] == pytest.approx(PRIOR.tolist())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "is not JSON"),
        ("[]", "is no tube file"),
        ('{"schema": "profiletool.design/3"}', "is no tube file"),
        ('{"schema": "profiletool.tube/1"}', "Field required|required"),
    ],
)
def test_no_tube_file(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "tube.json").write_text(text)
    with pytest.raises(UnreadableInput, match=said):
        load_tube(tmp_path / "tube.json")


def test_a_design_takes_the_tube(samples: Path) -> None:
    design, tube = the_design(samples), tube_of(samples)
    built = with_tube(design, tube)
    assert built.tube.rubber == tube.rubber
    assert built.tube.wall_mm == tube.wall_mm
    assert built.model.sector_extra_deg == tube.sector_extra_deg
    assert with_tube(design, None) is design
    wide = the_design(samples)
    object.__setattr__(wide.tube, "outer_diameter_mm", 16.0)
    with pytest.raises(UsageError, match="16 mm"):
        with_tube(wide, tube)


def test_a_request_takes_the_tube_and_is_surer_of_it(samples: Path) -> None:
    tube = tube_of(samples)
    asked = request_with(Request(Path("a.png")), tube)
    assert asked.tube.rubber == tube.rubber
    assert asked.model.sector_extra_deg == tube.sector_extra_deg
    assert asked.build.rubber < 2.0
    assert asked.build.wall == 0.0


def test_a_twins_rubber_scales_with_its_stiffness(samples: Path) -> None:
    design = the_design(samples)
    twin = tube_by(design, np.array([np.log(1.1), 0.0, 2.0, 0.1]))
    assert twin.tube.rubber is not None
    assert twin.tube.rubber.constants["C10"] == pytest.approx(1.1 * 0.0694, rel=1e-6)
    assert twin.tube.wall_mm == pytest.approx(design.tube.wall_mm + 0.1)
    assert twin.model.sector_extra_deg == pytest.approx(design.model.sector_extra_deg + 2.0)
