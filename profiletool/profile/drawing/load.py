"""Profiles that come as vectors: DXF, SVG and CSV files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from profiletool.errors import NoObject, UnreadableInput
from profiletool.files.read import read_file
from profiletool.profile.drawing.chain import Polyline, choose, clean
from profiletool.profile.drawing.read_csv import read_csv
from profiletool.profile.drawing.read_dxf import read_dxf
from profiletool.profile.drawing.read_svg import read_svg
from profiletool.records.profile import DrawnLine
from profiletool.records.units import FloatArray

SUFFIXES = (".dxf", ".svg", ".csv")
MAX_BYTES = 20_000_000
MAX_CLOSE_PAIRS = 2e7  # of pieces of a line that might cross


def load_vector(path: Path) -> DrawnLine:
    """Read the one profile of a DXF, SVG or CSV file; the suffix tells which it is.

    Parameters
    ----------
    path : Path
        At most 20 MB. Units: see ``read_dxf``, ``read_svg`` and ``read_csv``.

    Returns
    -------
    DrawnLine
        In mm, y up. Of several lines, the longest closed one around all others, or the one that
        is much longer than the rest.

    Raises
    ------
    UnreadableInput
        The file is missing, unsafe, damaged, too large or no profile.
    NoObject
        It holds no line, several alike, or one that crosses itself.
    """
    try:
        suffix = path.suffix.lower()
        if suffix not in SUFFIXES:
            raise UnreadableInput("not a vector profile; give DXF, SVG or CSV")
        data = _bytes(path)
        if suffix == ".csv":
            chain = read_csv(data)
        else:
            chain = choose(read_dxf(path) if suffix == ".dxf" else read_svg(data))
        _check(chain)
    except (UnreadableInput, NoObject) as error:
        raise type(error)(_one_line(f"{path}: {error}")) from None
    return DrawnLine(points=chain.points, closed=chain.closed)


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
    _check_tangle(chain)
    line = shapely.LinearRing(chain.points) if chain.closed else shapely.LineString(chain.points)
    if not line.is_simple:
        raise NoObject("the line crosses or touches itself; redraw it as one plain line")


def _check_tangle(chain: Polyline) -> None:
    """Refuse a line whose pieces lie across each other so much that crossings take for ever."""
    import shapely

    pieces = shapely.linestrings(np.stack([chain.points[:-1], chain.points[1:]], axis=1))
    every = max(1, len(pieces) // 200)
    tree = shapely.STRtree(pieces)
    if every * sum(len(tree.query(piece)) for piece in pieces[::every]) > MAX_CLOSE_PAIRS:
        raise NoObject("the line runs to and fro too densely; redraw it as one plain line")
