"""Designs whose numbers hold: tubes that stay clear of themselves, in steps that can be built."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from profiletool.bending.kinematics import meets_itself
from profiletool.joints.bounds import PRESSURE_STEP, wrap_mm
from profiletool.records.design import Design, named
from profiletool.records.request import PLACE_STEP_MM, Request, TubeSpec
from profiletool.records.units import BAR_PER_MPA
from profiletool.verdict.draft import Draft
from profiletool.verify.check import runs_into_itself, withdrawn

_SAME = 1e-4  # of a step; design.json keeps six decimals


def holding(attempt: Draft) -> Draft:
    """Take the verification back where what was verified does not hold.

    A tube that runs into itself was bent through itself, and numbers that cannot be built were
    bent in place of those that will be.
    """
    check, bent = attempt.check, attempt.bent
    if check is None or bent is None:
        return attempt
    off = off_steps(attempt.design, attempt.request)
    failure = runs_into_itself(bent)
    if not failure and off:
        failure = f"its numbers are not those that are built: {off[0]}"
    if not failure:
        return attempt
    check = withdrawn(replace(check, design=attempt.design), failure)
    return replace(attempt, design=check.design, check=check)


def broken(attempt: Draft) -> tuple[str, ...]:
    """Give reasons why an attempt's numbers do not hold; none where they do."""
    return (*_curled(attempt), *_unbuilt(attempt.design, attempt.request))


def _curled(attempt: Draft) -> Iterator[str]:
    """Say that the tube runs into itself: by finite elements, else by what it was chosen by."""
    bent = attempt.bent
    if meets_itself(attempt.best_shape) if bent is None else bent.touches:
        by = f" by {bent.overlap_mm:.1f} mm" if bent is not None else ""
        yield (
            f"the bent tube runs into itself{by}: leave out what curls up with `start_pct` or "
            "`end_pct`, or take a thinner tube with `outer_diameter_mm`"
        )


def _unbuilt(design: Design, request: Request) -> Iterator[str]:
    off = off_steps(design, request)
    if off:
        yield (
            f"no numbers that can be built were found to bend so: {'; '.join(off)}; try another "
            "`max_pressure_bar` or number of `joints`, or 0 for `alpha_step_deg` and "
            "`place_step_mm` if any number can be built"
        )


def off_steps(design: Design, request: Request) -> tuple[str, ...]:
    """Name the numbers of an optimal design that are off the steps asked for; see `Request`.

    The tube's end is cut to length, wherever that is.
    """
    if request.method != "optimal":
        return ()
    spec, said = request.tube, list[str]()
    thread = float(np.degrees(spec.thread_rad))
    step = thread if request.alpha_step_deg is None else request.alpha_step_deg
    alpha = {j.number: j.alpha_closed_deg for j in design.joints}
    off = [number for number, value in alpha.items() if not _whole(value, step)]
    if off:
        what = "whole threads" if request.alpha_step_deg is None else f"steps of {step:g} deg"
        said.append(f"alpha_closed of {named(off)} ({alpha[off[0]]:.2f} deg) is not in {what}")
    given = request.place_step_mm
    steps = (spec.pitch_mm, PLACE_STEP_MM) if given is None else (given,)
    off = min((_off_places(design, spec, step) for step in steps), key=len)
    if off:
        sizes = " or ".join(f"{step:g}" for step in dict.fromkeys(steps))
        said.append(f"the place of {named(off)} is not in steps of {sizes} mm")
    finest = BAR_PER_MPA * PRESSURE_STEP
    if not _whole(design.pressure_bar, finest):
        said.append(f"the pressure, {design.pressure_bar:.4f} bar, is finer than {finest:g} bar")
    return tuple(said)


def _off_places(design: Design, spec: TubeSpec, step: float) -> list[int]:
    """Numbers of the joints whose place is off a step: of the root, or of the sector before."""
    first = design.joints[0]
    least = max(spec.root_mm, 0.5 * first.openF_mm + wrap_mm(spec))
    on = _whole(first.centre_mm, step) or first.centre_mm <= least + 1e-6
    off = [] if on else [first.number]
    for before, joint in pairwise(design.joints):
        apart = joint.centre_mm - before.centre_mm
        wrapped = apart - 0.5 * (before.openF_mm + joint.openF_mm)
        if not (_whole(apart, step) or _whole(wrapped, step)):
            off.append(joint.number)
    return off


def _whole(value: float, step: float) -> bool:
    """Whether a number is a multiple of a step; any is of 0."""
    return step == 0.0 or abs(value / step - round(value / step)) < _SAME
