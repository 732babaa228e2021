"""The laws: derivatives of the energy, known values, and row 2 for the material."""

from __future__ import annotations

import json
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from fem.material import (
    LAWS,
    PAPER_RUBBER,
    Law,
    MooneyRivlin,
    NeoHooke,
    Ogden,
    Yeoh,
    cofactor,
    determinant,
    energy,
    full_tangent,
    kinematics,
    law,
)
from fem.sections import rotation_matrix
from tests.fem.laws import EVERY_LAW, RUBBERS, slope

FloatArray = NDArray[np.float64]

RUBBER = MooneyRivlin(0.07, 0.06, 3.2)
TURN = rotation_matrix(np.array([0.7, -1.1, 0.4]))
# Principal stretches that are all apart, nearly equal, two equal and all equal.
STRETCHES = [(1.7, 1.1, 0.6), (1.3, 1.3 + 1e-9, 0.7), (1.4, 0.8, 0.8), (1.2, 1.2, 1.2)]


def gradients(seed: int = 0, batch: int = 4) -> FloatArray:
    """Random F (3, 3, batch), and one of each of STRETCHES turned before and after."""
    rng = np.random.default_rng(seed)
    F = rng.uniform(-0.3, 0.3, (3, 3, batch)) + np.diag([1.4, 0.9, 1.1])[..., None]
    turns = rotation_matrix(rng.uniform(-2.0, 2.0, (2, len(STRETCHES), 3)))
    some = np.einsum("nij,nj,nkj->ikn", turns[0], np.array(STRETCHES), turns[1])
    return np.concatenate([F, some], axis=2)


def first_piola(rubber: Law, F: FloatArray) -> FloatArray:
    k = kinematics(F)
    return rubber.stress(k, rubber.volumetric(k.J)[1])


def moduli(rubber: Law, F: FloatArray) -> FloatArray:
    k = kinematics(F)
    _, p, bulk = rubber.volumetric(k.J)
    return full_tangent(rubber.tangent(k, p, bulk))


def test_energy_of_a_stretch_by_hand() -> None:
    # diag(2, 1, 1): J = 2, I1 = 6, I2 = 4 + 4 + 1 = 9.
    F = np.diag([2.0, 1.0, 1.0])[..., None]
    c, U = 2 ** (-1 / 3), 1.6
    x = 6 * c**2 - 3
    expected = {
        RUBBER: 0.07 * x + 0.06 * (9 * c**4 - 3),
        NeoHooke(0.5, 3.2): 0.5 * x,
        Yeoh(0.3, 0.2, 0.1, 3.2): 0.3 * x + 0.2 * x**2 + 0.1 * x**3,
        Ogden((0.4, -0.2), (3.0, -1.0), 3.2): 0.4 / 3 * ((2 * c) ** 3 + 2 * c**3 - 3)
        + 0.2 * (1 / (2 * c) + 2 / c - 3),
    }
    for rubber, W in expected.items():
        assert energy(rubber, F)[0] == pytest.approx(W + U, rel=1e-13)


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_rest_has_neither_energy_nor_stress(rubber: Law) -> None:
    F = np.eye(3)[..., None]
    assert energy(rubber, F)[0] == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(first_piola(rubber, F), 0.0, atol=1e-15)


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_small_strain_moduli_are_hookes(rubber: Law) -> None:
    A = moduli(rubber, np.eye(3)[..., None])[..., 0]
    mu, d = rubber.shear_modulus, np.eye(3)
    expected = (rubber.bulk_modulus - 2 / 3 * mu) * np.einsum("ij,kl->ijkl", d, d)
    expected += mu * (np.einsum("ik,jl->ijkl", d, d) + np.einsum("il,jk->ijkl", d, d))
    np.testing.assert_allclose(A, expected, atol=1e-14)


def test_bulk_modulus_of_the_papers_rubber() -> None:
    # The paper's D1 = 0.622 per MPa.
    assert pytest.approx(0.622, abs=5e-4) == 2.0 / PAPER_RUBBER.K
    assert PAPER_RUBBER.shear_modulus == pytest.approx(0.2644, rel=1e-12)


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_principal_stresses_are_the_closed_form(rubber: Law) -> None:
    for l1, l2, l3 in STRETCHES:
        P = first_piola(rubber, np.diag([l1, l2, l3])[..., None])[..., 0]
        expected = [slope(rubber, l1, l2, l3), slope(rubber, l2, l3, l1), slope(rubber, l3, l1, l2)]
        np.testing.assert_allclose(P, np.diag(expected), atol=1e-13)


