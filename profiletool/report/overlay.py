"""The overlay: the picture with the profile, the tube and its joints drawn onto it, to scale."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke

from profiletool.profile.curve import points_at
from profiletool.profile.offset import offset_curve, offset_points
from profiletool.records.frames import Shape
from profiletool.records.units import FloatArray
from profiletool.report.overlay_panel import best_theta_deg, draw_panel
from profiletool.report.palette import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, RED, SKY, YELLOW
from profiletool.report.scene import Scene, clamp_ring

_DPI = 130
_MARGIN_MM = 12.0
_SCALE_BAR_MM = 20.0
_LABEL_MM = 8.0  # room that a label takes


def overlay_figure(scene: Scene) -> Figure:
    """Draw picture, silhouette, profile and tube to scale, with a panel of facts beside."""
    x0, x1, y0, y1 = _limits(scene)
    tall = 8.6
    wide = float(np.clip(tall * (x1 - x0) / (y1 - y0), 5.0, 13.0))
    panel = 4.6
    figure = Figure(figsize=(wide + panel, tall), dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, wide / (wide + panel), 1.0))
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal")
    axes.set_axis_off()
    _draw_picture(axes, scene)
    _draw_sectors(axes, scene)
    _draw_tube(axes, scene)
    _draw_profile(axes, scene)
    _draw_joints(axes, scene)
    _draw_scale_bar(axes, (x0, x1, y0, y1))
    side = figure.add_axes((wide / (wide + panel), 0.0, panel / (wide + panel), 1.0))
    draw_panel(side, scene)
    return figure


def draw_overlay(scene: Scene) -> bytes:
    """Draw the overlay as PNG."""
    figure, buffer = overlay_figure(scene), io.BytesIO()
    # A better level would take a quarter of a second to save a fifth of the size.
    figure.savefig(
        buffer, format="png", metadata={"Software": None}, pil_kwargs={"compress_level": 1}
    )
    return buffer.getvalue()


def _limits(scene: Scene) -> tuple[float, float, float, float]:
    parts = [
        scene.bent.facing, scene.bent.far, scene.straight.facing, scene.straight.far,
        scene.profile.points, clamp_ring(scene),
    ]  # fmt: skip
    if scene.fe is not None:
        parts += [scene.fe.facing, scene.fe.far]
    if scene.profile.outline is not None:
        parts.append(scene.profile.outline)
    points = np.concatenate(parts)
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    m = _MARGIN_MM
    return float(x0 - m), float(x1 + m), float(y0 - 1.4 * m), float(y1 + m)


def _halo(width: float = 2.5, colour: str = "white") -> list[Any]:
    return [withStroke(linewidth=width, foreground=colour)]


def _fill(axes: Any, ring: FloatArray, **style: Any) -> None:
    """Fill a polygon (N, 2) without the search for axis limits that axes.fill does."""
    axes.add_artist(Polygon(ring, closed=True, **style))


def _draw_picture(axes: Any, scene: Scene) -> None:
    outline = scene.profile.outline
    if scene.backdrop is not None:
        axes.imshow(scene.backdrop.rgb, extent=scene.backdrop.extent, alpha=0.8, zorder=0)
    elif outline is not None:
        _fill(axes, outline, color="#e9e6e0", zorder=0)
    if outline is not None:
        closed = np.vstack([outline, outline[:1]])
        axes.plot(
            *closed.T, color=YELLOW, lw=1.4, zorder=2, label="silhouette",
            path_effects=_halo(2.8, "#00000090"),
        )  # fmt: skip


def _draw_sectors(axes: Any, scene: Scene) -> None:
    """Bending sectors on the drawing: between profile and outer curve, perpendicular to them."""
    profile, diameter = scene.profile, scene.design.tube.outer_diameter_mm
    outer = offset_points(profile, diameter)
    for k, (place, joint) in enumerate(zip(scene.places, scene.design.joints, strict=True)):
        half = 0.5 * joint.openF_mm
        within = np.abs(profile.s - place) <= half
        ring = np.concatenate([profile.points[within], outer[within][::-1]])
        _fill(axes, ring, color=RED, alpha=0.16, lw=0, zorder=3)
        for edge in (np.argmax(within), len(within) - 1 - np.argmax(within[::-1])):
            axes.plot(
                *np.stack([profile.points[edge], outer[edge]]).T, color=RED, lw=0.9, ls=(0, (4, 3)),
                zorder=3, label="bending sectors" if k == 0 and edge == np.argmax(within) else None,
            )  # fmt: skip


def _draw_tube(axes: Any, scene: Scene) -> None:
    """Draw the tube at rest and bent: filled as FE bends it, else as the formula does."""
    straight, pressure = scene.straight, scene.design.pressure_bar
    axes.plot(
        *_ring(straight).T, color=GREY, lw=1.0, ls=(0, (2, 2)), zorder=4, label="tube at rest"
    )
    if scene.fe is None:
        _draw_bent(axes, scene, scene.bent, GREEN, f"tube at {pressure:.2f} bar ({scene.by})")
        return
    axes.plot(
        *_ring(scene.bent).T, color=GREEN, lw=1.3, ls=(0, (6, 2)), zorder=5,
        path_effects=_halo(2.3), label=f"tube at {pressure:.2f} bar ({scene.by})",
    )  # fmt: skip
    if scene.band is not None:
        ring = np.concatenate([scene.band[0], scene.band[1][::-1]])
        label = "95 % of builds, pressure set"
        _fill(axes, ring, color=ORANGE, alpha=0.45, lw=0, zorder=5, label=label)
    _draw_bent(axes, scene, scene.fe, PURPLE, f"tube at {pressure:.2f} bar (finite elements)")


def _draw_bent(axes: Any, scene: Scene, bent: Shape, colour: str, label: str) -> None:
    _fill(axes, _ring(bent), color=colour, alpha=0.16, lw=0, zorder=4)
    axes.plot(*_ring(bent).T, color=colour, lw=1.8, zorder=5, path_effects=_halo(3.0), label=label)
    for bend in scene.bends:
        within = np.abs(bent.along - bend.centre_mm) <= 0.5 * bend.openF_mm + 1e-9
        window = np.concatenate([bent.facing[within], bent.far[within][::-1]])
        named = "cuts, with their angles" if bend is scene.bends[0] else None
        _fill(axes, window, facecolor=colour, alpha=0.30, lw=0, zorder=4, label=named)
    _fill(
        axes, clamp_ring(scene), facecolor="none", edgecolor=INK, hatch="////", lw=0.8, alpha=0.45,
        zorder=5, label="clamp",
    )  # fmt: skip


def _ring(shape: Shape) -> FloatArray:
    return np.concatenate([shape.facing, shape.far[::-1], shape.facing[:1]])


def _draw_profile(axes: Any, scene: Scene) -> None:
    profile, diameter = scene.profile, scene.design.tube.outer_diameter_mm
    axes.plot(
        *offset_curve(profile, diameter).T, color=BLUE, lw=1.3, zorder=4,
        label=f"outer curve, {diameter:g} mm off",
    )  # fmt: skip
    axes.plot(
        *offset_curve(profile, 0.5 * diameter).T, color=BLUE, lw=1.0, ls=(0, (8, 2, 1, 2)),
        zorder=4, label="axis curve",
    )  # fmt: skip
    axes.plot(
        *profile.points.T, color=INK, lw=2.2, zorder=6, path_effects=_halo(4.2),
        label="profile to follow",
    )  # fmt: skip
    for k, (start, end) in enumerate(scene.missed):
        within = (profile.s >= start) & (profile.s <= end)
        axes.plot(
            *profile.points[within].T, color="#d00000", lw=3.4, zorder=8, solid_capstyle="butt",
            label="missed by more than 1 mm" if k == 0 else None,
        )  # fmt: skip
    bridged = np.where(profile.bridged[:, None], profile.points, np.nan)
    if profile.bridged.any():
        axes.plot(*bridged.T, color=SKY, lw=2.2, zorder=7, label="grooves bridged")


def _draw_joints(axes: Any, scene: Scene) -> None:
    """Write every joint's number beside it, and its angle onto its cut."""
    profile, diameter = scene.profile, scene.design.tube.outer_diameter_mm
    badges = [offset_points(profile, diameter * k) for k in (1.3, 1.65, 0.5, 0.8, 2.0)]
    bent = scene.bent if scene.fe is None else scene.fe
    middles = points_at(
        np.array([joint.centre_mm for joint in scene.design.joints]), bent.along, bent.axis
    )
    taken: list[FloatArray] = list(middles)
    for place, middle, joint in zip(scene.places, middles, scene.design.joints, strict=True):
        axes.text(
            *middle, f"{joint.signed(best_theta_deg(joint)):.0f}°", color=INK, fontsize=10.5,
            weight="bold", ha="center", va="center", zorder=9, path_effects=_halo(3.0),
        )  # fmt: skip
        at = min(int(np.searchsorted(profile.s, place)), len(profile.s) - 1)
        axes.text(
            *_free_place([curve[at] for curve in badges], taken), str(joint.number),
            color="white", fontsize=11, weight="bold", ha="center", va="center", zorder=9,
            bbox={"boxstyle": "circle,pad=0.28", "fc": RED, "ec": "white", "lw": 1.2},
        )  # fmt: skip


def _free_place(places: Sequence[FloatArray], taken: list[FloatArray]) -> FloatArray:
    """Take the first place that no label has yet, or the one farthest from all labels."""
    room = [min((float(np.hypot(*(p - q))) for q in taken), default=np.inf) for p in places]
    free = [k for k, distance in enumerate(room) if distance >= _LABEL_MM]
    chosen = places[free[0] if free else int(np.argmax(room))]
    taken.append(chosen)
    return chosen


def _draw_scale_bar(axes: Any, limits: tuple[float, float, float, float]) -> None:
    x, y = limits[0] + 6.0, limits[2] + 6.0
    axes.plot(
        [x, x + _SCALE_BAR_MM], [y, y], color=INK, lw=3.5, solid_capstyle="butt", zorder=9,
        path_effects=_halo(5.5),
    )  # fmt: skip
    axes.text(
        x + _SCALE_BAR_MM / 2.0, y + 1.8, f"{_SCALE_BAR_MM:g} mm", ha="center", fontsize=10,
        color=INK, zorder=9, path_effects=_halo(3.0),
    )  # fmt: skip
