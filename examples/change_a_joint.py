"""A design with one joint changed by hand, verified anew by finite elements."""

from dataclasses import replace
from pathlib import Path

from profiletool import find_subject, load_design, verify_design

SAMPLES = Path(__file__).parents[1] / "samples"

design = load_design(SAMPLES / "paper_bulb.json")
profile = find_subject(SAMPLES / "bulb.png").profile
for alpha in (132.0, 120.0):
    last = replace(design.joints[-1], alpha_closed_deg=alpha)
    check = verify_design(replace(design, joints=(*design.joints[:-1], last)), profile)
    found = check.design
    print(
        f"joint {last.number}, alpha {alpha:g} deg: theta {found.joints[-1].theta_fe_deg:.1f} deg, "
        f"{found.fit.fe.rms_mm:.2f} mm RMS off the profile, verified: {found.verified}"
    )
