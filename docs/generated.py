"""Sphinx extension: tables made from the code itself, so that they cannot go stale.

``{rooms}`` lists the parts of ``profiletool`` in the order of the layers in pyproject.toml, each
with the first line of its docstring. ``{design-options}`` lists the options of `design`.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from rooms import ROOT, layers
from sphinx.application import Sphinx

from profiletool.records.options import DESIGN
from profiletool.records.request import Request

_USUAL = Request(Path())


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directives."""
    app.add_directive("rooms", Rooms)
    app.add_directive("design-options", DesignOptions)
    return {"parallel_read_safe": True}


class Rooms(Directive):
    """Table of rooms: name and the first line of the docstring."""

    def run(self) -> list[nodes.Node]:
        """Make the table."""
        rows = [[nodes.literal("", name), said(name)] for row in layers() for name in row]
        return [table((25, 75), ("room", "holds"), rows)]


class DesignOptions(Directive):
    """Table of the options: flag, field, default and help."""

    def run(self) -> list[nodes.Node]:
        """Make the table."""
        return [table((20, 22, 16, 42), ("flag", "field", "default", "meaning"), list(_options()))]


def said(name: str) -> str:
    """First line of a room's docstring."""
    place = ROOT / "profiletool" / name
    file = place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    text = ast.get_docstring(ast.parse(file.read_text("utf-8"))) or ""
    return text.partition("\n")[0].replace("`", "")


def _options() -> Iterator[list[Any]]:
    for row in DESIGN:
        flag = f"{row.flag}, --no-{row.flag[2:]}" if row.off else row.flag
        yield [
            nodes.literal("", flag), nodes.literal("", row.field), row.shown(_USUAL),
            row.help.replace("`", ""),
        ]  # fmt: skip


def table(
    widths: Sequence[int], heads: Sequence[str], rows: Sequence[Sequence[str | nodes.Node]]
) -> nodes.table:
    """Lay out a table.

    Parameters
    ----------
    widths : sequence of int
        Of the columns, in per cent.
    heads : sequence of str
    rows : sequence of sequences of str or node
    """
    group = nodes.tgroup(
        "",
        *(nodes.colspec(colwidth=width) for width in widths),
        nodes.thead("", _row(heads)),
        nodes.tbody("", *map(_row, rows)),
        cols=len(widths),
    )
    return nodes.table("", group)


def _row(cells: Sequence[str | nodes.Node]) -> nodes.row:
    texts = (nodes.Text(cell) if isinstance(cell, str) else cell for cell in cells)
    return nodes.row("", *(nodes.entry("", nodes.paragraph("", "", text)) for text in texts))
