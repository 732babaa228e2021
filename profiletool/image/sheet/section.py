"""The true outline of a round body that lies on the sheet, from how a near camera sees it.

A body of revolution is symmetric to any plane through its axis, and its support function depends
only on the angle between a tangent plane and the axis. The camera and a tangent of the outline
make such a plane; turned about the axis into the sheet's direction it is a tangent of the true
outline, and the point where it touches is the one where the ray's distance from the axis points
along the plane's normal. That holds for any perspective and any tilt. At the ends, which a tilted
camera sees from outside only in part, the outline goes on with the curvature it was last seen
with, as far as it can: a sphere is closed as a sphere, a rim as a flat end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from profiletool.records.units import FloatArray

_STEP_MM, _SMOOTH_MM, _LEAST_POINTS = 0.5, 2.0, 64
_TURNS = 4  # the axis is found from the outline, the outline with the axis
_ASKEW = 0.25  # sine of the angle between ray and meridian, below which it tells no radius
_TOO_LARGE = 0.02  # of the largest radius
_LAST = 9  # points, where single ones scatter
_END = 0.3  # of the normal's axial part: what an end's curvature is taken from
_ROUND = 1.1  # length over width, below which a body has no axis to be told


@dataclass(frozen=True)
class Section:
    """The outline of a lying body of revolution in the plane through its axis.

    Attributes
    ----------
    points : (N, 2) mm
        Closed, in plan.
    height_mm : float
        The axis's height above the sheet: the largest radius.
    """

    points: FloatArray
    height_mm: float


def lying_section(contour: FloatArray, camera: FloatArray) -> Section | None:
    """Find the true outline of a lying body of revolution.

    Parameters
    ----------
    contour : (N, 2) mm
        As seen on the sheet, closed, in plan: x to the right, y down.
    camera : (3,) mm
        The camera's foot in plan, and its height.

    Returns
    -------
    Section or None
        Exact for bodies of revolution but for their unseen ends; None where the outline has
        overhangs, as that of a mug with its handle, or the section would be larger than what is
        seen of it: no body of revolution then.
    """
    ring = _resampled(contour)
    axis = np.array([0.0, 1.0])
    section = None
    for _ in range(_TURNS):
        section = _section(ring, camera, axis)
        if section is None:
            return None
        turned = _principal_axis(section.points)
        if abs(float(turned @ axis)) > 1.0 - 1e-7:
            break
        axis = turned
    reach = (1.0 + _TOO_LARGE) * np.ptp(ring, axis=0)
    if section is None or (np.ptp(section.points, axis=0) > reach).any():
        return None
    return section


def _section(ring: FloatArray, camera: FloatArray, axis: FloatArray) -> Section | None:
    across = np.array([axis[1], -axis[0]])
    middle, height = _incircle(ring @ across, float(camera[:2] @ across), float(camera[2]))
    contact = _contact(ring, camera, axis, np.append(across * middle, height))
    crossings = np.flatnonzero(contact.right != np.roll(contact.right, 1))
    if len(crossings) != 2:
        return None
    # Clockwise as seen, the right side runs downwards and the left one upwards.
    start, end = crossings if contact.right[crossings[0]] else crossings[::-1]
    order = np.roll(np.arange(len(contact.right)), -start)
    count = (end - start) % len(order)
    outline = []
    for side, sign in ((order[:count], 1.0), (order[count:][::-1], -1.0)):
        place, radius = _closed_ends(contact.place[side], contact.radius[side], contact.lean[side])
        outline.append(across * middle + place[:, None] * axis + sign * radius[:, None] * across)
    return Section(np.concatenate([outline[0], outline[1][::-1]]), height)


@dataclass(frozen=True)
class _Contact:
    """Where rays touch the body: place along the axis, radius, axial part of the normal, side."""

    place: FloatArray
    radius: FloatArray
    lean: FloatArray
    right: NDArray[np.bool_]


def _contact(
    ring: FloatArray, camera: FloatArray, axis: FloatArray, origin: FloatArray
) -> _Contact:
    """Find the contacts of a ring's rays with a body round the axis through ``origin`` (3,) mm."""
    along = np.append(axis, 0.0)
    tangents = np.column_stack([_tangents(ring), np.zeros(len(ring))])
    rays = np.column_stack([ring, np.zeros(len(ring))]) - camera
    # The ring runs clockwise as seen from above: this points outwards (a left-handed frame).
    faces = np.cross(rays, tangents)
    faces /= np.linalg.norm(faces, axis=1)[:, None]
    lean = faces @ along
    radial = faces - lean[:, None] * along
    outward = np.linalg.norm(radial, axis=1)
    meridian = np.cross(along, faces)
    approach = (rays * meridian).sum(axis=1)
    told = np.abs(approach) > _ASKEW * np.linalg.norm(rays, axis=1) * np.maximum(outward, 1e-3)
    share = (meridian[told] @ (origin - camera)) / approach[told]
    touch = camera + share[:, None] * rays[told] - origin
    radius = (touch * radial[told]).sum(axis=1) / outward[told]
    right = faces[told] @ np.array([axis[1], -axis[0], 0.0]) > 0.0
    # The axis is at the height of the largest radius: what is farther off is no contact.
    kept = radius < (1.0 + _TOO_LARGE) * origin[2]
    return _Contact((touch @ along)[kept], radius[kept], lean[told][kept], right[kept])


