"""The files of a design: what the pipeline's result looks like on disk."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fem.export.vtu import write_pvd, write_vtu
from profiletool.errors import Unsure
from profiletool.files.design_json import to_json
from profiletool.pipeline import Result
from profiletool.profile.shape_csv import shape_csv
from profiletool.records.design import Design
from profiletool.records.fe import Verification
from profiletool.records.options import in_flags
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.report.candidates import draw_candidates
from profiletool.report.dossier import dossier_of, formula_marks
from profiletool.report.error import error_figure
from profiletool.report.fe import theta_csv
from profiletool.report.figure import mask_png, png
from profiletool.report.html import report_html
from profiletool.report.overlay import draw_overlay
from profiletool.report.plots import Mark, theta_figure, trajectories_figure
from profiletool.report.scene import Scene, scene_of
from profiletool.report.tradeoff import trade_off_csv, trade_off_figure
from profiletool.template.dxf import Version, write_dxf
from profiletool.template.kinds import PLAIN, Wish
from profiletool.template.layout import build_sheet
from profiletool.template.mounting import mounting_drawing
from profiletool.template.pdf import Paper, write_pdf
from profiletool.template.svg import write_svg
from profiletool.verify.run import Run


def files_of(
    result: Result,
    wish: Wish = PLAIN,
    paper: Paper = "a4",
) -> dict[str, bytes]:
    """Make every file of the output folder: name to content.

    Parameters
    ----------
    result : Result
    wish : Wish
        What the template shall be.
    paper : {"a4", "letter"}
        Of the PDFs.
    """
    result = _in_flags(result)
    design, checked = result.design, result.check
    lines = {"target": result.subject.profile.points, "formula": result.shape.facing}
    if result.plan.by != "formula":
        lines["response"] = result.plan.bent.facing
    if checked is not None and checked.shape is not None:
        lines["fe"] = checked.shape.facing
    scene = scene_of(result)
    files = {
        "design.json": to_json(design).encode(),
        **template_files(design, wish, paper),
        "shape.csv": shape_csv(lines),
        **mounting_files(result, scene, paper),
        "overlay.png": draw_overlay(scene),
        "error_along_arc.png": png(error_figure(scene, result.shape, design.source.file)),
    }
    if result.plan.trade_off is not None:
        files["trade_off.csv"] = trade_off_csv(result.plan.trade_off)
        files["trade_off.png"] = png(trade_off_figure(result.plan.trade_off, design))
    if result.subject.silhouette is not None:
        files["mask.png"] = mask_png(result.subject.silhouette.mask)
    if checked is not None and checked.run is not None:
        found = checked.run.verification
        files |= theta_files(found, design.source.file, formula_marks(design))
        if checked.shape is not None:
            files |= mesh_files(checked.run)
    files["report.html"] = report_html(dossier_of(result, scene, files["template.svg"].decode()))
    return files


def _in_flags(result: Result) -> Result:
    """Name fields by flags in all that is said: the files are those of the command."""
    design = result.design
    return replace(
        result,
        design=replace(design, warnings=tuple(in_flags(text) for text in design.warnings)),
        reasons=tuple(in_flags(text) for text in result.reasons),
        misses=tuple(replace(miss, reason=in_flags(miss.reason)) for miss in result.misses),
    )


def candidates_png(unsure: Unsure) -> bytes:
    """Draw what the object could be, for a user who is asked to say."""
    return draw_candidates(unsure.rgb, unsure.candidates)


def fe_files(
    run: Run, title: str, told: str, target: FloatArray | None = None, marks: Sequence[Mark] = ()
) -> dict[str, bytes]:
    """Make the files of a finite-element run: name to content.

    Parameters
    ----------
    run : Run
    title : str
        For the pictures.
    told : str
        The run as JSON, as it is printed.
    target : (N, 2) mm, optional
        Profile that the tube shall follow.
    marks : sequence of Mark
        Angles to compare with.
    """
    found = run.verification
    lines = {} if target is None else {"target": target}
    lines |= {"rest": found.rest.shape.facing, "fe": found.last.shape.facing}
    return {
        "fe.json": told.encode(),
        **theta_files(found, title, marks),
        "shape.csv": shape_csv(lines),
        **mesh_files(run),
    }


def mesh_files(run: Run) -> dict[str, bytes]:
    """Write the deformed mesh for ParaView: at the highest pressure, and as a series."""
    solution = run.solution
    names = [f"actuator_{k:02d}.vtu" for k in range(len(solution.states))]
    pressures_bar = [BAR_PER_MPA * state.pressure for state in solution.states]
    meshes = [write_vtu(solution.mesh, state.x) for state in solution.states]
    return {
        "actuator.vtu": meshes[-1],
        "actuator.pvd": write_pvd(list(zip(pressures_bar, names, strict=True))),
        **dict(zip(names, meshes, strict=True)),
    }


def theta_files(found: Verification, title: str, marks: Sequence[Mark] = ()) -> dict[str, bytes]:
    """Tabulate and draw angles against pressure."""
    return {
        "theta_vs_pressure.csv": theta_csv(found),
        "theta_vs_pressure.png": png(theta_figure(found, title, marks)),
    }


def trajectory_files(found: Verification, title: str) -> dict[str, bytes]:
    """Draw the ways of the phalanges."""
    return {"trajectories.png": png(trajectories_figure(found, title))}


def template_files(
    design: Design,
    wish: Wish = PLAIN,
    paper: Paper = "a4",
    version: Version = "R2000",
) -> dict[str, bytes]:
    """Draw a template of a design for cutters, plotters and printers."""
    sheet = build_sheet(design, wish)
    return {
        "template.dxf": write_dxf(sheet.drawing, version),
        "template.svg": write_svg(sheet.drawing).encode(),
        "template.pdf": write_pdf(sheet.drawing, paper, sheet.parts),
    }


def mounting_files(result: Result, scene: Scene, paper: Paper = "a4") -> dict[str, bytes]:
    """Draw how the tube is clamped beside its object, and the palm that is drilled for it."""
    bent = scene.bent if scene.fe is None else scene.fe
    drawing = mounting_drawing(result.design, result.subject.profile, scene.straight, bent)
    return {
        "mounting.dxf": write_dxf(drawing),
        "mounting.pdf": write_pdf(drawing, paper, drawing.parts),
    }
