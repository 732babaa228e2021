"""Notes on the model that finite elements bent a design by: its inputs and its mesh."""

from __future__ import annotations

from collections.abc import Iterator

from profiletool.records.design import Design
from profiletool.records.model import PAPER_MODEL, PAPER_NU
from profiletool.verify.threads import threads_note

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
    if design.threads_off_mm is not None:
        yield from threads_note(design.threads_off_mm)
    elif design.threads:
        yield (
            "no state with the sheet's single threads lies near that of the smeared gauze: the "
            "tube may bend far otherwise; `profiletool verify --threads` says how far"
        )
    length = design.tube.length_mm
    mesh = f"the mesh leaves up to {_MESH_SHARE * length:.1f} mm in the shape"
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
