"""The commands edit, report and refine, and designs that were changed in their files."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest

from profiletool.cli.design import conclude
from profiletool.errors import Infeasible
from profiletool.pipeline import Result
from tests.calls import call, error_of
from tests.cli.inputs import arc


@pytest.mark.slow
@pytest.mark.usefixtures("coarse_mesh", "few_files")
def test_a_changed_file_is_whole_again_after_report(tmp_path: Path) -> None:
    made = call("design", arc(tmp_path), "--diameter", 10, "--wall", 1, "--pitch", 1, "--no-refine")
    assert made.exit_code in (0, 6), made.stderr
    folder, other = tmp_path / "arc_design", tmp_path / "other"
    tree = json.loads((folder / "design.json").read_text())
    assert tree["verified"]
    assert call("template", folder, "--out", "good").exit_code == 0
    assert "NOT VERIFIED" not in (tmp_path / "good" / "template.svg").read_text()[:500]

    shutil.copytree(folder, other)
    changed = tree | {"pressure_bar": round(0.9 * tree["pressure_bar"], 2)}
    (other / "design.json").write_text(json.dumps(changed))
    result = call("template", other, "--out", "bad")
    assert result.exit_code == 0
    assert "note: NOT VERIFIED: it was changed since" in result.stderr
    assert "NOT VERIFIED</title>" in (tmp_path / "bad" / "template.svg").read_text()
    assert call("trim", other, "--tip", "1,2", "--at", 1.0).exit_code == 3
    result = call("report", other, "--out", "whole", "--json")
    assert result.exit_code in (0, 6), result.stderr
    again = json.loads(result.stdout)
    assert again["verified"]
    assert again["pressure_bar"] == changed["pressure_bar"]
    assert again["source"] == tree["source"]
    assert call("template", "whole", "--out", "made").stderr.startswith("written")

    result = call("refine", "whole", "--out", "better", "--json")
    assert result.exit_code in (0, 6), result.stderr
    refined = json.loads(result.stdout)
    assert refined["verified"]
    threads = refined["joints"][0]["alpha_closed_deg"] / math.degrees(1.0 / 5.0)
    assert threads == pytest.approx(round(threads), abs=1e-4)


def test_bad_changes_are_bad_usage(egg, tmp_path: Path) -> None:
    for words, says in (
        (("--alpha", 90), "--joint goes with one or more of --alpha, --openF, --move and"),
        (("--change", "3:alpha"), "expected a change such as 3:alpha=103"),
        (("--change", "99:alpha=90"), "--joint must be 1 to"),
        (("--joint", 99, "--alpha", 90), "--joint must be 1 to"),
        ((), "nothing to change"),
    ):
        result = call("edit", egg.folder, *words)
        assert result.exit_code == 2
        assert says in error_of(result)


def test_a_design_without_its_target_is_refused(egg, tmp_path: Path) -> None:
    shutil.copy(egg.folder / "design.json", tmp_path / "alone.json")
    result = call("report", tmp_path / "alone.json")
    assert result.exit_code == 3
    assert "shape.csv" in error_of(result)


@pytest.mark.parametrize(
    ("again", "says"),
    [
        ("edited", "the design as it was changed is beyond the limits (too far); it is in"),
        ("report", "the design is beyond the limits"),
        ("refined", "design chooses joints anew"),
        ("", "no design within the limits (too far); the best attempt is in"),
    ],
)
def test_a_refusal_says_what_was_judged(again: str, says: str, tmp_path: Path) -> None:
    found = SimpleNamespace(
        design=SimpleNamespace(warnings=()), reasons=("too far",), ways=None, check=None
    )
    with pytest.raises(Infeasible) as refused:
        conclude(cast(Result, found), tmp_path, lambda line: None, again)
    assert says in str(refused.value)
    assert "marked infeasible" in str(refused.value)
