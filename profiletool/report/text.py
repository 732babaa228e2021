"""Results as text: for the screen, as JSON and as CSV."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from formula.table import Assignment, Table
from profiletool.records.design import Source, named

EXTRAPOLATED = "beyond what the formula was fitted on: extrapolated"
_COLUMNS = ("pressure_bar", "openF_mm", "alpha_closed_deg", "theta_deg")


def scale_text(source: Source, digits: int = 4) -> str:
    """Tell a picture's scale, with its error where that was measured."""
    error = source.scale_error_share
    within = "" if error is None else f", within {100.0 * error:.2g} %"
    return f"{source.mm_per_px:.{digits}g} mm per pixel{within}"


def theta_text(table: Table) -> str:
    """Lay out a theta table as the paper's Table 4, one block for each openF."""
    lines = []
    for j, openF in enumerate(table.openF_mm):
        lines.append(f"theta (deg) at openF {openF:g} mm")
        lines.append("   bar" + "".join(f"{alpha:7g}" for alpha in table.alpha_deg) + "  alpha deg")
        for i, P in enumerate(table.pressures_bar):
            cells = zip(table.theta_deg[i, j], table.beyond[i, j], strict=True)
            row = "".join(f"{f'{theta:.1f}' + ('*' if out else ''):>7}" for theta, out in cells)
            lines.append(f"{P:6.2f}{row}")
    if table.beyond.any():
        lines.append(f"* {EXTRAPOLATED}")
    return "\n".join(lines) + "\n"


def theta_json(table: Table) -> str:
    """Write the cells of a theta table as a JSON list."""
    cells = []
    for P, openF, alpha, theta, out in _cells(table):
        cell: dict[str, object] = dict(
            zip(_COLUMNS, (P, openF, alpha, round(theta, 4)), strict=True)
        )
        cells.append({**cell, "extrapolated": True} if out else cell)
    return json.dumps(cells) + "\n"


def theta_csv(table: Table) -> str:
    """Write the cells of a theta table as CSV, with a column more where some are extrapolated."""
    more = bool(table.beyond.any())
    lines = [",".join((*_COLUMNS, "extrapolated") if more else _COLUMNS)]
    lines += [
        f"{P:.2f},{openF:g},{alpha:g},{theta:.2f}" + (f",{out:d}" if more else "")
        for P, openF, alpha, theta, out in _cells(table)
    ]
    return "\n".join(lines) + "\n"


def assignment_text(openF: Sequence[float], wanted: Sequence[float], found: Assignment) -> str:
    """Lay out joints of given cuts, mm, wanted angles, deg, and what the formula assigns."""
    rows = zip(openF, wanted, found.alpha_closed_deg, found.theta_deg, strict=True)
    lines = [
        f"pressure {found.pressure_bar:.2f} bar",
        "joint  openF mm  theta deg  alpha_closed deg  formula deg",
    ]
    lines += [
        f"{number:5d}  {cut:8g}  {theta:9g}  {alpha:16g}  {got:11.1f}"
        for number, (cut, theta, alpha, got) in enumerate(rows, start=1)
    ]
    lines += [f"note: {warning}" for warning in _assignment_warnings(found)]
    return "\n".join(lines) + "\n"


def assignment_json(found: Assignment) -> str:
    """Write what the formula assigns as JSON."""
    tree: dict[str, object] = {
        "pressure_bar": found.pressure_bar,
        "alpha_closed_deg": list(found.alpha_closed_deg),
        "theta_deg": [round(value, 4) for value in found.theta_deg],
    }
    warnings = _assignment_warnings(found)
    return json.dumps({**tree, "warnings": warnings} if warnings else tree) + "\n"


def _assignment_warnings(found: Assignment) -> list[str]:
    out = [number for number, beyond in enumerate(found.beyond, start=1) if beyond]
    return [f"{named(out)}: {EXTRAPOLATED}"] if out else []


def _cells(table: Table) -> Iterator[tuple[float, float, float, float, bool]]:
    for i, P in enumerate(table.pressures_bar):
        for j, openF in enumerate(table.openF_mm):
            for k, alpha in enumerate(table.alpha_deg):
                cell = float(table.theta_deg[i, j, k]), bool(table.beyond[i, j, k])
                yield P, openF, alpha, *cell
