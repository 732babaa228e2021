"""The report as a file: whole, safe, alone, the same each time, and saying what it should."""

from __future__ import annotations

import re
import shutil
import time
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from profiletool.pipeline import Request
from profiletool.report.asked import options_of
from profiletool.report.dossier import Dossier
from profiletool.report.html import report_html
from tests.report.dossiers import (
    designed,
    infeasible,
    unverified,
    verified,
    with_design,
    with_joints,
)
from tests.report.pages import Page, spaced

LOADS = ("src", "href", "xlink:href", "action", "data", "poster", "srcset", "formaction", "ping")


NASTY = "<img src=x onerror=alert(1)>&\"'$x\u202egpj.csv"


def test_elements_are_closed_and_ids_are_single(page: Page) -> None:
    assert page.wrong == []
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(ids) == len(set(ids))
    asked = {
        name
        for _, attributes in page.elements
        for key in ("aria-labelledby", "aria-describedby", "for", "list")
        for name in attributes.get(key, "").split()
    }
    asked |= set(re.findall(r"url\(#([^)]*)\)", page.source))
    asked |= {
        attributes[key][1:]
        for _, attributes in page.elements
        for key in ("href", "xlink:href")
        if attributes.get(key, "").startswith("#")
    }
    assert asked <= set(ids)


def test_it_asks_for_nothing_but_itself(page: Page) -> None:
    without = re.sub(r'xmlns(:\w+)?="[^"]*"', "", page.source)
    assert not re.search(r"(https?|ftp|file|wss?):", without)
    assert not re.search(r"['\"(=]\s*//\w", without)  # //host/file
    for name, attributes in page.elements:
        for key in LOADS:
            assert attributes.get(key, "#").startswith(("#", "data:")), (name, key)
        assert not [key for key in attributes if key.startswith("on")]
    assert not {"base", "iframe", "object", "embed", "form", "audio", "video"} & {
        name for name, _ in page.elements
    }
    assert re.findall(r"url\(([^#)][^)]*)\)|@import|image-set", page.source) == []
    policy = next(meta["content"] for meta in page.every("meta") if "http-equiv" in meta)
    assert policy.startswith("default-src 'none';")
    assert "http" not in policy
    assert "script-src 'unsafe-inline'" not in policy


def test_the_page_says_what_it_is(page: Page) -> None:
    assert page.every("html") == [{"lang": "en"}]
    assert {"name": "viewport", "content": "width=device-width, initial-scale=1"} in page.every(
        "meta"
    )
    titles = [text for name, text in page.texts if name == "title"]
    assert "bending actuator" in titles[0]
    assert len(page.every("h1")) == 1
    levels = [int(name[1]) for name, _ in page.elements if re.fullmatch(r"h[1-6]", name)]
    assert all(b <= a + 1 for a, b in pairwise(levels))
    for image in (svg for svg in page.every("svg") if svg.get("role") == "img"):
        assert image.get("aria-label") or image.get("aria-labelledby")
    for head in page.every("th"):
        assert head["scope"] in ("col", "row")
    for region in (div for div in page.every("div") if div.get("class") == "scroll"):
        assert region["tabindex"] == "0"
        assert region["aria-label"]


def test_it_is_small(page: Page) -> None:
    assert len(page.source.encode()) < 1_000_000


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["verified", "drawn, no FE"])
def test_the_same_dossier_gives_the_same_bytes(dossiers: dict[str, Dossier], kind: str) -> None:
    first = report_html(dossiers[kind])
    time.sleep(1.1)  # a time of day would differ by now
    assert report_html(dossiers[kind]) == first
    assert not re.search(rb"\d{4}-\d\d-\d\d|\d\d:\d\d:\d\d", first)


def test_seconds_and_folders_are_not_told(dossiers: dict[str, Dossier]) -> None:
    dossier = dossiers["verified"]
    assert dossier.check is not None
    assert dossier.check.run is not None
    found = replace(dossier.check.run.verification, seconds=98.7)
    slow = replace(dossier.check, run=replace(dossier.check.run, verification=found))
    page = report_html(replace(dossier, check=slow))
    assert page == report_html(dossier)
    assert str(Path.cwd()).encode() not in page
    assert b"samples/" not in page
    formula = Path("/home/somebody/tubes/mine.json")
    options = {option.name: option for option in options_of(Request(Path("a"), formula=formula))}
    assert options["--formula"].value == "mine.json"


def test_a_name_is_a_name_and_never_an_element(samples: Path, tmp_path: Path) -> None:
    shutil.copy(samples / "finger_rest.csv", tmp_path / NASTY)
    dossier = verified(unverified(designed(tmp_path / NASTY)))
    design = dossier.scene.design
    bad = "</script><script>alert(1)</script>"
    design = replace(
        design,
        formula=replace(design.formula, name=bad),
        warnings=(*design.warnings, f'formula "{bad}" says nothing'),
    )
    page = Page(report_html(infeasible(with_design(dossier, design), f"a reason <b>{bad}")))
    assert page.wrong == []
    assert page.every("img") == []
    assert page.every("b") == []
    assert len(page.every("script")) == 2
    assert "\u202e" not in page.source
    shown = [text for name, text in page.texts if name == "bdi"]
    assert shown[0] == "<img src=x onerror=alert(1)>&\"'$xgpj"  # what turns the text is dropped
    assert bad in page.text


