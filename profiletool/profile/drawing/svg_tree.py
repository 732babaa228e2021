"""The XML of a drawing: checked before anything is drawn, and pruned to what is drawn."""

from __future__ import annotations

import re
from collections import defaultdict
from xml.etree import ElementTree

from profiletool.errors import UnreadableInput
from profiletool.records.units import MM_PER_INCH

CSS_PX_PER_INCH = 96.0
MM_PER_PX = MM_PER_INCH / CSS_PX_PER_INCH
_PX_PER = {"": 1.0, "px": 1.0, "in": 96.0, "pt": 96 / 72, "pc": 16.0}
_PX_PER |= {"mm": 1 / MM_PER_PX, "cm": 10 / MM_PER_PX, "Q": 0.25 / MM_PER_PX}
MAX_ELEMENTS = 6_000
MAX_TRANSFORMS = 2_000_000  # characters, counted anew for every element that they act on
MAX_NUMBERS = 60_000  # and letters, in all paths together, counted anew for every <use>
MAX_DEPTH = 100
MAX_ATTRIBUTE = 1_000  # characters; longer ones make svgelements crawl
MAX_STYLE = 20_000  # characters in all <style> together

_SHAPES = ("path", "line", "polyline", "polygon", "rect", "circle", "ellipse")
# Their shapes are not drawn where they stand, or not at all.
_NOT_DRAWN = ("marker", "mask", "symbol", "filter", "metadata", "foreignObject", "image", "text")
_XLINK = "{http://www.w3.org/1999/xlink}href"
_DECLARATION = re.compile(rb"<!(?:DOCTYPE|ENTITY)", re.IGNORECASE)
_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_NUMBERS = re.compile(_NUMBER)
_LENGTH = re.compile(rf"\s*({_NUMBER})\s*(px|mm|cm|in|pt|pc|Q|%|)\s*")
_LENGTHS = ("x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "rx", "ry", "width", "height")
_LONG = ("d", "points")
# The other attributes change nothing in where lines go, and every child would inherit them.
_MEANT = (
    *_LENGTHS, "d", "points", "href", "id", "class", "style", "transform", "viewBox",
    "preserveAspectRatio", "display", "visibility",
)  # fmt: skip
# Nothing but numbers and what stands between them; possessive, so that it never looks back.
_ALLOWED = {"d": re.compile(rf"(?:[MmZzLlHhVvCcSsQqTtAa,\s]|{_NUMBER})*+")}
_ITEM = re.compile(rf"[A-DF-Za-df-z]|{_NUMBER}")
_ALLOWED["points"] = re.compile(rf"(?:[,\s]|{_NUMBER})*+")


def safe_tree(data: bytes) -> ElementTree.Element:
    """Parse the XML: no declarations, one encoding, bounded size."""
    if _DECLARATION.search(data):
        raise UnreadableInput("holds a DOCTYPE or ENTITY declaration; delete it and save again")
    if data.count(b"<") > 2 * MAX_ELEMENTS:
        raise UnreadableInput(f"more than {MAX_ELEMENTS} elements; simplify the drawing")
    try:
        # In UTF-16 and the like a declaration could hide from the search above.
        text = data.decode("utf-8-sig")
        if "\0" in text:
            raise ValueError("holds null characters")
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise UnreadableInput(f"not well-formed XML in UTF-8 ({error}); export again") from None


def _name(element: ElementTree.Element) -> str:
    return element.tag.rpartition("}")[2]


def prepare(root: ElementTree.Element) -> None:
    """Check the tree, prune what is not drawn and complete the page's size."""
    if _name(root) != "svg":
        raise UnreadableInput(
            f"holds <{_name(root)[:20]}> instead of <svg>; export it again as SVG"
        )
    _check_expansion(root)
    styles = 0
    for element in list(root.iter()):
        for child in list(element):
            if _name(child) in _NOT_DRAWN:
                element.remove(child)
        _keep_what_is_meant(element)
        styles += len(element.text or "") if _name(element) == "style" else 0
        if _name(element) in _SHAPES:
            _check_values(element)
    if styles > MAX_STYLE:
        raise UnreadableInput("an endless <style>; export it again as plain SVG")
    _complete_size(root)


def _check_expansion(root: ElementTree.Element) -> None:
    """Refuse <use> that multiplies without bound or refers to itself, and endless nesting."""
    by_id: defaultdict[str, list[ElementTree.Element]] = defaultdict(list)
    for element in root.iter():
        if element.get("id"):
            by_id[element.get("id", "")].append(element)
    sizes: dict[ElementTree.Element, tuple[int, int, int]] = {}

    def size(element: ElementTree.Element, depth: int) -> tuple[int, int, int]:
        """Elements drawn, characters of the transforms that act on them, numbers in paths."""
        if depth > MAX_DEPTH:
            raise UnreadableInput("nested too deeply, or <use> in a circle; flatten the drawing")
        if element not in sizes:
            inside = list(element)
            if _name(element) == "use":
                inside += by_id[_href(element)[1:]]
            below = [size(part, depth + 1) for part in inside]
            count = 1 + sum(part[0] for part in below)
            sizes[element] = (
                count,
                count * len(element.get("transform", "")) + sum(part[1] for part in below),
                _numbers(element) + sum(part[2] for part in below),
            )
        return sizes[element]

    count, transforms, numbers = size(root, 0)
    if count > MAX_ELEMENTS:
        raise UnreadableInput(
            f"more than {MAX_ELEMENTS} elements, with what <use> makes; simplify the drawing"
        )
    if transforms > MAX_TRANSFORMS:
        raise UnreadableInput("far too many transforms in each other; flatten the drawing")
    if numbers > MAX_NUMBERS:
        raise UnreadableInput(f"more than {MAX_NUMBERS} numbers in its paths; simplify the drawing")


def _numbers(element: ElementTree.Element) -> int:
    """Numbers and letters in a path: what it takes to read it."""
    text = element.get("d", "") + element.get("points", "")
    if len(text) > 40 * MAX_NUMBERS:  # not worth counting
        return MAX_NUMBERS + 1
    return sum(1 for _ in _ITEM.finditer(text))


def _href(element: ElementTree.Element) -> str:
    link = element.get(_XLINK, "")
    return element.get("href", link)


def _keep_what_is_meant(element: ElementTree.Element) -> None:
    for key, text in list(element.attrib.items()):
        outward = key in ("href", _XLINK) and not text.startswith("#")
        if outward or (key not in _MEANT and key != _XLINK):
            del element.attrib[key]
        elif len(text) > MAX_ATTRIBUTE and key not in _LONG:
            raise UnreadableInput(f"an endless {key[:20]!r}; export it again as plain SVG")


def _check_values(element: ElementTree.Element) -> None:
    """Refuse what is no number where a shape has them."""
    for key, allowed in _ALLOWED.items():
        text = element.get(key, "")
        if not allowed.fullmatch(text):
            raise UnreadableInput(f"<{_name(element)}> has a bad {key!r}; export the drawing again")
    for key in _LENGTHS:
        text = element.get(key, "0")
        if not _LENGTH.fullmatch(text) and text != "auto":
            raise UnreadableInput(
                f"<{_name(element)}> has the length {text[:20]!a}; use numbers, mm or px"
            )


def _complete_size(root: ElementTree.Element) -> None:
    """Bring width and height to px; where one is missing, the viewBox's proportions give it."""
    box = [float(n) for n in _NUMBERS.findall(root.get("viewBox", ""))]
    for key in ("width", "height"):
        given = _LENGTH.fullmatch(root.get(key, ""))
        if given is None:
            root.attrib.pop(key, None)  # "auto" and the like
        elif given[2] != "%":
            root.set(key, repr(float(given[1]) * _PX_PER[given[2]]))
    if len(box) != 4 or min(box[2:]) <= 0:
        return
    for have, lack, ratio in (
        ("width", "height", box[3] / box[2]),
        ("height", "width", box[2] / box[3]),
    ):
        given = _LENGTH.fullmatch(root.get(have, ""))
        if given and given[2] != "%" and root.get(lack) is None:
            root.set(lack, repr(float(given[1]) * ratio))
