"""Step sizes of the numbers that are built: threads, places, the pressure."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from profiletool.joints.correction.parameters import Parameters
from profiletool.joints.correction.surrogate import Surrogate
from profiletool.records.units import FloatArray

_MESH_COSTS_MM = 0.1  # RMS: what nobody sees, where every cut falls on whole threads


@dataclass(frozen=True)
class StepSizes:
    """The steps that numbers come in; 0 where they are free. rad, mm, MPa.

    ``mesh`` is another step of places, taken where it costs less than `_MESH_COSTS_MM`.
    """

    alpha: float
    place: float
    pressure: float
    mesh: float | None = None


def settled(surrogate: Surrogate, vector: FloatArray, steps: StepSizes) -> StepSizes:
    """Settle the step of the places: the mesh's where a surrogate promises that it costs little."""
    if steps.mesh is None:
        return steps
    meshes = replace(steps, place=steps.mesh)
    fine, coarse = (
        np.sqrt(surrogate.nominal(surrogate.built(sizes)[0]))
        for sizes in (sizes_of(vector, surrogate.parameters, those) for those in (steps, meshes))
    )
    return meshes if coarse < fine + _MESH_COSTS_MM else steps


def sizes_of(vector: FloatArray, parameters: Parameters, steps: StepSizes) -> FloatArray:
    """Step of each number: the tube slides freely as long as its root keeps its length."""
    n = parameters.joints
    sizes = [steps.alpha] * n + [steps.place] * (n - 1)
    sizes += [steps.place if parameters.root_grows(vector) else 0.0, steps.pressure]
    return np.array(sizes + [0.0, 0.0] * parameters.limits.base_free)
