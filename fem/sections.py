"""The tube as a chain of cross-sections: the chart in which steps are taken.

A section (a ring, or the mid nodes of a layer) has a centre, a rotation and a shape: its nodes as
seen from its own frame. Along the tube the centres follow each other by offsets in these frames.
In this chart a bending tube moves almost straight: increments are applied as finite rotations,
and states at several pressures can be extrapolated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.arrays import FloatArray
from fem.mesh import Mesh


@dataclass(frozen=True)
class Pose:
    """A deformed tube in the chart; S sections.

    Attributes
    ----------
    centre : (S, 3) mm
    rotation : (S, 3, 3)
        From rest.
    shape : (layers + 1, ring + mid, 3) mm
        Nodes as seen from their section's frame.
    x : (layers + 1, ring + mid, 3) mm
        Nodal positions: centre + rotation @ shape.
    """

    centre: FloatArray
    rotation: FloatArray
    shape: FloatArray
    x: FloatArray

    @property
    def offset(self) -> FloatArray:
        """From each centre to the next, in the frame of the first: (S - 1, 3), mm."""
        return _in_frame(self.rotation[:-1], np.diff(self.centre, axis=0))


class Chart:
    """Increments of a `Pose` as vectors: spins (3 S), changes of offsets, changes of shape."""

    def __init__(self, mesh: Mesh) -> None:
        self._ring, self._half = mesh.ring, mesh.half
        self._mids = mesh.mid > 0
        self._X = mesh.X
        self.z = self._interleave(mesh.z[:, None], 0.5 * (mesh.z[1:] + mesh.z[:-1])[:, None])[:, 0]

    def rest(self) -> Pose:
        """Return the tube at rest."""
        return self.of(self._X)

    def of(self, x: FloatArray) -> Pose:
        """Return a pose of given nodal positions, its sections' rotations counted from there."""
        # The mean of the nodes: about any other point a rigid motion would not look rigid.
        centre = self._mean(x)
        rotation = np.broadcast_to(np.eye(3), (len(self.z), 3, 3))
        return Pose(centre, rotation, x - self._nodal(centre), x)

    def fitted(self, x: FloatArray) -> Pose:
        """Return a pose of given nodal positions, its sections turned from rest as fits them best.

        Poses of several states can so be extrapolated, as if they had been reached in one chart.
        """
        pose = self.of(x)
        products = self.rest().shape[..., :, None] * pose.shape[..., None, :]
        sums = self._sum(products.reshape(*x.shape[:-1], 9)).reshape(-1, 3, 3)
        if self._half:
            sums[:, 0, 1:] = sums[:, 1:, 0] = 0.0
        before, _, after = np.linalg.svd(sums)
        after[:, 2] *= np.linalg.det(before @ after)[:, None]
        rotation = np.swapaxes(before @ after, 1, 2)
        turned = self._turn(np.swapaxes(rotation, 1, 2), pose.shape)
        return Pose(pose.centre, rotation, turned, x)

    def taut(self, strain: float) -> Pose:
        """Return the tube stretched a little every way, so that no thread is slack."""
        rest = self.rest()
        shape = rest.shape * (1.0 + strain)
        shape[[0, -1], : self._ring] = rest.shape[[0, -1], : self._ring]
        straight = Pose(rest.centre, rest.rotation, shape, rest.x)
        increment = np.zeros(6 * len(self.z) - 3 + shape.size)
        increment[3 * len(self.z) : 6 * len(self.z) - 3] = strain * rest.offset.ravel()
        return self.move(straight, increment)

    def increment(self, pose: Pose, du: FloatArray) -> FloatArray:
        """Small nodal displacements du (as x) in the chart, to first order."""
        arm = pose.x - self._nodal(pose.centre)
        shift = self._mean(du)
        spin = self._spin(arm, du - self._nodal(shift))
        rigid = self._nodal(shift) + np.cross(self._nodal(spin), arm)
        change = self._turn(np.swapaxes(pose.rotation, 1, 2), du - rigid)
        along = np.diff(pose.centre, axis=0)
        offset = _in_frame(pose.rotation[:-1], np.diff(shift, axis=0) - np.cross(spin[:-1], along))
        return np.concatenate([spin.ravel(), offset.ravel(), change.ravel()])

    def difference(self, pose: Pose, other: Pose) -> FloatArray:
        """Return the increment that leads from pose to other."""
        spin = rotation_vector(other.rotation @ np.swapaxes(pose.rotation, 1, 2))
        return np.concatenate(
            [
                spin.ravel(),
                (other.offset - pose.offset).ravel(),
                (other.shape - pose.shape).ravel(),
            ]
        )

    def move(self, pose: Pose, increment: FloatArray) -> Pose:
        """Apply an increment as finite rotations."""
        S = len(pose.centre)
        spin = increment[: 3 * S].reshape(S, 3)
        offset = pose.offset + increment[3 * S : 6 * S - 3].reshape(S - 1, 3)
        shape = pose.shape + increment[6 * S - 3 :].reshape(pose.shape.shape)
        rotation = rotation_matrix(spin) @ pose.rotation
        steps = np.einsum("kij,kj->ki", rotation[:-1], offset)
        centre = pose.centre[0] + np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
        return Pose(centre, rotation, shape, self._nodal(centre) + self._turn(rotation, shape))

    def spins(self, increment: FloatArray) -> FloatArray:
        """Return the part of an increment that turns the sections: (S, 3), rad."""
        return increment[: 3 * len(self.z)].reshape(-1, 3)

    def _interleave(self, rings: FloatArray, mids: FloatArray) -> FloatArray:
        if not self._mids:
            return rings
        out = np.empty((len(rings) + len(mids), rings.shape[1]))
        out[::2], out[1::2] = rings, mids
        return out

    def _nodal(self, values: FloatArray) -> FloatArray:
        """Spread a vector a section (S, 3) over its nodes."""
        out = np.zeros_like(self._X)
        step = 2 if self._mids else 1
        out[:, : self._ring] = values[::step, None]
        if self._mids:
            out[:-1, self._ring :] = values[1::2, None]
        return out

    def _turn(self, rotation: FloatArray, nodal: FloatArray) -> FloatArray:
        step = 2 if self._mids else 1
        out = np.zeros_like(nodal)
        turned = np.swapaxes(rotation, 1, 2)  # rows are vectors
        out[:, : self._ring] = nodal[:, : self._ring] @ turned[::step]
        if self._mids:
            out[:-1, self._ring :] = nodal[:-1, self._ring :] @ turned[1::2]
        return out

    def _mean(self, nodal: FloatArray) -> FloatArray:
        mean = self._interleave(
            nodal[:, : self._ring].mean(axis=1),
            nodal[:-1, self._ring :].mean(axis=1) if self._mids else nodal[:-1, 0],
        )
        if self._half:
            mean[:, 0] = 0.0
        return mean

    def _spin(self, arm: FloatArray, du: FloatArray) -> FloatArray:
        """Spins (S, 3) that fit du best."""
        moment = np.cross(arm, du)
        if self._half:
            about_x = arm[..., 1] ** 2 + arm[..., 2] ** 2
            sums = self._sum(np.stack([moment[..., 0], about_x], axis=-1))
            spin: FloatArray = np.zeros((len(sums), 3))
            spin[:, 0] = sums[:, 0] / sums[:, 1]
            return spin
        outer = arm[..., :, None] * arm[..., None, :]
        tensor = (arm**2).sum(axis=-1)[..., None, None] * np.eye(3) - outer
        packed = np.concatenate([moment, tensor.reshape(*arm.shape[:-1], 9)], axis=-1)
        sums = self._sum(packed)
        inertia, total = sums[:, 3:].reshape(-1, 3, 3), sums[:, :3, None]
        return np.asarray(np.linalg.solve(inertia, total)[..., 0])

    def _sum(self, nodal: FloatArray) -> FloatArray:
        return self._interleave(
            nodal[:, : self._ring].sum(axis=1), nodal[:-1, self._ring :].sum(axis=1)
        )


