"""Whole runs: against the independent reference numbers, energy, mesh error (rows 10, 12 to 14)."""

from __future__ import annotations

import csv
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from fem.actuator import Actuator, chain
from fem.gauze import PAPER_GAUZE, Gauze
from fem.loadpath import Options
from fem.material import Law, MooneyRivlin, Ogden
from fem.meshsize import DEFAULT_MESH, PAPER_MESH, MeshSize
from fem.solution import Solution
from fem.solver import solve
from tests.fem.laws import EVERY_LAW

FloatArray = NDArray[np.float64]
Campaign = dict[tuple[float, float], list[tuple[float, float]]]


def bulb() -> Actuator:
    """The paper's Table 5."""
    return chain(
        10.0, [19, 19, 19, 12, 12, 8], [8, 8, 8, 8, 6, 10],
        np.radians([132, 132, 132, 144, 144, 108]), np.radians([270] * 5 + [90]), end=4.0,
    )  # fmt: skip


def joint(alpha: float, openF: float, gauze: Gauze | None = None) -> Actuator:
    """The paper's one-joint model, alpha in degrees."""
    return chain(30.0, [30.0], [openF], [np.radians(alpha)], gauze=gauze or Gauze())


def campaign(shared: Path, name: str) -> Campaign:
    """(alpha, openF) to (pressure in bar, theta in degrees)."""
    cases: Campaign = defaultdict(list)
    with (shared / "reference" / name).open() as file:
        for row in csv.DictReader(file):
            key = float(row["alpha_closed_deg"]), float(row["openF_mm"])
            cases[key].append((float(row["pressure_bar"]), float(row["theta_fe_deg"])))
    return cases


def table(shared: Path, name: str) -> tuple[FloatArray, FloatArray]:
    """Pressures in bar, and angles in degrees."""
    rows = np.loadtxt(shared / "reference" / name, delimiter=",", skiprows=1)
    return rows[:, 0], rows[:, 1:]


def check(run: Solution) -> None:
    """What must hold of every run that ended."""
    assert run.converged
    assert run.states[-1].residual <= 1e-6
    for state in run.states[1:]:
        assert state.residual <= 3e-3
        assert state.energy_error <= 1e-3
        assert state.least_J > 0.0


def angles(run: Solution) -> FloatArray:
    return np.degrees([state.theta for state in run.states[1:]])


def formula(alpha: float, openF: float, P: float) -> float:
    """Formula (9) with the coefficients of Table 3, written out here once more."""
    m = (-0.000166 * alpha**2 + 0.031915 * alpha - 0.856229) * P**2 + (
        -0.000009 * alpha**2 - 0.000689 * alpha + 0.991593
    ) * P
    return m * openF + (-0.007112 * alpha + 4.051633) * P


@pytest.mark.parametrize("case", [(84.0, 10.0), (108.0, 14.0), (156.0, 8.0)])
def test_joint_against_the_reference(shared: Path, case: tuple[float, float]) -> None:
    known = campaign(shared, "joint_campaign.csv")[case][4::5]  # half-way, and the last
    run = solve(joint(*case), [P / 10.0 for P, _ in known])
    check(run)
    np.testing.assert_allclose(angles(run)[:, 0], [theta for _, theta in known], rtol=0.02)


@pytest.mark.slow
def test_campaign_against_the_reference_and_the_formula(shared: Path) -> None:
    off: dict[float, list[float]] = defaultdict(list)
    for (alpha, openF), known in campaign(shared, "joint_campaign.csv").items():
        run = solve(joint(alpha, openF), [P / 10.0 for P, _ in known])
        check(run)
        theta = angles(run)[:, 0]
        # The reference is rounded to 0.01 deg, 0.35 % of the smallest angle.
        wanted = np.array([value for _, value in known])
        assert np.all(np.abs(theta - wanted) <= 0.02 * wanted + 0.005), (alpha, openF)
        for (P, _), value in zip(known, theta, strict=True):
            off[P].append(value - formula(alpha, openF, P))
    rms = {P: float(np.sqrt(np.mean(np.square(values)))) for P, values in off.items()}
    assert max(rms[P] for P in (0.2, 0.4, 0.6)) <= 0.5
    assert rms[1.0] <= 1.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "case",
    [
        (84.0, 10.0),
        pytest.param(
            (132.0, 8.0),
            marks=pytest.mark.xfail(strict=True, reason="5 % low up to 0.8 bar, 2 % at 1.6 bar"),
        ),
    ],
)
def test_as_the_paper_modelled_it(shared: Path, case: tuple[float, float]) -> None:
    """8-node bricks of 1 mm, and threads that resist compression too."""
    known = [v for v in campaign(shared, "joint_campaign_paper_like.csv")[case] if v[0] <= 1.6]
    # Threads in compression buckle: the paper's model has no stable state above 0.3 to 1 bar.
    options = Options(stable=False)
    run = solve(joint(*case, PAPER_GAUZE), [P / 10.0 for P, _ in known], PAPER_MESH, options)
    check(run)
    np.testing.assert_allclose(angles(run)[:, 0], [theta for _, theta in known], rtol=0.04)


