"""Files that others name: regular ones alone, and no more of them than makes sense."""

from __future__ import annotations

import stat
from pathlib import Path

from profiletool.errors import UnreadableInput


def check_file(path: Path, most_bytes: int, kind: str) -> None:
    """Refuse what is no file, or too large, before it is opened: a pipe would wait for ever.

    Parameters
    ----------
    path : Path
    most_bytes : int
    kind : str
        What the file should be, with its article, for the messages.

    Raises
    ------
    UnreadableInput
        With the reason alone; the caller knows what to call the file.
    """
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise UnreadableInput(f"a folder; name {kind}")
        if not stat.S_ISREG(status.st_mode):
            raise UnreadableInput(f"not a regular file; name {kind}")
        with path.open("rb"):
            pass
    except FileNotFoundError:
        raise UnreadableInput("no such file; check the name") from None
    except PermissionError:
        raise UnreadableInput(
            "no permission to read it; change its permissions or copy it"
        ) from None
    except (OSError, ValueError) as error:
        raise UnreadableInput(f"cannot be opened ({error}); check the name") from None
    if status.st_size > most_bytes:
        raise _too_large(most_bytes, kind)


def read_file(path: Path, most_bytes: int, kind: str) -> bytes:
    """Read a file whole.

    Parameters
    ----------
    path, most_bytes, kind
        As `check_file` takes them.

    Raises
    ------
    UnreadableInput
        As `check_file`.
    """
    check_file(path, most_bytes, kind)
    try:
        with path.open("rb") as file:
            data = file.read(most_bytes + 1)  # it may have grown, or never have told its size
    except OSError as error:
        raise UnreadableInput(f"cannot be read ({error}); copy it to another disk") from None
    if len(data) > most_bytes:
        raise _too_large(most_bytes, kind)
    return data


def _too_large(most_bytes: int, kind: str) -> UnreadableInput:
    return UnreadableInput(f"larger than {most_bytes / 1e6:g} MB, too large for {kind}")
