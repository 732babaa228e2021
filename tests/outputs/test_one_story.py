"""Clamp, root, joints, tube and gauze: the same places and lengths in every file of a design."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from fem.mesh import make_mesh
from profiletool import design
from profiletool.files.design_json import from_json
from profiletool.pipeline import Result
from profiletool.report import outputs
from profiletool.verify.tube import actuator_of
from tests.report.pages import Page

NEAR = 0.01  # mm
SAMPLES = ("bulb", "egg", "bottle", "pear", "vase")
# Where three fingers find room, as the notes of the whole side say.
STARTS = {"bulb": 22, "egg": 36, "bottle": 12, "pear": 29, "vase": 19}
PHOTOS = {"bulb_on_white.jpg": 107.5, "eggplant_alpha.png": 120.0}


def lines_of(data: bytes) -> list[tuple[str, bool, np.ndarray]]:
    """Layer, whether it is closed, and points of every line of a DXF file."""
    doc = ezdxf.read(io.StringIO(data.decode("ascii")))
    return [
        (line.dxf.layer, line.closed, np.array([point[:2] for point in line.get_points()]))
        for line in doc.modelspace()
    ]


def written(result: Result, *names: str) -> dict[str, bytes]:
    rows = {name: outputs.DESIGN_FILES[name] for name in names}
    return outputs.written(rows, outputs.DesignOutput(result))


def number(pattern: str, text: str) -> float:
    (found,) = set(re.findall(pattern, text)) or {""}
    return float(found)


def assert_one_story(result: Result) -> None:
    files = written(result, "design.json", "template.dxf", "mounting.dxf", "report.html")
    tree = json.loads(files["design.json"])
    tube, joints, clamp = tree["tube"], tree["joints"], tree["clamp"]["length_mm"]
    length, diameter = tube["length_mm"], tube["outer_diameter_mm"]
    assert joints[0]["centre_mm"] == pytest.approx(tube["root_mm"], abs=NEAR)
    assert_fe(files["design.json"], tree)
    report = Page(files["report.html"]).text
    around = assert_template(lines_of(files["template.dxf"]), tree)
    for pattern, value in (
        (r"(\S+) from the clamp's edge, x = 0, to the closed end", length),
        (r"to the closed end, and (\S+) in the clamp", clamp),
        (r"hose goes (\S+) mm into the open end", clamp),
        (r"Tube and gauze go on for (\S+) mm behind it", clamp),
        (r"edges, (\S+) mm of it for the clamp", clamp),
        (r"The piece is (\S+) mm along the tube", clamp + length),
        (r"Cut a piece of (\S+) ×", clamp + length),
        (r"closed one, and (\S+) mm around it", around),
        (r"its root is (\S+) mm to the middle", tube["root_mm"]),
        (r"to the first cut the tube has (\S+) mm", tube["root_mm"] - joints[0]["openF_mm"] / 2),
    ):
        # A report says tenths.
        assert number(pattern, report) == pytest.approx(value, abs=0.05 + NEAR), pattern
    for note in tree["warnings"]:
        assert note in report or note.startswith("NOT VERIFIED") or note in result.reasons
    mounted = lines_of(files["mounting.dxf"])
    pose = tree["base_pose"]
    heading = np.radians(pose["heading_deg"])
    along = np.array([np.cos(heading), np.sin(heading)])
    out = np.array([along[1], -along[0]]) * (1.0 if tree["source"]["side"] == "left" else -1.0)
    base = np.array([pose["x_mm"], pose["y_mm"]])
    corners = [
        base,
        base - clamp * along,
        base - clamp * along + diameter * out,
        base + diameter * out,
    ]
    rings = [np.sort(p, axis=0) for layer, closed, p in mounted if layer == "MARK" and len(p) == 4]
    assert min(np.abs(ring - np.sort(corners, axis=0)).max() for ring in rings) < NEAR
    # The tube at rest is dashed, and the farthest thing in its own band.
    drawn = np.concatenate([points for layer, _, points in mounted if layer == "REF"]) - base
    beside = (drawn @ out > -NEAR) & (drawn @ out < diameter + NEAR)
    assert (drawn[beside] @ along).max() == pytest.approx(length, abs=NEAR)


def assert_fe(text: bytes, tree: dict) -> None:
    """The model's fixed section is x = 0, its windows are the cuts, its end the tube's."""
    actuator = actuator_of(from_json(text, "design.json"))
    mesh = make_mesh(actuator)
    closed = tree["tube"]["length_mm"] - actuator.plug  # the rigid last millimetre
    assert mesh.z[[0, -1]] == pytest.approx([0.0, closed], abs=NEAR)
    assert actuator.diameter == pytest.approx(tree["tube"]["outer_diameter_mm"])
    cuts = [
        (j["centre_mm"] - j["openF_mm"] / 2, j["centre_mm"] + j["openF_mm"] / 2)
        for j in tree["joints"]
    ]
    np.testing.assert_allclose([(w.start, w.end) for w in actuator.windows], cuts, atol=NEAR)


def assert_template(lines: list, tree: dict) -> float:
    """The gauze runs from the open end to the closed one; its length around is returned."""
    (outline,) = (points for layer, _, points in lines if layer == "CUT_OUTER")
    (x0, y0), (x1, y1) = outline.min(axis=0), outline.max(axis=0)
    assert x0 == pytest.approx(-tree["clamp"]["length_mm"], abs=NEAR)
    assert (x1, y0) == pytest.approx((tree["tube"]["length_mm"], 0.0), abs=NEAR)
    edge = [p for layer, _, p in lines if layer == "MARK" and np.all(np.abs(p[:, 0]) < 1e-9)]
    marked = sum(np.ptp(p[:, 1]) for p in edge if p[:, 1].min() >= 0.0 and p[:, 1].max() <= y1)
    assert marked > y1 - 7.0  # but for the notch and where the register line crosses
    slits = np.unique([p[0, 0] for layer, _, p in lines if layer == "CUT_INNER"])
    pitch = tree["gauze"]["pitch_mm"]
    rows = []
    for joint in tree["joints"]:
        count = round(joint["openF_mm"] / pitch)
        rows += [joint["centre_mm"] + (k - (count - 1) / 2) * pitch for k in range(count)]
    np.testing.assert_allclose(slits, np.unique(np.round(rows, 6)), atol=NEAR)
    return float(y1)


some = pytest.mark.parametrize(
    "name",
    [n if n == "egg" else pytest.param(n, marks=pytest.mark.slow) for n in SAMPLES],
)


@some
def test_samples(name: str, samples: Path) -> None:
    """As the paper's method designs them: where the numbers come from does not matter here."""
    assert_one_story(design(samples / f"{name}.png", method="paper", verify=False))


@pytest.mark.slow
def test_the_optimal_method(samples: Path) -> None:
    assert_one_story(design(samples / "bulb.png", verify=False))


@pytest.mark.slow
@pytest.mark.parametrize("name", PHOTOS)
def test_photographs(name: str, shared: Path) -> None:
    file = shared / "photos" / name
    assert_one_story(design(file, height_mm=PHOTOS[name], method="paper", verify=False))


@pytest.mark.slow
@some
def test_three_fingers_find_room_where_the_notes_say(name: str, samples: Path) -> None:
    asked = {"method": "paper", "verify": False}
    whole = design(samples / f"{name}.png", **asked)
    (note,) = (text for text in whole.design.warnings if "cannot share a palm" in text)
    assert f"three find room with `start_pct` {STARTS[name]}" in note
    there = design(samples / f"{name}.png", **asked, start_pct=STARTS[name])
    assert not any("cannot share" in text for text in there.design.warnings)
    drills = [
        closed
        for layer, closed, _ in lines_of(written(there, "mounting.dxf")["mounting.dxf"])
        if layer == "CUT_INNER"
    ]
    assert len(drills) in (6, 7)  # two screws a finger, and an opening for an object that needs one
