"""Forces and tangent of an actuator, and the factorisation of the tangent.

The tangent is block tridiagonal over the rings. It is eliminated from both ends toward a ring in
the middle, layer by layer as it is assembled: two threads share the work evenly, the whole matrix
never exists, and the result does not depend on how many threads there are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from fem.arrays import DOUBLE, SINGLE, DType, FloatArray, IntArray
from fem.deadweight import Deadweight
from fem.items import ITEMS, MakeItem
from fem.mesh import Mesh
from fem.part import Part
from fem.pattern import Unknowns
from fem.pivot import DoubtfulPivot, Pivot
from fem.plug import Plug, inner_area


@dataclass(frozen=True)
class Forces:
    """An actuator's state of force at given nodal positions.

    Attributes
    ----------
    internal : (count,) N
        Gradient of the stored energy by the unknowns.
    volume_gradient : (count,) mm^2
        Gradient of the enclosed volume: forces of a unit pressure.
    energy : float, N mm
        Stored in rubber, gauze and whatever else contributes (half of it in a half model).
    volume : float, mm^3
        Enclosed (half of it in a half model).
    least_J : float
        Smallest determinant of F. Where it is not above 0 a brick is turned inside out and all
        else is NaN.
    """

    internal: FloatArray
    volume_gradient: FloatArray
    energy: float
    volume: float
    least_J: float

    def residual(self, pressure: float) -> FloatArray:
        """Unbalanced forces (count,), N."""
        return self.internal - pressure * self.volume_gradient


class Inverse:
    """The factored tangent; holds until the system is factored anew."""

    def __init__(self, system: System, version: int) -> None:
        self._system = system
        self._version = version

    @property
    def negative(self) -> int:
        """How many negative eigenvalues the tangent has: 0 where the state is stable."""
        self._check()
        return sum(pivot.negative for pivot in self._system.pivots())

    def solve(self, rhs: FloatArray, *, positive: bool = False) -> FloatArray:
        """Solve for right sides (k, count) or (count,).

        ``positive``: in place of the tangent K = L S L^T, S = +-1, with L L^T, which is positive
        definite: the solution leads downhill in the energy whatever K is.
        """
        self._check()
        return self._system.solve(np.atleast_2d(rhs), positive=positive).reshape(rhs.shape)

    def _check(self) -> None:
        if self._version != self._system.version:
            raise RuntimeError("the tangent has been factored anew since")


_Halves = tuple[Part, Part, Pivot]  # from the root, from the tip, and the ring between them


class System:
    """The equations of one mesh.

    Holds the arrays that every factorisation uses again; use one System in one thread at a time.

    Parameters
    ----------
    mesh : Mesh
    threads : {1, 2}
    extra : sequence of MakeItem
        What contributes to the energy beside `fem.items.ITEMS` and the actuator's weight.
    single : bool
        Factor tangents in single precision where double is not asked for, until a pivot of one is
        not positive. Forces and energies are in double in any case.
    """

    def __init__(
        self,
        mesh: Mesh,
        threads: int = 2,
        extra: Sequence[MakeItem] = (),
        *,
        single: bool = False,
    ) -> None:
        self.mesh, self.extra = mesh, tuple(extra)
        self.unknowns = Unknowns.of(mesh)
        self.plug = Plug(mesh)
        self.version = 0
        middle = mesh.layers // 2
        own = () if mesh.actuator.weight is None else (Deadweight,)
        self.middle, self._single = middle, single
        self._items = (*ITEMS, *own, *extra)
        self._halves: dict[DType, _Halves] = {}
        self._parts: tuple[Part, ...] = ()
        self._use(SINGLE if single else DOUBLE)
        self._pool = ThreadPoolExecutor(1) if threads > 1 else None

    def _use(self, dtype: DType) -> None:
        """Go on with a tangent of a precision."""
        if dtype not in self._halves:
            mesh, middle, u = self.mesh, self.middle, self.unknowns
            root = Part(mesh, u, range(middle), self._items, from_root=True, dtype=dtype)
            tip = Part(
                mesh, u, range(middle, mesh.layers), self._items, from_root=False, dtype=dtype
            )
            self._halves[dtype] = (root, tip, Pivot(len(u.ring) if middle > 0 else 0, dtype))
        root, tip, self._last = self._halves[dtype]
        self._parts = (root, tip)

    def close(self) -> None:
        """Let the second thread go."""
        if self._pool is not None:
            self._pool.shutdown()
            self._pool = None

    def pivots(self) -> Iterable[Pivot]:
        """All pivots of the present factorisation."""
        for part in self._parts:
            yield from part.pivots.values()
        yield self._last

    def _both(self, work: Callable[[Part], object], *, alone: bool = False) -> None:
        """Do the work of both parts, at the same time unless it is too small for that."""
        root, tip = self._parts
        if self._pool is None or alone:
            work(root)
            work(tip)
            return
        other = self._pool.submit(work, tip)
        try:
            work(root)
        finally:
            other.result()

    def forces(self, x: FloatArray) -> Forces:
        """Give the forces at nodal positions x (layers + 1, ring + mid, 3), mm."""
        self._both(lambda part: part.evaluate(x, 0.0, None), alone=True)
        return self._gather(x)

    def factor(
        self, x: FloatArray, pressure: float, *, double: bool = True
    ) -> tuple[Forces, Inverse | None]:
        """Give forces and factored tangent at x under a pressure, MPa; None where least_J <= 0.

        ``double``: a step in single precision is off along the soft bending of a long tube.
        """
        self.version += 1
        self._use(SINGLE if self._single and not double else DOUBLE)
        try:
            forces = self._factor(x, pressure)
        except DoubtfulPivot:
            self._single = False
            self._use(DOUBLE)
            forces = self._factor(x, pressure)
        return forces, Inverse(self, self.version) if forces.least_J > 0.0 else None

    def _factor(self, x: FloatArray, pressure: float) -> Forces:
        self._both(lambda part: part.evaluate(x, pressure, self.plug))
        forces = self._gather(x)
        if forces.least_J > 0.0 and self.middle > 0:
            self._last.factorise(self._parts[0].next, self._parts[1].next)
        return forces

    def _gather(self, x: FloatArray) -> Forces:
        ours, theirs = (part.sums for part in self._parts)
        least = min(ours.least_J, theirs.least_J)
        if not least > 0.0:
            void = np.full(self.unknowns.count, np.nan)
            return Forces(void, void, np.nan, np.nan, least)
        cap, cap_gradient = self.plug.cap_volume(x)
        internal = self.restrict(x, ours.internal + theirs.internal)
        gradient = self.restrict(x, ours.gradient + theirs.gradient)
        gradient[-self.unknowns.plug :] += cap_gradient
        energy, volume = ours.energy + theirs.energy, ours.volume + theirs.volume + cap
        return Forces(internal, gradient, energy, volume, least)

    def clamp(self, x: FloatArray, pressure: float) -> FloatArray:
        """Force of the clamp on the tube (or on half of it) at x under a pressure: (3,) N.

        The volume that the wall encloses with the origin lacks the clamped opening's disc, and
        its gradient two thirds of the push that the wall's last ring takes there.
        """
        self._both(lambda part: part.evaluate(x, 0.0, None), alone=True)
        held: FloatArray = sum(
            part.sums.internal[0] - pressure * part.sums.gradient[0] for part in self._parts
        )[: self.mesh.ring].sum(axis=0)
        return held - [0.0, 0.0, pressure * inner_area(self.mesh) / 1.5]

    def compliance(
        self, x: FloatArray, layers: IntArray, around: IntArray, units: FloatArray
    ) -> FloatArray:
        """A^T K^-1 A of load patterns on outer faces, by half a solve; K positive definite.

        Parameters
        ----------
        x : nodal positions at the factored tangent
        layers, around : (s,)
            The face of each pattern.
        units : (s, m, 3)
            Its loads on the face's nodes.

        Returns
        -------
        (s, s)
        """
        mesh = self.mesh
        nodal = np.zeros((len(layers), 2 * mesh.ring + mesh.mid, 3), self._last.factor.dtype)
        nodal[np.arange(len(layers))[:, None], mesh.outer[around]] = units
        loads = nodal.reshape(len(layers), -1)
        result = np.zeros((len(layers), len(layers)))
        T = self.plug.motions(x).astype(nodal.dtype)
        rest: dict[Part, tuple[IntArray, FloatArray]] = {}

        def reduce(part: Part) -> None:
            rest[part] = part.compliance(layers, loads, T, result)

        self._both(reduce)
        if self.middle > 0:
            which = np.concatenate([rest[part][0] for part in self._parts])
            rows = np.concatenate([rest[part][1] for part in self._parts])
            self._last.forward(rows)
            result[np.ix_(which, which)] += rows @ rows.T
        return result

    def restrict(self, x: FloatArray, nodal: FloatArray) -> FloatArray:
        """Nodal forces (layers + 1, ring + mid, 3) on the unknowns (count,)."""
        u, ring = self.unknowns, self.mesh.ring
        rows = nodal.reshape(len(nodal), -1)
        return np.concatenate(
            [
                rows[1:-1, u.ring].ravel(),
                rows[:-1, 3 * ring + u.mid].ravel(),
                self.plug.motions(x).T @ rows[-1, : 3 * ring],
            ]
        )

    def expand(self, x: FloatArray, values: FloatArray) -> FloatArray:
        """Unknowns (count,) as nodal displacements (layers + 1, ring + mid, 3)."""
        u, ring = self.unknowns, self.mesh.ring
        nodal = np.zeros_like(x)
        rows = nodal.reshape(len(x), -1)
        rings, mids, plug = self.split(values[None])
        rows[1:-1, u.ring] = rings[0]
        rows[:-1, 3 * ring + u.mid] = mids[0]
        rows[-1, : 3 * ring] = self.plug.motions(x) @ plug[0]
        return nodal

    def split(self, values: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Unknowns (k, count) as rings (k, layers - 1, .), mids (k, layers, .), plug (k, .)."""
        u, k = self.unknowns, len(values)
        rings = values[:, : u.rings].reshape(k, u.layers - 1, -1)
        mids = values[:, u.rings : u.count - u.plug].reshape(k, u.layers, len(u.mid))
        return rings, mids, values[:, u.count - u.plug :]

    def solve(self, rhs: FloatArray, *, positive: bool = False) -> FloatArray:
        """Solve with the present factorisation for rhs (k, count); see `Inverse.solve`."""
        dtype = self._last.factor.dtype
        out = np.array(rhs, dtype)
        rings, mids, plug = self.split(out)
        carry: dict[Part, FloatArray] = {}

        def forward(part: Part) -> None:
            carry[part] = part.forward(rings, mids, plug)

        self._both(forward)
        middle = np.zeros((len(out), 0), dtype)
        if self.middle > 0:
            middle = rings[:, self.middle - 1] - sum(carry.values())
            self._last.forward(middle)
            if positive and self._last.signs is not None:
                middle *= self._last.signs
            self._last.backward(middle)
            rings[:, self.middle - 1] = middle
        self._both(lambda part: part.backward(rings, mids, plug, middle, positive=positive))
        return out.astype(DOUBLE, copy=False)
