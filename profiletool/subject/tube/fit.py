"""The tube fitted to the edges of a picture: place, scale, the joints' turns and lengthenings.

Edges are looked for across the predicted lines of the wrapped sectors, within a reach that
narrows from round to round; each round is a robust linear fit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from profiletool.records.units import BoolArray, FloatArray, IntArray
from profiletool.subject.tube.camera import Camera, Place
from profiletool.subject.tube.edges import Shown, edges_across
from profiletool.subject.tube.family import Family

_REACH_MM = (5.0, 3.5, 2.5, 1.8, 1.3, 1.0, 0.8, 0.8, 0.8)
_WHOLE = 2  # rounds in which the model's pressure is fitted, and no joint by itself
_CLOSE = 5  # from this round on it is close, and what lies far off does not count at all
# Standard deviations before any edge is seen: of a joint's own turn, and of that over its angle;
# of a lengthening; of the model's pressure over itself.
_TURN_RAD, _TURN_SHARE, _GROW_MM, _BAR_SHARE = np.radians(1.0), 0.12, 1.0, 0.3
_MARGIN_MM, _SPACING_MM = 0.25, 0.5  # of the places that are looked at
_LEAST_PX, _MODEL_PX = 0.05, 0.15  # what edges scatter at best, and a model's own waves
_MOST_MM = 0.05  # of their scatter, once close: edges that scatter more are of something else
_TUKEY, _CAUCHY = 4.685, 2.385
_BELIEVED = 0.3  # of an edge's weight
_LAGS = 12  # places along a line, over which residuals may hang together


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
    turn, grow : (J,) rad, mm
        Of the joints, beyond the model's.
    """

    place: Place
    size: float
    bar: float
    turn: FloatArray
    grow: FloatArray

    def values(self) -> FloatArray:
        """All as one vector: x, y, heading, size, bar, turns, lengthenings."""
        at = self.place
        return np.array([at.x, at.y, at.heading, self.size, self.bar, *self.turn, *self.grow])

    def of(self, values: FloatArray) -> Tube:
        """Give the same with other values."""
        x, y, heading, size, bar = values[:5].tolist()
        turn, grow = np.split(values[5:], 2)
        return Tube(Place(x, y, heading, self.place.hand), size, bar, turn, grow)


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
    covariance : (5 + 2 J, 5 + 2 J)
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


@dataclass(frozen=True)
class _Rows:
    """Residuals (N,) px, their slopes by the values (N, V), and where they are from."""

    off: FloatArray
    slope: FloatArray
    px: FloatArray
    sector: IntArray
    group: IntArray
    seen: BoolArray
    px_per_mm: float


@dataclass(frozen=True)
class Gaps:
    """Residuals (N,) over their standard deviations, and their slopes (N, V) by the values."""

    off: FloatArray
    slope: FloatArray

    def plus(self, other: Gaps) -> Gaps:
        """Both together."""
        return Gaps(
            np.concatenate([self.off, other.off]), np.concatenate([self.slope, other.slope])
        )


def start_of(family: Family, place: Place, bar: float) -> Tube:
    """Begin with a tube as the model has it."""
    none = np.zeros(family.joints)
    return Tube(place, 0.0, bar, none, none)


def fit_tube(
    picture: Shown,
    camera: Camera,
    family: Family,
    start: Tube,
    lines: Mapping[int, Line] | None = None,
    known: Known | None = None,
    near: bool = False,
) -> Fitted:
    """Fit a tube to a picture's edges.

    Parameters
    ----------
    picture : Shown
    camera : Camera
    family : Family
    start : Tube
        Within some mm of where it lies.
    lines : mapping of int to Line, optional
        By sector.
    known : Known, optional
    near : bool
        Whether it starts from a fit of this very picture.
    """
    tube, given = start, lines or {}

    def beforehand(at: Tube) -> Gaps:
        return _prior(family, at, camera, known).plus(_hints(camera, family, at, given))

    rounds = tuple(enumerate(_REACH_MM))[_CLOSE if near else 0 :]
    for k, reach in rounds:
        rows = _rows(picture, camera, family, tube, reach)
        step, _, _ = _solve(rows, beforehand(tube), _free(family, k < _WHOLE), k < _CLOSE)
        tube = _kept(tube.of(tube.values() + step), family)
    rows, free, more = (
        _rows(picture, camera, family, tube, reach),
        _free(family, False),
        beforehand(tube),
    )
    step, weight, scale = _solve(rows, more, free, False)
    residual = rows.off - rows.slope @ step
    covariance = _covariance(rows, more, free, weight, residual)
    tube = _kept(tube.of(tube.values() + step), family)
    believed = weight > _BELIEVED
    share = np.array(
        [believed[rows.sector == k].mean() if (rows.sector == k).any() else 0.0
         for k in range(family.joints + 1)]
    )  # fmt: skip
    outline = camera.lines(family.outline(tube.bar, tube.turn, tube.grow), tube.place, tube.size)
    rms = float(np.sqrt(np.mean(residual[believed] ** 2))) if believed.any() else np.nan
    return Fitted(
        tube, covariance, rows.px[rows.seen], rows.sector[rows.seen], believed[rows.seen],
        share, rms, float(1.0 - picture.inside(outline, 0.0).mean()),
    )  # fmt: skip


