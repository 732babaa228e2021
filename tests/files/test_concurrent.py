"""Several processes in one place, and killed ones: a whole folder or none, never a mix."""

from __future__ import annotations

import errno
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from profiletool.errors import OutputError, UsageError
from profiletool.files import workfolder, write
from profiletool.files.write import check_free, write_folder
from tests.files.writers import FILES, ROOT, Writer, leftovers, race, whole


def test_without_force_the_first_stays_and_the_others_are_refused(tmp_path: Path) -> None:
    said = race([Writer(tmp_path / "out", whose, 1, force=False) for whose in range(4)])
    assert sorted(line[:2] for line in said) == ["", "2 ", "2 ", "2 "]
    assert all("exists; replace it with `force`" in line for line in said if line)
    assert whole(tmp_path / "out").startswith(str(said.index("")).encode())
    assert leftovers(tmp_path) == []


@pytest.mark.slow
def test_with_force_the_last_stays_whole(tmp_path: Path) -> None:
    writers = [Writer(tmp_path / "out", whose, 40, force=True) for whose in range(3)]
    assert race(writers) == ["", "", ""]
    assert b" 39 " in whole(tmp_path / "out")
    assert leftovers(tmp_path) == []


@pytest.mark.slow
def test_a_reader_meets_whole_folders_only(tmp_path: Path) -> None:
    write_folder(tmp_path / "out", dict.fromkeys(["design.json"], b"x"), force=False)
    writer = Writer(tmp_path / "out", "a", 60, force=True)
    writer.start()
    seen = 0
    while writer.process.poll() is None:
        try:
            handle = os.open(tmp_path / "out", os.O_RDONLY | os.O_DIRECTORY)
        except FileNotFoundError:
            continue  # the instant of the exchange
        try:
            names = os.listdir(handle)  # noqa: PTH208  no path: the very folder
            # One that is replaced in this moment is emptied; one that stands is whole.
            if os.path.samestat(os.fstat(handle), (tmp_path / "out").stat()):
                assert len(names) in (1, FILES)
                seen += 1
        except FileNotFoundError:
            pass
        finally:
            os.close(handle)
    assert writer.end() == ""
    assert seen > 10


@pytest.mark.parametrize("at", ["lstat", "listdir", "after"])
def test_a_folder_that_is_exchanged_while_it_is_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, at: str
) -> None:
    """Emptied by its process, which has put another in its place: ours all the same."""
    out, aside = tmp_path / "out", tmp_path / "aside"
    write_folder(out, dict.fromkeys(["design.json", "b"], b"old"), force=False)
    lstat, listdir, looks = Path.lstat, os.listdir, []

    def exchange() -> None:
        if not aside.exists():
            out.rename(aside)
            (aside / "design.json").unlink()
            if at == "after":
                out.mkdir()
                (out / "design.json").touch()

    def looked(path: Path) -> os.stat_result:
        looks.append(path)
        if at == "lstat" and path == out:
            exchange()
        return lstat(path)

    def listed(path: Path) -> list[str]:
        if path != out or at == "lstat":
            return listdir(path)
        exchange()
        return listdir(aside if at == "after" else path)

    monkeypatch.setattr(Path, "lstat", looked)
    monkeypatch.setattr(os, "listdir", listed)
    check_free(out, force=True)
    assert out in looks
    assert aside.exists()


@pytest.mark.parametrize("force", [False, True])
def test_a_place_that_was_taken_and_is_free_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, force: bool
) -> None:
    """Another process had a folder there, and is about to replace it by its next."""
    out = tmp_path / "out"
    rename, lexists, tries = Path.rename, os.path.lexists, []

    def taken_once(path: Path, target: Path) -> Path:
        tries.append(target)
        if tries.count(out) == 1 and target == out:
            raise OSError(errno.ENOTEMPTY, "Directory not empty")
        return rename(path, target)

    monkeypatch.setattr(os.path, "lexists", lambda place: place != out and lexists(place))
    monkeypatch.setattr(Path, "rename", taken_once)
    write_folder(out, {"design.json": b"mine"}, force)
    assert (out / "design.json").read_bytes() == b"mine"


