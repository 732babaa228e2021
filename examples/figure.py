"""A figure of your own with matplotlib: the profile, and the tube bent beside it."""

from pathlib import Path

import matplotlib.pyplot as plt

from profiletool import design

result = design(Path(__file__).parents[1] / "samples" / "pear.png", verify=False)
profile, bent = result.subject.profile, result.plan.bent

figure, axes = plt.subplots(figsize=(4.0, 6.5), layout="constrained")
axes.fill(*profile.outline.T, color="0.9", label="object")
axes.plot(*profile.points.T, color="black", label="profile to follow")
axes.plot(*bent.facing.T, color="tab:orange", label="object-facing line of the tube")
axes.set(aspect="equal", xlabel="x / mm", ylabel="y / mm")
figure.legend(loc="outside lower center")
figure.savefig("pear_figure.png", dpi=150)

rms = result.design.fit.response.rms_mm
print(f"pear_figure.png: {len(result.design.joints)} joints, {rms:.2f} mm RMS off the profile")
