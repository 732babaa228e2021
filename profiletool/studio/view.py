"""Views of subjects: objects as the page draws them, in mm of the object frame, y down."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray
from profiletool.report.film import drawn, path
from profiletool.subject.find import Subject

View = dict[str, Any]

_LONGEST_PX = 1600  # of a picture on the page
_QUALITY = 88
_STEPS = 200  # of a side, from 0 to 100 %


def save_picture(rgb: NDArray[np.uint8], file: Path) -> None:
    """Write a picture as the page shows it, once."""
    if not file.exists():
        image = Image.fromarray(rgb)
        image.thumbnail((_LONGEST_PX, _LONGEST_PX), Image.Resampling.LANCZOS)
        image.save(file, "JPEG", quality=_QUALITY)


def subject_view(subject: Subject, shown: str | None) -> View:
    """Show an object with the whole of its side; ``shown`` is the file of its picture."""
    profile, scale = subject.profile, subject.scale
    outline = profile.points if profile.outline is None else profile.outline
    x0, y0 = outline.min(axis=0)
    x1, y1 = outline.max(axis=0)
    view: View = {
        "size": [float(x1 - x0), float(y1 - y0)],
        "box": [float(x0), float(-y1), float(x1 - x0), float(y1 - y0)],
        "scale": {"mm_per_px": scale.mm_per_px, "source": scale.source},
        "outline": path(drawn(outline)) + ("" if profile.outline is None else "Z"),
        "side": _even(profile).tolist(),
        "length": profile.length_mm,
        "notes": list(subject.notes),
    }
    silhouette, picture = subject.silhouette, subject.picture
    if silhouette is not None and picture is not None and subject.origin_px is not None:
        k, (x, y) = scale.mm_per_px, subject.origin_px
        height, width = picture.rgb.shape[:2]
        place = [k * (-0.5 - x), k * (-0.5 - y), k * width, k * height]
        view["picture"] = {"file": shown, "place": place, "turn": -subject.rotated_deg}
        view["found"] = {
            "by": silhouette.method, "confidence": silhouette.confidence,
            "outline": outline_of(silhouette.mask),
        }  # fmt: skip
    return view


def outline_of(mask: NDArray[np.bool_]) -> str:
    """Path around a mask (H, W), in its pixels."""
    lines, _ = cv2.findContours(
        mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_TC89_L1
    )  # fmt: skip
    parts = (np.asarray(line).reshape(-1, 2).tolist() for line in lines)
    return "".join("M" + " ".join(f"{x},{y}" for x, y in part) + "Z" for part in parts)


def _even(profile: Profile) -> FloatArray:
    """Points of a whole side at even arc lengths, (_STEPS + 1, 2) mm, y down."""
    at = np.linspace(0.0, profile.length_mm, _STEPS + 1)
    x, y = (np.interp(at, profile.s, profile.points[:, k]) for k in (0, 1))
    return np.asarray(np.round(np.column_stack([x, -y]), 3))
