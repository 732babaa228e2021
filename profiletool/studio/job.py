"""Jobs as records: what the worker is asked to do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Job:
    """Something to do.

    Attributes
    ----------
    kind : {"find", "design", "edit", "refine", "report"}
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
