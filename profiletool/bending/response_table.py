"""The data of the joint response: tabulated fields of single joints, and neighbours' influence.

All numbers are those of one tube, the *tabulated* one; `profiletool.bending.response` carries them
over to others.

Glossary
--------
A, O, P : nodes along alpha, openF, pressure
Q : pressures at which fields are tabulated, every second one of P
M : places along half a joint, from its middle outward: shares of the cut's half, then fixed
    distances outside
field : turn of the lines across; stretch along the axis and shift across it, both summed up from
    the middle on, in the frame that turns along; growth of the height
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import IO, Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from profiletool.bending.neighbours import Neighbours
from profiletool.records.units import FloatArray

FILE = "response.npz"


@dataclass(frozen=True)
class Axis:
    """One argument of a table, and cubic splines through its nodes.

    Attributes
    ----------
    nodes : (N,)
    pieces : (4, N - 1, N)
        Coefficients, highest power first, of the spline that is 1 at one node and 0 at others.
    """

    nodes: FloatArray
    pieces: FloatArray

    @classmethod
    def through(cls, nodes: FloatArray) -> Axis:
        """Build the splines (not-a-knot) of nodes, (N,)."""
        return cls(nodes, np.asarray(CubicSpline(nodes, np.eye(len(nodes))).c))

    def weights(self, x: ArrayLike) -> FloatArray:
        """Share of every node in a value at x: (..., N). Outside, the last piece goes on."""
        c, t = self._at(x)
        weights: FloatArray = ((c[0] * t + c[1]) * t + c[2]) * t + c[3]
        return weights

    def slopes(self, x: ArrayLike) -> FloatArray:
        """Differentiate `weights`: (..., N)."""
        c, t = self._at(x)
        slopes: FloatArray = (3.0 * c[0] * t + 2.0 * c[1]) * t + c[2]
        return slopes

    def _at(self, x: ArrayLike) -> tuple[FloatArray, FloatArray]:
        at = np.asarray(x, dtype=float)
        piece = np.searchsorted(self.nodes[1:-1], at, side="right")
        return self.pieces[:, piece], (at - self.nodes[piece])[..., None]


@dataclass(frozen=True)
class ResponseTable:
    """Single joints in a long tube, by finite elements.

    Attributes
    ----------
    alpha, openF, pressure : Axis
        rad, mm, MPa.
    log_rate : (A, O, P)
        Logarithm of theta / pressure, rad / MPa.
    coarse : Axis
        The Q pressures of the fields.
    fields : (A, O, Q, 4, M)
        Turn, stretch, shift, growth over theta: 1, mm, mm, mm per rad.
    inside, outside : (I,), (M - I,)
        Where the fields are tabulated: shares of openF / 2; mm outside the cut.
    wrapped : (2, P)
        What the wrapped tube does by itself: stretch per mm, growth of its height in mm.
    neighbours : Neighbours
    diameter, wall, stiffness : float
        Of the tabulated tube: mm, mm, C10 + C01 in MPa.
    about : dict
        Where the numbers come from and how good they are.
    """

    alpha: Axis
    openF: Axis
    pressure: Axis
    log_rate: FloatArray
    coarse: Axis
    fields: FloatArray
    inside: FloatArray
    outside: FloatArray
    wrapped: FloatArray
    neighbours: Neighbours
    diameter: float
    wall: float
    stiffness: float
    about: dict[str, Any]

    def places(self, openF: FloatArray) -> FloatArray:
        """Places at which halves of n joints are tabulated, from their middles: (n, M) mm."""
        half = 0.5 * openF[:, None]
        return np.concatenate([half * self.inside, half + self.outside], axis=1)

    def log_rates(self, openF: ArrayLike, pressure: ArrayLike) -> FloatArray:
        """Logarithm of theta / pressure at the nodes of alpha; arguments broadcast: (..., A)."""
        openF, pressure = np.broadcast_arrays(openF, pressure)
        weights = self.openF.weights(openF)[..., :, None] * self.pressure.weights(pressure)[
            ..., None, :
        ]  # fmt: skip
        flat = weights.reshape(*weights.shape[:-2], -1)
        rates: FloatArray = flat @ self.log_rate.reshape(len(self.log_rate), -1).T
        return rates

    def joints(
        self, alpha: FloatArray, openF: FloatArray, pressure: float
    ) -> tuple[FloatArray, FloatArray]:
        """Angle of n joints alone at one pressure, and their fields over it: (n,), (n, 4, M)."""
        many, few, Q, kinds, M = self.fields.shape
        grid = self.alpha.weights(alpha)[:, :, None] * self.openF.weights(openF)[:, None, :]
        grid = grid.reshape(len(grid), many * few)
        rates = self.log_rate.reshape(many * few, -1) @ self.pressure.weights(pressure)
        at = self.coarse.weights(pressure) @ self.fields.reshape(-1, Q, kinds * M)
        return pressure * np.exp(grid @ rates), (grid @ at).reshape(-1, kinds, M)

    def save(self, file: IO[bytes]) -> None:
        """Write the table as an npz file."""
        kept = {
            "log_rate": self.log_rate,
            "fields": self.fields,
            "inside": self.inside,
            "outside": self.outside,
            "wrapped": self.wrapped,
            "modes": self.neighbours.modes,
        }
        single: dict[str, Any] = {name: v.astype(np.float32) for name, v in kept.items()}
        np.savez_compressed(
            file,
            alpha=self.alpha.nodes,
            openF=self.openF.nodes,
            pressure=self.pressure.nodes,
            coarse=self.coarse.nodes,
            tube=np.array([self.diameter, self.wall, self.stiffness]),
            about=np.array(json.dumps(self.about)),
            **single,
        )

    @classmethod
    def read(cls, file: IO[bytes]) -> ResponseTable:
        """Read what `save` wrote."""
        with np.load(file, allow_pickle=False) as kept:
            values = {name: kept[name] for name in kept.files}
        about = json.loads(str(values.pop("about")))
        values = {name: v.astype(float) for name, v in values.items()}
        diameter, wall, stiffness = values["tube"]
        axes = {name: Axis.through(values[name]) for name in ("alpha", "openF", "pressure")}
        return cls(
            **axes,
            coarse=Axis.through(values["coarse"]),
            log_rate=values["log_rate"],
            fields=values["fields"],
            inside=values["inside"],
            outside=values["outside"],
            wrapped=values["wrapped"],
            neighbours=Neighbours(values["modes"]),
            diameter=float(diameter),
            wall=float(wall),
            stiffness=float(stiffness),
            about=about,
        )


@cache
def shipped() -> ResponseTable:
    """Read the table that comes with the package, once."""
    with resources.files("profiletool.bending").joinpath(FILE).open("rb") as file:
        return ResponseTable.read(file)
