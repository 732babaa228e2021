"""Drawings by their file: its kind and size, and whatever damage it has."""

import subprocess
import sys

import numpy as np
import pytest

from profiletool.errors import NoObject, UnreadableInput
from profiletool.profile.drawing.load import load_vector
from tests.profile.drawing.drawings import dxf_text, svg


@pytest.mark.parametrize("name", ["none.csv", "none.svg", "none.dxf", "with\nline\x1b.csv"])
def test_missing_file(tmp_path, name):
    with pytest.raises(UnreadableInput, match="no such file") as failure:
        load_vector(tmp_path / name)
    assert str(failure.value).isprintable()


def test_not_a_file(tmp_path):
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(UnreadableInput, match="a folder"):
        load_vector(tmp_path / "folder.csv")
    with pytest.raises(UnreadableInput, match="cannot be opened"):
        load_vector(tmp_path / ("x" * 5000 + ".csv"))


def test_unknown_suffix(load):
    with pytest.raises(UnreadableInput, match="give DXF, SVG or CSV"):
        load("a.step", "0,0\n1,0\n1,1\n")


def test_too_large(load, monkeypatch):
    monkeypatch.setattr("profiletool.profile.drawing.load.MAX_BYTES", 10)
    with pytest.raises(UnreadableInput, match="larger than"):
        load("a.csv", "0,0\n1,0\n1,1\n2,2\n")


def test_importing_is_cheap():
    code = (
        "import sys, profiletool.profile.drawing.load\n"
        "print([m for m in ('ezdxf', 'svgelements', 'shapely', 'scipy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def mutated(text, rng, count):
    data = bytearray(text)
    for _ in range(count):
        at = int(rng.integers(max(len(data), 1)))
        kind = rng.integers(4)
        if kind == 0:
            data[at : at + 1] = [int(rng.integers(256))]
        elif kind == 1:
            del data[at : at + int(rng.integers(1, 40))]
        elif kind == 2:
            data[at:at] = data[at : at + int(rng.integers(1, 40))]
        else:
            data[at:at] = [b"1e400", b"-", b"nan", b"9" * 30, b"\n", b"<"][int(rng.integers(6))]
    return bytes(data)


SEEDS = {
    "a.svg": svg(
        '<g transform="rotate(9) scale(2)"><path d="M0 0C0 40 30 40 30 0A9 9 0 0 1 9 9Q1 2 3 4z"/>'
        '</g><rect x="1mm" width="9" height="9" rx="2"/><use href="#a"/><circle id="a" r="4"/>'
    ),
    "a.csv": "x;y\n0;0\n10,5;0\n10;-5,25\n",
    "a.dxf": dxf_text(
        lambda msp: (
            msp.add_circle((0, 0), 20),
            msp.add_open_spline([(0, 0), (0, 4), (3, 4), (3, 0)]),
            msp.add_lwpolyline([(0, 0, 1), (2, 0, 0)], format="xyb"),
            msp.add_ellipse((1, 2), major_axis=(2, 0), ratio=0.5),
            msp.add_polyline2d([(0, 0), (3, 3), (4, 0)]),
        )
    ),
}


@pytest.mark.parametrize(("name", "rounds"), [("a.svg", 250), ("a.csv", 250), ("a.dxf", 25)])
def test_damage_ends_in_a_profile_or_one_line(load, capfd, name, rounds):
    rng = np.random.default_rng(7)
    seed, messages = SEEDS[name].encode(), []
    for _ in range(rounds):
        try:
            found = load(name, mutated(seed, rng, int(rng.integers(1, 12))))
        except (UnreadableInput, NoObject) as failure:
            messages.append(str(failure))
        else:
            assert np.all(np.isfinite(found.points))
    assert all(message.isprintable() for message in messages)
    assert capfd.readouterr() == ("", "")
