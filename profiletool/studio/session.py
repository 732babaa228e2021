"""The session: what was put in and what was made, kept in a work folder."""

from __future__ import annotations

import json
import re
import threading
import time
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from profiletool.errors import ProfiletoolError, UnreadableInput, UsageError
from profiletool.files.read import check_file
from profiletool.files.write import write_file, write_folder
from profiletool.records.edit import edit_of
from profiletool.studio.form import checked, to_toml
from profiletool.studio.job import Job, Running, Version
from profiletool.studio.state import KEPT, as_json, restored
from profiletool.studio.worker import Worker

_LOOK = ("box", "point", "mask")  # options that are about one picture
_SCALE = ("height_mm", "width_mm", "mm_per_px", "marker_mm")
_MOST_BYTES = 50_000_000
_NAME = re.compile(r"[^\W_][\w .,+()-]{0,99}")
_MADE = re.compile(r"session\.json|\d+\..*|(photo|front)_.*|mask_\d+\.png", re.IGNORECASE)


class Session:
    """The state, the worker, and what the page may do with both; for use from any thread.

    Parameters
    ----------
    folder : Path
        The work folder; what an earlier session left there goes on.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._lock = threading.RLock()
        self.state = restored(folder)
        self.revision = 0
        self.running: Running | None = None
        self.found: Any = None
        self.found_revision = 0
        self.said = ""
        self._worker = Worker(folder, self._hear)
        self._quick = Worker(folder, self._hear_early, patient=True)
        self.find()
        self._warm()

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *error: object) -> None:
        self._worker.close()
        self._quick.close()

    def open(self, file: Path) -> None:
        """Take a picture, a drawing or a design.json from the disk.

        Raises
        ------
        ProfiletoolError
        """
        file = file / "design.json" if file.is_dir() else file
        try:
            check_file(file, _MOST_BYTES, "a picture or a design")
        except UnreadableInput as error:
            raise UnreadableInput(f"{file}: {error}") from None
        if file.suffix.lower() == ".json":
            self._open_design(file)
        else:
            self.put(file.name, file.read_bytes())

    def put(self, name: str, data: bytes) -> None:
        """Take a picture or drawing; where it is the one that is there, all stays as it is.

        Raises
        ------
        ProfiletoolError
        """
        if not _NAME.fullmatch(name) or _MADE.fullmatch(name):
            raise UsageError("a picture's name has letters, digits, spaces and . - _ + ( ) alone")
        place = self.folder / name
        with self._lock:
            if name == self.state.picture and place.is_file() and place.read_bytes() == data:
                self.find()
                return
            write_file(place, data, force=True)
            for prefix in ("photo", "front"):
                (self.folder / f"{prefix}_{name}.jpg").unlink(missing_ok=True)
            kept = {k: v for k, v in self.state.values.items() if k not in (*_LOOK, *_SCALE)}
            self._keep(picture=name, values=kept, current=None)
            self.find()

    def set(self, values: Any) -> None:
        """Take options by field name, all of them.

        Raises
        ------
        UsageError
        """
        taken = checked(values)
        with self._lock:
            again = any(
                taken.get(name) != self.state.values.get(name)
                for name in {*taken, *self.state.values} - {"start_pct", "end_pct"}
            )
            self._keep(values=taken)
            if again or self.found is None:
                self.find()

    def find(self) -> None:
        """Find the object again."""
        with self._lock:
            if self.state.picture is not None:
                self._begin(Job("find", 0, self.state.picture, self.state.values), None)

    def design(self) -> None:
        """Begin a design of the picture with the options as they are.

        Raises
        ------
        UsageError
        """
        with self._lock:
            if self.state.picture is None:
                raise UsageError("there is no picture yet")
            number = self._next()
            toml = f"{number}.toml"
            write_file(self.folder / toml, to_toml(self.state.values).encode(), force=True)
            made = Version(number, None, "design", (self.state.picture, "--config", toml))
            self._begin(Job("design", number, self.state.picture, self.state.values), made)

    def change(self, edits: Sequence[str], pressure_bar: float | None, base: int) -> None:
        """Begin a change by hand of a version.

        Raises
        ------
        UsageError
        """
        texts = tuple(str(edit_of(text)) for text in edits)
        words = [word for text in texts for word in ("--change", text)]
        if pressure_bar is not None:
            words += ["--pressure", repr(pressure_bar)]
        self._again("edit", tuple(words), base, edits=texts, pressure_bar=pressure_bar)

    def refine(self) -> None:
        """Begin a correction of the current design by finite elements."""
        self._again("refine", ())

    def _again(
        self, kind: str, words: tuple[str, ...], number: int | None = None, **asked: Any
    ) -> None:
        with self._lock:
            base, number = self.version(number), self._next()
            job = Job(kind, number, f"{base.number}/design.json", {}, **asked)
            self._begin(job, Version(number, base.number, kind, words))
            if kind == "edit" and self.running is not None:
                early = self._quick.begin(replace(job, kind="near"))
                self.running = replace(self.running, early=early)

    def _open_design(self, file: Path) -> None:
        beside = [path for path in (file, file.with_name("shape.csv")) if path.is_file()]
        with self._lock:
            if self._is_given(file):
                return
            number = self._next()
            given = f"{number}.given"
            files = {"design.json": file.read_bytes()}
            files |= {path.name: path.read_bytes() for path in beside[1:]}
            write_folder(self.folder / given, files, force=True)
            self._keep(picture=None, values={}, current=None)
            job = Job("report", number, f"{given}/design.json", {})
            self._begin(job, Version(number, None, "report", (f"{given}/design.json",)))

    def _is_given(self, file: Path) -> bool:
        """Whether the current version began with this very design."""
        if self.state.current is None:
            return False
        given = self.folder / f"{self.line_of(self.version())[0].number}.given" / "design.json"
        return given.is_file() and given.read_bytes() == file.read_bytes()

    def cancel(self) -> None:
        """End the job that runs; what was made before stays."""
        with self._lock:
            if self.running is not None:
                self._worker.cancel()
                self.running = None
                self._changed("stopped: nothing was written")

    def go(self, number: int) -> None:
        """Make another version the current one.

        Raises
        ------
        UsageError
        """
        with self._lock:
            self.version(number)
            self._keep(current=number)

    def version(self, number: int | None = None) -> Version:
        """Give a version, by default the current one.

        Raises
        ------
        UsageError
        """
        with self._lock:
            wanted = self.state.current if number is None else number
            for version in self.state.versions:
                if version.number == wanted:
                    return version
        raise UsageError("there is no design yet" if number is None else f"no version {number}")

    def place(self, number: int | None = None) -> Path:
        """Give the folder of a version, by default the current one's."""
        return self.folder / str(self.version(number).number)

    def line_of(self, version: Version) -> tuple[Version, ...]:
        """Give the versions that a version was made from, the first one first, itself last."""
        if version.base is None:
            return (version,)
        return (*self.line_of(self.version(version.base)), version)

    # --- within ---------------------------------------------------------------------------

    def _next(self) -> int:
        return max((version.number for version in self.state.versions), default=0) + 1

    def _begin(self, job: Job, makes: Version | None) -> None:
        self.running = Running(self._worker.begin(job), job, makes, time.monotonic())
        self._changed("")

    def _hear(self, ticket: int, what: str, value: Any) -> None:
        with self._lock:
            running = self.running
            if running is None or running.ticket != ticket:
                return
            if what == "share":
                self.running = replace(running, share=float(value))
            elif what == "line":
                self.running = replace(running, line=value)
            else:
                self.running = None
                self._ended(running, value if what == "done" else None)
                self._changed("" if what == "done" else value)
            self.revision += 1

    def _hear_early(self, ticket: int, what: str, value: Any) -> None:
        with self._lock:
            if what == "done" and self.running is not None and self.running.early == ticket:
                self.running = replace(self.running, near=value)
                self.revision += 1

    def _warm(self) -> None:
        """Let the quick runs have a state to begin from."""
        if self.state.current is not None:
            self._quick.begin(Job("near", 0, f"{self.state.current}/design.json", {}))

    def _ended(self, running: Running, view: Any) -> None:
        version = running.makes
        if running.job.kind == "find":
            self.found, self.found_revision = view, self.found_revision + 1
        if version is None or view is None:
            return
        if version.base is not None:
            before = (self.folder / f"{version.base}.json").read_bytes()
            view |= {"subject": json.loads(before).get("subject")}
        try:
            write_file(self.folder / f"{version.number}.json", as_json(view), force=True)
            self._keep(versions=(*self.state.versions, version), current=version.number)
            if version.kind != "edit":
                self._warm()
        except ProfiletoolError as error:
            self.said = str(error)

    def _keep(self, **changes: Any) -> None:
        self.state = replace(self.state, **changes)
        write_file(self.folder / KEPT, as_json(asdict(self.state)), force=True)
        self.revision += 1

    def _changed(self, said: str) -> None:
        self.said = said
        self.revision += 1
