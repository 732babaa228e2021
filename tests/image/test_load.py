"""Every kind of picture that may come in, as a tiny literal one."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from profiletool.errors import UnreadableInput
from profiletool.image.load import load_picture

SIDE = 20
LEFT, RIGHT = (200, 100, 50), (10, 20, 30)


def halves(left: object, right: object, dtype: type = np.uint8) -> np.ndarray:
    """A picture whose left half has one colour and whose right half another."""
    one, two = np.asarray(left, dtype), np.asarray(right, dtype)
    row = np.stack([one] * (SIDE // 2) + [two] * (SIDE // 2))
    return np.stack([row] * SIDE)


def saved(folder: Path, image: Image.Image, name: str = "a.png", **options: object) -> Path:
    path = folder / name
    image.save(path, **options)
    return path


def corners(path: Path) -> tuple[list[int], list[int]]:
    rgb = load_picture(path).rgb
    assert rgb.dtype == np.uint8
    return rgb[0, 0].tolist(), rgb[0, -1].tolist()


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.bmp", "a.webp"])
def test_rgb_in_every_lossless_format(tmp_path: Path, name: str) -> None:
    options = {"lossless": True} if name.endswith("webp") else {}
    path = saved(tmp_path, Image.fromarray(halves(LEFT, RIGHT)), name, **options)
    assert corners(path) == (list(LEFT), list(RIGHT))
    assert load_picture(path).alpha is None


@pytest.mark.parametrize(
    ("mode", "expected"),
    [("L", ([200] * 3, [40] * 3)), ("1", ([255] * 3, [0] * 3)), ("P", ([200] * 3, [40] * 3))],
)
@pytest.mark.parametrize("name", ["a.png", "a.tif"])
def test_grey_bilevel_and_palette(
    tmp_path: Path, mode: str, expected: tuple[list[int], list[int]], name: str
) -> None:
    image = Image.fromarray(halves(200, 40)).convert(mode)
    assert corners(saved(tmp_path, image, name)) == expected


@pytest.mark.parametrize("mode", ["LA", "RGBA"])
@pytest.mark.parametrize("name", ["a.png", "a.tif"])
def test_alpha_keeps_the_colour_beneath(tmp_path: Path, mode: str, name: str) -> None:
    pixels = {"LA": ((200, 255), (40, 0)), "RGBA": ((200, 200, 200, 255), (40, 40, 40, 0))}
    image = Image.fromarray(halves(*pixels[mode]), mode=None)
    picture = load_picture(saved(tmp_path, image, name))
    assert picture.alpha is not None
    assert picture.alpha[0, [0, -1]].tolist() == [255, 0]
    assert picture.rgb[0, [0, -1], 0].tolist() == [200, 40]


def test_opaque_alpha_is_none(tmp_path: Path) -> None:
    image = Image.fromarray(halves((*LEFT, 255), (*RIGHT, 255)))
    assert load_picture(saved(tmp_path, image)).alpha is None


@pytest.mark.parametrize(("mode", "key"), [("P", 40), ("L", 40), ("RGB", (40, 40, 40))])
def test_transparent_colour_of_a_png(tmp_path: Path, mode: str, key: object) -> None:
    image = Image.fromarray(halves(200, 40)).convert(mode)
    picture = load_picture(saved(tmp_path, image, transparency=key))
    assert picture.alpha is not None
    assert picture.alpha[0, [0, -1]].tolist() == [255, 0]
    assert picture.rgb[0, [0, -1], 0].tolist() == [200, 40]


@pytest.mark.parametrize("name", ["a.png", "a.tif"])
def test_sixteen_bit_grey_is_scaled(tmp_path: Path, name: str) -> None:
    image = Image.fromarray(halves(200 * 257, 40 * 257, np.uint16))
    assert corners(saved(tmp_path, image, name)) == ([200] * 3, [40] * 3)


@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("name", ["a.png", "a.tif"])
def test_sixteen_bit_colour_is_scaled(tmp_path: Path, name: str, channels: int) -> None:
    bgra = [(50 * 257, 100 * 257, 200 * 257, 65535), (30 * 257, 20 * 257, 10 * 257, 0)]
    path = tmp_path / name
    assert cv2.imwrite(str(path), halves(*(c[:channels] for c in bgra), np.uint16))
    assert corners(path) == (list(LEFT), list(RIGHT))
    alpha = load_picture(path).alpha
    assert (None if alpha is None else alpha[0, [0, -1]].tolist()) == (
        [255, 0] if channels == 4 else None
    )


@pytest.mark.parametrize("name", ["a.jpg", "a.tif"])
def test_cmyk(tmp_path: Path, name: str) -> None:
    image = Image.fromarray(halves((0, 255, 255, 0), (0, 0, 0, 255)), mode="CMYK")
    left, right = corners(saved(tmp_path, image, name))
    np.testing.assert_allclose(left, [255, 0, 0], atol=12)
    np.testing.assert_allclose(right, [0, 0, 0], atol=12)


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.tif", "a.webp"])
def test_all_orientations_come_out_equal(tmp_path: Path, name: str) -> None:
    upright = np.zeros((24, 32, 3), np.uint8)
    upright[:12, :10], upright[12:, 20:] = (255, 0, 0), (0, 0, 255)
    # How a camera stores a picture that its tag then turns upright.
    stored = {
        1: upright, 2: upright[:, ::-1], 3: upright[::-1, ::-1], 4: upright[::-1],
        5: upright.swapaxes(0, 1), 6: np.rot90(upright), 7: np.rot90(upright, 2).swapaxes(0, 1),
        8: np.rot90(upright, -1),
    }  # fmt: skip
    for tag, pixels in stored.items():
        exif = Image.Exif()
        exif[0x0112] = tag
        path = saved(tmp_path, Image.fromarray(np.ascontiguousarray(pixels)), name, exif=exif)
        seen = load_picture(path).rgb
        assert seen.shape == upright.shape, tag
        assert np.abs(seen.astype(int) - upright).mean() < 8, tag


def test_alpha_turns_with_the_picture(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[0x0112] = 6
    image = Image.fromarray(halves((*LEFT, 255), (*RIGHT, 0)))
    alpha = load_picture(saved(tmp_path, image, exif=exif)).alpha
    assert alpha is not None
    assert alpha[[0, -1], 0].tolist() == [255, 0]


@pytest.mark.parametrize(
    ("name", "dpi", "expected"),
    [
        ("a.png", (254, 254), 0.1),
        ("a.tif", (300, 300), 25.4 / 300),
        ("a.jpg", (300, 300), None),
        ("a.png", (72, 72), None),
        ("a.tif", (96, 96), None),
        ("a.png", (300, 150), 25.4 / 300),
        ("a.png", (0, 0), None),
    ],
)
def test_stored_resolution(
    tmp_path: Path, name: str, dpi: tuple[int, int], expected: float | None
) -> None:
    path = saved(tmp_path, Image.fromarray(halves(LEFT, RIGHT)), name, dpi=dpi)
    assert load_picture(path).mm_per_px == (expected and pytest.approx(expected, rel=1e-4))


def png_header(width: int, height: int) -> bytes:
    """The start of a PNG that claims a size and holds no pixels."""
    body = b"IHDR" + struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = b"IDAT" + zlib.compress(b"")
    chunks = [
        struct.pack(">I", len(c) - 4) + c + struct.pack(">I", zlib.crc32(c))
        for c in (body, data, b"IEND")
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "empty"),
        (b"GIF89a" + bytes(40), "GIF"),
        (bytes(4) + b"ftypheic" + bytes(40), "HEIC"),
        (b"not a picture at all", "not a picture"),
        (png_header(8001, 8001), "64 megapixels"),
        (png_header(100_000, 100_000), "64 megapixels"),
        (png_header(3, 300), "3 x 300 pixels"),
        (png_header(64, 64), "truncated"),
        (bytes(50_000_001), "50 MB"),
    ],
)
def test_refusals_say_why_in_one_line(tmp_path: Path, content: bytes, reason: str) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(content)
    with pytest.raises(UnreadableInput, match=reason) as caught:
        load_picture(path)
    assert "\n" not in str(caught.value)


def test_truncated_files_are_refused(tmp_path: Path) -> None:
    noise = np.random.default_rng(0).integers(0, 255, (64, 64, 3)).astype(np.uint8)
    for name in ("a.png", "a.jpg", "a.tif", "a.bmp", "a.webp"):
        path = saved(tmp_path, Image.fromarray(noise), name)
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
        with pytest.raises(UnreadableInput):
            load_picture(path)


def test_floating_point_is_refused(tmp_path: Path) -> None:
    path = saved(tmp_path, Image.fromarray(np.ones((SIDE, SIDE), np.float32)), "a.tif")
    with pytest.raises(UnreadableInput, match="floating-point"):
        load_picture(path)


def test_missing_file_and_folder(tmp_path: Path) -> None:
    with pytest.raises(UnreadableInput, match="no such file"):
        load_picture(tmp_path / "absent.png")
    with pytest.raises(UnreadableInput, match="folder"):
        load_picture(tmp_path)
