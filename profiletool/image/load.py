"""Safe decoding: the header is judged before any pixel is expanded."""

from __future__ import annotations

import contextlib
import math
import struct
import warnings
import zlib
from pathlib import Path
from typing import NoReturn

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from profiletool.errors import UnreadableInput, UsageError
from profiletool.files.read import check_file
from profiletool.image.structure import check_structure
from profiletool.records.picture import Picture
from profiletool.records.units import MM_PER_INCH

MAX_PIXELS = 64_000_000
MAX_PIXELS_OF = {"WEBP": 36_000_000}  # decoded in several copies: they shall fit in a gibibyte
MAX_BYTES = 50_000_000
MIN_SIDE_PX = 16
FORMATS = ("PNG", "JPEG", "TIFF", "BMP", "WEBP")  # JPEG takes in multi-picture MPO
_ASK_FOR = "save it as PNG, JPEG, TIFF, BMP or WebP"

# What Pillow's decoders throw on damaged data, apart from UnidentifiedImageError.
_DAMAGE = (
    OSError,
    SyntaxError,
    ValueError,
    TypeError,
    KeyError,
    IndexError,
    AttributeError,
    OverflowError,
    EOFError,
    MemoryError,
    RuntimeError,
    struct.error,
    zlib.error,
)
_ORIENTATION_TAG = 0x0112
_EXIF_TAG, _FOCAL_35_TAG, _DIAGONAL_35_MM = 0x8769, 0xA405, 43.27
_BITS_TAG, _PHOTOMETRIC_TAG, _WHITE_IS_ZERO = 258, 262, 0
# Written by programs that know no resolution, as whole dpi or as whole pixels per metre.
_MEANINGLESS_DPI = (72.0, 96.0)


def load_picture(path: Path) -> Picture:
    """Decode a picture file, upright, as 8 bit RGB with its alpha apart.

    Parameters
    ----------
    path : Path
        A PNG, JPEG, TIFF, BMP or WebP file of at most 50 MB and 64 megapixels (WebP: 36).

    Returns
    -------
    Picture
        EXIF orientation applied; 16 bit scaled to 8; the colour of transparent pixels as stored;
        ``mm_per_px`` only from PNG and TIFF, in mm per pixel; ``focal_px`` from EXIF.

    Raises
    ------
    UnreadableInput
        The file is missing, no picture, damaged, too large or of a kind that is not supported.
    """
    _check_file(path)
    # Pillow warns of oversized pictures, odd metadata and palettes: the size is checked here, and
    # the rest is of no use to the reader of a one-line message.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            with Image.open(path, formats=FORMATS) as image:
                _check_size(path, image)
                image.load()
                rgb, alpha = _channels(path, image)
                turn = _orientation(image)
                mm_per_px = _stored_mm_per_px(image)
                focal_px = _stored_focal_px(image)
                kind = image.format or ""
        except UnidentifiedImageError:
            _refuse(path, f"not a picture that can be read{_looks_like(path)}; {_ASK_FOR}")
        except Image.DecompressionBombError:
            _refuse_size(path, MAX_PIXELS)
        except _DAMAGE as error:
            _refuse(path, f"damaged or truncated ({error}); export the picture again")
    return Picture(
        rgb=_upright(rgb, turn),
        alpha=None if alpha is None else _upright(alpha, turn),
        mm_per_px=mm_per_px,
        format=kind,
        focal_px=focal_px,
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


def _looks_like(path: Path) -> str:
    with path.open("rb") as file:
        head = file.read(12)
    known = {b"GIF8": "GIF", b"%PDF": "PDF", b"<svg": "SVG", b"<?xm": "XML", b"8BPS": "Photoshop"}
    name = known.get(head[:4], "HEIC or AVIF" if head[4:8] == b"ftyp" else "")
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
    return rgba[..., :3].copy(), alpha if alpha.min() < 255 else None


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
    top = (1 << bits) - 1
    if values.min() < 0 or values.max() > top:
        _refuse(path, f"holds more than 16 bits per pixel; {_ASK_FOR} with 8 or 16 bits")
    lookup = np.round(np.arange(top + 1) * (255.0 / top)).astype(np.uint8)
    if tags.get(_PHOTOMETRIC_TAG) == _WHITE_IS_ZERO:
        lookup = lookup[::-1]
    rgb = np.repeat(lookup[values][..., None], 3, axis=2)
    transparent = image.info.get("transparency")
    if not isinstance(transparent, int) or not (values == transparent).any():
        return rgb, None
    return rgb, np.where(values == transparent, 0, 255).astype(np.uint8)


def _orientation(image: Image.Image) -> int:
    try:
        return int(image.getexif().get(_ORIENTATION_TAG, 1))
    except _DAMAGE:  # damaged metadata does not spoil a sound picture
        return 1


def _upright(pixels: NDArray[np.uint8], orientation: int) -> NDArray[np.uint8]:
    """Apply an EXIF orientation (1 to 8) to an (H, W) or (H, W, 3) array."""
    if orientation in (5, 6, 7, 8):
        pixels = pixels.swapaxes(0, 1)
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    return np.ascontiguousarray(pixels)


def _stored_mm_per_px(image: Image.Image) -> float | None:
    if image.format not in ("PNG", "TIFF"):
        return None
    try:
        x_dpi, y_dpi = (float(value) for value in image.info.get("dpi", (0.0, 0.0)))
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    if not (math.isfinite(x_dpi) and math.isfinite(y_dpi) and min(x_dpi, y_dpi) > 0.0):
        return None
    if not math.isclose(x_dpi, y_dpi, rel_tol=1e-3):
        return None
    if any(abs(x_dpi - dpi) < 0.5 for dpi in _MEANINGLESS_DPI):
        return None
    return MM_PER_INCH / x_dpi


def _stored_focal_px(image: Image.Image) -> float | None:
    """Focal length in pixels from its 35 mm equivalent, which refers to the picture's diagonal."""
    try:
        equivalent = float(image.getexif().get_ifd(_EXIF_TAG).get(_FOCAL_35_TAG, 0.0))
    except _DAMAGE:
        return None
    if not (math.isfinite(equivalent) and equivalent > 0.0):
        return None
    return equivalent / _DIAGONAL_35_MM * math.hypot(*image.size)
