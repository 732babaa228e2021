"""Plain tree of all that an SVG draws: groups and shapes with their transforms and paint."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from xml.etree.ElementTree import Element, SubElement

from profiletool.errors import UnreadableInput, UsageError
from profiletool.profile.drawing.svg_page import LENGTH, NUMBER, px_of, view_box, viewport
from profiletool.profile.drawing.svg_style import INHERITED, Sheet, name_of, paint, share

MAX_ELEMENTS = 6_000
MAX_TRANSFORMS = 2_000_000  # characters, counted anew for every shape that they act on
MAX_NUMBERS = 60_000  # and letters, in all paths together, counted anew for every <use>
MAX_DEPTH = 100
MAX_ATTRIBUTE = 1_000  # characters; longer ones make svgelements crawl

_SHAPES = ("path", "line", "polyline", "polygon", "rect", "circle", "ellipse")
_GROUPS = ("g", "a", "switch", "svg")
_XLINK = "{http://www.w3.org/1999/xlink}href"
_LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
_LENGTHS = ("x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "rx", "ry", "width", "height")
_LONG = ("d", "points")
_READ = ("style", "transform", "class", "id", "href", _XLINK, "viewBox", "preserveAspectRatio")
# Nothing but numbers and what stands between them; possessive, so that it never looks back.
_ALLOWED = {"d": re.compile(rf"(?:[MmZzLlHhVvCcSsQqTtAa,\s]|{NUMBER})*+")}
_ALLOWED["points"] = re.compile(rf"(?:[,\s]|{NUMBER})*+")
_ITEM = re.compile(rf"[A-DF-Za-df-z]|{NUMBER}")
_URL = re.compile(r"url\(\s*[\"']?#([^\"')]+)[\"']?\s*\)")
_NAMED = 8  # layers in a message


@dataclass(frozen=True)
class _State:
    """What holds where an element stands.

    ``style`` is inherited; ``size`` (px) that of the viewport; ``path`` leads here; ``clips``
    are numbers of what clips; ``transforms`` counts characters; ``within`` the layer asked for.
    """

    style: Mapping[str, str]
    size: tuple[float, float]
    path: tuple[Element, ...] = ()
    clips: tuple[str, ...] = ()
    transforms: int = 0
    within: bool = True


@dataclass
class Plain:
    """A plain tree, and what is not in it.

    Attributes
    ----------
    root : Element
        An <svg> of <g> and shapes. Of a shape, inside and line each are none, white or ink;
        filled is stated or habit; clips are numbers with spaces between. What has a clipping is
        no shape, but the region of the clip of that number.
    left : Counter of str
        Texts, pictures, masks and hidden layers that are not drawn.
    """

    root: Element
    left: Counter[str] = field(default_factory=Counter)


def plain_tree(root: Element, layer: str | None = None) -> Plain:
    """Copy what is drawn: styles settled, <use>, symbols and nested pages in their places.

    Raises
    ------
    UnreadableInput
        Values that are no numbers, references in a circle, or too much of anything.
    UsageError
        No such layer.
    """
    copier = _Copier(root)
    if layer is not None and not any(_is_layer(e, layer) for e in root.iter()):
        names = [e.get(_LABEL, e.get("id", "")) for e in root if name_of(e) == "g"]
        known = ", ".join(f"{name[:40]!a}" for name in [n for n in names if n][:_NAMED])
        raise UsageError(f"no `layer` {layer[:40]!a}; there are {known or 'none'}")
    copier.layer = layer
    keys = ("width", "height", "viewBox", "preserveAspectRatio")
    made = Element("svg", {key: root.get(key, "") for key in keys if root.get(key)})
    made.set("xmlns", "http://www.w3.org/2000/svg")
    box = view_box(root)
    size = (box[2], box[3]) if box else tuple(float(root.get(key, "1000")) for key in keys[:2])
    state = _State({}, (size[0], size[1]), within=layer is None or _is_layer(root, layer))
    style = copier.sheet.of(root, ())
    state = replace(state, style=_inherited({}, style), path=(root,))
    copier.copy_all(list(root), made, state)
    return Plain(made, copier.left)


class _Copier:
    """Copies elements one into another tree, and counts, so that it ends."""

    def __init__(self, root: Element) -> None:
        self.sheet = Sheet(root)
        self.layer: str | None = None
        self.left: Counter[str] = Counter()
        self.by_id: defaultdict[str, list[Element]] = defaultdict(list)
        for element in root.iter():
            if element.get("id"):
                self.by_id[element.get("id", "")].append(element)
        self.elements = self.numbers = self.transforms = self.clips = 0

    def copy_all(self, elements: Sequence[Element], into: Element, above: _State) -> None:
        """Copy elements and what is in them; symbols are drawn by <use> alone."""
        for element in elements:
            if name_of(element) != "symbol":
                self.copy(element, into, above)

    def copy(self, element: Element, into: Element, above: _State) -> None:
        """Copy an element and what is in it."""
        name = name_of(element)
        if name in ("text", "image"):
            self.left[name] += 1
        if name not in (*_SHAPES, *_GROUPS, "use", "symbol"):
            return
        self._count(element, above)
        style = self.sheet.of(element, above.path)
        chosen = self.layer is not None and _is_layer(element, self.layer)
        hidden = style.get("display") == "none" or share(style.get("opacity", "1")) == 0.0
        if hidden and not chosen:
            self.left["hidden layer"] += element.get(_LABEL) is not None
            return
        if style.get("mask", "none") != "none":
            self.left["mask"] += 1
        transform = style.get("transform", "") if element.get("transform") else ""
        state = replace(
            above,
            style=_inherited(above.style, style),
            path=(*above.path, element),
            transforms=above.transforms + len(transform),
            within=above.within or chosen,
        )
        if name in _SHAPES and not state.within:
            return
        target = into
        if transform or name not in _SHAPES:
            target = SubElement(into, "g", {"transform": transform} if transform else {})
        state = self._clipped(style.get("clip-path", ""), target, state)
        if name in _SHAPES:
            self._shape(element, target, state)
        elif name == "use":
            self._use(element, target, state)
        else:
            self._group(element, target, state)

    def _count(self, element: Element, above: _State) -> None:
        self.elements += 1
        if self.elements > MAX_ELEMENTS:
            raise UnreadableInput(
                f"more than {MAX_ELEMENTS} elements, with what <use> makes; simplify the drawing"
            )
        if len(above.path) > MAX_DEPTH:
            raise UnreadableInput("nested too deeply, or <use> in a circle; flatten the drawing")
        self.transforms += above.transforms + len(element.get("transform", ""))
        if self.transforms > MAX_TRANSFORMS:
            raise UnreadableInput("far too many transforms in each other; flatten the drawing")
        for key in (*_READ, *_LENGTHS):
            if len(element.get(key, "")) > MAX_ATTRIBUTE:
                raise UnreadableInput(f"an endless {key[:20]!r}; export it again as plain SVG")
        text = element.get("d", "") + element.get("points", "")
        if len(text) > 40 * MAX_NUMBERS:  # not worth counting
            self.numbers += MAX_NUMBERS
        self.numbers += sum(1 for _ in _ITEM.finditer(text[: 40 * MAX_NUMBERS]))
        if self.numbers > MAX_NUMBERS:
            raise UnreadableInput(
                f"more than {MAX_NUMBERS} numbers in its paths; simplify the drawing"
            )

    def _shape(self, element: Element, into: Element, state: _State) -> None:
        _check_values(element)
        style = state.style
        if style.get("visibility") in ("hidden", "collapse"):
            return
        fill, stroke = (
            paint(
                style.get("color", "black") if style.get(key) == "currentColor"
                else style.get(key, default),
                style.get(f"{key}-opacity", "1"),
            )
            for key, default in (("fill", "black"), ("stroke", "none"))
        )  # fmt: skip
        if share(style.get("stroke-width", "1")) == 0.0:
            stroke = "none"
        kept = {key: element.get(key, "") for key in (*_LENGTHS, *_LONG) if element.get(key)}
        kept |= {"inside": fill, "line": stroke, "clips": " ".join(state.clips)}
        SubElement(
            into, name_of(element), kept | {"filled": "stated" if "fill" in style else "habit"}
        )

    def _group(self, element: Element, into: Element, state: _State) -> None:
        if name_of(element) in ("svg", "symbol"):
            x, y, *size = (
                self._length(element, key, whole, default)
                for key, whole, default in (
                    ("x", state.size[0], 0.0), ("y", state.size[1], 0.0),
                    ("width", state.size[0], state.size[0]),
                    ("height", state.size[1], state.size[1]),
                )
            )  # fmt: skip
            if min(size) <= 0.0:
                return
            transform, inner = viewport(element, size)
            move = f"translate({x!r} {y!r})" if name_of(element) == "svg" else ""
            into = SubElement(into, "g", {"transform": f"{move} {transform}"})
            state = replace(state, size=inner, transforms=state.transforms + len(transform) + 40)
        children = list(element)
        if name_of(element) == "switch":
            children = [c for c in children if name_of(c) not in ("", "foreignObject")][:1]
        self.copy_all(children, into, state)

    def _use(self, element: Element, into: Element, state: _State) -> None:
        link = element.get("href", element.get(_XLINK, ""))
        targets = self.by_id.get(link[1:], [])[:1] if link.startswith("#") else []
        x, y = (self._length(element, key, s, 0.0) for key, s in zip("xy", state.size, strict=True))
        if x or y:
            into = SubElement(into, "g", {"transform": f"translate({x!r} {y!r})"})
        for target in targets:
            if name_of(target) in ("symbol", "svg"):
                sizes = {key: element.get(key, "") for key in ("width", "height")}
                own = Element(
                    target.tag, {**target.attrib, **{k: v for k, v in sizes.items() if v}}
                )
                own.extend(list(target))
                target = own
            self.copy(target, into, state)

    def _clipped(self, link: str, into: Element, state: _State) -> _State:
        """Put the region of a clip beside what it clips."""
        found = _URL.match(link)
        regions = self.by_id.get(found[1], []) if found else []
        regions = [region for region in regions if name_of(region) == "clipPath"][:1]
        for region in regions:
            if region.get("clipPathUnits") == "objectBoundingBox":
                self.left["clip path"] += 1
                continue
            self.clips += 1
            number = str(self.clips)
            made = SubElement(into, "g", {"clipping": number})
            if region.get("transform"):
                made.set("transform", region.get("transform", ""))
            inside = replace(
                state, clips=(), style={"fill": "black"}, path=(*state.path, region), within=True
            )
            for child in region:
                self.copy(child, made, inside)
            state = replace(state, clips=(*state.clips, number))
        return state

    def _length(self, element: Element, key: str, whole: float, default: float) -> float:
        found = px_of(element.get(key, ""), whole)
        return default if found is None else found


def _inherited(above: Mapping[str, str], own: Mapping[str, str]) -> dict[str, str]:
    set_here = {k: v for k, v in own.items() if k in INHERITED and v != "inherit"}
    return {**above, **set_here}


def _is_layer(element: Element, layer: str) -> bool:
    return layer in (element.get(_LABEL), element.get("id"), element.get("data-name"))


def _check_values(element: Element) -> None:
    """Refuse what is no number where a shape has them."""
    for key, allowed in _ALLOWED.items():
        if not allowed.fullmatch(element.get(key, "")):
            raise UnreadableInput(
                f"<{name_of(element)}> has a bad {key!r}; export the drawing again"
            )
    for key in _LENGTHS:
        text = element.get(key, "0")
        if not LENGTH.fullmatch(text) and text != "auto":
            raise UnreadableInput(
                f"<{name_of(element)}> has the length {text[:20]!a}; use numbers, mm or px"
            )
