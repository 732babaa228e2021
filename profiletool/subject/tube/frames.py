"""Frames of a video at given times, by the frames' own time stamps."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.files.read import check_file
from profiletool.image.load import MAX_PIXELS
from profiletool.records.picture import Picture

ENDINGS = (".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v")
_MOST_BYTES = 2_000_000_000
_MOST_FRAMES = 200
_APART_S = 0.5  # between a time that is asked for and the nearest frame


def is_video(path: Path) -> bool:
    """Whether a file is a video, by its name."""
    return path.suffix.lower() in ENDINGS


def frames_at(path: Path, times_s: Sequence[float]) -> list[Picture]:
    """Take the frames nearest to rising times, s.

    Raises
    ------
    UnreadableInput
        It is no video, too large, or ends before.
    """
    try:
        check_file(path, _MOST_BYTES, "a video")
    except UnreadableInput as error:
        raise UnreadableInput(f"{path}: {error}") from None
    if len(times_s) > _MOST_FRAMES:
        raise UnreadableInput(
            f"{path}: {len(times_s)} times are asked for; give {_MOST_FRAMES} at most"
        )
    video = cv2.VideoCapture(str(path))
    try:
        found = _frames(video, times_s) if video.isOpened() else None
    finally:
        video.release()
    if found is None:
        raise UnreadableInput(f"{path}: no video that can be read; save it as MP4")
    if len(found) < len(times_s):
        raise UnreadableInput(
            f"{path}: shows no frame at {times_s[len(found)]:g} s; check the times of the pressures"
        )
    return found


def _frames(video: cv2.VideoCapture, times_s: Sequence[float]) -> list[Picture] | None:
    found: list[Picture] = []
    last: tuple[float, np.ndarray] | None = None
    while len(found) < len(times_s):
        good, bgr = video.read()
        if not good:
            break
        if bgr.shape[0] * bgr.shape[1] > MAX_PIXELS:
            return None
        now = 1e-3 * float(video.get(cv2.CAP_PROP_POS_MSEC))
        while len(found) < len(times_s) and now >= times_s[len(found)]:
            wanted = times_s[len(found)]
            before = last is not None and wanted - last[0] < now - wanted
            time, frame = last if before and last is not None else (now, bgr)
            if abs(time - wanted) > _APART_S:
                return found
            found.append(Picture(np.ascontiguousarray(frame[..., ::-1]), None, None, "video"))
        last = now, bgr
    else:
        return found
    if last is None:
        return None
    if abs(last[0] - times_s[len(found)]) <= _APART_S:
        found.append(Picture(np.ascontiguousarray(last[1][..., ::-1]), None, None, "video"))
    return found
