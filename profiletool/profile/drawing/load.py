"""Profiles that come as vectors: DXF, SVG and CSV files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from profiletool.errors import NoObject, UnreadableInput, UsageError
from profiletool.files.read import read_file
from profiletool.profile.drawing.chain import Polyline, clean
from profiletool.profile.drawing.choose import choose, tangled
from profiletool.profile.drawing.drawn import Drawn
from profiletool.profile.drawing.read_csv import read_csv
from profiletool.profile.drawing.read_dxf import read_dxf
from profiletool.profile.drawing.read_svg import read_svg
from profiletool.profile.drawing.scatter import without_scatter
from profiletool.records.profile import DrawnLine
from profiletool.records.units import FloatArray

SUFFIXES = (".dxf", ".svg", ".svgz", ".csv", ".txt", ".tsv", ".dat")
MAX_BYTES = 20_000_000
_LOOKED_INTO = 2_000  # pieces of a line whose crossings are looked for


def load_vector(path: Path, layer: str | None = None) -> DrawnLine:
    """Read the one profile of a DXF, SVG or CSV file; the suffix tells which it is.

    Parameters
    ----------
    path : Path
        At most 20 MB. Units: see ``read_dxf``, ``read_svg`` and ``read_csv``.
    layer : str or None
        The layer of a DXF, or the group of an SVG by its label or id, to read alone.

    Returns
    -------
    DrawnLine
        In mm, y up; see `choose` for which of several lines.

    Raises
    ------
    UnreadableInput
        The file is missing, unsafe, damaged, too large or no profile.
    NoObject
        It holds no line, several alike, or one that crosses itself.
    UsageError
        There is no such layer.
    """
    try:
        drawn = _read(path, layer)
        found = choose(drawn.chains)
        chain, scattered = without_scatter(found.chain)
        _check(chain)
    except (UnreadableInput, NoObject, UsageError) as error:
        raise type(error)(_one_line(f"{path}: {error}")) from None
    return DrawnLine(
        points=chain.points,
        closed=chain.closed,
        unit=drawn.unit,
        notes=(*drawn.notes, *found.notes, *scattered),
    )


def _read(path: Path, layer: str | None) -> Drawn:
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise UnreadableInput("not a vector profile; give DXF, SVG or CSV")
    data = _bytes(path)
    if suffix == ".dxf":
        return read_dxf(path, layer)
    if suffix in (".svg", ".svgz"):
        return read_svg(data, layer)
    if layer is not None:
        raise UsageError("`layer` is for DXF and SVG; a table of points has none")
    return read_csv(data)


def drawing_of(points: FloatArray) -> DrawnLine:
    """Take points (N, 2), mm, y up, for a drawn line; closed where the last meets the first.

    Raises
    ------
    UnreadableInput
        Too few points, or coordinates that are not finite or absurdly large.
    NoObject
        The line crosses itself.
    """
    chain = clean(np.asarray(points, dtype=float), closed=False)
    _check(chain)
    return DrawnLine(points=chain.points, closed=chain.closed)


def _one_line(text: str) -> str:
    """Join lines and show what a terminal could not, such as stray bytes, as '?'."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))


def _bytes(path: Path) -> bytes:
    data = read_file(path, MAX_BYTES, "a DXF, SVG or CSV file")
    if not data.strip():
        raise UnreadableInput("the file is empty; export the profile again")
    return data


def _check(chain: Polyline) -> None:
    import shapely

    if len(chain.points) < 3:
        raise UnreadableInput(f"only {len(chain.points)} distinct points; a profile needs 3")
    if tangled([chain]):
        raise NoObject("the line runs to and fro too densely; redraw it as one plain line")
    line = shapely.LinearRing(chain.points) if chain.closed else shapely.LineString(chain.points)
    if not line.is_simple:
        raise NoObject(
            f"the line crosses or touches itself{_crossing(chain)}; redraw it as one plain line"
        )


def _crossing(chain: Polyline) -> str:
    """Say where a line crosses itself."""
    import shapely

    pieces = shapely.linestrings(np.stack([chain.points[:-1], chain.points[1:]], axis=1))
    tree = shapely.STRtree(pieces)
    for k, piece in enumerate(pieces[:_LOOKED_INTO]):
        met = tree.query(piece, predicate="intersects")
        beyond = met[met > k + 1]
        if beyond.size:
            crossing = shapely.intersection(piece, pieces[int(beyond[0])])
            x, y = shapely.get_coordinates(crossing)[0]
            return f" at ({x:.1f}, {y:.1f})"
    return ""
