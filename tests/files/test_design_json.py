from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from profiletool.errors import UnreadableInput
from profiletool.files.design_json import from_json, load_design, to_json
from profiletool.records.design import Misfit, Sensitivity

SAMPLE = Path(__file__).parents[2] / "samples" / "paper_bulb.json"
OLDER = Path(__file__).parents[1] / "golden" / "design_before_optimal.json"
TREE = json.loads(SAMPLE.read_text())


def changed(**changes: Any) -> str:
    return json.dumps({**TREE, **changes})


def joints(which: int, **changes: Any) -> list[dict[str, Any]]:
    return [{**j, **changes} if j["number"] == which else j for j in TREE["joints"]]


def test_reads_back_what_it_wrote() -> None:
    design = load_design(SAMPLE)
    assert to_json(design) == SAMPLE.read_text()
    assert from_json(to_json(design), "x") == design


def test_files_of_the_first_schema_are_read() -> None:
    new = (
        "built", "operate_bar", "model", "threads", "threads_off_mm", "trim", "clamp", "seal",
        "neighbours", "grip",
    )  # fmt: skip
    tree = {key: value for key, value in TREE.items() if key not in new}
    older = from_json(json.dumps(tree | {"schema": "profiletool.design/1"}), "x")
    assert older == replace(load_design(SAMPLE), threads=())


def test_has_the_fields_of_the_contract() -> None:
    assert list(TREE) == [
        "schema", "source", "tube", "gauze", "formula", "pressure_bar", "joints", "base_pose",
        "fit", "feasible", "verified", "warnings", "method", "sensitivity", "built", "operate_bar",
        "trim", "model", "threads", "threads_off_mm", "clamp", "seal", "neighbours",
        "grip",
    ]  # fmt: skip
    assert TREE["schema"] == "profiletool.design/3"
    assert list(TREE["joints"][0]) == [
        "number", "F_mm", "openF_mm", "alpha_closed_deg", "alpha_center_deg", "theta_target_deg",
        "theta_formula_deg", "theta_fe_deg", "centre_mm", "theta_response_deg", "stretch_fe",
    ]  # fmt: skip
    assert list(TREE["fit"]) == ["formula", "fe", "response"]


def test_a_file_of_an_older_version_is_read() -> None:
    old = json.loads(OLDER.read_text())  # as the version before --method optimal wrote it
    assert not {"method", "sensitivity"} & set(old)
    assert "response" not in old["fit"]
    assert "theta_response_deg" not in old["joints"][0]
    assert load_design(OLDER) == load_design(SAMPLE)
    assert load_design(OLDER).method == "paper"


def test_what_the_optimal_method_adds_comes_back() -> None:
    design = load_design(SAMPLE)
    made = replace(
        design,
        joints=tuple(replace(j, theta_response_deg=j.number + 0.5) for j in design.joints),
        fit=replace(design.fit, response=Misfit(0.25, 0.75)),
        method="optimal",
        sensitivity=(
            Sensitivity("pressure 0.05 bar off", None, 0.4, 1.1),
            Sensitivity("joint 1 mm off its place", 3, 0.2, 0.5),
        ),
    )
    assert from_json(to_json(made), "x") == made
    tree = json.loads(to_json(made))
    assert tree["method"] == "optimal"
    assert tree["joints"][2]["theta_response_deg"] == 3.5
    assert tree["fit"]["response"] == {"rms_mm": 0.25, "max_mm": 0.75}
    assert tree["sensitivity"][1] == {
        "what": "joint 1 mm off its place", "joint": 3, "rms_mm": 0.2, "max_mm": 0.5,
    }  # fmt: skip


def test_no_negative_zero_and_no_noise_in_the_last_bits() -> None:
    design = load_design(SAMPLE)
    tiny = replace(design, base_pose=replace(design.base_pose, x_mm=-1e-12, y_mm=0.1 + 0.2))
    pose = json.loads(to_json(tiny))["base_pose"]
    assert str(pose["x_mm"]) == "0.0"
    assert str(pose["y_mm"]) == "0.3"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", "not JSON"),
        ("[" * 100_000, "not JSON"),
        ("[]", "schema"),
        (changed(schema="other/2"), "schema"),
        (changed(tube=None), "tube"),
        (changed(joints=[]), "no joints"),
        (changed(pressure_bar="high"), "pressure_bar"),
        (changed(joints=joints(2, openF_mm="wide")), r"joints\.1\.openF_mm"),
        (changed(joints=joints(3, centre_mm=32.0)), "joint 3 overlaps"),
        (changed(joints=joints(6, centre_mm=102.0)), "joint 6 lies beyond"),
        (changed(joints=joints(4, alpha_closed_deg=360)), "joint 4: alpha_closed_deg"),
        (changed(joints=joints(1, openF_mm=-8)), "joint 1 overlaps"),
        (changed(tube={**TREE["tube"], "length_mm": float("nan")}), "NaN is no number"),
        (changed(tube={**TREE["tube"], "length_mm": 1e5}), "such sizes"),
        (changed(tube={**TREE["tube"], "wall_mm": 10}), "such sizes"),
        (changed(gauze={**TREE["gauze"], "turns": 0}), "such sizes"),
        (changed(gauze={**TREE["gauze"], "thread_mm": 2}), "such sizes"),
        (changed(gauze={**TREE["gauze"], "pitch_mm": 1e-4}), "such sizes"),
        (changed(joints=joints(2, number=7)), "joint 7 stands where 2"),
        (changed(joints=joints(2, alpha_center_deg=1e300)), "joint 2: alpha_center_deg"),
        (changed(joints=joints(2, theta_response_deg="x")), r"joints\.1\.theta_response_deg"),
        (changed(sensitivity={"x": 1}), "sensitivity"),
        (changed(grip={"solid": "round"}), r"grip\.solid"),
        (changed(grip={"force_N": 0.0}), "grip: no force"),
        (changed(grip={"side": "left"}), r"grip\.side: no key"),
    ],
)
def test_what_is_no_design_is_refused_by_name(text: str, says: str) -> None:
    with pytest.raises(UnreadableInput, match=says) as caught:
        from_json(text, "x.json")
    assert "\n" not in str(caught.value)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(UnreadableInput, match="cannot read"):
        load_design(tmp_path / "absent.json")
    with pytest.raises(UnreadableInput, match="cannot read"):
        load_design(tmp_path)
    (tmp_path / "big.json").write_bytes(b" " * 6_000_000)
    with pytest.raises(UnreadableInput, match="too large"):
        load_design(tmp_path / "big.json")
