"""Photographs of the sheet with a body on it, by rays: nothing of the code under test but ink.

A body is a row of spheres along an axis, so a ray meets it where it passes a sphere's middle at
less than its radius, and its true outline is the union of discs.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np

from profiletool.image.sheet.board import Board, ink
from profiletool.records.picture import Picture

PX_PER_MM = 10


@dataclass(frozen=True)
class Body:
    """Spheres at ``place`` along the axis, with ``radius`` each, mm; it lies on the sheet."""

    place: np.ndarray
    radius: np.ndarray

    @property
    def length(self) -> float:
        return float((self.place + self.radius).max() - (self.place - self.radius).min())

    @property
    def width(self) -> float:
        return float(2 * self.radius.max())


def sphere(radius: float) -> Body:
    return Body(np.array([0.0]), np.array([radius]))


def capsule(radius: float, length: float) -> Body:
    half = length / 2 - radius
    return Body(np.linspace(-half, half, 60), np.full(60, radius))


def bulb(scale: float = 1.0) -> Body:
    """A globe of 60 mm with a neck that narrows to 26 mm, 106 mm long."""
    neck = np.linspace(6, 63, 50)
    radius = 13 + 17 * (0.5 + 0.5 * np.cos(np.pi * np.clip(neck / 50, 0, 1)))
    place = np.concatenate([[0.0], neck]) - 23
    return Body(scale * place, scale * np.concatenate([[30.0], radius]))


@dataclass(frozen=True)
class Shot:
    """How a picture is taken.

    ``tilt`` is the angle of the line of sight off the sheet's normal, towards ``azimuth`` (0 is
    the sheet's right, 90 its lower edge); ``fill`` is the share of the picture's longer side that
    297 mm take in the middle; ``roll`` turns the camera about its line of sight; all in degrees
    and mm. ``aim`` is what the camera looks at, off the sheet's middle; ``printed`` is what the
    printer makes of a millimetre.
    """

    distance: float
    tilt: float = 0.0
    azimuth: float = 90.0
    roll: float = 0.0
    k1: float = 0.0
    fill: float = 0.8
    noise: float = 2.0
    blur: float = 0.7
    aim: tuple[float, float] = (0.0, 0.0)
    printed: float = 1.0
    size: tuple[int, int] = (960, 1280)

    @property
    def focal(self) -> float:
        return self.fill * max(self.size) * self.distance / 297.0


@cache
def paper(board: Board, darkness: float = 0.92) -> np.ndarray:
    """The printed sheet, grey 0..1."""
    width, height = board.paper_mm
    sheet = np.ones((round(height * PX_PER_MM), round(width * PX_PER_MM)), np.float32)
    for x0, y0, x1, y1 in np.round((ink(board) + np.tile(board.origin_mm, 2)) * PX_PER_MM):
        sheet[int(y0) : int(y1), int(x0) : int(x1)] = 1 - darkness
    return cv2.GaussianBlur(sheet, (0, 0), 1.2)


def _axes(shot: Shot) -> tuple[np.ndarray, np.ndarray]:
    """The camera's place (x right, y down, z away from the viewer) and axes, from the middle."""
    tilt, azimuth, roll = np.radians([shot.tilt, shot.azimuth, shot.roll])
    toward = np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth)])
    place = np.array([*(shot.distance * toward), -shot.distance * np.cos(tilt)])
    sight = -place / np.linalg.norm(place)
    right = np.cross([0.0, 1.0, 0.0], sight)
    right /= np.linalg.norm(right)
    down = np.cross(sight, right)
    turned = np.cos(roll) * right + np.sin(roll) * down, np.cos(roll) * down - np.sin(roll) * right
    return place + np.array([*shot.aim, 0.0]), np.stack([*turned, sight])


def _rays(shot: Shot, fine: int) -> tuple[np.ndarray, np.ndarray]:
    """Directions (H, W, 3) of the rays through a picture ``fine`` times as fine."""
    width, height = shot.size
    u = ((np.arange(width * fine) + 0.5) / fine - 0.5 - (width - 1) / 2) / shot.focal
    v = ((np.arange(height * fine) + 0.5) / fine - 0.5 - (height - 1) / 2) / shot.focal
    bent = np.stack(np.meshgrid(u, v), axis=-1)
    flat = bent
    if shot.k1:
        # The lens takes r to r (1 + k1 r^2); read backwards from a fine table.
        r = np.linspace(0, 1.5 * np.hypot(u[-1], v[-1]), 20001)
        seen = np.hypot(bent[..., 0], bent[..., 1])
        bends = r * (1 + shot.k1 * r**2)
        flat = bent * (np.interp(seen, bends, r) / np.maximum(seen, 1e-12))[..., None]
    place, axes = _axes(shot)
    return place, flat @ axes[:2] + axes[2]


