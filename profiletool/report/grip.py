"""The finger on its object as text, JSON, CSV and pictures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from profiletool.profile.shape_csv import shape_csv
from profiletool.records.grip import Grip, GripState, LetGo, Payload
from profiletool.records.grip_request import GripRequest
from profiletool.records.units import FloatArray
from profiletool.report.figure import WIDE_IN, legend_below, panels, png, titled
from profiletool.report.palette import BLUE, GREEN, GREY, INK, ORANGE
from profiletool.report.registry import Writers

_DEEP_MM = 0.02  # in the object, that is told
_COLUMNS = (
    "pressure_bar", "normal_N", "radial_N", "axial_N", "peak_kPa", "mean_kPa", "contact_share",
    "misfit_rms_mm", "misfit_max_mm", "depth_mm",
)  # fmt: skip
_DECIMALS = 4


@dataclass(frozen=True)
class GripOutput:
    """All that the files of a grip are written from.

    Attributes
    ----------
    found : Grip
    asked : GripRequest
    target : (N, 2) mm
        The profile.
    told : str
        The grip as JSON, as it is printed.
    """

    found: Grip
    asked: GripRequest
    target: FloatArray
    told: str


def grip_json(found: Grip) -> str:
    """Write a grip as one line of JSON."""
    states, payload = found.states, found.payload

    def column(name: str) -> list[float]:
        return [round(getattr(state, name), _DECIMALS) for state in states]

    joints = range(len(states[0].joint_normal_N) if states else 0)
    first = found.first_touch_bar
    tree: dict[str, Any] = {
        "converged": found.converged,
        **{name: column(name) for name in _COLUMNS},
        "joint_normal_N": [
            [round(state.joint_normal_N[k], _DECIMALS) for state in states] for k in joints
        ],
        "clamped_N": column("clamped_N"),
        "clamp_N": [[round(value, _DECIMALS) for value in state.clamp_N] for state in states],
        "first_touch_bar": None if first is None else round(first, _DECIMALS),
        "object": found.solid,
        "let_go": _let_go_tree(states),
        "payload_N": None if payload is None else _payload_tree(payload),
        "energy_error": float(f"{max((s.energy_error for s in states), default=0.0):.4g}"),
        "factorisations": found.factorisations,
        "seconds": round(found.seconds, 3),
        "warnings": list(cautions(found)),
        **({} if found.failure is None else {"failure": found.failure}),
    }
    return json.dumps(tree, allow_nan=False) + "\n"


def _let_go_tree(states: Sequence[GripState]) -> dict[str, list[Any]] | None:
    """Tell where the object goes: null in ``moved_mm`` where it does not come to rest."""
    let = [state.let_go for state in states if state.let_go is not None]
    if not let:
        return None
    return {
        "end": [one.end for one in let],
        "moved_mm": [round(one.moved_mm, _DECIMALS) if one.end == "rests" else None for one in let],
        "normal_N": [round(one.normal_N, _DECIMALS) for one in let],
    }


def _payload_tree(payload: Payload) -> dict[str, Any]:
    return {
        "fingers": payload.fingers,
        "pressure_bar": round(payload.pressure_bar, _DECIMALS),
        "friction": list(payload.friction),
        "N": [round(load, _DECIMALS) for load in payload.load_N],
        "tilt_Nmm": [round(moment, 2) for moment in payload.tilt_Nmm],
        "undercut_N": round(payload.undercut_N, _DECIMALS),
    }


def cautions(found: Grip, most_kPa: float | None = None) -> tuple[str, ...]:
    """Say what the numbers of a grip are not to be trusted for, or what bears too little."""
    told = []
    deep = [s for s in found.states if s.depth_mm > _DEEP_MM]
    if deep:
        worst = max(deep, key=lambda s: s.depth_mm)
        told.append(
            f"at {worst.pressure_bar:.2f} bar the finger lies {worst.depth_mm:.2f} mm in the "
            "object, more than it should"
        )
    if most_kPa is not None:
        over = [s for s in found.states if s.peak_kPa > most_kPa]
        if over:
            told.append(
                f"from {over[0].pressure_bar:.2f} bar on the contact pressure is above the "
                f"{most_kPa:g} kPa that the object bears"
            )
    return tuple(told)


def grip_text(found: Grip, asked: GripRequest) -> str:
    """Lay out forces against pressure, and what the fingers carry."""
    lines = [
        f"{_met(found)}, rigid; forces of one finger on it in N",
        "   bar  normal  radial   axial  peak kPa  touches %  misfit mm RMS   max",
    ]
    lines += [
        f"{s.pressure_bar:6.2f}{s.normal_N:8.2f}{s.radial_N:8.2f}{s.axial_N:8.2f}"
        f"{s.peak_kPa:10.0f}{100.0 * s.contact_share:11.0f}{s.misfit_rms_mm:15.2f}"
        f"{s.misfit_max_mm:6.2f}"
        for s in found.states
    ]
    if found.first_touch_bar is not None:
        lines.append(f"the free finger comes to the object at {found.first_touch_bar:.2f} bar")
    if found.states:
        last = found.states[-1]
        by_joint = ", ".join(f"{force:.2f}" for force in last.joint_normal_N)
        lines.append(f"normal force joint by joint at {last.pressure_bar:.2f} bar: {by_joint} N")
    lines += [_let_go_line(s.let_go, s.pressure_bar) for s in found.states if s.let_go is not None]
    if found.payload is not None:
        lines += _payload_lines(found.payload)
    lines += [f"note: {text}" for text in cautions(found, asked.max_contact_kpa)]
    lines.append(f"{found.factorisations} factorisations, {found.seconds:.1f} s")
    return "\n".join(lines) + "\n"


def _let_go_line(let: LetGo, bar: float) -> str:
    """Say where the object goes that is let go at a pressure."""
    way = "up" if let.moved_mm > 0.0 else "down"
    if let.end == "rests":
        went = f"moves {abs(let.moved_mm):.2f} mm {way} and rests, {let.normal_N:.2f} N on a finger"
    elif let.end == "leaves":
        went = f"leaves the fingers, {way}"
    else:
        went = f"goes {way}; no equilibrium was found beyond {abs(let.moved_mm):.1f} mm"
    return f"let go at {bar:.2f} bar, it {went}"


def _met(found: Grip) -> str:
    """Name what the finger meets."""
    own = found.solid in ("turned", "extruded")
    return f"the object: its profile {found.solid}" if own else f"against a {found.solid}"


def _payload_lines(payload: Payload) -> list[str]:
    alone = payload.undercut_N
    without = f"carry {alone:.2f} N" if alone >= 0.0 else f"push the object out with {-alone:.2f} N"
    rows = zip(payload.friction, payload.load_N, payload.tilt_Nmm, strict=True)
    return [
        f"{payload.fingers} fingers at {payload.pressure_bar:.2f} bar; without friction they "
        f"{without}",
        "friction  payload N  tilting moment N mm",
        *(f"{mu:8.2f}{load:11.2f}{tilt:21.0f}" for mu, load, tilt in rows),
    ]


def grip_csv(found: Grip) -> bytes:
    """Tabulate forces, pressures and misfit against pressure."""
    joints = range(len(found.states[0].joint_normal_N) if found.states else 0)
    lines = [",".join([*_COLUMNS, *(f"joint{k + 1}_normal_N" for k in joints)])]
    for state in found.states:
        cells = [getattr(state, name) for name in _COLUMNS] + list(state.joint_normal_N)
        lines.append(",".join(f"{value:.4g}" for value in cells))
    return ("\n".join(lines) + "\n").encode()


def force_figure(found: Grip) -> Figure:
    """Draw forces and the distance to the profile against pressure."""
    figure, (forces, misfit) = panels(2, WIDE_IN, 5.6, below=True)
    bars = [s.pressure_bar for s in found.states]
    rows = (
        ("normal", "normal_N", INK, "o"), ("toward the axis", "radial_N", BLUE, "s"),
        ("along the axis, up", "axial_N", ORANGE, "^"),
    )  # fmt: skip
    for label, name, colour, marker in rows:
        forces.plot(
            bars, [getattr(s, name) for s in found.states], color=colour, marker=marker, ms=4.5,
            lw=1.6, label=label,
        )  # fmt: skip
    forces.axhline(0.0, color=GREY, lw=0.8)
    forces.set_ylabel("force of one finger (N)")
    misfit.plot(
        bars, [s.misfit_rms_mm for s in found.states], color=GREEN, marker="D", ms=4.5, lw=1.6
    )
    misfit.set_ylim(bottom=0.0)
    misfit.set_ylabel("off the profile (mm RMS)")
    misfit.set_xlabel("pressure (bar)")
    legend_below(figure, forces, 3)
    return figure


def pressure_figure(found: Grip, target: FloatArray) -> Figure:
    """Draw the object with the finger on it, and the contact pressure as a coloured line."""
    figure, (axes,) = panels(1, WIDE_IN, 5.8)
    state = found.states[-1]
    axes.plot(*target.T, color=GREY, lw=1.2, zorder=2)
    shape = state.shape
    ring = np.concatenate([shape.facing, shape.far[::-1], shape.facing[:1]])
    axes.fill(*ring.T, facecolor="none", edgecolor=BLUE, lw=1.2, zorder=3)
    _, kPa = pressure_along(state, target)
    on = kPa > 0.0
    pieces = LineCollection(
        list(np.stack([target[:-1], target[1:]], axis=1)[on]), cmap="YlOrRd", lw=5.0, zorder=4,
        capstyle="round",
    )  # fmt: skip
    pieces.set_array(kPa[on])
    pieces.set_clim(0.0, max(float(kPa.max()), 1e-9))
    axes.add_collection(pieces)
    figure.colorbar(pieces, ax=axes, label="contact pressure (kPa)", shrink=0.7)
    titled(axes, f"{state.pressure_bar:.2f} bar")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
    return figure


def pressure_along(state: GripState, target: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Contact pressure along the profile.

    Returns
    -------
    s : (N - 1,) mm
        Arc length of the profile's pieces.
    kPa : (N - 1,)
        Highest pressure within 1 mm of each.
    """
    middles = target[:-1] + 0.5 * np.diff(target, axis=0)
    s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(middles, axis=0).T))])
    kPa = np.zeros(len(middles))
    for point, value in zip(state.pad.points[:, :2], state.pad.kPa, strict=True):
        near = np.hypot(*(middles - point).T)
        k = int(np.argmin(near))
        low, high = np.searchsorted(s, [s[k] - 1.0, s[k] + 1.0])
        kPa[low:high] = np.maximum(kPa[low:high], value)
    return s, kPa


def _pressure_csv(output: GripOutput) -> bytes | None:
    if not output.found.states:
        return None
    columns = [pressure_along(s, output.target) for s in output.found.states]
    heads = ["s_mm", *(f"kPa_at_{s.pressure_bar:.3g}_bar" for s in output.found.states)]
    table = np.column_stack([columns[0][0], *(kPa for _, kPa in columns)])
    rows = (",".join(f"{value:.4g}" for value in row) for row in table[::5])
    return ("\n".join([",".join(heads), *rows]) + "\n").encode()


def _shapes(output: GripOutput) -> bytes:
    lines = {"target": output.target}
    for state in output.found.states:
        lines[f"at_{state.pressure_bar:.3g}_bar"] = state.shape.facing
    return shape_csv(lines)


GRIP_FILES: Writers[GripOutput] = {
    "grip.json": lambda output: output.told.encode(),
    "grip.csv": lambda output: grip_csv(output.found),
    "contact_pressure.csv": _pressure_csv,
    "shape.csv": _shapes,
    "force_vs_pressure.png": lambda output: (
        png(force_figure(output.found)) if output.found.states else None
    ),
    "contact.png": lambda output: (
        png(pressure_figure(output.found, output.target)) if output.found.states else None
    ),
}
