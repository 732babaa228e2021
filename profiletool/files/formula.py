"""Formula files, read with this project's errors."""

from __future__ import annotations

from pathlib import Path

from formula.errors import BadFormula
from formula.files import load_formula
from formula.theta import Formula, widened
from profiletool.errors import UnreadableInput
from profiletool.records.request import Request
from profiletool.records.rubber import law_of, usual_rubber

_OWN = Path("fe")  # ours for the paper's tube
_PAPER_SIZES = (20.0, 2.0)


def formula_for(request: Request) -> Formula:
    """Read the formula for the angles of a request's table.

    Where none is asked for, that is ours where joints are chosen by the joint response, which it
    goes with, and the tube is the paper's; else the paper's, equation (9).

    Raises
    ------
    UnreadableInput
        As `read_formula`.
    """
    tube = request.tube
    sizes = (tube.outer_diameter_mm, tube.wall_mm)
    own = request.method == "optimal" and sizes == _PAPER_SIZES and usual_rubber(tube.rubber)
    path = _OWN if request.formula is None and own else request.formula
    return read_formula(path, request.extrapolate)


def named_formula(name: str) -> Formula:
    """Read the formula that a design was made with: ours by its name, else the paper's."""
    return read_formula(_OWN if name == _OWN.name else None)


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
