"""The theta table (the paper's Table 4) and the design look-up in it (its Section 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formula.errors import OutOfRange
from formula.theta import Formula, beyond, check_range, theta_deg

# Rows and columns of Table 4.
PRESSURES_BAR = (0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 2.0)
OPENF_MM = (6.0, 8.0, 10.0)
ALPHA_DEG = (84.0, 96.0, 108.0, 120.0, 132.0, 144.0, 156.0, 168.0)

_SLACK_DEG = 1e-9  # a cell equal to the wanted angle counts as reaching it


@dataclass(frozen=True)
class Table:
    """Angles over pressure, openF and alpha, laid out as the paper's Table 4.

    Attributes
    ----------
    pressures_bar, openF_mm, alpha_deg : tuple of float
        Ascending.
    theta_deg : (pressures, openF, alpha) array
        Bending angles, deg.
    beyond : (pressures, openF, alpha) array of bool
        Where the formula is extrapolated.
    """

    pressures_bar: tuple[float, ...]
    openF_mm: tuple[float, ...]
    alpha_deg: tuple[float, ...]
    theta_deg: NDArray[np.float64]
    beyond: NDArray[np.bool_]


@dataclass(frozen=True)
class Assignment:
    """The cells that the look-up chose: one row, and for each joint a column.

    Attributes
    ----------
    pressure_bar : float
        Common to all joints, bar.
    alpha_closed_deg, theta_deg : tuple of float
        Uncut sector and angle of each joint, deg.
    beyond : tuple of bool
        Whether each joint's cell is extrapolated.
    """

    pressure_bar: float
    alpha_closed_deg: tuple[float, ...]
    theta_deg: tuple[float, ...]
    beyond: tuple[bool, ...]


def make_table(
    formula: Formula,
    openF_mm: Sequence[float] | None = None,
    pressures_bar: Sequence[float] | None = None,
    alpha_deg: Sequence[float] | None = None,
) -> Table:
    """Tabulate a formula.

    Parameters
    ----------
    formula : Formula
    openF_mm, pressures_bar, alpha_deg : sequence of float, optional
        Rows and columns; by default those of the paper's Table 4, as far as the formula's range
        goes. mm, bar and deg.

    Returns
    -------
    Table

    Raises
    ------
    OutOfRange
        When a row or column that was asked for lies outside the range of the formula, or none
        of the default ones lies inside.
    """
    openF_mm = _default(OPENF_MM, formula.openF_range_mm) if openF_mm is None else openF_mm
    if pressures_bar is None:
        pressures_bar = _default(PRESSURES_BAR, formula.pressure_range_bar)
    alpha_deg = _default(ALPHA_DEG, formula.alpha_range_deg) if alpha_deg is None else alpha_deg
    check_range(formula, "openF", "mm", openF_mm, formula.openF_range_mm)
    check_range(formula, "pressure", "bar", pressures_bar, formula.pressure_range_bar)
    check_range(formula, "alpha", "deg", alpha_deg, formula.alpha_range_deg)
    P, openF, alpha = (np.unique(np.asarray(v)) for v in (pressures_bar, openF_mm, alpha_deg))
    at = (alpha, openF[:, None], P[:, None, None])
    return Table(
        tuple(P.tolist()),
        tuple(openF.tolist()),
        tuple(alpha.tolist()),
        theta_deg(formula, *at),
        beyond(formula, *at),
    )


def assign(
    table: Table, openF_mm: Sequence[float], theta_wanted_deg: Sequence[float]
) -> Assignment:
    """Choose the common pressure and each joint's alpha by the paper's look-up (Section 4).

    The joint with the largest angle (of equals the one with the shortest cut) sets the pressure:
    of the cells of its openF block at or above the wanted angle the one with the least excess.
    Every joint then takes, in that row and its own block, the cell at or above its angle with
    the least excess. Where the paper is silent, because that row leaves another joint short,
    the next cell in order of excess is tried.

    Parameters
    ----------
    table : Table
    openF_mm, theta_wanted_deg : sequence of float
        Length of the cut, mm, and wanted angle, deg, of each joint.

    Returns
    -------
    Assignment

    Raises
    ------
    OutOfRange
        When an openF is not in the table, or no row reaches all angles.
    """
    blocks = [_block(table, openF) for openF in openF_mm]
    order = sorted(range(len(blocks)), key=lambda i: (-theta_wanted_deg[i], openF_mm[i]))
    lead = order[0]
    for i in order:
        best = float(table.theta_deg[:, blocks[i]].max())
        if best < theta_wanted_deg[i] - _SLACK_DEG:
            raise OutOfRange(
                f"joint {i + 1}: {theta_wanted_deg[i]:.1f} deg is more than openF "
                f"{openF_mm[i]:g} mm reaches up to {table.pressures_bar[-1]:g} bar "
                f"({best:.1f} deg); a longer cut or a smaller angle is needed"
            )
    for row in _rows_by_excess(table.theta_deg[:, blocks[lead]], theta_wanted_deg[lead]):
        cells = [
            _least_excess(table.theta_deg[row, block], theta)
            for block, theta in zip(blocks, theta_wanted_deg, strict=True)
        ]
        if all(cell is not None for cell in cells):
            chosen = [
                (block, cell) for block, cell in zip(blocks, cells, strict=True) if cell is not None
            ]
            return Assignment(
                pressure_bar=table.pressures_bar[row],
                alpha_closed_deg=tuple(table.alpha_deg[cell] for _, cell in chosen),
                theta_deg=tuple(float(table.theta_deg[row, block, cell]) for block, cell in chosen),
                beyond=tuple(bool(table.beyond[row, block, cell]) for block, cell in chosen),
            )
    raise OutOfRange("no single pressure of the table reaches the angles of all joints")


def _default(values: Sequence[float], limits: tuple[float, float]) -> list[float]:
    inside = [value for value in values if limits[0] <= value <= limits[1]]
    if not inside:
        raise OutOfRange(
            f"none of {', '.join(f'{value:g}' for value in values)} lies within the "
            f"{limits[0]:g} to {limits[1]:g} that the formula holds for; name others"
        )
    return inside


def _block(table: Table, openF: float) -> int:
    for index, value in enumerate(table.openF_mm):
        if abs(value - openF) < 1e-9:
            return index
    blocks = ", ".join(f"{value:g}" for value in table.openF_mm)
    raise OutOfRange(f"openF {openF:g} mm is not in the table (it has {blocks})")


def _rows_by_excess(block: NDArray[np.float64], wanted: float) -> list[int]:
    """Rows of a (pressure, alpha) block, the least excess first, of equals the lowest pressure."""
    excess = np.where(block >= wanted - _SLACK_DEG, block - wanted, np.inf).min(axis=1)
    order = np.argsort(excess, kind="stable")
    return [int(row) for row in order if np.isfinite(excess[row])]


def _least_excess(cells: NDArray[np.float64], wanted: float) -> int | None:
    excess = np.where(cells >= wanted - _SLACK_DEG, cells - wanted, np.inf)
    best = int(np.argmin(excess))
    return best if np.isfinite(excess[best]) else None
