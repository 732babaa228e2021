"""The stage: the object with the tube beside it, as one SVG in mm with the data of its motion."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from PIL import Image

from profiletool.records.frames import Shape
from profiletool.records.units import FloatArray
from profiletool.report.film import Film, drawn, path, ring_path
from profiletool.report.markup import Markup, signed, table, tag
from profiletool.report.scene import Backdrop, Scene, clamp_ring

_MARGIN_MM = 7.0
_LONGEST_PX = 1000
_JPEG_QUALITY = 80
_FINE_MM = 0.02  # drawn lines are thinned by no more
_EMS = 46.0  # widths of a letter across the stage
_SUBSTEPS = 24  # of the slider, between two pressures of FE


@dataclass(frozen=True)
class StageFrame:
    """The visible part of the plane: mm, x to the right, y up."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def em(self) -> float:
        """Size of the letters, mm."""
        return max(self.x1 - self.x0, 0.8 * (self.y1 - self.y0)) / _EMS


def stage(scene: Scene, film: Film, *, by_fe: bool) -> Markup:
    """Draw the stage, with all that needs no script: the last state is shown.

    Parameters
    ----------
    scene : Scene
    film : Film
        The tube that is shown filled.
    by_fe : bool
        Whether finite elements bent it; else what the joints were chosen by did.
    """
    frame = frame_of(scene, film)
    named = f"The object {scene.design.source.file} with the actuator along its side"
    said = f"The tube is {_told(scene, film, by_fe)}. Lengths in millimetres, to scale."
    layers = [
        tag("title", named, id="stage-title"),
        tag("desc", said, id="stage-desc"),
        _hatch(frame),
        *_object(scene, frame),
        _line("rest", ring_path(drawn(scene.straight.facing), drawn(scene.straight.far))),
        *_tube(film, _colour(scene, by_fe)),
        *([_line(f"bent {_colour(scene, False)}", _ring(scene.bent))] if by_fe else []),
        *([] if scene.band is None else [_line("band", ring_path(*map(drawn, scene.band)))]),
        *_clamp(clamp_ring(scene)),
        *_profile(scene),
        *_numbers(scene, film, frame),
        *_scale_bar(frame),
    ]
    return tag(
        "svg",
        *layers,
        class_="stage",
        viewBox=f"{frame.x0:.2f} {-frame.y1:.2f} {frame.x1 - frame.x0:.2f} "
        f"{frame.y1 - frame.y0:.2f}",
        style=f"--em: {frame.em:.2f}px",
        role="img",
        aria_labelledby="stage-title stage-desc",
    )


def legend(scene: Scene, film: Film, *, by_fe: bool) -> Markup:
    """Make the legend of the stage's lines."""
    rows: list[tuple[str, str]] = [("profile", "profile to follow")]
    if scene.profile.outline is not None:
        rows.append(("silhouette", "silhouette" if scene.backdrop is not None else "outline"))
    if scene.missed:
        rows.append(("missed", "missed by more than 1 mm"))
    moved = tag("span", "tube by finite elements at ", _gauge(film))
    shown = moved if by_fe else f"tube {_told(scene, film, by_fe)}"
    rows.append((f"tube {_colour(scene, by_fe)}", shown))
    if by_fe:
        told = f"tube as the {scene.by} bends it at {scene.design.pressure_bar:.2f} bar"
        rows.append((f"bent {_colour(scene, False)}", told))
    if scene.band is not None:
        rows.append(("band", "95 % of builds, pressure set on each"))
    rows.append((f"window {_colour(scene, by_fe)}", "cuts, with the joints' numbers"))
    rows.append(("rest", "tube at rest"))
    rows.append(("clamped", "clamp"))
    items = (tag("li", _key(class_), said) for class_, said in rows)
    return tag("ul", *items, class_="legend")


