"""Lines as they are read back, lines that lie on each other, and angles on a circle."""

from __future__ import annotations

import io

import ezdxf
import numpy as np
from shapely import STRtree, linestrings


def read_back(data: bytes):
    """A DXF file as a program reads it that mends nothing: ezdxf.recover would."""
    doc = ezdxf.read(io.StringIO(data.decode("ascii")))
    auditor = doc.audit()
    assert not auditor.has_errors
    assert not auditor.has_fixes
    return doc


def segments(sheet):
    """All segments of all layers, (N, 2 ends, 2)."""
    lines = [line for layer in sheet.drawing.layers for line in layer.lines]
    points = [np.vstack([p.points, p.points[:1]]) if p.closed else p.points for p in lines]
    return np.vstack([np.stack([line[:-1], line[1:]], axis=1) for line in points])


def coincident(found, near=1e-5):
    """Pairs of segments (N, 2, 2) that lie on each other over more than a point."""
    tree = STRtree(linestrings(found))
    a, b = tree.query(linestrings(found), predicate="dwithin", distance=near)
    a, b = a[a < b], b[a < b]
    start, along = found[a, 0], np.diff(found[a], axis=1)[:, 0]
    length = np.linalg.norm(along, axis=1)
    along /= length[:, None]
    ends = found[b] - start[:, None]
    aside = np.abs(ends[..., 0] * along[:, None, 1] - ends[..., 1] * along[:, None, 0])
    reach = np.sort((ends * along[:, None]).sum(axis=2), axis=1)
    overlap = np.minimum(reach[:, 1], length) - np.maximum(reach[:, 0], 0)
    bad = (aside.max(axis=1) < near) & (overlap > near)
    return list(zip(a[bad].tolist(), b[bad].tolist(), strict=True))


def angle_off(angle, target):
    """Distance of angles around the circle, deg."""
    return np.abs((np.asarray(angle) - target + 180) % 360 - 180)
