"""Rows of numbers as decks hold them, and the constants of rubbers by law."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice

import numpy as np

from fem.arrays import IntArray
from fem.errors import FemError
from fem.export.springs import Springs
from fem.material import Law, MooneyRivlin, NeoHooke, Ogden, Yeoh

_DIGITS = 9  # of a stiffness: springs that agree so far share a section


class NoSuchDeck(FemError):
    """A deck cannot hold such an actuator; the message says why."""


def row(*values: float, apart: str = ", ") -> str:
    """Numbers in one row, integers as such."""
    return apart.join(
        str(v) if isinstance(v, (int, np.integer)) else f"{v:.12g}" for v in values
    )


def rows(values: Iterable[int], count: int, apart: str = ", ") -> Iterator[str]:
    """Integers, so many in a row."""
    numbers = iter(values)
    while chunk := list(islice(numbers, count)):
        yield apart.join(map(str, chunk))


def by_stiffness(springs: Springs) -> Iterator[tuple[float, IntArray]]:
    """Stiffness (N/mm) and numbers of the springs that share it, the softest first."""
    rounded = np.array([float(f"{k:.{_DIGITS}g}") for k in springs.stiffness])
    for k in np.unique(rounded):
        yield float(k), np.flatnonzero(rounded == k)


def mooney(rubber: Law) -> tuple[float, float] | None:
    """C10 and C01 of Mooney-Rivlin and neo-Hookean rubbers, MPa; None for others."""
    if isinstance(rubber, MooneyRivlin):
        return rubber.C10, rubber.C01
    return (rubber.C10, 0.0) if isinstance(rubber, NeoHooke) else None


def known(rubber: Law) -> MooneyRivlin | NeoHooke | Yeoh | Ogden:
    """Take a rubber that decks have words for.

    Raises
    ------
    NoSuchDeck
    """
    if isinstance(rubber, (MooneyRivlin, NeoHooke, Yeoh, Ogden)):
        return rubber
    raise NoSuchDeck(
        f"a deck holds Mooney-Rivlin, neo-Hookean, Yeoh and Ogden rubbers, not {rubber.name}"
    )
