"""The axial threads of the sheet: template and count agree, turn by turn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from profiletool.joints.roll import roll_of
from profiletool.joints.threads import thread_rolls, threads_of, whole_angles
from profiletool.template.unroll import slits
from tests.template.designs import bulb, design_of, joint, short_tube


@pytest.mark.parametrize("design", [bulb(), short_tube()])
def test_every_thread_is_cut_by_the_template_or_counted(design) -> None:
    tube, gauze = design.tube, design.gauze
    roll = roll_of(tube, gauze)
    y = gauze.pitch_mm * (np.arange(200) + 0.5)
    y = y[y <= roll.length_mm]
    turn = (roll.phi_deg(y) // 360.0).astype(int)
    found = threads_of(design)
    assert [(t.joint, t.turn) for t in found] == [
        (j.number, k + 1) for j in design.joints for k in range(gauze.turns)
    ]
    cuts = slits(design.joints, tube, gauze)
    for threads in found:
        row = [s for s in cuts if s.joint == threads.joint]
        x = row[0].x_mm
        severed = np.zeros(len(y), dtype=bool)
        for slit in (s for s in row if s.x_mm == x):
            severed |= (y >= slit.y_start_mm) & (y <= slit.y_end_mm)
        assert threads.uncut == int((~severed & (turn == threads.turn - 1)).sum())


def test_angles_and_phases_lie_in_the_sector() -> None:
    design = bulb()
    for one, angles in zip(design.joints, whole_angles(design), strict=True):
        apart = (angles - one.alpha_center_deg + 180.0) % 360.0 - 180.0
        assert np.abs(apart).max() < 0.5 * one.alpha_closed_deg
        own = [t for t in threads_of(design) if t.joint == one.number]
        assert sum(t.uncut for t in own) == len(angles)
        first = min(apart) + 0.5 * one.alpha_closed_deg
        assert min(t.phase_deg for t in own) == pytest.approx(first, abs=1e-3)


def test_threads_lie_half_a_pitch_off_the_start_edge() -> None:
    one = design_of((joint(alpha=180.0, at=20.0),), 40.0)
    gauze = replace(one.gauze, seam_deg=90.0, turns=1, thread_mm=0.02)
    rolls = thread_rolls(one.tube, gauze)
    # A turn is 2 pi 10.01 mm: 31 threads and the middle of a mesh short of the 32nd.
    assert len(rolls) == 31
    assert rolls[0] == pytest.approx(np.degrees(1.0 / 10.01), rel=1e-4)
    # The sector is 180 .. 360 deg: the half turn from 90 deg of the sheet on, 15.7 pitches.
    (found,) = threads_of(replace(one, gauze=gauze))
    step, first = np.degrees(2.0 / 10.01), np.degrees(1.0 / 10.01)
    count = np.ceil((270.0 - first) / step) - np.ceil((90.0 - first) / step)
    assert found.uncut == count
    assert found.phase_deg == pytest.approx((first - 90.0) % step, abs=0.05)


def test_all_threads_of_an_all_but_closed_sector_are_cut() -> None:
    one = design_of((joint(alpha=1e-3, at=20.0),), 40.0)
    assert [(t.uncut, t.phase_deg) for t in threads_of(one)] == [(0, 0.0)] * 2
