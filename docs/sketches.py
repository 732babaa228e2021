"""Sketches of the guide as SVG, drawn without any library.

Run as ``python docs/sketches.py``.
"""

from __future__ import annotations

from math import cos, radians, sin
from pathlib import Path

PICTURES = Path(__file__).parent / "pictures"
INK, GREY, BLUE, RED, RUBBER = "#222222", "#8a9096", "#0072b2", "#d55e00", "#f3b98c"
GAUZE = "#c9d1d6"


def main() -> None:
    """Write all sketches."""
    for name, drawn in (("joint", joint()), ("frame", frame()), ("parallax", parallax())):
        (PICTURES / f"{name}.svg").write_text(drawn, encoding="utf-8", newline="\n")


# --- marks -----------------------------------------------------------------------------------


def line(
    *points: tuple[float, float], colour: str = INK, width: float = 1.4, dash: str = ""
) -> str:
    """Draw a polyline."""
    places = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    style = f'fill="none" stroke="{colour}" stroke-width="{width}"{dashed}'
    return f'<polyline points="{places}" {style}/>'


def area(*points: tuple[float, float], fill: str, edge: str = "none") -> str:
    """Fill a polygon."""
    places = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polygon points="{places}" fill="{fill}" stroke="{edge}" stroke-width="1.2"/>'


def text(x: float, y: float, words: str, colour: str = INK, anchor: str = "middle") -> str:
    """Letter a line."""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}">{words}</text>'


def arrow(start: tuple[float, float], end: tuple[float, float], colour: str = INK,
          both: bool = False) -> str:  # fmt: skip
    """Draw a straight arrow, or one with two heads."""
    tail = ' marker-start="url(#head)"' if both else ""
    return (
        f'<line x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}" y2="{end[1]:.1f}" '
        f'stroke="{colour}" stroke-width="1.2" marker-end="url(#head)"{tail}/>'
    )


def arc(x: float, y: float, r: float, start: float, end: float) -> list[tuple[float, float]]:
    """Give points of an arc, angles in deg counter-clockwise from the right."""
    steps = [start + (end - start) * k / 60 for k in range(61)]
    return [(x + r * cos(radians(a)), y - r * sin(radians(a))) for a in steps]


def measure(x0: float, x1: float, y: float, words: str) -> str:
    """Dimension a length."""
    return arrow((x0 + 1, y), (x1 - 1, y), both=True) + text(0.5 * (x0 + x1), y - 5, words)


def sheet(width: float, height: float, *marks: str) -> str:
    """Put marks on a white sheet."""
    head = (
        '<marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
        'orient="auto-start-reverse"><path d="M0,1 L7,4 L0,7" fill="none" stroke="#222222"/>'
        "</marker>"
    )
    body = "\n".join(marks)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}" '
        f'viewBox="0 0 {width:g} {height:g}" font-family="sans-serif" font-size="13">\n'
        f'<defs>{head}</defs>\n<rect width="{width:g}" height="{height:g}" fill="#ffffff"/>\n'
        f"{body}\n</svg>\n"
    )


# --- sketches --------------------------------------------------------------------------------


def joint() -> str:
    """Draw a straight tube with two joints, its section at a cut, and a bent joint."""
    return sheet(760, 480, *_straight(), *_section(), *_bent())


