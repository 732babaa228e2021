"""Drawings as SVG in mm, one group per layer."""

from __future__ import annotations

from xml.sax.saxutils import escape

from profiletool.template.drawing import COLOURS, Drawing, Layer, Line

MARGIN_MM = 5.0
HAIRLINE_MM = 0.1


def write_svg(drawing: Drawing) -> str:
    """Return an SVG document of ``drawing``: user unit and page in mm, y turned downward."""
    x0, y0, x1, y1 = drawing.bounds
    left, top = x0 - MARGIN_MM, y1 + MARGIN_MM
    width, height = x1 - x0 + 2 * MARGIN_MM, y1 - y0 + 2 * MARGIN_MM
    head = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<svg xmlns="http://www.w3.org/2000/svg" '
        'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" '
        f'width="{_number(width)}mm" height="{_number(height)}mm" '
        f'viewBox="0 0 {_number(width)} {_number(height)}">\n'
        f"<title>{escape(drawing.title)}</title>\n"
    )
    return head + "".join(_group(layer, left, top) for layer in drawing.layers) + "</svg>\n"


def _group(layer: Layer, left: float, top: float) -> str:
    """Return one layer; page coordinates are (x - left, top - y)."""
    shapes = "".join(
        f'<{"polygon" if line.closed else "polyline"} points="{_points(line, left, top)}"/>\n'
        for line in layer.lines
    )
    return (
        f'<g id="{layer.name}" inkscape:groupmode="layer" inkscape:label="{layer.name}" '
        f'fill="none" stroke="{COLOURS[layer.name][1]}" stroke-width="{HAIRLINE_MM}" '
        f'stroke-linecap="round" stroke-linejoin="round">\n{shapes}</g>\n'
    )


def _points(line: Line, left: float, top: float) -> str:
    return " ".join(f"{_number(x - left)},{_number(top - y)}" for x, y in line.points.tolist())


def _number(value: float) -> str:
    """Return ``value`` to a tenth of a micrometre, without needless zeros."""
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text in {"", "-0"} else text
