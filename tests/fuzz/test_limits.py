"""Files that would take for ever, or all the memory, are refused in one line."""

from __future__ import annotations

import contextlib
import random
import struct
import zlib
from pathlib import Path
from types import ModuleType

import pytest
from PIL import Image

from profiletool.errors import NoObject, UnreadableInput
from profiletool.image import load, structure
from profiletool.image.load import load_picture
from profiletool.profile.drawing import chain, choose, dxf_entities, read_dxf
from profiletool.profile.drawing.load import load_vector

SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">'
DXF = (
    "0\nSECTION\n2\nENTITIES\n"
    + "0\nSPLINE\n100\nAcDbEntity\n100\nAcDbSpline\n70\n8\n71\n3\n72\n8\n73\n4\n"
    + "40\n0\n" * 4 + "40\n1\n" * 4 + "10\n0\n20\n0\n10\n0\n20\n4\n10\n3\n20\n4\n10\n3\n20\n0\n"
    + "0\nCIRCLE\n10\n0\n20\n0\n40\n9\n0\nENDSEC\n0\nEOF\n"
)  # fmt: skip

# --- too much of something --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ('<path d="M' + ".." * 500_000 + '"/>', "bad 'd'"),
        ('<polygon points="' + "-" * 500_000 + '"/>', "bad 'points'"),
        ("<style>" + "a{b:c}" * 2000 + "</style>", "nothing drawable"),
        ("<style>" + "a{b:c}" * 2000 + "</style><style>" + "a{b:c}" * 2000 + "</style>", "endless"),
        ('<path transform="' + "(" * 2000 + '" d="M0 0h9v9z"/>', "endless 'transform'"),
        ('<path d="M0 0' + "L9 9 0 9" * 20_000 + '"/>', "more than 60000 numbers"),
        ('<path d="M0 0' + "z" * 60_001 + '"/>', "more than 60000 numbers"),
        (f'<path id="p" d="M0 0{"L1 1" * 900}"/>' + '<use href="#p"/>' * 30, "more than 60000"),
        (f'<g id="p">{"<g/>" * 99}</g><g id="p"/>' + '<use href="#p"/>' * 90, "more than 6000"),
        ("<g>" * 5000 + "</g>" * 5000, "nested"),
        (f"<g>{'<g/>' * 6000}</g>", "more than 6000 elements"),
        (
            "<g transform='rotate(1)'>" * 90 + "<g/>" * 5000 + "</g>" * 90,
            "transforms in each other",
        ),
        ('<use href="#' + "x" * 5000 + '"/>', "endless 'href'"),
    ],
)
def test_svg_that_would_take_for_ever(tmp_path: Path, body: str, says: str) -> None:
    (tmp_path / "a.svg").write_text(f"{SVG}{body}</svg>")
    with pytest.raises((UnreadableInput, NoObject), match=says):
        load_vector(tmp_path / "a.svg")


def test_svg_attributes_are_not_handed_down_without_end(tmp_path: Path) -> None:
    extra = " ".join(f'a{n}="{"x" * 900}"' for n in range(2000))
    shapes = '<rect width="9" height="5"/>' * 500
    (tmp_path / "a.svg").write_text(f"{SVG}<g {extra}>{shapes}</g></svg>")
    assert len(load_vector(tmp_path / "a.svg").points) == 4


@pytest.mark.parametrize(
    ("module", "limit"),
    [(read_dxf, "MAX_LINES"), (dxf_entities, "MAX_ENTITIES"), (read_dxf, "MAX_SPLINE_POINTS")],
)
def test_dxf_of_too_much(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: ModuleType, limit: str
) -> None:
    (tmp_path / "a.dxf").write_text(DXF)
    monkeypatch.setattr(module, limit, 1)
    with pytest.raises(UnreadableInput, match="more than 1 "):
        load_vector(tmp_path / "a.dxf")


@pytest.mark.parametrize("line_end", [b"\n", b"\r", b"\r\n"])
def test_dxf_lines_are_counted_however_they_end(tmp_path: Path, line_end: bytes) -> None:
    (tmp_path / "a.dxf").write_bytes(b"0" + line_end * (read_dxf.MAX_LINES + 1))
    with pytest.raises(UnreadableInput, match="lines of text"):
        load_vector(tmp_path / "a.dxf")


def test_binary_dxf_has_a_limit_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "a.dxf").write_bytes(b"AutoCAD Binary DXF\r\n\x1a\0" + b"\0\0a\0" * 600_000)
    with pytest.raises(UnreadableInput, match="binary DXF"):
        load_vector(tmp_path / "a.dxf")


def test_lines_that_all_end_in_one_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chain, "MAX_MEETINGS", 10_000)
    star = "".join(f'<line x2="{n}" y2="{n * n % 97}"/>' for n in range(1, 300))
    (tmp_path / "a.svg").write_text(f"{SVG}{star}</svg>")
    with pytest.raises(UnreadableInput, match="far too many lines end in one place"):
        load_vector(tmp_path / "a.svg")


