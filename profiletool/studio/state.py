"""The state of a session, as its work folder keeps it."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from profiletool.errors import OutputError, ProfiletoolError
from profiletool.studio.form import checked
from profiletool.studio.job import Version

KEPT = "session.json"


@dataclass(frozen=True)
class State:
    """What is kept of a session: see `Session`."""

    picture: str | None = None
    values: dict[str, Any] = field(default_factory=dict)
    versions: tuple[Version, ...] = ()
    current: int | None = None


def as_json(tree: Any) -> bytes:
    """Write a tree for the page, or to be kept."""
    return json.dumps(tree, separators=(",", ":"), allow_nan=False).encode()


def restored(folder: Path) -> State:
    """Read what an earlier session left.

    Raises
    ------
    OutputError
        It cannot be read.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not (folder / KEPT).exists():
            return State()
        tree = json.loads((folder / KEPT).read_text())
        versions = (Version(**{**row, "words": tuple(row["words"])}) for row in tree["versions"])
        made = {row.number: row for row in versions if (folder / f"{row.number}.json").exists()}
        current = tree["current"] if tree["current"] in made else None
        return State(tree["picture"], checked(tree["values"]), tuple(made.values()), current)
    except (OSError, ValueError, TypeError, KeyError, ProfiletoolError) as error:
        raise OutputError(
            f"cannot go on in {folder}: {error}; choose another with `out`"
        ) from error
