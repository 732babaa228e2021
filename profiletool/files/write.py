"""The output folder, or file: it appears whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import stat
from collections.abc import Iterator, Mapping
from pathlib import Path

from profiletool.errors import OutputError, UsageError
from profiletool.files.workfolder import OLD, recover, working_beside

_MARKS = ("design.json", "fe.json", "formula.json")  # any makes a folder ours to replace
_TAKEN = (errno.ENOTEMPTY, errno.EEXIST)
_TRIES = 100  # others may put theirs in the place while ours is on its way


def check_free(folder: Path, force: bool) -> None:
    """Refuse early to write over something, or where the system does not let us.

    Raises
    ------
    UsageError
        When the folder exists and ``force`` is not given, or it is no folder of ours.
    OutputError
        When nothing can be written there.
    """
    if not _stands(folder):
        return
    _check_ours(folder, folder, force)
    if not force:
        raise UsageError(f"{folder} exists; replace it with `force` or choose another with `out`")


def write_folder(folder: Path, files: Mapping[str, bytes], force: bool) -> None:
    """Write all files into a folder beside its place, then move it there in one step.

    Of several processes that write to one place, each folder is of one of them alone: without
    ``force`` the first stays and the others are refused, with it the last stays.

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
            _write(fresh / name, data)
        _move_into_place(fresh, folder, work / OLD, force)


def check_file(file: Path, force: bool) -> None:
    """Refuse early to write over a file, or where the system does not let us.

    Raises
    ------
    UsageError
        When the file exists and ``force`` is not given, or it is no file.
    OutputError
        When nothing can be written there.
    """
    if not _stands(file):
        return
    if not file.is_file() or file.is_symlink():
        raise UsageError(f"{file} exists and is no file; choose another with `out`")
    if not force:
        raise UsageError(f"{file} exists; replace it with `force` or choose another with `out`")


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
        _write(fresh, data)
        if force or not _linked(fresh, file):
            fresh.replace(file.absolute())


def _stands(place: Path) -> bool:
    """Whether there is something already, a broken link too, once leftovers are cleared away."""
    target = place.absolute()
    try:
        place.exists()  # a name that no system takes
        recover(target)
        if os.path.lexists(target):
            return True
        _check_writable(target.parent)
    except OSError as error:
        raise _cannot_write(place, error) from error
    return False


def _check_writable(folder: Path) -> None:
    """See whether a folder can be made or written to, before hours are spent on its content."""
    while not os.path.lexists(folder):
        folder = folder.parent
    if not folder.is_dir():
        raise NotADirectoryError(f"{folder} is no folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise PermissionError(f"no permission to write to {folder}")


def _check_ours(folder: Path, place: Path, force: bool) -> None:
    """Refuse to replace what is no folder of ours; ``place`` is where it stands for the user."""
    try:
        seen = folder.lstat()
        if not stat.S_ISDIR(seen.st_mode):
            raise UsageError(f"{place} exists and is no folder; choose another with `out`")
        names = os.listdir(folder)  # noqa: PTH208  all at once
        stands = os.path.samestat(seen, folder.lstat())
    except FileNotFoundError:
        stands = False
    except OSError as error:
        raise _cannot_write(place, error) from error
    # What another process replaces at this moment is looked at again when it is set aside.
    if force and stands and names and not set(names) & set(_MARKS):
        raise UsageError(
            f"{place} holds no {' or '.join(_MARKS)}, so `force` will not replace it; "
            "choose another with `out`"
        )


@contextlib.contextmanager
def _beside(place: Path) -> Iterator[Path]:
    """Give a folder to work in beside a place, and say so where the system does not let us."""
    try:
        with working_beside(place.absolute()) as work:
            yield work
    except OSError as error:
        raise _cannot_write(place, error) from error


def _cannot_write(place: Path, error: OSError) -> OutputError:
    reason = error.strerror or str(error)
    return OutputError(f"cannot write {place}: {reason}; choose another place with `out`")


def _write(path: Path, data: bytes) -> None:
    """Write a file through to the disk: it shall be whole wherever its folder is seen."""
    with path.open("xb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _move_into_place(fresh: Path, folder: Path, aside: Path, force: bool) -> None:
    """Put the fresh folder in its place, and what stands there aside.

    No system renames a folder onto one that holds something: what another process puts there
    meanwhile is either set aside whole or left alone.
    """
    target = folder.absolute()
    try:
        for _ in range(_TRIES):
            if force:
                _set_aside(target, folder, aside)
            try:
                fresh.rename(target)
                return
            except OSError as error:
                if error.errno not in _TAKEN and not os.path.lexists(target):
                    raise
            if not force:
                check_free(folder, force)
        raise OSError("others write there all the time")
    except BaseException:  # an interrupt too: better what was there than nothing
        if os.path.lexists(aside) and not os.path.lexists(target):
            aside.rename(target)
        raise


def _set_aside(target: Path, folder: Path, aside: Path) -> None:
    shutil.rmtree(aside, ignore_errors=True)  # what others have replaced since
    with contextlib.suppress(FileNotFoundError):
        target.rename(aside)
        _check_ours(aside, folder, force=True)


def _linked(fresh: Path, file: Path) -> bool:
    """Give a file its name unless that is taken; False where the disk knows no links."""
    try:
        os.link(fresh, file.absolute())
    except FileExistsError:
        check_file(file, force=False)
        raise
    except OSError:
        return False
    return True
