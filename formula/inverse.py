"""The continuous inverse of a formula: alpha from theta, openF and P."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from formula.errors import OutOfRange
from formula.theta import Formula, check_range, quadratic_in_alpha, theta_deg


def alpha_branch_deg(
    formula: Formula, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the range of alpha on which theta falls with alpha.

    In alpha a formula is a parabola. On one side of its vertex theta would grow with the uncut
    sector, which a joint does not do, so where the vertex lies inside the formula's range the
    inverse starts there, or ends there where the parabola opens upward. (Formula (9) opens
    downward, with its vertex at about 90 deg at 1.9 bar.)

    Returns
    -------
    low, high : ndarrays of the broadcast shape, deg

    Raises
    ------
    OutOfRange
        When the formula rises with alpha all over its range.
    """
    a, b, _ = quadratic_in_alpha(formula, openF_mm, pressure_bar)
    low, high = formula.alpha_range_deg
    with np.errstate(divide="ignore", invalid="ignore"):
        vertex = np.clip(-b / (2.0 * a), low, high)
    first = np.where(a < 0.0, vertex, low)
    last = np.where(a > 0.0, vertex, high)
    slope = a * (first + last) + b  # half-way
    if np.any(~((first < last) & (slope < 0.0)) & (np.asarray(pressure_bar) > 0.0)):
        raise OutOfRange(f'formula "{formula.name}" does not fall with alpha; it has no inverse')
    return first, last


def theta_range_deg(
    formula: Formula, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the least and the largest angle that some alpha gives at this openF and pressure.

    The least is never below zero: the formula turns negative near alpha 180 deg.

    Parameters
    ----------
    formula : Formula
    openF_mm : array_like
        Length of the cut, mm.
    pressure_bar : array_like
        Gauge pressure, bar.

    Returns
    -------
    least, most : ndarray
        Of the broadcast shape, deg.

    Raises
    ------
    OutOfRange
        When the formula rises with alpha all over its range.
    """
    low, high = alpha_branch_deg(formula, openF_mm, pressure_bar)
    least = theta_deg(formula, high, openF_mm, pressure_bar)
    return np.maximum(least, 0.0), theta_deg(formula, low, openF_mm, pressure_bar)


def alpha_deg(
    formula: Formula, theta_wanted_deg: ArrayLike, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> NDArray[np.float64]:
    """Alpha that gives the wanted angle: the inverse of `theta_deg` by alpha.

    Parameters
    ----------
    formula : Formula
    theta_wanted_deg : array_like
        Wanted angle, deg, 0 or above.
    openF_mm : array_like
        Length of the cut, mm.
    pressure_bar : array_like
        Gauge pressure, bar.

    Returns
    -------
    ndarray
        Uncut sector alpha_closed of the broadcast shape, deg.

    Raises
    ------
    OutOfRange
        Naming the first value that lies outside and the limit that it hits.
    """
    theta, openF, P = np.broadcast_arrays(
        *(np.asarray(v, dtype=float) for v in (theta_wanted_deg, openF_mm, pressure_bar))
    )
    check_range(formula, "openF", "mm", openF, formula.openF_range_mm)
    check_range(formula, "pressure", "bar", P, formula.pressure_range_bar)
    least, most = theta_range_deg(formula, openF, P)
    _check_theta(theta, least, most, openF, P)
    alpha = falling_root(*quadratic_in_alpha(formula, openF, P), theta)
    low, high = alpha_branch_deg(formula, openF, P)
    # At no pressure every alpha gives theta = 0; the widest sector is the strongest one.
    return np.clip(np.where(P > 0.0, alpha, high), low, high)


def falling_root(
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    c: NDArray[np.float64],
    theta: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Alpha where a alpha² + b alpha + c falls through theta; at the vertex where it does not."""
    root = np.sqrt(np.maximum(b * b - 4.0 * a * (c - theta), 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        # The textbook form loses all digits where the parabola is nearly a line.
        straight = 2.0 * (c - theta) / (root - b)
        alpha: NDArray[np.float64] = np.where(b < 0.0, straight, (-b - root) / (2.0 * a))
    return alpha


def _check_theta(
    theta: NDArray[np.float64],
    least: NDArray[np.float64],
    most: NDArray[np.float64],
    openF: NDArray[np.float64],
    P: NDArray[np.float64],
) -> None:
    slack = 1e-9
    for outside, limits, side, advice in (
        (~(theta <= most + slack), most, "most", "a longer cut or more pressure is needed"),
        (~(theta >= least - slack), least, "least", "a shorter cut or less pressure is needed"),
    ):
        if outside.any():
            raise OutOfRange(
                f"theta {theta[outside].flat[0]:.2f} deg is beyond {limits[outside].flat[0]:.2f} "
                f"deg, the {side} that openF {openF[outside].flat[0]:g} mm gives at "
                f"{P[outside].flat[0]:g} bar; {advice}"
            )
