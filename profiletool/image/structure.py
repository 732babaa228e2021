"""The parts that a picture file says it has, counted before a decoder goes through them all."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import BinaryIO

from profiletool.errors import UnreadableInput

MAX_PARTS = 20_000  # chunks of a PNG, strips or tiles of a TIFF; 64 megapixels need some thousands
MAX_SCANS = 50  # of a JPEG; a progressive one has about ten
_COUNTED_TAGS = (273, 279, 324, 325)  # offsets and sizes of strips and tiles
_MAX_TAGS = 1000


def check_structure(path: Path) -> None:
    """Refuse a picture file of absurdly many parts.

    Raises
    ------
    UnreadableInput
        With the reason alone.
    OSError, struct.error
        When the file breaks off.
    """
    with path.open("rb") as file:
        head = file.read(16)
        if head.startswith(b"\x89PNG\r\n\x1a\n"):
            _check_png(file)
        elif head.startswith(b"\xff\xd8"):
            # Never part of the coded pixels, where 0 follows every ff.
            if file.read().count(b"\xff\xda") > MAX_SCANS:
                raise UnreadableInput(f"a JPEG of more than {MAX_SCANS} scans; save it again")
        elif head[:2] in (b"II", b"MM"):
            _check_tiff(file, head)


def _check_png(file: BinaryIO) -> None:
    file.seek(8)
    for _ in range(MAX_PARTS):
        start = file.read(8)
        if len(start) < 8:
            return
        file.seek(int.from_bytes(start[:4], "big") + 4, 1)
    raise UnreadableInput(f"a PNG of more than {MAX_PARTS} chunks; save it again")


def _check_tiff(file: BinaryIO, head: bytes) -> None:
    order = "<" if head.startswith(b"II") else ">"
    big = struct.unpack(order + "H", head[2:4])[0] == 43  # BigTIFF
    count_form, entry_form = (order + "Q", order + "HHQQ") if big else (order + "H", order + "HHII")
    (place,) = struct.unpack_from(order + ("Q" if big else "I"), head, 8 if big else 4)
    file.seek(place)
    (tags,) = struct.unpack(count_form, file.read(struct.calcsize(count_form)))
    size = struct.calcsize(entry_form)
    for _ in range(min(tags, _MAX_TAGS)):
        tag, _, count, _ = struct.unpack(entry_form, file.read(size))
        if tag in _COUNTED_TAGS and count > MAX_PARTS:
            raise UnreadableInput(f"a TIFF of more than {MAX_PARTS} strips; save it again")
