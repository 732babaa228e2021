"""Formula (9): the bending angle of one joint."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from formula.errors import BadFormula, OutOfRange

SCHEMA = "profiletool.formula/1"
_ABSURD = 1e9
COEFFICIENTS = ("c11", "c12", "c13", "c21", "c22", "c23", "c31", "c32")


@dataclass(frozen=True)
class Formula:
    """Formula (9) with its eight coefficients and the range that it holds for.

    Attributes
    ----------
    name, source : str
    sha256 : str
        Of the file that it was read from.
    coefficients : tuple of 8 float
        c11, c12, c13, c21, c22, c23, c31, c32 (Table 3), for degrees, mm and bar.
    outer_diameter_mm, wall_mm : float
        The tube that it was fitted on.
    alpha_range_deg, openF_range_mm, pressure_range_bar : tuple of 2 float
    """

    name: str
    source: str
    sha256: str
    coefficients: tuple[float, ...]
    outer_diameter_mm: float
    wall_mm: float
    alpha_range_deg: tuple[float, float]
    openF_range_mm: tuple[float, float]
    pressure_range_bar: tuple[float, float]


def quadratic_in_alpha(
    formula: Formula, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return a, b, c of theta = a alpha² + b alpha + c at given openF and P (broadcast)."""
    c11, c12, c13, c21, c22, c23, c31, c32 = formula.coefficients
    openF, P = np.broadcast_arrays(
        np.asarray(openF_mm, dtype=float), np.asarray(pressure_bar, dtype=float)
    )
    a = (c11 * P + c21) * P * openF
    b = (c12 * P + c22) * P * openF + c31 * P
    c = (c13 * P + c23) * P * openF + c32 * P
    return a, b, c


def theta_deg(
    formula: Formula, alpha_deg: ArrayLike, openF_mm: ArrayLike, pressure_bar: ArrayLike
) -> NDArray[np.float64]:
    """Bending angle by formula (9), deg; arguments broadcast, the range is not checked.

    Parameters
    ----------
    formula : Formula
    alpha_deg, openF_mm, pressure_bar : array_like

    Returns
    -------
    ndarray of the broadcast shape
    """
    a, b, c = quadratic_in_alpha(formula, openF_mm, pressure_bar)
    alpha = np.asarray(alpha_deg, dtype=float)
    theta: NDArray[np.float64] = (a * alpha + b) * alpha + c
    return theta


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


def load_formula(path: Path | None = None) -> Formula:
    """Read a formula file; the paper's own where no path is given.

    Raises
    ------
    BadFormula
        When the file cannot be read or is no formula file of this schema.
    """
    if path is None:
        data = (resources.files("formula") / "coefficients" / "paper.json").read_bytes()
        return parse_formula(data, "paper.json")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise BadFormula(f"cannot read {path}: {error.strerror}") from error
    return parse_formula(data, path.name)


def parse_formula(data: bytes, file: str) -> Formula:
    """Build a Formula from the bytes of a formula file, checking every field.

    Raises
    ------
    BadFormula
        Naming the file and the first field that is missing or makes no sense.
    """
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise BadFormula(f"{file} is not JSON: {error}") from error
    if not isinstance(tree, dict) or tree.get("schema") != SCHEMA:
        raise BadFormula(f'{file} is no formula file: its "schema" is not "{SCHEMA}"')
    coefficients, domain = (_mapping(tree, key, file) for key in ("coefficients", "domain"))
    return Formula(
        name=str(tree.get("name", file)),
        source=str(tree.get("source", "")),
        sha256=hashlib.sha256(data).hexdigest(),
        coefficients=tuple(_number(coefficients, key, file) for key in COEFFICIENTS),
        outer_diameter_mm=_number(domain, "outer_diameter_mm", file),
        wall_mm=_number(domain, "wall_mm", file),
        alpha_range_deg=_interval(domain, "alpha_closed_deg", file),
        openF_range_mm=_interval(domain, "openF_mm", file),
        pressure_range_bar=_interval(domain, "pressure_bar", file),
    )


def _mapping(tree: dict[str, Any], key: str, file: str) -> dict[str, Any]:
    value = tree.get(key)
    if not isinstance(value, dict):
        raise BadFormula(f'{file} lacks "{key}"')
    return value


def _number(tree: dict[str, Any], key: str, file: str) -> float:
    value = tree.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < _ABSURD:
        raise BadFormula(f'{file}: "{key}" is not a number')
    return float(value)


def _interval(tree: dict[str, Any], key: str, file: str) -> tuple[float, float]:
    value = tree.get(key)
    if not isinstance(value, list) or len(value) != 2:
        raise BadFormula(f'{file}: "{key}" is not a pair of numbers')
    low, high = (_number({key: item}, key, file) for item in value)
    if low >= high:
        raise BadFormula(f'{file}: "{key}" is empty')
    return low, high
