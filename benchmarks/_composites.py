"""Photographs with a known mask: cut-outs laid on grounds that are drawn, lit and spoilt."""

from __future__ import annotations

import io
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from profiletool.image.find.masks import fill_holes
from profiletool.records.picture import Picture

FloatImage = NDArray[np.float64]

PHOTOS = Path(__file__).resolve().parents[2] / "shared" / "photos"
CUT_OUTS = (
    "bulb_clear", "cylinder", "eggplant", "mug", "pear", "pepper_grinder", "pitcher", "rubberduck",
)  # fmt: skip
_LONG_PX = 300  # the object's longer side
_FRAME = (420, 560)


@dataclass(frozen=True)
class Composite:
    """A picture and its object's true mask, (H, W), holes filled."""

    picture: Picture
    truth: NDArray[np.bool_]


def composite(
    name: str,
    ground: str,
    seed: int = 0,
    photos: Path = PHOTOS,
    skin: tuple[float, float, float] | None = None,
) -> Composite:
    """Lay a cut-out on a ground, or hold it before it; the same arguments give the same picture.

    Parameters
    ----------
    name, ground : str
        One of `CUT_OUTS` and one of `GROUNDS`.
    seed : int
    photos : Path
        Where the cut-outs are.
    skin : (r, g, b), optional
        Colour of the hand that holds it.
    """
    rng = np.random.default_rng([seed, zlib.crc32(f"{name} on {ground}".encode())])
    colour, cover = _placed(_cut_out(photos / f"{name}_alpha.png"), rng)
    mean = colour[cover > 0.5].mean(axis=0)
    seen = _shaded(GROUNDS[ground](rng, mean), cover, rng)
    layers = [(colour, cover)]
    if skin is not None:
        behind, before = (_lit(part, skin, rng) for part in _hand(cover > 0.5))
        layers = [behind, *layers, before]
    for paint, part in layers:
        soft = cv2.GaussianBlur(part, (0, 0), 0.6)[..., None]
        seen = seen * (1 - soft) + paint * soft
    truth = fill_holes(cover >= 0.5)
    return Composite(Picture(_photographed(seen, rng), None, None, "JPEG"), truth)


def _hand(cover: NDArray[np.bool_]) -> tuple[FloatImage, FloatImage]:
    """Palm and forearm behind an object, and fingers round its lower end, (H, W) each."""
    rows, columns = np.flatnonzero(cover.any(axis=1)), np.flatnonzero(cover.any(axis=0))
    base, high = int(rows[-1]), int(rows[-1] - rows[0])
    middle, wide = int(columns[0] + columns[-1]) // 2, int(columns[-1] - columns[0])
    grip = base - round(0.22 * high)
    behind, before = np.zeros(cover.shape), np.zeros(cover.shape)

    def stroke(image: FloatImage, start: tuple[int, int], end: tuple[int, int], size: int) -> None:
        cv2.line(image, start, end, 1.0, size, cv2.LINE_AA)

    stroke(behind, (middle + 90, cover.shape[0] + 20), (middle + 15, base + 5), 70)
    palm = round(0.5 * wide) + 18, 48
    cv2.ellipse(behind, (middle, grip + 25), palm, 0, 0, 360, 1.0, -1, cv2.LINE_AA)
    here = np.flatnonzero(cover[grip])
    left, right = int(here[0]), int(here[-1])
    for row in (grip + 4, grip + 25, grip + 46):
        stroke(before, (left - 16, row + 10), (left + round(0.38 * (right - left)), row), 19)
    stroke(before, (right + 16, grip + 30), (right - round(0.3 * (right - left)), grip + 2), 23)
    return behind, before


def _lit(
    part: FloatImage, skin: tuple[float, float, float], rng: np.random.Generator
) -> tuple[FloatImage, FloatImage]:
    """Paint a part of a hand, darker towards its rim."""
    depth = cv2.distanceTransform((part > 0.5).astype(np.uint8), cv2.DIST_L2, 5)
    shade = 0.75 + 0.3 * np.clip(depth / 12.0, 0.0, 1.0)
    return np.asarray(np.array(skin) * shade[..., None] + 3 * _grain(rng, 2)), part


