"""Lettering in single strokes, since cutters and plotters skip font text.

Glyphs are drawn on a grid 12 units high (the capital height), as polylines: pairs of base-36
digits x y, strokes parted by a bar. No stroke runs over another one. Lower case letters are
drawn as capitals, accents are dropped, and an unknown character becomes an empty box.
"""

from __future__ import annotations

import unicodedata
from functools import cache

import numpy as np

from profiletool.records.units import FloatArray

CAP_UNITS = 12
GAP_UNITS = 3
SPACE_UNITS = 4
UNKNOWN = "00 60 6c 0c 00"

GLYPHS = {
    "A": "00 3c 60|14 54",
    "B": "00 0c 4c 6a 68 47 07|47 65 62 40 00",
    "C": "62 40 20 02 0a 2c 4c 6a",
    "D": "00 0c 4c 6a 62 40 00",
    "E": "60 00 0c 6c|06 46",
    "F": "00 0c 6c|06 46",
    "G": "6a 4c 2c 0a 02 20 40 62 65 35",
    "H": "00 0c|60 6c|06 66",
    "I": "00 0c",
    "J": "02 20 30 52 5c",
    "K": "00 0c|6c 06 60",
    "L": "0c 00 60",
    "M": "00 0c 45 8c 80",
    "N": "00 0c 60 6c",
    "O": "20 50 72 7a 5c 2c 0a 02 20",
    "P": "00 0c 4c 6a 67 45 05",
    "Q": "20 50 72 7a 5c 2c 0a 02 20|43 70",
    "R": "00 0c 4c 6a 67 45 05|35 60",
    "S": "02 20 40 62 64 46 26 08 0a 2c 4c 6a",
    "T": "0c 6c|3c 30",
    "U": "0c 02 20 40 62 6c",
    "V": "0c 30 6c",
    "W": "0c 20 47 60 8c",
    "X": "00 6c|0c 60",
    "Y": "0c 36 6c|36 30",
    "Z": "0c 6c 00 60",
    "0": "20 40 62 6a 4c 2c 0a 02 20",
    "1": "09 3c 30",
    "2": "0a 2c 4c 6a 68 00 60",
    "3": "0a 2c 4c 6a 68 46 26|46 64 62 40 20 02",
    "4": "40 4c 04 64",
    "5": "6c 0c 07 47 65 62 40 20 02",
    "6": "6a 4c 2c 0a 02 20 40 62 65 47 27 05",
    "7": "0c 6c 20",
    "8": "26 08 0a 2c 4c 6a 68 46 26 04 02 20 40 62 64 46",
    "9": "02 20 40 62 6a 4c 2c 0a 07 25 45 67",
    ".": "00 20 22 02 00",
    ",": "00 13",
    ":": "02 12 13 03 02|08 18 19 09 08",
    ";": "01 13|08 18 19 09 08",
    "!": "00 10 11 01 00|04 0c",
    "?": "0a 2c 4c 6a 68 35 33|30 31",
    "'": "09 0c",
    "-": "06 46",
    "+": "06 66|33 39",
    "/": "00 4c",
    "_": "00 60",
    "(": "20 03 09 2c",
    ")": "00 23 29 0c",
    "=": "04 54|08 58",
    "%": "00 6c|0a 0c 2c 2a 0a|40 42 62 60 40",
    "\u00d7": "02 58|08 52",
    "°": "19 29 3a 3b 2c 1c 0b 0a 19",
}


def plain(text: str) -> str:
    """Return ``text`` as it is drawn: capitals without accents."""
    spread = unicodedata.normalize("NFKD", text.upper())
    return "".join(char for char in spread if not unicodedata.combining(char))


def text_width(text: str, height: float) -> float:
    """Return the width of ``text`` in capitals of ``height``, in the unit of ``height``."""
    advance = sum(_width(char) + GAP_UNITS for char in plain(text))
    return max(0, advance - GAP_UNITS) * height / CAP_UNITS


def text_strokes(text: str, height: float) -> tuple[FloatArray, ...]:
    """Return ``text`` as polylines, (N, 2) each, baseline on y = 0, starting at x = 0."""
    unit = height / CAP_UNITS
    lines: list[FloatArray] = []
    x = 0
    for char in plain(text):
        lines += [(stroke + np.array([x, 0])) * unit for stroke in _glyph(char)]
        x += _width(char) + GAP_UNITS
    return tuple(lines)


@cache
def _glyph(char: str) -> tuple[FloatArray, ...]:
    """Return the strokes of one character in grid units."""
    if char.isspace():
        return ()
    code = GLYPHS.get(char, UNKNOWN)
    return tuple(
        np.array(
            [[int(pair[0], 36), int(pair[1], 36)] for pair in stroke.split()], dtype=np.float64
        )
        for stroke in code.split("|")
    )


@cache
def _width(char: str) -> int:
    """Return the width of one character in grid units, the gap after it left out."""
    strokes = _glyph(char)
    return int(max(stroke[:, 0].max() for stroke in strokes)) if strokes else SPACE_UNITS
