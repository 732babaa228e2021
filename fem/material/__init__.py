"""Rubber: energy, stress and tangent of compressible hyperelastic laws as pure functions of F.

A law is any record that follows the protocol `Law`. Those that come along are `MooneyRivlin`,
`NeoHooke`, `Yeoh` and `Ogden`; `law` finds them by name. Stresses in MPa.
"""

from fem.material.invariant import Curvatures, InvariantLaw
from fem.material.kinematics import (
    PAIRS,
    Kinematics,
    cofactor,
    determinant,
    full_tangent,
    kinematics,
)
from fem.material.ogden import Ogden
from fem.material.protocol import Constant, Law, bulk_modulus, energy
from fem.material.registry import LAWS, law
from fem.material.rubbers import PAPER_RUBBER, MooneyRivlin, NeoHooke, Yeoh

__all__ = [
    "LAWS",
    "PAIRS",
    "PAPER_RUBBER",
    "Constant",
    "Curvatures",
    "InvariantLaw",
    "Kinematics",
    "Law",
    "MooneyRivlin",
    "NeoHooke",
    "Ogden",
    "Yeoh",
    "bulk_modulus",
    "cofactor",
    "determinant",
    "energy",
    "full_tangent",
    "kinematics",
    "law",
]
