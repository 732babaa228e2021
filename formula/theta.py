"""The bending angle of one joint as a polynomial: formula (9) is one, a derived one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from formula.errors import OutOfRange
from formula.rubber import RubberLaw

COEFFICIENTS = ("c11", "c12", "c13", "c21", "c22", "c23", "c31", "c32")
Terms = tuple[tuple[tuple[float, float, float], ...], ...]


@dataclass(frozen=True)
class Formula:
    """Polynomial for the angle of one joint, and the range that it holds for.

    theta = sum of ``terms[j][k - 1][i]`` openF^j P^k alpha^i. Formula (9) of the paper is one of
    these, with the coefficients of Table 3.

    Attributes
    ----------
    name, source : str
        As the formula file gives them.
    sha256 : str
        Of the file that it was read from.
    terms : tuple
        By powers of openF (mm) from 0, of P (bar) from 1 and of alpha (deg) from 0 to 2.
    outer_diameter_mm, wall_mm : float
        The tube that it was fitted on.
    alpha_range_deg, openF_range_mm, pressure_range_bar : tuple of 2 float
        What may be asked of it.
    rubber : RubberLaw or None
        Where the file does not say, the paper's.
    fitted : tuple of 3 ranges, or None
        Of alpha, openF and pressure: what it was fitted on, where more than that may be asked.
    """

    name: str
    source: str
    sha256: str
    terms: Terms
    outer_diameter_mm: float
    wall_mm: float
    alpha_range_deg: tuple[float, float]
    openF_range_mm: tuple[float, float]
    pressure_range_bar: tuple[float, float]
    rubber: RubberLaw | None = None
    fitted: tuple[tuple[float, float], ...] | None = None


def paper_terms(coefficients: Sequence[float]) -> Terms:
    """Terms of formula (9): of c11, c12, c13, c21, c22, c23, c31, c32 (Table 3)."""
    c11, c12, c13, c21, c22, c23, c31, c32 = coefficients
    nothing = (0.0, 0.0, 0.0)
    return (((c32, c31, 0.0), nothing), ((c23, c22, c21), (c13, c12, c11)))


def quadratic_in_alpha(
    formula: Formula, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return a, b, c of theta = a alpha² + b alpha + c at given openF and P (broadcast)."""
    openF, P = np.broadcast_arrays(
        np.asarray(openF_mm, dtype=float), np.asarray(pressure_bar, dtype=float)
    )
    total = np.zeros((3, *openF.shape))
    for power, block in enumerate(formula.terms):
        rows = np.zeros((3, *openF.shape))
        for row in reversed(block):
            rows = (rows + np.reshape(row, (3,) + (1,) * openF.ndim)) * P
        total += rows * openF**power
    c, b, a = total
    return a, b, c


def theta_deg(
    formula: Formula, alpha_deg: ArrayLike, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> NDArray[np.float64]:
    """Bending angle of a joint by a formula; for the paper's, equation (9).

    Parameters
    ----------
    formula : Formula
        Its range is not checked.
    alpha_deg : array_like
        Uncut sector alpha_closed, deg.
    openF_mm : array_like
        Length of the cut, mm.
    pressure_bar : array_like
        Gauge pressure, bar.

    Returns
    -------
    ndarray
        Angles of the broadcast shape, deg; a magnitude, toward the uncut sector.
    """
    a, b, c = quadratic_in_alpha(formula, openF_mm, pressure_bar)
    alpha = np.asarray(alpha_deg, dtype=float)
    theta: NDArray[np.float64] = (a * alpha + b) * alpha + c
    return theta


def widened(formula: Formula) -> Formula:
    """Let a formula be extrapolated: by half the cut and the pressure, by a fifth of alpha."""
    fitted = (formula.alpha_range_deg, formula.openF_range_mm, formula.pressure_range_bar)
    (a0, a1), (o0, o1), (p0, p1) = fitted
    return replace(
        formula,
        alpha_range_deg=(0.8 * a0, max(a1, min(1.2 * a1, 180.0))),
        openF_range_mm=(0.5 * o0, 1.5 * o1),
        pressure_range_bar=(0.5 * p0, 1.5 * p1),
        fitted=fitted,
    )


def beyond(
    formula: Formula, alpha_deg: ArrayLike, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> NDArray[np.bool_]:
    """Whether a formula is extrapolated at these values; arguments broadcast."""
    ranges = formula.fitted or (
        formula.alpha_range_deg,
        formula.openF_range_mm,
        formula.pressure_range_bar,
    )
    outside = [
        (values < low - 1e-9) | (values > high + 1e-9)
        for values, (low, high) in zip(
            np.broadcast_arrays(alpha_deg, openF_mm, pressure_bar), ranges, strict=True
        )
    ]
    anywhere: NDArray[np.bool_] = np.any(outside, axis=0)
    return anywhere


def check_range(
    formula: Formula, what: str, unit: str, values: ArrayLike, limits: tuple[float, float]
) -> None:
    """Refuse values outside the limits of a formula.

    Raises
    ------
    OutOfRange
        Naming the first value outside, what it is, and the limits.
    """
    array = np.asarray(values, dtype=float)
    low, high = limits
    outside = array[~((array >= low) & (array <= high))]
    if outside.size:
        raise OutOfRange(
            f"{what} {outside[0]:g} {unit} is outside the {low:g} to {high:g} {unit} "
            f'that formula "{formula.name}" holds for'
        )
