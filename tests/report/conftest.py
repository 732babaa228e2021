"""Dossiers of two designs, their pages, and a browser."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from profiletool.report.dossier import Dossier
from profiletool.report.html import report_html
from tests.report.browser import Browser, started
from tests.report.dossiers import (
    designed,
    ended_early,
    infeasible,
    unverified,
    verified,
    with_joints,
)
from tests.report.pages import Page


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with started(tmp_path_factory.mktemp("chromium")) as ours:
        yield ours


@pytest.fixture(scope="module")
def finger(samples: Path) -> Dossier:
    """A drawn profile without a picture."""
    return unverified(designed(samples / "finger_rest.csv"))


@pytest.fixture(scope="module")
def egg(samples: Path) -> Dossier:
    """A picture."""
    return unverified(designed(samples / "egg.png"))


@pytest.fixture(scope="module")
def dossiers(finger: Dossier, egg: Dossier) -> dict[str, Dossier]:
    return {
        "verified": verified(egg),
        "not verified": egg,
        "infeasible": infeasible(verified(egg), "the first <reason>", "the second reason"),
        "infeasible, not verified": infeasible(egg, "the only reason"),
        "ended early": ended_early(egg, 0.5),
        "ended at once": ended_early(egg, 0.0),
        "drawn": verified(finger),
        "drawn, no FE": finger,
        "twelve joints": verified(with_joints(finger, 12)),
    }


KINDS = (
    "verified", "not verified", "infeasible", "infeasible, not verified", "ended early",
    "ended at once", "drawn", "drawn, no FE", "twelve joints",
)  # fmt: skip


@pytest.fixture(scope="module")
def pages(dossiers: dict[str, Dossier]) -> dict[str, Page]:
    return {kind: Page(report_html(dossier)) for kind, dossier in dossiers.items()}


@pytest.fixture(params=KINDS)
def page(pages: dict[str, Page], request: pytest.FixtureRequest) -> Page:
    return pages[request.param]
