"""The subject of a design: the object or drawing, its scale, and the profile to follow."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from profiletool.errors import NoObject
from profiletool.image.load import load_picture
from profiletool.profile.drawing.load import SUFFIXES, load_vector
from profiletool.profile.side import top_middle
from profiletool.profile.target import Reach, profile_of_object
from profiletool.records.picture import Picture, Scale, Silhouette
from profiletool.records.profile import DrawnLine, Profile
from profiletool.records.request import Look, Request
from profiletool.records.side import Side
from profiletool.records.units import FloatArray
from profiletool.subject.drawing import see_drawing, sides_apart
from profiletool.subject.photo import see

_WRONG_SCALE = {
    "height": {"top", "bottom"},
    "width": {"left", "right"},
    "sheet": {"left", "right", "top", "bottom"},
}


@dataclass(frozen=True)
class Subject:
    """The object that a design is for.

    Attributes
    ----------
    picture : Picture or None
    silhouette : Silhouette or None
        None, as the picture, for a drawing.
    scale : Scale
    origin_px : (x, y) or None
        The object frame's origin in the picture once that is turned.
    profile : Profile
    rotated_deg : float
        By which the picture is turned, counter-clockwise about its middle.
    notes : tuple of str
        What the user should know of how the picture was read.
    """

    picture: Picture | None
    silhouette: Silhouette | None
    scale: Scale
    origin_px: tuple[float, float] | None
    profile: Profile
    rotated_deg: float = 0.0
    notes: tuple[str, ...] = ()


def find_subject(request: Request, say: Callable[[str], None]) -> Subject:
    """Read the picture or drawing and find the profile that the tube shall follow.

    Raises
    ------
    UnreadableInput, NoScale, NoObject, UsageError
    """
    reach, given = _reach(request), source_of(request)
    if isinstance(given, Profile):
        return Subject(None, None, Scale(1.0, "vector"), None, given)
    if isinstance(given, DrawnLine):
        line = see_drawing(given, request.scale, request.look)
        profile = line.profile(reach)
        say(line.told(profile))
        return Subject(None, None, line.scale, None, profile, line.rotated_deg, line.notes)
    seen = see(given, request.scale, request.look, say)
    silhouette, scale = seen.silhouette, seen.scale
    _check_frame(silhouette, scale, request.side)
    k = scale.mm_per_px
    origin, outline = _outline(silhouette, scale)
    width, height = np.ptp(outline, axis=0)
    by_mask = request.look.mask is not None
    sure = "" if by_mask else f" (sure to {100.0 * silhouette.confidence:.0f} %)"
    error = scale.measured_error
    within = "" if error is None else f", within {100.0 * error:.2g} %"
    say(
        f"object: {width:.1f} x {height:.1f} mm, found by {silhouette.method}{sure}, "
        f"{k:.4g} mm per pixel from {scale.source}{within}"
    )
    profile = profile_of_object(outline, _seen(reach, silhouette, scale))
    notes = (*given.notes, *seen.notes, *sides_apart(float(width), request.scale))
    place = float(origin[0]), float(origin[1])
    return Subject(seen.picture, silhouette, scale, place, profile, seen.rotated_deg, notes)


def source_of(request: Request) -> Picture | DrawnLine | Profile:
    """Read what a request is about, or take what is given in its place.

    Raises
    ------
    UnreadableInput
    """
    if request.given is not None:
        return request.given
    if request.file.suffix.lower() in SUFFIXES:
        return load_vector(request.file, request.look.layer)
    return load_picture(request.file)


def subject_again(subject: Subject, request: Request) -> Subject:
    """Find the profile of a subject for another request, such as another stretch or tube.

    Raises
    ------
    UnreadableInput, NoScale, NoObject, UsageError
    """
    silhouette, scale = subject.silhouette, subject.scale
    if silhouette is None:  # a drawing is read quickly
        return find_subject(request, lambda line: None)
    _check_frame(silhouette, scale, request.side)
    _, outline = _outline(silhouette, scale)
    profile = profile_of_object(outline, _seen(_reach(request), silhouette, scale))
    return replace(subject, profile=profile)


def _reach(request: Request) -> Reach:
    return Reach(
        side=request.side,
        radius_mm=request.tube.radius_mm,
        clearance_mm=request.clearance_mm,
        start_pct=request.start_pct,
        end_pct=request.end_pct,
    )


def _seen(reach: Reach, silhouette: Silhouette, scale: Scale) -> Reach:
    k = scale.mm_per_px
    return replace(reach, noise_mm=silhouette.noise_px * k, spacing_mm=k)


def _outline(silhouette: Silhouette, scale: Scale) -> tuple[FloatArray, FloatArray]:
    """Give the object frame's origin, px, and the outline (M, 2) in it, mm."""
    k = scale.mm_per_px
    origin = top_middle(silhouette.contour_px * [1.0, -1.0]) * [1.0, -1.0]
    return origin, (silhouette.contour_px - origin) * [k, -k]


def digest_of(request: Request) -> str:
    """SHA-256 of what a design is made from: the file's bytes, or the values given in its place."""
    given = request.given
    if given is None:
        return hashlib.sha256(request.file.read_bytes()).hexdigest()
    arrays = (given.rgb, given.alpha) if isinstance(given, Picture) else (given.points,)
    digest = hashlib.sha256()
    for array in arrays:
        if array is not None:
            digest.update(f"{array.dtype.str}{array.shape}".encode() + array.tobytes())
    return digest.hexdigest()


def _check_frame(silhouette: Silhouette, scale: Scale, side: Side) -> None:
    """Refuse an object that is cut off where it matters."""
    cut = silhouette.touches & ({side, "top"} | _WRONG_SCALE.get(scale.source, set()))
    if cut:
        raise NoObject(
            f"the object runs out of the frame ({', '.join(sorted(cut))}); "
            "take a picture with some ground all around it"
        )


def drawing_notes(request: Request, subject: Subject) -> Iterator[str]:
    """Say what the user should know of how the picture was read."""
    yield from subject.notes
    if subject.silhouette is None:
        asked, look = request.scale, request.look
        if asked.marker_mm is not None or asked.camera_distance_mm is not None:
            yield "a drawing shows no marker: `marker_mm` and `camera_distance_mm` were not used"
        if look != Look(rotate=look.rotate, symmetric=look.symmetric, layer=look.layer):
            yield "a drawing needs no `box`, `point`, `mask` or `flat`: they were not used"
        return
    if request.look.layer is not None:
        yield "a picture has no `layer`: it was not used"
    if subject.silhouette.touches:
        edges = ", ".join(sorted(subject.silhouette.touches))
        yield f"the object runs out of the frame ({edges}); the profile ends there"
