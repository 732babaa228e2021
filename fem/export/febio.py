"""Decks for FEBio 4."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from fem import Law, MooneyRivlin, Ogden
from fem.arrays import FloatArray, IntArray
from fem.export.deck import Cube, Deck
from fem.export.rows import deck_law, groups_of, row, rows, text

_PARTS = 10  # substeps of a step, at least
# The pressure model of U = K/2 (J - 1)^2; the default is K/2 (ln J)^2.
_PRESSURE_MODEL = 2
# First faces of bricks and wedges, turned: a surface's normal leaves the solid.
_FACES = {
    20: ("quad8", [0, 3, 2, 1, 11, 10, 9, 8]),
    8: ("quad4", [0, 3, 2, 1]),
    15: ("tri6", [0, 2, 1, 8, 7, 6]),
    6: ("tri3", [0, 2, 1]),
}
_KINDS = {20: "hex20", 8: "hex8", 15: "penta15", 6: "penta6"}


def write_febio(deck: Deck) -> str:
    """Write a deck for FEBio."""
    groups = [
        (f"{name}_{number}", k, springs.nodes[own])
        for name, springs in (("THREAD_AXIAL", deck.axial), ("THREAD_HOOP", deck.hoop))
        for number, (k, own) in enumerate(groups_of(springs.stiffness), start=1)
    ]
    domain = ' elem_type="HEX20G8"' if deck.quadratic else ""
    return text(
        [
            *_head(deck.title, len(deck.pressures), 1),
            "<Material>",
            *_rubber(deck.rubber),
            '<material id="2" name="CAP" type="rigid body">',
            f"<center_of_mass>0,0,{deck.end:.12g}</center_of_mass>",
            "</material>",
            "</Material>",
            "<Mesh>",
            *_nodes(deck.X),
            *_solids(deck),
            *_sets(deck),
            *_discrete_sets(groups),
            "</Mesh>",
            "<MeshDomains>",
            f'<SolidDomain name="WALL" mat="RUBBER"{domain}/>',
            '<SolidDomain name="CAP_WEDGES" mat="CAP"/>',
            '<SolidDomain name="CAP_BRICKS" mat="CAP"/>',
            "</MeshDomains>",
            *_held(deck),
            *_springs(groups),
            "<Loads>",
            '<surface_load name="air" surface="INNER" type="pressure">',
            '<pressure lc="1">1</pressure>',
            "<linear>0</linear>",
            "</surface_load>",
            "</Loads>",
            *_curves([deck.pressures]),
            *_output(f'<node_data data="ux;uy;uz" file="tip.txt">{deck.tip + 1}</node_data>'),
        ]
    )


def write_cube(cube: Cube) -> str:
    """Write the check cube; it lists the stresses of its brick in stress.txt."""
    faces = [(f"{axis}{side}", k, side) for k, axis in enumerate("xyz") for side in (0, 1)]
    lines = [*_head("check cube", len(cube.stretches), 3), "<Material>", *_rubber(cube.rubber)]
    lines += ["</Material>", "<Mesh>", *_nodes(cube.X)]
    lines += _elements("CUBE", np.arange(20)[None], 0)
    for name, axis, side in faces:
        lines += _set("NodeSet", name, cube.face(axis, side))
    lines += ["</Mesh>", "<MeshDomains>"]
    lines += ['<SolidDomain name="CUBE" mat="RUBBER" elem_type="HEX20G8"/>', "</MeshDomains>"]
    lines.append("<Boundary>")
    for name, axis, side in faces:
        lines += [
            f'<bc name="{name}" node_set="{name}" type="prescribed displacement">',
            f"<dof>{'xyz'[axis]}</dof>",
            f'<value lc="{axis + 1}">{side}</value>',
            "<relative>0</relative>",
            "</bc>",
        ]
    lines.append("</Boundary>")
    lines += _curves([[s[axis] - 1.0 for s in cube.stretches] for axis in range(3)])
    stress = '<element_data data="sx;sy;sz" file="stress.txt">1</element_data>'
    return text([*lines, *_output(stress)])


def _head(title: str, steps: int, curves: int) -> list[str]:
    """Begin: a step is a second, and every whole second is reached and printed.

    The last load curve, behind ``curves`` others, says which times must be reached, and by steps
    of what length.
    """
    part = 1.0 / _PARTS
    return [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f"<!-- {title}; mm, N, MPa; z along the tube, the object at -y -->",
        '<febio_spec version="4.0">',
        '<Module type="solid"/>',
        "<Control>",
        "<analysis>STATIC</analysis>",
        f"<time_steps>{_PARTS * steps}</time_steps>",
        f"<step_size>{part:g}</step_size>",
        "<plot_level>PLOT_MUST_POINTS</plot_level>",
        "<output_level>OUTPUT_MUST_POINTS</output_level>",
        '<time_stepper type="default">',
        "<max_retries>20</max_retries>",
        "<opt_iter>15</opt_iter>",
        f"<dtmin>{0.001 * part:g}</dtmin>",
        f'<dtmax lc="{curves + 1}">0</dtmax>',
        "</time_stepper>",
        '<solver type="solid">',
        "<max_refs>50</max_refs>",
        '<qn_method type="full Newton"/>',
        "</solver>",
        "</Control>",
        "<Globals><Constants><T>0</T><P>0</P><R>0</R><Fc>0</Fc></Constants></Globals>",
    ]


def _rubber(rubber: Law) -> Iterator[str]:
    law = deck_law(rubber)
    if isinstance(law, MooneyRivlin):
        name, values = "Mooney-Rivlin", {"c1": law.C10, "c2": law.C01}
    elif isinstance(law, Ogden):
        # Theirs is c / m^2.
        name, values = "Ogden", dict[str, float]()
        for number, (mu, alpha) in enumerate(zip(law.mu, law.alpha, strict=True), start=1):
            values |= {f"c{number}": mu * alpha, f"m{number}": alpha}
    else:
        # Theirs are the coefficients of dW/dI1.
        name, values = "Yeoh", {"c1": law.C10, "c2": 2.0 * law.C20, "c3": 3.0 * law.C30}
    yield f'<material id="1" name="RUBBER" type="{name}">'
    for key, value in {**values, "k": rubber.bulk_modulus}.items():
        yield f"<{key}>{value:.12g}</{key}>"
    yield f"<pressure_model>{_PRESSURE_MODEL}</pressure_model>"
    yield "</material>"


def _nodes(X: FloatArray) -> Iterator[str]:
    yield '<Nodes name="ALL">'
    for number, at in enumerate(X.tolist(), start=1):
        yield f'<node id="{number}">{row(*at, apart=",")}</node>'
    yield "</Nodes>"


def _solids(deck: Deck) -> Iterator[str]:
    number = 0
    for name, solids in (
        ("WALL", deck.wall),
        ("CAP_WEDGES", deck.wedges),
        ("CAP_BRICKS", deck.cap_bricks),
    ):
        yield from _elements(name, solids, number)
        number += len(solids)


def _elements(name: str, solids: IntArray, before: int) -> Iterator[str]:
    yield f'<Elements type="{_KINDS[solids.shape[1]]}" name="{name}">'
    for number, nodes in enumerate((solids + 1).tolist(), start=before + 1):
        yield f'<elem id="{number}">{row(*nodes, apart=",")}</elem>'
    yield "</Elements>"


def _sets(deck: Deck) -> Iterator[str]:
    yield from _set("NodeSet", "ROOT", deck.root)
    if deck.half:
        yield from _set("NodeSet", "SYMMETRY", deck.symmetry)
    yield from _set("NodeSet", "TIP", [deck.tip])
    yield '<Surface name="INNER">'
    number = 0
    for solids in (deck.wall[deck.inner_bricks], deck.wedges):
        kind, nodes = _FACES[solids.shape[1]]
        for face in (solids[:, nodes] + 1).tolist():
            number += 1
            yield f'<{kind} id="{number}">{row(*face, apart=",")}</{kind}>'
    yield "</Surface>"
    yield from _set("ElementSet", "CAP", range(len(deck.wall), deck.solids))


def _set(kind: str, name: str, members: Iterable[int]) -> Iterator[str]:
    yield f'<{kind} name="{name}">'
    yield ",\n".join(rows((int(n) + 1 for n in members), 16, apart=","))
    yield f"</{kind}>"


_Groups = Sequence[tuple[str, float, IntArray]]


def _discrete_sets(groups: _Groups) -> Iterator[str]:
    for name, _, pairs in groups:
        yield f'<DiscreteSet name="{name}">'
        yield from (f"<delem>{i},{k}</delem>" for i, k in (pairs + 1).tolist())
        yield "</DiscreteSet>"


def _springs(groups: _Groups) -> Iterator[str]:
    yield "<Discrete>"
    for number, (name, k, _) in enumerate(groups, start=1):
        kind = "tension-only linear spring"
        yield f'<discrete_material id="{number}" name="{name}" type="{kind}">'
        yield f"<E>{k:.12g}</E>"
        yield "</discrete_material>"
    for number, (name, *_) in enumerate(groups, start=1):
        yield f'<discrete dmat="{number}" discrete_set="{name}"/>'
    yield "</Discrete>"


def _held(deck: Deck) -> Iterator[str]:
    yield "<Boundary>"
    yield '<bc name="root" node_set="ROOT" type="zero displacement">'
    yield "<x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof>"
    yield "</bc>"
    if deck.half:
        yield '<bc name="symmetry" node_set="SYMMETRY" type="zero displacement">'
        yield "<x_dof>1</x_dof><y_dof>0</y_dof><z_dof>0</z_dof>"
        yield "</bc>"
    yield "</Boundary>"
    if deck.half:
        yield "<Rigid>"
        yield '<rigid_bc name="cap" type="rigid_fixed">'
        yield "<rb>CAP</rb><Rx_dof>1</Rx_dof><Rv_dof>1</Rv_dof><Rw_dof>1</Rw_dof>"
        yield "</rigid_bc>"
        yield "</Rigid>"


def _curves(series: Sequence[Sequence[float]]) -> Iterator[str]:
    """Load curves, a value a second from 0 on, and the times that must be reached."""
    count = len(series[0])
    yield "<LoadData>"
    for number, values in enumerate(series, start=1):
        yield from _curve(number, "LINEAR", [0.0, *values])
    yield from _curve(len(series) + 1, "STEP", [1.0 / _PARTS] * (count + 1))
    yield "</LoadData>"


def _curve(number: int, between: str, values: Sequence[float]) -> Iterator[str]:
    yield f'<load_controller id="{number}" type="loadcurve">'
    yield f"<interpolate>{between}</interpolate>"
    yield "<points>"
    yield from (f"<pt>{time},{value:.12g}</pt>" for time, value in enumerate(values))
    yield "</points>"
    yield "</load_controller>"


def _output(printed: str) -> list[str]:
    return [
        "<Output>",
        '<plotfile type="febio">',
        '<var type="displacement"/>',
        '<var type="stress"/>',
        "</plotfile>",
        f"<logfile>{printed}</logfile>",
        "</Output>",
        "</febio_spec>",
    ]
