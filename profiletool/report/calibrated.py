"""A calibrated tube as text."""

from __future__ import annotations

import math

from profiletool.records.calibrated import CalibratedTube, FittedNumber, Relaxation


def tube_text(tube: CalibratedTube) -> str:
    """Lay out what was fitted, how well, and what the angles cannot tell."""
    lines = [
        f"{tube.readings} angles at {len(tube.pressures_bar)} pressures, "
        f"{tube.pressures_bar[0]:g} to {tube.pressures_bar[-1]:g} bar",
        *(_number(one) for one in tube.fitted),
        *([] if tube.relaxation is None else [_relaxes(tube.relaxation)]),
        f"fit: {tube.rmse_deg:.2f} deg RMS, {tube.expected_deg:.2f} expected of the readings",
    ]
    if tube.held_out_deg is not None:
        lines.append(
            f"every other pressure, predicted from the others: {tube.held_out_deg:.2f} deg RMS"
        )
    values = ", ".join(f"{value:.2g}" for value in tube.singular_values)
    lines.append(f"singular values of the data over the priors: {values}")
    lines += [f"note: the angles do not tell {one}" for one in tube.untold]
    if tube.rmse_deg > 1.5 * tube.expected_deg:
        lines.append(
            "note: the fit leaves more than the readings' own error: a joint is off by itself, or "
            "the design is another one; `angles` given to trim name the joint"
        )
    return "\n".join(lines) + "\n"


def _relaxes(one: Relaxation) -> str:
    share = f"{100.0 * one.share:+6.1f} +-{100.0 * one.share_sigma:4.1f} %"
    if not one.told:
        return f"rubber relaxes by          {share}   (no more than chance)"
    time = f"in {one.time_s:.3g} +-{one.time_sigma_s:.2g} s"
    return f"rubber relaxes by          {share} {time}; all else is of the relaxed tube"


def _number(one: FittedNumber) -> str:
    told = "" if one.told else "   (mostly as thought before)"
    if one.name == "rubber":
        share, sigma = 100.0 * math.expm1(one.value), 100.0 * one.sigma
        return f"rubber stiffer by          {share:+6.1f} +-{sigma:4.1f} %{told}"
    names = {
        "dead": ("gauge reads too much       ", "bar", 3),
        "thread": ("uncut sectors act wider by ", "deg", 1),
        "wall": ("wall thicker by            ", "mm", 3),
    }
    what, unit, digits = names[one.name]
    return f"{what}{one.value:+6.{digits}f} +-{one.sigma:.{digits}f} {unit}{told}"
