"""The misfit to expect of the actuator that is built, by FE's own derivatives.

To first order an error e_k moves the line by e_k g_k, so that the mean square over all builds is
the nominal one and the sum of sigma_k^2 mean(g_k^2). Setting the pressure on the finished actuator
takes the part along g_P out of every error but the pressure's own.

Glossary
--------
K, M, S : number of errors, of the profile's points, of sampled builds
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from profiletool.records.built import BuildErrors, Built, BuiltMisfit, BuiltPart
from profiletool.records.design import Design
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.verify.fields import ErrorFields

_SAMPLES, _SEED = 20_000, 2020
_BAND_SAMPLES = 2_000
_DECIMALS = 3  # of what goes into design.json
P95 = 95.0


@dataclass(frozen=True)
class ErrorGroup:
    """Errors of one kind, each with its own field at one standard deviation.

    Attributes
    ----------
    what : str
        A field of `BuildErrors`.
    moved : (k, M) mm
        For one sigma; k is 1 for errors of the whole actuator, else the number of joints.
    """

    what: str
    moved: FloatArray

    def rms(self) -> float:
        """Root of the mean square over all builds, mm."""
        return float(np.sqrt(np.sum(np.mean(self.moved**2, axis=-1))))


def groups_of(design: Design, fields: ErrorFields, build: BuildErrors) -> tuple[ErrorGroup, ...]:
    """Give the errors of a build with their fields, in the order of `BuildErrors`.

    A cut that is too long is so at both ends, and a joint off its place moves alone: both are
    measured from the clamped end.
    """
    before, behind = fields.wrapped[:-1], fields.wrapped[1:]
    units = {
        "pressure": fields.pressure[None] / BAR_PER_MPA,
        "thread": design.thread_rad * fields.alpha,
        "rubber": 0.01 * fields.rubber[None],
        "wall": 0.01 * design.tube.wall_mm * fields.wall[None],
        "cut": fields.openF - 0.5 * (before + behind),
        "place": before - behind,
    }
    return tuple(ErrorGroup(what, build.sigma(what) * moved) for what, moved in units.items())


def trimmed(groups: tuple[ErrorGroup, ...], pressure: FloatArray) -> tuple[ErrorGroup, ...]:
    """Give the errors that are left once the pressure is set on the finished actuator.

    Parameters
    ----------
    groups : tuple of ErrorGroup
    pressure : (M,)
        The pressure's field, in any unit.
    """
    along = pressure / np.linalg.norm(pressure)
    return tuple(
        group
        if group.what == "pressure"
        else ErrorGroup(group.what, group.moved - np.outer(group.moved @ along, along))
        for group in groups
    )


def built_of(design: Design, fields: ErrorFields, build: BuildErrors) -> Built:
    """Say what to expect of the actuator that is built.

    Parameters
    ----------
    design : Design
        Verified.
    fields : ErrorFields
        Of the design.
    build : BuildErrors
    """
    as_set = groups_of(design, fields, build)
    after = trimmed(as_set, fields.pressure)
    parts = tuple(
        BuiltPart(one.what, round(one.rms(), _DECIMALS), round(other.rms(), _DECIMALS))
        for one, other in zip(as_set, after, strict=True)
        if getattr(build, one.what) > 0.0
    )
    both = [sampled(fields.gap, groups) for groups in (as_set, after)]
    expected = (_expected(fields.gap, groups) for groups in (as_set, after))
    most = (float(np.percentile(rms, P95)) for rms in both)
    return Built(
        build,
        BuiltMisfit(*(round(value, _DECIMALS) for value in expected)),
        BuiltMisfit(*(round(value, _DECIMALS) for value in most)),
        parts,
    )


def band_of(design: Design, fields: ErrorFields, build: BuildErrors) -> FloatArray:
    """Give the band about the line that holds 95 % of builds at every point, pressure set.

    Returns
    -------
    (2, M, 2) mm
        Its edge on the object's side first, where both go.
    """
    groups = trimmed(groups_of(design, fields, build), fields.pressure)
    moved = np.vstack([group.moved for group in groups])
    off = np.abs(draws((_BAND_SAMPLES, len(moved))) @ moved)
    half = np.percentile(off, P95, axis=0)[:, None] * fields.normal
    return np.stack([fields.closest - half, fields.closest + half])


def _expected(gap: FloatArray, groups: tuple[ErrorGroup, ...]) -> float:
    return float(np.sqrt(np.mean(gap**2) + sum(group.rms() ** 2 for group in groups)))


def draws(shape: tuple[int, ...], seed: int = _SEED) -> FloatArray:
    """Draw errors of one standard deviation from uniform distributions: the same every time."""
    bound = np.sqrt(3.0)
    return np.random.default_rng(seed).uniform(-bound, bound, shape)


def sampled(gap: FloatArray, groups: tuple[ErrorGroup, ...]) -> FloatArray:
    """RMS of sampled builds, to first order: (S,) mm."""
    moved = np.vstack([gap, *(group.moved for group in groups)])
    # The mean square is a quadratic form of the errors: no need of all points for every build.
    form = moved @ moved.T / len(gap)
    errors = np.column_stack([np.ones(_SAMPLES), draws((_SAMPLES, len(form) - 1))])
    squares = np.einsum("sk,kj,sj->s", errors, form, errors, optimize=True)
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)))
