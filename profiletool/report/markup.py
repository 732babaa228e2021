"""Markup for HTML and SVG: elements are closed, texts escaped."""

from __future__ import annotations

import base64
import hashlib
import html
import re
from collections.abc import Iterable, Sequence

MINUS = "\N{MINUS SIGN}"
_VOID = frozenset({"meta", "link", "input", "br", "path", "line", "rect", "circle", "image"})


class Markup(str):
    """Text that is markup already; any other text is escaped where it is put into an element."""

    __slots__ = ()


def tag(name: str, /, *inner: str, **attributes: str | float | bool) -> Markup:
    """Write an element.

    Parameters
    ----------
    name : str
    *inner : str
        What it holds, one after the other: `Markup` as it is, text escaped.
    **attributes : str, float or bool
        ``class_`` is class, other underscores are hyphens; True is an attribute without a value,
        False is none.
    """
    head = name + "".join(_attribute(key, value) for key, value in attributes.items())
    if name in _VOID and not inner:
        return Markup(f"<{head}/>")
    return Markup(f"<{head}>{''.join(text(part) for part in inner)}</{name}>")


def text(content: str) -> Markup:
    """Escape a text, unless it is markup; what cannot be printed, or turns its way, is dropped."""
    if isinstance(content, Markup):
        return content
    shown = "".join(c for c in content if c.isprintable() or c.isspace())
    return Markup(html.escape(shown))


def plain(content: str) -> str:
    """Take the elements out of markup; any other text stays as it is."""
    if not isinstance(content, Markup):
        return content
    return html.unescape(re.sub(r"<[^>]*>", "", content))


def joined(parts: Iterable[str], between: str = "") -> Markup:
    """Put parts one after the other."""
    return Markup(text(between).join(text(part) for part in parts))


def table(
    heads: Sequence[str], rows: Iterable[Sequence[str]], caption: str, class_: str = "numbers"
) -> Markup:
    """Write a table whose rows are named by their first cell; "numbers" or "words" is its class.

    It scrolls by itself where the page is too narrow for it; what is said above it does not.
    """
    head = tag("tr", *(tag("th", cell, scope="col") for cell in heads))
    body = [
        tag("tr", tag("th", first, scope="row"), *(tag("td", cell) for cell in rest))
        for first, *rest in rows
    ]
    whole = tag("table", tag("thead", head), tag("tbody", *body), class_=class_)
    return tag(
        "figure",
        tag("figcaption", caption),
        tag("div", whole, class_="scroll", tabindex="0", role="region", aria_label=plain(caption)),
        class_="table",
    )


def pairs(rows: Iterable[tuple[str, str]], class_: str = "pairs") -> Markup:
    """Write a list of names and their descriptions."""
    return tag(
        "dl",
        *(tag("div", tag("dt", name), tag("dd", value)) for name, value in rows),
        class_=class_,
    )


def policy(script: str) -> str:
    """Allow a page's own script and styles, and pictures that are part of it; nothing else."""
    mark = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return (
        f"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{mark}'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def signed(value: float, decimals: int = 1, unit: str = "") -> str:
    """Write a number with a true minus sign; no minus before nothing."""
    written = f"{value:.{decimals}f}"
    if not written.strip("-0."):
        written = written.lstrip("-")
    return written.replace("-", MINUS) + unit


def adopted(element: str, prefix: str) -> Markup:
    """Take an SVG document or element into a page; a prefix keeps its ids apart from others."""
    element = element[element.index("<svg") :].strip()
    element = re.sub(r'\bid="', f'id="{prefix}', element)
    element = re.sub(r'(href="#|url\(#)', rf"\g<1>{prefix}", element)
    return Markup(element)


def _attribute(key: str, value: str | float | bool) -> str:
    name = key.rstrip("_").replace("_", "-")
    if isinstance(value, bool):
        return f" {name}" if value else ""
    written = f"{value:g}" if isinstance(value, float) else str(value)
    return f' {name}="{text(written) if not isinstance(value, Markup) else value}"'
