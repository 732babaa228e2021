"""Style of SVG elements: attributes, style sheets and inline styles, in that order."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from profiletool.errors import UnreadableInput

MAX_STYLE = 20_000  # characters in all <style> together
_COMMENT = re.compile(r"/\*.*?\*/|<!--|-->", re.DOTALL)
_AT_RULE = re.compile(r"@[^{};]*(?:;|\{(?:[^{}]|\{[^{}]*\})*\})")
_RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
_COMPOUND = re.compile(r"(?:\*|[A-Za-z][\w-]*)?(?:[.#][\w-]+)*")
# What decides whether and how a shape is painted; children inherit the first ones.
INHERITED = ("fill", "stroke", "color", "visibility", "fill-opacity", "stroke-opacity",
             "stroke-width")  # fmt: skip
_OWN = ("display", "opacity", "clip-path", "mask", "transform")
_KEYS = frozenset((*INHERITED, *_OWN))
_WHITE = re.compile(r"white|#f{3}f?|#f{6}(?:ff)?|rgba?\(\s*(?:255|100%)(?:[\s,]+(?:255|100%)){2}"
                    r"(?:[\s,/]+(?:1|1\.0|100%))?\s*\)")  # fmt: skip
_CLEAR = re.compile(r"none|transparent|#[0-9a-f]{3}0|#[0-9a-f]{6}00|"
                    r"(?:rgb|hsl)a?\([^()]*[,/]\s*0?\.?0+%?\s*\)")  # fmt: skip
_ALPHA = re.compile(r"(?:rgb|hsl)a\(")


def name_of(element: Element) -> str:
    """Tag without its namespace; "" where that is another than SVG's."""
    space, _, name = element.tag.rpartition("}")
    return name if space in ("", "{http://www.w3.org/2000/svg") else ""


@dataclass(frozen=True)
class _Rule:
    """A selector, its compounds from the outermost to the element's own, and what it sets."""

    compounds: tuple[str, ...]
    weight: tuple[int, int, int, int]
    values: Mapping[str, str]


class Sheet:
    """The style sheets of a drawing."""

    def __init__(self, root: Element) -> None:
        text = "\n".join("".join(e.itertext()) for e in root.iter() if name_of(e) == "style")
        if len(text) > MAX_STYLE:
            raise UnreadableInput("an endless <style>; export it again as plain SVG")
        self._rules: defaultdict[str, list[_Rule]] = defaultdict(list)
        plain = _AT_RULE.sub("", _COMMENT.sub("", text))
        for order, (selectors, body) in enumerate(_RULE.findall(plain)):
            for selector in selectors.split(","):
                compounds = tuple(selector.replace(">", " ").split())
                if compounds and all(_COMPOUND.fullmatch(c) for c in compounds):
                    whole = "".join(compounds)
                    words = sum(bool(re.match(r"[A-Za-z]", c)) for c in compounds)
                    weight = (whole.count("#"), whole.count("."), words, order)
                    self._rules[_key(compounds[-1])].append(
                        _Rule(compounds, weight, declared(body))
                    )

    def of(self, element: Element, path: Sequence[Element]) -> dict[str, str]:
        """Give what is set on an element inside others, the outermost first."""
        found = {key: element.get(key, "").strip() for key in _KEYS if element.get(key)}
        names = element.get("class", "").split()
        keys = ["*", name_of(element), f"#{element.get('id', '')}", *(f".{n}" for n in names)]
        rules = [rule for key in keys for rule in self._rules.get(key, ())]
        for rule in sorted(rules, key=lambda rule: rule.weight):
            if _matches(element, rule.compounds[-1]) and _within(path, rule.compounds[:-1]):
                found |= rule.values
        return found | declared(element.get("style", ""))


def declared(text: str) -> dict[str, str]:
    """Split "key: value; key: value"."""
    pairs = (part.partition(":") for part in text.split(";"))
    values = {key.strip().lower(): value.partition("!")[0].strip() for key, _, value in pairs}
    return {key: value for key, value in values.items() if key in _KEYS and value}


def paint(value: str, opacity: str) -> str:
    """Tell what a fill or stroke is: "none", "white" or "ink"."""
    text = value.strip().lower()
    if share(opacity) == 0.0 or (_CLEAR.fullmatch(text) and not _opaque(text)):
        return "none"
    return "white" if _WHITE.fullmatch(text) else "ink"


def share(text: str, default: float = 1.0) -> float:
    """Read an opacity or a width, as a number or in per cent."""
    found = re.match(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*(%?)", text.lower())
    if found is None:
        return default
    return float(found[1]) * (0.01 if found[2] else 1.0)


def _opaque(text: str) -> bool:
    """Whether rgb(...) or hsl(...) names no alpha though its last number is 0."""
    if "(" not in text:
        return False
    return len(re.split(r"[\s,/]+", text.partition("(")[2].strip(" )"))) < 4


def _key(compound: str) -> str:
    """Give what a rule is looked up by."""
    marked: list[str] = re.findall(r"[.#][\w-]+", compound)
    return marked[-1] if marked else compound


def _matches(element: Element, compound: str) -> bool:
    tag = re.match(r"\*|[A-Za-z][\w-]*", compound)
    if tag is not None and tag[0] not in ("*", name_of(element)):
        return False
    names = element.get("class", "").split()
    return all(
        part[1:] in names if part[0] == "." else part[1:] == element.get("id")
        for part in re.findall(r"[.#][\w-]+", compound)
    )


def _within(path: Sequence[Element], compounds: Sequence[str]) -> bool:
    """Whether ancestors match compounds in their order."""
    left = list(compounds)
    for element in path:
        if left and _matches(element, left[0]):
            left.pop(0)
    return not left
