"""A formula from a campaign: by the paper's steps, and by a polynomial that fits better."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from formula.data import Data, FloatArray
from formula.errors import BadFormula
from formula.theta import Terms, paper_terms

_OPENF, _PRESSURE = (1, 2), (2, 3, 4)  # powers that are tried
# Where another form's cross-validated error is within this share of the best, fewer terms win.
_AS_GOOD = 1.1


@dataclass(frozen=True)
class Errors:
    """How far a form is off the campaign, deg.

    Attributes
    ----------
    rms, largest : float
        Over all points.
    by_pressure : (N, 2)
        RMS and largest at each pressure.
    """

    rms: float
    largest: float
    by_pressure: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class PaperFit:
    """Formula (9) by the paper's own steps.

    Attributes
    ----------
    coefficients : tuple of 8 float
        In the order of Table 3.
    slope, intercept : (A, N)
        m (deg/mm) and c (deg) of theta = m openF + c.
    line_R2 : (A, N)
        Of theta against openF.
    a1, a2, a3 : (A,)
        m = a1 P² + a2 P, c = a3 P.
    slope_R2, intercept_R2 : (A,)
        Of m and of c against P.
    a1_R2, a2_R2, a3_R2 : float
        Of the coefficients against alpha.
    """

    coefficients: tuple[float, ...]
    slope: FloatArray
    intercept: FloatArray
    line_R2: FloatArray
    a1: FloatArray
    a2: FloatArray
    a3: FloatArray
    slope_R2: FloatArray
    intercept_R2: FloatArray
    a1_R2: float
    a2_R2: float
    a3_R2: float

    @property
    def terms(self) -> Terms:
        """Formula (9) as terms."""
        return paper_terms(self.coefficients)


@dataclass(frozen=True)
class FittedForm:
    """A polynomial form, by its highest powers, and how good it is.

    Attributes
    ----------
    powers : (int, int, int)
        Of openF, P and alpha.
    terms : Terms
    errors : Errors
        Of the fit to all runs.
    validated : Errors
        Each run predicted by a fit to all the others.
    """

    powers: tuple[int, int, int]
    terms: Terms
    errors: Errors
    validated: Errors

    @property
    def size(self) -> int:
        """How many terms it has."""
        J, K, I = self.powers  # noqa: E741
        return (J + 1) * K * (I + 1)


def fit_paper(data: Data) -> PaperFit:
    """Derive the eight coefficients as the paper does (its Figs. 5 to 7).

    Raises
    ------
    BadFormula
        When the campaign has too few runs for it.
    """
    A, _, N = data.theta_deg.shape
    m, c, line_R2 = (np.full((A, N), np.nan) for _ in range(3))
    for i, n in product(range(A), range(N)):
        theta = data.theta_deg[i, :, n]
        mask = np.isfinite(theta)
        if mask.sum() >= 2:
            basis = np.column_stack([data.openF_mm, np.ones_like(data.openF_mm)])
            (m[i, n], c[i, n]), line_R2[i, n] = _least(basis[mask], theta[mask])
    P = data.pressure_bar
    a1, a2, a3, slope_R2, intercept_R2 = (np.full(A, np.nan) for _ in range(5))
    for i in range(A):
        mask = np.isfinite(m[i])
        if mask.sum() >= 2:
            p = P[mask]
            (a1[i], a2[i]), slope_R2[i] = _least(np.column_stack([p**2, p]), m[i, mask])
            (a3[i],), intercept_R2[i] = _least(p[:, None], c[i, mask])
    mask = np.isfinite(a1)
    if mask.sum() < 3:
        raise BadFormula("formula (9) needs runs at three alphas with two openF each, or more")
    alpha = data.alpha_deg[mask]
    square = np.column_stack([alpha**2, alpha, np.ones_like(alpha)])
    (c11, c12, c13), a1_R2 = _least(square, a1[mask])
    (c21, c22, c23), a2_R2 = _least(square, a2[mask])
    (c31, c32), a3_R2 = _least(square[:, 1:], a3[mask])
    return PaperFit(
        tuple(float(v) for v in (c11, c12, c13, c21, c22, c23, c31, c32)),
        m, c, line_R2, a1, a2, a3, slope_R2, intercept_R2, a1_R2, a2_R2, a3_R2,
    )  # fmt: skip


def errors_of(data: Data, predict: Callable[..., FloatArray]) -> Errors:
    """Compare ``predict(alpha, openF, P)`` with a campaign."""
    alpha, openF, P, theta = data.points
    return _errors(data, predict(alpha, openF, P) - theta)


def candidates(data: Data) -> tuple[FittedForm, ...]:
    """Fit every form that the campaign has runs enough for, the best validated first."""
    alphas, cuts, pressures = (len(np.unique(values)) for values in data.points[:3])
    most = min(2, alphas - 1)
    fits = []
    for J, K in product(_OPENF, _PRESSURE):
        if alphas == 0 or cuts <= J or pressures < K:
            continue
        form = (J, K, most)
        everything = np.ones(len(data.points[3]), dtype=bool)
        coefficients, scales, residuals = _solve(data, form, everything)
        apart = np.empty_like(residuals)
        runs = data.run
        for run in np.unique(runs):
            left_out = runs == run
            apart[left_out] = _solve(data, form, ~left_out)[2][left_out]
        fits.append(
            FittedForm(
                form,
                _terms(coefficients, scales, form),
                _errors(data, residuals),
                _errors(data, apart),
            )
        )
    if not fits:
        raise BadFormula("a formula needs runs at two openF and two pressures, or more")
    return tuple(sorted(fits, key=lambda candidate: candidate.validated.rms))


def best(fits: tuple[FittedForm, ...]) -> FittedForm:
    """Choose the smallest form of those that are as good as the best."""
    limit = _AS_GOOD * fits[0].validated.rms
    return min((c for c in fits if c.validated.rms <= limit), key=lambda c: c.size)


def _solve(
    data: Data, form: tuple[int, int, int], used: np.ndarray[tuple[int], np.dtype[np.bool_]]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Least squares over the ``used`` points: coefficients, their scales, and all residuals."""
    alpha, openF, P, theta = data.points
    J, K, I = form  # noqa: E741
    tops = np.array([data.openF_mm.max(), data.pressure_bar.max(), data.alpha_deg.max()])
    parts = [
        (x / top)[:, None] ** np.arange(first, last + 1)
        for x, top, first, last in zip((openF, P, alpha), tops, (0, 1, 0), (J, K, I), strict=True)
    ]
    basis = np.einsum("mj,mk,mi->mjki", *parts).reshape(len(theta), -1)
    coefficients = np.linalg.lstsq(basis[used], theta[used], rcond=None)[0]
    return coefficients, tops, basis @ coefficients - theta