def _straight() -> list[str]:
    top, bottom, start, end = 80.0, 130.0, 70.0, 690.0
    cuts = ((170.0, 230.0), (400.0, 480.0))
    marks = [area((start, top), (end, top), (end, bottom), (start, bottom), fill=GAUZE, edge=INK)]
    marks += [
        area((start - 30, top - 10), (start, top - 10), (start, bottom + 10),
             (start - 30, bottom + 10), fill="#5b646b"),
        text(start - 15, top - 18, "clamp"),
        area((end - 8, top), (end, top), (end, bottom), (end - 8, bottom), fill="#5b646b"),
        text(end, top - 8, "closed end", anchor="end"),
    ]  # fmt: skip
    for number, (left, right) in enumerate(cuts, start=1):
        middle = 0.5 * (left + right)
        marks.append(area((left, top), (right, top), (right, 117), (left, 117), fill=RUBBER))
        rows = round((right - left) / 10)
        for k in range(rows):
            x = left + (k + 0.5) * (right - left) / rows
            marks.append(line((x, top), (x, 117), colour=BLUE))
        marks.append(line((middle, 62), (middle, 178), colour=GREY, width=1.0, dash="7 3 2 3"))
        marks.append(text(middle, 54, f"joint {number}"))
        marks.append(arrow((left, 148), (right, 148), both=True))
        marks.append(text(right + 6, 152, f"openF{_low(number)}", anchor="start"))
    first, second = (0.5 * (a + b) for a, b in cuts)
    marks += [measure(start, first, 178, "Root"), measure(first, second, 178, f"F{_low(1)}")]
    marks += [measure(second, end, 178, f"F{_low(2)}")]
    marks += [line((x, 132), (x, 182), colour=GREY, width=0.8) for x in (start, end)]
    marks += [
        text(315, 100, "wrapped sector"),
        text(315, 116, "(gauze whole)"),
        text(380, 202, "the object lies on this side (270°)", colour=GREY),
    ]
    return marks


def _section() -> list[str]:
    x, y, r = 180.0, 345.0, 70.0
    half = 60.0
    ring = arc(x, y, r, 270 - half, 270 + half)
    cut = arc(x, y, r, 270 + half, 630 - half)
    inner = [(a, b) for a, b in arc(x, y, r - 14, 0, 360)]
    marks = [
        area(*arc(x, y, r - 2, 0, 360), fill=RUBBER),
        area(*inner, fill="#ffffff"),
        line(*ring, colour=INK, width=5),
        line(*cut, colour=BLUE, width=2, dash="4 4"),
        line((x, y), ring[0], colour=GREY, width=0.9),
        line((x, y), ring[-1], colour=GREY, width=0.9),
        line(*arc(x, y, 32, 270 - half, 270 + half), colour=INK, width=1.2),
        text(x, y + 24, "α"),
        arrow((x, y + 78), (x, y + 96)),
        text(x, y + 112, "alpha_center 270°: toward the object"),
        text(x, y - 84, "section at a cut, seen from the closed end"),
        text(x + 86, y - 26, "axial threads cut", colour=BLUE, anchor="start"),
        text(x + 74, y + 58, "uncut sector: α = alpha_closed", anchor="start"),
        text(x + r + 10, y + 4, "0°", colour=GREY, anchor="start"),
        text(x, y - r + 30, "90°", colour=GREY),
        text(x - r - 10, y + 4, "180°", colour=GREY, anchor="end"),
    ]
    return marks


def _bent() -> list[str]:
    """Draw one joint bent toward the object: arcs about a centre below the tube."""
    x, y, inside, outside, turn = 560.0, 420.0, 48.0, 100.0, 50.0
    start, end = 90 + turn / 2, 90 - turn / 2

    def ends(angle: float, way: float) -> list[tuple[float, float]]:
        points = []
        for r in (inside, outside):
            a, b = 75 * way * sin(radians(angle)), 75 * way * cos(radians(angle))
            points.append((x + r * cos(radians(angle)) + a, y - r * sin(radians(angle)) + b))
        return points

    left, right = ends(start, -1.0), ends(end, 1.0)
    low, high = arc(x, y, inside, start, end), arc(x, y, outside, start, end)
    wrapped = ((left, low[0], high[0]), (right, low[-1], high[-1]))
    marks = [area(*low, *reversed(high), fill=RUBBER, edge=INK)]
    for (near, far), a, b in wrapped:
        marks.append(area(near, a, b, far, fill=GAUZE, edge=INK))
    marks.append(line(*low, colour=INK, width=4))
    marks.append(line((x, y), low[0], colour=GREY, width=0.9, dash="4 3"))
    marks.append(line((x, y), low[-1], colour=GREY, width=0.9, dash="4 3"))
    marks.append(line(*arc(x, y, 26, start, end), colour=RED, width=1.6))
    marks.append(text(x, y - 32, "θ", colour=RED))
    marks.append(text(x, y - outside - 12, "the cut side opens"))
    marks.append(text(x, y + 22, "under pressure: θ > 0 toward the object"))
    return marks


