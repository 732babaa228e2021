"""A folder for each test, a design that tests share, and fewer files where they are not read."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest

from tests.cli.inputs import Made, unverified

# What tests of exit codes and notes look into.
FEW = (
    "design.json", "template.svg", "shape.csv", "mask.png", "theta_vs_pressure.csv",
    "actuator.vtu",
)  # fmt: skip


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def few_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """Write some files of a design only: drawings, plots and the report take longer than it."""
    from profiletool.report import outputs

    rows = {name: outputs.DESIGN_FILES[name] for name in FEW}
    monkeypatch.setattr(outputs, "DESIGN_FILES", rows)


@pytest.fixture
def coarse_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    """Solve on a coarse mesh: the commands are tested here, not the engine's error."""
    import fem

    coarse = partial(fem.solve, size=fem.MeshSize(beside=0.0, edge=0.4))
    for module in ("run", "grip"):
        monkeypatch.setattr(f"profiletool.verify.{module}.solve", coarse)


@pytest.fixture(scope="session")
def egg(samples: Path, tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Design for a picture with all files, without finite elements."""
    folder = tmp_path_factory.mktemp("egg") / "egg_design"
    result = unverified(
        samples / "egg.png", "--method", "paper", "--json", "--quiet", "--out", folder
    )
    assert result.exit_code == 0, result.stderr
    return Made(folder, result)
