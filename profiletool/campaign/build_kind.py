"""Runs of single builds with errors of their own: tasks, keys, outcomes and files."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from profiletool.campaign.keys import key_of, seal, unseal
from profiletool.campaign.kind import RunKind
from profiletool.records.design import Design
from profiletool.verify.sample import BuildDraw, SampledBuild, run_draw

SCHEMA = "profiletool.build/1"  # to be raised where `run` reads other numbers off a solution


@dataclass(frozen=True)
class BuildTask:
    """One build of a design.

    Attributes
    ----------
    design : Design
    points : tuple of (x, y)
        Of the profile, mm, evenly spaced.
    draw : BuildDraw
    """

    design: Design
    points: tuple[tuple[float, float], ...]
    draw: BuildDraw


def run(task: BuildTask) -> SampledBuild:
    """Run finite elements of one build."""
    return run_draw(task.design, task.draw, np.array(task.points))


def key(task: BuildTask) -> str:
    """Name a run by all that its outcome depends on, the model's own source files included."""
    return key_of({"schema": SCHEMA, **asdict(task)})


def to_json(found: SampledBuild) -> bytes:
    """Write an outcome to the last bit, with a checksum; what is not known is null."""
    tree = asdict(found)
    if found.failure is not None:
        tree |= {"as_set_mm": None, "trimmed_mm": None}
    return seal(SCHEMA, tree)


def from_json(data: bytes) -> SampledBuild:
    """Read what `to_json` wrote, and nothing else.

    Raises
    ------
    ValueError
        When a single byte is not as it was written.
    """
    body: Any = unseal(SCHEMA, data)
    try:
        numbers = (body["as_set_mm"], body["trimmed_mm"])
        as_set, trimmed = (np.nan if number is None else float(number) for number in numbers)
        return SampledBuild(as_set, trimmed, body["failure"])
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError("this is no run of a build") from error


def _order(task: BuildTask) -> float:
    """Sort key: all take as long."""
    return 0.0


def _died(task: BuildTask) -> SampledBuild:
    return SampledBuild(np.nan, np.nan, "its process died")


BUILD_RUN = RunKind(run, key, _order, _died, to_json, from_json)
