"""The report on a derived formula: the paper's Figs. 5 to 8, the residuals, and a text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps

from formula.fit import Errors
from formula.theta import Terms, theta_deg
from profiletool.campaign.derive import Derivation, formula_of
from profiletool.records.rubber import constants_text
from profiletool.records.units import FloatArray
from profiletool.report.figure import panels, png, styles
from profiletool.report.palette import BLUE, GREY, INK, RED

_NO_PAPER = "too few runs for the paper's steps"


def derivation_files(found: Derivation) -> dict[str, bytes]:
    """Draw all figures and write the residuals, by file name."""
    files = {
        "theta_vs_openF.png": draw_lines(found),
        "formula_vs_fe.png": draw_comparison(found),
        "residuals.png": draw_residuals(found),
        "residuals.csv": residuals_csv(found),
        "report.txt": derivation_text(found).encode(),
    }
    if found.paper is not None:
        files["slope_intercept_vs_pressure.png"] = draw_slopes(found)
        files["coefficients_vs_alpha.png"] = draw_coefficients(found)
    return files


def draw_lines(found: Derivation) -> bytes:
    """Draw theta against openF at every pressure, a panel each alpha, as PNG (paper, Fig. 5)."""
    data = found.data
    figure, row = _row(len(data.alpha_deg), sharey=True)
    shades = _shades(len(data.pressure_bar))
    fine = np.linspace(data.openF_mm[0], data.openF_mm[-1], 30)
    for i, (axes, alpha) in enumerate(zip(row, data.alpha_deg, strict=True)):
        for n, (P, shade) in enumerate(zip(data.pressure_bar, shades, strict=True)):
            axes.plot(fine, _theta(found, found.chosen.terms, alpha, fine, P), color=shade, lw=1.2)
            axes.plot(
                data.openF_mm, data.theta_deg[i, :, n], color=shade, marker="o", ms=3.5, ls="none",
                label=f"{P:.3g} bar",
            )  # fmt: skip
        axes.set_title(f"alpha {alpha:g} deg", fontsize=10, loc="left")
        axes.set_xlabel("openF (mm)")
    row[0].set_ylabel("θ (deg)")
    _legend(row[-1])
    return png(figure)


def draw_slopes(found: Derivation) -> bytes:
    """Draw m and c of theta = m openF + c against P, as PNG (paper, Fig. 6)."""
    fit, data = _paper(found), found.data
    figure, (left, right) = _row(2)
    fine = np.linspace(0.0, data.pressure_bar[-1], 60)
    for i, alpha in enumerate(data.alpha_deg):
        colour, marker = styles(i + 1)[i]
        style = {"color": colour, "marker": marker, "ms": 4.5, "ls": "none"}
        said = f"alpha {alpha:g} deg, R² {fit.slope_R2[i]:.4f}"
        left.plot(data.pressure_bar, fit.slope[i], label=said, **style)
        left.plot(fine, fit.a1[i] * fine**2 + fit.a2[i] * fine, color=colour, lw=1.3)
        said = f"alpha {alpha:g} deg, R² {fit.intercept_R2[i]:.4f}"
        right.plot(data.pressure_bar, fit.intercept[i], label=said, **style)
        right.plot(fine, fit.a3[i] * fine, color=colour, lw=1.3)
    left.set_ylabel("m (deg/mm) = a1 P² + a2 P")
    right.set_ylabel("c (deg) = a3 P")
    for axes in (left, right):
        axes.set_xlabel("P (bar)")
        axes.legend(fontsize=8, frameon=False)
    return png(figure)


def draw_coefficients(found: Derivation) -> bytes:
    """Draw a1, a2 and a3 against alpha, as PNG (paper, Fig. 7)."""
    fit, alpha = _paper(found), found.data.alpha_deg
    figure, row = _row(3)
    fine = np.linspace(alpha[0], alpha[-1], 60)
    c11, c12, c13, c21, c22, c23, c31, c32 = fit.coefficients
    rows = (
        ("a1 (deg/(mm bar²))", fit.a1, (c11, c12, c13), fit.a1_R2),
        ("a2 (deg/(mm bar))", fit.a2, (c21, c22, c23), fit.a2_R2),
        ("a3 (deg/bar)", fit.a3, (c31, c32), fit.a3_R2),
    )
    for axes, (label, values, curve, r2) in zip(row, rows, strict=True):
        axes.plot(alpha, values, color=BLUE, marker="o", ms=5, ls="none")
        axes.plot(fine, np.polyval(curve, fine), color=BLUE, lw=1.3, label=f"R² {r2:.4f}")
        axes.set_xlabel("alpha (deg)")
        axes.set_ylabel(label)
        axes.legend(fontsize=8, frameon=False)
    return png(figure)


def draw_comparison(found: Derivation) -> bytes:
    """Draw formulas and finite elements against P at the middle openF, as PNG (paper, Fig. 8)."""
    data = found.data
    figure, row = _row(len(data.alpha_deg), sharey=True)
    j = len(data.openF_mm) // 2
    fine = np.linspace(0.0, data.pressure_bar[-1], 60)
    for i, (axes, alpha) in enumerate(zip(row, data.alpha_deg, strict=True)):
        axes.plot(
            data.pressure_bar, data.theta_deg[i, j], color=INK, marker="o", ms=4, ls="none",
            label="finite elements",
        )  # fmt: skip
        curves = [("polynomial", found.chosen.terms, BLUE, "-")]
        if found.paper is not None:
            curves.append(("form of (9), refitted", found.paper.terms, RED, "--"))
        for label, terms, colour, style in curves:
            theta = _theta(found, terms, alpha, data.openF_mm[j], fine)
            axes.plot(fine, theta, color=colour, ls=style, lw=1.4, label=label)
        axes.set_title(f"alpha {alpha:g} deg", fontsize=10, loc="left")
        axes.set_xlabel("P (bar)")
    row[0].set_ylabel(f"θ (deg), openF {data.openF_mm[j]:g} mm")
    row[0].legend(fontsize=8, frameon=False)
    return png(figure)


def draw_residuals(found: Derivation) -> bytes:
    """Draw formula minus finite elements against P, as PNG."""
    data = found.data
    curves = [("polynomial", found.chosen.terms, found.chosen.errors)]
    if found.paper is not None and found.paper_errors is not None:
        curves.append(("form of (9), refitted", found.paper.terms, found.paper_errors))
    figure, row = _row(len(curves))
    alpha, openF, P, theta = data.points
    for axes, (label, terms, errors) in zip(row, curves, strict=True):
        off = _theta(found, terms, alpha, openF, P) - theta
        kinds = styles(len(data.alpha_deg))
        for value, (colour, marker) in zip(data.alpha_deg, kinds, strict=True):
            here = alpha == value
            axes.plot(
                P[here], off[here], color=colour, ls="none", ms=4, marker=marker,
                label=f"alpha {value:g} deg",
            )  # fmt: skip
        axes.axhline(0.0, color=GREY, lw=0.8)
        axes.set_title(
            f"{label}: {errors.rms:.2f} deg RMS, {errors.largest:.2f} at most",
            fontsize=10, loc="left",
        )  # fmt: skip
        axes.set_xlabel("P (bar)")
        axes.set_ylabel("formula - finite elements (deg)")
    _legend(row[-1])
    return png(figure)


def residuals_csv(found: Derivation) -> bytes:
    """Tabulate finite elements, both formulas and the joint's rigid motion."""
    data = found.data
    rows = [
        "alpha_closed_deg,openF_mm,pressure_bar,theta_fe_deg,theta_formula_deg,"
        "theta_paper_form_deg,dx_mm,dy_mm"
    ]
    for i, alpha in enumerate(data.alpha_deg):
        for j, openF in enumerate(data.openF_mm):
            for n, P in enumerate(data.pressure_bar):
                at = (alpha, openF, P)
                paper = None if found.paper is None else _theta(found, found.paper.terms, *at)
                cells = [
                    data.theta_deg[i, j, n], _theta(found, found.chosen.terms, *at), paper,
                    found.dx_mm[i, j, n], found.dy_mm[i, j, n],
                ]  # fmt: skip
                rows.append(
                    f"{alpha:g},{openF:g},{P:.6g}," + ",".join(_cell(value) for value in cells)
                )
    return ("\n".join(rows) + "\n").encode()


