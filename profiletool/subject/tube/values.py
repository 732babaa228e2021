"""A fitted tube: its values, what else tells of them, and the fit itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.records.units import BoolArray, FloatArray, IntArray
from profiletool.subject.tube.camera import Place
from profiletool.subject.tube.family import Family, Outline


@dataclass(frozen=True)
class Tube:
    """What is fitted: all that says where a tube lies and how it is bent.

    Attributes
    ----------
    place : Place
    size : float
        As the camera takes it.
    bar : float
        The model's pressure.
    turn, grow, shift : (J,) rad, mm, mm
        Of the joints, beyond the model's.
    """

    place: Place
    size: float
    bar: float
    turn: FloatArray
    grow: FloatArray
    shift: FloatArray

    def values(self) -> FloatArray:
        """All as one vector: x, y, heading, size, bar, turns, lengthenings, shifts."""
        at, joints = self.place, (self.turn, self.grow, self.shift)
        return np.array([at.x, at.y, at.heading, self.size, self.bar, *np.concatenate(joints)])

    def of(self, values: FloatArray) -> Tube:
        """Give the same with other values."""
        x, y, heading, size, bar = values[:5].tolist()
        turn, grow, shift = np.split(values[5:], 3)
        return Tube(Place(x, y, heading, self.place.hand), size, bar, turn, grow, shift)

    def outline(self, family: Family) -> Outline:
        """Give its lines."""
        return family.outline(self.bar, self.turn, self.grow, self.shift)


@dataclass(frozen=True)
class Line:
    """A line along a wrapped sector, drawn by hand or through painted marks.

    Attributes
    ----------
    ends : (2, 2) px
    across : bool
        Whether it runs around the tube rather than along.
    by_hand : bool
    sigma_px : float
        Of its ends.
    """

    ends: FloatArray
    across: bool = False
    by_hand: bool = True
    sigma_px: float = 1.0


@dataclass(frozen=True)
class Known:
    """What other pictures tell of place and size: x, y, heading, size.

    Attributes
    ----------
    values : (4,)
    root : (4, 4)
        Its square is the inverse of their covariance.
    """

    values: FloatArray
    root: FloatArray


@dataclass(frozen=True)
class Fitted:
    """A tube in a picture.

    Attributes
    ----------
    tube : Tube
    covariance : (5 + 3 J, 5 + 3 J)
        Of its values.
    px : (M, 2)
        Edges that were seen.
    sector : (M,)
        Wrapped sector of each.
    believed : (M,) bool
    share : (J + 1,)
        Of each sector's places: with an edge that is believed.
    rms_px : float
        Of the believed edges.
    outside : float
        Share of the tube's lines that lie outside the picture.
    """

    tube: Tube
    covariance: FloatArray
    px: FloatArray
    sector: IntArray
    believed: BoolArray
    share: FloatArray
    rms_px: float
    outside: float


def start_of(family: Family, place: Place, bar: float) -> Tube:
    """Begin with a tube as the model has it."""
    none = np.zeros(family.joints)
    return Tube(place, 0.0, bar, none, none, none)
