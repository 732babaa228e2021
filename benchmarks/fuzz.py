"""Damaged inputs, thousands of them, through every reader: `python benchmarks/fuzz.py 10000`.

Small valid files of every kind are damaged by a seeded mutator and read in worker processes. An
input may end in a result or in an error of ours with an exit code that fits; anything else, more
than 5 s of CPU, more than 1 GiB, a changed input or a file left behind is a finding. Findings are
kept in the folder `--keep`; `--replay KIND FILE` reads one of them again. Not for Windows, where
nothing limits the memory of a process.
"""

from __future__ import annotations

import argparse
import collections
import json
import os
import selectors
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # calls of commands are the tests'

import numpy as np
from _fuzz_corpus import SUFFIX, corpus
from _fuzz_damage import mutated

from formula.errors import BadFormula
from profiletool.errors import ProfiletoolError

SECONDS, BYTES = 5.0, 1 << 30
_ROOM = 3 * BYTES  # of addresses; what is really held is measured
# The exit codes that a reader may end in; "0" is a result.
ALLOWED = {
    "picture": {0, 3}, "dxf": {0, 3, 5}, "svg": {0, 3, 5}, "csv": {0, 3, 5}, "toml": {2, 3},
    "design": {0, 3}, "shape": {0}, "formula": {0, 2, 3}, "rubber": {0, 3},
}  # fmt: skip


def readers() -> dict[str, Callable[[Path], object]]:
    """Give what reads a file of each kind as the commands do."""
    from profiletool.campaign.derive import load_base
    from profiletool.files.design_json import load_design
    from profiletool.files.formula import read_formula
    from profiletool.image.load import load_picture
    from profiletool.profile.drawing.load import load_vector
    from profiletool.rubber.presets import parse_rubber
    from profiletool.subject.recall import target_of
    from tests.calls import call

    def options(path: Path) -> None:
        # There is no picture: it ends before any work is done, and options come first.
        result = call("design", path.with_name("absent.csv"), "--no-verify", "--config", path)
        if result.exit_code not in ALLOWED["toml"] or "Traceback" in result.stderr:
            raise AssertionError(f"exit {result.exit_code}: {result.stdout}{result.stderr}")
        raise ProfiletoolError(str(result.exit_code))

    def shape(path: Path) -> object:
        return target_of(load_design(path.with_name("design.json")), path)

    def formula(path: Path) -> object:
        return read_formula(path), load_base(str(path))

    vector = dict.fromkeys(("dxf", "svg", "csv"), load_vector)
    return {
        "picture": load_picture, **vector, "toml": options, "design": load_design,
        "shape": shape, "formula": formula, "rubber": lambda path: parse_rubber(str(path)),
    }  # fmt: skip


def outcome_of(kind: str, path: Path, read: Callable[[Path], object]) -> str:
    """Read a file and say in a word what came of it; a finding says more, after "!"."""
    before, names = path.read_bytes(), sorted(path.parent.iterdir())
    try:
        read(path)
        code, text = 0, ""
    except ProfiletoolError as error:
        text = str(error)
        code = int(text) if kind == "toml" else error.exit_code
    except BadFormula as error:
        return f"! BadFormula left the reader: {error}"
    except Exception:
        return "! " + traceback.format_exc()
    if code not in ALLOWED[kind]:
        return f"! exit {code}: {text}"
    if "\n" in text:
        return f"! more than one line: {text}"
    if path.read_bytes() != before or sorted(path.parent.iterdir()) != names:
        return "! the input or its folder was changed"
    return f"exit {code}" if code else "ok"


def inputs(kind: str, seed: int) -> Iterator[bytes]:
    """Yield damaged files of a kind without end, the same for the same seed."""
    seeds = corpus(kind)
    for number in range(sys.maxsize):
        rng = np.random.default_rng([seed, zlib.crc32(kind.encode()), number])
        one, other = rng.integers(len(seeds), size=2)
        yield mutated(seeds[one], seeds[other], rng)


