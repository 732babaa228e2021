"""Campaigns on this machine: each run once and kept, whatever is killed."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from fem.material import PAPER_RUBBER
from profiletool.campaign import workers
from profiletool.campaign.runs import DIED, JOINT_RUN, Outcome, Task, key, run, to_json
from profiletool.campaign.store import Store
from profiletool.campaign.workers import run_all
from profiletool.errors import OutputError, UsageError
from tests.campaign import fake
from tests.campaign.processes import ROOT, alive, environment, until

JointStore = Store[Task, Outcome]
TASKS = [fake.task(n) for n in range(6)]
OUTCOMES = [fake.outcome(task) for task in TASKS]
kills = pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs SIGKILL")


@pytest.fixture
def calls(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the marks of all calls go."""
    folder = tmp_path / "calls"
    folder.mkdir()
    monkeypatch.setenv(fake.CALLS, str(folder))
    return folder


@pytest.fixture
def store(tmp_path: Path) -> JointStore:
    return Store(tmp_path / "store", fake.FAKE_RUN)


def files(store: JointStore) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in store.folder.glob("*.json")}


def as_files(tasks: list[Task]) -> dict[str, bytes]:
    return {f"{key(task)}.json": to_json(fake.outcome(task)) for task in tasks}


@pytest.mark.parametrize("count", [1, 2])
def test_in_order_each_once_and_none_that_is_kept(
    calls: Path, store: JointStore, count: int
) -> None:
    store.put(key(TASKS[4]), OUTCOMES[4])
    told: list[tuple[int, int]] = []
    tasks = [TASKS[5], TASKS[2], TASKS[4], TASKS[0], TASKS[2]]
    found = run_all(
        tasks, store, workers=count, progress=lambda *n: told.append(n)
    )  # fmt: skip
    assert found == [fake.outcome(task) for task in tasks]
    assert told[0] == (1, 5)
    assert told[-1] == (5, 5)
    assert [n for n, _ in told] == sorted(n for n, _ in told)
    assert len(told) == 4
    assert len(fake.calls(calls)) == 3
    assert files(store) == as_files([TASKS[n] for n in (0, 2, 4, 5)])
    again = run_all(tasks, store, workers=count, progress=lambda *n: told.append(n))
    assert again == found
    assert told[4:] == [(5, 5)]
    assert len(fake.calls(calls)) == 3


def test_the_longest_first(calls: Path, store: JointStore) -> None:
    order: list[Task] = []

    def listed(task: Task) -> Outcome:
        order.append(task)
        return fake.run(task)

    short = Task(4.0, 150.0, 20.0, 2.0, PAPER_RUBBER, (0.2,))
    longer = Task(4.0, 84.0, 20.0, 2.0, PAPER_RUBBER, (0.2,))
    long = Task(4.0, 150.0, 20.0, 2.0, PAPER_RUBBER, (0.2,), "paper")
    listing = Store(store.folder, replace(fake.FAKE_RUN, run=listed))
    run_all([short, longer, TASKS[1], long], listing, workers=1)
    assert order == [long, TASKS[1], longer, short]


def test_each_is_kept_as_soon_as_it_comes(calls: Path, store: JointStore) -> None:
    def kept(done: int, _: int) -> None:
        assert len(files(store)) == done

    run_all(TASKS, store, workers=2, progress=kept)


@pytest.mark.slow
def test_real_runs_are_the_same_bit_for_bit_on_processes(store: JointStore) -> None:
    tasks = [Task(o, 120.0, 12.0, 1.5, PAPER_RUBBER, (0.1,)) for o in (4.0, 6.0)]
    found = run_all(tasks, Store(store.folder, JOINT_RUN), workers=2)
    assert [to_json(f) for f in found] == [to_json(run(task)) for task in tasks]
    assert all(f.failure is None for f in found)


@pytest.mark.parametrize("count", [1, 2])
def test_a_bug_is_raised_and_what_was_finished_is_kept(
    calls: Path, store: JointStore, count: int
) -> None:
    last = fake.task(99, fake.BUGGY)
    with pytest.raises(ZeroDivisionError, match="a bug"):
        run_all([last, *TASKS], store, workers=count)
    assert len(fake.calls(calls, last)) == 1
    # One may still have been under way.
    assert len(files(store)) >= len(TASKS) - (count - 1)
    assert files(store).items() <= as_files(TASKS).items()


def test_a_full_disk_ends_it(
    calls: Path, store: JointStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match="No space left"):
        run_all(TASKS, store, workers=1)


def test_another_version_of_the_model_does_not_answer() -> None:
    kind = replace(JOINT_RUN, run=fake.outcome)
    assert workers._answer(kind, key(TASKS[0]), TASKS[0]) == OUTCOMES[0]
    with pytest.raises(UsageError, match="another version"):
        workers._answer(kind, key(TASKS[1]), TASKS[0])


