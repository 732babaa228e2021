"""Options as the page sends them, and as TOML that the command line reads back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from profiletool import api, pipeline
from profiletool.errors import ProfiletoolError, UsageError
from profiletool.records.options import DESIGN
from profiletool.records.request import Request
from profiletool.studio.form import checked, fields, in_words, to_toml
from tests.calls import call

# A value other than its default for every option.
OTHER: dict[str, Any] = {
    "height_mm": 107.5, "width_mm": 60.0, "mm_per_px": 0.1, "marker_mm": 40.0,
    "camera_distance_mm": 800.0, "box": [10, 20.5, 300, 400], "point": [50, 60],
    "mask": "mask_0.png", "candidate": 2, "rotate": -12.5, "symmetric": True, "flat": True,
    "layer": "0 ä\"'\\",
    "side": "right", "start_pct": 12.5, "end_pct": 80, "clearance_mm": 0.5,
    "outer_diameter_mm": 16.0, "wall_mm": 1.6, "root_mm": 12.0, "clamp_mm": 25.0,
    "pitch_mm": 2.5, "pressure_bar": 1.31, "max_pressure_bar": 1.5, "max_length_mm": 200.0,
    "formula": "paper", "extrapolate": True, "method": "paper", "joints": 4, "tolerance_mm": 0.7,
    "interference_mm": 0.2, "base_free": True, "alpha_step_deg": 5.0, "place_step_mm": 0.5,
    "objective": "nominal", "build": "thread=0.25", "verify": False, "refine": False,
    "grip": False, "grip_N": 1.5, "solid": "turned", "nu": 0.49, "thread_factor": 1.1,
    "sector_extra_deg": 5.0, "gravity": "down",
}  # fmt: skip


def test_the_command_line_reads_what_the_page_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert set(OTHER) == {row.field for row in DESIGN}
    monkeypatch.chdir(tmp_path)
    asked: list[Request] = []

    def heard(request: Request, *_: object) -> None:
        asked.append(request)
        raise ProfiletoolError("enough")

    monkeypatch.setattr(pipeline, "run", heard)
    values = checked(OTHER)
    assert values == checked(values)  # as it is read again from the work folder
    Path("1.toml").write_text(to_toml(values), "utf-8")
    call("design", "bulb.png", "--config", "1.toml")
    assert asked == [api.request_for("bulb.png", **values)]
    usual = Request(Path("bulb.png"))
    for row in DESIGN:
        assert row.value(asked[0]) != row.value(usual), row.field


def test_defaults_are_left_out() -> None:
    assert checked({"height_mm": None, "layer": "", "joints": None}) == {}
    assert to_toml({}) == ""


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ([], "by name"),
        ({"hight_mm": 3}, "'hight_mm' is no option"),
        ({"height_mm": "3"}, "a number"),
        ({"height_mm": True}, "a number"),
        ({"height_mm": float("nan")}, "usual size"),
        ({"height_mm": 1e300}, "usual size"),
        ({"height_mm": -3}, "above 0"),
        ({"joints": 2.5}, "whole number"),
        ({"joints": {}}, "a number"),
        ({"side": "up"}, "one of left, right"),
        ({"verify": "no"}, "cannot be"),
        ({"box": [1, 2, 3]}, "4 numbers"),
        ({"box": "1,2,3,4"}, "4 numbers"),
        ({"mask": "../../secret.png"}, "cannot be"),
        ({"mask": "/etc/passwd"}, "cannot be"),
        ({"formula": "/etc/passwd"}, "cannot be"),
        ({"layer": "a\nverify = false"}, "cannot be"),
        ({"layer": "a" * 1000}, "cannot be"),
        ({"build": "thread=many"}, "bounds"),
        ({"start_pct": 80, "end_pct": 20}, "percentages"),
    ],
)
def test_what_makes_no_sense_is_refused(values: Any, says: str) -> None:
    with pytest.raises(UsageError, match=says):
        checked(values)


def test_the_form_has_every_option_and_speaks_no_command_line() -> None:
    rows = fields()
    assert [row["name"] for row in rows] == [row.field for row in DESIGN]
    assert {row["kind"] for row in rows} == {"float", "int", "bool", "str", "tuple", "Path",
                                             "BuildErrors"}  # fmt: skip
    said = in_words("raise `max_length_mm` or leave `nowhere` away")
    assert said == "raise “Max length” or leave nowhere away"
