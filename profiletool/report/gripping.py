"""The report's part on the finger against its object: pressure to work at, forces, payload."""

from __future__ import annotations

from profiletool.records.built import mm_text
from profiletool.records.design import Design
from profiletool.records.grip import Grip
from profiletool.records.units import FloatArray
from profiletool.report.grip import force_figure, pressure_figure
from profiletool.report.markup import Markup, joined, signed, table, tag
from profiletool.report.plotted import plotted

_SHOWN_MU = (0.0, 0.3, 0.5, 1.0)


def gripping(grip: Grip, design: Design, target: FloatArray) -> Markup:
    """Tell how the finger presses on its object.

    Parameters
    ----------
    grip : Grip
        With at least one state.
    design : Design
    target : (N, 2) mm
        The profile.
    """
    return joined(
        (
            *_advice(grip, design),
            tag(
                "div",
                plotted(pressure_figure(grip, target), "contact", _CONTACT.format(_last(grip))),
                plotted(force_figure(grip), "force", _FORCE),
                class_="two",
            ),
            _forces(grip),
            *_carried(grip),
        )
    )


_CONTACT = (
    "The finger on its object at {} bar: the colour along the profile is the contact pressure, "
    "in the mean over 2 mm around each point."
)
_FORCE = "Force of one finger on the object, and its distance off the profile, against pressure."


def _last(grip: Grip) -> str:
    return f"{grip.states[-1].pressure_bar:.2f}"


def _advice(grip: Grip, design: Design) -> tuple[Markup, ...]:
    """Say at which pressure to work, and why."""
    if design.operate_bar is None or design.built is None:
        return ()
    expected, most = design.built.expected_rms_mm, design.built.p95_rms_mm
    said = (
        f"Work at {design.operate_bar:.2f} bar once the object is there. The shape was fitted "
        f"free, at {design.pressure_bar:.2f} bar. An actuator that is stiffer than planned falls "
        "short of the object there; one that is softer is stopped by it. So a pressure above it "
        f"costs little and gains much: {mm_text(expected.in_contact)} mm RMS are to be expected "
        f"there, and 95 % of builds lie within {mm_text(most.in_contact)} mm. One finger as "
        f"planned presses with {grip.normal_at(design.operate_bar):.2f} N there. Once the pressure "
        f"was set on the finished actuator, work at {design.operate_bar / design.pressure_bar:.2f} "
        "times that pressure."
    )
    return (tag("p", said),)


def _forces(grip: Grip) -> Markup:
    heads = (
        "P (bar)", "normal (N)", "toward the axis (N)", "along it, up (N)", "peak (kPa)",
        "touches (%)", "off the profile (mm RMS)",
    )  # fmt: skip
    rows = [
        (
            f"{s.pressure_bar:.2f}", f"{s.normal_N:.2f}", signed(s.radial_N, 2),
            signed(s.axial_N, 2), f"{s.peak_kPa:.0f}", f"{100.0 * s.contact_share:.0f}",
            f"{s.misfit_rms_mm:.2f}",
        )
        for s in grip.states
    ]  # fmt: skip
    said = (
        "One finger on the rigid object without friction, by finite elements; the sector that the "
        "clamp holds is left out."
    )
    return table(heads, rows, said)


def _carried(grip: Grip) -> tuple[Markup, ...]:
    payload = grip.payload
    if payload is None:
        return ()
    rows = [
        (f"{mu:g}", f"{load:.2f}", f"{tilt:.0f}")
        for mu, load, tilt in zip(payload.friction, payload.load_N, payload.tilt_Nmm, strict=True)
        if mu in _SHOWN_MU
    ]
    heads = ("friction", "carries (N)", "bears tilting (N mm)")
    alone = payload.undercut_N
    without = f"carry {alone:.2f} N" if alone >= 0.0 else f"push the object out with {-alone:.2f} N"
    said = (
        f"{payload.fingers} such fingers evenly around the object at {payload.pressure_bar:.2f} "
        f"bar. Without friction they {without}."
    )
    return (table(heads, rows, said),)
