"""The law of a rubber by name and constants, as formula and design files hold it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

Constants = Mapping[str, float | tuple[float, ...]]
_OLDER = {"C10_MPa": "C10", "C01_MPa": "C01", "K_MPa": "K"}  # of files that know one law only


@dataclass(frozen=True)
class RubberLaw:
    """A rubber's name, its law and the law's constants.

    Attributes
    ----------
    name : str
        Of the rubber.
    law : str
        "mooney-rivlin", "neo-hooke", "yeoh", "ogden"; see `fem.material.law`.
    constants : mapping of str to float or tuple of float
        MPa but for exponents.
    """

    name: str
    law: str
    constants: Mapping[str, float | tuple[float, ...]]


def read_rubber(tree: Mapping[str, Any]) -> RubberLaw:
    """Read a rubber as a file holds it; older files hold C10_MPa, C01_MPa and K_MPa.

    Parameters
    ----------
    tree : mapping
        {"name": ..., "law": ..., "constants": {...}}.

    Returns
    -------
    RubberLaw

    Raises
    ------
    ValueError
        A part is missing, or a constant is no finite number.
    """
    law, constants = tree.get("law"), tree.get("constants")
    if law is None and constants is None:
        law, constants = "mooney-rivlin", {new: tree.get(old) for old, new in _OLDER.items()}
    if not isinstance(law, str) or not isinstance(constants, Mapping):
        raise ValueError('a rubber has a "law" and its "constants"')
    values = {str(key): _value(str(key), value) for key, value in constants.items()}
    return RubberLaw(str(tree.get("name", "")), law, values)


def _value(key: str, value: object) -> float | tuple[float, ...]:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return tuple(_number(key, entry) for entry in value)
    return _number(key, value)


def _number(key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f'"{key}" is not a finite number')
    return float(value)
