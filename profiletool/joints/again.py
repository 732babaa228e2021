"""Designs taken up again: a joint changed by hand, and plans of joints that are there already."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np

from formula.theta import Formula, theta_deg
from profiletool.bending.kinematics import deform
from profiletool.bending.model import Chain, Model
from profiletool.errors import UsageError
from profiletool.joints.bounds import limits_of
from profiletool.joints.correction.correct import ForwardModel
from profiletool.joints.correction.parameters import PosedChain
from profiletool.joints.layout import Layout
from profiletool.joints.optimal_method import angles, correction, model_of, places_of
from profiletool.joints.plan import Plan
from profiletool.joints.windows import off_mesh
from profiletool.records.design import Design, Joint
from profiletool.records.edit import Edit
from profiletool.records.profile import Profile
from profiletool.records.request import Request
from profiletool.records.units import BAR_PER_MPA

S = TypeVar("S")

_LEAST_WRAP = 0.02  # of the diameter: less gauze between two cuts cannot be modelled


def edited(design: Design, edit: Edit) -> Design:
    """Change a design by hand: its joints and pressure; what follows from them is left as it was.

    Raises
    ------
    UsageError
        There is no such joint, nothing to change, or no actuator has such numbers.
    """
    changes = {
        "alpha_closed_deg": edit.alpha_deg, "openF_mm": edit.openF_mm, "centre_mm": edit.move_mm,
        "alpha_center_deg": edit.alpha_center_deg,
    }  # fmt: skip
    given: dict[str, Any] = {name: value for name, value in changes.items() if value is not None}
    if bool(given) != (edit.joint is not None):
        raise UsageError(
            "`joint` goes with one or more of `alpha_deg`, `openF_mm`, `move_mm` and "
            "`alpha_center_deg`"
        )
    if not given and edit.pressure_bar is None:
        raise UsageError("nothing to change: give a `joint` with its numbers, or `pressure_bar`")
    joints = design.joints
    if edit.joint is not None:
        if not 1 <= edit.joint <= len(joints):
            raise UsageError(f"`joint` must be 1 to {len(joints)}, not {edit.joint}")
        old = joints[edit.joint - 1]
        if "centre_mm" in given:
            given["centre_mm"] += old.centre_mm
        new = replace(old, **given)
        joints = (*joints[: edit.joint - 1], new, *joints[edit.joint :])
    pressure = design.pressure_bar if edit.pressure_bar is None else edit.pressure_bar
    _check(design, joints, pressure)
    return replace(design, joints=joints, pressure_bar=pressure)


def _check(design: Design, joints: tuple[Joint, ...], pressure_bar: float) -> None:
    """Refuse what cannot be built."""
    if not 0.0 < pressure_bar <= 20.0:
        raise UsageError(f"`pressure_bar` must be above 0 and at most 20, not {pressure_bar:g}")
    pitch = design.gauze.pitch_mm
    for joint in joints:
        meshes = joint.openF_mm / pitch
        if not (meshes >= 0.99 and abs(meshes - round(meshes)) < 1e-6):
            raise UsageError(
                f"`openF_mm` must be whole meshes of {pitch:g} mm, not {joint.openF_mm:g}"
            )
        if not 0.0 <= joint.alpha_center_deg < 360.0:
            raise UsageError(
                f"`alpha_center_deg` must be within 0 to 360, not {joint.alpha_center_deg:g}"
            )
        if not 0.0 < joint.alpha_closed_deg < 360.0:
            raise UsageError(f"`alpha_deg` must be within 0 to 360, not {joint.alpha_closed_deg:g}")
    ends = [(j.centre_mm - j.openF_mm / 2, j.centre_mm + j.openF_mm / 2) for j in joints]
    if ends[0][0] <= 0.0:
        raise UsageError("joint 1 would be cut into the clamp; `move_mm` it less, or cut it less")
    for (_, end), (start, _), joint in zip(ends, ends[1:], joints[1:], strict=False):
        if start - end < _LEAST_WRAP * design.tube.outer_diameter_mm - 1e-9:
            left = f"overlap by {end - start:g}" if start < end else f"leave only {start - end:g}"
            raise UsageError(
                f"the cuts of joints {joint.number - 1} and {joint.number} would {left} mm"
                f"{'' if start < end else ' of gauze'}; `move_mm` it less, or cut it less"
            )
    if ends[-1][1] >= design.tube.length_mm:
        raise UsageError(f"joint {len(joints)} would lie beyond the tube's closed end")


def plan_again(
    design: Design,
    request: Request,
    profile: Profile,
    formula: Formula,
    say: Callable[[str], None],
    forward: ForwardModel[S] | None = None,
) -> Plan:
    """Plan with the joints of a design, corrected where there is a forward model.

    Parameters
    ----------
    design : Design
    request : Request
        With the design's tube.
    profile : Profile
    formula : Formula
        For the angles of the table.
    say : callable
        Takes one line of progress at a time.
    forward : ForwardModel, optional
        Of the correction, such as finite elements of the whole actuator.

    Raises
    ------
    UnreadableInput
        A joint bends out of the plane.
    """
    posed, model = posed_of(design), model_of(request, formula)
    if request.tube.pressure_bar is not None:
        posed = replace(posed, pressure=request.tube.pressure_bar / BAR_PER_MPA)
    if forward is not None:
        limits = limits_of(model, request.tube, request.base_free)
        request = on_mesh(request, design)
        posed = correction(request, forward, profile, model, (posed, limits), say).best.posed
    chain, pressure_bar = posed.chain, BAR_PER_MPA * posed.pressure
    joints = _joints(design, chain, pressure_bar, formula)
    layout = Layout(joints, float(chain.centre[0]), chain.length, pressure_bar, posed.pose)
    if _holds(model, posed):
        by = "joint response"
        bent = model.shape(chain, posed.pressure, posed.pose, profile.sign)
        response = np.abs(np.degrees(angles(bent, chain))).tolist()
        joints = tuple(
            replace(joint, theta_response_deg=theta)
            for joint, theta in zip(joints, response, strict=True)
        )
        layout = replace(layout, joints=joints)
    else:
        by = "formula"
        bent = deform(
            layout.bends(), layout.length_mm, request.tube.radius_mm, posed.pose, profile.sign
        )
    return Plan(layout=layout, by=by, bent=bent, places=places_of(bent, chain, profile))


def on_mesh(request: Request, design: Design) -> Request:
    """Keep the joints on whole meshes where those of a design are, and no step is asked for."""
    if request.place_step_mm is None and not off_mesh(design.joints, design.gauze):
        return replace(request, place_step_mm=design.gauze.pitch_mm)
    return request


def posed_of(design: Design) -> PosedChain:
    """Take the joints of a design as a chain in its base pose."""
    joints = design.joints
    chain = Chain(
        np.array([joint.centre_mm for joint in joints]),
        np.array([joint.openF_mm for joint in joints]),
        np.radians([joint.alpha_closed_deg for joint in joints]),
        np.radians([joint.alpha_center_deg for joint in joints]),
        design.tube.length_mm,
    )
    return PosedChain(chain, design.pressure_bar / BAR_PER_MPA, design.base_pose)


def _joints(
    design: Design, chain: Chain, pressure_bar: float, formula: Formula
) -> tuple[Joint, ...]:
    """Give the joints of a chain, with the wanted angles of a design."""
    alpha = np.degrees(chain.alpha)
    by_formula = theta_deg(formula, alpha, chain.openF, pressure_bar)
    ends = [*chain.centre.tolist(), chain.length]
    return tuple(
        replace(
            joint,
            F_mm=end - start,
            alpha_closed_deg=float(alpha[k]),
            centre_mm=start,
            theta_formula_deg=float(by_formula[k]),
            theta_fe_deg=None,
            theta_response_deg=None,
            stretch_fe=None,
        )
        for k, (joint, (start, end)) in enumerate(zip(design.joints, pairwise(ends), strict=True))
    )


def _holds(model: Model, posed: PosedChain) -> bool:
    """Whether all joints lie within what a joint response was measured for."""
    chain = posed.chain
    asked = (
        (model.alpha, chain.alpha), (model.openF, chain.openF),
        (model.pressure, np.array([posed.pressure])),
    )  # fmt: skip
    return all(
        bool(np.all((values >= low - 1e-9) & (values <= high + 1e-9)))
        for (low, high), values in asked
    )
