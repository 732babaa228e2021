"""Rows of numbers as decks hold them, and the constants of rubbers by law."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice

import numpy as np

from fem import Law, MooneyRivlin, NeoHooke, Ogden, Yeoh
from fem.arrays import FloatArray, IntArray

_DIGITS = 9  # springs whose stiffness agrees so far share a section


def row(*values: float, apart: str = ", ") -> str:
    """Numbers in one row, integers as such."""
    return apart.join(str(v) if isinstance(v, (int, np.integer)) else f"{v:.12g}" for v in values)


def rows(values: Iterable[int], count: int, apart: str = ", ") -> Iterator[str]:
    """Integers, so many in a row."""
    numbers = iter(values)
    while chunk := list(islice(numbers, count)):
        yield apart.join(map(str, chunk))


def groups_of(values: FloatArray) -> Iterator[tuple[float, IntArray]]:
    """Values, the smallest first, and the numbers of all that share it to nine digits."""
    rounded = np.array([float(f"{value:.{_DIGITS}g}") for value in values])
    for value in np.unique(rounded):
        yield float(value), np.flatnonzero(rounded == value)


def deck_law(rubber: Law) -> MooneyRivlin | Yeoh | Ogden:
    """Take a rubber that decks have words for; a neo-Hookean one is Mooney-Rivlin with C01 = 0.

    Raises
    ------
    ValueError
        For any other law.
    """
    if isinstance(rubber, NeoHooke):
        return MooneyRivlin(rubber.C10, 0.0, rubber.K)
    if isinstance(rubber, (MooneyRivlin, Yeoh, Ogden)):
        return rubber
    raise ValueError(
        f"a deck holds Mooney-Rivlin, neo-Hookean, Yeoh and Ogden rubbers, not {rubber.name}"
    )


def text(lines: Iterable[str]) -> str:
    """Put lines into a file."""
    return "\n".join(lines) + "\n"
