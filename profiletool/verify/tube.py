"""Designs, chains and single joints as actuators of the finite-element model."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem.actuator import Actuator, Window, chain
from fem.gauze import THREAD_EA, Gauze, slack_on
from fem.weight import Weight
from profiletool.bending.model import Chain
from profiletool.records.design import Design
from profiletool.records.design import Gauze as DesignGauze
from profiletool.records.design import Tube as DesignTube
from profiletool.records.frames import base_axes
from profiletool.records.model import PAPER_MODEL, ModelInputs
from profiletool.records.request import TubeSpec
from profiletool.records.rubber import law_of
from profiletool.records.side import side_sign
from profiletool.records.units import FloatArray

_PAPER_THREAD_MM = 0.25
PAPER_TUBE = TubeSpec()
_RUBBER_G_PER_MM3, _THREAD_G_PER_MM3 = 1.1e-3, 1.14e-3  # silicone, polyamide
_N_PER_G = 9.81e-3

Axes = tuple[FloatArray, FloatArray]
LYING_AXES = base_axes(0.0, -1.0)  # of an actuator without an object: along x, bending down


def actuator_of(design: Design) -> Actuator:
    """Model a design; its closed end is rigid over its last millimetre.

    Raises
    ------
    fem.errors.BadGeometry
        When no such actuator can be modelled.
    """
    windows = tuple(
        Window(
            j.centre_mm,
            j.openF_mm,
            np.radians(j.alpha_closed_deg),
            float(np.radians(j.alpha_center_deg)),
        )
        for j in design.joints
    )
    heading = float(np.radians(design.base_pose.heading_deg))
    made = _made_of(
        design.tube, design.gauze, design.model, base_axes(heading, side_sign(design.source.side))
    )
    return Actuator(design.tube.length_mm, windows, **made)


def tube_of(
    chain: Chain, spec: TubeSpec, model: ModelInputs = PAPER_MODEL, axes: Axes = LYING_AXES
) -> Actuator:
    """Model a chain of joints before it is a design.

    Parameters
    ----------
    chain : Chain
    spec : TubeSpec
    model : ModelInputs
    axes : ((2,), (2,))
        Unit vectors along the clamped tube and away from the object, in the object's frame;
        they matter to gravity alone.

    Raises
    ------
    fem.errors.BadGeometry
        When no such actuator can be modelled.
    """
    windows = tuple(
        Window(*(float(number) for number in joint))
        for joint in zip(chain.centre, chain.openF, chain.alpha, chain.alpha_center, strict=True)
    )
    return Actuator(chain.length, windows, **_made_of(spec, spec, model, axes))


def _made_of(
    tube: DesignTube | TubeSpec, gauze: DesignGauze | TubeSpec, model: ModelInputs, axes: Axes
) -> dict[str, Any]:
    """Give all fields of an actuator but its length and windows."""
    thread = model.thread_factor * THREAD_EA * (gauze.thread_mm / _PAPER_THREAD_MM) ** 2
    stiffness = thread * gauze.turns / gauze.pitch_mm
    rubber = law_of(tube.rubber, model.nu)
    return {
        "diameter": tube.outer_diameter_mm,
        "wall": tube.wall_mm,
        "rubber": rubber,
        "gauze": Gauze(
            stiffness=stiffness,
            slack=slack_on(rubber.shear_modulus * tube.wall_mm, stiffness),
            allowance=float(np.radians(model.sector_extra_deg)),
        ),
        "weight": _weight(gauze, model, axes),
    }


def _weight(gauze: DesignGauze | TubeSpec, model: ModelInputs, axes: Axes) -> Weight | None:
    """Weight of rubber and gauze, pulling where the model says in the object's frame."""
    along, outward = (np.asarray(axis) for axis in axes)
    # Away from the object is +1 to the left of a tube that points down, as on the left side.
    sign = 1.0 if along[1] * outward[0] - along[0] * outward[1] > 0.0 else -1.0
    pull = model.pull(sign)
    if pull is None:
        return None
    threads = 2.0 * gauze.turns / gauze.pitch_mm * 0.25 * np.pi * gauze.thread_mm**2  # mm
    return Weight(
        (0.0, float(outward @ pull), float(along @ pull)),
        rubber=_RUBBER_G_PER_MM3 * _N_PER_G,
        gauze=_THREAD_G_PER_MM3 * _N_PER_G * float(threads),
    )


def joint_actuator(
    openF_mm: float,
    alpha_deg: float,
    center_deg: float,
    spec: TubeSpec,
    model: ModelInputs = PAPER_MODEL,
) -> Actuator:
    """Model one joint as the paper does: Root = F1 = 30 mm."""
    return chain(
        30.0, [30.0], [openF_mm], [float(np.radians(alpha_deg))], [float(np.radians(center_deg))],
        **_made_of(spec, spec, model, LYING_AXES),
    )  # fmt: skip


FINGER = ((14.0, 90.0), (16.0, 90.0), (12.0, 90.0))  # openF mm and alpha deg of the paper's Table 2


def finger_actuator(model: ModelInputs = PAPER_MODEL, spec: TubeSpec = PAPER_TUBE) -> Actuator:
    """Model the finger of the paper's Table 2."""
    openF, alpha = zip(*FINGER, strict=True)
    return chain(
        10.0, [40.0, 22.0, 20.0], openF, np.radians(alpha).tolist(),
        **_made_of(spec, spec, model, LYING_AXES),
    )  # fmt: skip
