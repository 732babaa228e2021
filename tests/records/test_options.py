"""The registry of options: every field of a request once, its checks, and words for it."""

from __future__ import annotations

import re
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import pytest

from formula.files import load_formula
from profiletool.errors import UsageError
from profiletool.records.built import BuildErrors
from profiletool.records.making import check_request, check_scale, request_of
from profiletool.records.options import DESIGN, FLAGS, in_flags
from profiletool.records.request import Request, ScaleRequest, TubeSpec

NO_OPTIONS = {"file", "given", "tube.thread_mm", "tube.turns", "tube.rubber"}
REQUEST = Request(Path("a.png"))


def paths_of(record: object, prefix: str = "") -> set[str]:
    found = set()
    for field in fields(record):  # type: ignore[arg-type]
        value = getattr(record, field.name)
        nested = is_dataclass(value) and not isinstance(value, BuildErrors)  # one option holds it
        found |= paths_of(value, f"{field.name}.") if nested else {prefix + field.name}
    return found


def test_every_field_of_a_request_is_one_option() -> None:
    paths = [row.path for row in DESIGN]
    assert len(set(paths)) == len(paths)
    assert set(paths) == paths_of(REQUEST) - NO_OPTIONS
    assert len({row.field for row in DESIGN}) == len({row.flag for row in DESIGN}) == len(DESIGN)


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        ({"pressure_bar": 2.2}, "2.2 bar is more than the highest, 2 bar: lower it, or raise"),
        ({"pressure_bar": 1.5, "max_pressure_bar": 1.2}, "more than the highest, 1.2 bar"),
        ({"pressure_bar": 1.234}, "comes in steps of 0.01 bar, not 1.234"),
        ({"pressure_bar": 0.0}, "must be a number above 0"),
    ],
)
def test_a_pressure_that_cannot_be_kept(asked: dict[str, float], says: str) -> None:
    with pytest.raises(UsageError, match=says):
        check_request(request_of(Path("a.png"), asked))


def test_the_core_names_only_fields_that_have_a_flag() -> None:
    root = Path(__file__).parents[2] / "profiletool"
    for file in sorted(root.rglob("*.py")):
        if file.parent.name in ("cli", "records"):
            continue
        for line in file.read_text("utf-8").splitlines():
            code = line.partition("  #")[0]
            if re.match(r'\s+(raise|yield)?.*f?".*`\w+`', code) and '"""' not in code:
                for name in re.findall(r"`(\w+)`", code):
                    assert name in FLAGS, f"{file}: {line.strip()}"


def test_the_core_speaks_no_command_line() -> None:
    root = Path(__file__).parents[2] / "profiletool"
    flags = re.compile("|".join(re.escape(flag) + r"\b" for flag in FLAGS.values()))
    allowed = {"cli", "records", "studio"}  # the page shows the commands that do the same
    spoken = [
        f"{file.name}: {line.strip()}"
        for file in sorted(root.rglob("*.py"))
        if file.parent.name not in allowed and file.name != "response_runs.py"
        for line in file.read_text("utf-8").splitlines()
        if flags.search(line)
    ]
    assert spoken == []


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"height_mm": 0.0}, "`height_mm` must be a number above 0, not 0"),
        ({"tolerance_mm": float("nan")}, "`tolerance_mm` must be a number above 0, not nan"),
        ({"clearance_mm": -1.0}, "`clearance_mm` must be 0 or more, not -1"),
        ({"alpha_step_deg": float("inf")}, "`alpha_step_deg` must be 0 or more, not inf"),
        ({"joints": 0}, "`joints` must be 1 or more, not 0"),
        ({"pitch_mm": 0.25}, "`pitch_mm` must be more than the thread, 0.25 mm"),
        ({"wall_mm": 10.0}, "`wall_mm` must be less than half of `outer_diameter_mm`"),
        ({"start_pct": 50.0, "end_pct": 50.0}, "`start_pct` and `end_pct` must be percentages"),
        ({"end_pct": 101.0}, "`start_pct` and `end_pct` must be percentages"),
    ],
)
def test_values_that_no_design_can_be_made_with(values: dict[str, float], words: str) -> None:
    with pytest.raises(UsageError) as caught:
        check_request(request_of(Path("a.png"), values))
    assert str(caught.value).startswith(words)


def test_values_at_their_bounds_are_good() -> None:
    check_request(REQUEST)
    bounds = {"clearance_mm": 0.0, "joints": 1, "wall_mm": 9.99, "pitch_mm": 0.26, "end_pct": 100.0}
    check_request(request_of(Path("a.png"), bounds))


def test_a_scale_is_judged_alone_too() -> None:
    check_scale(ScaleRequest())
    with pytest.raises(UsageError, match="`marker_mm` must be a number above 0"):
        check_scale(ScaleRequest(marker_mm=-4.0))


def test_a_request_from_values_by_field_name() -> None:
    values = {"height_mm": 90.0, "box": (1.0, 2.0, 3.0, 4.0), "joints": 5, "root_mm": 12.0}
    made = request_of(Path("a.png"), values | {"wall_mm": None, "tolerance_mm": None})
    assert made == replace(
        REQUEST,
        scale=ScaleRequest(height_mm=90.0),
        look=replace(REQUEST.look, box=(1.0, 2.0, 3.0, 4.0)),
        joints=5,
        tube=TubeSpec(root_mm=12.0),
    )
    with pytest.raises(UsageError, match="'heigth_mm' is no option of a design; there are height"):
        request_of(Path("a.png"), {"heigth_mm": 90.0})


def test_the_tube_is_the_formulas_where_no_other_is_given() -> None:
    formula = replace(load_formula(), outer_diameter_mm=16.0, wall_mm=1.6)
    assert request_of(Path("a"), {}, formula).tube == TubeSpec(16.0, 1.6)
    assert request_of(Path("a"), {"wall_mm": 2.5}, formula).tube == TubeSpec(16.0, 2.5)


def test_fields_of_a_message_become_flags() -> None:
    told = "shorten it (`start_pct`, `end_pct`), raise `max_length_mm`, or see `design`"
    assert in_flags(told) == "shorten it (--from, --to), raise --max-length, or see `design`"
    assert in_flags("no field in here") == "no field in here"
