"""Cautions about a finite-element run that converged: readings to be believed only in part."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from profiletool.records.design import named
from profiletool.records.fe import FeState, Verification
from profiletool.verify.run import too_little

# Above, no law of two constants holds: silicone stiffens as its chains come to their end, and the
# laws of the presets are checked for stability up to here only.
LAW_HOLDS = 3.0
_TEARS_SOON = 0.5  # of the stretch at break
_BULGES = 0.1  # of the radius; the paper's joints reach 0.06 at 2.0 bar


def cautions(found: Verification) -> tuple[str, ...]:
    """Say what of a run's last state is beyond what the model holds for."""
    last = found.last
    said = [*strained(last, found.breaks), *uncertain(found.theta_uncertain)]
    overlapping = [state for state in found.states if state.touches]
    if overlapping:
        first, deepest = overlapping[0], max(state.overlap_mm for state in overlapping)
        said.append(
            f"the bent tube touches itself from {first.pressure_bar:.2f} bar on, and lies up to "
            f"{deepest:.1f} mm deep in itself: the model knows no contact and lets it"
        )
    if found.ahead is not None:
        said.append(too_little(found))
    return tuple(said)


def strained(state: FeState, breaks: float | None) -> Iterator[str]:
    """Say where rubber and gauze are strained beyond what the model holds for.

    ``breaks`` is the stretch at which the rubber breaks, None where nothing tells.
    """
    most = state.largest_stretch
    if breaks is not None and most > _TEARS_SOON * breaks:
        where = "more than" if most > breaks else "more than half of"
        yield (
            f"the rubber is stretched {most:.1f} times at {state.pressure_bar:.2f} bar, {where} "
            f"what it breaks at ({breaks:g} times): ask for less pressure or a thicker wall"
        )
    if most > LAW_HOLDS:
        over = [k for k, s in enumerate(state.joint_stretch, start=1) if s > LAW_HOLDS]
        yield (
            f"the rubber is stretched {most:.1f} times{_at(over)}: its law holds to about "
            f"{LAW_HOLDS:g} times, beyond that angles are extrapolated"
        )
    out = {k: b for k, b in enumerate(state.joint_bulge, start=1) if b > _BULGES}
    if out:
        yield (
            f"the tube balloons{_at(out)}: it stands out by {100.0 * max(out.values()):.0f} % of "
            "its radius"
        )


def uncertain(joints: Iterable[int]) -> Iterator[str]:
    """Say whose angles are not to be read by themselves."""
    numbers = tuple(joints)
    if numbers:
        yield (
            f"the angles of {named(numbers)}, marked ~, are uncertain by up to 7 %: the sector "
            "between their cuts is so short that it warps; compare shapes there"
        )


def _at(numbers: Iterable[int]) -> str:
    listed = tuple(numbers)
    return f" at {named(listed)}" if listed else ""
