"""Pictures whose files say odd things of their pixels."""

from __future__ import annotations

import struct
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw

from profiletool.errors import UnreadableInput
from profiletool.image import heif
from profiletool.image.load import load_picture

DISC = Image.new("RGB", (60, 80), (235, 232, 228))
ImageDraw.Draw(DISC).ellipse((10, 10, 50, 70), fill=(120, 60, 40))
CAMERA = Image.Exif()
CAMERA[33434] = 0.005  # exposure time
SCANNER = Image.Exif()
SCANNER[271] = "EPSON"


def saved(path: Path, image: Image.Image = DISC, **how: object) -> Path:
    image.save(path, **how)
    return path


@pytest.mark.parametrize(
    ("dpi", "exif", "mm_per_px"),
    [
        (254, None, 0.1),
        (254, SCANNER, 0.1),
        (254, CAMERA, None),
        *[(screen, None, None) for screen in (72, 96, 120, 144, 192, 216)],
        (1, None, None),
        (1e6, None, None),
    ],
)
@pytest.mark.parametrize("name", ["a.png", "a.tif"])
def test_only_a_scanner_tells_its_scale(
    tmp_path: Path, name: str, dpi: float, exif: Image.Exif | None, mm_per_px: float | None
) -> None:
    more = {} if exif is None else {"exif": exif}
    found = load_picture(saved(tmp_path / name, dpi=(dpi, dpi), **more)).mm_per_px
    assert found == (None if mm_per_px is None else pytest.approx(mm_per_px, rel=1e-3))


@pytest.mark.parametrize(
    ("dpi", "size", "mm_per_px"),
    [((300, 150), (60, 160), 25.4 / 300), ((100, 200), (120, 80), 25.4 / 200)],
)
def test_pixels_that_are_not_square_are_stretched(
    tmp_path: Path, dpi: tuple[int, int], size: tuple[int, int], mm_per_px: float
) -> None:
    picture = load_picture(saved(tmp_path / "a.tif", dpi=dpi))
    assert picture.rgb.shape[1::-1] == size
    assert picture.mm_per_px == pytest.approx(mm_per_px)
    assert "as high as wide: it was stretched" in picture.notes[0]
    assert load_picture(saved(tmp_path / "b.tif", dpi=(300, 299))).notes == ()


@pytest.mark.parametrize("bits", [8, 10, 12, 14, 16])
def test_sensors_values_in_16_bits(tmp_path: Path, bits: int) -> None:
    top = (1 << bits) - 1
    values = np.full((40, 40), top, np.uint16)
    values[10:30, 10:30] = top // 2
    found = load_picture(saved(tmp_path / "a.tif", Image.fromarray(values))).rgb
    assert found.max() == 255
    assert abs(int(found[20, 20, 0]) - 127) <= 1


def test_colours_of_12_bits_in_16_are_almost_black(tmp_path: Path) -> None:
    dark = Image.fromarray(np.asarray(DISC) // 16)
    with pytest.raises(UnreadableInput, match="almost black, as 12 bit values in 16 are"):
        load_picture(saved(tmp_path / "a.png", dark))


def test_alpha_that_is_0_everywhere_means_nothing_in_a_bmp(tmp_path: Path) -> None:
    clear = DISC.convert("RGBA")
    clear.putalpha(0)
    assert load_picture(saved(tmp_path / "a.png", clear)).alpha is not None
    buffer = BytesIO()
    clear.save(buffer, "BMP", bitmap_format="bmp")
    (tmp_path / "a.bmp").write_bytes(buffer.getvalue())
    picture = load_picture(tmp_path / "a.bmp")
    assert picture.alpha is None
    np.testing.assert_array_equal(picture.rgb, np.asarray(DISC))


@pytest.mark.parametrize("name", ["a.tif", "a.webp", "a.png"])
def test_several_pictures_in_one_file_are_told(tmp_path: Path, name: str) -> None:
    others = [Image.new("RGB", DISC.size, colour) for colour in ("red", "blue")]
    path = saved(tmp_path / name, save_all=True, append_images=others)
    assert load_picture(path).notes == ("the file holds 3 pictures: the first was taken",)
    assert load_picture(saved(tmp_path / name)).notes == ()


@pytest.mark.parametrize(
    ("head", "says"),
    [
        (b"<svg xmlns=''/>", "looks like SVG: name it .svg"),
        (b"0\nSECTION\n2\nHEADER\n", "looks like DXF: name it .dxf"),
        (b"  0\r\nSECTION\r\n", "looks like DXF: name it .dxf"),
        (b"%!PS-Adobe", "looks like PostScript"),
        (b"\x1f\x8b\x08" + b"x" * 20, "looks like packed: unpack it"),
        (b"AC1027", "looks like DWG: save it as DXF"),
        (b"\0\0\0\x18ftypavif", "looks like AVIF"),
        (b"\0\0\0\x18ftypheic", "looks like HEIC, which takes pip install profiletool[heic]"),
    ],
)
def test_what_it_is_instead_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, head: bytes, says: str
) -> None:
    monkeypatch.setattr(heif, "_DECODERS", ())  # as if the extra were not installed
    (tmp_path / "a.png").write_bytes(head)
    with pytest.raises(UnreadableInput) as refusal:
        load_picture(tmp_path / "a.png")
    assert says in str(refusal.value)


def tiff(compression: str) -> bytes:
    buffer = BytesIO()
    DISC.save(buffer, "TIFF", compression=compression)
    return buffer.getvalue()


def pointed(data: bytes, tag: int, value: int) -> bytes:
    """The file with another value for a tag; 0 for where the tags themselves are."""
    (place,) = struct.unpack("<I", data[4:8])
    if tag == 0:
        return data[:4] + struct.pack("<I", value) + data[8:]
    (count,) = struct.unpack("<H", data[place : place + 2])
    entries = [place + 2 + 12 * n for n in range(count)]
    (at,) = (e for e in entries if struct.unpack("<H", data[e : e + 2]) == (tag,))
    return data[: at + 8] + struct.pack("<I", value) + data[at + 12 :]


@pytest.mark.parametrize("compression", ["raw", "tiff_lzw"])
@pytest.mark.parametrize("tag", [0, 273, 279])  # tags, strips, sizes of strips
@pytest.mark.parametrize("value", [0x7FFFFFFF, 0xFFFFFFF0, 500_000])
def test_a_tiff_that_points_outside_itself(
    tmp_path: Path, compression: str, tag: int, value: int
) -> None:
    path = tmp_path / "a.tif"
    path.write_bytes(tiff(compression))
    assert load_picture(path).rgb.shape == (80, 60, 3)
    path.write_bytes(pointed(tiff(compression), tag, value))
    with pytest.raises(UnreadableInput, match="points outside itself"):
        load_picture(path)


def test_heic_with_the_extra() -> None:
    if not heif.with_heif():
        pytest.skip("needs the extra [heic]")
    picture = load_picture(Path(__file__).with_name("egg.heic"))
    assert picture.format == "HEIF"
    assert picture.rgb.shape in ((128, 96, 3), (96, 128, 3))
    assert abs(picture.rgb[64, 48].astype(int) - (120, 60, 40)).max() < 12
