"""Small tubes, and how the tests deform them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fem.actuator import Actuator, Window
from fem.assembly import System
from fem.gauze import Gauze
from fem.mesh import Mesh, make_mesh
from fem.meshsize import MeshSize
from fem.sections import Chart, Pose

FloatArray = NDArray[np.float64]

COARSE = MeshSize(around=3, beside=0.0, edge=2.0, growth=2.0)
COARSE8 = replace(COARSE, around=4, kind="hex8", through=2, orders=(2, 2, 2), mean_dilatation=True)


def tube(center: float = 270.0, gauze: Gauze | None = None) -> Actuator:
    """One joint in the middle of 22 mm; ``center`` in degrees."""
    window = Window(10.0, 5.0, np.radians(90.0), np.radians(center))
    return Actuator(22.0, (window,), gauze=Gauze() if gauze is None else gauze)


def mesh_of(center: float = 270.0, size: MeshSize = COARSE, gauze: Gauze | None = None) -> Mesh:
    return make_mesh(tube(center, gauze), size)


def bent(system: System, seed: int, amount: float = 0.3, stretch: float = 0.02) -> Pose:
    """Some deformed state: every node displaced at random by ``amount`` mm, and the plug turned."""
    mesh, chart = system.mesh, Chart(system.mesh)
    rng = np.random.default_rng(seed)
    values = amount * rng.uniform(-1.0, 1.0, system.unknowns.count)
    pose = chart.rest()
    du = system.expand(pose.x, values)
    smooth = np.zeros_like(du)
    smooth[..., 1] = -0.003 * mesh.X[..., 2] ** 2
    smooth[..., 2] = stretch * mesh.X[..., 2]
    smooth[-1] = 0.0
    rows = system.expand(pose.x, system.restrict(pose.x, smooth))
    rows[-1] = 0.0
    tip = np.zeros(system.unknowns.count)
    tip[-system.unknowns.plug :] = (
        [-1.2, 0.4, 0.9] if mesh.half else [0.4, -1.2, 0.4, 0.9, 0.5, 0.7]
    )
    return chart.move(pose, chart.increment(pose, du + rows + system.expand(pose.x, tip)))


def shifted(system: System, pose: Pose, values: FloatArray) -> FloatArray:
    """Nodal positions after a finite motion along the unknowns ``values``."""
    chart = Chart(system.mesh)
    return chart.move(pose, chart.increment(pose, system.expand(pose.x, values))).x
