"""Render the sample pictures and write their true outlines beside them.

Every object is a body of revolution that lies on a table and is seen from straight above. Its
outline is made of lines and arcs that join with a common tangent, so the truth is exact.

Frame of all outlines: mm, x to the right, y up, origin at the object's top middle.
Lengths are mm unless a name says px; colours are linear light in 0..1 until they are encoded.

    python samples/render.py [NAME ...]
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image
from scipy.ndimage import gaussian_filter, map_coordinates, zoom

FloatArray = NDArray[np.float64]

HERE = Path(__file__).parent
CHORD_ERROR_MM = 0.001
SUBROWS = 32
BLUR_PX = 0.6
NOISE_8BIT = 0.75
RIM_NZ = 0.22
PITCH = 3.629  # E27, as is the depth below
THREAD_DEPTH = 1.0


# --- outlines ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Line:
    """Straight on."""

    length: float


@dataclass(frozen=True)
class Arc:
    """A turn of ``turn`` degrees; positive is clockwise: convex, on an object's right side."""

    radius: float
    turn: float


Step = Line | Arc


def trace(
    steps: Sequence[Step], heading_deg: float = 0.0, chord_error: float = CHORD_ERROR_MM
) -> FloatArray:
    """Walk along lines and arcs from the origin; (N, 2) points on the curve."""
    at, heading = np.zeros(2), np.radians(heading_deg)
    points = [at[None]]
    for step in steps:
        if isinstance(step, Line):
            run = at + np.array([[step.length * np.cos(heading), step.length * np.sin(heading)]])
        else:
            turn, sign = np.radians(abs(step.turn)), np.sign(step.turn)
            pieces = int(np.ceil(turn / np.sqrt(8 * chord_error / step.radius)))
            out = heading + sign * np.pi / 2  # from the centre to where we stand
            centre = at - step.radius * np.array([np.cos(out), np.sin(out)])
            angles = out - sign * np.linspace(0, turn, pieces + 1)[1:]
            run = centre + step.radius * np.column_stack([np.cos(angles), np.sin(angles)])
            heading -= sign * turn
        points.append(run)
        at = run[-1]
    return np.concatenate(points)


def close(before: list[Step], slant_deg: float, after: list[Step], height: float) -> list[Step]:
    """Join two runs by a line heading ``slant_deg`` such that the whole ends on the axis.

    ``after`` begins at that heading and ends heading left, at ``-height``.
    """
    head, tail = trace(before)[-1], trace(after, slant_deg)[-1]
    slant = (-height - head[1] - tail[1]) / np.sin(np.radians(slant_deg))
    inward = head[0] + tail[0] + slant * np.cos(np.radians(slant_deg))
    return [*before, Line(float(slant)), *after, Line(float(inward))]


def bulb(shift: float = 0.0) -> list[Step]:
    """Shape an A60 bulb, E27 cap; ``shift`` moves the thread down (half a pitch on the left)."""
    neck = float(np.degrees(np.arccos((13.3 + 40) / (30 + 40))))
    flank = 2 * np.degrees(np.arctan(THREAD_DEPTH / (PITCH / 2)))
    radius = PITCH / 4 / np.sin(np.radians(flank))
    wave = [Arc(radius, flank), Arc(radius, -2 * flank), Arc(radius, flank)]
    before: list[Step] = [Arc(30, 90 + neck), Arc(40, -neck), Line(6.4 + shift)]
    before += [*wave * 4, Line(PITCH / 2 + 0.4 - shift), Arc(1.5, 52)]
    tip: list[Step] = [Arc(1.5, -46), Line(0.9), Arc(1.2, 60), Arc(9, 24)]
    return close(before, -142, tip, 107.5)


def egg() -> Sequence[Step]:
    """Shape an egg 60 mm high and 44 wide: three circles, each inside the next."""
    side = float(np.degrees(np.arctan2(24, 32)))
    return [Arc(14, 90 - side), Arc(54, side), Arc(22, 90)]


