"""Rings along the tube and columns around it: where they must lie, and how they grow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fem.actuator import Actuator, chain
from fem.meshlines import make_columns, stations, stretched
from fem.meshsize import DEFAULT_MESH, MeshSize

TUBE = chain(
    10.0, [19.0, 12.0], [8.0, 6.0], np.radians([132.0, 120.0]), np.radians([270.0, 90.0]), end=4.0
)
EVEN = MeshSize(around=5, beside=0.0)


def edges(actuator: Actuator) -> np.ndarray:
    """Ends of the segments, up to the plug."""
    ends = [edge for window in actuator.windows for edge in (window.start, window.end)]
    return np.array([0.0, *ends, actuator.wrapped[-1][1]])


@pytest.mark.parametrize("size", [DEFAULT_MESH, replace(DEFAULT_MESH, edge=2.0, growth=1.5)])
def test_rings_lie_on_every_cuts_edge_and_layers_grow_away_from_it(size: MeshSize) -> None:
    z, segment = stations(TUBE, size)
    heights = np.diff(z)
    assert (z[0], z[-1]) == (0.0, pytest.approx(edges(TUBE)[-1]))
    assert np.abs(z[:, None] - edges(TUBE)).min(axis=0).max() < 1e-9
    assert segment.tolist() == sorted(segment)
    assert set(segment.tolist()) == {0, 1, 2, 3, 4}
    for k in range(5):
        own = heights[segment == k]
        most = 1.1 * (size.window if k % 2 else size.wrapped)
        assert own.max() <= most + 1e-9
        assert max(own[1:] / own[:-1], default=1.0) <= size.growth + 1e-9
        # A layer at a cut's edge is no higher than asked for, but for what fills the length.
        at_cuts = [own[0]] * (k > 0) + [own[-1]] * (k < 4)
        assert max(at_cuts) <= 1.1 * size.edge + 1e-9


def test_layers_go_with_the_diameter() -> None:
    double = replace(
        TUBE,
        length=TUBE.length + edges(TUBE)[-1],  # the plug stays as long as it is
        diameter=2.0 * TUBE.diameter,
        wall=2.0 * TUBE.wall,
        windows=tuple(replace(w, centre=2.0 * w.centre, openF=2.0 * w.openF) for w in TUBE.windows),
    )
    (z, segment), (twice, same) = (stations(tube, DEFAULT_MESH) for tube in (TUBE, double))
    np.testing.assert_allclose(twice, 2.0 * z)
    np.testing.assert_array_equal(same, segment)


@pytest.mark.parametrize("longer", [-1.5, 0.0, 2.0])
def test_a_stretched_mesh_has_its_rings_on_the_new_edges(longer: float) -> None:
    z, segment = stations(TUBE, DEFAULT_MESH)
    first, second = TUBE.windows
    changed = replace(
        TUBE,
        length=TUBE.length + longer,
        windows=(
            replace(first, centre=first.centre + 0.5 * longer, openF=first.openF + longer),
            replace(second, centre=second.centre + longer),
        ),
    )
    moved = stretched(z, segment, changed)
    ends = np.flatnonzero(np.diff(segment)) + 1
    np.testing.assert_allclose(moved[[0, *ends, -1]], edges(changed), atol=1e-9)
    assert np.diff(moved).min() > 0.0
    # Low layers at the edges keep their heights; segments that did not change keep all.
    before, after = np.diff(z), np.diff(moved)
    np.testing.assert_allclose(after[segment != 1], before[segment != 1], atol=1e-9)
    own = before[segment == 1]
    np.testing.assert_allclose(after[segment == 1][0], own[0], rtol=0.03)  # all alike: 25 %
    if longer == 0.0:
        np.testing.assert_allclose(moved, z, atol=1e-12)


def test_columns_end_where_the_uncut_sectors_do() -> None:
    for half, whole in ((True, np.pi), (False, 2.0 * np.pi)):
        columns = make_columns(TUBE, DEFAULT_MESH, half)
        assert columns[0] == -0.5 * np.pi
        assert columns[-1] - columns[0] == pytest.approx(whole)
        assert np.diff(columns).min() > 0.0
        # Of the first window, about 270 deg: from the object's side by half of its uncut sector.
        reach = 0.5 * (TUBE.windows[0].alpha + TUBE.gauze.allowance)
        assert np.abs(columns - columns[0] - reach).min() < 1e-9
        narrow = np.argmin(np.abs(columns - columns[0] - reach))
        beside = np.diff(columns)[[narrow - 1, narrow]]
        assert beside.max() <= 1.1 * DEFAULT_MESH.beside + 1e-9


def test_even_columns() -> None:
    np.testing.assert_allclose(np.diff(make_columns(TUBE, EVEN, True)), np.pi / 5)
    np.testing.assert_allclose(np.diff(make_columns(TUBE, EVEN, False)), np.pi / 5)
