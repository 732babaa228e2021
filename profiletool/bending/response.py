"""The joint response: a fast first guess of a whole actuator's shape.

Finite elements of single joints, tabulated over alpha, openF and pressure, give what a joint adds
to a long straight tube: fields along the tube of the turn of the lines across it, of the midline's
stretch and of its height. An actuator is the sum of its joints' fields, mirrored for joints that
bend away from the object, scaled for their neighbours (`profiletool.bending.neighbours`) and
integrated along the tube.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from profiletool.bending.model import Chain
from profiletool.bending.neighbours import PLUG_MM
from profiletool.bending.response_table import ResponseTable, shipped
from profiletool.records.frames import Pose, Shape, base_axes
from profiletool.records.units import FloatArray

Values = TypeVar("Values", FloatArray, NDArray[np.complex128])

STEP_MM = 0.5  # spacing of a shape's points on the straight tube
_END_MM = 1.0  # how soon the tube takes its height behind the clamped end
_ROUNDS = 5  # of Newton's method for alpha: the first guess is good to a few degrees


@dataclass(frozen=True)
class Response:
    """A `profiletool.bending.model.Model` by tabulated finite elements; mm, rad, MPa.

    Other tubes than the tabulated one follow from dimensional analysis, see `scaled`.

    Attributes
    ----------
    table : ResponseTable
    length_scale, pressure_scale : float
        Of this tube over the tabulated one.
    """

    table: ResponseTable
    length_scale: float = 1.0
    pressure_scale: float = 1.0

    @classmethod
    def load(cls) -> Response:
        """Return the response of the default tube: D 20 mm, wall 2 mm."""
        return cls(shipped())

    def scaled(self, diameter: float, wall: float, stiffness: float | None = None) -> Response:
        """Carry the response over to another tube.

        Exact for a tube of the same shape, with lengths over the diameter and pressures over the
        rubber's stiffness, but for the gauze's own stiffness, which matters little. For another
        shape the pressure is taken in proportion to wall / diameter: a rough first guess.

        Parameters
        ----------
        diameter, wall : float, mm
        stiffness : float, optional
            C10 + C01 of the rubber, MPa; by default that of the tabulated tube.
        """
        known = self.table
        rubber = 1.0 if stiffness is None else stiffness / known.stiffness
        shape = (wall / diameter) / (known.wall / known.diameter)
        return replace(self, length_scale=diameter / known.diameter, pressure_scale=rubber * shape)

    @property
    def radius(self) -> float:
        """Outer radius of the tube, mm."""
        return 0.5 * self.table.diameter * self.length_scale

    @property
    def openF(self) -> tuple[float, float]:
        """Lengths of cut that are tabulated, mm."""
        return _range(self.table.openF.nodes, self.length_scale)

    @property
    def alpha(self) -> tuple[float, float]:
        """Extents of the uncut sector that are tabulated, rad."""
        return _range(self.table.alpha.nodes, 1.0)

    @property
    def pressure(self) -> tuple[float, float]:
        """Pressures that are tabulated, MPa; below them theta is extrapolated, to 0 at 0."""
        return _range(self.table.pressure.nodes, self.pressure_scale)

    def theta(self, openF: ArrayLike, alpha: ArrayLike, pressure: ArrayLike) -> FloatArray:
        """Angle of a joint alone, rad; arguments broadcast.

        Between the straight parts of a long tube, 25 mm away from the cut.
        """
        o, p = self._own(openF, pressure)
        rates = self.table.log_rates(o, p)
        theta: FloatArray = p * np.exp(np.sum(self.table.alpha.weights(alpha) * rates, axis=-1))
        return theta

    def theta_slopes(
        self, openF: ArrayLike, alpha: ArrayLike, pressure: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Differentiate `theta` with respect to openF (rad/mm), alpha, pressure (rad/MPa)."""
        o, p = self._own(openF, pressure)
        axes = (
            (self.table.openF, o),
            (self.table.alpha, np.asarray(alpha)),
            (self.table.pressure, p),
        )
        log_rate = np.moveaxis(self.table.log_rate, 0, 1)
        theta = self.theta(openF, alpha, pressure)
        slopes = []
        for k in range(3):
            w = [a.slopes(x) if j == k else a.weights(x) for j, (a, x) in enumerate(axes)]
            slopes.append(theta * np.einsum("...o,...a,...p,oap->...", *w, log_rate))
        with np.errstate(divide="ignore", invalid="ignore"):
            own = np.where(p > 0.0, theta / p, np.nan)
        return slopes[0] / self.length_scale, slopes[1], (slopes[2] + own) / self.pressure_scale

    def alpha_for(self, openF: ArrayLike, theta: ArrayLike, pressure: ArrayLike) -> FloatArray:
        """alpha_closed that gives an angle, rad; NaN where none within the range does."""
        o, p = self._own(openF, pressure)
        o, p, wanted = np.broadcast_arrays(o, p, np.asarray(theta, dtype=float))
        rates = self.table.log_rates(o, p)  # falling along alpha
        axis = self.table.alpha
        with np.errstate(divide="ignore", invalid="ignore"):
            rate = np.log(wanted / p)
        slack = 1e-9
        within = (rate <= rates[..., 0] + slack) & (rate >= rates[..., -1] - slack)
        rate = np.clip(np.where(within, rate, rates[..., 0]), rates[..., -1], rates[..., 0])
        piece = np.clip(np.sum(rates > rate[..., None], axis=-1) - 1, 0, len(axis.nodes) - 2)
        high, low = (np.take_along_axis(rates, (piece + k)[..., None], -1)[..., 0] for k in (0, 1))
        left, right = axis.nodes[piece], axis.nodes[piece + 1]
        alpha = left + (high - rate) / (high - low) * (right - left)
        for _ in range(_ROUNDS):
            off = np.sum(axis.weights(alpha) * rates, axis=-1) - rate
            slope = np.sum(axis.slopes(alpha) * rates, axis=-1)
            alpha = np.clip(alpha - off / slope, left, right)
        return np.where(within, alpha, np.nan)

    def line(self, openF: float, alpha: float, pressure: float, sense: float) -> FloatArray:
        """Object-facing line of a joint in a long straight tube: (N, 3) of x, y, heading.

        In the frame of `profiletool.bending.model.Model.line`. It begins and ends 25 mm outside the
        cut; the stretch that a wrapped tube has without joints is left out.
        """
        o, p = self._own(openF, pressure)
        table = self.table
        z = _mirrored(table.places(o[None]), -1.0)[0]
        theta, over = table.joints(np.array([alpha]), o[None], float(p))
        fields = np.array([[sense], [1.0], [sense], [1.0]]) * theta[0] * over[0]
        turn, stretch = _mirrored(fields[:2], -1.0)
        shift, growth = _mirrored(fields[2:], 1.0)
        turn = turn - turn[0]
        centre = _integrate(turn, np.diff(z) + np.diff(stretch), np.diff(shift))
        height = 0.5 * (table.diameter + growth - growth[0])
        facing = centre - height[:, None] * _across(turn)
        facing += [z[0] + 0.5 * float(o), 0.5 * table.diameter]
        return np.column_stack([self.length_scale * facing, -turn])

    def factors(self, chain: Chain, pressure: float) -> FloatArray:
        """Factors on every joint's turn and stretch by its neighbours and the ends: (n, 2)."""
        own = self._own_chain(chain)
        return np.exp(self.table.neighbours.log_factors(own, pressure / self.pressure_scale))

    def shape(self, chain: Chain, pressure: float, pose: Pose, sign: float) -> Shape:
        """Bend the whole tube at a pressure, neighbours' influence included.

        Points lie evenly along the straight tube.
        """
        return self.shape_by(self.factors(chain, pressure), chain, pressure, pose, sign)

    def shape_by(
        self, factors: FloatArray, chain: Chain, pressure: float, pose: Pose, sign: float
    ) -> Shape:
        """Bend the whole tube with given factors on every joint's turn and stretch, (n, 2)."""
        own, p = self._own_chain(chain), pressure / self.pressure_scale
        table = self.table
        along = np.linspace(0.0, own.length, max(round(own.length / STEP_MM), 1) + 1)
        turn, stretch, shift, growth = self._fields(own, p, along, factors)
        centre = _integrate(turn - turn[0], np.diff(along) + np.diff(stretch), np.diff(shift))
        across = _across(turn - turn[0])
        half = 0.5 * (table.diameter + growth)[:, None] * across
        centre[:, 1] += 0.5 * table.diameter
        heading = np.radians(pose.heading_deg)
        axes = np.array(base_axes(heading, sign))
        start = np.array([pose.x_mm, pose.y_mm])
        facing, axis, far = (
            start + self.length_scale * (line @ axes)
            for line in (centre - half, centre, centre + half)
        )
        return Shape(self.length_scale * along, facing, axis, far)

    def _fields(
        self, chain: Chain, pressure: float, along: FloatArray, factors: FloatArray
    ) -> FloatArray:
        """Sum the fields of a chain of the tabulated tube at places along it: (4, N)."""
        table = self.table
        stretch, growth = table.wrapped @ table.pressure.weights(pressure)
        free = max(chain.length - PLUG_MM, _END_MM)
        inside = np.minimum(along, free)
        held = 1.0 - np.exp(-inside / _END_MM) - np.exp((inside - free) / _END_MM)
        turned, grown = np.zeros(len(along), complex), np.zeros(len(along), complex)
        turned += 1j * stretch * inside
        grown += 1j * growth * np.maximum(held, 0.0)
        if len(chain.centre):
            theta, fields = table.joints(chain.alpha, chain.openF, pressure)
            scale = theta[:, None] * factors
            bent = (chain.sense * scale[:, 0])[:, None]
            odd = _mirrored(bent * fields[:, 0] + 1j * scale[:, 1:] * fields[:, 1], -1.0)
            even = _mirrored(bent * fields[:, 2] + 1j * scale[:, :1] * fields[:, 3], 1.0)
            places = chain.centre[:, None] + _mirrored(table.places(chain.openF), -1.0)
            for z, turning, growing in zip(places, odd, even, strict=True):
                turned += np.interp(along, z, turning)
                grown += np.interp(along, z, growing)
        return np.array([turned.real, turned.imag, grown.real, grown.imag])

    def _own(self, openF: ArrayLike, pressure: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Give openF and pressure as the tabulated tube has them."""
        o = np.asarray(openF, dtype=float) / self.length_scale
        return o, np.asarray(pressure, dtype=float) / self.pressure_scale

    def _own_chain(self, chain: Chain) -> Chain:
        if self.length_scale == 1.0:
            return chain
        by = 1.0 / self.length_scale
        return replace(
            chain, centre=by * chain.centre, openF=by * chain.openF, length=by * chain.length
        )


def _range(nodes: FloatArray, scale: float) -> tuple[float, float]:
    return float(nodes[0]) * scale, float(nodes[-1]) * scale


def _mirrored(half: Values, parity: float) -> Values:
    """Extend fields of half a joint, (n, M), over the whole of it: (n, 2 M - 1)."""
    return np.concatenate([parity * half[:, :0:-1], half], axis=1)


def _integrate(turn: FloatArray, length: FloatArray, shift: FloatArray) -> FloatArray:
    """Lay steps end to end, in the frame that turns with them.

    Parameters
    ----------
    turn : (N,) rad
        Toward the object, that is toward -y.
    length, shift : (N - 1,) mm
        Of every step, along the tube and across it, away from the object.

    Returns
    -------
    (N, 2) mm, from the origin along x
    """
    step = np.diff(turn)
    middle = 0.5 * (turn[1:] + turn[:-1])
    chord = np.sinc(step / (2.0 * np.pi))  # of arcs of constant curvature
    cos, sin = chord * np.cos(middle), chord * np.sin(middle)
    line = np.zeros((len(turn), 2))
    np.cumsum(length * cos + shift * sin, out=line[1:, 0])
    np.cumsum(shift * cos - length * sin, out=line[1:, 1])
    return line


def _across(turn: FloatArray) -> FloatArray:
    """Give unit vectors across the tube, away from the object: (N, 2)."""
    return np.column_stack([np.sin(turn), np.cos(turn)])
