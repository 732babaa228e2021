"""The paper's method: joints read off the profile one by one, angles looked up in the table."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from formula.errors import OutOfRange
from formula.theta import Formula
from profiletool.bending.kinematics import deform
from profiletool.errors import Infeasible, NoObject, UsageError
from profiletool.joints.paper.assign import joint_rules, lay_out, theta_table
from profiletool.joints.paper.sectors import discretise
from profiletool.joints.plan import Plan, out_of_reach
from profiletool.records.profile import Profile
from profiletool.records.request import Request

PAPER_TOLERANCE_MM = 1.0


def paper_plan(
    request: Request, profile: Profile, formula: Formula, say: Callable[[str], None]
) -> Plan:
    """Read joints off the profile and look their angles up, as the paper does.

    Parameters
    ----------
    request : Request
    profile : Profile
    formula : Formula
    say : callable
        Takes one line of progress at a time.

    Raises
    ------
    UsageError
        When the formula covers no cut or no pressure that the request allows.
    NoObject
        When the profile is straight.
    Infeasible
        When no pressure serves all joints.
    """
    spec = request.tube
    try:
        table = theta_table(formula, spec)
    except OutOfRange as error:
        raise UsageError(f"{error}; change `pitch_mm`, `max_pressure_bar` or `formula`") from error
    tolerance = request.tolerance_mm or PAPER_TOLERANCE_MM
    rules = joint_rules(table, spec, tolerance)
    sectors = discretise(profile, rules, request.joints)
    if not sectors:
        raise NoObject(
            f"the profile is straight to {tolerance:g} mm: there is nothing to bend; "
            "take another `side` or stretch, or a smaller `tolerance_mm`"
        )
    try:
        layout = lay_out(profile, sectors, table, spec)
    except OutOfRange as error:
        raise Infeasible(f"no pressure serves all joints: {error}") from error
    say(f"joints: {len(sectors)} at {layout.pressure_bar:.2f} bar")

    return Plan(
        layout=layout,
        by="formula",
        bent=deform(layout.bends(), layout.length_mm, spec.radius_mm, layout.pose, profile.sign),
        places=np.array([sector.centre for sector in sectors]),
        sectors=sectors,
        rules=rules,
        hopeless=out_of_reach(profile.length_mm, 0.0, request),
    )
