"""The worker: a process that does one job at a time, and that can be ended at any moment."""

from __future__ import annotations

import os
import queue
import signal
import threading
from collections.abc import Callable
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from profiletool.studio.form import in_words

Hear = Callable[[int, str, Any], None]
_PATIENCE_SECONDS = 5.0  # for a killed process to be gone


class Worker:
    """A process that waits for jobs, its modules loaded; where it is ended, a fresh one.

    Parameters
    ----------
    folder : Path
        The work folder.
    hear : callable
        Takes (ticket, what, value): "line" with a text, "share" with a number, "done" with a view,
        "failed" with a text. It is called in a thread of its own.
    patient : bool
        Whether a job that runs is done to its end, unheard, when others come; then the last one
        of those is done.
    """

    def __init__(self, folder: Path, hear: Hear, *, patient: bool = False) -> None:
        self._folder, self._hear, self._patient = folder, hear, patient
        self._ticket = 0
        self._busy = False
        self._lock = threading.Lock()
        self._process, self._line = self._started()

    def begin(self, job: Any) -> int:
        """Begin a job, and give its ticket; one that runs is ended before."""
        with self._lock:
            if self._busy and not self._patient:
                self._restart()
            self._ticket += 1
            self._busy = True
            self._line.send((self._ticket, job))
            return self._ticket

    def cancel(self) -> None:
        """End the job that runs, if any: its process is killed."""
        with self._lock:
            if self._busy:
                self._restart()

    def close(self) -> None:
        """End the process."""
        with self._lock:
            self._end()

    def _restart(self) -> None:
        self._end()
        self._process, self._line = self._started()

    def _end(self) -> None:
        self._busy = False
        self._process.kill()
        self._process.join(_PATIENCE_SECONDS)
        self._line.close()

    def _started(self) -> tuple[BaseProcess, Connection]:
        context = get_context("spawn")
        ours, theirs = context.Pipe()
        process = context.Process(target=_work, args=(str(self._folder), theirs), daemon=True)
        process.start()
        theirs.close()
        threading.Thread(target=self._listen, args=(process, ours), daemon=True).start()
        return process, ours

    def _listen(self, process: BaseProcess, line: Connection) -> None:
        """Pass on what a process says; where it died over a job, say so and take another one."""
        while True:
            try:
                ticket, what, value = line.recv()
            except (EOFError, OSError):
                break
            with self._lock:
                if process is not self._process or ticket != self._ticket or not self._busy:
                    continue
                self._busy = what not in ("done", "failed")
            self._hear(ticket, what, value)
        with self._lock:
            died = process is self._process and self._busy
            ticket = self._ticket
            if died:
                self._restart()
        if died:
            self._hear(ticket, "failed", "the process that worked on it died; try again")


def _work(folder: str, line: Connection) -> None:
    """Do jobs one by one, in the work folder, until the server is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the server
    os.chdir(folder)
    jobs: queue.Queue[tuple[int, Any]] = queue.Queue()
    threading.Thread(target=_take, args=(line, jobs), daemon=True).start()
    from profiletool.errors import ProfiletoolError
    from profiletool.studio.work import Bench

    bench = Bench()
    while True:
        ticket, job = jobs.get()
        while not jobs.empty():
            ticket, job = jobs.get()

        def tell(what: str, value: Any, ticket: int = ticket) -> None:
            line.send((ticket, what, value))

        try:
            view = bench.done(
                job,
                lambda text: tell("line", in_words(text)),
                lambda share: tell("share", share),
            )
            tell("done", view)
            if jobs.empty():
                bench.prepare()
        except ProfiletoolError as error:
            tell("failed", in_words(str(error)))
        except Exception as error:  # a fault of ours shall not end the studio
            tell("failed", f"a fault in profiletool ({type(error).__name__}: {error})")


def _take(line: Connection, jobs: queue.Queue[tuple[int, Any]]) -> None:
    while True:
        try:
            jobs.put(line.recv())
        except (EOFError, OSError):
            os._exit(0)  # the server is gone, whatever this process is at
