"""The report's part on the actuator that is built: what to expect, what each error costs."""

from __future__ import annotations

from profiletool.records.built import Built, mm_text
from profiletool.records.design import Design
from profiletool.report.markup import Markup, joined, table, tag

_UNITS = {
    "pressure": ("pressure", "bar"),
    "thread": ("uncut threads, each sector", "threads"),
    "rubber": ("rubber's stiffness", "%"),
    "wall": ("wall", "%"),
    "cut": ("length, each cut", "mm"),
    "place": ("place, each joint", "mm"),
}


def expectation(design: Design) -> Markup:
    """Tell what to expect of the built actuator; empty where it is not known."""
    built = design.built
    if built is None:
        return joined(())
    said = (
        "The verdict's distance is that of perfect parts. An actuator whose parts are off, each "
        "anywhere within the bounds below, lies this far off the profile, to first order in the "
        "errors. Rubber, wall and pressure act in one direction, so setting the pressure once on "
        "the finished actuator takes their errors out. The orange band beside the tube holds 95 % "
        "of builds after that."
    )
    return joined((tag("p", said), _figures(built), _parts(built), _threads(design)))


def _figures(built: Built) -> Markup:
    rows = [
        (what, mm_text(misfit.as_set), mm_text(misfit.trimmed))
        for what, misfit in (
            ("expected (root of the mean square)", built.expected_rms_mm),
            ("95 % of builds lie within", built.p95_rms_mm),
        )
    ]
    heads = ("RMS off the profile (mm)", "at the planned pressure", "pressure set on it")
    return table(heads, rows, "The actuator that is built", "words")


def _parts(built: Built) -> Markup:
    rows = []
    for part in built.parts:
        name, unit = _UNITS[part.what]
        bound = f"± {getattr(built.build, part.what):g} {unit}"
        rows.append((name, bound, f"{part.as_set:.2f}", f"{part.trimmed:.2f}"))
    heads = ("What is off", "by", "before (mm RMS)", "pressure set (mm RMS)")
    said = "The share of each error: its standard deviation, which is its bound over √3"
    return table(heads, rows, said)


def _threads(design: Design) -> Markup:
    off = design.threads_off_mm
    if off is None:
        return joined(())
    return tag(
        "p",
        "Finite elements smear the axial threads over the gauze. With the single threads that the "
        f"template's sheet leaves whole the tube lies {mm_text(off.as_set)} mm RMS beside that, "
        f"{mm_text(off.trimmed)} mm once the pressure is set.",
    )
