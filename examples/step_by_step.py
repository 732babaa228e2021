"""The stages of a design one by one; each cell (`# %%`) can be run alone in an editor."""

# %% Find the object in the picture, its scale, and the profile to follow.
from pathlib import Path

from profiletool import design, files_of, find_subject, plan_joints

SAMPLES = Path(__file__).parents[1] / "samples"

subject = find_subject(SAMPLES / "egg.png")
profile = subject.profile
width, height = profile.outline.max(axis=0) - profile.outline.min(axis=0)
print(f"scale: {subject.scale.mm_per_px:.4f} mm per pixel, from the {subject.scale.source}")
print(f"object: {width:.1f} x {height:.1f} mm, {profile.length_mm:.1f} mm of profile to follow")

# %% Choose joints for it: first by the paper's method, then all at once by the joint response.
for method in ("paper", "optimal"):
    layout = plan_joints(profile, method=method).layout
    print(f"{method}: {len(layout.joints)} joints at {layout.pressure_bar:.2f} bar")

# %% Make the whole design; leave out verify=False to have it corrected by finite elements.
result = design(profile, verify=False)
print(f"{result.design.fit.response.rms_mm:.2f} mm RMS off the profile by the joint response")
for note in result.design.warnings:
    print(f"note: {note}")

# %% Take some of its files.
files = files_of(result)
for name in ("design.json", "template.dxf", "overlay.png"):
    Path(name).write_bytes(files[name])
    print(f"{name}: {len(files[name])} bytes")
