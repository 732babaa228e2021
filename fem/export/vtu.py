"""The deformed FE mesh for ParaView: VTK's XML files of unstructured grids, written directly.

Points are those at rest; "displacement" takes them to where they are under pressure (ParaView:
Warp By Vector). Where half a tube was modelled, the other half is its mirror image.
"""

from __future__ import annotations

import base64
import struct
import zlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fem.arrays import FloatArray, IntArray
from fem.element import natural_nodes
from fem.mesh import Mesh

_CELL_TYPE = {"hex20": 25, "hex8": 12}  # VTK_QUADRATIC_HEXAHEDRON, VTK_HEXAHEDRON
_CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))
_MIDDLES = ((0, -1), (1, 0), (0, 1), (-1, 0))
_NAMES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "u1": "UInt8"}
_MIRROR = np.array([-1.0, 1.0, 1.0])


def write_vtu(mesh: Mesh, positions: FloatArray) -> bytes:
    """Write a deformed mesh, of the whole tube; ``positions`` as `Mesh.X`, mm.

    Point data: ``displacement`` (mm) and ``swelling`` (mm, growth of the distance from the
    section's centre). Cell data: ``joint``, the number of the joint in whose window a brick lies,
    or 0.
    """
    X, x = (_points(mesh, nodes) for nodes in (mesh.X, positions))
    cells = _cells(mesh, mirrored=False)
    joint = np.repeat(_joints(mesh), len(mesh.bricks))
    swelling = _swelling(mesh, X, x)
    if mesh.half:
        other = _mirror_nodes(mesh)
        fresh = other >= len(X)
        cells = np.concatenate([cells, other[_cells(mesh, mirrored=True)]])
        X, x = (np.concatenate([v, v[fresh] * _MIRROR]) for v in (X, x))
        swelling, joint = np.concatenate([swelling, swelling[fresh]]), np.tile(joint, 2)
    count, corners = cells.shape
    parts = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        'header_type="UInt32" compressor="vtkZLibDataCompressor">',
        f'<UnstructuredGrid><Piece NumberOfPoints="{len(X)}" NumberOfCells="{count}">',
        '<PointData Vectors="displacement">',
        _array("displacement", (x - X).astype("<f4")),
        _array("swelling", swelling.astype("<f4")),
        '</PointData><CellData Scalars="joint">',
        _array("joint", joint.astype("<i4")),
        "</CellData><Points>",
        _array("Points", X.astype("<f4")),
        "</Points><Cells>",
        _array("connectivity", cells.astype("<i4").ravel()),
        _array("offsets", (corners * np.arange(1, count + 1)).astype("<i4")),
        _array("types", np.full(count, _CELL_TYPE[mesh.size.kind], dtype="<u1")),
        "</Cells></Piece></UnstructuredGrid></VTKFile>",
    ]
    return ("\n".join(parts) + "\n").encode()


def write_pvd(files: Sequence[tuple[float, str]]) -> bytes:
    """Write a series for ParaView: pressures in bar, which stand for its time, and file names."""
    parts = [
        '<?xml version="1.0"?>',
        '<VTKFile type="Collection" version="1.0" byte_order="LittleEndian"><Collection>',
        *(f'<DataSet timestep="{bar:.6g}" part="0" file="{name}"/>' for bar, name in files),
        "</Collection></VTKFile>",
    ]
    return ("\n".join(parts) + "\n").encode()


def _points(mesh: Mesh, nodes: FloatArray) -> FloatArray:
    """Give the nodes in one row, without the mid nodes of the last section: (N, 3)."""
    return nodes.reshape(-1, 3)[: mesh.nodes]


def _order(kind: str) -> IntArray:
    """Natural coordinates of a brick's nodes as VTK numbers them: (n, 3)."""
    rows = [(*c, z) for z in (-1, 1) for c in _CORNERS]
    if kind == "hex20":
        rows += [(*m, z) for z in (-1, 1) for m in _MIDDLES] + [(*c, 0) for c in _CORNERS]
    return np.array(rows)


