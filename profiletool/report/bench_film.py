"""The film of a measurement: its pictures, under the predicted and the fitted tube.

All pictures are on the page, one below the other; where a script runs, it shows one at a time.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from profiletool.records.bench import Seen
from profiletool.records.units import FloatArray
from profiletool.report.bench import NAMES, BenchOutput
from profiletool.report.markup import Markup, signed, tag

_MOST_PX, _LEAST_PX = 900, 160  # of a picture's longer side
_MOST_BYTES = 1_500_000  # of all pictures together
_QUALITY = 80
_POINTS, _DOTS = 60, 150  # of a line, of all edges: at most about that many
_KINDS = (("predicted", "predicted"), ("fitted", "fitted, and its sectors"), ("edges", "edges"))


def bench_film(output: BenchOutput) -> Markup:
    """Write the pictures with their lines, and the controls that a script brings to life."""
    order = sorted(range(len(output.seen)), key=lambda k: output.seen[k].pressure_bar)
    rgbs = (output.load(k).rgb for k in order)
    sizes, jpegs = _jpegs(rgbs) if order else ([], [])
    shots = [
        _shot(output.seen[k], size, jpeg, NAMES[output.by])
        for k, size, jpeg in zip(order, sizes, jpegs, strict=True)
    ]
    return tag("div", _controls(len(shots)), *shots, id="film")


def _controls(count: int) -> Markup:
    slider = tag(
        "input", type="range", id="picture", min="0", max=str(count - 1), value=str(count - 1),
        aria_label="Picture",
    )  # fmt: skip
    boxes = [
        tag("label", tag("input", type="checkbox", value=kind, checked=True), f" {said}")
        for kind, said in _KINDS
    ]
    return tag(
        "div",
        tag("button", "Back", id="back", type="button"), slider,
        tag("button", "Next", id="next", type="button"), *boxes,
        class_="controls", id="controls", hidden=True,
    )  # fmt: skip


def _shot(one: Seen, size: tuple[int, int, float], jpeg: bytes, model: str) -> Markup:
    width, height, share = size
    lost = sum(angle.state == "lost" for angle in one.angles)
    said = f"{one.picture}, {one.pressure_bar:.2f} bar" + (f", {lost} angles lost" if lost else "")
    source = f"data:image/jpeg;base64,{base64.b64encode(jpeg).decode()}"
    drawn = tag(
        "svg",
        tag("image", href=source, width=str(width), height=str(height)),
        tag("g", *(_path(line, share) for line in one.predicted_px), class_="predicted"),
        tag(
            "g",
            *(_path(line, share) for line in (*one.outline_px, *one.sectors_px)),
            *_labels(one, share),
            class_="fitted",
        ),
        tag("g", _dots(one.edges_px, share), class_="edges"),
        viewBox=f"0 0 {width} {height}", role="img", aria_label=said,
        style=f"max-width: {width}px",
    )  # fmt: skip
    caption = f"{said}. Dashed: {model}. Blue: fitted to the orange edges."
    return tag("figure", drawn, tag("figcaption", caption), class_="shot", data_bar=said)


def _path(line: FloatArray, share: float) -> Markup:
    kept = np.unique(np.linspace(0, len(line) - 1, _POINTS).round().astype(int))
    return tag("path", d="M" + " ".join(_at(point, share) for point in line[kept]))


def _dots(px: FloatArray, share: float) -> Markup:
    some = px[:: max(1, len(px) // _DOTS)]
    return tag("path", d="".join(f"M{_at(point, share)}h0" for point in some))


def _labels(one: Seen, share: float) -> Sequence[Markup]:
    made = []
    for k, angle in enumerate(one.angles):
        x, y = share * 0.5 * (one.sectors_px[k, 1] + one.sectors_px[k + 1, 0])
        said = "lost" if angle.state == "lost" else signed(angle.theta_deg, unit="°")
        made.append(tag("text", f"{k + 1}: {said}", x=f"{x:.0f}", y=f"{y:.0f}", class_=angle.state))
    return made


def _at(point: FloatArray, share: float) -> str:
    x, y = share * (point + 0.5)
    return f"{x:.1f},{y:.1f}"


def _jpegs(rgbs: Iterable[NDArray[np.uint8]]) -> tuple[list[tuple[int, int, float]], list[bytes]]:
    """Shrink pictures until they fit on a page together: width, height and share of each."""
    first = [_shrunk(Image.fromarray(rgb), _MOST_PX) for rgb in rgbs]
    jpegs, px = [_jpeg(image) for image, _ in first], _MOST_PX
    images = [image for image, _ in first]
    while (total := sum(map(len, jpegs))) > _MOST_BYTES and px > _LEAST_PX:
        px = max(_LEAST_PX, int(0.95 * px * (_MOST_BYTES / total) ** 0.5))
        images = [_shrunk(image, px)[0] for image, _ in first]
        jpegs = [_jpeg(image) for image in images]
    sizes = [
        (image.width, image.height, share * image.width / whole.width)
        for image, (whole, share) in zip(images, first, strict=True)
    ]
    return sizes, jpegs


def _shrunk(image: Image.Image, px: int) -> tuple[Image.Image, float]:
    share = min(1.0, px / max(image.size))
    size = max(1, round(share * image.width)), max(1, round(share * image.height))
    return image.resize(size, Image.Resampling.BOX), size[0] / image.width


def _jpeg(image: Image.Image) -> bytes:
    buffer = io.BytesIO()
    image.save(buffer, "JPEG", quality=_QUALITY)
    return buffer.getvalue()
