"""Accuracy of silhouettes on photographs with a true mask, against cv2.grabCut from a rectangle.

Each folder given is a set: NAME.png (or .jpg) with NAME_mask.png, white where the object is. A
refusal is counted apart. "wrong" is the share of the accepted below an overlap (IoU) of 0.8, and
"good" in the second table the share within 5 % of the true area's outline, an IoU of 0.95.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from _common import machine, table
from numpy.typing import NDArray

from profiletool.errors import NoObject, Unsure
from profiletool.image.find.hint import Hint
from profiletool.image.find.masks import overlap
from profiletool.image.find.silhouette import find_silhouette
from profiletool.image.load import load_picture

_WRONG, _NEAR = 0.8, 0.05
_BOX_GROWN = 0.03
_BINS = (0.0, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)


@dataclass(frozen=True)
class Outcome:
    """What came of one picture."""

    name: str
    accepted: bool
    iou: float
    area: float
    confidence: float
    method: str
    seconds: float
    grabcut: float


def hint_of(kind: str, truth: NDArray[np.bool_]) -> Hint:
    """Give what a user would say of a true mask: nothing, its box grown a little, its middle."""
    if kind == "box":
        height, width = truth.shape
        x, y, w, h = cv2.boundingRect(truth.view(np.uint8))
        left, top = max(0, x - round(_BOX_GROWN * w)), max(0, y - round(_BOX_GROWN * h))
        right = min(width, x + w + round(_BOX_GROWN * w))
        bottom = min(height, y + h + round(_BOX_GROWN * h))
        return Hint(box=(left, top, right - left, bottom - top))
    if kind == "point":
        depth = cv2.distanceTransform(np.pad(truth, 1).view(np.uint8), cv2.DIST_L2, 5)[1:-1, 1:-1]
        row, column = np.unravel_index(int(depth.argmax()), depth.shape)
        return Hint(point=(float(column), float(row)))
    return Hint()


def from_rectangle(rgb: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Three lines of OpenCV: cv2.grabCut from a rectangle of 80 % of the picture."""
    height, width = rgb.shape[:2]
    labels = np.zeros((height, width), np.uint8)
    rectangle = width // 10, height // 10, width - width // 5, height - height // 5
    cv2.setRNGSeed(0)
    bgr = np.ascontiguousarray(rgb[..., ::-1])
    models = np.zeros((1, 65)), np.zeros((1, 65))
    cv2.grabCut(bgr, labels, rectangle, *models, 5, cv2.GC_INIT_WITH_RECT)
    return np.asarray((labels == 1) | (labels == 3))


def outcome(file: Path, truth: NDArray[np.bool_], kind: str, compare: bool) -> Outcome:
    """Find the object of a picture and compare; a refused one by its best candidate."""
    picture = load_picture(file)
    begun = time.process_time()
    accepted, mask, confidence, method = False, np.zeros(truth.shape, bool), 0.0, "none"
    try:
        found = find_silhouette(picture, (), hint_of(kind, truth))
        accepted, mask = not found.touches & {"top", "left"}, found.mask
        confidence, method = found.confidence, found.method
    except Unsure as unsure:
        mask, confidence, method = unsure.candidates[0]
    except NoObject as refused:
        method = str(refused)
    seconds = time.process_time() - begun
    rival = overlap(from_rectangle(picture.rgb), truth) if compare else float("nan")
    area = abs(float(mask.sum()) / float(truth.sum()) - 1.0)
    return Outcome(
        str(file), accepted, overlap(mask, truth), area, confidence, method, seconds, rival
    )


def outcomes(folder: Path, kind: str, compare: bool, every: int = 1) -> Iterator[Outcome]:
    """Go through a folder."""
    for mask in sorted(folder.glob("*_mask.png"))[::every]:
        stem = mask.name.removesuffix("_mask.png")
        file = next(f for f in folder.glob(f"{stem}.*") if f.suffix in (".png", ".jpg"))
        yield outcome(file, load_picture(mask).rgb[..., 0] > 127, kind, compare)


def row(title: str, made: Sequence[Outcome]) -> tuple[str, ...]:
    """One line of the table."""
    kept = np.array([one.iou for one in made if one.accepted])
    numbers = ["-"] * 3
    if len(kept):
        wrong = f"{100 * (kept < _WRONG).mean():.1f} %"
        numbers = [f"{np.median(kept):.3f}", f"{np.quantile(kept, 0.1):.3f}", wrong]
    rival = np.array([one.grabcut for one in made])
    seconds = np.median([one.seconds for one in made])
    return (
        title,
        str(len(made)),
        f"{100 * len(kept) / len(made):.0f} %",
        *numbers,
        f"{np.median(rival):.3f}",
        f"{np.quantile(rival, 0.1):.3f}",
        f"{100 * (rival < _WRONG).mean():.0f} %",
        f"{seconds:.2f}",
    )


def calibration(made: Sequence[Outcome]) -> str:
    """Say what a confidence is worth."""
    rows = []
    for low, high in zip(_BINS, (*_BINS[1:], 1.01), strict=True):
        ones = [one for one in made if low <= one.confidence < high and one.confidence > 0.0]
        near = [one.area < _NEAR and one.iou >= 1.0 - 2.0 * _NEAR for one in ones]
        stated = [one.confidence for one in ones]
        share = f"{100 * np.mean(near):.0f} %" if ones else "-"
        mean = f"{np.mean(stated):.2f}" if ones else "-"
        rows.append((f"{low:.2f} to {min(high, 1.0):.2f}", str(len(ones)), mean, share))
    return table(("confidence", "pictures", "stated", "within 5 % of the area"), rows)


def main() -> None:
    """Go through the folders and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--hint", choices=("none", "box", "point"), default="none")
    parser.add_argument("--every", type=int, default=1, help="look at every so many only")
    parser.add_argument("--list", action="store_true", help="every picture that is off or refused")
    parser.add_argument("--no-grabcut", action="store_true", help="leave out the comparison")
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    print(machine(), flush=True)
    head = ("", "pictures", "accepted", "median IoU", "worst decile", "wrong",
            "grabCut: median", "worst decile", "wrong", "s")  # fmt: skip
    rows, made = [], []
    for folder in arguments.folders:
        found = list(outcomes(folder, arguments.hint, not arguments.no_grabcut, arguments.every))
        rows.append(row(folder.name, found))
        made += found
    rows.append(row("all", made))
    print(table(head, rows), "", calibration(made), sep="\n")
    if arguments.list:
        for one in made:
            if not one.accepted or one.iou < 1.0 - _NEAR:
                print(
                    f"{one.name}: {'' if one.accepted else 'refused, '}{one.iou:.3f} "
                    f"({one.confidence:.2f}, {one.method}; grabCut {one.grabcut:.3f})"
                )


if __name__ == "__main__":
    main()
