"""Inputs of finite elements: the paper's model, and what may be taken in its place."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from profiletool.errors import UsageError

PAPER_NU, PAPER_SECTOR_DEG = 0.46, 6.0
_DOWN_DEG = {"down": 270.0, "up": 90.0}
_MOST_NU, _MOST_SECTOR_DEG, _FACTORS = 0.4999, 30.0, (0.01, 100.0)


@dataclass(frozen=True)
class ModelInputs:
    """What finite elements take; the defaults are the paper's.

    Attributes
    ----------
    nu : float or None
        Poisson's ratio of the rubber at small strain; None for the rubber's own, which is 0.46
        for the paper's. The shear modulus stays.
    thread_factor : float
        Stiffness of a thread over that of the paper's polyamide of the same diameter.
    sector_extra_deg : float
        By how much the smeared uncut sector is wider than alpha_closed: what the threads at both
        its ends stand for.
    gravity : str
        Where gravity pulls, in the frame of the object: "none", "down" where the object stands
        as in its picture, "up" where it hangs upside down, "level" where it lies and the tube
        hangs from its underside, or an angle in deg, counter-clockwise from the right.
    """

    nu: float | None = None
    thread_factor: float = 1.0
    sector_extra_deg: float = PAPER_SECTOR_DEG
    gravity: str = "none"

    def pull(self, sign: float) -> tuple[float, float] | None:
        """Give the unit vector of gravity in the object's frame (y up); None without gravity.

        Parameters
        ----------
        sign : float
            +1 for a tube on the object's left side, -1 on the right.

        Raises
        ------
        UsageError
            Where ``gravity`` is no direction.
        """
        if self.gravity == "none":
            return None
        if self.gravity == "level":
            return -sign, 0.0
        angle = math.radians(_degrees(self.gravity))
        return math.cos(angle), math.sin(angle)

    def __str__(self) -> str:
        """Say what is not the paper's; empty where all is."""
        return ", ".join(_changes(self))


PAPER_MODEL = ModelInputs()


def check_model(model: ModelInputs) -> None:
    """Refuse inputs that no finite elements can be run with.

    Raises
    ------
    UsageError
    """
    if model.nu is not None and not 0.0 <= model.nu <= _MOST_NU:
        raise UsageError(f"`nu` must be 0 to {_MOST_NU:g}, not {model.nu:g}")
    low, high = _FACTORS
    if not low <= model.thread_factor <= high:
        raise UsageError(
            f"`thread_factor` must be {low:g} to {high:g}, not {model.thread_factor:g}"
        )
    if not 0.0 <= model.sector_extra_deg <= _MOST_SECTOR_DEG:
        raise UsageError(
            f"`sector_extra_deg` must be 0 to {_MOST_SECTOR_DEG:g}, not {model.sector_extra_deg:g}"
        )
    model.pull(1.0)


def _degrees(text: str) -> float:
    if text in _DOWN_DEG:
        return _DOWN_DEG[text]
    try:
        angle = float(text)
    except ValueError:
        angle = math.nan
    if not abs(angle) <= 360.0:
        raise UsageError(
            f"`gravity` must be none, down, up, level or an angle in deg, not {text!r}"
        )
    return angle


def _changes(model: ModelInputs) -> Iterator[str]:
    if model.nu is not None:
        yield f"Poisson's ratio {model.nu:g}"
    if model.thread_factor != PAPER_MODEL.thread_factor:
        yield f"threads {model.thread_factor:g} times as stiff"
    if model.sector_extra_deg != PAPER_MODEL.sector_extra_deg:
        yield f"sectors {model.sector_extra_deg:g} deg wider than alpha"
    if model.gravity != PAPER_MODEL.gravity:
        yield f"gravity {model.gravity}"
