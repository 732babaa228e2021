"""The campaign engine: many runs in this process, on this machine's cores, or on a cluster."""

from __future__ import annotations

import contextlib
import importlib
import os
import pickle
import signal
import threading
from asyncio import CancelledError
from collections import Counter, deque
from collections.abc import Callable, Generator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

from profiletool.campaign.kind import OutcomeT, RunKind, TaskT
from profiletool.campaign.store import Store
from profiletool.errors import ProfiletoolError, UsageError

Keyed = tuple[str, TaskT]
# Outcomes as they come, under their keys; None where the process died over it again and again.
Finished = Generator[tuple[str, OutcomeT | None]]

AGAIN = 3  # times that a run is begun again whose process died
_CONNECT_SECONDS = 10.0


def run_all(
    tasks: Sequence[TaskT],
    store: Store[TaskT, OutcomeT],
    *,
    workers: int,
    scheduler: str | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> list[OutcomeT]:
    """Run tasks that the store does not hold yet; each outcome is kept as soon as it comes.

    Parameters
    ----------
    tasks : sequence
        Equal ones are run once.
    store : Store
        Of the tasks' kind.
    workers : int
        Processes, one thread each; 1 runs in this one. A cluster has its own.
    scheduler : str, optional
        Address of a dask.distributed scheduler to run on instead, tcp://HOST:PORT.
    progress : callable, optional
        Takes how many tasks are done, those found in the store too, and how many there are.

    Returns
    -------
    list
        Outcomes in the order of the tasks. A run whose process died at every trial is a failure
        that is not kept.

    Raises
    ------
    UsageError
        When there is no such scheduler, or its workers have another profiletool.
    OutputError
        When an outcome cannot be kept.
    """
    if workers < 1:
        raise ValueError(f"workers must be 1 or more, not {workers}")
    keys = [store.kind.key(task) for task in tasks]
    store.sweep()
    outcomes = {name: kept for name in set(keys) if (kept := store.get(name)) is not None}
    missing = {k: task for k, task in zip(keys, tasks, strict=True) if k not in outcomes}
    _report(progress, keys, outcomes)
    finished = _finished(missing, store.kind, workers, scheduler)
    with contextlib.closing(finished):
        for name, outcome in finished:
            if outcome is not None:
                store.put(name, outcome)
            outcomes[name] = store.kind.died(missing[name]) if outcome is None else outcome
            _report(progress, keys, outcomes)
    return [outcomes[name] for name in keys]


def _report(
    progress: Callable[[int, int], None] | None,
    keys: Sequence[str],
    outcomes: Mapping[str, OutcomeT],
) -> None:
    if progress is not None:
        progress(sum(name in outcomes for name in keys), len(keys))


def _finished(
    missing: Mapping[str, TaskT],
    kind: RunKind[TaskT, OutcomeT],
    workers: int,
    scheduler: str | None,
) -> Finished[OutcomeT]:
    """Run tasks, the longest first."""
    left = sorted(missing.items(), key=lambda keyed: kind.order(keyed[1]))
    if not left:
        return
    if scheduler is not None:
        yield from _on_cluster(left, scheduler, kind)
    elif workers == 1:
        for name, task in left:
            yield name, kind.run(task)
    else:
        yield from _on_processes(left, workers, kind)


def _on_processes(
    left: list[Keyed[TaskT]], workers: int, kind: RunKind[TaskT, OutcomeT]
) -> Finished[OutcomeT]:
    """Run on processes, each a pool of its own, so that one that dies takes only its own run."""
    context = get_context("spawn")
    # All processes end as soon as the other end of their leash is let go of, or this one dies.
    leash, hand = context.Pipe(duplex=False)
    waiting, deaths = deque(left), Counter[str]()
    idle: list[ProcessPoolExecutor] = []
    busy: dict[Future[OutcomeT], tuple[ProcessPoolExecutor, Keyed[TaskT]]] = {}
    try:
        while waiting or busy:
            while waiting and len(busy) < workers:
                pool = idle.pop() if idle else ProcessPoolExecutor(1, context, _obey, (leash,))
                name, task = waiting[0]
                try:
                    future = pool.submit(_answer, kind, name, task)
                except BrokenProcessPool:  # it died while it had nothing to do
                    pool.shutdown(wait=False)
                    continue
                busy[future] = pool, waiting.popleft()
            ended, _ = wait(busy, return_when=FIRST_COMPLETED)
            # A bug in one run shall not cost the others that have just ended.
            for future in sorted(ended, key=lambda f: f.exception() is not None):
                pool, keyed = busy.pop(future)
                try:
                    outcome = future.result()
                except BrokenProcessPool:
                    pool.shutdown(wait=False)
                    deaths[keyed[0]] += 1
                    if deaths[keyed[0]] > AGAIN:
                        yield keyed[0], None
                    else:
                        waiting.append(keyed)  # last: there may be more memory by then
                    continue
                idle.append(pool)
                yield keyed[0], outcome
    finally:
        hand.close()
        for pool in (*idle, *(pool for pool, _ in busy.values())):
            pool.shutdown(cancel_futures=True)
        leash.close()


def _obey(leash: Connection) -> None:
    """Make a process end with the one that started it, which alone hears of Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(leash,), daemon=True).start()


def _end_with(leash: Connection) -> None:
    with contextlib.suppress(EOFError, OSError):
        leash.recv_bytes()
    os._exit(1)


def _answer(kind: RunKind[TaskT, OutcomeT], name: str, task: TaskT) -> OutcomeT:
    """Run a task, elsewhere, if the model there is the one whose answer was asked for."""
    if kind.key(task) != name:
        raise UsageError(
            "a worker has another version of the model; install the same profiletool everywhere"
        )
    return kind.run(task)


def _far(kind: RunKind[TaskT, OutcomeT], name: str, task: TaskT) -> bytes:
    return kind.write(_answer(kind, name, task))


def _on_cluster(
    left: list[Keyed[TaskT]], address: str, kind: RunKind[TaskT, OutcomeT]
) -> Finished[OutcomeT]:
    """Run on a cluster, which begins again by itself what its workers lose."""

    def answer(asked: bytes) -> bytes:
        # Sent whole as it refers to nothing here. By its name it would end, not fail, a worker
        # without this module; and so the scheduler needs no such module either.
        import pickle

        from profiletool.campaign.workers import _far

        return _far(*pickle.loads(asked))

    distributed = _dask()
    with contextlib.closing(_client(distributed, address)) as client:
        futures = {
            client.submit(
                answer,
                pickle.dumps((kind, name, task)),
                key=f"profiletool-{name}",
                pure=True,
                retries=AGAIN,
            ): name
            for name, task in left
        }
        for future in distributed.as_completed(futures, loop=client.loop):
            try:
                told = future.result()
            except (Exception, CancelledError) as error:
                if future.status != "error":
                    raise ProfiletoolError(
                        f"the scheduler at {address} is gone; what was finished is kept, run again"
                    ) from error
                if isinstance(error, ModuleNotFoundError):
                    raise UsageError(
                        f"a worker says: {error}; install the same profiletool everywhere"
                    ) from error
                if not isinstance(error, distributed.KilledWorker):
                    raise
                told = None
            name = futures.pop(future)
            future.release()  # else what a killed worker has long handed over is run again
            yield name, None if told is None else kind.read(told)


def _dask() -> Any:
    try:
        return importlib.import_module("distributed")
    except ModuleNotFoundError as error:
        raise UsageError(
            "`scheduler` needs dask.distributed; install profiletool[cluster]"
        ) from error


def _client(distributed: Any, address: str) -> Any:
    try:
        return distributed.Client(address, timeout=_CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UsageError(
            f"no dask scheduler answers at {address}; start one there or leave out `scheduler`"
        ) from error
