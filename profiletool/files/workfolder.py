"""Folders to work in beside a place, and what killed processes left of theirs.

Each holds a lock as long as its process lives; the system lets go of it however that ends.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

if sys.platform == "win32":
    import msvcrt

    def _hold(file: BinaryIO) -> None:
        try:
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        except OSError as error:
            raise BlockingIOError from error
else:
    import fcntl

    def _hold(file: BinaryIO) -> None:
        """Lock a file; BlockingIOError where another has, OSError where the disk knows no locks."""
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


OLD = "old"  # in a folder: what stood at the place until its process moved it aside
_LOCK = "lock"
_TRIES = 10


@contextlib.contextmanager
def working_beside(target: Path) -> Iterator[Path]:
    """Give a fresh folder beside a place, and remove it in the end.

    Raises
    ------
    OSError
        Where the system does not let us.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    work, lock = _claimed(target)
    try:
        yield work
    finally:
        _remove(work, lock)


def recover(target: Path) -> None:
    """Clear away what killed processes left beside a place; put back what they had moved aside."""
    ours = re.compile(re.escape(_prefix(target)) + "[a-z0-9_]{8}")
    with contextlib.suppress(OSError):
        for work in [path for path in target.parent.iterdir() if ours.fullmatch(path.name)]:
            with contextlib.suppress(OSError):
                _recover(work, target)


def _prefix(target: Path) -> str:
    return f".{target.name}-part-"


def _claimed(target: Path) -> tuple[Path, BinaryIO]:
    """Make a folder and lock it; another process may clear it away before that."""
    for _ in range(_TRIES):
        work = Path(tempfile.mkdtemp(prefix=_prefix(target), dir=target.parent))
        with contextlib.suppress(FileNotFoundError, BlockingIOError):
            lock = (work / _LOCK).open("xb")
            try:
                _hold(lock)
            except BlockingIOError:
                lock.close()
                raise
            except OSError:
                pass  # a disk without locks: there the others cannot take it either
            if os.path.samestat(os.fstat(lock.fileno()), (work / _LOCK).stat()):
                return work, lock
    raise OSError("other processes are in the way; try again")


def _recover(work: Path, target: Path) -> None:
    try:
        lock = (work / _LOCK).open("r+b")
    except FileNotFoundError:
        work.rmdir()  # its process was killed before it had a lock, or will make another folder
        return
    with lock:
        _hold(lock)  # fails where the process lives
        if (work / OLD).exists() and not os.path.lexists(target):
            (work / OLD).rename(target)
        _remove(work, lock)


def _remove(work: Path, lock: BinaryIO) -> None:
    """Remove a folder, its lock last: what is left of it by then is still known as ours."""
    with contextlib.suppress(OSError):
        for part in work.iterdir():
            if part.name != _LOCK:
                shutil.rmtree(part, ignore_errors=True)
    # While it is held, lest another takes the lock of what is about to go.
    with contextlib.suppress(OSError):  # Windows removes no open file
        (work / _LOCK).unlink()
    lock.close()
    shutil.rmtree(work, ignore_errors=True)
