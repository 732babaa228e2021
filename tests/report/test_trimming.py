"""Setting the pressure: one story in the report, the steps and the template."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from profiletool.records.built import TrimPoint
from profiletool.records.design import Design
from profiletool.report.dossier import Dossier
from profiletool.report.html import report_html
from profiletool.report.markup import MINUS, Markup, plain
from profiletool.report.trimming import trim_table, trimming
from profiletool.template.layout import build_sheet
from tests.report.dossiers import with_design
from tests.report.pages import Page


def with_trim(design: Design, highest: float = 1.1) -> Design:
    """As if the tip went along x by 50 mm a bar, and every angle grew by a degree a row."""
    bar = design.pressure_bar
    shares = [share for share in (0.85, 0.9, 0.95, 1.0, 1.05, 1.1) if share <= highest]
    rows = tuple(
        TrimPoint(
            round(share * bar, 4), (-20.0 + 50.0 * (share - 1.0) * bar, -90.0),
            tuple(joint.sense * (20.0 + k) for joint in design.joints),
        )
        for k, share in enumerate(shares)
    )  # fmt: skip
    return replace(design, trim=rows)


@pytest.fixture
def design(dossiers: dict[str, Dossier]) -> Design:
    return with_trim(dossiers["verified"].scene.design)


def cells(design: Design) -> list[list[str]]:
    """Text of the table's cells, row by row."""
    rows = re.findall(r"<tr>(.*?)</tr>", trim_table(design))[1:]
    return [
        [plain(Markup(cell)) for cell in re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row)]
        for row in rows
    ]


def test_the_table_marks_the_planned_row_and_says_what_to_set(design: Design) -> None:
    bar = design.pressure_bar
    rows = cells(design)
    assert len(rows) == 6
    assert [row[0] for row in rows].index(f"{bar:.2f} planned") == 3
    assert rows[3][1:4] == [f"{MINUS}20.0", f"{MINUS}90.0", "0.0"]
    assert rows[3][-1] == f"{bar:.2f}"
    assert rows[4][-1] == f"{bar / 1.05:.2f}"
    assert rows[2][-1] == f"{bar / 0.95:.2f}"
    assert rows[0][-1] == "–"  # 1.18 of the planned pressure was not checked
    assert rows[5][3] == f"{5.0 * bar:.1f}"
    assert len(rows[0]) == 5 + len(design.joints)
    assert trim_table(design).count("<strong>") == len(rows[0])


def test_how_to_do_it(design: Design) -> None:
    bar = design.pressure_bar
    said = plain(trimming(design, 9.0))
    assert f"Inflate 5 times to {1.1 * bar:.2f} bar" in said
    assert "1.1 times the planned pressure" in said
    assert "wait for a minute" in said
    assert f"profiletool trim design.json --tip -20.0,-90.0 --at {bar:.2f}" in said
    assert "no stable state" not in said
    assert "asked for" not in said
    assert "above the 2.00 bar asked for" in plain(trimming(design, 2.0))
    low = plain(trimming(with_trim(design, 1.05), 9.0))
    assert f"Inflate 5 times to {1.05 * bar:.2f} bar" in low
    assert "1.1 times" not in low
    none = plain(trimming(with_trim(design, 1.0), 9.0))
    assert f"found no stable state above {bar:.2f} bar" in none


def test_one_story_on_the_page(dossiers: dict[str, Dossier], design: Design) -> None:
    page = Page(report_html(with_design(dossiers["verified"], design)))
    bar, top = design.pressure_bar, design.trim[-1].pressure_bar
    assert f"Never more than {top:.2f} bar." in page.text
    assert f"Go up to {bar:.2f} bar in 10 even steps" in page.text
    assert "Setting the pressure" in page.text
    assert f"Never more than {bar:.2f} bar." not in page.text
    assert "Setting the pressure" not in Page(report_html(dossiers["verified"])).text


def test_the_templates_note(design: Design) -> None:
    def noted(design: Design) -> str:
        drawing = build_sheet(design).drawing
        return " ".join(text.text for text in drawing.texts if text.layer == "NOTE")

    bar, top = design.pressure_bar, design.trim[-1].pressure_bar
    said = noted(design)
    assert f"inflate 5 times to {top:.2f} bar, never more. Hold {bar:.2f} bar" in said
    assert "planned: x -20.0, y -90.0 mm" in said
    assert "on object" not in said
    # Above what was checked free, the finger works on its object alone.
    held = noted(replace(design, operate_bar=top + 0.02))
    assert f"to {top:.2f} bar, never more in free air. Hold {bar:.2f} bar" in held
    assert f"Pressure {bar:.2f}, on object {top + 0.02:.2f} bar." in held
    assert "never more. Hold" in noted(replace(design, operate_bar=top))
    assert "Before use" not in noted(replace(design, trim=()))
