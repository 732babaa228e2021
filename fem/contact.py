"""Contact of an actuator's outer surface with a rigid obstacle that is given by its gap.

A point x of the outer surface has the gap g(x): its distance from the obstacle, negative inside
it. Contact adds the potential sum W eps psi(-g) over Gauss points of the outer faces, W their
area at rest. Taken at nodes, a uniform pressure would pull at the corners of quadratic faces.

Glossary
--------
g, n, H : gap (mm), its gradient (the obstacle's outward normal), its second derivative (1/mm)
eps : penalty, MPa of contact pressure per mm of depth
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fem.arrays import BoolArray, FloatArray, IntArray
from fem.element import face_nodes, gauss, natural_nodes, shape
from fem.friction import Hold
from fem.gap import Gap, Obstacle
from fem.items import Batch
from fem.material import PAIRS
from fem.mesh import Mesh

PENALTY = 30.0  # MPa/mm
RAMP_MM = 0.02  # of depth, over which the penalty sets in
_CLAMPED = 0.15  # of the diameter, that the clamp stiffens
ORDERS = (6, 3)  # Gauss points of a face, around and along


@dataclass(frozen=True)
class Surface:
    """Gauss points of a mesh's outer faces: L layers, c faces around, q points, m nodes.

    Attributes
    ----------
    N : (q, m)
        Shape functions.
    area : (L, c, q), mm^2
        At rest.
    nodes : (L, c, m)
    """

    N: FloatArray
    area: FloatArray
    nodes: IntArray

    @classmethod
    def of(cls, mesh: Mesh) -> Surface:
        """Lay the points out on a mesh."""
        m = face_nodes(mesh.size.kind)
        points, w = gauss(ORDERS)
        N, dN = shape(natural_nodes(mesh.size.kind)[-m:, 1:], points)
        first = np.arange(mesh.layers)[:, None, None] * (mesh.ring + mesh.mid)
        nodes = first + mesh.outer
        along = np.einsum("qnd,lcni->lcqdi", dN, mesh.X.reshape(-1, 3)[nodes])
        area = w * np.linalg.norm(np.cross(along[..., 0, :], along[..., 1, :]), axis=-1)
        return cls(N, area, nodes)

    def points(self, x: FloatArray) -> FloatArray:
        """Places of all points, (L, c, q, 3) mm, for nodes x (N, 3)."""
        return np.asarray(self.N @ x[self.nodes])


class Contact:
    """Contact with an obstacle; makes the items of a mesh, as `fem.items.MakeItem` does.

    Parameters
    ----------
    obstacle : Obstacle
        Mirrored by x = 0 where a half model is to meet it.
    penalty : float
        MPa/mm.
    ramp : float
        mm of depth over which the penalty sets in.
    friction : float
        Coefficient.

    Attributes
    ----------
    offset : (L, c, q), mm, or None
        How far the obstacle stands out at each point, which so presses without any depth: the
        multiplier over the penalty; see `update`.
    lift : float, mm
        How far the obstacle stands back from its place.
    hold : fem.friction.Hold, or None
        The state that friction counts the slip from; see `take_hold`.
    """

    def __init__(
        self,
        obstacle: Obstacle,
        penalty: float = PENALTY,
        ramp: float = RAMP_MM,
        friction: float = 0.0,
    ) -> None:
        self.obstacle, self.penalty, self.ramp, self.friction = obstacle, penalty, ramp, friction
        self.hold: Hold | None = None
        self.offset: FloatArray | None = None
        self.lift = 0.0

    def __call__(self, mesh: Mesh) -> _Item:
        """Give an item of a mesh; all items of it share the multipliers."""
        return _Item(self, mesh)

    def pressure(self, distance: FloatArray, offset: FloatArray | float) -> FloatArray:
        """Contact pressure at points with gaps (...), MPa."""
        return self.penalty * self._law(offset - distance)[1]

    def _law(self, depth: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """psi, psi' and psi'' at depths: psi'' rises over the ramp from 0 to 1."""
        d = self.ramp
        part, over = np.clip(depth, 0.0, d), np.maximum(depth - d, 0.0)
        slope = part / d
        return (
            part * part * slope / 6.0 + over * (0.5 * d + 0.5 * over),
            0.5 * part * slope + over,
            slope,
        )

    def derivatives(
        self, points: FloatArray, area: FloatArray, offset: FloatArray | float
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy at points (..., 3) without friction, and its first and second derivative there.

        Parameters
        ----------
        points : (..., 3) mm
        area : (...) mm^2
        offset : (...) mm
            See `Contact`; 0 where there is none.

        Returns
        -------
        energy : (...) N mm
        push : (..., 3) N
        moduli : (..., 3, 3) N/mm
        """
        gap = self.obstacle.gap(points.reshape(-1, 3))
        psi, slope, curve = self._law(offset - gap.distance.reshape(area.shape) - self.lift)
        weight, normal = self.penalty * area, gap.normal.reshape(points.shape)
        push = (weight * slope)[..., None]
        moduli = (weight * curve)[..., None, None] * normal[..., :, None] * normal[..., None, :]
        moduli -= push[..., None] * gap.bend.reshape(*points.shape, 3)
        return weight * psi, -push * normal, moduli

    def energy(self, mesh: Mesh, x: FloatArray) -> float:
        """Energy that contact adds at nodes x (layers + 1, ring + mid, 3), N mm."""
        surface = Surface.of(mesh)
        points = surface.points(x.reshape(-1, 3))
        offset = 0.0 if self.offset is None else self.offset
        energy = float(self.derivatives(points, surface.area, offset)[0].sum())
        if self.hold is None:
            return energy
        return energy + float((surface.area * self.hold.respond(points)[0]).sum())

    def take_hold(self, mesh: Mesh, x: FloatArray, *, slip: bool = True) -> None:
        """Count slip from nodes x, or without ``slip`` renew the pressure that bounds friction."""
        if self.friction <= 0.0:
            return
        pressed = pressed_of(self, mesh, x)
        bound = self.friction * pressed.pressure
        if slip or self.hold is None:
            normal = pressed.gap.normal.reshape(pressed.points.shape)
            start = pressed.points if self.hold is None else self.hold.dragged(pressed.points)
            self.hold = Hold(start, normal, bound)
        else:
            self.hold = replace(self.hold, bound=bound)

    def update(self, pressed: Pressed) -> None:
        """Let the obstacle stand out so far that a state's contact pressure needs no depth.

        Not beside the clamp, where nothing gives way: there the pressure would grow for ever.
        """
        slope = pressed.pressure / self.penalty
        half = 0.5 * self.ramp
        out = np.where(slope < half, np.sqrt(2.0 * self.ramp * slope), slope + half)
        self.offset = np.where(pressed.clamped[:, None, None], 0.0, out)


@dataclass(frozen=True)
class Pressed:
    """What contact does at a state: L layers, c faces, q points.

    Attributes
    ----------
    points : (L, c, q, 3) mm
    gap : Gap
        Of the points, in one row: (L c q, ...).
    pressure : (L, c, q) MPa
    area : (L, c, q) mm^2
    drag : (L, c, q, 3) MPa
        Friction on the obstacle.
    clamped : (L,)
        Layers so near to the clamp that they hardly give way.
    """

    points: FloatArray
    gap: Gap
    pressure: FloatArray
    area: FloatArray
    drag: FloatArray
    clamped: BoolArray

    @property
    def depth(self) -> float:
        """Largest depth in the obstacle, mm; the first layer, which the clamp holds, left out."""
        return max(0.0, -float(self.gap.distance.reshape(self.area.shape)[1:].min()))

    @property
    def own_depth(self) -> float:
        """The same beyond the layers that the clamp stiffens, where multipliers help."""
        free = self.gap.distance.reshape(self.area.shape)[~self.clamped]
        return max(0.0, -float(free.min(initial=0.0)))

    @cached_property
    def force(self) -> FloatArray:
        """Force on the obstacle by each point (L, c, q, 3), N."""
        push = self.pressure[..., None] * self.gap.normal.reshape(self.points.shape)
        return np.asarray(self.area[..., None] * (self.drag - push))


def pressed_of(contact: Contact, mesh: Mesh, x: FloatArray) -> Pressed:
    """Read contact off a state with nodes x (layers + 1, ring + mid, 3), mm."""
    surface = Surface.of(mesh)
    points = surface.points(x.reshape(-1, 3))
    gap = contact.obstacle.gap(points.reshape(-1, 3))
    gap = replace(gap, distance=gap.distance + contact.lift)
    offset = 0.0 if contact.offset is None else contact.offset
    pressure = contact.pressure(gap.distance.reshape(surface.area.shape), offset)
    drag = np.zeros_like(points) if contact.hold is None else contact.hold.respond(points)[1]
    clamped = mesh.z[:-1] < _CLAMPED * mesh.actuator.diameter
    return Pressed(points, gap, pressure, surface.area, drag, clamped)


class _Item:
    def __init__(self, contact: Contact, mesh: Mesh) -> None:
        self._contact, self._surface = contact, Surface.of(mesh)

    def add(self, batch: Batch) -> None:
        """Add energy, forces and stiffness of a batch's faces that touch."""
        contact, surface = self._contact, self._surface
        layers = slice(batch.layers.start, batch.layers.stop)
        points = np.asarray(surface.N @ batch.x[surface.nodes[layers]])  # (L, c, q, 3)
        near = contact.obstacle.near(points.reshape(-1, 3)).reshape(points.shape[:3])
        faces = np.nonzero(near.any(axis=2))  # (layer, around)
        if not faces[0].size:
            return
        points, area = points[faces], surface.area[layers][faces]  # (f, q, 3), (f, q)
        offset = 0.0 if contact.offset is None else contact.offset[layers][faces]
        energy, push, moduli = contact.derivatives(points, area, offset)
        batch.sums.energy += float(energy.sum())
        held = None if contact.hold is None else contact.hold.at(layers, faces)
        if held is not None:
            cost, drag, hinder = held.respond(points)
            batch.sums.energy += float((area * cost).sum())
            push += area[..., None] * drag
        forces = surface.N.T @ push  # (f, m, 3)
        batch.add_forces(surface.nodes[layers][faces], np.moveaxis(forces, -1, 0))
        if batch.skin is None:
            return
        if held is not None:
            moduli += area[..., None, None] * hinder
        pairs = (surface.N[:, :, None] * surface.N[:, None, :]).reshape(len(surface.N), -1)
        m = surface.N.shape[1]
        layer, around = faces
        for number, (i, k) in enumerate(PAIRS):
            block = (moduli[..., i, k] @ pairs).reshape(-1, m, m)
            batch.skin[number][around, layer] += block
