"""Photographs of an actuator on the bench, rendered from finite elements: the angles are known.

A tube of silicone in gauze lies on a table, held by a clamp, and is inflated in steps. The picture
shows what a lens would: perspective, a shadow, blur, noise, JPEG. The skin bulges at the cuts as
finite elements say. Beside the pictures lies truth.csv, with the
angles of the joints, and truth_tube.json, the tube that was rendered.

    python samples/bench.py DESIGN.json --pressures 0,0.6,1.2 --out DIR
        [--rubber 0.9] [--wall 1.03] [--thread 3] [--dead 0.05] [--noise 2] [--sheet] [--tilt 8]

``--rubber`` and ``--wall`` are shares of the design's, ``--thread`` deg that every uncut sector is
wider, ``--dead`` bar that the gauge reads too much. mm, N, MPa, rad inside; the ground's frame: x
to the right, y down, z away from the viewer, origin in the middle of the picture.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from fem import Mesh, State
from formula.rubber import RubberLaw
from profiletool import Design, load_design
from profiletool.files.tube_json import tube_json
from profiletool.image.sheet.board import board_for, ink
from profiletool.records.calibrated import CalibratedTube
from profiletool.records.rubber import law_of
from profiletool.records.side import side_sign
from profiletool.verify.lines import on_line
from profiletool.verify.run import inflate
from profiletool.verify.tube import actuator_of

FloatArray = NDArray[np.float64]

AROUND_STEP, ALONG_MM = np.radians(2.4), 0.4
BEYOND = np.radians(24.0)  # of the half that faces the viewer: what a slanting view shows
PITCH_MM, THREAD_MM = 2.0, 0.25
FINE = 3  # of the picture's pixels, that the tube is drawn in
SHEET_PX_PER_MM = 10
SILICONE, THREAD, CLAMP = (
    np.array(c) for c in ((0.62, 0.64, 0.66), (0.86, 0.86, 0.82), (0.1,) * 3)
)
PATCHES = (
    (-75.0, -42.0, -40.0, -12.0),
    (-35.0, 0.0, 10.0, 40.0),
)  # x0, y0, x1, y1 on the ground, mm
GROUNDS = {
    "paper": (0.93, 0.92, 0.88), "patches": (0.93, 0.92, 0.88), "wood": (0.45, 0.29, 0.16),
    "dark": (0.13, 0.14, 0.16),
}  # fmt: skip


@dataclass(frozen=True)
class Shot:
    """How a picture is taken.

    ``tilt_deg`` is the slant of the line of sight toward ``azimuth_deg`` (0: right, 90: down);
    ``distance`` mm from the lens to the ground; ``px_per_mm`` there, in the middle.
    """

    distance: float = 1000.0
    tilt_deg: float = 0.0
    azimuth_deg: float = 90.0
    roll_deg: float = 0.0
    px_per_mm: float = 8.0
    size: tuple[int, int] = (1280, 1280)
    blur_px: float = 0.7
    noise: float = 2.0
    jpeg: int = 90
    ground: str = "paper"
    sheet: bool = False

    @property
    def focal(self) -> float:
        """Focal length, px."""
        return self.px_per_mm * self.distance

    def camera(self) -> tuple[FloatArray, FloatArray]:
        """Place of the lens, and its axes: right, down, sight."""
        tilt, azimuth, roll = np.radians([self.tilt_deg, self.azimuth_deg, self.roll_deg])
        toward = np.array([np.cos(azimuth), np.sin(azimuth)]) * np.sin(tilt)
        place = self.distance * np.array([*toward, -np.cos(tilt)])
        sight = -place / self.distance
        right = np.cross([0.0, 1.0, 0.0], sight)
        right /= np.linalg.norm(right)
        down = np.cross(sight, right)
        c, s = np.cos(roll), np.sin(roll)
        return place, np.stack([c * right + s * down, c * down - s * right, sight])

    def seen(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Pixels (..., 2) and depths (...) of points (..., 3)."""
        place, axes = self.camera()
        off = (points - place) @ axes.T
        middle = (np.array(self.size) - 1.0) / 2.0
        return self.focal * off[..., :2] / off[..., 2:] + middle, off[..., 2]

    def spots(self) -> FloatArray:
        """Places on the ground that the pixels show: (H, W, 2)."""
        place, axes = self.camera()
        w, h = self.size
        u = (np.arange(w) - (w - 1) / 2) / self.focal
        v = (np.arange(h) - (h - 1) / 2) / self.focal
        rays = np.stack(np.meshgrid(u, v), axis=-1) @ axes[:2] + axes[2]
        return place[:2] - rays[..., :2] * (place[2] / rays[..., 2:])


