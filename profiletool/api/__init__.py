"""The library: designs from Python, in a script or a notebook."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from profiletool.campaign.derive import (
    Base,
    CampaignPlan,
    Derivation,
    check_plan,
    derive,
    load_base,
)
from profiletool.campaign.runs import JOINT_RUN
from profiletool.campaign.store import Store, default_folder
from profiletool.campaign.workers import run_all
from profiletool.errors import UsageError
from profiletool.files.design_json import load_design
from profiletool.files.formula import formula_for, named_formula, read_formula
from profiletool.joints.closest import spaced
from profiletool.joints.optimal_method import optimal_plan
from profiletool.joints.paper_method import paper_plan
from profiletool.joints.plan import Plan
from profiletool.pipeline import Result, run, run_again
from profiletool.records.built import BuildErrors
from profiletool.records.design import Design
from profiletool.records.edit import Edit
from profiletool.records.making import check_request, request_of
from profiletool.records.picture import Picture
from profiletool.records.profile import DrawnLine, Profile
from profiletool.records.request import Request
from profiletool.records.seal import sealed
from profiletool.subject.find import Subject
from profiletool.subject.find import find_subject as find
from profiletool.subject.given import given_of
from profiletool.subject.recall import profile_of
from profiletool.verify.check import Check, check, runs_into_itself, withdrawn
from profiletool.verify.errors import with_errors
from profiletool.verify.recompute import recomputed

Source = str | PathLike[str] | ArrayLike | Picture | DrawnLine | Profile
Say = Callable[[str], None]
Progress = Callable[[float], None]


def design(
    source: Source | Request,
    *,
    say: Say | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> Result:
    """Design an actuator that mirrors the side of an object.

    Parameters
    ----------
    source : path, array, Picture, DrawnLine or Profile
        A picture or drawing as the command `design` takes it; (H, W, 3), (H, W, 4) or (H, W)
        uint8 for a picture in RGB, RGBA or grey; (N, 2) for the points of a drawn line, mm, y up,
        closed where the last point repeats the first (what makes such an array will do, as a list
        of points or an image of Pillow); or a profile to follow as it is.
    say : callable, optional
        Takes one line of progress at a time.
    progress : callable, optional
        Takes the share of all that is done, 0 to 1.
    **options
        Options by field name: ``height_mm=107.5``, ``side="right"``, ``joints=5``,
        ``max_pressure_bar=1.5``, ``verify=False``; see `profiletool.records.options.DESIGN`.

    Returns
    -------
    Result
        ``print(result)`` shows the joints; ``result.design`` is what design.json holds.

    Raises
    ------
    ProfiletoolError
        Of the class that tells what is wrong; a design that is infeasible or not verified is no
        error but says so.
    """
    return run(request_for(source, **options), say or _silence, progress)


def design_again(
    file: Path | str,
    *,
    edits: Sequence[Edit] = (),
    refine: bool = False,
    pressure_bar: float | None = None,
    formula: Path | None = None,
    say: Say | None = None,
    progress: Progress | None = None,
) -> Result:
    """Take a design up again: change or correct it where asked, verify it and judge it anew.

    Parameters
    ----------
    file : Path or str
        A design.json, with shape.csv or the drawing beside it.
    edits, refine, pressure_bar
        As for `profiletool.pipeline.run_again`.
    formula : Path, optional
        As for `verify_design`.
    say, progress : callable, optional
        As for `design`.

    Raises
    ------
    UsageError, UnreadableInput
    """
    design, place = load_design(file), Path(file)
    known = named_formula(design.formula.name) if formula is None else read_formula(formula)
    profile, say = profile_of(design, place), say or _silence
    return run_again(
        design, profile, known, say, progress, edits=edits, refine=refine, pressure_bar=pressure_bar
    )


def find_subject(source: Source | Request, *, say: Say | None = None, **options: Any) -> Subject:
    """Find the object and the profile that a tube shall follow: the first step of `design`.

    Parameters
    ----------
    source, say, **options
        As for `design`.

    Returns
    -------
    Subject
        With the silhouette, the scale and the profile (mm).

    Raises
    ------
    UnreadableInput, NoScale, NoObject, UsageError
    """
    request = request_for(source, **options)
    check_request(request)
    return find(request, say or _silence)


def plan_joints(profile: Profile, *, say: Say | None = None, **options: Any) -> Plan:
    """Choose joints and pressure for a profile, without finite elements: the second step.

    Parameters
    ----------
    profile : Profile
        Such as ``find_subject(...).profile``.
    say, **options
        As for `design`.

    Returns
    -------
    Plan
        ``plan.layout`` holds the joints (mm, deg) and the pressure (bar).

    Raises
    ------
    UsageError, NoObject, Infeasible
    """
    request = request_for(profile, **options)
    check_request(request)
    formula = formula_for(request)
    make = optimal_plan if request.method == "optimal" else paper_plan
    return make(request, profile, formula, say or _silence)


def verify_design(
    design: Design,
    target: Profile | NDArray[np.float64],
    *,
    formula: Path | None = None,
    progress: Callable[[float], None] | None = None,
) -> Check:
    """Run finite elements of a whole design, such as one with a joint changed by hand.

    Parameters
    ----------
    design : Design
        Joints by their places: ``F_mm`` and the root follow from ``centre_mm``.
    target : Profile, or (N, 2) mm
        What the object-facing line shall lie on, in the object frame.
    formula : Path, optional
        For the formula's own angles; by default the design's where it comes along, else the
        paper's.
    progress : callable, optional
        Takes the pressure reached so far, bar.

    Returns
    -------
    Check
        ``check.design`` with the angles and the misfit by formula and by FE, what to expect of
        the built actuator, the trim table, and whether it is ``verified``; ``check.failure`` says
        why not.

    Raises
    ------
    UnreadableInput
        The file holds no formula, or a joint bends out of the plane, which no formula follows.
    """
    points = np.asarray(target.points if isinstance(target, Profile) else target, dtype=float)
    known = named_formula(design.formula.name) if formula is None else read_formula(formula)
    done = check(recomputed(design, points, known), points, progress)
    if done.run is None or done.shape is None:
        return done
    if failure := runs_into_itself(done.run.verification.last):
        return withdrawn(done, failure)
    build = BuildErrors() if design.built is None else design.built.build
    expected = with_errors(done.design, done.run, spaced(points), build)
    return replace(done, design=sealed(expected.design))


def derive_formula(
    plan: CampaignPlan,
    *,
    base: str | Base | None = None,
    workers: int = 1,
    scheduler: str | None = None,
    runs: Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Derivation:
    """Derive a formula for a tube and a rubber from finite elements of single joints.

    Parameters
    ----------
    plan : CampaignPlan
        The tube (mm), the rubber, and the axes of the campaign (deg, mm, bar).
    base : str or Base, optional
        A formula file, or "fe", whose campaign is carried over by similarity.
    workers : int
        Processes, one thread each.
    scheduler : str, optional
        A dask.distributed scheduler to run on instead, tcp://HOST:PORT.
    runs : Path, optional
        Folder of finished runs; the user's cache by default.
    progress : callable, optional
        Takes how many runs are done, and of how many.

    Returns
    -------
    Derivation
        ``formula_file(derivation, name)`` gives the bytes of the formula file.

    Raises
    ------
    UsageError, UnreadableInput, NotVerified
    """
    check_plan(plan)
    known = load_base(base) if isinstance(base, str) else base
    store = Store(runs or default_folder(), JOINT_RUN)
    return derive(
        plan,
        lambda tasks: run_all(
            tasks, store, workers=workers, scheduler=scheduler, progress=progress
        ),
        known,
    )


def request_for(source: Source | Request, **options: Any) -> Request:
    """Request for what `design` takes.

    Raises
    ------
    UsageError
        An array or an option that makes no sense.
    """
    if isinstance(source, Request):
        if options:
            raise UsageError("a request holds all options: give it none beside")
        return source
    formula = read_formula(_path(options.get("formula")), bool(options.get("extrapolate", False)))
    options |= {name: _path(options.get(name)) for name in ("formula", "mask")}
    if isinstance(source, str | PathLike):
        return request_of(Path(source), options, formula)
    if isinstance(source, Picture | DrawnLine | Profile):
        given = source
    else:
        given = given_of(np.asarray(source))
    if isinstance(given, Profile):
        options["side"] = given.side
    file = Path("picture" if isinstance(given, Picture) else "profile")
    return replace(request_of(file, options, formula), given=given)


def _path(name: str | PathLike[str] | None) -> Path | None:
    return None if name is None else Path(name)


def _silence(line: str) -> None:
    del line