def _low(number: int) -> str:
    """Give a number as a subscript."""
    return f'<tspan font-size="10" dy="3">{number}</tspan>'


def frame() -> str:
    """Draw the object frame, the profile and the tube's base."""
    x, y, r = 420.0, 90.0, 88.0
    left = [(a, b) for a, b in arc(x, y + r, r, 90, 215)]
    neck = [(x - 46, y + 190), (x - 40, y + 215), (x - 40, y + 270)]
    side = [*left, *neck]
    whole = [*side, *[(2 * x - a, b) for a, b in reversed(side)]]
    tube = [(x + 2, y), (x - 300, y), (x - 300, y - 50), (x + 2, y - 50)]
    return sheet(
        640, 400,
        area(*whole, fill="#eef1f3", edge=GREY),
        line(*side, colour=INK, width=3),
        area(*tube, fill="none", edge=GREY),
        text(x - 150, y - 20, "tube at rest", colour=GREY),
        arrow((x, y), (x + 90, y)), text(x + 100, y + 4, "x", anchor="start"),
        arrow((x, y), (x, y - 78)), text(x + 8, y - 72, "y", anchor="start"),
        '<circle cx="420" cy="90" r="4" fill="#d55e00"/>',
        text(x + 12, y + 20, "origin: top middle, 0 %", colour=RED, anchor="start"),
        text(x - 52, y + 292, "end of the side, 100 %", colour=RED),
        '<circle cx="380" cy="360" r="4" fill="#d55e00"/>',
        arrow((x - 104, y + 66), (x - 108, y + 110)),
        text(x - 118, y + 84, "profile of the left side:", anchor="end"),
        text(x - 118, y + 102, "arc length s from the top down", anchor="end"),
        arrow((x - 60, y - 8), (x - 130, y - 8), colour=INK),
        text(x - 150, y + 22, "heading of the base: 180°", anchor="end"),
        line((x - 152, y + 16), (x - 118, y - 4), colour=GREY, width=0.8),
    )  # fmt: skip


def parallax() -> str:
    """Draw a camera over the sheet and a round object that lies on it."""
    ground, eye, x, r = 330.0, (320.0, 40.0), 320.0, 52.0
    cy = ground - r
    # Tangents from the camera to the circle, and where they meet the sheet.
    distance = cy - eye[1]
    half = r / (1.0 - (r / distance) ** 2) ** 0.5 * (ground - eye[1]) / distance
    return sheet(
        640, 370,
        line((60, ground), (580, ground), width=2.5),
        text(66, ground + 20, "printed sheet", anchor="start"),
        f'<circle cx="{x}" cy="{cy}" r="{r}" fill="#eef1f3" stroke="{INK}" stroke-width="1.4"/>',
        area((eye[0] - 18, eye[1] - 24), (eye[0] + 18, eye[1] - 24), (eye[0] + 18, eye[1]),
             (eye[0] - 18, eye[1]), fill="#5b646b"),
        text(eye[0] + 28, eye[1] - 6, "camera", anchor="start"),
        line(eye, (x - half, ground), colour=RED, dash="5 3"),
        line(eye, (x + half, ground), colour=RED, dash="5 3"),
        line((x - half, ground), (x + half, ground), colour=RED, width=5),
        text(x, ground + 20, "seen width on the sheet: too large", colour=RED),
        arrow((x - r, cy), (x + r, cy), both=True), text(x, cy - 6, "true width"),
        arrow((120, eye[1]), (120, ground), both=True), text(110, 190, "H", anchor="end"),
        arrow((470, cy), (470, ground), both=True), text(480, cy + 30, "t", anchor="start"),
        line((x, cy), (478, cy), colour=GREY, width=0.8, dash="4 3"),
        line((112, eye[1]), (eye[0] - 18, eye[1]), colour=GREY, width=0.8, dash="4 3"),
    )  # fmt: skip


if __name__ == "__main__":
    main()
