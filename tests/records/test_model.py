"""The inputs of finite elements: words, directions, bounds; what the actuator becomes by them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from profiletool.errors import UnreadableInput, UsageError
from profiletool.files.design_json import from_json, load_design, to_json
from profiletool.records.design import Design
from profiletool.records.making import check_request, model_of, request_of
from profiletool.records.model import PAPER_MODEL, ModelInputs
from profiletool.verify.tube import actuator_of


@pytest.fixture(scope="module")
def bulb(samples: Path) -> Design:
    return load_design(samples / "paper_bulb.json")


@pytest.mark.parametrize(
    ("gravity", "sign", "pull"),
    [
        ("down", 1.0, (0.0, -1.0)),
        ("up", -1.0, (0.0, 1.0)),
        ("level", 1.0, (-1.0, 0.0)),
        ("level", -1.0, (1.0, 0.0)),
        ("-30", 1.0, (np.sqrt(0.75), -0.5)),
    ],
)
def test_where_gravity_pulls(gravity: str, sign: float, pull: tuple[float, float]) -> None:
    assert ModelInputs(gravity=gravity).pull(sign) == pytest.approx(pull, abs=1e-12)


def test_no_gravity_no_pull() -> None:
    assert PAPER_MODEL.pull(1.0) is None
    assert str(PAPER_MODEL) == ""


def test_changes_in_words() -> None:
    model = ModelInputs(nu=0.499, thread_factor=0.5, sector_extra_deg=0.0, gravity="level")
    assert str(model) == (
        "Poisson's ratio 0.499, threads 0.5 times as stiff, sectors 0 deg wider than alpha, "
        "gravity level"
    )


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"nu": 0.5}, "`nu` must be 0 to 0.4999, not 0.5"),
        ({"nu": float("nan")}, "`nu` must be"),
        ({"thread_factor": 0.0}, "`thread_factor` must be"),
        ({"thread_factor": 101.0}, "`thread_factor` must be 0.01 to 100, not 101"),
        ({"sector_extra_deg": -1.0}, "`sector_extra_deg` must be"),
        ({"gravity": "sideways"}, "`gravity` must be none, down, up, level or an angle in deg"),
        ({"gravity": "nan"}, "`gravity` must be"),
    ],
)
def test_inputs_that_make_no_sense(values: dict[str, object], words: str) -> None:
    with pytest.raises(UsageError) as caught:
        check_request(request_of(Path("a.png"), values))
    assert str(caught.value).startswith(words)
    with pytest.raises(UsageError):
        model_of(values, PAPER_MODEL)


def test_what_is_not_given_stays_the_designs() -> None:
    known = ModelInputs(nu=0.48, gravity="down")
    assert model_of({"nu": None, "thread_factor": 2.0}, known) == replace(known, thread_factor=2.0)
    with pytest.raises(UsageError, match="'pitch_mm' is no input"):
        model_of({"pitch_mm": 2.0}, known)


def test_the_actuator_takes_them(bulb: Design) -> None:
    usual = actuator_of(bulb)
    made = actuator_of(
        replace(bulb, model=ModelInputs(nu=0.49, thread_factor=0.5, sector_extra_deg=0.0))
    )
    # K = 2 mu (1 + nu) / (3 (1 - 2 nu)), the shear modulus kept.
    mu = usual.rubber.shear_modulus
    assert made.rubber.shear_modulus == pytest.approx(mu, rel=1e-12)
    assert made.rubber.bulk_modulus == pytest.approx(2.0 * mu * 1.49 / (3.0 * 0.02), rel=1e-9)
    assert made.gauze.stiffness == pytest.approx(0.5 * usual.gauze.stiffness, rel=1e-12)
    assert made.gauze.allowance == 0.0
    assert made.weight is None


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_tube_on_either_side_hangs_where_the_object_says(bulb: Design, side: str) -> None:
    pose = replace(bulb.base_pose, heading_deg=-90.0)
    tube = replace(bulb, base_pose=pose, source=replace(bulb.source, side=side))
    for gravity, direction in [("down", (0, 0, 1)), ("up", (0, 0, -1)), ("level", (0, 1, 0))]:
        weight = actuator_of(replace(tube, model=ModelInputs(gravity=gravity))).weight
        assert weight is not None
        assert weight.direction == pytest.approx(direction, abs=1e-12)
    # By hand: 118 mm of tube and gauze weigh some 15.4 g.
    assert weight is not None
    grams = (
        1e3
        / 9.81
        * (
            weight.rubber * np.pi * ((100.0 - 64.0) * 117.0 + 100.0)
            + weight.gauze * 2.0 * np.pi * 10.0 * 118.0
        )
    )
    assert grams == pytest.approx(15.4, abs=0.6)


def test_design_json_keeps_them_and_older_files_have_the_papers(bulb: Design) -> None:
    changed = replace(bulb, model=ModelInputs(nu=0.49, gravity="up"))
    assert from_json(to_json(changed), "d").model == changed.model
    assert bulb.model == PAPER_MODEL
    wrong = to_json(changed).replace('"nu": 0.49', '"nu": 0.7')
    with pytest.raises(UnreadableInput, match=r"d: model: .nu. must be"):
        from_json(wrong, "d")
