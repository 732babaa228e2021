"""Options as the report lists them."""

from __future__ import annotations

from pathlib import Path

from profiletool.pipeline import Request
from profiletool.records.request import TubeSpec
from profiletool.report.asked import options_of


def test_options_that_differ_are_told_and_the_main_ones_always() -> None:
    plain = options_of(Request(Path("a.png")))
    assert not any(option.changed for option in plain)
    assert {"--side", "--max-pressure", "--joints", "--verify"} <= {o.name for o in plain}
    assert "--place-step" not in {option.name for option in plain}
    asked = Request(
        Path("a.png"), place_step_mm=2.0, tube=TubeSpec(max_pressure_bar=1.2), verify=False
    )
    changed = {o.name: (o.value, o.usual) for o in options_of(asked) if o.changed}
    assert changed == {
        "--place-step": ("2 mm", "the gauze's pitch, or 1 mm"),
        "--max-pressure": ("1.2 bar", "2 bar"),
        "--verify": ("no", "yes"),
    }
