"""A design at rising pressures, as a model predicts it for the bench."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from formula.theta import Formula, theta_deg
from profiletool.bending.model import Chain
from profiletool.bending.response import Response
from profiletool.errors import NotVerified
from profiletool.records.bench import Predicted
from profiletool.records.design import Design
from profiletool.records.fe import Verification
from profiletool.records.rubber import law_of
from profiletool.records.side import side_sign
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.run import inflate, reason
from profiletool.verify.tube import actuator_of

BEYOND = 1.3  # of the highest pressure: an actuator may be softer than planned
STATES = 13
_RESPONSE_SHARE = 0.03  # of a joint's angle: what the joint response is off by inside a joint


def predicted_by_fe(
    design: Design, most_bar: float, progress: Callable[[float], None] | None = None
) -> Predicted:
    """Predict a design's states by finite elements, to some way beyond a pressure, bar.

    Raises
    ------
    NotVerified
        They do not reach the pressure itself.
    fem.errors.BadGeometry, fem.errors.NotConverged
    """
    bars = np.linspace(0.0, BEYOND * most_bar, STATES + 1)[1:]
    sign = side_sign(design.source.side)
    run = inflate(actuator_of(design), bars.tolist(), design.base_pose, sign, progress=progress)
    found = run.verification
    if found.last.pressure_bar < most_bar - 1e-9:
        raise NotVerified(
            f"finite elements: {reason(found)}, before the {most_bar:g} bar of the pictures; "
            "measure at lower pressures"
        )
    return predicted_of(design, found)


def predicted_of(design: Design, found: Verification) -> Predicted:
    """Take the states of a finite-element run as predictions."""
    states = [found.rest, *found.states]
    return Predicted(
        np.array([state.pressure_bar for state in states]),
        np.array([state.theta_deg for state in states]),
        tuple(state.shape for state in states),
        windows_of(design),
        side_sign(design.source.side),
        design.base_pose.heading_deg,
    )


def predicted_by_response(design: Design, most_bar: float) -> Predicted:
    """Predict a design's states by the joint response: quicker, and less true."""
    joints, tube = design.joints, design.tube
    chain = Chain(
        np.array([joint.centre_mm for joint in joints]),
        np.array([joint.openF_mm for joint in joints]),
        np.radians([joint.alpha_closed_deg for joint in joints]),
        np.radians([joint.alpha_center_deg for joint in joints]),
        tube.length_mm,
    )
    law = law_of(tube.rubber, design.model.nu)
    stiffness = 0.5 * law.shear_modulus
    model = Response.load().scaled(tube.outer_diameter_mm, tube.wall_mm, stiffness)
    sign = side_sign(design.source.side)
    bars = np.linspace(0.0, BEYOND * most_bar, STATES + 1)
    rows, shapes = [], []
    for bar in bars.tolist():
        pressure = bar / BAR_PER_MPA
        turn = model.factors(chain, pressure)[:, 0] * model.theta(
            chain.openF, chain.alpha, pressure
        )
        rows.append(np.degrees(chain.sense * turn))
        shapes.append(model.shape(chain, pressure, design.base_pose, sign))
    return Predicted(
        bars, np.array(rows), tuple(shapes), windows_of(design), sign,
        design.base_pose.heading_deg, _RESPONSE_SHARE,
    )  # fmt: skip


def windows_of(design: Design) -> FloatArray:
    """Where the cuts of a design start and end: (joints, 2) mm."""
    return np.array(
        [[j.centre_mm - 0.5 * j.openF_mm, j.centre_mm + 0.5 * j.openF_mm] for j in design.joints]
    )


def formula_angles(design: Design, formula: Formula, bars: FloatArray) -> FloatArray:
    """Angles of a design's joints by a formula, whatever its range: (n, joints) deg, signed."""
    return np.array(
        [
            [joint.signed(float(theta_deg(formula, joint.alpha_closed_deg, joint.openF_mm, bar)))
             for joint in design.joints]
            for bar in bars.tolist()
        ]
    )  # fmt: skip
