"""What is printed of a finite-element run, from numbers made up."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from profiletool.files.design_json import load_design
from profiletool.records.design import Misfit
from profiletool.records.fe import CriticalPoint, FeState, Verification
from profiletool.records.frames import Shape
from profiletool.report.fe import (
    compared_text,
    fe_json,
    fe_text,
    misfit_json,
    ranges_json,
    ranges_text,
    theta_csv,
)
from profiletool.report.figure import png
from profiletool.report.plots import Mark, theta_figure, trajectories_figure

LINE = np.column_stack([np.linspace(0.0, 90.0, 10), np.zeros(10)])
SHAPE = Shape(LINE[:, 0], LINE, LINE + np.array([0.0, 10.0]), LINE + np.array([0.0, 20.0]))


def state(bar: float, *theta: float, **change: object) -> FeState:
    at_rest = FeState(
        bar, theta, SHAPE, LINE[: len(theta) + 1] + bar, 2.0 * bar, (1.4,) * len(theta), 1.5, 0.9,
        0.02, 8.0, 1e-7, 1e-3, False,
    )  # fmt: skip
    return replace(at_rest, **change)


def run(*states: FeState, critical: CriticalPoint | None = None) -> Verification:
    rest = state(0.0, *(0.0 for _ in states[0].theta_deg))
    return Verification(rest, states, states[-1].pressure_bar, critical, 10, 99, 250, 31, 1.23456)


FINGER = run(
    state(1.0, 25.0, 28.0, 22.0), state(2.0, 79.0, 90.0, 69.0), state(2.2, 95.0, 108.0, 83.0)
)


def test_json() -> None:
    found = json.loads(
        fe_json(
            run(state(0.5, 10.0, -4.0, touches=True, overlap_mm=0.7), state(1.0, 20.123456, -9.0))
        )
    )
    assert found["theta_deg"] == [[10.0, 20.1235], [-4.0, -9.0]]
    assert found["pressure_bar"] == [0.5, 1.0]
    assert (found["elements"], found["nodes"], found["dofs"]) == (10, 99, 250)
    assert found["seconds"] == 1.235
    assert found["air_ml"] == [1.0, 2.0]
    assert found["touches"] is True  # at any pressure
    assert found["overlap_mm"] == 0.7
    assert any("touches itself from 0.50 bar on" in text for text in found["warnings"])
    assert found["theta_uncertain"] == []
    assert found["ahead"] is None
    ended = json.loads(
        fe_json(run(state(0.5, 1.0), critical=CriticalPoint("limit point", 0.61)), {"a": 1})
    )
    assert ended["converged"] is False
    assert ended["critical"] == {"kind": "limit point", "pressure_bar": 0.61}
    assert ended["a"] == 1


def test_a_run_that_ends_at_once_prints_too() -> None:
    nothing = replace(run(state(0.5, 1.0), critical=CriticalPoint("limit point", 0.01)), states=())
    assert json.loads(fe_json(nothing))["theta_deg"] == [[]]
    assert "at 0.00 bar" in fe_text(nothing)
    assert theta_csv(nothing) == b"pressure_bar,theta1_deg,air_ml\n"
    for figure in (theta_figure(nothing, "x"), trajectories_figure(nothing, "x")):
        assert png(figure).startswith(b"\x89PNG")


def test_text_and_csv() -> None:
    found = run(state(0.5, 10.0, -4.04), state(1.0, 20.0, -9.0, touches=True))
    lines = fe_text(found).splitlines()
    assert lines[1].split() == ["bar", "theta1", "theta2", "air"]
    assert lines[2].split() == ["0.50", "10.0", "-4.0", "1.0"]
    assert len({len(line) for line in lines[1:4]}) == 1
    assert any("touches itself" in line for line in lines)
    assert theta_csv(found).decode().splitlines()[1] == "0.5,10.000,-4.040,1.000"


def test_joints_too_near_to_each_other_are_marked() -> None:
    found = replace(run(state(0.5, 10.0, -4.0, 3.0)), theta_uncertain=(2, 3))
    text = fe_text(found)
    assert text.splitlines()[1].split() == ["bar", "theta1", "~theta2", "~theta3", "air"]
    assert "the angles of joints 2 and 3, marked ~" in text
    assert json.loads(fe_json(found))["theta_uncertain"] == [2, 3]


def test_what_ends_the_path_a_little_above() -> None:
    found = replace(run(state(0.5, 10.0)), ahead=CriticalPoint("limit point", 0.512))
    told = json.loads(fe_json(found))
    assert told["converged"] is True
    assert told["ahead"] == {"kind": "limit point", "pressure_bar": 0.512}
    assert told["warnings"] == ["limit point at 0.51 bar, less than 5 % above 0.50 bar"]
    assert "note: limit point at 0.51 bar" in fe_text(found)


def test_ranges_of_the_finger() -> None:
    assert ranges_json(FINGER)["range_reached_bar"] == pytest.approx(
        [1.926, 2.111, 1.915], abs=1e-3
    )
    assert "joint 2: 0 to 100 deg reached at 2.11 bar (the paper: below 2.0 bar)" in ranges_text(
        FINGER
    )
    low = replace(FINGER, states=FINGER.states[:2])
    assert ranges_json(low)["range_reached_bar"][1] is None
    assert "joint 2: 0 to 100 deg not reached" in ranges_text(low)


def test_comparison_with_a_design(samples: Path) -> None:
    design = load_design(samples / "paper_bulb.json")
    angles = (34.9, 35.4, 35.0, 29.1, 19.7, -44.3)
    text = compared_text(design, run(state(1.9, *angles)), Misfit(1.25, 3.0), "shape.csv")
    assert "6       -45.0        -45.3   -44.3" in text
    assert "off the target (shape.csv) at 1.90 bar: 1.2 mm RMS, 3.0 mm at most" in text
    other = compared_text(design, run(state(1.0, *angles)), None, None)
    assert "wanted" not in other  # at another pressure that compares nothing
    assert "no target" in other
    assert misfit_json(None, None) == {"fit": None}
    assert misfit_json(Misfit(1.0, 2.0), "a")["fit"]["target"] == "a"


@pytest.mark.slow
def test_pictures_show_what_they_are_given() -> None:
    plain = png(theta_figure(FINGER, "finger"))
    marked = png(theta_figure(FINGER, "finger", [Mark("formula", 2.0, (70.0, 80.0, 60.0))]))
    ended = png(
        theta_figure(replace(FINGER, critical=CriticalPoint("limit point", 2.25)), "finger")
    )
    assert len({plain, marked, ended}) == 3
    assert plain == png(theta_figure(FINGER, "finger"))
    many = run(state(1.0, *range(1, 13)))
    assert png(theta_figure(many, "twelve joints")).startswith(b"\x89PNG")
    assert png(trajectories_figure(many, "twelve joints")).startswith(b"\x89PNG")
