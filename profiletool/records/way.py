"""Ways out of a design that is infeasible: options to change, and what they were found to reach."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Way:
    """One way out, tried.

    Attributes
    ----------
    changes : tuple of (str, value)
        Fields of the request, and what they are to be.
    rms_mm : float
        How far off the profile the design lies that they lead to.
    by : str
        The model that says so: "FE", "the joint response", "the formula".
    """

    changes: tuple[tuple[str, Any], ...]
    rms_mm: float
    by: str

    def __str__(self) -> str:
        """Fields in backticks, as messages name them."""
        return f"{named_changes(self.changes)} reaches {self.rms_mm:.2f} mm RMS by {self.by}"


def named_changes(changes: tuple[tuple[str, Any], ...]) -> str:
    """Name changes by fields in backticks: "`start_pct` 12 `end_pct` 90"."""
    return " ".join(
        f"`{field}` {value:g}" if isinstance(value, int | float) else f"`{field}` {value}"
        for field, value in changes
    )


@dataclass(frozen=True)
class WaysOut:
    """What trials of other options came to.

    Attributes
    ----------
    ways : tuple of Way
        Those that work, the one that changes least first.
    tried : tuple of str
        In words, all that was tried.
    """

    ways: tuple[Way, ...]
    tried: tuple[str, ...]

    def __str__(self) -> str:
        """One line for the end of a message."""
        if self.ways:
            return "tried, and it works: " + "; ".join(str(way) for way in self.ways)
        return f"nothing that was tried works: {', '.join(self.tried)}"
