"""Pictures of the guide, made anew from the sample bulb.

Run as ``python docs/pictures.py``. Needs profiletool with the extra [test] (meshio reads the FE
meshes). The same library versions give the same bytes; every picture stays below 200 kB.
"""

from __future__ import annotations

import csv
import io
import json
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import matplotlib.pyplot as plt
import meshio
import numpy as np
from matplotlib.collections import PolyCollection
from PIL import Image

HERE = Path(__file__).parent
SAMPLE = HERE.parent / "samples" / "bulb.png"
PICTURES = HERE / "pictures"

_WIDE_PX = 1300
_SHOWN = (0, 3, 7, 10)  # states of the series: at rest, at 30, 70 and 100 % of the pressure
# Corner and mid-side nodes of a brick's outer face, in the order of VTK's quadratic hexahedron.
_OUTER_FACE = (1, 9, 2, 18, 6, 13, 5, 17)
_WRAPPED, _CUT = np.array([0.62, 0.66, 0.70]), np.array([0.93, 0.60, 0.36])
_BLUE, _RED, _INK = "#0072b2", "#d55e00", "#222222"


def main() -> None:
    """Make all pictures."""
    plt.rcParams.update({"font.size": 10, "axes.spines.top": False, "axes.spines.right": False})
    with TemporaryDirectory() as place:
        made = Path(place) / "bulb"
        _call("design", str(SAMPLE), "--out", str(made), "--quiet")
        _write("overlay.jpg", Image.open(made / "overlay.png"))
        for name in ("theta_vs_pressure.png", "trade_off.png", "error_along_arc.png"):
            _write(name, Image.open(made / name))
        (PICTURES / "template.svg").write_bytes((made / "template.svg").read_bytes())
        _write("inflation.jpg", _drawn(inflation(made)))
        example = HERE.parent / "examples" / "figure.py"
        subprocess.run(
            [sys.executable, str(example)], check=True, cwd=place, stdout=subprocess.DEVNULL
        )
        (PICTURES / "pear_figure.png").write_bytes((Path(place) / "pear_figure.png").read_bytes())
    _write("formula.png", _drawn(formula()))


def inflation(folder: Path) -> Any:
    """Draw the FE mesh beside the object at four pressures.

    Parameters
    ----------
    folder : Path
        Of a verified design.
    """
    design = json.loads((folder / "design.json").read_text())
    source, pose = design["source"], design["base_pose"]
    scale, (x0, y0) = source["mm_per_px"], source["origin_px"]
    photo = np.asarray(Image.open(SAMPLE).convert("RGB"))
    height, width = photo.shape[:2]
    sides = (-0.5 - x0, width - 0.5 - x0, y0 - height + 0.5, y0 + 0.5)
    figure, panels = plt.subplots(1, len(_SHOWN), figsize=(12.0, 3.0), layout="constrained")
    for axes, state in zip(panels, _SHOWN, strict=True):
        axes.imshow(photo, extent=[scale * side for side in sides], alpha=0.55)
        polygons, colours = _outer_faces(folder / f"actuator_{state:02d}.vtu", design, pose)
        axes.add_collection(PolyCollection(polygons, facecolors=colours, edgecolors="face", lw=0.4))
        axes.set_title(f"{design['pressure_bar'] * state / 10:.2f} bar", fontsize=11)
        axes.set(xlim=(-118.0, 32.0), ylim=(-110.0, 22.0), aspect="equal")
        axes.axis("off")
    return figure


