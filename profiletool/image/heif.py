"""HEIC pictures, as iPhones take them, where the extra that decodes them is installed."""

from __future__ import annotations

import importlib

HEIF_EXTRA = "pip install profiletool[heic]"
# The first, of the extra, only decodes and is LGPL as a wheel; the second's wheels hold a GPL encoder.
_DECODERS = ("pi_heif", "pillow_heif")


def with_heif() -> bool:
    """Let Pillow open HEIC files; False where nothing that decodes them is installed."""
    for name in _DECODERS:
        try:
            decoder = importlib.import_module(name)
        except ImportError:
            continue
        decoder.register_heif_opener()
        return True
    return False
