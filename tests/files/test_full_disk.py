"""Full disks, quotas and places that cannot be written."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from profiletool.errors import OutputError
from profiletool.files import write
from profiletool.files.write import check_file, check_free, write_file, write_folder
from tests.files.writers import ROOT, WRITER


def full_disk(monkeypatch: pytest.MonkeyPatch, after: int) -> None:
    write_file = write._write
    written: list[Path] = []

    def writing(path: Path, data: bytes) -> None:
        if len(written) == after:
            path.write_bytes(data[:1])
            raise OSError(errno.ENOSPC, "No space left on device")
        write_file(path, data)
        written.append(path)

    monkeypatch.setattr(write, "_write", writing)


@pytest.mark.parametrize("after", [0, 1, 2])
@pytest.mark.parametrize("earlier", [False, True])
def test_a_full_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, after: int, earlier: bool
) -> None:
    out = tmp_path / "out"
    if earlier:
        write_folder(out, {"design.json": b"old"}, force=False)
    full_disk(monkeypatch, after)
    with pytest.raises(OutputError, match="No space left"):
        write_folder(out, dict.fromkeys(["design.json", "a", "b"], b"new"), force=True)
    assert [path.name for path in tmp_path.iterdir()] == (["out"] if earlier else [])
    assert not earlier or (out / "design.json").read_bytes() == b"old"


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
def test_a_quota(tmp_path: Path) -> None:
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))\n"
    done = subprocess.run(
        [sys.executable, "-c", limit + WRITER, str(tmp_path / "out"), "a", "1", "0", "0"],
        input="\n", capture_output=True, text=True, timeout=60, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.stderr.startswith("1 cannot write")
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("check", [check_free, check_file])
def test_a_place_that_cannot_be_is_refused_at_once(
    tmp_path: Path, check: Callable[[Path, bool], None]
) -> None:
    (tmp_path / "file").write_text("mine")
    with pytest.raises(OutputError, match="is no folder"):
        check(tmp_path / "file" / "deep" / "out", False)
    with pytest.raises(OutputError, match="is no folder"):
        write_file(tmp_path / "file" / "out", b"", force=False)


def test_a_folder_that_is_read_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)  # root may write anywhere
    with pytest.raises(OutputError, match="no permission"):
        check_free(tmp_path / "deep" / "out", force=False)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() == 0, reason="root may write anywhere")
def test_a_folder_that_is_read_only_in_earnest(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(OutputError, match="no permission"):
            write_folder(tmp_path / "out", {"design.json": b""}, force=False)
    finally:
        tmp_path.chmod(0o700)
