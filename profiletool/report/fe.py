"""Results of finite elements as text, as JSON and as CSV."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from formula.theta import Formula, theta_deg
from profiletool.joints.misfit import misfit_to
from profiletool.records.design import Design, Misfit
from profiletool.records.fe import Verification
from profiletool.records.units import FloatArray
from profiletool.verify.cautions import cautions

_ANGLE_DECIMALS = 4  # deg: the mesh is good to a hundredth
_SIGNIFICANT = 4
FINGER_RANGE_DEG = (75.0, 100.0, 65.0)  # of the paper's finger, below 2.0 bar


def fe_json(found: Verification, more: Mapping[str, Any] | None = None) -> str:
    """Write a verification as one line of JSON; the entries of ``more`` come last."""
    states = found.states
    ended = found.critical
    tree = {
        "converged": found.converged,
        "pressure_bar": [round(p, 6) for p in found.pressures_bar],
        "theta_deg": [[round(t, _ANGLE_DECIMALS) for t in row] for row in found.theta_deg],
        "elements": found.elements,
        "nodes": found.nodes,
        "dofs": found.dofs,
        "newton_iterations": found.newton_iterations,
        "seconds": round(found.seconds, 3),
        "critical": None
        if ended is None
        else {"kind": ended.kind, "pressure_bar": round(ended.pressure_bar, 4)},
        "ahead": None
        if found.ahead is None
        else {"kind": found.ahead.kind, "pressure_bar": round(found.ahead.pressure_bar, 4)},
        "energy_error": _short(max((s.energy_error for s in states), default=0.0)),
        "residual": _short(max((s.residual for s in states), default=0.0)),
        "least_J": round(min((s.least_J for s in states), default=1.0), 4),
        "touches": any(s.touches for s in states),
        "overlap_mm": round(max((s.overlap_mm for s in states), default=0.0), 2),
        "theta_uncertain": list(found.theta_uncertain),
        "warnings": list(cautions(found)),
        "air_ml": [round(s.air_ml, 3) for s in states],
        "largest_stretch": round(found.last.largest_stretch, 3),
        "thread_N": round(found.last.thread_N, 2),
        **({} if found.failure is None else {"failure": found.failure}),
        **(more or {}),
    }
    return json.dumps(tree, allow_nan=False) + "\n"


def theta_csv(found: Verification) -> bytes:
    """Tabulate the angles of all joints against pressure, deg and bar, and the air demand, ml."""
    names = [f"theta{k + 1}_deg" for k in range(len(found.rest.theta_deg))]
    lines = [",".join(["pressure_bar", *names, "air_ml"])]
    for state in found.states:
        cells = ",".join(f"{theta:.3f}" for theta in state.theta_deg)
        lines.append(f"{state.pressure_bar:.4g},{cells},{state.air_ml:.3f}")
    return ("\n".join(lines) + "\n").encode()


def fe_text(found: Verification) -> str:
    """Lay out angles against pressure and what the run was like."""
    joints = range(1, len(found.rest.theta_deg) + 1)
    lines = [
        "theta of each joint in deg, positive toward the object; air beyond that at rest in ml",
        "   bar" + "".join(f"{_head(k, found):>8}" for k in joints) + "     air",
    ]
    for state in found.states:
        cells = "".join(f"{theta:8.1f}" for theta in state.theta_deg)
        lines.append(f"{state.pressure_bar:6.2f}{cells}{state.air_ml:8.1f}")
    last = found.last
    lines.append(
        f"at {last.pressure_bar:.2f} bar: rubber stretched {last.largest_stretch:.2f} times at "
        f"most, {last.thread_N:.1f} N in a thread at most"
    )
    lines += [f"note: {text}" for text in cautions(found)]
    lines.append(
        f"{found.elements} elements, {found.nodes} nodes, {found.dofs} unknowns, "
        f"{found.newton_iterations} Newton iterations, {found.seconds:.1f} s"
    )
    return "\n".join(lines) + "\n"


def _head(joint: int, found: Verification) -> str:
    """Head of a joint's column, marked where its angle is uncertain."""
    return f"{'~' if joint in found.theta_uncertain else ''}theta{joint}"


