"""The gauze: two families of threads glued to the outer surface, in tension only.

A family is a set of thread points on the outer faces: where they are, in which direction the
thread runs, and what stiffness (N mm: stiffness per unit width times area, or EA times length)
they stand for. The smeared gauze has Gauss points with the share of their face that is covered;
single threads at the mesh pitch have points along their lines. The rest of the model does not
know which.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.arrays import FloatArray

# Polyamide, thread of 0.25 mm: EA of one thread, and two turns of a 2 mm mesh.
THREAD_E = 2000.0
THREAD_EA = THREAD_E * np.pi / 4.0 * 0.25**2
PAPER_STIFFNESS = THREAD_EA * 2 / 2.0

_SLACK, _SLACK_OVER_WALL = 1e-3, 0.186


@dataclass(frozen=True)
class Gauze:
    """The material of the gauze.

    Attributes
    ----------
    stiffness : float
        Of all turns together, per unit width, in each thread direction, N/mm.
    slack : float
        Stiffness in compression over that in tension; 0 for threads, 1 for bars.
    transition : float
        Stretch over which the stiffness sets in.
    allowance : float
        What the threads at both ends of an uncut sector add to alpha, rad (physics of the
        paper's model: its alpha acts like a smeared sector of alpha + 6 deg).
    pitch : float or None
        None for a smeared gauze; else single threads this far apart, mm.

    Raises
    ------
    ValueError
        When a number makes no sense.
    """

    stiffness: float = PAPER_STIFFNESS
    slack: float = _SLACK
    transition: float = 2e-4
    allowance: float = float(np.radians(6.0))
    pitch: float | None = None

    def __post_init__(self) -> None:
        if not (self.stiffness > 0.0 and 0.0 <= self.slack <= 1.0 and self.transition > 0.0):
            raise ValueError("a gauze needs stiffness > 0, 0 <= slack <= 1 and transition > 0")
        if not (0.0 <= self.allowance < np.pi and (self.pitch is None or self.pitch > 0.0)):
            raise ValueError("a gauze needs 0 <= allowance < pi and a pitch above 0, or none")


def slack_on(wall: float, stiffness: float = PAPER_STIFFNESS) -> float:
    """Share of their stiffness that threads keep in compression on a soft wall.

    What is left is for the numbers alone. Beside a wall of softer rubber than the paper's the usual
    share is no longer small: the wall, stiffened in compression, wrinkles at every window.

    Parameters
    ----------
    wall : float
        Shear modulus times thickness, N/mm.
    stiffness : float
        Of the gauze, N/mm.
    """
    return min(_SLACK, _SLACK_OVER_WALL * wall / stiffness)


# As the paper modelled it: bars every 6 deg that resist compression, those at both ends of a
# sector uncut.
PAPER_GAUZE = Gauze(slack=1.0, allowance=0.0, pitch=float(np.radians(6.0) * 10.0))


@dataclass(frozen=True)
class AxialLines:
    """Single axial threads in the windows, each a line along the tube.

    Wrapped sectors, where no thread is cut, stay smeared.

    Attributes
    ----------
    angles : tuple of tuple of float
        Angular positions of the threads that are whole in each window, rad.
    EA : float
        Stiffness of one of them, N.

    Raises
    ------
    ValueError
        When the stiffness is not above 0.
    """

    angles: tuple[tuple[float, ...], ...]
    EA: float

    def __post_init__(self) -> None:
        if not self.EA > 0.0:
            raise ValueError("single threads need a stiffness above 0")

    @property
    def in_plane(self) -> bool:
        """Whether the plane x = 0 mirrors the threads of every window onto themselves."""
        for angles in self.angles:
            own = np.exp(1j * np.array(angles))
            mirrored = -own.conj()
            if len(own) and np.abs(own[:, None] - mirrored).min(axis=0).max() > 1e-6:
                return False
        return True


@dataclass(frozen=True)
class Threads:
    """Thread points on faces.

    Attributes
    ----------
    gradient : (E, q, n)
        Derivatives of the face's shape functions along the thread at rest, 1/mm.
    weight : (E, q)
        Stiffness that a point stands for, N mm.
    """

    gradient: FloatArray
    weight: FloatArray


def tension_law(gauze: Gauze, lam: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Energy, force and tangent of a thread at stretch lam, over its stiffness.

    Zero at rest and in compression (but for ``slack``); the tangent rises linearly from there to
    1 over ``transition``, so that the force has no kink.
    """
    e = lam - 1.0
    if gauze.slack == 1.0:
        return 0.5 * e * e, e, np.ones_like(e)
    d, r = gauze.transition, gauze.slack
    ramp = np.clip(e, 0.0, d)
    over = np.maximum(e - d, 0.0)
    tangent = ramp / d
    force = 0.5 * ramp * tangent + over
    energy = ramp * ramp * tangent / 6.0 + over * (0.5 * d + 0.5 * over)
    rest = 1.0 - r
    return rest * energy + 0.5 * r * e * e, rest * force + r * e, rest * tangent + r


@dataclass(frozen=True)
class ThreadState:
    """Threads at a deformed state.

    Attributes
    ----------
    energy : (E,) N mm
    force : (E, n, 3) N
        On the face's nodes.
    stiffness : (E, 6, n * n) N/mm, or None
        For the pairs (i, k) of `fem.material.PAIRS`.
    """

    energy: FloatArray
    force: FloatArray
    stiffness: FloatArray | None


def stretch(threads: Threads, x: FloatArray) -> FloatArray:
    """Stretch at the thread points, for face nodes x (E, n, 3): (E, q)."""
    lam: FloatArray = np.linalg.norm(threads.gradient @ x, axis=2)
    return lam


def respond(gauze: Gauze, threads: Threads, x: FloatArray, tangent: bool) -> ThreadState:
    """Energy, nodal forces and stiffness of threads on faces with nodes x (E, n, 3), mm."""
    g = threads.gradient @ x
    lam = np.sqrt(np.einsum("eqi,eqi->eq", g, g))
    energy, force, slope = tension_law(gauze, lam)
    w = threads.weight
    along = w * force / lam
    nodal = np.swapaxes(threads.gradient, 1, 2) @ (along[..., None] * g)
    if not tangent:
        return ThreadState((w * energy).sum(axis=1), nodal, None)
    t = g / lam[..., None]
    extra = w * slope - along
    i, k = (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)
    moduli = extra[..., None] * t[..., i] * t[..., k]
    moduli[..., (0, 3, 5)] += along[..., None]
    n = threads.gradient.shape[2]
    pairs = (threads.gradient[..., :, None] * threads.gradient[..., None, :]).reshape(
        *threads.gradient.shape[:2], n * n
    )
    stiffness = np.swapaxes(moduli, 1, 2) @ pairs
    return ThreadState((w * energy).sum(axis=1), nodal, stiffness)
