"""Safe decoding: the header is judged before any pixel is expanded."""

from __future__ import annotations

import contextlib
import struct
import warnings
from pathlib import Path
from typing import NoReturn

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from profiletool.errors import UnreadableInput, UsageError
from profiletool.files.read import check_file
from profiletool.image.heif import HEIF_EXTRA, with_heif
from profiletool.image.stored import (
    DAMAGE,
    orientation,
    pixel_aspect,
    stored_focal_px,
    stored_mm_per_px,
)
from profiletool.image.structure import check_structure
from profiletool.records.picture import Picture

MAX_PIXELS = 64_000_000
MAX_PIXELS_OF = {"WEBP": 36_000_000}  # decoded in several copies: they shall fit in a gibibyte
MAX_BYTES = 50_000_000
MIN_SIDE_PX = 16
FORMATS = ("PNG", "JPEG", "TIFF", "BMP", "WEBP")  # JPEG takes in multi-picture MPO
_ASK_FOR = "save it as PNG, JPEG, TIFF, BMP or WebP"

_BITS_TAG, _PHOTOMETRIC_TAG, _WHITE_IS_ZERO = 258, 262, 0
_DEPTHS = (8, 10, 12, 14, 16)  # bits of sensors, whose values stand in 16 bits as they are
_ALMOST_BLACK = 16  # of 255: what 12 bits of 16 look like once shortened


def load_picture(path: Path) -> Picture:
    """Decode a picture file, upright, as 8 bit RGB with its alpha apart.

    Parameters
    ----------
    path : Path
        A PNG, JPEG, TIFF, BMP or WebP file of at most 50 MB and 64 megapixels (WebP: 36).

    Returns
    -------
    Picture
        EXIF orientation applied; 16 bit scaled to 8; pixels that are not square stretched; the
        colour of transparent pixels as stored; ``mm_per_px`` only from PNG and TIFF, in mm per
        pixel, and not from cameras and screens; ``focal_px`` from EXIF.

    Raises
    ------
    UnreadableInput
        The file is missing, no picture, damaged, too large or of a kind that is not supported.
    """
    _check_file(path)
    formats = (*FORMATS, "HEIF") if _is_heif(path) and with_heif() else FORMATS
    # Pillow warns of oversized pictures, odd metadata and palettes: the size is checked here, and
    # the rest is of no use to the reader of a one-line message.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with Image.open(path, formats=formats) as image:
                _check_size(path, image)
                image.load()
                rgb, alpha = _channels(path, image)
                turn = orientation(image)
                aspect = pixel_aspect(image)
                mm_per_px = stored_mm_per_px(image)
                focal_px = stored_focal_px(image)
                kind = image.format or ""
                notes = _several(image)
        except UnidentifiedImageError:
            _refuse(path, f"not a picture that can be read{_looks_like(path)}; {_ASK_FOR}")
        except Image.DecompressionBombError:
            _refuse_size(path, MAX_PIXELS)
        except DAMAGE as error:
            _refuse(path, f"damaged or truncated ({error}); export the picture again")
    if alpha is None and 0 < rgb.max() < _ALMOST_BLACK:
        _refuse(path, "almost black, as 12 bit values in 16 are; export it with its full range")
    if aspect != 1.0:
        rgb = _square(path, rgb, aspect)
        alpha = None if alpha is None else _square(path, alpha, aspect)
        notes += (f"its pixels are {aspect:.3g} times as high as wide: it was stretched",)
    return Picture(
        rgb=_upright(rgb, turn),
        alpha=None if alpha is None else _upright(alpha, turn),
        mm_per_px=mm_per_px,
        format=kind,
        focal_px=focal_px,
        notes=notes,
    )


