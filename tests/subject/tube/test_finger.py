"""The finger of the paper's Table 2, measured in rendered pictures of a twin."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import fem
from profiletool.records.design import Design
from profiletool.subject.tube.family import family_of
from profiletool.verify.predicted import predicted_by_fe
from tests.verify.conftest import COARSE

BENCHMARKS = Path(__file__).parents[3] / "benchmarks"


@pytest.fixture(scope="module")
def script() -> Iterator[ModuleType]:
    """Give the benchmark that renders and measures, on a coarse mesh."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(BENCHMARKS)
        patch.setattr("profiletool.verify.run.solve", partial(fem.solve, size=COARSE))
        yield importlib.import_module("bench_pictures")


def told(
    script: ModuleType, design: Design, scene: str, bars: list[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Errors and sigmas (pictures, joints), deg, of a twin's angles; none may be lost."""
    family, twin = family_of(predicted_by_fe(design, bars[-1])), script.twin_run(design, bars)
    found = script.seen_and_true(design, script.SCENES[scene], family, twin, bars)
    off, sigma = script.measured(list(found))
    shape = len(bars), len(design.joints)
    return off.reshape(shape), sigma.reshape(shape)


@pytest.mark.slow
def test_the_papers_finger_is_measured_to_half_a_degree(script: ModuleType) -> None:
    off, sigma = told(script, script.paper_finger(), "squarely", [0.6, 1.0, 1.4, 1.8])
    assert np.percentile(np.abs(off), 95) <= 0.5
    assert (np.abs(off) < 3.0 * sigma).all()
    assert np.mean(np.abs(off) < sigma) >= 0.6


@pytest.mark.slow
def test_a_short_clamped_sector_tells_how_unsure_its_direction_is(script: ModuleType) -> None:
    finger = script.paper_finger()
    first, *others = finger.joints
    first = replace(first, centre_mm=9.0, F_mm=41.0)  # 2 mm are left before its cut
    short = replace(
        finger, joints=(first, *others), tube=replace(finger.tube, root_mm=first.centre_mm)
    )
    off, sigma = told(script, short, "alone", [1.0])
    assert (np.abs(off) < 1.6 * sigma).all()
    assert 0.3 < sigma[0, 0] < 1.0
    assert sigma[0, 1:].max() < 0.2
