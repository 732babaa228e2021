"""Results as text: for the screen, as JSON and as CSV."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from formula.table import Assignment, Table
from profiletool.records import Design, Misfit

_COLUMNS = ("pressure_bar", "openF_mm", "alpha_closed_deg", "theta_deg")


def joint_table(design: Design) -> str:
    """Lay out the joints of a design as the paper's Table 5."""
    extra = [("formula deg", "theta_formula_deg")]
    if any(j.theta_response_deg is not None for j in design.joints):
        extra.append(("response deg", "theta_response_deg"))
    if design.verified:
        extra.append(("FE deg", "theta_fe_deg"))
    lines = [
        f"{design.source.file}: {_counted(len(design.joints))} at {design.pressure_bar:.2f} bar, "
        f"tube {design.tube.length_mm:.1f} mm long, root {design.tube.root_mm:.1f} mm",
        "joint    F mm  openF mm  alpha_closed deg  alpha_center deg  theta deg"
        + "".join(f"  {head}" for head, _ in extra),
    ]
    lines += [
        f"{j.number:5d}  {j.F_mm:6.1f}  {j.openF_mm:8g}  {j.alpha_closed_deg:16.4g}  "
        f"{j.alpha_center_deg:16g}  {j.theta_target_deg:9.1f}"
        + "".join(f"  {getattr(j, name):{len(head)}.1f}" for head, name in extra)
        for j in design.joints
    ]
    lines.append(f"by the formula off the profile:        {off_text(design.fit.formula)}")
    if design.fit.response is not None:
        lines.append(f"by the joint response off the profile: {off_text(design.fit.response)}")
    if design.fit.fe is not None:
        lines.append(f"by FE off the profile:                 {off_text(design.fit.fe)}")
    return "\n".join(lines) + "\n"


def off_text(misfit: Misfit) -> str:
    """Say how far a shape lies off its target."""
    return f"{misfit.rms_mm:.2f} mm RMS, {misfit.max_mm:.2f} mm at most"


def _counted(joints: int) -> str:
    return "1 joint" if joints == 1 else f"{joints} joints"


def theta_text(table: Table) -> str:
    """Lay out a theta table as the paper's Table 4, one block for each openF."""
    lines = []
    for j, openF in enumerate(table.openF_mm):
        lines.append(f"theta (deg) at openF {openF:g} mm")
        lines.append("   bar" + "".join(f"{alpha:7g}" for alpha in table.alpha_deg) + "  alpha deg")
        for i, P in enumerate(table.pressures_bar):
            cells = "".join(f"{theta:7.1f}" for theta in table.theta_deg[i, j])
            lines.append(f"{P:6.2f}{cells}")
    return "\n".join(lines) + "\n"


def theta_json(table: Table) -> str:
    """Write the cells of a theta table as a JSON list."""
    cells = [dict(zip(_COLUMNS, (*key, round(t, 4)), strict=True)) for *key, t in _cells(table)]
    return json.dumps(cells) + "\n"


def theta_csv(table: Table) -> str:
    """Write the cells of a theta table as CSV."""
    lines = [",".join(_COLUMNS)]
    lines += [
        f"{P:.2f},{openF:g},{alpha:g},{theta:.2f}" for P, openF, alpha, theta in _cells(table)
    ]
    return "\n".join(lines) + "\n"


def assignment_text(openF: Sequence[float], wanted: Sequence[float], found: Assignment) -> str:
    """Lay out the result of the look-up."""
    rows = zip(openF, wanted, found.alpha_closed_deg, found.theta_deg, strict=True)
    lines = [
        f"pressure {found.pressure_bar:.2f} bar",
        "joint  openF mm  theta deg  alpha_closed deg  formula deg",
    ]
    lines += [
        f"{number:5d}  {cut:8g}  {theta:9g}  {alpha:16g}  {got:11.1f}"
        for number, (cut, theta, alpha, got) in enumerate(rows, start=1)
    ]
    return "\n".join(lines) + "\n"


def assignment_json(found: Assignment) -> str:
    """Write the result of the look-up as JSON."""
    tree = {
        "pressure_bar": found.pressure_bar,
        "alpha_closed_deg": list(found.alpha_closed_deg),
        "theta_deg": [round(value, 4) for value in found.theta_deg],
    }
    return json.dumps(tree) + "\n"


def _cells(table: Table) -> Iterator[tuple[float, float, float, float]]:
    for i, P in enumerate(table.pressures_bar):
        for j, openF in enumerate(table.openF_mm):
            for k, alpha in enumerate(table.alpha_deg):
                yield P, openF, alpha, float(table.theta_deg[i, j, k])
