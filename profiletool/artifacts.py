"""The files of a design: what the pipeline's result looks like on disk."""

from __future__ import annotations

from collections.abc import Sequence

from profiletool.designfile import to_json
from profiletool.joints.kinematics import deform
from profiletool.pipeline import Result
from profiletool.records import Design, FloatArray, Verification
from profiletool.report.fe import theta_csv
from profiletool.report.files import mask_png, shape_csv
from profiletool.report.overlay import Scene, backdrop_of, draw_overlay
from profiletool.report.plots import Mark, draw_theta, draw_trajectories
from profiletool.report.tradeoff import draw_trade_off, trade_off_csv
from profiletool.report.vtu import write_pvd, write_vtu
from profiletool.template.dxf import write_dxf
from profiletool.template.layout import build_sheet
from profiletool.template.svg import write_svg
from profiletool.verify import Run


def files_of(result: Result) -> dict[str, bytes]:
    """Make every file of the output folder: name to content."""
    design, checked = result.design, result.check
    lines = {"target": result.subject.profile.points, "formula": result.shape.facing}
    if result.plan.by != "formula":
        lines["response"] = result.plan.bent.facing
    if checked is not None and checked.shape is not None:
        lines["fe"] = checked.shape.facing
    files = {
        "design.json": to_json(design).encode(),
        **template_files(design),
        "shape.csv": shape_csv(lines),
        "overlay.png": draw_overlay(scene_of(result)),
    }
    if result.plan.trade_off is not None:
        files["trade_off.csv"] = trade_off_csv(result.plan.trade_off)
        files["trade_off.png"] = draw_trade_off(result.plan.trade_off, design)
    if result.subject.silhouette is not None:
        files["mask.png"] = mask_png(result.subject.silhouette.mask)
    if checked is not None and checked.run is not None:
        found = checked.run.verification
        files |= theta_files(found, design.source.file, formula_marks(design))
        if checked.shape is not None:
            solution = checked.run.solution
            files["actuator.vtu"] = write_vtu(solution.mesh, solution.states[-1].x)
    return files


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
    found, solution = run.verification, run.solution
    lines = {} if target is None else {"target": target}
    lines |= {"rest": found.rest.shape.facing, "fe": found.last.shape.facing}
    series = [(10.0 * s.pressure, f"actuator_{k:02d}.vtu") for k, s in enumerate(solution.states)]
    return {
        "fe.json": told.encode(),
        **theta_files(found, title, marks),
        "shape.csv": shape_csv(lines),
        "actuator.vtu": write_vtu(solution.mesh, solution.states[-1].x),
        "actuator.pvd": write_pvd(series),
        **{
            name: write_vtu(solution.mesh, state.x)
            for (_, name), state in zip(series, solution.states, strict=True)
        },
    }


def theta_files(found: Verification, title: str, marks: Sequence[Mark] = ()) -> dict[str, bytes]:
    """Tabulate and draw angles against pressure."""
    return {
        "theta_vs_pressure.csv": theta_csv(found),
        "theta_vs_pressure.png": draw_theta(found, title, marks),
    }


def trajectory_files(found: Verification, title: str) -> dict[str, bytes]:
    """Draw the ways of the phalanges."""
    return {"trajectories.png": draw_trajectories(found, title)}


def formula_marks(design: Design) -> tuple[Mark, ...]:
    """Give the formula's angles to compare with."""
    angles = [joint.sense * joint.theta_formula_deg for joint in design.joints]
    label = f"formula, {design.pressure_bar:.2f} bar"
    return (Mark(label, design.pressure_bar, angles),)


def template_files(design: Design) -> dict[str, bytes]:
    """Draw the cut template of a design."""
    drawing = build_sheet(design).drawing
    return {"template.dxf": write_dxf(drawing), "template.svg": write_svg(drawing).encode()}


def scene_of(result: Result) -> Scene:
    """Gather what the overlay shows."""
    subject, plan, design = result.subject, result.plan, result.design
    layout = plan.layout
    backdrop = None
    if subject.picture is not None and subject.origin_px is not None:
        backdrop = backdrop_of(subject.picture, subject.scale.mm_per_px, subject.origin_px)
    radius = 0.5 * design.tube.outer_diameter_mm
    straight = deform((), layout.length_mm, radius, layout.pose, subject.profile.sign)
    return Scene(
        backdrop,
        subject.profile,
        plan.places,
        design,
        layout.bends(),
        plan.by,
        plan.bent,
        straight,
        result.check.shape if result.check is not None else None,
        tuple((place.start, place.end) for place in result.misses),
    )
