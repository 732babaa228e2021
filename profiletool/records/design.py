"""A design: what design.json holds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from formula.rubber import RubberLaw
from profiletool.errors import UnreadableInput
from profiletool.records.built import Built, BuiltMisfit, SectorThreads, TrimPoint
from profiletool.records.clamp import Clamp
from profiletool.records.frames import Pose
from profiletool.records.grip_request import OnObject
from profiletool.records.model import ModelInputs
from profiletool.records.neighbour import Neighbour
from profiletool.records.side import Side

TOWARD_DEG, AWAY_DEG = 270.0, 90.0  # alpha_center of a joint that bends toward the object, or away
_NEAR_SHARE = 0.25  # of the diameter: a sector this short between two cuts warps
_SAME_DEG = 1e-6  # design.json keeps six decimals


def sense_of(alpha_center_deg: float, joint: int) -> float:
    """+1 where alpha_center is 270 deg (toward the object), -1 where it is 90 (away from it).

    Raises
    ------
    UnreadableInput
        Naming the joint, where it bends out of the plane of the picture.
    """
    for center, sense in ((TOWARD_DEG, 1.0), (AWAY_DEG, -1.0)):
        if abs(alpha_center_deg - center) <= _SAME_DEG:
            return sense
    raise UnreadableInput(
        f"joint {joint} bends out of the plane of the picture, with alpha_center at "
        f"{alpha_center_deg:g} deg: formula and joint response bend joints toward the object "
        "(270 deg) or away from it (90 deg); others are for finite elements and templates alone"
    )


def named(numbers: Iterable[int]) -> str:
    """Name joints by their numbers: "joint 2", "joints 2, 3 and 5"."""
    words = [str(number) for number in numbers]
    if len(words) == 1:
        return f"joint {words[0]}"
    return f"joints {', '.join(words[:-1])} and {words[-1]}"


def joints_too_near(between_mm: Sequence[float], diameter_mm: float) -> tuple[int, ...]:
    """Numbers of the joints whose angles are uncertain, as the sector between them warps.

    Cuts less than 5 mm apart on a tube of 20 mm. The angle of each then depends on what is called
    the rotation of a warped section, by up to 7 %; the shape of the tube does not.

    Parameters
    ----------
    between_mm : (joints - 1,)
        Wrapped lengths from cut to cut.
    diameter_mm : float
        Outer diameter of the tube.
    """
    least = _NEAR_SHARE * diameter_mm - 1e-6
    near = (k for k, between in enumerate(between_mm, start=1) if between < least)
    return tuple(sorted({number for k in near for number in (k, k + 1)}))


@dataclass(frozen=True)
class Joint:
    """One joint of an actuator, as a row of the paper's Table 5.

    Attributes
    ----------
    number : int
        From 1, from the clamp on.
    F_mm : float
        From this joint's centre to the next one's, the last one's to the tube's end.
    openF_mm : float
        Axial length of the cut.
    alpha_closed_deg, alpha_center_deg : float
        Extent of the uncut sector, and its middle: 270 bends toward the object, 90 away from it.
    theta_target_deg, theta_formula_deg : float
        Bending angle, a magnitude: as wanted, and as the formula predicts it.
    theta_fe_deg, theta_response_deg : float or None
        The same by finite elements and by the joint response; None where neither was asked.
    centre_mm : float
        Place of the cut's middle along the tube, from the clamp's edge.
    stretch_fe : float or None
        Stretch of the rubber at the joint, by finite elements; see `fem.measure.stretches`.
    """

    number: int
    F_mm: float
    openF_mm: float
    alpha_closed_deg: float
    alpha_center_deg: float
    theta_target_deg: float
    theta_formula_deg: float
    theta_fe_deg: float | None
    centre_mm: float
    theta_response_deg: float | None = None
    stretch_fe: float | None = None

    @property
    def sense(self) -> float:
        """+1 where the joint bends toward the object, -1 away from it, both in the plane.

        Raises
        ------
        UnreadableInput
            Where it bends out of the plane; see `away` and `signed` for any direction.
        """
        return sense_of(self.alpha_center_deg, self.number)

    @property
    def away(self) -> bool:
        """Whether the middle of the uncut sector lies on the tube's far half."""
        return math.sin(math.radians(self.alpha_center_deg)) > 1e-12

    def signed(self, theta_deg: float) -> float:
        """Give an angle the sign that it has in a table of angles, or take it off: - where `away`.

        Finite elements report angles with it: about the joint's own axis, toward its uncut sector.
        """
        return -theta_deg if self.away else theta_deg


@dataclass(frozen=True)
class Source:
    """Where a design comes from.

    ``origin_px`` is the object frame's origin in the picture (in the frontal view of a printed
    sheet) once that is turned by ``rotated_deg``, counter-clockwise about its middle.
    ``scale_error_share`` is by how much of itself a scale that was measured in the picture may be
    off, about two standard deviations; ``confidence`` how far the silhouette is to be believed.
    """

    file: str
    sha256: str
    mm_per_px: float | None
    scale_source: str
    side: Side
    profile_length_mm: float
    bridged_share: float
    origin_px: tuple[float, float] | None
    rotated_deg: float = 0.0
    symmetric: bool = False
    scale_error_share: float | None = None
    confidence: float | None = None


