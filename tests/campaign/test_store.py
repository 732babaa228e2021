"""Runs in a folder: whole or absent, whoever writes and whenever it is killed."""

from __future__ import annotations

import os
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest

from profiletool.campaign.runs import JOINT_RUN, Outcome, to_json
from profiletool.campaign.store import Store, default_folder
from profiletool.errors import OutputError
from tests.campaign import fake

OUTCOME = fake.outcome(fake.task(1))
DAY = 86400.0


def test_what_is_put_is_got(tmp_path: Path) -> None:
    store = Store(tmp_path / "new" / "folder", JOINT_RUN)
    assert store.get("a") is None
    store.put("a", OUTCOME)
    assert store.get("a") == OUTCOME
    assert store.get("b") is None
    assert [file.name for file in store.folder.iterdir()] == ["a.json"]
    other = fake.outcome(fake.task(2))
    store.put("a", other)
    assert Store(store.folder, JOINT_RUN).get("a") == other


@pytest.mark.parametrize(
    "data", [b"", to_json(OUTCOME)[:-1], to_json(OUTCOME)[:50], b"[" * 100_000, b"\x00" * 99]
)
def test_a_damaged_file_counts_as_absent_and_is_replaced(tmp_path: Path, data: bytes) -> None:
    store = Store(tmp_path, JOINT_RUN)
    (tmp_path / "a.json").write_bytes(data)
    assert store.get("a") is None
    store.put("a", OUTCOME)
    assert store.get("a") == OUTCOME


def test_reading_never_fails(tmp_path: Path) -> None:
    (tmp_path / "a.json").mkdir()
    (tmp_path / "file").touch()
    assert Store(tmp_path, JOINT_RUN).get("a") is None
    assert Store(tmp_path / "file", JOINT_RUN).get("a") is None
    Store(tmp_path / "file", JOINT_RUN).sweep()


def test_a_folder_that_cannot_be_written_is_told_in_a_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="cannot keep runs in") as caught:
        Store(tmp_path / "file", JOINT_RUN).put("a", OUTCOME)
    assert "\n" not in str(caught.value)


def test_nothing_is_left_of_a_write_that_failed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    store = Store(tmp_path, JOINT_RUN)
    store.put("a", OUTCOME)
    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match="No space left"):
        store.put("a", fake.outcome(fake.task(2)))
    assert store.get("a") == OUTCOME
    assert [file.name for file in tmp_path.iterdir()] == ["a.json"]


def test_what_a_kill_leaves_behind_is_removed_after_a_day(tmp_path: Path) -> None:
    store = Store(tmp_path, JOINT_RUN)
    store.put("a", OUTCOME)
    old, young = tmp_path / ".a.1.part", tmp_path / ".a.2.part"
    for file, age in ((old, 1.1 * DAY), (young, 0.9 * DAY), (tmp_path / "a.json", 9.0 * DAY)):
        file.touch()
        os.utime(file, (time.time() - age,) * 2)
    store.sweep()
    assert not old.exists()
    assert young.exists()
    assert store.get("a") == OUTCOME


def write_often(folder: str, seconds: float) -> int:
    """Put and get one key again and again; give how often it was not there whole."""
    store, end, missing = Store(Path(folder), JOINT_RUN), time.monotonic() + seconds, 0
    while time.monotonic() < end:
        store.put("a", OUTCOME)
        missing += store.get("a") != OUTCOME
    return missing


def test_two_processes_write_one_key(tmp_path: Path) -> None:
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        writing = [pool.submit(write_often, str(tmp_path), 0.5) for _ in range(2)]
        assert [future.result() for future in writing] == [0, 0]
    assert [file.name for file in tmp_path.iterdir()] == ["a.json"]
    assert isinstance(Store(tmp_path, JOINT_RUN).get("a"), Outcome)


def test_where_runs_are_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("PROFILETOOL_RUNS", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert "profiletool" in default_folder().parts
    monkeypatch.setenv("PROFILETOOL_RUNS", str(tmp_path / "elsewhere"))
    assert default_folder() == tmp_path / "elsewhere"
