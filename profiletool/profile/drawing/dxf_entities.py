"""Entities of a DXF that are drawn: those of its layers, with what its blocks hold."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from profiletool.errors import NoObject, UnreadableInput, UsageError

if TYPE_CHECKING:
    from ezdxf.document import Drawing

KINDS = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "LWPOLYLINE", "POLYLINE", "SPLINE", "HATCH",
         "MPOLYGON", "SOLID", "TRACE", "3DFACE")  # fmt: skip
_OPENED = ("INSERT", "MLINE")
# Bodies and pictures that no line stands for; texts, dimensions and the like are no profile.
_LOST = ("REGION", "3DSOLID", "BODY", "SURFACE", "MESH", "HELIX", "IMAGE", "PDFUNDERLAY",
         "ACAD_PROXY_ENTITY")  # fmt: skip
_NEVER_PLOTTED = "defpoints"  # where CAD programs keep the points of dimensions
MAX_ENTITIES = 10_000
_MAX_DEPTH = 12  # of blocks in blocks
_NAMED = 8  # layers in a message


def drawn_entities(drawing: Drawing, layer: str | None) -> tuple[list[Any], tuple[str, ...]]:
    """Give the lines and curves that are drawn, blocks taken apart, and notes on the rest.

    Parameters
    ----------
    drawing : ezdxf.document.Drawing
    layer : str or None
        To take alone, even if it is off.

    Raises
    ------
    UsageError
        No such layer.
    NoObject
        There is nothing but what no line stands for.
    UnreadableInput
        Far too many.
    """
    walk = _Walk(drawing, layer)
    found = list(walk.drawn(drawing.modelspace()))
    notes = []
    if not found:
        for layout in drawing.layouts:
            if layout.is_any_paperspace and not found:
                found = list(walk.drawn(layout))
                notes = [f"all lies in paper space: {layout.name[:40]!a} was read"] if found else []
    if not found and layer is not None:
        raise NoObject(f"nothing drawable on the `layer` {layer[:40]!a}")
    left = ", ".join(f"{count} {kind}" for kind, count in sorted(walk.left.items()))
    hidden = ", ".join(f"{name[:40]!a}" for name in sorted(walk.hidden)[:_NAMED])
    if hidden and not found:
        raise NoObject(f"all lies on layers that are off or frozen, {hidden}: choose a `layer`")
    if hidden:
        notes.append(f"left out: what lies on layers that are off or frozen, {hidden}")
    if left and not found:
        raise NoObject(f"nothing drawable, only {left}; explode it, or export its outline as lines")
    if left:
        notes.append(f"left out of the drawing: {left}")
    return found, tuple(notes)


class _Walk:
    """A way through the entities of a drawing that counts what it meets."""

    def __init__(self, drawing: Drawing, layer: str | None) -> None:
        self.only = None if layer is None else layer.lower()
        if layer is not None:
            _check_layer(drawing, layer)
        layers = list(drawing.layers)
        self.off = {entry.dxf.name.lower() for entry in layers if entry.is_off()}
        self.frozen = {entry.dxf.name.lower() for entry in layers if entry.is_frozen()}
        self.left: Counter[str] = Counter()
        self.hidden: set[str] = set()
        self.met = 0

    def drawn(self, entities: Any, within: str = "", depth: int = 0) -> Iterator[Any]:
        """Yield what is drawn of entities that stand in a block placed on the layer ``within``."""
        if depth > _MAX_DEPTH:
            self.left["block within itself"] += 1
            return
        for entity in entities:
            self.met += 1
            if self.met > MAX_ENTITIES:
                raise UnreadableInput(f"more than {MAX_ENTITIES} lines and curves; simplify it")
            kind, layer = entity.dxftype(), _layer(entity)
            layer = within if within and layer == "0" else layer
            if entity.dxf.get("invisible", 0):
                continue
            if self._hidden(layer, kind):
                if kind in (*KINDS, *_OPENED) and layer != _NEVER_PLOTTED:
                    self.hidden.add(layer)
                continue
            if kind in _OPENED:
                yield from self._opened(entity, layer, depth)
            elif kind in KINDS:
                if self.only is None or layer == self.only:
                    yield entity
            elif kind in _LOST:
                self.left[kind] += 1

    def _hidden(self, layer: str, kind: str) -> bool:
        if layer == _NEVER_PLOTTED and layer != self.only:
            return True
        if self.only is not None:
            return False
        return layer in self.frozen or (layer in self.off and kind != "INSERT")

    def _opened(self, entity: Any, layer: str, depth: int) -> Iterator[Any]:
        if entity.dxftype() == "MLINE":
            yield from self.drawn(entity.virtual_entities(), layer, depth + 1)
            return
        block = entity.block()
        if block is None or block.block.is_xref or block.block.is_xref_overlay:
            self.left["external reference"] += 1
            return
        if entity.mcount * max(len(block), 1) > MAX_ENTITIES:
            self.left["block of far too much"] += 1
            return
        for one in entity.multi_insert() if entity.mcount > 1 else (entity,):
            yield from self.drawn(one.virtual_entities(), layer, depth + 1)


def _check_layer(drawing: Drawing, layer: str) -> None:
    names = {entry.dxf.name.lower() for entry in drawing.layers}
    names |= {_layer(entity) for block in drawing.blocks for entity in block}
    if layer.lower() not in names:
        known = ", ".join(f"{name[:40]!a}" for name in sorted(names)[:_NAMED])
        raise UsageError(f"no `layer` {layer[:40]!a}; there are {known}")


def _layer(entity: Any) -> str:
    name: str = entity.dxf.get("layer", "0")
    return name.lower()
