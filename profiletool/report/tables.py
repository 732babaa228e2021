"""The tables of the report: joints, loads on the tube, sensitivity, and the design's origin."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import radians

from profiletool.joints.windows import slit_rows
from profiletool.records.design import Design, Joint, Source
from profiletool.records.fe import FeState, Verification
from profiletool.records.units import FloatArray
from profiletool.records.version import VERSION
from profiletool.report.markup import Markup, joined, pairs, signed, table, tag
from profiletool.report.text import scale_text
from profiletool.template.labels import short
from profiletool.template.unroll import slits

_NOTHING = "–"


@dataclass(frozen=True)
class AskedOption:
    """An option of the command: its value, and the value where it is not given."""

    name: str
    value: str
    usual: str

    @property
    def changed(self) -> bool:
        """Whether it differs from its default."""
        return self.value != self.usual


def joint_table(design: Design, places: FloatArray) -> Markup:
    """Tabulate all joints; ``places`` (n,) mm along the profile."""
    heads = (
        "Joint", "F (mm)", "openF (mm)", "slits (rows)", "alpha closed (°)",
        "alpha (threads)", "bends", "θ wanted (°)", "θ formula (°)", "θ joint response (°)",
        "θ FE (°)", "largest stretch", "on the tube (mm)", "on the profile (mm)",
    )  # fmt: skip
    rows = [
        _joint_row(joint, design, place)
        for joint, place in zip(design.joints, places.tolist(), strict=True)
    ]
    said = (
        f"Angles at {design.pressure_bar:.2f} bar, positive toward the object. Places are the "
        "cuts' centres: along the tube from the clamp's edge, along the profile from its start."
    )
    return table(heads, rows, said)


def slit_table(design: Design) -> Markup:
    """Tabulate where the slits of every joint are, and what stays uncut."""
    pitch = design.gauze.pitch_mm
    found = slits(design.joints, design.tube, design.gauze)
    heads = ("Joint", "x from the clamp's edge (mm)", "rows, per turn", "slits, all turns",
             "threads left uncut, by turn", "on the side")  # fmt: skip
    rows = [
        (
            f"{joint.number}",
            _places(joint, pitch),
            f"{len(slit_rows(joint, pitch))}",
            f"{sum(slit.joint == joint.number for slit in found)}",
            threads_left(joint, design),
            "far" if joint.away else "object's",
        )
        for joint in design.joints
    ]
    return table(heads, rows, "Slits of every joint")


def pressure_table(design: Design, found: Verification) -> Markup:
    """Tabulate the angles to expect at the pressures of finite elements."""
    heads = (
        "P (bar)",
        *(f"{_mark(joint, design)}θ{joint.number} (°)" for joint in design.joints),
        "air (ml)",
    )
    rows = [
        (
            f"{state.pressure_bar:.2f}",
            *(signed(theta) for theta in state.theta_deg),
            f"{state.air_ml:.1f}",
        )
        for state in found.states
    ]
    return table(heads, rows, "Angles by finite elements, positive toward the object")


def loads(state: FeState, design: Design) -> Markup:
    """Tabulate the demands of a state of finite elements on rubber, gauze and air supply."""
    stretches = list(zip(design.joints, state.joint_stretch, strict=True))
    worst, _ = max(stretches, key=lambda pair: pair[1])
    rows = [
        ("Air, beyond that at rest", f"{state.air_ml:.1f} ml"),
        ("Rubber, largest stretch", f"{state.largest_stretch:.2f}, at joint {worst.number}"),
        ("Rubber, by joint", ", ".join(f"{joint.number}: {most:.2f}" for joint, most in stretches)),
        ("Rubber, least volume ratio J", f"{state.least_J:.3f}"),
        ("Thread, largest force", f"{state.thread_N:.1f} N"),
        ("Gauze, slack axial threads", f"{100.0 * state.slack_share:.0f} % of the wrapped surface"),
        (
            "Tube, runs into itself",
            f"by {state.overlap_mm:.1f} mm; the model lets it" if state.touches else "no",
        ),
    ]
    return pairs(rows)


def sensitivity_table(design: Design) -> Markup:
    """Tabulate what small errors of the build do to the shape."""
    rows = [
        (
            row.what,
            _NOTHING if row.joint is None else f"joint {row.joint}",
            f"{row.rms_mm:.2f}",
            f"{row.max_mm:.2f}",
        )
        for row in design.sensitivity
    ]
    heads = ("What is off", "worst at", "RMS (mm)", "at most (mm)")
    said = "How far the object-facing line under pressure moves, to first order, where this is off"
    return table(heads, rows, said)


def threads_left(joint: Joint, design: Design) -> str:
    """Count the axial threads that a joint's slits leave whole: by turn where these differ."""
    counts = [row.uncut for row in design.threads if row.joint == joint.number]
    return " / ".join(map(str, counts if len(set(counts)) > 1 else counts[:1])) or _NOTHING


