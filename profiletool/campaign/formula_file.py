"""The formula file of a derivation."""

from __future__ import annotations

import json

import numpy as np

from formula.files import POLYNOMIAL
from formula.theta import COEFFICIENTS
from profiletool.campaign.derive import Base, Derivation
from profiletool.records.units import FloatArray


def formula_file(found: Derivation, name: str) -> bytes:
    """Write a derivation as a formula file; the same derivation gives the same bytes.

    Parameters
    ----------
    found : Derivation
    name : str
        Of the formula.

    Returns
    -------
    bytes
        JSON that `formula.files.parse_formula` reads, the campaign in it.
    """
    plan, law = found.plan, found.plan.rubber.law
    tree = {
        "schema": POLYNOMIAL,
        "name": name,
        "source": _source(found),
        "powers": dict(zip(("openF", "pressure", "alpha"), found.chosen.powers, strict=True)),
        "terms": found.chosen.terms,
        "domain": {
            "outer_diameter_mm": plan.diameter_mm,
            "wall_mm": plan.wall_mm,
            "rubber": {
                "name": plan.rubber.name,
                "law": law.name,
                "constants": dict(law.constants),
            },
            "alpha_closed_deg": [plan.alpha_deg[0], plan.alpha_deg[-1]],
            "openF_mm": [plan.openF_mm[0], plan.openF_mm[-1]],
            "pressure_bar": [0.0, plan.pressures_bar[-1]],
        },
        "fit": {
            "rms_deg": _deg(found.chosen.errors.rms),
            "max_deg": _deg(found.chosen.errors.largest),
            "cross_validated_rms_deg": _deg(found.chosen.validated.rms),
            "cross_validated_max_deg": _deg(found.chosen.validated.largest),
        },
        "paper_form": _paper_form(found),
        "base": None if found.base is None else _base(found.base),
        "failures": [
            {"alpha_closed_deg": a, "openF_mm": o, "reason": why} for a, o, why in found.failures
        ],
        "campaign": {
            "model": plan.model,
            "runs": int(np.isfinite(found.made.theta_deg).any(axis=2).sum()),
            "alpha_closed_deg": plan.alpha_deg,
            "openF_mm": plan.openF_mm,
            "pressure_bar": plan.pressures_bar,
            "theta_deg": _rows(found.data.theta_deg),
            "dx_mm": _rows(found.dx_mm),
            "dy_mm": _rows(found.dy_mm),
        },
    }
    return (json.dumps(tree, indent=1, allow_nan=False) + "\n").encode()


def _source(found: Derivation) -> str:
    runs = int(np.isfinite(found.made.theta_deg).any(axis=2).sum())
    plan = found.plan
    told = (
        f"profiletool derive: finite elements of {runs} joints, tube {plan.diameter_mm:g} x "
        f"{plan.wall_mm:g} mm, {plan.rubber.name} ({plan.rubber.source})"
    )
    if found.base is not None:
        told += f', from the campaign of "{found.base.formula.name}" by similarity'
    return told + (", modelled as the paper did" if plan.model == "paper" else "")


def _paper_form(found: Derivation) -> dict[str, object] | None:
    fit, errors = found.paper, found.paper_errors
    if fit is None or errors is None:
        return None
    return {
        "coefficients": dict(zip(COEFFICIENTS, fit.coefficients, strict=True)),
        "rms_deg": _deg(errors.rms),
        "max_deg": _deg(errors.largest),
        "R2": {
            "theta_openF_least": _r2(np.nanmin(fit.line_R2)),
            "m_P": [_r2(v) for v in fit.slope_R2],
            "c_P": [_r2(v) for v in fit.intercept_R2],
            "a1_alpha": _r2(fit.a1_R2),
            "a2_alpha": _r2(fit.a2_R2),
            "a3_alpha": _r2(fit.a3_R2),
        },
    }


def _base(base: Base) -> dict[str, str]:
    return {"name": base.formula.name, "sha256": base.formula.sha256}


def _rows(values: FloatArray) -> list[list[list[float | None]]]:
    return [
        [[round(v, 6) if np.isfinite(v) else None for v in line] for line in block]
        for block in values.tolist()
    ]


def _deg(value: float) -> float:
    return round(value, 4)


def _r2(value: float) -> float | None:
    return round(float(value), 6) if np.isfinite(value) else None
