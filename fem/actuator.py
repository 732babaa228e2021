"""The actuator that is modelled: a closed tube in a gauze with windows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from fem.errors import BadGeometry
from fem.gauze import AxialLines, Gauze
from fem.material import PAPER_RUBBER, Law
from fem.weight import Weight

TOWARD, AWAY = np.radians(270.0), np.radians(90.0)  # alpha_center in the bending plane
_LEAST_WRAP = 0.02  # of the diameter, between two windows
_PLANE = 1e-9  # rad


@dataclass(frozen=True)
class Window:
    """One joint: the axial threads are cut over openF, but for a sector.

    Attributes
    ----------
    centre : float
        From the clamped end, mm.
    openF : float
        Axial length of the cut, mm.
    alpha : float
        alpha_closed, extent of the uncut sector, rad.
    center : float
        alpha_center, angular position of its middle, rad.
    """

    centre: float
    openF: float
    alpha: float
    center: float = float(TOWARD)

    @property
    def start(self) -> float:
        """Edge of the cut toward the clamped end, mm."""
        return self.centre - 0.5 * self.openF

    @property
    def end(self) -> float:
        """Edge of the cut toward the closed end, mm."""
        return self.centre + 0.5 * self.openF

    @property
    def away(self) -> bool:
        """Whether the sector lies on the side away from the object."""
        return bool(np.sin(self.center) > 1e-12)


@dataclass(frozen=True)
class Actuator:
    """A tube, closed at one end, in a gauze with windows.

    Attributes
    ----------
    length : float
        From the clamped end to the closed end, mm.
    windows : tuple of Window
        In order from the clamped end.
    diameter, wall : float
        Outer diameter and thickness of the wall, mm.
    rubber : Law
    gauze : Gauze
    plug : float
        Length of the rigid closed end within ``length``, mm; air fills the rest.
    weight : Weight or None
        None leaves gravity out.
    lines : AxialLines or None
        The axial threads in the windows one by one; None for smeared sectors.

    Raises
    ------
    BadGeometry
        When no such tube can exist, or none that this model describes.
    """

    length: float
    windows: tuple[Window, ...]
    diameter: float = 20.0
    wall: float = 2.0
    rubber: Law = PAPER_RUBBER
    gauze: Gauze = field(default_factory=Gauze)
    plug: float = 1.0
    weight: Weight | None = None
    lines: AxialLines | None = None

    def __post_init__(self) -> None:
        _check(self)

    @property
    def free_length(self) -> float:
        """From the clamped end to the plug, mm."""
        return self.length - self.plug

    @property
    def radius(self) -> float:
        """Outer radius, mm."""
        return 0.5 * self.diameter

    @property
    def in_plane(self) -> bool:
        """Whether all sectors face the object or away from it, so that half the tube will do.

        Nor may gravity pull it out of the plane, or single threads lie otherwise on one side
        of it than on the other.
        """
        level = self.weight is None or self.weight.in_plane
        even = self.lines is None or self.lines.in_plane
        return level and even and all(abs(np.cos(w.center)) < _PLANE for w in self.windows)

    @property
    def wrapped(self) -> tuple[tuple[float, float], ...]:
        """Where each wrapped sector begins and ends: one more than there are windows, mm."""
        edges = [0.0]
        for window in self.windows:
            edges += [window.start, window.end]
        edges.append(self.free_length)
        return tuple(zip(edges[::2], edges[1::2], strict=True))


def chain(
    root: float, F: Sequence[float], openF: Sequence[float], alpha: Sequence[float],
    center: Sequence[float] | None = None, *, end: float = 0.0, **rest: object,
) -> Actuator:  # fmt: skip
    """Lay joints out as the paper does: F from centre to centre, the last to the tube's end.

    Parameters
    ----------
    root : float
        From the clamped end to the first joint's centre, mm.
    F, openF : sequence of float
        mm.
    alpha, center : sequence of float
        rad; by default all sectors face the object.
    end : float
        What the tube goes on beyond the last F, mm.
    **rest
        Further fields of `Actuator`.

    Returns
    -------
    Actuator

    Raises
    ------
    BadGeometry
        When no such tube can exist, or none that this model describes.
    """
    centres = root + np.concatenate([[0.0], np.cumsum(F)])
    middle = [TOWARD] * len(openF) if center is None else center
    windows = tuple(
        Window(float(c), float(o), float(a), float(m))
        for c, o, a, m in zip(centres, openF, alpha, middle, strict=False)
    )
    return Actuator(float(centres[-1] + end), windows, **rest)  # type: ignore[arg-type]


def _check(a: Actuator) -> None:
    numbers = [a.length, a.diameter, a.wall, a.plug]
    numbers += [value for w in a.windows for value in (w.centre, w.openF, w.alpha, w.center)]
    if not np.isfinite(numbers).all():
        raise BadGeometry("all sizes and angles must be finite numbers")
    if not (a.diameter > 0.0 and 0.0 < a.wall < 0.5 * a.diameter):
        raise BadGeometry(
            f"a wall of {a.wall:g} mm does not make a tube of {a.diameter:g} mm diameter"
        )
    if not 0.01 <= a.wall / a.diameter <= 0.3:
        raise BadGeometry(
            f"a wall of {a.wall:g} mm on {a.diameter:g} mm is beyond this model "
            "(1 to 30 % of the diameter)"
        )
    if not (a.plug >= 0.0 and a.free_length > 0.1 * a.diameter):
        raise BadGeometry(f"a tube of {a.length:g} mm with a plug of {a.plug:g} mm has no inside")
    if a.lines is not None and len(a.lines.angles) != len(a.windows):
        raise BadGeometry("single threads must be given for every window")
    least = _LEAST_WRAP * a.diameter
    for number, w in enumerate(a.windows, start=1):
        if not w.openF >= 0.025 * a.diameter:
            raise BadGeometry(f"joint {number}: a cut of {w.openF:g} mm is too short to model")
        if not 0.0 < w.alpha <= np.radians(330.0):
            raise BadGeometry(
                f"joint {number}: alpha_closed {np.degrees(w.alpha):g} deg is not in 0 .. 330"
            )
    if a.windows and a.windows[0].start < -1e-9:
        raise BadGeometry("joint 1 reaches beyond the clamped end")
    if a.windows and a.windows[-1].end > a.free_length + 1e-9:
        raise BadGeometry(f"joint {len(a.windows)} reaches beyond the plug")
    for number, (w, after) in enumerate(pairwise(a.windows), start=1):
        if after.start - w.end < least - 1e-9:
            raise BadGeometry(
                f"joints {number} and {number + 1} leave {after.start - w.end:g} mm of wrapped "
                f"tube between them, less than {least:g} mm"
            )