def test_verdicts(pages: dict[str, Page], dossiers: dict[str, Dossier]) -> None:
    bar = f"{dossiers['verified'].scene.design.pressure_bar:.2f} bar"
    said = pages["verified"].text
    assert "Verified by finite elements (FE)" in said
    assert f"0.23 mm RMS, 0.57 mm at most off the profile at {bar}" in said
    assert "NOT VERIFIED" not in said
    assert "INFEASIBLE" not in said
    assert "NOT VERIFIED Reason: no finite" in spaced(pages["not verified"])
    assert "No finite elements were run" in pages["not verified"].text
    told = spaced(pages["infeasible"])
    assert "INFEASIBLE: best attempt the first <reason> the second reason" in told
    assert told.count("the first <reason>") == 1  # among the notes it would be said again
    assert "Verified by" not in told
    assert f"By finite elements (FE) 0.23 mm RMS, 0.57 mm at most off the profile at {bar}" in told
    both = spaced(pages["infeasible, not verified"])
    assert "INFEASIBLE: best attempt the only reason NOT VERIFIED" in both
    assert "limit point at" in pages["ended early"].text
    assert "NOT VERIFIED" in pages["ended early"].text
    assert "build it to try it" in pages["not verified"].text
    assert "build it to try it" not in said


def test_a_tube_is_not_told_to_be_blown_up(
    pages: dict[str, Page], dossiers: dict[str, Dossier]
) -> None:
    bar = dossiers["ended early"].scene.design.pressure_bar
    assert f"Stay below {0.54 * bar:.2f} bar." in pages["ended early"].text
    assert f"Never more than {bar:.2f} bar." not in pages["ended early"].text
    assert f"Never more than {bar:.2f} bar." in pages["verified"].text


def test_the_verdict_has_the_colour_of_what_it_says(pages: dict[str, Page]) -> None:
    for kind, page in pages.items():
        (verdict,) = [div for div in page.every("div") if div.get("id") == "verdict"]
        good = kind in ("verified", "drawn", "twelve joints")
        assert verdict["class"] == f"verdict {'good' if good else 'bad'}"


def test_joints_and_steps(pages: dict[str, Page], dossiers: dict[str, Dossier]) -> None:
    for kind in ("verified", "twelve joints"):
        design, said = dossiers[kind].scene.design, pages[kind].text
        tube = design.tube
        for joint in design.joints:
            threads = np.pi * tube.outer_diameter_mm * joint.alpha_closed_deg / 720.0
            assert f"{joint.alpha_closed_deg:.1f}{threads:.1f}".removesuffix(".0") in said
        assert f"{tube.outer_diameter_mm - 2.0 * tube.wall_mm:g} mm" in said
        for name in ("template.pdf", "template.dxf", "template.svg", "mounting.pdf"):
            assert name in said
    early = pages["ended early"]
    half = 0.5 * dossiers["ended early"].scene.design.pressure_bar
    assert f"What the tube bears at {half:.2f} bar" in early.text
    assert "there are no angles to compare with" in pages["not verified"].text
    assert "there are no angles to compare with" not in pages["verified"].text


def test_what_moves_the_tube(pages: dict[str, Page], dossiers: dict[str, Dossier]) -> None:
    for kind, count in (("verified", 11), ("ended early", 6), ("twelve joints", 11)):
        design, states = dossiers[kind].scene.design, pages[kind].states
        assert len(states["bar"]) == len(states["lines"]) == count
        assert states["bar"][0] == 0.0
        assert 60 <= len(states["lines"][0]) / 4 <= 90
        assert all(isinstance(v, int) for v in states["lines"][-1])
        (slider,) = pages[kind].every("input")
        assert int(slider["max"]) == (count - 1) * int(slider["data-substeps"])
        assert slider["value"] == slider["max"]
        assert len(pages[kind].every("option")) == count
        rows = [g for g in pages[kind].every("g") if "data-joint" in g]
        assert len(rows) == len(states["windows"]) == len(design.joints)
        (controls,) = [d for d in pages[kind].every("div") if d.get("id") == "controls"]
        assert "hidden" in controls  # until the script shows it
    for kind in ("not verified", "ended at once", "drawn, no FE"):
        assert pages[kind].states == {}
        assert pages[kind].every("input") == []
        assert pages[kind].every("script") == []
        assert any("data-tube" in path for path in pages[kind].every("path"))


@pytest.mark.slow
def test_many_joints_are_no_trouble(finger: Dossier) -> None:
    page = Page(report_html(with_joints(finger, 60)))
    assert page.wrong == []
    assert len([g for g in page.every("g") if "data-joint" in g]) == 60


def test_the_picture_lies_where_the_object_is(
    pages: dict[str, Page], dossiers: dict[str, Dossier]
) -> None:
    (image,) = pages["verified"].every("image")
    assert image["href"].startswith("data:image/jpeg;base64,")
    backdrop = dossiers["verified"].scene.backdrop
    assert backdrop is not None
    left, right, bottom, top = backdrop.extent
    x, y, width, height = (float(image[key]) for key in ("x", "y", "width", "height"))
    pixel = (right - left) / backdrop.rgb.shape[1]
    assert left - 1e-3 <= x < x + width <= right + 1e-3
    assert -top - 1e-3 <= y < y + height <= -bottom + 1e-3
    # It starts on a pixel of the picture.
    assert (x - left) / pixel == pytest.approx(round((x - left) / pixel), abs=0.02)
    assert pages["drawn"].every("image") == []
