"""The options of a design: one row each, from which flags, checks, TOML keys and tables are made.

A message of the core names a field in backticks: "raise `max_length_mm`". So it reads in a
notebook; `in_flags` turns it into the command's words: "raise --max-length".
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path, PurePath

from profiletool.records.built import BuildErrors
from profiletool.records.clamp import LEAST_MM
from profiletool.records.option import ANY, Option, ValueKind


def _number(unit: str) -> ValueKind:
    return ValueKind(float, lambda value: f"{value:g}{unit}")


def _pixels(count: int) -> ValueKind:
    return ValueKind(tuple, lambda values: ",".join(f"{v:g}" for v in values) + " px", count)


def _list(unit: str) -> ValueKind:
    return ValueKind(tuple, lambda values: ",".join(f"{v:g}" for v in values) + unit, ANY)


def _choice(*choices: str) -> ValueKind:
    return ValueKind(str, str, choices=choices)


_MM, _BAR, _PERCENT, _DEG = _number(" mm"), _number(" bar"), _number(" %"), _number("°")
_RATIO, _COUNT = _number(""), ValueKind(int, str)
_YES = ValueKind(bool, lambda value: "yes" if value else "no")
_FILE = ValueKind(Path, lambda value: PurePath(value).name)
_TURN = ValueKind(str, lambda value: value if value == "auto" else f"{value:g}°", count=1)
_BUILD = ValueKind(BuildErrors, str)
_ROOT = ValueKind(float, lambda value: f"at least {value:g} mm")

_OBJECT = Option(
    "--object", "solid", _choice("auto", "turned", "extruded"),
    "What the actuator meets: the profile turned about the object's axis, or the same at every "
    "depth (auto: turned where it keeps to its side of the axis).",
)  # fmt: skip
DESIGN = (
    Option(
        "--height", "scale.height_mm", _MM, "Full height of the object, drawn or pictured, mm.",
        above=0.0,
    ),
    Option(
        "--width", "scale.width_mm", _MM, "Full width of the object, drawn or pictured, mm.",
        above=0.0,
    ),
    Option(
        "--mm-per-px", "scale.mm_per_px", _RATIO,
        "Millimetres per pixel, or per unit of a drawing.", above=0.0,
    ),
    Option(
        "--marker-mm", "scale.marker_mm", _MM,
        "Side of an ArUco DICT_4X4_50 marker in the picture, mm.", above=0.0,
    ),
    Option(
        "--camera-distance", "scale.camera_distance_mm", _MM,
        "From the lens to the marker's or printed sheet's plane, mm: parallax.", above=0.0,
    ),
    Option("--box", "look.box", _pixels(4), "The object lies in this box, px.", metavar="X,Y,W,H"),
    Option("--point", "look.point", _pixels(2), "A point inside the object, px.", metavar="X,Y"),
    Option(
        "--mask", "look.mask", _FILE,
        "The object in white on black, a picture of the same size.",
    ),
    Option(
        "--rotate", "look.rotate", _TURN,
        "Turn the object, deg counter-clockwise; auto: its axis upright.", metavar="auto|DEG",
    ),
    Option("--symmetric", "look.symmetric", _YES, "Take the mean of the object's two sides."),
    Option(
        "--flat", "look.flat", _YES,
        "The object is flat and lies on the marker's or printed sheet's plane.",
    ),
    Option(
        "--layer", "look.layer", ValueKind(str, str),
        "Read this layer of a DXF alone, or this group of an SVG.",
    ),
    Option("--side", "side", _choice("left", "right"), "Side of the object to follow.", main=True),
    Option(
        "--from", "start_pct", _PERCENT, "Start of the stretch, % of that side from the top.",
        main=True,
    ),
    Option("--to", "end_pct", _PERCENT, "End of the stretch, %.", main=True),
    Option("--clearance", "clearance_mm", _MM, "Gap between tube and object, mm.", least=0.0),
    Option(
        "--diameter", "tube.outer_diameter_mm", _MM,
        "Outer diameter of the tube, mm (default: the formula's, 20).", above=0.0, main=True,
    ),
    Option(
        "--wall", "tube.wall_mm", _MM, "Wall of the tube, mm (default: the formula's, 2).",
        above=0.0, main=True,
    ),
    Option(
        "--root", "tube.root_mm", _ROOT,
        "Least length from the clamp's edge to the first joint's centre, mm.", above=0.0,
    ),
    Option(
        "--clamp", "tube.clamp_mm", _MM,
        "Tube and gauze that are held behind the clamp's edge, mm (default: one diameter).",
        least=LEAST_MM, absent="one diameter",
    ),
    Option(
        "--pitch", "tube.pitch_mm", _MM, "Mesh pitch of the gauze, mm.", above=0.0, main=True
    ),
    Option(
        "--pressure", "tube.pressure_bar", _BAR,
        "The operating pressure, as of one regulator for several fingers, bar, in steps of 0.01 "
        "(default: what suits best, up to --max-pressure).",
        above=0.0, absent="what suits best",
    ),
    Option(
        "--max-pressure", "tube.max_pressure_bar", _BAR, "Highest pressure, bar.", above=0.0,
        main=True,
    ),
    Option("--max-length", "tube.max_length_mm", _MM, "Longest tube, mm.", above=0.0, main=True),
    Option(
        "--formula", "formula", _FILE,
        "A formula file, or by name paper or fe (default: fe, ours for the paper's tube, with "
        "--method optimal; paper with --method paper).",
        absent="the method's",
    ),
    Option(
        "--extrapolate", "extrapolate", _YES,
        "Let the formula be used some way beyond what it was fitted on, with a warning.",
    ),
    Option(
        "--method", "method", _choice("optimal", "paper"),
        "How joints are chosen: all at once, or one by one as the paper does.", main=True,
    ),
    Option(
        "--joints", "joints", _COUNT, "Number of joints (default: as few as reach --tolerance).",
        least=1, absent="as few as will do", main=True,
    ),
    Option(
        "--tolerance", "tolerance_mm", _MM,
        "How far the shape may lie off the profile, mm: RMS (default: joints are added "
        "down to 0.25 by the joint response, and 1 % of the length will do), or for --method "
        "paper the polygon of joints at most (default: 1).",
        above=0.0, absent="the method's", main=True,
    ),
    Option(
        "--interference", "interference_mm", _MM,
        "How deep the tube may lie in the object, mm (optimal).", least=0.0,
    ),
    Option(
        "--base-free", "base_free", _YES,
        "Let the base leave the profile's start tangent (optimal).",
    ),
    Option(
        "--alpha-step", "alpha_step_deg", _DEG,
        "Step of alpha, deg (default: one thread; 0: any; optimal).", least=0.0,
        absent="one thread",
    ),
    Option(
        "--place-step", "place_step_mm", _MM,
        "Step of the joints' places, mm (default: the gauze's pitch where that costs less than "
        "0.1 mm, else 1; 0: any; optimal).",
        least=0.0, absent="the gauze's pitch, or 1 mm",
    ),
    Option(
        "--objective", "objective", _choice("built", "nominal"),
        "Choose joints for the actuator that is built, or for perfect parts (optimal).", main=True,
    ),
    Option(
        "--build", "build", _BUILD,
        "Errors of the build, uniform within +-: bar, threads, % of the rubber's stiffness, "
        "% of the wall, mm of a cut, mm of a place; 0 leaves one out.",
        metavar="NAME=BOUND,...", main=True,
    ),
    Option(
        "--verify", "verify", _YES, "Run finite elements of the whole actuator: some seconds.",
        main=True, off=True,
    ),
    Option(
        "--refine", "refine", _YES,
        "Let finite elements correct the design (optimal; needs verify).", main=True,
        off=True,
    ),
    Option(
        "--no-grip", "grip", _YES,
        "Leave out the run against the object, and with it the pressure to work at there.",
        off=True,
    ),
    Option(
        "--grip", "grip_N", _number(" N"),
        "Normal force of one finger on its object, N: work at the pressure that gives it "
        "(default: at the pressure of the least expected misfit).", above=0.0, metavar="N",
    ),
    _OBJECT,
    Option(
        "--nu", "model.nu", _RATIO,
        "Poisson's ratio of the rubber (default: its own; the paper's 0.46).", least=0.0,
        absent="the rubber's own",
    ),
    Option(
        "--thread-factor", "model.thread_factor", _RATIO,
        "Stiffness of a thread over that of the paper's (default: 1).", above=0.0,
    ),
    Option(
        "--sector-extra", "model.sector_extra_deg", _DEG,
        "What the threads at its ends add to a sector, deg (default: 6).", least=0.0,
    ),
    Option(
        "--gravity", "model.gravity", ValueKind(str, str),
        "Where gravity pulls on the object as pictured (default: none).",
        metavar="none|down|up|level|DEG",
    ),
)  # fmt: skip
GRIP = (
    Option(
        "--pressure", "pressures_bar", _list(" bar"),
        "Pressures, bar (default: the design's own, and up to 1.2 times as much).",
        metavar="BAR,...",
    ),
    Option(
        "--friction", "friction", _list(""),
        "Coefficients of friction to tell the payload at (default: 0 to 1).", metavar="MU,...",
    ),
    Option("--fingers", "fingers", _COUNT, "Fingers around the object.", least=1),
    _OBJECT,
    Option(
        "--clearance", "clearance_mm", _MM, "Gap that the profile keeps from the object, mm.",
        least=0.0,
    ),
    Option(
        "--max-contact-kpa", "max_contact_kpa", _number(" kPa"),
        "Contact pressure that the object bears, kPa.", above=0.0,
    ),
    Option(
        "--against", "against", ValueKind(str, str),
        "Something else in place of the object, such as a load cell: plane:X,Y,DEG with its normal "
        "at DEG, cylinder:X,Y,R, sphere:X,Y,R; mm.", metavar="KIND:X,Y,NUMBER",
    ),
)  # fmt: skip
MODEL = tuple(row for row in DESIGN if row.path.startswith("model."))
# Fields of other records and commands that messages name.
_OTHERS = {
    "kerf_mm": "--kerf", "port": "--port", "out": "--out", "force": "--force",
    "alpha_center_deg": "--alpha-center", "base": "--from", "runs": "--runs",
    "scheduler": "--scheduler", "workers": "--workers", "alpha_deg": "--alpha",
    "openF_mm": "--openF", "theta_deg": "--theta", "tip_mm": "--tip", "at_bar": "--at",
    "angles": "--angles", "pressures": "--pressures",
    "lines": "--lines", "tube": "--tube", "joint": "--joint",
    "move_mm": "--move",
}  # fmt: skip
FLAGS: Mapping[str, str] = {**{row.field: row.flag for row in (*DESIGN, *GRIP)}, **_OTHERS}


def in_flags(text: str) -> str:
    """Name the fields of a message by the flags of the command line."""
    return re.sub(r"`(\w+)`", lambda found: FLAGS.get(found[1], found[0]), text)
