"""The output folder, or file: it appears whole or not at all."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

from profiletool.errors import OutputError, UsageError

_MARKS = ("design.json", "fe.json", "formula.json")  # any makes a folder ours to replace


def check_free(folder: Path, force: bool) -> None:
    """Refuse early to write over something.

    Raises
    ------
    UsageError
        When the folder exists and ``force`` is not given, or it is no folder of ours.
    """
    if not _stands(folder):
        return
    if not folder.is_dir() or folder.is_symlink():
        raise UsageError(f"{folder} exists and is no folder; choose another with --out")
    ours = any((folder / mark).is_file() for mark in _MARKS) or not any(folder.iterdir())
    if force and not ours:
        raise UsageError(
            f"{folder} holds no {' or '.join(_MARKS)}, so --force will not replace it; "
            "choose another with --out"
        )
    if not force:
        raise UsageError(f"{folder} exists; replace it with --force or choose another with --out")


def write_folder(folder: Path, files: Mapping[str, bytes], force: bool) -> None:
    """Write all files into a folder beside its place, then move it there in one step.

    Raises
    ------
    UsageError
        As `check_free`.
    OutputError
        When the system does not let us write; nothing is left behind then.
    """
    check_free(folder, force)
    with _beside(folder) as work:
        fresh = work / "new"
        fresh.mkdir()
        for name, data in files.items():
            (fresh / name).write_bytes(data)
        _move_into_place(fresh, folder.absolute(), work / "old")


def check_file(file: Path, force: bool) -> None:
    """Refuse early to write over a file.

    Raises
    ------
    UsageError
        When the file exists and ``force`` is not given, or it is no file.
    """
    if not _stands(file):
        return
    if not file.is_file() or file.is_symlink():
        raise UsageError(f"{file} exists and is no file; choose another with --out")
    if not force:
        raise UsageError(f"{file} exists; replace it with --force or choose another with --out")


def write_file(file: Path, data: bytes, force: bool) -> None:
    """Write a file beside its place, then move it there in one step.

    Raises
    ------
    UsageError
        As `check_file`.
    OutputError
        When the system does not let us write; nothing is left behind then.
    """
    check_file(file, force)
    with _beside(file) as work:
        fresh = work / "new"
        fresh.write_bytes(data)
        fresh.replace(file.absolute())


def _stands(place: Path) -> bool:
    """Whether there is something already, a broken link too."""
    try:
        return place.exists() or place.is_symlink()
    except OSError as error:
        raise _cannot_write(place, error) from error


@contextlib.contextmanager
def _beside(place: Path) -> Iterator[Path]:
    """Give a folder to work in beside a place, and say so where the system does not let us."""
    target = place.absolute()
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{target.name}-", dir=target.parent) as work:
            yield Path(work)
    except OSError as error:
        raise _cannot_write(place, error) from error


def _cannot_write(place: Path, error: OSError) -> OutputError:
    reason = error.strerror or str(error)
    return OutputError(f"cannot write {place}: {reason}; choose another place with --out")


def _move_into_place(fresh: Path, target: Path, aside: Path) -> None:
    had_one = target.is_dir()
    if had_one:
        target.rename(aside)
    try:
        fresh.rename(target)
    except OSError:
        if had_one:
            aside.rename(target)
        raise
    with contextlib.suppress(OSError):
        shutil.rmtree(aside)
