"""The path of equilibria as the pressure rises: steps, cut-backs, limit points.

A generator of equilibria, apart from Newton's method: it predicts the next state by
extrapolation in the chart of sections, sizes the step by how far off the last prediction was,
and reaches the asked pressures exactly. Where no equilibrium is found ahead it goes on by
volume, under which a balloon is stable, and so finds out whether the pressure has a maximum.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem.arrays import FloatArray
from fem.assembly import System
from fem.equilibrium import Critical, Equilibrium, lagrange, peak, potential, spread
from fem.errors import Attempt, NotConverged
from fem.newton import Correction, correct, descend
from fem.sections import Chart, Pose

_ORDER = 2  # of the extrapolation
_SHRINK, _GROW = 0.3, 2.5
_FLAT = 2e-3  # the states around a maximum lie within this share of its pressure
_FREE = 1e-4  # of the stored energy: what a state may set free without having jumped
_FAILED = 2  # steps shortened in vain, after which it tries the energy
_LIMIT_STEPS = 60  # by volume, before it gives up looking for a maximum


@dataclass(frozen=True)
class Options:
    """How the path is followed.

    Attributes
    ----------
    tolerance, before, between : float
        Residual over the pressure's forces at the last asked pressure, at those asked before it,
        and at those in between.
    aim : float
        Residual that a prediction may have.
    first, smallest : float
        First step, and the step below which something must be in the way, over the rubber's
        shear modulus.
    stable : bool
        Whether a state that is not stable under pressure ends the path.
    beyond : float
        How much further to follow the path by volume past a limit point, as a share of the
        volume there.
    ahead : float
        How far beyond the last asked pressure to look for what ends the path, MPa.
    """

    tolerance: float = 1e-6
    before: float = 3e-3
    between: float = 3e-3
    aim: float = 0.15
    first: float = 0.02
    smallest: float = 2e-3
    stable: bool = True
    beyond: float = 0.0
    ahead: float = 0.0


DEFAULT_OPTIONS = Options()


class Path:
    """The path of one system from rest.

    Attributes
    ----------
    history : list of Attempt
        All that was tried so far.
    critical : Critical or None
        What ended the path before the last asked pressure.
    """

    def __init__(self, system: System, chart: Chart, options: Options) -> None:
        self._system, self._chart, self._options = system, chart, options
        self._states: list[Equilibrium] = []
        self._careful = False
        self._unstable = False  # whether an unstable equilibrium was found ahead
        self.history: list[Attempt] = []
        self.critical: Critical | None = None

    def follow(self, pressures: Sequence[float]) -> Iterator[Equilibrium]:
        """Yield equilibria through the asked pressures (rising, MPa), and a little ahead.

        Ends early, with ``critical`` set, where the path loses its stability.

        Raises
        ------
        NotConverged
        """
        options = self._options
        mu = self._system.mesh.actuator.rubber.shear_modulus
        step, pressure, failed = options.first * mu, 0.0, 0
        beyond = [pressures[-1] + options.ahead] if pressures and options.ahead > 0.0 else []
        for number, target in enumerate([*pressures, *beyond], start=1):
            while pressure < target:
                count = max(1, int(np.ceil((target - pressure) / step - 1e-6)))
                asked = count == 1 and number <= len(pressures)
                trial = target if count == 1 else pressure + (target - pressure) / count
                allowed = options.before if number < len(pressures) else options.tolerance
                state, first = self._try(trial, None, allowed if asked else None)
                if state is not None:
                    step = (trial - pressure) * _rate(options.aim / first)
                    self._careful = step < 5.0 * options.smallest * mu
                    pressure, failed = trial, 0
                    yield state
                    continue
                failed += 1
                shorter = 0.4 * (trial - pressure)
                last = shorter < options.smallest * mu
                if last or failed == _FAILED:
                    state = self._settle(trial, asked)
                if state is not None:
                    step = max(trial - pressure, options.smallest * mu)
                    pressure, failed = trial, 0
                    yield state
                elif last:
                    step, failed = options.smallest * mu, 0
                    yield from self._by_volume(trial, shorter)
                    if self.critical is not None:
                        return
                    pressure = self._states[-1].pressure
                else:
                    step = shorter

    def _try(
        self, pressure: float, volume: float | None, allowed: float | None
    ) -> tuple[Equilibrium | None, float]:
        """Predict and correct; give the equilibrium and the prediction's residual.

        ``allowed`` is the residual that an asked state may have, None for one in between.
        """
        asked, tolerance = allowed is not None, allowed or self._options.between
        if self._careful or not self._states:
            tolerance = self._options.tolerance
        pose, pressure = self._predict(pressure, volume)
        done = correct(self._system, self._chart, pose, pressure, tolerance, volume)
        outcome: str = done.outcome
        negative = done.negative
        if outcome == "converged" and negative:
            # Counted on the way there: what counts is the state itself.
            _, inverse = self._system.factor(done.pose.x, done.pressure)
            done = replace(done, inverse=inverse)
            negative = done.negative
            if negative and volume is None and self._options.stable:
                outcome = "unstable"
                self._unstable = True
        self._note(done, outcome)
        if outcome != "converged":
            self._careful = True  # what is extrapolated from must be right from now on
            return None, done.first
        return self._keep(done, asked, by_volume=volume is not None), done.first

    def _settle(self, pressure: float, asked: bool) -> Equilibrium | None:
        """Let the last state settle at a slightly higher pressure, downhill in the energy.

        None where that leads nowhere, or to a state that no path leads to: on a path the energy
        U - p V sinks by the integral of V over p. What it sinks by more is set free in a jump.
        """
        if not self._states:
            return None
        last = self._states[-1]
        done = descend(self._system, self._chart, last.pose, pressure, self._options.tolerance)
        outcome: str = done.outcome
        if outcome == "converged":
            sunk = potential(last.forces, last.pressure) - potential(done.forces, pressure)
            free = sunk - done.forces.volume * (pressure - last.pressure)
            if free > _FREE * last.forces.energy:
                outcome = "unstable"
                self._unstable = True
        self._note(done, outcome)
        if outcome != "converged":
            return None
        return self._keep(done, asked)

    def _note(self, done: Correction, outcome: str) -> None:
        self.history.append(
            Attempt(done.pressure, done.iterations, done.factored, done.residual, outcome)
        )

    def _keep(self, done: Correction, asked: bool, *, by_volume: bool = False) -> Equilibrium:
        compliance = np.nan
        if by_volume or len(self._states) < 2:
            flow = done.flow
            compliance = float(done.forces.volume_gradient @ flow)
            if not self._states:
                x = done.pose.x
                self._flow = self._chart.increment(done.pose, self._system.expand(x, flow))
        state = Equilibrium(
            done.pressure, done.pose, done.forces, compliance, done.residual, asked, done.negative
        )
        self._states = [*self._states[-_ORDER:], state]
        return state

    def _predict(self, pressure: float, volume: float | None) -> tuple[Pose, float]:
        """Extrapolate the last states: a polynomial in the pressure, or in the volume."""
        chart, states = self._chart, self._states
        if not states:
            return chart.taut(2.0 * self._system.mesh.actuator.gauze.transition), pressure
        last = states[-1]
        if len(states) == 1:
            return chart.move(last.pose, self._flow * (pressure - last.pressure)), pressure
        by_pressure = volume is None
        at = pressure if volume is None else volume
        places = np.array([e.pressure if by_pressure else e.forces.volume for e in states])
        weights = lagrange(places, at)
        increment = sum(
            w * chart.difference(last.pose, e.pose)
            for w, e in zip(weights[:-1], states[:-1], strict=True)
        )
        if not by_pressure:
            pressure = float(weights @ np.array([e.pressure for e in states]))
        return chart.move(last.pose, np.asarray(increment)), pressure

    def _by_volume(self, blocked: float, step: float) -> Iterator[Equilibrium]:
        """Go on by volume from the last state, past what blocks the pressure.

        Returns once the pressure is above ``blocked`` (nothing was in the way but a hard step)
        or sets ``critical``.
        """
        if len(self._states) < 2:
            raise self._failure(blocked)
        self._careful = True
        before, last = self._states[-2:]
        softness = (last.forces.volume - before.forces.volume) / (last.pressure - before.pressure)
        grow = max(softness * step, 1e-5 * last.forces.volume)
        least = 1e-3 * grow
        end = np.inf
        for _ in range(_LIMIT_STEPS):
            before = self._states[-1]
            volume = before.forces.volume + grow
            allowed = self._options.tolerance if self.critical is not None else None
            state, first = self._try(before.pressure, min(volume, end), allowed)
            if state is None:
                grow *= 0.4
                if grow < least:
                    self._give_up(blocked)
                    return
                continue
            if self.critical is not None:
                yield state
                if volume >= end:
                    return
            elif state.compliance < 0.0 and spread(self._states) > _FLAT:
                self._states.pop()  # too far beyond the maximum to say where it is
                grow *= 0.4
                continue
            elif state.compliance < 0.0:
                self.critical = Critical("limit point", peak(self._states))
                end = before.forces.volume * (1.0 + self._options.beyond)
                if volume >= end:
                    return
                yield state
            elif state.negative:
                self.critical = Critical("bifurcation", before.pressure)
                return
            elif state.pressure > blocked:
                yield state
                return
            else:
                yield state
            grow *= min(2.0, _rate(self._options.aim / first))
        self._give_up(blocked)

    def _give_up(self, blocked: float) -> None:
        """End the path: where stability is known to be lost ahead, that is what ended it."""
        if self.critical is None and self._unstable:
            self.critical = Critical("bifurcation", self._states[-1].pressure)
        if self.critical is None:
            raise self._failure(blocked)

    def _failure(self, pressure: float) -> NotConverged:
        reached = self._states[-1].pressure if self._states else 0.0
        last = self.history[-1]
        return NotConverged(
            f"no equilibrium found at {10.0 * pressure:.3f} bar (last outcome: {last.outcome}); "
            f"the last state is at {10.0 * reached:.3f} bar",
            tuple(self.history),
            reached,
        )

    _flow: FloatArray  # per MPa, at the first state


def _rate(share: float) -> float:
    """How much longer the next step may be when the prediction was off by 1 / share of the aim."""
    return float(np.clip(min(share, 1e9) ** (2.0 / 3.0), _SHRINK, _GROW))
