"""Pictures of one actuator at several pressures, measured together.

The tube is searched for in the picture at the highest pressure, where its shape is its own most;
the others start from the picture beside them. The clamp does not move: what the pictures agree on
of its place counts in each of them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from profiletool.errors import NoObject, UsageError
from profiletool.records.bench import Angle, Seen, State
from profiletool.records.picture import Picture
from profiletool.records.units import FloatArray
from profiletool.subject.tube.family import Family
from profiletool.subject.tube.fit import fit_tube
from profiletool.subject.tube.marks import mark_lines
from profiletool.subject.tube.rows import turn_sigma
from profiletool.subject.tube.search import Found, find_tube
from profiletool.subject.tube.values import Fitted, Known, Line, start_of
from profiletool.subject.tube.views import Looked, View, allowed_in, view_of

_TRIED = (0.75, 0.88, 1.0, 1.12, 1.28)  # of the nominal pressure
_LEAST_SHARE = 0.35  # of a sector's places, that an edge must be believed at
_MOST_SIGMA_DEG = 1.0  # of an angle that is called measured
_MODEL_DEG = 0.06  # what the model's own course of turning is uncertain by
_SAME = np.array([0.15, 0.15, np.radians(0.15), 0.004])  # of places that agree, beside their sigmas
_FLOOR = np.array([0.05, 0.05, np.radians(0.04), 0.001])
_AGREE = 16.0  # chi-squared of four
_SEEN_SHARE, _SEEN_SCORE, _CUT_SHARE = 0.5, 0.35, 0.02
_MOST_SIGMAS = 4.0  # that a scale may be off what was said of it
_MOST_OTHERWISE = 1.5  # usual deviations from the model, that half of the joints may have


@dataclass(frozen=True)
class _Fit:
    view: View
    fitted: Fitted
    lines: Mapping[int, Line]


def measure_series(
    family: Family,
    names: Sequence[str],
    bars: Sequence[float],
    load: Callable[[int], Picture],
    looked: Looked,
    progress: Callable[[float], None] | None = None,
) -> tuple[Seen, ...]:
    """Measure the joints' angles in pictures of one actuator.

    Parameters
    ----------
    family : Family
        The shapes that it may have.
    names : sequence of str
        Of the pictures.
    bars : sequence of float
        Their pressures.
    load : callable
        Gives a picture by its number.
    looked : Looked
    progress : callable, optional
        Takes the share that is done.

    Returns
    -------
    tuple of Seen
        In the order of the pictures.

    Raises
    ------
    NoScale
        Neither a scale is given nor is the printed sheet seen.
    NoObject
        Naming the picture, where no such tube is found in it, or a part of it only.
    """
    order = sorted(range(len(bars)), key=lambda k: -bars[k])
    fits: dict[int, _Fit] = {}
    last: _Fit | None = None
    for count, k in enumerate(order, start=1):
        view = view_of(names[k], bars[k], load(k), family, looked)
        last = _fitted(view, family, looked, last)
        fits[k] = last
        if progress is not None:
            progress(0.7 * count / len(order))
    made = {}
    for count, k in enumerate(order, start=1):
        made[k] = _seen(_again(fits, k, family), family)
        if progress is not None:
            progress(0.7 + 0.3 * count / len(order))
    if all(angle.state == "lost" for one in made.values() for angle in one.angles):
        raise NoObject(
            f"no angle can be told in {names[0] if len(names) == 1 else 'any of the pictures'}: "
            "check design, scale and pressures, or give `lines`"
        )
    return tuple(made[k] for k in range(len(bars)))


def timed(seen: Sequence[Seen], times_s: Sequence[float]) -> tuple[Seen, ...]:
    """Say when the pictures were taken."""
    return tuple(replace(one, time_s=float(time)) for one, time in zip(seen, times_s, strict=True))


def _fitted(view: View, family: Family, looked: Looked, last: _Fit | None) -> _Fit:
    """Fit a picture, from the one beside it where it can, else from a search of its own."""
    if last is not None and last.view.bar > 0.0:
        known = last.fitted.tube
        bar = view.bar * known.bar / last.view.bar
        start = replace(start_of(family, known.place, min(bar, family.top)), size=known.size)
        found = _lined(view, family, looked, fit_tube(view.shown, view.camera, family, start))
        if _whole(found, family):
            return found
    best: _Fit | None = None
    for one in _searched(view, family, looked)[:3]:
        start = start_of(family, one.place, one.bar)
        found = _lined(view, family, looked, fit_tube(view.shown, view.camera, family, start))
        if best is None or _worth(found.fitted) > _worth(best.fitted):
            best = found
        if _whole(found, family) and found.fitted.share.mean() > 0.9:
            break
    if best is None or not _whole(best, family):
        raise NoObject(_missing(view, best, family))
    return best


def _searched(view: View, family: Family, looked: Looked) -> list[Found]:
    tried = sorted({min(share * view.bar, family.top) for share in _TRIED})
    allowed, point = allowed_in(view, looked), None
    if looked.point is not None:
        at = view.camera.mm(np.array(looked.point, float))
        point = view.plane.seen(at) / view.plane.mm_per_px
    found = find_tube(view.plane, family, tried, (family.sign, -family.sign), allowed, point)
    if not found or found[0].score < _SEEN_SCORE:
        raise NoObject(_missing(view, None, family))
    return found


def _missing(view: View, best: _Fit | None, family: Family) -> str:
    if best is not None and _alike(best, family):
        return (
            f"{view.name}: the actuator runs out of the frame; show it whole, from the clamp to "
            "the tip"
        )
    return (
        f"{view.name}: no actuator of this design found in the picture, at about {view.bar:g} bar; "
        "show it whole and squarely, check scale and pressure, or say where it is with `point` or "
        "`box`"
    )


def _worth(fitted: Fitted) -> float:
    return float(fitted.share.mean())


def _whole(fit: _Fit, family: Family) -> bool:
    """Whether a fit is of the tube that was looked for, and of all of it."""
    return _alike(fit, family) and fit.fitted.outside <= _CUT_SHARE


def _alike(fit: _Fit, family: Family) -> bool:
    """Whether a fit is of the tube that was looked for: seen, of its size, bent much as it."""
    fitted, tube = fit.fitted, fit.fitted.tube
    sized = abs(tube.size) <= _MOST_SIGMAS * fit.view.camera.sigma
    usual = turn_sigma(family, tube.bar)
    bent = float(np.median(np.abs(tube.turn) / usual)) <= _MOST_OTHERWISE
    return bent and sized and _worth(fitted) > _SEEN_SHARE


def _lined(view: View, family: Family, looked: Looked, fitted: Fitted) -> _Fit:
    """Fit again with lines drawn by hand, and through marks."""
    lines: dict[int, Line] = {}
    if looked.marks:
        lines |= mark_lines(view.shown, view.camera, family, fitted.tube)
    count = family.joints + 1
    lines |= {k: line for (name, k), line in looked.lines.items() if name == view.name}
    wrong = [k for k in lines if not 0 <= k < count]
    if wrong:
        raise UsageError(f"a line of sector {wrong[0] + 1}, but the tube has {count}")
    if lines:
        fitted = fit_tube(view.shown, view.camera, family, fitted.tube, lines)
    return _Fit(view, fitted, lines)


def _again(fits: Mapping[int, _Fit], k: int, family: Family) -> _Fit:
    """Fit a picture once more, with what the others tell of the clamp's place."""
    own = fits[k]
    known = _told([other for j, other in sorted(fits.items()) if j != k], own)
    if known is None:
        return own
    view = own.view
    fitted = fit_tube(view.shown, view.camera, family, own.fitted.tube, own.lines, known, near=True)
    return replace(own, fitted=fitted)


