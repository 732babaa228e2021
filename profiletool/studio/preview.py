"""The tube while a joint is dragged, by the joint response, and once it is let go, by FE."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, reduce
from pathlib import Path

import numpy as np

from profiletool.errors import NotVerified
from profiletool.files.design_json import load_design
from profiletool.files.formula import named_formula
from profiletool.joints.again import edited, plan_again
from profiletool.joints.correction.correct import CannotBend
from profiletool.joints.misfit import misfit_to
from profiletool.records.design import Design
from profiletool.records.edit import Edit
from profiletool.records.frames import Shape
from profiletool.records.making import request_again
from profiletool.records.profile import Profile
from profiletool.report.film import still_of
from profiletool.report.view import View, film_view, joints_view
from profiletool.subject.recall import profile_of
from profiletool.verify.near import NearBench

_EVERY = 10  # of the profile's points, 0.1 mm apart, counts for the misfit that is shown


@lru_cache(maxsize=4)
def _base(file: Path, stamp: int) -> tuple[Design, Profile]:
    """Read a design and its profile; ``stamp`` is the time of its last change."""
    del stamp
    design = load_design(file)
    return design, profile_of(design, file)


def changed(file: Path, edits: Sequence[Edit]) -> tuple[Design, Profile]:
    """Read a design with its profile, and change it.

    Raises
    ------
    UsageError, UnreadableInput
    """
    known, profile = _base(file, file.stat().st_mtime_ns)
    return reduce(edited, edits, known), profile


def by_fe(file: Path, edits: Sequence[Edit], bench: NearBench) -> View:
    """Bend a changed design by finite elements, to show it soon; nothing is verified.

    Raises
    ------
    NotVerified
        They do not get there.
    UsageError, UnreadableInput
    """
    design, profile = changed(file, edits)
    try:
        shape, solution = bench.bend(design, profile)
    except CannotBend as error:
        raise NotVerified(str(error)) from error
    view = joints_view(design)
    for row, theta in zip(view["joints"], np.degrees(solution.states[-1].theta), strict=True):
        row["fe"] = float(theta)
    return {**view, **_bent(design, profile, shape), "by": "fe"}


def _bent(design: Design, profile: Profile, shape: Shape) -> View:
    off = misfit_to(shape, profile.points[::_EVERY])
    return {
        "bar": design.pressure_bar,
        "film": film_view(still_of(shape, design)),
        "off": {"rms": off.rms_mm, "max": off.max_mm},
    }


def preview(file: Path, edits: Sequence[Edit]) -> View:
    """Bend a changed design by the model that joints are chosen by.

    Parameters
    ----------
    file : Path
        A design.json with shape.csv beside it.
    edits : sequence of Edit

    Raises
    ------
    UsageError
        No actuator has such numbers.
    UnreadableInput
    """
    design, profile = changed(file, edits)
    asked = request_again(design, profile, refine=False)
    formula = named_formula(design.formula.name)
    plan = plan_again(design, asked, profile, formula, lambda line: None)
    joints = plan.layout.joints
    view = joints_view(design)
    for row, joint in zip(view["joints"], joints, strict=True):
        theta = joint.theta_response_deg or joint.theta_formula_deg
        row["response"] = joint.signed(theta)
    return {**view, **_bent(design, profile, plan.bent), "by": plan.by}