def _in_frame(rotation: FloatArray, vectors: FloatArray) -> FloatArray:
    seen: FloatArray = np.einsum("kji,kj->ki", rotation, vectors)
    return seen


def rotation_matrix(spin: FloatArray) -> FloatArray:
    """Rotations (..., 3, 3) by rotation vectors (..., 3), rad."""
    angle = np.linalg.norm(spin, axis=-1)[..., None, None]
    W = np.zeros((*spin.shape, 3))
    W[..., 0, 1], W[..., 0, 2], W[..., 1, 2] = -spin[..., 2], spin[..., 1], -spin[..., 0]
    W -= np.swapaxes(W, -1, -2)
    half = np.sinc(angle / (2.0 * np.pi))
    turned: FloatArray = np.eye(3) + np.sinc(angle / np.pi) * W + 0.5 * half**2 * (W @ W)
    return turned


def rotation_vector(R: FloatArray) -> FloatArray:
    """Rotation vectors (..., 3), rad, of rotations R (..., 3, 3) by less than half a turn."""
    axis = 0.5 * np.stack(
        [
            R[..., 2, 1] - R[..., 1, 2],
            R[..., 0, 2] - R[..., 2, 0],
            R[..., 1, 0] - R[..., 0, 1],
        ],
        axis=-1,
    )
    sine = np.linalg.norm(axis, axis=-1)
    cosine = 0.5 * (np.trace(R, axis1=-2, axis2=-1) - 1.0)
    angle = np.arctan2(sine, cosine)
    scale = np.where(sine > 1e-12, angle / np.maximum(sine, 1e-300), 1.0)
    vector: FloatArray = axis * scale[..., None]
    return vector


def best_rotation(rest: FloatArray, now: FloatArray) -> FloatArray:
    """Rotation (3, 3) that takes points rest (n, 3) nearest to now (n, 3), both centred."""
    U, _, Vt = np.linalg.svd(now.T @ rest)
    U[:, 2] *= np.linalg.det(U) * np.linalg.det(Vt)
    turned: FloatArray = U @ Vt
    return turned


def best_rotations(rest: FloatArray, now: FloatArray, half: bool) -> FloatArray:
    """Rotations (S, 3, 3) that take sections rest (S, n, 3) nearest to now (S, n, 3).

    ``half``: the sections are the half at x >= 0 of symmetric ones.
    """
    if half:
        mirror = np.array([-1.0, 1.0, 1.0])
        rest, now = (np.concatenate([v, v * mirror], axis=1) for v in (rest, now))
    rest = rest - rest.mean(axis=1, keepdims=True)
    now = now - now.mean(axis=1, keepdims=True)
    U, _, Vt = np.linalg.svd(np.swapaxes(now, 1, 2) @ rest)
    U[:, :, 2] *= (np.linalg.det(U) * np.linalg.det(Vt))[:, None]
    turned: FloatArray = U @ Vt
    return turned
