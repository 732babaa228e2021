"""DXF files as CAD programs write them: units, blocks, layers, frames, planes, splines, gaps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from profiletool.errors import NoObject, NoScale, ProfiletoolError, UsageError
from tests.profile.drawing.egg import EGG, SIZE, size_of

Draw = Callable[[Any, Any], object]
Point = tuple[float, ...]
RING: list[Point] = [(float(x), float(y)) for x, y in EGG]


@pytest.fixture
def drawn(tmp_path: Path) -> Callable[..., Path]:
    def save(draw: Draw, units: int = 4, version: str = "R2000") -> Path:
        document = ezdxf.new(version, units=units)
        draw(document.modelspace(), document)
        document.saveas(tmp_path / "a.dxf")
        return tmp_path / "a.dxf"

    return save


def egg(space: Any, scale: float = 1.0, points: Sequence[Point] = RING, **how: object) -> Any:
    scaled = [(scale * x, scale * y) for x, y in points]
    return space.add_lwpolyline(scaled, close=True, dxfattribs=how)


def blocks_in_blocks(space: Any, document: Any) -> None:
    inner, outer = document.blocks.new("A"), document.blocks.new("B")
    egg(inner, 0.5)
    outer.add_blockref("A", (3, 4), dxfattribs={"xscale": 2, "yscale": 2, "rotation": 90})
    space.add_blockref("B", (10, 10), dxfattribs={"rotation": -90})


def mirrored_block(space: Any, document: Any) -> None:
    egg(document.blocks.new("A"), points=[(-x, y) for x, y in RING])
    space.add_blockref("A", (0, 0), dxfattribs={"xscale": -1})


def block_on_layer(space: Any, document: Any) -> None:
    block = document.blocks.new("A")
    egg(block)
    block.add_circle((200, 0), 70, dxfattribs={"layer": "Off"})
    document.layers.add("Off").off()
    space.add_blockref("A", (0, 0))


def frozen_block(space: Any, document: Any) -> None:
    egg(space)
    document.blocks.new("A").add_circle((200, 0), 70)
    document.layers.add("Frozen").freeze()
    space.add_blockref("A", (0, 0), dxfattribs={"layer": "Frozen"})


def hatch(space: Any, _: object) -> None:
    space.add_hatch().paths.add_polyline_path(RING, is_closed=True)


def hatched(space: Any, document: Any) -> None:
    egg(space)
    hatch(space, document)


def dimensions(space: Any, _: object) -> None:
    egg(space)
    space.add_linear_dim(base=(0, 60), p1=(-30, 45), p2=(30, 45)).render()
    space.add_text("egg")


def unclamped_periodic(space: Any, _: object) -> None:
    space.add_spline().apply_construction_tool(
        ezdxf.math.closed_uniform_bspline([(45, 0), (0, 67), (-45, 0), (0, -67)], order=4)
    )


def short_lines(space: Any, _: object) -> None:
    for a, b in zip(RING, RING[1:] + RING[:1], strict=True):
        space.add_line(a, b)


@pytest.mark.parametrize(
    "draw",
    [
        blocks_in_blocks, mirrored_block, hatch, hatched, dimensions, short_lines,
        lambda space, _: egg(space, points=[(-x, y) for x, y in RING], extrusion=(0, 0, -1)),
    ],
)  # fmt: skip
def test_the_same_egg(
    drawn: Callable[..., Path], notes_of: Callable[..., list[str]], draw: Draw
) -> None:
    path = drawn(draw)
    assert size_of(path) == pytest.approx(SIZE, rel=1e-3)
    assert notes_of(path) == []


@pytest.mark.parametrize(
    ("units", "mm"),
    [(1, 25.4), (2, 304.8), (5, 10.0), (6, 1000.0), (9, 0.0254), (10, 914.4), (13, 1e-3),
     (14, 100.0)],
)  # fmt: skip
def test_units(drawn: Callable[..., Path], units: int, mm: float) -> None:
    path = drawn(lambda space, _: egg(space, 1.0 / mm), units)
    assert size_of(path) == pytest.approx(SIZE, rel=1e-3)


@pytest.mark.parametrize(
    ("units", "scale", "error", "says"),
    [
        (1, 1.0, NoScale, "unit is inches, which makes the profile 1[0-9]{3} x 2286 mm; give its"),
        (0, 0.01, NoScale, "names no unit, so its numbers were taken for mm, which makes"),
        (5, 1.0, NoObject, r"check the scale \(the drawing's unit is centimeters; `height_mm`"),
    ],
)
def test_a_unit_that_cannot_be_is_named(
    drawn: Callable[..., Path], units: int, scale: float, error: type[ProfiletoolError], says: str
) -> None:
    path = drawn(lambda space, _: egg(space, scale), units)
    with pytest.raises(error, match=says):
        size_of(path)
    assert size_of(path, width_mm=SIZE[0]) == pytest.approx(SIZE, rel=1e-3)


def test_no_header_at_all(drawn: Callable[..., Path]) -> None:
    path = drawn(lambda space, _: egg(space))
    text = path.read_text()
    path.write_text(text[text.index("  0\nSECTION\n  2\nTABLES") :])
    assert size_of(path) == pytest.approx(SIZE, rel=1e-3)


def title_block(space: Any, document: Any) -> None:
    egg(space)
    block = document.blocks.new("FRAME")
    sheet = [(-105, -148.5), (105, -148.5), (105, 148.5), (-105, 148.5)]
    for size in (1.0, 0.95):
        egg(block, size, sheet)
    block.add_line((20, -141), (20, -120))
    block.add_line((20, -120), (99.75, -120))
    space.add_blockref("FRAME", (0, 0))


def centre_lines(space: Any, _: object) -> None:
    egg(space)
    space.add_line((0, -60), (0, 60))
    space.add_line((-50, 0), (50, 0))


def gaps(space: Any, _: object) -> None:
    for n in range(0, 160, 20):
        part = (RING + RING[:1])[n : n + 21]
        space.add_lwpolyline([(x + 0.1 * (n % 40 == 0), y) for x, y in part])


def outside_reference(space: Any, document: Any) -> None:
    egg(space)
    document.add_xref_def("other.dwg", "X")
    space.add_blockref("X", (0, 0))


@pytest.mark.parametrize(
    ("draw", "said"),
    [
        (block_on_layer, "on layers that are off or frozen, 'off'"),
        (frozen_block, "on layers that are off or frozen, 'frozen'"),
        (title_block, "a rectangle round the profile, 210.0 x 297.0 mm at (0.0, 0.0), was taken"),
        (centre_lines, "the outline round all 3 lines was taken"),
        (gaps, "gaps of up to 0.33 mm between lines were closed"),
        (outside_reference, "left out of the drawing: 1 external reference"),
        (
            lambda space, _: space.add_polyline3d([(x, 5, y) for x, y in RING], close=True),
            "seen from the front",
        ),
        (
            lambda space, _: space.add_polyline3d([(7, x, y) for x, y in RING], close=True),
            "seen from the side",
        ),
        (
            lambda space, _: space.add_polyline3d([(x, y, x) for x, y in RING], close=True),
            "not flat: it was seen from above",
        ),
        (
            lambda space, _: (egg(space), egg(space, 0.6)),
            f"the outer outline, {SIZE[0]:.1f} x 90.0 mm",
        ),
    ],
)
def test_what_was_done_is_told(
    drawn: Callable[..., Path], notes_of: Callable[..., list[str]], draw: Draw, said: str
) -> None:
    path = drawn(draw)
    assert size_of(path) == pytest.approx(SIZE, rel=3e-3)
    assert any(said in note for note in notes_of(path)), notes_of(path)


def test_a_periodic_spline_with_uniform_knots(drawn: Callable[..., Path]) -> None:
    # Its points over the control points are (1 4 1)/6 of them: 30 of 45, 44.7 of 67.
    assert size_of(drawn(unclamped_periodic)) == pytest.approx((60.0, 2 * 67 * 4 / 6), abs=0.03)


def two_layers(space: Any, document: Any) -> None:
    egg(space, layer="Part")
    space.add_circle((200, 0), 60, dxfattribs={"layer": "Other"})
    document.layers.add("Part").off()


def test_a_layer_alone_even_if_it_is_off(drawn: Callable[..., Path]) -> None:
    path = drawn(two_layers)
    assert size_of(path) == pytest.approx((120.0, 120.0), abs=0.03)
    assert size_of(path, layer="part") == pytest.approx(SIZE, rel=1e-3)
    with pytest.raises(UsageError, match=r"no `layer` 'none'; there are '0', .*'other', 'part'"):
        size_of(path, layer="none")


@pytest.mark.parametrize(
    ("draw", "says"),
    [
        (lambda space, _: (egg(space), egg(space, 1.9, [(-30, -46), (30, -46), (30, 46),
                                                        (-30, 46)])), None),
        (lambda space, _: (egg(space, 0.5), egg(space, 1.25, [(-35, -60), (35, -60), (35, 60),
                                                              (-35, 60)])), "a frame or the obj"),
        (lambda space, _: space.add_image(space.doc.add_image_def("a.png", (9, 9)), (0, 0), (9, 9)),
         "only 1 IMAGE"),
    ],
)  # fmt: skip
def test_frames_and_what_may_be_one(
    drawn: Callable[..., Path], draw: Draw, says: str | None
) -> None:
    path = drawn(draw)
    if says is None:
        found = np.array(size_of(path))
        assert found[0] / found[1] == pytest.approx(SIZE[0] / SIZE[1], rel=1e-3)
        return
    with pytest.raises(NoObject, match=says):
        size_of(path)


def test_a_plate_with_a_hole_stays_a_plate(
    drawn: Callable[..., Path], notes_of: Callable[..., list[str]]
) -> None:
    plate = [(-70.0, -120.0), (70.0, -120.0), (70.0, 120.0), (-70.0, 120.0)]
    path = drawn(lambda space, _: (egg(space, 0.5), egg(space, 1.0, plate)))
    assert size_of(path) == pytest.approx((140.0, 240.0))
    (note,) = notes_of(path)
    assert "140.0 x 240.0 mm at (0.0, 0.0), was taken; a shape of 30.3 x 45.0 mm lies in it" in note
