"""A tube as its own angles tell it: rubber, dead pressure, threads and wall of a prototype."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace

from formula.rubber import RubberLaw
from profiletool.errors import UsageError
from profiletool.records.built import BuildErrors
from profiletool.records.design import Design
from profiletool.records.request import Request

_SHARE_KEPT = 0.5  # of a prior's sigma: a number that is surer is told by the data
_STEEP_DEG = 30.0  # deg that a usual joint turns for its stiffness over itself: P dtheta/dP
_WIDTH = math.sqrt(3.0)  # half of a uniform distribution, over its sigma


@dataclass(frozen=True)
class FittedNumber:
    """A number that was fitted.

    Attributes
    ----------
    name : str
        "rubber": natural logarithm of the stiffness over the design's; "dead": bar that the gauge
        reads too much; "thread": deg that every uncut sector acts wider; "wall": mm that the wall
        is thicker.
    value, sigma, prior_sigma : float
    """

    name: str
    value: float
    sigma: float
    prior_sigma: float

    @property
    def told(self) -> bool:
        """Whether the data tell it, rather than what was thought before."""
        return self.sigma < _SHARE_KEPT * self.prior_sigma


@dataclass(frozen=True)
class Relaxation:
    """How rubber gives way while a pressure is held.

    Attributes
    ----------
    share, share_sigma : float
        Of the pressure, that acts late: the rubber is stiffer by about that much at first.
    time_s, time_sigma_s : float
        Time constant of an exponential.
    """

    share: float
    share_sigma: float
    time_s: float
    time_sigma_s: float

    @property
    def told(self) -> bool:
        """Whether it is more than chance."""
        return self.share > 2.0 * self.share_sigma


@dataclass(frozen=True)
class CalibratedTube:
    """A tube file.

    Attributes
    ----------
    design : str
        Picture or drawing of the design that the tube was built from.
    date : str
        Of the calibration.
    cycles : int or None
        How often the tube had been inflated.
    outer_diameter_mm, wall_mm : float
    rubber : RubberLaw
    nu : float or None
        As in `ModelInputs`.
    dead_bar, sector_extra_deg : float
    fitted : tuple of FittedNumber
    readings : int
        How many angles.
    pressures_bar : tuple of float
        At which they were measured.
    rmse_deg, expected_deg : float
        What the fit leaves of the angles, and what their own sigmas let expect.
    held_out_deg : float or None
        The same of every other pressure, predicted from the others; None for a single one.
    singular_values : tuple of float
        Of the data's slopes, every number over its prior's sigma: below 1 the prior tells more.
    untold : tuple of str
        Combinations of the numbers that the data cannot tell.
    relaxation : Relaxation or None
        None where no pressure was held. Rubber and wall are those of the relaxed tube.
    """

    design: str
    date: str
    cycles: int | None
    outer_diameter_mm: float
    wall_mm: float
    rubber: RubberLaw
    nu: float | None
    dead_bar: float
    sector_extra_deg: float
    fitted: tuple[FittedNumber, ...]
    readings: int
    pressures_bar: tuple[float, ...]
    rmse_deg: float
    expected_deg: float
    held_out_deg: float | None
    singular_values: tuple[float, ...]
    untold: tuple[str, ...]
    relaxation: Relaxation | None = None


def with_tube(design: Design, tube: CalibratedTube | None) -> Design:
    """Give a design this tube's rubber, wall and gauze; as it is for None.

    Raises
    ------
    UsageError
        It is of another diameter.
    """
    if tube is None:
        return design
    diameter = design.tube.outer_diameter_mm
    if abs(diameter - tube.outer_diameter_mm) > 1e-6:
        raise UsageError(
            f"`tube` is of one of {tube.outer_diameter_mm:g} mm, and the design's has "
            f"{diameter:g} mm"
        )
    made = replace(design.tube, wall_mm=tube.wall_mm, rubber=tube.rubber)
    model = replace(design.model, sector_extra_deg=tube.sector_extra_deg, nu=tube.nu)
    return replace(design, tube=made, model=model)


def request_with(request: Request, tube: CalibratedTube | None) -> Request:
    """Make a request one for this tube, with the errors that its calibration leaves.

    Where the errors of the build are the usual ones, rubber and wall are as sure as fitted.
    """
    if tube is None:
        return request
    spec = replace(
        request.tube,
        outer_diameter_mm=tube.outer_diameter_mm,
        wall_mm=tube.wall_mm,
        rubber=tube.rubber,
    )
    model = replace(request.model, sector_extra_deg=tube.sector_extra_deg, nu=tube.nu)
    build, usual = request.build, BuildErrors()
    if asdict(build) == asdict(usual):
        left = 100.0 * _WIDTH * softness(tube)
        build = replace(build, rubber=round(min(usual.rubber, left), 2), wall=0.0)
    return replace(request, tube=spec, model=model, build=build)


def softness(tube: CalibratedTube) -> float:
    """Share that the tube's stiffness, rubber and wall together, is still uncertain by.

    They act as one where the data cannot part them: the angles at the calibrated pressures are
    as sure as the fit is.
    """
    scatter = max(tube.rmse_deg, tube.expected_deg) / math.sqrt(max(tube.readings, 1))
    return max(0.005, scatter / _STEEP_DEG)
