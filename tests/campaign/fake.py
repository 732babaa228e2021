"""Runs that cost nothing but time and leave a mark of every call in a folder."""

from __future__ import annotations

import math
import os
import signal
import sys
import time
from dataclasses import replace
from pathlib import Path
from uuid import uuid4

from fem.material import PAPER_RUBBER
from profiletool.campaign.runs import JOINT_RUN, Outcome, Task
from profiletool.campaign.store import Store
from profiletool.campaign.workers import run_all
from tests.campaign.processes import until

CALLS, SECONDS = "TEST_CALLS", "TEST_SECONDS"
HELD_AFTER = "TEST_HELD_AFTER"  # a run that begins when so many have ended waits for let_go()
DEADLY_ONCE, DEADLY, BUGGY = 301.0, 302.0, 303.0  # alpha of tasks that go wrong

_GO = "go"


def let_go(folder: Path) -> None:
    """Let runs that are held go on."""
    Path(folder, _GO).touch()


def task(number: int, alpha: float = 90.0) -> Task:
    """One of any number of tasks; the first ones are the longest."""
    return Task(1000.0 - number, alpha, 20.0, 2.0, PAPER_RUBBER, (0.2, 0.4, 0.6))


def outcome(task: Task) -> Outcome:
    """Numbers that need all their digits."""
    values = tuple(math.sin(task.openF_mm * p) / 3.0 for p in task.pressures_bar)
    failure = None if task.openF_mm % 3.0 else "limit point at 0.70 bar"
    return Outcome(task.pressures_bar, values, values, values, failure)


def run(task: Task) -> Outcome:
    name = f"{task.openF_mm:g}-{os.getpid()}-{uuid4().hex}"
    mark = Path(os.environ[CALLS], f"{name}.begun")
    mark.touch()
    if task.alpha_deg == BUGGY:
        raise ZeroDivisionError("a bug")
    if len(calls(mark.parent, suffix=".ended")) >= float(os.environ.get(HELD_AFTER, "inf")):
        until(Path(mark.parent, _GO).exists)
    time.sleep(float(os.environ.get(SECONDS, "0.02")))
    first = len(calls(mark.parent, task)) == 1
    if task.alpha_deg == DEADLY_ONCE and first:
        until(lambda: calls(mark.parent, suffix=".ended"))  # something else first
        time.sleep(0.6)
    if task.alpha_deg == DEADLY or (task.alpha_deg == DEADLY_ONCE and first):
        os.kill(os.getpid(), signal.SIGKILL)
    mark.rename(mark.with_suffix(".ended"))
    return outcome(task)


FAKE_RUN = replace(JOINT_RUN, run=run)


def calls(folder: Path, task: Task | None = None, suffix: str = ".*") -> list[Path]:
    """Marks of the calls so far, of one task or of all."""
    name = "*" if task is None else f"{task.openF_mm:g}-*"
    return list(folder.glob(f"{name}{suffix}"))


def pid_of(mark: Path) -> int:
    return int(mark.name.split("-")[1])


def main() -> None:
    """Run a campaign: the store's folder, tasks, workers."""
    # A shell that runs the tests in its background has switched Ctrl-C off for all below it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    folder, count, workers = sys.argv[1:]
    tasks = [task(n) for n in range(int(count))]
    found = run_all(tasks, Store(Path(folder), FAKE_RUN), workers=int(workers))
    assert found == [outcome(t) for t in tasks]