def work(kind: str, seed: int, first: int, folder: Path) -> None:
    """Read inputs as they are asked for, and print a line of JSON for each."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (_ROOM, _ROOM))
    warnings.simplefilter("error", RuntimeWarning)
    read = readers()[kind]
    if kind == "shape":
        (folder / "design.json").write_bytes(corpus("design")[0])
    path = folder / ("shape.csv" if kind == "shape" else f"input{SUFFIX[kind]}")
    path.write_bytes(corpus(kind)[0])
    outcome_of(kind, path, read)  # the first loads libraries
    unit = 1 if sys.platform == "darwin" else 1024
    for number, data in enumerate(inputs(kind, seed)):
        if number < first:
            continue
        path.write_bytes(data)
        print(json.dumps({"start": number}), flush=True)
        start = time.process_time()  # others may be at work on this machine
        told = {"outcome": outcome_of(kind, path, read)}
        told["seconds"] = time.process_time() - start
        told["bytes"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit
        print(json.dumps(told), flush=True)


class Worker:
    """A process that reads inputs from a number on, with a watch on its time."""

    def __init__(self, kind: str, seed: int, first: int, folder: Path) -> None:
        words = [sys.executable, __file__, "--work", kind, str(seed), str(first), str(folder)]
        root = Path(__file__).resolve().parents[1]
        self.process = subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            bufsize=0,  # a line that waited in a buffer would not wake the selector
            env={**os.environ, "PYTHONPATH": str(root)},
        )  # fmt: skip
        self.selector = selectors.DefaultSelector()
        assert self.process.stdout is not None
        self.selector.register(self.process.stdout, selectors.EVENT_READ)

    def line(self, seconds: float) -> dict[str, Any] | None:
        """Give what it prints next; None where it takes too long or has died."""
        assert self.process.stdout is not None
        if not self.selector.select(seconds):
            return None
        text = self.process.stdout.readline()
        return json.loads(text) if text else None

    def next(self) -> dict[str, Any]:
        """Give what came of the next input."""
        if self.line(60.0) is None:
            raise SystemExit("a worker did not start; try --replay")
        told = self.line(6.0 * SECONDS)
        if told is None:
            dead = self.process.poll()
            return {"outcome": "! takes too long" if dead is None else f"! died ({dead})"}
        if told["seconds"] > SECONDS:
            told["outcome"] = f"! {told['seconds']:.1f} s, then {told['outcome']}"
        if told["bytes"] > BYTES:
            told["outcome"] = f"! {told['bytes'] / 1e6:.0f} MB, then {told['outcome']}"
        return told

    def stop(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.communicate()


def campaign(kind: str, seed: int, first: int, count: int, keep: Path) -> collections.Counter[str]:
    """Read ``count`` inputs of a kind from number ``first`` on; count the outcomes."""
    seen: collections.Counter[str] = collections.Counter()
    source, slowest = inputs(kind, seed), 0.0
    worker = None
    with tempfile.TemporaryDirectory() as folder:
        for number, data in zip(range(first + count), source, strict=False):
            if number < first:
                continue
            worker = worker or Worker(kind, seed, number, Path(folder))
            told = worker.next()
            slowest = max(slowest, told.get("seconds", 0.0))
            outcome = told["outcome"]
            if outcome.startswith("!"):
                keep.mkdir(parents=True, exist_ok=True)
                file = keep / f"{kind}_{seed}_{number}{SUFFIX[kind]}"
                file.write_bytes(data)
                print(f"{file}: {outcome.rstrip()}\n", flush=True)
                worker.stop()
                worker = None
            seen["FINDING" if outcome.startswith("!") else outcome] += 1
        if worker is not None:
            worker.stop()
    print(f"{kind:8} {count:6}  {dict(sorted(seen.items()))}  slowest {slowest:.2f} s", flush=True)
    return seen


def main() -> int:
    """Run the campaign, a worker or a replay, as the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", nargs="?", type=int, default=10_000, help="inputs in all")
    parser.add_argument("--only", choices=ALLOWED, help="one kind alone")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    parser.add_argument("--keep", type=Path, default=Path("fuzz_findings"))
    parser.add_argument("--replay", nargs=2, metavar=("KIND", "FILE"))
    parser.add_argument("--work", nargs=4, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.work:
        kind, seed, first, folder = asked.work
        work(kind, int(seed), int(first), Path(folder))
    elif asked.replay:
        kind, file = asked.replay
        print(outcome_of(kind, Path(file), readers()[kind]))
    else:
        kinds = [asked.only] if asked.only else list(ALLOWED)
        share = -(-asked.count // len(kinds))
        found = [campaign(kind, asked.seed, asked.first, share, asked.keep) for kind in kinds]
        return int(any(seen["FINDING"] for seen in found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