@pytest.mark.skipif(sys.platform == "win32", reason="Windows removes no open file")
def test_a_lock_goes_before_it_is_let_go_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else another process could take the lock of a folder that is being removed."""
    rmtree, left = shutil.rmtree, []

    def removed(folder: Path, ignore_errors: bool) -> None:
        left.append((folder / "lock").exists())
        rmtree(folder, ignore_errors)

    with workfolder.working_beside(tmp_path / "out"):
        monkeypatch.setattr(shutil, "rmtree", removed)
    assert left == [False]
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_looked_into(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def denied(_: Path) -> list[str]:
        raise PermissionError(13, "Permission denied")

    (tmp_path / "out").mkdir()
    monkeypatch.setattr(os, "listdir", denied)
    with pytest.raises(OutputError, match="Permission denied"):
        check_free(tmp_path / "out", force=True)


@pytest.mark.parametrize("force", [False, True])
def test_files_in_a_race(tmp_path: Path, force: bool) -> None:
    writers = [Writer(tmp_path / "f.json", n, 1, force=force, as_file=True) for n in range(4)]
    said = race(writers)
    lost = [line for line in said if line]
    assert len(lost) == (0 if force else 3)
    assert all(line.startswith("2 ") for line in lost)
    content = (tmp_path / "f.json").read_bytes()
    assert content == content[:4] * 2000
    assert leftovers(tmp_path) == []


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("blow", ["SIGKILL", "SIGTERM", "SIGINT"])
def test_killed_at_any_moment(tmp_path: Path, blow: str) -> None:
    chance = random.Random(3)
    out = tmp_path / "out"
    race([Writer(out, "first", 1, force=False)])
    for turn in range(10):
        writer = Writer(out, turn, 1000, force=True)
        writer.start()
        time.sleep(chance.uniform(0.0, 0.1))
        writer.process.send_signal(getattr(signal, blow))
        writer.end()
        try:
            check_free(out, force=True)  # as the next run begins
        finally:
            whole(out)
    write_folder(out, {"design.json": b"new"}, force=True)
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def killed_in(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, force: bool = True) -> None:
    """Leave behind what a process does that is killed between the two renames."""
    rename = Path.rename

    def deadly(self: Path, target: Path) -> Path:
        if self.name == "new":
            os._exit(9)
        return rename(self, target)

    child = os.fork()
    if child == 0:
        monkeypatch.setattr(Path, "rename", deadly)
        write_folder(tmp_path / "out", {"design.json": b"new"}, force)
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 9


@pytest.mark.skipif(sys.platform == "win32", reason="forks")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_the_old_folder_comes_back_after_a_kill_in_the_exchange(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_folder(tmp_path / "out", {"design.json": b"old", "a.txt": b"old"}, force=False)
    killed_in(monkeypatch, tmp_path)
    assert not (tmp_path / "out").exists()
    with pytest.raises(UsageError, match="exists"):  # nothing is lost, nor taken for free
        check_free(tmp_path / "out", force=False)
    assert (tmp_path / "out" / "a.txt").read_bytes() == b"old"
    assert leftovers(tmp_path) == []


@pytest.mark.skipif(sys.platform == "win32", reason="forks")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_the_leftovers_of_another_place_stay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    killed_in(monkeypatch, tmp_path)
    (mine,) = leftovers(tmp_path)
    (tmp_path / ".ou-part-12345678x").mkdir()
    check_free(tmp_path / "ou", force=False)
    check_free(tmp_path / "out-part", force=False)
    assert leftovers(tmp_path) == [".ou-part-12345678x", mine]
    check_free(tmp_path / "out", force=False)
    assert leftovers(tmp_path) == [".ou-part-12345678x"]


def test_a_living_process_keeps_its_folder(tmp_path: Path) -> None:
    with workfolder.working_beside(tmp_path / "out") as work:
        (work / "new").mkdir()
        check_free(tmp_path / "out", force=False)
        assert (work / "new").is_dir()
    assert leftovers(tmp_path) == []


def test_a_folder_of_a_process_killed_before_its_lock_goes(tmp_path: Path) -> None:
    (tmp_path / ".out-part-abcd1234").mkdir()
    check_free(tmp_path / "out", force=False)
    assert leftovers(tmp_path) == []


def test_a_disk_without_locks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(workfolder, "_hold", none)
    write_folder(tmp_path / "out", {"design.json": b"1"}, force=False)
    write_folder(tmp_path / "out", {"design.json": b"2"}, force=True)
    assert (tmp_path / "out" / "design.json").read_bytes() == b"2"
    assert leftovers(tmp_path) == []


@pytest.mark.parametrize("force", [False, True])
def test_what_comes_in_between_is_not_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, force: bool
) -> None:
    """Someone else's folder appears after the place was seen to be free."""
    out, write_file = tmp_path / "out", write._write

    def slowly(path: Path, data: bytes) -> None:
        write_file(path, data)
        out.mkdir()
        (out / "thesis.tex").write_text("years of work")

    monkeypatch.setattr(write, "_write", slowly)
    with pytest.raises(UsageError):
        write_folder(out, {"design.json": b"1"}, force)
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert (out / "thesis.tex").read_text() == "years of work"


@pytest.mark.slow
def test_two_designs_into_one_folder(samples: Path, tmp_path: Path) -> None:
    words = ["design", str(samples / "egg.png"), "--no-verify", "--quiet", "--out", "out"]
    code = "from profiletool.cli.main import main; main()"
    runs = [
        subprocess.Popen(
            [sys.executable, "-c", code, *words], cwd=tmp_path,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )
        for _ in range(2)
    ]  # fmt: skip
    said = [run.communicate(timeout=300)[1] for run in runs]
    assert sorted(run.returncode for run in runs) == [0, 2]
    assert any("exists; replace it with --force" in line for line in said)
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert (tmp_path / "out" / "report.html").stat().st_size > 1000