def load_mask(path: Path, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Decode a mask: what is opaque, or white where the file has no alpha channel, is object.

    Parameters
    ----------
    path : Path
        A file as `load_picture` takes it.
    shape : (H, W)
        Of the picture that it is for, upright.

    Returns
    -------
    (H, W) bool
        True from half way on, 128 of 255.

    Raises
    ------
    UnreadableInput
        As `load_picture`.
    UsageError
        The mask is of another size than the picture, or empty.
    """
    picture = load_picture(path)
    height, width = picture.rgb.shape[:2]
    if (height, width) != tuple(shape):
        raise UsageError(
            f"{path}: the mask is {width} x {height} pixels and the picture {shape[1]} x "
            f"{shape[0]}; save the mask at the picture's size"
        )
    grey = cv2.COLOR_RGB2GRAY
    shade = cv2.cvtColor(picture.rgb, grey) if picture.alpha is None else picture.alpha
    mask = np.asarray(shade >= 128)
    if not mask.any():
        raise UsageError(f"{path}: the mask is empty; paint the object white on black")
    return mask


def _refuse(path: Path, reason: str) -> NoReturn:
    raise UnreadableInput(" ".join(f"{path}: {reason}".split())) from None


def _refuse_size(path: Path, most: int) -> NoReturn:
    _refuse(path, f"more than {most // 1_000_000} megapixels; scale the picture down")


def _check_file(path: Path) -> None:
    try:
        check_file(path, MAX_BYTES, "a picture")
        with contextlib.suppress(OSError, OverflowError, struct.error):  # the decoder will tell
            check_structure(path)
    except UnreadableInput as error:
        _refuse(path, str(error))
    if path.stat().st_size == 0:
        _refuse(path, "the file is empty; export the picture again")


def _check_size(path: Path, image: Image.Image) -> None:
    width, height = image.size
    most = MAX_PIXELS_OF.get(image.format or "", MAX_PIXELS)
    if width * height > most:
        _refuse_size(path, most)
    if min(width, height) < MIN_SIDE_PX:
        _refuse(path, f"only {width} x {height} pixels; use a larger picture")


def _is_heif(path: Path) -> bool:
    with path.open("rb") as file:
        head = file.read(12)
    return head[4:8] == b"ftyp" and head[8:12] != b"avif"


def _looks_like(path: Path) -> str:
    with path.open("rb") as file:
        head = file.read(512)
    known = {
        b"GIF8": "GIF", b"%PDF": "PDF", b"8BPS": "Photoshop", b"\x1f\x8b\x08": "packed: unpack it",
        b"II*\0\x10\0\0\0CR": "camera raw", b"%!PS": "PostScript", b"PK": "a ZIP archive",
        b"AC10": "DWG: save it as DXF", b"solid": "STL", b"ISO-10303": "STEP",
    }  # fmt: skip
    name = next((name for magic, name in known.items() if head.startswith(magic)), "")
    if b"<svg" in head or b"<?xml" in head[:8]:
        name = "SVG: name it .svg"
    elif head[:30].split()[:2] == [b"0", b"SECTION"]:
        name = "DXF: name it .dxf"
    elif head[4:8] == b"ftyp":
        name = "AVIF" if head[8:12] == b"avif" else f"HEIC, which takes {HEIF_EXTRA}"
    return f" (looks like {name})" if name else ""


def _channels(path: Path, image: Image.Image) -> tuple[NDArray[np.uint8], NDArray[np.uint8] | None]:
    """Colour (H, W, 3) and alpha (H, W) or None, not yet turned upright."""
    if image.mode == "F":
        _refuse(path, f"holds floating-point values, which have no defined white; {_ASK_FOR}")
    if image.mode == "I" or image.mode.startswith("I;16"):
        return _deep_grey(path, image)
    if not image.has_transparency_data:
        # Only converted where need be: every copy of 64 megapixels counts.
        return np.asarray(image if image.mode == "RGB" else image.convert("RGB")), None
    _shorten_deep_transparency(image)
    rgba = np.asarray(image if image.mode == "RGBA" else image.convert("RGBA"))
    alpha = rgba[..., 3].copy()
    meaningless = image.format == "BMP" and alpha.max() == 0  # most programs write no alpha there
    return rgba[..., :3].copy(), None if meaningless or alpha.min() == 255 else alpha


def _several(image: Image.Image) -> tuple[str, ...]:
    """Say that a file holds more pictures than the one that is read, a camera's previews apart."""
    count = 1 if image.format == "MPO" else getattr(image, "n_frames", 1)
    return () if count == 1 else (f"the file holds {count} pictures: the first was taken",)


def _square(path: Path, pixels: NDArray[np.uint8], aspect: float) -> NDArray[np.uint8]:
    """Stretch pixels that are ``aspect`` times as high as wide along their longer side."""
    height, width = pixels.shape[:2]
    size = (width, round(height * aspect)) if aspect > 1.0 else (round(width / aspect), height)
    if size[0] * size[1] > MAX_PIXELS:
        _refuse_size(path, MAX_PIXELS)
    return np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_LINEAR), np.uint8)


def _shorten_deep_transparency(image: Image.Image) -> None:
    # Pillow keeps the high byte of 16 bit RGB but both bytes of its transparent colour.
    colour = image.info.get("transparency")
    if image.mode == "RGB" and isinstance(colour, tuple) and max(colour) > 255:
        image.info["transparency"] = tuple(value >> 8 for value in colour)


def _deep_grey(
    path: Path, image: Image.Image
) -> tuple[NDArray[np.uint8], NDArray[np.uint8] | None]:
    """16 bit grey: Pillow's own conversion may clip instead of scaling."""
    values = np.asarray(image)
    tags = getattr(image, "tag_v2", {})
    bits = min(tags.get(_BITS_TAG, (16,))[0], 16)
    if values.min() < 0 or values.max() > (1 << bits) - 1:
        _refuse(path, f"holds more than 16 bits per pixel; {_ASK_FOR} with 8 or 16 bits")
    bits = next((b for b in _DEPTHS if values.max() < 1 << b), bits) if bits == 16 else bits
    top = (1 << bits) - 1
    lookup = np.round(np.arange(top + 1) * (255.0 / top)).astype(np.uint8)
    if tags.get(_PHOTOMETRIC_TAG) == _WHITE_IS_ZERO:
        lookup = lookup[::-1]
    rgb = np.repeat(lookup[values][..., None], 3, axis=2)
    transparent = image.info.get("transparency")
    if not isinstance(transparent, int) or not (values == transparent).any():
        return rgb, None
    return rgb, np.where(values == transparent, 0, 255).astype(np.uint8)


def _upright(pixels: NDArray[np.uint8], orientation: int) -> NDArray[np.uint8]:
    """Apply an EXIF orientation (1 to 8) to an (H, W) or (H, W, 3) array."""
    if orientation in (5, 6, 7, 8):
        pixels = pixels.swapaxes(0, 1)
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    return np.ascontiguousarray(pixels)
