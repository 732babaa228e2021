"""The way of a design through the studio, its versions, and what stays of them."""

from __future__ import annotations

import io
import json
import shutil
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from profiletool import pipeline
from profiletool.files.design_json import load_design
from profiletool.records.edit import edit_of
from profiletool.report import outputs
from profiletool.report.outputs import DESIGN_FILES
from profiletool.studio.state import restored
from profiletool.verify.check import Check
from tests.calls import call
from tests.studio.conftest import Studio, opened

QUICK = {"method": "paper", "joints": 2, "verify": False, "end_pct": 70}


@pytest.fixture(scope="module")
def first(samples: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The work folder of a first design, without finite elements and most files."""
    folder = tmp_path_factory.mktemp("first")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        few(patch)
        studio = next(opened(folder, patch))
        assert studio.put(samples / "egg.png").status_code == 200
        assert studio.post("do/set", {"values": QUICK}).status_code == 200
        assert studio.post("do/design", {}).status_code == 200
        studio.worker.work()
        yield folder


@pytest.fixture
def made(first: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Studio]:
    """With a first design."""
    folder = shutil.copytree(first, tmp_path / "work")
    monkeypatch.chdir(folder)
    few(monkeypatch)
    yield from opened(folder, monkeypatch)


def few(patch: pytest.MonkeyPatch) -> None:
    """Write the files that later steps need alone: pictures take a second."""
    kept = {name: DESIGN_FILES[name] for name in ("design.json", "shape.csv", "template.svg")}
    patch.setattr(outputs, "DESIGN_FILES", kept)


def test_from_a_picture_to_a_design(made: Studio) -> None:
    state = made.state
    assert (state["picture"], state["current"]) == ("egg.png", 1)
    assert state["values"] == QUICK
    assert state["toml"] == 'to = 70.0\nmethod = "paper"\njoints = 2\nverify = false\n'
    assert state["commands"] == ["design egg.png --config 1.toml --out made/1"]
    made.worker.work()  # the object is found again
    state = made.state
    assert state["found"]["sized"]
    assert len(state["found"]["side"]) == 201
    view = made.get("view/1").json()
    assert [joint["number"] for joint in view["joints"]] == [1, 2]
    assert not view["verified"]
    # The picture lies where the object does: the outline's box, in pixels, holds the object.
    picture, k = view["subject"]["picture"], view["subject"]["scale"]["mm_per_px"]
    assert made.get(f"picture/{picture['file']}").headers["content-type"] == "image/jpeg"
    left, top, width, height = (value / k for value in view["subject"]["box"])
    x, y = (value / k for value in picture["place"][:2])
    from profiletool.image.load import load_picture

    rgb = load_picture(made.session.folder / "egg.png").rgb
    assert [picture["place"][2] / k, picture["place"][3] / k] == pytest.approx(
        [rgb.shape[1], rgb.shape[0]]
    )
    assert 0 < left - x < left + width - x < rgb.shape[1]
    assert 0 < top - y < top + height - y < rgb.shape[0]


def test_the_zip_and_the_folder_hold_the_files_of_the_version(made: Studio) -> None:
    place = made.session.place(1)
    files = {path.name: path.read_bytes() for path in place.iterdir()}
    with zipfile.ZipFile(io.BytesIO(made.get("zip/1").content)) as packed:
        assert {name: packed.read(name) for name in packed.namelist()} == files
    assert made.get("zip/1").content == made.get("zip/1").content
    asked = {"version": 1, "name": "egg_design", "force": False}
    assert made.post("do/export", asked).status_code == 200
    folder = made.session.folder.parent / "egg_design"
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == files
    answer = made.post("do/export", asked)
    assert answer.status_code == 400
    assert "exists" in answer.json()["error"]
    assert made.post("do/export", asked | {"force": True}).status_code == 200
    for name in ("../x", "/tmp/x", "a/b", "", ".x", "work", "x\n", 3):
        assert made.post("do/export", asked | {"name": name}).status_code == 400, name
    assert made.get("files/1/design.json").content == files["design.json"]


def test_changes_are_versions_with_their_commands(
    made: Studio, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = load_design(made.session.place(1) / "design.json")
    monkeypatch.setattr(pipeline, "_verified", lambda design, *_: Check(design, None, "left out"))
    asked = {"version": 1, "edits": ["2:move=-2"], "pressure_bar": 1.25}
    assert made.post("do/change", asked).status_code == 200
    assert made.state["running"]["kind"] == "edit"
    made.worker.work()
    state = made.state
    assert state["current"] == 2
    assert state["commands"][1:] == [
        "profiletool edit made/1/design.json --change 2:move=-2.0 --pressure 1.25 --out made/2"
    ]
    second = load_design(made.session.place(2) / "design.json")
    assert second.joints[1].centre_mm == pytest.approx(first.joints[1].centre_mm - 2.0)
    assert second.pressure_bar == 1.25
    assert made.get("view/2").json()["subject"] == made.get("view/1").json()["subject"]
    made.post("do/go", {"version": 1})  # undo
    assert made.state["current"] == 1
    assert len(made.state["commands"]) == 1
    assert made.post("do/go", {"version": 9}).status_code == 400
    # What a session leaves is what the next one begins with.
    assert restored(made.session.folder) == made.session.state


def test_the_tube_follows_a_drag(made: Studio) -> None:
    still = made.post("bend", {"version": 1, "edits": []}).json()
    design = load_design(made.session.place(1) / "design.json")
    moved = made.post("bend", {"version": 1, "edits": ["1:move=2"]}).json()
    assert moved["joints"][0]["centre"] == pytest.approx(design.joints[0].centre_mm + 2.0)
    assert moved["film"]["lines"] != still["film"]["lines"]
    assert len(moved["film"]["lines"]) % 4 == 0
    softer = made.post("bend", {"version": 1, "edits": [], "pressure_bar": 0.5}).json()
    for less, more in zip(softer["joints"], still["joints"], strict=True):
        assert abs(less["response"]) < abs(more["response"])
    away = made.post("bend", {"version": 1, "edits": ["1:center=90"]}).json()
    assert away["joints"][0]["response"] < 0.0 < still["joints"][0]["response"]
    for edit, says in (("1:move=-500", "clamp"), ("1:openF=3.3", "whole meshes"),
                       ("7:move=1", "must be 1 to"), ("1:alpha=400", "0 to 360")):  # fmt: skip
        answer = made.post("bend", {"version": 1, "edits": [edit]})
        assert answer.status_code == 400
        assert says in answer.json()["error"]
        assert "`" not in answer.json()["error"]


def test_cancel_leaves_what_was_there(made: Studio) -> None:
    made.post("do/design", {})
    made.worker.hear(len(made.worker.jobs), "share", 0.25)
    assert made.state["running"]["share"] == 0.25
    made.post("do/cancel", {})
    state = made.state
    assert (state["running"], state["current"]) == (None, 1)
    assert made.worker.cancelled == 1
    made.worker.hear(len(made.worker.jobs), "done", {})  # too late
    assert [version["number"] for version in made.state["versions"]] == [1]


def test_a_refused_picture_says_why(studio: Studio, tmp_path: Path) -> None:
    file = tmp_path / "no.png"
    file.write_bytes(b"no picture")
    studio.put(file)
    studio.worker.work()
    assert "not a picture" in studio.state["found"]["error"]
    assert studio.post("do/design", {}).status_code == 200
    studio.worker.work()
    assert "not a picture" in studio.state["said"]
    assert studio.state["versions"] == []


def test_without_a_size_the_object_is_shown_all_the_same(
    studio: Studio, samples: Path, tmp_path: Path
) -> None:
    from PIL import Image

    file = tmp_path / "bare.png"
    Image.open(samples / "egg.png").convert("RGB").save(file)  # leaves the resolution away
    studio.put(file)
    studio.worker.work()
    found = studio.state["found"]
    assert not found["sized"]
    assert found["outline"]
    assert "“Height”" in found["error"]
    studio.post("do/set", {"values": {"height_mm": 60}})
    studio.worker.work()
    assert studio.state["found"]["size"][1] == pytest.approx(60.0, abs=0.2)


def test_the_same_picture_again_keeps_the_session(made: Studio, samples: Path) -> None:
    made.session.open(samples / "egg.png")
    assert made.state["current"] == 1
    made.session.open(samples / "pear.png")
    assert made.state["current"] is None
    assert made.state["values"]["joints"] == 2


def test_a_folder_that_is_no_session_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from profiletool.errors import OutputError

    for text in ("", "[]", "{}", '{"picture": null, "values": {"a": 1}, "versions": []}'):
        (tmp_path / "session.json").write_text(text)
        with pytest.raises(OutputError, match="cannot go on"):
            restored(tmp_path)
    (tmp_path / "session.json").write_text(json.dumps(
        {"picture": "a.png", "values": {}, "versions": [], "current": 3}
    ))  # fmt: skip
    monkeypatch.chdir(tmp_path)
    studio = next(opened(tmp_path, monkeypatch))
    assert studio.state["current"] is None


def test_a_change_is_written_as_it_is_read() -> None:
    for text in ("3:alpha=103.13240312354819,openF=8.0,move=-2.5,center=90.0", "1:move=0.1"):
        assert str(edit_of(text)) == text


@pytest.mark.slow
def test_the_files_are_those_of_the_command_line(studio: Studio, samples: Path) -> None:
    studio.put(samples / "egg.png")
    studio.post("do/set", {"values": QUICK})
    studio.post("do/design", {})
    studio.worker.work()
    (line,) = studio.state["commands"]
    assert call(*line.split()).exit_code in (0, 6)
    ours, theirs = (
        {path.name: path.read_bytes() for path in folder.iterdir()}
        for folder in (studio.session.place(1), Path("made/1"))
    )
    assert {"design.json", "report.html", "template.pdf", "overlay.png"} <= set(ours)
    assert ours == theirs