def _cut_out(path: Path) -> NDArray[np.uint8]:
    """RGBA of a cut-out, enlarged to the size of an object in a photograph."""
    image = Image.open(path).convert("RGBA")
    scale = _LONG_PX / max(image.size)
    size = tuple(max(1, round(side * scale)) for side in image.size)
    # Enlarged with its colours weighted by alpha, so that no fringe comes in from outside.
    large = image.convert("RGBa").resize(size, Image.Resampling.BICUBIC).convert("RGBA")
    return np.asarray(large)


def _placed(rgba: NDArray[np.uint8], rng: np.random.Generator) -> tuple[FloatImage, FloatImage]:
    """Colour (H, W, 3) and cover (H, W) of a cut-out somewhere near the middle of the frame."""
    height, width = rgba.shape[:2]
    top, left = (
        round((whole - part) * rng.uniform(0.3, 0.7))
        for whole, part in zip(_FRAME, (height, width), strict=True)
    )
    colour, cover = np.zeros((*_FRAME, 3)), np.zeros(_FRAME)
    window = np.s_[top : top + height, left : left + width]
    colour[window] = rgba[..., :3]
    # An enlarged rim is as soft as it was: made firm again about its half level.
    cover[window] = np.clip((rgba[..., 3] / 255.0 - 0.5) * 3.0 + 0.5, 0.0, 1.0)
    return colour, cover


def _shaded(ground: FloatImage, cover: FloatImage, rng: np.random.Generator) -> FloatImage:
    """Let the object cast a soft shadow."""
    down, right = rng.uniform(2, 14), rng.uniform(-14, 14)
    moved = cv2.warpAffine(cover, np.array([[1, 0, right], [0, 1, down]]), cover.shape[::-1])
    shadow = cv2.GaussianBlur(moved, (0, 0), rng.uniform(6, 14))[..., None]
    return np.asarray(ground * (1 - rng.uniform(0.15, 0.4) * shadow))


def _photographed(rgb: FloatImage, rng: np.random.Generator) -> NDArray[np.uint8]:
    """Light, blur, noise and compression of a photograph."""
    v, u = _places()
    slope = rng.uniform(-0.06, 0.06, (2, 3))
    lit = rgb * (1 + (u - 0.5)[..., None] * slope[0] + (v - 0.5)[..., None] * slope[1])
    blurred = cv2.GaussianBlur(lit, (0, 0), rng.uniform(0.4, 1.0))
    noisy = blurred + rng.normal(0, rng.uniform(1, 5), rgb.shape)
    memory = io.BytesIO()
    Image.fromarray(np.clip(np.round(noisy), 0, 255).astype(np.uint8)).save(
        memory, "JPEG", quality=int(rng.integers(60, 91))
    )
    return np.asarray(Image.open(memory).convert("RGB"))


# --- grounds, (H, W, 3) ---------------------------------------------------------------------


def _places() -> tuple[FloatImage, FloatImage]:
    """Row and column of every pixel, 0 to 1."""
    v, u = np.mgrid[: _FRAME[0], : _FRAME[1]]
    return v / (_FRAME[0] - 1), u / (_FRAME[1] - 1)


def _flat(colour: object) -> FloatImage:
    return np.ones((*_FRAME, 3)) * np.asarray(colour, np.float64)


def _grain(rng: np.random.Generator, reach: float) -> FloatImage:
    """Noise of unit deviation, blotches of a given size."""
    grain = cv2.GaussianBlur(rng.normal(0, 1, _FRAME), (0, 0), reach)
    return np.asarray(grain / grain.std())[..., None]


