"""The plot of distances: its sign, its panels, and how plots become part of a page."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from profiletool.profile.offset import offset_points
from profiletool.records.design import Misfit
from profiletool.records.frames import Shape
from profiletool.report.error import error_figure, gap_along
from profiletool.report.figure import png, svg
from profiletool.report.palette import NAMES
from profiletool.report.scene import Scene, scene_of
from tests.report.dossiers import designed


@pytest.fixture(scope="module")
def scene(samples: Path) -> Scene:
    return scene_of(designed(samples / "egg.png"))


def off(scene: Scene, by_mm: float) -> Shape:
    """A tube that lies by so much off the object all along."""
    facing = offset_points(scene.profile, by_mm)
    return replace(scene.straight, along=scene.profile.s, facing=facing, axis=facing, far=facing)


def with_fe(scene: Scene, by_mm: float) -> Scene:
    fit = replace(scene.design.fit, fe=Misfit(abs(by_mm), abs(by_mm)))
    return replace(scene, design=replace(scene.design, fit=fit), fe=off(scene, by_mm))


@pytest.mark.parametrize("by_mm", [0.5, -0.5])
def test_positive_is_off_the_object_and_negative_in_it(scene: Scene, by_mm: float) -> None:
    s, gap = gap_along(off(scene, by_mm), scene.profile)
    assert s[-1] == pytest.approx(scene.profile.length_mm)
    inner = (s > 2.0) & (s < s[-1] - 2.0)
    assert np.allclose(gap[inner], by_mm, atol=0.01)
    figure = error_figure(with_fe(scene, by_mm), off(scene, by_mm))
    (axes,) = figure.axes
    drawn = [line for line in axes.lines if "finite elements" in str(line.get_label())]
    assert np.allclose(np.asarray(drawn[0].get_ydata())[inner], by_mm, atol=0.01)
    heights = {text.get_text(): text.get_position()[1] for text in axes.texts}
    assert heights["off the object"] > 0.5 > heights["pressed into it"]
    assert axes.get_xlabel().endswith("(mm)")
    assert axes.get_ylabel().endswith("(mm)")


def test_a_curve_that_would_flatten_the_others_gets_a_panel_of_its_own(scene: Scene) -> None:
    near, far = with_fe(scene, 0.2), off(scene, 9.0)
    close_up, whole = error_figure(near, far).axes
    assert close_up.get_ylim()[1] < 0.5
    assert whole.get_ylim()[1] > 9.0
    assert len(error_figure(near, off(scene, 0.3)).axes) == 1


def test_joints_are_numbered(scene: Scene) -> None:
    (axes,) = error_figure(scene, off(scene, 0.5)).axes
    numbers = [text.get_text() for text in axes.texts if text.get_text().isdigit()]
    assert numbers == [str(joint.number) for joint in scene.design.joints]


def test_a_name_is_no_mathematics(scene: Scene) -> None:
    assert png(error_figure(scene, off(scene, 0.5), r"$\nothing_$.png")).startswith(b"\x89PNG")


def test_a_plot_on_a_page_has_the_page_s_colours_and_font(scene: Scene) -> None:
    drawn = svg(error_figure(with_fe(scene, 0.2), off(scene, 9.0)))
    assert drawn == svg(error_figure(with_fe(scene, 0.2), off(scene, 9.0)))
    assert drawn.startswith("<svg")
    assert drawn.endswith("</svg>")
    assert "<style" not in drawn
    assert "<metadata" not in drawn
    assert "finite elements: 0.20 mm RMS" in drawn  # text is text
    assert "var(--purple)" in drawn
    left = set(re.findall(r"#[0-9a-f]{6}\b", drawn))
    assert not left & set(NAMES)
    assert left == set()
    head = drawn[: drawn.index(">")]
    assert "viewBox" in head
    assert " width=" not in head
