"""Directions of joints: in the plane, and out of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fem.actuator import AWAY as FEM_AWAY
from fem.actuator import TOWARD as FEM_TOWARD
from fem.actuator import Window
from formula.files import load_formula
from profiletool.bending.constant_curvature import FormulaModel
from profiletool.bending.model import AWAY, TOWARD, Chain, centers_of
from profiletool.bending.response import Response
from profiletool.errors import UnreadableInput
from profiletool.records.design import Joint
from profiletool.records.frames import Pose

JOINT = Joint(3, 18.0, 8.0, 120.0, 270.0, 30.0, 31.0, None, 14.0)
CHAIN = Chain(
    centre=np.array([20.0, 45.0]),
    openF=np.array([8.0, 8.0]),
    alpha=np.array([2.0, 2.2]),
    alpha_center=np.radians([270.0, 200.0]),
    length=70.0,
)


def pointing(alpha_center_deg: float) -> Joint:
    return replace(JOINT, alpha_center_deg=alpha_center_deg)


@pytest.mark.parametrize(("center", "sense"), [(270.0, 1.0), (90.0, -1.0)])
@pytest.mark.parametrize("off", [0.0, 9e-7, -9e-7])
def test_the_two_senses_of_the_plane(center: float, sense: float, off: float) -> None:
    assert pointing(center + off).sense == sense


@pytest.mark.parametrize("center", [269.9, 270.00001, 90.1, 200.0, 0.0, 180.0, 360.0])
def test_other_directions_have_no_sense(center: float) -> None:
    with pytest.raises(UnreadableInput, match=f"joint 3 bends out .* {center:g} deg:"):
        _ = pointing(center).sense


@pytest.mark.parametrize("center", [*np.arange(0.0, 361.0, 7.5).tolist(), 89.9, 269.9])
def test_every_direction_has_a_side_and_a_sign_as_in_finite_elements(center: float) -> None:
    joint = pointing(center)
    assert joint.away == Window(14.0, 8.0, 2.0, float(np.radians(center))).away
    assert joint.signed(30.0) == (-30.0 if joint.away else 30.0)


def test_a_chain_has_the_senses_of_its_joints() -> None:
    assert (TOWARD, AWAY) == (FEM_TOWARD, FEM_AWAY)
    sense = np.array([1.0, -1.0, -1.0])
    three = np.ones(3)
    assert Chain(three, three, three, centers_of(sense), 9.0).sense.tolist() == sense.tolist()


@pytest.mark.parametrize("by", ["formula", "response"])
def test_models_of_the_plane_refuse_joints_out_of_it(by: str) -> None:
    model = FormulaModel(load_formula(), 10.0) if by == "formula" else Response.load()
    with pytest.raises(UnreadableInput, match="joint 2 bends out of the plane"):
        model.shape(CHAIN, 0.15, Pose(0.0, 0.0, 0.0), 1.0)
    planar = replace(CHAIN, alpha_center=centers_of([1.0, -1.0]))
    assert model.shape(planar, 0.15, Pose(0.0, 0.0, 0.0), 1.0).facing.shape[1] == 2