@pytest.mark.slow
def test_a_line_that_runs_to_and_fro(tmp_path: Path) -> None:
    text = "".join(f"{n % 2 * 1e4},{n % 2 * 1e4 + n * 0.01}\n" for n in range(20_000))
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(NoObject, match="to and fro"):
        load_vector(tmp_path / "a.csv")


def test_a_fine_outline_is_not_refused(tmp_path: Path) -> None:
    text = "".join(f"{n % 50_000 * 1e-3},{n * 1e-2}\n" for n in range(50_000))
    (tmp_path / "a.csv").write_text(text)
    assert len(load_vector(tmp_path / "a.csv").points) == 50_000
    assert choose.MAX_CLOSE_PAIRS > 50_000


# --- pictures ---------------------------------------------------------------------------------


def chunk(name: bytes, data: bytes) -> bytes:
    return len(data).to_bytes(4, "big") + name + data + zlib.crc32(name + data).to_bytes(4, "big")


@pytest.mark.parametrize(
    ("name", "head"), [(b"zTXt", b"x\0\0"), (b"iTXt", b"x\0\1\0\0\0"), (b"iCCP", b"x\0\0")]
)
def test_a_bomb_in_the_notes_of_a_png(tmp_path: Path, name: bytes, head: bytes) -> None:
    path = tmp_path / "a.png"
    Image.new("RGB", (30, 30)).save(path)
    data = path.read_bytes()
    bomb = chunk(name, head + zlib.compress(bytes(50_000_000)))
    path.write_bytes(data[:33] + bomb + data[33:])  # after the header
    with pytest.raises(UnreadableInput, match="too large"):
        load_picture(path)


def test_webp_has_a_limit_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(load.MAX_PIXELS_OF, "WEBP", 2_000_000)
    for name, suits in (("a.webp", False), ("a.png", True)):
        Image.new("RGB", (2000, 1500)).save(tmp_path / name)
        if suits:
            load_picture(tmp_path / name)
            continue
        with pytest.raises(UnreadableInput, match="more than 2 megapixels"):
            load_picture(tmp_path / name)


def test_bits_flipped_in_pictures(tmp_path: Path) -> None:
    chance, said = random.Random(5), []
    for name in ("a.png", "a.jpg", "a.tif", "a.bmp", "a.webp"):
        path = tmp_path / name
        Image.linear_gradient("L").resize((40, 40)).convert("RGB").save(path)
        data = path.read_bytes()
        for _ in range(40):
            made = bytearray(data)
            for _ in range(chance.randint(1, 5)):
                made[chance.randrange(min(len(made), 400))] = chance.randrange(256)
            path.write_bytes(made)
            with contextlib.suppress(UnreadableInput):
                load_picture(path)
                said.append("")
    assert len(said) > 20  # harmless ones are read


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"0,0\n" + b";" * 20_000, "line 2 never ends"),
        (b"0,0\x0b" * 200_001, "more than 200000 points"),
        (b"\n" * 400_001 + b"0", "more than 200000 lines"),
    ],
)
def test_columns_without_end(tmp_path: Path, data: bytes, says: str) -> None:
    (tmp_path / "a.csv").write_bytes(data)
    with pytest.raises(UnreadableInput, match=says):
        load_vector(tmp_path / "a.csv")


def saved(path: Path, **how: object) -> bytes:
    Image.linear_gradient("L").convert("RGB").save(path, **how)
    load_picture(path)  # as it is
    return path.read_bytes()


def test_a_png_of_chunks_without_end(tmp_path: Path) -> None:
    data = saved(tmp_path / "a.png")
    for count, end in ((1000, ""), (structure.MAX_PARTS, "more than 20000 chunks")):
        made = data[:33] + chunk(b"tEXt", b"a\0b") * count + data[33:]
        (tmp_path / "a.png").write_bytes(made)
        if not end:
            load_picture(tmp_path / "a.png")
            continue
        with pytest.raises(UnreadableInput, match=end):
            load_picture(tmp_path / "a.png")


def test_a_jpeg_of_scans_without_end(tmp_path: Path) -> None:
    data = saved(tmp_path / "a.jpg", progressive=True)
    last = data[data.rindex(b"\xff\xda") : -2]
    (tmp_path / "a.jpg").write_bytes(data[:-2] + last * 60 + data[-2:])
    with pytest.raises(UnreadableInput, match="more than 50 scans"):
        load_picture(tmp_path / "a.jpg")


@pytest.mark.parametrize("how", [{}, {"big_tiff": True}])
def test_a_tiff_of_strips_without_end(tmp_path: Path, how: dict[str, bool]) -> None:
    data = saved(tmp_path / "a.tif", **how)
    count, width = (8, "<HHQ") if how else (4, "<HHI")
    place = data.index(struct.pack("<HH", 273, 4) + b"\x01")
    huge = struct.pack(width, 273, 4, 2_000_000)
    assert len(huge) == 4 + count
    (tmp_path / "a.tif").write_bytes(data[:place] + huge + data[place + len(huge) :])
    with pytest.raises(UnreadableInput, match="more than 20000 strips"):
        load_picture(tmp_path / "a.tif")
