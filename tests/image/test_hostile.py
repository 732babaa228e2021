"""Damaged and malicious files end in a picture or in one line, quickly and in little memory."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from profiletool.errors import UnreadableInput
from profiletool.image.load import load_picture

MUST_DECODE = {
    "Landscape_2.jpg", "Landscape_5.jpg", "Portrait_1.jpg", "Portrait_3.jpg", "Portrait_6.jpg",
    "Portrait_8.jpg", "basi6a16.png", "basn0g16.png", "basn3p01.png", "basn4a16.png",
    "basn6a16.png", "hopper_orientation_6.jpg", "mode_16bit.png", "pil_sample_cmyk.jpg",
    "tbrn2c08.png", "transparent.png",
}  # fmt: skip

# Loads every file of a folder; prints what came of it and the most memory held, in bytes.
PROBE = """
import json, resource, sys, time, warnings
from pathlib import Path
from profiletool.errors import UnreadableInput
from profiletool.image.load import load_picture
warnings.simplefilter("error")
seen = {}
for path in sorted(Path(sys.argv[1]).iterdir()):
    start = time.perf_counter()
    try:
        picture = load_picture(path)
        end = list(picture.rgb.shape)
    except UnreadableInput as error:
        end = str(error)
    seen[path.name] = end, time.perf_counter() - start
unit = 1 if sys.platform == "darwin" else 1024
print(json.dumps([seen, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit]))
"""


# A process starts with the peak of the one that it is forked from: here a small one.
SMALL = "import subprocess, sys; sys.exit(subprocess.run(sys.argv[1:]).returncode)"


def test_every_hostile_file_ends_well(shared: Path) -> None:
    run = subprocess.run(
        [sys.executable, "-c", SMALL, sys.executable, "-c", PROBE, str(shared / "hostile")],
        capture_output=True, text=True, check=True, timeout=60,
    )  # fmt: skip
    assert run.stderr == ""
    seen, memory = json.loads(run.stdout)
    assert memory < 1 << 30
    assert {name for name, (end, _) in seen.items() if isinstance(end, list)} == MUST_DECODE
    for name, (end, seconds) in seen.items():
        assert seconds < 5, name
        assert isinstance(end, list) or (name in end and "\n" not in end)


@pytest.mark.parametrize(
    ("names", "shape"),
    [
        (["Landscape_2.jpg", "Landscape_5.jpg"], (1200, 1800, 3)),
        ([f"Portrait_{n}.jpg" for n in (1, 3, 6, 8)], (1800, 1200, 3)),
    ],
)
def test_orientations_show_one_picture(
    shared: Path, names: list[str], shape: tuple[int, int, int]
) -> None:
    pictures = [load_picture(shared / "hostile" / name).rgb for name in names]
    for rgb in pictures:
        assert rgb.shape == shape
        assert np.abs(rgb.astype(np.int16) - pictures[0]).mean() < 5


def test_missing_data_is_not_decoded_silently(shared: Path) -> None:
    with pytest.raises(UnreadableInput, match="truncated"):
        load_picture(shared / "hostile" / "truncated_jpeg.jpg")


def test_known_colours_of_unusual_files(shared: Path) -> None:
    folder = shared / "hostile"
    assert load_picture(folder / "mode_16bit.png").rgb[0, 0].tolist() == [255, 0, 0]
    grey = load_picture(folder / "basn0g16.png").rgb
    assert (grey.min(), grey.max()) == (0, 255)
    cmyk = load_picture(folder / "pil_sample_cmyk.jpg").rgb
    np.testing.assert_allclose(cmyk[2, 2], [255, 0, 20], atol=40)
    background = load_picture(folder / "tbrn2c08.png").alpha
    assert background is not None
    assert set(np.unique(background)) == {0, 255}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mode", "name", "side"),
    [
        ("CMYK", "a.jpg", 8000),
        ("RGBA", "a.png", 8000),
        ("RGBA", "a.webp", 6000),
    ],
)
def test_largest_picture_fits_in_a_gibibyte(
    tmp_path: Path, mode: str, name: str, side: int
) -> None:
    folder = tmp_path / "large"
    folder.mkdir()
    Image.new(mode, (side, side), 0).save(folder / name, compress_level=1)
    run = subprocess.run(
        [sys.executable, "-c", SMALL, sys.executable, "-c", PROBE, str(folder)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    seen, memory = json.loads(run.stdout)
    assert seen[name][0] == [side, side, 3]
    assert memory < 1 << 30
