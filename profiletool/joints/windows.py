"""Windows: the cut stretches of the gauze, their rows of slits, and the seam beside them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from profiletool.records.design import TOWARD_DEG, Gauze, Joint
from profiletool.records.units import FloatArray

FULL_CIRCLE = 360.0
# Angles closer than this are the same edge; slivers between them are no place for a seam.
SAME_DEG = 1e-6


@dataclass(frozen=True)
class SeamChoice:
    """A place for the glue and weld line, and the cuts that it crosses.

    Attributes
    ----------
    seam_deg : float
        Its angle on the tube, 0 <= seam < 360.
    crossed : tuple of int
        Numbers of the joints whose cut sector it runs through.
    margin_deg : float
        Distance to the nearest edge of any joint's sector.
    """

    seam_deg: float
    crossed: tuple[int, ...]
    margin_deg: float


def cut_sector(joint: Joint) -> tuple[float, float]:
    """Return the cut sector of a joint as (start angle in 0..360, extent), deg.

    Raises
    ------
    ValueError
        ``alpha_closed_deg`` is not within 0..360.
    """
    if not 0 <= joint.alpha_closed_deg <= FULL_CIRCLE:
        raise ValueError(f"joint {joint.number}: alpha_closed_deg must lie within 0..360")
    start = (joint.alpha_center_deg + joint.alpha_closed_deg / 2) % FULL_CIRCLE
    return start, FULL_CIRCLE - joint.alpha_closed_deg


def slit_rows(joint: Joint, pitch_mm: float) -> FloatArray:
    """Return the places along the tube of a joint's slits, (N,) mm: one per cell of the mesh.

    Raises
    ------
    ValueError
        The mesh pitch is not positive.
    """
    if pitch_mm <= 0:
        raise ValueError("the mesh pitch must be positive")
    n = max(1, round(joint.openF_mm / pitch_mm))
    return np.asarray(joint.centre_mm + (np.arange(n) - (n - 1) / 2) * pitch_mm)


def off_mesh(joints: Sequence[Joint], gauze: Gauze) -> tuple[int, ...]:
    """Return the numbers of the joints whose rows do not fall into the others' mesh cells.

    The hoop threads lie ``pitch_mm`` apart all along the tube; the longest total cut that
    agrees on where they lie decides, and a joint that differs by more than a thread is named.
    """
    pitch = gauze.pitch_mm
    if not joints:
        return ()
    phase = np.array([slit_rows(joint, pitch)[0] for joint in joints])
    shift = np.abs((phase[:, None] - phase[None, :] + pitch / 2) % pitch - pitch / 2)
    agree = shift <= gauze.thread_mm
    cut = np.array([joint.openF_mm for joint in joints])
    leader = int(np.argmax(agree @ cut))
    return tuple(j.number for j, same in zip(joints, agree[leader], strict=True) if not same)


def seam_at(joints: Sequence[Joint], seam_deg: float) -> SeamChoice:
    """Return what a seam at ``seam_deg`` crosses, and how far it is from any sector's edge."""
    seam = seam_deg % FULL_CIRCLE
    start, extent = _sectors(joints)
    inside = _strictly_inside(np.array([seam]), start, extent)[0]
    edges = _edges(start, extent)
    margin = FULL_CIRCLE / 2
    if edges.size:
        away = np.abs((edges - seam + FULL_CIRCLE / 2) % FULL_CIRCLE - FULL_CIRCLE / 2)
        margin = float(away.min())
    crossed = tuple(j.number for j, cut in zip(joints, inside, strict=True) if cut)
    return SeamChoice(seam, crossed, margin)


def best_seam(joints: Sequence[Joint]) -> SeamChoice:
    """Return the best place for the glue and weld line.

    The edges of all cut sectors part the circle into arcs; within one, the same joints are
    crossed. Of the arcs on which the crossed joints' ``openF`` sums to the least, the widest
    one is taken, and its middle: the point with the greatest margin. Among equals the nearest
    to the first joint's ``alpha_center`` wins, then the counter-clockwise one, so that turning
    all joints turns the seam with them.
    """
    start, extent = _sectors(joints)
    edges = _edges(start, extent)
    home = joints[0].alpha_center_deg if joints else TOWARD_DEG
    if not edges.size:
        return seam_at(joints, home)
    width = np.diff(edges, append=edges[0] + FULL_CIRCLE)
    middle = edges + width / 2
    crossed = _strictly_inside(middle, start, extent)
    cost = crossed @ np.array([joint.openF_mm for joint in joints])
    away = (middle - home + FULL_CIRCLE / 2) % FULL_CIRCLE - FULL_CIRCLE / 2
    keys = (away < 0, *(np.round(key, 6) for key in (np.abs(away), -width, cost)))
    return seam_at(joints, float(middle[np.lexsort(keys)[0]]))


def _sectors(joints: Sequence[Joint]) -> tuple[FloatArray, FloatArray]:
    """Return the cut sectors' starts and extents, (N,) deg each."""
    pairs = np.array([cut_sector(joint) for joint in joints]).reshape(-1, 2)
    return pairs[:, 0], pairs[:, 1]


def _strictly_inside(
    angles: FloatArray, start: FloatArray, extent: FloatArray
) -> NDArray[np.bool_]:
    """Tell which angles (M,) lie inside which sectors (N,), edges left out; (M, N)."""
    into = (angles[:, None] - start) % FULL_CIRCLE
    within = (into > SAME_DEG) & (into < extent - SAME_DEG)
    return np.asarray(within | (extent >= FULL_CIRCLE))


def _edges(start: FloatArray, extent: FloatArray) -> FloatArray:
    """Return the sectors' edges, (K,) deg, ascending, each once; none for 0 and 360 deg."""
    real = (extent > SAME_DEG) & (extent < FULL_CIRCLE - SAME_DEG)
    edges = np.sort(np.concatenate([start[real], start[real] + extent[real]]) % FULL_CIRCLE)
    if not edges.size:
        return edges
    gap = np.diff(edges, prepend=edges[-1] - FULL_CIRCLE)
    return edges[gap > SAME_DEG]
