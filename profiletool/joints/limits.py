"""What a design misses, in words: reasons why it is infeasible, and warnings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np

from formula.theta import Formula, beyond
from profiletool.joints.assign import NEAR_DEG, Layout
from profiletool.joints.kinematics import depth_inside, meets_itself
from profiletool.joints.pieces import Rules
from profiletool.joints.sectors import Sector
from profiletool.records import Design, FeState, Joint, Material, Misfit, Profile, Shape

_FORMULA_LOW_ABOVE_BAR = 1.2
_BREAKS = 9.5  # stretch of silicone at break: 850 % of strain
_SLACK_SHARE = 0.1
_BULGES_ABOVE_BAR = 2.0
_SLACK = 0.05  # mm or deg that nobody can see


def shortfalls(
    sectors: Sequence[Sector],
    layout: Layout,
    rules: Rules,
    material: Material,
    formula: Formula,
    count: int | None,
    place: Callable[[float], str],
) -> tuple[str, ...]:
    """Reasons why a design is beyond the physical limits; none where it is within them.

    Where a number of joints was asked for (``count``), a polygon off the tolerance is what the
    user chose, not a limit. ``place`` says in words where an arc length on the profile is.
    """
    reasons = []
    tube = (material.outer_diameter_mm, material.wall_mm)
    if tube != (formula.outer_diameter_mm, formula.wall_mm):
        reasons.append(
            f'formula "{formula.name}" holds for a tube of {formula.outer_diameter_mm:g} mm with '
            f"a wall of {formula.wall_mm:g} mm, not {tube[0]:g} and {tube[1]:g} mm; "
            "give a formula for this tube with --formula"
        )
    if count is not None and len(sectors) < count:
        reasons.append(f"there is no room for {count} joints on this profile, only {len(sectors)}")
    for number, sector in enumerate(sectors, start=1):
        found = [*_missing(sector, rules), *(_off(sector, rules) if count is None else ())]
        reasons += [f"joint {number}, {place(sector.centre)}: {what}" for what in found]
    if layout.length_mm > material.max_length_mm + _SLACK:
        reasons.append(
            f"the tube would be {layout.length_mm:.1f} mm long, more than "
            f"{material.max_length_mm:g} mm; shorten --root or the stretch (--from, --to), "
            "or raise --max-length"
        )
    return tuple(reasons)


def _missing(sector: Sector, rules: Rules) -> Iterator[str]:
    """Say what one joint cannot do."""
    if sector.blocked:
        yield "there is nothing for it to bend; ask for fewer joints"
    if np.degrees(sector.excess_turn_rad) > _SLACK:
        most = np.degrees(rules.theta_most_rad[np.searchsorted(rules.openF_mm, sector.openF_mm)])
        yield (
            f"a turn of {abs(np.degrees(sector.turn_rad)):.1f} deg is more than one joint reaches "
            f"({most:.1f} deg with openF {sector.openF_mm:g} mm at the highest pressure); leave "
            "such a corner out with --from or --to"
        )
    if sector.missing_mm > _SLACK:
        yield (
            f"its cut of {sector.openF_mm:g} mm lacks {2.0 * sector.missing_mm:.1f} mm of room; "
            "the profile turns too fast here for this tube: leave it out with --from or --to"
        )


def _off(sector: Sector, rules: Rules) -> Iterator[str]:
    """Say where the polygon leaves the profile."""
    if sector.deviation_mm > rules.tolerance_mm:
        yield (
            f"the polygon is {sector.deviation_mm:.2f} mm off the profile, more than the "
            f"tolerance of {rules.tolerance_mm:g} mm; raise --tolerance, or leave this place out "
            "with --from or --to"
        )
    elif sector.inward_mm > rules.interference_mm:
        yield (
            f"the polygon runs {sector.inward_mm:.2f} mm into the object, more than "
            f"{rules.interference_mm:g} mm; give some --clearance, or leave this place out with "
            "--from or --to"
        )


def warnings(
    layout: Layout,
    profile: Profile,
    fit: Misfit,
    tolerance_mm: float,
    material: Material,
    formula: Formula,
    verified: bool,
) -> tuple[str, ...]:
    """Say what the user should know of a design that can be made.

    ``fit`` is that of FE where it has ``verified`` the design, else the formula's.
    """
    found = []
    if material.max_pressure_bar > formula.pressure_range_bar[1]:
        found.append(
            f'formula "{formula.name}" ends at {formula.pressure_range_bar[1]:g} bar: '
            "no higher pressure was considered"
        )
    theirs = formula.name == "paper"
    if theirs and layout.pressure_bar > _FORMULA_LOW_ABOVE_BAR and not verified:
        found.append(
            f"formula (9) reads low above {_FORMULA_LOW_ABOVE_BAR:g} bar: expect the joints to "
            f"bend more than it says at {layout.pressure_bar:.2f} bar"
        )
    eager = [j for j in layout.joints if j.theta_formula_deg - j.theta_target_deg > NEAR_DEG]
    if eager:
        worst = max(j.theta_formula_deg - j.theta_target_deg for j in eager)
        found.append(
            f"{named(j.number for j in eager)} will bend up to {worst:.1f} deg more than wanted: "
            f"the look-up rounds up, and the table is coarse at {layout.pressure_bar:.2f} bar"
        )
    found += bridged(profile)
    if fit.max_mm > tolerance_mm:
        by = "by FE the bent shape lies" if verified else "the bent shape is predicted"
        found.append(
            f"{by} up to {fit.max_mm:.1f} mm off the profile "
            f"(RMS {fit.rms_mm:.1f} mm): the paper's method rounds angles up, takes lengths off "
            "the drawing and corrects neither"
        )
    return tuple(found)


def bridged(profile: Profile) -> Iterator[str]:
    """Say how much of the profile the tube spans without touching it."""
    share = 100.0 * float(np.mean(profile.bridged))
    if share >= 0.5:
        yield f"{share:.0f} % of the profile is bridged: grooves too tight to enter"


def extrapolated(design: Design, formula: Formula) -> Iterator[str]:
    """Say for which joints the formula is used beyond what it was fitted on."""
    out = [
        joint.number
        for joint in design.joints
        if beyond(formula, joint.alpha_closed_deg, joint.openF_mm, design.pressure_bar)
    ]
    if out:
        yield (
            f'formula "{formula.name}" was not fitted for {named(out)}: its angle there is '
            "extrapolated"
        )


def disagreement(joints: Sequence[Joint], pressure_bar: float) -> Iterator[str]:
    """Say where FE and the formula disagree, by more than the table's own coarseness."""
    for more, word in ((True, "more"), (False, "less")):
        off = {
            j.number: (1.0 if more else -1.0) * (j.theta_fe_deg - j.theta_formula_deg)
            for j in joints
            if j.theta_fe_deg is not None
        }
        apart = {number: by for number, by in off.items() if by > NEAR_DEG}
        if apart:
            verb = "bends" if len(apart) == 1 else "bend up to"
            yield (
                f"by FE {named(apart)} {verb} {max(apart.values()):.1f} deg {word} at "
                f"{pressure_bar:.2f} bar than the formula says: believe the FE"
            )


