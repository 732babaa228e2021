"""Threads that go slack or taut within one Newton step.

All of the model is smooth but for this: a thread that switches changes the tangent by a stiff
spring, and plain Newton spends most of its iterations on finding out which do. With the factored
tangent K0 at hand the piecewise linear problem is small. Of the few thread points p that switch,
with unit forces a_p, the step obeys

    du = K0^-1 (rhs - sum_p w_p q_p(e_p) a_p),   e_p = a_p . du,

where q_p is what the thread's force exceeds its linear share in K0. In the strains e alone this
is e = e0 - C w q(e) with the compliance C = A^T K0^-1 A, found by half a solve, and solved by
Newton in a few unknowns.
"""

from __future__ import annotations

import numpy as np

from fem import gauze
from fem.arrays import FloatArray, IntArray
from fem.assembly import Inverse, System

_ROUNDS = 4
_MOST = 600  # switching points up to which this pays
_ENOUGH = 0.02  # unbalanced thread forces over the right side


class Switching:
    """The axial threads as they stand in a factored tangent.

    Parameters
    ----------
    system : System
    inverse : Inverse
        Of the tangent at ``x``.
    x : (layers + 1, ring + mid, 3) mm
    """

    def __init__(self, system: System, inverse: Inverse, x: FloatArray) -> None:
        mesh = system.mesh
        self._system, self._inverse, self._x = system, inverse, x
        self._threads = mesh.axial
        first = np.arange(mesh.layers)[:, None, None] * (mesh.ring + mesh.mid)
        self._faces = (first + mesh.outer).reshape(-1, mesh.outer.shape[1])
        g = self._gradient(x)
        lam = np.linalg.norm(g, axis=2)
        self._along = g / lam[..., None]
        self._lam = lam
        _, self._force, self._slope = gauze.tension_law(mesh.actuator.gauze, lam)
        self._size = np.linalg.norm(self._threads.gradient, axis=2)
        self._chosen = np.zeros(lam.shape, dtype=bool)
        self._points = np.zeros(0, dtype=np.int64)
        self._compliance = np.zeros((0, 0))

    def _gradient(self, nodal: FloatArray) -> FloatArray:
        moved: FloatArray = self._threads.gradient @ nodal.reshape(-1, 3)[self._faces]
        return moved

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Step (count,) that balances rhs (count,) with the threads' own law."""
        first = self._inverse.solve(rhs)
        return first if self._inverse.negative else self._balanced(rhs, first)

    def _balanced(self, rhs: FloatArray, first: FloatArray) -> FloatArray:
        du = first
        law, w = self._system.mesh.actuator.gauze, self._threads.weight
        lam, force = self._lam, self._force
        start = self._strain(first)
        used = np.zeros_like(lam)
        for _ in range(_ROUNDS):
            e = self._strain(du)
            excess = gauze.tension_law(law, lam + e)[1] - force - self._slope * e - used
            load = np.abs(w * excess) * self._size
            if np.linalg.norm(load) <= _ENOUGH * np.linalg.norm(rhs):
                return du
            if not self._choose(load, _ENOUGH * float(np.linalg.norm(rhs))):
                return first
            points = self._points
            extra = self._balance(start.flat[points], lam.flat[points], force.flat[points], points)
            used[...] = 0.0
            used.flat[points] = extra
            du = self._inverse.solve(rhs - self._spread(w * used))
        return du

    def _strain(self, du: FloatArray) -> FloatArray:
        moved = self._gradient(self._system.expand(self._x, du))
        strain: FloatArray = np.einsum("eqi,eqi->eq", moved, self._along)
        return strain

    def _choose(self, load: FloatArray, rest: float) -> bool:
        """Add the points that matter; False where they are too many for this to pay."""
        sizes = np.sort(load, axis=None)
        # Leave out the smallest, as many as together stay within half of what is let pass.
        spared = np.searchsorted(np.cumsum(sizes**2), (0.5 * rest) ** 2)
        chosen = self._chosen | (load >= sizes[min(int(spared), sizes.size - 1)])
        points = np.flatnonzero(chosen)
        if len(points) > _MOST:
            return False
        if len(points) > len(self._points):
            self._chosen, self._points = chosen, points
            face, q = np.divmod(points, load.shape[1])
            unit = self._threads.gradient[face, q][:, :, None] * self._along[face, q][:, None, :]
            layer, around = np.divmod(face, self._system.mesh.around)
            self._compliance = self._system.compliance(self._x, layer, around, unit)
        return True

    def _balance(
        self, start: FloatArray, lam: FloatArray, force: FloatArray, points: IntArray
    ) -> FloatArray:
        """Solve e = start - C w q(e); return q."""
        law, w = self._system.mesh.actuator.gauze, self._threads.weight.flat[points]
        slope = self._slope.flat[points]
        C = self._compliance * w

        def excess(e: FloatArray) -> tuple[FloatArray, FloatArray]:
            _, f, k = gauze.tension_law(law, lam + e)
            return f - force - slope * e, k - slope

        e = start
        q, dq = excess(e)
        gap = e - start + C @ q
        for _ in range(40):
            size = float(np.linalg.norm(gap))
            if size <= 1e-12:
                break
            step = np.linalg.solve(np.eye(len(e)) + C * dq, -gap)
            share = 1.0
            while True:
                trial = e + share * step
                q, dq = excess(trial)
                new = trial - start + C @ q
                if np.linalg.norm(new) < size or share < 0.1:
                    break
                share *= 0.5
            e, gap = trial, new
        return q

    def _spread(self, load: FloatArray) -> FloatArray:
        """Thread forces (E, q) on the unknowns (count,)."""
        mesh = self._system.mesh
        nodal = np.zeros_like(mesh.X)
        pull = np.swapaxes(self._threads.gradient, 1, 2) @ (load[..., None] * self._along)
        flat = nodal.reshape(-1, 3)
        for i in range(3):
            flat[:, i] = np.bincount(self._faces.ravel(), pull[..., i].ravel(), len(flat))
        return self._system.restrict(self._x, nodal)
