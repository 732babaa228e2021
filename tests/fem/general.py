"""Any mesh of bricks on the kernels of `fem`, for problems that are not a tube.

Slow and plain on purpose: one sparse matrix, one Newton loop, the same `respond` and
`face_volumes` that the tube uses.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.linalg import splu

from fem import solid
from fem.element import Kind, Reference, face_nodes, gauss, natural_nodes, reference, shape
from fem.material import PAIRS, Law
from fem.pressure import face_volumes

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

TUBE_ORDERS = (2, 3, 2)
# epsilon_ijk of the Hessian of the volume
EPSILON = ((0, 1, 2, 1.0), (1, 2, 0, 1.0), (2, 0, 1, 1.0))


@dataclass(frozen=True)
class Grid:
    """Bricks in rows; ``at`` (N, 3) are the nodes' places in half bricks."""

    kind: Kind
    counts: tuple[int, int, int]
    at: IntArray
    X: FloatArray
    bricks: IntArray
    cells: IntArray

    def on(self, axis: int, end: int) -> BoolArray:
        """Nodes of the first (end 0) or the last (end 1) face across an axis."""
        return self.at[:, axis] == end * 2 * self.counts[axis]

    def faces(self, axis: int, end: int) -> IntArray:
        """Faces (E, m) across an axis, ordered so that their normal points along it."""
        natural = natural_nodes(self.kind).tolist()
        local = []
        for u, v in natural_nodes(self.kind)[: face_nodes(self.kind), 1:].tolist():
            place = [0, 0, 0]
            place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3] = 2 * end - 1, u, v
            local.append(natural.index(place))
        return self.bricks[self.cells[:, axis] == end * (self.counts[axis] - 1)][:, local]


def grid(
    kind: Kind,
    counts: tuple[int, int, int],
    place: Callable[[FloatArray], FloatArray],
    *,
    straight: bool = False,
) -> Grid:
    """Map the unit cube by ``place`` (N, 3) -> (N, 3); ``straight`` puts mid nodes half-way."""
    natural = natural_nodes(kind)
    cells = np.array(list(np.ndindex(*counts)))
    every = (2 * cells[:, None] + 1 + natural).reshape(-1, 3)
    at, bricks = np.unique(every, axis=0, return_inverse=True)
    half = at % 2
    X = place(at / (2.0 * np.array(counts)))
    if straight:
        ends = [place((at + s * half) / (2.0 * np.array(counts))) for s in (-1, 1)]
        X = np.where(half.any(axis=1)[:, None], 0.5 * (ends[0] + ends[1]), X)
    return Grid(kind, counts, at, X, bricks.reshape(len(cells), -1), cells)


class Model:
    """Energy, forces and stiffness of a grid of rubber bricks."""

    def __init__(
        self,
        mesh: Grid,
        rubber: Law,
        orders: tuple[int, int, int] = TUBE_ORDERS,
        *,
        mean_dilatation: bool = False,
    ) -> None:
        self.mesh, self.rubber, self.mean_dilatation = mesh, rubber, mean_dilatation
        self.work = solid.Workspace()
        # Bricks that are shifted copies of each other share a reference and go in one batch.
        alike: dict[bytes, list[int]] = {}
        for e, nodes in enumerate(mesh.bricks):
            X = mesh.X[nodes]
            alike.setdefault(np.round(X - X[0], 12).tobytes(), []).append(e)
        self.groups: list[tuple[Reference, IntArray]] = [
            (reference(mesh.kind, mesh.X[mesh.bricks[found[:1]]], orders), np.array(found))
            for found in alike.values()
        ]

    def respond(
        self, x: FloatArray, tangent: bool
    ) -> tuple[float, FloatArray, sp.csc_matrix | None]:
        """Energy, forces (N, 3) and stiffness (3 N, 3 N)."""
        bricks = self.mesh.bricks
        E, n = bricks.shape
        energy, force = 0.0, np.zeros_like(x)
        full = np.empty((E, n, 3, n, 3)) if tangent else None
        for ref, members in self.groups:
            S = np.empty((6, 1, len(members), n * n)) if tangent else None
            state = solid.respond(
                self.rubber,
                ref,
                np.full(len(members), 2.0),
                np.ascontiguousarray(x[bricks[members]].transpose(2, 1, 0)[:, None]),
                self.work,
                S,
                mean_dilatation=self.mean_dilatation,
            )
            if not state.least_J > 0.0:
                raise FloatingPointError("a brick is turned inside out")
            energy += state.energy
            np.add.at(force, bricks[members], state.force[:, 0].transpose(2, 1, 0))
            if full is not None and S is not None:
                for m, (i, k) in enumerate(PAIRS):
                    block = S[m, 0].reshape(-1, n, n)
                    full[members, :, i, :, k] = block
                    full[members, :, k, :, i] = block.transpose(0, 2, 1)
        if full is None:
            return energy, force, None
        dofs = (3 * bricks[:, :, None] + np.arange(3)).reshape(E, -1)
        return energy, force, _assemble(dofs, full.reshape(E, 3 * n, 3 * n), 3 * len(x))


