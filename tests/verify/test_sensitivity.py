"""First-order errors of the bent shape, on a small actuator of two opposite joints."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fem.errors import FemError
from fem.rates import Sensitivities
from profiletool.files.design_json import load_design
from profiletool.joints.closest import closest_points, target_points
from profiletool.profile.curve import arc_length
from profiletool.records.design import Design, Joint, Sensitivity
from profiletool.records.frames import Pose, Shape
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray
from profiletool.verify import fields as fields_module
from profiletool.verify.fields import fields_of
from profiletool.verify.run import Run, inflate, run_design
from profiletool.verify.sensitivity import sensitivity_of
from profiletool.verify.tube import actuator_of

BAR = 1.0


def two_joints(samples: Path) -> Design:
    paper = load_design(samples / "paper_bulb.json")
    joints = (
        Joint(1, 15.0, 8.0, 110.0, 270.0, 20.0, 20.0, None, 14.0),
        Joint(2, 11.0, 6.0, 140.0, 90.0, 10.0, 10.0, None, 29.0),
    )
    return replace(
        paper,
        joints=joints,
        tube=replace(paper.tube, length_mm=40.0, root_mm=14.0),
        base_pose=Pose(2.0, 1.0, 200.0),
        pressure_bar=BAR,
        warnings=(),
    )


@pytest.fixture(scope="module")
def design(samples: Path) -> Design:
    return two_joints(samples)


@pytest.fixture(scope="module")
def run(design: Design) -> Run:
    return run_design(design, BAR)


def along(line: FloatArray) -> Profile:
    """A target that runs along a line."""
    at = arc_length(line)
    s = np.linspace(0.0, at[-1], round(at[-1] / 0.1) + 1)
    points = np.column_stack([np.interp(s, at, line[:, k]) for k in (0, 1)])
    heading = np.unwrap(np.arctan2(*np.gradient(points, axis=0).T[::-1]))
    nothing = np.zeros(len(s))
    return Profile(points, s, heading, nothing, nothing.astype(bool), "left", None)


@pytest.fixture(scope="module")
def profile(run: Run) -> Profile:
    return along(run.verification.last.shape.facing)


@pytest.fixture(scope="module")
def found(design: Design, run: Run, profile: Profile) -> tuple[Sensitivity, ...]:
    return told_of(design, run, profile)


def told_of(design: Design, run: Run, profile: Profile) -> tuple[Sensitivity, ...]:
    points = target_points(profile)
    fields = fields_of(design, run, points)
    assert fields is not None
    return sensitivity_of(design, fields, points)


def off(changed: Shape, profile: Profile) -> FloatArray:
    """How far a line lies off a profile that it lay on."""
    return closest_points(changed.facing, target_points(profile)[:-4], 1.0).distance


def test_entries_in_their_order(found: tuple[Sensitivity, ...]) -> None:
    assert [entry.what for entry in found] == [
        "pressure 0.05 bar off",
        "one thread more or less uncut",
        "cut 2 mm longer or shorter",
        "joint 1 mm off its place",
        "wall 5 % off",
        "scale 1 % off",
    ]
    assert [entry.joint is None for entry in found] == [True, False, False, False, True, True]
    assert all(entry.max_mm > entry.rms_mm > 0.0 for entry in found)


def test_more_pressure_to_first_order(
    design: Design, profile: Profile, found: tuple[Sensitivity, ...]
) -> None:
    more = off(run_design(design, BAR + 0.05).verification.last.shape, profile)
    assert found[0].rms_mm == pytest.approx(np.sqrt(np.mean(more**2)), rel=0.1, abs=0.01)
    assert found[0].max_mm == pytest.approx(np.abs(more).max(), rel=0.1, abs=0.01)
    assert found[0].rms_mm > 0.05


@pytest.mark.slow
@pytest.mark.parametrize("entry", [1, 2, 3])
def test_of_what_every_joint_has_the_one_that_matters_most(
    entry: int, design: Design, profile: Profile, found: tuple[Sensitivity, ...]
) -> None:
    """Each joint changed by the whole error, and FE from rest again."""
    worst = []
    for k in (0, 1):
        joints = list(design.joints)
        length = 0.0
        if entry == 1:
            alpha = joints[k].alpha_closed_deg + np.degrees(0.2)
            joints[k] = replace(joints[k], alpha_closed_deg=alpha)
        elif entry == 2:  # the wrapped lengths stay, and all behind moves on
            length = 2.0
            joints[k] = replace(
                joints[k], openF_mm=joints[k].openF_mm + 2.0, centre_mm=joints[k].centre_mm + 1.0
            )
        else:
            length = 1.0
            joints[k] = replace(joints[k], centre_mm=joints[k].centre_mm + 1.0)
        for j in range(k + 1, 2):
            joints[j] = replace(joints[j], centre_mm=joints[j].centre_mm + length)
        tube = replace(design.tube, length_mm=design.tube.length_mm + length)
        changed = replace(design, joints=tuple(joints), tube=tube)
        shape = inflate(actuator_of(changed), [BAR], design.base_pose, 1.0).verification.last.shape
        worst.append(float(np.sqrt(np.mean(off(shape, profile) ** 2))))
    assert found[entry].joint == int(np.argmax(worst)) + 1
    assert found[entry].rms_mm == pytest.approx(max(worst), rel=0.3)  # whole errors are not small


def test_scale_on_a_straight_profile(design: Design, run: Run) -> None:
    """A line and a profile that leave each other at 0.1 rad: 1 % of what lies across."""
    x = np.linspace(0.0, 40.0, 161)
    line = np.column_stack([x, np.zeros(161)])
    ramp = along(np.column_stack([0.99 * x * np.cos(0.1), 5.0 + 0.99 * x * np.sin(0.1)]))
    seen = run.verification
    last = replace(seen.last, shape=replace(seen.last.shape, along=x, facing=line))
    straight = replace(run, verification=replace(seen, states=(*seen.states[:-1], last)))
    entry = told_of(design, straight, ramp)[-1]
    most = 0.01 * ramp.length_mm * np.sin(0.1)
    assert entry.max_mm == pytest.approx(most, abs=0.0051)
    assert entry.rms_mm == pytest.approx(most / np.sqrt(3.0), abs=0.0051)


def test_the_scales_own_error_where_it_was_measured(
    design: Design, run: Run, profile: Profile
) -> None:
    """Large errors, for the results are rounded to hundredths of a mm."""

    def last(share: float) -> Sensitivity:
        measured = replace(design, source=replace(design.source, scale_error_share=share))
        return told_of(measured, run, profile)[-1]

    assert last(0.035).what == "scale 3.5 % off"
    assert last(0.8).rms_mm == pytest.approx(2.0 * last(0.4).rms_mm, abs=0.016)
    assert last(0.4).rms_mm > 0.5


def test_thicker_wall_less_bent(
    design: Design, profile: Profile, found: tuple[Sensitivity, ...]
) -> None:
    thick = replace(design, tube=replace(design.tube, wall_mm=2.1))
    changed = off(run_design(thick, BAR).verification.last.shape, profile)
    assert found[4].rms_mm == pytest.approx(np.sqrt(np.mean(changed**2)), rel=0.15, abs=0.01)


def test_nothing_where_the_tangent_allows_no_derivatives(
    design: Design, run: Run, profile: Profile, monkeypatch: pytest.MonkeyPatch
) -> None:
    def singular(*_: object, **__: object) -> Sensitivities:
        raise FemError("singular")

    monkeypatch.setattr(fields_module, "sensitivities", singular)
    assert fields_of(design, run, target_points(profile)) is None
