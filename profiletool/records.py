"""The frozen records that are handed from stage to stage.

Frames
------
Picture frame: pixels, x to the right, y down, pixel centres at whole numbers, so that a picture
W wide spans -0.5 .. W - 0.5.
Object frame: mm, x to the right, y up. For a picture its origin is the object's top middle; a
vector profile keeps its own coordinates.

A profile is travelled from the top of the object to its base. For ``side == "left"`` the object
lies to the left of the travel direction (the tube to its right), for ``"right"`` the other way
round. Turns and curvature count positive where the object is convex, so they do not depend on
the side.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from formula.theta import RubberLaw

FloatArray = NDArray[np.float64]
Side = Literal["left", "right"]

MM_PER_INCH = 25.4
TOWARD_DEG, AWAY_DEG = 270.0, 90.0  # alpha_center of a joint that bends toward the object, or away


def side_sign(side: Side) -> float:
    """Return +1 where a convex turn is counter-clockwise (left side), else -1."""
    return 1.0 if side == "left" else -1.0


@dataclass(frozen=True)
class Picture:
    """A decoded picture, upright.

    Attributes
    ----------
    rgb : (H, W, 3) uint8
    alpha : (H, W) uint8, or None
        None where the file has no alpha channel, or one that is opaque everywhere.
    mm_per_px : float or None
        The resolution stored in the file, where it means something.
    format : str
        As Pillow names it: "PNG", "JPEG", ...
    focal_px : float or None
        Focal length in pixels, where the file tells its 35 mm equivalent; some per cent off.
    """

    rgb: NDArray[np.uint8]
    alpha: NDArray[np.uint8] | None
    mm_per_px: float | None
    format: str
    focal_px: float | None = None

    @property
    def middle(self) -> FloatArray:
        """Its middle in the picture frame, (2,) px."""
        return np.asarray(0.5 * (np.array(self.rgb.shape[1::-1], float) - 1.0))


@dataclass(frozen=True)
class Silhouette:
    """The outline of the one object in a picture.

    Attributes
    ----------
    contour_px : (N, 2)
        Closed polygon (first point not repeated) in the picture frame, sub-pixel, ordered so
        that it runs counter-clockwise as seen (down the left side).
    mask : (H, W) bool
        The object, holes filled.
    method : str
        What found it: "alpha matte", "plain ground", "grabcut", ..., or the user's own "mask".
    noise_px : float
        Standard deviation of the contour's position, normal to itself.
    touches : frozenset of {"left", "right", "top", "bottom"}
        The edges of the frame that the object runs into.
    confidence : float
        How far the mask deserves to be believed, 0 to 1; a matte is believed wholly.
    held : bool
        Whether a hand seems to hide part of the object.
    """

    contour_px: FloatArray
    mask: NDArray[np.bool_]
    method: str
    noise_px: float
    touches: frozenset[str]
    confidence: float = 1.0
    held: bool = False


@dataclass(frozen=True)
class Scale:
    """Millimetres per pixel, and where that number comes from.

    Attributes
    ----------
    mm_per_px : float
    source : str
    error_share : float or None
        By how much of itself the number may be off, about two standard deviations; None where
        nothing is known of it.
    """

    mm_per_px: float
    source: Literal["height", "width", "mm-per-px", "marker", "sheet", "resolution", "vector"]
    error_share: float | None = None

    @property
    def measured_error(self) -> float | None:
        """``error_share`` of a scale that the picture tells; None where the user answers for it."""
        return self.error_share if self.source in ("marker", "sheet") else None


@dataclass(frozen=True)
class Profile:
    """The target of the object-facing line: the stretch that the tube can follow.

    Attributes
    ----------
    points : (N, 2) mm, object frame, from the top down, 0.1 mm apart but for smoothing
    s : (N,) mm
        Arc length from the first point.
    heading : (N,) rad
        Direction of travel, counter-clockwise from +x, unwrapped.
    curvature : (N,) 1/mm
        Positive where the object is convex.
    bridged : (N,) bool
        Where the tube spans a groove of the object instead of touching it.
    side : "left" or "right"
    outline : (M, 2) mm, or None
        The closed outline of the object; None for an open drawn profile.
    """

    points: FloatArray
    s: FloatArray
    heading: FloatArray
    curvature: FloatArray
    bridged: NDArray[np.bool_]
    side: Side
    outline: FloatArray | None

    @property
    def length_mm(self) -> float:
        """Arc length of the whole profile."""
        return float(self.s[-1])

    @property
    def sign(self) -> float:
        """+1 where a convex turn is counter-clockwise (left side), else -1."""
        return side_sign(self.side)


@dataclass(frozen=True)
class Material:
    """The tube and gauze that a design starts from, and what they may be asked for.

    ``rubber`` is None for the paper's.
    """

    outer_diameter_mm: float = 20.0
    wall_mm: float = 2.0
    root_mm: float = 10.0
    pitch_mm: float = 2.0
    thread_mm: float = 0.25
    turns: int = 2
    max_pressure_bar: float = 2.0
    max_length_mm: float = 250.0
    rubber: RubberLaw | None = None

    @property
    def radius_mm(self) -> float:
        """Outer radius of the tube."""
        return 0.5 * self.outer_diameter_mm


@dataclass(frozen=True)
class Joint:
    """One joint of an actuator, as a row of the paper's Table 5.

    theta is a magnitude; ``alpha_center_deg`` tells the direction (270 toward the object, 90
    away from it). It is given as wanted, and as the formula, the joint response (where the joints
    were chosen by it) and FE predict it. ``F_mm`` runs from this joint's centre to the next
    one's, the last one's to the tube's end. ``centre_mm`` is the joint's place along the tube,
    from the clamped end. ``stretch_fe`` is the largest principal stretch of the rubber there.
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
        """+1 where the joint bends toward the object, -1 away from it."""
        return 1.0 if self.alpha_center_deg == TOWARD_DEG else -1.0


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
    """The tube; ``length_mm`` from the clamped end to the closed one, no rubber is the paper's."""

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
class Pose:
    """Where the object-facing line starts and which way it points (object frame)."""

    x_mm: float
    y_mm: float
    heading_deg: float


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
class Shape:
    """A deformed (or straight) actuator in the object frame.

    Attributes
    ----------
    along : (N,) mm
        Position on the straight tube, from the clamped end.
    facing, axis, far : (N, 2) mm
        The object-facing surface line, the axis, the surface line on the other side.
    """

    along: FloatArray
    facing: FloatArray
    axis: FloatArray
    far: FloatArray


