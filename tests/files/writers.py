"""Processes that write folders or files which tell whose they are."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


FILES = 12


# Writes folders, or files, that tell whose they are; argv: place, whose, times, force, file.
WRITER = """
import signal, sys
from pathlib import Path
from profiletool.errors import ProfiletoolError
from profiletool.files.write import write_file, write_folder
place, whose, times, force, as_file = Path(sys.argv[1]), sys.argv[2], *map(int, sys.argv[3:])
signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
print("ready", flush=True)
sys.stdin.readline()
for turn in range(times):
    data = f"{whose} {turn} ".encode() * 2000
    try:
        if as_file:
            write_file(place, data, bool(force))
        else:
            names = ["design.json", *(f"{n}.txt" for n in range(11))]
            write_folder(place, dict.fromkeys(names, data), bool(force))
    except ProfiletoolError as error:
        sys.exit(f"{error.exit_code} {error}")
"""


class Writer:
    """A process that writes as soon as it is told to."""

    def __init__(
        self, place: Path, whose: object, times: int, *, force: bool, as_file: bool = False
    ) -> None:
        words = [str(place), str(whose), str(times), str(int(force)), str(int(as_file))]
        self.process = subprocess.Popen(
            [sys.executable, "-c", WRITER, *words],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )  # fmt: skip
        assert self.process.stdout is not None
        assert self.process.stdout.readline() == "ready\n"

    def start(self) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write("\n")
        self.process.stdin.flush()

    def end(self) -> str:
        """What it says on stderr."""
        return self.process.communicate(timeout=60)[1].strip()


def race(writers: list[Writer]) -> list[str]:
    for writer in writers:
        writer.start()
    return [writer.end() for writer in writers]


def whole(folder: Path) -> bytes:
    """The content that all files of a folder share."""
    names = {path.name for path in folder.iterdir()}
    assert names == {"design.json", *(f"{n}.txt" for n in range(FILES - 1))}
    (content,) = {path.read_bytes() for path in folder.iterdir()}
    assert len(content) > 2000
    return content


def leftovers(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if path.name.startswith("."))