def pear() -> list[Step]:
    """Shape a pear 90 mm high with a short stem."""
    before: list[Step] = [
        Line(1.0),
        Arc(0.8, 88),
        Line(7),
        Arc(3.0, -58),
        Arc(18, 48),
        Arc(60, -16),
    ]
    return close(before, -62, [Arc(30, 78), Arc(18, 40)], 90)


def bottle() -> list[Step]:
    """Shape a bottle 90 mm high: mouth with a bead, neck of radius 9, body of radius 17."""
    turn = float(np.degrees(np.arccos(1 - 8 / (10 + 15))))
    bead: list[Step] = [Line(8.0), Arc(2.2, 132), Arc(2.2, -42)]
    inset = 9 - trace(bead)[-1][0]
    bead[0] = Line(8.0 + float(inset))
    neck: list[Step] = [Line(13), Arc(10, -turn), Arc(15, turn)]
    return close([*bead, *neck], -90, [Arc(3.5, 90)], 90)


def vase() -> list[Step]:
    """Shape an hourglass vase 120 mm high."""
    before: list[Step] = [Line(25), Arc(2.5, 117), Line(14), Arc(40, -52)]
    foot: list[Step] = [Arc(30, 60), Arc(25, -42), Arc(2.5, 97)]
    return close(before, -65, foot, 120)


def finger_rest() -> FloatArray:
    """Draw the grip side of a hand tool, from its top end down: an open line, both curvatures."""
    steps = [Arc(60, 18), Arc(30, -48), Arc(34, 56), Arc(26, -42), Arc(45, 28)]
    return trace(steps, -82)


@dataclass(frozen=True)
class Body:
    """A body of revolution: the steps of its right and left meridian, from the top to the base.

    They differ by the turn of a thread alone.
    """

    right_steps: Sequence[Step]
    left_steps: Sequence[Step]

    @cached_property
    def right(self) -> FloatArray:
        """Right meridian (N, 2), fine enough to take normals from."""
        return trace(self.right_steps, chord_error=CHORD_ERROR_MM / 100)

    @cached_property
    def left(self) -> FloatArray:
        """Left meridian (N, 2), mirrored: x >= 0."""
        return trace(self.left_steps, chord_error=CHORD_ERROR_MM / 100)

    @property
    def height(self) -> float:
        """Length along the axis."""
        return float(-self.right[-1, 1])

    @property
    def radius(self) -> float:
        """The largest one."""
        return float(self.right[:, 0].max())

    def outline(self) -> FloatArray:
        """Return the outline, down the left side and up the right; the last point is the first."""
        left, right = trace(self.left_steps) * (-1, 1), trace(self.right_steps)
        ring: FloatArray = np.concatenate([left, right[::-1]]).round(4) + 0.0
        moved: NDArray[np.bool_] = np.any(ring[1:] != ring[:-1], axis=1)
        return np.concatenate([ring[:1], ring[1:][moved]])


def radius_at(meridian: FloatArray, y: FloatArray) -> FloatArray:
    """Radius at the heights ``y`` (any shape), 0 beyond the ends."""
    return np.interp(-y, -meridian[:, 1], meridian[:, 0], left=0.0, right=0.0)


# --- light ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Surface:
    """What the camera sees of a body, per pixel (H, W): place and normal (H, W, 3)."""

    x: FloatArray
    y: FloatArray
    r: FloatArray
    phi: FloatArray
    normal: FloatArray


def unit(v: ArrayLike) -> FloatArray:
    """Scale a vector to length 1."""
    vector = np.asarray(v, np.float64)
    return vector / float(np.linalg.norm(vector))


def smooth(edge0: float, edge1: float, v: FloatArray) -> FloatArray:
    """0 below edge0, 1 above edge1, smooth in between; the edges may come in either order."""
    t = np.clip((v - edge0) / (edge1 - edge0), 0, 1)
    return t * t * (3 - 2 * t)


KEY = unit((-0.55, 0.62, 0.80))
RIM = unit((0.92, -0.10, 0.42))


