"""Columns of a uniaxial test: which are stretch and stress, and in what units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from profiletool.errors import UnreadableInput
from profiletool.files.columns import NUMBER, shown
from profiletool.records.units import FloatArray

MPA_PER = {
    "mpa": 1.0, "n/mm2": 1.0, "mn/m2": 1.0, "kpa": 1e-3, "kn/m2": 1e-3, "hpa": 1e-4, "pa": 1e-6,
    "n/m2": 1e-6, "n/cm2": 1e-2, "gpa": 1e3, "bar": 0.1, "mbar": 1e-4, "atm": 0.101325,
    "psi": 6.894757e-3, "lbf/in2": 6.894757e-3, "lb/in2": 6.894757e-3, "ksi": 6.894757,
    "kgf/cm2": 0.0980665, "kg/cm2": 0.0980665, "kp/cm2": 0.0980665, "kgf/mm2": 9.80665,
    "kg/mm2": 9.80665, "kp/mm2": 9.80665, "dyn/cm2": 1e-7,
}  # fmt: skip
_FORCES = ("n", "kn", "mn", "kgf", "kg", "gf", "g", "lbf", "lb")
_FRACTIONS = ("", "-", "1", "mm/mm", "m/m", "in/in", "cm/cm")
_PERCENT = ("%", "percent", "pct")
_TRUE = re.compile("true|cauchy")
_LOGARITHMIC = re.compile(r"\b(?:log|ln|logarithmic|hencky|true)\b|^le$")
_NAMES = re.compile(
    r"stretch|lambda|strain|stress|nominal|engineering|eng\b|tensile|uniaxial|true|cauchy|"
    r"log(?:arithmic)?|hencky|first|piola|kirchhoff|pk1|ratio|extension"
)
_BACK = 0.02  # of the range of the stretch: a turn, not scatter
_LEAST_RUN = 5  # points of a run, on average
_NEEDED = (
    'the header must name one column "stretch" or "strain" and one "stress_MPa" or '
    '"stress_kPa", nominal (force over the cross-section before the test), not true stress'
)


@dataclass(frozen=True)
class Columns:
    """Where a line holds what; without a header it holds nothing else.

    ``fields`` is how many there are, 0 for at least those that count; a stretch is ``offset`` and
    the number times ``share``, or where ``logarithmic`` its exponential.
    """

    stretch: int = 0
    stress: int = 1
    fields: int = 2
    offset: float = 0.0
    share: float = 1.0
    logarithmic: bool = False
    unit_MPa: float = 1.0

    def row(self, fields: Sequence[str], number: int) -> tuple[float, float]:
        """Stretch and nominal stress, MPa, of a line."""
        most = max(self.stretch, self.stress)
        if len(fields) <= most or (self.fields and len(fields) != self.fields):
            raise UnreadableInput(
                f"line {number} holds {len(fields)} fields, not {self.fields or most + 1}; "
                "give stretch and nominal stress in MPa"
            )
        values: list[float] = []
        for field in (fields[self.stretch], fields[self.stress]):
            value = float(field) if NUMBER.fullmatch(field) else np.nan
            if not np.isfinite(value):
                raise UnreadableInput(
                    f"line {number}: {shown(field)} is no finite number; "
                    "give stretch and nominal stress in MPa"
                )
            values.append(value)
        along = values[0] * self.share
        stretch = float(np.exp(min(along, 50.0))) if self.logarithmic else along + self.offset
        return stretch, values[1] * self.unit_MPa


def columns_of(names: Sequence[str], units: Sequence[str] = ()) -> Columns | None:
    """Find the columns by a header's names, and by the units of a line of their own.

    Returns
    -------
    Columns or None
        None where the names tell of no test.

    Raises
    ------
    UnreadableInput
        A unit that is not known, or one of force.
    """
    heads = [name.strip("\"' ").lower() for name in names]
    stresses = [n for n, h in enumerate(heads) if "stress" in h and not _TRUE.search(h)]
    strains = [n for n, h in enumerate(heads) if re.search("stretch|lambda|strain", h)]
    strains = [n for n in strains if n not in stresses]
    plain = [n for n in strains if not _LOGARITHMIC.search(heads[n].replace("_", " "))]
    along = plain or strains
    across = [n for n in stresses if n not in along]
    if len(along) != 1 or len(across) != 1:
        return None
    units = [unit.strip("\"'()[] ").lower() for unit in units] or [""] * len(heads)
    n, k = along[0], across[0]
    return Columns(
        stretch=n,
        stress=k,
        fields=0,
        offset=1.0 if "strain" in heads[n] else 0.0,
        share=_share(_unit(heads[n]) or units[n], heads[n]),
        logarithmic=not plain,
        unit_MPa=_mpa(_unit(heads[k]) or units[k]),
    )


def needs_header() -> UnreadableInput:
    """Error of a header that tells of no test."""
    return UnreadableInput(_NEEDED)


def _unit(head: str) -> str:
    """Give the unit that a name holds: in brackets, after a slash, or what is left of its words."""
    inside = re.search(r"[\[(]([^\[\]()]*)[\])]", head)
    if inside is not None:
        return inside[1].strip()
    left = _NAMES.sub(" ", head.replace("_", " ").replace(",", " "))
    return left.strip(" /:;.-")


def _share(unit: str, head: str) -> float:
    if unit in _PERCENT or "%" in head or "percent" in head:
        return 0.01
    if unit in _FRACTIONS or not re.search("[a-z]", unit):
        return 1.0
    if re.fullmatch(r"(?:mm|cm|m|in|inch)", unit):
        raise UnreadableInput(
            f"the strain is given in {shown(unit)}: a length; give the strain, or the stretch"
        )
    return 1.0


def _mpa(unit: str) -> float:
    plain = re.sub(r"[\s^*.]", "", unit).replace("²", "2").replace("sq", "")
    if plain in MPA_PER:
        return MPA_PER[plain]
    if plain in _FORCES:
        raise UnreadableInput(
            f"the header gives {shown(unit)}, a force; divide it by the cross-section before the "
            "test"
        )
    if plain and ("/" in plain or re.search("pa$|psi|bar$", plain)):
        raise UnreadableInput(
            f"the header gives the stress in {shown(unit)}, which is not known; convert it to MPa"
        )
    return 1.0


def first_loading(stretch: FloatArray) -> list[int]:
    """Find the first loading of a test that was run to and fro; all points of any other.

    Loading leads away from stretch 1, in tension or in compression; the first of either counts. A
    table in any order, which turns at every other point, is taken whole.

    Parameters
    ----------
    stretch : (n,)
        In the order of the test.
    """
    everything = list(range(len(stretch)))
    reach = float(np.ptp(stretch)) if len(stretch) else 0.0
    turns, extreme, rising = [0], 0, True
    for n in everything:
        ahead = stretch[n] - stretch[extreme] if rising else stretch[extreme] - stretch[n]
        if ahead > 0.0:  # of points alike the first: unloading may start at the same stretch
            extreme = n
        elif -ahead > _BACK * reach:
            turns.append(extreme)
            extreme, rising = n, not rising
    turns = sorted({*turns, len(stretch) - 1})
    runs = [range(a, b + 1) for a, b in pairwise(turns) if b > a]
    if len(runs) < 2 or len(runs) > max(2, len(stretch) // _LEAST_RUN):
        return everything
    rests = [int(run[np.argmin(np.abs(stretch[run] - 1.0))]) for run in runs]
    parts = sorted({*turns, *rests})
    runs = [range(a, b + 1) for a, b in pairwise(parts)]
    away = [run for run in runs if abs(stretch[run[-1]] - 1.0) > abs(stretch[run[0]] - 1.0)]
    kept: list[int] = []
    for tension in (False, True):
        kept += next((list(run) for run in away if (stretch[run[-1]] > 1.0) == tension), [])
    return sorted(kept) or everything