@dataclass(frozen=True)
class Critical:
    """Where the path of equilibria ends: ``kind`` is "limit point" or "bifurcation"."""

    kind: str
    pressure_bar: float


@dataclass(frozen=True)
class FeState:
    """An actuator at one pressure, by finite elements.

    Attributes
    ----------
    pressure_bar : float
    theta_deg : tuple of float
        Of every joint, positive toward the object.
    shape : Shape
    phalanges : (joints + 1, 2) mm, object frame
        Midpoints of the wrapped sectors, the clamped one first.
    air_ml : float
        Volume gained since rest, at the tube's own pressure.
    joint_stretch : tuple of float
        Largest principal stretch of the rubber at every joint.
    largest_stretch, least_J : float
        Of the rubber: largest principal stretch, smallest change of volume.
    slack_share : float
        Of the wrapped surface: where axial threads are slack.
    thread_N : float
        Largest force in a single thread.
    residual, energy_error : float
        Unbalanced forces over the pressure's; stored energy off the pressure's work, over it.
    touches : bool
        Whether the tube's surface meets itself; the model has no contact.
    """

    pressure_bar: float
    theta_deg: tuple[float, ...]
    shape: Shape
    phalanges: FloatArray
    air_ml: float
    joint_stretch: tuple[float, ...]
    largest_stretch: float
    least_J: float
    slack_share: float
    thread_N: float
    residual: float
    energy_error: float
    touches: bool


@dataclass(frozen=True)
class Verification:
    """What finite elements say of an actuator.

    Attributes
    ----------
    rest : FeState
    states : tuple of FeState
        At the asked pressures that were reached, in rising order.
    asked_bar : float
        The highest pressure asked for.
    critical : Critical or None
        What ended the path before that.
    elements, nodes, dofs, newton_iterations : int
    seconds : float
    """

    rest: FeState
    states: tuple[FeState, ...]
    asked_bar: float
    critical: Critical | None
    elements: int
    nodes: int
    dofs: int
    newton_iterations: int
    seconds: float

    @property
    def converged(self) -> bool:
        """Whether every asked pressure was reached."""
        return self.critical is None

    @property
    def last(self) -> FeState:
        """The state at the highest pressure that was reached."""
        return self.states[-1] if self.states else self.rest

    @property
    def pressures_bar(self) -> tuple[float, ...]:
        """The pressures of the states."""
        return tuple(state.pressure_bar for state in self.states)

    @property
    def theta_deg(self) -> tuple[tuple[float, ...], ...]:
        """Angles of every joint, one for each state."""
        columns = range(len(self.rest.theta_deg))
        return tuple(tuple(state.theta_deg[k] for state in self.states) for k in columns)


@dataclass(frozen=True)
class Design:
    """A whole actuator: what design.json holds."""

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
