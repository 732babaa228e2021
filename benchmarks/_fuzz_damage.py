"""Damage to files: bytes, pieces, numbers, words and encodings; the same for the same generator."""

from __future__ import annotations

import re
import struct
import zlib

import numpy as np

_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?")
_VALUES = (
    b"0", b"-1", b"1e308", b"-1e400", b"nan", b"inf", b"1e-320", b"9" * 40, b"9" * 5000, b"1e5",
    b"65535", b"2147483648", b"0x10", b"1_0", b"", b"true", b"null", b"[]", b'""', b"1979-05-27",
)  # fmt: skip
_WORDS = (
    b"<", b"</g>", b"<g>" * 200, b"[" * 5000, b'{"a":' * 3000, b"\0", b"\xff\xfe", b"\xef\xbb\xbf",
    b"\n", b"\r", b'"', b"=", b"[[a]]\n", b"a.b.c=1\n", b"<!DOCTYPE a>", b"&a;", b"#", b";", b",",
    b"../../../etc/passwd", b"/dev/zero", b'<use href="#a"/>', b'transform="scale(1e300)"',
    b"  0\nINSERT\n  2\nA\n 70\n1000000\n 71\n1000000\n", b"\xe2\x80\xa8", b"\x1b[31m", b"%",
)  # fmt: skip


def mutated(data: bytes, other: bytes, rng: np.random.Generator) -> bytes:
    """Damage a file in a few places; ``other`` is one to splice from."""
    for _ in range(int(rng.geometric(0.4))):
        data = _MUTATIONS[int(rng.integers(len(_MUTATIONS)))](data, other, rng)
    return _checked(data) if rng.random() < 0.7 else data


def _flip(data: bytes, _: bytes, rng: np.random.Generator) -> bytes:
    made = bytearray(data)
    for at in rng.integers(max(len(data), 1), size=int(rng.integers(1, 4))):
        made[at : at + 1] = [int(rng.integers(256))]
    return bytes(made)


def _cut(data: bytes, _: bytes, rng: np.random.Generator) -> bytes:
    at = int(rng.integers(len(data) + 1))
    return data[:at] + data[at + int(rng.integers(1, 60)) :]


def _truncate(data: bytes, _: bytes, rng: np.random.Generator) -> bytes:
    return data[: int(rng.integers(len(data) + 1))] if rng.random() < 0.3 else data


def _double(data: bytes, _: bytes, rng: np.random.Generator) -> bytes:
    at, size = int(rng.integers(len(data) + 1)), int(rng.integers(1, 200))
    times = int(rng.choice([1, 2, 300]))
    return data[:at] + data[at : at + size] * times + data[at:]


def _splice(data: bytes, other: bytes, rng: np.random.Generator) -> bytes:
    at, start = int(rng.integers(len(data) + 1)), int(rng.integers(len(other) + 1))
    return data[:at] + other[start : start + int(rng.integers(1, 400))] + data[at:]


def _number(data: bytes, _: bytes, rng: np.random.Generator) -> bytes:
    found = list(_NUMBER.finditer(data[:200_000]))
    if not found:
        return data
    place = found[int(rng.integers(len(found)))]
    return data[: place.start()] + _VALUES[int(rng.integers(len(_VALUES)))] + data[place.end() :]


def _word(data: bytes, _: bytes, rng: np.random.Generator) -> bytes:
    at = int(rng.integers(len(data) + 1))
    return data[:at] + _WORDS[int(rng.integers(len(_WORDS)))] + data[at:]


def _integer(data: bytes, _: bytes, rng: np.random.Generator) -> bytes:
    """Put an extreme 16 or 32 bit number where sizes and offsets of binary files may stand."""
    at = int(rng.integers(min(len(data), 300) + 1))
    form = str(rng.choice(["<H", ">H", "<I", ">I"]))
    value = int(rng.choice([0, 1, 0x7FFF, 0xFFFF, 0x10000, 0x7FFFFFFF, 0xFFFFFFFF]))
    made = struct.pack(form, value & (0xFFFF if form[1] == "H" else 0xFFFFFFFF))
    return data[:at] + made + data[at + len(made) :]


def _encode(data: bytes, _: bytes, rng: np.random.Generator) -> bytes:
    if rng.random() < 0.8:
        return data
    return data.decode("latin-1").encode(str(rng.choice(["utf-16", "utf-8-sig", "utf-16-be"])))


_MUTATIONS = (
    _flip, _cut, _truncate, _double, _splice, _number, _number, _word, _integer, _encode,
)  # fmt: skip


def _checked(data: bytes) -> bytes:
    """Mend the check sums of a PNG, so that the damage gets past them."""
    if not data.startswith(b"\x89PNG\r\n\x1a\n"):
        return data
    made, at = bytearray(data), 8
    while at + 12 <= len(made):
        end = at + 8 + int.from_bytes(made[at : at + 4], "big")
        if end + 4 > len(made):
            break
        made[end : end + 4] = zlib.crc32(made[at + 4 : end]).to_bytes(4, "big")
        at = end + 4
    return bytes(made)
