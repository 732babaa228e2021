"""Files of a deck: the model for another code, a check cube, the angles to expect."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.export.deck import Cube, Deck, make_deck
from fem.export.expected import Expected, expect
from fem.export.formats import FORMATS, MESHES, Code, Format, MeshName
from profiletool.records.design import Design
from profiletool.records.fe import Verification
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.report.registry import Writers
from profiletool.verify.run import pressures_to, run_design
from profiletool.verify.tube import actuator_of

_ML_PER_MM3 = 1e-3
# By code: how to run it, where its results are, and whether that was tried.
_HOW: dict[Code, tuple[str, str, str]] = {
    "calculix": (
        "    ccx -i cube\n    ccx -i actuator",
        "cube.dat has the stresses, actuator.dat the displacements of TIP at the end\n"
        "of every step, actuator.frd the whole shape, for cgx or ParaView.",
        "CalculiX 2.20 was run on decks like this one: its angles and its TIP were within\n"
        "0.1 % of expected.csv up to 1.0 bar.",
    ),
    "abaqus": (
        "    abaqus job=cube interactive\n    abaqus job=actuator interactive",
        "cube.dat has the stresses, actuator.dat the displacements of TIP at the end\n"
        "of every step, actuator.odb the whole shape.",
        "Abaqus was NOT run on it. CalculiX was run on decks like this one: it knows their\n"
        "words, but for the rotation of a cap on the plane of symmetry.",
    ),
    "ansys": (
        "    ansys -b -i cube.dat -o cube.out\n    ansys -b -i actuator.dat -o actuator.out",
        "cube.out has the stresses, actuator.out the displacements of TIP by step.",
        "Ansys was NOT run on it. The deck was read back by another program, and its\n"
        "nodes, elements and components compared with those of the other decks.",
    ),
    "febio": (
        "    febio4 -i cube.feb\n    febio4 -i actuator.feb",
        "stress.txt has the stresses, tip.txt the displacements of TIP at every whole\n"
        "second, which is a step; actuator.xplt the whole shape.",
        "FEBio was NOT run on it. The deck was read back, its nodes, elements and sets\n"
        "compared with those of the other decks, its words with the source of FEBio 4.",
    ),
}


@dataclass(frozen=True)
class DeckOutput:
    """All that the files of a deck are written from.

    Attributes
    ----------
    design : Design
    code : str
        As `fem.export.formats.FORMATS` names it.
    deck : Deck
    expected : Expected or None
        By this engine for the same bricks and springs; None where it was not run.
    verified : Verification or None
        By this engine as it verifies designs.
    """

    design: Design
    code: Code
    deck: Deck
    expected: Expected | None = None
    verified: Verification | None = None

    @property
    def reached_bar(self) -> float:
        """How far this engine came; the last pressure where it was not run."""
        pressures = self.deck.pressures if self.expected is None else self.expected.pressure
        return BAR_PER_MPA * float(max((0.0, *pressures)))

    @property
    def format(self) -> Format:
        """The code, and how decks for it are written."""
        return FORMATS[self.code]


def make_deck_output(
    design: Design,
    code: Code,
    mesh: MeshName,
    pressure_bar: float,
    *,
    solve: bool = True,
    progress: Callable[[float], None] | None = None,
) -> DeckOutput:
    """Lay a design out for another code.

    Parameters
    ----------
    design : Design
    code : {"calculix", "abaqus", "ansys", "febio"}
    mesh : {"default", "paper"}
    pressure_bar : float
        The highest; ten equal steps lead there.
    solve : bool
        Run this engine too, for the angles to expect.
    progress : callable, optional
        Takes the pressure reached so far, bar.

    Raises
    ------
    fem.errors.BadGeometry, fem.errors.NotConverged
    """
    pressures = tuple(bar / BAR_PER_MPA for bar in pressures_to(pressure_bar))
    title = f"{design.source.file}, {pressure_bar:g} bar, by profiletool"
    deck, grid = make_deck(actuator_of(design), pressures, MESHES[mesh], title)
    if not solve:
        return DeckOutput(design, code, deck)

    def told(pressure: float) -> None:
        if progress is not None:
            progress(BAR_PER_MPA * pressure)

    expected = expect(deck, grid, told)
    return DeckOutput(
        design, code, deck, expected, run_design(design, pressure_bar, progress).verification
    )


def _actuator(output: DeckOutput) -> bytes:
    return output.format.write(output.deck).encode()


def _cube(output: DeckOutput) -> bytes:
    return output.format.write_cube(Cube(output.deck.rubber)).encode()


def _expected_csv(output: DeckOutput) -> bytes | None:
    found = output.expected
    if found is None:
        return None
    joints = [str(joint.number) for joint in output.design.joints]
    names = [f"theta{j}_deg" for j in joints] + [f"design_theta{j}_deg" for j in joints]
    lines = [",".join(["pressure_bar", *names, "tip_ux_mm", "tip_uy_mm", "tip_uz_mm", "air_ml"])]
    for step, theta in enumerate(_degrees(found)):
        cells = [f"{BAR_PER_MPA * found.pressure[step]:.4f}", *(f"{t:.3f}" for t in theta)]
        cells += _design_angles(output, step)
        cells += [f"{u:.4f}" for u in found.tip[step]]
        lines.append(",".join([*cells, f"{_ML_PER_MM3 * found.air[step]:.3f}"]))
    return ("\n".join(lines) + "\n").encode()


def _degrees(found: Expected) -> FloatArray:
    """Angles, deg; beyond half a turn they go on."""
    return np.unwrap(np.degrees(found.theta), period=360.0, axis=0)


def _design_angles(output: DeckOutput, step: int) -> list[str]:
    """Angles of the design's own verification at a step; empty where it did not get there."""
    states = () if output.verified is None else output.verified.states
    if step >= len(states):
        return [""] * len(output.design.joints)
    return [f"{theta:.3f}" for theta in states[step].theta_deg]


