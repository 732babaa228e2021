"""Decks for other codes: the same model in four languages, and the gauze as springs."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from fem import (
    PAPER_RUBBER,
    Actuator,
    AxialLines,
    BadGeometry,
    Law,
    NeoHooke,
    Ogden,
    Weight,
    Window,
    Yeoh,
    chain,
)
from fem.export.deck import PAPER_DECK_MESH, Cube, Deck, make_deck
from fem.export.expected import expect
from fem.export.formats import FORMATS
from fem.export.springs import with_springs
from fem.mesh import Mesh
from fem.meshsize import MeshSize
from tests.fem.decks import Read, read_ansys, read_febio, read_inp
from tests.programs import run

SIZE = MeshSize(around=4, edge=2.0, growth=2.0, orders=(2, 2, 2))
PAPER_BY_TWO = replace(PAPER_DECK_MESH, around=15, edge=4.0, window=4.0, wrapped=4.0)
OUT_OF_PLANE = (Window(10.0, 5.0, 1.5, np.radians(210.0)),)
ACTUATORS = {
    "half": (Actuator(22.0, (Window(10.0, 5.0, 1.5),)), SIZE),
    "whole": (Actuator(22.0, OUT_OF_PLANE, diameter=12.0, wall=1.5), SIZE),
    "as the paper": (Actuator(22.0, (Window(10.0, 5.0, 1.5),)), PAPER_BY_TWO),
}
RUBBERS: list[Law] = [
    PAPER_RUBBER,
    NeoHooke.from_poisson(0.1, 0.46),
    Yeoh.from_poisson(0.1, -0.01, 0.002, 0.46),
    Ogden.from_poisson((0.32, 0.0024, -0.02), (1.3, 5.0, -2.0), 0.46),
]


@pytest.fixture(scope="module", params=ACTUATORS)
def made(request: pytest.FixtureRequest) -> tuple[Deck, Mesh]:
    actuator, size = ACTUATORS[request.param]
    return make_deck(actuator, (0.05, 0.1), size, "a--b$\n*STEP")


@pytest.fixture(scope="module")
def read(made: tuple[Deck, Mesh], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Read]:
    text = {code: form.write(made[0]) for code, form in FORMATS.items()}
    return {
        "calculix": read_inp(text["calculix"]),
        "abaqus": read_inp(text["abaqus"]),
        "ansys": read_ansys(text["ansys"], tmp_path_factory.mktemp("ansys")),
        "febio": read_febio(text["febio"]),
    }


def test_all_decks_hold_the_same_nodes_bricks_and_sets(
    made: tuple[Deck, Mesh], read: dict[str, Read]
) -> None:
    deck, _ = made
    sets = {
        "ROOT": len(deck.root), "SYMMETRY": len(deck.symmetry), "TIP": 1, "WALL": len(deck.wall),
        "CAP": len(deck.wedges) + len(deck.cap_bricks), "INNER": len(deck.inner),
        "THREAD_AXIAL": len(deck.axial.nodes), "THREAD_HOOP": len(deck.hoop.nodes),
    }  # fmt: skip
    for code, found in read.items():
        np.testing.assert_allclose(found.X, deck.X, atol=1e-9, err_msg=code)
        for ours, theirs in zip((deck.wall, deck.cap_bricks), found.bricks, strict=True):
            assert (ours == theirs).all(), code
        # Ansys' cap is elastic, and held on the plane of symmetry too.
        more = int((np.abs(found.X[deck.cap, 0]) < 1e-9).sum()) if code == "ansys" else 0
        plane = {"SYMMETRY": sets["SYMMETRY"] + more * deck.half}
        assert {name: found.sets[name] for name in sets} == {**sets, **plane}, code


def test_all_decks_are_as_stiff_and_hold_as_much_air(
    made: tuple[Deck, Mesh], read: dict[str, Read]
) -> None:
    deck, mesh = made
    for code, found in read.items():
        for name, springs in (("THREAD_AXIAL", deck.axial), ("THREAD_HOOP", deck.hoop)):
            assert found.stiffness[name] == pytest.approx(springs.stiffness.sum(), rel=1e-8), code
            assert found.longest[name] == pytest.approx(springs.length.max(), rel=1e-8), code
        assert found.volume == pytest.approx(bore(mesh), rel=1e-9), code


def bore(mesh: Mesh) -> float:
    """Volume of the prism that the nodes inside are corners of, mm^3."""
    columns = mesh.columns
    if mesh.size.kind == "hex20":
        columns = np.interp(np.arange(0.0, len(columns) - 0.75, 0.5), range(len(columns)), columns)
    radius = mesh.actuator.radius - mesh.actuator.wall
    return float(0.5 * radius**2 * np.sin(np.diff(columns)).sum() * mesh.z[-1])


def test_springs_are_as_stiff_as_the_gauze(made: tuple[Deck, Mesh]) -> None:
    deck, mesh = made
    for springs, smeared, width in ((deck.axial, mesh.axial, 1e-12), (deck.hoop, mesh.hoop, 0.02)):
        whole = (springs.stiffness * springs.length**2).sum()  # EA over all lengths
        # Hoops are chords, on the arcs of the gauze.
        assert whole == pytest.approx(smeared.weight.sum(), rel=width)
    for name in ("axial", "hoop"):
        springs = getattr(deck, name)
        own = getattr(with_springs(mesh), name).weight.sum()
        assert own == pytest.approx((springs.stiffness * springs.length**2).sum(), rel=1e-12)


def test_a_sector_may_end_between_mesh_lines() -> None:
    sums = []
    for alpha in (1.45, 1.5, 1.55):
        window = Window(10.0, 5.0, alpha)
        even = replace(SIZE, beside=0.0)
        deck, mesh = make_deck(Actuator(22.0, (window,)), (0.1,), even)
        assert len(mesh.columns) == 5
        sums.append(float((deck.axial.stiffness * deck.axial.length**2).sum()))
    gauze = Actuator(22.0, ()).gauze
    for low, high in pairwise(sums):
        assert high - low == pytest.approx(gauze.stiffness * 5.0 * 10.0 * 0.5 * 0.05, rel=1e-9)


def test_a_title_is_no_command(made: tuple[Deck, Mesh]) -> None:
    deck, _ = made
    assert deck.title == "a_b_STEP"
    for form in FORMATS.values():
        assert any("a_b_STEP" in line for line in form.write(deck).splitlines()[:3])


def test_every_pressure_is_a_step(made: tuple[Deck, Mesh]) -> None:
    deck, _ = made
    for code in ("calculix", "abaqus"):
        assert re.findall(r"INNER, P1, (\S+)", FORMATS[code].write(deck)) == ["0.05", "0.1"]
    loads = re.findall(r"^SFE,ALL,1,PRES,0,(\S+)", FORMATS["ansys"].write(deck), re.M)
    assert loads == ["0.05", "0.1"]
    root = ElementTree.fromstring(FORMATS["febio"].write(deck))
    # FEBio takes load curves by their order; the one of dtmax holds times and longest steps.
    curves = root.findall("LoadData/load_controller")
    assert [curve.attrib["id"] for curve in curves] == ["1", "2"]
    points = [[point.text for point in curve.iter("pt")] for curve in curves]
    assert points == [["0,0", "1,0.05", "2,0.1"], ["0,0.1", "1,0.1", "2,0.1"]]
    assert root.find("Loads/surface_load/pressure").attrib == {"lc": "1"}
    assert root.find("Control/time_stepper/dtmax").attrib == {"lc": "2"}


def test_elements_are_no_mirror_images(made: tuple[Deck, Mesh]) -> None:
    deck, _ = made
    for solids, corners in ((deck.wall, 4), (deck.cap_bricks, 4), (deck.wedges, 3)):
        a, b, c, up = (deck.X[solids[:, n]] for n in (0, 1, corners - 1, corners))
        assert np.linalg.det(np.stack([b - a, c - a, up - a], axis=1)).min() > 0.0


def test_sets_lie_where_they_should(made: tuple[Deck, Mesh]) -> None:
    deck, mesh = made
    radius = mesh.actuator.radius
    assert (deck.X[deck.root, 2] == 0.0).all()
    assert deck.X[deck.cap, 2].min() == pytest.approx(mesh.z[-1])
    assert deck.X[deck.tip] == pytest.approx([0.0, -radius, mesh.z[-1]], abs=1e-9)
    assert deck.X[deck.symmetry, 0] == pytest.approx(0.0, abs=1e-9)
    for springs in (deck.axial, deck.hoop):
        ends = deck.X[springs.nodes]
        assert np.hypot(ends[..., 0], ends[..., 1]) == pytest.approx(radius)
    volume = 0.0
    for n in deck.wedges:  # the disc of the cap is whole
        a, b, c = deck.X[n[:3], :2]
        volume += 0.5 * float(np.linalg.det(np.stack([b - a, c - a])))
    assert volume == pytest.approx(
        0.5 * (radius - mesh.actuator.wall) ** 2 * np.sin(np.diff(mesh.columns)).sum()
    )


def test_the_paper_mesh_is_that_of_its_finger() -> None:
    finger = chain(10.0, [40.0, 22.0, 20.0], [14.0, 16.0, 12.0], [np.radians(90.0)] * 3)
    deck, mesh = make_deck(finger, (0.1,), PAPER_DECK_MESH)
    # The paper's: 4286 nodes and 5110 elements, its plug of unknown make among them.
    assert mesh.nodes == 4278
    assert deck.elements == pytest.approx(5110, rel=0.005)


@pytest.mark.parametrize("rubber", RUBBERS, ids=lambda rubber: rubber.name)
def test_calculix_finds_our_stresses_in_the_cube(rubber: Law, tmp_path: Path) -> None:
    cube = Cube(rubber)
    (tmp_path / "cube.inp").write_text(FORMATS["calculix"].write_cube(cube))
    run("ccx", "-i", "cube", cwd=tmp_path)
    blocks = (tmp_path / "cube.dat").read_text().split("stresses")[1:]
    found = [
        np.array([line.split()[2:5] for line in block.splitlines()[1:] if line.strip()], float)
        for block in blocks
    ]
    assert len(found) == len(cube.stretches)
    for theirs, ours in zip(found, cube.stresses, strict=True):
        assert theirs == pytest.approx(np.tile(ours, (len(theirs), 1)), rel=1e-5)


def test_the_cube_of_the_paper_s_rubber() -> None:
    swollen, _ = Cube(PAPER_RUBBER).stresses
    assert swollen == pytest.approx([1.0648] * 3, abs=5e-5)
    for form in FORMATS.values():
        text = form.write_cube(Cube(PAPER_RUBBER))
        assert "0.0694" in text
        assert "0.0628" in text


def test_words_of_the_rubber() -> None:
    ogden = RUBBERS[-1]
    assert isinstance(ogden, Ogden)
    k = ogden.bulk_modulus
    ansys, febio = (FORMATS[code].write_cube(Cube(ogden)) for code in ("ansys", "febio"))
    # Ansys' mu is ours, FEBio's c is mu alpha.
    assert f"TBDATA,1,0.32,1.3,0.0024,5,-0.02,-2\nTBDATA,7,{2.0 / k:.12g},1e+20,1e+20" in ansys
    for words in ("<c1>0.416</c1>", "<m3>-2</m3>", "<pressure_model>2</pressure_model>"):
        assert words in febio
    yeoh = FORMATS["febio"].write_cube(Cube(RUBBERS[2]))
    assert "<c1>0.1</c1>\n<c2>-0.02</c2>\n<c3>0.006</c3>" in yeoh


def test_what_no_deck_holds_is_refused() -> None:
    a = ACTUATORS["half"][0]
    for wrong, why in (
        (replace(a, weight=Weight((0.0, 0.0, 1.0), 1e-5, 1e-6)), "no weight"),
        (replace(a, lines=AxialLines(((0.0,),), 98.0)), "no single threads"),
    ):
        with pytest.raises(BadGeometry, match=why):
            make_deck(wrong, (0.1,))

    class OwnLaw(NeoHooke):
        name = "own"

    class Other:
        name = "other"
        bulk_modulus = 1.0

    with pytest.raises(ValueError, match="Ogden rubbers, not other"):
        FORMATS["febio"].write_cube(Cube(Other()))  # type: ignore[arg-type]
    assert "<c1>1</c1>" in FORMATS["febio"].write_cube(Cube(OwnLaw(1.0, 2.0)))


def test_states_to_expect() -> None:
    actuator, size = ACTUATORS["half"]
    deck, mesh = make_deck(actuator, (0.02, 0.04), size)
    found = expect(deck, mesh, threads=1)
    assert found.pressure.tolist() == [0.02, 0.04]
    assert found.theta.shape == (2, 1)
    assert (np.diff(found.theta[:, 0], prepend=0.0) > 0.0).all()
    assert found.tip[:, 0] == pytest.approx(0.0)
    assert (np.diff(found.tip[:, 1], prepend=0.0) < 0.0).all()  # toward the object
    assert found.air[0] > 2.0 * bore(mesh)
