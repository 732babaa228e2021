"""Single axial threads in the windows: what they carry, and the smeared gauze as their limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from fem import gauze
from fem.actuator import Actuator
from fem.assembly import System
from fem.errors import BadGeometry
from fem.gauze import AxialLines
from fem.mesh import Mesh, make_mesh
from fem.solver import solve
from tests.fem.tubes import COARSE, tube

FloatArray = NDArray[np.float64]

TUBE = tube()
ONE = 130.0  # N
AROUND = tuple(np.radians(np.arange(5.0, 360.0, 10.0)).tolist())


def single(*angles_deg: float, EA: float = ONE) -> Actuator:
    return replace(TUBE, lines=AxialLines((tuple(np.radians(angles_deg).tolist()),), EA))


def fine(count: int) -> Actuator:
    """Threads so thin and many that they are the smeared sector."""
    window, law = TUBE.windows[0], TUBE.gauze
    circle = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    apart = (circle - window.center + np.pi) % (2.0 * np.pi) - np.pi
    own = circle[np.abs(apart) < 0.5 * (window.alpha + law.allowance)]
    each = law.stiffness * 2.0 * np.pi * TUBE.radius / count
    return replace(TUBE, lines=AxialLines((tuple(own.tolist()),), each))


def pull(mesh: Mesh, stretch: float, layer: int) -> float:
    """Axial force of the threads on the upper nodes of a layer, N; all is stretched evenly."""
    x = mesh.X * [1.0, 1.0, stretch]
    nodes = mesh.outer + layer * (mesh.ring + mesh.mid)
    own = slice(layer * mesh.around, (layer + 1) * mesh.around)
    threads = gauze.Threads(mesh.axial.gradient[own], mesh.axial.weight[own])
    state = gauze.respond(mesh.actuator.gauze, threads, x.reshape(-1, 3)[nodes], False)
    upper = nodes >= (layer + 1) * (mesh.ring + mesh.mid)
    # What the middle nodes carry belongs to both ends: even strain leaves them unloaded.
    return float(state.force[..., 2][upper].sum())


@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize("angles", [(270.0,), (260.0, 280.0), (250.0, 270.0, 290.0)])
def test_threads_pull_as_springs_in_a_row(angles: tuple[float, ...], whole: bool) -> None:
    mesh = make_mesh(single(*angles), COARSE, whole)
    layer = int(np.flatnonzero(mesh.segment == 1)[0])
    e, d = 0.03, TUBE.gauze.transition
    taut = (1.0 - TUBE.gauze.slack) * (e - 0.5 * d) + TUBE.gauze.slack * e
    share = 1.0 if whole else 0.5
    assert pull(mesh, 1.0 + e, layer) == pytest.approx(share * len(angles) * ONE * taut, rel=1e-9)
    assert abs(pull(mesh, 1.0 - e, layer)) < 1e-2 * len(angles) * ONE * e  # slack


def test_threads_all_around_are_as_stiff_as_the_wrapped_tube() -> None:
    each = TUBE.gauze.stiffness * 2.0 * np.pi * TUBE.radius / len(AROUND)
    mesh = make_mesh(replace(TUBE, lines=AxialLines((AROUND,), each)), COARSE)
    layers = [int(np.flatnonzero(mesh.segment == k)[0]) for k in (0, 1)]
    wrapped, window = (pull(mesh, 1.02, layer) for layer in layers)
    assert window == pytest.approx(wrapped, rel=1e-9)
    # and as the gauze of the smeared tube, which the section's forces balance
    law = gauze.tension_law(TUBE.gauze, np.array(1.02))[1]
    assert wrapped == pytest.approx(
        0.5 * TUBE.gauze.stiffness * 2.0 * np.pi * TUBE.radius * float(law), rel=1e-9
    )


def test_many_thin_threads_are_the_smeared_sector() -> None:
    # So many Gauss points that it does not matter where they lie among slack and taut threads.
    size = replace(COARSE, orders=(2, 8, 2))
    smeared, thin, thick = (
        solve(actuator, [0.06], size, threads=1).states[-1].theta[0]
        for actuator in (TUBE, fine(720), fine(40))
    )
    assert thin == pytest.approx(smeared, rel=2e-3)
    assert abs(thick / smeared - 1.0) > 5e-3


def test_what_lies_alike_on_both_sides_needs_half_the_tube() -> None:
    assert single(250.0, 270.0, 290.0).in_plane
    assert single(-110.0, 290.0).in_plane  # the same, a turn further
    assert not single(250.0, 280.0).in_plane
    assert not make_mesh(single(250.0, 280.0), COARSE).half
    assert single().in_plane  # all cut


def test_the_half_and_the_whole_tube_agree() -> None:
    def energy(whole: bool) -> float:
        mesh = make_mesh(single(262.0, 270.0, 278.0), COARSE, whole)
        system = System(mesh, threads=1)
        try:
            found = system.forces(mesh.X * [1.0, 1.0, 1.02]).energy
        finally:
            system.close()
        return found

    assert 2.0 * energy(False) == pytest.approx(energy(True), rel=1e-9)


def test_threads_that_make_no_sense() -> None:
    with pytest.raises(BadGeometry, match="every window"):
        replace(TUBE, lines=AxialLines((), ONE))
    with pytest.raises(ValueError, match="stiffness above 0"):
        AxialLines(((0.0,),), 0.0)
