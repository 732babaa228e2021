"""Templates as other programs draw them: true to scale in LibreCAD, Inkscape and poppler."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from profiletool.records.design import Design
from profiletool.template.dxf import write_dxf
from profiletool.template.kinds import Wish
from profiletool.template.layout import Sheet, build_sheet
from profiletool.template.pdf import write_pdf
from profiletool.template.svg import write_svg
from tests.programs import run
from tests.template.designs import bulb, long_tube

pytestmark = pytest.mark.slow

DPI = 600
MM = 25.4 / DPI  # a pixel
DARK = 235  # grey below which a pixel is ink
SHORT_MM = 9.0  # what a side may be drawn short
NOTCH_MM = 30.0  # a side along the tube is broken at x = 0, a clamp from its end


def ink_of(picture: Path) -> np.ndarray:
    with Image.open(picture) as image:
        flat = Image.new("RGB", image.size, "white")
        flat.paste(image, mask=image.getchannel("A") if "A" in image.getbands() else None)
    return np.asarray(flat).min(axis=2) < DARK


def upright_lines(ink: np.ndarray, least_mm: float) -> list[tuple[float, float]]:
    """Give the middle (mm from the left) and length (mm) of upright lines of some length."""
    padded = np.zeros((ink.shape[0] + 2, ink.shape[1]), dtype=np.int8)
    padded[1:-1] = ink
    change = np.diff(padded, axis=0)
    longest = np.zeros(ink.shape[1])
    for x in np.flatnonzero(ink.sum(axis=0) * MM >= least_mm):
        starts, ends = np.flatnonzero(change[:, x] > 0), np.flatnonzero(change[:, x] < 0)
        longest[x] = (ends - starts).max() * MM
    found = []
    columns = np.flatnonzero(longest >= least_mm)
    for group in np.split(columns, np.flatnonzero(np.diff(columns) > 1) + 1):
        if group.size:
            found.append((float(group.mean()) * MM, float(longest[group].max())))
    return found


def sheet_of(design: Design, wish: Wish = Wish()) -> Sheet:  # noqa: B008
    """Build a sheet that is longer than the bar and the check box, so that none is taken for it."""
    return build_sheet(replace(design, tube=replace(design.tube, length_mm=118.0)), wish)


def measure(picture: Path, piece: tuple[float, float], bar: bool = True) -> None:
    """Measure a picture of a sheet: its piece (mm along x, y), its 100 mm bar and its check box."""
    ink = ink_of(picture)
    for across, mm, short in ((ink, piece, SHORT_MM), (ink.T, piece[::-1], NOTCH_MM)):
        found = upright_lines(across, mm[1] - short)
        sides = [x for x, length in found if length < mm[1] + 0.5]
        assert sides, f"no side of {mm[1]} mm"
        assert max(sides) - min(sides) == pytest.approx(mm[0], abs=0.1)
    if not bar:
        return
    box = [x for x, length in upright_lines(ink, 49.5) if abs(length - 50.0) < 0.4]
    assert max(box) - min(box) == pytest.approx(100.0, abs=0.1)
    long = [(y, length) for y, length in upright_lines(ink.T, 99.5) if abs(length - 100.0) < 0.4]
    heights = sorted(y for y, _ in long)
    assert len(heights) == 3  # the bar, and the check box' upper and lower side
    assert heights[2] - heights[1] == pytest.approx(50.0, abs=0.1)
    thickness = 0.25  # at most, of a drawn line
    assert all(100.0 - 0.1 <= length <= 100.0 + 0.1 + thickness for _, length in long)


def drawn_by_poppler(pdf: Path, page: int = 1) -> Path:
    run(
        "pdftoppm",
        "-r",
        DPI,
        "-f",
        page,
        "-l",
        page,
        "-png",
        "-singlefile",
        pdf,
        "page",
        cwd=pdf.parent,
    )
    return pdf.parent / "page.png"


def test_librecad_draws_the_dxf_to_scale(tmp_path: Path) -> None:
    sheet = sheet_of(bulb())
    for version in ("R2000", "R12"):
        (tmp_path / "sheet.dxf").write_bytes(write_dxf(sheet.drawing, version))
        run("librecad", "dxf2pdf", "-c", "-s", "1.0", "-p", "297x420", "sheet.dxf", cwd=tmp_path)
        measure(drawn_by_poppler(tmp_path / "sheet.pdf"), sheet.size_mm)


def test_inkscape_draws_the_svg_to_scale(tmp_path: Path) -> None:
    sheet = sheet_of(bulb())
    (tmp_path / "sheet.svg").write_text(write_svg(sheet.drawing))
    run(
        "inkscape", "sheet.svg", "--export-type=png", f"--export-dpi={DPI}", "--export-area-page",
        cwd=tmp_path,
    )  # fmt: skip
    measure(tmp_path / "sheet.png", sheet.size_mm)
    layers = {
        row.split(",")[0]: [float(v) * 25.4 / 96 for v in row.split(",")[1:]]
        for row in run("inkscape", "--query-all", "sheet.svg", cwd=tmp_path).splitlines()
    }
    assert {"CUT_OUTER", "CUT_INNER", "MARK", "NOTE", "REF"} <= set(layers)
    assert layers["CUT_OUTER"][2:] == pytest.approx(sheet.size_mm, abs=0.11)  # a hairline wider


@pytest.mark.parametrize("paper", ["a4", "letter"])
@pytest.mark.parametrize("build", [bulb, long_tube])
def test_poppler_draws_the_pdf_to_scale(tmp_path: Path, paper: str, build) -> None:
    wish = Wish(date="2026-11-26")
    sheet = sheet_of(build(), wish) if build is bulb else build_sheet(build(), wish)
    pdf = tmp_path / "sheet.pdf"
    pdf.write_bytes(write_pdf(sheet.drawing, paper, sheet.parts))
    told = run("pdfinfo", pdf, cwd=tmp_path)
    pages = int(told.split("Pages:")[1].split()[0])
    assert pages == {("a4", bulb): 2, ("a4", long_tube): 2, ("letter", bulb): 2}.get(
        (paper, build), 3
    )
    if pages < 3:  # else the piece is tiled
        measure(drawn_by_poppler(pdf), sheet.size_mm, bar=pages == 1)


@pytest.mark.parametrize("kind", ["sleeve", "strip"])
def test_other_kinds_are_to_scale_too(tmp_path: Path, kind: str) -> None:
    sheet = sheet_of(bulb(), Wish(kind))
    pdf = tmp_path / "sheet.pdf"
    pdf.write_bytes(write_pdf(sheet.drawing, "a4", sheet.parts))
    x, y = np.ptp(sheet.outline, axis=0)
    measure(drawn_by_poppler(pdf), (x, y))
