"""Sampled builds of a design by finite elements: the check of what is expected of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from profiletool.campaign.build_kind import BuildTask
from profiletool.records.built import BuildErrors, BuiltMisfit
from profiletool.records.design import Design
from profiletool.records.units import FloatArray
from profiletool.verify.built import P95
from profiletool.verify.sample import SampledBuild, draws_of

RunAll = Callable[[Sequence[BuildTask]], Sequence[SampledBuild]]
_DECIMALS = 3


@dataclass(frozen=True)
class SampledBuilds:
    """Sampled builds, as `profiletool.records.built.Built` tells them to first order.

    Attributes
    ----------
    samples : int
        Builds that finite elements could bend.
    expected_rms_mm, p95_rms_mm : BuiltMisfit
    failures : tuple of str
        Why the others could not be bent.
    """

    samples: int
    expected_rms_mm: BuiltMisfit
    p95_rms_mm: BuiltMisfit
    failures: tuple[str, ...]


def sample_builds(
    design: Design, points: FloatArray, build: BuildErrors, count: int, run_all: RunAll
) -> SampledBuilds:
    """Run sampled builds of a design.

    Parameters
    ----------
    design : Design
    points : (M, 2) mm
        Of the profile, evenly spaced.
    build : BuildErrors
    count : int
        How many builds.
    run_all : callable
        Tasks to outcomes, in the order of the tasks.
    """
    target = tuple((float(x), float(y)) for x, y in points)
    tasks = [BuildTask(design, target, draw) for draw in draws_of(build, len(design.joints), count)]
    found = run_all(tasks)
    good = np.array([(one.as_set_mm, one.trimmed_mm) for one in found if one.failure is None])
    failures = tuple(one.failure for one in found if one.failure is not None)
    if len(good) == 0:
        return SampledBuilds(0, BuiltMisfit(None, None), BuiltMisfit(None, None), failures)
    expected = np.sqrt(np.mean(good**2, axis=0)).round(_DECIMALS).tolist()
    most = np.percentile(good, P95, axis=0).round(_DECIMALS).tolist()
    return SampledBuilds(len(good), BuiltMisfit(*expected), BuiltMisfit(*most), failures)
