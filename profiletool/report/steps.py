"""Instructions for building an actuator, step by step, with a design's own numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

from profiletool.joints.windows import off_mesh, seam_at
from profiletool.records.design import Design, named
from profiletool.records.fe import Verification
from profiletool.records.rubber import constants_text
from profiletool.report.markup import Markup, joined, pairs, signed, tag
from profiletool.report.tables import pressure_table, slit_table
from profiletool.template.labels import short, times
from profiletool.template.notes import alone
from profiletool.template.unroll import sheet_size

_CAP_MM = 4.0  # rubber beyond the core's end, which closes the tube (the paper's)
_STEPS = 10  # up to the full pressure, as finite elements have them
_WAIT_S = 10  # at every pressure, before it is read (the paper's)
_PAPER_RUBBER = (
    "silicone RTV-4250-S (Dow Corning XIAMETER, Shore A 25), base and curing agent 10 : 1 by mass, "
    "8 h in the mould at 20 °C, cured for 24 h at 23 °C"
)
_SIDES = {270.0: "on the side that faces the object", 90.0: "on the side away from the object"}
_WAYS = ("right", "up and right", "up", "up and left", "left", "down and left", "down",
         "down and right")  # fmt: skip


@dataclass(frozen=True)
class Step:
    """One step of the work: what it is about, and how it is done."""

    title: str
    body: Markup


def steps(design: Design, found: Verification | None) -> tuple[Step, ...]:
    """List all steps from the mould to the first inflation.

    Parameters
    ----------
    design : Design
    found : Verification or None
        Angles to compare with on the way; None where no finite elements were run.
    """
    return (
        Step("Cast the tube", _tube(design)),
        Step("Print the template", _template(design)),
        Step("Cut the gauze and its slits", _slits(design)),
        Step("Glue and roll", _roll(design)),
        Step("Weld", _weld(design)),
        Step("Plug, fitting and clamp", _plug(design)),
        Step("Mount", _mount(design)),
        Step("Inflate for the first time", _inflate(design, found)),
    )


def _tube(design: Design) -> Markup:
    tube, held = design.tube, design.clamp.length_mm
    inner = tube.outer_diameter_mm - 2.0 * tube.wall_mm
    area = 0.25 * pi * (tube.outer_diameter_mm**2 - inner**2)
    cap = 0.25 * pi * tube.outer_diameter_mm**2 * _CAP_MM
    volume_ml = 1e-3 * (area * (tube.length_mm + design.clamp.length_mm) + cap)
    rubber = tube.rubber
    law = (
        _PAPER_RUBBER
        if rubber is None or rubber.name == "paper"
        else f"{rubber.name} ({constants_text(rubber)})"
    )
    return joined(
        (
            pairs(
                (
                    ("Outer diameter", f"{tube.outer_diameter_mm:g} mm"),
                    ("Inner diameter, the core's", f"{inner:g} mm"),
                    ("Wall", f"{tube.wall_mm:g} mm"),
                    (
                        "Length",
                        f"{short(tube.length_mm + held)} mm: {short(tube.length_mm)} from the "
                        f"clamp's edge, x = 0, to the closed end, and {short(held)} in the clamp",
                    ),
                    ("Rubber", law),
                    ("Rubber to pour", f"{volume_ml:.0f} ml, and what sticks to the cup"),
                )
            ),
            tag(
                "p",
                f"A core of {inner:g} mm stands centred in a mould of {tube.outer_diameter_mm:g} "
                f"mm; about {_CAP_MM:g} mm of rubber over the core's end close the tube. A groove "
                "around the core's foot makes a bead inside the tube, "
                f"{short(-design.clamp.bead_mm)} mm behind x = 0, that seals on the plug. Shake "
                "bubbles out before it sets.",
            ),
        )
    )


def _template(design: Design) -> Markup:
    along, around = sheet_size(design)
    return tag(
        "p",
        "Print ",
        _file("template.pdf"),
        " at 100 %, not fitted to the page, and measure the 100 mm bar and the check box before "
        "you cut. A cutter or plotter takes ",
        _file("template.dxf"),
        " or ",
        _file("template.svg"),
        f", in millimetres. The piece is {short(along)} mm along the tube, from its open end to "
        f"its closed one, and {short(around)} mm around it. The line x = 0 is the clamp's edge.",
    )


def _slits(design: Design) -> Markup:
    gauze = design.gauze
    along, around = sheet_size(design)
    parts = [
        tag(
            "p",
            f"Polyamide gauze, square mesh of {gauze.pitch_mm:g} mm, thread {gauze.thread_mm:g} "
            f"mm. Cut a piece of {short(along)} × {short(around)} mm with its threads along the "
            f"edges, {short(design.clamp.length_mm)} mm of it for the clamp; the start edge runs "
            "half-way between two axial threads. Each slit lies between "
            "two hoop threads and severs axial threads only. Take no gauze out: the hoop threads "
            "stay whole.",
        ),
        slit_table(design),
    ]
    stray = off_mesh(design.joints, gauze)
    if stray:
        said = f"The cuts of {named(stray)} lie off the mesh of the others: cut in the nearest "
        parts.append(tag("p", said + "meshes, never along a thread.", class_="mind"))
    return joined(parts)


def _roll(design: Design) -> Markup:
    gauze = design.gauze
    seam = gauze.seam_deg % 360.0
    return tag(
        "p",
        f"Glue the start edge along the tube {_side(seam)} ({short(seam)}°; 270° faces the "
        "object, angles run counter-clockwise as seen from the closed end). Lay the sheet face up "
        f"with the tube on it and roll it {times(gauze.turns)}, tight and square: the slits of "
        "all turns must lie over each other.",
    )


def _weld(design: Design) -> Markup:
    seam = seam_at(design.joints, design.gauze.seam_deg)
    parts = [
        tag(
            "p",
            "Weld the end edge onto the register line, along the whole tube; weld the layers "
            "together beside every cut, so that they cannot slip; weld the gauze together over "
            "the closed end, as a plug.",
        )
    ]
    if seam.crossed:
        parts.append(
            tag(
                "p",
                f"The weld line crosses the cuts of {named(seam.crossed)}: keep glue and weld off "
                "the slits there, and weld again on both sides of them.",
                class_="mind",
            )
        )
    else:
        parts.append(tag("p", "The weld line crosses no cut."))
    return joined(parts)


def _plug(design: Design) -> Markup:
    tube, first, clamp = design.tube, design.joints[0], design.clamp
    far, near = (short(-place) for place in clamp.belt_mm)
    free = tube.root_mm - 0.5 * first.openF_mm
    inner = tube.outer_diameter_mm - 2.0 * tube.wall_mm
    return joined(
        (
            tag(
                "p",
                f"An aluminium plug of {inner:g} mm with a groove for the bead and a fitting for "
                f"a 4 mm hose goes {short(clamp.length_mm)} mm into the open end: its inner face "
                "lies at x = 0. A plastic belt or a saddle around gauze, tube and plug, "
                f"{far} to {near} mm behind x = 0, holds them.",
            ),
            tag(
                "p",
                "The edge of the clamp is the template's line x = 0. From there to "
                f"the first cut the tube has {short(free)} mm of whole gauze, and its root is "
                f"{short(tube.root_mm)} mm to the middle of joint 1. Tube and gauze go on for "
                f"{short(clamp.length_mm)} mm behind it, to the open end.",
            ),
        )
    )


def _mount(design: Design) -> Markup:
    pose = design.base_pose
    return joined(
        (
            tag(
                "p",
                "Fix the plug to a stand so that the tube at rest starts and points as below, its "
                "270° side to the object. ",
                _file("mounting.pdf"),
                " shows it to scale.",
            ),
            pairs(
                (
                    (
                        "The object-facing line starts, at x = 0",
                        f"x {signed(pose.x_mm, 2)} mm, y {signed(pose.y_mm, 2)} mm from "
                        f"{origin_of(design)}, "
                        "x to the right and y up",
                    ),
                    (
                        "The tube points",
                        f"{_way(pose.heading_deg)} ({signed(pose.heading_deg)}° counter-clockwise "
                        "from right)",
                    ),
                )
            ),
        )
    )


def origin_of(design: Design) -> str:
    """Say in words where the object's frame has its origin."""
    drawn = design.source.origin_px is None
    return "the drawing's own origin" if drawn else "the object's top in the middle"


