"""The summary of a design as text: joints, pressure and distances off the profile."""

from __future__ import annotations

from profiletool.records.built import Built, mm_text
from profiletool.records.design import Design, Joint, Misfit
from profiletool.records.seal import proven


def joint_table(design: Design) -> str:
    """Lay out the joints of a design as the paper's Table 5."""
    extra = [("formula deg", "theta_formula_deg")]
    if any(j.theta_response_deg is not None for j in design.joints):
        extra.append(("response deg", "theta_response_deg"))
    if proven(design):
        extra.append(("FE deg", "theta_fe_deg"))
    lines = [
        f"{design.source.file}: {_counted(len(design.joints))} at {design.pressure_bar:.2f} bar, "
        f"tube {design.tube.length_mm:.1f} mm long, root {design.tube.root_mm:.1f} mm",
        "joint    F mm  openF mm  alpha_closed deg  alpha_center deg  theta deg"
        + "".join(f"  {head}" for head, _ in extra),
    ]
    lines += [
        f"{j.number:5d}  {j.F_mm:6.1f}  {j.openF_mm:8g}  {j.alpha_closed_deg:16.4g}  "
        f"{j.alpha_center_deg:16g}  {j.signed(j.theta_target_deg):9.1f}"
        + "".join(f"  {_angle(design, j, name):>{len(head)}}" for head, name in extra)
        for j in design.joints
    ]
    lines.append("theta is positive toward the object, negative away from it")
    if design.fit.fe is not None:
        lines.append(f"by FE off the profile:                 {off_text(design.fit.fe)}")
    if design.built is not None:
        lines.append(f"built by hand, off the profile:        {built_text(design.built)}")
    if design.operate_bar is not None and design.built is not None:
        off = mm_text(design.built.expected_rms_mm.in_contact)
        lines.append(
            f"against its object, work at:           {design.operate_bar:.2f} bar; {off} mm RMS "
            "expected there"
        )
    if design.fit.response is not None:
        lines.append(f"by the joint response off the profile: {off_text(design.fit.response)}")
    lines.append(f"by the formula off the profile:        {off_text(design.fit.formula)}")
    return "\n".join(lines) + "\n"


def _angle(design: Design, joint: Joint, name: str) -> str:
    """Give an angle of a joint, marked where finite elements cannot tell it for certain."""
    angle: float | None = getattr(joint, name)
    if angle is None:
        return "–"
    doubtful = name == "theta_fe_deg" and joint.number in design.theta_uncertain
    return f"{'~' if doubtful else ''}{joint.signed(angle):.1f}"


def off_text(misfit: Misfit) -> str:
    """Say how far a shape lies off its target."""
    return f"{misfit.rms_mm:.2f} mm RMS, {misfit.max_mm:.2f} mm at most"


def built_text(built: Built) -> str:
    """Say what to expect of the actuator that is built, as it is set and as its pressure is."""
    expected = built.expected_rms_mm
    return (
        f"{mm_text(expected.as_set)} mm RMS expected at the planned pressure, "
        f"{mm_text(expected.trimmed)} mm after the pressure is set on it"
    )


def _counted(joints: int) -> str:
    return "1 joint" if joints == 1 else f"{joints} joints"


def summary(design: Design) -> str:
    """Joints, distances, verdict and notes of a design as text."""
    verdict = (
        "feasible" if design.feasible else "INFEASIBLE",
        "verified by finite elements" if proven(design) else "NOT VERIFIED",
    )
    notes = [f"note: {text}" for text in design.warnings]
    return joint_table(design) + "\n".join((", ".join(verdict), *notes))


def _built_short(design: Design) -> str:
    if design.built is None:
        return ""
    expected = design.built.expected_rms_mm
    return f" with perfect parts ({mm_text(expected.trimmed)} mm expected once built and set)"


def headline(design: Design) -> str:
    """Say in one line what a design is."""
    fit = design.fit.fe or design.fit.response or design.fit.formula
    verified = "verified" if proven(design) else "NOT VERIFIED"
    return (
        f"{design.source.file}: {_counted(len(design.joints))} at {design.pressure_bar:.2f} bar, "
        f"{fit.rms_mm:.2f} mm RMS off the profile{_built_short(design)}, "
        f"{'feasible' if design.feasible else 'INFEASIBLE'}, {verified}"
    )