def _told(others: Sequence[_Fit], own: _Fit) -> Known | None:
    """Put together what other pictures tell of the place; None where none agrees with this one."""
    here, spread = _place(own.fitted)
    total, weighted = np.zeros((4, 4)), np.zeros(4)
    for other in others:
        values, covariance = _place(other.fitted)
        if other.fitted.tube.place.hand != own.fitted.tube.place.hand:
            continue
        off = values - here
        off[2] = (off[2] + np.pi) % (2.0 * np.pi) - np.pi
        slack = np.diag((_SAME * _units(own)) ** 2)
        if float(off @ np.linalg.solve(covariance + spread + slack, off)) > _AGREE:
            continue
        weight = np.linalg.inv(covariance + np.diag((_FLOOR * _units(own)) ** 2))
        total += weight
        weighted += weight @ (here + off)
    if not total.any():
        return None
    mean: FloatArray = np.linalg.solve(total, weighted).astype(np.float64)
    return Known(mean, np.linalg.cholesky(total).T.astype(np.float64))


def _units(own: _Fit) -> FloatArray:
    """Give the units of a place: its last value is a share for one camera, mm for the other."""
    return np.array([1.0, 1.0, 1.0, own.view.camera.sigma / 0.02])


def _place(fitted: Fitted) -> tuple[FloatArray, FloatArray]:
    return fitted.tube.values()[:4], fitted.covariance[:4, :4]


def _seen(fit: _Fit, family: Family) -> Seen:
    """Read angles and lines off a fit."""
    fitted, view = fit.fitted, fit.view
    tube = fitted.tube
    outline = tube.outline(family)
    lines = view.camera.lines(outline, tube.place, tube.size)
    none = np.zeros(family.joints)
    planned = view.camera.lines(family.outline(view.bar, none, none), tube.place, tube.size)
    theta = family.theta_deg(tube.bar, tube.turn)
    count = family.joints
    spread = np.degrees(np.sqrt(np.diag(fitted.covariance)[5 : 5 + count]))
    sigma = np.hypot(spread, np.hypot(_MODEL_DEG, family.error_share * theta))
    states = [_state(fit, k, float(sigma[k])) for k in range(count)]
    angles = tuple(
        Angle(float("nan"), float("nan"), state)
        if state == "lost"
        else Angle(float(theta[k]), float(sigma[k]), state)
        for k, state in enumerate(states)
    )
    ends = [np.flatnonzero(family.sector == k)[[0, -1]] for k in range(count + 1)]
    middle = lines.mean(axis=0)
    wide = float(np.linalg.norm(lines[1, 0] - lines[0, 0]))
    return Seen(
        view.name, view.bar, angles, lines, planned, fitted.px[fitted.believed],
        np.array([middle[pair] for pair in ends]), outline.axis[family.middles],
        2.0 * float(outline.half[0]) / wide, fitted.rms_px,
    )  # fmt: skip


def _state(fit: _Fit, joint: int, sigma: float) -> State:
    """Say how a joint was measured; the root's direction is known from the other pictures, too."""
    faint = [k for k in (joint, joint + 1) if k and fit.fitted.share[k] < _LEAST_SHARE]
    if sigma > _MOST_SIGMA_DEG or any(k not in fit.lines for k in faint):
        return "lost"
    return "by hand" if any(fit.lines[k].by_hand for k in faint) else "measured"
