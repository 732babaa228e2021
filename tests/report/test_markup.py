"""Markup: escapes, numbers, drawings taken over."""

from __future__ import annotations

from profiletool.report.markup import MINUS, Markup, adopted, signed, tag


def test_markup_escapes_all_that_is_not_markup() -> None:
    assert tag("p", "<b>&", Markup("<i>x</i>"), class_='a"b') == (
        '<p class="a&quot;b">&lt;b&gt;&amp;<i>x</i></p>'
    )
    assert tag("input", hidden=True, disabled=False, data_x="1") == '<input hidden data-x="1"/>'
    assert tag("p", "a\u202eb\x00c\ud800d\ne") == "<p>abcd\ne</p>"


def test_minus_signs() -> None:
    assert signed(-1.25, 2, "°") == f"{MINUS}1.25°"
    assert signed(-0.04) == "0.0"
    assert signed(10.0) == "10.0"


def test_an_adopted_drawing_keeps_to_itself() -> None:
    drawing = (
        '<?xml version="1.0"?>\n<!DOCTYPE svg>\n<svg id="a"><use xlink:href="#b"/>'
        '<g id="b" clip-path="url(#c)"/></svg>\n'
    )
    assert adopted(drawing, "x-") == (
        '<svg id="x-a"><use xlink:href="#x-b"/><g id="x-b" clip-path="url(#x-c)"/></svg>'
    )
