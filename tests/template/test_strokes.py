"""Letters as strokes."""

from __future__ import annotations

import numpy as np
import pytest

from profiletool.template.drawing import Text
from profiletool.template.strokes import GLYPHS, text_strokes, text_width
from tests.template.geometry import coincident


@pytest.mark.parametrize("char", [*GLYPHS, "☃"])
def test_glyph_fills_its_width_and_runs_over_nothing(char):
    strokes = text_strokes(char, 12.0)
    points = np.vstack(strokes)
    assert points.min(axis=0).tolist() >= [0, 0]
    assert points[:, 0].max() == text_width(char, 12.0)
    assert points[:, 1].max() <= 12
    assert coincident(np.vstack([np.stack([s[:-1], s[1:]], axis=1) for s in strokes])) == []


def test_lower_case_and_accents_are_drawn_as_capitals():
    for a, b in zip(text_strokes("süß", 3), text_strokes("SUSS", 3), strict=True):
        np.testing.assert_array_equal(a, b)
    assert text_width("", 3) == 0


def test_text_box_holds_its_strokes():
    for anchor in ("left", "centre", "right"):
        for upward in (False, True):
            text = Text("NOTE", "HOE", 7.0, -3.0, 4.0, anchor, upward)
            points = np.vstack(text.lines())
            found = (*points.min(axis=0), *points.max(axis=0))
            assert found == pytest.approx(text.box)
