"""What the guide says of the code is there: files, imports, the picture of the rooms, commands."""

from __future__ import annotations

import ast
import re
import shlex
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from textwrap import dedent

import pytest
from typer.testing import CliRunner

from profiletool.cli.main import app

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
DEVELOPERS = [DOCS / "architecture.md", DOCS / "contributing.md", *sorted(DOCS.glob("extend/*.md"))]
# What a how-to tells the reader to write.
NEW = {"report/markdown.py", "read_json.py", "gent.py"}
NEW_FLAGS = {"--max-openF", "--thread"}
_NAMED = re.compile(r"`((?!\.venv)(?:[\w.]+/)+[\w.]*|\w+\.(?:py|toml))`")
pages = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())


def blocks(page: Path) -> Iterator[tuple[str, str]]:
    """Language and content of every fenced block."""
    language, lines = None, list[str]()
    for line in page.read_text("utf-8").splitlines():
        fence = line.strip().startswith("```")
        if fence and language is None:
            language, lines = line.strip()[3:], []
        elif fence and language is not None:
            yield language, dedent("\n".join(lines))
            language = None
        else:
            lines.append(line)


def commands(page: Path) -> Iterator[list[str]]:
    """Words of every command line of ours."""
    for language, code in blocks(page):
        if language in ("", "sh"):
            for line in code.replace("\\\n", " ").splitlines():
                words = shlex.split(line, comments=True)
                if words[:1] in (["design"], ["profiletool"]):
                    yield words


@pytest.mark.parametrize("page", DEVELOPERS, ids=lambda page: page.stem)
def test_files_that_are_named_exist(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text("utf-8"), flags=re.S)
    named = set(_NAMED.findall(text)) - NEW
    for name in named:
        places = (ROOT / name, ROOT / "profiletool" / name)
        assert any(place.exists() for place in places), name


@pages
def test_imports_of_code_blocks_work(page: Path) -> None:
    for language, code in blocks(page):
        if language != "python":
            continue
        for line in re.findall(r"^(?:from|import) (?:profiletool|fem|formula)\b.*$", code, re.M):
            (node,) = ast.parse(line).body
            assert isinstance(node, ast.ImportFrom)
            module = import_module(str(node.module))
            assert all(hasattr(module, alias.name) for alias in node.names), line


@pages
def test_flags_of_commands_exist(page: Path) -> None:
    for words in commands(page):
        command = "design" if words[0] == "design" else words[1]
        flags = {word for word in words if word.startswith("--")} - NEW_FLAGS
        assert flags <= flags_of(command), words


@cache
def flags_of(command: str) -> frozenset[str]:
    shown = CliRunner().invoke(app, [command, "--help"])
    assert shown.exit_code == 0, command
    return frozenset(re.findall(r"--[\w-]+", shown.output))


def test_the_picture_of_the_rooms_is_that_of_the_layers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(DOCS))
    rooms = import_module("rooms")
    drawn = (DOCS / "pictures" / "rooms.svg").read_text("utf-8")
    assert drawn == rooms.rooms(rooms.layers()), "run python docs/rooms.py"
    names = [name for row in rooms.layers() for name in row]
    assert all(f">{name}<" in drawn or f">{name}.py<" in drawn for name in names)


def test_pages_and_pictures_that_are_linked_exist() -> None:
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#:]+?)(?:#[^)]*)?\)", page.read_text("utf-8")):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_commands_of_the_readme_are_one_line_each() -> None:
    text = (ROOT / "README.md").read_text("utf-8")
    assert len(text.splitlines()) <= 90
    for heading in ("## Run it", "## Test it"):
        block = text.partition(f"\n{heading}\n")[2].partition("```\n")[2].partition("```")[0]
        assert block.startswith("python3 -m venv .venv && ")
        assert block.count("\n") == 1
