"""The overlay against golden pictures, compared as pictures."""

from __future__ import annotations

import io
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from profiletool.bending.kinematics import deform
from profiletool.joints.misfit import misfit
from profiletool.pipeline import Request, run
from profiletool.records.picture import Picture
from profiletool.records.seal import sealed
from profiletool.report.overlay import draw_overlay
from profiletool.report.scene import Scene, backdrop_of, scene_of

GOLDEN = Path(__file__).parents[1] / "golden"
WIDTH_PX = 700
BLOCK_PX = 7


def scene_from(file: Path) -> Scene:
    return scene_of(run(Request(file, method="paper", verify=False), lambda line: None))


def reduced(png: bytes | Path) -> Image.Image:
    source = png if isinstance(png, Path) else io.BytesIO(png)
    with Image.open(source) as image:
        height = round(image.height * WIDTH_PX / image.width)
        return image.convert("RGB").resize((WIDTH_PX, height), Image.Resampling.BOX)


def worst_block(a: Image.Image, b: Image.Image) -> float:
    """Largest difference between the mean greys of blocks: small shifts of thin lines show."""
    if a.size != b.size:
        return 255.0
    off = np.abs(np.asarray(a, float) - np.asarray(b, float)).mean(axis=2)
    h, w = (n // BLOCK_PX * BLOCK_PX for n in off.shape)
    blocks = off[:h, :w].reshape(h // BLOCK_PX, BLOCK_PX, w // BLOCK_PX, BLOCK_PX)
    return float(blocks.mean(axis=(1, 3)).max())


@pytest.fixture(scope="module")
def bulb(samples: Path) -> Scene:
    return scene_from(samples / "bulb.png")


def check(name: str, png: bytes) -> None:
    golden = GOLDEN / name
    if os.environ.get("PROFILETOOL_REGENERATE") == "1":
        reduced(png).save(golden, lossless=True)
    assert worst_block(reduced(png), reduced(golden)) < 16.0


def test_bulb(bulb: Scene) -> None:
    check("overlay_bulb.webp", draw_overlay(bulb))


def test_drawn_profile(samples: Path) -> None:
    check("overlay_finger_rest.webp", draw_overlay(scene_from(samples / "finger_rest.csv")))


def by_fe(scene: Scene) -> Scene:
    """As if finite elements had bent every joint by a seventh more."""
    design = scene.design
    more = [replace(bend, turn_rad=bend.turn_rad * 8.0 / 7.0) for bend in scene.bends]
    shape = deform(more, design.tube.length_mm, 10.0, design.base_pose, scene.profile.sign)
    joints = tuple(replace(j, theta_fe_deg=j.theta_formula_deg * 8.0 / 7.0) for j in design.joints)
    fit = replace(design.fit, fe=misfit(shape, scene.profile))
    verified = sealed(replace(design, joints=joints, fit=fit, verified=True, warnings=()))
    return replace(scene, design=verified, fe=shape)


def test_bulb_with_finite_elements(bulb: Scene) -> None:
    check("overlay_bulb_fe.webp", draw_overlay(by_fe(bulb)))


def by_response(scene: Scene) -> Scene:
    """As if the joint response had bent every joint by a tenth less, and steps were one thread."""
    design = scene.design
    less = [replace(bend, turn_rad=0.9 * bend.turn_rad) for bend in scene.bends]
    bent = deform(less, design.tube.length_mm, 10.0, design.base_pose, scene.profile.sign)
    joints = tuple(
        replace(
            j,
            theta_response_deg=0.9 * j.theta_formula_deg,
            alpha_closed_deg=round(j.alpha_closed_deg * np.pi / 36.0) * 36.0 / np.pi,
        )
        for j in design.joints
    )
    fit = replace(design.fit, response=misfit(bent, scene.profile))
    design = replace(design, joints=joints, fit=fit, method="optimal", warnings=())
    return replace(scene, design=design, bent=bent, by="joint response")


def test_bulb_by_the_joint_response(bulb: Scene) -> None:
    # A design that no better choice of joints can change; what is chosen is tested elsewhere.
    check("overlay_bulb_response.webp", draw_overlay(by_response(bulb)))


@pytest.mark.slow
def test_an_optimal_design_is_drawn_as_the_response_bends_it(samples: Path) -> None:
    request = Request(samples / "finger_rest.csv", verify=False)
    result = run(request, lambda line: None)
    scene = scene_of(result)
    assert scene.by == "joint response"
    assert scene.fe is None
    assert scene.bent is result.plan.bent
    off = misfit(scene.bent, scene.profile).rms_mm
    assert off == pytest.approx(result.design.fit.response.rms_mm)
    assert off < result.design.fit.formula.rms_mm
    assert (
        worst_block(
            reduced(draw_overlay(scene)), reduced(draw_overlay(replace(scene, bent=result.shape)))
        )
        > 16.0
    )


def test_finite_elements_a_millimetre_off_are_seen(bulb: Scene) -> None:
    scene = by_fe(bulb)
    assert scene.fe is not None
    shifted = replace(scene, fe=replace(scene.fe, facing=scene.fe.facing + 1.0))
    assert worst_block(reduced(draw_overlay(scene)), reduced(draw_overlay(shifted))) > 16.0


@pytest.mark.slow
def test_a_tube_a_millimetre_off_is_seen(bulb: Scene) -> None:
    shifted = replace(bulb, bent=replace(bulb.bent, facing=bulb.bent.facing + 1.0))
    assert worst_block(reduced(draw_overlay(bulb)), reduced(draw_overlay(shifted))) > 16.0


def test_the_picture_lies_in_the_object_frame() -> None:
    picture = Picture(np.zeros((40, 20, 3), np.uint8), None, None, "PNG")
    assert backdrop_of(picture, 0.5, (9.5, 4.5)).extent == (-5.0, 5.0, -17.5, 2.5)
    large = Picture(np.zeros((4000, 2000, 3), np.uint8), None, None, "PNG")
    assert backdrop_of(large, 0.5, (0.0, 0.0)).rgb.shape[0] <= 1400


def test_what_is_transparent_is_white() -> None:
    alpha = np.array([[0, 255], [128, 0]], np.uint8)
    picture = Picture(np.full((2, 2, 3), 40, np.uint8), alpha, None, "PNG")
    grey = backdrop_of(picture, 0.5, (0.0, 0.0)).rgb[..., 0]
    assert grey.tolist() == [[255, 40], [147, 255]]


@pytest.mark.slow
def test_an_infeasible_design_says_so(bulb: Scene) -> None:
    marked = replace(bulb, design=replace(bulb.design, feasible=False))
    assert worst_block(reduced(draw_overlay(bulb)), reduced(draw_overlay(marked))) > 16.0
