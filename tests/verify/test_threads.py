"""Single threads of a design's sectors by finite elements, and what the design says of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fem.gauze import AxialLines
from profiletool.joints.threads import threads_of, whole_angles
from profiletool.records.built import BuiltMisfit
from profiletool.records.design import Design
from profiletool.verify.threads import (
    even_lines,
    sheet_lines,
    sheet_off,
    threads_note,
    threads_off,
)
from profiletool.verify.tube import actuator_of
from tests.verify.test_check import short


@pytest.fixture(scope="module")
def design(samples: Path) -> Design:
    return short(samples, bar=0.3)


@pytest.mark.parametrize(("threads", "on_plane"), [(7, True), (8, False)])
def test_even_threads_lie_about_the_plane(design: Design, threads: int, on_plane: bool) -> None:
    step = np.degrees(2.0 / 10.0)
    (joint,) = design.joints
    changed = replace(design, joints=(replace(joint, alpha_closed_deg=threads * step),))
    (angles,) = even_lines(changed).angles
    off = np.degrees(np.array(angles)) - joint.alpha_center_deg
    assert len(off) == threads
    assert np.diff(off) == pytest.approx(step)
    assert bool((np.abs(off) < 1e-9).any()) == on_plane
    assert off == pytest.approx(-off[::-1], abs=1e-9)


def test_the_sheets_threads_and_their_mirror_images_share_their_stiffness(design: Design) -> None:
    whole = whole_angles(design)
    lines = sheet_lines(design, whole)
    assert [len(own) for own in lines.angles] == [2 * len(own) for own in whole]
    count = sum(t.uncut for t in threads_of(design))
    # A thread of each of both turns: EA of polyamide, 0.25 mm thick.
    assert len(lines.angles[0]) * lines.EA == pytest.approx(count * 98.17, rel=1e-3)
    assert replace(actuator_of(design), lines=lines).in_plane


@pytest.mark.slow
def test_thin_threads_lie_on_the_smeared_line_and_coarse_ones_beside_it(design: Design) -> None:
    actuator = actuator_of(design)
    (window,) = actuator.windows
    half = 0.5 * (window.alpha + actuator.gauze.allowance)
    own = window.center + half * (2.0 * (np.arange(300) + 0.5) / 300 - 1.0)
    each = actuator.gauze.stiffness * 2.0 * half * actuator.radius / 300
    thin = threads_off(design, AxialLines((tuple(own.tolist()),), each))
    assert thin.as_set is not None
    assert thin.as_set < 5e-3
    few = AxialLines((tuple(own[::60].tolist()),), 30.0 * each)
    found = threads_off(design, few)
    assert found.as_set is not None
    assert found.trimmed is not None
    assert found.as_set > 10.0 * thin.as_set
    assert found.trimmed < found.as_set


def test_a_design_says_when_its_threads_are_far_off(design: Design) -> None:
    assert list(threads_note(BuiltMisfit(6.6, 0.4))) == []
    (note,) = threads_note(BuiltMisfit(6.61, 0.74))
    assert "0.7 mm RMS apart once the pressure is set, 6.6 before" in note


def test_threads_of_the_sheet_move_a_tube_a_little(design: Design) -> None:
    found = sheet_off(design)
    assert found.as_set is not None
    assert found.trimmed is not None
    assert 0.0 < found.trimmed < found.as_set < 1.0