def _cells(mesh: Mesh, *, mirrored: bool) -> IntArray:
    """Nodes of all bricks in VTK's order; mirrored bricks run the other way around."""
    order = _order(mesh.size.kind) * (1, -1 if mirrored else 1, 1)
    ours = {tuple(row): k for k, row in enumerate(natural_nodes(mesh.size.kind).tolist())}
    take = [ours[tuple(row)] for row in order.tolist()]
    first = np.arange(mesh.layers)[:, None, None] * (mesh.ring + mesh.mid)
    cells: IntArray = (first + mesh.bricks[:, take]).reshape(-1, len(take))
    return cells


def _on_plane(mesh: Mesh) -> NDArray[np.bool_]:
    """Whether the plane of symmetry holds each node: (N,)."""
    rows = np.concatenate([mesh.fixed_ring, mesh.fixed_mid])[:, 0]
    return np.tile(rows, mesh.layers + 1)[: mesh.nodes]


def _mirror_nodes(mesh: Mesh) -> IntArray:
    """Give every node's mirror image: its own on the plane of symmetry, else a new one."""
    off = ~_on_plane(mesh)
    return np.where(off, mesh.nodes + np.cumsum(off) - 1, np.arange(mesh.nodes))


def _joints(mesh: Mesh) -> IntArray:
    """Give the number of the joint whose window each layer lies in, else 0: (layers,)."""
    middle = 0.5 * (mesh.z[1:] + mesh.z[:-1])
    numbers = np.zeros(mesh.layers, dtype=np.int64)
    for number, window in enumerate(mesh.actuator.windows, start=1):
        numbers[(middle > window.start) & (middle < window.end)] = number
    return numbers


def _swelling(mesh: Mesh, X: FloatArray, x: FloatArray) -> FloatArray:
    """Growth of every node's distance from the centre of its section: (N,) mm."""
    size = np.tile([mesh.ring, mesh.mid], mesh.layers + 1)[:-1]
    section = np.repeat(np.arange(len(size)), size)[: mesh.nodes]
    weight = np.tile(_width(mesh), mesh.layers + 1)[: mesh.nodes]
    total = np.bincount(section, weight)
    total[total == 0.0] = 1.0  # 8-node bricks have no mid nodes
    reach = []
    for nodes in (X, x):
        sums = [np.bincount(section, weight * nodes[:, k]) / total for k in range(3)]
        centre = np.stack(sums, axis=1)
        if mesh.half:
            centre[:, 0] = 0.0
        reach.append(np.linalg.norm(nodes - centre[section], axis=1))
    growth: FloatArray = reach[1] - reach[0]
    return growth


def _width(mesh: Mesh) -> FloatArray:
    """Share of the circumference that each node of a ring, then of a mid section, stands for."""
    widths = []
    for nodes in (mesh.X[0, : mesh.ring], mesh.X[0, mesh.ring :]):
        phi = np.round(np.arctan2(nodes[:, 1], nodes[:, 0]), 6)
        places, which, count = np.unique(phi, return_inverse=True, return_counts=True)
        if mesh.half:
            gaps = np.diff(places, prepend=places[:1], append=places[-1:])
        else:
            gaps = np.diff(places, prepend=places[-1:] - 2.0 * np.pi)
            gaps = np.append(gaps, gaps[:1])
        width = (0.5 * (gaps[1:] + gaps[:-1]) / count)[which]
        # What is left of the first moment goes, so that a tube at rest has its centre on the axis.
        across = nodes[:, 1:2] if mesh.half else nodes[:, :2]
        moment = (across * width[:, None]).T @ across
        widths.append(width - width * (across @ np.linalg.lstsq(moment, width @ across)[0]))
    return np.concatenate(widths)


def _array(name: str, values: NDArray[np.generic]) -> str:
    kind = _NAMES[values.dtype.str[1:]]
    wide = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    raw = values.tobytes()
    packed = zlib.compress(raw, 6)
    header = struct.pack("<4I", 1, len(raw), 0, len(packed))
    text = (base64.b64encode(header) + base64.b64encode(packed)).decode()
    return f'<DataArray type="{kind}" Name="{name}"{wide} format="binary">{text}</DataArray>'
