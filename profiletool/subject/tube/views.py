"""Pictures of a tube, prepared: edges, camera, and the plane that it bends in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from profiletool.errors import NoScale, UsageError
from profiletool.image.load import load_picture
from profiletool.image.sheet.rectify import Rectified, rectify
from profiletool.records.picture import Picture
from profiletool.records.request import Box, Point
from profiletool.records.units import BoolArray
from profiletool.subject.tube.camera import Camera, FlatCamera, SheetCamera
from profiletool.subject.tube.edges import Shown, shown
from profiletool.subject.tube.family import Family
from profiletool.subject.tube.search import Plane
from profiletool.subject.tube.values import Line


@dataclass(frozen=True)
class Looked:
    """How to look at the pictures.

    Attributes
    ----------
    mm_per_px : float or None
        None where the printed sheet tells.
    box, point
        As in `Look`; of the first picture that is looked at.
    marks : bool
        Whether dots or rings are painted on the wrapped sectors.
    lines : mapping of (str, int) to Line
        Drawn by hand: by picture and wrapped sector, from 0.
    """

    mm_per_px: float | None = None
    box: Box | None = None
    point: Point | None = None
    marks: bool = False
    lines: Mapping[tuple[str, int], Line] = field(default_factory=dict)


@dataclass(frozen=True)
class View:
    """A picture, prepared."""

    name: str
    bar: float
    shown: Shown
    camera: Camera
    plane: Plane


def picture_of(path: Path) -> Picture:
    """Decode a picture file, upright; as `profiletool.image.load.load_picture`."""
    return load_picture(path)


def view_of(name: str, bar: float, picture: Picture, family: Family, looked: Looked) -> View:
    """Prepare a picture.

    Raises
    ------
    NoScale, UsageError
    """
    sheet = rectify(picture)
    if sheet is not None:
        if looked.mm_per_px is not None:
            raise UsageError(
                f"{name} shows a printed sheet, which tells its scale: leave `mm_per_px` away"
            )
        camera: Camera = SheetCamera(sheet.view, family.radius)
        return View(name, bar, shown(picture.rgb), camera, _frontal(sheet, camera))
    if looked.mm_per_px is None:
        raise NoScale(
            f"{name}: nothing says how large a pixel is: photograph the actuator on the printed "
            "sheet (`profiletool sheet`), or give `mm_per_px`"
        )
    flat = FlatCamera(looked.mm_per_px)
    plane = Plane(picture.rgb, looked.mm_per_px, np.zeros(2), np.array([1.0, 0.0]))
    return View(name, bar, shown(picture.rgb), flat, plane)


def _frontal(sheet: Rectified, camera: Camera) -> Plane:
    """Take the frontal view of a sheet, as the tube's plane."""
    w, h = sheet.frame.width, sheet.frame.height
    corners = sheet.photo_of(np.array([[0.0, 0.0], [w - 1.0, 0.0], [0.0, h - 1.0]]))
    first, right, _ = camera.mm(corners)
    across = right - first
    length = float(np.linalg.norm(across))
    return Plane(sheet.plain.rgb, length / (w - 1.0), first, across / length)


def allowed_in(view: View, looked: Looked) -> BoolArray | None:
    """Where in the plane's picture the tube may lie."""
    if looked.box is None:
        return None
    x, y, w, h = looked.box
    corners = np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h]], float)
    at = view.plane.seen(view.camera.mm(corners)) / view.plane.mm_per_px
    low, high = at.min(axis=0), at.max(axis=0)
    rows, columns = view.plane.rgb.shape[:2]
    inside_x = (np.arange(columns) >= low[0]) & (np.arange(columns) <= high[0])
    inside_y = (np.arange(rows) >= low[1]) & (np.arange(rows) <= high[1])
    if not (inside_x.any() and inside_y.any()):
        raise UsageError(f"`box` lies outside {view.name}")
    return np.asarray(inside_y[:, None] & inside_x[None])
