"""HEIC pictures, as iPhones take them, where the extra that decodes them is installed."""

from __future__ import annotations

import importlib

HEIF_EXTRA = "pip install profiletool[heic]"
# The extra is the first: it only decodes, and its wheels are LGPL. Wheels of the second hold an
# encoder that is GPL.
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
