"""Readings off a deformed actuator: angles, lines, diameters, stretches, threads.

All quantities are those of the whole tube, also where only half of it is modelled.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem import gauze
from fem.arrays import FloatArray
from fem.element import face_nodes, natural_nodes, shape
from fem.mesh import Mesh
from fem.meshsize import start_angle
from fem.sections import best_rotations, rotation_matrix, rotation_vector

_SAMPLE = 0.5  # of the wall cubed: the most stretched rubber, whose mean counts


@dataclass(frozen=True)
class TubeLines:
    """Lines and sections along the tube; S rings.

    Attributes
    ----------
    z : (S,) mm
        Places at rest, from the clamped end to the plug's inner face.
    centre : (S, 3) mm
        Centre line: mean of the sections.
    facing, far : (S, 3) mm
        Surface lines at 270 deg (toward the object) and 90 deg.
    rotation : (S, 3, 3)
        Of the sections, from rest.
    height, breadth : (S,) mm
        Outer diameter in the bending plane (270 to 90 deg) and across it (0 to 180 deg).
    bulge : (S,) mm
        Largest distance of the surface from the section's centre, over the radius at rest.
    """

    z: FloatArray
    centre: FloatArray
    facing: FloatArray
    far: FloatArray
    rotation: FloatArray
    height: FloatArray
    breadth: FloatArray
    bulge: FloatArray


@dataclass(frozen=True)
class Sector:
    """Rigid motion of a wrapped sector, taken at its middle section.

    Attributes
    ----------
    start, end : float
        Its edges at rest, mm.
    centre : (3,) mm
    rotation : (3, 3)
        From rest.
    """

    start: float
    end: float
    centre: FloatArray
    rotation: FloatArray


@dataclass(frozen=True)
class ThreadTension:
    """How the threads are pulled.

    Attributes
    ----------
    axial_force, hoop_force : float
        Largest force a unit of width, N/mm.
    slack : (layers, around) bool
        Faces whose axial threads are slack in the middle, inside first around from 270 deg.
    slack_share : float
        Share of the wrapped surface whose axial threads are slack.
    """

    axial_force: float
    hoop_force: float
    slack: NDArray[np.bool_]
    slack_share: float


def lines(mesh: Mesh, x: FloatArray) -> TubeLines:
    """Read lines and sections off nodal positions x."""
    facing, far, side, other = (
        surface_line(mesh, x, np.radians(phi)) for phi in (270.0, 90.0, 0.0, 180.0)
    )
    centre = 0.25 * (facing + far + side + other)
    reach = np.linalg.norm(x[:, mesh.outer_ring] - centre[:, None], axis=2).max(axis=1)
    return TubeLines(
        z=mesh.z,
        centre=centre,
        facing=facing,
        far=far,
        rotation=rotations(mesh, x),
        height=np.linalg.norm(facing - far, axis=1),
        breadth=np.linalg.norm(side - other, axis=1),
        bulge=reach - mesh.actuator.radius,
    )


def rotations(mesh: Mesh, x: FloatArray) -> FloatArray:
    """Rotation of every ring from rest that fits its nodes best: (layers + 1, 3, 3)."""
    return best_rotations(mesh.X[:, : mesh.ring], x[:, : mesh.ring], mesh.half)


def surface_weights(mesh: Mesh, phi: float) -> tuple[NDArray[np.int64], FloatArray, float]:
    """Nodes of a ring and weights that give the surface point at phi, rad.

    Returns
    -------
    nodes : (n,)
    weights : (n,)
    mirror : float
        -1 where the point lies in the half that is not modelled (x changes its sign), else 1.
    """
    mirror = 1.0
    turn = (phi - start_angle()) % (2.0 * np.pi)
    if mesh.half and turn > np.pi + 1e-12:
        turn, mirror = 2.0 * np.pi - turn, -1.0
    starts = mesh.columns - start_angle()
    k = int(np.clip(np.searchsorted(starts, turn + 1e-9) - 1, 0, mesh.around - 1))
    m = face_nodes(mesh.size.kind)
    eta = float(np.clip(2.0 * (turn - starts[k]) / (starts[k + 1] - starts[k]) - 1.0, -1.0, 1.0))
    N, _ = shape(natural_nodes(mesh.size.kind)[-m:, 1:], [[eta, -1.0]])
    nodes = mesh.outer[k]
    keep = (nodes < mesh.ring) & (np.abs(N[0]) > 1e-12)
    return nodes[keep], N[0][keep], mirror


def surface_line(mesh: Mesh, x: FloatArray, phi: float) -> FloatArray:
    """Surface points at phi on all rings: (layers + 1, 3), mm."""
    nodes, weights, mirror = surface_weights(mesh, phi)
    line: FloatArray = np.einsum("n,knj->kj", weights, x[:, nodes])
    line[:, 0] *= mirror
    return line


def sectors(mesh: Mesh, shape: TubeLines) -> tuple[Sector, ...]:
    """Rigid motions of the wrapped sectors."""
    motions = []
    for start, end in mesh.actuator.wrapped:
        middle = 0.5 * (start + end)
        k = int(np.clip(np.searchsorted(mesh.z, middle) - 1, 0, mesh.layers - 1))
        share = (middle - mesh.z[k]) / (mesh.z[k + 1] - mesh.z[k])
        before, after = shape.rotation[k], shape.rotation[k + 1]
        turn = rotation_matrix(share * rotation_vector(after @ before.T))
        centre = (1.0 - share) * shape.centre[k] + share * shape.centre[k + 1]
        motions.append(Sector(start, end, centre, turn @ before))
    return tuple(motions)


def joint_angles(mesh: Mesh, x: FloatArray, wrapped: tuple[Sector, ...]) -> FloatArray:
    """Angle of every joint, rad: between the lines across the middles of the sectors beside it.

    A line runs from the surface point opposite alpha_center to the one at alpha_center, as a
    picture of the bent tube shows it. Positive toward the object, negative where the uncut
    sector faces away from it.
    """
    angles = []
    for window, before, after in zip(mesh.actuator.windows, wrapped, wrapped[1:], strict=False):
        across = surface_line(mesh, x, window.center) - surface_line(mesh, x, window.center + np.pi)
        d1, d2 = (
            np.array([np.interp(0.5 * (s.start + s.end), mesh.z, across[:, i]) for i in range(3)])
            for s in (before, after)
        )
        axis = before.rotation @ [-np.sin(window.center), np.cos(window.center), 0.0]
        sine, cosine = axis @ np.cross(d1, d2), d1 @ d2 - (d1 @ axis) * (d2 @ axis)
        theta = np.arctan2(sine, cosine)
        angles.append(-theta if window.away else theta)
    return np.array(angles)


def threads(mesh: Mesh, x: FloatArray) -> ThreadTension:
    """State of the threads."""
    material = mesh.actuator.gauze
    faces = np.arange(mesh.layers)[:, None, None] * (mesh.ring + mesh.mid) + mesh.outer
    nodes = x.reshape(-1, 3)[faces.reshape(-1, mesh.outer.shape[1])]
    force = {}
    for name, family in (("axial", mesh.axial), ("hoop", mesh.hoop)):
        lam = gauze.stretch(family, nodes)
        pull = material.stiffness * gauze.tension_law(material, lam)[1]
        force[name] = np.where(family.weight > 0.0, pull, 0.0)
        if name == "axial":
            slack_points = (lam < 1.0) & (family.weight > 0.0)
            weight = family.weight
    slack = slack_points.mean(axis=1) >= 0.5
    total = float(weight.sum())
    return ThreadTension(
        axial_force=float(force["axial"].max()),
        hoop_force=float(force["hoop"].max()),
        slack=slack.reshape(mesh.layers, mesh.around),
        slack_share=float(weight[slack_points].sum()) / total,
    )


def stretches(mesh: Mesh, x: FloatArray) -> FloatArray:
    """Stretch of the rubber about each joint: (joints,), or (1,) where there is none.

    The largest principal stretch, in the mean over the most stretched rubber there, as much as
    `_SAMPLE` of a cube as wide as the wall is thick. Its largest value at any point is none of the
    tube's: at the corners of a cut it is singular, and grows as bricks get smaller. A joint
    reaches to the middles of the sectors beside it, as its cut's edges strain both sides.
    """
    lam, volume = _points(mesh, x)
    sample = _SAMPLE * mesh.actuator.wall**3
    middles = [0.5 * (start + end) for start, end in mesh.actuator.wrapped[1:-1]]
    owner = np.searchsorted(middles, 0.5 * (mesh.z[1:] + mesh.z[:-1]))
    found = np.ones(len(middles) + 1)
    for joint in np.unique(owner):
        values, weights = (a[owner == joint].ravel() for a in (lam, volume))
        order = np.argsort(-values)
        before = np.cumsum(weights[order]) - weights[order]
        taken = np.clip(sample - before, 0.0, weights[order])
        found[joint] = float(taken @ values[order]) / float(taken.sum())
    return found


def _points(mesh: Mesh, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Largest principal stretch and volume at rest, mm^3, of all Gauss points: (layers, q) each."""
    lam, volume, c = list[FloatArray](), list[FloatArray](), mesh.around
    first = np.arange(mesh.layers) * (mesh.ring + mesh.mid)
    for deep, brick in enumerate(mesh.brick):
        nodes = mesh.bricks[deep * c : (deep + 1) * c, :, None] + first
        gradient = brick.dN @ np.moveaxis(x.reshape(-1, 3)[nodes], 3, 0)
        F = gradient.reshape(3, c, 3, -1, mesh.layers)
        F[:, :, 2] *= 2.0 / mesh.heights
        C = np.einsum("kciql,kcjql->lcqij", F, F).reshape(mesh.layers, -1, 3, 3)
        lam.append(np.sqrt(np.linalg.eigvalsh(C)[..., 2]))
        weights = brick.weights.ravel() * (2.0 if mesh.half else 1.0)
        volume.append(weights * 0.5 * mesh.heights[:, None])
    return np.concatenate(lam, axis=1), np.concatenate(volume, axis=1)
