"""Lines that move with the pressure."""

from __future__ import annotations

import numpy as np
import pytest

from profiletool.report.dossier import Dossier
from profiletool.report.film import Film, film_of, still_of
from tests.report.dossiers import made_up


def corners(path: str) -> np.ndarray:
    return np.array([[float(v) for v in p.split(",")] for p in path.strip("MZ").split(" ")])


def test_the_tube_is_drawn_where_it_is(finger: Dossier) -> None:
    design = finger.scene.design
    found = made_up(design)
    film = film_of(found, design)
    shape = found.last.shape
    drawn = corners(film.outline()) * [1.0, -1.0]
    n = film.lines.shape[2]
    assert np.allclose(drawn[[0, n - 1, n, -1]], [
        shape.facing[0], shape.facing[-1], shape.far[-1], shape.far[0],
    ], atol=0.006)  # fmt: skip
    for k, joint in enumerate(design.joints):
        edges = corners(film.window(k)) * [1.0, -1.0]
        at = np.interp(joint.centre_mm - 0.5 * joint.openF_mm, shape.along, shape.facing[:, 0])
        assert edges[0, 0] == pytest.approx(at, abs=0.2)
        assert np.allclose(
            [float(v) for v in film.centre(k)],
            [
                np.interp(joint.centre_mm, shape.along, shape.axis[:, 0]),
                -np.interp(joint.centre_mm, shape.along, shape.axis[:, 1]),
            ],
            atol=0.2,
        )
    still = still_of(shape, design)
    assert still.outline() == film.outline()
    assert not still.moves


def test_lengths_survive_thinning(finger: Dossier) -> None:
    design = finger.scene.design
    found = made_up(design)
    film: Film = film_of(found, design)
    for state, lines in zip((found.rest, *found.states), film.lines, strict=True):
        for line, thin in zip((state.shape.facing, state.shape.far), lines / 100.0, strict=True):
            length, kept = (np.hypot(*np.diff(v, axis=0).T).sum() for v in (line, thin))
            assert kept == pytest.approx(length, rel=3e-3)
