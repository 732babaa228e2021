"""The faces of the packages: public names, what they load, and their docstrings."""

from __future__ import annotations

import ast
import dataclasses
import inspect
import re
import subprocess
import sys
import textwrap
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import FunctionType

import pytest

ROOT = Path(__file__).resolve().parents[2]
FACES = ("profiletool", "fem", "formula")
NAMES = [
    pytest.param(face, name, id=f"{face}.{name}")
    for face in FACES
    for name in import_module(face).__all__
]


def declared(face: str) -> set[str]:
    """Names that the face imports for type checkers, which must be the public ones."""
    tree = ast.parse(Path(str(import_module(face).__file__)).read_text())
    guarded = [node for node in tree.body if isinstance(node, ast.If)]
    imports = [node for node in guarded[0].body if isinstance(node, ast.ImportFrom)]
    return {alias.name for node in imports for alias in node.names}


@pytest.mark.parametrize("face", FACES)
def test_all_is_true(face: str) -> None:
    module = import_module(face)
    assert len(module.__all__) == len(set(module.__all__))
    assert set(module.__all__) == set(module._HOMES) == declared(face)
    assert set(module.__all__) <= set(dir(module))
    for name, home in module._HOMES.items():
        assert getattr(module, name) is getattr(import_module(f"{face}.{home}"), name)


@pytest.mark.parametrize("face", FACES)
def test_no_public_name_is_a_modules(face: str) -> None:
    # A module that is imported takes the place of the name in the package.
    folder = Path(str(import_module(face).__file__)).parent
    assert not set(import_module(face).__all__) & {path.stem for path in folder.iterdir()}


@pytest.mark.parametrize("face", FACES)
def test_no_other_name_is_there(face: str) -> None:
    with pytest.raises(AttributeError, match="nowhere"):
        _ = import_module(face).nowhere


def loaded(code: str) -> set[str]:
    """Packages that are loaded after running ``code`` in a Python of its own."""
    report = f"{code}; import sys; print(*{{name.partition('.')[0] for name in sys.modules}})"
    done = subprocess.run(
        [sys.executable, "-c", report], check=True, capture_output=True, text=True, cwd=ROOT
    )
    return set(done.stdout.split())


@pytest.mark.parametrize("face", FACES)
def test_a_face_loads_nothing(face: str) -> None:
    assert not {"numpy", "scipy"} & loaded(f"import {face}")


def test_an_actuator_is_described_without_scipy() -> None:
    code = "from fem import Actuator, BadGeometry, Gauze, MeshSize, Ogden, chain, law"
    assert "scipy" not in loaded(code)
    assert "scipy" in loaded("import scipy")  # the check can tell


def documented(thing: object) -> Iterator[tuple[str, object]]:
    """Yield a public class or function, and a class's public methods and properties."""
    yield getattr(thing, "__name__", ""), thing
    if inspect.isclass(thing):
        for name, member in vars(thing).items():
            member = getattr(member, "__func__", getattr(member, "fget", member))
            if isinstance(member, FunctionType) and not name.startswith("_"):
                yield f"{thing.__name__}.{name}", member


def raises(thing: object) -> bool:
    """Whether a function, or the making of a record, raises an error itself."""
    if inspect.isclass(thing):
        thing = vars(thing).get("__post_init__", object())
    if not isinstance(thing, FunctionType):
        return False
    tree = ast.parse(textwrap.dedent(inspect.getsource(thing)))
    return any(isinstance(node, ast.Raise) and node.exc is not None for node in ast.walk(tree))


@pytest.mark.parametrize(("face", "name"), NAMES)
def test_docstrings_are_complete(face: str, name: str) -> None:
    thing = getattr(import_module(face), name)
    if not (inspect.isclass(thing) or inspect.isfunction(thing)):
        return
    for what, member in documented(thing):
        doc = inspect.getdoc(member)
        assert doc, what
        if raises(member):
            assert "Raises\n" in doc, what
    doc = inspect.getdoc(thing) or ""
    if dataclasses.is_dataclass(thing):
        told = [field.name for field in dataclasses.fields(thing)]
    elif inspect.isfunction(thing):
        told = list(inspect.signature(thing).parameters)
    else:
        told = []
    assert [word for word in told if not re.search(rf"\b{word}\b", doc)] == []


@pytest.mark.parametrize("face", FACES)
def test_the_installed_package_is_ours(face: str) -> None:
    # `fem` and `formula` are top-level names that another wheel may take.
    assert Path(str(import_module(face).__file__)).parent == ROOT / face
