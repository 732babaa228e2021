"""What all tests share."""

from __future__ import annotations

import gc
import os

# Before numpy and OpenCV load, here and in every process that a test starts: pytest has a worker
# for each core already, and threads beside them spin more than they work. Dense products of the
# engine took seven times the CPU time with two, the search for a sheet 1.3 times.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OPENCV_FOR_THREADS_NUM", "1")

from pathlib import Path

import pytest
from hypothesis import settings

# Wall-clock deadlines fail on a busy machine; derandomised, a failure is the same for everyone.
settings.register_profile("profiletool", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("profiletool")


def pytest_collection_finish() -> None:
    """Leave what all tests share out of every garbage collection: a fiftieth of all time."""
    gc.collect()
    gc.freeze()


ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def samples() -> Path:
    """The sample pictures of this repository."""
    return ROOT / "samples"


@pytest.fixture(scope="session")
def shared() -> Path:
    """Reference data kept beside the repository; tests that need it skip where it is absent.

    PROFILETOOL_NEED_SHARED=1 turns the skip into a failure, so that CI cannot pass without it.
    """
    folder = ROOT.parent / "shared"
    if not folder.is_dir():
        if os.environ.get("PROFILETOOL_NEED_SHARED") == "1":
            pytest.fail(f"{folder} is absent, and PROFILETOOL_NEED_SHARED=1 demands it")
        pytest.skip("needs the reference data in ../shared")
    return folder


@pytest.fixture(autouse=True)
def no_trials(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Try no other options for an infeasible design, which takes seconds; `trials` does."""
    if "trials" in request.keywords:
        return
    from profiletool import pipeline
    from profiletool.records.way import WaysOut
    from profiletool.verdict import ways

    for module in (pipeline, ways):
        monkeypatch.setattr(module, "ways_out", lambda *_: WaysOut((), ("nothing",)))
