"""Lines and shapes of a deformed mesh in the object frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.element import face_nodes, natural_nodes, shape
from fem.mesh import Mesh
from fem.solution import State
from profiletool.bending.kinematics import STEP_MM
from profiletool.records.frames import Pose, Shape, base_axes
from profiletool.records.units import FloatArray


@dataclass(frozen=True)
class Placement:
    """From the FE frame into the object frame."""

    pose: Pose
    sign: float
    radius: float

    def __call__(self, points: FloatArray) -> FloatArray:
        """Place points (N, 3) of the FE frame in the object frame: (N, 2), mm."""
        along, outward = base_axes(float(np.radians(self.pose.heading_deg)), self.sign)
        start = np.array([self.pose.x_mm, self.pose.y_mm])
        off = points[:, 1, None] + self.radius
        placed: FloatArray = start + points[:, 2, None] * along + off * outward
        return placed


def shape_of(mesh: Mesh, state: State, pose: Pose, sign: float) -> Shape:
    """Lines of a state's tube in the object frame; ``pose`` and ``sign`` as in `inflate`."""
    return placed_shape(mesh, state, Placement(pose, sign, mesh.actuator.radius))


def placed_shape(mesh: Mesh, state: State, place: Placement) -> Shape:
    """Lines of the tube at even places, by the elements' own interpolation; then the plug."""
    length = mesh.actuator.length
    along = np.linspace(0.0, length, round(length / STEP_MM) + 1)
    beyond = np.maximum(along - mesh.actuator.free_length, 0.0)[:, None]
    end = beyond * (state.shape.rotation[-1] @ [0.0, 0.0, 1.0])
    facing, far = (
        place(on_line(mesh, state.x, along, phi) + end) for phi in (-0.5 * np.pi, 0.5 * np.pi)
    )
    return Shape(along, facing, 0.5 * (facing + far), far)


def on_line(
    mesh: Mesh, nodal: FloatArray, along: FloatArray, phi: float = -0.5 * np.pi
) -> FloatArray:
    """Interpolate nodal values to a surface line: (S, 3).

    Parameters
    ----------
    mesh : Mesh
    nodal : (layers + 1, ring + mid, 3)
    along : (S,) mm
        Places on the straight tube; beyond the plug's inner face its values count.
    phi : float
        rad; by default the object-facing line.
    """
    inside = np.minimum(along, mesh.actuator.free_length)
    layer = np.clip(np.searchsorted(mesh.z, inside, side="right") - 1, 0, mesh.layers - 1)
    t = (inside - mesh.z[layer]) / mesh.heights[layer]
    nodes = mesh.outer + (layer * (mesh.ring + mesh.mid))[:, None, None]
    k, N = _on_bricks(mesh, 2.0 * t - 1.0, phi)
    values: FloatArray = np.einsum("sn,snj->sj", N, nodal.reshape(-1, 3)[nodes[:, k]])
    return values


def _on_bricks(mesh: Mesh, zeta: FloatArray, phi: float) -> tuple[int, FloatArray]:
    """Brick around that has the surface line at phi (rad, from 270 deg on), and its weights there.

    Returns
    -------
    k : int
    N : (S, n)
        Shape functions of the brick's outer face, one row for each natural coordinate zeta.
    """
    k = int(np.clip(np.searchsorted(mesh.columns, phi + 1e-9) - 1, 0, mesh.around - 1))
    low, high = mesh.columns[k : k + 2]
    eta = np.clip(2.0 * (phi - low) / (high - low) - 1.0, -1.0, 1.0)
    kind = mesh.size.kind
    face = natural_nodes(kind)[-face_nodes(kind) :, 1:]
    N, _ = shape(face, np.column_stack([np.full(len(zeta), eta), zeta]))
    return k, N
