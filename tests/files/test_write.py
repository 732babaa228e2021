from __future__ import annotations

from pathlib import Path

import pytest

from profiletool.errors import OutputError, UsageError
from profiletool.files.write import check_free, write_folder

FILES = {"design.json": b"{}", "a.txt": b"new"}


def content(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_a_new_folder_holds_exactly_the_files(tmp_path: Path) -> None:
    write_folder(tmp_path / "deep" / "out", FILES, force=False)
    assert content(tmp_path / "deep" / "out") == FILES
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["out"]


def test_an_existing_folder_is_refused_and_left_alone(tmp_path: Path) -> None:
    write_folder(tmp_path / "out", FILES, force=False)
    with pytest.raises(UsageError, match="`force`"):
        write_folder(tmp_path / "out", {"design.json": b"other"}, force=False)
    assert content(tmp_path / "out") == FILES


def test_force_replaces_the_whole_folder(tmp_path: Path) -> None:
    write_folder(tmp_path / "out", {**FILES, "old.txt": b"old"}, force=False)
    write_folder(tmp_path / "out", FILES, force=True)
    assert content(tmp_path / "out") == FILES
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_force_does_not_replace_what_is_not_ours(tmp_path: Path) -> None:
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "chapter1.tex").write_text("years of work")
    with pytest.raises(UsageError, match=r"holds no design\.json or fe\.json"):
        write_folder(tmp_path / "thesis", FILES, force=True)
    assert (tmp_path / "thesis" / "chapter1.tex").read_text() == "years of work"


def test_force_fills_an_empty_folder(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    write_folder(tmp_path / "out", FILES, force=True)
    assert content(tmp_path / "out") == FILES


def test_a_file_in_the_way(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("mine")
    with pytest.raises(UsageError, match="no folder"):
        check_free(tmp_path / "out", force=True)


def test_nothing_half_written(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot write"):
        write_folder(tmp_path / "out", {"a.txt": b"1", "no/such/folder.txt": b"2"}, force=False)
    assert list(tmp_path.iterdir()) == []


def test_the_earlier_design_survives_a_failure(tmp_path: Path) -> None:
    write_folder(tmp_path / "out", FILES, force=False)
    with pytest.raises(OutputError):
        write_folder(tmp_path / "out", {"a.txt": b"1", "no/such.txt": b"2"}, force=True)
    assert content(tmp_path / "out") == FILES


def test_and_a_failure_of_the_last_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_folder(tmp_path / "out", FILES, force=False)
    rename = Path.rename

    def failing(self: Path, target: Path) -> Path:
        if self.name == "new":
            raise OSError(28, "No space left on device")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", failing)
    with pytest.raises(OutputError, match="No space left"):
        write_folder(tmp_path / "out", {"design.json": b"x"}, force=True)
    assert content(tmp_path / "out") == FILES


def test_force_does_not_follow_a_link(tmp_path: Path) -> None:
    write_folder(tmp_path / "real", FILES, force=False)
    (tmp_path / "link").symlink_to(tmp_path / "real")
    with pytest.raises(UsageError, match="no folder"):
        write_folder(tmp_path / "link", FILES, force=True)


def test_a_name_that_no_system_takes(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot write"):
        check_free(tmp_path / ("x" * 300), force=False)
