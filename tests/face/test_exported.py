"""The faces of the packages: what `__all__` says is what there is, lazily, and documented."""

from __future__ import annotations

import ast
import inspect
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

FACES = ("profiletool", "fem", "formula")
ROOT = Path(__file__).parents[2]


def exported(face: ModuleType) -> list[tuple[str, object]]:
    return [(name, getattr(face, name)) for name in face.__all__]


@pytest.mark.parametrize("name", FACES)
def test_all_is_true(name: str) -> None:
    face = import_module(name)
    assert face.__all__ == sorted(face.__all__, key=str)
    assert len(set(face.__all__)) == len(face.__all__)
    for public, value in exported(face):
        assert value is not None, public
        assert not isinstance(value, ModuleType), f"{public} is a room"
        home = getattr(value, "__module__", name)
        assert home.partition(".")[0] in FACES, f"{public} comes from {home}"
    assert set(face.__all__) <= set(dir(face))
    with pytest.raises(AttributeError, match="no attribute 'nothing_of_the_kind'"):
        _ = face.nothing_of_the_kind


@pytest.mark.parametrize("name", FACES)
def test_types_are_declared_for_the_same_names(name: str) -> None:
    """What type checkers read and what is loaded when asked for are the same."""
    file = ROOT / name / "__init__.py"
    (block,) = [n for n in ast.parse(file.read_text("utf-8")).body if isinstance(n, ast.If)]
    declared = {
        alias.asname or alias.name: node.module
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    face = import_module(name)
    assert declared == {public: f"{name}.{home}" for public, home in face._HOMES.items()}
    assert sorted(declared) == face.__all__


@pytest.mark.parametrize("name", FACES)
def test_a_face_loads_nothing_before_it_is_asked(name: str) -> None:
    code = (
        f"import sys, {name}; "
        "print([m for m in ('numpy', 'scipy', 'cv2', 'matplotlib', 'typer') if m in sys.modules])"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"


def functions_of(face: ModuleType) -> list[tuple[str, object]]:
    return [(name, value) for name, value in exported(face) if inspect.isfunction(value)]


@pytest.mark.parametrize("name", FACES)
def test_public_functions_are_documented_whole(name: str) -> None:
    for public, function in functions_of(import_module(name)):
        text = inspect.getdoc(function) or ""
        parameters = [
            parameter.name
            for parameter in inspect.signature(function).parameters.values()  # type: ignore[arg-type]
        ]
        for parameter in parameters:
            assert re.search(rf"\b{parameter}\b", text.partition("\n")[2]), f"{public}: {parameter}"
        assert "Returns\n" in text, f"{public} returns what?"
        source = inspect.getsource(function)  # type: ignore[arg-type]
        if "raise " in source:
            assert "Raises\n" in text, f"{public} raises what?"


@pytest.mark.parametrize("name", FACES)
def test_public_records_are_documented(name: str) -> None:
    for public, value in exported(import_module(name)):
        if inspect.isclass(value):
            assert re.match(r"[A-Z].*\.$", (inspect.getdoc(value) or "").split("\n")[0]), public


def test_the_installed_packages_are_ours() -> None:
    """`fem` and `formula` are top-level names that another wheel may take."""
    for name in FACES:
        assert Path(str(import_module(name).__file__)).parent == ROOT / name
