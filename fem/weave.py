"""Threads on a mesh's outer faces, and the part of them that a window leaves uncut."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from fem.actuator import Actuator, Window
from fem.arrays import FloatArray, IntArray
from fem.element import face_nodes, natural_nodes, shape
from fem.gauze import Gauze, Threads
from fem.meshsize import MeshSize, one_brick, start_angle


def _face_gradient(size: MeshSize, eta: FloatArray, zeta: FloatArray) -> FloatArray:
    """Shape derivatives of an outer face by (eta, zeta): (..., n, 2)."""
    m = face_nodes(size.kind)
    nodes = natural_nodes(size.kind)[-m:, 1:]
    _, dN = shape(nodes, np.column_stack([eta.ravel(), zeta.ravel()]))
    return dN.reshape(*eta.shape, m, 2)


def axial_threads(
    actuator: Actuator,
    size: MeshSize,
    heights: FloatArray,
    segment: IntArray,
    columns: FloatArray,
) -> Threads:
    """Place the axial threads.

    Parameters
    ----------
    actuator : Actuator
    size : MeshSize
    heights : (layers,) mm
    segment : (layers,) int
        Which stretch of the tube a layer lies in; see `fem.mesh.Mesh`.
    columns : (around + 1,) rad
        Where the faces of a layer begin and end.
    """
    gauze = actuator.gauze
    around = len(columns) - 1
    kinds, which = _kinds(actuator, segment)
    lines = [_lines(actuator, columns, kind, size) for kind in kinds]
    most = max(eta.shape[1] for eta, _ in lines)
    eta, width = (
        np.stack([np.pad(pair[k], ((0, 0), (0, most - pair[k].shape[1]))) for pair in lines])
        for k in (0, 1)
    )
    zeta, along = np.polynomial.legendre.leggauss(size.orders[2])
    shape_at = np.broadcast_to(eta[..., None], (*eta.shape, len(zeta)))
    dN = _face_gradient(size, shape_at, np.broadcast_to(zeta, shape_at.shape))
    gradient = dN[..., 1].reshape(len(kinds), around, -1, dN.shape[-2])
    weight = (gauze.stiffness * width[..., None] * along).reshape(len(kinds), around, -1)
    half = 0.5 * heights[:, None, None]
    gradient = gradient[which] / half[..., None]
    weight = weight[which] * half
    return Threads(gradient.reshape(-1, *gradient.shape[2:]), weight.reshape(-1, weight.shape[2]))


Kind = Window | int | None


def _kinds(actuator: Actuator, segment: IntArray) -> tuple[list[Kind], list[int]]:
    """Kinds of layers by their axial threads, and which of them each layer is.

    None for wrapped sectors, else the window, or its number where it has single threads.
    """
    single = actuator.lines is not None
    of_layers: list[Kind] = [
        None if k % 2 == 0 else k // 2 if single else actuator.windows[k // 2]
        for k in segment.tolist()
    ]
    kinds = list(dict.fromkeys(of_layers))
    return kinds, [kinds.index(kind) for kind in of_layers]


def _lines(
    actuator: Actuator, columns: FloatArray, kind: Kind, size: MeshSize
) -> tuple[FloatArray, FloatArray]:
    """Where uncut axial threads cross each face of a layer: (eta, width in mm), each (around, q).

    The smeared gauze takes Gauss points within the covered part of each face, so that the edge
    of a sector need not lie on the mesh.
    """
    gauze, radius = actuator.gauze, actuator.radius
    if isinstance(kind, int):
        assert actuator.lines is not None
        angles = np.array(actuator.lines.angles[kind])
        return _at_angles(columns, angles, actuator.lines.EA / gauze.stiffness)
    if gauze.pitch is not None:
        return _single_lines(gauze, radius, columns, kind)
    points, w = np.polynomial.legendre.leggauss(size.orders[1])
    parts = np.array([covered(gauze, start, end, kind) for start, end in pairwise(columns)])
    a, b = parts[..., 0, None], parts[..., 1, None]
    eta = 0.5 * (a + b) + 0.5 * (b - a) * points
    width = 0.5 * (b - a) * w * (0.5 * radius * np.diff(columns)[:, None, None])
    keep = (b - a)[..., 0].any(axis=0)
    keep[0] = True
    flat = (len(columns) - 1, -1)
    return eta[:, keep].reshape(flat), width[:, keep].reshape(flat)


def covered(
    gauze: Gauze, start: float, end: float, window: Window | None
) -> list[tuple[float, float]]:
    """Give the covered parts of a face in eta, at most two."""
    if window is None:
        return [(-1.0, 1.0), (0.0, 0.0)]
    half, span = 0.5 * (window.alpha + gauze.allowance), end - start
    parts = []
    for turn in (-2.0 * np.pi, 0.0, 2.0 * np.pi):
        middle = window.center - np.floor((window.center - start) / (2.0 * np.pi)) * 2.0 * np.pi
        low = max(middle + turn - half, start)
        high = min(middle + turn + half, end)
        if high - low > 1e-9 * span:
            parts.append((2.0 * (low - start) / span - 1.0, 2.0 * (high - start) / span - 1.0))
    return (parts + [(0.0, 0.0)] * 2)[:2]


def _single_lines(
    gauze: Gauze, radius: float, columns: FloatArray, window: Window | None
) -> tuple[FloatArray, FloatArray]:
    """Single threads at the pitch, the first one facing the object."""
    assert gauze.pitch is not None
    count = max(4, round(2.0 * np.pi * radius / gauze.pitch))
    step = 2.0 * np.pi / count
    phi = start_angle() + np.arange(0.0, count) * step
    if window is not None:
        apart = (phi - window.center + np.pi) % (2.0 * np.pi) - np.pi
        phi = phi[np.abs(apart) <= 0.5 * (window.alpha + gauze.allowance) + 1e-9]
    return _at_angles(columns, phi, step * radius)


def _at_angles(
    columns: FloatArray, angles: FloatArray, width: float
) -> tuple[FloatArray, FloatArray]:
    """Lines at angles (rad) that stand for a width (mm) each: (eta, width), each (around, q).

    A line on the border of two faces counts half in each; so does one on the plane of symmetry,
    the other half of which is not modelled.
    """
    turn = np.sort((angles - columns[0] + 1e-9) % (2.0 * np.pi) - 1e-9)
    turn = columns[0] + np.concatenate([turn, turn[:1] + 2.0 * np.pi])
    rows = []
    for start, end in pairwise(columns):
        eta = 2.0 * (turn - start) / (end - start) - 1.0
        eta = eta[(eta >= -1.0 - 1e-9) & (eta <= 1.0 + 1e-9)]
        shares = np.where(np.abs(np.abs(eta) - 1.0) < 1e-9, 0.5, 1.0)
        rows.append(list(zip(np.clip(eta, -1.0, 1.0), shares * width, strict=True)))
    most = max(1, *(len(row) for row in rows))
    table = np.array([row + [(0.0, 0.0)] * (most - len(row)) for row in rows])
    return table[..., 0], table[..., 1]


def hoop_threads(actuator: Actuator, size: MeshSize, z: FloatArray, columns: FloatArray) -> Threads:
    """Place the hoop threads, which no cut severs: on all faces of layers between z (mm)."""
    gauze, heights = actuator.gauze, np.diff(z)
    rule, w = np.polynomial.legendre.leggauss(size.orders[2])
    zeta = np.broadcast_to(rule, (len(heights), len(rule)))
    width = 0.5 * heights[:, None] * w
    if gauze.pitch is not None:
        zeta, width = _single_rings(gauze.pitch, z)
    eta, around_w = np.polynomial.legendre.leggauss(size.orders[1])
    shape_at = (len(heights), zeta.shape[1], len(eta))
    dN = _face_gradient(
        size, np.broadcast_to(eta, shape_at), np.broadcast_to(zeta[:, :, None], shape_at)
    )
    gradient = dN[..., 0].reshape(len(heights), 1, -1, dN.shape[-2])
    # The face is a parabola, not quite an arc: along the thread by its own speed.
    speed = np.linalg.norm(gradient @ _face_positions(actuator, size, columns), axis=-1)
    weight = gauze.stiffness * (width[:, :, None] * around_w).reshape(len(heights), 1, -1) * speed
    faces = speed.shape[0] * speed.shape[1]
    return Threads(
        (gradient / speed[..., None]).reshape(faces, *gradient.shape[2:]),
        weight.reshape(faces, -1),
    )


def _face_positions(actuator: Actuator, size: MeshSize, columns: FloatArray) -> FloatArray:
    """Nodes of a layer's outer faces, each turned to +x and laid flat along z: (around, n, 3)."""
    bricks = [one_brick(actuator, size, span, size.through - 1) for span in np.diff(columns)]
    flat: FloatArray = np.array(bricks)[:, -face_nodes(size.kind) :] * [1.0, 1.0, 0.0]
    return flat


def _single_rings(pitch: float, z: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Hoop threads at the pitch: (zeta, width), each (layers, q)."""
    places = (np.arange(np.ceil(z[-1] / pitch)) + 0.5) * pitch
    rows = []
    for low, high in pairwise(z.tolist()):
        inside = places[(places >= low) & (places < high)]
        rows.append([(2.0 * (p - low) / (high - low) - 1.0, pitch) for p in inside])
    most = max(1, *(len(row) for row in rows))
    table = np.array([row + [(0.0, 0.0)] * (most - len(row)) for row in rows])
    return table[..., 0], table[..., 1]