@pytest.mark.parametrize(
    "numbers", [(0.0, 0.0, 1.0), (-0.1, 0.2, 1.0), (0.2, -0.1, 1.0), (1, 1, 0)]
)
def test_no_such_rubber(numbers: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match="a rubber needs"):
        MooneyRivlin(*numbers)


def test_no_such_rubber_of_the_other_laws() -> None:
    for wrong in (lambda: NeoHooke(0.0, 1.0), lambda: NeoHooke(1.0, 0.0)):
        with pytest.raises(ValueError, match="neo-Hookean rubber needs"):
            wrong()
    for wrong in (lambda: Yeoh(0.0, 1.0, 1.0, 1.0), lambda: Yeoh(1.0, 0.0, 0.0, -1.0)):
        with pytest.raises(ValueError, match="Yeoh rubber needs"):
            wrong()
    for mu, alpha, K in (
        ((1.0,), (2.0, 3.0), 1.0),
        ((1.0,), (0.0,), 1.0),
        ((1.0,), (-2.0,), 1.0),
        ((1.0,), (2.0,), 0.0),
    ):
        with pytest.raises(ValueError, match="Ogden rubber needs"):
            Ogden(mu, alpha, K)


@pytest.mark.parametrize("nu", [0.5, 0.7, -0.1])
def test_no_such_poissons_ratio(nu: float) -> None:
    for make in (
        lambda: MooneyRivlin.from_poisson(1.0, 0.0, nu),
        lambda: NeoHooke.from_poisson(1.0, nu),
        lambda: Yeoh.from_poisson(1.0, 0.0, 0.0, nu),
        lambda: Ogden.from_poisson((1.0,), (2.0,), nu),
    ):
        with pytest.raises(ValueError, match="Poisson"):
            make()


@pytest.mark.parametrize("name", LAWS)
def test_poissons_ratio_gives_the_bulk_modulus(name: str) -> None:
    rubber = RUBBERS[name]
    mu, K = rubber.shear_modulus, rubber.bulk_modulus
    assert (3.0 * K - 2.0 * mu) / (6.0 * K + 2.0 * mu) == pytest.approx(0.46, rel=1e-12)


@pytest.mark.parametrize("name", LAWS)
def test_a_law_comes_back_by_its_name_and_constants(name: str) -> None:
    rubber = RUBBERS[name]
    held = json.loads(json.dumps({"law": rubber.name, "constants": rubber.constants}))
    assert held["law"] == name
    assert law(held["law"], held["constants"]) == rubber
    by_nu = {key: value for key, value in held["constants"].items() if key != "K"}
    assert law(name, {**by_nu, "nu": 0.46}) == rubber
    with pytest.raises(FrozenInstanceError):
        rubber.K = 1.0  # type: ignore[misc]