@dataclass(frozen=True)
class Tube:
    """The tube; ``length_mm`` from the clamp's edge to the closed end, no rubber is the paper's."""

    outer_diameter_mm: float
    wall_mm: float
    root_mm: float
    length_mm: float
    rubber: RubberLaw | None = None


@dataclass(frozen=True)
class Gauze:
    """The gauze: ``seam_deg`` is the angular position of the glue and weld line."""

    pitch_mm: float
    thread_mm: float
    turns: int
    seam_deg: float


@dataclass(frozen=True)
class FormulaRef:
    """The formula a design was made with."""

    name: str
    sha256: str


@dataclass(frozen=True)
class Misfit:
    """Distance between the deformed object-facing line and the target profile."""

    rms_mm: float
    max_mm: float


@dataclass(frozen=True)
class Fit:
    """The misfit as the formula, FE and the joint response predict it; None where they do not."""

    formula: Misfit
    fe: Misfit | None
    response: Misfit | None = None


@dataclass(frozen=True)
class Sensitivity:
    """How far the bent object-facing line moves off itself when an input is off by a little.

    ``joint`` is the one that matters most, None where the input is the whole tube's.
    """

    what: str
    joint: int | None
    rms_mm: float
    max_mm: float


@dataclass(frozen=True)
class Design:
    """A whole actuator: what design.json holds.

    Attributes
    ----------
    source, tube, gauze, formula : Source, Tube, Gauze, FormulaRef
    pressure_bar : float
        Operating pressure, one for the whole tube.
    joints : tuple of Joint
    base_pose : Pose
        Of the object-facing line at the clamp's edge.
    fit : Fit
        Distances off the profile.
    feasible, verified : bool
        Whether it is within the limits; whether finite elements bent it up to its pressure and a
        little further, clear of itself. What was changed since is not `proven`.
    warnings : tuple of str
        What its user should know.
    method : {"optimal", "paper"}
    sensitivity : tuple of Sensitivity
        Empty where finite elements did not verify it.
    built : Built or None
        The misfit to expect of the actuator that is built; None where finite elements did not
        verify it.
    operate_bar : float or None
        The pressure to work at against the object; None where it is not computed.
    trim : tuple of TrimPoint
        Where the finished actuator stands at pressures about the planned one.
    model : ModelInputs
        What finite elements take.
    threads : tuple of SectorThreads
        The axial threads that stay whole, joint by joint, turn by turn, as the template's sheet
        has them.
    threads_off_mm : BuiltMisfit or None
        How far these single threads move the object-facing line from that of the smeared gauze,
        mm RMS; None where it is not computed.
    clamp : Clamp
        How much of tube and gauze is held behind x = 0.
    seal : str or None
        Digest of all that finite elements verified; see `profiletool.records.seal`.
    neighbours : tuple of Neighbour
        Choices near the chosen one, that one first; empty where joints were not chosen all at once.
    grip : OnObject
    """

    source: Source
    tube: Tube
    gauze: Gauze
    formula: FormulaRef
    pressure_bar: float
    joints: tuple[Joint, ...]
    base_pose: Pose
    fit: Fit
    feasible: bool
    verified: bool
    warnings: tuple[str, ...]
    method: str = "paper"
    sensitivity: tuple[Sensitivity, ...] = ()
    built: Built | None = None
    operate_bar: float | None = None
    trim: tuple[TrimPoint, ...] = ()
    model: ModelInputs = field(default_factory=ModelInputs)
    threads: tuple[SectorThreads, ...] = ()
    threads_off_mm: BuiltMisfit | None = None
    clamp: Clamp = field(default_factory=Clamp)
    seal: str | None = None
    neighbours: tuple[Neighbour, ...] = ()
    grip: OnObject = field(default_factory=OnObject)

    @property
    def thread_rad(self) -> float:
        """Angle of one mesh of the gauze around the tube, that of a thread more or less uncut."""
        return 2.0 * self.gauze.pitch_mm / self.tube.outer_diameter_mm

    @property
    def planned(self) -> TrimPoint:
        """Row of the trim table at the operating pressure; there must be a table."""
        return min(self.trim, key=lambda row: abs(row.pressure_bar - self.pressure_bar))

    @property
    def theta_uncertain(self) -> tuple[int, ...]:
        """Numbers of the joints that are too near to each other for an angle each."""
        between = [
            b.centre_mm - a.centre_mm - 0.5 * (a.openF_mm + b.openF_mm)
            for a, b in pairwise(self.joints)
        ]
        return joints_too_near(between, self.tube.outer_diameter_mm)
