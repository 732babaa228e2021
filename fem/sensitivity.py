"""Derivatives of angles and of the object-facing line, by direct differentiation.

At equilibrium R(x; p) = 0, so dx/dp = -K^-1 dR/dp with the tangent K at the state itself: one
back-substitution a parameter. dR/dp at fixed positions is taken by central differences of the
forces alone: the mesh keeps its layers and moves with the parameter. As each parameter is felt by
its own segment of the tube alone, one pair of forces serves all joints.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fem import blas, measure
from fem.actuator import Actuator
from fem.arrays import FloatArray
from fem.assembly import Forces, System
from fem.errors import FemError
from fem.items import MakeItem
from fem.mesh import Mesh, alike, make_mesh, remesh
from fem.parameters import LENGTH_STEP, Parameter, families
from fem.rates import Rate, Sensitivities
from fem.transfer import settle


def _unknown(like: Rate) -> Rate:
    return Rate(*(np.nan * value for value in vars(like).values()))


def _by_parameter(rates: Sequence[Rate], count: int) -> Sensitivities:
    """Sort rates: by pressure, ``count`` sectors and cuts, wrapped lengths, wall, gauze.

    The last two are not known where they are not there.
    """
    if len(rates) == 3 * count + 2:
        rates = [*rates, *[_unknown(rates[0])] * 2]
    return Sensitivities(
        pressure=rates[0],
        alpha=tuple(rates[1 : count + 1]),
        openF=tuple(rates[count + 1 : 2 * count + 1]),
        wrapped=tuple(rates[2 * count + 1 : -2]),
        wall=rates[-2],
        gauze=rates[-1],
    )


def sensitivities(
    mesh: Mesh,
    x: FloatArray,
    pressure: float,
    threads: int = 2,
    *,
    angles: bool = True,
    tube: bool = True,
    extra: Sequence[MakeItem] = (),
) -> Sensitivities:
    """Differentiate an equilibrium.

    Parameters
    ----------
    mesh : Mesh
    x : (layers + 1, ring + mid, 3)
        Nodal positions in equilibrium, mm.
    pressure : float, MPa
    threads : {1, 2}
    angles : bool
        Whether to differentiate the joint angles and the volume too, half of the work; they are
        NaN otherwise.
    tube : bool
        Whether to differentiate by the wall and the gauze, too; those are NaN otherwise.
    extra : sequence of MakeItem
        What contributes to the energy beside bricks, gauze and air; see `fem.items`.

    Returns
    -------
    Sensitivities

    Raises
    ------
    FemError
        Where the tangent is singular or the positions are no equilibrium.
    """
    count = len(mesh.actuator.windows)
    changes = families(count, apart=bool(extra), tube=tube)  # see `_pulls`
    rates = _rates(mesh, x, pressure, changes, threads, angles, extra)
    return _by_parameter(rates, count)


def rates_by(
    mesh: Mesh,
    x: FloatArray,
    pressure: float,
    parameters: Sequence[Parameter],
    threads: int = 2,
    extra: Sequence[MakeItem] = (),
) -> tuple[Rate, ...]:
    """Differentiate an equilibrium by parameters of the caller's choice.

    Parameters
    ----------
    mesh, x, pressure, threads, extra
        As in `sensitivities`.
    parameters : sequence of Parameter
        Such as `fem.parameters.rubber_constant`, `poisson` and `alpha_center`.

    Returns
    -------
    tuple of Rate
        By each parameter, with angles and volume.

    Raises
    ------
    FemError
        As `sensitivities` does, and where a parameter leads out of the plane of a half model.
    """
    for parameter in parameters:
        if mesh.half and not parameter.change(mesh.actuator, parameter.step).in_plane:
            raise FemError("half of a tube cannot leave its plane: model it whole")
    changes = [(parameter,) for parameter in parameters]
    return tuple(_rates(mesh, x, pressure, changes, threads, True, extra)[1:])


def _rates(
    mesh: Mesh,
    x: FloatArray,
    pressure: float,
    changes: Sequence[Sequence[Parameter]],
    threads: int,
    angles: bool,
    extra: Sequence[MakeItem],
) -> list[Rate]:
    """Differentiate by the pressure, and by families of parameters."""
    with blas.one_thread():
        system = System(mesh, threads, extra)
        try:
            forces, inverse = system.factor(x, pressure)
            if inverse is None:
                raise FemError("a brick is turned inside out")
            push = pressure * np.linalg.norm(forces.volume_gradient)
            if np.linalg.norm(forces.residual(pressure)) > 1e-4 * push:
                raise FemError("these positions are not in equilibrium")
            rhs = [forces.volume_gradient]
            for family in changes:
                rhs += _pulls(system, x, pressure, family)
            flows = inverse.solve(np.array(rhs))
            every = [None, *(change for family in changes for change in family)]
            return [
                _rate(system, x, forces, du, change, angles)
                for du, change in zip(flows, every, strict=True)
            ]
        finally:
            system.close()


def _enclosed(mesh: Mesh, x: FloatArray) -> float:
    """Volume enclosed at nodal positions x, mm^3 (half of it in a half model)."""
    return System(mesh, threads=1).forces(x).volume


def _changed(mesh: Mesh, actuator: Actuator) -> Mesh:
    """Mesh a changed actuator with as many nodes; its columns move with the sectors' edges."""
    changed = make_mesh(actuator, mesh.size, not mesh.half, like=mesh)
    return changed if alike(changed, mesh) else remesh(mesh, actuator)