@pytest.mark.parametrize(
    ("name", "constants", "message"),
    [
        ("gent", {"mu": 1.0, "Jm": 3.0, "K": 1.0}, "there is no law"),
        ("neo-hooke", {"C10": 1.0}, "takes C10, K"),
        ("neo-hooke", {"C10": 1.0, "nu": 0.4, "K": 1.0}, "takes C10, nu"),
        ("yeoh", {"C10": 1.0, "K": 1.0}, "takes C10, C20, C30, K"),
        ("neo-hooke", {"C10": float("inf"), "K": 1.0}, "C10 must be a finite number"),
        ("neo-hooke", {"C10": True, "K": 1.0}, "C10 must be a finite number"),
        ("neo-hooke", {"C10": [1.0], "K": 1.0}, "C10 must be a finite number"),
        ("ogden", {"mu": 1.0, "alpha": [2.0], "K": 1.0}, "mu must be a list"),
        ("ogden", {"mu": ["1"], "alpha": [2.0], "K": 1.0}, "mu must be a finite number"),
        ("neo-hooke", {"C10": 1.0, "nu": 0.5}, "Poisson"),
    ],
)
def test_no_law_of_these_constants(name: str, constants: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        law(name, constants)


@pytest.mark.parametrize(
    ("special", "known"),
    [
        (NeoHooke(0.5, 10.0), MooneyRivlin(0.5, 0.0, 10.0)),
        (Yeoh(0.5, 0.0, 0.0, 10.0), NeoHooke(0.5, 10.0)),
        (Ogden((1.0,), (2.0,), 10.0), NeoHooke(0.5, 10.0)),
        (Ogden((0.14, -0.12), (2.0, -2.0), 3.2), RUBBER),
    ],
)
def test_laws_that_are_one(special: Law, known: Law) -> None:
    assert special.shear_modulus == pytest.approx(known.shear_modulus, rel=1e-14)
    F = gradients()
    np.testing.assert_allclose(energy(special, F), energy(known, F), rtol=1e-12)
    np.testing.assert_allclose(first_piola(special, F), first_piola(known, F), atol=1e-13)
    np.testing.assert_allclose(moduli(special, F), moduli(known, F), atol=1e-12)


def test_determinant_and_cofactor_are_numpys() -> None:
    F = gradients()
    H = cofactor(F)
    for n in range(F.shape[2]):
        J = np.linalg.det(F[..., n])
        assert determinant(F, H)[n] == pytest.approx(J, rel=1e-13)
        np.testing.assert_allclose(H[..., n], J * np.linalg.inv(F[..., n]).T, rtol=1e-12)


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_stress_is_the_derivative_of_the_energy(rubber: Law) -> None:
    F, h = gradients(), 1e-5
    P = first_piola(rubber, F)
    for i, j in np.ndindex(3, 3):
        step = np.zeros((3, 3, 1))
        step[i, j] = h
        change = (energy(rubber, F + step) - energy(rubber, F - step)) / (2 * h)
        np.testing.assert_allclose(P[i, j], change, atol=1e-8)


def difference(rubber: Law, F: FloatArray, way: FloatArray, h: float) -> FloatArray:
    """Central difference of the stress along ``way``."""
    return (first_piola(rubber, F + h * way) - first_piola(rubber, F - h * way)) / (2 * h)


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_tangent_is_the_derivative_of_the_stress(rubber: Law) -> None:
    F = gradients()
    A = moduli(rubber, F)
    for k, m in np.ndindex(3, 3):
        step = np.zeros((3, 3, 1))
        step[k, m] = 1.0
        np.testing.assert_allclose(A[:, :, k, m], difference(rubber, F, step, 1e-5), atol=1e-7)


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_error_of_the_differences_is_a_v(rubber: Law) -> None:
    F = gradients()
    way = np.random.default_rng(1).uniform(-1.0, 1.0, F.shape)
    exact = np.einsum("ijkln,kln->ijn", moduli(rubber, F), way)
    errors = [
        float(np.abs(difference(rubber, F, way, h) - exact).max() / np.abs(exact).max())
        for h in (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10)
    ]
    assert min(errors) < 1e-9
    # Truncation falls with h^2, rounding rises with 1/h.
    assert 50.0 < errors[0] / errors[1] < 200.0
    assert 50.0 < errors[1] / errors[2] < 200.0
    assert errors[5] > 10.0 * errors[4] > 100.0 * errors[3]


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_tangent_is_symmetric(rubber: Law) -> None:
    A = moduli(rubber, gradients())
    np.testing.assert_allclose(A, A.transpose(2, 3, 0, 1, 4), atol=1e-13 * np.abs(A).max())


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_objectivity(rubber: Law) -> None:
    F = gradients()
    turned = np.einsum("ip,pjn->ijn", TURN, F)
    np.testing.assert_allclose(energy(rubber, turned), energy(rubber, F), rtol=1e-10)
    P = np.einsum("ip,pjn->ijn", TURN, first_piola(rubber, F))
    np.testing.assert_allclose(first_piola(rubber, turned), P, atol=1e-10)
    A = np.einsum("ip,kr,pjrln->ijkln", TURN, TURN, moduli(rubber, F))
    np.testing.assert_allclose(moduli(rubber, turned), A, atol=1e-10)


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_isotropy(rubber: Law) -> None:
    # Turning the rubber before it is stretched changes nothing.
    F = gradients()
    turned = np.einsum("ijn,pj->ipn", F, TURN)
    np.testing.assert_allclose(energy(rubber, turned), energy(rubber, F), rtol=1e-10)


@pytest.mark.parametrize("rubber", EVERY_LAW)
def test_the_volumetric_part_is_apart(rubber: Law) -> None:
    # A swelling changes J alone: neither W_iso nor its stress know of it.
    k = kinematics(1.3 * np.eye(3)[..., None])
    assert rubber.isochoric_energy(k)[0] == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(rubber.stress(k, np.zeros(1)), 0.0, atol=1e-15)
    stiffer = replace(rubber, K=2.0 * rubber.bulk_modulus)  # type: ignore[type-var]
    F = gradients()
    k = kinematics(F)
    np.testing.assert_array_equal(stiffer.isochoric_energy(k), rubber.isochoric_energy(k))