def _alpha_threads(joint: Joint, design: Design) -> str:
    """Extent of the uncut sector in threads, as finite elements smear it."""
    return short(radians(joint.alpha_closed_deg) / design.thread_rad)


def _seen(source: Source) -> Iterator[tuple[str, str]]:
    """Tell how the object was found and what was done to its outline."""
    if source.confidence is not None:
        yield "Silhouette", f"sure to {100.0 * source.confidence:.0f} %"
    if source.rotated_deg:
        yield "Turned", f"{source.rotated_deg:.1f}° counter-clockwise"
    if source.symmetric:
        yield "Sides", "the mean of both"


def provenance(
    design: Design, found: Verification | None, options: Sequence[AskedOption]
) -> Markup:
    """Tabulate what the design was made from, and how; ``options`` are those asked for."""
    source, formula = design.source, design.formula
    own = "in mm already" if source.scale_source == "vector" else "sized as given"
    scale = own if source.mm_per_px is None else scale_text(source, digits=6)
    rows: list[tuple[str, str]] = [
        ("Input", tag("bdi", source.file)),
        ("SHA-256 of the input", tag("code", source.sha256)),
        ("Scale", f"{scale}, from {source.scale_source}"),
        *_seen(source),
        (
            "Profile",
            f"{source.side} side, {source.profile_length_mm:.1f} mm, "
            f"{100.0 * source.bridged_share:.0f} % of it bridged",
        ),
        ("Formula", tag("bdi", formula.name)),
        ("SHA-256 of the formula", tag("code", formula.sha256)),
        ("Mesh", _mesh(found)),
        ("Made by", f"profiletool {VERSION}"),
    ]
    asked = [
        (
            tag("code", option.name),
            tag("strong", option.value) if option.changed else option.value,
            option.usual,
        )
        for option in options
    ]
    heads = ("Option", "asked", "default")
    return joined((pairs(rows), table(heads, asked, "What was asked for", "words")))


def _joint_row(joint: Joint, design: Design, place: float) -> tuple[str, ...]:
    gauze = design.gauze
    return (
        f"{joint.number}",
        f"{joint.F_mm:.1f}",
        f"{joint.openF_mm:g}",
        f"{len(slit_rows(joint, gauze.pitch_mm))}",
        f"{joint.alpha_closed_deg:.1f}",
        _alpha_threads(joint, design),
        f"{'away' if joint.away else 'toward'} ({joint.alpha_center_deg:g}°)",
        *(
            _NOTHING if theta is None else signed(joint.signed(theta))
            for theta in (
                joint.theta_target_deg,
                joint.theta_formula_deg,
                joint.theta_response_deg,
            )
        ),
        _NOTHING
        if joint.theta_fe_deg is None
        else f"{_mark(joint, design)}{signed(joint.signed(joint.theta_fe_deg))}",
        _NOTHING if joint.stretch_fe is None else f"{joint.stretch_fe:.2f}",
        f"{joint.centre_mm:.1f}",
        f"{place:.1f}",
    )


def _mark(joint: Joint, design: Design) -> str:
    """Mark an angle by FE that is uncertain, as the joint is near to another."""
    return "~" if joint.number in design.theta_uncertain else ""


def _mesh(found: Verification | None) -> str:
    if found is None:
        return "no finite elements were run"
    return (
        f"{found.elements} elements, {found.nodes} nodes, {found.dofs} unknowns; "
        f"{found.newton_iterations} Newton iterations"
    )


def _places(joint: Joint, pitch_mm: float) -> str:
    """Say where a joint's rows of slits are along the tube."""
    rows = slit_rows(joint, pitch_mm)
    if len(rows) == 1:
        return short(rows[0])
    return f"{short(rows[0])} to {short(rows[-1])}, every {pitch_mm:g}"
