"""Facts that a picture file stores beside its pixels: way up, resolution, focal length."""

from __future__ import annotations

import math
import struct
import zlib

from PIL import Image

from profiletool.records.units import MM_PER_INCH

# What Pillow's decoders throw on damaged data, apart from UnidentifiedImageError.
DAMAGE = (
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
# Exposure, aperture, sensitivity, focal length: a scanner, which has a maker too, has none.
_CAMERA_TAGS = (33434, 33437, 34855, 37386, _FOCAL_35_TAG)
# Of screens and of programs that know no resolution, as whole dpi or as whole pixels per metre.
_MEANINGLESS_DPI = (72.0, 96.0, 120.0, 144.0, 192.0, 216.0)
_LEAST_DPI, _MOST_DPI = 40.0, 20_000.0  # of a scanner
_SQUARE, _MOST_ASPECT = 0.01, 10.0  # share by which square pixels may differ; a fax has 2


def orientation(image: Image.Image) -> int:
    """EXIF orientation, 1 to 8; what it is, by the viewers, where it is damaged: 1."""
    try:
        return int(image.getexif().get(_ORIENTATION_TAG, 1))
    except DAMAGE:  # damaged metadata does not spoil a sound picture
        return 1


def pixel_aspect(image: Image.Image) -> float:
    """Height of a pixel over its width, as stored; 1 where that makes no sense."""
    x, y = _pair(image, "aspect") or _pair(image, "dpi") or _pair(image, "jfif_density") or (1, 1)
    aspect = x / y  # more pixels across an inch are narrower ones
    if abs(aspect - 1.0) <= _SQUARE or not 1.0 / _MOST_ASPECT <= aspect <= _MOST_ASPECT:
        return 1.0
    return aspect


def stored_mm_per_px(image: Image.Image) -> float | None:
    """Give a scanner's resolution; None from a camera or screen, or where there is none."""
    found = _pair(image, "dpi") if image.format in ("PNG", "TIFF") else None
    if found is None or is_photograph(image):
        return None
    dpi = max(found)  # along the side that is not stretched
    if not _LEAST_DPI <= dpi <= _MOST_DPI or not min(found) >= dpi / _MOST_ASPECT:
        return None
    if any(abs(dpi - useless) < 0.5 for useless in _MEANINGLESS_DPI):
        return None
    return MM_PER_INCH / dpi


def is_photograph(image: Image.Image) -> bool:
    """Whether EXIF holds what a camera measured: its resolution is then but a number."""
    try:
        exif = image.getexif()
        below = exif.get_ifd(_EXIF_TAG)
        return any(tag in below or tag in exif for tag in _CAMERA_TAGS)
    except DAMAGE:
        return False


def stored_focal_px(image: Image.Image) -> float | None:
    """Focal length in pixels from its 35 mm equivalent, which refers to the picture's diagonal."""
    try:
        equivalent = float(image.getexif().get_ifd(_EXIF_TAG).get(_FOCAL_35_TAG, 0.0))
    except DAMAGE:
        return None
    if not (math.isfinite(equivalent) and equivalent > 0.0):
        return None
    return equivalent / _DIAGONAL_35_MM * math.hypot(*image.size)


def _pair(image: Image.Image, key: str) -> tuple[float, float] | None:
    try:
        x, y = (float(value) for value in image.info.get(key, (0.0, 0.0)))
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    good = math.isfinite(x) and math.isfinite(y) and min(x, y) > 0.0
    return (x, y) if good else None
