"""Dynamic programming over lines and the joints between them.

The search is exact for its discretisation: an edge is left out only if it alone costs more than
``most_cost``, so a path found to cost less than that has none of them as a rival.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from profiletool.bending.model import Chain, Model, centers_of
from profiletool.joints.bounds import Limits
from profiletool.joints.correction.parameters import PosedChain
from profiletool.joints.expected import BUILT_WEIGHT, ErrorSizes, slopes_of
from profiletool.joints.misfit import Objective, objective_of
from profiletool.joints.optimal.bends import Bends, tabulate
from profiletool.joints.optimal.edges import Edges, Priced, edges_of, price, summed_cost
from profiletool.joints.optimal.lines import CandidateLines, Discretisation, lines_of
from profiletool.records.frames import Pose, base_axes
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray, IntArray

MOST_JOINTS = 24
_FIRST_MOST_MM = 1.0  # RMS that edges may cost at first
_WIDEN = 9.0
_WIDENED = 3
_USUAL_ALPHA = float(np.radians(96.0))  # at which angles grow with the pressure as they do


@dataclass(frozen=True)
class PathJoint:
    """One joint of a path: the lines before and behind it; ``errors`` as in `Priced`."""

    sense: float
    start: int
    end: int
    turn: float
    before: float
    after: float
    openF: float
    errors: float


@dataclass(frozen=True)
class SearchResult:
    """The least cost for every number of joints at every pressure, and the way back along paths.

    Attributes
    ----------
    pressure : (P,) MPa
    openF : (K,) mm
    cost : (P, J) mm³
        For 1 to J joints; infinite where no path is known.
    errors : (P, J) mm³
        The part of the cost that errors of a build make.
    most_cost : float
        Costs below it are those of the optimum.
    """

    lines: CandidateLines
    senses: tuple[Edges, ...]
    pressure: FloatArray
    openF: FloatArray
    bends: tuple[tuple[Bends, ...], ...]
    priced: tuple[tuple[Priced, ...], ...]
    totals: tuple[FloatArray, ...]
    cost: FloatArray
    errors: FloatArray
    most_cost: float
    objective: Objective

    def path(self, pressure: int, joints: int) -> tuple[PathJoint, ...]:
        """Walk back the best path of so many joints at a pressure (an index)."""
        totals, priced = self.totals[pressure], self.priced[pressure]
        line = int(np.argmin(totals[joints] + _tails(self.lines, self.objective)))
        steps: list[PathJoint] = []
        for n in range(joints, 0, -1):
            best, step = np.inf, None
            for edges, prices in zip(self.senses, priced, strict=True):
                low, high = np.searchsorted(edges.end, [line, line + 1])
                total = totals[n - 1][edges.start[low:high]] + prices.cost[low:high]
                if high > low and total.min() < best:
                    best, e = float(total.min()), low + int(np.argmin(total))
                    step = PathJoint(
                        edges.sense,
                        int(edges.start[e]),
                        line,
                        float(edges.turn[e]),
                        float(edges.before[e]),
                        float(edges.after[e]),
                        float(self.openF[prices.cut[e]]),
                        float(prices.errors[e]),
                    )
            assert step is not None
            steps.append(step)
            line = step.start
        return tuple(steps[::-1])

    def posed_chain(
        self, pressure: int, joints: int, model: Model, profile: Profile, limits: Limits
    ) -> PosedChain:
        """Give the actuator of the best path; its end reaches as far as the profile's."""
        steps = self.path(pressure, joints)
        sense, turn, openF, before, after = (
            np.array([getattr(step, name) for step in steps])
            for name in ("sense", "turn", "openF", "before", "after")
        )
        cut = np.searchsorted(self.openF, openF - 1e-9)
        reach = np.empty(joints)
        for n in range(joints):
            bends = self.bends[pressure][0 if sense[n] > 0.0 else 1]
            angles = np.linspace(bends.least[cut[n]], bends.most[cut[n]], bends.reach.shape[1])
            reach[n] = np.interp(turn[n], angles, bends.reach[cut[n]])
        P = float(self.pressure[pressure])
        alpha = np.nan_to_num(model.alpha_for(openF, turn, P), nan=model.alpha[0])
        # Between windows: what both joints leave of their common line.
        wrapped = after[:-1] - reach[:-1] + before[1:] - reach[1:]
        place = float(before[0] - reach[0] + 0.5 * openF[0])
        root = max(limits.root_mm, 0.5 * float(openF[0]) + limits.wrap_mm, place)
        F = wrapped + 0.5 * (openF[1:] + openF[:-1])
        centre = root + np.concatenate([[0.0], np.cumsum(F)])
        lines, last = self.lines, steps[-1].end
        goal = int(np.flatnonzero(lines.weight)[-1])
        end = float(after[-1] - reach[-1] + lines.along[last, goal])
        length = float(centre[-1]) + 0.5 * float(openF[-1]) + max(end, limits.end_mm)
        heading = float(profile.heading[0]) + profile.sign * float(lines.turn[steps[0].start])
        along, _ = base_axes(heading, profile.sign)
        x, y = lines.point[steps[0].start] + (place - root) * along
        pose = Pose(float(x), float(y), float(np.degrees(heading)))
        return PosedChain(Chain(centre, openF, alpha, centers_of(sense), length), P, pose)


