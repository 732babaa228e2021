"""Decks read back, each into the same record: what a code would make of its own words.

Ansys' are read by mapdl-archive, the bricks of CalculiX' and Abaqus' by meshio, which knows neither
springs nor 15-node wedges; those, and FEBio's XML, by a few lines here.
"""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import mapdl_archive
import meshio
import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Faces = list[list[int]]  # each its corners and then its mid-sides, by index of node


@dataclass(frozen=True)
class Read:
    """A deck read back.

    Attributes
    ----------
    X : (N, 3) mm
    bricks : list of (n, 20 or 8) int
        Of the wall, then of the cap.
    sets : dict of str to int
        Members of ROOT, SYMMETRY, WALL, CAP, INNER, THREAD_AXIAL, THREAD_HOOP and TIP.
    stiffness : dict of str to float
        Sum over the springs of each family, N/mm.
    longest : dict of str to float
        Length of the longest spring, mm.
    volume : float
        Between the faces that the air pushes on and z = 0, mm^3; positive where it pushes outward.
    """

    X: FloatArray
    bricks: list[IntArray]
    sets: dict[str, int]
    stiffness: dict[str, float]
    longest: dict[str, float]
    volume: float


def enclosed(X: FloatArray, faces: Faces) -> float:
    """Volume between the origin and faces, by flat triangles, positive where normals point away."""
    return sum(
        float(np.linalg.det(x[list(corners)])) / 6.0
        for x in (X[face] for face in faces)
        for corners in _triangles(x)
    )


def _triangles(x: FloatArray) -> list[tuple[int, int, int]]:
    """Triangles between the nodes of a face; where it is curved, each lies between two lines."""
    if len(x) < 6:
        return [(0, n, n + 1) for n in range(1, len(x) - 1)]
    count = len(x) // 2
    corners = [(n, count + n, count + (n - 1) % count) for n in range(count)]
    if count == 3:
        return [*corners, (3, 4, 5)]
    bulge = np.linalg.norm(x[4:] - 0.5 * (x[:4] + np.roll(x[:4], -1, axis=0)), axis=1)
    a, b, c, d = np.roll([4, 5, 6, 7], 0 if bulge[0] > bulge[1] else 1).tolist()
    return [*corners, (a, b, c), (a, c, d)]


def first_faces(elements: Sequence[Sequence[int]]) -> Faces:
    """First faces of bricks and wedges: four nodes or three, and their mid-sides."""
    found = []
    for nodes in elements:
        corners, first = {20: (4, 8), 15: (3, 6), 8: (4, 8), 6: (3, 6)}[len(nodes)]
        found.append([*nodes[:corners], *nodes[first : first + corners]])
    return found


def read_inp(text: str) -> Read:
    """Read a deck for CalculiX or Abaqus."""
    text = re.sub(r"^\*\*.*\n", "", text, flags=re.M)
    blocks = [block.split("\n", 1) for block in re.split(r"^\*", text, flags=re.M)[1:]]
    own = [(head, _numbers(body)) for head, body in blocks if head.startswith("ELEMENT")]
    elements = {
        int(row[0]): (row[1:] - 1).astype(int)
        for head, values in own
        for row in values.reshape(-1, 1 + _nodes_of(head))
    }
    names: dict[int, str] = {}
    for head, values in own:
        for number in values.reshape(-1, 1 + _nodes_of(head))[:, 0]:
            names[int(number)] = head.partition("ELSET=")[2]
    solids = meshio.abaqus._abaqus.read_buffer(io.StringIO(_solid_bricks(text)))
    X = solids.points
    sets = _inp_sets(blocks)
    inner = _members(blocks, "ELSET, ELSET=INNER")
    families: dict[str, list[tuple[float, float]]] = {"THREAD_AXIAL": [], "THREAD_HOOP": []}
    tables = {
        head.partition("ELSET=")[2]: _numbers(body).reshape(-1, 2)
        for head, body in blocks
        if head.startswith("SPRING")
    }
    for number, name in names.items():
        if name in tables:
            (low, shrunk), rest, (high, grown) = tables[name]
            length = float(np.linalg.norm(np.diff(X[elements[number]], axis=0)))
            assert low == 0.0
            assert (rest == 0.0).all()
            assert -shrunk == grown >= 2.0 * length - 1e-6
            families[name.rpartition("_")[0]].append((high / grown, length))
    references = re.search(r"REF NODE=(\d+)", text)
    assert references
    kept = X[: int(references[1]) - 1]
    return Read(
        kept,
        [cells.data for cells in solids.cells],
        sets
        | {name: sum(kind == name for kind in names.values()) for name in ("WALL", "CAP")}
        | {name: len(springs) for name, springs in families.items()},
        {name: sum(k for k, _ in springs) for name, springs in families.items()},
        {name: max(length for _, length in springs) for name, springs in families.items()},
        enclosed(kept, first_faces([elements[n].tolist() for n in inner])),
    )


def _nodes_of(head: str) -> int:
    kind = re.search(r"TYPE=(\w+)", head)
    assert kind
    return {"C3D20R": 20, "C3D8": 8, "C3D8I": 8, "C3D15": 15, "C3D6": 6, "SPRINGA": 2}[kind[1]]


def _numbers(body: str) -> FloatArray:
    return np.array([float(word) for word in re.split(r"[,\s]+", body) if word])


