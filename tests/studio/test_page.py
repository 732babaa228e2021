"""The page in a browser: the whole way by pointer, as a user goes it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from tests.report.browser import NARROW, WIDE, Browser, started

pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[2]
_PATIENCE_SECONDS = 600.0  # with finite elements on a busy machine


@dataclass
class Server:
    """`profiletool studio` as a process of its own."""

    work: Path
    process: subprocess.Popen[str] = field(init=False)
    address: str = field(init=False)

    def start(self, *words: object) -> None:
        command = [sys.executable, "-m", "profiletool", "studio", *map(str, words), "--port", "0"]
        command += ["--no-browser", "--out", str(self.work)]
        settings = os.environ | {"PYTHONPATH": str(ROOT)}
        self.process = subprocess.Popen(
            command, stderr=subprocess.PIPE, text=True, env=settings, cwd=self.work.parent
        )
        assert self.process.stderr is not None
        lines = iter(self.process.stderr.readline, "")
        told = next(line for line in lines if "http://" in line)
        self.address = told[told.index("http://") :].strip()

    def end(self, how: signal.Signals) -> None:
        self.process.send_signal(how)
        self.process.communicate()

    @property
    def workers(self) -> list[int]:
        """Numbers of the processes that it started."""
        found = subprocess.run(
            ["ps", "-o", "pid=", "--ppid", str(self.process.pid)],
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        return [int(number) for number in found.stdout.split()]


@dataclass(frozen=True)
class Page:
    """The page, and a pointer on it."""

    browser: Browser

    def js(self, expression: str, *arguments: object) -> Any:
        return self.browser.js(expression, *arguments)

    def text(self, name: str) -> str:
        return str(self.js("document.getElementById(arguments[0]).innerText", name))

    def wait(self, expression: str) -> None:
        end = time.monotonic() + _PATIENCE_SECONDS
        while not self.js(expression):
            assert time.monotonic() < end, (expression, self.text("said"))
            time.sleep(0.1)

    def place(self, selector: str) -> tuple[float, float]:
        found = self.js(
            """(e => { e.scrollIntoView({block: 'nearest'}); const r = e.getBoundingClientRect();
            return [r.x + r.width / 2, r.y + r.height / 2]; })(document.querySelector(arguments[0]))
            """,
            selector,
        )
        return float(found[0]), float(found[1])

    def mouse(self, kind: str, x: float, y: float) -> None:
        self.browser.command(
            "Input.dispatchMouseEvent", type=f"mouse{kind}", x=x, y=y, button="left",
            buttons=int(kind != "Released"), clickCount=1,
        )  # fmt: skip

    def click(self, selector: str) -> None:
        x, y = self.place(selector)
        self.mouse("Pressed", x, y)
        self.mouse("Released", x, y)

    def drag(self, selector: str, dx: float, dy: float) -> None:
        x, y = self.place(selector)
        self.mouse("Pressed", x, y)
        for share in (0.25, 0.5, 0.75, 1.0):
            self.mouse("Moved", x + share * dx, y + share * dy)
        self.mouse("Released", x + dx, y + dy)

    def choose(self, name: str, value: str) -> None:
        self.js(
            """(e => { e.closest('details').open = true; e.value = arguments[1];
            e.dispatchEvent(new Event('change')); })(
            document.querySelector(`[data-field=${arguments[0]}]`))""".replace(
                "arguments[1]", repr(value)
            ),
            name,
        )


IDLE = "document.getElementById('work').hidden"
FOUND = "document.querySelector('[data-key=end-1]') !== null"
JOINTS = "document.querySelector('[data-key=joint-0]') !== null && !joints.hidden"


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with started(tmp_path_factory.mktemp("chromium")) as ours:
        yield ours


@pytest.fixture(scope="module")
def server(samples: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    ours = Server(tmp_path_factory.mktemp("studio") / "work")
    ours.start(samples / "bulb.png")
    yield ours
    ours.end(signal.SIGINT)


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width", [NARROW, WIDE])
def test_the_page_fits(browser: Browser, server: Server, width: int, dark: bool) -> None:
    page = Page(browser)
    browser.open(server.address, width, dark=dark)
    page.wait(f"{JOINTS} || {FOUND}")
    for tab in ("object", "joints", "files"):
        page.click(f"#tab-{tab}")
        assert page.js("document.documentElement.scrollWidth") <= width
        beyond = """[...document.querySelectorAll('body *')].filter(e => !e.closest('.scroll') &&
            !e.closest('svg') && e.getBoundingClientRect().right > innerWidth + 0.5).length"""
        assert page.js(beyond) == 0
        nameless = """[...document.querySelectorAll('button, input, select, a, [role=slider]')]
            .filter(e => e.getClientRects().length && !(e.innerText || e.labels?.length ||
            e.getAttribute('aria-label'))).map(e => e.outerHTML)"""
        assert page.js(nameless) == []
        small = """[...document.querySelectorAll('button, input, select, summary')]
            .filter(e => e.offsetWidth && (e.offsetWidth < 20 || e.offsetHeight < 20))
            .map(e => e.outerHTML)"""
        assert page.js(small) == []
    assert browser.complaints == []
