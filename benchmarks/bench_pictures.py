"""Angles measured in rendered pictures of a twin, against the truth: how far off, how honest.

The twin is a design built in softer rubber and a thinner wall, with sectors that act wider and a
gauge that reads too much; `samples/bench.py` takes its pictures, at 8 px/mm.

    python benchmarks/bench_pictures.py [DESIGN.json] [--only NAME ...] [--levels 10]

Without a design it is the finger of the paper's Table 2.
"""

from __future__ import annotations

import argparse
import importlib.util
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from _common import machine, table

from profiletool.files.design_json import load_design
from profiletool.records.bench import Seen
from profiletool.records.design import Design, Joint
from profiletool.records.frames import direction, outward
from profiletool.records.picture import Picture
from profiletool.records.side import side_sign
from profiletool.records.units import FloatArray
from profiletool.subject.tube.family import Family, family_of
from profiletool.subject.tube.series import measure_series
from profiletool.subject.tube.views import Looked
from profiletool.verify.predicted import predicted_by_fe
from profiletool.verify.run import Run, inflate
from profiletool.verify.tube import FINGER, actuator_of

SAMPLES = Path(__file__).parents[1] / "samples"
DEAD_BAR, TWIN = 0.04, {"rubber": 0.9, "wall": 0.97, "thread": 3.0}
GIVEN_MM_PER_PX = 0.124  # of the views without the sheet; it is 0.125 on the ground
WIDE = (2000, 1600)


def _bench() -> ModuleType:
    spec = importlib.util.spec_from_file_location("samples_bench", SAMPLES / "bench.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


bench = _bench()
Shot = bench.Shot
LYING = bench.Lying(y=-45.0)
ON_SHEET = bench.Lying(x=-48.0, y=-45.0)  # bent, it stays inside the printed frame


@dataclass(frozen=True)
class Scene:
    """How pictures are taken: with the object or without; ``alone``: each measured by itself."""

    shot: Any
    lying: Any = LYING
    object: bool = False
    alone: bool = False


SCENES = {
    "squarely": Scene(Shot(size=WIDE)),
    "slanted": Scene(Shot(500.0, 15.0, size=(2000, 1700), sheet=True), ON_SHEET),
    "afar": Scene(Shot(2000.0, 8.0, size=(2000, 1700), sheet=True), ON_SHEET),
    "object": Scene(Shot(size=WIDE), object=True),
    "patches": Scene(Shot(size=WIDE, ground="patches")),
    "alone": Scene(Shot(size=WIDE), alone=True),
    "wood": Scene(Shot(size=WIDE, ground="wood"), alone=True),
}


def paper_finger() -> Design:
    """Give the finger of Table 2 as a design: F 40, 22 and 20 mm behind a root of 10."""
    bulb = load_design(SAMPLES / "paper_bulb.json")
    F = (40.0, 22.0, 20.0)
    centres = np.cumsum([10.0, *F])
    joints = tuple(
        Joint(k + 1, F[k], openF, alpha, 270.0, 0.0, 0.0, None, float(centres[k]))
        for k, (openF, alpha) in enumerate(FINGER)
    )
    tube = replace(bulb.tube, length_mm=float(centres[-1]))
    return replace(bulb, joints=joints, tube=tube, pressure_bar=1.8)


def twin_run(design: Design, bars: Sequence[float]) -> Run:
    """Inflate its twin: the state at rest, then one for each pressure on the gauge."""
    inside = [bar - DEAD_BAR for bar in bars]
    twin = bench.twin_of(design, **TWIN)
    return inflate(actuator_of(twin), inside, design.base_pose, side_sign(design.source.side))


def seen_and_true(
    design: Design, scene: Scene, family: Family, twin: Run, bars: Sequence[float]
) -> Iterator[tuple[Seen, FloatArray]]:
    """Photograph a twin at the pressures of its run, and measure it: (seen, true deg)."""
    sign, rng = side_sign(design.source.side), np.random.default_rng(0)
    outline = object_outline(design, sign) if scene.object else None
    shots = [
        bench.photograph(twin.solution.mesh, state, sign, scene.shot, scene.lying, rng, outline)
        for state in twin.solution.states[1:]
    ]
    looked = Looked(None if scene.shot.sheet else GIVEN_MM_PER_PX)
    together = [[k] for k in range(len(bars))] if scene.alone else [[*range(len(bars))]]
    for some in together:
        pictures = [Picture(shots[k], None, None, "JPEG") for k in some]
        names = [f"{bars[k]:g} bar" for k in some]
        found = measure_series(family, names, [bars[k] for k in some], pictures.__getitem__, looked)
        for one, k in zip(found, some, strict=True):
            yield one, np.array(twin.verification.states[k].theta_deg)


def object_outline(design: Design, sign: float) -> FloatArray:
    """Lay the sample bulb beside the actuator that is designed for it, on the ground."""
    outline = np.loadtxt(SAMPLES / "truth" / "bulb.csv", delimiter=",", skiprows=1)
    pose = design.base_pose
    along = direction(np.radians(pose.heading_deg))
    toward = -outward(np.radians(pose.heading_deg), sign)
    off = outline - np.array([pose.x_mm, pose.y_mm])
    radius = 0.5 * design.tube.outer_diameter_mm
    flat = np.column_stack([off @ along, off @ toward + radius, np.zeros(len(off))])
    return np.asarray(bench.placed(flat, LYING, sign)[:, :2])


def measured(found: Sequence[tuple[Seen, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    """Errors, deg, of the angles that are not lost, and their sigmas."""
    told = [
        (angle.theta_deg - theta, angle.sigma_deg)
        for seen, true in found
        for angle, theta in zip(seen.angles, true.tolist(), strict=True)
        if angle.state != "lost"
    ]
    return tuple(np.array(told).T)


def main(given: Sequence[str] | None = None) -> None:
    """Print a row for each scene."""
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("design", type=Path, nargs="?")
    words.add_argument("--only", nargs="+", choices=SCENES, default=list(SCENES))
    words.add_argument("--levels", type=int, default=10)
    asked = words.parse_args(given)
    design = paper_finger() if asked.design is None else load_design(asked.design)
    bars = [design.pressure_bar * (k + 1) / asked.levels for k in range(asked.levels)]
    family = family_of(predicted_by_fe(design, bars[-1]))
    twin = twin_run(design, bars)
    print(machine(), flush=True)
    rows = []
    for name in asked.only:
        found = list(seen_and_true(design, SCENES[name], family, twin, bars))
        off, sigma = measured(found)
        size = np.abs(off)
        rows.append(
            (name, sum(len(seen.angles) for seen, _ in found) - len(off), len(off),
             f"{np.percentile(size, 95):.2f}", f"{size.max():.2f}", f"{np.median(sigma):.2f}",
             f"{100.0 * np.mean(size < sigma):.0f}", f"{100.0 * np.mean(size < 2.0 * sigma):.0f}")
        )  # fmt: skip
        print(*rows[-1], flush=True)
    head = ("scene", "lost", "angles", "95 % deg", "most deg", "sigma deg", "in 1", "in 2")
    print(table(head, rows))


if __name__ == "__main__":
    main()
