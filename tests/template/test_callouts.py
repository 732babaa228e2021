"""Lettering beside lines."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from profiletool.template.callouts import Callout, lettered
from profiletool.template.drawing import Drawing, polyline
from tests.template.mounts import assert_lettering_clear


def test_callouts_keep_off_everything():
    wall = polyline("MARK", (5, -30), (5, 30))
    wanted = [Callout(f"number {k}", np.array([0.0, 0.0]), 0.0) for k in range(6)]
    lines, texts = lettered(wanted, [wall], [])
    assert_lettering_clear(Drawing("", (wall, *lines[::2]), texts))
    tips = [line.points[1] for line in lines[::2]]
    assert all(tip.tolist() == [0, 0] for tip in tips)
    assert all(a.box != b.box for a, b in pairwise(texts))
