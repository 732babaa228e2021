"""Sampled builds: tasks, outcomes as files, and what is made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from profiletool.campaign.build_kind import BUILD_RUN, BuildTask
from profiletool.campaign.builds import sample_builds
from profiletool.files.design_json import load_design
from profiletool.records.built import BuildErrors, Built
from profiletool.records.design import Design
from profiletool.report.sampled import samples_text, samples_tree
from profiletool.verify.built import P95
from profiletool.verify.sample import SampledBuild

POINTS = np.array([[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]])


@pytest.fixture(scope="module")
def design(samples: Path) -> Design:
    return load_design(samples / "paper_bulb.json")


def asked(design: Design, count: int = 5) -> list[BuildTask]:
    tasks: list[BuildTask] = []

    def keep(some: Sequence[BuildTask]) -> list[SampledBuild]:
        tasks.extend(some)
        return [SampledBuild(1.0, 0.5)] * len(some)

    sample_builds(design, POINTS, BuildErrors(), count, keep)
    return tasks


def test_each_build_is_a_task_of_its_own(design: Design) -> None:
    tasks = asked(design)
    assert len({BUILD_RUN.key(task) for task in tasks}) == 5
    assert [BUILD_RUN.key(task) for task in asked(design)] == [BUILD_RUN.key(t) for t in tasks]
    moved = replace(design, pressure_bar=design.pressure_bar + 0.01)
    assert BUILD_RUN.key(asked(moved)[0]) != BUILD_RUN.key(tasks[0])


@pytest.mark.parametrize(
    "found", [SampledBuild(1.25, 0.1 + 0.2), SampledBuild(np.nan, np.nan, "it does not bear it")]
)
def test_outcomes_are_read_as_they_were_written(found: SampledBuild) -> None:
    data = BUILD_RUN.write(found)
    again = BUILD_RUN.read(data)
    assert again.failure == found.failure
    assert np.array_equal(again.trimmed_mm, found.trimmed_mm, equal_nan=True)
    with pytest.raises(ValueError, match=r"."):
        BUILD_RUN.read(data[:-3] + b"0" + data[-2:])


def test_the_mean_square_and_the_95th_hundredth_of_those_that_could_be_bent(
    design: Design,
) -> None:
    known = [SampledBuild(float(k), 0.1 * k) for k in range(1, 5)]
    known.append(SampledBuild(np.nan, np.nan, "limit point at 1.90 bar"))
    found = sample_builds(design, POINTS, BuildErrors(), 5, lambda _: known)
    assert found.samples == 4
    assert found.expected_rms_mm.as_set == pytest.approx(np.sqrt(30.0 / 4.0), abs=1e-3)
    assert found.p95_rms_mm.trimmed == pytest.approx(np.percentile([0.1, 0.2, 0.3, 0.4], P95))
    linear = Built(BuildErrors(), found.p95_rms_mm, found.expected_rms_mm, ())
    text = samples_text(found, linear)
    assert "not among them: 1 (limit point at 1.90 bar)" in text
    assert samples_tree(found, linear)["samples"]["samples"] == 4


def test_where_none_could_be_bent_nothing_is_known(design: Design) -> None:
    lost = [SampledBuild(np.nan, np.nan, "no equilibrium")] * 2
    found = sample_builds(design, POINTS, BuildErrors(), 2, lambda _: lost)
    assert found.samples == 0
    assert found.expected_rms_mm.as_set is None
