"""Campaigns on a dask.distributed cluster of this machine's processes."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fem.material import PAPER_RUBBER
from profiletool.campaign.runs import DIED, JOINT_RUN, Task, key, run, to_json
from profiletool.campaign.store import Store
from profiletool.campaign.workers import run_all
from profiletool.errors import ProfiletoolError, UsageError
from tests.campaign import fake
from tests.campaign.processes import environment, until

TASKS = [fake.task(n) for n in range(8)]
Start = Callable[..., "subprocess.Popen[bytes]"]


def test_without_dask(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"install profiletool\[cluster\]"):
        run_all(TASKS, Store(tmp_path, fake.FAKE_RUN), workers=1, scheduler="tcp://127.0.0.1:1")


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def calls(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the marks of all calls go."""
    folder = tmp_path / "calls"
    folder.mkdir()
    monkeypatch.setenv(fake.CALLS, str(folder))
    monkeypatch.setenv(fake.SECONDS, "0.1")
    return folder


@contextlib.contextmanager
def starter(folder: Path) -> Iterator[Start]:
    """Start dask commands in processes that all end with the block."""
    started: list[subprocess.Popen[bytes]] = []

    def begin(command: str, *more: str, **variables: str) -> subprocess.Popen[bytes]:
        with (folder / f"{len(started)}.log").open("wb") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.dask_{command}", "--no-dashboard", *more],
                env=environment(**variables), cwd=folder, stdout=log, stderr=log,
            )  # fmt: skip
        started.append(process)
        return process

    try:
        yield begin
    finally:
        for process in reversed(started):
            process.kill()
            process.wait()


@pytest.fixture
def start(tmp_path: Path, calls: Path) -> Iterator[Start]:
    with starter(tmp_path) as begin:
        yield begin


def start_scheduler(start: Start, **variables: str) -> tuple[subprocess.Popen[bytes], str]:
    """Start a scheduler that knows nothing of this repository's tests."""
    pytest.importorskip("distributed")
    port = free_port()
    options = "--host", "127.0.0.1", "--port", str(port)
    process = start("scheduler", *options, PYTHONPATH="", **variables)

    def listens() -> bool:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1.0):
            return True
        return False

    until(listens)
    return process, f"tcp://127.0.0.1:{port}"


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with starter(tmp_path_factory.mktemp("scheduler")) as begin:
        yield start_scheduler(begin)[1]


def worker(start: Start, scheduler: str, **variables: str) -> subprocess.Popen[bytes]:
    options = "--nthreads", "1", "--no-nanny", "--host", "127.0.0.1"
    return start("worker", scheduler, *options, **variables)


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_its_own_run_only(
    scheduler: str, start: Start, calls: Path, tmp_path: Path
) -> None:
    # Some runs end, then none until a worker is killed, however late this process sees it.
    workers = [worker(start, scheduler, **{fake.HELD_AFTER: "3"}) for _ in range(2)]
    killed: list[int] = []
    kept: list[Task] = []
    store = Store(tmp_path / "store", fake.FAKE_RUN)

    def under_way() -> bool:
        """Whether a worker that has handed a run over is at the next one."""
        kept[:] = [task for task in TASKS if store.get(key(task)) is not None]
        busy = {fake.pid_of(mark) for mark in fake.calls(calls, suffix=".begun")}
        ended = {fake.pid_of(mark) for task in kept for mark in fake.calls(calls, task)}
        killed.extend(list(busy & ended)[:1])
        return bool(killed)

    def kill(done: int, _: int) -> None:
        assert len(list(store.folder.glob("*.json"))) == done
        if done >= 2 and not killed:
            until(under_way)
            os.kill(killed[0], signal.SIGKILL)
            fake.let_go(calls)

    found = run_all(TASKS, store, workers=1, scheduler=scheduler, progress=kill)
    assert killed[0] in {process.pid for process in workers}
    assert [to_json(f) for f in found] == [to_json(fake.outcome(task)) for task in TASKS]
    # What the killed one had under way was begun again, and what it had not handed over yet.
    count = Counter(mark.name.split("-")[0] for mark in fake.calls(calls))
    twice = [task for task in TASKS if count[f"{task.openF_mm:g}"] > 1]
    assert len(kept) >= 2
    assert not set(twice) & set(kept)
    for task in twice:
        assert killed[0] in {fake.pid_of(mark) for mark in fake.calls(calls, task)}
    assert sum(count.values()) == len(TASKS) + len(twice)
    assert len(fake.calls(calls, suffix=".begun")) <= 1
    assert all(store.get(key(task)) == fake.outcome(task) for task in TASKS)

    # The same model answers bit for bit the same there.
    real = [Task(6.0, 120.0, 12.0, 1.5, PAPER_RUBBER, (0.1,))]
    joints = Store(store.folder, JOINT_RUN)
    there = run_all(real, joints, workers=1, scheduler=scheduler)
    assert [to_json(f) for f in there] == [to_json(run(task)) for task in real]


