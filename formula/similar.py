"""A campaign for another tube or rubber from a known one and a few runs.

Theta depends on alpha, openF / D, wall / D, P / (C10 + C01), C01 / C10 and the bulk modulus over
C10 + C01, and hardly on the gauze's stiffness. A tube of the same shape and kind of rubber is
therefore known already; what its gauze changes, and what another shape or kind of rubber does, a
few runs tell: their ratio to the known angles is smooth.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator, make_interp_spline

from formula.data import Data, FloatArray

# Corners and middle: they tell a function that is a parabola in alpha and a line in openF.
CORRECTIONS = 5


def carried(
    known: Data,
    alpha_deg: FloatArray,
    openF_mm: FloatArray,
    pressure_bar: FloatArray,
    length: float,
    stiffness: float,
) -> FloatArray:
    """Angles of a similar tube by a known one's, (A, O, N) deg; NaN outside what is known.

    Beyond the longest and the shortest known cut theta goes on along the line that it nearly is.

    Parameters
    ----------
    known : Data
    alpha_deg, openF_mm, pressure_bar : (A,), (O,), (N,)
        Of the new tube.
    length, stiffness : float
        The new diameter over the known one, and the new C10 + C01 over the known one.
    """
    openF, P = np.asarray(openF_mm) / length, np.asarray(pressure_bar) / stiffness
    theta = _along(known.alpha_deg, known.theta_deg, np.asarray(alpha_deg), axis=0)
    theta = _along(*_longer(known.openF_mm, theta, openF), openF, axis=1)
    # theta / P is even smoother than theta, and makes theta 0 at 0.
    pressures = known.pressure_bar
    share = _along(pressures, theta / pressures, P, axis=2, below=True)
    angles: FloatArray = share * P
    return angles


def correction_runs(alpha_deg: FloatArray, openF_mm: FloatArray) -> list[tuple[int, int]]:
    """Choose runs for a correction: indices of alpha and openF, at most `CORRECTIONS`."""
    A, O = len(alpha_deg), len(openF_mm)  # noqa: E741
    chosen = [(0, 0), (0, O - 1), (A - 1, 0), (A - 1, O - 1), (A // 2, O // 2)]
    return sorted(set(chosen))


def corrected(guess: FloatArray, few: Data, whole: Data) -> Data:
    """Bring carried-over angles onto a few runs.

    Parameters
    ----------
    guess : (A, O, N)
        Angles by `carried` on the grid of ``whole``.
    few : Data
        On that same grid, NaN but for the runs that were made.
    whole : Data
        The grid; its angles do not matter.

    Returns
    -------
    Data
        The guess times a ratio that is a parabola in alpha and bilinear with openF at every
        pressure; the runs themselves as they are.
    """
    alpha, openF = np.meshgrid(_unit(whole.alpha_deg), _unit(whole.openF_mm), indexing="ij")
    theta = np.array(guess)
    for n in range(len(whole.pressure_bar)):
        ratio = few.theta_deg[..., n] / guess[..., n]
        made = np.isfinite(ratio)
        if not made.any():
            theta[..., n] = np.nan
            continue
        terms = (np.ones_like(alpha), alpha, openF, alpha**2, alpha * openF)
        told = [term for term in terms if np.abs(term[made]).max() > 0.0]
        basis = np.stack(told[: int(made.sum())], axis=-1)
        factors = np.linalg.lstsq(basis[made], ratio[made], rcond=None)[0]
        theta[..., n] = np.where(made, few.theta_deg[..., n], guess[..., n] * (basis @ factors))
    return Data(whole.alpha_deg, whole.openF_mm, whole.pressure_bar, theta)


def _longer(x: FloatArray, theta: FloatArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Add lines' ends to theta (A, O, N) over x (O,), so that they reach over all of ``at``."""
    if len(x) < 2:
        return x, theta
    for end, inner, beyond in ((0, 1, at.min()), (-1, -2, at.max())):
        if (beyond - x[end]) * (x[end] - x[inner]) > 0.0:
            share = (beyond - x[end]) / (x[end] - x[inner])
            further = theta[:, end] + share * (theta[:, end] - theta[:, inner])
            place = 0 if end == 0 else len(x)
            x = np.insert(x, place, beyond)
            theta = np.insert(theta, place, further, axis=1)
    return x, theta


def _unit(values: FloatArray) -> FloatArray:
    spread = float(np.ptp(values))
    scaled: FloatArray = (values - values.mean()) / (spread if spread > 0.0 else 1.0)
    return scaled


def _along(
    x: FloatArray, values: FloatArray, at: FloatArray, axis: int, *, below: bool = False
) -> FloatArray:
    """Interpolate along an axis; NaN outside x, but that ``below`` it goes on as it begins."""
    if len(x) == 1:
        inside = np.repeat(values, len(at), axis=axis)
        outside = np.abs(at - x[0]) > 1e-9 * max(abs(float(x[0])), 1.0)
    elif np.isfinite(values).all() and len(x) >= 4:
        inside = make_interp_spline(x, values, k=3, axis=axis)(at)
        outside = (at > x[-1] * (1.0 + 1e-9)) | (at < x[0] * (1.0 - 1e-9))
    else:
        inside = _gappy(x, values, at, axis)
        outside = (at > x[-1] * (1.0 + 1e-9)) | (at < x[0] * (1.0 - 1e-9))
    if below:
        outside = outside & (at > x[0])
    shape = [1, 1, 1]
    shape[axis] = len(at)
    result: FloatArray = np.where(outside.reshape(shape), np.nan, inside)
    return result


def _gappy(x: FloatArray, values: FloatArray, at: FloatArray, axis: int) -> FloatArray:
    """Interpolate rows that have gaps, each by what it has; NaN beyond its own ends."""

    def row(y: FloatArray) -> FloatArray:
        mask = np.isfinite(y)
        if mask.sum() < 2:
            return np.full(len(at), np.nan)
        interpolant: FloatArray = PchipInterpolator(x[mask], y[mask], extrapolate=False)(at)
        return interpolant

    return np.apply_along_axis(row, axis, values)
