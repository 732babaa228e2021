"""Drawings as SVG."""

import numpy as np
import pytest
import shapely

from profiletool.errors import NoObject, UnreadableInput
from tests.profile.drawing.drawings import PX, assert_circle, assert_same_ring, svg


@pytest.mark.parametrize(
    "body",
    [
        '<rect x="10" y="20" width="20" height="10"/>',
        '<polygon points="10,20 30,20 30,30 10,30"/>',
        '<polyline points="10 20 30 20 30 30 10 30 10 20"/>',
        '<path d="M10 20h20v10h-20z"/>',
        '<path d="m10,20 20,0 0,10 -20,0 0-10"/>',
        '<line x1="10" y1="20" x2="30" y2="20"/><path d="M30 30V20M10 30H30M10 20V30"/>',
        '<g transform="translate(10 20)"><rect width="10" height="5" transform="scale(2)"/></g>',
        '<rect x="20" y="-30" width="10" height="20" transform="rotate(90)"/>',
        '<rect x="10" y="20" width="20" height="10" transform="matrix(1 0 0 1 0 0)"/>',
        '<defs><rect id="r" width="20" height="10"/></defs><use href="#r" x="10" y="20"/>',
        '<rect width="100" height="100" fill="white"/><path d="M10 20h20v10h-20z"/>',
        '<style>.no{display:none}</style><circle class="no" r="90"/><path d="M10 20h20v10h-20z"/>',
        '<path d="M10 20h20v10h-20z"/><g style="display:none"><circle r="90"/></g>',
        '<path d="M10 20h20v10h-20z"/><circle r="90" visibility="hidden"/>',
        '<path d="M10 20h20v10h-20z"/><text x="3" y="4">90 mm</text>',
        '<path d="M10 20h20v10h-20z"/><marker><circle r="90"/></marker>',
        '<clipPath id="c"><circle r="90"/></clipPath><path d="M10 20h20v10h-20z"/>',
    ],
)
def test_svg_same_square(load, body):
    found = load("a.svg", svg(body))
    assert_same_ring(found, [(10, -20), (30, -20), (30, -30), (10, -30)], atol=1e-6)


@pytest.mark.parametrize(
    ("head", "unit"),
    [
        ("", PX),
        ('width="200" height="100"', PX),
        ('width="200px" height="100px" viewBox="0 0 200 100"', PX),
        ('viewBox="0 0 200 100"', PX),
        ('width="100%" height="100%" viewBox="0 0 200 100"', PX),
        ('width="200mm" height="100mm" viewBox="0 0 200 100"', 1),
        ('width="200mm" viewBox="0 0 200 100"', 1),
        ('height="100mm" width="auto" viewBox="0 0 200 100"', 1),
        ('width="20cm" height="10cm" viewBox="0 0 100 50"', 2),
        ('width="2in" height="1in" viewBox="0 0 2000 1000"', 0.0254),
        ('width="72pt" height="72pt" viewBox="0 0 1 1"', 25.4),
    ],
)
def test_svg_units(load, head, unit):
    found = load("a.svg", svg('<path d="M0 0 40 0 40 10 0 30z"/>', head))
    expected = np.array([(0, 0), (40, 0), (40, -10), (0, -30)]) * unit
    assert_same_ring(found, expected, atol=1e-6)


def test_svg_view_box_offset_and_lengths_with_units(load):
    body = '<rect x="1cm" y="0" width="2cm" height="1cm"/>'
    found = load(
        "a.svg", svg(body, 'width="50mm" height="50mm" viewBox="0 0 188.976378 188.976378"')
    )
    assert_same_ring(found, [(10, 0), (30, 0), (30, -10), (10, -10)], atol=1e-4)


@pytest.mark.parametrize(
    "body",
    [
        '<circle cx="50" cy="40" r="30"/>',
        '<ellipse cx="50" cy="40" rx="30" ry="30"/>',
        '<path d="M20 40a30 30 0 0 1 60 0 30 30 0 0 1-60 0z"/>',
        '<ellipse cx="25" cy="40" rx="15" ry="30" transform="scale(2 1)"/>',
        '<circle cx="0" cy="0" r="15" transform="translate(50 40) rotate(30) scale(2)"/>',
        '<path d="M20 40a30 30 0 0 1 60 0M20 40A30 30 0 0 0 80 40"/>',
    ],
)
def test_svg_circle(load, body):
    assert_circle(load("a.svg", svg(body)), (50, -40), 30)


