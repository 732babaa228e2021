"""The seal of a design: the digest of all that finite elements verified.

A verified design carries the digest of all its values. Whoever says "verified" compares it: a
design that was changed afterwards is not verified, whatever it claims.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, replace
from typing import Any

from profiletool.records.design import Design
from profiletool.records.grip_request import OnObject

_DECIMALS = 6  # a nanometre; keeps the last bits of the arithmetic out of the file


def values_of(design: Design) -> dict[str, Any]:
    """Give all values of a design by name, as design.json holds them."""
    tree: dict[str, Any] = _rounded(asdict(design))
    return tree


def seal_of(design: Design) -> str:
    """Digest of all values of a design but the seal: SHA-256 of their canonical JSON."""
    values = values_of(design)
    del values["seal"]
    for name, none in (("neighbours", []), ("grip", asdict(OnObject()))):
        if values[name] == none:  # as in files from before there were any
            del values[name]
    text = json.dumps(values, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def sealed(design: Design) -> Design:
    """Seal a verified design as it is; one that is not verified has no seal."""
    return replace(design, seal=seal_of(design) if design.verified else None)


def proven(design: Design) -> bool:
    """Whether finite elements verified this very design, and nothing was changed since."""
    return design.verified and design.seal is not None and design.seal == seal_of(design)


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, _DECIMALS) + 0.0  # no "-0.0"
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_rounded(item) for item in value]
    return value