def _assemble(dofs: IntArray, blocks: FloatArray, size: int) -> sp.csc_matrix:
    rows = np.repeat(dofs, dofs.shape[1], axis=1).ravel()
    columns = np.tile(dofs, (1, dofs.shape[1])).ravel()
    return sp.csc_matrix(sp.coo_matrix((blocks.ravel(), (rows, columns)), shape=(size, size)))


def enclosed(
    x: FloatArray, faces: IntArray, tangent: bool
) -> tuple[float, FloatArray, sp.csc_matrix | None]:
    """Volume between faces and the origin, its gradient (N, 3) and Hessian (3 N, 3 N)."""
    volume, dV, h = face_volumes(np.ascontiguousarray(x[faces].transpose(2, 1, 0)), tangent)
    gradient = np.zeros_like(x)
    np.add.at(gradient, faces, dV.transpose(2, 1, 0))
    if h is None:
        return float(volume.sum()), gradient, None
    E, m = faces.shape
    full = np.zeros((E, m, 3, m, 3))
    for i, j, k, sign in EPSILON:
        full[:, :, i, :, j] = sign * h[k].transpose(2, 0, 1)
        full[:, :, j, :, i] = -sign * h[k].transpose(2, 0, 1)
    dofs = (3 * faces[:, :, None] + np.arange(3)).reshape(E, -1)
    return (
        float(volume.sum()),
        gradient,
        _assemble(dofs, full.reshape(E, 3 * m, 3 * m), 3 * len(x)),
    )


def face_load(X: FloatArray, faces: IntArray, traction: ArrayLike) -> FloatArray:
    """Nodal forces (N, 3) of a dead traction on faces, per area at rest."""
    kind: Kind = "hex20" if faces.shape[1] == 8 else "hex8"
    points, w = gauss((3, 3))
    N, dN = shape(natural_nodes(kind)[: faces.shape[1], 1:], points)
    along = np.einsum("qnd,eni->eqdi", dN, X[faces])
    area = np.linalg.norm(np.cross(along[:, :, 0], along[:, :, 1]), axis=2)
    load = np.zeros_like(X)
    np.add.at(load, faces, np.einsum("q,eq,qn->en", w, area, N)[..., None] * np.asarray(traction))
    return load


def motions(count: int, held: Sequence[tuple[BoolArray, ArrayLike]]) -> sp.csc_matrix:
    """Independent motions (3 N, free) of nodes held along the normals (mask, normal)."""
    normals: list[list[FloatArray]] = [[] for _ in range(count)]
    for mask, normal in held:
        for node in np.flatnonzero(mask):
            normals[node].append(np.asarray(normal, dtype=float))
    blocks = []
    for rows in normals:
        blocks.append(scipy.linalg.null_space(np.array(rows)) if rows else np.eye(3))
    return sp.csc_matrix(scipy.linalg.block_diag(*blocks))