def test_no_workers(store: JointStore) -> None:
    with pytest.raises(ValueError, match="1 or more"):
        run_all(TASKS, store, workers=0)


@kills
@pytest.mark.slow
def test_a_process_that_dies_loses_its_own_run_only(
    calls: Path, store: JointStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(fake.SECONDS, "0.1")
    once, always = fake.task(50, fake.DEADLY_ONCE), fake.task(51, fake.DEADLY)
    tasks = [always, *TASKS, once]
    found = run_all(tasks, store, workers=2)
    assert found == [DIED, *OUTCOMES, fake.outcome(once)]
    assert DIED.failure == "its process died"
    count = Counter(mark.name.split("-")[0] for mark in fake.calls(calls))
    assert count.pop(f"{always.openF_mm:g}") == 4
    assert count.pop(f"{once.openF_mm:g}") == 2
    assert set(count.values()) == {1}
    assert files(store) == as_files([*TASKS, once])


@kills
def test_a_process_that_dies_while_idle_loses_nothing(calls: Path, store: JointStore) -> None:
    quick, deadly = TASKS[1], fake.task(-1, fake.DEADLY_ONCE)

    def kill_idle(done: int, _: int) -> None:
        if done == 1:
            (ended,) = fake.calls(calls, suffix=".ended")
            os.kill(fake.pid_of(ended), signal.SIGKILL)

    found = run_all([quick, deadly], store, workers=2, progress=kill_idle)
    assert found == [fake.outcome(quick), fake.outcome(deadly)]
    assert len(working(calls)) == 3  # the second trial of the deadly one has a process of its own


def start(
    calls: Path, store: JointStore, seconds: float, count: int = 12
) -> subprocess.Popen[bytes]:
    """Start a campaign of two workers in a process of its own."""
    code = "from tests.campaign.fake import main; main()"
    # Python cleans up after a killed one, and says so, when the next may be under way.
    with (calls.parent / f"{len(all_said(calls))}.stderr").open("xb") as said:
        return subprocess.Popen(
            [sys.executable, "-c", code, str(store.folder), str(count), "2"],
            env=environment(**{fake.CALLS: str(calls), fake.SECONDS: str(seconds)}),
            cwd=ROOT,
            stderr=said,
        )


def all_said(calls: Path) -> list[Path]:
    return sorted(calls.parent.glob("*.stderr"))


def said(calls: Path) -> str:
    """What the last campaign and its workers said."""
    return all_said(calls)[-1].read_text()


def working(calls: Path) -> set[int]:
    return {fake.pid_of(mark) for mark in fake.calls(calls)}


@kills
@pytest.mark.slow
def test_a_campaign_killed_at_any_moment_goes_on(calls: Path, store: JointStore) -> None:
    tasks, chance = [fake.task(n) for n in range(12)], random.Random(1)
    for stop in (1, 4, 8):
        campaign = start(calls, store, 0.15)
        until(lambda: len(files(store)) >= stop)  # noqa: B023
        time.sleep(chance.uniform(0.0, 0.15))
        campaign.kill()
        campaign.wait()
        until(lambda: not any(alive(pid) for pid in working(calls)), 20.0)
        assert files(store).items() <= as_files(tasks).items()
    kept = {task for task in tasks if store.get(key(task)) is not None}
    before = {task: len(fake.calls(calls, task)) for task in tasks}
    campaign = start(calls, store, 0.0)
    assert campaign.wait(60.0) == 0
    assert said(calls) == ""
    assert files(store) == as_files(tasks)
    for task in tasks:
        assert len(fake.calls(calls, task)) - before[task] == (task not in kept)


@pytest.fixture
def campaign(calls: Path, store: JointStore) -> Iterator[subprocess.Popen[bytes]]:
    """A campaign whose runs take longer than anyone waits."""
    process = start(calls, store, 60.0)
    yield process
    process.kill()
    process.wait()


@kills
def test_an_interrupted_campaign_ends_at_once(
    campaign: subprocess.Popen[bytes], calls: Path, store: JointStore
) -> None:
    """As Ctrl-C does, every process hears of it; only the one that started the others ends."""
    until(lambda: len(fake.calls(calls)) == 2)
    for pid in working(calls):
        os.kill(pid, signal.SIGINT)
    time.sleep(0.3)
    assert campaign.poll() is None
    campaign.send_signal(signal.SIGINT)
    assert campaign.wait(20.0) != 0  # long before a run ends
    assert said(calls).rstrip().endswith("KeyboardInterrupt")
    assert said(calls).count("Traceback") == 1  # the workers say nothing
    assert not any(alive(pid) for pid in working(calls))
    assert len(fake.calls(calls)) == 2