def window(
    ray: FloatArray, centre: FloatArray, half: tuple[float, float], soft: float
) -> FloatArray:
    """How much of a rectangular soft box each ray (H, W, 3) meets."""
    across = unit(np.cross((0.0, 1.0, 0.0), centre))
    up = np.cross(centre, across)
    ahead = np.maximum(ray @ centre, 1e-3)
    a, b = np.abs(ray @ across) / ahead, np.abs(ray @ up) / ahead
    lit = smooth(half[0] + soft, half[0] - soft, a) * smooth(half[1] + soft, half[1] - soft, b)
    return lit * (ray @ centre > 0)


def mirror(s: Surface) -> FloatArray:
    """Reflect the view ray, straight from above, at the surface (H, W, 3)."""
    ray = 2 * s.normal[..., 2:] * s.normal
    ray[..., 2] -= 1
    return ray


def gloss(s: Surface, strength: float, soft: float) -> FloatArray:
    """Reflections of the two soft boxes on a dielectric (H, W, 1), stronger at grazing angles."""
    ray = mirror(s)
    fresnel = 0.05 + 0.5 * (1 - s.normal[..., 2]) ** 4
    boxes = window(ray, KEY, (0.30, 0.42), soft) + 0.35 * window(ray, RIM, (0.16, 0.9), soft)
    return (strength * fresnel * 14 * boxes)[..., None]


def diffuse(s: Surface, ground: FloatArray, wrap: float) -> FloatArray:
    """Light that falls on the surface (H, W, 3): key, fill, sky and what the ground sends back."""
    n = s.normal
    key = np.clip((n @ KEY + wrap) / (1 + wrap), 0, 1)[..., None]
    fill = np.clip((n @ RIM + 0.4) / 1.4, 0, 1)[..., None]
    sky = (0.5 + 0.5 * n[..., 2])[..., None]
    warm, cool = np.array([1.0, 0.97, 0.92]), np.array([0.86, 0.93, 1.0])
    light: FloatArray = 0.80 * key * warm + (0.14 * fill + 0.30 * sky) * cool
    return light + 0.35 * (1 - sky) * ground


def rim_darkening(s: Surface, amount: float) -> FloatArray:
    """Return a factor (H, W, 1) that falls by ``amount`` toward the silhouette."""
    return (1 - amount * (1 - s.normal[..., 2]) ** 3)[..., None]


# --- skins ------------------------------------------------------------------------------------


