"""Formula files: JSON, every field checked when it is read.

Schema ``profiletool.formula/1`` holds the eight coefficients of formula (9); ``/2`` the terms of
any polynomial of `formula.theta.Formula`, and with them the campaign that they were fitted to.
"""

from __future__ import annotations

import hashlib
import json
import stat
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from formula.data import Data, FloatArray
from formula.errors import BadFormula
from formula.rubber import RubberLaw, read_rubber
from formula.theta import COEFFICIENTS, Formula, Terms, paper_terms

SCHEMA, POLYNOMIAL = "profiletool.formula/1", "profiletool.formula/2"
_ABSURD = 1e9
_MOST_BYTES = 5_000_000
_MOST_POWERS = 8


def shipped() -> dict[str, bytes]:
    """Files of the formulas that are part of the package.

    Returns
    -------
    dict of str to bytes
        Name, such as "paper" or "fe", to content.
    """
    folder = resources.files("formula") / "coefficients"
    return {
        file.name.removesuffix(".json"): file.read_bytes()
        for file in sorted(folder.iterdir(), key=lambda file: file.name)
        if file.name.endswith(".json")
    }


def load_formula(path: Path | None = None) -> Formula:
    """Read a formula file.

    Parameters
    ----------
    path : Path, optional
        The file, or the name of a formula of the package (`shipped`); by default the paper's,
        equation (9) with the coefficients of Table 3.

    Returns
    -------
    Formula

    Raises
    ------
    BadFormula
        When the file cannot be read or is no formula file of this schema.
    """
    if path is None:
        return parse_formula(shipped()["paper"], "paper")
    return parse_formula(read_bytes(str(path)), str(path))


def read_bytes(name: str) -> bytes:
    """Bytes of a formula file, or of the formula of that name that comes along.

    Raises
    ------
    BadFormula
    """
    path = Path(name)
    ours = shipped()
    if name in ours and not path.is_file():
        return ours[name]
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # a pipe would wait for ever
            raise OSError("not a file")
        with path.open("rb") as file:
            data = file.read(_MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        names = ", ".join(ours)
        raise BadFormula(f"cannot read {path}: {reason}; by name there are {names}") from error
    if len(data) > _MOST_BYTES:
        raise BadFormula(
            f"{path} is larger than {_MOST_BYTES / 1e6:g} MB, too large for a formula file"
        )
    return data


def read_tree(data: bytes, file: str) -> dict[str, Any]:
    """Decode a formula file and check its schema.

    Raises
    ------
    BadFormula
    """
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise BadFormula(f"{file} is not JSON: {error}") from error
    if not isinstance(tree, dict) or tree.get("schema") not in (SCHEMA, POLYNOMIAL):
        raise BadFormula(f'{file} is no formula file: its "schema" is not "{SCHEMA}" or /2')
    return tree


def parse_formula(data: bytes, file: str) -> Formula:
    """Build a Formula from the bytes of a formula file, checking every field.

    Raises
    ------
    BadFormula
        Naming the file and the first field that is missing or makes no sense.
    """
    tree = read_tree(data, file)
    domain = _mapping(tree, "domain", file)
    if tree["schema"] == SCHEMA:
        coefficients = _mapping(tree, "coefficients", file)
        terms = paper_terms([_number(coefficients, key, file) for key in COEFFICIENTS])
    else:
        terms = _terms(tree.get("terms"), file)
    return Formula(
        name=str(tree.get("name", file)),
        source=str(tree.get("source", "")),
        sha256=hashlib.sha256(data).hexdigest(),
        terms=terms,
        outer_diameter_mm=_number(domain, "outer_diameter_mm", file),
        wall_mm=_number(domain, "wall_mm", file),
        alpha_range_deg=_interval(domain, "alpha_closed_deg", file),
        openF_range_mm=_interval(domain, "openF_mm", file),
        pressure_range_bar=_interval(domain, "pressure_bar", file),
        rubber=_rubber(domain, file) if "rubber" in domain else None,
    )


def campaign_of(data: bytes, file: str) -> Data | None:
    """Read the campaign that a formula file holds; None where it holds none.

    Raises
    ------
    BadFormula
        When the file, or its campaign, makes no sense.
    """
    tree = read_tree(data, file)
    if "campaign" not in tree:
        return None
    campaign = _mapping(tree, "campaign", file)
    alpha, openF, P = (
        _ascending(campaign, key, file) for key in ("alpha_closed_deg", "openF_mm", "pressure_bar")
    )
    rows = campaign.get("theta_deg")
    try:
        theta = np.array(rows, dtype=float)  # null becomes NaN
    except (TypeError, ValueError, OverflowError) as error:
        raise BadFormula(f'{file}: "theta_deg" is not a table of numbers') from error
    if (
        theta.shape != (len(alpha), len(openF), len(P))
        or np.abs(theta[np.isfinite(theta)]).max(initial=0.0) > _ABSURD
    ):
        raise BadFormula(f'{file}: "theta_deg" does not fit its axes')
    return Data(alpha, openF, P, theta)


def _ascending(tree: dict[str, Any], key: str, file: str) -> FloatArray:
    value = tree.get(key)
    if not isinstance(value, list) or not value:
        raise BadFormula(f'{file}: "{key}" is not a list of numbers')
    axis = np.array([_number({key: item}, key, file) for item in value])
    if np.any(np.diff(axis) <= 0.0):
        raise BadFormula(f'{file}: "{key}" does not rise')
    return axis


def _rubber(domain: dict[str, Any], file: str) -> RubberLaw:
    tree = _mapping(domain, "rubber", file)
    try:
        return read_rubber(tree)
    except ValueError as error:
        raise BadFormula(f"{file}: {error}") from error


def _terms(value: object, file: str) -> Terms:
    def rows(part: object, least: int, most: int) -> list[Any]:
        if not isinstance(part, list) or not least <= len(part) <= most:
            raise BadFormula(f'{file}: "terms" are not lists by openF, pressure and alpha')
        return part

    blocks = [rows(block, 1, _MOST_POWERS) for block in rows(value, 1, _MOST_POWERS)]
    if len({len(block) for block in blocks}) != 1:
        raise BadFormula(f'{file}: "terms" have not the same powers of the pressure throughout')
    terms = []
    for block in blocks:
        lines = []
        for row in block:
            c, b, a = (_number({"terms": v}, "terms", file) for v in rows(row, 3, 3))
            lines.append((c, b, a))
        terms.append(tuple(lines))
    return tuple(terms)


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
