"""The jobs of the studio: each reads what it needs from the work folder, and writes it there."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from profiletool import api
from profiletool.errors import NoScale, ProfiletoolError, Unsure
from profiletool.files.write import write_folder
from profiletool.records.edit import Edit, edit_of
from profiletool.records.picture import Picture
from profiletool.records.request import Request, ScaleRequest
from profiletool.report.outputs import files_of
from profiletool.report.view import View, design_view
from profiletool.studio.form import in_words
from profiletool.studio.job import Job
from profiletool.studio.preview import by_fe
from profiletool.studio.view import outline_of, save_picture, subject_view
from profiletool.subject.find import Subject, source_of
from profiletool.verify.near import NearBench

_GUESSED_MM = 150.0  # of a picture's longer side, to draw an object whose size is not told yet


Say = Callable[[str], None]
Progress = Callable[[float], None]


class Bench:
    """What does jobs, in the current folder; it keeps the last state of finite elements."""

    def __init__(self) -> None:
        self._near = NearBench()

    def done(self, job: Job, say: Say, progress: Progress) -> View:
        """Do a job; give what the page shows.

        Parameters
        ----------
        job : Job
        say, progress : callable
            Take a line of progress, and the share that is done.

        Raises
        ------
        ProfiletoolError
        """
        if job.kind == "find":
            return _found(job, say)
        if job.kind == "near":
            return by_fe(Path(job.file), _edits(job), self._near)
        if job.kind == "design":
            result = api.design(_request(job), say=say, progress=progress)
            view = {**design_view(result), "subject": _subject(job.file, result.subject)}
        else:
            refine = job.kind == "refine"
            result = api.design_again(
                job.file, edits=_edits(job), refine=refine, say=say, progress=progress
            )
            view = design_view(result)
        view["notes"] = [in_words(text) for text in view["notes"]]
        say("the files")
        write_folder(Path(str(job.number)), files_of(result), force=True)
        return view

    def prepare(self) -> None:
        """Get ready for the next job, while there is none."""
        self._near.prepare()


def _edits(job: Job) -> list[Edit]:
    edits = [edit_of(text) for text in job.edits]
    return edits if job.pressure_bar is None else [*edits, Edit(pressure_bar=job.pressure_bar)]


def _request(job: Job) -> Request:
    return api.request_for(job.file, **job.values)


def _subject(file: str, subject: Subject) -> View:
    """Show the object of a file, with the picture that it was taken from."""
    picture = subject.picture
    return subject_view(subject, None if picture is None else _shown(file, picture))


def _shown(file: str, picture: Picture) -> str:
    """Save the picture that a subject was taken from: a photograph, or its frontal view."""
    photo, rgb = source_of(Request(Path(file))), picture.rgb
    same = isinstance(photo, Picture) and np.array_equal(photo.rgb, rgb)
    name = f"{'photo' if same else 'front'}_{Path(file).name}.jpg"
    save_picture(rgb, Path(name))
    return name


# --- finding ----------------------------------------------------------------------------------


def _found(job: Job, say: Say) -> View:
    request = replace(_request(job), start_pct=0.0, end_pct=100.0)
    view: View = {"photo": None, "error": None, "candidates": [], "drawing": True}
    with contextlib.suppress(ProfiletoolError):  # the finder will tell
        source = source_of(request)
        if isinstance(source, Picture):
            name = f"photo_{request.file.name}.jpg"
            save_picture(source.rgb, Path(name))
            height, width = source.rgb.shape[:2]
            view |= {"photo": {"file": name, "px": [width, height]}, "drawing": False}
    told: list[str] = []

    def hear(line: str) -> None:
        told.append(in_words(line))
        say(line)

    try:
        return view | _seen(request, hear) | {"sized": True, "told": told}
    except NoScale as error:
        view["error"] = in_words(str(error))
        longer = max(view["photo"]["px"]) if view["photo"] else 1000.0
        guessed = ScaleRequest(mm_per_px=_GUESSED_MM / longer)
        with contextlib.suppress(ProfiletoolError):
            return view | _seen(replace(request, scale=guessed), hear) | {"sized": False}
    except Unsure as unsure:
        view["error"] = in_words(str(unsure))
        view["candidates"] = [
            _candidate(k, mask, f"{method}, {100.0 * sure:.0f} %")
            for k, (mask, sure, method) in enumerate(unsure.candidates)
        ]
    except ProfiletoolError as error:
        view["error"] = in_words(str(error))
    return view


def _seen(request: Request, say: Say) -> View:
    return _subject(str(request.file), api.find_subject(request, say=say))


def _candidate(number: int, mask: np.ndarray[Any, Any], said: str) -> View:
    """Keep the mask of a candidate, which the user may choose."""
    name = f"mask_{number}.png"
    Image.fromarray(mask).save(name, "PNG", compress_level=1)
    return {"mask": name, "outline": outline_of(mask), "said": said}
