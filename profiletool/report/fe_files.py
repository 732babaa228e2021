"""Files of a finite-element run: angles, shapes and the deformed mesh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from fem.export.vtu import write_pvd, write_vtu
from profiletool.profile.shape_csv import shape_csv
from profiletool.records.units import BAR_PER_MPA, FloatArray
from profiletool.report.fe import theta_csv
from profiletool.report.figure import png
from profiletool.report.plots import Mark, theta_figure, trajectories_figure
from profiletool.report.registry import Writers
from profiletool.verify.run import Run

_MESH = "actuator_{:02d}.vtu"


@dataclass(frozen=True)
class FeOutput:
    """All that the files of a finite-element run are written from.

    Attributes
    ----------
    run : Run
    title : str
        For the pictures.
    marks : sequence of Mark
        Angles to compare with.
    told : str
        The run as JSON, as it is printed.
    target : (N, 2) mm, optional
        Profile that the tube shall follow.
    trajectories : bool
        Whether the ways of the phalanges are drawn.
    """

    run: Run
    title: str
    marks: Sequence[Mark] = ()
    told: str = ""
    target: FloatArray | None = None
    trajectories: bool = False

    @cached_property
    def meshes(self) -> list[bytes]:
        """The deformed mesh at rest and at every pressure, as VTU."""
        solution = self.run.solution
        return [write_vtu(solution.mesh, state.x) for state in solution.states]


def _theta_png(output: FeOutput) -> bytes:
    return png(theta_figure(output.run.verification, output.title, output.marks))


def _fe_shapes(output: FeOutput) -> bytes:
    found = output.run.verification
    lines = {} if output.target is None else {"target": output.target}
    return shape_csv(lines | {"rest": found.rest.shape.facing, "fe": found.last.shape.facing})


def _mesh_series(output: FeOutput) -> bytes:
    pressures_bar = [BAR_PER_MPA * state.pressure for state in output.run.solution.states]
    return write_pvd([(bar, _MESH.format(k)) for k, bar in enumerate(pressures_bar)])


def _trajectories(output: FeOutput) -> bytes | None:
    if not output.trajectories:
        return None
    return png(trajectories_figure(output.run.verification, output.title))


THETA_FILES: Writers[FeOutput] = {
    "theta_vs_pressure.csv": lambda output: theta_csv(output.run.verification),
    "theta_vs_pressure.png": _theta_png,
}
# For ParaView: the mesh at the highest pressure, and all as a series.
MESH_FILES: Writers[FeOutput] = {
    "actuator.vtu": lambda output: output.meshes[-1],
    "actuator.pvd": _mesh_series,
    _MESH: lambda output: output.meshes,
}
FE_FILES: Writers[FeOutput] = {
    "fe.json": lambda output: output.told.encode(),
    **THETA_FILES,
    "shape.csv": _fe_shapes,
    **MESH_FILES,
    "trajectories.png": _trajectories,
}
