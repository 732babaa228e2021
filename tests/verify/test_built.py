"""The built misfit: sums, the trim, samples, and finite elements of single builds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from profiletool.files.design_json import load_design
from profiletool.records.built import BuildErrors
from profiletool.records.design import Design, Joint
from profiletool.records.frames import Pose
from profiletool.records.units import FloatArray
from profiletool.verify.built import ErrorGroup, band_of, built_of, groups_of, sampled, trimmed
from profiletool.verify.fields import ErrorFields, fields_of
from profiletool.verify.run import run_design
from profiletool.verify.sample import BuildDraw, drawn, draws_of, run_draw

NOTHING = BuildErrors(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
NO_DRAW = BuildDraw(0.0, (0.0, 0.0), 0.0, 0.0, (0.0, 0.0), (0.0, 0.0))
M = 40


@pytest.fixture(scope="module")
def design(samples: Path) -> Design:
    paper = load_design(samples / "paper_bulb.json")
    joints = (
        Joint(1, 15.0, 8.0, 110.0, 270.0, 20.0, 20.0, None, 14.0),
        Joint(2, 11.0, 6.0, 140.0, 90.0, 10.0, 10.0, None, 29.0),
    )
    tube = replace(paper.tube, length_mm=40.0, root_mm=14.0)
    pose = Pose(2.0, 1.0, 200.0)
    return replace(paper, joints=joints, tube=tube, base_pose=pose, pressure_bar=1.0, warnings=())


def made_up(seed: int = 1) -> ErrorFields:
    """Fields of two joints, at random."""
    rng = np.random.default_rng(seed)
    sizes = {"gap": (M,), "closest": (M, 2), "normal": (M, 2), "pressure": (M,), "alpha": (2, M)}
    sizes |= {"openF": (2, M), "wrapped": (3, M), "wall": (M,), "rubber": (M,)}
    fields = {name: rng.normal(size=shape) for name, shape in sizes.items()}
    fields["normal"] /= np.hypot(*fields["normal"].T)[:, None]
    return ErrorFields(**fields)


def test_the_expected_square_is_that_of_the_samples(design: Design) -> None:
    fields = made_up()
    built = built_of(design, fields, BuildErrors())
    groups = groups_of(design, fields, BuildErrors())
    rms = sampled(fields.gap, groups)
    assert np.sqrt(np.mean(rms**2)) == pytest.approx(built.expected_rms_mm.as_set, rel=0.01)
    assert np.mean(rms <= built.p95_rms_mm.as_set) == pytest.approx(0.95, abs=0.001)
    squares = sum(part.as_set**2 for part in built.parts)
    total = np.mean(fields.gap**2) + squares
    assert built.expected_rms_mm.as_set == pytest.approx(np.sqrt(total), abs=0.002)


def test_what_acts_as_the_pressure_is_set_away_and_its_own_error_stays(design: Design) -> None:
    fields = made_up()
    fields = replace(fields, rubber=-0.3 * fields.pressure, wall=2.0 * fields.pressure)
    parts = {part.what: part for part in built_of(design, fields, BuildErrors()).parts}
    assert parts["rubber"].as_set > 0.01
    assert parts["rubber"].trimmed == parts["wall"].trimmed == 0.0
    assert parts["pressure"].trimmed == parts["pressure"].as_set
    assert all(part.trimmed <= part.as_set for part in parts.values())


def test_trimming_leaves_nothing_along_the_pressure() -> None:
    rng = np.random.default_rng(3)
    pressure = rng.normal(size=M)
    (after,) = trimmed((ErrorGroup("cut", rng.normal(size=(2, M))),), pressure)
    assert after.moved @ pressure == pytest.approx(np.zeros(2), abs=1e-9)


def test_an_error_that_is_left_out_has_no_part(design: Design) -> None:
    fields = made_up()
    built = built_of(design, fields, replace(NOTHING, cut=1.0))
    assert [part.what for part in built.parts] == ["cut"]
    perfect = built_of(design, fields, NOTHING)
    gap = float(np.sqrt(np.mean(fields.gap**2)))
    assert perfect.expected_rms_mm.as_set == pytest.approx(gap, abs=5e-4)
    assert perfect.p95_rms_mm.trimmed == pytest.approx(gap, abs=5e-4)


def test_the_band_holds_95_of_100_builds(design: Design) -> None:
    fields = made_up()
    inner, outer = band_of(design, fields, BuildErrors())
    half = np.einsum("mk,mk->m", outer - fields.closest, fields.normal)
    assert inner + outer == pytest.approx(2.0 * fields.closest)
    groups = trimmed(groups_of(design, fields, BuildErrors()), fields.pressure)
    moved = np.vstack([group.moved for group in groups])
    draws = np.random.default_rng(9).uniform(-np.sqrt(3.0), np.sqrt(3.0), (4000, len(moved)))
    within = np.mean(np.abs(draws @ moved) <= half, axis=0)
    assert within.min() > 0.93
    assert within.max() < 0.97


def test_draws_are_uniform_within_their_bounds_and_the_same_again(design: Design) -> None:
    build = BuildErrors(thread=0.5, place=0.0)
    found = draws_of(build, 2, 400)
    assert found == draws_of(build, 2, 400)
    threads = np.array([draw.threads for draw in found])
    assert np.abs(threads).max() <= 0.5
    assert threads.std() == pytest.approx(0.5 / np.sqrt(3.0), rel=0.05)
    assert {draw.place_mm for draw in found} == {(0.0, 0.0)}
    rubber = np.array([draw.rubber for draw in found])
    assert 0.09 < np.abs(rubber).max() <= 0.1
    changed = drawn(design, replace(NO_DRAW, threads=(1.0, 0.0), wall=0.03, place_mm=(0.0, 0.5)))
    assert changed.joints[0].alpha_closed_deg == pytest.approx(110.0 + np.degrees(0.2))
    assert changed.tube.wall_mm == pytest.approx(2.06)
    assert changed.joints[1].centre_mm == 29.5


@pytest.fixture(scope="module")
def points(design: Design) -> FloatArray:
    """A target off the design's own line."""
    run = run_design(design, design.pressure_bar)
    line = run.verification.last.shape.facing[4:-6:2]
    return np.asarray(line + np.array([0.1, 0.0]))