@pytest.mark.slow
def test_a_run_that_kills_every_worker_is_a_failure(
    start: Start, calls: Path, tmp_path: Path
) -> None:
    _, scheduler = start_scheduler(start, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0")
    for _ in range(2):
        worker(start, scheduler)
    tasks, store = [*TASKS[:2], fake.task(9, fake.DEADLY)], Store(tmp_path / "store", fake.FAKE_RUN)
    found = run_all(tasks, store, workers=1, scheduler=scheduler)
    assert found == [*(fake.outcome(task) for task in TASKS[:2]), DIED]
    assert store.get(key(tasks[-1])) is None


def test_a_bug_is_raised(scheduler: str, start: Start, calls: Path, tmp_path: Path) -> None:
    worker(start, scheduler)
    with pytest.raises(ZeroDivisionError, match="a bug"):
        run_all(
            [fake.task(0, fake.BUGGY)],
            Store(tmp_path / "store", fake.FAKE_RUN),
            workers=1,
            scheduler=scheduler,
        )


def test_a_worker_without_what_it_takes_says_so_and_lives_on(
    scheduler: str, start: Start, tmp_path: Path
) -> None:
    there = worker(start, scheduler, PYTHONPATH="")
    with pytest.raises(UsageError, match=r"No module named .*install the same profiletool"):
        run_all(TASKS, Store(tmp_path, fake.FAKE_RUN), workers=1, scheduler=scheduler)
    assert there.poll() is None


@pytest.mark.slow
def test_a_scheduler_that_goes_away(start: Start, calls: Path, tmp_path: Path) -> None:
    scheduler, address = start_scheduler(start)
    worker(start, address, **{fake.HELD_AFTER: "2"})  # some are always left to lose
    store = Store(tmp_path / "store", fake.FAKE_RUN)

    def kill(done: int, _: int) -> None:
        if done == 1:
            scheduler.kill()

    with pytest.raises(ProfiletoolError, match="is gone"):
        run_all(TASKS, store, workers=1, scheduler=address, progress=kill)
    assert len(list(store.folder.glob("*.json"))) >= 1


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:{}", "nonsense", "tcp://127.0.0.1"])
def test_no_scheduler_there(tmp_path: Path, address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("profiletool.campaign.workers._CONNECT_SECONDS", 0.5)
    with pytest.raises(UsageError, match="no dask scheduler answers"):
        run_all(
            TASKS, Store(tmp_path, fake.FAKE_RUN), workers=1, scheduler=address.format(free_port())
        )


def test_what_is_kept_needs_no_scheduler(tmp_path: Path) -> None:
    store = Store(tmp_path, fake.FAKE_RUN)
    store.put(key(TASKS[0]), fake.outcome(TASKS[0]))
    found = run_all(TASKS[:1], store, workers=1, scheduler="tcp://127.0.0.1:1")
    assert found == [fake.outcome(TASKS[0])]
