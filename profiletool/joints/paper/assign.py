"""Steps 5 to 8 of the paper's method: sectors to a table of joints with one common pressure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from formula.errors import OutOfRange
from formula.table import PRESSURES_BAR, Table, assign, make_table
from formula.theta import Formula
from profiletool.bending.kinematics import facing_stretch
from profiletool.joints.bounds import END_WRAP_MM, wrap_mm
from profiletool.joints.layout import Layout
from profiletool.joints.paper.pieces import Rules
from profiletool.joints.paper.sectors import BendingSector
from profiletool.profile.curve import points_at
from profiletool.profile.offset import offset_points
from profiletool.records.design import AWAY_DEG, TOWARD_DEG, Joint
from profiletool.records.frames import Pose, direction
from profiletool.records.profile import Profile
from profiletool.records.request import INTERFERENCE_MM, TubeSpec
from profiletool.records.units import FloatArray

NEAR_DEG = 2.0  # an angle of the table this much above the wanted one is near enough
_F_DECIMALS = 1


def theta_table(formula: Formula, spec: TubeSpec) -> Table:
    """Tabulate the formula for cuts in whole meshes, up to the highest pressure.

    Raises
    ------
    formula.errors.OutOfRange
        When the formula covers none of them.
    """
    low, high = formula.openF_range_mm
    pitch = spec.pitch_mm
    cuts = np.arange(np.ceil(low / pitch - 1e-9), np.floor(high / pitch + 1e-9) + 1.0) * pitch
    if cuts.size == 0:
        raise OutOfRange(
            f"no whole number of {pitch:g} mm meshes lies within the {low:g} to {high:g} mm of "
            f'openF that formula "{formula.name}" holds for'
        )
    least, most = formula.pressure_range_bar
    if spec.pressure_bar is not None:
        if not least <= spec.pressure_bar <= most:
            raise OutOfRange(
                f"`pressure_bar` {spec.pressure_bar:g} bar is not within the {least:g} to {most:g} "
                f'bar of formula "{formula.name}"'
            )
        return make_table(formula, openF_mm=cuts.tolist(), pressures_bar=[spec.pressure_bar])
    most = min(spec.max_pressure_bar, most)
    pressures = [row for row in PRESSURES_BAR if least <= row <= most + 1e-9]
    if not pressures:
        raise OutOfRange(f"the table begins at {PRESSURES_BAR[0]:g} bar, above {most:g} bar")
    return make_table(formula, openF_mm=cuts.tolist(), pressures_bar=pressures)


def joint_rules(table: Table, spec: TubeSpec, tolerance_mm: float) -> Rules:
    """Rules for joints by the table.

    Parameters
    ----------
    table : Table
    spec : TubeSpec
    tolerance_mm : float
        How far the polygon may lie off the profile.
    """
    return Rules(
        radius_mm=spec.radius_mm,
        openF_mm=np.array(table.openF_mm),
        theta_most_rad=np.radians(table.theta_deg.max(axis=(0, 2))),
        wrap_mm=wrap_mm(spec),
        tolerance_mm=tolerance_mm,
        interference_mm=min(INTERFERENCE_MM, tolerance_mm),
    )


def lay_out(
    profile: Profile, sectors: Sequence[BendingSector], table: Table, spec: TubeSpec
) -> Layout:
    """Measure the sectors and look the angles up.

    A turn that no joint reaches is cut back to what one does, so that the best attempt can be
    drawn; the sectors keep what is missing.

    Parameters
    ----------
    profile : Profile
    sectors : sequence of BendingSector, in order along the profile
    table : Table
    spec : TubeSpec

    Raises
    ------
    formula.errors.OutOfRange
        When no pressure of the table serves all joints.
    """
    openF = [sector.openF_mm for sector in sectors]
    most = table.theta_deg.max(axis=(0, 2))[np.searchsorted(table.openF_mm, openF)]
    turns = np.abs(np.degrees([sector.turn_rad for sector in sectors]))
    wanted = np.minimum(turns, most).tolist()
    openF = _nearest_cuts(table, openF, wanted)
    found = assign(table, openF, wanted)
    sectors = [replace(sector, openF_mm=cut) for sector, cut in zip(sectors, openF, strict=True)]
    F = _phalanges(profile, sectors, spec)
    root, pose = _base(profile, sectors[0], spec)
    centres = root + np.concatenate([[0.0], np.cumsum(F)])
    joints = tuple(
        Joint(
            number=k + 1,
            F_mm=float(F[k]),
            openF_mm=sector.openF_mm,
            alpha_closed_deg=found.alpha_closed_deg[k],
            alpha_center_deg=TOWARD_DEG if sector.turn_rad > 0.0 else AWAY_DEG,
            theta_target_deg=float(abs(np.degrees(sector.turn_rad))),
            theta_formula_deg=found.theta_deg[k],
            theta_fe_deg=None,
            centre_mm=float(centres[k]),
        )
        for k, sector in enumerate(sectors)
    )
    return Layout(joints, root, float(centres[-1]), found.pressure_bar, pose)


def _nearest_cuts(table: Table, openF: Sequence[float], wanted: Sequence[float]) -> list[float]:
    """Shorten cuts where the table has nothing near the wanted angle.

    The length of a bending sector is free (step 4), and the columns of a long cut lie up to 14
    deg apart. The longest cut that comes near enough is taken, else the one that comes nearest.
    Joints with the largest angle keep their cut: it sets the pressure.
    """
    row = table.pressures_bar.index(assign(table, openF, wanted).pressure_bar)
    cuts = list(openF)
    for k, theta in enumerate(wanted):
        excess = table.theta_deg[row] - theta
        least = np.min(np.where(excess >= 0.0, excess, np.inf), axis=1)
        least[np.array(table.openF_mm) > openF[k] + 1e-9] = np.inf
        near = np.flatnonzero(least <= NEAR_DEG)
        if theta < max(wanted):
            cuts[k] = table.openF_mm[near[-1] if near.size else np.argmin(least)]
    return cuts


def _phalanges(profile: Profile, sectors: Sequence[BendingSector], spec: TubeSpec) -> FloatArray:
    """F of every joint by eq. (10), NS measured between points of the axis curve: (n,).

    Straight, as in the paper: "between the intersection points of the curved axis with the
    perpendicular lines" at the ends of the nondeformable sector.

    On the profile a bending sector is as long as its cut; one that bends away opens on the
    object-facing side and covers its opening too.
    """
    axis = offset_points(profile, spec.radius_mm)
    ends = [0.5 * _covered(sector, spec.radius_mm) for sector in sectors]

    def wrapped(start: float, end: float, least: float) -> float:
        if end <= start:
            return least
        here, there = points_at(np.array([start, end]), profile.s, axis)
        return max(float(np.hypot(*(there - here))), least)

    NS = [
        wrapped(a.centre + ends[k], b.centre - ends[k + 1], wrap_mm(spec))
        for k, (a, b) in enumerate(pairwise(sectors))
    ]
    NS.append(wrapped(sectors[-1].centre + ends[-1], profile.length_mm, END_WRAP_MM))
    half = 0.5 * np.array([sector.openF_mm for sector in sectors])
    F: FloatArray = np.round(half + NS + np.append(half[1:], 0.0), _F_DECIMALS)
    return F


def _covered(sector: BendingSector, radius_mm: float) -> float:
    opening = float(facing_stretch(sector.turn_rad, radius_mm))
    return sector.openF_mm + max(opening, 0.0)


def _base(profile: Profile, first: BendingSector, spec: TubeSpec) -> tuple[float, Pose]:
    """Root length and pose: straight along the first line, so that joint 1 lies on its vertex.

    The root is as long as asked, longer only where the profile starts with a longer straight or
    the first cut needs the room.
    """
    heading = float(profile.heading[0])
    along = direction(heading)
    lead = float((np.array(first.vertex) - profile.points[0]) @ along)
    room = 0.5 * first.openF_mm + wrap_mm(spec)
    root = round(max(spec.root_mm, lead, room), _F_DECIMALS)
    x, y = np.array(first.vertex) - root * along
    return root, Pose(float(x), float(y), float(np.degrees(heading)))
