"""Measures of the code's architecture: rooms, arrows, circles, chains, lengths, parameters.

Run as ``python tests/house/measures.py``; `test_house.py` holds the bounds.
"""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import grimp

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("profiletool", "fem", "formula")
MOST_LINES, MOST_FUNCTION_LINES, MOST_PARAMETERS = 300, 60, 8


@dataclass(frozen=True)
class Measures:
    """The architecture in numbers.

    Attributes
    ----------
    top : tuple of str
        Modules directly in profiletool/, packages apart.
    rooms : tuple of str
        Packages and modules directly in profiletool/; other packages.
    modules : int
    arrows : int
        Pairs of rooms of which one imports the other.
    circles : tuple of frozenset of str
        Groups of modules that import each other, directly or by way of others.
    upward : int
        Imports against the order of the layers in pyproject.toml.
    layers : int
    chain, room_chain : tuple of str
        The longest chain of imports, of modules and of rooms.
    long_files, long_functions, wide_functions : dict
        Place to count, of what is over the bounds.
    """

    top: tuple[str, ...]
    rooms: tuple[str, ...]
    modules: int
    arrows: int
    circles: tuple[frozenset[str], ...]
    upward: int
    layers: int
    chain: tuple[str, ...]
    room_chain: tuple[str, ...]
    long_files: dict[str, int]
    long_functions: dict[str, int]
    wide_functions: dict[str, int]


def measures() -> Measures:
    """Measure the code as it lies in the repository."""
    graph = grimp.build_graph(*PACKAGES, cache_dir=None)
    arrows = {m: sorted(graph.find_modules_directly_imported_by(m)) for m in sorted(graph.modules)}
    room = {module: _room(module) for module in arrows}
    layers = _layers()
    files = sorted(file for package in PACKAGES for file in (ROOT / package).rglob("*.py"))
    functions = [pair for file in files for pair in _functions(file)]
    return Measures(
        top=tuple(sorted(file.stem for file in (ROOT / "profiletool").glob("*.py"))),
        rooms=tuple(sorted(set(room.values()))),
        modules=len(arrows),
        arrows=len({(room[a], room[b]) for a in arrows for b in arrows[a] if room[a] != room[b]}),
        circles=tuple(part for part in _components(arrows) if len(part) > 1),
        upward=sum(_is_upward(a, b, layers) for a in arrows for b in arrows[a]),
        layers=len(layers),
        chain=_longest_chain(arrows),
        room_chain=_longest_chain(_between(arrows, room)),
        long_files=_over({_place(f): _lines(f) for f in files}, MOST_LINES),
        long_functions=_over({place: node_lines(node) for place, node in functions},
                             MOST_FUNCTION_LINES),
        wide_functions=_over({place: parameters(node) for place, node in functions},
                             MOST_PARAMETERS),
    )  # fmt: skip


def _room(module: str) -> str:
    """Room that a module belongs to: below profiletool the first name, else its package."""
    parts = module.split(".")
    if parts[0] == "profiletool":
        return ".".join(parts[:2])
    package = (ROOT / Path(*parts) / "__init__.py").exists()
    return module if package else ".".join(parts[:-1])


def _between(arrows: dict[str, list[str]], room: dict[str, str]) -> dict[str, list[str]]:
    """Imports between rooms."""
    rooms = {name: set[str]() for name in room.values()}
    for importer, imported in arrows.items():
        rooms[room[importer]] |= {room[m] for m in imported} - {room[importer]}
    return {name: sorted(others) for name, others in sorted(rooms.items())}


def _over(counts: dict[str, int], most: int) -> dict[str, int]:
    return {place: count for place, count in counts.items() if count > most}


def _place(file: Path) -> str:
    return file.relative_to(ROOT).as_posix()


def _lines(file: Path) -> int:
    return len(file.read_text("utf-8").splitlines())


Function = ast.FunctionDef | ast.AsyncFunctionDef


def _functions(file: Path) -> Iterator[tuple[str, Function]]:
    """Every function of a file with its place; a nested one is part of its outer one too."""
    for node in ast.walk(ast.parse(file.read_text("utf-8"))):
        if isinstance(node, Function):
            yield f"{_place(file)}:{node.name}", node


def node_lines(node: Function) -> int:
    """Lines of a function from its def on, docstring and comments among them."""
    return (node.end_lineno or node.lineno) - node.lineno + 1


def parameters(node: Function) -> int:
    """Number of parameters of a function, self and cls apart."""
    names = [a.arg for a in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)]
    return len([name for name in names if name not in ("self", "cls")])


def _layers() -> list[frozenset[str]]:
    """Rows of the layers contract, the highest first."""
    settings: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    (rows,) = (contract["layers"] for contract in contracts if contract["type"] == "layers")
    return [frozenset(part.strip() for part in row.split("|")) for row in rows]


def _is_upward(importer: str, imported: str, layers: list[frozenset[str]]) -> bool:
    """Whether an import runs up the stairs, or between two rooms of one layer."""
    heights = []
    for module in (importer, imported):
        _, _, below = module.partition("profiletool.")
        room = below.partition(".")[0]
        heights.append(next((k for k, row in enumerate(layers) if room in row), None))
    first, second = heights
    if first is None or second is None:
        return False
    apart = importer.split(".")[1] != imported.split(".")[1]
    return apart and second <= first


def _components(arrows: dict[str, list[str]]) -> list[frozenset[str]]:
    """Strongly connected components (Tarjan)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    parts: list[frozenset[str]] = []

    def visit(node: str) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in arrows[node]:
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            at = stack.index(node)
            parts.append(frozenset(stack[at:]))
            del stack[at:]

    for node in arrows:
        if node not in index:
            visit(node)
    return parts


def _longest_chain(arrows: dict[str, list[str]]) -> tuple[str, ...]:
    """Longest chain of imports; in a circle the first arrow that leads back is left out."""
    chains: dict[str, tuple[str, ...]] = {}

    def chain(node: str, above: frozenset[str]) -> tuple[str, ...]:
        if node not in chains:
            below = [chain(n, above | {node}) for n in arrows[node] if n not in above | {node}]
            chains[node] = (node, *max(below, key=len, default=()))
        return chains[node]

    return max((chain(node, frozenset()) for node in arrows), key=len)


def report(found: Measures) -> str:
    """The measures as lines of text."""
    lines = [
        f"modules {found.modules}, directly in profiletool/ {len(found.top)}: "
        f"{' '.join(found.top)}",
        f"rooms {len(found.rooms)}: {' '.join(found.rooms)}",
        f"arrows between rooms {found.arrows}, against the layers {found.upward}, "
        f"layers {found.layers}",
        f"circles {len(found.circles)}" + "".join(f"\n  {sorted(c)}" for c in found.circles),
        f"longest chain of rooms {len(found.room_chain)}: {' > '.join(found.room_chain)}",
        f"longest chain of modules {len(found.chain)}: {' > '.join(found.chain)}",
    ]
    for what, over, most in (
        ("files", found.long_files, f"{MOST_LINES} lines"),
        ("functions", found.long_functions, f"{MOST_FUNCTION_LINES} lines"),
        ("functions", found.wide_functions, f"{MOST_PARAMETERS} parameters"),
    ):
        lines.append(f"{what} over {most}: {len(over)}")
        lines += [f"  {place} {count}" for place, count in sorted(over.items())]
    return "\n".join(lines)


if __name__ == "__main__":
    print(report(measures()))
