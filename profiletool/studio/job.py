"""Jobs as records: what the worker is asked to do, how far it is, and what it makes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Job:
    """Something to do.

    Attributes
    ----------
    kind : {"find", "design", "edit", "refine", "report", "near"}
    number : int
        Of the picture, or of the version that is to be made.
    file : str
        The picture, or the design.json that is taken up again; in the work folder.
    values : mapping
        Options by field name.
    edits : tuple of str
        As `profiletool.records.edit.edit_of` takes them.
    pressure_bar : float or None
        Of an edit.
    """

    kind: str
    number: int
    file: str
    values: Mapping[str, Any]
    edits: tuple[str, ...] = ()
    pressure_bar: float | None = None


@dataclass(frozen=True)
class Version:
    """A design that was made here.

    Attributes
    ----------
    number : int
        Its folder has this name, and its view and TOML are beside it.
    base : int or None
        The version that it was changed from.
    kind : {"design", "edit", "refine", "report"}
    words : tuple of str
        What the command line takes for it, beside the input and --out.
    """

    number: int
    base: int | None
    kind: str
    words: tuple[str, ...] = ()


@dataclass(frozen=True)
class Running:
    """The job at work, how far it is, and what it makes.

    ``early`` is the ticket of the quick run beside it, ``near`` what that found.
    """

    ticket: int
    job: Job
    makes: Version | None
    began: float
    share: float = 0.0
    line: str = ""
    early: int = 0
    near: Any = None
