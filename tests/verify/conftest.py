"""Coarse meshes: what is tested here is what is asked of the engine, not how exact it is."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import pytest

import fem

# Even bricks: no mesh changes with an angle.
COARSE = fem.MeshSize(beside=0.0, edge=0.4)


@pytest.fixture(scope="module", autouse=True)
def coarse_mesh(request: pytest.FixtureRequest) -> Iterator[None]:
    """Solve on the mesh that a test file names as MESH, else on a coarse one."""
    size = getattr(request.module, "MESH", COARSE)
    with pytest.MonkeyPatch.context() as patch:
        for module in ("run", "forward", "sample", "threads", "grip"):
            patch.setattr(f"profiletool.verify.{module}.solve", partial(fem.solve, size=size))
        yield