@dataclass(frozen=True)
class Lying:
    """Where the actuator lies on the ground: its axis at the clamp, and which way it points.

    ``heading`` is clockwise from the right, as seen; ``mirrored`` where it is seen from behind.
    """

    x: float = 0.0
    y: float = -50.0
    heading: float = np.pi / 2
    mirrored: bool = False
    height: float = 10.0


def skin(mesh: Mesh, state: State, sign: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Places of the outer surface along and around: (S,), (A,), and points (S, A, 3).

    Their frame: x along the clamped tube, y to the object's side, z toward the viewer, origin on
    the axis at the clamp. ``sign`` is that of the design's side.
    """
    length = mesh.actuator.length
    along = np.linspace(0.0, length, round(length / ALONG_MM) + 1)
    last = np.pi / 2 + BEYOND
    around = np.linspace(-last, last, round(2.0 * last / AROUND_STEP) + 1)
    beyond = np.maximum(along - mesh.actuator.free_length, 0.0)[:, None]
    end = beyond * (state.shape.rotation[-1] @ [0.0, 0.0, 1.0])
    nearest = np.abs(around) <= np.pi / 2
    same = np.where(nearest, around, np.copysign(np.pi, around) - around)  # in the half modelled
    found = np.stack([on_line(mesh, state.x, along, phi) + end for phi in same], axis=1)
    across, up, z = np.moveaxis(found, -1, 0)
    across = np.where(nearest, across, -across)
    return along, around, np.stack([z, -up, across], axis=-1)


def placed(points: FloatArray, lying: Lying, sign: float) -> FloatArray:
    """Put points of the actuator's frame on the ground."""
    hand = -sign if lying.mirrored else sign
    c, s = np.cos(lying.heading), np.sin(lying.heading)
    x, y = points[..., 0], -hand * points[..., 1]  # y down
    return np.stack(
        [lying.x + c * x - s * y, lying.y + s * x + c * y, -lying.height - points[..., 2]], axis=-1
    )


def photograph(
    mesh: Mesh,
    state: State,
    sign: float,
    shot: Shot,
    lying: Lying,
    rng: np.random.Generator,
    object_outline: FloatArray | None = None,
) -> NDArray[np.uint8]:
    """Take a picture of a state: (H, W, 3) RGB.

    ``object_outline`` (N, 2) mm lies flat on the ground, in the ground's frame.
    """
    colour = _ground(shot, rng)
    if object_outline is not None:
        px, _ = shot.seen(np.column_stack([object_outline, np.zeros(len(object_outline))]))
        body = _filled(px, shot)[..., None]
        colour = colour * (1.0 - body) + body * np.array([0.75, 0.6, 0.35])
    along, around, points = skin(mesh, state, sign)
    radius = mesh.actuator.radius
    points = placed(points, lying, sign)
    tube, cover = _tube(along, around, points, shot, rng)
    moved = np.float32([[1, 0, 12], [0, 1, 9]])
    shadow = cv2.warpAffine(gaussian_filter(cover, 14.0), moved, shot.size)
    colour *= 1.0 - 0.45 * shadow[..., None]
    colour = colour * (1.0 - cover[..., None]) + tube
    colour = _clamp(colour, shot, lying, radius, sign)
    colour = colour ** (1.0 / 2.2) * 255.0
    colour = gaussian_filter(colour, (shot.blur_px, shot.blur_px, 0.0))
    colour += rng.normal(0.0, shot.noise, colour.shape)
    rgb = np.clip(np.round(colour), 0, 255).astype(np.uint8)
    _, data = cv2.imencode(".jpg", rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, shot.jpeg])
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR)[..., ::-1], np.uint8)