def _white(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    return _flat((250, 249, 246))


def _grey(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    v, u = _places()
    return _flat(1) * (110 + 60 * u + 30 * v)[..., None]


def _dark(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    return _flat((38, 36, 40)) + 3 * _grain(rng, 1.5)


def _wood(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    v, u = _places()
    warp = 0.08 * _grain(rng, 60)[..., 0]
    rings = np.sin(2 * np.pi * (18 * (u + warp) + 0.6 * np.sin(5 * v)))[..., None]
    fibres = cv2.GaussianBlur(rng.normal(0, 1, _FRAME), (0, 0), sigmaX=1, sigmaY=25)
    return _flat((178, 132, 86)) + 16 * rings + 7 * (fibres / fibres.std())[..., None]


def _cloth(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    v, u = _places()
    weave = np.sin(2 * np.pi * 90 * u) * np.sin(2 * np.pi * 70 * v)
    folds = 10 * _grain(rng, 45)
    return _flat((82, 118, 128)) + folds + 12 * weave[..., None] + 10 * _grain(rng, 1.2)


def _granite(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    dark, pale = _grain(rng, 2.2), _grain(rng, 2.8)
    ground = _flat((148, 144, 142)) + 8 * _grain(rng, 1.0)
    ground = np.where(dark > 1.1, np.array([60.0, 58, 62]), ground)
    return np.asarray(np.where(pale > 1.3, np.array([222.0, 214, 208]), ground))


def _checks(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    v, u = _places()
    dyed = 0.5 * (np.floor(u * 16) % 2)[..., None] + 0.5 * (np.floor(v * 12) % 2)[..., None]
    return _flat((240, 238, 232)) * (1 - dyed) + np.array([60.0, 80, 150]) * dyed


def _newspaper(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    page = np.full(_FRAME, 226.0)
    for top in range(6, _FRAME[0] - 6, 11):
        for left in range(4, _FRAME[1] - 4, 6):
            if rng.random() < 0.82:
                high, wide = int(rng.integers(4, 8)), int(rng.integers(2, 6))
                page[top : top + high, left : left + wide] = rng.uniform(40, 110)
    return cv2.GaussianBlur(page, (0, 0), 0.7)[..., None] * np.array([1.0, 0.985, 0.95])


def _own_colour(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    return _flat(mean) + 3 * _grain(rng, 20)


def _vignette(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    v, u = _places()
    fall = 1 - 0.55 * ((u - 0.4) ** 2 + (v - 0.35) ** 2) / 0.5
    return _flat((214, 204, 186)) * (fall * (0.75 + 0.35 * u))[..., None]


def _clutter(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    ground = _flat((196, 198, 190)) + 2 * _grain(rng, 15)
    for _ in range(7):
        side = int(rng.integers(0, 4))
        along = rng.uniform(0.05, 0.95)
        x, y = ((along, 0.0), (along, 1.0), (0.0, along), (1.0, along))[side]
        centre = int(x * _FRAME[1]), int(y * _FRAME[0])
        axes = int(rng.integers(14, 34)), int(rng.integers(14, 34))
        colour = tuple(float(value) for value in rng.uniform(20, 235, 3))
        cv2.ellipse(ground, centre, axes, rng.uniform(0, 180), 0, 360, colour, -1)
    return ground


def _leaves(rng: np.random.Generator, mean: FloatImage) -> FloatImage:
    """Blotches of many sizes and two hues, as grass or a carpet."""
    tone = 22 * _grain(rng, 3) + 14 * _grain(rng, 9)
    return _flat((92, 112, 62)) + tone + 10 * _grain(rng, 6) * np.array([1.0, -0.4, -0.3])


GROUNDS: dict[str, Callable[[np.random.Generator, FloatImage], FloatImage]] = {
    "white": _white,
    "grey gradient": _grey,
    "dark": _dark,
    "wood": _wood,
    "cloth": _cloth,
    "granite": _granite,
    "checks": _checks,
    "newspaper": _newspaper,
    "own colour": _own_colour,
    "vignette": _vignette,
    "clutter": _clutter,
    "leaves": _leaves,
}
