"""Drawings as CSV."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from profiletool.errors import UnreadableInput
from profiletool.profile.drawing.load import load_vector


@pytest.mark.parametrize(
    "text",
    [
        "0,0\n10,0\n10,-5\n",
        "x_mm,y_mm\n0,0\n10,0\n10,-5\n",
        "\ufeffx;y\n0;0\n10,0;0\n1,0e1;-5\n",
        "# note\n\n0\t0\r\n10\t0\r\n10\t-5\r\n",
        "0 0\n10   0\n  10 -5 # the end\n",
        "0,0\r10,0\r10,-5\r",
        "0.;.0\n+10;0\n10;-5,0\n",
    ],
)
def test_csv_dialects(load, text):
    found = load("a.csv", text)
    assert found.points.tolist() == [[0, 0], [10, 0], [10, -5]]
    assert found.closed is False


def test_csv_header_in_latin_1(load):
    assert load("a.CSV", "höhe,x\n0,0\n1,0\n1,1\n".encode("latin-1")).points.shape == (3, 2)


def test_csv_closed_when_the_last_point_is_the_first(load):
    found = load("a.csv", "0,0\n10,0\n10,0\n10,10\n0,10\n0,0\n")
    assert found.closed
    assert found.points.tolist() == [[0, 0], [10, 0], [10, 10], [0, 10]]


@given(
    x=st.lists(st.floats(0.1, 100), min_size=3, max_size=30),
    y=st.lists(st.floats(-1000, 1000), min_size=30, max_size=30),
    style=st.sampled_from([",", ";", "\t", " ", "; comma"]),
)
def test_csv_round_trip(tmp_path_factory, x, y, style):
    points = np.column_stack([np.cumsum(x), y[: len(x)]])
    separator = style[0]
    lines = [separator.join(repr(float(v)) for v in row) for row in points]
    text = "\n".join(lines)
    path = tmp_path_factory.mktemp("csv") / "a.csv"
    path.write_text(text.replace(".", ",") if "comma" in style else text)
    found = load_vector(path)
    assert not found.closed
    np.testing.assert_array_equal(found.points, points)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0,0\n1,zwei\n2,2\n", "line 2: 'zwei' is no number"),
        ("0,0\n1,1\n\n2,nan\n", "line 4: 'nan' is not finite"),
        ("x,y\n0,-Infinity\n1,1\n2,2", "line 2: '-Infinity' is not finite"),
        ("0,0\n1,1,1\n2,2\n", "line 2 holds 3 fields"),
        ("0,0\n1,5 2,5\n2,2\n", "line 2 holds 3 fields"),
        ("x,y\n" * 20 + "a,b\n0,0\n1,1\n2,2\n", "line 21: 'a' is no number"),
        ("0,0\n1_0,1\n2,2\n", "line 2: '1_0' is no number"),
        ("0,0\n١,1\n2,2\n", "line 2"),
        ("0,0\n1,1\n", "only 2 points"),
        ("x,y\n", "only 0 points"),
        ("0,0\n0,0\n1,1\n1,1\n", "only 2 distinct points"),
        ("0,0\n1,1\n1e6,2\n", "beyond"),
        ("0,0\n1,1\n1e999,2\n", "not finite"),
        (b"0,0\n1,\x001\n2,2\n", "plain text"),
        (b"\xff\xfe0\x00,\x000", "plain text"),
        ("", "empty"),
        (" \n\n", "empty"),
    ],
)
def test_csv_refused(load, text, words):
    with pytest.raises(UnreadableInput, match=r"a\.csv: ") as failure:
        load("a.csv", text)
    assert words in str(failure.value)
    assert "\n" not in str(failure.value)


def test_too_many_points(load, monkeypatch):
    monkeypatch.setattr("profiletool.profile.drawing.read_csv.MAX_POINTS", 5)
    with pytest.raises(UnreadableInput, match="more than 5 points"):
        load("a.csv", "\n".join(f"{i},0" for i in range(6)))
    with pytest.raises(UnreadableInput, match="more than 5 lines"):
        load("a.csv", "\n" * 20 + "0,0")
