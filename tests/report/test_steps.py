"""The steps of making it."""

from __future__ import annotations

from dataclasses import replace

from profiletool.report.dossier import Dossier
from profiletool.report.markup import joined
from profiletool.report.steps import steps


def test_slits_and_the_weld_line(dossiers: dict[str, Dossier]) -> None:
    drawn = dossiers["drawn"].scene.design
    gauze = drawn.gauze
    for seam, words in (
        (270.0, "on the side that faces the object (270°"),
        (90.0, "on the side away from the object (90°"),
        (300.0, "30° counter-clockwise from the side that faces the object (300°"),
        (250.0, "20° clockwise from the side that faces the object (250°"),
    ):
        design = replace(drawn, gauze=replace(gauze, seam_deg=seam, turns=3))
        said = joined(step.body for step in steps(design, None))
        assert words in said
        assert "roll it 3 times" in said
    assert "The weld line crosses the cuts of joint" in said
    toward = replace(
        design,
        joints=tuple(replace(joint, alpha_center_deg=270.0) for joint in design.joints),
        gauze=replace(gauze, seam_deg=270.0),
    )
    said = joined(step.body for step in steps(toward, None))
    assert "The weld line crosses no cut" in said