def _pulls(
    system: System, x: FloatArray, pressure: float, family: Sequence[Parameter]
) -> list[FloatArray]:
    """-dR/dp of a family's parameters, each (count,).

    All are changed at once: a segment's layers alone feel its own parameter, all others move
    along as they are.
    What is fixed in space may feel a segment's length all along the tube; then each is alone.
    """
    if not family:
        return []
    mesh, step = system.mesh, family[0].step
    ends = []
    for sign in (1.0, -1.0):
        actuator = mesh.actuator
        for parameter in family:
            actuator = parameter.change(actuator, sign * step)
        near = _changed(mesh, actuator)
        # The clamped ring and the plug's change as well.
        at = settle(x, near, mesh)
        ends.append(System(near, 1, system.extra).forces(at))
    residuals = [forces.residual(pressure) for forces in ends]
    pull = -(residuals[0] - residuals[1]) / (2.0 * step)
    return [
        np.where(_felt(system, None if system.extra else parameter.segment), pull, 0.0)
        for parameter in family
    ]


def _felt(system: System, segment: int | None) -> NDArray[np.bool_]:
    """Unknowns (count,) of a segment's layers; all of them for None."""
    if segment is None:
        return np.ones(system.unknowns.count, dtype=bool)
    layers = system.mesh.segment == segment
    felt = np.zeros(system.unknowns.count, dtype=bool)
    rings, mids, plug = system.split(felt[None])
    rings[0, layers[:-1] | layers[1:]] = True
    mids[0, layers] = True
    plug[...] = layers[-1]
    return felt


def _rate(
    system: System,
    x: FloatArray,
    forces: Forces,
    du: FloatArray,
    parameter: Parameter | None,
    angles: bool,
) -> Rate:
    """Read a rate off the flow du (count,); no parameter stands for the pressure."""
    mesh = system.mesh
    moved = system.expand(x, du)
    # The angles by differences along the known motion.
    size = min(1e-4 / max(float(np.abs(moved).max()), 1e-12), LENGTH_STEP if parameter else 1.0)
    ends, theta, grown = [], [], 0.0
    for sign in (1.0, -1.0):
        near = mesh
        if parameter is not None:
            near = remesh(mesh, parameter.change(mesh.actuator, sign * size), gauze=False)
            if parameter.segment is None and angles:
                near = _changed(mesh, near.actuator)
                grown += sign * _enclosed(near, settle(x, near, mesh)) / (2.0 * size)
        ends.append(near)
        theta.append(
            _angles(near, x + sign * size * moved)
            if angles
            else np.full(len(mesh.actuator.windows), np.nan)
        )
    volume = float(forces.volume_gradient @ du) + grown if angles else np.nan
    return Rate(
        theta=(theta[0] - theta[1]) / (2.0 * size),
        facing=measure.surface_line(mesh, moved, np.radians(270.0)),
        z=(ends[0].z - ends[1].z) / (2.0 * size),
        volume=(2.0 if mesh.half else 1.0) * volume,
        moved=moved,
    )


def _angles(mesh: Mesh, x: FloatArray) -> FloatArray:
    return measure.joint_angles(mesh, x, measure.sectors(mesh, measure.lines(mesh, x)))
