"""A known state as a first guess for a similar actuator: nodal positions from mesh to mesh."""

from __future__ import annotations

import numpy as np

from fem.arrays import FloatArray
from fem.element import natural_nodes, shape
from fem.mesh import Mesh
from fem.sections import best_rotation, best_rotations, rotation_matrix, rotation_vector


def transfer(old: Mesh, x: FloatArray, new: Mesh) -> FloatArray:
    """Nodal positions for a new mesh by the old one's interpolation.

    Points correspond layer by layer, and at the same place in the tube's section. Where a layer
    is higher than it was its sections move apart and turn more, so that its strain stays.

    Parameters
    ----------
    old, new : Mesh
        Of the same layers, see `fem.mesh.make_mesh`, and of tubes of the same section.
    x : (layers + 1, ring + mid, 3) mm
        Nodal positions on ``old``.

    Returns
    -------
    (layers + 1, ring + mid, 3) mm
    """
    positions = np.zeros_like(new.X)
    mid = slice(new.ring, None)
    positions[:, : new.ring] = _around(old, x, new.X[0, : new.ring], -1.0)
    positions[:-1, mid] = _around(old, x, new.X[0, mid], 0.0)[:-1]
    _lengthen(old, new, positions)
    return settle(positions, new)


def settle(x: FloatArray, new: Mesh, old: Mesh | None = None) -> FloatArray:
    """Bring nodal positions onto the clamp and the rigid plug of a mesh.

    ``old`` is the mesh that says what the plug's positions mean, by default the new one.
    """
    X, positions = new.X, x.copy()
    old = old or new
    positions[-1, new.ring :] = X[-1, new.ring :]
    positions[0, : new.ring] = X[0, : new.ring]
    # The plug stays rigid to the last bit; its outer nodes say where it is, whatever the wall.
    rest, now = old.X[-1, old.outer_ring], x[-1, old.outer_ring]
    R = best_rotation(rest - rest.mean(axis=0), now - now.mean(axis=0))
    arm = X[-1, : new.ring] - rest.mean(axis=0)
    arm[:, 2] = 0.0  # both are level at rest, wherever along the tube
    positions[-1, : new.ring] = now.mean(axis=0) + arm @ R.T
    return positions


def _around(old: Mesh, x: FloatArray, at: FloatArray, zeta: float) -> FloatArray:
    """Points of every section that lie at ``at`` (n, 3) at rest: (layers + 1, n, 3)."""
    actuator, through = old.actuator, old.size.through
    share = (np.hypot(at[:, 0], at[:, 1]) - actuator.radius) / actuator.wall + 1.0
    deep = np.clip(np.floor(share * through), 0, through - 1).astype(np.int64)
    edges = old.columns - old.columns[0]
    turn = (np.arctan2(at[:, 1], at[:, 0]) - old.columns[0] + 1e-9) % (2.0 * np.pi) - 1e-9
    column = np.clip(np.searchsorted(edges, turn, side="right") - 1, 0, old.around - 1)
    eta = 2.0 * (turn - edges[column]) / (edges[column + 1] - edges[column]) - 1.0
    natural = np.column_stack([2.0 * (share * through - deep) - 1.0, eta, np.full(len(at), zeta)])
    N, _ = shape(natural_nodes(old.size.kind), np.clip(natural, -1.0, 1.0))
    nodes = old.bricks[deep * old.around + column]
    # On a ring only its own nodes count: the last one has no layer behind it.
    nodes = np.where(np.abs(N) > 1e-14, nodes, nodes[:, :1])
    step = np.arange(old.layers + 1)[:, None, None] * (old.ring + old.mid)
    flat = np.concatenate([x.reshape(-1, 3), np.zeros((old.ring + old.mid, 3))])
    points: FloatArray = np.einsum("pn,kpnj->kpj", N, flat[nodes + step])
    return points


def _lengthen(old: Mesh, new: Mesh, x: FloatArray) -> None:
    """Move the sections apart where layers are higher than they were, and turn them as much."""
    S, ring = 2 * new.layers + 1, new.ring
    centre, turned = np.zeros((S, 3)), np.zeros((S, 3, 3))
    for at, rest, now in (
        (slice(0, S, 2), new.X[:, :ring], x[:, :ring]),
        (slice(1, S, 2), new.X[:-1, ring:], x[:-1, ring:]),
    ):
        if rest.shape[1]:
            centre[at] = now.mean(axis=1) * ([0.0, 1.0, 1.0] if new.half else 1.0)
            turned[at] = best_rotations(rest, now, new.half)
    step = 1 if new.mid else 2
    centre, turned = centre[::step], turned[::step]
    longer = np.repeat(new.heights / old.heights, 2 // step)[:, None]
    spin = rotation_vector(np.swapaxes(turned[:-1], 1, 2) @ turned[1:]) * longer
    along = np.einsum("kji,kj->ki", turned[:-1], np.diff(centre, axis=0)) * longer
    R, c = [turned[0]], [centre[0]]
    for turn, offset in zip(rotation_matrix(spin), along, strict=True):
        c.append(c[-1] + R[-1] @ offset)
        R.append(R[-1] @ turn)
    moved = np.array(R) @ np.swapaxes(turned, 1, 2)  # from where the sections were
    for at, nodes in ((slice(0, None, 2 // step), x[:, :ring]), (slice(1, None, 2), x[:-1, ring:])):
        if nodes.shape[1]:
            arm = nodes - centre[at, None]
            nodes[...] = np.array(c)[at, None] + arm @ np.swapaxes(moved[at], 1, 2)