def _kept(tube: Tube, family: Family) -> Tube:
    return replace(tube, bar=float(np.clip(tube.bar, 0.0, family.top)))


def _free(family: Family, whole: bool) -> BoolArray:
    """Which values are fitted: the model's pressure, or each joint by itself."""
    joints = np.full(2 * family.joints, not whole)
    return np.concatenate([[True] * 4, [whole], joints])


def _lines(camera: Camera, family: Family, tube: Tube) -> FloatArray:
    outline = family.outline(tube.bar, tube.turn, tube.grow)
    return camera.lines(outline, tube.place, tube.size)


def _slopes(camera: Camera, family: Family, tube: Tube, base: FloatArray) -> FloatArray:
    """Motion of both lines by each value: (V, 2, S, 2) px."""
    values = tube.values()
    steps = np.full(len(values), 1e-4)
    moved = []
    for k, step in enumerate(steps.tolist()):
        changed = values.copy()
        changed[k] += step
        moved.append((_lines(camera, family, tube.of(changed)) - base) / step)
    return np.array(moved)


def _rows(picture: Shown, camera: Camera, family: Family, tube: Tube, reach_mm: float) -> _Rows:
    base = _lines(camera, family, tube)
    slopes = _slopes(camera, family, tube, base)
    tangent = np.gradient(base, axis=1)
    tangent /= np.linalg.norm(tangent, axis=2, keepdims=True) + 1e-12
    normal = np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)
    across = base[1] - base[0]
    sense = np.sign((normal * across).sum(axis=2)) * np.array([[-1.0], [1.0]])
    normal = normal * sense[..., None]
    every = max(1, round(_SPACING_MM / float(family.along[1] - family.along[0])))
    places = np.flatnonzero(family.wrapped(_MARGIN_MM))
    places = places[places % every == 0]
    px_per_mm = float(np.median(np.linalg.norm(across, axis=1))) / (2.0 * family.radius)
    parts = []
    for side in (0, 1):
        at, out = base[side, places], normal[side, places]
        edges = edges_across(picture, at, out, reach_mm * px_per_mm, 0.5 * reach_mm * px_per_mm)
        slope = np.einsum("vsk,sk->sv", slopes[:, side, places], out)
        parts.append((edges.off, slope, at + edges.off[:, None] * out, edges.seen))
    off, slope, px, seen = (np.concatenate(part) for part in zip(*parts, strict=True))
    sector = np.tile(family.sector[places], 2)
    sides = np.repeat([0, 1], len(places))
    return _Rows(off, slope, px, sector, 2 * sector + sides, seen, px_per_mm)


def _hints(camera: Camera, family: Family, tube: Tube, lines: Mapping[int, Line]) -> Gaps:
    """Directions of given lines."""
    if not lines:
        return Gaps(np.zeros(0), np.zeros((0, len(tube.values()))))
    base = _lines(camera, family, tube)
    slopes = _slopes(camera, family, tube, base)
    off, slope = [], []
    for number, line in sorted(lines.items()):
        inside = np.flatnonzero(family.sector == number)
        a, b = inside[0], inside[-1]
        middle, moved = base.mean(axis=0), slopes.mean(axis=1)
        run, way = middle[b] - middle[a], moved[:, b] - moved[:, a]
        if line.across:
            m = family.middles[number]
            run, way = base[1, m] - base[0, m], slopes[:, 1, m] - slopes[:, 0, m]
        given = line.ends[1] - line.ends[0]
        gap = np.arctan2(given[1], given[0]) - np.arctan2(run[1], run[0])
        gap = (gap + 0.5 * np.pi) % np.pi - 0.5 * np.pi
        turn = (run[0] * way[:, 1] - run[1] * way[:, 0]) / float(run @ run)
        sigma = np.sqrt(2.0) * line.sigma_px / float(np.linalg.norm(given))
        off.append(gap / sigma)
        slope.append(turn / sigma)
    return Gaps(np.array(off), np.array(slope))