def mottle(shape: tuple[int, int], sigma_px: float, rng: np.random.Generator) -> FloatArray:
    """Smooth random field of zero mean and unit deviation; made coarse, then enlarged."""
    step = max(1, int(sigma_px / 3))
    coarse = [n // step + 4 for n in shape]
    field = gaussian_filter(rng.standard_normal(coarse), sigma_px / step, mode="wrap")
    field = zoom(field, step, order=3)[: shape[0], : shape[1]] if step > 1 else field
    field = field[: shape[0], : shape[1]]
    field -= field.mean()
    return np.asarray(field / field.std())


def wrapped(s: Surface, sigma: tuple[float, float], rng: np.random.Generator) -> FloatArray:
    """Random field on the skin (H, W); sigma in mm around and along the body."""
    step = 0.25
    around, along = s.phi * s.r.max() / step, (s.y.max() - s.y) / step
    shape = (int(along.max()) + 3, int(np.pi * s.r.max() / step) + 3)
    field = gaussian_filter(rng.standard_normal(shape), (sigma[1] / step, sigma[0] / step))
    field /= field.std()
    centred = around + np.pi / 2 * s.r.max() / step
    return map_coordinates(field, [along, centred], order=1, mode="nearest")


def opal_bulb(s: Surface, ground: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Opal glass, nickel cap, ivory insulator, tin contact."""
    light = diffuse(s, ground, 0.55)
    glass = light * np.array([0.80, 0.775, 0.72]) * rim_darkening(s, 0.22) + gloss(s, 0.95, 0.05)
    ray = mirror(s)
    room = 0.20 + 0.25 * smooth(-0.1, 0.9, ray[..., 1]) + 0.12 * smooth(-0.6, 0.6, -ray[..., 0])
    room += 1.25 * window(ray, KEY, (0.45, 0.9), 0.30) + 0.75 * window(ray, RIM, (0.22, 1.5), 0.22)
    room += 0.30 * smooth(0.45, 0.95, ray[..., 2]) + 0.25 * light[..., 0]
    brushed = 1 + 0.025 * wrapped(s, (6.0, 0.25), rng)
    metal = (room * brushed)[..., None] * np.array([0.78, 0.75, 0.70]) * rim_darkening(s, 0.20)
    ring = light * np.array([0.60, 0.56, 0.47]) + gloss(s, 0.7, 0.10)
    tin = (0.15 + 0.75 * room)[..., None] * np.array([0.62, 0.60, 0.57]) * rim_darkening(s, 0.20)
    seam = np.exp(-(((s.y + 80.2) / 0.16) ** 2))[..., None]
    colour = np.where((s.y > -80.3)[..., None], glass, metal)
    colour = np.where((s.y < -100.0)[..., None], ring, colour)
    colour = np.where((s.y < -104.2)[..., None], tin, colour)
    return np.asarray(colour * (1 - 0.6 * seam))


def egg_shell(s: Surface, ground: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Brown egg, matt, with darker speckles."""
    specks = smooth(2.0, 2.9, wrapped(s, (0.35, 0.35), rng))
    tint = 1 + 0.025 * wrapped(s, (4, 4), rng) + 0.012 * wrapped(s, (0.5, 0.5), rng)
    albedo = np.array([0.80, 0.47, 0.27]) * tint[..., None] * (1 - 0.38 * specks[..., None])
    return diffuse(s, ground, 0.3) * albedo * rim_darkening(s, 0.30) + gloss(s, 0.16, 0.30)


def pear_skin(s: Surface, ground: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Yellow-green pear with a red cheek and lenticels, brown stem."""
    patches = wrapped(s, (9, 12), rng)
    cheek = smooth(-0.2, 1.5, 0.9 * np.sin(s.phi + 0.2) + 0.35 * patches)[..., None]
    green, red = np.array([0.58, 0.56, 0.075]), np.array([0.62, 0.17, 0.045])
    skin = green * (1 - 0.8 * cheek) + red * 0.8 * cheek
    russet = smooth(-20, -12, s.y)[..., None]
    skin = skin * (1 - 0.45 * russet) + np.array([0.36, 0.24, 0.07]) * 0.45 * russet
    dots = smooth(1.9, 2.7, wrapped(s, (0.32, 0.32), rng))[..., None]
    skin = skin * (1 + 0.05 * wrapped(s, (1.2, 1.2), rng)[..., None]) * (1 - 0.35 * dots)
    bark = np.array([0.16, 0.085, 0.035]) * (1 + 0.2 * wrapped(s, (4, 0.5), rng)[..., None])
    stem = smooth(-9.6, -8.2, s.y)[..., None]
    albedo = skin * (1 - stem) + bark * stem
    shine = gloss(s, 0.55, 0.22) * (1 - 0.8 * stem)
    return diffuse(s, ground, 0.3) * albedo * rim_darkening(s, 0.30) + shine


def amber_glass(s: Surface, ground: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Brown pharmacy glass: the ground shines through, deeper toward the edges."""
    nz = s.normal[..., 2]
    path = 0.75 + 0.55 / np.maximum(nz, 0.16)
    base = 1.3 * smooth(-83.5, -89.5, s.y) + 0.8 * smooth(-4.5, 0, s.y)
    absorb = np.array([0.50, 1.15, 2.9]) * (path + base)[..., None]
    glow = np.exp(-(((s.phi - 0.55) / 0.34) ** 2)) * smooth(-88, -60, s.y) * smooth(0.15, 0.5, nz)
    line = 0.9 * np.exp(-(((nz - 0.30) / 0.035) ** 2))
    through = 0.95 * ground * np.exp(-absorb) * (0.75 + 1.1 * glow + line)[..., None]
    body = diffuse(s, ground, 0.4) * np.array([0.020, 0.008, 0.003])
    waves = replace(s, normal=s.normal + 0.005 * wrapped(s, (3, 9), rng)[..., None])
    return np.asarray(through + body + gloss(waves, 1.1, 0.04))


def celadon(s: Surface, ground: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Glazed stoneware with faint throwing rings; the glaze is thin and brown at the lip."""
    rings = np.sin(2 * np.pi * (s.y + 0.35 * s.phi) / 5.2 + 0.9 * wrapped(s, (20, 5), rng))
    tint = 1 + 0.012 * rings + 0.05 * wrapped(s, (6, 9), rng) + 0.02 * wrapped(s, (0.6, 0.6), rng)
    bare = 0.85 * smooth(-2.8, -0.6, s.y)[..., None]
    glaze, clay = np.array([0.23, 0.47, 0.46]), np.array([0.13, 0.06, 0.03])
    albedo = (glaze * (1 - bare) + clay * bare) * tint[..., None]
    tilt = np.zeros_like(s.normal)
    tilt[..., 1] = 0.006 * rings
    return diffuse(s, ground, 0.25) * albedo * rim_darkening(s, 0.30) + gloss(
        replace(s, normal=s.normal + tilt), 0.8, 0.08
    )


# --- picture ----------------------------------------------------------------------------------

Skin = Callable[[Surface, FloatArray, np.random.Generator], FloatArray]


@dataclass(frozen=True)
class Sample:
    """One picture: what lies where, on what, and at what resolution.

    ``top_px`` is the object's top middle in the picture (x, y), pixel centres at whole numbers.
    ``glow`` is the share of the key light, per colour, that shines through the object.
    """

    body: Body
    skin: Skin
    ground: tuple[float, float, float]
    size_px: tuple[int, int]
    top_px: tuple[float, float]
    px_per_metre: int
    seed: int
    glow: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def mm_per_px(self) -> float:
        """Size of a pixel."""
        return 1000 / self.px_per_metre

    def smaller(self, factor: int) -> Sample:
        """Return the same scene with pixels ``factor`` times as large."""
        width, height = self.size_px
        top = tuple((c + 0.5) / factor - 0.5 for c in self.top_px)
        return replace(
            self,
            size_px=(width // factor, height // factor),
            top_px=(top[0], top[1]),
            px_per_metre=self.px_per_metre // factor,
        )

    def x(self) -> FloatArray:
        """Of the pixel columns' middles, (W,)."""
        return (np.arange(self.size_px[0], dtype=np.float64) - self.top_px[0]) * self.mm_per_px

    def y(self) -> FloatArray:
        """Of the pixel rows' middles, (H,)."""
        return (self.top_px[1] - np.arange(self.size_px[1], dtype=np.float64)) * self.mm_per_px


def coverage(sample: Sample) -> FloatArray:
    """Share of each pixel that the object covers (H, W): exact along rows, many rows a pixel."""
    mm, x, y = sample.mm_per_px, sample.x(), sample.y()
    total = np.zeros((y.size, x.size))
    for k in range(SUBROWS):
        row = y - ((k + 0.5) / SUBROWS - 0.5) * mm
        right = radius_at(sample.body.right, row)[:, None]
        left = -radius_at(sample.body.left, row)[:, None]
        span = np.minimum(x + mm / 2, right) - np.maximum(x - mm / 2, left)
        total += np.clip(span / mm, 0, 1)
    return total / SUBROWS


def surface(sample: Sample) -> Surface:
    """Find the visible surface; pixels off the object take the nearest place on it in their row."""
    body = sample.body
    y = np.clip(sample.y(), -body.height + 0.02, -0.02)[:, None]
    x = np.broadcast_to(sample.x(), (y.size, sample.size_px[0]))
    fine = np.arange(0, body.height, 0.005)
    half_square = radius_at(body.right, -fine) ** 2 / 2
    slope = gaussian_filter(-np.gradient(half_square, 0.005), 4, mode="nearest")
    r = radius_at(body.right, y)
    phi = np.arcsin(np.clip(x / r, -0.999, 0.999))
    depth = np.broadcast_to(-y, x.shape)
    if body.right_steps != body.left_steps:
        thread = (depth > 76) & (depth < 98.4)  # a helix: half a pitch lower on the left
        depth = np.where(thread, depth - PITCH * (np.pi / 2 - phi) / (2 * np.pi), depth)
    r = np.interp(depth, fine, np.sqrt(2 * half_square))
    x = np.clip(x, -0.999 * r, 0.999 * r)
    normal = np.stack([x, -np.interp(depth, fine, slope), np.sqrt(r**2 - x**2)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    # The outermost pixels share one shade: a steep fall of light there would move the edge seen.
    normal[..., 2] = np.maximum(normal[..., 2], RIM_NZ)
    normal[..., :2] *= (np.sqrt(1 - normal[..., 2] ** 2) / np.hypot(*normal[..., :2].T).T)[
        ..., None
    ]
    return Surface(x, np.broadcast_to(y, x.shape), r, phi, normal)


def lit_share(sample: Sample, rays: FloatArray) -> FloatArray:
    """Share of the rays (K, 3) that reach each point of the ground, (H, W) in 0..1."""
    body, step = sample.body, 0.5 / sample.mm_per_px
    width, height = sample.size_px
    nodes_x, nodes_y = np.arange(0, width + step, step), np.arange(0, height + step, step)
    x = (nodes_x - sample.top_px[0]) * sample.mm_per_px
    y = (sample.top_px[1] - nodes_y) * sample.mm_per_px
    share = np.zeros((y.size, x.size))
    for ray in rays:
        free = np.ones(share.shape, bool)
        for level in np.linspace(0.01, 0.99, 40) * 2 * body.radius:
            slide = level * ray[:2] / ray[2]
            r2 = radius_at(body.right, y + slide[1]) ** 2 - (level - body.radius) ** 2
            free &= (x + slide[0]) ** 2 > r2[:, None]
        share += free
    share = gaussian_filter(share / len(rays), 1.2, mode="nearest")
    rows, columns = np.arange(height) / step, np.arange(width) / step
    return map_coordinates(share, np.meshgrid(rows, columns, indexing="ij"), order=1)


def cone(centre: FloatArray, spread: float, count: int) -> FloatArray:
    """Rays (count, 3) evenly over a disc of radius ``spread`` around a direction (a spiral)."""
    k = np.arange(count) + 0.5
    rho, turn = spread * np.sqrt(k / count), k * np.pi * (3 - np.sqrt(5))
    a = unit(np.cross((0.0, 0.0, 1.0) if abs(centre[2]) < 0.9 else (1.0, 0.0, 0.0), centre))
    b = np.cross(centre, a)
    rays = centre + rho[:, None] * (np.cos(turn)[:, None] * a + np.sin(turn)[:, None] * b)
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))


def dome(count: int) -> FloatArray:
    """Rays (count, 3) from the whole sky, weighted by the cosine."""
    k = np.arange(count) + 0.5
    rho, turn = 0.97 * np.sqrt(k / count), k * np.pi * (3 - np.sqrt(5))
    return np.column_stack([rho * np.cos(turn), rho * np.sin(turn), np.sqrt(1 - rho**2)])


def ground(sample: Sample, rng: np.random.Generator) -> FloatArray:
    """Light the table (H, W, 3): uneven light, mottling, cast and contact shadow."""
    width, height = sample.size_px
    v, u = np.mgrid[0:height, 0:width] / max(width, height)
    falloff = 1.10 - 0.28 * u - 0.20 * v - 0.25 * ((u - 0.35) ** 2 + (v - 0.45) ** 2)
    scale = 0.1 / sample.mm_per_px
    clouds = 0.022 * mottle((height, width), 110 * scale, rng)
    clouds += 0.010 * mottle((height, width), 22 * scale, rng)
    key = lit_share(sample, cone(KEY, 0.34, 90))
    sky = lit_share(sample, dome(140))
    warm, cool, glow = np.array([(1.0, 0.97, 0.92), (0.88, 0.95, 1.0), sample.glow])
    light = 0.72 * (key + np.multiply.outer(glow, 1 - key)) * warm[:, None, None]
    light += 0.30 * sky * cool[:, None, None]
    colour = np.array(sample.ground)[:, None, None] * light * (falloff + clouds)
    return np.moveaxis(colour, 0, -1)


def encode(linear: FloatArray) -> FloatArray:
    """Linear light to sRGB in 0..255, with a soft shoulder for the highlights."""
    knee = np.where(linear > 0.75, 0.75 + 0.25 * np.tanh((linear - 0.75) / 0.25), linear)
    knee = np.clip(knee, 0, 1)
    srgb = np.where(knee <= 0.0031308, 12.92 * knee, 1.055 * knee ** (1 / 2.4) - 0.055)
    return 255 * srgb


def render(sample: Sample) -> NDArray[np.uint8]:
    """Return the picture (H, W, 3), the same at every run."""
    rng = np.random.default_rng(sample.seed)
    table = ground(sample, rng)
    seen = surface(sample)
    thing = sample.skin(seen, np.array(sample.ground), rng)
    # Mixed as encoded, not as light: so the half-way grey level lies on the true outline.
    share = coverage(sample)[..., None]
    picture = share * encode(thing) + (1 - share) * encode(table)
    picture = gaussian_filter(picture, (BLUR_PX, BLUR_PX, 0), mode="nearest")
    picture += NOISE_8BIT * rng.standard_normal(picture.shape)
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8)


def revolve(steps: Sequence[Step]) -> Body:
    """Make the body of one meridian."""
    return Body(steps, steps)


SAMPLES = {
    "bulb": Sample(
        body=Body(bulb(), bulb(PITCH / 2)),
        skin=opal_bulb,
        ground=(0.115, 0.165, 0.205),
        size_px=(1000, 1400),
        top_px=(489.3, 148.6),
        px_per_metre=10000,
        seed=1,
    ),
    "pear": Sample(
        body=revolve(pear()),
        skin=pear_skin,
        ground=(0.52, 0.54, 0.56),
        size_px=(840, 960),
        top_px=(404.7, 112.2),
        px_per_metre=8000,
        seed=2,
    ),
    "egg": Sample(
        body=revolve(egg()),
        skin=egg_shell,
        ground=(0.16, 0.24, 0.27),
        size_px=(800, 900),
        top_px=(381.4, 140.3),
        px_per_metre=10000,
        seed=3,
    ),
    "bottle": Sample(
        body=revolve(bottle()),
        skin=amber_glass,
        ground=(0.66, 0.62, 0.55),
        size_px=(720, 960),
        top_px=(340.6, 118.8),
        px_per_metre=8000,
        seed=4,
        glow=(0.30, 0.10, 0.01),
    ),
    "vase": Sample(
        body=revolve(vase()),
        skin=celadon,
        ground=(0.62, 0.53, 0.42),
        size_px=(800, 1000),
        top_px=(383.2, 110.4),
        px_per_metre=6250,
        seed=5,
    ),
}


def write_points(path: Path, points: FloatArray) -> None:
    """Write x,y in mm, four decimals."""
    rows = [f"{x:.4f},{y:.4f}" for x, y in points + 0.0]
    path.write_text("x_mm,y_mm\n" + "\n".join(rows) + "\n", encoding="utf-8", newline="\n")


def main(names: Sequence[str]) -> None:
    """Render the named samples (all without names) and write every truth."""
    for name in names or SAMPLES:
        sample = SAMPLES[name]
        dpi = sample.px_per_metre * 0.0254
        Image.fromarray(render(sample)).save(HERE / f"{name}.png", dpi=(dpi, dpi), optimize=True)
    rows = ["name,mm_per_px,width_px,height_px,top_x_px,top_y_px"]
    for name, sample in SAMPLES.items():
        write_points(HERE / "truth" / f"{name}.csv", sample.body.outline())
        numbers = (sample.mm_per_px, *sample.size_px, *sample.top_px)
        rows.append(",".join([name, *(f"{n:g}" for n in numbers)]))
    text = "\n".join(rows) + "\n"
    (HERE / "truth" / "pictures.csv").write_text(text, encoding="utf-8", newline="\n")
    write_points(HERE / "finger_rest.csv", finger_rest())


if __name__ == "__main__":
    main(sys.argv[1:])
