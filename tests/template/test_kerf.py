"""The cut beside the piece: what the beam burns away is taken from the waste."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from profiletool.errors import UsageError
from profiletool.template.kerf import check_kerf, outline_path, slit_paths
from profiletool.template.unroll import Slit

L = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 10.0], [12.0, 10.0], [12.0, 20.0], [0.0, 20.0]])
ROLL = 100.0


def test_an_outline_grows_by_half_of_the_kerf_and_keeps_its_corners() -> None:
    found = outline_path(L, 0.4)
    grown = [[-0.2, -0.2], [30.2, -0.2], [30.2, 10.2], [12.2, 10.2], [12.2, 20.2], [-0.2, 20.2]]
    start = int(np.argmin(np.hypot(*(found - grown[0]).T)))
    np.testing.assert_allclose(np.roll(found, -start, axis=0), grown, atol=1e-9)
    assert shapely.LinearRing(found).is_ccw
    assert outline_path(L, 0.0) is L


def slit(start: float, end: float) -> Slit:
    return Slit(1, 5.0, start, end)


@pytest.mark.parametrize(
    ("start", "end", "cut"),
    [
        (20.0, 40.0, (20.2, 39.8)),
        (0.0, 40.0, (0.0, 39.8)),  # open at the start edge
        (20.0, ROLL, (20.2, ROLL)),
        (0.0, ROLL, (0.0, ROLL)),
    ],
)
def test_a_slit_is_cut_short_of_its_ends(
    start: float, end: float, cut: tuple[float, float]
) -> None:
    (line,) = slit_paths([slit(start, end)], ROLL, 0.4)
    np.testing.assert_allclose(line.points, [[5.0, cut[0]], [5.0, cut[1]]])
    assert (line.layer, line.closed) == ("CUT_INNER", False)


def test_a_slit_no_longer_than_the_kerf_is_left_out() -> None:
    assert slit_paths([slit(20.0, 20.4)], ROLL, 0.4) == ()
    assert len(slit_paths([slit(20.0, 20.5)], ROLL, 0.4)) == 1


def test_a_kerf_passes_between_hoop_threads() -> None:
    for kerf in (0.0, 1.74):
        check_kerf(kerf, 2.0, 0.25)
    for kerf in (-0.01, 1.75, float("nan"), float("inf")):
        with pytest.raises(UsageError, match=r"does not pass between hoop threads 1\.75 mm apart"):
            check_kerf(kerf, 2.0, 0.25)
