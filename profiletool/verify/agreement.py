"""Measured angles compared with a model's: regression, bias, limits of agreement.

R² alone says little: a model that is 30 % too stiff has nearly 1. Slope and bias tell.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from profiletool.records.bench import Agreement, Seen
from profiletool.records.units import FloatArray

_LIMIT = 1.96  # standard deviations, Bland and Altman 1986


def agreement(measured: FloatArray, model: FloatArray) -> Agreement | None:
    """Compare angles (n,) deg with a model's; None where there are fewer than two."""
    kept = np.isfinite(measured) & np.isfinite(model)
    y, x = measured[kept], model[kept]
    if len(y) < 2:
        return None
    off = y - x
    bias = float(off.mean())
    width = _LIMIT * float(off.std(ddof=1))
    spread = float(((x - x.mean()) ** 2).sum())
    total = float(((y - y.mean()) ** 2).sum())
    slope = r2 = intercept = float("nan")
    if spread > 0.0 and total > 0.0:
        slope = float(((x - x.mean()) * (y - y.mean())).sum()) / spread
        intercept = float(y.mean() - slope * x.mean())
        r2 = 1.0 - float(((y - slope * x - intercept) ** 2).sum()) / total
    rmse = float(np.sqrt(np.mean(off**2)))
    return Agreement(len(y), r2, slope, intercept, rmse, bias, (bias - width, bias + width))


def angles_of(seen: Sequence[Seen]) -> tuple[FloatArray, FloatArray]:
    """Give angles and their sigmas as tables: (pictures, joints) deg each, NaN where lost."""
    theta = np.array([[angle.theta_deg for angle in one.angles] for one in seen])
    sigma = np.array([[angle.sigma_deg for angle in one.angles] for one in seen])
    return theta, sigma


def agreements(
    measured: FloatArray, model: FloatArray
) -> tuple[tuple[Agreement | None, ...], Agreement | None]:
    """Compare (pictures, joints) deg with a model's: joint by joint, and all together."""
    each = tuple(agreement(measured[:, k], model[:, k]) for k in range(measured.shape[1]))
    return each, agreement(measured.ravel(), model.ravel())
