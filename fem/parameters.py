"""The parameters of an actuator that its states are differentiated by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from fem.actuator import Actuator, Window
from fem.material import Constant, bulk_modulus, law

ANGLE_STEP, LENGTH_STEP, SHARE_STEP = 1e-5, 1e-4, 1e-4  # of the differences: rad, mm, 1
POISSON_STEP = 1e-6  # it counts by its distance from a half


@dataclass(frozen=True)
class Parameter:
    """A parameter of an actuator.

    Attributes
    ----------
    segment : int or None
        The stretch of the tube that it changes; None for the whole tube.
    step : float
        For differences, mm, rad or a share of itself.
    change : callable
        Changes an actuator by an amount.
    """

    segment: int | None
    step: float
    change: Callable[[Actuator, float], Actuator]


def families(
    count: int, *, apart: bool = False, tube: bool = True
) -> tuple[tuple[Parameter, ...], ...]:
    """Families of parameters that can be changed at once: no two have a ring in common.

    In order: each window's alpha, all windows' lengths, all wrapped sectors' lengths, the wall,
    the gauze; for ``count`` windows; each parameter by itself where they are to be kept ``apart``;
    wall and gauze only where the whole ``tube`` is asked for.
    """
    windows, wrapped = range(1, 2 * count, 2), range(0, 2 * count + 1, 2)
    together: tuple[tuple[Parameter, ...], ...] = (
        # The bricks of the whole tube end where the sectors do: they move with each alpha.
        *((Parameter(None, ANGLE_STEP, _alpha(k // 2)),) for k in windows),
        tuple(Parameter(k, LENGTH_STEP, _stretch(k)) for k in windows),
        tuple(Parameter(k, LENGTH_STEP, _stretch(k)) for k in wrapped),
    )
    if tube:
        wall, gauze = (LENGTH_STEP, _thicken), (SHARE_STEP, _stiffen)
        together += tuple((Parameter(None, step, change),) for step, change in (wall, gauze))
    return tuple((p,) for family in together for p in family) if apart else together


def rubber_constant(name: str) -> Parameter:
    """By a number of the rubber's law, as a share of itself; the other numbers are kept."""

    def change(actuator: Actuator, share: float) -> Actuator:
        number = actuator.rubber.constants[name]
        if isinstance(number, tuple):
            raise ValueError(f"{name} of {actuator.rubber.name} is not one number")
        return _with_rubber(actuator, **{name: (1.0 + share) * number})

    return Parameter(None, SHARE_STEP, change)


def poisson() -> Parameter:
    """By Poisson's ratio of the rubber at small strain, all constants but K kept."""

    def change(actuator: Actuator, amount: float) -> Actuator:
        mu, K = actuator.rubber.shear_modulus, actuator.rubber.bulk_modulus
        nu = (3.0 * K - 2.0 * mu) / (6.0 * K + 2.0 * mu)
        return _with_rubber(actuator, K=bulk_modulus(mu, nu + amount))

    return Parameter(None, POISSON_STEP, change)


def alpha_center(number: int) -> Parameter:
    """By the middle of a window's uncut sector; the model must be of the whole tube."""

    def change(actuator: Actuator, amount: float) -> Actuator:
        windows = list(actuator.windows)
        windows[number] = replace(windows[number], center=windows[number].center + amount)
        return replace(actuator, windows=tuple(windows))

    return Parameter(None, ANGLE_STEP, change)


def _with_rubber(actuator: Actuator, **constants: Constant) -> Actuator:
    rubber = actuator.rubber
    return replace(actuator, rubber=law(rubber.name, {**rubber.constants, **constants}))


def _thicken(actuator: Actuator, amount: float) -> Actuator:
    return replace(actuator, wall=actuator.wall + amount)


def _stiffen(actuator: Actuator, share: float) -> Actuator:
    gauze = replace(actuator.gauze, stiffness=(1.0 + share) * actuator.gauze.stiffness)
    return replace(actuator, gauze=gauze)


def _alpha(number: int) -> Callable[[Actuator, float], Actuator]:
    def change(actuator: Actuator, amount: float) -> Actuator:
        windows = list(actuator.windows)
        windows[number] = replace(windows[number], alpha=windows[number].alpha + amount)
        return replace(actuator, windows=tuple(windows))

    return change


def _stretch(segment: int) -> Callable[[Actuator, float], Actuator]:
    """Lengthen segment 2 k (wrapped sector k) or 2 k + 1 (window k); all beyond moves on."""

    def change(actuator: Actuator, amount: float) -> Actuator:
        def moved(number: int, w: Window) -> Window:
            own = 2 * number + 1
            if own == segment:
                return replace(w, centre=w.centre + 0.5 * amount, openF=w.openF + amount)
            return replace(w, centre=w.centre + amount) if own > segment else w

        windows = tuple(moved(number, w) for number, w in enumerate(actuator.windows))
        return replace(actuator, length=actuator.length + amount, windows=windows)

    return change
