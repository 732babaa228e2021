"""Frames of a video."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from profiletool.errors import UnreadableInput
from profiletool.subject.tube.frames import frames_at, is_video


@pytest.fixture(scope="module")
def video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two seconds, ten frames each, that grow lighter."""
    path = tmp_path_factory.mktemp("video") / "a.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 10.0, (64, 48))
    for k in range(20):
        writer.write(np.full((48, 64, 3), 10 * k, np.uint8))
    writer.release()
    return path


def test_the_nearest_frames(video: Path) -> None:
    found = frames_at(video, [0.0, 0.52, 1.9])
    assert [round(float(one.rgb.mean()) / 10.0) for one in found] == [0, 5, 19]


def test_times_beyond_its_end(video: Path) -> None:
    with pytest.raises(UnreadableInput, match="no frame at 9 s"):
        frames_at(video, [0.5, 9.0])


def test_no_video(tmp_path: Path) -> None:
    (tmp_path / "a.mp4").write_text("no")
    assert is_video(tmp_path / "a.mp4")
    assert not is_video(Path("a.jpg"))
    with pytest.raises(UnreadableInput, match="no video"):
        frames_at(tmp_path / "a.mp4", [0.0])
    with pytest.raises(UnreadableInput, match="no such file"):
        frames_at(tmp_path / "b.mp4", [0.0])
