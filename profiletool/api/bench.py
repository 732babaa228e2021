"""A built actuator from Python: its angles measured in pictures, for `calibrate`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from profiletool.errors import UsageError
from profiletool.records.bench import Seen
from profiletool.records.design import Design
from profiletool.records.picture import Picture
from profiletool.records.setting import AngleReading
from profiletool.subject.tube.family import family_of
from profiletool.subject.tube.series import measure_series, timed
from profiletool.subject.tube.views import Looked, picture_of
from profiletool.verify.predicted import predicted_by_fe, predicted_by_response
from profiletool.verify.setting import MOST_BAR

Shot = str | PathLike[str] | NDArray[np.uint8] | Picture


def measure_pictures(
    design: Design,
    pictures: Sequence[Shot],
    pressures_bar: Sequence[float],
    *,
    times_s: Sequence[float] | None = None,
    mm_per_px: float | None = None,
    fe: bool = True,
    progress: Callable[[float], None] | None = None,
) -> tuple[Seen, ...]:
    """Measure the joints' angles of an inflated actuator in pictures.

    Parameters
    ----------
    design : Design
        What it was built from.
    pictures : sequence of path, (H, W, 3) uint8 in RGB, or Picture
    pressures_bar : sequence of float
        One for each picture, bar; rising where no times are given.
    times_s : sequence of float, optional
        One for each picture, s, rising: `calibrate` finds relaxation where a pressure was held.
    mm_per_px : float, optional
        Where no printed sheet tells.
    fe : bool
        Whether finite elements predict the tube, or the joint response: quicker, and less true.
    progress : callable, optional
        Takes the share of the pictures that is done.

    Returns
    -------
    tuple of Seen
        In the order of the pictures.

    Raises
    ------
    UsageError, UnreadableInput, NoScale, NoObject, NotVerified
    """
    bars = [float(bar) for bar in pressures_bar]
    times = None if times_s is None else [float(time) for time in times_s]
    if len(bars) != len(pictures) or (times is None and not _rise(bars)):
        raise UsageError("`pressures_bar` holds one pressure for each picture, rising")
    if times is not None and not (len(times) == len(pictures) and _rise(times)):
        raise UsageError("times_s holds one time for each picture, rising")
    if not bars or not (min(bars) >= 0.0 and 0.0 < max(bars) <= MOST_BAR):
        raise UsageError(
            f"`pressures_bar` must be 0 to {MOST_BAR:g} bar, not all 0: an actuator at rest tells "
            "nothing"
        )
    predicted = (predicted_by_fe if fe else predicted_by_response)(design, max(bars))
    names = [
        Path(one).name if isinstance(one, str | PathLike) else f"picture {k}"
        for k, one in enumerate(pictures, start=1)
    ]
    looked = Looked(mm_per_px)
    family = family_of(predicted)
    seen = measure_series(family, names, bars, lambda k: _picture(pictures[k]), looked, progress)
    return seen if times is None else timed(seen, times)


def _rise(values: Sequence[float]) -> bool:
    return all(a < b for a, b in pairwise(values))


def readings_of(seen: Sequence[Seen]) -> tuple[AngleReading, ...]:
    """Take the angles that ``seen`` holds, but those that are lost, as readings."""
    return tuple(
        AngleReading(one.pressure_bar, joint, angle.theta_deg, angle.sigma_deg, one.time_s)
        for one in seen
        for joint, angle in enumerate(one.angles, start=1)
        if angle.state != "lost"
    )


def _picture(given: Shot) -> Picture:
    """Read a picture, or take an array for one.

    Raises
    ------
    UsageError, UnreadableInput
    """
    if isinstance(given, Picture):
        return given
    if isinstance(given, str | PathLike):
        return picture_of(Path(given))
    array = np.asarray(given)
    if array.dtype != np.uint8 or array.ndim != 3 or array.shape[2] != 3:
        raise UsageError(
            f"a picture is an array (H, W, 3) of uint8, not {array.shape} {array.dtype}"
        )
    return Picture(array, None, None, "array")
