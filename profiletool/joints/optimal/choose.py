"""The choice of all joints of an actuator together, by a model: the best that a pressure allows.

First the global optimum of a discretisation (`search`), for every number of joints and every
pressure; then everything continuous is moved until the shape is best (`polish`). The fewest joints
win whose shape lies within the tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from profiletool.bending.model import Chain, Model
from profiletool.errors import Infeasible, NoObject
from profiletool.joints.bounds import Limits, cuts_of, limits_of
from profiletool.joints.correction.parameters import PosedChain
from profiletool.joints.expected import POLISHED_WEIGHT, Aim, ErrorSizes, Expected
from profiletool.joints.misfit import is_good
from profiletool.joints.optimal.lines import FAR, FINE, WIDE
from profiletool.joints.optimal.paths import QUICK, around, best_of, score_of
from profiletool.joints.optimal.polish import Goal, Polished, at_bound, goal_of, judge, polish
from profiletool.joints.optimal.search import MOST_JOINTS, SearchResult, search
from profiletool.records.design import Misfit
from profiletool.records.frames import Pose, Shape, cross, direction
from profiletool.records.profile import Profile
from profiletool.records.request import INTERFERENCE_MM, TubeSpec
from profiletool.records.units import BAR_PER_MPA, FloatArray

TOLERANCE_MM = 0.25

_FAR_MM = 3.0
_HOPEFUL = 3.0  # a path this many times the tolerance off may be polished into it
_WORTH = 0.1  # of the tolerance: what one more joint must bring
_RIVALS = 3  # paths polished for one number of joints
_NEAR = 1.3  # times the tolerance, after a quick polish: worth a long one
_MOST_POLISHED = 7  # numbers of joints that are polished
_SWAPS = 3
_CUTS = 3  # times that a profile too long for the tube is shortened
_SHORTEST_MM = 40.0


@dataclass(frozen=True)
class TradeOff:
    """The gain of more joints and more pressure.

    Attributes
    ----------
    pressure : (P,) MPa
    rms_mm : (P, J) mm
        Of the best discrete actuator of 1 to J joints; infinite where there is none.
    polished_mm : (J,) mm
        Of the best polished one; NaN for numbers of joints that were not polished.
    """

    pressure: FloatArray
    rms_mm: FloatArray
    polished_mm: FloatArray


@dataclass(frozen=True)
class ChoiceOptions:
    """Options of the choice.

    Attributes
    ----------
    tolerance_mm : float
        RMS that is good enough.
    interference_mm : float
        How deep the tube may lie in the object.
    count : int or None
        Number of joints; as few as reach the tolerance where None.
    base_free : bool
        Whether the base may leave the profile's start tangent.
    sizes : ErrorSizes or None
        Of a build's errors; the nominal shape alone counts where None.
    neighbours : bool
        Whether to look at what one joint fewer, one more, or less pressure would give.
    """

    tolerance_mm: float = TOLERANCE_MM
    interference_mm: float = INTERFERENCE_MM
    count: int | None = None
    base_free: bool = False
    sizes: ErrorSizes | None = None
    neighbours: bool = False


@dataclass(frozen=True)
class Choice:
    """The chosen actuator as the model bends it.

    ``depth`` is how deep it lies in the object at most, mm; ``pressure`` in MPa. ``neighbours``
    holds polished actuators by name: "as chosen" first, then those around it.
    """

    chain: Chain
    pressure: float
    pose: Pose
    shape: Shape
    misfit: Misfit
    depth: float
    trade_off: TradeOff
    limits: Limits
    neighbours: tuple[tuple[str, Polished], ...] = ()


def choose(
    profile: Profile, model: Model, spec: TubeSpec, options: ChoiceOptions | None = None
) -> Choice:
    """Choose number, places, senses, cuts and sectors of the joints, pressure and base.

    Parameters
    ----------
    profile : Profile
    model : Model
    spec : TubeSpec
    options : ChoiceOptions, optional

    Raises
    ------
    profiletool.errors.NoObject
        When the profile is straight.
    profiletool.errors.Infeasible
        When no joints follow it even roughly.
    formula.errors.OutOfRange
        When no cut in whole meshes is known to the model.
    """
    options = options or ChoiceOptions()
    away = cross(direction(profile.heading[0]), profile.points - profile.points[0])
    if np.abs(away).max() <= options.tolerance_mm:
        raise NoObject(
            f"the profile is straight to {options.tolerance_mm:g} mm: there is nothing to bend; "
            "take another `side` or stretch, or a smaller `tolerance_mm`"
        )
    limits, cuts = limits_of(model, spec, options.base_free), cuts_of(model, spec)
    expected = None if options.sizes is None else Expected(model, options.sizes, POLISHED_WEIGHT)
    aim = Aim(options.interference_mm, expected)
    reached = profile
    for _ in range(_CUTS):
        # What lies farther down than the tube can be long is out of reach whatever it does.
        reached = _first_part(reached, limits.max_length_mm)
        searches = _searches(reached, model, cuts, limits, options)
        goal = goal_of(reached, limits, aim)
        best, polished = _fewest(searches, model, goal, options)
        excess = best.posed.chain.length - limits.max_length_mm
        if excess <= 0.0:
            break
        reached = _first_part(reached, max(reached.length_mm - excess - 1.0, _SHORTEST_MM))
    best = _swapped(best, model, goal, cuts)
    count = len(best.posed.chain.openF)
    polished[count - 1] = np.fmin(polished[count - 1], best.misfit.rms_mm)
    at = best.posed
    trade_off = TradeOff(searches[0].pressure, _rms(searches, reached), polished)
    beside = []
    if reached is profile and options.neighbours:
        beside = [("as chosen", best), *around(best, searches, model, goal)]
    if reached is not profile:
        best = judge(at, model, goal_of(profile, limits, aim))
    return Choice(
        at.chain, at.pressure, at.pose, best.shape, best.misfit, best.depth, trade_off, limits,
        tuple(beside),
    )  # fmt: skip


def _first_part(profile: Profile, length: float) -> Profile:
    """Cut a profile off at an arc length."""
    if profile.length_mm <= length:
        return profile
    kept = slice(0, int(np.searchsorted(profile.s, length)))
    return replace(
        profile,
        **{
            name: getattr(profile, name)[kept]
            for name in ("points", "s", "heading", "curvature", "bridged")
        },
    )


def _searches(
    profile: Profile, model: Model, cuts: FloatArray, limits: Limits, options: ChoiceOptions
) -> list[SearchResult]:
    """Search on the profile, and farther off it where that does not do."""
    room = int(limits.max_length_mm / (cuts.min() + limits.wrap_mm)) + 1
    most = min(options.count or MOST_JOINTS, room)
    searches: list[SearchResult] = []
    for grid, enough in ((FINE, 2.0 * options.tolerance_mm), (WIDE, _FAR_MM), (FAR, np.inf)):
        found = search(
            profile, model, cuts, limits, options.interference_mm, grid, most, options.sizes
        )
        searches.append(found)
        rms = _rms(searches, profile)
        if (rms[:, -1] if options.count else rms).min() <= enough:
            break
    if not np.isfinite(rms).any():
        raise Infeasible(
            f"no joints of this tube follow the profile at {BAR_PER_MPA * limits.pressure[1]:.2f} "
            "bar: it turns too fast; take a longer cut, more pressure or another stretch"
        )
    return searches


def _rms(searches: list[SearchResult], profile: Profile) -> FloatArray:
    """Best RMS of several searches, on the pressures of the first: (P, J)."""
    nominal = [one.cost - one.errors for one in searches]
    best = nominal[0].copy()
    for other in nominal[1:]:
        # All end at the highest pressure.
        top = best[-len(other) :]
        np.minimum(top, other[-len(top) :], out=top)
    return np.asarray(np.sqrt(best / profile.length_mm))


def _fewest(
    searches: list[SearchResult], model: Model, goal: Goal, options: ChoiceOptions
) -> tuple[Polished, FloatArray]:
    """Polish numbers of joints from below until one lies within the tolerance.

    Where none does, one more joint must bring its worth.
    """
    rms = _rms(searches, goal.profile).min(axis=0)
    polished = np.full(len(rms), np.nan)
    least, worth = float(rms.min()), _WORTH * options.tolerance_mm
    if options.count is not None:
        numbers = np.array([_nearest_count(rms, options.count)])
    else:
        hopeful = rms <= max(_HOPEFUL * options.tolerance_mm, 1.5 * least)
        useful = np.arange(len(rms)) <= np.argmin(rms + 0.1 * worth * np.arange(len(rms)))
        numbers = np.flatnonzero(hopeful & useful)[:_MOST_POLISHED] + 1
    best: dict[int, Polished] = {}
    for n in (int(n) for n in numbers):
        best[n] = best_of(searches, model, goal, n, rivals=1, runs=QUICK)
        near = best[n].misfit.rms_mm <= _NEAR * options.tolerance_mm
        if near:
            best[n] = best_of(searches, model, goal, n, _RIVALS)
        polished[n - 1] = best[n].misfit.rms_mm
        good = is_good(best[n].misfit, best[n].depth, options.tolerance_mm, options.interference_mm)
        if near and good:
            return best[n], polished
    chosen = min(best, key=lambda n: score_of(best[n], goal) + worth * n)
    full = best_of(searches, model, goal, chosen, _RIVALS)
    polished[chosen - 1] = full.misfit.rms_mm
    return full, polished


def _nearest_count(rms: FloatArray, count: int) -> int:
    """Give the number of joints nearest below ``count`` that there is a path for."""
    reachable = np.flatnonzero(np.isfinite(rms[:count]))
    return int(reachable[-1]) + 1 if reachable.size else count


def _swapped(best: Polished, model: Model, goal: Goal, cuts: FloatArray) -> Polished:
    """Give joints whose alpha ends at a bound the next cut, as long as it helps."""
    for _ in range(_SWAPS):
        chain = best.posed.chain
        bound = at_bound(best.posed, goal.limits)
        candidates = []
        for k in np.flatnonzero(bound):
            index = int(np.argmin(np.abs(cuts - chain.openF[k]))) - int(bound[k])
            if 0 <= index < len(cuts):
                openF = chain.openF.copy()
                openF[k] = cuts[index]
                posed = replace(best.posed, chain=replace(chain, openF=openF))
                candidates.append(polish(_fitting(posed, goal.limits), model, goal, QUICK))
        better = min(candidates, key=lambda polished: score_of(polished, goal), default=best)
        if score_of(better, goal) >= score_of(best, goal) - 1e-6:
            break
        best = better
    return best


def _fitting(posed: PosedChain, limits: Limits) -> PosedChain:
    """Move joints apart until their windows leave the least wrapped length."""
    chain = posed.chain
    room = 0.5 * (chain.openF[1:] + chain.openF[:-1]) + limits.wrap_mm
    F = np.maximum(np.diff(chain.centre), room)
    root = max(float(chain.centre[0]), 0.5 * float(chain.openF[0]) + limits.wrap_mm)
    centre = root + np.concatenate([[0.0], np.cumsum(F)])
    length = float(chain.length + centre[-1] - chain.centre[-1])
    return replace(posed, chain=replace(chain, centre=centre, length=length))
