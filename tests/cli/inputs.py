"""Inputs of commands, and finite elements that fail on purpose."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageDraw

from tests.calls import Result, call

REST = "finger_rest.csv"


@dataclass(frozen=True)
class Made:
    """A design's folder, and what the command printed."""

    folder: Path
    result: Result


def unverified(*arguments: object) -> Result:
    """Design without finite elements, where they are not the point."""
    return call("design", *arguments, "--no-verify")


def arc(folder: Path) -> Path:
    """Draw a quarter of a circle of 30 mm, which one or two joints follow."""
    angle = np.linspace(0.0, 0.5 * np.pi, 60)
    points = 30.0 * np.column_stack([-np.sin(angle), np.cos(angle)])
    np.savetxt(folder / "arc.csv", points, delimiter=",", fmt="%.4f")
    return folder / "arc.csv"


def picture(path: Path, *, blank: bool = False, **save: object) -> Path:
    image = Image.new("RGB", (300, 400), (235, 232, 228))
    if not blank:
        ImageDraw.Draw(image).ellipse((70, 60, 230, 330), fill=(120, 60, 40))
    image.save(path, **save)
    return path


def ending_early(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every FE run meet a limit point half-way."""
    import fem
    from profiletool.verify import run

    solve = run.solve

    def stopped(*arguments: object, **options: object) -> fem.Solution:
        found = solve(*arguments, **options)
        middle = len(found.states) // 2
        ended = fem.Critical("limit point", found.states[middle].pressure)
        return replace(found, states=found.states[:middle], critical=ended)

    monkeypatch.setattr(run, "solve", stopped)


def never_converging(monkeypatch: pytest.MonkeyPatch) -> None:
    from fem.errors import NotConverged

    def fails(*_: object, **__: object) -> None:
        raise NotConverged("inverted at 0.010 bar", (), 0.001)

    for module in ("run", "forward"):
        monkeypatch.setattr(f"profiletool.verify.{module}.solve", fails)
