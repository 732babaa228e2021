"""Requests made from values by field name, and checked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from profiletool.errors import UsageError
from profiletool.records.built import BuildErrors, build_errors
from profiletool.records.model import ModelInputs, check_model
from profiletool.records.option import Option
from profiletool.records.options import DESIGN, MODEL
from profiletool.records.request import (
    PRESSURE_STEP_BAR,
    Look,
    Request,
    ScaleRequest,
    TubeSpec,
)

if TYPE_CHECKING:
    from formula.theta import Formula
    from profiletool.records.design import Design
    from profiletool.records.profile import Profile


def request_of(file: Path, values: Mapping[str, Any], formula: Formula | None = None) -> Request:
    """Make a request from values by field name; what is None or missing has its default.

    Parameters
    ----------
    file : Path
    values : mapping
        Field names of `DESIGN` to values.
    formula : Formula, optional
        Its tube and rubber are those of the request where none other are given.

    Raises
    ------
    UsageError
        A name is no field.
    """
    paths = {row.field: row.path for row in DESIGN}
    unknown = sorted(set(values) - set(paths))
    if unknown:
        raise UsageError(f"{unknown[0]!r} is no option of a design; there are {', '.join(paths)}")
    tube = TubeSpec()
    if formula is not None:
        tube = TubeSpec(formula.outer_diameter_mm, formula.wall_mm, rubber=formula.rubber)
    parts: dict[str, Any] = {
        "scale": ScaleRequest(),
        "look": Look(),
        "tube": tube,
        "model": ModelInputs(),
    }
    own: dict[str, Any] = {}
    for name, value in values.items():
        holder, _, field = paths[name].rpartition(".")
        if value is None:
            continue
        if holder:
            parts[holder] = replace(parts[holder], **{field: value})
        else:
            own[field] = build_errors(value) if field == "build" else value
    return Request(file, **parts, **own)


def changed_request(request: Request, values: Mapping[str, Any]) -> Request:
    """Give a request with other values, by field name."""
    paths = {row.field: row.path for row in DESIGN}
    for name, value in values.items():
        holder, _, field = paths[name].rpartition(".")
        if holder:
            part = replace(getattr(request, holder), **{field: value})
            request = replace(request, **{holder: part})
        else:
            request = replace(request, **{field: value})
    return request


def request_again(
    design: Design, profile: Profile, refine: bool, pressure_bar: float | None = None
) -> Request:
    """Ask for a design anew: its own tube, model and errors of the build, along its profile.

    Its numbers stay as they are, whatever steps they lie on, unless they are to be corrected; then
    its pressure is the one that is given, if any.
    """
    tube, gauze, most = design.tube, design.gauze, TubeSpec()
    spec = TubeSpec(
        outer_diameter_mm=tube.outer_diameter_mm,
        wall_mm=tube.wall_mm,
        root_mm=min(tube.root_mm, most.root_mm) if refine else tube.root_mm,
        pitch_mm=gauze.pitch_mm,
        thread_mm=gauze.thread_mm,
        turns=gauze.turns,
        max_pressure_bar=max(design.pressure_bar, most.max_pressure_bar),
        max_length_mm=max(tube.length_mm, most.max_length_mm),
        rubber=tube.rubber,
        clamp_mm=design.clamp.length_mm,
        pressure_bar=pressure_bar,
    )
    asked = Request(
        Path(design.source.file),
        side=design.source.side,
        tube=spec,
        build=BuildErrors() if design.built is None else design.built.build,
        model=design.model,
        given=profile,
        refine=refine,
        grip=design.grip.pressed,
        grip_N=design.grip.force_N,
        solid=design.grip.solid,
        clearance_mm=design.grip.clearance_mm,
    )
    return asked if refine else replace(asked, alpha_step_deg=0.0, place_step_mm=0.0)


def check_request(request: Request) -> None:
    """Refuse values that no design can be made with.

    Raises
    ------
    UsageError
    """
    for row in DESIGN:
        _check(row, row.value(request))
    tube = request.tube
    if tube.pitch_mm <= tube.thread_mm:
        raise UsageError(f"`pitch_mm` must be more than the thread, {tube.thread_mm:g} mm")
    if tube.wall_mm >= tube.radius_mm:
        raise UsageError("`wall_mm` must be less than half of `outer_diameter_mm`")
    if tube.pressure_bar is not None:
        _check_pressure(tube.pressure_bar, tube.max_pressure_bar)
    if not 0.0 <= request.start_pct < request.end_pct <= 100.0:
        raise UsageError("`start_pct` and `end_pct` must be percentages, the first one the lower")
    check_model(request.model)


def _check_pressure(pressure_bar: float, most_bar: float) -> None:
    if pressure_bar > most_bar:
        raise UsageError(
            f"`pressure_bar` {pressure_bar:g} bar is more than the highest, {most_bar:g} bar: "
            "lower it, or raise `max_pressure_bar` as well"
        )
    steps = pressure_bar / PRESSURE_STEP_BAR
    if abs(steps - round(steps)) > 1e-6:
        raise UsageError(
            f"`pressure_bar` comes in steps of {PRESSURE_STEP_BAR:g} bar, not {pressure_bar:g}"
        )


def model_of(values: Mapping[str, Any], base: ModelInputs) -> ModelInputs:
    """Give the inputs of finite elements: values by field name, what is None as in ``base``.

    Raises
    ------
    UsageError
        A name is no input, or a value makes no sense.
    """
    unknown = sorted(set(values) - {row.field for row in MODEL})
    if unknown:
        raise UsageError(f"{unknown[0]!r} is no input of finite elements")
    model = replace(base, **{name: value for name, value in values.items() if value is not None})
    check_model(model)
    return model


def check_scale(scale: ScaleRequest) -> None:
    """Refuse lengths that are no lengths.

    Raises
    ------
    UsageError
    """
    for row in DESIGN:
        if row.path.startswith("scale."):
            _check(row, getattr(scale, row.field))


def _check(row: Option, value: Any) -> None:
    if value is None:
        return
    if row.above is not None and not (math.isfinite(value) and value > row.above):
        raise UsageError(f"`{row.field}` must be a number above {row.above:g}, not {value:g}")
    if row.least is not None and not (math.isfinite(value) and value >= row.least):
        raise UsageError(f"`{row.field}` must be {row.least:g} or more, not {value:g}")
