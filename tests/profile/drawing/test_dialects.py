"""Tables of points in the units and layouts of spreadsheets, instruments and programs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from profiletool.errors import NoScale, UnreadableInput
from tests.profile.drawing.egg import EGG, SIZE, size_of

RING = np.vstack([EGG, EGG[:1]])


def rows(separator: str = ",", scale: float = 1.0, form: str = "%.5f") -> str:
    return "\n".join(separator.join(form % (scale * v) for v in point) for point in RING)


def commas(separator: str, scale: float = 1.0) -> str:
    return rows(separator, scale).replace(".", ",")


@pytest.mark.parametrize(
    "text",
    [
        "# x_cm,y_cm\n" + rows(scale=0.1, form="%.6f"),
        "# x [cm] y [cm]\n" + rows(" ", 0.1, "%.6f"),
        "x (in);y (in)\n" + commas(";", 1 / 25.4),
        "x_m,y_m\n" + rows(scale=1e-3, form="%.8f"),
        "X [µm],Y [µm]\n" + rows(scale=1e3),
        "x_pt,y_pt\n" + rows(scale=72 / 25.4),
        "x,y\ncm,cm\n" + rows(scale=0.1, form="%.6f"),
        "# units: cm\nx,y\n" + rows(scale=0.1, form="%.6f"),
        "Units are inches\n\n" + rows(scale=1 / 25.4, form="%.7f"),
        "x,y,\n" + rows().replace("\n", ",\n") + ",",
        '\ufeff"X";"Y"\n' + commas(";"),
        "x,y,z\n" + rows().replace("\n", ",0\n") + ",0",
        "y,x\n" + "\n".join(f"{b:.5f},{a:.5f}" for a, b in RING),
        "t;x/mm;y/mm\n" + "\n".join(f"{n};{a:.5f};{b:.5f}" for n, (a, b) in enumerate(RING)),
        "made by a digitiser\non a Monday\n\nx y\n" + rows(" "),
        rows(", "),
        commas(" "),
        commas("\t"),
        rows(",\t"),
        "x_µm;y_µm\n" + "\n".join(f"{1e3 * a:,.2f};{1e3 * b:,.2f}" for a, b in RING),
        rows().replace("\n", "\r\n") + "\r\n,\r\n,\r\n",
        "name,x (ft),y (ft)\n" + "\n".join(f"P{n},{a / 304.8:.8f},{b / 304.8:.8f}"
                                           for n, (a, b) in enumerate(RING)),
        ("x,y\n" + rows()).encode("utf-16"),
        ("x\ty\n" + commas("\t")).encode("utf-16"),
    ],
)  # fmt: skip
def test_the_same_egg(tmp_path: Path, text: str | bytes) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    assert size_of(path) == pytest.approx(SIZE, rel=1e-3)


@pytest.mark.parametrize(("name", "unit"), [("px", "px"), ("furlong", "furlong"), ("deg", "deg")])
def test_what_is_no_length_wants_a_size(tmp_path: Path, name: str, unit: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"x [{name}],y [{name}]\n" + rows(scale=4.0))
    with pytest.raises(NoScale, match=f"the header gives '{unit}', which is no length; give"):
        size_of(path)
    assert size_of(path, height_mm=SIZE[1]) == pytest.approx(SIZE, rel=1e-3)
    assert size_of(path, mm_per_px=0.25) == pytest.approx(SIZE, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("x_mm,y_cm\n" + rows(), "two units"),
        ("x,y,z\n0,0,0\n1,1,1\n2,0,3\n", "a curve in space"),
        (rows().replace("\n", ",7\n") + ",7", "name the columns x and y in a header"),
    ],
)
def test_refused(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(UnreadableInput, match=says):
        size_of(tmp_path / "a.csv")


def test_sizes_that_contradict_each_other_are_told(
    tmp_path: Path, notes_of: Callable[..., list[str]]
) -> None:
    (tmp_path / "a.csv").write_text("x_mm,y_mm\n" + rows())
    assert notes_of(tmp_path / "a.csv") == []
    both = notes_of(tmp_path / "a.csv", height_mm=180.0, width_mm=60.0)
    assert len(both) == 2
    assert "`width_mm` is 60 mm, but at a `height_mm` of 180 mm" in both[0]
    assert f"the drawing itself is {SIZE[0]:.4g} x 90 mm" in both[1]
    assert notes_of(tmp_path / "a.csv", height_mm=90.0, width_mm=SIZE[0]) == []
