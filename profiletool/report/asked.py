"""The options of a design as its report lists them."""

from __future__ import annotations

from profiletool.records.options import DESIGN
from profiletool.records.request import Request
from profiletool.report.tables import AskedOption


def options_of(request: Request) -> tuple[AskedOption, ...]:
    """Options that differ from their defaults, and the main ones that do not.

    Files are listed by their names, without their folders.
    """
    usual = Request(request.file)
    shown = ((row, AskedOption(row.flag, row.shown(request), row.shown(usual))) for row in DESIGN)
    return tuple(option for row, option in shown if option.changed or row.main)