def _ground(shot: Shot, rng: np.random.Generator) -> FloatArray:
    """Colour of the ground at every pixel, linear light."""
    spots = shot.spots()
    w, h = shot.size
    if shot.sheet:
        board = board_for("a4")
        paper_w, paper_h = board.paper_mm
        sheet = np.full((round(paper_h * SHEET_PX_PER_MM), round(paper_w * SHEET_PX_PER_MM)), 0.9)
        for x0, y0, x1, y1 in np.round(
            (ink(board) + np.tile(board.origin_mm, 2)) * SHEET_PX_PER_MM
        ):
            sheet[int(y0) : int(y1), int(x0) : int(x1)] = 0.05
        sheet = gaussian_filter(sheet, 1.0).astype(np.float32)
        at = (spots + np.array(board.paper_mm) / 2) * SHEET_PX_PER_MM - 0.5
        at = at.astype(np.float32)
        seen = cv2.remap(sheet, at, None, cv2.INTER_LINEAR, borderValue=0.4)
        return np.repeat(np.asarray(seen, float)[..., None], 3, axis=2)
    if shot.ground == "silicone":
        base = 0.97 * (0.8 * SILICONE + 0.2 * THREAD)
    else:
        base = np.array(GROUNDS[shot.ground])
    base = np.broadcast_to(base, (h, w, 3)).copy()
    if shot.ground == "patches":  # of the tube's own colour, where it lies over them
        for x0, y0, x1, y1 in PATCHES:
            x, y = spots[..., 0], spots[..., 1]
            base[(x > x0) & (x < x1) & (y > y0) & (y < y1)] = 0.8 * SILICONE + 0.2 * THREAD
    light = 1.0 + 0.12 * (spots[..., 0] / 160.0) + 0.08 * (spots[..., 1] / 160.0)
    grain = gaussian_filter(
        rng.normal(0.0, 1.0, (h, w)), (1.0, 30.0) if shot.ground == "wood" else 3.0
    )
    grain *= 0.1 / grain.std() if shot.ground == "wood" else 0.015 / grain.std()
    return np.clip(base * (light + grain)[..., None], 0.0, 1.0)


