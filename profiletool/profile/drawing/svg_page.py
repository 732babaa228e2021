"""Page of an SVG and the viewports in it: how large its px are, and where."""

from __future__ import annotations

import re
from collections.abc import Sequence
from xml.etree.ElementTree import Element

from profiletool.records.profile import DrawnUnit
from profiletool.records.units import MM_PER_INCH

CSS_PX_PER_INCH = 96.0
MM_PER_PX = MM_PER_INCH / CSS_PX_PER_INCH
NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
LENGTH = re.compile(rf"\s*({NUMBER})\s*(px|mm|cm|in|pt|pc|q|%|)\s*", re.IGNORECASE)
_NUMBERS = re.compile(NUMBER)
_PX_PER = {"": 1.0, "px": 1.0, "in": 96.0, "pt": 96 / 72, "pc": 16.0}
_PX_PER |= {"mm": 1 / MM_PER_PX, "cm": 10 / MM_PER_PX, "q": 0.25 / MM_PER_PX}
_OLD_INKSCAPE = re.compile(r"inkscape:version\s*=\s*[\"']0\.(\d+)")
_OLD_INKSCAPE_PX, _ILLUSTRATOR_PX = 90.0, 72.0  # per inch
_NEW_MINOR = 92  # of Inkscape 0.x, from which on px are those of CSS
_HEAD = 4000  # characters in which a program says its name
_ALIGN = re.compile(r"x(Min|Mid|Max)Y(Min|Mid|Max)(?:\s+(meet|slice))?")


def px_of(text: str, whole: float) -> float | None:
    """Read a length in px, shares as those of ``whole``; None where there is none."""
    found = LENGTH.fullmatch(text)
    if found is None:
        return None
    unit = found[2].lower()
    return float(found[1]) * (0.01 * whole if unit == "%" else _PX_PER[unit])


def view_box(element: Element) -> list[float] | None:
    """Give the four numbers of a viewBox; None where there is none that draws."""
    box = [float(n) for n in _NUMBERS.findall(element.get("viewBox", ""))]
    return box if len(box) == 4 and min(box[2:]) > 0.0 else None


def size_page(root: Element, text: str) -> tuple[DrawnUnit, float]:
    """Bring the page's width and height to px; the viewBox's proportions give what is missing.

    Returns
    -------
    unit : DrawnUnit
    float
        What lengths in CSS px are to be multiplied with, where a program has other px.
    """
    styled = dict(re.findall(r"(?:^|;)\s*(width|height)\s*:\s*([^;]+)", root.get("style", "")))
    given = {
        key: LENGTH.fullmatch(root.get(key) or styled.get(key) or "") for key in ("width", "height")
    }
    kept = {key: m for key, m in given.items() if m is not None and m[2] != "%"}
    for key in given:
        root.attrib.pop(key, None)
        if key in kept:
            root.set(key, repr(float(kept[key][1]) * _PX_PER[kept[key][2].lower()]))
    box = view_box(root)
    if box is not None and len(kept) == 1:
        (have,) = kept
        lack = "height" if have == "width" else "width"
        ratio = box[3] / box[2] if have == "width" else box[2] / box[3]
        root.set(lack, repr(float(root.get(have, "0")) * ratio))
    physical = [m for m in kept.values() if m[2].lower() not in ("", "px")]
    other = _other_px(text, box is not None and bool(physical))
    if other is not None:
        per_inch, name = other
        unit = DrawnUnit(
            MM_PER_INCH / per_inch, f"{name} has {per_inch:g} px per inch", assumed=True
        )
        return unit, CSS_PX_PER_INCH / per_inch
    if physical:
        key, m = next((key, m) for key, m in kept.items() if m in physical)
        side = "wide" if key == "width" else "high"
        return DrawnUnit(MM_PER_PX, f"the page is {m[1][:20]} {m[2]} {side}"), 1.0
    if kept:
        source = "the file gives its size in px alone, taken for 1/96 inch"
        return DrawnUnit(MM_PER_PX, source, assumed=True), 1.0
    return DrawnUnit(MM_PER_PX, "the file states no physical size", sized=False), 1.0


def _other_px(text: str, sized: bool) -> tuple[float, str] | None:
    """Say which program has px of its own, and how many per inch."""
    head = text[:_HEAD]
    if sized:
        return None
    old = _OLD_INKSCAPE.search(head)
    if old is not None and int(old[1][:2]) < _NEW_MINOR:
        return _OLD_INKSCAPE_PX, f"Inkscape 0.{old[1][:2]}"
    if re.search(r"<!--[^>]*Adobe Illustrator", head):
        return _ILLUSTRATOR_PX, "Illustrator"
    return None


def viewport(element: Element, size: Sequence[float]) -> tuple[str, tuple[float, float]]:
    """Give the transform into a nested viewport of a size (px), and its own size inside."""
    box = view_box(element)
    if box is None or min(size) <= 0.0:
        return "", (size[0], size[1])
    x, y, width, height = box
    sx, sy = size[0] / width, size[1] / height
    text = element.get("preserveAspectRatio", "").strip()
    aligned = _ALIGN.search(text) if text else _ALIGN.search("xMidYMid")
    shift = [0.0, 0.0]
    if aligned is not None:
        sx = sy = max(sx, sy) if aligned[3] == "slice" else min(sx, sy)
        part = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}
        shift = [
            part[aligned[1]] * (size[0] - sx * width),
            part[aligned[2]] * (size[1] - sy * height),
        ]
    place = f"translate({shift[0]!r} {shift[1]!r}) scale({sx!r} {sy!r}) translate({-x!r} {-y!r})"
    return place, (width, height)
