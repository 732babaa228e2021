"""One rubber of each law, and its closed forms apart from the code's tensors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq

from fem.material import Curvatures, InvariantLaw, Law, MooneyRivlin, NeoHooke, Ogden, Yeoh

FloatArray = NDArray[np.float64]
Stretches = tuple[float, float, float]


@dataclass(frozen=True)
class Polynomial(InvariantLaw):
    """A law that does not come along: all three second derivatives of W are there.

    W_iso = C10 x + C01 y + C11 x y + C02 y^2, x = I1bar - 3, y = I2bar - 3.
    """

    name: ClassVar[str] = "polynomial"
    C10: float
    C01: float
    C11: float
    C02: float
    K: float

    @property
    def constants(self) -> dict[str, float]:
        return {"C10": self.C10, "C01": self.C01, "C11": self.C11, "C02": self.C02, "K": self.K}

    @property
    def shear_modulus(self) -> float:
        return 2.0 * (self.C10 + self.C01)

    def density(self, I1: FloatArray, I2: FloatArray) -> FloatArray:
        x, y = I1 - 3.0, I2 - 3.0
        return self.C10 * x + self.C01 * y + self.C11 * x * y + self.C02 * y * y

    def slopes(self, I1: FloatArray, I2: FloatArray) -> tuple[FloatArray, FloatArray]:
        x, y = I1 - 3.0, I2 - 3.0
        return self.C10 + self.C11 * y, self.C01 + self.C11 * x + 2.0 * self.C02 * y

    def curvatures(self, I1: FloatArray, I2: FloatArray) -> Curvatures:
        return Curvatures(0.0, self.C11, 2.0 * self.C02)


RUBBERS: dict[str, Law] = {
    "mooney-rivlin": MooneyRivlin.from_poisson(0.0694, 0.0628, 0.46),
    "neo-hooke": NeoHooke.from_poisson(0.12, 0.46),
    "yeoh": Yeoh.from_poisson(0.11, -0.01, 0.002, 0.46),
    "ogden": Ogden.from_poisson((0.16, 0.0012, -0.01), (1.3, 5.0, -2.0), 0.46),
    "polynomial": Polynomial(0.08, 0.03, 0.001, 0.0005, 3.0),
}
EVERY_LAW = [pytest.param(rubber, id=name) for name, rubber in RUBBERS.items()]


def slope(rubber: Law, l1: float, l2: float, l3: float) -> float:
    """Nominal stress dW/dl1 of the law in principal stretches."""
    J = l1 * l2 * l3
    c, volumetric = rubber.constants, rubber.bulk_modulus * (J - 1) * l2 * l3
    if rubber.name == "ogden":
        powers = [[(a / J ** (1 / 3)) ** e for a in (l1, l2, l3)] for e in c["alpha"]]
        terms = zip(c["mu"], powers, strict=True)
        return sum(m * (p[0] - sum(p) / 3) for m, p in terms) / l1 + volumetric
    I1 = l1**2 + l2**2 + l3**2
    I2 = (l1 * l2) ** 2 + (l2 * l3) ** 2 + (l3 * l1) ** 2
    x, y = J ** (-2 / 3) * I1 - 3, J ** (-4 / 3) * I2 - 3
    by_x, by_y = {
        "mooney-rivlin": lambda: (c["C10"], c["C01"]),
        "neo-hooke": lambda: (c["C10"], 0.0),
        "yeoh": lambda: (c["C10"] + 2 * c["C20"] * x + 3 * c["C30"] * x**2, 0.0),
        "polynomial": lambda: (
            c["C10"] + c["C11"] * y,
            c["C01"] + c["C11"] * x + 2 * c["C02"] * y,
        ),
    }[rubber.name]()
    first = by_x * J ** (-2 / 3) * (2 * l1 - 2 * I1 / (3 * l1))
    second = by_y * J ** (-4 / 3) * (2 * l1 * (l2**2 + l3**2) - 4 * I2 / (3 * l1))
    return float(first + second + volumetric)


def homogeneous(rubber: Law, load: str, L: float) -> tuple[Stretches, float]:
    """Stretches and nominal stress along x of the law itself: the root of the free stress."""

    def root(free: Callable[[float], float]) -> float:
        return float(brentq(free, 0.1, 2.0, xtol=1e-15, rtol=1e-14))

    if load == "uniaxial":
        t = root(lambda t: slope(rubber, t, t, L))
        stretches = (L, t, t)
    elif load == "equibiaxial":
        t = root(lambda t: slope(rubber, t, L, L))
        stretches = (L, L, t)
    else:
        t = root(lambda t: slope(rubber, t, L, 1.0))
        stretches = (L, 1.0, t)
    return stretches, slope(rubber, *stretches)


def incompressible(rubber: Law, load: str, L: float) -> float:
    """Nominal stress along x at constant volume, where the pressure takes what is free."""
    l2, l3 = {
        "uniaxial": (L**-0.5, L**-0.5),
        "equibiaxial": (L, L**-2),
        "planar": (1.0, 1.0 / L),
    }[load]
    # P1 l1 - P3 l3 of W_iso: side 3 is free, and the volumetric part is the same in both.
    along, free = slope(rubber, L, l2, l3) * L, slope(rubber, l3, L, l2) * l3
    return (along - free) / L
