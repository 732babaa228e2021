"""The film of a measurement: all pictures on one page, and a script that shows one at a time."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from profiletool.files.design_json import load_design
from profiletool.files.formula import named_formula
from profiletool.records.bench import Angle, Seen
from profiletool.records.picture import Picture
from profiletool.report.bench import BenchOutput, bench_output
from profiletool.report.bench_film import bench_film
from profiletool.report.bench_page import bench_html
from profiletool.verify.predicted import predicted_by_response
from tests.report.browser import Browser

BARS = (0.3, 0.6, 0.9)
LINES = np.array([[[0.0, 0.0], [40.0, 10.0]], [[0.0, 20.0], [40.0, 30.0]]])


def output_of(samples: Path, rgb: Callable[[int], np.ndarray]) -> BenchOutput:
    design = load_design(samples / "paper_bulb.json")
    count = len(design.joints)
    angles = (Angle(-20.0, 0.2, "measured"), *[Angle(np.nan, np.nan, "lost")] * (count - 1))
    ends = np.zeros((count + 1, 2, 2))
    seen = tuple(
        Seen(f"{bar}<.jpg", bar, angles, LINES, LINES + 3.0, LINES[0], ends, ends[:, 0], 0.1, 0.2)
        for bar in BARS
    )
    predicted = predicted_by_response(design, 0.9)
    return bench_output(
        design, seen, predicted, "response", named_formula(design.formula.name),
        lambda k: Picture(rgb(k), None, None, "JPEG"),
    )  # fmt: skip


def plain(k: int) -> np.ndarray:
    return np.full((60, 100, 3), 50 * k, np.uint8)


def test_every_picture_with_its_lines(samples: Path) -> None:
    film = bench_film(output_of(samples, plain))
    assert film.count('class="shot"') == film.count("data:image/jpeg") == len(BARS)
    assert re.findall(r'data-bar="([^"]*)"', film) == [
        f"{bar}&lt;.jpg, {bar:.2f} bar, 5 angles lost" for bar in BARS
    ]
    assert film.count('viewBox="0 0 100 60"') == len(BARS)
    # Centres of pixels are at halves in the drawing.
    assert 'd="M0.5,0.5 40.5,10.5"' in film
    assert 'd="M3.5,3.5 43.5,13.5"' in film
    assert "1: \N{MINUS SIGN}20.0°" in film


def test_pictures_shrink_until_the_page_is_small(samples: Path) -> None:
    rng = np.random.default_rng(0)
    rgb = rng.integers(0, 256, (1200, 1000, 3)).astype(np.uint8)
    film = bench_film(output_of(samples, lambda _: np.repeat(rgb, 2, axis=1)))
    assert len(film) < 2_200_000
    (width, height), *others = re.findall(r'viewBox="0 0 (\d+) (\d+)"', film)
    assert others == [(width, height)] * 2
    assert 160 <= int(width) <= 900
    assert int(width) / int(height) == pytest.approx(2000 / 1200, rel=0.01)
    # The lines shrink with them.
    x = 0.001 * int(width) / 2.0 * 40.5
    assert f"M{0.5 * int(width) / 2000:.1f}," in film
    assert f" {x:.1f}," in film


@pytest.mark.slow
def test_one_picture_at_a_time(samples: Path, tmp_path: Path, browser: Browser) -> None:
    page = tmp_path / "report.html"
    page.write_bytes(bench_html(output_of(samples, plain)))
    browser.open(page)
    shown = "[...document.querySelectorAll('.shot')].map(e => e.getClientRects().length > 0)"
    dashed = "document.querySelectorAll('.predicted')[1].getClientRects().length > 0"
    assert browser.js(shown) == [False, False, True]
    browser.js("document.getElementById('back').click()")
    assert browser.js(shown) == [False, True, False]
    assert browser.js(dashed)
    browser.js("document.querySelector('[value=predicted]').click()")
    assert not browser.js(dashed)
    assert browser.complaints == []
    asked = [address for address in browser.asked if not address.startswith("data:")]
    assert asked == [page.as_uri()]


@pytest.mark.slow
def test_without_a_script_all_are_there(samples: Path, tmp_path: Path, browser: Browser) -> None:
    page = tmp_path / "report.html"
    page.write_bytes(bench_html(output_of(samples, plain)))
    browser.command("Emulation.setScriptExecutionDisabled", value=True)
    try:
        browser.open(page)
        shots = browser.driver.find_elements("css selector", ".shot")
        assert [shot.is_displayed() for shot in shots] == [True] * len(BARS)
        assert not browser.driver.find_element("id", "picture").is_displayed()
    finally:
        browser.command("Emulation.setScriptExecutionDisabled", value=False)
