"""The derivation of a formula from a campaign of one-joint runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from fem.errors import BadGeometry
from fem.material import Law
from formula.data import Data
from formula.errors import BadFormula
from formula.files import campaign_of, parse_formula, read_bytes
from formula.fit import Errors, FittedForm, PaperFit, best, candidates, errors_of, fit_paper
from formula.similar import carried, corrected, correction_runs
from formula.theta import Formula, Terms, theta_deg
from profiletool.campaign.runs import Model, Outcome, Task, actuator_of
from profiletool.errors import NotVerified, UnreadableInput, UsageError
from profiletool.records.rubber import law_of
from profiletool.records.units import FloatArray
from profiletool.rubber.presets import Rubber
from profiletool.rubber.uniaxial import uniaxial_stress

RunAll = Callable[[Sequence[Task]], list[Outcome]]
_MOST_RUNS = 10_000
_SAME = 0.02  # how far shape and kind of rubber may differ and still count as the same
_PULLED = np.array([1.25, 2.0, 3.0])  # stretches at which kinds of rubber are compared


@dataclass(frozen=True)
class CampaignPlan:
    """The tube, the rubber and the axes of a campaign.

    Attributes
    ----------
    diameter_mm, wall_mm : float
        Of the tube.
    rubber : Rubber
    alpha_deg, openF_mm, pressures_bar : tuple of float
        Ascending.
    model : {"converged", "paper"}
        How the joint is modelled; see `profiletool.campaign.runs.Task`.
    """

    diameter_mm: float
    wall_mm: float
    rubber: Rubber
    alpha_deg: tuple[float, ...]
    openF_mm: tuple[float, ...]
    pressures_bar: tuple[float, ...]
    model: Model = "converged"

    def task(self, i: int, j: int) -> Task:
        """Make the task of the i-th alpha and the j-th openF."""
        return Task(
            openF_mm=self.openF_mm[j],
            alpha_deg=self.alpha_deg[i],
            diameter_mm=self.diameter_mm,
            wall_mm=self.wall_mm,
            rubber=self.rubber.law,
            pressures_bar=self.pressures_bar,
            model=self.model,
        )


@dataclass(frozen=True)
class Base:
    """A known campaign to start from."""

    formula: Formula
    data: Data


@dataclass(frozen=True)
class Derivation:
    """A campaign and what was made of it.

    Attributes
    ----------
    plan : CampaignPlan
    base : Base or None
    made : Data
        The angles of the runs that were made.
    data : Data
        What was fitted: the same, or a known campaign brought onto them.
    dx_mm, dy_mm : (A, O, N)
        The joint's rigid motion, see `profiletool.campaign.runs.Outcome`.
    failures : tuple of (alpha_deg, openF_mm, reason)
        Runs that ended early.
    paper : PaperFit or None
        None where the campaign is too small for the paper's steps.
    paper_errors : Errors or None
    forms : tuple of FittedForm
        All that were tried.
    chosen : FittedForm
    """

    plan: CampaignPlan
    base: Base | None
    made: Data
    data: Data
    dx_mm: FloatArray
    dy_mm: FloatArray
    failures: tuple[tuple[float, float, str], ...]
    paper: PaperFit | None
    paper_errors: Errors | None
    forms: tuple[FittedForm, ...]
    chosen: FittedForm


def load_base(name: str) -> Base:
    """Read the campaign in a formula file.

    Parameters
    ----------
    name : str
        Path of the file, or the name of a formula that comes along.

    Raises
    ------
    UnreadableInput
        When the file is no formula file.
    UsageError
        When it holds no campaign.
    """
    try:
        data = read_bytes(name)
        formula, campaign = parse_formula(data, name), campaign_of(data, name)
    except BadFormula as error:
        raise UnreadableInput(str(error)) from error
    if campaign is None:
        raise UsageError(f"{name} holds no campaign to start from; derive one without `base` first")
    return Base(formula, campaign)


def derive(plan: CampaignPlan, run_all: RunAll, base: Base | None = None) -> Derivation:
    """Run a campaign and fit a formula to it.

    Parameters
    ----------
    plan : CampaignPlan
    run_all : callable
        Tasks to their outcomes, in order.
    base : Base, optional
        A known campaign that is carried over by similarity and corrected by few runs.

    Returns
    -------
    Derivation

    Raises
    ------
    NotVerified
        When too few runs get anywhere.
    UsageError
        When the known campaign does not reach as far as is asked for.
    """
    grid = list(product(range(len(plan.alpha_deg)), range(len(plan.openF_mm))))
    axes = [np.array(v) for v in (plan.alpha_deg, plan.openF_mm, plan.pressures_bar)]
    guess = None if base is None else _guess(plan, base, axes)
    if base is not None:
        grid = correction_runs(axes[0], axes[1])
    outcomes = run_all([plan.task(i, j) for i, j in grid])
    theta, dx, dy = (np.full([len(axis) for axis in axes], np.nan) for _ in range(3))
    failures = []
    for (i, j), outcome in zip(grid, outcomes, strict=True):
        n = len(outcome.theta_deg)
        theta[i, j, :n] = outcome.theta_deg
        dx[i, j, :n], dy[i, j, :n] = outcome.dx_mm, outcome.dy_mm
        if outcome.failure is not None:
            failures.append((plan.alpha_deg[i], plan.openF_mm[j], outcome.failure))
    made = Data(axes[0], axes[1], axes[2], theta)
    data = made if guess is None else corrected(guess, made, made)
    try:
        forms = candidates(data)
    except BadFormula as error:
        raise NotVerified(_too_little(error, failures)) from error
    try:
        paper = fit_paper(data)
        paper_errors = errors_of(data, _predictor(plan, paper.terms))
    except BadFormula:
        paper, paper_errors = None, None
    return Derivation(
        plan, base, made, data, dx, dy, tuple(failures), paper, paper_errors, forms, best(forms)
    )


def formula_of(plan: CampaignPlan, terms: Terms) -> Formula:
    """Make a formula of terms, valid for the plan's tube and the range that it covers."""
    return Formula(
        "", "", "", terms, plan.diameter_mm, plan.wall_mm,
        (plan.alpha_deg[0], plan.alpha_deg[-1]),
        (plan.openF_mm[0], plan.openF_mm[-1]),
        (0.0, plan.pressures_bar[-1]),
    )  # fmt: skip


