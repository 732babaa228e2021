"""Small valid files of every kind that is read, for benchmarks/fuzz.py to damage."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path

from PIL import Image, ImageDraw, PngImagePlugin

ROOT = Path(__file__).resolve().parents[1]
_HOSTILE = ROOT.parent / "shared" / "hostile"
_CASES = ROOT / "tests" / "cases" / "files"
_SMALL = 40_000  # bytes of a hostile file that is damaged further
SUFFIX = {
    "picture": ".png", "dxf": ".dxf", "svg": ".svg", "csv": ".csv", "toml": ".toml",
    "design": ".json", "shape": ".csv", "formula": ".json", "rubber": ".csv",
}  # fmt: skip


def corpus(kind: str) -> list[bytes]:
    """Give the files of a kind."""
    return _MAKERS[kind]()


def _picture(mode: str, form: str, **how: object) -> bytes:
    image = Image.new("RGB", (40, 48), (235, 232, 228))
    ImageDraw.Draw(image).ellipse((10, 8, 30, 40), fill=(120, 60, 40))
    image = image.convert("L").convert(mode) if mode == "I;16" else image.convert(mode)
    buffer = io.BytesIO()
    image.save(buffer, form, **how)
    return buffer.getvalue()


def _pictures() -> list[bytes]:
    notes = PngImagePlugin.PngInfo()
    notes.add_text("Comment", "words " * 50, zip=True)
    notes.add_itxt("Title", "Höhe", zip=True)
    made = [_picture(mode, "PNG") for mode in ("RGB", "RGBA", "P", "L", "LA", "1", "I;16")]
    made.append(_picture("RGB", "PNG", dpi=(254, 254), pnginfo=notes, icc_profile=b"x" * 200))
    made.append(_picture("RGB", "PNG", transparency=(120, 60, 40)))
    made += [_picture(mode, "JPEG") for mode in ("RGB", "L", "CMYK")]
    exif = Image.Exif()
    exif[0x0112] = 6
    made.append(_picture("RGB", "JPEG", progressive=True, exif=exif))
    more = [Image.new("RGB", (40, 48), colour) for colour in ("red", "blue")]
    for compression in ("raw", "tiff_lzw", "tiff_adobe_deflate", "packbits"):
        made.append(_picture("RGB", "TIFF", compression=compression, dpi=(300, 300)))
    made.append(_picture("RGB", "TIFF", save_all=True, append_images=more))
    made += [_picture(mode, "TIFF") for mode in ("1", "I;16", "CMYK", "F")]
    made += [_picture(mode, "BMP") for mode in ("RGB", "L", "1", "P")]
    made += [_picture("RGB", "WEBP"), _picture("RGBA", "WEBP", lossless=True)]
    made.append(_picture("RGB", "WEBP", save_all=True, append_images=more))
    made.append(_picture("P", "GIF"))
    return made + _hostile() + _cases(".png", ".tif", ".jpg")


def _cases(*suffixes: str, rubber: bool = False) -> list[bytes]:
    """Small files of people's kinds."""
    files = sorted(path for path in _CASES.iterdir() if path.suffix in suffixes)
    return [
        path.read_bytes()
        for path in files
        if path.stat().st_size < _SMALL and path.name.startswith("rubber") == rubber
    ]


def _hostile() -> list[bytes]:
    if not _HOSTILE.is_dir():
        return []
    files = sorted(path for path in _HOSTILE.iterdir() if path.suffix not in (".md", ".txt"))
    return [path.read_bytes() for path in files if path.stat().st_size < _SMALL]


def _drawings() -> list[bytes]:
    import ezdxf

    def drawing(version: str, units: int, binary: bool) -> bytes:
        document = ezdxf.new(version, units=units)
        space = document.modelspace()
        document.blocks.new("A").add_circle((0, 0), 5)
        document.layers.add("Off").off()
        space.add_circle((0, 0), 20)
        space.add_arc((0, 0), radius=30, start_angle=0, end_angle=90, dxfattribs={"layer": "Off"})
        space.add_line((0, 0, 1), (9, 9, 1), dxfattribs={"extrusion": (0, 0, -1)})
        space.add_polyline2d([(0, 0), (3, 3), (4, 0)])
        space.add_blockref("A", (0, 0), dxfattribs={"row_count": 3, "column_count": 3})
        if version != "R12":
            space.add_open_spline([(0, 0), (0, 4), (3, 4), (3, 0)])
            space.add_lwpolyline([(0, 0, 1), (2, 0, 0)], format="xyb")
            space.add_ellipse((1, 2), major_axis=(2, 0), ratio=0.5)
        text, raw = io.StringIO(), io.BytesIO()
        document.write(raw if binary else text, fmt="bin" if binary else "asc")
        return raw.getvalue() if binary else text.getvalue().encode()

    short = (
        "0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n100\nAcDbEntity\n100\nAcDbPolyline\n90\n3\n70\n1\n10\n0\n20\n0\n10\n9\n20\n0\n10\n9\n"
        "20\n9\n0\nCIRCLE\n10\n3\n20\n3\n40\n2\n0\nARC\n10\n0\n20\n0\n40\n5\n50\n0\n51\n90\n"
        "0\nENDSEC\n0\nEOF\n"
    )
    return [
        drawing("R12", 0, False), drawing("R2000", 4, False), drawing("R2000", 1, True),
        *[short.encode()] * 3, *_cases(".dxf"),
    ]  # fmt: skip


