"""The files of a design: what the pipeline's result looks like on disk."""

from __future__ import annotations

from profiletool.designfile import to_json
from profiletool.joints.kinematics import deform
from profiletool.pipeline import Result
from profiletool.records import Design
from profiletool.report.files import mask_png, shape_csv
from profiletool.report.overlay import Scene, backdrop_of, draw_overlay
from profiletool.template.dxf import write_dxf
from profiletool.template.layout import build_sheet
from profiletool.template.svg import write_svg


def files_of(result: Result) -> dict[str, bytes]:
    """Make every file of the output folder: name to content."""
    files = {
        "design.json": to_json(result.design).encode(),
        **template_files(result.design),
        "shape.csv": shape_csv(result.subject.profile, result.shape),
        "overlay.png": draw_overlay(scene_of(result)),
    }
    if result.subject.silhouette is not None:
        files["mask.png"] = mask_png(result.subject.silhouette.mask)
    return files


def template_files(design: Design) -> dict[str, bytes]:
    """Draw the cut template of a design."""
    sheet = build_sheet(design)
    return {"template.dxf": write_dxf(sheet), "template.svg": write_svg(sheet).encode()}


def scene_of(result: Result) -> Scene:
    """Gather what the overlay shows."""
    subject, layout, design = result.subject, result.layout, result.design
    backdrop = None
    if subject.picture is not None and subject.origin_px is not None:
        backdrop = backdrop_of(subject.picture, subject.scale.mm_per_px, subject.origin_px)
    radius = 0.5 * design.tube.outer_diameter_mm
    straight = deform((), layout.length_mm, radius, layout.pose, subject.profile.sign)
    return Scene(
        backdrop,
        subject.profile,
        result.sectors,
        design,
        layout.bends(),
        result.shape,
        straight,
    )
