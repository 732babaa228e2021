"""Decks by the code that they are for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from fem.export import apdl, febio, inp
from fem.export.deck import DECK_MESH, PAPER_DECK_MESH, Cube, Deck
from fem.meshsize import MeshSize

Code = Literal["calculix", "abaqus", "ansys", "febio"]
MeshName = Literal["default", "paper"]


@dataclass(frozen=True)
class Format:
    """A code, and how decks for it are written.

    Attributes
    ----------
    code : str
        Its name.
    ending : str
        Of its input files.
    write : callable
        The deck as text.
    write_cube : callable
        The check cube as text.
    """

    code: str
    ending: str
    write: Callable[[Deck], str]
    write_cube: Callable[[Cube], str]


FORMATS: Mapping[Code, Format] = {
    "calculix": Format("CalculiX", ".inp", inp.write_calculix, inp.write_cube),
    "abaqus": Format("Abaqus/Standard", ".inp", inp.write_abaqus, inp.write_cube),
    "ansys": Format("Ansys Mechanical APDL", ".dat", apdl.write_ansys, apdl.write_cube),
    "febio": Format("FEBio 4", ".feb", febio.write_febio, febio.write_cube),
}
MESHES: Mapping[MeshName, MeshSize] = {"default": DECK_MESH, "paper": PAPER_DECK_MESH}
