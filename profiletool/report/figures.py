"""The figures of a result, as matplotlib draws them."""

from __future__ import annotations

from matplotlib.figure import Figure

from profiletool.pipeline import Result
from profiletool.report.dossier import formula_marks
from profiletool.report.error import error_figure
from profiletool.report.overlay import overlay_figure
from profiletool.report.plots import theta_figure
from profiletool.report.scene import scene_of
from profiletool.report.tradeoff import trade_off_figure


def figures_of(result: Result) -> dict[str, Figure]:
    """Draw a result, for a notebook or a figure of one's own.

    Parameters
    ----------
    result : Result

    Returns
    -------
    dict of str to matplotlib.figure.Figure
        "overlay" and "error_along_arc"; "trade_off" where the joints were chosen all at once;
        "theta_vs_pressure" where finite elements ran.
    """
    scene, design, trade_off = scene_of(result), result.design, result.plan.trade_off
    figures = {
        "overlay": overlay_figure(scene),
        "error_along_arc": error_figure(scene, result.shape, design.source.file),
    }
    if trade_off is not None:
        figures["trade_off"] = trade_off_figure(trade_off, design)
    run = None if result.check is None else result.check.run
    if run is not None:
        marks = formula_marks(design)
        figures["theta_vs_pressure"] = theta_figure(run.verification, design.source.file, marks)
    return figures
