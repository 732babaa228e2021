"""Decks for CalculiX and Abaqus: the same keywords but for the rigid body and the steps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from fem import Law, MooneyRivlin, Ogden
from fem.arrays import IntArray
from fem.export.deck import Cube, Deck
from fem.export.rows import deck_law, groups_of, row, rows, text
from fem.export.springs import Springs

# Abaqus' C3D8 takes the mean of the volume change, CalculiX' does not: it locks.
_BRICK_OF_CALCULIX = {20: "C3D20R", 8: "C3D8I"}
_BRICK_OF_ABAQUS = {20: "C3D20R", 8: "C3D8"}
_WEDGE = {15: "C3D15", 6: "C3D6"}
_NONE = 1e20  # D2 and D3: U has no such terms; CalculiX takes 0 for a value of its own
# CalculiX' largest residual force over the mean one, and largest correction over the increment;
# with its own 5e-3 the tip of two opposite joints was 0.65 % off.
_RESIDUAL = "1e-3, 1e-2"
# Iterations before CalculiX checks for divergence, for slow convergence, and gives up; its default
# of 16 is too few for its approximate tangent.
_PATIENCE = "8, 30, 30, 60, 15, 4, , 10"


def write_calculix(deck: Deck) -> str:
    """Write a deck for CalculiX."""
    ref = len(deck.X) + 1
    lines = [
        *_model(deck, _BRICK_OF_CALCULIX, 2),
        "** translations of the rigid cap, then its rotations",
        f"*RIGID BODY, NSET=CAP, REF NODE={ref}, ROT NODE={ref + 1}",
        *_held(deck, [f"{ref}, 1, 1", f"{ref + 1}, 2, 3"]),
    ]
    for pressure in deck.pressures:
        lines += ["*STEP, NLGEOM, INC=200", "*STATIC", "0.5, 1.0, 1e-3"]
        lines += ["*CONTROLS, PARAMETERS=FIELD", _RESIDUAL]
        lines += ["*CONTROLS, PARAMETERS=TIME INCREMENTATION", _PATIENCE]
        lines += [*_blown(pressure), "*NODE PRINT, NSET=TIP, FREQUENCY=1000", "U"]
        lines += ["*NODE FILE, FREQUENCY=1000", "U", "*EL FILE, FREQUENCY=1000", "S"]
        lines.append("*END STEP")
    return text(lines)


def write_abaqus(deck: Deck) -> str:
    """Write a deck for Abaqus/Standard."""
    ref = len(deck.X) + 1
    lines = [
        *_model(deck, _BRICK_OF_ABAQUS, 1),
        f"*RIGID BODY, ELSET=CAP, REF NODE={ref}",
        *_held(deck, [f"{ref}, 1, 1", f"{ref}, 5, 6"]),
    ]
    for pressure in deck.pressures:
        lines += ["*STEP, NLGEOM=YES, INC=1000, UNSYMM=YES", "*STATIC", "0.1, 1.0, 1e-6, 0.25"]
        lines += [*_blown(pressure), "*OUTPUT, FIELD, VARIABLE=PRESELECT"]
        lines += ["*NODE PRINT, NSET=TIP, FREQUENCY=1000", "U", "*END STEP"]
    return text(lines)


def write_cube(cube: Cube) -> str:
    """Write the check cube for either code; it prints the stresses at its Gauss points."""
    lines = ["*HEADING", "check cube"]
    lines += ["*NODE, NSET=NALL", *(row(n, *at) for n, at in enumerate(cube.X, start=1))]
    lines += [*_elements("C3D20R", "CUBE", np.arange(20)[None], 0), *_rubber(cube.rubber)]
    lines.append("*SOLID SECTION, ELSET=CUBE, MATERIAL=RUBBER")
    for stretch in cube.stretches:
        lines += ["*STEP, NLGEOM", "*STATIC", "0.25, 1.0", "*BOUNDARY"]
        for axis in range(3):
            for side in (0, 1):
                value = side * (stretch[axis] - 1.0)
                lines += [row(n + 1, axis + 1, axis + 1, value) for n in cube.face(axis, side)]
        lines += ["*EL PRINT, ELSET=CUBE, FREQUENCY=1000", "S", "*END STEP"]
    return text(lines)


def _model(deck: Deck, brick: Mapping[int, str], references: int) -> Iterator[str]:
    """Nodes, elements, sets and material; ``references`` more nodes on the cap, for its motion."""
    X = np.concatenate([deck.X, [[0.0, 0.0, deck.end]] * references])
    yield "*HEADING"
    yield deck.title
    yield "** mm, N, MPa; z along the tube, the object at -y"
    yield "*NODE, NSET=NALL"
    yield from (row(n, *at) for n, at in enumerate(X, start=1))
    number = 0
    for name, kinds, elements in (
        ("WALL", brick, deck.wall),
        ("CAP", _WEDGE, deck.wedges),
        ("CAP", brick, deck.cap_bricks),
    ):
        yield from _elements(kinds[elements.shape[1]], name, elements, number)
        number += len(elements)
    yield from _rubber(deck.rubber)
    yield "*SOLID SECTION, ELSET=WALL, MATERIAL=RUBBER"
    yield "** the cap is rigid: its material does not matter"
    yield "*SOLID SECTION, ELSET=CAP, MATERIAL=RUBBER"
    for name, springs in (("THREAD_AXIAL", deck.axial), ("THREAD_HOOP", deck.hoop)):
        yield from _springs(name, springs, number)
        number += len(springs.nodes)
    yield from _set("NSET", "ROOT", deck.root)
    if deck.half:
        yield from _set("NSET", "SYMMETRY", deck.symmetry)
    yield from _set("NSET", "CAP", deck.cap)
    yield from _set("NSET", "TIP", [deck.tip])
    yield from _set("ELSET", "INNER", deck.inner)


def _elements(kind: str, name: str, elements: IntArray, before: int) -> Iterator[str]:
    yield f"*ELEMENT, TYPE={kind}, ELSET={name}"
    for number, nodes in enumerate((elements + 1).tolist(), start=before + 1):
        first, *more = rows([number, *nodes], 11)
        yield first + ("," if more else "")
        yield from more


def _springs(name: str, springs: Springs, before: int) -> Iterator[str]:
    """Springs by stiffness: a table of force and elongation that no spring leaves.

    Beyond its table a spring would hold its force. Abaqus needs the blank line, where other springs
    have their directions; CalculiX skips it, and tells a force by its decimal point.
    """
    far = 2.0 * float(springs.length.max())
    groups = []
    for group, (k, own) in enumerate(groups_of(springs.stiffness), start=1):
        groups.append(f"{name}_{group}")
        yield f"*ELEMENT, TYPE=SPRINGA, ELSET={groups[-1]}"
        for n in own:
            yield row(before + int(n) + 1, *(springs.nodes[n] + 1))
        yield f"*SPRING, NONLINEAR, ELSET={groups[-1]}"
        yield ""
        yield from (f"{force:.9e}, {by:.9g}" for force, by in ((0, -far), (0, 0), (k * far, far)))
    yield f"*ELSET, ELSET={name}"
    yield from (f"{group}," for group in groups)


def _set(kind: str, name: str, members: Iterable[int]) -> Iterator[str]:
    yield f"*{kind}, {kind}={name}"
    for line in rows((int(n) + 1 for n in members), 12):
        yield line + ","


def _held(deck: Deck, on_plane: list[str]) -> list[str]:
    """Boundary conditions; ``on_plane`` those of the cap where half the tube is modelled."""
    return ["*BOUNDARY", "ROOT, 1, 3", *(["SYMMETRY, 1, 1", *on_plane] if deck.half else [])]


def _blown(pressure: float) -> list[str]:
    return ["*DLOAD", f"INNER, P1, {pressure:.12g}"]


def _rubber(rubber: Law) -> list[str]:
    """Material RUBBER, with U = (J - 1)^2 / D1."""
    law, d = deck_law(rubber), 2.0 / rubber.bulk_modulus
    if isinstance(law, MooneyRivlin):
        words = ["*HYPERELASTIC, MOONEY-RIVLIN", row(law.C10, law.C01, d)]
    elif isinstance(law, Ogden):
        # Theirs is 2 mu / alpha^2.
        terms = [v for mu, a in zip(law.mu, law.alpha, strict=True) for v in (0.5 * mu * a, a)]
        values = [*terms, d, *[_NONE] * (len(law.mu) - 1)]
        words = [f"*HYPERELASTIC, OGDEN, N={len(law.mu)}", *_wrapped(values)]
    else:
        words = ["*HYPERELASTIC, YEOH", row(law.C10, law.C20, law.C30, d, _NONE, _NONE)]
    return ["*MATERIAL, NAME=RUBBER", *words]


def _wrapped(values: list[float]) -> list[str]:
    return [row(*values[k : k + 8]) for k in range(0, len(values), 8)]
