"""The report in a browser: it fits, asks for nothing, moves, and does without a script."""

from __future__ import annotations

import base64
from pathlib import Path

import numpy as np
import pytest

from profiletool.pipeline import Request, Result, run
from profiletool.report.film import Film, film_of
from profiletool.report.html import report_html
from profiletool.report.markup import MINUS
from profiletool.report.outputs import files_of
from tests.report.browser import NARROW, WIDE, Browser
from tests.report.dossiers import designed, unverified, verified, with_joints

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def result(samples: Path) -> Result:
    asked = Request(samples / "egg.png", joints=3, verify=True)
    return run(asked, lambda line: None)


@pytest.fixture(scope="module")
def page(result: Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("report") / "report.html"
    file.write_bytes(files_of(result)["report.html"])
    return file


@pytest.fixture(scope="module")
def film(result: Result) -> Film:
    assert result.check is not None
    assert result.check.run is not None
    assert result.design.feasible
    assert result.grip is not None
    return film_of(result.check.run.verification, result.design, result.grip)


@pytest.fixture(scope="module")
def wide_page(samples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Twelve joints and a name without a space: the widest tables and the longest line."""
    file = tmp_path_factory.mktemp("long") / ("a_name_that_does_not_end_" * 6 + ".csv")
    file.write_bytes((samples / "finger_rest.csv").read_bytes())
    dossier = verified(with_joints(unverified(designed(file)), 12))
    written = tmp_path_factory.mktemp("wide") / "report.html"
    written.write_bytes(report_html(dossier))
    return written


@pytest.mark.parametrize("width", [NARROW, WIDE])
@pytest.mark.parametrize("name", ["page", "wide_page"])
def test_the_page_fits(
    browser: Browser, request: pytest.FixtureRequest, name: str, width: int
) -> None:
    browser.open(request.getfixturevalue(name), width)
    assert browser.js("window.innerWidth") == width
    assert browser.js("document.documentElement.scrollWidth") <= width
    beyond = """[...document.querySelectorAll('body *')].filter(e => !e.closest('.scroll') &&
        !e.closest('svg') && e.getBoundingClientRect().right > innerWidth + 0.5).length"""
    assert browser.js(beyond) == 0
    assert browser.complaints == []


def test_it_asks_for_nothing(browser: Browser, page: Path) -> None:
    browser.open(page)
    browser.move(10)
    asked = [address for address in browser.asked if not address.startswith("data:")]
    assert asked == [page.as_uri()]
    assert browser.complaints == []


@pytest.mark.parametrize("name", ["page", "wide_page"])
def test_it_prints_on_paper(browser: Browser, request: pytest.FixtureRequest, name: str) -> None:
    browser.open(request.getfixturevalue(name), 688, media="print", dark=True)  # A4's width
    assert browser.js("document.documentElement.scrollWidth") <= 688
    for hidden in ("#controls", "nav"):
        style = f"getComputedStyle(document.querySelector('{hidden}')).display"
        assert browser.js(style) == "none"
    assert luminance(background(browser)) > 0.9  # light, whatever the screen is
    browser.move(0)
    printed = browser.command("Page.printToPDF", preferCSSPageSize=True)["data"]
    pdf = base64.b64decode(printed)
    assert pdf.startswith(b"%PDF")
    assert 4 <= pdf.count(b"/Type /Page\n") <= 14
    # Paper shows the tube under pressure, wherever the slider stood.
    assert browser.tube == final(browser)


def test_the_slider_moves_the_tube(browser: Browser, page: Path, film: Film) -> None:
    browser.open(page)
    static = browser.tube
    assert static == film.outline()
    substeps = int(browser.js("document.getElementById('slider').dataset.substeps"))
    assert browser.js("document.getElementById('controls').offsetHeight") > 0
    assert browser.js("document.getElementById('still').offsetHeight") == 0
    seen = set()
    for k in range(len(film.lines)):  # at FE's own pressures, what FE says
        browser.move(k * substeps)
        seen.add(browser.tube)
        assert browser.js("new Set([...document.querySelectorAll('.bar')].map("
                          "e => e.textContent)).size") == 1  # fmt: skip
        assert browser.bar == pytest.approx(film.pressure_bar[k], abs=0.0051)
        assert browser.theta == pytest.approx(film.theta_deg[k].tolist(), abs=0.051)
        facing, far = film.lines[k] / 100.0
        assert np.abs(corners(browser.tube) - np.concatenate([facing, far[::-1]])).max() < 1e-9
    assert len(seen) == len(film.lines)
    browser.move(0)
    assert browser.tube != static
    assert browser.theta == [0.0] * len(film.windows)
    browser.move(film.shown * substeps)
    assert browser.tube == static


def test_between_pressures_lines_keep_their_lengths(
    browser: Browser, page: Path, film: Film
) -> None:
    browser.open(page)
    substeps = int(browser.js("document.getElementById('slider').dataset.substeps"))
    for k in range(len(film.lines) - 1):
        browser.move(k * substeps + substeps // 2)
        between = corners(browser.tube)
        n = film.lines.shape[2]
        for line, ends in ((between[:n], film.lines[:, 0]), (between[n:], film.lines[:, 1, ::-1])):
            low, high = sorted(length(ends[k + i] / 100.0) for i in (0, 1))
            assert 0.999 * low <= length(line) <= 1.001 * high
        assert film.pressure_bar[k] < browser.bar < film.pressure_bar[k + 1]
        spans = zip(browser.theta, film.theta_deg[k], film.theta_deg[k + 1], strict=True)
        assert all(min(a, b) - 0.05 <= theta <= max(a, b) + 0.05 for theta, a, b in spans)


def test_joints_and_cuts_go_along(browser: Browser, page: Path) -> None:
    browser.open(page)
    shown = int(browser.js("document.getElementById('slider').value"))
    places = "[...document.querySelectorAll('[data-joint]')].map(e => e.getAttribute('transform'))"
    cuts = "[...document.querySelectorAll('[data-window]')].map(e => e.getAttribute('d'))"
    before = browser.js(places), browser.js(cuts)
    browser.move(0)
    assert all(a != b for a, b in zip(browser.js(places), before[0], strict=True))
    assert all(a != b for a, b in zip(browser.js(cuts), before[1], strict=True))
    browser.move(shown)
    assert (browser.js(places), browser.js(cuts)) == before


def test_the_button_inflates_and_nothing_starts_by_itself(browser: Browser, page: Path) -> None:
    browser.open(page)
    wait = (
        "new Promise(done => setTimeout(() => done(document.getElementById('tube')"
        ".getAttribute('d')), 400))"
    )
    static = browser.tube
    assert browser.js(wait) == static
    browser.js("document.getElementById('play').click()")
    assert browser.js("document.getElementById('play').textContent") == "Stop"
    assert browser.js(wait) != static
    browser.js("document.getElementById('play').click()")
    stopped = browser.tube
    assert browser.js(wait) == stopped
    assert browser.js("document.getElementById('play').textContent") == "Inflate"


def test_keys_move_the_slider(browser: Browser, page: Path) -> None:
    browser.open(page)
    before = browser.tube
    browser.driver.find_element("id", "slider").send_keys("\ue012")  # arrow to the left
    assert browser.tube != before
    said = browser.js("document.getElementById('slider').getAttribute('aria-valuetext')")
    assert said == f"{browser.bar:.2f} bar"


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("name", ["page", "wide_page"])
def test_text_stands_out(
    browser: Browser, request: pytest.FixtureRequest, name: str, dark: bool
) -> None:
    browser.open(request.getfixturevalue(name), dark=dark)
    light = luminance(background(browser))
    assert light < 0.05 if dark else light > 0.9
    found = browser.js(_TEXTS)
    assert len(found) > 100
    assert {kind for kind, _, _ in found} >= {"TD", "TH", "P", "A", "BUTTON", "text", "DT"}
    for kind, ink, ground in found:
        assert contrast(rgb(ink), rgb(ground)) >= 4.5, (kind, ink, ground)


def test_without_a_script_the_final_shape_is_there(
    browser: Browser, page: Path, film: Film
) -> None:
    browser.command("Emulation.setScriptExecutionDisabled", value=True)
    try:
        browser.open(page)
        path = browser.driver.find_element("id", "tube")
        assert path.get_dom_attribute("d") == film.outline()
        assert not browser.driver.find_element("id", "slider").is_displayed()
        assert not browser.driver.find_element("id", "play").is_displayed()
        said = browser.driver.find_element("css selector", ".readout").text
        for theta in np.round(film.theta_deg[film.shown], 4):
            assert f"{theta:.1f}°".replace("-", MINUS) in said
        assert browser.driver.find_element("id", "still").is_displayed()
    finally:
        browser.command("Emulation.setScriptExecutionDisabled", value=False)


# Every element with a text of its own that is seen, its colour, and what is behind it: the nearest
# background that is not clear. The drawings on the stage and the template have their own grounds.
_TEXTS = """[...document.querySelectorAll('body *')].filter(e =>
    [...e.childNodes].some(n => n.nodeType === 3 && n.data.trim()) && e.getClientRects().length &&
    !e.closest('.stage, .sheet, script, style, title, desc')).map(e => {
        const svg = e instanceof SVGElement;
        let at = e, ground = 'rgba(0, 0, 0, 0)';
        for (; at && ground === 'rgba(0, 0, 0, 0)'; at = at.parentElement)
            ground = getComputedStyle(at).backgroundColor;
        const style = getComputedStyle(e);
        return [e.tagName, svg ? style.fill : style.color, ground];
    })"""


def corners(path: str) -> np.ndarray:
    return np.array([[float(v) for v in p.split(",")] for p in path.strip("MZ").split(" ")])


def length(line: np.ndarray) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def final(browser: Browser) -> str:
    """The tube as it is shown first."""
    browser.move(int(browser.js("document.getElementById('slider').defaultValue")))
    return browser.tube


def background(browser: Browser) -> list[float]:
    return rgb(browser.js("getComputedStyle(document.body).backgroundColor"))


def rgb(colour: str) -> list[float]:
    return [float(v) for v in colour[colour.index("(") + 1 : -1].split(",")[:3]]


def luminance(colour: list[float]) -> float:
    """As WCAG defines it."""
    parts = [v / 255.0 for v in colour]
    red, green, blue = (v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def contrast(ink: list[float], ground: list[float]) -> float:
    dark, light = sorted((luminance(ink), luminance(ground)))
    return (light + 0.05) / (dark + 0.05)
