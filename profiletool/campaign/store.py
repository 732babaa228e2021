"""The store of finished runs: a folder with one file for each, under its key."""

from __future__ import annotations

import contextlib
import os
import time
import uuid
from pathlib import Path
from typing import Generic

import platformdirs

from profiletool.campaign.kind import OutcomeT, RunKind, TaskT
from profiletool.errors import OutputError

FOLDER_VARIABLE = "PROFILETOOL_RUNS"
_TEMPORARY = ".part"
_STALE_SECONDS = 86400.0


class Store(Generic[TaskT, OutcomeT]):
    """Finished runs of one kind; any number of processes may share one folder, also at once.

    Parameters
    ----------
    folder : Path
        Made when the first run is kept. Runs of other kinds may lie in it too.
    kind : RunKind
    """

    def __init__(self, folder: Path, kind: RunKind[TaskT, OutcomeT]) -> None:
        self.folder = folder
        self.kind = kind

    def get(self, key: str) -> OutcomeT | None:
        """Read the outcome of a run; None where there is none, or its file is damaged."""
        try:
            return self.kind.read(self._file(key).read_bytes())
        except (OSError, ValueError, RecursionError):
            return None

    def put(self, key: str, outcome: OutcomeT) -> None:
        """Keep an outcome: whole and safe on the disk, or not at all.

        Raises
        ------
        OutputError
            When the system does not let us write.
        """
        fresh = self.folder / f".{key}.{uuid.uuid4().hex}{_TEMPORARY}"
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            try:
                with fresh.open("xb") as file:
                    file.write(self.kind.write(outcome))
                    file.flush()
                    os.fsync(file.fileno())
                fresh.replace(self._file(key))
            finally:
                with contextlib.suppress(OSError):
                    fresh.unlink(missing_ok=True)
        except OSError as error:
            # Windows lets no one replace a file that another process has open.
            if self.get(key) == outcome:
                return
            reason = error.strerror or str(error)
            raise OutputError(
                f"cannot keep runs in {self.folder}: {reason}; choose another folder with `runs`"
            ) from error

    def sweep(self) -> None:
        """Remove what processes that were killed in the middle of `put` left behind."""
        with contextlib.suppress(OSError):
            for file in self.folder.glob(f".*{_TEMPORARY}"):
                with contextlib.suppress(OSError):
                    if file.stat().st_mtime < time.time() - _STALE_SECONDS:
                        file.unlink()

    def _file(self, key: str) -> Path:
        return self.folder / f"{key}.json"


def default_folder() -> Path:
    """Folder of runs: PROFILETOOL_RUNS where it is set, else one in the user's cache."""
    asked = os.environ.get(FOLDER_VARIABLE)
    if asked:
        return Path(asked)
    return platformdirs.user_cache_path("profiletool", appauthor=False) / "runs"
