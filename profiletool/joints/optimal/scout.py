"""A rough look at what joints can reach on a profile: a coarse search, nothing polished.

About ten times quicker than the choice. It reads high where joints are far off the profile, and
within a third where they are near it: good enough to tell which other options are worth a choice.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from profiletool.bending.model import Model
from profiletool.joints.bounds import cuts_of, limits_of
from profiletool.joints.optimal.lines import Discretisation
from profiletool.joints.optimal.search import MOST_JOINTS, search
from profiletool.records.profile import Profile
from profiletool.records.request import INTERFERENCE_MM, TubeSpec
from profiletool.records.units import FloatArray

_COARSE = Discretisation(2.5, (-0.1, 0.0, 0.1), (-0.3, 0.7, 2.0), least_pressure=0.0)
_PLACES = 60  # at most: the time grows with their square
_LONGEST = 1.05  # times the longest tube, which stretches by about that
_PRESSURE_STEP = 0.35  # of the highest: at three pressures


def scout(profile: Profile, model: Model, spec: TubeSpec) -> FloatArray:
    """Look how near joints come to a profile.

    Parameters
    ----------
    profile : Profile
    model : Model
    spec : TubeSpec

    Returns
    -------
    (J,) array, mm
        RMS with 1 to J joints, about; infinite where there is no way.

    Raises
    ------
    formula.errors.OutOfRange
        When no cut in whole meshes is known to the model.
    """
    if profile.length_mm > _LONGEST * spec.max_length_mm:
        return np.full(MOST_JOINTS, np.inf)
    limits, cuts = limits_of(model, spec), cuts_of(model, spec)
    small = min(spec.radius_mm / 10.0 + 0.2, 1.0)
    grid = replace(
        _COARSE,
        step_mm=max(small * _COARSE.step_mm, profile.length_mm / _PLACES),
        pressure_step=_PRESSURE_STEP * limits.pressure[1],
    )
    found = search(profile, model, cuts, limits, INTERFERENCE_MM, grid, MOST_JOINTS)
    rms: FloatArray = np.sqrt(found.cost.min(axis=0) / profile.length_mm)
    return rms
