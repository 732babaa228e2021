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
_FORMS = {3: "H", 4: "I", 16: "Q"}  # of numbers, by the type in a tag


def check_structure(path: Path) -> None:
    """Refuse a picture file of absurdly many parts, and a TIFF that points outside itself.

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
    count_form, entry_form = (order + "Q", order + "HHQ") if big else (order + "H", order + "HHI")
    (place,) = struct.unpack_from(order + ("Q" if big else "I"), head, 8 if big else 4)
    end, room = file.seek(0, 2), 8 if big else 4
    (tags,) = struct.unpack(count_form, _part(file, place, struct.calcsize(count_form), end))
    place += struct.calcsize(count_form)
    size = struct.calcsize(entry_form)
    parts: dict[int, tuple[int, ...]] = {}
    for _ in range(min(tags, _MAX_TAGS)):
        tag, kind, count = struct.unpack(entry_form, _part(file, place, size, end))
        if tag in _COUNTED_TAGS and kind in _FORMS:
            if count > MAX_PARTS:
                raise UnreadableInput(f"a TIFF of more than {MAX_PARTS} strips; save it again")
            form = f"{order}{count}{_FORMS[kind]}"
            at = place + size
            if struct.calcsize(form) > room:
                (at,) = struct.unpack(order + "IQ"[big], _part(file, at, room, end))
            parts[tag] = struct.unpack(form, _part(file, at, struct.calcsize(form), end))
        place += size + room
    for offsets, sizes in ((273, 279), (324, 325)):
        for k, start in enumerate(parts.get(offsets, ())):
            given = parts.get(sizes, ())
            _part(file, start, given[k] if k < len(given) else 0, end, read=False)


def _part(file: BinaryIO, place: int, size: int, end: int, read: bool = True) -> bytes:
    """Read a part that a TIFF points to."""
    if place + size > end:
        raise UnreadableInput(
            "a TIFF that points outside itself, cut off or damaged; save it again"
        )
    file.seek(place)
    return file.read(size) if read else b""
