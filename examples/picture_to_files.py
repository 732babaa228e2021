"""A picture to a design: the joints, the misfit, and all files in a folder."""

from pathlib import Path

from profiletool import design, files_of

PICTURE = Path(__file__).parents[1] / "samples" / "bulb.png"

result = design(PICTURE, verify=False)  # without finite elements: a matter of seconds
found = result.design
print(f"{len(found.joints)} joints at {found.pressure_bar:.2f} bar, {found.tube.length_mm:.0f} mm")
for joint in found.joints:
    print(
        f"joint {joint.number}: F {joint.F_mm:g} mm, openF {joint.openF_mm:g} mm, "
        f"alpha {joint.alpha_closed_deg:.1f} deg, theta {joint.theta_response_deg:.1f} deg"
    )

folder = Path("bulb")
folder.mkdir(exist_ok=True)
for name, data in files_of(result).items():
    (folder / name).write_bytes(data)
print(f"{len(list(folder.iterdir()))} files in the folder {folder}")
