"""Picture of the rooms of profiletool, made from the layers contract in pyproject.toml.

Run as ``python docs/rooms.py``; a test compares the picture with the contract.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

from sketches import GREY, INK, PICTURES, arrow, sheet, text

ROOT = Path(__file__).resolve().parents[1]
_WIDTH, _STEP, _BOX, _GAP = 760.0, 46.0, (128.0, 30.0), 14.0
_MIDDLE = 400.0
_FILLS = {"room": "#dcebf5", "module": "#f6eee3", "alone": "#e3efe0"}


def main() -> None:
    """Write the picture."""
    (PICTURES / "rooms.svg").write_text(rooms(layers()), encoding="utf-8", newline="\n")


def layers() -> list[list[str]]:
    """Rows of the layers contract, the highest first."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    (rows,) = (contract["layers"] for contract in contracts if contract["type"] == "layers")
    return [[name.strip() for name in row.split("|")] for row in rows]


def rooms(rows: list[list[str]]) -> str:
    """Draw the stairs: a row of boxes for each layer, and below them the two that stand alone."""
    top = 40.0
    marks = [
        text(_MIDDLE, 22, "profiletool"),
        arrow((36, top), (36, top + _STEP * len(rows) - 20)),
        _upright(22, top + 0.5 * _STEP * len(rows), "imports go down only"),
    ]
    for number, row in enumerate(rows):
        marks += _boxes(row, top + _STEP * number)
    end = top + _STEP * len(rows)
    alone = "stand alone; they know neither profiletool nor each other"
    marks.append(text(_MIDDLE, end + 16, alone, GREY))
    marks += _boxes(["fem", "formula"], end + 28, "alone")
    return sheet(_WIDTH, end + 76, *marks)


def _boxes(names: list[str], y: float, kind: str | None = None) -> list[str]:
    """Draw a row of boxes about the middle."""
    width, height = _BOX
    left = _MIDDLE - 0.5 * (len(names) * (width + _GAP) - _GAP)
    marks = []
    for number, name in enumerate(names):
        x = left + number * (width + _GAP)
        is_room = (ROOT / "profiletool" / name).is_dir()
        fill = _FILLS[kind or ("room" if is_room else "module")]
        marks.append(
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:g}" height="{height:g}" rx="4" '
            f'fill="{fill}" stroke="{INK}" stroke-width="1"/>'
        )
        marks.append(text(x + 0.5 * width, y + 20, name if is_room or kind else f"{name}.py"))
    return marks


def _upright(x: float, y: float, words: str) -> str:
    return f'<g transform="rotate(-90 {x:g} {y:g})">{text(x, y, words, GREY)}</g>'


if __name__ == "__main__":
    main()
