"""The tube while a joint is dragged: by the joint response, in a few milliseconds."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache, reduce
from pathlib import Path

from profiletool.files.design_json import load_design
from profiletool.files.formula import named_formula
from profiletool.joints.again import edited, plan_again
from profiletool.joints.misfit import misfit_to
from profiletool.records.design import Design
from profiletool.records.edit import Edit
from profiletool.records.making import request_again
from profiletool.records.profile import Profile
from profiletool.report.film import still_of
from profiletool.report.view import View, film_view, joints_view
from profiletool.subject.recall import profile_of

_EVERY = 10  # of the profile's points, 0.1 mm apart, counts for the misfit that is shown


@lru_cache(maxsize=4)
def _base(file: Path, stamp: int) -> tuple[Design, Profile]:
    """Read a design and its profile; ``stamp`` is the time of its last change."""
    del stamp
    design = load_design(file)
    return design, profile_of(design, file)


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
    known, profile = _base(file, file.stat().st_mtime_ns)
    design = reduce(edited, edits, known)
    asked = request_again(design, profile, refine=False)
    formula = named_formula(design.formula.name)
    plan = plan_again(design, asked, profile, formula, lambda line: None)
    joints = plan.layout.joints
    off = misfit_to(plan.bent, profile.points[::_EVERY])
    view = joints_view(design)
    for row, joint in zip(view["joints"], joints, strict=True):
        theta = joint.theta_response_deg or joint.theta_formula_deg
        row["response"] = joint.signed(theta)
    return {
        **view,
        "by": plan.by,
        "bar": design.pressure_bar,
        "film": film_view(still_of(plan.bent, design)),
        "off": {"rms": off.rms_mm, "max": off.max_mm},
    }
