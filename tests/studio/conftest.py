"""A studio without a process of its own: its jobs are done when a test says so."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import pytest

from profiletool.errors import ProfiletoolError
from profiletool.studio import session as sessions
from profiletool.studio import work
from profiletool.studio.app import app_of
from profiletool.studio.job import Job
from profiletool.studio.session import Session

TOKEN = "a-token"
ADDRESS = "http://127.0.0.1:8741"


@dataclass
class Worker:
    """In place of the process: jobs wait until `work` does the last one."""

    folder: Path
    hear: Callable[[int, str, Any], None]
    jobs: list[Job] = field(default_factory=list)
    cancelled: int = 0
    bench: work.Bench = field(default_factory=work.Bench)

    def begin(self, job: Job) -> int:
        self.jobs.append(job)
        return len(self.jobs)

    def cancel(self) -> None:
        self.cancelled += 1

    def close(self) -> None:
        pass

    def work(self) -> None:
        ticket = len(self.jobs)
        try:
            view = self.bench.done(
                self.jobs[-1],
                lambda line: self.hear(ticket, "line", line),
                lambda share: self.hear(ticket, "share", share),
            )
        except ProfiletoolError as error:
            self.hear(ticket, "failed", str(error))
        else:
            self.hear(ticket, "done", view)


@dataclass(frozen=True)
class Client:
    """Asks the application without a socket; what it raises is raised here."""

    app: Any

    def request(self, method: str, place: str, **words: Any) -> httpx.Response:
        async def asked() -> httpx.Response:
            transport = httpx.ASGITransport(app=self.app)
            async with httpx.AsyncClient(transport=transport, base_url=ADDRESS) as client:
                return await client.request(method, place, **words)

        return asyncio.run(asked())

    def get(self, place: str, **words: Any) -> httpx.Response:
        return self.request("GET", place, **words)

    def post(self, place: str, **words: Any) -> httpx.Response:
        return self.request("POST", place, **words)


@dataclass(frozen=True)
class Studio:
    """A session, its worker, and a client that knows the address."""

    session: Session
    worker: Worker
    client: Client

    def get(self, place: str, **words: Any) -> httpx.Response:
        return self.client.get(f"/{TOKEN}/{place}", **words)

    def post(self, place: str, tree: object) -> httpx.Response:
        return self.client.post(f"/{TOKEN}/{place}", json=tree)

    def put(self, file: Path) -> httpx.Response:
        return self.client.post(f"/{TOKEN}/put/{file.name}", content=file.read_bytes())

    @property
    def state(self) -> dict[str, Any]:
        answer = self.get("state")
        assert answer.status_code == 200
        tree: dict[str, Any] = answer.json()
        return tree


@pytest.fixture
def studio(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Studio]:
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)  # as the worker
    yield from opened(folder, monkeypatch)


def opened(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Studio]:
    made: list[Worker] = []

    def worker(
        place: Path, hear: Callable[[int, str, Any], None], *, patient: bool = False
    ) -> Worker:
        made.append(Worker(place, hear))
        return made[-1]

    monkeypatch.setattr(sessions, "Worker", worker)
    with Session(folder) as session:
        yield Studio(session, made[0], Client(app_of(session, TOKEN)))
