"""Designs through finite elements; short tubes and low pressures, the physics is tested in fem."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fem
from fem.errors import NotConverged
from fem.material import PAPER_RUBBER
from formula.rubber import RubberLaw
from profiletool.api import verify_design
from profiletool.bending.kinematics import deform
from profiletool.errors import UnreadableInput
from profiletool.files.design_json import load_design, to_json
from profiletool.profile.curve import arc_length
from profiletool.records.design import Design, Joint
from profiletool.records.frames import Pose
from profiletool.records.profile import Profile
from profiletool.records.side import side_sign
from profiletool.report.dossier import formula_marks
from profiletool.report.fe import compared_text
from profiletool.verify.check import check
from profiletool.verify.lines import Placement
from profiletool.verify.run import DOWN, LYING, STEPS, Run, inflate, pressures_to, run_design, solve
from profiletool.verify.tube import actuator_of

POSES = [(Pose(0.0, 0.0, 180.0), "left"), (Pose(-3.0, 7.0, -35.0), "right")]


def short(samples: Path, center_deg: float = 270.0, pose: Pose | None = None, side: str = "left",
          bar: float = 0.6) -> Design:  # fmt: skip
    """One joint on 32 mm of tube."""
    paper = load_design(samples / "paper_bulb.json")
    joint = Joint(1, 18.0, 8.0, 120.0, center_deg, 6.0, 6.0, None, 14.0)
    return replace(
        paper,
        joints=(joint,),
        tube=replace(paper.tube, length_mm=32.0, root_mm=14.0),
        base_pose=pose or POSES[0][0],
        source=replace(paper.source, side=side),
        pressure_bar=bar,
        warnings=(),
    )


def along(points: np.ndarray, side: str = "left") -> Profile:
    """A target that runs along given points."""
    s = np.arange(0.0, arc_length(points)[-1], 0.1)
    dense = np.column_stack([np.interp(s, arc_length(points), points[:, k]) for k in (0, 1)])
    heading = np.unwrap(np.arctan2(*np.gradient(dense, axis=0).T[::-1]))
    nothing = np.zeros(len(s))
    return Profile(dense, s, heading, nothing, nothing.astype(bool), side, None)


def heading_deg(line: np.ndarray) -> float:
    dx, dy = line[-1] - line[-2]
    return float(np.degrees(np.arctan2(dy, dx)))


def changed(monkeypatch: pytest.MonkeyPatch, change: Callable[[fem.Solution], object]) -> None:
    real = solve
    monkeypatch.setattr("profiletool.verify.run.solve", lambda *a, **k: change(real(*a, **k)))


@pytest.fixture(scope="module")
def run(samples: Path) -> Run:
    return run_design(short(samples), 0.6)


def test_pressures() -> None:
    assert pressures_to(2.0) == pytest.approx([0.2 * k for k in range(1, 11)])
    assert pressures_to(2.0)[-1] == 2.0
    assert pressures_to(0.35, 0.1) == (0.1, 0.2, 0.3, 0.35)
    assert pressures_to(0.3, 0.1) == (0.1, 0.2, 0.3)


@pytest.mark.parametrize(("pose", "side"), POSES)
def test_at_rest_it_lies_where_the_design_says(pose: Pose, side: str, samples: Path) -> None:
    design = short(samples, pose=pose, side=side, bar=0.05)
    rest = inflate(actuator_of(design), [0.05], pose, side_sign(side)).verification.rest.shape
    straight = deform((), 32.0, 10.0, pose, side_sign(side))
    for line in ("facing", "axis", "far"):
        a, b = getattr(rest, line), getattr(straight, line)
        np.testing.assert_allclose(a[[0, -1]], b[[0, -1]], atol=1e-9)
        assert np.all(np.diff(rest.along) > 0.0)
        np.testing.assert_allclose(a, b[0] + np.outer(rest.along / 32.0, b[-1] - b[0]), atol=1e-9)


@pytest.mark.parametrize(("pose", "side"), POSES)
@pytest.mark.parametrize("center", [270.0, 90.0])
def test_it_bends_toward_the_object_or_away(
    pose: Pose, side: str, center: float, samples: Path
) -> None:
    design = short(samples, center, pose, side, bar=0.3)
    last = run_design(design, 0.3).verification.last
    (theta,) = last.theta_deg
    assert theta * (1.0 if center == 270.0 else -1.0) > 1.5
    turned = side_sign(side) * (heading_deg(last.shape.facing) - pose.heading_deg)
    turned = (turned + 180.0) % 360.0 - 180.0
    # Positive theta turns the tube's end toward the object, whose side the sign tells.
    assert turned == pytest.approx(theta, abs=0.1 * abs(theta))
    assert design.joints[0].signed(theta) > 0.0


@pytest.mark.parametrize("center", [200.0, 160.0])
def test_a_joint_out_of_the_plane_is_verified_all_the_same(center: float, samples: Path) -> None:
    # 20 deg off sideways, a little to the object's half of the tube and to the far one.
    design = short(samples, center)
    verification = run_design(design, 0.6).verification
    assert verification.converged
    (theta,) = verification.last.theta_deg  # about the joint's own axis
    assert design.joints[0].signed(theta) > 3.0
    # Of a bend sideways little is seen in the plane.
    start, end = verification.last.shape.facing[[0, -1]]
    rise = abs(heading_deg(np.array([start, end])) - heading_deg(verification.rest.shape.facing))
    assert min(rise, 360.0 - rise) < 0.4 * abs(theta)
    # What is wanted of the joint has the sign of what finite elements find.
    row = compared_text(design, verification, None, None).splitlines()[1].split()
    assert np.sign([float(number) for number in row[1:]]).tolist() == [np.sign(theta)] * 3
    (mark,) = formula_marks(design)
    assert list(mark.theta_deg) == [np.sign(theta) * 6.0]
    with pytest.raises(UnreadableInput, match="joint 1 bends out of the plane"):
        verify_design(design, along(verification.last.shape.facing))


def test_both_sides_are_mirror_images(samples: Path, run: Run) -> None:
    mirrored = short(samples, pose=Pose(0.0, 0.0, 0.0), side="right")
    other = run_design(mirrored, 0.6).verification.last
    last = run.verification.last
    assert other.theta_deg == last.theta_deg
    for line in ("facing", "axis", "far"):
        np.testing.assert_allclose(
            getattr(other.shape, line) * [-1, 1], getattr(last.shape, line), atol=1e-9
        )
    np.testing.assert_allclose(other.phalanges * [-1, 1], last.phalanges, atol=1e-9)


def test_lines_pass_through_the_nodes_and_bend_within_the_bricks(run: Run) -> None:
    state, mesh, shape = run.solution.states[-1], run.solution.mesh, run.verification.last.shape
    place = Placement(POSES[0][0], 1.0, 10.0)
    for line, nodes in ((shape.facing, state.shape.facing), (shape.far, state.shape.far)):
        at = [np.interp(mesh.z, shape.along, line[:, k]) for k in (0, 1)]
        np.testing.assert_allclose(np.stack(at, axis=1), place(nodes), atol=0.06)
    # The plug, rigid, goes on from the last ring as that one is turned.
    end = state.shape.rotation[-1] @ [0.0, 0.0, 1.0]
    tip = place(state.shape.facing[-1:] + end * mesh.actuator.plug)
    np.testing.assert_allclose(shape.facing[-1:], tip, atol=1e-9)


def test_checks_and_counts(run: Run) -> None:
    found = run.verification
    assert found.pressures_bar == pytest.approx([0.06 * k for k in range(1, 11)])
    assert len(found.theta_deg) == 1
    assert len(found.theta_deg[0]) == 10
    assert np.all(np.diff(found.theta_deg[0]) > 0.0)
    assert found.converged
    last = found.last
    assert 0.1 < last.air_ml < 2.0
    assert last.residual < 1e-5
    assert last.energy_error < 0.02
    assert 0.8 < last.least_J < 1.0 < last.largest_stretch < 3.0
    assert last.thread_N > 0.5
    assert not last.touches
    # Clamped ring and plug have no nodes of their own to find.
    assert 0.8 * 3 * found.nodes < found.dofs < 3 * found.nodes


def test_a_thicker_gauze_gives_more_stiffness(samples: Path) -> None:
    design = short(samples)
    one = replace(design, gauze=replace(design.gauze, turns=1))
    assert actuator_of(design).gauze.stiffness == pytest.approx(98.17, abs=0.01)
    assert actuator_of(one).gauze.stiffness == pytest.approx(98.17 / 2.0, abs=0.01)


def test_a_verified_design(samples: Path, run: Run) -> None:
    design = short(samples)
    facing = run.verification.last.shape.facing
    done = check(design, along(facing).points)
    assert done.failure is None
    assert done.design.verified is True
    (joint,) = done.design.joints
    assert joint.theta_fe_deg == round(run.verification.last.theta_deg[0], 4)
    assert done.design.fit.fe is not None
    assert done.design.fit.fe.max_mm < 0.01
    assert done.design.fit.formula == design.fit.formula
    assert check(design, along(facing).points).design == done.design


def test_the_fit_is_in_the_designs_own_pose(samples: Path, run: Run) -> None:
    facing = run.verification.last.shape.facing
    moved = check(short(samples), along(facing + np.array([0.0, 1.0])).points).design.fit.fe
    assert moved is not None
    assert 0.8 < moved.rms_mm <= moved.max_mm <= 1.01


def test_a_design_that_does_not_converge(
    samples: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise NotConverged("residual at 0.500 bar", (), 0.04)

    monkeypatch.setattr("profiletool.verify.run.solve", fails)
    done = check(short(samples), along(run.verification.rest.shape.facing).points)
    assert done.design == short(samples)
    assert done.run is None
    assert done.shape is None
    assert done.failure == "no equilibrium found beyond 0.40 bar"


def test_states_that_were_reached_are_kept_where_a_run_does_not_converge(
    samples: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object, **__: object) -> None:
        part = replace(run.solution, states=run.solution.states[:4])
        raise NotConverged("residual at 0.300 bar", (), 0.024, part)

    monkeypatch.setattr("profiletool.verify.run.solve", fails)
    done = check(short(samples), run.verification.rest.shape.facing)
    assert done.failure == "no equilibrium found beyond 0.24 bar"
    assert not done.design.verified
    assert done.shape is None
    assert done.run is not None
    found = done.run.verification
    assert not found.converged
    assert found.critical is None
    assert found.failure == done.failure
    assert found.theta_deg[0] == run.verification.theta_deg[0][:3]


def test_a_limit_point_before_the_operating_pressure(
    samples: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended = fem.Critical("limit point", 0.05)
    changed(monkeypatch, lambda s: replace(s, states=s.states[:-3], critical=ended))
    done = check(short(samples), along(run.verification.rest.shape.facing).points)
    assert done.failure == "limit point at 0.50 bar"
    assert done.design.verified is False
    assert done.design.joints[0].theta_fe_deg is None
    assert done.design.fit.fe is None
    assert done.shape is None
    assert done.run is not None
    assert not done.run.verification.converged
    assert len(done.run.verification.states) == STEPS - 3


def test_a_limit_point_just_above_the_operating_pressure(
    samples: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended = fem.Critical("limit point", 0.0612)
    changed(monkeypatch, lambda s: replace(s, ahead=ended))
    done = check(short(samples), along(run.verification.rest.shape.facing).points)
    assert done.failure == "limit point at 0.61 bar, less than 5 % above 0.60 bar"
    assert done.design.verified is False
    assert done.shape is None
    assert done.run is not None
    assert done.run.verification.converged


def test_a_design_that_cannot_be_modelled(samples: Path, run: Run) -> None:
    design = short(samples)
    thick = replace(design, tube=replace(design.tube, wall_mm=8.0))
    done = check(thick, along(run.verification.rest.shape.facing).points)
    assert done.failure is not None
    assert done.failure.startswith("cannot be modelled: a wall of 8 mm")


def test_angles_go_on_beyond_half_a_turn(samples: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    turns = iter(np.radians([0.0, 170.0, -160.0, 100.0]))

    def wound(found: fem.Solution) -> fem.Solution:
        return replace(
            found, states=tuple(replace(s, theta=np.array([next(turns)])) for s in found.states)
        )

    changed(monkeypatch, wound)
    actuator = actuator_of(short(samples))
    found = inflate(actuator, [0.05, 0.1, 0.15], LYING, DOWN).verification
    assert found.theta_deg[0] == pytest.approx([170.0, 200.0, 100.0])


def test_the_tube_is_of_its_own_rubber(samples: Path, tmp_path: Path) -> None:
    plain = short(samples)
    assert plain.tube.rubber is None
    assert actuator_of(plain).rubber == PAPER_RUBBER
    stiff = RubberLaw("stiff", "mooney-rivlin", {"C10": 0.1388, "C01": 0.1256, "K": 6.434})
    design = replace(plain, tube=replace(plain.tube, rubber=stiff))
    (tmp_path / "design.json").write_text(to_json(design))
    read = load_design(tmp_path / "design.json")
    assert read.tube.rubber == stiff
    law = actuator_of(read).rubber
    assert pytest.approx(2.0 * (PAPER_RUBBER.C10 + PAPER_RUBBER.C01)) == law.C10 + law.C01
    broken = replace(
        design,
        tube=replace(
            design.tube, rubber=replace(stiff, constants={**stiff.constants, "C10": -1.0})
        ),
    )
    (tmp_path / "broken.json").write_text(to_json(broken))
    with pytest.raises(UnreadableInput, match="rubber"):
        load_design(tmp_path / "broken.json")
