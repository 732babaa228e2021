"""The page in a browser: the whole way by pointer, as a user goes it."""

from __future__ import annotations

import math
import os
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
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


def joint_dragged(page: Page) -> None:
    """Drag a joint back where there is room: it goes the way of the pointer, in meshes."""
    rows = page.js(
        """[...document.getElementById('table').rows].map(row =>
        [...row.querySelectorAll('td')].slice(0, 2).map(cell => Number(cell.innerText)))"""
    )
    ends = [(centre - openF / 2, centre + openF / 2) for centre, openF in rows]
    room = [start - end for (_, end), (start, _) in pairwise(ends)]
    assert max(room) > 4.0
    way = 2.0 - max(room)
    k = room.index(max(room)) + 1
    per_px = float(page.js("1 / document.getElementById('stage').getScreenCTM().a"))
    page.click(f"[data-key=joint-{k}]")
    places = (page.place(f"[data-key={end}-{k}]") for end in ("start", "end"))
    dx, dy = (b - a for a, b in zip(*places, strict=True))
    pixels = way / per_px / math.hypot(dx, dy)
    centre = "Number(document.getElementById('centre').value)"
    before = float(page.js(centre))
    page.drag(f"[data-key=joint-{k}]", pixels * dx, pixels * dy)
    moved = float(page.js(centre)) - before
    assert moved == pytest.approx(way, abs=1.0)
    assert moved % 2.0 == pytest.approx(0.0, abs=0.02)
    assert moved != 0.0


def test_the_whole_way_by_pointer(browser: Browser, server: Server) -> None:
    page = Page(browser)
    browser.open(server.address)
    page.wait(FOUND)
    page.drag("[data-key=end-1]", 0.0, -150.0)
    page.wait(IDLE)
    end = float(page.js("document.querySelector('[data-field=end_pct]').value"))
    assert 60.0 < end < 90.0
    for name, value in (("refine", "no"), ("grip", "no"), ("tolerance_mm", "2")):  # it is quicker
        page.choose(name, value)
    page.wait(f"{IDLE} && {FOUND}")
    page.click("#design")
    page.wait(JOINTS)
    assert "INFEASIBLE" not in page.text("verdict")
    joint_dragged(page)
    page.wait(f"document.getElementById('commands').textContent.includes('made/2') && {IDLE}")
    page.click("#undo")
    page.wait("document.getElementById('undo').disabled")
    page.click("#redo")
    page.wait("!document.getElementById('undo').disabled")
    page.click("#tab-files")
    page.click("#export")
    page.wait("document.getElementById('exported').textContent !== ''")
    ours = server.work.parent / "bulb_design"
    assert page.text("exported") == f"Written: {ours}"
    for line in page.text("commands").splitlines():
        words = shlex.split(line)
        words = words[1:] if words[0] == "profiletool" else words
        done = subprocess.run(
            [sys.executable, "-m", "profiletool", *words],
            cwd=server.work, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True,
            text=True, check=False,
        )  # fmt: skip
        assert done.returncode in (0, 6), done.stderr
    theirs = server.work / "made" / "2"
    names = {path.name for path in ours.iterdir()}
    assert names == {path.name for path in theirs.iterdir()}
    assert {"design.json", "report.html", "template.pdf", "actuator.vtu"} <= names
    for name in names:
        assert (ours / name).read_bytes() == (theirs / name).read_bytes(), name
    base = server.address.rsplit("/", 2)[0]
    asked = [place for place in browser.asked if not place.startswith(("data:", "blob:"))]
    assert asked
    assert all(place.startswith(f"{base}/") for place in asked)
    assert browser.complaints == []


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


def test_what_a_killed_server_leaves(browser: Browser, server: Server, samples: Path) -> None:
    page = Page(browser)
    browser.open(server.address)
    page.wait(f"({JOINTS}) || ({FOUND})")
    if not page.js(JOINTS):  # where this test runs alone
        page.choose("verify", "no")
        page.wait(f"{IDLE} && {FOUND}")
        page.click("#design")
        page.wait(JOINTS)
        page.click("#tab-object")
        page.choose("verify", "yes")
        page.wait(f"{IDLE} && {FOUND}")
    versions = sorted(path.name for path in server.work.glob("*.json"))
    undone = page.js("document.getElementById('undo').disabled")
    page.click("#tab-object")
    page.wait(FOUND)
    page.click("#design")
    page.wait(f"!{IDLE}")
    page.click("#cancel")
    page.wait(IDLE)
    assert "stopped" in page.text("said")
    page.click("#design")
    page.wait(f"!{IDLE}")
    workers = server.workers
    assert workers
    server.end(signal.SIGKILL)
    page.wait("!document.getElementById('gone').hidden")
    assert "Nothing is lost" in page.text("gone")
    for number in workers:
        while Path(f"/proc/{number}").exists():
            time.sleep(0.05)
    assert sorted(path.name for path in server.work.glob("*.json")) == versions
    server.start(samples / "bulb.png")
    browser.open(server.address)
    page.wait(JOINTS)
    assert page.js("document.getElementById('undo').disabled") == undone
    second = subprocess.run(
        [sys.executable, "-m", "profiletool", "studio", "--no-browser", "--port",
         server.address.split(":")[2].split("/")[0]],
        cwd=server.work.parent, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True,
        text=True, check=False,
    )  # fmt: skip
    assert second.returncode == 1
    assert second.stderr.startswith("error: port ")
    assert second.stderr.count("\n") == 1