def derivation_text(found: Derivation) -> str:
    """Lay out what was run, and the errors of each form."""
    plan, data = found.plan, found.data
    runs = int(np.isfinite(found.made.theta_deg).any(axis=2).sum())
    cells = int(np.isfinite(data.theta_deg).sum())
    lines = [
        f"tube {plan.diameter_mm:g} x {plan.wall_mm:g} mm, {plan.rubber.name}: "
        f"{constants_text(plan.rubber.record)}",
        f"{runs} joints run, {cells} angles fitted, up to {plan.pressures_bar[-1]:g} bar",
    ]
    if found.base is not None:
        lines.append(f'from the campaign of "{found.base.formula.name}", brought onto these runs')
    lines += [
        f"alpha {alpha:g} deg, openF {openF:g} mm ended early: {why}"
        for alpha, openF, why in found.failures
    ]
    lines.append("")
    lines.append("polynomials by cross-validation (each run predicted from the others), deg")
    lines.append("openF  P  alpha  terms   RMS    max  validated RMS    max")
    for form in found.forms:
        J, K, I = form.powers  # noqa: E741
        mark = "  <- taken" if form is found.chosen else ""
        lines.append(
            f"{J:5d}  {K}  {I:5d}  {form.size:5d}  {form.errors.rms:4.2f}  "
            f"{form.errors.largest:5.2f}  {form.validated.rms:13.2f}  "
            f"{form.validated.largest:5.2f}{mark}"
        )
    lines.append("")
    if found.paper is None or found.paper_errors is None:
        lines.append(_NO_PAPER)
    else:
        fit = found.paper
        lines.append(
            f"formula (9) refitted: {found.paper_errors.rms:.2f} deg RMS, "
            f"{found.paper_errors.largest:.2f} at most; R² of theta(openF) >= "
            f"{np.nanmin(fit.line_R2):.4f}, m(P) >= {np.nanmin(fit.slope_R2):.4f}, c(P) >= "
            f"{np.nanmin(fit.intercept_R2):.4f}, a1, a2, a3 (alpha) {fit.a1_R2:.4f} "
            f"{fit.a2_R2:.4f} {fit.a3_R2:.4f}"
        )
        names = ("c11", "c12", "c13", "c21", "c22", "c23", "c31", "c32")
        lines.append(
            "  ".join(f"{n} {v:.6f}" for n, v in zip(names, fit.coefficients, strict=True))
        )
    lines.append("")
    lines += _by_pressure(found)
    return "\n".join(lines) + "\n"


