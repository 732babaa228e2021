"""Sphinx extension for the API pages: links of public names, and a check that none is left out.

Docstrings and annotations name public records without their package, and the engine's own types
beside them. A public name becomes a link to its entry; any other name of the packages stays text.
A name that does not exist is a broken reference, and with ``-W`` an error. So is a name of
``__all__`` without an entry.
"""

from __future__ import annotations

import builtins
import inspect
import pkgutil
import re
import typing
from functools import cache
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy.typing
from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging

FACES = ("profiletool", "fem", "formula")
_LOGGER = logging.getLogger(__name__)
_OUTSIDE = {"collections", "numpy", "np", "os", "pathlib", "typing"}


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to the build."""
    app.connect("autodoc-process-docstring", _plain_headings, priority=100)
    app.connect("missing-reference", _link)
    app.connect("env-check-consistency", _check_complete)
    return {"parallel_read_safe": True}


def _plain_headings(
    app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]
) -> None:
    """Turn a heading in a package's docstring into a rubric, and its terms into a list.

    Two pages have a Glossary, and Sphinx wants headings to differ.
    """
    if what != "module":
        return
    for number, line in enumerate(lines):
        if number + 1 < len(lines) and re.fullmatch(r"-{4,}", lines[number + 1]):
            lines[number : number + 2] = [f".. rubric:: {line}", ""]
        elif term := re.fullmatch(r"(\w[\w, ]*) : (.*)", line):
            lines[number] = f"- **{term[1]}**: {term[2]}"


@cache
def _modules() -> dict[str, ModuleType]:
    """All modules of the packages by name."""
    found = {}
    for face in FACES:
        package = import_module(face)
        names = [info.name for info in pkgutil.walk_packages(package.__path__, f"{face}.")]
        found[face] = package
        found |= {name: import_module(name) for name in names if not name.endswith("__main__")}
    return found


@cache
def _known() -> frozenset[str]:
    """Names that exist: modules, what they hold, and the fields and methods of their classes."""
    names = {*_modules(), *vars(builtins), *vars(typing), *vars(numpy.typing)}
    for module in _modules().values():
        for name, value in vars(module).items():
            names.add(name)
            if inspect.isclass(value) and value.__module__.partition(".")[0] in FACES:
                names |= {*dir(value), *inspect.get_annotations(value)}
    return frozenset(names)


@cache
def _entries() -> dict[str, str]:
    """Public names by their last part."""
    return {name: f"{face}.{name}" for face in FACES for name in import_module(face).__all__}


def _link(
    app: Sphinx, env: BuildEnvironment, node: pending_xref, text: nodes.Element
) -> nodes.Node | None:
    """Link a public name, leave any other name that exists as it is, and refuse the rest."""
    if node.get("refdomain") != "py":
        return None
    target = re.sub(r"^~", "", node["reftarget"])
    parts = target.split(".")
    for count in (1, 2):  # a name, or a member of one
        if len(parts) >= count and parts[-count] in _entries():
            entry = ".".join([_entries()[parts[-count]], *parts[len(parts) - count + 1 :]])
            entries: dict[str, Any] = env.domains.python_domain.objects
            if entry in entries:
                found = entries[entry]
                return _reference(app, node["refdoc"], found, text)
    exists = target in _modules() or all(part in _known() for part in parts[-2:])
    return text if exists or target.partition(".")[0] in _OUTSIDE else None


def _reference(app: Sphinx, page: str, entry: Any, text: nodes.Element) -> nodes.reference:
    uri = f"{app.builder.get_relative_uri(page, entry.docname)}#{entry.node_id}"
    return nodes.reference("", "", text, internal=True, refuri=uri)


def _check_complete(app: Sphinx, env: BuildEnvironment) -> None:
    """Warn of public names without an entry."""
    entries = env.domains.python_domain.objects
    missing = [name for name in _entries().values() if name not in entries]
    for name in missing:
        _LOGGER.warning("%s is public but has no entry on the API pages", name)
