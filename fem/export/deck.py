"""The model as other codes take it: one neutral record that every deck is written from."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np

from fem import Law
from fem.actuator import Actuator
from fem.arrays import FloatArray, IntArray
from fem.errors import BadGeometry
from fem.export.cap import make_cap
from fem.export.springs import Springs, axial_springs, hoop_springs
from fem.mesh import Mesh, make_mesh
from fem.meshsize import MeshSize
from fem.principal import principal_stresses

# The engine's kind of mesh with narrower bricks: codes integrate 20 nodes at 2 x 2 x 2 points.
DECK_MESH = MeshSize(around=8, orders=(2, 2, 2))
# As the paper's: 8-node bricks of 2 mm by 6 deg, two through the wall.
PAPER_DECK_MESH = MeshSize(
    30, 0.0, 2.0, 2.0, 2.0, 2.0, 1.0, "hex8", 2, (2, 2, 2), mean_dilatation=True
)
# Corners inside, corners outside, mid-sides inside, outside and between: the order of nodes that
# all codes share, by our own.
_ORDER = {
    "hex20": [0, 1, 2, 3, 12, 13, 14, 15, 4, 5, 6, 7, 16, 17, 18, 19, 8, 9, 10, 11],
    "hex8": list(range(8)),
}
_NO_TRANSITION = 1e-6  # springs pull from rest on


@dataclass(frozen=True)
class Deck:
    """An actuator for another code: nodes, elements, sets, material and steps.

    Nodes and elements count from 0 here and from 1 in decks; elements in the order wall, wedges,
    cap bricks, axial springs, hoop springs. The air pushes on the first face of every inner
    element, that of its first four nodes, or three of a wedge.

    Attributes
    ----------
    title : str
        Of plain letters: no code takes it for a command.
    X : (N, 3) mm
    wall : (B, 20 or 8) int
        WALL: the rubber, corners inside first.
    wedges, cap_bricks : (W, 15 or 6), (C, 20 or 8) int
        CAP: the rigid closed end.
    inner : (n,) int
        INNER: elements that the air pushes on, of the wall and all wedges.
    axial, hoop : Springs
        THREAD_AXIAL and THREAD_HOOP.
    root : (r,) int
        ROOT: nodes that are held.
    symmetry : (s,) int
        SYMMETRY: nodes that x = 0 holds where half the tube is modelled, less ROOT and CAP.
    tip : int
        TIP: the last node of the object-facing line, on the cap.
    end : float
        z of the cap's inner face, mm.
    half : bool
    rubber : Law
    pressures : tuple of float
        One step each, MPa.
    """

    title: str
    X: FloatArray
    wall: IntArray
    wedges: IntArray
    cap_bricks: IntArray
    inner: IntArray
    axial: Springs
    hoop: Springs
    root: IntArray
    symmetry: IntArray
    tip: int
    end: float
    half: bool
    rubber: Law
    pressures: tuple[float, ...]

    @property
    def quadratic(self) -> bool:
        """Whether bricks have nodes half-way along their edges."""
        return len(self.wall[0]) == 20

    @property
    def cap(self) -> IntArray:
        """Nodes of the closed end, in order."""
        return np.unique(np.concatenate([self.wedges.ravel(), self.cap_bricks.ravel()]))

    @property
    def solids(self) -> int:
        """How many bricks and wedges there are."""
        return len(self.wall) + len(self.wedges) + len(self.cap_bricks)

    @property
    def elements(self) -> int:
        """How many elements there are, springs too."""
        return self.solids + len(self.axial.nodes) + len(self.hoop.nodes)

    @property
    def inner_bricks(self) -> IntArray:
        """Elements of the wall that the air pushes on."""
        return self.inner[self.inner < len(self.wall)]


@dataclass(frozen=True)
class Cube:
    """A unit cube of the rubber, one 20-node brick, stretched along its edges: a check of the law.

    Attributes
    ----------
    rubber : Law
    stretches : tuple of (float, float, float)
        Along x, y and z, one step each. The first tries the volume alone.
    """

    rubber: Law
    stretches: tuple[tuple[float, float, float], ...] = ((1.1, 1.1, 1.1), (1.4, 0.9, 0.85))

    @property
    def X(self) -> FloatArray:
        """Nodes in the order that all codes share: (20, 3) mm."""
        corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        edges = [(k + i, k + (i + 1) % 4) for k in (0, 4) for i in range(4)]
        edges += [(i, i + 4) for i in range(4)]
        at = np.array(corners, dtype=float)
        return np.concatenate([at, [0.5 * (at[i] + at[k]) for i, k in edges]])

    def face(self, axis: int, side: int) -> IntArray:
        """Nodes of the face at 0 or 1 mm along an axis."""
        return np.flatnonzero(self.X[:, axis] == side)

    @property
    def stresses(self) -> FloatArray:
        """Normal Cauchy stresses along x, y and z at each step: (steps, 3) MPa."""
        return principal_stresses(self.rubber, np.array(self.stretches))


def for_deck(actuator: Actuator) -> Actuator:
    """Give an actuator the threads of a deck: they pull from rest on, and never push.

    Raises
    ------
    BadGeometry
        When it has what no deck holds.
    """
    if actuator.weight is not None:
        raise BadGeometry("a deck holds no weight; leave gravity out")
    if actuator.lines is not None or actuator.gauze.pitch is not None:
        raise BadGeometry("a deck holds a smeared gauze, no single threads")
    gauze = replace(actuator.gauze, slack=0.0, transition=_NO_TRANSITION)
    return replace(actuator, gauze=gauze)


def make_deck(
    actuator: Actuator, pressures: tuple[float, ...], size: MeshSize = DECK_MESH, title: str = ""
) -> tuple[Deck, Mesh]:
    """Lay an actuator out for other codes.

    Parameters
    ----------
    actuator : Actuator
    pressures : tuple of float
        MPa, rising.
    size : MeshSize
    title : str

    Returns
    -------
    deck : Deck
    mesh : Mesh
        The mesh that it was made from.

    Raises
    ------
    BadGeometry
        When the actuator has what no deck holds.
    """
    mesh = make_mesh(for_deck(actuator), size)
    return deck_of(mesh, pressures, title), mesh


def deck_of(mesh: Mesh, pressures: tuple[float, ...], title: str = "") -> Deck:
    """Lay a mesh out for other codes; see `make_deck`."""
    cap = make_cap(mesh)
    row, order = mesh.ring + mesh.mid, _ORDER[mesh.size.kind]
    X = np.concatenate([mesh.X.reshape(-1, 3)[: mesh.nodes], cap.X])
    wall = (row * np.arange(mesh.layers)[:, None, None] + mesh.bricks).reshape(-1, len(order))
    inside = np.arange(mesh.layers)[:, None] * len(mesh.bricks) + np.arange(mesh.around)
    wedges = len(wall) + np.arange(len(cap.wedges))
    root = np.arange(mesh.ring)
    taken = np.concatenate([root, cap.wedges.ravel(), cap.bricks.ravel()])
    plane = np.flatnonzero(np.abs(X[:, 0]) < 1e-9 * mesh.actuator.radius)
    facing = row * mesh.layers + mesh.outer_ring
    return Deck(
        title=re.sub(r"[^\w .,/()+]+", "_", title, flags=re.ASCII)[:72],
        X=X,
        wall=wall[:, order],
        wedges=cap.wedges,
        cap_bricks=cap.bricks[:, order],
        inner=np.concatenate([inside.ravel(), wedges]),
        axial=axial_springs(mesh),
        hoop=hoop_springs(mesh),
        root=root,
        symmetry=np.setdiff1d(plane, taken) if mesh.half else plane[:0],
        tip=int(facing[np.argmin(X[facing, 1])]),
        end=float(mesh.z[-1]),
        half=mesh.half,
        rubber=mesh.actuator.rubber,
        pressures=pressures,
    )