def _outer_faces(file: Path, design: dict[str, Any], pose: dict[str, float]) -> tuple[Any, Any]:
    """Give the outer faces in the object frame, the farthest first, with their shades.

    Returns
    -------
    (N, 8, 2) mm and (N, 3) RGB
    """
    mesh = meshio.read(file)
    cells = mesh.cells_dict["hexahedron20"][:, _OUTER_FACE]
    joint = np.concatenate(mesh.cell_data["joint"])
    faces = (mesh.points + mesh.point_data["displacement"])[cells]
    x, y, _ = mesh.points[cells].mean(axis=1).T
    phi = np.degrees(np.arctan2(y, x))
    cut = np.zeros(len(joint), dtype=bool)
    for row in design["joints"]:
        off = (phi - row["alpha_center_deg"] + 180.0) % 360.0 - 180.0
        cut |= (joint == row["number"]) & (np.abs(off) > 0.5 * row["alpha_closed_deg"])
    seen = x >= 0.0  # the half of the tube on the viewer's side
    order = np.argsort(faces[seen].mean(axis=1)[:, 0])
    faces, cut = faces[seen][order], cut[seen][order]
    normal = np.cross(faces[:, 2] - faces[:, 0], faces[:, 6] - faces[:, 0])
    light = np.abs(normal[:, 0]) / np.linalg.norm(normal, axis=1)
    base = np.where(cut[:, None], _CUT, _WRAPPED)
    heading = np.radians(pose["heading_deg"])
    sign = 1.0 if design["source"]["side"] == "left" else -1.0
    along = np.array([np.cos(heading), np.sin(heading)])
    outward = sign * np.array([np.sin(heading), -np.cos(heading)])
    off = faces[..., 1, None] + 0.5 * design["tube"]["outer_diameter_mm"]
    placed = np.array([pose["x_mm"], pose["y_mm"]]) + faces[..., 2, None] * along + off * outward
    return placed, np.clip(base * (0.45 + 0.6 * light[:, None]), 0.0, 1.0)


def formula() -> Any:
    """Draw formula (9) and finite elements: theta over the pressure, and over alpha."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.6), layout="constrained")
    run = json.loads(_call("profiletool", "joint", "--openF", "10", "--alpha", "84", "--json"))
    paper, ours = _table("paper"), _table("fe")
    row = {P: theta for P, alpha, theta in paper if alpha == 84.0}
    left.plot([0.0, *row], [0.0, *row.values()], color=_RED, label="formula (9)")
    left.plot(
        [0.0, *run["pressure_bar"]], [0.0, *run["theta_deg"][0]],
        color=_BLUE, marker="o", ms=4, label="finite elements",
    )  # fmt: skip
    left.set(xlabel="pressure (bar)", ylabel="θ (deg)")
    left.set_title("openF 10 mm, alpha_closed 84 deg", fontsize=10, loc="left")
    for table, colour, name in ((paper, _RED, "formula (9)"), (ours, _BLUE, "finite elements")):
        for bar, style in ((1.0, "--"), (2.0, "-")):
            points = [(alpha, theta) for P, alpha, theta in table if bar == P]
            right.plot(*zip(*points, strict=True), color=colour, ls=style, marker="o", ms=3,
                       label=f"{name}, {bar:.0f} bar")  # fmt: skip
    right.set(xlabel="alpha_closed (deg)", ylabel="θ (deg)", ylim=(0.0, None))
    right.set_title("openF 10 mm", fontsize=10, loc="left")
    for axes in (left, right):
        axes.legend(frameon=False, fontsize=8)
    return figure


def _table(name: str) -> list[tuple[float, float, float]]:
    """Rows (bar, alpha_closed in deg, theta in deg) of a formula's table at openF 10 mm."""
    text = _call("profiletool", "table", "--formula", name, "--openF", "10", "--csv")
    return [
        (float(row["pressure_bar"]), float(row["alpha_closed_deg"]), float(row["theta_deg"]))
        for row in csv.DictReader(io.StringIO(text))
    ]


def _call(command: str, *words: str) -> str:
    """Run a command of this Python's environment; its standard output."""
    program = Path(sys.executable).with_name(command)
    return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout


def _drawn(figure: Any) -> Image.Image:
    """Turn a figure into a picture."""
    buffer = io.BytesIO()
    figure.savefig(buffer, dpi=130, facecolor="white")
    plt.close(figure)
    return Image.open(buffer)


def _write(name: str, picture: Image.Image) -> None:
    """Write a picture no wider than the page: photographs as JPEG, plots with a palette."""
    picture = picture.convert("RGB")
    if picture.width > _WIDE_PX:
        tall = round(picture.height * _WIDE_PX / picture.width)
        picture = picture.resize((_WIDE_PX, tall), Image.Resampling.LANCZOS)
    if name.endswith(".jpg"):
        picture.save(PICTURES / name, quality=84, subsampling=0, optimize=True)
        return
    palette = picture.quantize(96, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    palette.save(PICTURES / name, optimize=True)


if __name__ == "__main__":
    main()
