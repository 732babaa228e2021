from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from formula.files import load_formula
from profiletool.bending.constant_curvature import FormulaModel
from profiletool.bending.model import Chain, centers_of
from profiletool.errors import NoObject
from profiletool.joints.bounds import cuts_of, limits_of
from profiletool.joints.closest import closest_points, target_points
from profiletool.joints.correction.parameters import PosedChain
from profiletool.joints.expected import Expected, error_sizes
from profiletool.joints.misfit import misfit
from profiletool.joints.optimal.bends import tabulate
from profiletool.joints.optimal.choose import Choice, ChoiceOptions, choose
from profiletool.joints.optimal.lines import Discretisation
from profiletool.joints.optimal.search import search
from profiletool.profile.target import Reach, profile_of_line
from profiletool.records.built import BuildErrors
from profiletool.records.frames import Pose
from profiletool.records.profile import Profile
from profiletool.records.request import TubeSpec
from profiletool.records.units import FloatArray
from profiletool.verdict.missed import missed, reasons, tightest_radius
from tests.curves import turning_line

MODEL = FormulaModel(load_formula(), 10.0)
SPEC = TubeSpec()
LIMITS = limits_of(MODEL, SPEC)
CUTS = cuts_of(MODEL, SPEC)


def bent_line(*pieces: tuple[float, float]) -> Profile:
    """Profile of (length, turn in deg) pieces, from heading straight down; right turns negative."""
    return profile_of_line(turning_line(*pieces), Reach("left", 10.0))


BOWL = bent_line((20.0, 0.0), (40.0, 70.0), (20.0, 0.0))


@pytest.mark.slow
def test_the_search_is_as_good_as_trying_everything() -> None:
    profile = bent_line((15.0, 0.0), (25.0, 55.0), (25.0, -25.0), (15.0, 0.0))
    grid = Discretisation(12.0, (0.0,), (-0.3, 0.3), 0.04, 0.16)
    found = search(profile, MODEL, CUTS, LIMITS, 0.3, grid, 3)
    for pressure in range(len(found.pressure)):
        edges: dict[tuple[int, int], float] = {}
        for of_sense, priced in zip(found.senses, found.priced[pressure], strict=True):
            for a, b, cost in zip(of_sense.start, of_sense.end, priced.cost, strict=True):
                edges[int(a), int(b)] = min(cost, edges.get((int(a), int(b)), np.inf))
        lines = range(found.lines.base, len(found.lines.place))
        for joints in (1, 2, 3):
            best = np.full(len(found.lines.place), np.inf)
            for way in product(lines, repeat=joints):
                path = (0, *way)
                cost = sum(edges.get(pair, np.inf) for pair in zip(path, way, strict=False))
                best[way[-1]] = min(best[way[-1]], cost)
            assert found.totals[pressure][joints] == pytest.approx(best)


def test_a_path_costs_what_its_actuator_misses() -> None:
    grid = Discretisation()
    found = search(BOWL, MODEL, CUTS, LIMITS, 0.3, grid, 4)
    joints = 3
    pressure = int(np.argmin(found.cost[:, joints - 1]))
    at = found.posed_chain(pressure, joints, MODEL, BOWL, LIMITS)
    shape = MODEL.shape(at.chain, at.pressure, at.pose, BOWL.sign)
    predicted = np.sqrt(found.cost[pressure, joints - 1] / BOWL.length_mm)
    assert misfit(shape, BOWL).rms_mm == pytest.approx(predicted, abs=0.05)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_the_vertex_lies_as_far_from_both_edges_of_the_window(sense: float) -> None:
    bends = tabulate(MODEL, 0.2, np.array([10.0]), sense)
    theta, reach = bends.most[0], bends.reach[0, -1]
    x, y, heading = MODEL.line(10.0, MODEL.alpha_for(10.0, theta, 0.2), 0.2, sense)[-1]
    end = reach * np.array([1.0 + np.cos(heading), np.sin(heading)])
    assert [x, y] == pytest.approx(end, abs=1e-6)


def within_limits(choice: Choice, spec: TubeSpec = SPEC) -> None:
    chain, limits = choice.chain, choice.limits
    gaps = np.diff(chain.centre) - 0.5 * (chain.openF[1:] + chain.openF[:-1])
    assert np.all(gaps >= limits.wrap_mm - 1e-9)
    assert chain.centre[0] >= max(spec.root_mm, 0.5 * chain.openF[0] + limits.wrap_mm) - 1e-9
    assert chain.length - chain.centre[-1] - 0.5 * chain.openF[-1] >= limits.end_mm - 1e-9
    assert chain.length <= spec.max_length_mm + 1e-9
    assert np.all((chain.alpha >= MODEL.alpha[0]) & (chain.alpha <= MODEL.alpha[1]))
    assert limits.pressure[0] <= choice.pressure <= limits.pressure[1]
    assert np.all(np.isin(chain.openF, CUTS))


def test_a_bowl_is_followed_within_the_limits_and_the_same_every_time() -> None:
    first, second = (choose(BOWL, MODEL, SPEC) for _ in range(2))
    within_limits(first)
    assert first.misfit.rms_mm <= 0.25
    assert first.depth <= 0.4
    assert reasons(BOWL, first, MODEL, SPEC, 0.25) == ()
    assert np.array_equal(first.shape.facing, second.shape.facing)
    assert first.pressure == second.pressure


