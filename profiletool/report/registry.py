"""Registries of files: a row gives a file's name and the function that writes its content."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

T = TypeVar("T")
U = TypeVar("U")
# A list where the name counts, as "actuator_{:02d}.vtu" does; None where there is no such file.
Content = bytes | list[bytes] | None
Writer = Callable[[T], Content]
Writers = Mapping[str, Writer[T]]


def written(writers: Writers[T], output: T) -> dict[str, bytes]:
    """Write every file of a registry that an output has.

    Parameters
    ----------
    writers : mapping of str to callable
        Name to writer; a writer gives None where the output has no such file, and a list where
        the name counts from 0.
    output
        What the writers take.

    Returns
    -------
    dict of str to bytes
        Name to content, in the order of the registry.
    """
    files: dict[str, bytes] = {}
    for name, write in writers.items():
        content = write(output)
        if isinstance(content, list):
            files |= {name.format(k): data for k, data in enumerate(content)}
        elif content is not None:
            files[name] = content
    return files


def rows_of(part: Callable[[T], U | None], writers: Writers[U]) -> dict[str, Writer[T]]:
    """Rows for a part of the output; none of them is written where there is no such part."""

    def lifted(write: Writer[U]) -> Writer[T]:
        def content(output: T) -> Content:
            found = part(output)
            return None if found is None else write(found)

        return content

    return {name: lifted(write) for name, write in writers.items()}
