"""The scene: everything that the overlay and the report draw, gathered from a result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from profiletool.bending.kinematics import Bend, deform
from profiletool.pipeline import Result
from profiletool.records.design import Design
from profiletool.records.frames import Shape
from profiletool.records.picture import Picture
from profiletool.records.profile import Profile
from profiletool.records.units import FloatArray

_LONGEST_PX = 1000  # the picture is shown no finer than the figure resolves


@dataclass(frozen=True)
class Backdrop:
    """The picture behind the drawing.

    Attributes
    ----------
    rgb : (H, W, 3) uint8
    extent : (left, right, bottom, top) mm
        Place of its edges in the object frame.
    """

    rgb: NDArray[np.uint8]
    extent: tuple[float, float, float, float]


@dataclass(frozen=True)
class Scene:
    """All that the overlay shows.

    Attributes
    ----------
    backdrop : Backdrop or None
        None for a drawn profile.
    profile : Profile
    places : (n,) mm
        Arc lengths of the joints' middles on the profile.
    design : Design
    bends : sequence of Bend
        As the formula has them.
    by : str
        Name of the model that the joints were chosen by.
    bent, straight : Shape
        The tube as that model bends it, and at rest.
    fe : Shape or None
        The tube by finite elements; None where it was not verified.
    missed : sequence of (float, float)
        Arc lengths of the stretches that the tube is far off, mm.
    band : (2, M, 2) array or None
        Edges of the band that holds 95 % of builds, mm.
    """

    backdrop: Backdrop | None
    profile: Profile
    places: FloatArray
    design: Design
    bends: Sequence[Bend]
    by: str
    bent: Shape
    straight: Shape
    fe: Shape | None = None
    missed: Sequence[tuple[float, float]] = ()
    band: FloatArray | None = None


def scene_of(result: Result) -> Scene:
    """Gather what the overlay shows."""
    subject, plan, layout = result.subject, result.plan, result.plan.layout
    backdrop = None
    if subject.picture is not None and subject.origin_px is not None:
        backdrop = backdrop_of(
            subject.picture, subject.scale.mm_per_px, subject.origin_px, subject.rotated_deg
        )
    radius = 0.5 * result.design.tube.outer_diameter_mm
    return Scene(
        backdrop=backdrop,
        profile=subject.profile,
        places=plan.places,
        design=result.design,
        bends=layout.bends(),
        by=plan.by,
        bent=plan.bent,
        straight=deform((), layout.length_mm, radius, layout.pose, subject.profile.sign),
        fe=None if result.check is None else result.check.shape,
        missed=tuple((place.start, place.end) for place in result.misses),
        band=result.band,
    )


def clamp_ring(scene: Scene) -> FloatArray:
    """Outline of the tube in its clamp, (4, 2) mm: the clamp's edge first and last."""
    near, far = scene.straight.facing[0], scene.straight.far[0]
    along = scene.straight.facing[-1] - near
    back = scene.design.clamp.length_mm * along / np.hypot(*along)
    return np.stack([near, near - back, far - back, far])


def backdrop_of(
    picture: Picture, mm_per_px: float, origin_px: tuple[float, float], rotated_deg: float = 0.0
) -> Backdrop:
    """Place a picture in the object frame, thinned to what the figure resolves.

    It is turned counter-clockwise about its middle first; ``origin_px`` lies in what comes of
    that. What is transparent, or outside the picture, is shown white.
    """
    height, width = picture.rgb.shape[:2]
    every = max(1, round(max(height, width) / _LONGEST_PX))
    rgb = picture.rgb[::every, ::every]
    if picture.alpha is not None:
        cover = picture.alpha[::every, ::every, None] / 255.0
        rgb = np.rint(255.0 - (255.0 - rgb) * cover).astype(np.uint8)
    size = np.array([width, height], float)
    if rotated_deg:
        pixel = size / rgb.shape[1::-1]
        image = Image.fromarray(rgb).rotate(
            rotated_deg, Image.Resampling.BICUBIC, expand=True, fillcolor="white"
        )
        rgb, size = np.asarray(image), pixel * image.size
    x, y = 0.5 * (width - 1.0) - origin_px[0], origin_px[1] - 0.5 * (height - 1.0)
    half, tall = 0.5 * size
    extent = np.array([x - half, x + half, y - tall, y + tall]) * mm_per_px
    left, right, bottom, top = extent.tolist()
    return Backdrop(rgb, (left, right, bottom, top))
