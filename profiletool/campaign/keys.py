"""Keys and files of runs: hashes of a task and the model's sources, and sealed JSON."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable

import fem

_NO_MODEL = "export"  # the sub-package of `fem` that writes solutions down


def key_of(asked: Mapping[str, object]) -> str:
    """Name a run by a tree of all that was asked for and the sources of `fem`."""
    return hashlib.sha256(_canonical({**asked, "sources": _model_sources()})).hexdigest()


@cache
def _model_sources() -> str:
    return hash_sources(resources.files(fem))


def hash_sources(package: Traversable) -> str:
    """Hash the source files of a package, however their lines end.

    Sub-packages count, but for ``export``, on which no result depends.
    """
    digest = hashlib.sha256()
    for path, file in _sources(package):
        code = file.read_bytes().replace(b"\r\n", b"\n")
        digest.update(f"{path} {len(code)}\n".encode() + code)
    return digest.hexdigest()


def _sources(package: Traversable, above: str = "") -> Iterator[tuple[str, Traversable]]:
    """Source files with their paths in the package, in the order of their names."""
    for entry in sorted(package.iterdir(), key=lambda entry: entry.name):
        if entry.is_dir():
            if f"{above}{entry.name}" != _NO_MODEL:
                yield from _sources(entry, f"{above}{entry.name}/")
        elif entry.name.endswith(".py"):
            yield f"{above}{entry.name}", entry


def seal(schema: str, body: Mapping[str, object]) -> bytes:
    """Write an outcome as JSON with a checksum; the same outcome gives the same bytes."""
    checksum = hashlib.sha256(_canonical(body)).hexdigest()
    return _canonical({"schema": schema, "sha256": checksum, "outcome": body}) + b"\n"


def unseal(schema: str, data: bytes) -> dict[str, object]:
    """Read what `seal` wrote, and nothing else.

    Raises
    ------
    ValueError
        When a single byte is not as it was written, or the schema is another.
    """
    tree = json.loads(data)
    body = tree.get("outcome") if isinstance(tree, dict) else None
    if not isinstance(body, dict):
        raise ValueError("this is no run")
    if seal(schema, body) != data:  # checksum, schema, layout and all
        raise ValueError("this run is damaged")
    return body


def _canonical(tree: Mapping[str, object]) -> bytes:
    return json.dumps(tree, sort_keys=True, separators=(",", ":")).encode()