@pytest.mark.parametrize("count", [2, 5])
def test_a_wished_number_of_joints_is_honoured(count: int) -> None:
    choice = choose(BOWL, MODEL, SPEC, ChoiceOptions(count=count))
    within_limits(choice)
    assert len(choice.chain.openF) == count
    assert choice.trade_off.rms_mm.shape[1] == count
    assert choice.trade_off.polished_mm[count - 1] == pytest.approx(choice.misfit.rms_mm)


def test_for_builds_that_are_off_joints_are_taken_that_errors_move_less() -> None:
    sizes = error_sizes(BuildErrors(), SPEC)
    assert sizes is not None
    nominal = choose(BOWL, MODEL, SPEC)
    built = choose(BOWL, MODEL, SPEC, ChoiceOptions(sizes=sizes))
    within_limits(built)
    points = target_points(BOWL)

    def errors_mm(choice: Choice) -> float:
        posed = PosedChain(choice.chain, choice.pressure, choice.pose)
        closest = closest_points(choice.shape.facing, points, BOWL.sign)
        return Expected(MODEL, sizes).rms_mm(posed, choice.shape, closest)

    assert errors_mm(built) < 0.98 * errors_mm(nominal)
    assert built.misfit.rms_mm <= 0.25
    assert len(built.chain.openF) <= len(nominal.chain.openF) + 1


@pytest.mark.slow
def test_fewer_joints_do_for_a_looser_tolerance() -> None:
    tight, loose = (choose(BOWL, MODEL, SPEC, ChoiceOptions(tolerance_mm=t)) for t in (0.05, 2.0))
    assert len(loose.chain.openF) < len(tight.chain.openF)


def test_less_pressure_takes_no_more_than_is_allowed() -> None:
    spec = replace(SPEC, max_pressure_bar=1.2)
    choice = choose(BOWL, MODEL, spec)
    within_limits(choice, spec)
    assert choice.pressure <= 0.12 + 1e-12
    assert choice.trade_off.pressure[-1] == pytest.approx(0.12)


@pytest.mark.slow
def test_a_free_base_is_no_worse() -> None:
    hollow = bent_line((12.0, -14.0), (50.0, 80.0), (25.0, 0.0))
    fixed, free = (
        choose(hollow, MODEL, SPEC, ChoiceOptions(count=3, base_free=f)) for f in (False, True)
    )
    assert free.misfit.rms_mm <= fixed.misfit.rms_mm + 1e-3
    assert free.limits.base_free


def actuators() -> st.SearchStrategy[Chain]:
    """Feasible actuators of two or three joints on a root of 16 mm."""

    def chain(joints: list[tuple[float, float, float, float]]) -> Chain:
        openF, alpha, sense, wrapped = (np.array(v) for v in zip(*joints, strict=True))
        edge = 6.0 + np.cumsum(wrapped + openF)
        return Chain(
            edge - 0.5 * openF, openF, np.radians(alpha), centers_of(sense), float(edge[-1]) + 15.0
        )

    joint = st.tuples(
        st.sampled_from(CUTS.tolist()),
        st.floats(95.0, 145.0),
        st.sampled_from([1.0, 1.0, -1.0]),
        st.floats(8.0, 20.0),
    )
    return st.lists(joint, min_size=2, max_size=3).map(chain)


def profile_like(facing: FloatArray) -> Profile:
    return profile_of_line(facing, Reach("left", 10.0))


@settings(max_examples=6)
@given(actuators())
@pytest.mark.slow
def test_it_is_at_least_as_good_as_the_actuator_that_the_profile_comes_from(chain: Chain) -> None:
    pose = Pose(0.0, 0.0, -90.0)
    made = MODEL.shape(chain, 0.17, pose, 1.0)
    profile = profile_like(made.facing)
    choice = choose(profile, MODEL, SPEC)
    within_limits(choice)
    # The profile's headings are smoothed at the joints' sharp ends.
    assert choice.misfit.rms_mm <= max(misfit(made, profile).rms_mm + 0.02, 0.25)


@pytest.mark.slow
def test_a_curve_too_tight_is_named_with_its_place() -> None:
    corner = bent_line((50.0, 0.0), (3.0, 90.0), (50.0, 0.0))
    choice = choose(corner, MODEL, SPEC)
    (stretch,) = missed(corner, choice, MODEL, SPEC, 0.25)
    assert stretch.start < 51.5 < stretch.end
    assert "turns 9" in stretch.reason or "turns 8" in stretch.reason
    assert "toward the object" in stretch.reason
    assert "2.00 bar" in stretch.reason


@pytest.mark.slow
def test_a_hollow_tighter_than_the_tube_bends_is_named() -> None:
    least = tightest_radius(MODEL, SPEC, 0.2, -1.0)
    assert least > 25.0 > tightest_radius(MODEL, SPEC, 0.2, 1.0)
    hollow = bent_line((30.0, 0.0), (np.radians(120.0) * 22.0, -120.0), (30.0, 0.0))
    choice = choose(hollow, MODEL, SPEC)
    said = " ".join(reasons(hollow, choice, MODEL, SPEC, 0.25))
    assert (
        "away from the object, at a radius down to 22 mm, and joints in a row follow none " in said
    )


def test_a_profile_too_long_for_the_tube_is_followed_as_far_as_it_goes() -> None:
    spec = replace(SPEC, max_length_mm=70.0)
    choice = choose(BOWL, MODEL, spec)
    within_limits(choice, spec)
    (reason,) = reasons(BOWL, choice, MODEL, spec, 0.25)
    assert "may be 70 mm long" in reason


def test_a_straight_profile_has_nothing_to_bend() -> None:
    with pytest.raises(NoObject, match="straight"):
        choose(bent_line((60.0, 0.0)), MODEL, SPEC)