def polygon_warnings(
    sectors: Sequence[Sector], tolerance_mm: float, count: int | None
) -> Iterator[str]:
    """Say what is wrong with the polygon that was asked for."""
    off = max(sector.deviation_mm for sector in sectors)
    if count is not None and off > tolerance_mm:
        yield (
            f"with --joints {count} the polygon is {off:.1f} mm off the profile, "
            f"beyond --tolerance {tolerance_mm:g}"
        )


def shape_warnings(shape: Shape, profile: Profile, depth_mm: float) -> Iterator[str]:
    """Say what is wrong with the bent shape; it may lie ``depth_mm`` deep in the object."""
    depth = depth_inside(shape, profile)
    if depth > depth_mm:
        yield f"the tube would press up to {depth:.1f} mm into the object"
    if meets_itself(shape):
        yield "the bent tube runs into itself"


def wear(state: FeState, design: Design) -> Iterator[str]:
    """Say what strains the tube at its operating pressure, by FE."""
    worst = max(design.joints, key=lambda joint: joint.stretch_fe or 0.0)
    yield (
        f"the rubber is stretched most at joint {worst.number}: {worst.stretch_fe:.1f} times "
        f"(silicone breaks at {_BREAKS:g} times)"
    )
    if state.slack_share > _SLACK_SHARE:
        yield (
            f"axial threads are slack on {100.0 * state.slack_share:.0f} % of the wrapped surface: "
            "the gauze may wrinkle there"
        )
    if design.pressure_bar > _BULGES_ABOVE_BAR:
        yield f"bulges were seen above {_BULGES_ABOVE_BAR:.1f} bar on the paper's actuators"
    if state.touches:
        yield "by FE the bent tube touches itself; the model lets it pass through"


def named(numbers: Iterable[int]) -> str:
    """Name joints by their numbers: "joint 2", "joints 2, 3 and 5"."""
    words = [str(number) for number in numbers]
    if len(words) == 1:
        return f"joint {words[0]}"
    return f"joints {', '.join(words[:-1])} and {words[-1]}"
