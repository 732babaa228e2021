"""What a derivative is taken by: one number of an actuator changed, and all beyond moved on."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fem.actuator import Actuator, chain
from fem.parameters import families

TUBE = chain(
    10.0, [19.0, 12.0], [8.0, 6.0], np.radians([132.0, 120.0]), np.radians([270.0, 90.0]), end=4.0
)


def lengths(actuator: Actuator) -> np.ndarray:
    """Lengths of the segments: wrapped, cut, wrapped ..."""
    ends = [edge for window in actuator.windows for edge in (window.start, window.end)]
    return np.diff([0.0, *ends, actuator.length])


def test_each_parameter_changes_one_number() -> None:
    alone = [p for (p,) in families(2, apart=True)]
    assert [p.segment for p in alone] == [None, None, 1, 3, 0, 2, 4, None, None]
    before = lengths(TUBE)
    for number in (0, 1):
        changed = alone[number].change(TUBE, 0.3)
        assert changed.windows[number].alpha == pytest.approx(TUBE.windows[number].alpha + 0.3)
        assert changed.windows[1 - number] == TUBE.windows[1 - number]
        np.testing.assert_array_equal(lengths(changed), before)
    for parameter in alone[2:7]:
        changed = parameter.change(TUBE, 0.3)
        expected = before.copy()
        expected[parameter.segment] += 0.3
        np.testing.assert_allclose(lengths(changed), expected, atol=1e-12)
        assert [w.alpha for w in changed.windows] == [w.alpha for w in TUBE.windows]
    assert alone[-2].change(TUBE, 0.3) == replace(TUBE, wall=TUBE.wall + 0.3)
    stiffer = alone[-1].change(TUBE, 0.3)
    assert stiffer.gauze.stiffness == pytest.approx(1.3 * TUBE.gauze.stiffness)
    assert replace(stiffer, gauze=TUBE.gauze) == TUBE


def test_those_of_a_family_have_no_ring_in_common() -> None:
    together = families(3)
    assert [len(family) for family in together] == [1, 1, 1, 3, 4, 1, 1]
    for family in together:
        segments = sorted(p.segment for p in family if p.segment is not None)
        assert all(b - a >= 2 for a, b in pairwise(segments))
    assert sum(map(len, families(3, apart=True))) == sum(map(len, together))
