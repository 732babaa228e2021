"""The plain data files of a design."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from profiletool.joints.kinematics import Shape
from profiletool.profile.curve import arc_length
from profiletool.records import FloatArray, Profile


def mask_png(mask: NDArray[np.bool_]) -> bytes:
    """Encode a mask (H, W): white object on black."""
    buffer = io.BytesIO()
    Image.fromarray(mask).save(buffer, "PNG", compress_level=1)
    return buffer.getvalue()


def shape_csv(profile: Profile, shape: Shape) -> bytes:
    """Tabulate the target profile and the predicted object-facing line, mm, object frame."""
    lines = ["curve,s_mm,x_mm,y_mm"]
    for name, points in (("target", profile.points), ("formula", shape.facing)):
        lines += _rows(name, points)
    return ("\n".join(lines) + "\n").encode()


def _rows(name: str, points: FloatArray) -> list[str]:
    table = np.column_stack([arc_length(points), points])
    return [f"{name},{s:.3f},{x:.4f},{y:.4f}" for s, x, y in table.tolist()]