def _incircle(across: FloatArray, foot: float, height: float) -> tuple[float, float]:
    """Place and height of the axis: the sheet and the outermost rays touch the largest circle."""
    low, high = float(across.min()), float(across.max())
    base = high - low
    left, right = math.hypot(foot - low, height), math.hypot(foot - high, height)
    return low + (base + left - right) / 2.0, base * height / (base + left + right)


def _resampled(contour: FloatArray) -> FloatArray:
    """Give a ring in even steps, clockwise as seen."""
    closed = np.vstack([contour, contour[:1]])
    x, y = closed.T
    if (x[:-1] * y[1:] - y[:-1] * x[1:]).sum() < 0.0:
        closed = closed[::-1]
    s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    count = max(_LEAST_POINTS, round(s[-1] / _STEP_MM))
    places = np.arange(count) * (s[-1] / count)
    return np.column_stack([np.interp(places, s, closed[:, k]) for k in (0, 1)])


def _tangents(ring: FloatArray) -> FloatArray:
    """Directions (N, 2) of an evenly sampled ring, smoothed over some millimetres."""
    waves = 2.0 * np.pi * np.fft.fftfreq(len(ring), _STEP_MM)
    damped = np.fft.fft(ring[:, 0] + 1j * ring[:, 1]) * np.exp(-0.5 * (waves * _SMOOTH_MM) ** 2)
    slope = np.fft.ifft(1j * waves * damped)
    slope /= np.maximum(np.abs(slope), 1e-12)
    return np.column_stack([slope.real, slope.imag])


def _closed_ends(
    place: FloatArray, radius: FloatArray, lean: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Go on at both ends of one side, from the upper to the lower, to the axis."""
    upper = _end(-place[::-1], radius[::-1], -lean[::-1])
    lower = _end(place, radius, lean)
    return (
        np.concatenate([-upper[0][::-1], place, lower[0]]),
        np.concatenate([upper[1][::-1], radius, lower[1]]),
    )


def _end(place: FloatArray, radius: FloatArray, lean: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Continue with the last curvature until the outline stands square on the axis."""
    last = float(lean[-1])
    if not 0.0 < last < 1.0:
        return np.array([place[-1]]), np.array([0.0])
    near = np.flatnonzero(lean > max(last - _END, 0.5 * last))
    near = near[near > len(lean) // 2]
    bend = 0.0
    if len(near) > _LAST and np.ptp(lean[near]) > 0.05:
        bend = float(np.polyfit(lean[near], place[near], 1)[0])
    slope = np.sqrt(1.0 - lean[-_LAST:] ** 2)
    bend = min(max(bend, 0.0), float(np.median(radius[-_LAST:] / slope)))
    further = np.linspace(math.asin(last), math.pi / 2.0, 24)[1:]
    # The last points scatter most: their mean circle goes on, not the very last one's.
    middle = float(np.mean(place[-_LAST:] - bend * lean[-_LAST:]))
    lower = float(np.mean(radius[-_LAST:] - bend * slope))
    return (
        middle + bend * np.append(np.sin(further), 1.0),
        np.append(np.maximum(lower + bend * np.cos(further), 0.0), 0.0),
    )


def _principal_axis(points: FloatArray) -> FloatArray:
    """Give the direction of the longer extent, downwards; straight down where there is none."""
    ring = _resampled(points)
    x, y = (ring - ring.mean(axis=0)).T
    cross = x * np.roll(y, -1) - y * np.roll(x, -1)
    area = cross.sum()
    mean = np.array([((z + np.roll(z, -1)) * cross).sum() / (3.0 * area) for z in (x, y)])
    x, y = x - mean[0], y - mean[1]
    nx, ny = np.roll(x, -1), np.roll(y, -1)
    cross = x * ny - y * nx
    xx = ((x * x + x * nx + nx * nx) * cross).sum() / (6.0 * area)
    yy = ((y * y + y * ny + ny * ny) * cross).sum() / (6.0 * area)
    xy = ((x * ny + 2.0 * x * y + 2.0 * nx * ny + nx * y) * cross).sum() / (12.0 * area)
    sizes, axes = np.linalg.eigh(np.array([[xx, xy], [xy, yy]]))
    longer = axes[:, 1] * np.sign(axes[1, 1] or 1.0)
    if sizes[1] < _ROUND**2 * sizes[0] or longer[1] < math.cos(math.radians(30.0)):
        return np.array([0.0, 1.0])
    return np.asarray(longer)
