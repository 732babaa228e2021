"""Whatever a file holds, reading it ends in a result or in one line with the right exit code."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from formula.errors import BadFormula
from formula.files import load_formula
from profiletool.campaign.derive import load_base
from profiletool.errors import ProfiletoolError, UnreadableInput
from profiletool.files import read
from profiletool.files.angles_csv import read_angles
from profiletool.files.design_json import load_design
from profiletool.files.formula import read_formula
from profiletool.image.load import load_picture
from profiletool.profile.drawing.load import load_vector
from profiletool.profile.shape_csv import read_shape_csv
from profiletool.rubber.presets import parse_rubber
from profiletool.subject.recall import Target, target_of
from tests.calls import call

ROOT = Path(__file__).resolve().parents[2]
DESIGN = (ROOT / "samples" / "paper_bulb.json").read_bytes()
FORMULA = (ROOT / "formula" / "coefficients" / "fe.json").read_bytes()
SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">'
DRAWING = f'{SVG}<path d="M0 0C0 40 30 40 30 0A9 9 0 0 1 9 9z"/></svg>'
DXF = (
    "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n100\nAcDbEntity\n100\nAcDbPolyline\n90\n3\n"
    "70\n1\n10\n0\n20\n0\n10\n9\n20\n0\n10\n9\n20\n9\n"
    "0\nSPLINE\n100\nAcDbEntity\n100\nAcDbSpline\n70\n8\n71\n3\n72\n8\n73\n4\n"
    "40\n0\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1\n40\n1\n10\n0\n20\n0\n"
    "10\n0\n20\n4\n10\n3\n20\n4\n10\n3\n20\n0\n0\nENDSEC\n0\nEOF\n"
)
RUBBER = "stretch,stress\n" + "".join(f"{1 + n / 20},{0.02 * n}\n" for n in range(30))
ANGLES = (
    "picture,pressure_bar,joint,theta_deg,sigma_deg,state\n"
    "a.png,1.6,1,20.5,0.4,measured\na.png,1.6,2,,,lost\n"
)
TOML = (
    'side = "right"\nmax-length = 200\nroot = 12\njoints = 4\nverify = false\nformula = "paper"\n'
)


def read_options(path: Path) -> None:
    """As `design` does: there is no picture, and options are read first."""
    result = call("design", path.with_name("absent.csv"), "--no-verify", "--config", path)
    assert result.exit_code in (2, 3)
    assert "Traceback" not in result.stderr


def read_shape(path: Path) -> None:
    path.with_name("design.json").write_bytes(DESIGN)
    target_of(load_design(path.with_name("design.json")), path)


READERS: dict[str, tuple[str, bytes, Callable[[Path], Any]]] = {
    "svg": ("a.svg", DRAWING.encode(), load_vector),
    "csv": ("a.csv", b"x;y\n0;0\n10,5;0\n10;-5,25\n", load_vector),
    "dxf": ("a.dxf", DXF.encode(), load_vector),
    "design": ("design.json", DESIGN, load_design),
    "formula": ("f.json", FORMULA, lambda path: (read_formula(path), load_base(str(path)))),
    "rubber": ("r.csv", RUBBER.encode(), lambda path: parse_rubber(str(path))),
    "shape": ("shape.csv", b"curve,s_mm,x_mm,y_mm\ntarget,0,0,0\ntarget,5,5,0\n", read_shape),
    "angles": ("angles.csv", ANGLES.encode(), read_angles),
    "options": ("lab.toml", TOML.encode(), read_options),
}  # fmt: skip

TOKENS = [
    b"nan", b"-inf", b"1e999", b"-1e308", b"9" * 400, b"0", b"-1", b"\0", b"\xff\xfe",
    b"\xef\xbb\xbf", b"[" * 2000, b'{"a":' * 2000, b"<g>" * 300, b"&a;", b"<!DOCTYPE a>",
    b"null", b'"', b"=", b"\n", b"\r", b";", b",", b"#", b"1979-05-27", b"\x1b[31m", b"../../x",
    b"\xe2\x80\xa8", b"\x85", b"%",
]  # fmt: skip
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?")


@st.composite
def damaged(draw: st.DrawFn, seed: bytes) -> bytes:
    """A valid file with a few numbers, pieces and tokens changed."""
    data = seed
    for _ in range(draw(st.integers(1, 4))):
        kind, token = draw(st.integers(0, 3)), draw(st.sampled_from(TOKENS))
        at, size = draw(st.integers(0, len(data))), draw(st.integers(1, 40))
        if kind == 0:
            places = [place.span() for place in NUMBER.finditer(data)] or [(at, at)]
            start, end = draw(st.sampled_from(places))
            data = data[:start] + token + data[end:]
        elif kind == 1:
            data = data[:at] + token + data[at:]
        elif kind == 2:
            data = data[:at] + data[at + size :]
        else:
            data = data[:at] + data[at : at + size] + data[at:]
    return data


def ends_well(kind: str, folder: Path, data: bytes) -> None:
    name, _, read = READERS[kind]
    path = folder / name
    path.write_bytes(data)
    code, said = 0, ""
    try:
        read(path)
    except ProfiletoolError as error:
        code, said = error.exit_code, str(error)
    assert code in ((0, 2, 3) if kind == "formula" else (0, 3, 5))
    assert "\n" not in said
    assert path.read_bytes() == data


@pytest.mark.parametrize("kind", READERS)
@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_damaged_files(kind: str, tmp_path: Path, data: st.DataObject) -> None:
    ends_well(kind, tmp_path, data.draw(damaged(READERS[kind][1])))


@pytest.mark.parametrize("kind", READERS)
@settings(max_examples=8, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.binary(max_size=200) | st.text(max_size=100).map(lambda text: text.encode()))
def test_any_bytes(kind: str, tmp_path: Path, data: bytes) -> None:
    ends_well(kind, tmp_path, data)


@pytest.mark.slow
@pytest.mark.parametrize("kind", READERS)
@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_many_damaged_files(kind: str, tmp_path: Path, data: st.DataObject) -> None:
    ends_well(kind, tmp_path, data.draw(damaged(READERS[kind][1])))


# --- what is no plain file --------------------------------------------------------------------


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with a name")
@pytest.mark.parametrize("kind", [*READERS, "picture"])
def test_a_pipe_does_not_wait_for_ever(kind: str, tmp_path: Path) -> None:
    name, _, read = READERS.get(kind, ("a.png", b"", load_picture))
    os.mkfifo(tmp_path / name)
    if kind in ("shape", "options"):  # neither lets an error out
        read(tmp_path / name)
        return
    with pytest.raises(UnreadableInput, match=r"not a (regular )?file"):
        read(tmp_path / name)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no such device")
@pytest.mark.parametrize("kind", [*READERS, "picture"])
def test_an_endless_device_is_no_file(kind: str, tmp_path: Path) -> None:
    name, _, read = READERS.get(kind, ("a.png", b"", load_picture))
    (tmp_path / name).symlink_to("/dev/zero")
    if kind in ("shape", "options"):
        read(tmp_path / name)
        return
    with pytest.raises(UnreadableInput, match=r"not a (regular )?file"):
        read(tmp_path / name)


def test_a_file_that_grows_while_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("profiletool.files.read.check_file", lambda *_: None)
    (tmp_path / "a.csv").write_bytes(b"0,0\n" * 10)
    with pytest.raises(UnreadableInput, match="larger than"):
        read.read_file(tmp_path / "a.csv", 20, "a table")
    assert read.read_file(tmp_path / "a.csv", 40, "a table") == b"0,0\n" * 10


def test_a_formula_file_has_a_limit(tmp_path: Path) -> None:
    (tmp_path / "big.json").write_bytes(FORMULA + b" " * 5_000_000)
    with pytest.raises(BadFormula, match="larger than 5 MB"):
        load_formula(tmp_path / "big.json")
    assert call("table", "--formula", tmp_path / "big.json").exit_code == 3


def test_a_number_too_long_for_a_campaign(tmp_path: Path) -> None:
    tree = json.loads(FORMULA)
    tree["campaign"]["theta_deg"] = [[[10**400]]]
    (tmp_path / "long.json").write_text(json.dumps(tree))
    with pytest.raises(UnreadableInput, match="table of numbers"):
        load_base(str(tmp_path / "long.json"))


@pytest.mark.parametrize("text", ["a." * 4500 + "a = 1", "a = " + "[" * 9000, "\ufeffroot = 1"])
def test_options_nested_without_end(tmp_path: Path, text: str) -> None:
    (tmp_path / "lab.toml").write_text(text)
    read_options(tmp_path / "lab.toml")


# --- paths inside files -----------------------------------------------------------------------


@pytest.mark.parametrize("name", ["../a.csv", "sub/../../a.csv", "{root}/a.csv", "link.csv", "\0"])
def test_a_design_never_leads_out_of_its_folder(tmp_path: Path, name: str) -> None:
    import hashlib

    drawing = (ROOT / "samples" / "truth" / "bulb.csv").read_bytes()
    (tmp_path / "a.csv").write_bytes(drawing)
    folder = tmp_path / "made"
    (folder / "sub").mkdir(parents=True)
    (folder / "link.csv").symlink_to(tmp_path / "a.csv")
    tree = json.loads(DESIGN)
    tree["source"] |= {
        "file": name.format(root=tmp_path), "sha256": hashlib.sha256(drawing).hexdigest()
    }  # fmt: skip
    (folder / "design.json").write_text(json.dumps(tree))
    design = load_design(folder / "design.json")
    assert target_of(design, folder / "design.json") is None
    # The very drawing beside the design is taken.
    (folder / "mine.csv").write_bytes(drawing)
    tree["source"]["file"] = "mine.csv"
    (folder / "design.json").write_text(json.dumps(tree))
    assert target_of(load_design(folder / "design.json"), folder / "design.json") is not None


def five_mm(folder: Path, x: str) -> Target | None:
    """Look for the target of a design 5 mm long beside a shape.csv whose line is as long, at x."""
    table = f"curve,s_mm,x_mm,y_mm\ntarget,0,{x},0\ntarget,5,{x},5\n"
    (folder / "shape.csv").write_text(table)
    design = load_design(ROOT / "samples" / "paper_bulb.json")
    design = replace(design, source=replace(design.source, profile_length_mm=5.0))
    return target_of(design, folder / "design.json")


@pytest.mark.parametrize("value", ["1.1e5", "1e308", "-1e300"])
def test_a_shape_of_absurd_numbers_is_no_target(tmp_path: Path, value: str) -> None:
    found = five_mm(tmp_path, "9.9e4")
    assert found is not None
    assert found.file == "shape.csv"
    assert five_mm(tmp_path, value) is None


@pytest.mark.parametrize("value", ["nan", "inf", "1e999", "-1e300"])
def test_a_table_of_absurd_numbers_is_refused(value: str) -> None:
    for x, y in ((value, "0"), ("0", value)):
        with pytest.raises(ValueError, match="not finite"):
            read_shape_csv(f"curve,s_mm,x_mm,y_mm\ntarget,0,0,0\ntarget,5,{x},{y}\n", "target")


def test_svg_references_out_of_the_file_are_not_followed(tmp_path: Path) -> None:
    (tmp_path / "other.svg").write_text(f'{SVG}<circle id="a" r="90"/></svg>')
    body = (
        f'<use href="file://{tmp_path}/other.svg#a"/><use href="other.svg#a"/>'
        f'<image href="file://{tmp_path}/other.svg" width="9" height="9"/>'
        f'<style>@import url("file://{tmp_path}/x.css"); path{{fill:url(/dev/zero)}}</style>'
        '<path d="M0 0h9v9z"/>'
    )
    (tmp_path / "a.svg").write_text(f"{SVG}{body}</svg>")
    assert len(load_vector(tmp_path / "a.svg").points) == 3


def test_dxf_references_and_block_bombs_are_not_followed(tmp_path: Path) -> None:
    document = ezdxf.new("R2000", units=4)
    space = document.modelspace()
    document.add_xref_def(str(tmp_path / "absent.dxf"), "X")
    space.add_blockref("X", (0, 0))
    space.add_image(document.add_image_def("/dev/zero", (9, 9)), (0, 0), (9, 9))
    inner = document.blocks.new("A")
    inner.add_blockref("A", (0, 0))
    many = {"row_count": 10**6, "column_count": 10**6}
    space.add_blockref("A", (0, 0), dxfattribs=many)
    space.add_circle((0, 0), 9)
    document.saveas(tmp_path / "a.dxf")
    assert load_vector(tmp_path / "a.dxf").closed


# --- what damage has found --------------------------------------------------------------------


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize(
    ("head", "body"),
    [
        ('viewBox="0 0 9 null"', '<rect width="9" height="9"/>'),
        ('viewBox="nan 0 9 9"', '<rect width="9" height="9"/>'),
        ('width="50%"', '<rect width="9" height="9"/>'),
        ("", '<path d="M0 0C0 40 1e308 40 30 0z"/>'),
        ("", f'<path d="M0 0Q9 9 {"9" * 400} 0z"/>'),
    ],
)
def test_svg_of_odd_pages_and_absurd_curves(tmp_path: Path, head: str, body: str) -> None:
    text = f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{body}</svg>'
    ends_well("svg", tmp_path, text.encode())
