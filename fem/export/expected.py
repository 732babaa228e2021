"""The results that another code should find for a deck, by this engine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.arrays import FloatArray
from fem.errors import NotConverged
from fem.export.deck import Deck
from fem.export.springs import with_springs
from fem.mesh import Mesh
from fem.solution import Solution
from fem.solver import solve_mesh


@dataclass(frozen=True)
class Expected:
    """States of a deck, of the same bricks and springs; S steps, as far as the engine came.

    Attributes
    ----------
    pressure : (S,) MPa
    theta : (S, joints) rad
    tip : (S, 3) mm
        Displacement of TIP.
    air : (S,) mm^3
        Volume of the air inside the whole tube.
    """

    pressure: FloatArray
    theta: FloatArray
    tip: FloatArray
    air: FloatArray


def expect(
    deck: Deck, mesh: Mesh, progress: Callable[[float], None] | None = None, threads: int = 2
) -> Expected:
    """Solve a deck with this engine.

    Parameters
    ----------
    deck : Deck
    mesh : Mesh
        The mesh that it was made from.
    progress : callable, optional
        Takes the pressure reached so far, MPa.
    threads : {1, 2}
        Of the computer.
    """
    try:
        found = solve_mesh(with_springs(mesh), deck.pressures, threads=threads, progress=progress)
    except NotConverged as error:
        if not isinstance(error.solution, Solution):
            raise
        found = error.solution
    states = found.states[1:]
    tips = [state.x.reshape(-1, 3)[deck.tip] - deck.X[deck.tip] for state in states]
    return Expected(
        pressure=np.array([state.pressure for state in states]),
        theta=np.array([state.theta for state in states]).reshape(len(states), -1),
        tip=np.array(tips).reshape(-1, 3),
        air=np.array([state.volume for state in states]),
    )