def photograph(
    board: Board,
    body: Body | None,
    shot: Shot,
    rng: np.random.Generator,
    at: tuple[float, float] = (0.0, 0.0),
    turn: float = 0.0,
    sheet: np.ndarray | None = None,
    focal_error: float | None = 0.0,
) -> Picture:
    """Take a picture of a sheet with a body whose axis is ``turn`` degrees off the sheet's."""
    sheet = paper(board) if sheet is None else sheet
    place, rays = _rays(shot, 2)
    spots = place[:2] - rays[..., :2] * (place[2] / rays[..., 2:])
    px = (spots / shot.printed + np.array(board.paper_mm) / 2) * PX_PER_MM - 0.5
    seen = cv2.remap(
        sheet,
        px.astype(np.float32),
        None,
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=0.45,
    )
    grey = cv2.resize(seen, shot.size, interpolation=cv2.INTER_AREA)
    colour = grey[..., None] * np.array([232.0, 230.0, 222.0])
    if body is not None:
        cover = _cover(body, shot, at, turn)[..., None]
        colour = colour * (1 - cover) + cover * np.array([120.0, 50.0, 35.0])
    colour = cv2.GaussianBlur(colour, (0, 0), shot.blur)
    colour += rng.normal(0, shot.noise, colour.shape)
    rgb = np.clip(np.round(colour), 0, 255).astype(np.uint8)
    focal = None if focal_error is None else shot.focal * (1 + focal_error)
    return Picture(rgb, None, None, "JPEG", focal)


def _cover(body: Body, shot: Shot, at: tuple[float, float], turn: float) -> np.ndarray:
    """The share of every pixel that the body covers."""
    place, rays = _rays(shot, 1)
    rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    height = body.radius.max()
    angle = np.radians(turn)
    along = np.array([-np.sin(angle), np.cos(angle), 0.0])
    middle = np.array([*at, -height])
    spots = [middle + s * along - place for s in body.place]
    coarse = _inside(rays[::8, ::8], spots, body.radius, shot.focal) > -24
    rows, columns = (8 * np.flatnonzero(coarse.any(axis=k)) for k in (1, 0))
    window = np.s_[max(0, rows[0] - 8) : rows[-1] + 9, max(0, columns[0] - 8) : columns[-1] + 9]
    cover = np.zeros(rays.shape[:2])
    cover[window] = np.clip(_inside(rays[window], spots, body.radius, shot.focal) + 0.5, 0, 1)
    return cover


def _inside(
    rays: np.ndarray, spots: list[np.ndarray], radii: np.ndarray, focal: float
) -> np.ndarray:
    """How many pixels inside the body's outline rays are."""
    inside = np.full(rays.shape[:2], -np.inf)
    for off, radius in zip(spots, radii, strict=True):
        depth = rays @ off
        gap = np.sqrt(np.maximum((off @ off) - depth**2, 0.0))
        inside = np.maximum(inside, (radius - gap) * (focal / depth))
    return inside


BODIES = {"sphere": sphere(30.0), "cylinder": capsule(20.0, 120.0), "bulb": bulb()}
# Ten usual and unusual ways to hold a camera: 0.3 to 2 m, up to 30 degrees, lenses of all kinds.
POSES = {
    "overhead, 0.5 m": Shot(500, 2, 20),
    "overhead, 1 m": Shot(1000, 3, 200, roll=2),
    "near, 0.3 m": Shot(300, 3, 120, fill=0.7),
    "near, slanted, barrel": Shot(300, 12, 0, k1=-0.08, fill=0.65),
    "from below, 15 deg": Shot(600, 15, 90),
    "from below, 30 deg": Shot(600, 30, 90),
    "from the side, 30 deg": Shot(450, 30, 0, fill=0.7),
    "askew, 25 deg, barrel": Shot(700, 25, 45, roll=4, k1=-0.1, fill=0.7),
    "afar, 1.5 m, cushion": Shot(1500, 10, 250, k1=0.06),
    "afar, 2 m, blurred": Shot(2000, 8, 160, fill=0.7, blur=1.2, noise=5.0),
}


def random_shot(rng: np.random.Generator) -> Shot:
    return Shot(
        distance=float(np.exp(rng.uniform(np.log(300), np.log(2000)))),
        tilt=float(rng.uniform(0, 30)),
        azimuth=float(rng.uniform(0, 360)),
        roll=float(rng.uniform(-8, 8)),
        k1=float(rng.uniform(-0.1, 0.06)),
        fill=float(rng.uniform(0.55, 0.75)),
        noise=float(rng.uniform(1, 5)),
        blur=float(rng.uniform(0.5, 1.2)),
        aim=(float(rng.uniform(-10, 10)), float(rng.uniform(-10, 10))),
        printed=float(1 + rng.normal(0, 0.002)),
    )