@pytest.mark.slow
def test_single_builds_by_finite_elements_are_as_the_fields_say(
    design: Design, points: FloatArray
) -> None:
    run = run_design(design, design.pressure_bar)
    fields = fields_of(design, run, points)
    assert fields is not None
    perfect = run_draw(design, NO_DRAW, points)
    assert perfect.as_set_mm == pytest.approx(np.sqrt(np.mean(fields.gap**2)), abs=0.005)
    assert perfect.trimmed_mm <= perfect.as_set_mm + 1e-6
    draw = replace(NO_DRAW, rubber=0.03, threads=(0.2, -0.2), cut_mm=(0.3, 0.0))
    groups = {g.what: g.moved for g in groups_of(design, fields, BuildErrors())}
    build = BuildErrors()
    moved = (
        fields.gap
        + 3.0 / build.sigma("rubber") * groups["rubber"][0]
        + np.array([0.2, -0.2]) / build.sigma("thread") @ groups["thread"]
        + 0.3 / build.sigma("cut") * groups["cut"][0]
    )
    found = run_draw(design, draw, points)
    assert found.failure is None
    assert found.as_set_mm == pytest.approx(np.sqrt(np.mean(moved**2)), rel=0.1, abs=0.01)
    assert found.trimmed_mm < found.as_set_mm


def test_a_build_whose_best_pressure_was_not_looked_at_is_not_counted(
    design: Design, points: FloatArray
) -> None:
    found = run_draw(design, replace(NO_DRAW, wall=0.4), points)
    assert found.failure is not None
    assert np.isnan(found.trimmed_mm)
