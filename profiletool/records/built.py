"""The errors that a build may have, and the misfit to expect of the actuator that is built."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields

from profiletool.errors import UsageError

_HALF_WIDTH_TO_SIGMA = 1.0 / math.sqrt(3.0)  # standard deviation of a uniform distribution


@dataclass(frozen=True)
class BuildErrors:
    """Errors of a build, each uniform within plus and minus its bound; 0 leaves one out.

    Pressure, rubber and wall are errors of the whole actuator; every joint has a thread, a cut and
    a place error of its own.

    Attributes
    ----------
    pressure : float, bar
        Of the pressure as it is set.
    thread : float
        Threads more or less uncut in a sector.
    rubber : float, %
        Of the rubber's stiffness, as from batch to batch.
    wall : float, %
        Of the wall's thickness.
    cut : float, mm
        Of the length of a cut.
    place : float, mm
        Of a joint's place along the tube.
    """

    pressure: float = 0.02
    thread: float = 0.5
    rubber: float = 10.0
    wall: float = 3.0
    cut: float = 1.0
    place: float = 0.5

    def __str__(self) -> str:
        """As the option `build` takes it."""
        return ",".join(f"{name}={bound:g}" for name, bound in asdict(self).items())

    @property
    def none(self) -> bool:
        """Whether nothing is ever off."""
        return not any(asdict(self).values())

    def sigma(self, name: str) -> float:
        """Give the standard deviation of an error, in the unit of its bound."""
        return _HALF_WIDTH_TO_SIGMA * float(getattr(self, name))


_MOST = {"pressure": 1.0, "thread": 5.0, "rubber": 50.0, "wall": 50.0, "cut": 10.0, "place": 10.0}


def build_errors(given: BuildErrors | Mapping[str, float] | str) -> BuildErrors:
    """Read the errors of a build; what is not named has its default.

    Parameters
    ----------
    given : BuildErrors, mapping or str
        Bounds by name, or as text: "thread=0.5,rubber=3".

    Raises
    ------
    UsageError
        Naming the part that makes no sense.
    """
    if isinstance(given, BuildErrors):
        given = asdict(given)
    elif isinstance(given, str):
        given = _parsed(given)
    names = [field.name for field in fields(BuildErrors)]
    for name, bound in given.items():
        if name not in names:
            raise UsageError(f"`build` knows no error {name!r}; there are {', '.join(names)}")
        number = isinstance(bound, int | float) and not isinstance(bound, bool)
        if not (number and 0.0 <= bound <= _MOST[name]):
            raise UsageError(f"`build`: {name} must be 0 to {_MOST[name]:g}, not {bound}")
    return BuildErrors(**{name: float(bound) for name, bound in given.items()})


def _parsed(text: str) -> dict[str, float]:
    bounds: dict[str, float] = {}
    for part in filter(None, (part.strip() for part in text.split(","))):
        name, _, bound = part.partition("=")
        try:
            bounds[name.strip()] = float(bound)
        except ValueError:
            raise UsageError(
                f'`build` takes bounds like "thread=0.5,rubber=3", not {part!r}'
            ) from None
    return bounds


@dataclass(frozen=True)
class BuiltMisfit:
    """A misfit of the built actuator, mm RMS; None where it is not computed.

    Attributes
    ----------
    as_set : float or None
        At the planned pressure.
    trimmed : float or None
        After the pressure was set once, so that this actuator fits best.
    in_contact : float or None
        Against its object.
    """

    as_set: float | None
    trimmed: float | None
    in_contact: float | None = None


def mm_text(value: float | None, decimals: int = 2) -> str:
    """Write a misfit in mm, or a dash where it is not computed."""
    return "–" if value is None else f"{value:.{decimals}f}"


@dataclass(frozen=True)
class BuiltPart:
    """The share of one error in the misfit of the built actuator, mm RMS: one sigma of it.

    Attributes
    ----------
    what : str
        A field of `BuildErrors`.
    as_set, trimmed : float
        Before and after the pressure was set on the finished actuator.
    """

    what: str
    as_set: float
    trimmed: float


@dataclass(frozen=True)
class Built:
    """The misfit to expect of the actuator that is built, to first order in its errors.

    Attributes
    ----------
    build : BuildErrors
    expected_rms_mm : BuiltMisfit
        Root of the mean square over all builds, the nominal misfit included.
    p95_rms_mm : BuiltMisfit
        RMS that 95 % of all builds keep.
    parts : tuple of BuiltPart
    """

    build: BuildErrors
    expected_rms_mm: BuiltMisfit
    p95_rms_mm: BuiltMisfit
    parts: tuple[BuiltPart, ...]


@dataclass(frozen=True)
class SectorThreads:
    """The axial threads that stay whole at a joint, in one turn of the gauze.

    Attributes
    ----------
    joint, turn : int
        Numbers, from 1; the first turn is the inner one.
    uncut : int
        How many threads stay whole.
    phase_deg : float
        Angle on the tube from the start of the uncut sector to the first of them; 0 where there
        is none.
    """

    joint: int
    turn: int
    uncut: int
    phase_deg: float


@dataclass(frozen=True)
class TrimPoint:
    """Where the finished actuator stands at a pressure, with nominal parts.

    Attributes
    ----------
    pressure_bar : float
    tip_mm : (x, y)
        End of the object-facing line, in the object's frame.
    theta_deg : tuple of float
        Of every joint, with the sign that it has in tables: - where it bends away.
    """

    pressure_bar: float
    tip_mm: tuple[float, float]
    theta_deg: tuple[float, ...]