def _readme(output: DeckOutput) -> bytes:
    deck, (run, results, ran) = output.deck, _HOW[output.code]
    name = output.format.code
    cube = "\n".join(
        f"  {step}. stretched {lam[0]:g}, {lam[1]:g}, {lam[2]:g} along x, y, z: normal stresses "
        f"{s[0]:.4f}, {s[1]:.4f}, {s[2]:.4f} MPa, mean {s.mean():.4f}"
        for step, (lam, s) in enumerate(
            zip(Cube(deck.rubber).stretches, Cube(deck.rubber).stresses, strict=True), start=1
        )
    )
    return _README.format(
        title=deck.title, name=name, ending=output.format.ending, run=run,
        results=results, ran=ran, cube=cube, expected=_what_to_expect(output),
        half="half of the tube, x >= 0" if deck.half else "the whole tube",
        nodes=len(deck.X), wall=len(deck.wall), cap=deck.solids - len(deck.wall),
        axial=len(deck.axial.nodes), axial_k=deck.axial.stiffness.sum(),
        hoop=len(deck.hoop.nodes), hoop_k=deck.hoop.stiffness.sum(),
        steps=len(deck.pressures), most=BAR_PER_MPA * max(deck.pressures),
        links="a LINK180 (E = 2000 MPa)" if output.code == "ansys" else "a spring",
    ).encode()  # fmt: skip


def _what_to_expect(output: DeckOutput) -> str:
    if output.expected is None:
        return "This engine was not run (--no-verify), so there is no expected.csv."
    text = (
        "expected.csv has what profiletool's own engine finds, by pressure: angles of the\n"
        "joints for the same bricks and springs (theta), and as it verifies designs, with\n"
        "a smeared gauze on a mesh of its own (design_theta); the displacement of TIP and\n"
        "the volume of the air for the same bricks and springs. Expect theta and TIP\n"
        "within 1 %, on the paper's mesh within 2 %."
    )
    if len(output.expected.pressure) < len(output.deck.pressures):
        text += f"\nThis engine came to {output.reached_bar:.2f} bar."
    return text


_README = """{title}
A deck for {name}: the finite-element model of this actuator.

Run
{run}
{results}
{ran}
Begin with the cube.

cube{ending}: one brick of the rubber
{cube}

actuator{ending}: {half}; mm, N, MPa
  z along the tube from the clamped end, the object at -y; {nodes} nodes of bricks and wedges
  ROOT           nodes of the clamped end
  SYMMETRY       nodes on the plane x = 0, where half of the tube is modelled
  WALL           {wall} bricks of rubber
  CAP            {cap} bricks and wedges of the closed end, rigid
  INNER          faces that the air pushes on; the pressure follows them
  THREAD_AXIAL   {axial} axial threads, {axial_k:.6g} N/mm together
  THREAD_HOOP    {hoop} hoop threads, {hoop_k:.6g} N/mm together
  TIP            the end of the line that faces the object, on the cap's inner side
  {steps} steps to {most:g} bar
Threads are straight between two nodes and pull only. Each is {links}
as stiff as the strip of gauze nearest to it, as far as that is not cut.

{expected}
"""

# With the ending of the code's own files.
DECK_FILES: Writers[DeckOutput] = {
    "actuator{ending}": _actuator,
    "cube{ending}": _cube,
    "expected.csv": _expected_csv,
    "README.txt": _readme,
}