@pytest.mark.slow
def test_bulb_against_the_reference(shared: Path) -> None:
    pressures, theta = table(shared, "bulb_fe.csv")
    run = solve(bulb(), pressures / 10.0)
    check(run)
    np.testing.assert_allclose(angles(run), theta, rtol=0.03)
    last = run.states[-1]
    # The gauze holds the diameter; between the opposed joints 5 and 6 the tube turns oval by 3.4 %.
    assert np.abs(last.shape.height / 20.0 - 1.0).max() < 0.04
    assert not last.touches


@pytest.mark.slow
def test_finger_against_the_reference(shared: Path) -> None:
    pressures, theta = table(shared, "finger_fe.csv")
    actuator = chain(10.0, [40.0, 22.0, 20.0], [14.0, 16.0, 12.0], [np.radians(90.0)] * 3)
    run = solve(actuator, pressures / 10.0)
    check(run)
    np.testing.assert_allclose(angles(run), theta, rtol=0.03)


@pytest.mark.slow
def test_mesh_error_of_the_default() -> None:
    """Row 12: half of all sizes changes theta by less than 2 %."""
    fine = MeshSize(
        around=2 * DEFAULT_MESH.around,
        beside=0.5 * DEFAULT_MESH.beside,
        edge=0.5 * DEFAULT_MESH.edge,
        window=0.5 * DEFAULT_MESH.window,
        wrapped=0.5 * DEFAULT_MESH.wrapped,
        end=0.5 * DEFAULT_MESH.end,
    )
    coarse, better = (
        angles(solve(joint(84.0, 10.0), [0.02, 0.1, 0.2], size))[:, 0]
        for size in (DEFAULT_MESH, fine)
    )
    np.testing.assert_allclose(coarse, better, rtol=0.02)


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_a_joint_of_any_law_is_inflated(rubber: Law) -> None:
    actuator = chain(30.0, [30.0], [10.0], [np.radians(84.0)], rubber=rubber)
    run = solve(actuator, [0.05, 0.1], replace(DEFAULT_MESH, edge=1.0))
    check(run)
    small, large = angles(run)[:, 0]
    assert 0.0 < 2.0 * small < large  # the angle rises faster than the pressure


def test_laws_that_are_one_bend_alike() -> None:
    law = MooneyRivlin(0.0694, 0.0628, 3.2)
    ogden = Ogden((2.0 * law.C10, -2.0 * law.C01), (2.0, -2.0), law.K)
    size = replace(DEFAULT_MESH, edge=1.0)
    a, b = (
        solve(replace(joint(84.0, 10.0), rubber=rubber), [0.1], size).states[-1]
        for rubber in (law, ogden)
    )
    np.testing.assert_allclose(a.theta, b.theta, rtol=1e-6)
    np.testing.assert_allclose(a.x, b.x, atol=1e-5)


@pytest.mark.slow
def test_half_and_whole_agree() -> None:
    actuator = chain(8.0, [14.0], [6.0], [np.radians(100.0)])
    size = replace(DEFAULT_MESH, around=6, beside=0.0, edge=1.0)  # the same bricks in both
    half, whole = (solve(actuator, [0.1], size, whole=w) for w in (False, True))
    assert half.mesh.half
    assert not whole.mesh.half
    a, b = half.states[-1], whole.states[-1]
    np.testing.assert_allclose(a.theta, b.theta, rtol=1e-5)
    np.testing.assert_allclose(a.shape.facing, b.shape.facing, atol=1e-4)
    assert a.volume == pytest.approx(b.volume, rel=1e-6)
    assert a.energy == pytest.approx(b.energy, rel=1e-5)


@pytest.mark.slow
def test_a_turned_sector_turns_the_whole_answer() -> None:
    """A joint at any alpha_center is the joint at 270 deg turned about the tube."""
    size = replace(DEFAULT_MESH, around=6, beside=0.0, edge=1.0)  # 120 deg is four bricks
    found = []
    for center in (270.0, 150.0):
        actuator = chain(8.0, [14.0], [6.0], [np.radians(100.0)], [np.radians(center)])
        found.append(solve(actuator, [0.1], size, whole=True).states[-1])
    straight, turned = found
    assert abs(turned.theta[0]) == pytest.approx(straight.theta[0], rel=1e-6)
    turn = np.radians(150.0 - 270.0)
    c, s = np.cos(turn), np.sin(turn)
    Q = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(turned.shape.centre[-1], Q @ straight.shape.centre[-1], atol=1e-4)


def test_the_plug_stays_rigid_on_uneven_bricks() -> None:
    run = solve(chain(8.0, [14.0], [6.0], [np.radians(84.0)]), [0.15])
    ring = slice(0, run.mesh.ring)
    rest, now = run.mesh.X[-1, ring], run.states[-1].x[-1, ring]
    apart = [np.linalg.norm(v[:, None] - v, axis=2) for v in (rest, now)]
    np.testing.assert_allclose(apart[1], apart[0], atol=1e-9)


@pytest.mark.slow
def test_deterministic_to_the_last_bit_for_any_number_of_threads() -> None:
    actuator = chain(8.0, [14.0, 14.0], [6.0, 4.0], np.radians([100.0, 120.0]))
    size = replace(DEFAULT_MESH, edge=1.0)
    runs = [solve(actuator, [0.12], size, threads=t) for t in (1, 2, 2)]
    for other in runs[1:]:
        np.testing.assert_array_equal(other.states[-1].x, runs[0].states[-1].x)