def off_target(found: Verification, target: FloatArray) -> Misfit:
    """Say how far the last state lies off a target's points, (N, 2) mm."""
    return misfit_to(found.last.shape, target)


def compared_text(
    design: Design, found: Verification, off: Misfit | None, target: str | None
) -> str:
    """Lay out FE's angles beside the wanted ones, and the distance off the target.

    Parameters
    ----------
    design : Design
    found : Verification
        Its last state is compared where it is at the design's pressure.
    off : Misfit or None
        None where there is no target.
    target : str or None
        Name of the file that the target was taken from.
    """
    last = found.last
    lines = []
    if abs(last.pressure_bar - design.pressure_bar) < 1e-6:
        lines.append("joint  wanted deg  formula deg  FE deg")
        lines += [
            f"{j.number:5d}  {j.signed(j.theta_target_deg):10.1f}  "
            f"{j.signed(j.theta_formula_deg):11.1f}  {theta:6.1f}"
            for j, theta in zip(design.joints, last.theta_deg, strict=True)
        ]
    if off is None:
        lines.append("no target to compare with: neither shape.csv nor the drawing lies beside it")
    else:
        lines.append(
            f"off the target ({target}) at {last.pressure_bar:.2f} bar: {off.rms_mm:.1f} mm RMS, "
            f"{off.max_mm:.1f} mm at most"
        )
    return "\n".join(lines) + "\n"


def misfit_json(off: Misfit | None, target: str | None) -> dict[str, Any]:
    """Make the entry `fit` of fe.json: distances to the target of a file, null without one."""
    if off is None:
        return {"fit": None}
    return {
        "fit": {"rms_mm": round(off.rms_mm, 4), "max_mm": round(off.max_mm, 4), "target": target}
    }


def ranges_text(found: Verification) -> str:
    """Lay out the pressures at which the finger's joints reach the paper's ranges."""
    lines = []
    for k, (angle, bar) in enumerate(zip(FINGER_RANGE_DEG, _reached(found), strict=True)):
        said = "not reached" if bar is None else f"reached at {bar:.2f} bar"
        lines.append(f"joint {k + 1}: 0 to {angle:g} deg {said} (the paper: below 2.0 bar)")
    return "\n".join(lines) + "\n"


def ranges_json(found: Verification) -> dict[str, Any]:
    """Make the entries of fe.json for the paper's ranges, deg, and the pressures, bar."""
    bars = [None if bar is None else round(bar, 3) for bar in _reached(found)]
    return {"range_deg": list(FINGER_RANGE_DEG), "range_reached_bar": bars}


def _reached(found: Verification) -> list[float | None]:
    """Pressures at which the joints reach the paper's ranges, between states by straight lines."""
    bars: list[float | None] = []
    pressures = [0.0, *found.pressures_bar]
    for angle, theta in zip(FINGER_RANGE_DEG, found.theta_deg, strict=True):
        rising = np.maximum.accumulate([0.0, *theta])
        reached = rising[-1] >= angle
        bars.append(float(np.interp(angle, rising, pressures)) if reached else None)
    return bars


def _short(value: float) -> float:
    return float(f"{value:.{_SIGNIFICANT}g}")


def formula_json(
    found: Verification, formula: Formula | None, cuts: Sequence[tuple[float, float]]
) -> dict[str, Any]:
    """Make the entry of fe.json for a formula's angles, of cuts (openF mm, alpha deg) in order."""
    if formula is None:
        return {}
    theta = [
        [round(float(theta_deg(formula, alpha, openF, bar)), _ANGLE_DECIMALS)
         for bar in found.pressures_bar]
        for openF, alpha in cuts
    ]  # fmt: skip
    return {"formula": {"name": formula.name, "theta_deg": theta}}


def formula_text(
    found: Verification, formula: Formula | None, cuts: Sequence[tuple[float, float]]
) -> str:
    """Say what a formula makes of the last state."""
    if formula is None:
        return ""
    bar = found.last.pressure_bar
    said = (f"{float(theta_deg(formula, alpha, openF, bar)):.1f}" for openF, alpha in cuts)
    return f'by the formula "{formula.name}" at {bar:.2f} bar: {", ".join(said)} deg\n'