X_AXIS, Y_AXIS, Z_AXIS = np.eye(3)


@dataclass
class Problem:
    """A model with its supports, and the faces that a pressure works on.

    The faces enclose a volume together with planes through the origin. Where there are other
    planes, ``closing`` is the Hessian of what these add, a quadratic form of x.
    """

    model: Model
    free: sp.csc_matrix
    faces: IntArray | None = None
    closing: sp.csc_matrix | None = None
    x: FloatArray = field(init=False)
    pressure: float = 0.0
    steps: list[list[float]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.x = self.model.mesh.X.copy()

    def volume(self, x: FloatArray) -> tuple[float, FloatArray, sp.csc_matrix]:
        """Enclosed volume, its gradient and Hessian."""
        assert self.faces is not None
        V, g, hessian = enclosed(x, self.faces, True)
        assert hessian is not None
        if self.closing is not None:
            extra = (self.closing @ x.ravel()).reshape(-1, 3)
            V, g, hessian = V + 0.5 * float((extra * x).sum()), g + extra, hessian + self.closing
        return V, g, hessian

    def tangent(self) -> FloatArray:
        """Stiffness of the free motions, with the pressure's, as a dense matrix."""
        K = self.model.respond(self.x, True)[2]
        if self.faces is not None:
            K = K - self.pressure * self.volume(self.x)[2]
        dense: FloatArray = (self.free.T @ K @ self.free).toarray()
        return dense

    def _share(self, x: FloatArray, du: FloatArray) -> float:
        """Largest of a few shares of a step that turns no brick inside out."""
        for share in (1.0, 0.5, 0.25, 0.125):
            try:
                self.model.respond(x + share * du, False)
            except FloatingPointError:
                continue
            return share
        raise RuntimeError("the step turns bricks inside out however short")

    def solve(
        self,
        *,
        load: FloatArray | None = None,
        pressure: float | None = None,
        volume: float | None = None,
        jump: FloatArray | None = None,
        tolerance: float = 1e-11,
        most: int = 30,
    ) -> FloatArray:
        """Go to an equilibrium from the last one; return the reactions (N, 3).

        ``load`` are dead nodal forces, ``volume`` is to be enclosed by the faces with the
        pressure unknown, ``jump`` (N, 3) moves held nodes.
        """
        p = self.pressure if pressure is None else pressure
        x, history = self.x, []
        for _ in range(most):
            _, internal, K = self.model.respond(x, True)
            residual = internal.copy() if load is None else internal - load
            scale = np.linalg.norm(internal) + (0.0 if load is None else np.linalg.norm(load))
            V, g = 0.0, np.zeros_like(x)
            if self.faces is not None:
                V, g, hessian = self.volume(x)
                residual = residual - p * g
                K = K - p * hessian
                scale += abs(p) * np.linalg.norm(g)
            error = float(np.linalg.norm(self.free.T @ residual.ravel()) / max(scale, 1e-30))
            if volume is not None:
                error = max(error, abs(V / volume - 1.0))
            history.append(error)
            if error < tolerance and jump is None:
                self.x, self.pressure = x, p
                self.steps.append(history)
                return residual
            rhs = -residual.ravel()
            du = np.zeros_like(rhs)
            if jump is not None:
                rhs = rhs - K @ jump.ravel()
                du += jump.ravel()
                jump = None
            lu = splu(sp.csc_matrix(self.free.T @ K @ self.free))
            du += self.free @ lu.solve(self.free.T @ rhs)
            if volume is not None:
                flow = self.free @ lu.solve(self.free.T @ g.ravel())
                rise = (volume - V - float(g.ravel() @ du)) / float(g.ravel() @ flow)
                p += rise
                du += rise * flow
            x = x + self._share(x, du.reshape(-1, 3)) * du.reshape(-1, 3)
        raise RuntimeError(f"Newton stalls: {history}")
