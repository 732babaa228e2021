"""Designs from Python: files, arrays and profiles, as a notebook makes them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from profiletool import (
    DrawnLine,
    Profile,
    Request,
    design,
    figures_of,
    files_of,
    find_subject,
    load_design,
    measure_pictures,
    plan_joints,
    readings_of,
    trim_pressure,
    verify_design,
)
from profiletool.errors import NoObject, NoScale, UnreadableInput, UsageError
from profiletool.pipeline import Result
from tests.subject.tube.drawn import MM_PER_PX, family, picture

T = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
EGG = np.column_stack([30.0 * np.cos(T) * (1.0 - 0.15 * np.sin(T)), 42.0 * np.sin(T)])


@pytest.fixture(scope="module")
def made(samples: Path) -> Result:
    return design(Request(samples / "egg.png", verify=False))


@pytest.mark.slow
def test_a_file_by_its_name_gives_what_the_command_gives(made: Result, samples: Path) -> None:
    assert not made.design.verified
    assert made.design.source.file == "egg.png"
    again = design(str(samples / "egg.png"), verify=False, side="left", joints=None)
    assert again.design == made.design
    with pytest.raises(UsageError, match="a request holds all options"):
        design(Request(samples / "egg.png", verify=False), side="right")


@pytest.mark.slow
def test_a_picture_as_an_array_is_the_same_picture(made: Result, samples: Path) -> None:
    with Image.open(samples / "egg.png") as image:
        rgba = np.array(image.convert("RGBA"))
    mm_per_px = made.design.source.mm_per_px
    given = design(rgba, mm_per_px=mm_per_px, verify=False)
    assert given.design.joints == made.design.joints
    assert given.design.source.file == "picture"
    assert given.design.source.sha256 != made.design.source.sha256
    with pytest.raises(NoScale):
        design(rgba, verify=False)
    darker = rgba.copy()
    darker[0, 0, 0] ^= 1
    other = find_subject(darker, mm_per_px=mm_per_px)
    assert other.profile.length_mm == pytest.approx(made.subject.profile.length_mm, abs=0.01)


def test_points_are_a_drawn_line() -> None:
    closed = find_subject(np.vstack([EGG, EGG[:1]]), side="right").profile
    assert closed.side == "right"
    assert closed.outline is not None
    # From the top down to where the outline faces down to within 45 degrees.
    down = np.vstack([EGG[100::-1], EGG[:-100:-1]])
    steps = np.diff(down, axis=0)
    facing = np.degrees(np.arctan2(steps[:, 0], -steps[:, 1])) > -45.0
    expected = float(np.hypot(*steps[facing].T).sum())
    assert closed.length_mm == pytest.approx(expected, abs=1.0)
    open_ = find_subject(EGG[100:300]).profile
    assert open_.outline is None
    assert find_subject(EGG[100:300].tolist()).profile.length_mm == open_.length_mm
    drawing = find_subject(DrawnLine(EGG, closed=True), side="right").profile
    assert drawing.length_mm == pytest.approx(closed.length_mm, abs=1e-6)


@pytest.mark.parametrize(
    ("array", "error", "says"),
    [
        (np.zeros((4, 5, 7), np.uint8), UsageError, "an array is a picture"),
        (np.zeros((40, 50, 3)), UsageError, "float64"),
        (3, UsageError, "an array is a picture"),
        (np.full((9, 2), np.nan), UnreadableInput, "not finite"),
        (np.zeros((2, 2)), UnreadableInput, "points"),
        (np.array([[0, 0], [9, 9], [9, 0], [0, 9.0]]), NoObject, "crosses"),
    ],
)
def test_arrays_that_are_neither(array: np.ndarray, error: type[Exception], says: str) -> None:
    with pytest.raises(error, match=says):
        design(array)


@pytest.mark.slow
def test_the_steps_one_by_one(made: Result, samples: Path) -> None:
    profile = find_subject(samples / "egg.png").profile
    assert isinstance(profile, Profile)
    plan = plan_joints(profile)
    assert plan.layout == made.plan.layout
    other = design(profile, verify=False)
    assert other.design.joints == made.design.joints
    assert other.design.source.side == "left"
    assert plan_joints(profile, method="paper").by == "formula"
    mirrored = find_subject(samples / "egg.png", side="right").profile
    assert design(mirrored, verify=False, method="paper").design.source.side == "right"


@pytest.mark.slow
def test_files_as_bytes(made: Result, tmp_path: Path) -> None:
    files = files_of(made)
    assert files["overlay.png"].startswith(b"\x89PNG")
    (tmp_path / "design.json").write_bytes(files["design.json"])
    read = load_design(tmp_path / "design.json")
    assert len(read.joints) == len(made.design.joints)


def test_figures_for_a_notebook(made: Result) -> None:
    figures = figures_of(made)
    assert list(figures) == ["overlay", "error_along_arc", "trade_off"]
    assert all(isinstance(figure, Figure) for figure in figures.values())
    assert figures["overlay"].axes[0].get_aspect() == 1.0
    assert "egg.png" in str(made)
    assert "NOT VERIFIED" in str(made)
    assert len(repr(made)) < 120
    assert made._repr_html_().startswith("<pre>egg.png: ")


def test_a_wrong_option_is_named() -> None:
    with pytest.raises(UsageError, match="'heigth_mm' is no option of a design"):
        design("egg.png", heigth_mm=90)


@pytest.mark.slow
def test_a_joint_changed_by_hand_is_verified_anew(made: Result) -> None:
    profile = made.subject.profile
    first, *others = made.design.joints
    changed = replace(made.design, joints=(replace(first, alpha_closed_deg=150.0), *others))
    check = verify_design(changed, profile)
    assert check.failure is None
    assert check.design.verified
    assert check.design.joints[0].theta_formula_deg < first.theta_formula_deg
    assert check.design.fit.fe is not None
    assert made.design.fit.fe is None
    assert check.shape is not None
    # A verdict never stands for perfect parts alone.
    assert check.design.built is not None
    assert check.design.built.expected_rms_mm.as_set > check.design.fit.fe.rms_mm
    assert check.design.sensitivity
    moved = replace(made.design, joints=(replace(first, centre_mm=first.centre_mm - 1.0), *others))
    again = verify_design(moved, profile.points).design
    assert again.tube.root_mm == first.centre_mm - 1.0
    assert again.joints[0].F_mm == pytest.approx(first.F_mm + 1.0)
    (row,) = (row for row in again.trim if row.pressure_bar == again.pressure_bar)
    assert trim_pressure(again, tip_mm=row.tip_mm, at_bar=row.pressure_bar).stiffness == (
        pytest.approx(1.0, abs=1e-3)
    )


@pytest.mark.parametrize(
    ("pictures", "bars", "says"),
    [
        (["a.jpg"], [0.3, 0.6], "one pressure for each"),
        (["a.jpg", "b.jpg"], [0.6, 0.3], "rising"),
        ([], [], "0 to 20 bar"),
        (["a.jpg"], [0.0], "at rest tells nothing"),
        (["a.jpg"], [float("nan")], "0 to 20 bar"),
        ([np.zeros((4, 5))], [0.6], "uint8, not"),
    ],
)
def test_pictures_that_cannot_be_measured(
    samples: Path, pictures: list[str], bars: list[float], says: str
) -> None:
    bulb = load_design(samples / "paper_bulb.json")
    with pytest.raises(UsageError, match=says):
        measure_pictures(bulb, pictures, bars, mm_per_px=0.2, fe=False)


def test_times_rise(samples: Path) -> None:
    bulb = load_design(samples / "paper_bulb.json")
    with pytest.raises(UsageError, match="times_s"):
        measure_pictures(bulb, ["a.jpg"] * 2, [0.6] * 2, times_s=[1.0, 1.0], fe=False)


@pytest.mark.slow
def test_pictures_are_measured_and_read(samples: Path) -> None:
    bulb = load_design(samples / "paper_bulb.json")
    known = family(samples)
    shot = picture(known, 0.8)
    seen = measure_pictures(bulb, [shot.rgb], [0.8], mm_per_px=MM_PER_PX, fe=False)
    readings = readings_of(seen)
    assert [one.joint for one in readings] == [1, 2, 3, 4, 5, 6]
    for one, true in zip(readings, known.theta_deg(0.8, np.zeros(6)), strict=True):
        assert abs(one.theta_deg - true) < 3.0 * one.sigma_deg
    one, *others = seen[0].angles
    lost = replace(seen[0], angles=(replace(one, state="lost"), *others))
    assert [reading.joint for reading in readings_of([lost])] == [2, 3, 4, 5, 6]
