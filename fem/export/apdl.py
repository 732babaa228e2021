"""Decks for Ansys Mechanical APDL, with the elements of the paper's own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from fem import Law, MooneyRivlin, Ogden
from fem.arrays import FloatArray
from fem.export.deck import Cube, Deck
from fem.export.rows import deck_law, groups_of, row, text
from fem.gauze import THREAD_E

_RUBBER, _CAP, _THREAD = 1, 2, 3  # materials
_SOLID, _LINK = 1, 2  # element types
_CAP_E, _CAP_NU = 70000.0, 0.33  # the paper's plug, rigid for all purposes
_SUBSTEPS = "NSUBST,10,1000,4"
_NONE = 1e20  # d2 and d3: U has no such terms
# A wedge is a brick whose nodes K and L are one, O and P, and so on.
_DEGENERATE = {
    15: [0, 1, 2, 2, 3, 4, 5, 5, 6, 7, 2, 8, 9, 10, 5, 11, 12, 13, 14, 14],
    6: [0, 1, 2, 2, 3, 4, 5, 5],
}


def write_ansys(deck: Deck) -> str:
    """Write a deck for Ansys."""
    sections = list(_sections(deck))
    return text(
        [
            *_head(deck.title, deck.quadratic),
            f"ET,{_LINK},180",
            "! the section of a link keeps its area",
            f"KEYOPT,{_LINK},2,1",
            *_nodes(deck.X),
            *_elements(deck, sections),
            *_components(deck),
            *_materials(deck.rubber),
            *_link_sections(sections),
            *_steps(deck),
        ]
    )


def write_cube(cube: Cube) -> str:
    """Write the check cube; it lists the stresses at its nodes."""
    lines = [*_head("check cube", True), *_nodes(cube.X), "EBLOCK,19,SOLID,1,1", "(19i10)"]
    lines += [*_element(1, _SOLID, _RUBBER, 1, range(1, 21)), "-1", *_rubber(cube.rubber)]
    lines += ["FINISH", "/SOLU", "ANTYPE,STATIC", "NLGEOM,ON", _SUBSTEPS]
    for step, stretch in enumerate(cube.stretches, start=1):
        lines.append(f"TIME,{step}")
        for axis, name in enumerate("XYZ"):
            for side in (0, 1):
                value = side * (stretch[axis] - 1.0)
                lines += [f"D,{n + 1},U{name},{value:.12g}" for n in cube.face(axis, side)]
        lines.append("SOLVE")
    lines += ["FINISH", "/POST1"]
    for step in range(1, len(cube.stretches) + 1):
        lines += [f"SET,{step},LAST", "PRNSOL,S,COMP"]
    return text([*lines, "FINISH"])


def _head(title: str, quadratic: bool) -> list[str]:
    """Begin; KEYOPT(2) = 0: mean volume change for 8 nodes, 2 x 2 x 2 points for 20."""
    return [
        f"/TITLE,{title}",
        "! mm, N, MPa; z along the tube, the object at -y",
        "/PREP7",
        f"ET,{_SOLID},{186 if quadratic else 185}",
        f"KEYOPT,{_SOLID},2,0",
    ]


def _nodes(X: FloatArray) -> Iterator[str]:
    yield f"NBLOCK,6,SOLID,{len(X)},{len(X)}"
    yield "(3i9,6e21.13e3)"
    for number, at in enumerate(X.tolist(), start=1):
        yield f"{number:9d}{0:9d}{0:9d}" + "".join(_fixed(value) for value in at)
    yield "N,R5.3,LOC,-1,"


def _fixed(value: float) -> str:
    """Write a number in 21 characters with three digits in its exponent."""
    digits, _, exponent = f"{value:.13E}".partition("E")
    return f"{digits}E{int(exponent):+04d}".rjust(21)


def _sections(deck: Deck) -> Iterator[tuple[float, list[int], list[tuple[int, int]]]]:
    """Area of a link (mm^2), numbers of the elements that have it, and their nodes."""
    number = deck.solids
    for springs in (deck.axial, deck.hoop):
        for area, own in groups_of(springs.stiffness * springs.length / THREAD_E):
            nodes = [(int(i) + 1, int(k) + 1) for i, k in springs.nodes[own]]
            yield area, (own + number + 1).tolist(), nodes
        number += len(springs.nodes)


def _elements(
    deck: Deck, sections: Sequence[tuple[float, list[int], list[tuple[int, int]]]]
) -> Iterator[str]:
    yield f"EBLOCK,19,SOLID,{deck.elements},{deck.elements}"
    yield "(19i10)"
    number = 0
    wedges = deck.wedges[:, _DEGENERATE[deck.wedges.shape[1]]]
    for material, solids in ((_RUBBER, deck.wall), (_CAP, wedges), (_CAP, deck.cap_bricks)):
        for nodes in (solids + 1).tolist():
            number += 1
            yield from _element(number, _SOLID, material, 1, nodes)
    links = sorted(
        (link, section, nodes)
        for section, (_, numbers, pairs) in enumerate(sections, start=2)
        for link, nodes in zip(numbers, pairs, strict=True)
    )
    for link, section, nodes in links:
        yield from _element(link, _LINK, _THREAD, section, nodes)
    yield "-1"


def _element(
    number: int, kind: int, material: int, section: int, nodes: Sequence[int]
) -> Iterator[str]:
    head = [material, kind, 1, section, 0, 0, 0, 0, len(nodes), 0, number]
    for line in ([*head, *nodes[:8]], nodes[8:]):
        if line:
            yield "".join(f"{value:10d}" for value in line)


def _components(deck: Deck) -> Iterator[str]:
    first = deck.solids
    second, end = first + len(deck.axial.nodes), deck.elements
    yield from _component("ROOT", "NODE", deck.root)
    if deck.half:
        # The cap is no rigid body here: its plane of symmetry must be held, too.
        plane = deck.cap[np.abs(deck.X[deck.cap, 0]) < 1e-9 * np.abs(deck.X).max()]
        yield from _component("SYMMETRY", "NODE", np.union1d(deck.symmetry, plane))
    yield from _component("CAP_NODES", "NODE", deck.cap)
    yield from _component("TIP", "NODE", [deck.tip])
    yield from _component("WALL", "ELEM", range(len(deck.wall)))
    yield from _component("CAP", "ELEM", range(len(deck.wall), first))
    yield from _component("INNER", "ELEM", deck.inner)
    yield from _component("THREAD_AXIAL", "ELEM", range(first, second))
    yield from _component("THREAD_HOOP", "ELEM", range(second, end))


def _component(name: str, kind: str, members: Iterable[int]) -> Iterator[str]:
    numbers = [int(n) + 1 for n in members]
    yield f"CMBLOCK,{name},{kind},{len(numbers):8d}"
    yield "(8i10)"
    for k in range(0, len(numbers), 8):
        yield "".join(f"{n:10d}" for n in numbers[k : k + 8])


def _materials(rubber: Law) -> list[str]:
    return [
        *_rubber(rubber),
        "! the cap, rigid beside the rubber",
        f"MP,EX,{_CAP},{_CAP_E:g}",
        f"MP,PRXY,{_CAP},{_CAP_NU:g}",
        "! the threads",
        f"MP,EX,{_THREAD},{THREAD_E:g}",
        f"MP,PRXY,{_THREAD},0.3",
    ]


def _rubber(rubber: Law) -> list[str]:
    """Material of the wall, with U = (J - 1)^2 / d."""
    law, d = deck_law(rubber), 2.0 / rubber.bulk_modulus
    if isinstance(law, MooneyRivlin):
        return [f"TB,HYPER,{_RUBBER},1,2,MOONEY", f"TBDATA,1,{row(law.C10, law.C01, d, apart=',')}"]
    if isinstance(law, Ogden):
        terms = [v for pair in zip(law.mu, law.alpha, strict=True) for v in pair]
        count, name = len(law.mu), "OGDEN"
    else:
        terms, count, name = [law.C10, law.C20, law.C30], 3, "YEOH"
    values = [*terms, d, *[_NONE] * (count - 1)]
    return [
        f"TB,HYPER,{_RUBBER},1,{count},{name}",
        *(f"TBDATA,{k + 1},{row(*values[k : k + 6], apart=',')}" for k in range(0, len(values), 6)),
    ]


def _link_sections(
    sections: Sequence[tuple[float, list[int], list[tuple[int, int]]]],
) -> Iterator[str]:
    yield "! links in tension only, by area"
    for number, (area, *_) in enumerate(sections, start=2):
        yield f"SECTYPE,{number},LINK"
        yield f"SECDATA,{area:.12g}"
        yield "SECCONTROL,,1"


def _steps(deck: Deck) -> Iterator[str]:
    yield from ("FINISH", "/SOLU", "ANTYPE,STATIC", "NLGEOM,ON", "OUTRES,ALL,LAST")
    yield "D,ROOT,ALL"
    if deck.half:
        yield "D,SYMMETRY,UX"
    for step, pressure in enumerate(deck.pressures, start=1):
        yield from (f"TIME,{step}", "AUTOTS,ON", _SUBSTEPS, "KBC,0")
        yield "CMSEL,S,INNER,ELEM"
        yield f"SFE,ALL,1,PRES,0,{pressure:.12g}"
        yield from ("ALLSEL,ALL", "SOLVE")
    yield from ("FINISH", "/POST1", "CMSEL,S,TIP,NODE")
    for step in range(1, len(deck.pressures) + 1):
        yield from (f"SET,{step},LAST", "PRNSOL,U,COMP")
    yield from ("ALLSEL,ALL", "FINISH")
