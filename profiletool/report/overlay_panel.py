"""The overlay's panel: facts about the design, its joints, the legend and the notes."""

from __future__ import annotations

import textwrap
from typing import Any

from profiletool.records.built import mm_text
from profiletool.records.design import Design, Joint
from profiletool.records.seal import proven
from profiletool.report.palette import GREY, INK, RED
from profiletool.report.scene import Scene
from profiletool.report.text import scale_text


def draw_panel(axes: Any, scene: Scene) -> None:
    """Draw the panel on axes of its own; the legend is that of the figure's first axes."""
    design = scene.design
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    axes.set_axis_off()
    y = 0.955
    name = _short(design.source.file, 30)
    axes.text(0.03, y, name, fontsize=15, weight="bold", color=INK, parse_math=False)
    for text, colour in _status(design):
        y -= 0.032
        axes.text(0.03, y, text, fontsize=10.5, weight="bold", color=colour)
    for text in _facts(design):
        y -= 0.029
        axes.text(0.03, y, text, fontsize=10, color=INK)
    y = _draw_table(axes, design, y - 0.05)
    y = _draw_legend(axes, scene, y)
    _draw_warnings(axes, design, y)


def _status(design: Design) -> list[tuple[str, str]]:
    lines = []
    if not design.feasible:
        lines.append(("INFEASIBLE: best attempt", RED))
    off = design.fit.fe
    if not proven(design):
        lines.append(("NOT VERIFIED by FE", RED))
    elif off is not None:
        lines.append((f"verified by FE: {off.rms_mm:.2f} mm RMS with perfect parts", INK))
        if design.built is not None:
            expected = design.built.expected_rms_mm
            as_set, trimmed = (mm_text(mm, 1) for mm in (expected.as_set, expected.trimmed))
            said = f"built: {as_set} mm as set, {trimmed} mm pressure set"
            lines.append((said, INK))
    return lines


def _facts(design: Design) -> list[str]:
    tube, source, fit = design.tube, design.source, design.fit
    scale = "" if source.mm_per_px is None else f"  ({scale_text(source)})"
    off = [] if fit.fe is None else [("FE off the profile", fit.fe)]
    if fit.response is not None:
        off.append(("joint response off the profile", fit.response))
    off.append(("formula off the profile", fit.formula))
    return [
        f"operating pressure {design.pressure_bar:.2f} bar",
        f"tube {tube.outer_diameter_mm:g} x {tube.wall_mm:g} mm, {tube.length_mm:.1f} mm long, "
        f"root {tube.root_mm:.1f} mm",
        f"{source.side} side, {source.profile_length_mm:.1f} mm to follow",
        f"scale from {source.scale_source}{scale}",
        *(f"{by}: {m.rms_mm:.2f} mm RMS, {m.max_mm:.1f} at most" for by, m in off),
    ]


def _draw_table(axes: Any, design: Design, y: float) -> float:
    columns: tuple[float, ...] = (0.06, 0.22, 0.40, 0.58, 0.75, 0.92)
    heads: tuple[str, ...] = ("joint", "F\nmm", "openF\nmm", "α closed\n°", "α center\n°", "θ\n°")
    if proven(design):
        columns = (0.06, 0.18, 0.32, 0.47, 0.62, 0.79, 0.93)
        heads = (*heads[:5], "θ formula\n°", "θ FE\n°")
    for x, head in zip(columns, heads, strict=True):
        axes.text(x, y, head, fontsize=9, color=GREY, ha="center", va="center", linespacing=1.3)
    y -= 0.027
    axes.plot([0.02, 0.98], [y, y], color=INK, lw=0.8)
    step = min(0.027, 0.30 / len(design.joints))
    for joint in design.joints:
        y -= step
        cells = (
            f"{joint.number}", f"{joint.F_mm:.1f}", f"{joint.openF_mm:g}",
            f"{joint.alpha_closed_deg:.4g}", f"{joint.alpha_center_deg:g}",
            *((f"{joint.signed(joint.theta_formula_deg):.1f}",) if proven(design) else ()),
            f"{joint.signed(best_theta_deg(joint)):.1f}",
        )  # fmt: skip
        for x, cell in zip(columns, cells, strict=True):
            axes.text(x, y, cell, fontsize=10, color=INK, ha="center", va="center")
    return y - 0.022


def _draw_legend(axes: Any, scene: Scene, y: float) -> float:
    main = axes.figure.axes[0]
    handles, labels = main.get_legend_handles_labels()
    legend = axes.legend(
        handles, labels, loc="upper left", bbox_to_anchor=(0.0, y), fontsize=9.5, frameon=False,
        handlelength=2.6, labelspacing=0.45,
    )  # fmt: skip
    for line in legend.get_lines():
        line.set_path_effects([])
    return y - 0.0235 * len(labels) - 0.03


def _draw_warnings(axes: Any, design: Design, y: float) -> None:
    for shown, warning in enumerate(design.warnings):
        lines = textwrap.wrap("• " + warning, 58, subsequent_indent="   ")
        height = 0.0205 * len(lines)
        if y - height < 0.02:
            axes.text(
                0.03,
                y,
                f"• {len(design.warnings) - shown} more in design.json",
                fontsize=8.5,
                color=GREY,
                va="top",
            )
            return
        axes.text(0.03, y, "\n".join(lines), fontsize=8.5, color=GREY, va="top", linespacing=1.25)
        y -= height + 0.008


def _short(text: str, most: int) -> str:
    return text if len(text) <= most else text[: most - 1] + "…"


def best_theta_deg(joint: Joint) -> float:
    """Angle of a joint by the best model that was asked: FE, joint response or formula."""
    known = (joint.theta_fe_deg, joint.theta_response_deg, joint.theta_formula_deg)
    return next(theta for theta in known if theta is not None)
