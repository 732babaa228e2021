"""The results of a run: states at pressures, and how they were reached."""

from __future__ import annotations

from dataclasses import dataclass

from fem import measure, touching
from fem.arrays import FloatArray
from fem.equilibrium import Critical, Equilibrium
from fem.errors import Attempt
from fem.mesh import Mesh


@dataclass(frozen=True)
class State:
    """An actuator at one pressure; all quantities are those of the whole tube.

    Attributes
    ----------
    pressure : float, MPa
    theta : (joints,) rad
        Positive toward the object; see `fem.measure.joint_angles`.
    shape : fem.measure.TubeLines
    sectors : tuple of fem.measure.Sector
    threads : fem.measure.ThreadTension
    volume : float, mm^3
        Enclosed: the air demand is what it exceeds that at rest.
    energy, work : float, N mm
        Stored in rubber, gauze and what else contributes; done by the pressure so far (NaN where
        that is not known).
    residual : float
        Unbalanced forces over the pressure's.
    least_J : float
        Smallest determinant of F.
    stretches : (joints,)
        Of the rubber about each joint; see `fem.measure.stretches`.
    overlap : float, mm
        How deep the tube runs into itself, as the model has no contact; 0 where it does not. See
        `fem.touching.overlap`.
    x : (layers + 1, ring + mid, 3) mm
        Nodal positions of the mesh.
    """

    pressure: float
    theta: FloatArray
    shape: measure.TubeLines
    sectors: tuple[measure.Sector, ...]
    threads: measure.ThreadTension
    volume: float
    energy: float
    work: float
    residual: float
    least_J: float
    stretches: FloatArray
    overlap: float
    x: FloatArray

    @property
    def touches(self) -> bool:
        """Whether the tube runs into itself."""
        return self.overlap > 0.0

    @property
    def largest_stretch(self) -> float:
        """Largest stretch of the rubber about any joint."""
        return float(self.stretches.max())

    @property
    def energy_error(self) -> float:
        """How far the stored energy is off the work done, over the work.

        0 at rest and at the first state, from which on the balance is counted; NaN where the
        work is not known.
        """
        return abs(self.energy - self.work) / self.work if self.work != 0.0 else 0.0


@dataclass(frozen=True)
class Solution:
    """What a run gives.

    Attributes
    ----------
    mesh : Mesh
    states : tuple of State
        At rest, then at every asked pressure that was reached, in order.
    critical : Critical or None
        What ended the path before the last asked pressure.
    history : tuple of Attempt
    newton_iterations, factorisations : int
    seconds : float
    failure : str or None
        Why no equilibrium was found at an asked pressure, where `NotConverged` carries this.
    ahead : Critical or None
        What ends the path beyond the last asked pressure, as far as ``Options.ahead`` looks.
    """

    mesh: Mesh
    states: tuple[State, ...]
    critical: Critical | None
    history: tuple[Attempt, ...]
    newton_iterations: int
    factorisations: int
    seconds: float
    failure: str | None = None
    ahead: Critical | None = None

    @property
    def converged(self) -> bool:
        """Whether every asked pressure was reached."""
        return self.critical is None and self.failure is None


def state_of(mesh: Mesh, equilibrium: Equilibrium, work: float) -> State:
    """Read all that a state tells off an equilibrium.

    Parameters
    ----------
    mesh : Mesh
    equilibrium : Equilibrium
    work : float
        Of the pressure so far on what is modelled of the tube, N mm; NaN where it is not known.
    """
    x, forces = equilibrium.pose.x, equilibrium.forces
    twice = 2.0 if mesh.half else 1.0
    shape = measure.lines(mesh, x)
    wrapped = measure.sectors(mesh, shape)
    return State(
        pressure=equilibrium.pressure,
        theta=measure.joint_angles(mesh, x, wrapped),
        shape=shape,
        sectors=wrapped,
        threads=measure.threads(mesh, x),
        volume=twice * forces.volume,
        energy=twice * forces.energy,
        work=twice * work,
        residual=equilibrium.residual,
        least_J=forces.least_J,
        stretches=measure.stretches(mesh, x),
        overlap=touching.overlap(touching.outer_rings(mesh, x)),
        x=x,
    )