def controls(film: Film) -> Markup:
    """Make the slider that inflates the tube; hidden until the script shows it."""
    last, shown = len(film.lines) - 1, film.shown
    ticks = (tag("option", value=str(k * _SUBSTEPS)) for k in range(last + 1))
    slider = tag(
        "input", type="range", id="slider", min="0", max=str(last * _SUBSTEPS), step="1",
        value=str(shown * _SUBSTEPS), list="pressures", data_substeps=str(_SUBSTEPS),
        aria_label="Pressure", aria_valuetext=f"{film.pressure_bar[shown]:.2f} bar",
    )  # fmt: skip
    return tag(
        "div",
        tag("button", "Inflate", type="button", id="play"),
        slider,
        tag("datalist", *ticks, id="pressures"),
        _gauge(film),
        id="controls",
        class_="controls",
        hidden=True,
    )


def readout(film: Film) -> Markup:
    """Make the display of pressure, angles and air of the state that is shown."""
    rows = [
        (f"{k + 1}", tag("span", signed(theta, 1, "°"), class_="theta"))
        for k, theta in enumerate(np.round(film.theta_deg[film.shown], 4).tolist())
    ]
    air = tag("span", f"{film.air_ml[film.shown]:.1f}", id="air")
    rows.append(("air", tag("span", air, " ml")))
    caption = tag("span", "At ", _gauge(film), "; angles positive toward the object")
    return tag("div", table(("Joint", "θ"), rows, caption), class_="readout")


def _gauge(film: Film) -> Markup:
    return tag("span", tag("span", f"{film.pressure_bar[film.shown]:.2f}", class_="bar"), " bar")


def frame_of(scene: Scene, film: Film) -> StageFrame:
    """Find room for all that is drawn, and a margin."""
    parts = [
        film.lines.reshape(-1, 2) * [0.01, -0.01],
        scene.profile.points,
        clamp_ring(scene),
        *(line for shape in (scene.bent, scene.straight) for line in (shape.facing, shape.far)),
    ]
    if scene.profile.outline is not None:
        parts.append(scene.profile.outline)
    points = np.concatenate(parts)
    (x0, y0), (x1, y1) = points.min(axis=0) - _MARGIN_MM, points.max(axis=0) + _MARGIN_MM
    return StageFrame(float(x0), float(y0) - 0.5 * _MARGIN_MM, float(x1), float(y1))


def _told(scene: Scene, film: Film, by_fe: bool) -> str:
    if by_fe:
        return f"by finite elements at {film.pressure_bar[film.shown]:.2f} bar"
    return f"as the {scene.by} bends it at {scene.design.pressure_bar:.2f} bar"


def _colour(scene: Scene, by_fe: bool) -> str:
    return "fe" if by_fe else "response" if scene.by == "joint response" else "formula"


def _object(scene: Scene, frame: StageFrame) -> Iterator[Markup]:
    outline = scene.profile.outline
    closed = None if outline is None else path(drawn(_simple(outline))) + "Z"
    if scene.backdrop is not None:
        yield from _picture(scene.backdrop, frame)
    elif closed is not None:
        yield _line("body", closed)
    if closed is not None:
        yield _line("halo", closed)
        yield _line("silhouette", closed)


def _picture(backdrop: Backdrop, frame: StageFrame) -> Iterator[Markup]:
    """Embed what the stage shows of the picture."""
    left, right, bottom, top = backdrop.extent
    height, width = backdrop.rgb.shape[:2]
    across, down = (right - left) / width, (top - bottom) / height  # mm of a pixel
    x = np.clip([(frame.x0 - left) / across, (frame.x1 - left) / across], 0, width)
    y = np.clip([(top - frame.y1) / down, (top - frame.y0) / down], 0, height)
    (j0, i0), (j1, i1) = (np.floor([x[0], y[0]]).astype(int), np.ceil([x[1], y[1]]).astype(int))
    if j1 <= j0 or i1 <= i0:
        return
    image = Image.fromarray(np.ascontiguousarray(backdrop.rgb[i0:i1, j0:j1]))
    image.thumbnail((_LONGEST_PX, _LONGEST_PX), Image.Resampling.LANCZOS)
    buffer = io.BytesIO()
    image.save(buffer, "JPEG", quality=_JPEG_QUALITY, optimize=True)
    data = base64.b64encode(buffer.getvalue()).decode()
    yield tag(
        "image", href=f"data:image/jpeg;base64,{data}", x=left + j0 * across,
        y=-(top - i0 * down), width=(j1 - j0) * across, height=(i1 - i0) * down,
        preserveAspectRatio="none",
    )  # fmt: skip