def _svgs() -> list[bytes]:
    head = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
    bodies = (
        '<g transform="rotate(9) scale(2)"><path d="M0 0C0 40 30 40 30 0A9 9 0 0 1 9 9Q1 2 3 4z"/>'
        '</g><rect x="1mm" width="9" height="9" rx="2"/><use href="#a"/><circle id="a" r="4"/>',
        "<style>.no{display:none} path{stroke:red}</style><defs><path id='p' d='M0 0h9v9z'/></defs>"
        "<use xlink:href='#p' x='3' y='4'/><ellipse class='no' rx='3' ry='5'/>",
        '<polygon points="0,0 9,0 9,9"/><polyline points="1 1 2 2 3 1" style="fill:none"/>'
        '<image href="file:///etc/passwd"/><text x="3">9</text><line x1="1" x2="9%"/>',
        '<svg x="3" width="50" height="50" viewBox="0 0 9 9"><path d="M0 0 9 0 9 9T3 3S1 2 3 4z"/>'
        "</svg><symbol id='s'><circle r='3'/></symbol><use href='#s'/>",
    )
    sizes = ('width="100mm" height="90mm" viewBox="0 0 100 90"', 'width="50%"', 'viewBox="0 0 9 9"')
    made = [f"{head}{size}>{body}</svg>".encode() for size in sizes for body in bodies]
    return made + _cases(".svg", ".svgz")


def _points() -> list[bytes]:
    texts = (
        "x;y\n0;0\n10,5;0\n10;-5,25\n",
        "x_mm,y_mm\n0,0\n9,0\n9,9\n0,9\n0,0\n",
        "0 0\n1 2\n3 9",
    )
    return [text.encode() for text in texts] + _cases(".csv", ".txt")


def _options() -> list[bytes]:
    return [
        b'side = "right"\nmax-length = 200\nroot = 12\njoints = 4\nverify = false\n',
        b'height = 100.0\nmethod = "paper"\nwall = 2\nformula = "paper"\ntolerance = 0.1\n',
        b'out = "here"\nkerf = 0.1\ndate = "today"\npaper = "letter"\nforce = false\n',
    ]


def _designs() -> list[bytes]:
    return [(ROOT / "samples" / "paper_bulb.json").read_bytes()]


def _shapes() -> list[bytes]:
    return [b"curve,s_mm,x_mm,y_mm\ntarget,0.000,0.0000,0.0000\ntarget,5.000,5.0000,0.0000\n"]


def _formulas() -> list[bytes]:
    folder = ROOT / "formula" / "coefficients"
    found = [path.read_bytes() for path in sorted(folder.glob("*.json"))]
    return [*found, *(json.dumps(json.loads(data)).encode() for data in found)]


def _tests() -> list[bytes]:
    rows = [(1 + 0.05 * n, 0.39 * n * 0.05) for n in range(30)]
    plain = "".join(f"{a:.3f},{b:.4f}\n" for a, b in rows)
    percent = "".join(f"{a - 1:.3f};{1e3 * b:.4f}\n".replace(".", ",") for a, b in rows)
    made = [b"stretch,stress_MPa\n" + plain.encode(), b"Strain;Stress (kPa)\n" + percent.encode()]
    return made + _cases(".csv", rubber=True)


_MAKERS: dict[str, Callable[[], list[bytes]]] = {
    "picture": _pictures, "dxf": _drawings, "svg": _svgs, "csv": _points, "toml": _options,
    "design": _designs, "shape": _shapes, "formula": _formulas, "rubber": _tests,
}  # fmt: skip
