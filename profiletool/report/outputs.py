"""Files of results, by registries such as `DESIGN_FILES`, `FE_FILES`, `TEMPLATE_FILES`.

A row gives a file's name and the function that writes it: one function and one row add a file.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from profiletool.files.angles_csv import write_angles
from profiletool.files.design_json import to_json
from profiletool.pipeline import Result
from profiletool.profile.shape_csv import shape_csv
from profiletool.records.design import Design
from profiletool.records.options import in_flags
from profiletool.records.seal import proven, sealed
from profiletool.records.units import FloatArray
from profiletool.report.bench import BenchOutput
from profiletool.report.bench_page import BENCH_FILES
from profiletool.report.deck import DECK_FILES, DeckOutput
from profiletool.report.dossier import dossier_of, formula_marks
from profiletool.report.error import error_figure
from profiletool.report.fe_files import FE_FILES, MESH_FILES, THETA_FILES, FeOutput
from profiletool.report.figure import mask_png, png
from profiletool.report.grip import GRIP_FILES, GripOutput
from profiletool.report.html import report_html
from profiletool.report.overlay import draw_overlay
from profiletool.report.plots import Mark
from profiletool.report.registry import Writers, rows_of, written
from profiletool.report.scene import Scene, scene_of
from profiletool.report.tradeoff import trade_off_csv, trade_off_figure
from profiletool.template.dxf import Version, write_dxf
from profiletool.template.kinds import PLAIN, Wish
from profiletool.template.layout import Sheet, build_sheet
from profiletool.template.mounting import Mounting, mounting_drawing
from profiletool.template.pdf import Paper, write_pdf
from profiletool.template.svg import write_svg
from profiletool.verify.run import Run


@dataclass(frozen=True)
class TemplateOutput:
    """All that the files of a template are written from.

    Attributes
    ----------
    design : Design
    wish : Wish
        What the template shall be.
    paper : {"a4", "letter"}
        Of the PDF.
    version : {"R2000", "R12"}
        Of the DXF.
    """

    design: Design
    wish: Wish = PLAIN
    paper: Paper = "a4"
    version: Version = "R2000"

    @cached_property
    def sheet(self) -> Sheet:
        """The sheet that all formats show."""
        return build_sheet(self.design, self.wish)

    @cached_property
    def svg(self) -> str:
        """The sheet as SVG."""
        return write_svg(self.sheet.drawing)


@dataclass(frozen=True)
class DesignOutput:
    """All that the files of a design are written from.

    Attributes
    ----------
    result : Result
    wish : Wish
        What the template shall be.
    paper : {"a4", "letter"}
        Of the PDFs.
    """

    result: Result
    wish: Wish = PLAIN
    paper: Paper = "a4"

    @cached_property
    def scene(self) -> Scene:
        """What the overlay and the report draw."""
        return scene_of(self.result)

    @cached_property
    def template(self) -> TemplateOutput:
        """The cut template."""
        return TemplateOutput(self.result.design, self.wish, self.paper)

    @cached_property
    def mounting(self) -> Mounting:
        """The tube clamped beside its object, and the palm that is drilled for it."""
        result, asked = self.result, self.result.request
        stretch = asked.start_pct, asked.end_pct
        return mounting_drawing(
            result.design, result.profile, self.scene.straight, result.best_shape, stretch
        )

    @cached_property
    def fe(self) -> FeOutput | None:
        """The finite-element run; None where there is not even a part of it."""
        check, design = self.result.check, self.result.design
        if check is None or check.run is None:
            return None
        return FeOutput(check.run, design.source.file, formula_marks(design))

    @cached_property
    def verified(self) -> FeOutput | None:
        """The finite-element run; None where it did not get to the operating pressure."""
        check = self.result.check
        return None if check is None or check.shape is None else self.fe


def _template_pdf(output: TemplateOutput) -> bytes:
    sheet = output.sheet
    return write_pdf(sheet.drawing, output.paper, sheet.parts)


def _design_shapes(output: DesignOutput) -> bytes:
    result = output.result
    profile = result.subject.profile
    lines = {"target": profile.points, "formula": result.shape.facing}
    if result.plan.by != "formula":
        lines["response"] = result.plan.bent.facing
    if result.check is not None and result.check.shape is not None:
        lines["fe"] = result.check.shape.facing
    if profile.outline is not None:
        lines["outline"] = profile.outline
    return shape_csv(lines)


def _mounting_pdf(output: DesignOutput) -> bytes:
    return write_pdf(output.mounting, output.paper, output.mounting.parts)


def _error_png(output: DesignOutput) -> bytes:
    result = output.result
    return png(error_figure(output.scene, result.shape, result.design.source.file))


def _trade_off_csv(output: DesignOutput) -> bytes | None:
    trade_off = output.result.plan.trade_off
    return None if trade_off is None else trade_off_csv(trade_off)


def _trade_off_png(output: DesignOutput) -> bytes | None:
    trade_off = output.result.plan.trade_off
    return None if trade_off is None else png(trade_off_figure(trade_off, output.result.design))


def _mask(output: DesignOutput) -> bytes | None:
    silhouette = output.result.subject.silhouette
    return None if silhouette is None else mask_png(silhouette.mask)


def _report(output: DesignOutput) -> bytes:
    return report_html(dossier_of(output.result, output.scene, output.template.svg))


TEMPLATE_FILES: Writers[TemplateOutput] = {
    "template.dxf": lambda output: write_dxf(output.sheet.drawing, output.version),
    "template.svg": lambda output: output.svg.encode(),
    "template.pdf": _template_pdf,
}
DESIGN_FILES: Writers[DesignOutput] = {
    "design.json": lambda output: to_json(output.result.design).encode(),
    **rows_of(lambda output: output.template, TEMPLATE_FILES),
    "shape.csv": _design_shapes,
    "mounting.dxf": lambda output: write_dxf(output.mounting),
    "mounting.pdf": _mounting_pdf,
    "overlay.png": lambda output: draw_overlay(output.scene),
    "error_along_arc.png": _error_png,
    "trade_off.csv": _trade_off_csv,
    "trade_off.png": _trade_off_png,
    "mask.png": _mask,
    **rows_of(lambda output: output.fe, THETA_FILES),
    **rows_of(lambda output: output.verified, MESH_FILES),
    "report.html": _report,
}


def files_of(result: Result, wish: Wish = PLAIN, paper: Paper = "a4") -> dict[str, bytes]:
    """Make every file of the output folder.

    Parameters
    ----------
    result : Result
    wish : Wish
        What the template shall be.
    paper : {"a4", "letter"}
        Of the PDFs.

    Returns
    -------
    dict of str to bytes
        Name to content.
    """
    return written(DESIGN_FILES, DesignOutput(_in_flags(result), wish, paper))


def fe_files(
    run: Run,
    title: str,
    told: str,
    target: FloatArray | None = None,
    marks: Sequence[Mark] = (),
    *,
    trajectories: bool = False,
) -> dict[str, bytes]:
    """Make the files of a finite-element run: name to content; see `FeOutput`."""
    return written(FE_FILES, FeOutput(run, title, marks, told, target, trajectories))


def template_files(
    design: Design, wish: Wish = PLAIN, paper: Paper = "a4", version: Version = "R2000"
) -> dict[str, bytes]:
    """Draw a template of a design for cutters, plotters and printers: name to content."""
    return written(TEMPLATE_FILES, TemplateOutput(design, wish, paper, version))


def deck_files(output: DeckOutput) -> dict[str, bytes]:
    """Write a design's model for another code: name to content."""
    ending = output.format.ending
    rows = {name.format(ending=ending): write for name, write in DECK_FILES.items()}
    return {**written(rows, output), "design.json": to_json(output.design).encode()}


def grip_files(output: GripOutput) -> dict[str, bytes]:
    """Make the files of a finger on its object: name to content."""
    return written(GRIP_FILES, output)


def bench_files(output: BenchOutput) -> dict[str, bytes]:
    """Write a measurement: name to content."""
    return {"angles.csv": write_angles(output.seen), **written(BENCH_FILES, output)}


def _in_flags(result: Result) -> Result:
    """Name fields by flags in all that is said: the files are those of the command."""
    design = result.design
    said = replace(design, warnings=tuple(in_flags(text) for text in design.warnings))
    return replace(
        result,
        design=sealed(said) if proven(design) else said,
        reasons=tuple(in_flags(text) for text in result.reasons),
        misses=tuple(replace(miss, reason=in_flags(miss.reason)) for miss in result.misses),
    )