def _tube(film: Film, colour: str) -> Iterator[Markup]:
    """Draw the tube in its last state; the script finds what moves by its data."""
    yield tag("path", class_="halo", d=film.outline(), data_tube=True)
    yield tag("path", class_=f"tube {colour}", d=film.outline(), data_tube=True, id="tube")
    for k in range(len(film.windows)):
        yield tag("path", class_=f"window {colour}", d=film.window(k), data_window=str(k))


def _clamp(ring: FloatArray) -> Iterator[Markup]:
    """Draw the tube in its clamp (4, 2) mm, as drawings show what is fixed, and the edge x = 0."""
    yield tag("path", d=path(drawn(ring)) + "Z", fill="url(#hatch)", class_="hatched")
    yield _line("clamped", path(drawn(ring[[0, 3]])))


def _hatch(frame: StageFrame) -> Markup:
    step = 0.35 * frame.em
    pattern = tag(
        "pattern", tag("path", class_="hatch", d=f"M0,0V{step:.2f}"), id="hatch",
        width=round(step, 2), height=round(step, 2), patternUnits="userSpaceOnUse",
        patternTransform="rotate(45)",
    )  # fmt: skip
    return tag("defs", pattern)


def _profile(scene: Scene) -> Iterator[Markup]:
    profile = scene.profile
    whole = path(drawn(_simple(profile.points)))
    yield _line("halo wide", whole)
    yield _line("profile", whole)
    for start, end in scene.missed:
        within = (profile.s >= start) & (profile.s <= end)
        if within.sum() > 1:
            yield _line("missed", path(drawn(_simple(profile.points[within]))))


def _numbers(scene: Scene, film: Film, frame: StageFrame) -> Iterator[Markup]:
    """Write the joints' numbers in the middle of the tube, where nothing else is."""
    centres = [joint.centre_mm for joint in scene.design.joints]
    room = min(np.diff(centres).tolist(), default=np.inf)
    radius = min(0.75 * frame.em, 0.38 * room, 0.32 * scene.design.tube.outer_diameter_mm)
    for k, joint in enumerate(scene.design.joints):
        x, y = film.centre(k)
        badge = tag(
            "g",
            tag("circle", r=f"{radius:.2f}"),
            tag("text", f"{joint.number}", dy="0.36em", style=f"font-size: {1.25 * radius:.2f}px"),
            class_="badge",
        )
        yield tag("g", badge, transform=f"translate({x} {y})", data_joint=str(k))


def _scale_bar(frame: StageFrame) -> Iterator[Markup]:
    most = (frame.x1 - frame.x0) / 4.0
    length = max(mm for mm in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0) if mm <= max(most, 1.0))
    x, y = frame.x0 + 0.5 * _MARGIN_MM, -frame.y0 - 0.5 * _MARGIN_MM
    bar = f"M{x:.2f},{y:.2f}h{length:g}"
    yield _line("halo wide", bar)
    yield _line("scale", bar)
    yield tag(
        "text", f"{length:g} mm", x=round(x + 0.5 * length, 2), y=round(y - 0.5 * frame.em, 2),
        class_="label",
    )  # fmt: skip


def _key(class_: str) -> Markup:
    """Draw a piece of a line, or of the clamp, as it is drawn on the stage."""
    drawn = "M2,1H26V11H2Z" if class_.startswith("window") else "M1,6H27"
    parts = [_line(class_, drawn)]
    if class_ == "clamped":
        parts.append(tag("g", _line("hatched", "M0.3,2H9V4H0.3Z"), transform="scale(3)"))
    return tag("svg", *parts, viewBox="0 0 28 12", aria_hidden="true")


def _line(class_: str, d: str) -> Markup:
    return tag("path", class_=class_, d=d)


def _ring(shape: Shape) -> str:
    ring = np.concatenate([shape.facing, shape.far[::-1], shape.facing[:1]])
    return path(drawn(_simple(ring)))


def _simple(points: FloatArray) -> FloatArray:
    """Leave out points that a line does not need."""
    return np.asarray(shapely.get_coordinates(shapely.LineString(points).simplify(_FINE_MM)))
