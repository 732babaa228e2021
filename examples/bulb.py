"""A picture to a design: the joints, the misfit, and all files in a folder."""

from pathlib import Path

from profiletool import design, files_of

PICTURE = Path(__file__).parents[1] / "samples" / "bulb.png"

result = design(PICTURE, verify=False)  # without finite elements: a matter of seconds
print(result)

folder = Path("bulb")
folder.mkdir(exist_ok=True)
for name, data in files_of(result).items():
    (folder / name).write_bytes(data)
print(f"{len(list(folder.iterdir()))} files in {folder}")
