"""The pressure to set, on made-up actuators whose stiffness is known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fem
import profiletool
from profiletool.errors import Infeasible, UnreadableInput, UsageError
from profiletool.files.design_json import from_json, load_design, to_json
from profiletool.records.built import TrimPoint
from profiletool.records.design import Design
from profiletool.records.seal import sealed
from profiletool.records.setting import AngleReading
from profiletool.records.side import side_sign
from profiletool.verify.check import check
from profiletool.verify.run import inflate, run_design
from profiletool.verify.setting import by_angles, by_tip, trim_pressure
from profiletool.verify.trim import trim_of
from profiletool.verify.tube import actuator_of

PLANNED = 1.67
_POWER = np.array([1.5, 1.7, 1.6])
_PLANNED_DEG = np.array([30.0, 25.0, -20.0])


def theta(bar: float) -> np.ndarray:
    """Angles of the nominal actuator, deg."""
    return _PLANNED_DEG * (bar / PLANNED) ** _POWER


def tip(bar: float) -> tuple[float, float]:
    """Its tip, mm: on a curve that turns with the sum of the angles."""
    turn = np.radians(theta(bar).sum())
    return float(-80.0 * np.cos(turn) + 0.1 * turn), float(-80.0 * np.sin(turn))


@pytest.fixture(scope="module")
def design(samples: Path) -> Design:
    return made_up(samples)


def made_up(samples: Path) -> Design:
    """A verified design of three joints with a trim table, as a file gives it."""
    paper = load_design(samples / "paper_bulb.json")
    joints = tuple(
        replace(
            paper.joints[0], number=k + 1, centre_mm=15.0 + 20.0 * k, openF_mm=8.0,
            theta_fe_deg=abs(float(_PLANNED_DEG[k])), alpha_center_deg=(270.0, 270.0, 90.0)[k],
        )
        for k in range(3)
    )  # fmt: skip
    bars = [1.39, 1.43, 1.47, 1.51, 1.55, 1.59, 1.63, 1.67, 1.71, 1.75, 1.79, 1.84]
    trim = tuple(TrimPoint(bar, tip(bar), tuple(theta(bar).tolist())) for bar in bars)
    F = (20.0, 20.0, paper.tube.length_mm - joints[-1].centre_mm)
    joints = tuple(replace(joint, F_mm=to_next) for joint, to_next in zip(joints, F, strict=True))
    tube = replace(paper.tube, root_mm=joints[0].centre_mm)
    made = replace(paper, tube=tube, joints=joints, pressure_bar=PLANNED, verified=True, trim=trim)
    return from_json(to_json(sealed(made)), "made up")


def read(stiffness: float, at: float, sigma: float = 1.0) -> list[AngleReading]:
    return [
        AngleReading(at, k + 1, float(angle), sigma)
        for k, angle in enumerate(theta(at / stiffness))
    ]


def test_the_pressure_on_the_object_is_scaled_as_the_other_one(design: Design) -> None:
    held = sealed(replace(design, operate_bar=1.85))
    assert by_angles(held, read(1.04, PLANNED)).operate_bar == pytest.approx(1.04 * 1.85, abs=5e-3)
    assert by_angles(held, read(0.85, PLANNED)).operate_bar is None  # beyond the table
    assert by_angles(design, read(1.04, PLANNED)).operate_bar is None


@pytest.mark.parametrize("at", [PLANNED, 1.6, 1.8])
@pytest.mark.parametrize("stiffness", [1.08, 1.0, 0.94])
def test_from_the_tip_and_from_the_angles(design: Design, stiffness: float, at: float) -> None:
    for found in (
        by_tip(design, tip(at / stiffness), at),
        by_angles(design, read(stiffness, at)),
    ):
        if at / stiffness > 1.84:
            assert found.beyond
            continue
        assert found.stiffness == pytest.approx(stiffness, abs=1e-4)
        assert found.pressure_bar == round(stiffness * PLANNED, 2)
        assert (found.off_mm or 0.0) < 0.01
        assert (found.rms_deg or 0.0) < 0.01
        assert found.notes == ()


def test_a_tip_off_its_way(design: Design) -> None:
    x, y = tip(PLANNED / 1.05)
    out = np.array([x, y]) / np.hypot(x, y)  # across the way
    for off, said in ((1.0, False), (6.0, True)):
        found = by_tip(design, (x + off * out[0], y + off * out[1]), PLANNED)
        assert found.off_mm == pytest.approx(off, rel=0.02)
        assert found.pressure_bar == pytest.approx(1.05 * PLANNED, abs=0.01)
        assert any("a joint is off" in note for note in found.notes) is said


def test_beyond_the_table(design: Design) -> None:
    soft = by_tip(design, tip(1.9), PLANNED)
    assert soft.beyond
    assert soft.pressure_bar == round(PLANNED**2 / 1.84, 2)
    assert "at most 1.52 bar" in soft.notes[-1]
    again = by_tip(design, tip(1.9 / PLANNED * soft.pressure_bar), soft.pressure_bar)
    assert not again.beyond
    assert again.pressure_bar == pytest.approx(PLANNED**2 / 1.9, abs=0.006)
    stiff = by_tip(design, tip(1.3), 1.45)
    assert stiff.beyond
    assert "at least 1.74 bar" in stiff.notes[-1]
    far = by_angles(design, read(0.85, 1.8))
    assert far.beyond
    assert far.stiffness == pytest.approx(0.85, abs=0.01)  # angles go on by a power law


def test_no_more_than_was_checked(design: Design) -> None:
    at_most = 1.84 / PLANNED
    assert by_tip(design, tip(PLANNED / (at_most - 1e-4)), PLANNED).pressure_bar == 1.84
    for stiffness in (1.11, 1.3):
        with pytest.raises(Infeasible, match=r"checked it up to 1\.84 bar only") as caught:
            by_tip(design, tip(PLANNED / stiffness), PLANNED)
        assert ("at least" in str(caught.value)) is (stiffness == 1.3)
        with pytest.raises(Infeasible):
            by_angles(design, read(stiffness, PLANNED))


def test_a_joint_that_is_off_by_itself_is_named(design: Design) -> None:
    readings = [*read(1.04, 1.6), *read(1.04, PLANNED)]
    off = [replace(one, theta_deg=one.theta_deg + 6.0 * (one.joint == 2)) for one in readings]
    found = by_angles(design, off)
    assert found.joints_off == (2,)
    assert "joint 2 is +" in found.notes[0]
    assert found.rms_deg is not None
    assert found.rms_deg > 2.0
    # A reading that is not sure of itself hardly counts, and names nothing.
    unsure = [replace(one, sigma_deg=20.0 if one.joint == 2 else 0.5) for one in off]
    found = by_angles(design, unsure)
    assert found.joints_off == ()
    assert found.stiffness == pytest.approx(1.04, abs=2e-3)


def test_angles_that_scatter(design: Design) -> None:
    readings = read(1.04, PLANNED, 0.1) + read(1.04, 1.7, 0.1)
    noisy = [
        replace(one, theta_deg=one.theta_deg + (1.0 if k < 3 else -1.0))
        for k, one in enumerate(readings)
    ]
    assert any("scatter by 1.0 deg" in note for note in by_angles(design, noisy).notes)


def test_low_pressures_do_not_count_and_magnitudes_will_do(design: Design) -> None:
    readings = read(1.05, PLANNED) + [AngleReading(bar, 1, 40.0) for bar in (0.0, 0.4, 0.8)]
    bare = [replace(one, theta_deg=abs(one.theta_deg)) for one in readings]
    for given in (readings, bare):
        found = by_angles(design, given)
        assert found.stiffness == pytest.approx(1.05, abs=1e-3)
        assert "2 of 5 angles lie outside the trim table" in found.notes[-1]


def test_a_design_that_was_changed_has_no_trim_table(design: Design) -> None:
    joints = design.joints
    bent = (replace(joints[0], theta_fe_deg=31.0), *joints[1:])
    shuffled = (*design.trim[:2], *design.trim[3:1:-1], *design.trim[4:])
    for changed, said in (
        (replace(design, pressure_bar=1.71), "changed since"),
        (replace(design, joints=bent), "changed since"),
        (replace(design, joints=joints[:2]), "changed since"),
        (replace(design, trim=shuffled), "changed since"),
        (sealed(replace(design, trim=())), "holds no trim table"),
        (replace(design, verified=False), "not verified"),
    ):
        with pytest.raises(UnreadableInput, match=said):
            by_tip(changed, tip(PLANNED), PLANNED)


def test_bad_readings(design: Design) -> None:
    for bad in (-1.0, 0.0, 25.0, float("nan")):
        with pytest.raises(UsageError, match="bar"):
            by_tip(design, tip(PLANNED), bad)
    with pytest.raises(UsageError, match="finite"):
        by_tip(design, (float("nan"), 0.0), PLANNED)
    with pytest.raises(UnreadableInput, match="joint 4"):
        by_angles(design, [AngleReading(PLANNED, 4, 10.0)])
    for readings in ([], [AngleReading(0.0, 1, 0.0)], [AngleReading(1.6, 1, 20.0, 0.0)]):
        with pytest.raises(UsageError):
            by_angles(design, readings)


def test_one_function_for_tip_and_angles(design: Design) -> None:
    assert profiletool.trim_pressure is trim_pressure
    where = tip(PLANNED / 1.08)
    assert trim_pressure(design, tip_mm=where, at_bar=PLANNED).pressure_bar == 1.80
    readings = read(1.08, PLANNED)
    assert trim_pressure(design, angles=readings).pressure_bar == 1.80
    for wrong in ({}, {"tip_mm": where}, {"at_bar": 1.0}, {"tip_mm": where, "angles": readings}):
        with pytest.raises(UsageError, match="either"):
            trim_pressure(design, **wrong)


# --- against finite elements ------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("stiffer", [1.08, 0.93])
def test_rubber_of_another_stiffness_by_fe(samples: Path, stiffer: float) -> None:
    """The whole actuator with other rubber: trim finds where FE's own misfit is least."""
    paper = replace(load_design(samples / "paper_bulb.json"), pressure_bar=1.4)
    sign = side_sign(paper.source.side)
    run = run_design(paper, paper.pressure_bar)
    wanted = run.verification.last.shape.facing
    design = check(paper, wanted).design
    design = sealed(replace(design, trim=trim_of(design, run)))
    nominal = actuator_of(design)
    law = nominal.rubber
    other = fem.MooneyRivlin(stiffer * law.C10, stiffer * law.C01, stiffer * law.K)
    bars = np.round(design.pressure_bar * stiffer + np.arange(-0.04, 0.041, 0.02), 3)
    at = design.pressure_bar
    states = inflate(
        replace(nominal, rubber=other), sorted({at, *bars.tolist()}), design.base_pose, sign
    ).verification.states
    # Distances of points of the same material: the square of the misfit is a parabola.
    squares = [
        np.mean((state.shape.facing - wanted) ** 2)
        for state in states
        if np.abs(bars - state.pressure_bar).min() < 1e-6
    ]
    a, b, _ = np.polyfit(bars, squares, 2)
    least = -0.5 * b / a
    (there,) = (state for state in states if abs(state.pressure_bar - at) < 1e-6)
    x, y = there.shape.facing[-1].tolist()
    by = [
        by_tip(design, (x, y), at),
        by_angles(design, [AngleReading(at, k + 1, t) for k, t in enumerate(there.theta_deg)]),
    ]
    for found in by:
        assert found.stiffness * at == pytest.approx(least, abs=0.01)
        assert abs(found.pressure_bar - at) > 0.05
        assert found.notes == ()
