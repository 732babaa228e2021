"""The laws by name, as files hold them: {"law": name, "constants": {...}}."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import Any

from fem.material.ogden import Ogden
from fem.material.protocol import Constant, Law
from fem.material.rubbers import MooneyRivlin, NeoHooke, Yeoh

LAWS: Mapping[str, type[MooneyRivlin | NeoHooke | Yeoh | Ogden]] = {
    MooneyRivlin.name: MooneyRivlin,
    NeoHooke.name: NeoHooke,
    Yeoh.name: Yeoh,
    Ogden.name: Ogden,
}


def law(name: str, constants: Mapping[str, float | Sequence[float]]) -> Law:
    """Give the law of a name and its constants.

    Parameters
    ----------
    name : str
        One of `LAWS`.
    constants : mapping
        What the law's ``constants`` gives, MPa but for exponents; ``nu``, Poisson's ratio at
        small strain, may take the place of ``K``.

    Returns
    -------
    Law
        One of the records in `LAWS`.

    Raises
    ------
    ValueError
        When there is no such law, a constant is missing, unknown or no finite number, or no such
        rubber can exist.
    """
    if name not in LAWS:
        raise ValueError(f'there is no law "{name}"; there are {", ".join(LAWS)}')
    made = LAWS[name]
    by_nu = "nu" in constants
    kinds = {f.name if f.name != "K" or not by_nu else "nu": str(f.type) for f in fields(made)}
    if set(kinds) != set(constants):
        raise ValueError(
            f"{name} takes {', '.join(kinds)} (nu or K), not {', '.join(constants) or 'nothing'}"
        )
    make: Callable[..., Law] = made.from_poisson if by_nu else made
    return make(*(_value(f"{name}: {key}", constants[key], kinds[key]) for key in kinds))


def _value(what: str, value: Any, kind: str) -> Constant:
    if kind == "float":
        return _number(what, value)
    if not isinstance(value, Sequence) or isinstance(value, str):
        raise ValueError(f"{what} must be a list of numbers, not {value!r}")
    return tuple(_number(what, entry) for entry in value)


def _number(what: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{what} must be a finite number, not {value!r}")
    return float(value)
