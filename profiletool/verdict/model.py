"""What a design says of the model: its inputs, its mesh, and the single threads of its sectors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from fem.solution import Solution
from profiletool.records.built import BuiltMisfit
from profiletool.records.design import Design
from profiletool.records.model import PAPER_MODEL, PAPER_NU
from profiletool.template.threads import threads_of, whole_angles
from profiletool.verify.threads import sheet_lines, threads_off

_NOTED_MM = 0.5  # a difference of the threads, after the trim, that a design says
_MESH_SHARE = 0.005  # of the length: what the default mesh leaves in a shape, at most


def model_notes(design: Design, refined: bool) -> Iterator[str]:
    """Say which model finite elements bent a verified design by, and how good its mesh is.

    Parameters
    ----------
    design : Design
    refined : bool
        Whether finite elements corrected it, too.
    """
    if not design.verified:
        if design.model != PAPER_MODEL:
            yield f"no finite elements took {design.model} into account"
        return
    length = design.tube.length_mm
    mesh = f"its mesh leaves up to {_MESH_SHARE * length:.1f} mm in the shape"
    if design.model == PAPER_MODEL and design.tube.rubber is None:
        yield (
            f"finite elements take the paper's Poisson's ratio, {PAPER_NU:g}; rubber is nearly "
            "incompressible, and bends some mm less until the pressure is set on the finished "
            f"tube (`nu`); {mesh}"
        )
    elif design.model == PAPER_MODEL:
        yield f"finite elements: {mesh}"
    else:
        yield f"finite elements take {design.model}; {mesh}"
        if refined:
            yield (
                "the first choice of joints is by the paper's model; finite elements corrected it"
            )


def with_threads(design: Design, smeared: Solution | None = None) -> Design:
    """Run finite elements with the single threads of a design's sectors, as its sheet has them.

    Parameters
    ----------
    design : Design
    smeared : Solution, optional
        Of the design at its pressure, by the smeared gauze; it is run where none is given.

    Returns
    -------
    Design
        With ``threads`` and ``threads_off_mm``, and a note where they are far off.

    Raises
    ------
    fem.errors.FemError
        Where one of the runs has no state at the pressure.
    """
    off = threads_off(design, sheet_lines(design, whole_angles(design)), smeared)
    return replace(
        design,
        threads=threads_of(design),
        threads_off_mm=off,
        warnings=(*design.warnings, *threads_note(off)),
    )


def threads_note(off: BuiltMisfit) -> Iterator[str]:
    """Say by how much the sheet's threads differ from the smeared gauze, where that is much."""
    if off.trimmed is not None and off.trimmed > _NOTED_MM:
        yield (
            "the sheet's single threads bend the tube otherwise than the smeared gauze: "
            f"{off.trimmed:.1f} mm RMS apart once the pressure is set, {off.as_set:.1f} before"
        )
