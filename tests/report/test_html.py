"""The report as a file: whole, safe, alone, the same each time, and saying what it should."""

from __future__ import annotations

import json
import re
import shutil
import time
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from profiletool.pipeline import Request
from profiletool.records.request import TubeSpec
from profiletool.report.asked import options_of
from profiletool.report.dossier import Dossier
from profiletool.report.film import Film, film_of, still_of
from profiletool.report.html import report_html
from profiletool.report.markup import MINUS, Markup, adopted, joined, signed, tag
from profiletool.report.steps import steps
from tests.report.dossiers import (
    designed,
    ended_early,
    infeasible,
    made_up,
    unverified,
    verified,
    with_design,
    with_joints,
)

VOID = {"meta", "link", "input", "br", "img"}
LOADS = ("src", "href", "xlink:href", "action", "data", "poster", "srcset", "formaction", "ping")
NASTY = "<img src=x onerror=alert(1)>&\"'$x\u202egpj.csv"


class Page(HTMLParser):
    """What is in a page, and what is wrong with how it is written."""

    def __init__(self, source: bytes) -> None:
        super().__init__(convert_charrefs=True)
        self.source = source.decode()
        self.open: list[str] = []
        self.wrong: list[str] = []
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.texts: list[tuple[str, str]] = []
        self.feed(self.source)
        self.close()
        self.wrong += self.open

    def handle_starttag(self, name: str, attributes: list[tuple[str, str | None]]) -> None:
        if len({key for key, _ in attributes}) < len(attributes):
            self.wrong.append(f"{name}: an attribute twice")
        self.elements.append((name, {key: value or "" for key, value in attributes}))
        if name not in VOID:
            self.open.append(name)

    def handle_startendtag(self, name: str, attributes: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(name, attributes)
        if name not in VOID:
            self.open.pop()

    def handle_endtag(self, name: str) -> None:
        if not self.open or self.open.pop() != name:
            self.wrong.append(f"</{name}>")

    def handle_data(self, data: str) -> None:
        self.texts.append((self.open[-1] if self.open else "", data))

    def every(self, name: str) -> list[dict[str, str]]:
        return [attributes for element, attributes in self.elements if element == name]

    @property
    def text(self) -> str:
        """All that is to be read, spaces made single."""
        said = "".join(text for name, text in self.texts if name not in ("script", "style"))
        return " ".join(said.split())

    @property
    def states(self) -> dict[str, list[list[float]]]:
        """What the script is given; nothing where there is no script."""
        told = [text for name, text in self.texts if name == "script"]
        return dict(json.loads(told[0])) if told else {}


@pytest.fixture(scope="module")
def finger(samples: Path) -> Dossier:
    """A drawn profile without a picture."""
    return unverified(designed(samples / "finger_rest.csv"))


@pytest.fixture(scope="module")
def egg(samples: Path) -> Dossier:
    """A picture."""
    return unverified(designed(samples / "egg.png"))


@pytest.fixture(scope="module")
def dossiers(finger: Dossier, egg: Dossier) -> dict[str, Dossier]:
    return {
        "verified": verified(egg),
        "not verified": egg,
        "infeasible": infeasible(verified(egg), "the first <reason>", "the second reason"),
        "infeasible, not verified": infeasible(egg, "the only reason"),
        "ended early": ended_early(egg, 0.5),
        "ended at once": ended_early(egg, 0.0),
        "drawn": verified(finger),
        "drawn, no FE": finger,
        "twelve joints": verified(with_joints(finger, 12)),
    }


KINDS = (
    "verified", "not verified", "infeasible", "infeasible, not verified", "ended early",
    "ended at once", "drawn", "drawn, no FE", "twelve joints",
)  # fmt: skip


@pytest.fixture(scope="module")
def pages(dossiers: dict[str, Dossier]) -> dict[str, Page]:
    return {kind: Page(report_html(dossier)) for kind, dossier in dossiers.items()}


@pytest.fixture(params=KINDS)
def page(pages: dict[str, Page], request: pytest.FixtureRequest) -> Page:
    return pages[request.param]


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
    assert "NOT VERIFIED Reason: no finite" in _spaced(pages["not verified"])
    assert "No finite elements were run" in pages["not verified"].text
    told = _spaced(pages["infeasible"])
    assert "INFEASIBLE: best attempt the first <reason> the second reason" in told
    assert told.count("the first <reason>") == 1  # among the notes it would be said again
    assert "Verified by" not in told
    assert f"By finite elements (FE) 0.23 mm RMS, 0.57 mm at most off the profile at {bar}" in told
    both = _spaced(pages["infeasible, not verified"])
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


def test_slits_and_the_weld_line(dossiers: dict[str, Dossier]) -> None:
    drawn = dossiers["drawn"].scene.design
    gauze = drawn.gauze
    for seam, words in (
        (270.0, "on the side that faces the object (270°"),
        (90.0, "on the side away from the object (90°"),
        (300.0, "30° counter-clockwise from the side that faces the object (300°"),
        (250.0, "20° clockwise from the side that faces the object (250°"),
    ):
        design = replace(drawn, gauze=replace(gauze, seam_deg=seam, turns=3))
        said = joined(step.body for step in steps(design, None))
        assert words in said
        assert "roll it 3 times" in said
    assert "The weld line crosses the cuts of joint" in said
    toward = replace(
        design,
        joints=tuple(replace(joint, alpha_center_deg=270.0) for joint in design.joints),
        gauze=replace(gauze, seam_deg=270.0),
    )
    said = joined(step.body for step in steps(toward, None))
    assert "The weld line crosses no cut" in said


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


def test_many_joints_are_no_trouble(finger: Dossier) -> None:
    page = Page(report_html(with_joints(finger, 60)))
    assert page.wrong == []
    assert len([g for g in page.every("g") if "data-joint" in g]) == 60


def corners(path: str) -> np.ndarray:
    return np.array([[float(v) for v in p.split(",")] for p in path.strip("MZ").split(" ")])


def test_the_tube_is_drawn_where_it_is(finger: Dossier) -> None:
    design = finger.scene.design
    found = made_up(design)
    film = film_of(found, design)
    shape = found.last.shape
    drawn = corners(film.outline()) * [1.0, -1.0]
    n = film.lines.shape[2]
    assert np.allclose(drawn[[0, n - 1, n, -1]], [
        shape.facing[0], shape.facing[-1], shape.far[-1], shape.far[0],
    ], atol=0.006)  # fmt: skip
    for k, joint in enumerate(design.joints):
        edges = corners(film.window(k)) * [1.0, -1.0]
        at = np.interp(joint.centre_mm - 0.5 * joint.openF_mm, shape.along, shape.facing[:, 0])
        assert edges[0, 0] == pytest.approx(at, abs=0.2)
        assert np.allclose(
            [float(v) for v in film.centre(k)],
            [
                np.interp(joint.centre_mm, shape.along, shape.axis[:, 0]),
                -np.interp(joint.centre_mm, shape.along, shape.axis[:, 1]),
            ],
            atol=0.2,
        )
    still = still_of(shape, design)
    assert still.outline() == film.outline()
    assert not still.moves


def test_lengths_survive_thinning(finger: Dossier) -> None:
    design = finger.scene.design
    found = made_up(design)
    film: Film = film_of(found, design)
    for state, lines in zip((found.rest, *found.states), film.lines, strict=True):
        for line, thin in zip((state.shape.facing, state.shape.far), lines / 100.0, strict=True):
            length, kept = (np.hypot(*np.diff(v, axis=0).T).sum() for v in (line, thin))
            assert kept == pytest.approx(length, rel=3e-3)


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


def test_options_that_differ_are_told_and_the_main_ones_always() -> None:
    plain = options_of(Request(Path("a.png")))
    assert not any(option.changed for option in plain)
    assert {"--side", "--max-pressure", "--joints", "--verify"} <= {o.name for o in plain}
    assert "--place-step" not in {option.name for option in plain}
    asked = Request(
        Path("a.png"), place_step_mm=2.0, tube=TubeSpec(max_pressure_bar=1.2), verify=False
    )
    changed = {o.name: (o.value, o.usual) for o in options_of(asked) if o.changed}
    assert changed == {
        "--place-step": ("2 mm", "1 mm"),
        "--max-pressure": ("1.2 bar", "2 bar"),
        "--verify": ("no", "yes"),
    }


def test_markup_escapes_all_that_is_not_markup() -> None:
    assert tag("p", "<b>&", Markup("<i>x</i>"), class_='a"b') == (
        '<p class="a&quot;b">&lt;b&gt;&amp;<i>x</i></p>'
    )
    assert tag("input", hidden=True, disabled=False, data_x="1") == '<input hidden data-x="1"/>'
    assert tag("p", "a\u202eb\x00c\ud800d\ne") == "<p>abcd\ne</p>"


def test_minus_signs() -> None:
    assert signed(-1.25, 2, "°") == f"{MINUS}1.25°"
    assert signed(-0.04) == "0.0"
    assert signed(10.0) == "10.0"


def test_an_adopted_drawing_keeps_to_itself() -> None:
    drawing = (
        '<?xml version="1.0"?>\n<!DOCTYPE svg>\n<svg id="a"><use xlink:href="#b"/>'
        '<g id="b" clip-path="url(#c)"/></svg>\n'
    )
    assert adopted(drawing, "x-") == (
        '<svg id="x-a"><use xlink:href="#x-b"/><g id="x-b" clip-path="url(#x-c)"/></svg>'
    )


def _spaced(page: Page) -> str:
    """All that is to be read, with a space between elements."""
    said = (text for name, text in page.texts if name not in ("script", "style"))
    return " ".join(" ".join(said).split())
