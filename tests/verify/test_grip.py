"""The finger on its object: the object's place, readings, and the pressure to work at."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from profiletool.errors import UsageError
from profiletool.files.design_json import load_design
from profiletool.records.built import BuildErrors, Built, BuiltMisfit
from profiletool.records.design import Design, Joint
from profiletool.records.frames import Pose, base_axes, outward
from profiletool.records.grip import Grip
from profiletool.records.grip_request import GripRequest, Solid
from profiletool.records.side import side_sign
from profiletool.records.units import FloatArray
from profiletool.report.film import film_of
from profiletool.report.grip import grip_csv, grip_json, grip_text
from profiletool.verify.fields import fields_of
from profiletool.verify.grip import run_grip
from profiletool.verify.operate import in_contact
from profiletool.verify.run import Run, run_design
from profiletool.verify.solid import given_obstacle, object_of


@pytest.fixture(scope="module")
def design(samples: Path) -> Design:
    paper = load_design(samples / "paper_bulb.json")
    joints = (
        Joint(1, 15.0, 8.0, 90.0, 270.0, 20.0, 20.0, None, 14.0),
        Joint(2, 26.0, 8.0, 90.0, 270.0, 10.0, 10.0, None, 29.0),
    )
    tube = replace(paper.tube, length_mm=55.0, root_mm=14.0)
    pose = Pose(0.0, 0.0, 180.0)
    return replace(paper, joints=joints, tube=tube, base_pose=pose, pressure_bar=0.8, warnings=())


@pytest.fixture(scope="module")
def run(design: Design) -> Run:
    return run_design(design, design.pressure_bar)


@pytest.fixture(scope="module")
def target(run: Run) -> FloatArray:
    """What the free tube lies on at its pressure."""
    return run.verification.last.shape.facing


@pytest.fixture(scope="module")
def found(design: Design, target: FloatArray) -> Grip:
    return run_grip(design, target, GripRequest(pressures_bar=(0.8, 0.9), friction=(0.0, 0.5)))


def test_the_object_lies_where_the_profile_does(design: Design, target: FloatArray) -> None:
    along, out = base_axes(np.pi, side_sign(design.source.side))
    points = target[10:-10:5]
    tangent = np.gradient(points, axis=0)
    tangent /= np.hypot(*tangent.T)[:, None]
    off = outward(np.arctan2(tangent[:, 1], tangent[:, 0]), side_sign(design.source.side))
    solids: tuple[Solid, ...] = ("turned", "extruded")
    for distance in (0.0, 0.5):
        moved = points + distance * off
        x = np.column_stack([np.zeros(len(points)), moved @ out - 10.0, moved @ along])
        for solid in solids:
            obstacle, made = object_of(design, target, solid)
            assert made == solid
            np.testing.assert_allclose(obstacle.gap(x).distance, distance, atol=0.03)
            back, _ = object_of(design, target, solid, clearance_mm=0.2)
            np.testing.assert_allclose(back.gap(x).distance, distance + 0.2, atol=0.03)


def test_a_profile_across_the_axis_is_extruded(design: Design, target: FloatArray) -> None:
    moved = target + np.array([40.0, 0.0])
    assert object_of(design, moved)[1] == "extruded"
    with pytest.raises(UsageError, match="beyond the object's axis"):
        object_of(design, moved, "turned")


@pytest.mark.parametrize("text", ["plane:0,0", "wall:1,2,3", "sphere:1,2,0", "plane:a,b,c", ""])
def test_what_cannot_be_met_is_refused(design: Design, text: str) -> None:
    with pytest.raises(UsageError, match="`against`"):
        given_obstacle(design, text)


def test_what_is_met_in_place_of_the_object_lies_there(design: Design) -> None:
    # Object frame (-20, -5): 20 mm along the tube, 5 + 10 mm below its axis.
    plane, _ = given_obstacle(design, "plane:-20,-5,90")
    ball, _ = given_obstacle(design, "sphere:-20,-5,4")
    x = np.array([[0.0, -11.0, 20.0]])
    np.testing.assert_allclose(plane.gap(x).distance, 4.0)
    np.testing.assert_allclose(ball.gap(x).distance, 0.0, atol=1e-12)
    np.testing.assert_allclose(plane.gap(x).normal, [[0.0, 1.0, 0.0]], atol=1e-12)


def test_more_pressure_presses_harder_and_moves_little(found: Grip, design: Design) -> None:
    assert found.converged
    first, last = found.states
    assert 0.0 <= first.normal_N < last.normal_N
    assert sum(last.joint_normal_N) == pytest.approx(last.normal_N)
    assert last.misfit_rms_mm < 1.0  # free it would go on by some mm
    assert last.energy_error < 1e-3
    assert last.depth_mm <= 0.011
    assert 0.0 < last.contact_share < 1.0
    assert last.peak_kPa >= last.mean_kPa > 0.0
    force = last.pad.force.sum(axis=0)
    sign = side_sign(design.source.side)
    np.testing.assert_allclose(force, [sign * last.radial_N, last.axial_N, 0.0], atol=1e-9)
    assert np.linalg.norm(last.pad.force, axis=1).sum() == pytest.approx(last.normal_N)


def test_the_film_goes_on_against_the_object(found: Grip, run: Run, design: Design) -> None:
    film = film_of(run.verification, design, found)
    assert film.shown == len(film.lines) - 2
    np.testing.assert_allclose(film.pressure_bar[film.shown :], [0.8, 0.9])
    assert film.outline() == film_of(run.verification, design).outline()
    np.testing.assert_allclose(found.states[0].theta_deg, film.theta_deg[film.shown], atol=1.0)
    assert 0.0 < film.air_ml[film.shown] < film.air_ml[-1]


def test_a_grip_is_told(found: Grip) -> None:
    assert '"converged": true' in grip_json(found)
    assert "friction  payload N" in grip_text(found, GripRequest(max_contact_kpa=0.001))
    assert "above the 0.001 kPa" in grip_text(found, GripRequest(max_contact_kpa=0.001))
    assert len(grip_csv(found).splitlines()) == 3


@pytest.mark.slow
def test_the_finger_works_above_its_free_pressure(
    design: Design, run: Run, target: FloatArray
) -> None:
    fields = fields_of(design, run, target[::4])
    assert fields is not None
    nothing = BuiltMisfit(1.0, 0.5)
    built = Built(BuildErrors(), nothing, nothing, ())
    told = replace(design, built=built)
    held = in_contact(told, run.solution, target, fields, GripRequest(), 2.0)
    bar, expected = held.design.operate_bar, held.design.built
    assert bar is not None
    assert expected is not None
    assert 1.0 * design.pressure_bar < bar <= 1.28 * design.pressure_bar
    rms, most = expected.expected_rms_mm.in_contact, expected.p95_rms_mm.in_contact
    assert rms is not None
    assert most is not None
    assert 0.0 < rms < most < 2.0
    capped = in_contact(told, run.solution, target, fields, GripRequest(), 0.82).design
    assert capped.operate_bar is not None
    assert capped.operate_bar <= 0.82
    # An object that cannot be is told, not passed over.
    beyond = target + np.array([40.0, 0.0])
    turned = GripRequest(solid="turned")
    refused = in_contact(told, run.solution, beyond, fields, turned, 2.0)
    assert refused.design.operate_bar is None
    assert refused.grip is not None
    assert "beyond the object's axis" in str(refused.grip.failure)
    # A force that is asked for sets the pressure; where it is out of reach, the highest one is.
    assert held.grip is not None
    asked = held.grip.normal_at(0.97)
    forced = in_contact(told, run.solution, target, fields, GripRequest(), 1.2, asked).design
    assert forced.operate_bar == pytest.approx(0.97, rel=0.01)
    most = in_contact(told, run.solution, target, fields, GripRequest(), 1.1, 1e3).design
    assert most.operate_bar == pytest.approx(1.1)


@pytest.mark.parametrize(
    "values",
    [
        {"pressures_bar": (0.0,)}, {"friction": (-0.1,)}, {"fingers": 0}, {"clearance_mm": -1.0},
        {"max_contact_kpa": 0.0},
    ],
)  # fmt: skip
def test_requests_that_make_no_sense(values: dict[str, object]) -> None:
    with pytest.raises(UsageError, match=f"`{next(iter(values))}`"):
        GripRequest(**values)  # type: ignore[arg-type]
