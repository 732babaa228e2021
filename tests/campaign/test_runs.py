"""One-joint runs: the task, its key, and the numbers read off the model."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fem
from fem.actuator import chain
from fem.errors import FemError, NotConverged
from fem.gauze import PAPER_GAUZE, Gauze, slack_on
from fem.loadpath import DEFAULT_OPTIONS, Options
from fem.material import PAPER_RUBBER, MooneyRivlin
from fem.measure import Sector
from fem.meshsize import DEFAULT_MESH, PAPER_MESH, MeshSize
from fem.sections import rotation_matrix
from fem.solution import Solution
from fem.solver import solve
from profiletool.campaign import runs
from profiletool.campaign.keys import hash_sources, seal
from profiletool.campaign.runs import (
    Outcome,
    Task,
    actuator_of,
    from_json,
    key,
    rigid_motion,
    run,
    to_json,
)
from profiletool.records.request import TubeSpec
from profiletool.verify.run import DOWN, LYING, inflate
from profiletool.verify.tube import joint_actuator

ROOT = Path(__file__).resolve().parents[2]
TASK = Task(10.0, 84.0, 20.0, 2.0, PAPER_RUBBER, (0.2, 0.4))
COARSE = MeshSize(around=2, beside=0.0, edge=5.0, window=5.0, wrapped=10.0, end=10.0)
OUTCOME = Outcome((0.1, 0.3), (0.1 + 0.2, -1e-17), (5e-324, 1e300), (-0.0, 2.0), "Grenzwert 1 µm")


def coarsely(monkeypatch: pytest.MonkeyPatch, gauze: Gauze | None = None) -> None:
    settings = runs._Settings(gauze or Gauze(), COARSE, Options())
    monkeypatch.setattr(runs, "_SETTINGS", {"converged": settings})


def test_the_joint_is_the_one_of_profiletool_joint() -> None:
    assert actuator_of(TASK) == joint_actuator(10.0, 84.0, 270.0, TubeSpec())


def test_all_lengths_go_with_the_diameter() -> None:
    rubber = MooneyRivlin(0.2, 0.1, 3.0)
    found = actuator_of(Task(12.0, 100.0, 30.0, 2.5, rubber, (0.2,)))
    assert (found.length, found.plug, found.windows[0].centre) == (90.0, 1.5, 45.0)
    assert (found.diameter, found.wall, found.windows[0].openF) == (30.0, 2.5, 12.0)
    assert (found.rubber, found.gauze) == (rubber, Gauze())


def test_slack_threads_are_soft_beside_a_soft_rubber() -> None:
    # Dragon Skin 10; with a share of 1e-3 the wall wrinkles, a bifurcation at 0.39 bar.
    rubber = MooneyRivlin(0.0299, 0.0, 0.72757)
    task = Task(14.0, 120.0, 20.0, 2.0, rubber, (0.5,))
    found = actuator_of(task)
    assert slack_on(PAPER_RUBBER.shear_modulus * 2.0) == Gauze.slack
    assert found.gauze.slack == pytest.approx(1e-3 * rubber.shear_modulus / 0.2644, rel=0.01)
    outcome = run(task)
    assert outcome.failure is None
    assert outcome.theta_deg == pytest.approx([86.1], abs=0.5)


def test_the_papers_model(monkeypatch: pytest.MonkeyPatch) -> None:
    joint = chain(30.0, [30.0], [10.0], [np.radians(84.0)], gauze=PAPER_GAUZE)
    asked: list[Any] = []

    def refuse(*arguments: object, **_: object) -> Solution:
        asked.append(arguments)
        raise FemError("enough")

    monkeypatch.setattr(runs, "solve", refuse)
    assert run(replace(TASK, model="paper")).failure == "enough"
    assert asked == [(joint, [0.02, 0.04], PAPER_MESH, Options(stable=False))]
    # Threads stay on the bricks' edges, every 6 deg.
    wide = actuator_of(replace(TASK, model="paper", diameter_mm=30.0))
    assert wide.gauze.pitch == pytest.approx(np.radians(6.0) * 15.0)


@pytest.mark.parametrize("pressures", [(0.2, 0.2), (0.4, 0.2), (0.0, 0.2), (-1.0,), (np.nan,)])
def test_pressures_rise_from_above_0(pressures: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="rise from above 0"):
        replace(TASK, pressures_bar=pressures)


def test_models_that_do_not_exist() -> None:
    with pytest.raises(ValueError, match="no model"):
        replace(TASK, model="finest")  # type: ignore[arg-type]


def test_any_changed_field_changes_the_key() -> None:
    others: dict[str, Any] = {
        "openF_mm": np.nextafter(10.0, 11.0),
        "alpha_deg": 84.5,
        "diameter_mm": 21.0,
        "wall_mm": 2.1,
        "rubber": replace(PAPER_RUBBER, K=2.0),
        "pressures_bar": (0.2, 0.4, 0.6),
        "model": "paper",
    }
    assert set(others) == {field.name for field in fields(Task)}
    changed = [replace(TASK, **{name: value}) for name, value in others.items()]
    changed += [replace(TASK, rubber=replace(PAPER_RUBBER, C10=0.07))]
    changed += [replace(TASK, rubber=replace(PAPER_RUBBER, C01=0.07))]
    assert len({key(task) for task in [TASK, *changed]}) == len(changed) + 1


def test_the_same_run_has_the_same_key() -> None:
    whole = Task(10, 84, 20, 2, PAPER_RUBBER, (np.float64(0.2), 0.4))
    assert key(whole) == key(TASK)


def test_what_a_model_is_made_of_is_in_the_key(monkeypatch: pytest.MonkeyPatch) -> None:
    before = key(TASK)
    finer = runs._Settings(Gauze(), replace(DEFAULT_MESH, around=5), DEFAULT_OPTIONS)
    monkeypatch.setattr(runs, "_SETTINGS", {"converged": finer})
    assert key(TASK) != before


def test_another_version_of_the_model_has_other_keys(tmp_path: Path) -> None:
    """Asked of another process, which has the same key as this one until its model changes."""
    code = (
        "from fem.material import PAPER_RUBBER as R; from profiletool.campaign.runs import *; "
        "print(key(Task(10.0, 84.0, 20.0, 2.0, R, (0.2, 0.4))))"
    )
    copy = tmp_path / "fem"
    shutil.copytree(ROOT / "fem", copy, ignore=shutil.ignore_patterns("__pycache__"))
    environment = {**os.environ, "PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}"}

    def asked() -> str:
        told = subprocess.run(
            [sys.executable, "-c", code], env=environment, cwd=tmp_path, capture_output=True,
            check=True, text=True,
        )  # fmt: skip
        return told.stdout.strip()

    assert asked() == key(TASK)
    with (copy / "gauze.py").open("a") as file:
        file.write("# another version\n")
    assert asked() != key(TASK)


def test_every_source_file_counts_however_its_lines_end(tmp_path: Path) -> None:
    known = hash_sources(Path(str(fem.__file__)).parent)
    copy = tmp_path / "fem"
    shutil.copytree(ROOT / "fem", copy)
    (copy / "notes.txt").write_text("not a source file")
    file = copy / "newton.py"
    file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n"))
    assert hash_sources(copy) == known
    law = copy / "material" / "ogden.py"  # in a subpackage
    law.rename(law.with_name("ogden2.py"))
    assert hash_sources(copy) != known
    law.with_name("ogden2.py").rename(law)
    assert hash_sources(copy) == known
    file.rename(copy / "newton2.py")
    assert hash_sources(copy) != known


def test_sub_packages_of_the_model_count_but_for_its_exports(tmp_path: Path) -> None:
    package = Path(shutil.copytree(ROOT / "fem", tmp_path / "fem"))
    known = hash_sources(package)
    (package / "export" / "vtu.py").write_text("# another writer\n")
    (package / "export" / "decks").mkdir()
    (package / "export" / "decks" / "deck.py").touch()
    assert hash_sources(package) == known
    laws = package / "laws" / "export"  # only the model's own export is none of its results
    laws.mkdir(parents=True)
    (laws / "yeoh.py").write_text("C10 = 1.0\n")
    known = hash_sources(package)
    (laws / "yeoh.py").write_text("C10 = 2.0\n")
    changed = hash_sources(package)
    assert changed != known
    (laws / "yeoh.py").rename(package / "laws" / "yeoh.py")
    assert hash_sources(package) not in (known, changed)


def test_an_outcome_comes_back_to_the_last_bit() -> None:
    data = to_json(OUTCOME)
    assert from_json(data) == OUTCOME
    assert str(from_json(data)) == str(OUTCOME)  # tells -0.0 from 0.0
    assert to_json(from_json(data)) == data
    assert json.loads(data)["schema"] == "profiletool.run/1"
    nothing = Outcome((), (), (), (), None)
    assert from_json(to_json(nothing)) == nothing


def test_every_damage_is_noticed() -> None:
    data = to_json(OUTCOME)
    damaged = [data[:end] for end in range(len(data))]
    damaged += [data[:k] + bytes([data[k] ^ 1]) + data[k + 1 :] for k in range(len(data))]
    damaged += [data + b" ", b"[]", b'{"outcome":{}}', b"\xff\xfe", b"null"]
    for wrong in damaged:
        with pytest.raises(ValueError, match=r"."):
            from_json(wrong)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("theta_deg", [1.0]),
        ("theta_deg", [1, 2]),
        ("theta_deg", [True, 1.0]),
        ("theta_deg", "ab"),
        ("dx_mm", None),
        ("failure", 3),
        ("more", 1.0),
    ],
)
def test_only_what_a_run_holds_is_read(name: str, value: object) -> None:
    """Even with the right checksum."""
    tree = json.loads(to_json(OUTCOME))
    tree["outcome"][name] = value
    with pytest.raises(ValueError, match=r"a run|no run"):
        from_json(seal(tree["schema"], tree["outcome"]))


def sector(middle: float, centre: np.ndarray, rotation: np.ndarray) -> Sector:
    return Sector(middle - 5.0, middle + 5.0, centre, rotation)


def test_rigid_motion_of_a_joint_that_turns_about_a_hinge() -> None:
    """Wherever the whole tube is: the axis at the cut moves about the hinge on the object side."""
    angle, hinge, cut = np.radians(35.0), np.array([0.0, 6.0, 30.0]), 31.0
    off = np.array([0.0, 0.02, 0.0])  # a section's centre as the mesh sees it
    starts = [np.array([0.0, 0.0, middle]) + off for middle in (12.0, 47.0)]
    rest = [sector(s[2], s, np.eye(3)) for s in starts]
    turn = rotation_matrix(np.array([angle, 0.0, 0.0]))  # about x: z goes to -y, to the object
    moved = hinge + turn @ (starts[1] - hinge)
    everywhere, away = rotation_matrix(np.array([0.4, 0.0, 0.0])), np.array([0.0, 3.0, -2.0])
    now = [
        sector(12.0, everywhere @ starts[0] + away, everywhere),
        sector(47.0, everywhere @ moved + away, everywhere @ turn),
    ]
    dx, dy = rigid_motion(tuple(rest), tuple(now), cut)
    arm = np.array([-hinge[1], cut - hinge[2]])  # (y, z) of the axis there, from the hinge
    c, s = np.cos(angle), np.sin(angle)
    y, z = c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]
    np.testing.assert_allclose([dx, dy], [z - arm[1], -(y - arm[0])], atol=1e-12)


@pytest.fixture(scope="module")
def done() -> Outcome:
    return run(TASK)


def test_a_run_gives_what_profiletool_joint_gives(done: Outcome) -> None:
    known = inflate(actuator_of(TASK), TASK.pressures_bar, LYING, DOWN)
    assert done.pressures_bar == TASK.pressures_bar
    assert done.failure is None
    theirs = [s.theta_deg[0] for s in known.verification.states]
    assert done.theta_deg[-1] == pytest.approx(theirs[-1], rel=1e-6)
    assert done.theta_deg == pytest.approx(theirs, abs=0.01)  # states in between are loose there
    for state, theta, dx, dy in zip(
        known.solution.states[1:], done.theta_deg, done.dx_mm, done.dy_mm, strict=True
    ):
        before, beyond = state.sectors
        turn = before.rotation.T @ beyond.rotation
        assert np.degrees(np.arctan2(turn[2, 1], turn[1, 1])) == pytest.approx(theta, rel=0.03)
        # The sector before the joint bends by hundredths of a degree only: without it, nearly so.
        point = beyond.centre + beyond.rotation @ (np.array([0.0, 0.0, 30.0 - 47.0]))
        assert point[2] - 30.0 == pytest.approx(dx, abs=0.05)
        assert -point[1] == pytest.approx(dy, abs=0.05)


def test_a_joint_bends_toward_the_object_and_gets_longer(done: Outcome) -> None:
    assert 0.0 < done.theta_deg[0] < done.theta_deg[1]
    assert 0.0 < done.dx_mm[0] < done.dx_mm[1]
    assert 0.0 < done.dy_mm[0] < done.dy_mm[1]


def test_whole_turns_do_not_depend_on_the_pressures_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    coarsely(monkeypatch)
    state = solve(actuator_of(TASK), [0.01], COARSE).states[-1]
    turns = np.linspace(0.0, np.radians(503.0), 2 * len(state.shape.z))[:, None] * [1.0, 0.0, 0.0]
    rotation = np.array([rotation_matrix(turn) for turn in turns])
    bent = replace(
        state,
        theta=np.array([np.radians(503.0 - 360.0)]),
        shape=replace(state.shape, rotation=rotation),
    )
    assert runs._theta_deg(bent) == pytest.approx(503.0)


@pytest.mark.parametrize("model", ["converged", "paper"])
@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"openF_mm": 60.0}, "beyond the plug"),
        ({"wall_mm": 10.0}, "does not make a tube"),
        ({"diameter_mm": -20.0}, "does not make a tube"),
        ({"diameter_mm": np.nan}, "finite"),
        ({"alpha_deg": 0.0}, "alpha_closed"),
    ],
)
def test_impossible_joints_are_told(change: dict[str, float], why: str, model: str) -> None:
    task = replace(TASK, **change, model=model)  # type: ignore[arg-type]
    assert len(key(task)) == 64
    found = run(task)
    assert replace(found, failure=None) == Outcome((), (), (), (), None)
    assert why in str(found.failure)


@pytest.mark.slow
def test_a_limit_point_is_told_and_the_states_before_it_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    coarsely(monkeypatch, Gauze(stiffness=0.05))  # hardly any: the tube balloons
    rubber = MooneyRivlin.from_poisson(0.13, 0.0, 0.46)
    found = run(replace(TASK, rubber=rubber, pressures_bar=(0.2, 1.0)))
    assert found.pressures_bar == (0.2,)
    assert len(found.theta_deg) == len(found.dx_mm) == len(found.dy_mm) == 1
    assert str(found.failure).startswith("limit point at 0.4")


def test_what_was_reached_before_it_did_not_converge_is_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    coarsely(monkeypatch)

    def stuck(actuator: Any, pressures: list[float], *rest: Any, **more: Any) -> Solution:
        raise NotConverged("", (), 0.026, solve(actuator, pressures[:2], *rest, **more))

    whole = run(replace(TASK, pressures_bar=(0.1, 0.2)))
    monkeypatch.setattr(runs, "solve", stuck)
    found = run(replace(TASK, pressures_bar=(0.1, 0.2, 0.3, 0.4, 0.5)))
    assert found == replace(whole, failure="not converged beyond 0.26 bar")
    assert found.pressures_bar == (0.1, 0.2)

    def never(*_: object, **__: object) -> Solution:
        raise NotConverged("", (), 0.0)

    monkeypatch.setattr(runs, "solve", never)
    assert run(TASK) == Outcome((), (), (), (), "not converged beyond 0.00 bar")


def test_a_bug_is_no_outcome(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> Solution:
        raise ZeroDivisionError

    monkeypatch.setattr(runs, "solve", broken)
    with pytest.raises(ZeroDivisionError):
        run(TASK)
