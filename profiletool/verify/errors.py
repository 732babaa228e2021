"""Errors of the build in a verified design: sensitivities, the built misfit, the trim table."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fem.errors import FemError
from profiletool.records.built import BuildErrors, BuiltMisfit
from profiletool.records.design import Design
from profiletool.records.units import FloatArray
from profiletool.verify.built import band_of, built_of
from profiletool.verify.fields import ErrorFields, fields_of
from profiletool.verify.run import Run
from profiletool.verify.sensitivity import sensitivity_of
from profiletool.verify.threads import sheet_off
from profiletool.verify.trim import trim_of


@dataclass(frozen=True)
class Expected:
    """A verified design with what errors of the build do to it.

    Attributes
    ----------
    design : Design
    band : (2, M, 2) array or None
        Edges of the band about the object-facing line that holds 95 % of builds, mm.
    fields : ErrorFields or None
        Both None where FE's tangent allows no derivatives.
    """

    design: Design
    band: FloatArray | None = None
    fields: ErrorFields | None = None


def with_errors(design: Design, run: Run, points: FloatArray, build: BuildErrors) -> Expected:
    """Add what errors of the build do to a verified design, and how to set its pressure.

    Parameters
    ----------
    design : Design
    run : Run
        Of the design, up to its pressure.
    points : (M, 2) mm
        Of the profile, evenly spaced.
    build : BuildErrors
    """
    design = replace(design, trim=trim_of(design, run), threads_off_mm=_threads_off(design, run))
    fields = fields_of(design, run, points)
    if fields is None:
        return Expected(design)
    sensitivity, built = sensitivity_of(design, fields, points), built_of(design, fields, build)
    told = replace(design, sensitivity=sensitivity, built=built)
    return Expected(told, band_of(design, fields, build), fields)


def _threads_off(design: Design, run: Run) -> BuiltMisfit | None:
    """Say what the sheet's single threads do; None where that is not near what smeared ones do."""
    try:
        return sheet_off(design, run.solution)
    except FemError:
        return None
