"""The report's part on the neighbours of a design, and the rule that chose among them."""

from __future__ import annotations

from profiletool.joints.optimal.choose import TOLERANCE_MM
from profiletool.records.built import mm_text
from profiletool.records.design import Design
from profiletool.records.request import Request
from profiletool.report.markup import Markup, joined, table, tag

_RULE = (
    "Joints are added one by one until the shape lies within the tolerance ({tolerance:g} mm RMS) "
    "by the model that they are chosen by; where no number does, each further joint must bring a "
    "tenth of it. At equal numbers the misfit decides, and to a lesser part what errors of the "
    "build cost."
)


def neighbours(design: Design, request: Request) -> Markup:
    """Tabulate what choices near the chosen one give, and say by which rule that one was chosen."""
    rule = _RULE.format(tolerance=request.tolerance_mm or TOLERANCE_MM)
    if request.joints is not None:
        rule = "The number of joints is the one asked for."
    if request.tube.pressure_bar is not None:
        rule += " The pressure is given."
    rows = [
        (
            one.what,
            f"{one.joints}",
            f"{one.pressure_bar:.2f}",
            f"{one.rms_mm:.2f}",
            mm_text(one.expected_rms_mm),
            one.by,
        )
        for one in design.neighbours
    ]
    heads = ("Choice", "joints", "bar", "nominal (mm RMS)", "expected (mm RMS)", "by")
    said = (
        "Nominal is with perfect parts, expected of the built actuator once the pressure is set "
        "on it. By joint response: as chosen, before numbers are rounded to what can be built; "
        "by FE: corrected and rounded."
    )
    return joined(
        (tag("p", rule), table(heads, rows, "Choices near the chosen one", "words"),
         tag("p", said, class_="small"))
    )  # fmt: skip
