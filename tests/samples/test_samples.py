import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest
import shapely
from PIL import Image
from scipy.ndimage import map_coordinates

from profiletool.files.design_json import to_json

SAMPLES = Path(__file__).parents[2] / "samples"
NAMES = ("bulb", "pear", "egg", "bottle", "vase")
SIZES = {  # width where it is said, height
    "bulb": (60.0, 107.5),
    "pear": (None, 90.0),
    "egg": (44.0, 60.0),
    "bottle": (34.0, 90.0),
    "vase": (None, 120.0),
}


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("samples_render", SAMPLES / "render.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


def truth(name):
    """Closed outline (N, 2) in mm, first point not repeated."""
    ring = np.loadtxt(SAMPLES / "truth" / f"{name}.csv", delimiter=",", skiprows=1)
    assert np.array_equal(ring[0], ring[-1])
    return ring[:-1]


def placing(name):
    for row in (SAMPLES / "truth" / "pictures.csv").read_text().splitlines()[1:]:
        if row.startswith(name + ","):
            return [float(field) for field in row.split(",")[1:]]
    raise AssertionError(name)


def edge_distances(picture, outline_px):
    """Distance (px, outward) of the half-way level from the outline, along its normals."""
    middle = (outline_px + np.roll(outline_px, -1, axis=0)) / 2
    along = np.roll(outline_px, -1, axis=0) - outline_px
    # Pixel frame: y down, the outline runs down the left side, so outward is to the right.
    normal = np.column_stack([-along[:, 1], along[:, 0]]) / np.hypot(*along.T)[:, None]
    reach = np.linspace(-4, 4, 81)
    places = middle[:, None] + reach[:, None] * normal[:, None]
    seen = np.stack(
        [
            map_coordinates(
                picture[..., c].astype(float), places[..., ::-1].transpose(2, 0, 1), order=1
            )
            for c in range(3)
        ],
        axis=-1,
    )
    inside = seen[:, (reach < -1.7) & (reach > -2.8)].mean(1)
    step = seen[:, (reach > 1.7) & (reach < 2.8)].mean(1) - inside
    contrast = np.linalg.norm(step, axis=1)
    share = ((seen - inside[:, None]) * step[:, None]).sum(-1) / (contrast**2)[:, None]
    near = np.abs(reach) < 1.7
    place = np.array(
        [np.interp(0.5, np.maximum.accumulate(row), reach[near]) for row in share[:, near]]
    )
    return place, contrast


def outline_px(line, mm, top, spacing_px):
    """Evenly divided outline in the picture frame, down the left side."""
    fine = shapely.segmentize(shapely.LinearRing(line), spacing_px * mm)
    return shapely.get_coordinates(fine)[:-1] * (1, -1) / mm + top


def turns(line):
    """Turn at each vertex (degrees) of a closed outline, left positive."""
    along = np.roll(line, -1, axis=0) - line
    heading = np.arctan2(along[:, 1], along[:, 0])
    turn = heading - np.roll(heading, 1)
    return np.degrees((turn + np.pi) % (2 * np.pi) - np.pi)


@pytest.mark.parametrize("name", NAMES)
def test_truth_is_a_simple_polygon_of_the_said_size(name):
    line = truth(name)
    polygon = shapely.Polygon(line)
    assert polygon.is_valid
    assert np.array_equal(line[0], (0, 0))  # the top middle
    assert np.hypot(*np.diff(line, axis=0).T).min() > 0
    assert polygon.exterior.is_ccw  # down the left side
    x0, y0, x1, y1 = polygon.bounds
    width, height = SIZES[name]
    assert (y0, y1) == (pytest.approx(-height, abs=1e-3), 0.0)
    assert x0 == pytest.approx(-x1, abs=1e-3)
    if width:
        assert x1 - x0 == pytest.approx(width, abs=3e-3)


def test_bulb_blends_into_its_cap_without_a_corner():
    line = truth("bulb")
    glass = (line[:, 1] > -80) & (line[:, 1] < -1)
    assert np.abs(turns(line)[glass]).max() < 1.5
    centre = np.array([53.3, -(30 + np.sqrt(70**2 - 53.3**2))])
    joint = np.array([0, -30]) + (centre - (0, -30)) * 30 / 70
    right = line[line[:, 0] > 0]
    neck = right[(right[:, 1] < joint[1] - 0.01) & (right[:, 1] > centre[1])]
    crown = right[right[:, 1] > joint[1] + 0.01]
    assert len(neck) > 10
    np.testing.assert_allclose(np.hypot(*(neck - centre).T), 40, atol=2e-3)
    np.testing.assert_allclose(np.hypot(*(crown - (0, -30)).T), 30, atol=2e-3)


def test_bulb_thread_is_e27():
    line = truth("bulb")
    right = line[(line[:, 0] > 0) & (line[:, 1] < -80) & (line[:, 1] > -98)]
    left = line[(line[:, 0] < 0) & (line[:, 1] < -80) & (line[:, 1] > -98)]
    assert right[:, 0].max() == pytest.approx(13.3, abs=2e-3)
    assert right[:, 0].min() == pytest.approx(12.3, abs=2e-2)
    roots = [side[np.abs(side[:, 0]) < 12.32, 1] for side in (right, left)]
    shift = roots[0].max() - roots[1].max()
    assert shift == pytest.approx(3.629 / 2, abs=0.05)  # a helix


@pytest.mark.parametrize("name", NAMES)
def test_picture_stores_its_resolution(name):
    mm, width, height, _, _ = placing(name)
    with Image.open(SAMPLES / f"{name}.png") as picture:
        dpi = picture.info["dpi"]
        assert picture.size == (width, height)
    assert dpi[0] == dpi[1] == pytest.approx(25.4 / mm, rel=1e-4)
    assert min(abs(dpi[0] - usual) for usual in (72, 96)) > 10


@pytest.mark.parametrize("name", NAMES)
def test_edge_in_the_shipped_picture_is_the_truth(name):
    mm, _, _, x, y = placing(name)
    picture = np.asarray(Image.open(SAMPLES / f"{name}.png"))
    place, contrast = edge_distances(picture, outline_px(truth(name), mm, (x, y), 3))
    assert np.median(contrast) > 60
    assert abs(np.median(place)) < 0.05
    assert np.quantile(np.abs(place), 0.9) < 0.15


def test_same_scene_again_smaller(script):
    sample = script.SAMPLES["egg"].smaller(2)
    picture = script.render(sample)
    assert np.array_equal(picture, script.render(sample))
    line = outline_px(truth("egg"), sample.mm_per_px, sample.top_px, 3)
    place, _ = edge_distances(picture, line)
    assert abs(np.median(place)) < 0.08


def test_coverage_is_exact(script):
    sample = script.SAMPLES["bottle"].smaller(4)
    area = script.coverage(sample).sum() * sample.mm_per_px**2
    assert area == pytest.approx(shapely.Polygon(truth("bottle")).area, rel=2e-4)


@pytest.mark.parametrize("name", NAMES)
def test_truth_belongs_to_the_script(script, name):
    np.testing.assert_allclose(script.SAMPLES[name].body.outline()[:-1], truth(name), atol=1e-4)


def test_finger_rest_is_a_bendable_open_line():
    line = np.loadtxt(SAMPLES / "finger_rest.csv", delimiter=",", skiprows=1)
    assert shapely.LineString(line).is_simple
    assert line[:, 1].argmax() == 0
    assert line[:, 1].argmin() == len(line) - 1
    along = np.diff(line, axis=0)
    length = np.hypot(*along.T)
    assert length.sum() == pytest.approx(118, abs=1)
    turn = np.diff(np.unwrap(np.arctan2(along[:, 1], along[:, 0])))
    curvature = turn / ((length[1:] + length[:-1]) / 2)
    assert curvature.min() < -0.02
    assert curvature.max() > 0.02
    assert np.abs(curvature).max() < 1 / 25


def test_the_papers_bulb_is_what_its_script_writes():
    spec = importlib.util.spec_from_file_location("paper_bulb", SAMPLES / "paper_bulb.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert to_json(module.paper_bulb()) == (SAMPLES / "paper_bulb.json").read_text()
