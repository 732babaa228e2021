"""Residuals of a tube in a picture, and their slopes by its values: edges, lines, what is known."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from profiletool.records.units import BoolArray, FloatArray, IntArray
from profiletool.subject.tube.camera import Camera
from profiletool.subject.tube.edges import Edges, Shown, edge_pairs, edges_across
from profiletool.subject.tube.family import Family
from profiletool.subject.tube.values import Known, Line, Tube

# Standard deviations before any edge is seen: of a joint's own turn, and of that over its angle;
# of a lengthening; of the model's pressure over itself; of a shift. In another rubber or gauze a
# cut bends a little nearer one of its ends: what lies beyond is shifted, the more it turns.
_TURN_RAD, _TURN_SHARE, _GROW_MM, _BAR_SHARE = np.radians(1.0), 0.12, 1.0, 0.3
_SHIFT_MM, _SHIFT_MM_RAD = 0.01, 0.1
_MARGIN_MM, _SPACING_MM = 0.25, 0.5  # of the places that are looked at
_WIDTH_MM = 0.06  # standard deviation of the tube's width along it
_WIDE_MM, _SPARSE_MM = 1.5, 1.5  # a reach, from which on they stand that far apart


@dataclass(frozen=True)
class Rows:
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


def _lines(camera: Camera, family: Family, tube: Tube) -> FloatArray:
    return camera.lines(tube.outline(family), tube.place, tube.size)


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


def edge_rows(picture: Shown, camera: Camera, family: Family, tube: Tube, reach_mm: float) -> Rows:
    """Look for edges across both lines of the wrapped sectors, within a reach."""
    base = _lines(camera, family, tube)
    slopes = _slopes(camera, family, tube, base)
    tangent = np.gradient(base, axis=1)
    tangent /= np.linalg.norm(tangent, axis=2, keepdims=True) + 1e-12
    normal = np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)
    across = base[1] - base[0]
    sense = np.sign((normal * across).sum(axis=2)) * np.array([[-1.0], [1.0]])
    normal = normal * sense[..., None]
    spacing = _SPACING_MM if reach_mm < _WIDE_MM else _SPARSE_MM
    every = max(1, round(spacing / float(family.along[1] - family.along[0])))
    places = np.flatnonzero(family.wrapped(_MARGIN_MM))
    places = places[places % every == 0]
    px_per_mm = float(np.median(np.linalg.norm(across, axis=1))) / (2.0 * family.radius)
    reach, at_both, out_both = reach_mm * px_per_mm, base[:, places], normal[:, places]
    found: tuple[Edges, ...]
    if reach_mm < _WIDE_MM:
        found = edge_pairs(picture, at_both, out_both, reach, 0.5 * reach, _WIDTH_MM * px_per_mm)
    else:
        found = tuple(
            edges_across(picture, at, out, reach, 0.5 * reach)
            for at, out in zip(at_both, out_both, strict=True)
        )
    parts = []
    for side, edges in enumerate(found):
        at, out = at_both[side], out_both[side]
        slope = np.einsum("vsk,sk->sv", slopes[:, side, places], out)
        parts.append((edges.off, slope, at + edges.off[:, None] * out, edges.seen))
    off, slope, px, seen = (np.concatenate(part) for part in zip(*parts, strict=True))
    sector = np.tile(family.sector[places], 2)
    sides = np.repeat([0, 1], len(places))
    return Rows(off, slope, px, sector, 2 * sector + sides, seen, px_per_mm)


def line_gaps(camera: Camera, family: Family, tube: Tube, lines: Mapping[int, Line]) -> Gaps:
    """Compare the directions of given lines."""
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


def turn_sigma(family: Family, bar: float) -> FloatArray:
    """Give the usual deviations of the joints' turns from the model's, (J,) rad."""
    theta = np.radians(np.abs(family.theta_deg(bar, np.zeros(family.joints))))
    return np.asarray(_TURN_RAD + _TURN_SHARE * theta)


def prior_gaps(family: Family, tube: Tube, camera: Camera, known: Known | None) -> Gaps:
    """Say what is thought of the values before any edge is seen."""
    theta = np.radians(np.abs(family.theta_deg(tube.bar, tube.turn)))
    sigma = np.concatenate(
        [[1e3, 1e3, 10.0, camera.sigma, _BAR_SHARE * max(tube.bar, 0.1)],
         turn_sigma(family, tube.bar), np.full(family.joints, _GROW_MM),
         _SHIFT_MM + _SHIFT_MM_RAD * theta]
    )  # fmt: skip
    off = -tube.values() / sigma
    off[[0, 1, 2, 4]] = 0.0
    rate = np.diag(1.0 / sigma)
    if known is None:
        return Gaps(off, rate)
    more = np.zeros((4, len(sigma)))
    more[:, :4] = known.root
    return Gaps(off, rate).plus(Gaps(known.root @ (known.values - tube.values()[:4]), more))
