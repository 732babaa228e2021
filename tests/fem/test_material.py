"""The law: derivatives of the energy, known values, and row 2 for the material."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fem.material import (
    PAPER_RUBBER,
    MooneyRivlin,
    cofactor,
    determinant,
    energy,
    full_tangent,
    kinematics,
    stress,
    tangent,
    volumetric,
)
from fem.sections import rotation_matrix

FloatArray = NDArray[np.float64]

RUBBER = MooneyRivlin(0.07, 0.06, 3.2)
NEO_HOOKE = MooneyRivlin(0.5, 0.0, 10.0)
TURN = rotation_matrix(np.array([0.7, -1.1, 0.4]))


def gradients(seed: int = 0, batch: int = 4) -> FloatArray:
    F = np.random.default_rng(seed).uniform(-0.3, 0.3, (3, 3, batch))
    F += np.diag([1.4, 0.9, 1.1])[..., None]
    return F


def first_piola(rubber: MooneyRivlin, F: FloatArray) -> FloatArray:
    k = kinematics(F)
    return stress(rubber, k, volumetric(rubber, k.J)[1])


def moduli(rubber: MooneyRivlin, F: FloatArray) -> FloatArray:
    k = kinematics(F)
    _, p, bulk = volumetric(rubber, k.J)
    return full_tangent(tangent(rubber, k, p, bulk))


def test_energy_of_a_stretch_by_hand() -> None:
    # diag(2, 1, 1): J = 2, I1 = 6, I2 = 4 + 4 + 1 = 9.
    F = np.diag([2.0, 1.0, 1.0])[..., None]
    expected = 0.07 * (2 ** (-2 / 3) * 6 - 3) + 0.06 * (2 ** (-4 / 3) * 9 - 3) + 1.6
    assert energy(RUBBER, F)[0] == pytest.approx(expected, rel=1e-14)


def test_rest_has_neither_energy_nor_stress() -> None:
    F = np.eye(3)[..., None]
    assert energy(RUBBER, F)[0] == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(first_piola(RUBBER, F), 0.0, atol=1e-15)


def test_small_strain_moduli_are_hookes() -> None:
    A = moduli(RUBBER, np.eye(3)[..., None])[..., 0]
    mu, d = 0.26, np.eye(3)
    expected = (3.2 - 2 / 3 * mu) * np.einsum("ij,kl->ijkl", d, d)
    expected += mu * (np.einsum("ik,jl->ijkl", d, d) + np.einsum("il,jk->ijkl", d, d))
    np.testing.assert_allclose(A, expected, atol=1e-14)


def test_bulk_modulus_of_the_papers_rubber() -> None:
    # The paper's D1 = 0.622 per MPa.
    assert pytest.approx(0.622, abs=5e-4) == 2.0 / PAPER_RUBBER.K
    assert PAPER_RUBBER.shear_modulus == pytest.approx(0.2644, rel=1e-12)


@pytest.mark.parametrize(
    "numbers", [(0.0, 0.0, 1.0), (-0.1, 0.2, 1.0), (0.2, -0.1, 1.0), (1, 1, 0)]
)
def test_no_such_rubber(numbers: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match="a rubber needs"):
        MooneyRivlin(*numbers)


@pytest.mark.parametrize("nu", [0.5, 0.7, -0.1])
def test_no_such_poissons_ratio(nu: float) -> None:
    with pytest.raises(ValueError, match="Poisson"):
        MooneyRivlin.from_poisson(1.0, 0.0, nu)


def test_determinant_and_cofactor_are_numpys() -> None:
    F = gradients()
    H = cofactor(F)
    for n in range(F.shape[2]):
        J = np.linalg.det(F[..., n])
        assert determinant(F, H)[n] == pytest.approx(J, rel=1e-13)
        np.testing.assert_allclose(H[..., n], J * np.linalg.inv(F[..., n]).T, rtol=1e-12)


@pytest.mark.parametrize("rubber", [RUBBER, NEO_HOOKE])
def test_stress_is_the_derivative_of_the_energy(rubber: MooneyRivlin) -> None:
    F, h = gradients(), 1e-5
    P = first_piola(rubber, F)
    for i, j in np.ndindex(3, 3):
        step = np.zeros((3, 3, 1))
        step[i, j] = h
        slope = (energy(rubber, F + step) - energy(rubber, F - step)) / (2 * h)
        np.testing.assert_allclose(P[i, j], slope, atol=1e-8)


@pytest.mark.parametrize("rubber", [RUBBER, NEO_HOOKE])
def test_tangent_is_the_derivative_of_the_stress(rubber: MooneyRivlin) -> None:
    F, h = gradients(), 1e-5
    A = moduli(rubber, F)
    for k, m in np.ndindex(3, 3):
        step = np.zeros((3, 3, 1))
        step[k, m] = h
        slope = (first_piola(rubber, F + step) - first_piola(rubber, F - step)) / (2 * h)
        np.testing.assert_allclose(A[:, :, k, m], slope, atol=1e-7)


def test_objectivity() -> None:
    F = gradients()
    turned = np.einsum("ip,pjn->ijn", TURN, F)
    np.testing.assert_allclose(energy(RUBBER, turned), energy(RUBBER, F), rtol=1e-10)
    P = np.einsum("ip,pjn->ijn", TURN, first_piola(RUBBER, F))
    np.testing.assert_allclose(first_piola(RUBBER, turned), P, atol=1e-10)
    A = np.einsum("ip,kr,pjrln->ijkln", TURN, TURN, moduli(RUBBER, F))
    np.testing.assert_allclose(moduli(RUBBER, turned), A, atol=1e-10)


def test_isotropy() -> None:
    # Turning the rubber before it is stretched changes nothing.
    F = gradients()
    turned = np.einsum("ijn,pj->ipn", F, TURN)
    np.testing.assert_allclose(energy(RUBBER, turned), energy(RUBBER, F), rtol=1e-10)
