"""The renderer of pictures of an actuator."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

import fem

BENCH = Path(__file__).parents[2] / "samples" / "bench.py"


@pytest.mark.slow
def test_a_tube_is_as_wide_as_it_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    spec = importlib.util.spec_from_file_location("samples_bench", BENCH)
    assert spec is not None
    assert spec.loader is not None
    bench = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "samples_bench", bench)
    spec.loader.exec_module(bench)
    coarse = fem.MeshSize(beside=0.0, edge=0.4)
    tube = fem.chain(30.0, [30.0], [10.0], [1.5])
    found = fem.solve(tube, [0.1], size=coarse)
    shot = bench.Shot(1000.0, px_per_mm=3.0, size=(300, 300), noise=0.0, ground="dark")
    rng = np.random.default_rng(0)
    rest, bent = (
        bench.photograph(found.mesh, state, 1.0, shot, bench.Lying(0.0, -30.0), rng).mean(axis=2)
        for state in (found.states[0], found.states[-1])
    )
    # 990 mm from the lens to its axis, 1000 to the ground.
    across = rest[150]
    level = 0.5 * (across.max() + across.min())
    assert np.count_nonzero(across > level) == pytest.approx(20.0 * 3.0 * 1000.0 / 990.0, abs=1.5)
    columns = [np.flatnonzero(row[200] > level).mean() for row in (rest, bent)]
    assert columns[1] > columns[0] + 5.0  # it bends to the right, where the object is on this side
