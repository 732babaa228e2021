"""The request: what `design` is asked for, and the tube that it may use."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from profiletool.records.built import BuildErrors
from profiletool.records.clamp import LEAST_MM, Clamp
from profiletool.records.grip_request import Solid
from profiletool.records.model import ModelInputs
from profiletool.records.side import Side

if TYPE_CHECKING:
    from formula.rubber import RubberLaw
    from profiletool.records.picture import Picture
    from profiletool.records.profile import DrawnLine, Profile


Box = tuple[float, float, float, float]  # x, y, width, height
Point = tuple[float, float]  # x, y


@dataclass(frozen=True)
class ScaleRequest:
    """What the user said about the scale; the first given wins, in this order.

    Attributes
    ----------
    height_mm, width_mm : float or None
        The object's full extent.
    mm_per_px : float or None
        The scale itself.
    marker_mm : float or None
        Side of the ArUco DICT_4X4_50 marker in the picture.
    camera_distance_mm : float or None
        From the camera's lens to the plane that a marker or the printed sheet lies in.
    """

    height_mm: float | None = None
    width_mm: float | None = None
    mm_per_px: float | None = None
    marker_mm: float | None = None
    camera_distance_mm: float | None = None


PRESSURE_STEP_BAR = 0.01  # what a gauge can be set to
PLACE_STEP_MM = 1.0  # what a ruler has
INTERFERENCE_MM = 0.3  # how deep a straight piece of tube may lie in the object as drawn


@dataclass(frozen=True)
class TubeSpec:
    """The tube and gauze that a design starts from, and the limits that it must keep.

    Attributes
    ----------
    outer_diameter_mm, wall_mm : float
    root_mm : float
        Least length from the clamp's edge to the first joint's centre.
    pitch_mm, thread_mm : float
        Of the gauze: mesh pitch, diameter of a thread.
    turns : int
        How often the gauze is rolled around the tube.
    max_pressure_bar, max_length_mm : float
        Highest pressure; longest tube.
    pressure_bar : float or None
        The operating pressure where it is given; None for what suits best, up to the highest.
    rubber : RubberLaw or None
        None for the paper's silicone.
    clamp_mm : float or None
        Length of tube and gauze that is held behind the clamp's edge; None for one diameter.
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
    clamp_mm: float | None = None
    pressure_bar: float | None = None

    @property
    def clamp(self) -> Clamp:
        """The clamp that the tube is held by."""
        return Clamp(
            max(self.outer_diameter_mm, LEAST_MM) if self.clamp_mm is None else self.clamp_mm
        )

    @property
    def radius_mm(self) -> float:
        """Outer radius of the tube."""
        return 0.5 * self.outer_diameter_mm

    @property
    def thread_rad(self) -> float:
        """Angle of one mesh of the gauze around the tube, that of a thread more or less uncut."""
        return self.pitch_mm / self.radius_mm


@dataclass(frozen=True)
class Look:
    """How to look at a picture.

    Attributes
    ----------
    box : (x, y, w, h), or None
        Pixels of the picture, upright; everything outside is ground.
    point : (x, y), or None
        Pixels; inside the object.
    mask : Path, or None
        A picture of the object in white on black, or with transparent ground.
    candidate : int or None
        Which of the candidates to take that a doubtful picture shows, from 1.
    rotate : float or "auto"
        Degrees counter-clockwise to turn the object by.
    symmetric : bool
        Whether to take the mean of the object's two sides.
    flat : bool
        Whether the object is flat and lies on the marker's or printed sheet's plane.
    layer : str or None
        Of a drawing, to read alone.
    """

    box: Box | None = None
    point: Point | None = None
    mask: Path | None = None
    candidate: int | None = None
    rotate: float | Literal["auto"] = 0.0
    symmetric: bool = False
    flat: bool = False
    layer: str | None = None


Method = Literal["optimal", "paper"]
Aim = Literal["built", "nominal"]


@dataclass(frozen=True)
class Request:
    """All that a design is asked for.

    Attributes
    ----------
    file : Path
        The picture or drawing to read; only its name where one is ``given`` in its place.
    scale : ScaleRequest
    look : Look
    side : {"left", "right"}
        Of the object.
    start_pct, end_pct : float
        Stretch of that side's arc length from the top, %.
    clearance_mm : float
        Gap between tube and object.
    tolerance_mm : float or None
        RMS off the profile; None for the method's own.
    joints : int or None
        How many; None for as few as will do.
    method : {"optimal", "paper"}
    interference_mm : float
        How deep the tube may lie in the object.
    base_free : bool
        Whether the base may leave the profile's start tangent.
    alpha_step_deg : float or None
        Step of alpha_closed; None for one thread, 0 for any value.
    place_step_mm : float or None
        Step of the joints' places; 0 for any value, None for the gauze's pitch where that costs
        little, else `PLACE_STEP_MM`.
    tube : TubeSpec
    formula : Path or None
        A formula file, or the name of one that comes along; None for the paper's.
    extrapolate : bool
        Whether the formula may be used beyond what it was fitted on.
    objective : {"built", "nominal"}
        What joints are chosen for: the actuator that is built, errors and all, or perfect parts.
    build : BuildErrors
    verify, refine : bool
        Whether finite elements verify the design, and correct it before.
    grip : bool
        Whether finite elements press the verified actuator on its object.
    grip_N : float or None
        Normal force on the object to work with; None for the least expected misfit.
    solid : {"auto", "turned", "extruded"}
        What the profile is of: see `profiletool.records.grip.GripRequest`.
    model : ModelInputs
        What finite elements take.
    given : Picture, DrawnLine, Profile or None
        What a design is made from where there is no file.
    """

    file: Path
    scale: ScaleRequest = field(default_factory=ScaleRequest)
    look: Look = field(default_factory=Look)
    side: Side = "left"
    start_pct: float = 0.0
    end_pct: float = 100.0
    clearance_mm: float = 0.0
    tolerance_mm: float | None = None
    joints: int | None = None
    method: Method = "optimal"
    interference_mm: float = INTERFERENCE_MM
    base_free: bool = False
    alpha_step_deg: float | None = None
    place_step_mm: float | None = None
    tube: TubeSpec = field(default_factory=TubeSpec)
    formula: Path | None = None
    extrapolate: bool = False
    objective: Aim = "built"
    build: BuildErrors = field(default_factory=BuildErrors)
    verify: bool = True
    refine: bool = True
    grip: bool = True
    grip_N: float | None = None
    solid: Solid = "auto"
    model: ModelInputs = field(default_factory=ModelInputs)
    given: Picture | DrawnLine | Profile | None = None