def test_svg_circle_under_a_skew(load):
    found = load("a.svg", svg('<circle cx="50" cy="40" r="10" transform="skewX(45)"/>'))
    x, y = found.points[:, 0], -found.points[:, 1]
    np.testing.assert_allclose(np.hypot(x - y - 50, y - 40), 10, atol=1e-6)


def test_svg_curves(load):
    cubic = load("a.svg", svg('<path d="M0 0C0 40 30 40 30 0"/>'))
    assert not cubic.closed
    assert shapely.LineString(cubic.points).distance(shapely.Point(15, -30)) < 0.01
    smooth = load("a.svg", svg('<path d="M0 0Q10 20 20 0T40 0"/>'))
    line = shapely.LineString(smooth.points)
    for middle in [(10, -10), (30, 10)]:
        assert line.distance(shapely.Point(middle)) < 0.01
    assert 20 < len(smooth.points) < 200


BOMB = "".join(f'<g id="a{i}">' + f'<use href="#a{i - 1}"/>' * 10 + "</g>" for i in range(1, 9))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('<!DOCTYPE svg [<!ENTITY a "b">]>' + svg("&a;"), "DOCTYPE"),
        ('<!DOCTYPE svg SYSTEM "a.dtd" [<!ENTITY a SYSTEM "b">]>' + svg("<g/>"), "DOCTYPE"),
        (svg('<path d="M0 0h9v9z"/>').encode("utf-16-le"), "well-formed"),
        ('<?xml version="1.0" encoding="cp037"?>'.encode("cp037"), "well-formed"),
        (svg("<path>"), "well-formed"),
        ("plain words", "well-formed"),
        ("<html><body/></html>", "<html>"),
        ('<svg xmlns="http://example.org/other"><path d="M0 0h9v9z"/></svg>', "no <svg>"),
        (svg('<path d="M0 0 L 9 nine 9 0"/>'), "bad 'd'"),
        (svg('<polygon points="0,0 nan,3 4,4"/>'), "bad 'points'"),
        (svg('<circle r="ten"/>'), "length 'ten'"),
        (svg('<circle r="nan"/>'), "length 'nan'"),
        (svg('<circle r="1e9"/>'), "beyond"),
        (svg('<path d="M0 0C1e300 0 9 9 0 5z"/>'), "beyond"),
        (svg('<path d="M0 0L1e999 0 9 9z"/>'), "beyond"),
        (svg('<g id="a"><use href="#a"/></g>'), "circle"),
        (svg(f'<g id="a0"><circle r="1"/></g>{BOMB}'), "<use> makes"),
        (svg("<g>" * 300 + "</g>" * 300), "nested"),
        (svg('<line x1="0" y1="0" x2="9" y2="0"/>'), "only 2 distinct"),
        (svg('<rect width="9" height="9" transform="rotate(x)"/>'), ""),
    ],
)
def test_svg_refused(load, text, words):
    with pytest.raises(UnreadableInput, match=r"a\.svg: ") as failure:
        load("a.svg", text)
    assert words in str(failure.value)
    assert str(failure.value).isprintable()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (svg(""), "nothing drawable"),
        (svg("<text>words</text>"), "nothing drawable"),
        (svg('<image href="file:///etc/passwd" width="9" height="9"/>'), "nothing drawable"),
        (svg('<use href="other.svg#part"/>'), "nothing drawable"),
        (svg('<circle r="9"/>', 'width="0" height="9" viewBox="0 0 9 9"'), "width"),
        (svg('<circle r="9"/><circle cx="40" r="9"/>'), "several"),
        (svg('<path d="M0 0L9 9 9 0 0 9z"/>'), "crosses"),
        (svg('<path d="M0 0h9v9h-9z"/><path d="M0 0L-9-9"/>'), "several"),
    ],
)
def test_svg_without_a_profile(load, text, words):
    with pytest.raises(NoObject) as failure:
        load("a.svg", text)
    assert words in str(failure.value)


def test_svg_too_much(load, monkeypatch):
    monkeypatch.setattr("profiletool.profile.drawing.svg_tree.MAX_NUMBERS", 5)
    with pytest.raises(UnreadableInput, match="more than 5 numbers"):
        load("a.svg", svg('<path d="M0 0 9 0 9 9z"/>'))
    monkeypatch.setattr("profiletool.profile.drawing.svg_tree.MAX_ELEMENTS", 5)
    with pytest.raises(UnreadableInput, match="more than 5 elements"):
        load("a.svg", svg("<g/>" * 10))
