"""Versions taken out of the studio: the files, and the commands that write the very same."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

from profiletool.errors import UsageError
from profiletool.files.write import check_free, write_folder
from profiletool.studio.job import Version
from profiletool.studio.session import Session

_FOLDER = re.compile(r"[^\W_][\w .+-]{0,99}")


def commands(session: Session, version: Version) -> list[str]:
    """Give the commands that write a version's files, to be run in the work folder.

    The folders that they write are named as those of the studio, and lie in ``made``.
    """
    lines = []
    for step in session.line_of(version):
        if step.kind == "design":
            words = ["design", *step.words]
        elif step.base is None:
            words = ["profiletool", step.kind, *step.words]
        else:
            words = ["profiletool", step.kind, f"made/{step.base}/design.json", *step.words]
        lines.append(shlex.join([*words, "--out", f"made/{step.number}"]))
    return lines


def toml_of(session: Session, version: Version) -> str:
    """Give the options that a version was designed with, as the file beside it has them."""
    first = session.line_of(version)[0]
    if first.kind != "design":
        return ""
    return (session.folder / f"{first.number}.toml").read_text("utf-8")


def files_of_version(session: Session, version: Version) -> dict[str, bytes]:
    """Read all files of a version."""
    place = session.place(version.number)
    return {path.name: path.read_bytes() for path in sorted(place.iterdir()) if path.is_file()}


def export(session: Session, version: Version, name: str, force: bool) -> Path:
    """Write all files of a version into a folder beside the work folder.

    Raises
    ------
    UsageError
        It is no name of a folder there, or there is something else.
    OutputError
        When the system does not let us write.
    """
    if not _FOLDER.fullmatch(name) or name == session.folder.name:
        raise UsageError("a folder's name has letters, digits, spaces and . - _ + alone")
    folder = session.folder.parent / name
    check_free(folder, force)
    write_folder(folder, files_of_version(session, version), force)
    return folder