def _inflate(design: Design, found: Verification | None) -> Markup:
    critical = None if found is None else found.critical
    most = design.pressure_bar if critical is None else critical.pressure_bar
    highest = design.trim[-1].pressure_bar if design.trim else most
    to = f"to {design.pressure_bar:.2f} bar " if critical is None else ""
    parts = [
        tag(
            "p",
            f"{'Never more than' if critical is None else 'Stay below'} {highest:.2f} bar"
            f"{alone(design)}. Wear "
            f"goggles. Go up {to}in {_STEPS} even steps with a precise regulator, wait {_WAIT_S} "
            "s at each and compare. Where a joint bends much more or less than it should, or the "
            "tube bulges, let the air out and look at slits and welds.",
        )
    ]
    if critical is not None:
        said = f"By finite elements the tube meets a {critical.kind} at {most:.2f} bar: it may "
        parts.append(tag("p", f"{said}balloon or buckle there.", class_="mind"))
    if found is None:
        parts.append(
            tag(
                "p",
                "No finite elements were run: there are no angles to compare with on the way. "
                "The table of joints has those at the full pressure.",
                class_="mind",
            )
        )
    elif found.states:
        parts.append(pressure_table(design, found))
    parts += _sensitive(design)
    return joined(parts)


def _sensitive(design: Design) -> Iterator[Markup]:
    """Say what a wrong pressure does."""
    for row in design.sensitivity:
        if row.what.startswith("pressure"):
            yield tag(
                "p",
                f"With the {row.what} the shape moves by {row.rms_mm:g} mm RMS and {row.max_mm:g} "
                "mm at most: take a good gauge, and set the pressure by the shape.",
            )


def _file(name: str) -> Markup:
    return tag("code", name)


def _side(angle_deg: float) -> str:
    """Say where an angle around the tube is."""
    if angle_deg in _SIDES:
        return _SIDES[angle_deg]
    off = (angle_deg - 270.0 + 180.0) % 360.0 - 180.0
    way = "counter-clockwise" if off > 0.0 else "clockwise"
    return f"{short(abs(off))}° {way} from the side that faces the object"


def _way(heading_deg: float) -> str:
    """Say in words where a direction points; up and down only where it is no level one."""
    return _WAYS[round(heading_deg / 45.0) % 8]
