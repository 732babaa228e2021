"""The continuous inverse of formula (9): alpha from theta, openF and P."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from formula.errors import OutOfRange
from formula.theta import Formula, check_range, quadratic_in_alpha, theta_deg


def alpha_branch_deg(
    formula: Formula, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the range of alpha on which theta falls with alpha.

    In alpha the formula is a parabola that opens downward. Left of its vertex theta would grow
    with the uncut sector, which the joint does not do, so the inverse starts at the vertex where
    that lies inside the formula's range (about 90 deg at 1.9 bar).

    Returns
    -------
    low, high : ndarrays of the broadcast shape, deg

    Raises
    ------
    OutOfRange
        When the formula's parabola opens upward.
    """
    a, b, _ = quadratic_in_alpha(formula, openF_mm, pressure_bar)
    if np.any((a >= 0.0) & (np.asarray(pressure_bar) > 0.0)):
        raise OutOfRange(f'formula "{formula.name}" does not fall with alpha; it has no inverse')
    low, high = formula.alpha_range_deg
    with np.errstate(divide="ignore", invalid="ignore"):
        vertex = np.where(a < 0.0, -b / (2.0 * a), low)
    return np.clip(vertex, low, high), np.full(np.shape(a), high)


def theta_range_deg(
    formula: Formula, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the least and the largest angle that some alpha gives at this openF and pressure.

    The least is never below zero: the formula turns negative near alpha 180 deg.
    """
    low, high = alpha_branch_deg(formula, openF_mm, pressure_bar)
    least = theta_deg(formula, high, openF_mm, pressure_bar)
    return np.maximum(least, 0.0), theta_deg(formula, low, openF_mm, pressure_bar)


def alpha_deg(
    formula: Formula, theta_wanted_deg: ArrayLike, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> NDArray[np.float64]:
    """Alpha that gives the wanted angle; arguments broadcast.

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
    a, b, c = quadratic_in_alpha(formula, openF, P)
    root = np.sqrt(np.maximum(b * b - 4.0 * a * (c - theta), 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        alpha = (-b - root) / (2.0 * a)
    low, high = alpha_branch_deg(formula, openF, P)
    # At no pressure every alpha gives theta = 0; the widest sector is the strongest one.
    return np.clip(np.where(P > 0.0, alpha, high), low, high)


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
