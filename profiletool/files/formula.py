"""Formula files, read with this project's errors."""

from __future__ import annotations

from pathlib import Path

from formula.errors import BadFormula
from formula.files import load_formula
from formula.theta import Formula, widened
from profiletool.errors import UnreadableInput
from profiletool.records.rubber import law_of


def read_formula(path: Path | None, extrapolate: bool = False) -> Formula:
    """Read a formula file, or the paper's formula; let it be extrapolated or not.

    Raises
    ------
    UnreadableInput
        When the file holds no formula, or one for a rubber that cannot be.
    """
    try:
        formula = load_formula(path)
    except BadFormula as error:
        raise UnreadableInput(str(error)) from error
    try:
        law_of(formula.rubber)
    except ValueError as error:
        raise UnreadableInput(f"{path}: domain.rubber: {error}") from error
    return widened(formula) if extrapolate else formula