def _terms(coefficients: FloatArray, tops: FloatArray, form: tuple[int, int, int]) -> Terms:
    J, K, I = form  # noqa: E741
    openF, P, alpha = tops
    scale = (
        openF ** np.arange(J + 1)[:, None, None]
        * P ** np.arange(1, K + 1)[:, None]
        * alpha ** np.arange(I + 1)
    )
    whole = np.zeros((J + 1, K, 3))
    whole[..., : I + 1] = coefficients.reshape(J + 1, K, I + 1) / scale
    return tuple(tuple((float(r[0]), float(r[1]), float(r[2])) for r in block) for block in whole)


def _least(basis: FloatArray, values: FloatArray) -> tuple[FloatArray, float]:
    """Least squares and its R² (about the mean, as spreadsheets give it)."""
    coefficients: FloatArray = np.asarray(
        np.linalg.lstsq(basis, values, rcond=None)[0], dtype=np.float64
    )
    rest = float(((values - basis @ coefficients) ** 2).sum())
    about = float(((values - values.mean()) ** 2).sum())
    return coefficients, 1.0 - rest / about if about > 0.0 else 1.0


def _errors(data: Data, residuals: FloatArray) -> Errors:
    P = data.points[2]
    by_pressure = []
    for pressure in data.pressure_bar:
        here = residuals[pressure == P]
        by_pressure.append((_rms(here), float(np.abs(here).max(initial=0.0))))
    return Errors(_rms(residuals), float(np.abs(residuals).max(initial=0.0)), tuple(by_pressure))


def _rms(residuals: FloatArray) -> float:
    return float(np.sqrt(np.mean(residuals**2))) if residuals.size else 0.0