def _prior(family: Family, tube: Tube, camera: Camera, known: Known | None) -> Gaps:
    """What is thought of the values before any edge is seen."""
    theta = np.radians(np.abs(family.theta_deg(tube.bar, np.zeros(family.joints))))
    sigma = np.concatenate(
        [[1e3, 1e3, 10.0, camera.sigma, _BAR_SHARE * max(tube.bar, 0.1)],
         _TURN_RAD + _TURN_SHARE * theta, np.full(family.joints, _GROW_MM)]
    )  # fmt: skip
    off = -tube.values() / sigma
    off[[0, 1, 2, 4]] = 0.0
    rate = np.diag(1.0 / sigma)
    if known is None:
        return Gaps(off, rate)
    more = np.zeros((4, len(sigma)))
    more[:, :4] = known.root
    return Gaps(off, rate).plus(Gaps(known.root @ (known.values - tube.values()[:4]), more))


def _solve(
    rows: _Rows, more: Gaps, free: BoolArray, wide: bool
) -> tuple[FloatArray, FloatArray, float]:
    """Fit robustly; the step (V,), the weights (N,) of the edges, and their scatter, px."""
    slope = rows.slope[:, free]
    step = np.zeros(int(free.sum()))
    weight, scale = rows.seen.astype(float), 1.0
    for _ in range(8):
        residual = rows.off - slope @ step
        scale = _scatter(residual[rows.seen])
        if not wide:
            scale = min(scale, max(_MODEL_PX, _MOST_MM * rows.px_per_mm))
        z = residual / scale
        if wide:
            weight = rows.seen / (1.0 + (z / _CAUCHY) ** 2)
        else:
            weight = rows.seen * np.clip(1.0 - (z / _TUKEY) ** 2, 0.0, None) ** 2
        root = np.sqrt(weight) / scale
        A = np.concatenate([root[:, None] * slope, more.slope[:, free]])
        step = np.linalg.lstsq(A, np.concatenate([root * rows.off, more.off]), rcond=None)[0]
    whole = np.zeros(len(free))
    whole[free] = step
    return whole, weight, scale


def _scatter(residual: FloatArray) -> float:
    if not len(residual):
        return 1.0
    return max(_MODEL_PX, 1.4826 * float(np.median(np.abs(residual))))


def _covariance(
    rows: _Rows, more: Gaps, free: BoolArray, weight: FloatArray, residual: FloatArray
) -> FloatArray:
    """Covariance of the values; edges that hang together count for fewer."""
    believed = weight > _BELIEVED
    spread = float(np.sqrt(np.mean(residual[believed] ** 2))) if believed.any() else 1.0
    spread = max(spread, _LEAST_PX) * np.sqrt(_together(residual, believed, rows.group))
    A = (np.sqrt(weight) / spread)[:, None] * rows.slope[:, free]
    A = np.concatenate([A, more.slope[:, free]])
    found = np.zeros((len(free), len(free)))
    found[np.ix_(free, free)] = np.linalg.inv(A.T @ A)
    return found


def _together(residual: FloatArray, believed: BoolArray, group: IntArray) -> float:
    """By how much the variance of a mean is more than that of independent residuals."""
    square = float(np.mean(residual[believed] ** 2)) if believed.any() else 1.0
    total = 1.0
    for lag in range(1, _LAGS + 1):
        both = believed[lag:] & believed[:-lag] & (group[lag:] == group[:-lag])
        if both.sum() < 10:
            break
        shared = float(np.mean(residual[lag:][both] * residual[:-lag][both])) / square
        if shared <= 0.0:
            break
        total += 2.0 * shared
    return total
