"""Plans of joints: angles and places on the bent tube, the numbers of the layout, and verdicts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from formula.files import load_formula
from formula.theta import theta_deg
from profiletool.bending.kinematics import Bend, deform
from profiletool.bending.model import Chain, centers_of
from profiletool.bending.response import Response
from profiletool.errors import UsageError
from profiletool.files.design_json import load_design
from profiletool.joints.correction.by_model import BendingForwardModel
from profiletool.joints.correction.correct import CannotBend, Iterate
from profiletool.joints.correction.parameters import PosedChain
from profiletool.joints.optimal_method import angles, optimal_plan
from profiletool.joints.windows import off_mesh
from profiletool.pipeline import Request, Result, run
from profiletool.records.design import Design, Fit, Misfit
from profiletool.records.frames import Pose, Shape
from profiletool.records.making import request_of
from profiletool.records.profile import Profile
from profiletool.records.request import TubeSpec
from profiletool.subject.find import Subject, find_subject
from profiletool.verdict.missed import Missed
from profiletool.verdict.reasons import GOOD_SHARE, not_good


def silent(line: str) -> None:
    pass


@pytest.fixture(scope="module")
def request_(samples: Path) -> Request:
    return Request(samples / "finger_rest.csv", verify=False)


@pytest.fixture(scope="module")
def result(request_: Request) -> Result:
    return run(request_, silent)


def chain_of(result: Result) -> Chain:
    joints, tube = result.design.joints, result.design.tube
    return Chain(
        np.array([j.centre_mm for j in joints]),
        np.array([j.openF_mm for j in joints]),
        np.radians([j.alpha_closed_deg for j in joints]),
        np.radians([j.alpha_center_deg for j in joints]),
        tube.length_mm,
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_angles_of_a_known_shape(sign: float) -> None:
    turns = np.radians([40.0, 75.0, -20.0, 80.0, 60.0])  # past half a turn in all
    centre = np.array([14.0, 34.0, 52.0, 75.0, 97.0])
    openF = np.array([8.0, 12.0, 6.0, 14.0, 10.0])
    bends = [Bend(*three) for three in zip(centre, openF, turns, strict=True)]
    shape = deform(bends, 110.0, 10.0, Pose(3.0, -2.0, 170.0), sign)
    chain = Chain(centre, openF, np.full(5, 2.0), centers_of(turns), 110.0)
    assert angles(shape, chain) == pytest.approx(sign * turns, abs=1e-9)


@pytest.mark.parametrize("method", [pytest.param("optimal", marks=pytest.mark.slow), "paper"])
def test_a_given_pressure_is_kept(samples: Path, method: str) -> None:
    asked = {"pressure_bar": 0.77, "method": method, "verify": False}
    result = run(request_of(samples / "finger_rest.csv", asked), silent)
    assert result.design.pressure_bar == pytest.approx(0.77, abs=1e-9)
    assert not any(one.what == "lower pressure" for one in result.design.neighbours)


def test_a_given_pressure_that_no_joint_is_known_at(samples: Path) -> None:
    with pytest.raises(UsageError, match=r"0\.1 bar is not within the 0\.2 to 2\.2 bar"):
        run(request_of(samples / "finger_rest.csv", {"pressure_bar": 0.1}), silent)


@pytest.mark.slow
def test_neighbours_are_told_with_the_choice(result: Result) -> None:
    chosen, *others = result.design.neighbours
    count = len(result.design.joints)
    assert (chosen.what, chosen.joints) == ("as chosen", count)
    assert chosen.rms_mm == pytest.approx(result.plan.choice.misfit.rms_mm, abs=1e-4)
    known = {one.what: one for one in others}
    assert known["one joint fewer"].joints == count - 1
    assert known["one joint more"].joints == count + 1
    assert known["lower pressure"].pressure_bar <= 0.9 * chosen.pressure_bar + 1e-3
    assert {one.by for one in result.design.neighbours} == {"joint response"}
    assert all(one.expected_rms_mm > one.rms_mm for one in result.design.neighbours)
    assert known["one joint fewer"].rms_mm > chosen.rms_mm


@pytest.mark.slow
def test_places_fall_on_whole_meshes_where_that_costs_little(result: Result) -> None:
    design = result.design
    assert off_mesh(design.joints, design.gauze) == ()
    fine = run(replace(result.request, place_step_mm=1.0), silent).design.fit.response
    assert design.fit.response.rms_mm < fine.rms_mm + 0.1


def test_angles_of_a_tube_that_bends_in_its_wrapped_sectors_too() -> None:
    # A circle: from the middle of one wrapped sector to that of the next.
    shape = deform([Bend(50.0, 100.0, 2.0)], 100.0, 10.0, Pose(0.0, 0.0, 0.0), 1.0)
    two = np.ones(2)
    chain = Chain(np.array([20.0, 60.0]), 10.0 * two, two, centers_of(two), 100.0)
    # Sectors of 0 to 15, 25 to 55 and 65 to 100 mm.
    assert angles(shape, chain) == pytest.approx(0.02 * np.array([32.5, 42.5]), abs=1e-4)


def test_the_numbers_of_the_layout_add_up(result: Result, request_: Request) -> None:
    layout, joints = result.plan.layout, result.plan.layout.joints
    assert [j.number for j in joints] == list(range(1, len(joints) + 1))
    assert layout.root_mm == joints[0].centre_mm
    centres = layout.root_mm + np.cumsum([0.0, *(j.F_mm for j in joints)])
    assert [j.centre_mm for j in joints] == pytest.approx(centres[:-1])
    assert layout.length_mm == pytest.approx(centres[-1])
    cut = [e for j in joints for e in (j.centre_mm - j.openF_mm / 2, j.centre_mm + j.openF_mm / 2)]
    assert np.diff([0.0, *cut, layout.length_mm]).min() >= 2.0 - 1e-9
    assert result.design.tube.length_mm == layout.length_mm
    assert result.design.pressure_bar == layout.pressure_bar
    # In steps that can be built: meshes, threads, millimetres and hundredths of a bar.
    for j in joints:
        for value, step in ((j.openF_mm, 2.0), (np.radians(j.alpha_closed_deg), 0.2)):
            assert value / step == pytest.approx(round(value / step), abs=1e-6)
    wrapped = np.diff(cut)[1::2]
    assert wrapped == pytest.approx(np.round(wrapped), abs=1e-6)
    assert 100.0 * layout.pressure_bar == pytest.approx(round(100.0 * layout.pressure_bar))


def test_every_joint_knows_its_angles(result: Result) -> None:
    chain, choice = chain_of(result), result.plan.choice
    assert choice is not None
    model = Response.load()
    design, joints = result.design, result.design.joints
    bent = model.shape(chain, 0.1 * design.pressure_bar, design.base_pose, 1.0)
    assert result.plan.bent.facing == pytest.approx(bent.facing, abs=1e-9)
    by_response = np.abs(np.degrees(angles(bent, chain)))
    assert [j.theta_response_deg for j in joints] == pytest.approx(by_response)
    wanted = np.abs(np.degrees(angles(choice.shape, choice.chain)))
    assert [j.theta_target_deg for j in joints] == pytest.approx(wanted)
    assert design.formula.name == "fe"  # ours, for the paper's tube
    ours = load_formula(Path("fe"))
    formula = theta_deg(ours, np.degrees(chain.alpha), chain.openF, result.design.pressure_bar)
    assert [j.theta_formula_deg for j in joints] == pytest.approx(formula)
    assert all(j.theta_fe_deg is None for j in joints)
    # Rounded, but not bent all differently.
    assert by_response == pytest.approx(wanted, abs=8.0)
    assert (np.sign(angles(bent, chain)) == chain.sense).all()


def test_places_are_those_nearest_to_the_joints(result: Result) -> None:
    plan, profile = result.plan, result.subject.profile
    assert (np.diff(plan.places) > 0.0).all()
    for place, joint in zip(plan.places, plan.layout.joints, strict=True):
        at = [np.interp(joint.centre_mm, plan.bent.along, plan.bent.facing[:, k]) for k in (0, 1)]
        there = [np.interp(place, profile.s, profile.points[:, k]) for k in (0, 1)]
        nearest = np.hypot(*(profile.points - at).T).min()
        assert np.hypot(*np.subtract(at, there)) == pytest.approx(nearest, abs=1e-9)


@pytest.mark.slow
def test_by_a_formula_of_the_users(samples: Path, tmp_path: Path) -> None:
    import formula

    file = next((Path(formula.__file__).parent / "coefficients").glob("*.json"))
    (tmp_path / "mine.json").write_bytes(file.read_bytes())
    request = Request(samples / "finger_rest.csv", formula=tmp_path / "mine.json", verify=False)
    found = run(request, silent)
    assert found.plan.by == "formula"
    assert found.design.fit.response is None
    assert all(j.theta_response_deg is None for j in found.design.joints)
    assert found.design.fit.formula.rms_mm < 0.01 * found.subject.profile.length_mm


def test_less_pressure_than_joints_are_known_for(request_: Request) -> None:
    weak = replace(request_, tube=TubeSpec(max_pressure_bar=0.05))
    with pytest.raises(UsageError, match=r"`max_pressure_bar` 0\.05 bar is less than the 0\.2 bar"):
        run(weak, silent)


class Bursting(BendingForwardModel):
    """Finite elements for which no tube stands 1.2 bar."""

    def __init__(self) -> None:
        super().__init__(Response.load())

    def bend(
        self, posed: PosedChain, sign: float, near: Iterate[None] | None
    ) -> tuple[Shape, None]:
        if posed.pressure > 0.12:
            raise CannotBend("limit point at 1.20 bar", 0.12)
        return super().bend(posed, sign, near)


@pytest.mark.slow
def test_a_choice_that_does_not_stand_is_made_again_with_less_pressure(request_: Request) -> None:
    said: list[str] = []
    profile = find_subject(request_, silent).profile
    plan = optimal_plan(request_, profile, load_formula(), said.append, Bursting())
    (note,) = plan.notes
    assert note.endswith("did not stand by FE: limit point at 1.20 bar")
    assert note in said
    assert plan.layout.pressure_bar <= 0.97 * 1.20
    assert len([line for line in said if line.startswith("joints: ")]) == 2
    assert any(line.startswith("finite elements, first guess: ") for line in said)


@pytest.fixture(scope="module")
def subject(request_: Request) -> Subject:
    return find_subject(request_, silent)


def judged(
    profile: Profile,
    request: Request,
    design: Design,
    fit: Fit,
    length_mm: float = 100.0,
    places: tuple[Missed, ...] = (),
) -> tuple[str, ...]:
    made = replace(design, fit=fit, tube=replace(design.tube, length_mm=length_mm))
    return not_good(made, profile, request, places)


GOOD, BAD = Misfit(0.5, 0.9), Misfit(5.0, 9.0)


def test_verdicts_at_their_limits(samples: Path, request_: Request, subject: Subject) -> None:
    design, profile = load_design(samples / "paper_bulb.json"), subject.profile
    limit = GOOD_SHARE * profile.length_mm
    assert limit == pytest.approx(1.183, abs=1e-3)

    def of(rms: float, request: Request = request_, **more: float) -> tuple[str, ...]:
        return judged(profile, request, design, Fit(Misfit(rms, 3.0), None), **more)

    assert of(limit - 1e-6) == ()
    (reason,) = of(limit + 0.01)
    assert reason == (
        "the best shape found lies 1.19 mm RMS and up to 3.00 mm off the profile, more than "
        "1.18 mm RMS"
    )
    strict = replace(request_, tolerance_mm=0.3)
    assert of(0.3, strict) == ()
    assert "more than 0.30 mm RMS" in of(0.301, strict)[0]
    assert of(5.0, replace(request_, tolerance_mm=6.0)) == ()
    assert of(0.1, length_mm=250.04) == ()
    (long,) = of(0.1, length_mm=250.2)
    assert "250.2 mm long, more than 250 mm" in long
    assert of(0.1, replace(request_, joints=len(design.joints))) == ()
    (few,) = of(0.1, replace(request_, joints=7))
    assert few == "there is no room for 7 joints on this profile, only 6"


def test_the_best_knowledge_of_the_shape_counts(
    samples: Path, request_: Request, subject: Subject
) -> None:
    design, profile = load_design(samples / "paper_bulb.json"), subject.profile
    for fit, good in (
        (Fit(BAD, None), False),
        (Fit(BAD, None, GOOD), True),
        (Fit(GOOD, None, BAD), False),
        (Fit(BAD, GOOD, BAD), True),
        (Fit(GOOD, BAD, GOOD), False),
    ):
        assert (judged(profile, request_, design, fit) == ()) == good
    # Places are told where the whole is not good.
    there = (Missed(10.0, 12.0, 2.0, "10 mm down: up to 2.0 mm off"),)
    assert judged(profile, request_, design, Fit(GOOD, None), places=there) == ()
    assert judged(profile, request_, design, Fit(BAD, None), places=there)[1:] == (
        "10 mm down: up to 2.0 mm off",
    )
