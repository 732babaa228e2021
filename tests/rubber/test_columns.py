"""Test data of rubbers in the units and layouts that machines write."""

from __future__ import annotations

import numpy as np
import pytest

from profiletool.rubber.columns import first_loading
from profiletool.rubber.uniaxial import read_uniaxial

STRAIN = np.linspace(0.0, 1.0, 11)
MPA = 0.1 * STRAIN


@pytest.mark.parametrize(
    ("header", "strain", "stress"),
    [
        ("strain,stress (kgf/cm2)", 1.0, 1 / 0.0980665),
        ("strain,stress_psi", 1.0, 1 / 6.894757e-3),
        ("strain,Stress [Pa]", 1.0, 1e6),
        ("strain,stress/kPa", 1.0, 1e3),
        ("strain,stress N/mm²", 1.0, 1.0),
        ("strain,nominal stress (bar)", 1.0, 10.0),
        ("strain (%),stress", 100.0, 1.0),
        ("strain_percent,stress_MPa", 100.0, 1.0),
        ("Tensile strain,Tensile stress\n(mm/mm),(kPa)", 1.0, 1e3),
        ("Specimen A\nstrain,stress\n%,MPa", 100.0, 1.0),
    ],
)
def test_units(header: str, strain: float, stress: float) -> None:
    rows = "\n".join(f"{a * strain:.9g},{b * stress:.9g}" for a, b in zip(STRAIN, MPA, strict=True))
    found = read_uniaxial(f"{header}\n{rows}\n".encode())
    np.testing.assert_allclose(found[0], 1.0 + STRAIN, atol=1e-7)
    np.testing.assert_allclose(found[1], MPA, atol=1e-7)


@pytest.mark.parametrize("name", ["log strain", "true strain", "Hencky strain", "ln_strain"])
def test_logarithmic_strain(name: str) -> None:
    rows = "\n".join(f"{np.log1p(a):.9g},{b:.9g}" for a, b in zip(STRAIN, MPA, strict=True))
    found = read_uniaxial(f"{name},stress\n{rows}\n".encode())
    np.testing.assert_allclose(found[0], 1.0 + STRAIN, atol=1e-7)


def test_the_first_loading_alone() -> None:
    up = np.linspace(1.0, 2.0, 21)
    loops = np.concatenate([up, up[::-1], up, up[::-1]])
    assert first_loading(loops) == list(range(21))
    assert first_loading(up) == first_loading(up[::-1]) == list(range(21))
    shuffled = np.random.default_rng(1).permutation(up)
    assert first_loading(shuffled) == list(range(21))
    squeezed = np.concatenate([1.0 - 0.3 * (up - 1.0), 1.0 - 0.3 * (up[::-1] - 1.0), up, up[::-1]])
    assert first_loading(squeezed) == [*range(21), *range(41, 63)]
