"""How angles and the object-facing line answer to small changes, by direct differentiation.

At equilibrium R(x; p) = 0, so dx/dp = -K^-1 dR/dp with the tangent K at the state itself: one
back-substitution a parameter. dR/dp at fixed positions is taken by central differences of the
forces alone: the mesh keeps its layers and moves with the parameter.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fem import blas, measure
from fem.actuator import Actuator, Window
from fem.assembly import System
from fem.errors import FemError
from fem.mesh import Mesh, remesh

FloatArray = NDArray[np.float64]

_ANGLE, _LENGTH = 1e-5, 1e-4  # steps of the differences: rad, mm


@dataclass(frozen=True)
class Rate:
    """Derivatives by one parameter.

    Attributes
    ----------
    theta : (joints,) rad per unit
    facing : (layers + 1, 3) mm per unit
        Of the object-facing line at the rings, which move along the tube with the parameter.
    z : (layers + 1,) mm per unit
        Of the rings' places along the tube.
    volume : float, mm^3 per unit
    """

    theta: FloatArray
    facing: FloatArray
    z: FloatArray
    volume: float


@dataclass(frozen=True)
class Sensitivities:
    """Derivatives of one state by its inputs.

    Attributes
    ----------
    pressure : Rate, per MPa
    alpha : tuple of Rate, per rad
        By each joint's alpha_closed.
    openF : tuple of Rate, per mm
        By each cut's length, the wrapped lengths kept.
    wrapped : tuple of Rate, per mm
        By the length of each wrapped sector, the cuts' lengths kept; the first is the root's.
    """

    pressure: Rate
    alpha: tuple[Rate, ...]
    openF: tuple[Rate, ...]
    wrapped: tuple[Rate, ...]


def sensitivities(mesh: Mesh, x: FloatArray, pressure: float, threads: int = 2) -> Sensitivities:
    """Differentiate an equilibrium.

    Parameters
    ----------
    mesh : Mesh
    x : (layers + 1, ring + mid, 3)
        Nodal positions in equilibrium, mm.
    pressure : float, MPa
    threads : {1, 2}

    Raises
    ------
    FemError
        Where the tangent is singular or the positions are no equilibrium.
    """
    actuator, count = mesh.actuator, len(mesh.actuator.windows)
    with blas.one_thread():
        system = System(mesh, threads)
        try:
            forces, inverse = system.factor(x, pressure)
            if inverse is None:
                raise FemError("a brick is turned inside out")
            push = pressure * np.linalg.norm(forces.volume_gradient)
            if np.linalg.norm(forces.residual(pressure)) > 1e-4 * push:
                raise FemError("these positions are not in equilibrium")

            def rate(rhs: FloatArray, near: Callable[[float], Mesh], step: float) -> Rate:
                du = inverse.solve(rhs)
                moved = system.expand(x, du)
                # The line and the angles by differences along the known motion.
                size = min(1e-4 / max(float(np.abs(moved).max()), 1e-12), step)
                ends = [near(sign * size) for sign in (1.0, -1.0)]
                theta = [
                    _angles(mesh, x + sign * size * moved)
                    for sign, mesh in zip((1.0, -1.0), ends, strict=True)
                ]
                return Rate(
                    theta=(theta[0] - theta[1]) / (2.0 * size),
                    facing=measure.surface_line(mesh, moved, np.radians(270.0)),
                    z=(ends[0].z - ends[1].z) / (2.0 * size),
                    volume=(2.0 if mesh.half else 1.0) * float(forces.volume_gradient @ du),
                )

            def by(change: Callable[[Actuator, float], Actuator], step: float) -> Rate:
                def near(amount: float) -> Mesh:
                    return remesh(mesh, change(actuator, amount))

                pulls = []
                for sign in (1.0, -1.0):
                    other = System(near(sign * step), threads=1)
                    pulls.append(other.forces(x).internal)
                return rate(-(pulls[0] - pulls[1]) / (2.0 * step), near, step)

            return Sensitivities(
                pressure=rate(forces.volume_gradient, lambda _: mesh, 1.0),
                alpha=tuple(by(_alpha(k), _ANGLE) for k in range(count)),
                openF=tuple(by(_stretch(2 * k + 1), _LENGTH) for k in range(count)),
                wrapped=tuple(by(_stretch(2 * k), _LENGTH) for k in range(count + 1)),
            )
        finally:
            system.close()


def _angles(mesh: Mesh, x: FloatArray) -> FloatArray:
    return measure.joint_angles(mesh, x, measure.sectors(mesh, measure.lines(mesh, x)))


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
