"""Dossiers of two designs, their pages, and a browser."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from profiletool.report.dossier import Dossier
from profiletool.report.html import report_html
from tests.programs import program
from tests.report.browser import FLAGS, Browser
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
    chromium, chromedriver = program("chromium"), program("chromedriver")
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service

    options = Options()
    options.binary_location = chromium
    for flag in (*FLAGS, f"--user-data-dir={tmp_path_factory.mktemp('chromium')}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(chromedriver))
    try:
        yield Browser(driver)
    finally:
        driver.quit()


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
