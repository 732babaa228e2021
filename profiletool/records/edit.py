"""A change of a design by hand."""

from __future__ import annotations

import math
from dataclasses import dataclass

from profiletool.errors import UsageError

# Words of a change, as the command line takes them, and the fields that they are for.
_WORDS = {
    "alpha": "alpha_deg", "openF": "openF_mm", "move": "move_mm", "center": "alpha_center_deg",
}  # fmt: skip


@dataclass(frozen=True)
class Edit:
    """A change by hand; None leaves a number as it is.

    Attributes
    ----------
    joint : int or None
        Its number; None where the pressure alone is changed.
    alpha_deg, openF_mm : float or None
    move_mm : float or None
        By which the joint moves along the tube, toward the closed end; its neighbours stay.
    pressure_bar : float or None
    alpha_center_deg : float or None
        270 bends toward the object, 90 away from it.
    """

    joint: int | None = None
    alpha_deg: float | None = None
    openF_mm: float | None = None
    move_mm: float | None = None
    pressure_bar: float | None = None
    alpha_center_deg: float | None = None

    def __str__(self) -> str:
        """Write the change of the joint as `edit_of` reads it, to the last digit."""
        given = [(word, getattr(self, field)) for word, field in _WORDS.items()]
        numbers = ",".join(f"{word}={value!r}" for word, value in given if value is not None)
        return f"{self.joint}:{numbers}"


def edit_of(text: str) -> Edit:
    """Read a change of a joint, such as "3:alpha=103,openF=8,move=-2,center=90".

    Raises
    ------
    UsageError
    """
    number, _, rest = text.partition(":")
    values: dict[str, float] = {}
    try:
        joint = int(number)
        for part in rest.split(","):
            word, _, value = part.partition("=")
            field = _WORDS[word.strip()]
            if field in values or not math.isfinite(float(value)):
                raise ValueError
            values[field] = float(value)
    except (ValueError, KeyError) as error:
        raise UsageError(
            f"expected a change such as 3:alpha=103,openF=8,move=-2,center=90, not {text!r}"
        ) from error
    return Edit(joint, **values)
