"""Tasks of the joint response: single joints, pairs, joints near the ends, random actuators."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from profiletool.bending.model import Chain, centers_of

PRESSURES = tuple(round(0.2 * k, 1) for k in range(1, 12))  # bar, of single joints
COARSE = (0.4, 0.8, 1.2, 1.6, 2.0)  # of several joints
CHECKED = (1.0, 1.25, 1.5, 1.75, 2.0)
PLUG_MM = 1.0
_ALPHA_DEG, _OPENF = range(72, 181, 12), range(4, 17, 2)
_GAPS = (2, 4, 7, 12, 20)
_PAIRS = (
    ((84, 8), (84, 8)), ((132, 8), (132, 8)), ((108, 12), (108, 12)),
    ((84, 12), (144, 6)), ((144, 12), (96, 6)), ((168, 8), (84, 10)),
)  # fmt: skip
_AT_ENDS, _END_GAPS = ((84, 8), (132, 8), (108, 12), (156, 6)), (1, 2, 4, 7, 12, 20)
_LONGEST_MM = 125.0


@dataclass(frozen=True)
class ResponseTask:
    """A run of an actuator for the joint response.

    Attributes
    ----------
    name : str
        Of its own in a campaign.
    chain : Chain
    pressures_bar : tuple of float
        Rising, above 0.
    """

    name: str
    chain: Chain
    pressures_bar: tuple[float, ...]


def _task(
    name: str, length: float, joints: Sequence[tuple[float, ...]], pressures_bar: tuple[float, ...]
) -> ResponseTask:
    """Task of joints (centre mm, openF mm, alpha deg, sense)."""
    centre, openF, alpha, sense = np.array(joints, dtype=float).reshape(-1, 4).T
    chain = Chain(centre, openF, np.radians(alpha), centers_of(sense), length)
    return ResponseTask(name, chain, pressures_bar)


def singles() -> list[ResponseTask]:
    """Single joints between long wrapped sectors; the first is a tube without joints."""
    grid = product(_OPENF, _ALPHA_DEG)
    alone = [_task(f"s{a}_{o}", 81.0, [(40.0, o, a, 1.0)], PRESSURES) for o, a in grid]
    return [_task("none", 80.0, [], PRESSURES), *alone]


def pairs() -> list[ResponseTask]:
    """Pairs of joints, and single joints near an end."""
    tasks = []
    for ((a1, o1), (a2, o2)), sense, gap in product(_PAIRS, (1.0, -1.0), _GAPS):
        joints = [(30.0 + o1 / 2, o1, a1, 1.0), (30.0 + o1 + gap + o2 / 2, o2, a2, sense)]
        name = f"p{a1}_{o1}_{a2}_{o2}_{sense}_{gap}"
        tasks.append(_task(name, 61.0 + o1 + gap + o2, joints, COARSE))
    for (a, o), end, gap in product(_AT_ENDS, "cp", _END_GAPS):
        centre = gap + o / 2 if end == "c" else 60.0 - gap - o / 2
        tasks.append(_task(f"e{a}_{o}_{end}_{gap}", 61.0, [(centre, o, a, 1.0)], COARSE))
    return tasks


def actuators(count: int, seed: int, pressures_bar: tuple[float, ...]) -> list[ResponseTask]:
    """Random actuators: 2 to 7 joints on both sides, gaps from 2 mm, up to 125 mm long."""
    rng = np.random.default_rng(seed)
    tasks: list[ResponseTask] = []
    while len(tasks) < count:
        n = int(rng.integers(2, 8))
        openF, alpha = 2.0 * rng.integers(2, 9, n), rng.uniform(72.0, 180.0, n)
        sense = np.where(rng.random(n) < 0.65, 1.0, -1.0)
        gap = np.minimum(2.0 + rng.exponential(6.0, n + 1), 30.0)
        gap[0] = rng.uniform(2.0, 20.0)
        length = openF.sum() + gap.sum() + PLUG_MM
        if length > _LONGEST_MM:
            continue
        centre = np.cumsum(gap[:-1] + openF) - 0.5 * openF
        joints = list(zip(centre, openF, alpha, sense, strict=True))
        name = f"r{seed}_{len(tasks)}"
        tasks.append(_task(name, round(float(length), 2), joints, pressures_bar))
    return tasks
