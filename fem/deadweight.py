"""The weight of an actuator as an item of its energy."""

from __future__ import annotations

import numpy as np

from fem.arrays import FloatArray, IntArray
from fem.element import face_nodes, gauss, natural_nodes, shape
from fem.items import Batch
from fem.mesh import Mesh

_HEIGHT = 2.0  # mm, of a mesh's bricks


class Deadweight:
    """What hangs on the nodes: energy -f (x - X) with constant forces f, and no stiffness.

    Forces are those of the shape functions. The plug's are spread over the outer nodes of the
    last ring, which it moves as a rigid body: half of its length, the arm to its middle, is left
    out.

    Raises
    ------
    ValueError
        When the mesh's actuator has no weight.
    """

    def __init__(self, mesh: Mesh) -> None:
        weight = mesh.actuator.weight
        if weight is None:
            raise ValueError("this actuator has no weight")
        self._mesh = mesh
        self._direction = np.array(weight.direction)
        c, m = mesh.outer.shape
        points, _ = gauss(mesh.size.orders)
        N, _ = shape(natural_nodes(mesh.size.kind), points)
        bricks = np.concatenate([brick.weights @ N for brick in mesh.brick])
        # (through * around, n) N per mm of height
        self._per_height: FloatArray = weight.rubber * bricks / _HEIGHT
        at, w = gauss(mesh.size.orders[1:])
        face, _ = shape(natural_nodes(mesh.size.kind)[-face_nodes(mesh.size.kind) :, 1:], at)
        width = mesh.actuator.radius * np.diff(mesh.columns)
        self._per_height[-c:, -m:] += weight.gauze * width[:, None] * (0.25 * w @ face)
        # The plug's, as much on a node as on the others of its angle: Simpson's rule.
        end = [a for a, zeta in enumerate(natural_nodes(mesh.size.kind)[:, 2]) if zeta > 0]
        top = mesh.bricks[-c:][:, [a for a in end if a >= bricks.shape[1] - m]]
        share = np.array([1.0, 1.0, 4.0]) / 6.0 if top.shape[1] == 3 else np.full(2, 0.5)
        volume = 0.5 * mesh.actuator.radius**2 * np.diff(mesh.columns) * mesh.actuator.plug
        self._plug_nodes = top.ravel() + (mesh.layers - 1) * (mesh.ring + mesh.mid)
        self._plug = (weight.rubber * volume[:, None] * share).ravel()

    def add(self, batch: Batch) -> None:
        """Add energy and forces of a batch's layers; the last layer's carries the plug."""
        mesh = self._mesh
        heights = mesh.heights[batch.layers.start : batch.layers.stop]
        nodes = mesh.bricks[:, :, None] + batch.first  # (through * around, n, L)
        self._hang(batch, nodes, self._per_height[:, :, None] * heights)
        if batch.layers.stop == mesh.layers:
            self._hang(batch, self._plug_nodes, self._plug)

    def _hang(self, batch: Batch, nodes: IntArray, load: FloatArray) -> None:
        moved = batch.x[nodes] - self._mesh.X.reshape(-1, 3)[nodes]
        batch.sums.energy -= float((load * (moved @ self._direction)).sum())
        batch.add_forces(nodes, -self._direction.reshape(3, *[1] * load.ndim) * load)