def check_plan(plan: CampaignPlan) -> None:
    """Refuse a tube or a cut that cannot be, before anything is run.

    Raises
    ------
    UsageError
    """
    runs = len(plan.alpha_deg) * len(plan.openF_mm)
    if runs > _MOST_RUNS:
        raise UsageError(f"{runs} joints are too many, more than {_MOST_RUNS}; name fewer")
    for i, j in product(range(len(plan.alpha_deg)), range(len(plan.openF_mm))):
        try:
            actuator_of(plan.task(i, j))
        except BadGeometry as error:
            raise UsageError(str(error)) from error


def _guess(plan: CampaignPlan, base: Base, axes: Sequence[FloatArray]) -> FloatArray:
    law, known = plan.rubber.law, law_of(base.formula.rubber)
    guess = carried(
        base.data, axes[0], axes[1], axes[2],
        plan.diameter_mm / base.formula.outer_diameter_mm,
        law.shear_modulus / known.shear_modulus,
    )  # fmt: skip
    if not np.isfinite(guess).any():
        raise UsageError(
            f'the campaign of "{base.formula.name}" does not reach to these alphas and pressures '
            "(over the rubber's stiffness); leave out `base`"
        )
    missing = ~np.isfinite(guess).all(axis=(0, 1))
    if missing.any():
        raise UsageError(
            f'the campaign of "{base.formula.name}" reaches, for this rubber, to less than '
            f"{axes[2][missing][0]:g} bar or not to all alphas; lower `max_pressure_bar` or leave "
            "out `base`"
        )
    return guess


def similar(plan: CampaignPlan, base: Base) -> bool:
    """Whether tube and rubber are those of a known campaign but for scale, within 2 %."""

    def numbers(diameter: float, wall: float, law: Law) -> tuple[float, ...]:
        # Mooney's plot, stress / (lam - lam^-2) over the stiffness, tells laws apart.
        plot = uniaxial_stress(law, _PULLED) / (_PULLED - _PULLED**-2.0) / law.shear_modulus
        return wall / diameter, *plot.tolist(), law.bulk_modulus / law.shear_modulus

    known = base.formula
    pairs = zip(
        numbers(plan.diameter_mm, plan.wall_mm, plan.rubber.law),
        numbers(known.outer_diameter_mm, known.wall_mm, law_of(known.rubber)),
        strict=True,
    )
    return all(abs(a / b - 1.0) <= _SAME for a, b in pairs)


def _predictor(plan: CampaignPlan, terms: Terms) -> Callable[..., FloatArray]:
    formula = formula_of(plan, terms)

    def predict(alpha: FloatArray, openF: FloatArray, P: FloatArray) -> FloatArray:
        return theta_deg(formula, alpha, openF, P)

    return predict


def _too_little(error: BadFormula, failures: Sequence[tuple[float, float, str]]) -> str:
    first = f" (first: alpha {failures[0][0]:g}: {failures[0][2]})" if failures else ""
    return f"{error}; {len(failures)} runs ended early{first}; lower `max_pressure_bar`"
