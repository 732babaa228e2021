"""Runs for the joint response: from an actuator to its lines, with keys and files."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem.actuator import Actuator, Window
from fem.errors import NotConverged
from profiletool.bending.model import Chain
from profiletool.campaign.keys import key_of, seal, unseal
from profiletool.campaign.kind import RunKind
from profiletool.campaign.response_fit import BASE, SIGN, Lines
from profiletool.campaign.response_tasks import PLUG_MM, ResponseTask
from profiletool.records.units import BAR_PER_MPA
from profiletool.verify.run import inflate, reason, shortly

SCHEMA = "profiletool.response_run/1"  # to be raised where `run` reads other numbers off a solution
_CHAIN = ("centre", "openF", "alpha", "alpha_center")
_LINES = ("pressure", "along", "facing", "far")


def run(task: ResponseTask) -> Lines:
    """Run finite elements, as far as they go; without states where they do not even begin."""
    chain = task.chain
    windows = tuple(
        Window(*(float(number) for number in joint))
        for joint in zip(chain.centre, chain.openF, chain.alpha, chain.alpha_center, strict=True)
    )
    actuator = Actuator(chain.length, windows, plug=PLUG_MM)
    try:
        found = inflate(actuator, task.pressures_bar, BASE, SIGN, threads=1).verification
    except NotConverged as error:
        return _no_lines(task, shortly(error))
    ended = reason(found) or None
    shapes = [state.shape for state in found.states]
    if not shapes:
        return _no_lines(task, ended)
    return Lines(
        name=task.name,
        chain=chain,
        pressure=np.array(found.pressures_bar) / BAR_PER_MPA,
        along=found.rest.shape.along,
        facing=np.array([shape.facing for shape in shapes]),
        far=np.array([shape.far for shape in shapes]),
        ended=ended,
    )


def _no_lines(task: ResponseTask, ended: str | None) -> Lines:
    none, no_line = np.empty(0), np.empty((0, 0, 2))
    return Lines(task.name, task.chain, none, none, no_line, no_line, ended)


def _died(task: ResponseTask) -> Lines:
    return _no_lines(task, "its process died")


def key(task: ResponseTask) -> str:
    """Name a run by all that its lines depend on, the model's own source files included."""
    return key_of(
        {
            "schema": SCHEMA,
            "name": task.name,
            "chain": _chain_tree(task.chain),
            "pressures_bar": [float(p) for p in task.pressures_bar],
            "plug_mm": PLUG_MM,
        }
    )


def _order(task: ResponseTask) -> float:
    """Sort key that puts the longest tubes first."""
    return -task.chain.length


def to_json(lines: Lines) -> bytes:
    """Write lines to the last bit, with a checksum; the same lines give the same bytes."""
    values = {name: getattr(lines, name).tolist() for name in _LINES}
    chain = _chain_tree(lines.chain)
    return seal(SCHEMA, {"name": lines.name, "chain": chain, "ended": lines.ended, **values})


def from_json(data: bytes) -> Lines:
    """Read what `to_json` wrote, and nothing else.

    Raises
    ------
    ValueError
        When a single byte is not as it was written.
    """
    body: Any = unseal(SCHEMA, data)
    try:
        pressure, along = (np.array(body[name], dtype=float) for name in ("pressure", "along"))
        facing, far = (
            np.array(body[name], dtype=float).reshape(len(pressure), len(along), 2)
            for name in ("facing", "far")
        )
        tree = body["chain"]
        centre, openF, alpha, alpha_center = (np.array(tree[name], dtype=float) for name in _CHAIN)
        chain = Chain(centre, openF, alpha, alpha_center, tree["length"])
        return Lines(body["name"], chain, pressure, along, facing, far, body["ended"])
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError("this is no run of lines") from error


def _chain_tree(chain: Chain) -> dict[str, object]:
    joints = {name: getattr(chain, name).tolist() for name in _CHAIN}
    return {**joints, "length": float(chain.length)}


RESPONSE_RUN = RunKind(run, key, _order, _died, to_json, from_json)
