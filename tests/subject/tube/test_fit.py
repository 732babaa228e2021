"""The tube in a picture: its shapes, its edges, the fit, and what is lost."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from profiletool.errors import NoObject, NoScale, UsageError
from profiletool.files.design_json import load_design
from profiletool.image.load import load_picture
from profiletool.records.bench import Seen
from profiletool.subject.tube.camera import FlatCamera, Place, SheetCamera
from profiletool.subject.tube.edges import edge_pairs, edges_across, sampled, shown
from profiletool.subject.tube.family import Family
from profiletool.subject.tube.fit import fit_tube
from profiletool.subject.tube.marks import mark_lines
from profiletool.subject.tube.series import measure_series
from profiletool.subject.tube.values import Line, start_of
from profiletool.subject.tube.views import Looked
from profiletool.verify.predicted import predicted_by_response
from tests.subject.tube.drawn import MM_PER_PX, PLACE, family, picture

TURNS = np.array([2.0, -1.5, 1.0, 0.5, -2.0, 1.5])


@pytest.fixture(scope="module")
def known() -> Family:
    return family(Path(__file__).parents[3] / "samples")


def test_a_family_gives_its_models_own_lines_back(samples: Path) -> None:
    design = load_design(samples / "paper_bulb.json")
    predicted = predicted_by_response(design, 1.0)
    shape, made = predicted.shapes[6], family(samples)
    outline = made.outline(float(predicted.pressure_bar[6]), np.zeros(6), np.zeros(6))
    ends = [np.linalg.norm(line[-1] - line[0]) for line in (shape.axis, outline.axis)]
    assert ends[0] == pytest.approx(ends[1], abs=1e-6)
    width = np.linalg.norm(shape.far - shape.facing, axis=1)
    assert 2.0 * outline.half == pytest.approx(width, abs=1e-9)
    # Toward the object is to the left of the tube, whichever side the design is for.
    assert outline.axis[len(outline.axis) // 2, 1] > 0.0


def test_a_joint_turned_further_turns_all_beyond_it(known: Family) -> None:
    none = np.zeros(6)
    turn = none.copy()
    turn[2] = np.radians(5.0)
    plain, more = known.outline(0.8, none, none), known.outline(0.8, turn, none)
    headings = [np.arctan2(line.out[:, 0], -line.out[:, 1]) for line in (plain, more)]
    off = np.degrees(headings[1] - headings[0])
    assert off[known.middles[:3]] == pytest.approx(0.0, abs=1e-9)
    assert off[known.middles[3:]] == pytest.approx(5.0, abs=1e-9)
    assert known.theta_deg(0.8, turn)[2] - known.theta_deg(0.8, none)[2] == pytest.approx(5.0)


def test_a_joint_lengthened_moves_all_beyond_it(known: Family) -> None:
    none, grow = np.zeros(6), np.array([0.0, 0.0, 0.0, 2.0, 0.0, 0.0])
    plain, more = known.outline(0.0, none, none), known.outline(0.0, none, grow)
    off = more.axis - plain.axis
    assert off[known.middles[3]] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert off[-1] == pytest.approx([2.0, 0.0], abs=1e-9)


def test_a_joint_shifted_moves_all_beyond_it_across(known: Family) -> None:
    none, shift = np.zeros(6), np.array([0.0, 0.0, 0.0, 0.5, 0.0, 0.0])
    off = known.outline(0.0, none, none, shift).axis - known.outline(0.0, none, none).axis
    assert off[known.middles[3]] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert off[-1] == pytest.approx([0.0, -0.5], abs=1e-6)  # away from the object


@pytest.mark.parametrize("at", [40.0, 40.3, 39.55])
def test_an_edge_is_found_between_pixels(at: float) -> None:
    x = np.arange(80.0)
    ramp = np.clip(x - at + 0.5, 0.0, 1.0)  # area of each pixel beyond the edge
    rgb = np.repeat(np.tile(200.0 - 120.0 * ramp, (60, 1))[..., None], 3, axis=2)
    px = np.column_stack([np.full(20, 41.0), np.arange(20.0, 40.0)])
    normal = np.tile([1.0, 0.0], (20, 1))
    found = edges_across(shown(np.round(rgb).astype(np.uint8)), px, normal, 8.0, 4.0)
    assert found.seen.all()
    assert px[:, 0] + found.off == pytest.approx(at, abs=0.05)


def strips(*levels: tuple[float, float]) -> np.ndarray:
    """Draw upright strips, blurred: each from an x on with its level."""
    x = np.arange(140.0)
    line = np.full(140, float(levels[0][1]))
    for at, level in levels[1:]:
        line += (level - line) * np.clip(x - at + 0.5, 0.0, 1.0)
    line = np.convolve(np.pad(line, 4, mode="edge"), [0.25, 0.5, 0.25], "same")[4:-4]
    return np.repeat(np.tile(line, (60, 1))[..., None], 3, axis=2).round().astype(np.uint8)


@pytest.mark.parametrize(
    ("levels", "right"),
    [
        (((0, 230), (40, 120), (100, 230)), 100.0),
        (((0, 230), (40, 120), (100, 200), (105, 60)), 100.0),  # an object stands beside it
        (((0, 230), (40, 120), (94, 190), (96, 120), (100, 180)), 100.0),  # a bright thread in it
        (((0, 230), (40, 120), (104, 230)), None),  # no edge where it must be
        (((0, 230), (40, 120)), None),
    ],
    ids=["plain", "object", "thread", "wider", "one line"],
)
def test_edges_are_as_far_apart_as_the_tube_is_wide(
    levels: tuple[tuple[float, float], ...], right: float | None
) -> None:
    rgb = strips((0, 230), (40, 120), (100, 230))
    rgb[25:] = strips(*levels)[25:]
    y = np.arange(10.0, 35.0)
    px = np.stack([np.column_stack([np.full(25, at), y]) for at in (41.0, 100.5)])
    normal = np.stack([np.tile([side, 0.0], (25, 1)) for side in (-1.0, 1.0)])
    left, other = edge_pairs(shown(rgb), px, normal, 7.0, 4.0, 0.5)
    some = y > 29.0  # clear of where the strips change
    if right is None:
        assert not other.seen[some].any()
        assert left.seen[some].all() == (len(levels) == 2)
    else:
        assert left.seen.all()
        assert px[0, some, 0] - left.off[some] == pytest.approx(40.0, abs=0.1)
        assert px[1, some, 0] + other.off[some] == pytest.approx(right, abs=0.3)


def test_no_edge_on_a_plain_ground() -> None:
    grain = np.random.default_rng(1).normal(0.0, 2.0, (60, 80, 3))
    rgb = np.clip(np.round(150.0 + grain), 0, 255).astype(np.uint8)
    px = np.column_stack([np.full(20, 41.0), np.arange(20.0, 40.0)])
    found = edges_across(shown(rgb), px, np.tile([1.0, 0.0], (20, 1)), 8.0, 4.0)
    assert not found.seen.any()


def test_sampled_is_bilinear() -> None:
    image = np.arange(12.0, dtype=np.float32).reshape(3, 4, 1)
    assert sampled(image, np.array([[1.5, 0.5], [-3.0, 1.0], [9.0, 9.0]]))[:, 0] == pytest.approx(
        [3.5, 4.0, 11.0], abs=0.01
    )


def test_turns_are_measured(known: Family) -> None:
    shot = picture(known, 0.8, TURNS)
    start = start_of(known, replace(PLACE, x=61.0, y=24.0, heading=1.52), 0.74)
    fitted = fit_tube(shown(shot.rgb), FlatCamera(MM_PER_PX), known, start)
    theta = known.theta_deg(fitted.tube.bar, fitted.tube.turn)
    true = known.theta_deg(0.8, np.radians(TURNS))
    sigma = np.degrees(np.sqrt(np.diag(fitted.covariance)))[5:11]
    assert np.abs(theta - true).max() < 0.8
    assert (np.abs(theta - true) < 3.0 * np.hypot(sigma, 0.08)).all()
    assert fitted.share[1:].min() > 0.8


def measured(
    known: Family, bars: tuple[float, ...], looked: Looked, **drawn: object
) -> tuple[Seen, ...]:
    shots = [picture(known, bar, **drawn) for bar in bars]  # type: ignore[arg-type]
    names = [f"{bar:g}.png" for bar in bars]
    return measure_series(known, names, bars, shots.__getitem__, looked)


@pytest.mark.slow
def test_a_series_is_found_and_measured(known: Family) -> None:
    bars = (0.4, 0.8)
    for seen, bar in zip(measured(known, bars, Looked(1.01 * MM_PER_PX)), bars, strict=True):
        true = known.theta_deg(bar, np.zeros(6))
        for angle, theta in zip(seen.angles, true, strict=True):
            assert angle.state == "measured"
            assert abs(angle.theta_deg - theta) < 3.0 * angle.sigma_deg
        assert seen.mm_per_px == pytest.approx(MM_PER_PX, rel=0.005)


@pytest.mark.slow
def test_seen_from_behind(known: Family) -> None:
    behind = replace(PLACE, hand=-1.0, x=90.0)
    (seen,) = measured(known, (0.9,), Looked(MM_PER_PX), place=behind)
    true = known.theta_deg(0.9, np.zeros(6))
    assert [angle.theta_deg for angle in seen.angles] == pytest.approx(true, abs=0.6)


@pytest.mark.slow
def test_hidden_edges_are_lost_and_lines_by_hand_take_their_place(known: Family) -> None:
    lines = FlatCamera(MM_PER_PX).lines(known.outline(0.8, np.zeros(6), np.zeros(6)), PLACE, 0.0)
    middle = lines.mean(axis=0)
    hidden = middle[known.sector == 6]
    x0, y0 = (hidden.min(axis=0) - 60).astype(int)
    x1, y1 = (hidden.max(axis=0) + 60).astype(int)
    patch = (max(x0, 0), max(y0, 0), x1, y1)
    (seen,) = measured(known, (0.8,), Looked(MM_PER_PX), patch=patch)
    assert seen.angles[5].state == "lost"
    assert np.isnan(seen.angles[5].theta_deg)
    assert "measured" in [angle.state for angle in seen.angles]
    ends = hidden[[0, -1]]
    drawn = {("0.8.png", 5): Line(middle[known.sector == 5][[0, -1]]), ("0.8.png", 6): Line(ends)}
    (seen,) = measured(known, (0.8,), Looked(MM_PER_PX, lines=drawn), patch=patch)
    assert seen.angles[5].state in ("by hand", "lost")
    if seen.angles[5].state == "by hand":
        true = known.theta_deg(0.8, np.zeros(6))[5]
        assert abs(seen.angles[5].theta_deg - true) < 3.0 * seen.angles[5].sigma_deg + 1.0


def test_dots_and_rings_are_lines(known: Family) -> None:
    shot = picture(known, 0.6)
    lines = FlatCamera(MM_PER_PX).lines(known.outline(0.6, np.zeros(6), np.zeros(6)), PLACE, 0.0)
    middle = lines.mean(axis=0)
    places = np.flatnonzero(known.sector == 6)
    y, x = np.mgrid[0:760, 0:760]
    for k in (places[len(places) // 4], places[3 * len(places) // 4]):
        spot = np.hypot(x - middle[k, 0], y - middle[k, 1]) < 4.0
        shot.rgb[spot] = (220, 30, 30)
    m = known.middles[3]
    across = (lines[1, m] - lines[0, m]) / np.linalg.norm(lines[1, m] - lines[0, m])
    along = np.array([-across[1], across[0]])
    off = np.stack([x, y], axis=-1) - middle[m]
    shot.rgb[(np.abs(off @ across) < 35.0) & (np.abs(off @ along) < 3.0)] = (30, 30, 220)
    found = mark_lines(shown(shot.rgb), FlatCamera(MM_PER_PX), known, start_of(known, PLACE, 0.6))
    assert sorted(found) == [3, 6]
    assert found[3].across
    assert not found[6].across
    for number, way in ((3, across), (6, middle[places[-1]] - middle[places[0]])):
        ends = found[number].ends[1] - found[number].ends[0]
        cosine = abs(ends @ way) / np.linalg.norm(ends) / np.linalg.norm(way)
        assert np.degrees(np.arccos(min(cosine, 1.0))) < 1.5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("drawn", "looked", "error", "said"),
    [
        ({}, Looked(), NoScale, "mm_per_px"),
        ({"place": Place(60.0, 300.0, 1.5, 1.0)}, Looked(MM_PER_PX), NoObject, "no actuator of"),
        ({"place": Place(60.0, 75.0, 1.5, 1.0)}, Looked(MM_PER_PX), NoObject, "out of the frame"),
        ({}, Looked(MM_PER_PX, lines={("0.8.png", 9): Line(np.eye(2))}), UsageError, "sector 10"),
        ({}, Looked(MM_PER_PX, box=(5000.0, 0.0, 10.0, 10.0)), UsageError, "box"),
    ],
    ids=["no scale", "no tube", "cut off", "no such sector", "box outside"],
)  # fmt: skip
def test_what_cannot_be_measured_is_refused(
    known: Family, drawn: dict[str, object], looked: Looked, error: type[Exception], said: str
) -> None:
    with pytest.raises(error, match=said):
        measured(known, (0.8,), looked, **drawn)


@pytest.mark.slow
@pytest.mark.parametrize("thing", ["pear", "bulb"])
def test_another_thing_is_no_actuator(known: Family, samples: Path, thing: str) -> None:
    shot = load_picture(samples / f"{thing}.png")
    scale = Looked(shot.mm_per_px)
    with pytest.raises(NoObject, match=f"{thing}.png: no actuator of this design found"):
        measure_series(known, [f"{thing}.png"], [0.8], lambda _: shot, scale)


class Squarely:
    """A view from straight above at a height, as `View` gives one: px are mm times ten."""

    camera_mm = np.array([30.0, 40.0, 500.0])

    def picture_of(self, points: np.ndarray) -> np.ndarray:
        return 10.0 * points

    def sheet_of(self, px: np.ndarray) -> np.ndarray:
        return px / 10.0


def test_a_tube_on_the_sheet_is_seen_where_rays_touch_it(known: Family) -> None:
    camera = SheetCamera(Squarely(), 10.0)  # type: ignore[arg-type]
    outline = known.outline(0.0, np.zeros(6), np.zeros(6))
    straight = Place(0.0, 90.0, 0.0, 1.0)
    lines = camera.lines(outline, straight, 0.0) / 10.0
    # In the plane across the tube: tangents from (40, 500) to the circle about (90, 10) of 10.
    depth, aside = 490.0, 50.0
    to, half = np.arctan2(aside, depth), np.arcsin(outline.half[60] / np.hypot(aside, depth))
    rims = 40.0 + 500.0 * np.tan([to - half, to + half])
    k = int(np.abs(known.along - 30.0).argmin())  # straight below the camera
    assert sorted(lines[:, k, 1]) == pytest.approx(rims, abs=1e-3)
    point = np.array([[55.0, 66.0]])
    assert camera.mm(camera.px(point, 0.0)) == pytest.approx(point)