def _tube(
    along: FloatArray, around: FloatArray, points: FloatArray, shot: Shot, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Colour of the tube times its cover, and the cover, at every pixel."""
    px, depth = shot.seen(points)
    tangent = np.gradient(points, axis=0)
    normal = np.cross(tangent, np.gradient(points, axis=1))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True) + 1e-12
    place, _ = shot.camera()
    sight = place - points
    facing = np.einsum("sak,sak->sa", normal, sight)
    outward = np.where(facing[len(along) // 2, len(around) // 2] > 0.0, 1.0, -1.0)
    light = np.array([-0.35, -0.5, -0.8])
    shade = 0.55 + 0.45 * np.clip(outward * normal @ (light / np.linalg.norm(light)), 0.0, 1.0)
    colour = _weave(along, around, rng) * shade[..., None]
    size = (FINE * shot.size[1], FINE * shot.size[0])
    drawn, cover = np.zeros((*size, 3), np.float32), np.zeros(size, np.uint8)
    corners = FINE * (np.stack([px[:-1, :-1], px[1:, :-1], px[1:, 1:], px[:-1, 1:]], 2) + 0.5) - 0.5
    shown = np.round(16 * corners).astype(np.int32)
    mean = 0.25 * (colour[:-1, :-1] + colour[1:, :-1] + colour[1:, 1:] + colour[:-1, 1:])
    order = np.argsort(
        -0.25 * (depth[:-1, :-1] + depth[1:, :-1] + depth[1:, 1:] + depth[:-1, 1:]).ravel()
    )
    quads, shades = shown.reshape(-1, 4, 2), mean.reshape(-1, 3).tolist()
    for k in order.tolist():
        cv2.fillConvexPoly(drawn, quads[k], shades[k], shift=4)
        cv2.fillConvexPoly(cover, quads[k], 255, shift=4)
    inside = cover > 0
    both = np.dstack([np.where(inside[..., None], drawn, 0.0), inside.astype(np.float32)])
    small = np.asarray(cv2.resize(both, shot.size, interpolation=cv2.INTER_AREA), float)
    return small[..., :3], small[..., 3]


def _weave(along: FloatArray, around: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Silicone seen through gauze: threads along and around, at every place of the skin."""
    arc = 10.0 * around + rng.uniform(0.0, PITCH_MM)
    threads = np.maximum(
        (np.mod(along, PITCH_MM) < THREAD_MM)[:, None], (np.mod(arc, PITCH_MM) < THREAD_MM)[None]
    )
    soft = gaussian_filter(rng.normal(0.0, 1.0, threads.shape), 12.0)
    base = SILICONE * (1.0 + 0.04 * (soft / soft.std())[..., None])
    cover = 0.8 * threads[..., None]
    return np.asarray(base * (1.0 - cover) + THREAD * cover)


def _clamp(colour: FloatArray, shot: Shot, lying: Lying, radius: float, sign: float) -> FloatArray:
    """Draw the clamp over the tube's start."""
    half, deep = radius + 4.0, 24.0
    box = np.array([[-deep, -half, 0.0], [0.0, -half, 0.0], [0.0, half, 0.0], [-deep, half, 0.0]])
    px, _ = shot.seen(placed(box, lying, sign))
    cover = _filled(px, shot)[..., None]
    return np.asarray(colour * (1.0 - cover) + CLAMP * cover)


def _filled(px: FloatArray, shot: Shot) -> FloatArray:
    cover = np.zeros((FINE * shot.size[1], FINE * shot.size[0]), np.uint8)
    cv2.fillPoly(cover, [np.round(16 * (FINE * (px + 0.5) - 0.5)).astype(np.int32)], 255, shift=4)
    return np.asarray(cv2.resize(cover, shot.size, interpolation=cv2.INTER_AREA), float) / 255.0


# --- a twin: the same design, built with other rubber, wall and gauze ----------------------------


def twin_of(design: Design, rubber: float = 1.0, wall: float = 1.0, thread: float = 0.0) -> Design:
    """Build a design otherwise: stiffness and wall as shares, sectors wider by deg."""
    known = law_of(design.tube.rubber)
    stiff = {k: rubber * v for k, v in known.constants.items() if not isinstance(v, tuple)}
    tube = replace(
        design.tube,
        rubber=RubberLaw("twin", known.name, stiff),
        wall_mm=wall * design.tube.wall_mm,
    )
    extra = design.model.sector_extra_deg + thread
    return replace(design, tube=tube, model=replace(design.model, sector_extra_deg=extra))


def tube_of(twin: Design, dead_bar: float) -> CalibratedTube:
    """Write the twin's tube down, as if it were calibrated without any error."""
    assert twin.tube.rubber is not None
    return CalibratedTube(
        twin.source.file, "", None, twin.tube.outer_diameter_mm, twin.tube.wall_mm,
        twin.tube.rubber, None, dead_bar, twin.model.sector_extra_deg, (), 0, (), 0.0, 0.0, None,
        (), (),
    )  # fmt: skip


def _main(given: Sequence[str] | None = None) -> None:
    asked = _words().parse_args(given)
    design = load_design(asked.design)
    twin = twin_of(design, asked.rubber, asked.wall, asked.thread)
    bars = [float(bar) for bar in asked.pressures.split(",")]
    sign = side_sign(design.source.side)
    inside = [bar - asked.dead for bar in bars if bar > asked.dead]
    run = inflate(actuator_of(twin), inside, design.base_pose, sign)
    states = {round(10.0 * s.pressure, 9): s for s in run.solution.states}
    told = {s.pressure_bar: s for s in (run.verification.rest, *run.verification.states)}
    shot = Shot(
        asked.distance, asked.tilt, px_per_mm=asked.px_per_mm, noise=asked.noise,
        ground=asked.ground, sheet=asked.sheet, size=(asked.width, asked.high),
    )  # fmt: skip
    rng = np.random.default_rng(asked.seed)
    rows = ["picture,pressure_bar,joint,theta_deg"]
    asked.out.mkdir(parents=True)
    for bar in bars:
        at = min(states, key=lambda p: abs(p - max(bar - asked.dead, 0.0)))
        picture = photograph(run.solution.mesh, states[at], sign, shot, Lying(), rng)
        name = f"bar_{bar:.2f}.jpg"
        quality = [cv2.IMWRITE_JPEG_QUALITY, 95]
        cv2.imwrite(str(asked.out / name), picture[..., ::-1], quality)
        theta = min(told.items(), key=lambda pair: abs(pair[0] - at))[1].theta_deg
        rows += [f"{name},{bar:g},{k},{angle:.4f}" for k, angle in enumerate(theta, start=1)]
    (asked.out / "truth.csv").write_text("\n".join(rows) + "\n", "utf-8")
    (asked.out / "truth_tube.json").write_bytes(tube_json(tube_of(twin, asked.dead)))


def _words() -> argparse.ArgumentParser:
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("design", type=Path)
    words.add_argument("--pressures", required=True)
    words.add_argument("--out", type=Path, required=True)
    for name, usual in (
        ("rubber", 1.0), ("wall", 1.0), ("thread", 0.0), ("dead", 0.0), ("noise", 2.0),
        ("tilt", 0.0), ("distance", 1000.0), ("px-per-mm", 8.0),
    ):  # fmt: skip
        words.add_argument(f"--{name}", type=float, default=usual)
    for name, usual in (("seed", 0), ("width", 1280), ("high", 1280)):
        words.add_argument(f"--{name}", type=int, default=usual)
    words.add_argument("--ground", choices=[*GROUNDS, "silicone"], default="paper")
    words.add_argument("--sheet", action="store_true")
    return words


if __name__ == "__main__":
    _main()