def search(
    profile: Profile,
    model: Model,
    openF: FloatArray,
    limits: Limits,
    interference: float,
    grid: Discretisation,
    most_joints: int,
    sizes: ErrorSizes | None = None,
) -> SearchResult:
    """Find the least cost for 1 to ``most_joints`` joints at every pressure of a grid.

    Parameters
    ----------
    profile : Profile
    model : Model
    openF : (K,) array, mm
        The cuts to choose from.
    limits : Limits
    interference : float, mm
        How deep the tube may lie in the object before it costs more.
    grid : Discretisation
    most_joints : int
    sizes : ErrorSizes, optional
        Of a build's errors; without them the nominal shape alone counts.
    """
    lines, objective = lines_of(profile, limits, grid), objective_of(interference)
    pressure = _pressures(limits, grid)
    bends = tuple(
        tuple(tabulate(model, float(P), openF, sense, sizes) for sense in (1.0, -1.0))
        for P in pressure
    )
    most = _FIRST_MOST_MM**2 * profile.length_mm
    for attempt in range(_WIDENED):
        senses = [
            edges_of(lines, sense, [of[k] for of in bends], limits.wrap_mm, objective, most)
            for k, sense in enumerate((1.0, -1.0))
        ]
        priced, totals = [], []
        for of in bends:
            prices = [
                price(edges, lines, table, openF, limits.wrap_mm, objective)
                for edges, table in zip(senses, of, strict=True)
            ]
            priced.append(tuple(prices))
            totals.append(_totals(lines, senses, prices, most_joints))
        tail = _tails(lines, objective)
        cost = np.array([(total[1:] + tail).min(axis=1) for total in totals])
        if cost.min() <= most or attempt == _WIDENED - 1:
            break
        most *= _WIDEN
    found = SearchResult(
        lines, tuple(senses), pressure, openF, bends, tuple(priced), tuple(totals), cost,
        np.zeros_like(cost), most, objective,
    )  # fmt: skip
    return found if sizes is None else _with_errors(found, model, sizes)


def _with_errors(found: SearchResult, model: Model, sizes: ErrorSizes) -> SearchResult:
    """Tell the errors' part of the costs, and add that of the pressure, which paths share."""
    errors = np.zeros_like(found.cost)
    for p, n in np.argwhere(np.isfinite(found.cost)):
        errors[p, n] = sum(step.errors for step in found.path(int(p), int(n) + 1))
    alpha, pressure = np.clip(_USUAL_ALPHA, *model.alpha), found.pressure[:, None]
    slope = slopes_of(model, found.openF, alpha, pressure).pressure
    growth = np.mean(slope / model.theta(found.openF, alpha, pressure), axis=1)
    common = BUILT_WEIGHT * found.lines.swing2 * (sizes.pressure * growth[:, None]) ** 2
    return replace(found, cost=found.cost + common, errors=errors + common)


def _pressures(limits: Limits, grid: Discretisation) -> FloatArray:
    """Give the pressures of the grid, the highest one among them."""
    low, high = limits.pressure
    low = min(max(low, grid.least_pressure), high)
    count = int(np.floor((high - low) / grid.pressure_step + 1e-9)) + 1
    return high - grid.pressure_step * np.arange(count, dtype=float)[::-1]


def _tails(lines: CandidateLines, objective: Objective) -> FloatArray:
    """Cost of going straight on from every line's place: (N,)."""
    summed = summed_cost(lines, objective)
    return summed[:, -1] - summed[np.arange(len(lines.place)), lines.place + 1]


def _totals(
    lines: CandidateLines, senses: list[Edges], prices: list[Priced], most_joints: int
) -> FloatArray:
    """Least cost of reaching every line with 0 to ``most_joints`` joints: (J + 1, N)."""
    count = len(lines.place)
    totals = np.full((most_joints + 1, count), np.inf)
    totals[0, : lines.base] = 0.0
    groups: list[tuple[IntArray, IntArray, IntArray, FloatArray]] = []
    for edges, priced in zip(senses, prices, strict=True):
        finite = np.flatnonzero(np.isfinite(priced.cost))
        if finite.size:
            end = edges.end[finite]
            first = np.flatnonzero(np.append(True, np.diff(end) > 0))
            groups.append((edges.start[finite], first, end[first], priced.cost[finite]))
    for n in range(most_joints):
        for start, first, end, cost in groups:
            least = np.minimum.reduceat(totals[n][start] + cost, first)
            totals[n + 1, end] = np.minimum(totals[n + 1, end], least)
    return totals
