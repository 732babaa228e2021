"""Drawings turned upright and averaged."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from profiletool.errors import UsageError
from profiletool.profile.upright import turned
from profiletool.records.request import Look, Request, ScaleRequest
from profiletool.subject.find import find_subject
from tests.subject.objects import PEAR, csv


def asked(file: Path, **look: object) -> Request:
    return Request(file, verify=False, look=Look(**look))  # type: ignore[arg-type]


def test_drawings_are_turned_and_averaged_too(tmp_path: Path) -> None:
    closed = np.vstack([PEAR, PEAR[:1]])
    stands = find_subject(asked(csv(tmp_path / "a.csv", closed)), str)
    file = csv(tmp_path / "b.csv", turned(closed, 70.0))
    for rotate in (-70.0, "auto"):
        made = find_subject(asked(file, rotate=rotate), str)
        assert made.rotated_deg == pytest.approx(-70.0, abs=0.1)
        assert made.profile.length_mm == pytest.approx(stands.profile.length_mm, rel=2e-3)
    lopsided = np.where(closed[:, :1] > 0.0, closed * [1.1, 1.0], closed)
    mean = find_subject(asked(csv(tmp_path / "c.csv", lopsided), symmetric=True), str)
    outline = mean.profile.outline
    assert outline is not None
    half = 0.5 * (np.ptp(PEAR[:, 0]) * 1.05)
    assert np.ptp(outline[:, 0]) == pytest.approx(2.0 * half, rel=2e-3)


def test_an_open_profile_has_no_axis(tmp_path: Path) -> None:
    file = csv(tmp_path / "a.csv", PEAR[300:900])
    for look in ({"rotate": "auto"}, {"symmetric": True}):
        with pytest.raises(UsageError, match="open profile"):
            find_subject(asked(file, **look), str)
    plain, half = find_subject(asked(file), str), find_subject(asked(file, rotate=5.0), str)
    assert half.profile.length_mm == pytest.approx(plain.profile.length_mm, rel=0.01)
    assert half.rotated_deg == 5.0


def test_a_height_and_a_width_that_contradict_each_other_are_told(samples: Path) -> None:
    for width, told in ((70.0, 1), (60.0, 0)):
        scale = ScaleRequest(height_mm=107.5, width_mm=width)
        request = Request(samples / "bulb.png", scale, verify=False)
        subject = find_subject(request, str)
        assert subject.scale.source == "height"
        said = [n for n in subject.notes if "`width_mm` is 70 mm, but at a `height_mm`" in n]
        assert len(said) == told
