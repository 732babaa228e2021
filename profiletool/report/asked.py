"""What a design was asked for, as the options of the command say it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from profiletool.records.request import Request
from profiletool.report.tables import Option

_ALWAYS = frozenset(
    (
        "--side", "--from", "--to", "--diameter", "--wall", "--pitch", "--max-pressure",
        "--max-length", "--method", "--joints", "--tolerance", "--verify", "--refine",
    )
)  # fmt: skip


def options_of(request: Request) -> tuple[Option, ...]:
    """Give the options that differ from their defaults, and the main ones that do not.

    Files are told by their names alone: where they lay is nobody's business.
    """
    asked, usual = _values(request), _values(Request(request.file, verify=True))
    options = (Option(name, value, usual[name]) for name, value in asked.items())
    return tuple(option for option in options if option.changed or option.name in _ALWAYS)


def _values(request: Request) -> dict[str, str]:
    scale, material, look = request.scale, request.material, request.look
    return {
        "--height": _mm(scale.height_mm),
        "--width": _mm(scale.width_mm),
        "--mm-per-px": "not given" if scale.mm_per_px is None else f"{scale.mm_per_px:g}",
        "--marker-mm": _mm(scale.marker_mm),
        "--camera-distance": _mm(scale.camera_distance_mm),
        "--box": _px(look.box),
        "--point": _px(look.point),
        "--mask": "not given" if look.mask is None else PurePath(look.mask).name,
        "--rotate": look.rotate if look.rotate == "auto" else f"{look.rotate:g}°",
        "--symmetric": _yes(look.symmetric),
        "--side": request.side,
        "--from": f"{request.start_pct:g} %",
        "--to": f"{request.end_pct:g} %",
        "--clearance": _mm(request.clearance_mm),
        "--diameter": _mm(material.outer_diameter_mm),
        "--wall": _mm(material.wall_mm),
        "--root": f"at least {_mm(material.root_mm)}",
        "--pitch": _mm(material.pitch_mm),
        "--max-pressure": f"{material.max_pressure_bar:g} bar",
        "--max-length": _mm(material.max_length_mm),
        "--formula": "paper" if request.formula is None else PurePath(request.formula).name,
        "--extrapolate": _yes(request.extrapolate),
        "--method": request.method,
        "--joints": "as few as will do" if request.joints is None else f"{request.joints}",
        "--tolerance": _mm(request.tolerance_mm, "the method's"),
        "--interference": _mm(request.interference_mm),
        "--base-free": _yes(request.base_free),
        "--alpha-step": "one thread"
        if request.alpha_step_deg is None
        else f"{request.alpha_step_deg:g}°",
        "--place-step": _mm(request.place_step_mm),
        "--verify": _yes(request.verify),
        "--refine": _yes(request.refine),
    }


def _mm(length: float | None, absent: str = "not given") -> str:
    return absent if length is None else f"{length:g} mm"


def _px(values: Sequence[float] | None) -> str:
    return "not given" if values is None else ",".join(f"{value:g}" for value in values) + " px"


def _yes(value: bool) -> str:
    return "yes" if value else "no"
