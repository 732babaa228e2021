"""A design with one joint changed by hand: finite elements tell what one more thread does."""

from dataclasses import replace
from math import degrees
from pathlib import Path

from profiletool import design, verify_design

result = design(Path(__file__).parents[1] / "samples" / "egg.png", verify=False)
planned = result.design
thread_deg = degrees(planned.gauze.pitch_mm / (0.5 * planned.tube.outer_diameter_mm))

first, *others = planned.joints
changed = replace(first, alpha_closed_deg=first.alpha_closed_deg + thread_deg)
for joint in (first, changed):
    check = verify_design(replace(planned, joints=(joint, *others)), result.subject.profile)
    found = check.design
    print(
        f"joint 1, alpha {joint.alpha_closed_deg:.1f} deg: "
        f"theta {found.joints[0].theta_fe_deg:.1f} deg, "
        f"{found.fit.fe.rms_mm:.2f} mm RMS off the profile, verified: {found.verified}"
    )
