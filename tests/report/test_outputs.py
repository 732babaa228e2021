"""Registries of files: which are written, in which order, and how one is added."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest

from profiletool.pipeline import Result
from profiletool.records.request import TubeSpec
from profiletool.report.outputs import (
    DESIGN_FILES,
    TEMPLATE_FILES,
    DesignOutput,
    fe_files,
    template_files,
)
from profiletool.report.registry import rows_of, written
from profiletool.template.kinds import Wish
from profiletool.verify.check import Check
from profiletool.verify.run import DOWN, LYING, Run, inflate
from profiletool.verify.tube import joint_actuator
from tests.report.dossiers import designed, made_up

TEMPLATES = ["template.dxf", "template.svg", "template.pdf"]
THETA = ["theta_vs_pressure.csv", "theta_vs_pressure.png"]
MESHES = ["actuator.vtu", "actuator.pvd", "actuator_00.vtu", "actuator_01.vtu"]


@pytest.fixture(scope="module")
def result(samples: Path) -> Result:
    return designed(samples / "finger_rest.csv")


@pytest.fixture(scope="module")
def run() -> Run:
    return inflate(joint_actuator(4.0, 144.0, 270.0, TubeSpec()), (0.1,), LYING, DOWN)


def some(output: DesignOutput, *names: str) -> dict[str, bytes]:
    """Files of a few rows only; all of them take seconds."""
    return written({name: DESIGN_FILES[name] for name in names}, output)


def checked(result: Result, run: Run, failure: str | None) -> DesignOutput:
    """As if finite elements had bent the tube, with another tube's meshes."""
    made = replace(run, verification=made_up(result.design))
    return DesignOutput(replace(result, check=Check(result.design, made, failure)))


def test_rows_are_written_in_their_order_where_there_is_something_to_write() -> None:
    rows = {
        "b.txt": lambda text: text.encode(),
        "a_{:02d}.txt": lambda text: [letter.encode() for letter in text],
        "absent.txt": lambda text: None,
        "empty.txt": lambda text: b"",
        **rows_of(lambda text: None, {"of_nothing.txt": lambda part: b"part"}),
        **rows_of(len, {"length.txt": lambda length: str(length).encode()}),
    }
    files = written(cast(Any, rows), "xy")
    assert list(files.items()) == [
        ("b.txt", b"xy"), ("a_00.txt", b"x"), ("a_01.txt", b"y"), ("empty.txt", b""),
        ("length.txt", b"2"),
    ]  # fmt: skip


def test_a_file_more_is_one_function_and_one_row(result: Result) -> None:
    def joints_md(output: DesignOutput) -> bytes:
        rows = [f"| {j.number} | {j.openF_mm:g} |" for j in output.result.design.joints]
        return "\n".join(["| joint | openF mm |", "|---|---|", *rows]).encode()

    assert "joints.md" not in DESIGN_FILES
    files = written(
        {"design.json": DESIGN_FILES["design.json"], "joints.md": joints_md}, DesignOutput(result)
    )
    assert list(files) == ["design.json", "joints.md"]
    assert files["joints.md"].count(b"\n") == 1 + len(result.design.joints)


def test_the_folder_of_a_design() -> None:
    assert list(DESIGN_FILES) == [
        "design.json", *TEMPLATES, "shape.csv", "mounting.dxf", "mounting.pdf", "overlay.png",
        "error_along_arc.png", "trade_off.csv", "trade_off.png", "mask.png", *THETA,
        "actuator.vtu", "actuator.pvd", "actuator_{:02d}.vtu", "report.html",
    ]  # fmt: skip


@pytest.mark.slow
def test_what_a_drawing_by_the_papers_method_without_finite_elements_lacks(
    result: Result,
) -> None:
    rows = {k: v for k, v in DESIGN_FILES.items() if k not in ("overlay.png", "report.html")}
    files = written(rows, DesignOutput(result))
    assert list(files) == [
        "design.json", *TEMPLATES, "shape.csv", "mounting.dxf", "mounting.pdf",
        "error_along_arc.png",
    ]  # fmt: skip
    assert files["template.svg"] == template_files(result.design)["template.svg"]


def test_a_run_that_ended_early_has_angles_but_no_mesh(result: Result, run: Run) -> None:
    names = ("shape.csv", *THETA, "actuator.vtu", "actuator.pvd", "actuator_{:02d}.vtu")
    early = some(checked(result, run, "limit point at 1.00 bar"), *names)
    assert list(early) == ["shape.csv", *THETA]
    whole = some(checked(result, run, None), *names)
    assert list(whole) == ["shape.csv", *THETA, *MESHES]
    assert b"\nfe," in whole["shape.csv"]
    assert b"\nfe," not in early["shape.csv"]
    nothing = replace(result, check=Check(result.design, None, "cannot be modelled"))
    assert list(some(DesignOutput(nothing), *names)) == ["shape.csv"]


def test_the_folder_of_a_run(run: Run) -> None:
    files = fe_files(run, "one joint", '{"a": 1}\n')
    assert list(files) == ["fe.json", *THETA, "shape.csv", *MESHES]
    assert files["fe.json"] == b'{"a": 1}\n'
    assert files["actuator.vtu"] == files["actuator_01.vtu"] != files["actuator_00.vtu"]
    assert all(f'"{name}"'.encode() in files["actuator.pvd"] for name in MESHES[2:])
    more = fe_files(run, "one joint", "", run.verification.rest.shape.axis, trajectories=True)
    assert list(more)[-1] == "trajectories.png"
    assert len(more["shape.csv"].splitlines()) > len(files["shape.csv"].splitlines())


@pytest.mark.slow
def test_a_template_is_asked_for_by_kind_paper_and_version(result: Result) -> None:
    assert list(TEMPLATE_FILES) == TEMPLATES
    plain = template_files(result.design)
    strip = template_files(result.design, Wish("strip"), "letter", "R12")
    assert all(plain[name] != strip[name] for name in TEMPLATES)
    assert b"AC1015" in plain["template.dxf"]
    assert b"AC1009" in strip["template.dxf"]
    dated = DesignOutput(result, Wish(date="1 May 2031"), "letter")
    files = some(dated, "template.svg", "template.pdf")
    assert files["template.svg"] != plain["template.svg"]
    assert files["template.pdf"] != some(replace(dated, paper="a4"), "template.pdf")["template.pdf"]
