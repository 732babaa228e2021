"""One option of a command: its flag, its value, its bounds, and the words about it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from profiletool.records.grip_request import GripRequest
from profiletool.records.request import Request

ANY = -1  # count of a list that is as long as it may be


@dataclass(frozen=True)
class ValueKind:
    """What an option holds.

    Attributes
    ----------
    type : type
        float, int, bool, str, Path, or tuple for numbers with commas between.
    show : callable
        A value as the report says it.
    count : int
        How many numbers with commas between it takes, `ANY` for some; 0 where it takes no list.
    choices : tuple of str
        What a str may be; empty where it may be anything.
    """

    type: type
    show: Callable[[Any], str]
    count: int = 0
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class Option:
    """One option of `design`.

    Attributes
    ----------
    flag : str
        As the command line takes it; without its dashes the key in a TOML file.
    path : str
        Where its value stands in a `Request`.
    kind : ValueKind
    help : str
    above, least : float or None
        Bounds: the value is greater than ``above``, and at least ``least``.
    absent : str
        What the report says where no value is given.
    metavar : str
    main : bool
        Whether the report lists it even where it has its default.
    off : bool
        Whether there is a flag to turn it off, too.
    """

    flag: str
    path: str
    kind: ValueKind
    help: str
    above: float | None = None
    least: float | None = None
    absent: str = "not given"
    metavar: str | None = None
    main: bool = False
    off: bool = False

    @property
    def field(self) -> str:
        """Name of the field that holds the value, as messages name it."""
        return self.path.rpartition(".")[2]

    def value(self, request: Request | GripRequest) -> Any:
        """Value of the option in a request."""
        holder, _, name = self.path.rpartition(".")
        return getattr(getattr(request, holder) if holder else request, name)

    def shown(self, request: Request | GripRequest) -> str:
        """Value of the option in a request, in words."""
        value = self.value(request)
        return self.absent if value is None else self.kind.show(value)
