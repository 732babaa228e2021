"""Designs, chains and single joints as actuators of the finite-element model."""

from __future__ import annotations

import numpy as np

from fem.actuator import Actuator, Window, chain
from fem.gauze import THREAD_EA, Gauze
from profiletool.bending.model import Chain
from profiletool.records.design import Design
from profiletool.records.design import Gauze as DesignGauze
from profiletool.records.design import Tube as DesignTube
from profiletool.records.request import TubeSpec
from profiletool.records.rubber import law_of

_PAPER_THREAD_MM = 0.25


def actuator_of(design: Design) -> Actuator:
    """Model a design; its closed end is rigid over its last millimetre.

    Raises
    ------
    fem.errors.BadGeometry
        When no such actuator can be modelled.
    """
    tube, gauze = design.tube, design.gauze
    windows = tuple(
        Window(
            j.centre_mm,
            j.openF_mm,
            np.radians(j.alpha_closed_deg),
            float(np.radians(j.alpha_center_deg)),
        )
        for j in design.joints
    )
    return _tube(tube.length_mm, windows, tube, gauze)


def tube_of(chain: Chain, spec: TubeSpec) -> Actuator:
    """Model a chain of joints before it is a design.

    Raises
    ------
    fem.errors.BadGeometry
        When no such actuator can be modelled.
    """
    windows = tuple(
        Window(*(float(number) for number in joint))
        for joint in zip(chain.centre, chain.openF, chain.alpha, chain.alpha_center, strict=True)
    )
    return _tube(chain.length, windows, spec, spec)


def _tube(
    length: float,
    windows: tuple[Window, ...],
    tube: DesignTube | TubeSpec,
    gauze: DesignGauze | TubeSpec,
) -> Actuator:
    thread = THREAD_EA * (gauze.thread_mm / _PAPER_THREAD_MM) ** 2
    return Actuator(
        length,
        windows,
        diameter=tube.outer_diameter_mm,
        wall=tube.wall_mm,
        rubber=law_of(tube.rubber),
        gauze=Gauze(stiffness=thread * gauze.turns / gauze.pitch_mm),
    )


def joint_actuator(
    openF_mm: float, alpha_deg: float, center_deg: float, spec: TubeSpec
) -> Actuator:
    """Model one joint as the paper does: Root = F1 = 30 mm."""
    return chain(
        30.0, [30.0], [openF_mm], [float(np.radians(alpha_deg))], [float(np.radians(center_deg))],
        diameter=spec.outer_diameter_mm, wall=spec.wall_mm,
        rubber=law_of(spec.rubber),
    )  # fmt: skip


def finger_actuator() -> Actuator:
    """Model the finger of the paper's Table 2."""
    quarter = float(np.radians(90.0))
    return chain(10.0, [40.0, 22.0, 20.0], [14.0, 16.0, 12.0], [quarter] * 3)