def _members(blocks: list[list[str]], head: str) -> list[int]:
    return [int(n) for name, body in blocks if name == head for n in _numbers(body)]


def _inp_sets(blocks: list[list[str]]) -> dict[str, int]:
    names = {"ROOT": "NSET", "SYMMETRY": "NSET", "TIP": "NSET", "INNER": "ELSET"}
    return {name: len(_members(blocks, f"{kind}, {kind}={name}")) for name, kind in names.items()}


def _solid_bricks(text: str) -> str:
    """The mesh without what meshio does not know."""
    return re.sub(r"^\*(ELEMENT, TYPE=(?!C3D20R|C3D8)|ELSET)[^*]*", "", text, flags=re.M)


def read_ansys(text: str, folder: Path) -> Read:
    """Read a deck for Ansys."""
    file = folder / "deck.dat"
    file.write_text(text)
    deck = mapdl_archive.Archive(file, parse_vtk=False)
    assert (deck.nnum == np.arange(1, len(deck.nodes) + 1)).all()
    assert (deck.enum == np.arange(1, deck.n_elem + 1)).all()
    nodes = [row[10:].astype(int) - 1 for row in deck.elem]
    areas = dict(
        zip(
            map(int, re.findall(r"^SECTYPE,(\d+),LINK", text, re.M)),
            map(float, re.findall(r"^SECDATA,(\S+)", text, re.M)),
            strict=True,
        )
    )
    assert text.count("SECCONTROL,,1") == len(areas)
    young = re.search(r"^MP,EX,3,(\S+)", text, re.M)
    assert young
    parts = deck.element_components
    stiffness, longest = {}, {}
    for name in ("THREAD_AXIAL", "THREAD_HOOP"):
        own = parts[name] - 1
        ends = deck.nodes[np.array([nodes[n] for n in own])]
        length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        area = np.array([areas[deck.section[n]] for n in own])
        assert (deck.material_type[own] == 3).all()
        stiffness[name] = float((float(young[1]) * area / length).sum())
        longest[name] = float(length.max())
    wall = np.array([nodes[n] for n in parts["WALL"] - 1])
    cap = [nodes[n] for n in parts["CAP"] - 1]
    return Read(
        deck.nodes,
        [wall, np.array([row for row in cap if len(set(row.tolist())) == wall.shape[1]])],
        {name: len(deck.node_components.get(name, ())) for name in ("ROOT", "SYMMETRY", "TIP")}
        | {name: len(members) for name, members in parts.items()},
        stiffness,
        longest,
        enclosed(deck.nodes, [_ansys_face(nodes[n]) for n in parts["INNER"] - 1]),
    )


def _ansys_face(nodes: IntArray) -> list[int]:
    """First face of a brick, or of a wedge whose nodes K and L are one."""
    corners, sides = nodes[:4].tolist(), nodes[8:12].tolist()
    if corners[2] != corners[3]:
        return [*corners, *sides]
    assert sides[2:3] in ([], corners[2:3])
    return [*corners[:3], *sides[:2], *sides[3:]]


def read_febio(text: str) -> Read:
    """Read a deck for FEBio."""
    root = ElementTree.fromstring(text)
    X = np.array([list(map(float, _words(node))) for node in root.findall("Mesh/Nodes/node")])
    blocks = {
        block.attrib["name"]: [_ints(row) for row in block]
        for block in root.findall("Mesh/Elements")
    }
    faces = [_ints(face) for face in root.findall("Mesh/Surface[@name='INNER']/*")]
    moduli = {
        row.attrib["name"]: float(row.findtext("E", "nan"))
        for row in root.findall("Discrete/discrete_material")
    }
    springs = {
        group.attrib["name"]: np.array([_ints(row) for row in group]) - 1
        for group in root.findall("Mesh/DiscreteSet")
    }
    used = [row.attrib["discrete_set"] for row in root.findall("Discrete/discrete")]
    assert used == list(springs) == list(moduli)
    length = {
        name: np.linalg.norm(X[pairs[:, 1]] - X[pairs[:, 0]], axis=1)
        for name, pairs in springs.items()
    }
    families = {
        name: [group for group in springs if group.startswith(f"{name}_")]
        for name in ("THREAD_AXIAL", "THREAD_HOOP")
    }
    sets = {
        row.attrib["name"]: len(_ints(row))
        for kind in ("NodeSet", "ElementSet")
        for row in root.findall(f"Mesh/{kind}")
    }
    return Read(
        X,
        [np.array(blocks[name]) - 1 for name in ("WALL", "CAP_BRICKS")],
        {"SYMMETRY": 0, **sets, "WALL": len(blocks["WALL"]), "INNER": len(faces)}
        | {name: sum(len(springs[g]) for g in groups) for name, groups in families.items()},
        {name: sum(moduli[g] * len(springs[g]) for g in own) for name, own in families.items()},
        {name: max(length[g].max() for g in own) for name, own in families.items()},
        # A surface's normal leaves the solid, into the air.
        -enclosed(X, [[n - 1 for n in face] for face in faces]),
    )


def _words(row: ElementTree.Element) -> list[str]:
    return re.split(r"[,\s]+", (row.text or "").strip())


def _ints(row: ElementTree.Element) -> list[int]:
    return [int(word) for word in _words(row)]
