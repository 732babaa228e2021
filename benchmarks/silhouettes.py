"""Accuracy of silhouettes, on pictures whose true mask is known.

Cut-outs of ../shared/photos are laid on grounds that are drawn, and photographed: shadow, uneven
light, blur, noise, JPEG. A refusal is counted apart; "right" means an overlap (IoU) of at least
0.95 with the true mask. The second table tells what a confidence is worth; with --held, a last
one tells what becomes of objects in a hand, which are to be refused.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from _common import machine, table
from _composites import CUT_OUTS, GROUNDS, PHOTOS, composite

from profiletool.errors import NoObject, Unsure
from profiletool.image.find.masks import overlap
from profiletool.image.find.silhouette import find_silhouette
from profiletool.image.load import load_picture
from profiletool.records.picture import Picture

_RIGHT, _GOOD, _WRONG = 0.95, 0.97, 0.9
_SKINS = {
    "pale": (236.0, 192.0, 170.0), "tan": (205.0, 150.0, 120.0), "brown": (150.0, 100.0, 72.0),
    "dark": (96.0, 62.0, 46.0),
}  # fmt: skip


@dataclass(frozen=True)
class Outcome:
    """What came of one picture; a refusal without candidates has no overlap and confidence 0."""

    name: str
    ground: str
    refused: bool
    iou: float
    confidence: float
    method: str
    seconds: float


def outcome(name: str, ground: str, picture: Picture, truth: np.ndarray) -> Outcome:
    """Find the object of a picture and compare; a refused one by its best candidate."""
    begun = time.process_time()
    refused, iou, confidence, method = True, 0.0, 0.0, "none"
    try:
        found = find_silhouette(picture)
        refused, iou = False, overlap(found.mask, truth)
        confidence, method = found.confidence, found.method
    except Unsure as unsure:
        mask, confidence, method = unsure.candidates[0]
        iou = overlap(mask, truth)
    except NoObject:
        pass
    return Outcome(name, ground, refused, iou, confidence, method, time.process_time() - begun)


def outcomes(grounds: Sequence[str], names: Sequence[str], seeds: int) -> Iterator[Outcome]:
    """Go through all pictures."""
    for ground in grounds:
        for seed in range(seeds):
            for name in names:
                made = composite(name, ground, seed)
                yield outcome(name, ground, made.picture, made.truth)


def row(title: str, made: Sequence[Outcome]) -> tuple[str, ...]:
    """One line of the table."""
    kept = np.array([one.iou for one in made if not one.refused])
    refused = [one for one in made if one.refused]
    right = sum(one.iou >= _RIGHT for one in refused)
    numbers = (
        (f"{np.median(kept):.3f}", f"{np.quantile(kept, 0.1):.3f}", f"{kept.min():.3f}")
        if len(kept)
        else ("-", "-", "-")
    )
    seconds = np.median([one.seconds for one in made])
    return (title, str(len(made)), *numbers, str(len(refused)), str(right), f"{seconds:.2f}")


def calibration(made: Sequence[Outcome]) -> str:
    """Say what share of the masks of a confidence is right."""
    rows = []
    for low in (0.0, 0.25, 0.5, 0.7, 0.8, 0.9, 0.95):
        high = {0.0: 0.25, 0.25: 0.5, 0.5: 0.7, 0.7: 0.8, 0.8: 0.9, 0.9: 0.95}.get(low, 1.01)
        iou = np.array([one.iou for one in made if low <= one.confidence < high])
        shares = [f"{100 * (iou >= level).mean():.0f} %" if len(iou) else "-"
                  for level in (_GOOD, _RIGHT, _WRONG)]  # fmt: skip
        rows.append((f"{low:.2f} to {min(high, 1.0):.2f}", str(len(iou)), *shares))
    return table(("confidence", "pictures", "IoU >= 0.97", ">= 0.95", ">= 0.90"), rows)


def believed(made: Sequence[Outcome]) -> str:
    """Say how many of the good and of the wrong masks are above the threshold."""
    good = [not one.refused for one in made if one.iou >= _GOOD]
    wrong = [not one.refused for one in made if one.iou < _WRONG]
    return (
        f"believed: {sum(good)} of {len(good)} masks with IoU >= {_GOOD}, "
        f"{sum(wrong)} of {len(wrong)} with IoU < {_WRONG}; "
        f"area under the curve {_area_under(made):.3f}"
    )


def _area_under(made: Sequence[Outcome]) -> float:
    """Chance that a right mask has more confidence than one that is not."""
    right = np.array([one.confidence for one in made if one.iou >= _RIGHT])
    other = np.array([one.confidence for one in made if one.iou < _RIGHT])
    if not len(right) or not len(other):
        return float("nan")
    return float((right[:, None] > other).mean() + 0.5 * (right[:, None] == other).mean())


def held(grounds: Sequence[str], names: Sequence[str]) -> str:
    """Say how many objects in a hand are refused, and how many others are wrong."""
    rows = []
    for skin, colour in _SKINS.items():
        made = []
        for ground in grounds:
            for name in names:
                shown = composite(name, ground, skin=colour)
                made.append(outcome(name, ground, shown.picture, shown.truth))
        kept = [one for one in made if not one.refused]
        wrong = [f"{one.name} on {one.ground}" for one in kept if one.iou < _RIGHT]
        rows.append((skin, str(len(made)), str(len(made) - len(kept)), ", ".join(wrong) or "none"))
    return table(("hand", "pictures", "refused", "wrong"), rows)


def main() -> None:
    """Go through the pictures and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=1, help="pictures of each cut-out and ground")
    parser.add_argument("--ground", action="append", choices=list(GROUNDS))
    parser.add_argument("--list", action="store_true", help="every picture that is off or refused")
    parser.add_argument("--held", action="store_true", help="objects in a hand too")
    parser.add_argument("--only", action="append", choices=CUT_OUTS, help="this cut-out alone")
    arguments = parser.parse_args()
    print(machine(), flush=True)
    grounds = arguments.ground or list(GROUNDS)
    names = arguments.only or CUT_OUTS
    made = list(outcomes(grounds, names, arguments.seeds))
    rows = [row(ground, [one for one in made if one.ground == ground]) for ground in grounds]
    rows.append(row("all", made))
    head = ("", "pictures", "median IoU", "worst decile", "worst", "refused", "of them right", "s")
    print(table(head, rows), "", calibration(made), "", believed(made), sep="\n")
    if arguments.list:
        for one in made:
            if one.refused or one.iou < _RIGHT:
                print(f"{one.name} on {one.ground}: {'refused, ' if one.refused else ''}"
                      f"{one.iou:.3f} ({one.confidence:.2f}, {one.method})")  # fmt: skip
    if arguments.held:
        print("", held(grounds, names), "", sep="\n")
    truth = load_picture(PHOTOS / "bulb_mask.png").rgb[..., 0] > 127
    for ground in ("white", "grey"):
        one = outcome("bulb", ground, load_picture(PHOTOS / f"bulb_on_{ground}.jpg"), truth)
        print(f"bulb_on_{ground}: IoU {one.iou:.4f}, confidence {one.confidence:.2f}")


if __name__ == "__main__":
    main()
