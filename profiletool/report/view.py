"""Views of designs: all that a page draws and tells, as JSON; mm of the object frame, y down."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

from profiletool.pipeline import Result
from profiletool.records.design import Design
from profiletool.records.profile import Profile
from profiletool.report.film import Film, drawn, film_of, path, ring_path, still_of
from profiletool.report.scene import clamp_ring, scene_of
from profiletool.report.stage import frame_of
from profiletool.verdict.summary import built_text

View = dict[str, Any]


def design_view(result: Result) -> View:
    """Show a design: the tube at all pressures, its joints, and what to know."""
    scene, design, check = scene_of(result), result.design, result.check
    run = None if check is None else check.run
    if run is None:
        film = still_of(scene.bent, design)
    else:
        film = film_of(run.verification, design, result.grip)
    frame, fit = frame_of(scene, film), design.fit
    band = None if scene.band is None else ring_path(*map(drawn, scene.band))
    off = fit.fe or fit.response or fit.formula
    return {
        "name": design.source.file,
        "bar": design.pressure_bar,
        "box": [frame.x0, -frame.y1, frame.x1 - frame.x0, frame.y1 - frame.y0],
        "by": "fe" if run is not None else scene.by,
        "film": json.loads(film.as_json()),
        "bent": ring_path(drawn(scene.bent.facing), drawn(scene.bent.far)),
        "rest": ring_path(drawn(scene.straight.facing), drawn(scene.straight.far)),
        "band": band,
        "clamp": path(drawn(clamp_ring(scene))) + "Z",
        "profile": path(drawn(scene.profile.points)),
        "missed": _missed(scene.profile, scene.missed),
        "off": {"rms": off.rms_mm, "max": off.max_mm},
        "built": None if design.built is None else built_text(design.built),
        "feasible": design.feasible,
        "verified": design.verified,
        "notes": list(design.warnings),
        **joints_view(design),
    }


def joints_view(design: Design) -> View:
    """Show the joints in numbers."""
    thread = math.degrees(design.thread_rad)
    return {
        "pitch": design.gauze.pitch_mm,
        "thread": thread,
        "tube": {"diameter": design.tube.outer_diameter_mm, "length": design.tube.length_mm},
        "joints": [
            {
                "number": joint.number,
                "centre": joint.centre_mm,
                "openF": joint.openF_mm,
                "alpha": joint.alpha_closed_deg,
                "center": joint.alpha_center_deg,
                "target": joint.signed(joint.theta_target_deg),
                "response": _signed(joint.theta_response_deg, joint.away),
                "fe": _signed(joint.theta_fe_deg, joint.away),
                "stretch": joint.stretch_fe,
            }
            for joint in design.joints
        ],
    }


def film_view(film: Film) -> View:
    """Show the only state of a film."""
    return {"lines": film.lines[film.shown].reshape(-1).tolist(), "windows": film.windows.tolist()}


def _signed(theta_deg: float | None, away: bool) -> float | None:
    return None if theta_deg is None else (-theta_deg if away else theta_deg)


def _missed(profile: Profile, stretches: Sequence[tuple[float, float]]) -> list[str]:
    within = ((profile.s >= start) & (profile.s <= end) for start, end in stretches)
    return [path(drawn(profile.points[mask])) for mask in within if mask.sum() > 1]
