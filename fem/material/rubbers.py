"""Mooney-Rivlin, neo-Hooke and Yeoh: the laws of the invariants that rubber data are given in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from fem.arrays import FloatArray
from fem.material.invariant import Curvatures, InvariantLaw, Value
from fem.material.protocol import Constant, bulk_modulus


@dataclass(frozen=True)
class MooneyRivlin(InvariantLaw):
    """W_iso = C10 (I1bar - 3) + C01 (I2bar - 3): C10, C01 and the bulk modulus K, MPa.

    Attributes
    ----------
    C10, C01 : float, MPa
    K : float, MPa
        Bulk modulus.

    Raises
    ------
    ValueError
        When a constant is negative, or the rubber has no stiffness.
    """

    name: ClassVar[str] = "mooney-rivlin"
    C10: float
    C01: float
    K: float

    def __post_init__(self) -> None:
        if not (self.C10 + self.C01 > 0.0 and self.C01 >= 0.0 and self.C10 >= 0.0 and self.K > 0.0):
            raise ValueError("a rubber needs C10, C01 >= 0, C10 + C01 > 0 and K > 0")

    @classmethod
    def from_poisson(cls, C10: float, C01: float, nu: float) -> MooneyRivlin:
        """Take the bulk modulus from Poisson's ratio at small strain.

        Raises
        ------
        ValueError
            When nu is not between 0 and 0.5.
        """
        return cls(C10, C01, bulk_modulus(2.0 * (C10 + C01), nu))

    @property
    def constants(self) -> dict[str, Constant]:
        """C10, C01 and K, MPa."""
        return {"C10": self.C10, "C01": self.C01, "K": self.K}

    @property
    def shear_modulus(self) -> float:
        """Shear modulus at small strain, MPa."""
        return 2.0 * (self.C10 + self.C01)

    def density(self, I1: FloatArray, I2: FloatArray) -> FloatArray:
        """W at I1bar, I2bar (...): MPa."""
        return self.C10 * (I1 - 3.0) + self.C01 * (I2 - 3.0)

    def slopes(self, I1: FloatArray, I2: FloatArray) -> tuple[Value, Value]:
        """C10 and C01, MPa."""
        return self.C10, self.C01


@dataclass(frozen=True)
class NeoHooke(InvariantLaw):
    """W_iso = C10 (I1bar - 3): C10 and the bulk modulus K, MPa.

    Attributes
    ----------
    C10 : float, MPa
    K : float, MPa
        Bulk modulus.

    Raises
    ------
    ValueError
        When a constant is not positive.
    """

    name: ClassVar[str] = "neo-hooke"
    C10: float
    K: float

    def __post_init__(self) -> None:
        if not (self.C10 > 0.0 and self.K > 0.0):
            raise ValueError("a neo-Hookean rubber needs C10 > 0 and K > 0")

    @classmethod
    def from_poisson(cls, C10: float, nu: float) -> NeoHooke:
        """Take the bulk modulus from Poisson's ratio at small strain.

        Raises
        ------
        ValueError
            When nu is not between 0 and 0.5.
        """
        return cls(C10, bulk_modulus(2.0 * C10, nu))

    @property
    def constants(self) -> dict[str, Constant]:
        """C10 and K, MPa."""
        return {"C10": self.C10, "K": self.K}

    @property
    def shear_modulus(self) -> float:
        """Shear modulus at small strain, MPa."""
        return 2.0 * self.C10

    def density(self, I1: FloatArray, I2: FloatArray) -> FloatArray:
        """W at I1bar, I2bar (...): MPa."""
        return self.C10 * (I1 - 3.0)

    def slopes(self, I1: FloatArray, I2: FloatArray) -> tuple[Value, Value]:
        """C10 and 0, MPa."""
        return self.C10, 0.0


@dataclass(frozen=True)
class Yeoh(InvariantLaw):
    """W_iso = C10 x + C20 x^2 + C30 x^3, x = I1bar - 3: these and the bulk modulus K, MPa.

    Yeoh, Rubber Chem. Technol. 66 (1993) 754. C20 is often negative (the rubber turns softer
    first) and C30 positive (it stiffens at large stretches). Where dW/dx falls below 0 the rubber
    is not stable; the path then ends there.

    Attributes
    ----------
    C10, C20, C30 : float, MPa
    K : float, MPa
        Bulk modulus.

    Raises
    ------
    ValueError
        When the rubber has no stiffness at rest.
    """

    name: ClassVar[str] = "yeoh"
    C10: float
    C20: float
    C30: float
    K: float

    def __post_init__(self) -> None:
        if not (self.C10 > 0.0 and self.K > 0.0):
            raise ValueError("a Yeoh rubber needs C10 > 0 and K > 0")

    @classmethod
    def from_poisson(cls, C10: float, C20: float, C30: float, nu: float) -> Yeoh:
        """Take the bulk modulus from Poisson's ratio at small strain.

        Raises
        ------
        ValueError
            When nu is not between 0 and 0.5.
        """
        return cls(C10, C20, C30, bulk_modulus(2.0 * C10, nu))

    @property
    def constants(self) -> dict[str, Constant]:
        """C10, C20, C30 and K, MPa."""
        return {"C10": self.C10, "C20": self.C20, "C30": self.C30, "K": self.K}

    @property
    def shear_modulus(self) -> float:
        """Shear modulus at small strain, MPa."""
        return 2.0 * self.C10

    def density(self, I1: FloatArray, I2: FloatArray) -> FloatArray:
        """W at I1bar, I2bar (...): MPa."""
        x = I1 - 3.0
        return x * (self.C10 + x * (self.C20 + x * self.C30))

    def slopes(self, I1: FloatArray, I2: FloatArray) -> tuple[Value, Value]:
        """dW/dI1bar (...) and 0, MPa."""
        x = I1 - 3.0
        return self.C10 + x * (2.0 * self.C20 + x * (3.0 * self.C30)), 0.0

    def curvatures(self, I1: FloatArray, I2: FloatArray) -> Curvatures:
        """d2W/dI1bar2 (...), MPa."""
        return Curvatures(2.0 * self.C20 + 6.0 * self.C30 * (I1 - 3.0))


# The paper's silicone, XIAMETER RTV-4250-S (section 2.2).
PAPER_RUBBER = MooneyRivlin.from_poisson(0.0694, 0.0628, 0.46)