def _by_pressure(found: Derivation) -> list[str]:
    columns: list[tuple[str, Errors]] = [("polynomial", found.chosen.errors)]
    if found.paper_errors is not None:
        columns.append(("form of (9)", found.paper_errors))
    lines = ["  bar" + "".join(f"  {name:>11} RMS    max" for name, _ in columns)]
    for n, P in enumerate(found.data.pressure_bar):
        cells = (errors.by_pressure[n] for _, errors in columns)
        lines.append(f"{P:5.2f}" + "".join(f"  {rms:15.2f}  {most:5.2f}" for rms, most in cells))
    return lines


def _paper(found: Derivation) -> Any:
    if found.paper is None:
        raise ValueError(_NO_PAPER)
    return found.paper


def _theta(found: Derivation, terms: Terms, alpha: Any, openF: Any, P: Any) -> FloatArray:
    return theta_deg(formula_of(found.plan, terms), alpha, openF, P)


def _cell(value: Any) -> str:
    return "" if value is None or not np.isfinite(value) else f"{float(value):.4f}"


def _row(count: int, *, sharey: bool = False) -> tuple[Any, Sequence[Any]]:
    return panels(count, min(3.1 * count, 15.0) if count > 3 else 5.0 * count, 4.2, sharey=sharey)


def _legend(axes: Any) -> None:
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, fontsize=8.5)


def _shades(count: int) -> list[Any]:
    return [colormaps["viridis"](v) for v in np.linspace(0.0, 0.88, count)]
