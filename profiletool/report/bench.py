"""The measurement of an actuator on the bench: everything that its files are written from."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image
from scipy.interpolate import CubicSpline

from formula.theta import Formula
from profiletool.records.bench import Agreement, Predicted, Seen
from profiletool.records.design import Design
from profiletool.records.picture import Picture
from profiletool.records.units import FloatArray
from profiletool.report.palette import BLUE, GREEN, INK, ORANGE, RED
from profiletool.verify.agreement import agreements, angles_of
from profiletool.verify.predicted import formula_angles

_OVERLAY_PX = 1400  # of an overlay's longer side, at most
_DPI = 100
_MOST_LOST = 0.3  # of all angles, before a note


@dataclass(frozen=True)
class BenchOutput:
    """All that the files of a measurement are written from.

    Attributes
    ----------
    design : Design
    seen : tuple of Seen
        Picture by picture.
    predicted : Predicted
    by : str
        The model that predicts: "fe" or "response".
    fe, formula : (pictures, J) deg
        Angles that the model and the formula predict there.
    load : callable
        Gives a picture by its number.
    notes : tuple of str
        What the user should know.
    """

    design: Design
    seen: tuple[Seen, ...]
    predicted: Predicted
    by: str
    fe: FloatArray
    formula: FloatArray
    load: Callable[[int], Picture]
    notes: tuple[str, ...] = ()

    @cached_property
    def measured(self) -> tuple[FloatArray, FloatArray]:
        """Angles and sigmas, (pictures, J) deg each; NaN where lost."""
        return angles_of(self.seen)

    @cached_property
    def compared(self) -> dict[str, tuple[tuple[Agreement | None, ...], Agreement | None]]:
        """Agreement with every model by name: joint by joint, and all together."""
        theta = self.measured[0]
        return {self.by: agreements(theta, self.fe), "formula": agreements(theta, self.formula)}

    @cached_property
    def overlays(self) -> list[bytes]:
        """Every picture with the fitted tube, as PNG."""
        return [draw_fit(self.load(k).rgb, one) for k, one in enumerate(self.seen)]


def bench_output(
    design: Design,
    seen: tuple[Seen, ...],
    predicted: Predicted,
    by: str,
    formula: Formula,
    load: Callable[[int], Picture],
) -> BenchOutput:
    """Gather what the files of a measurement are written from; see `BenchOutput`."""
    bars = np.array([one.pressure_bar for one in seen])
    known = CubicSpline(predicted.pressure_bar, predicted.theta_deg)(bars)
    lost = [angle.state for one in seen for angle in one.angles].count("lost")
    notes = []
    if lost > _MOST_LOST * len(seen) * len(design.joints):
        notes.append(
            f"{lost} of {len(seen) * len(design.joints)} angles are lost: look at the overlays; is "
            "it this design, at these pressures and this scale?"
        )
    return BenchOutput(
        design, seen, predicted, by, known, formula_angles(design, formula, bars), load,
        tuple(notes),
    )  # fmt: skip


def compare_json(output: BenchOutput) -> str:
    """Write how the measured angles agree with the models'."""
    tree: dict[str, Any] = {"pictures": len(output.seen), "states": _counts(output.seen)}
    for name, (each, whole) in output.compared.items():
        tree[name] = {
            "joints": [{"joint": k, **_numbers(one)} for k, one in enumerate(each, start=1)],
            "all": _numbers(whole),
        }
    tree["notes"] = list(output.notes)
    return json.dumps(tree, indent=1, allow_nan=False) + "\n"


def _counts(seen: Sequence[Seen]) -> dict[str, int]:
    states = [angle.state for one in seen for angle in one.angles]
    return {name: states.count(name) for name in ("measured", "by hand", "lost")}


def _numbers(one: Agreement | None) -> dict[str, Any]:
    names = ("r2", "slope", "intercept_deg", "rmse_deg", "bias_deg")
    if one is None:
        return {"count": 0, **dict.fromkeys(names), "limits_deg": None}
    values = {name: _rounded(getattr(one, name)) for name in names}
    return {"count": one.count, **values, "limits_deg": [_rounded(v) for v in one.limits_deg]}


def _rounded(value: float) -> float | None:
    return round(value, 5) if np.isfinite(value) else None


def bench_text(output: BenchOutput) -> str:
    """Lay out the measured angles, and how they agree with the models."""
    count = len(output.design.joints)
    lines = [
        "theta of each joint in deg, positive toward the object; +- one standard deviation",
        "   bar" + "".join(f"{f'joint {k}':>15}" for k in range(1, count + 1)) + "  picture",
    ]
    for one in output.seen:
        cells = "".join(
            f"{'lost':>15}"
            if angle.state == "lost"
            else f"{angle.theta_deg:8.2f} +-{angle.sigma_deg:4.2f}"
            for angle in one.angles
        )
        lines.append(f"{one.pressure_bar:6.2f}{cells}  {one.picture}")
    for name, (_, whole) in output.compared.items():
        if whole is None:
            continue
        low, high = whole.limits_deg
        lines.append(
            f"against {NAMES[name]}: {whole.rmse_deg:.2f} deg RMS, bias {whole.bias_deg:+.2f}, "
            f"limits of agreement {low:+.2f} to {high:+.2f}; slope {whole.slope:.3f}, R2 "
            f"{whole.r2:.4f}"
        )
    return "\n".join(lines) + "\n"


NAMES = {"fe": "finite elements", "response": "the joint response", "formula": "the formula"}


def draw_fit(rgb: Any, seen: Seen) -> bytes:
    """Draw the fitted tube, its sectors and the believed edges onto a picture, as PNG."""
    height, width = rgb.shape[:2]
    share = min(1.0, _OVERLAY_PX / max(height, width))
    figure = Figure(figsize=(share * width / _DPI, share * height / _DPI), dpi=_DPI)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(-0.5, width - 0.5), ylim=(height - 0.5, -0.5))
    axes.set_axis_off()
    small = Image.fromarray(rgb).resize(
        (round(share * width), round(share * height)), Image.Resampling.BOX
    )
    axes.imshow(np.asarray(small), extent=(-0.5, width - 0.5, height - 0.5, -0.5), aspect="auto")
    for line in seen.outline_px:
        axes.plot(*line.T, color=BLUE, lw=1.0)
    axes.plot(*seen.edges_px.T, color=ORANGE, ls="none", marker=".", ms=2.5)
    for ends in seen.sectors_px:
        axes.plot(*ends.T, color=GREEN, lw=1.8)
    for k, angle in enumerate(seen.angles):
        at = 0.5 * (seen.sectors_px[k, 1] + seen.sectors_px[k + 1, 0])
        lost = angle.state == "lost"
        said = "lost" if lost else f"{angle.theta_deg:.1f}°"
        axes.text(
            float(at[0]), float(at[1]), f"{k + 1}: {said}", color=RED if lost else INK,
            fontsize=9, ha="center", va="center",
            bbox={"boxstyle": "round,pad=0.2", "fc": "white", "ec": "none"},
        )  # fmt: skip
    buffer = io.BytesIO()
    figure.savefig(
        buffer, format="png", metadata={"Software": None}, pil_kwargs={"compress_level": 3}
    )
    return buffer.getvalue()
