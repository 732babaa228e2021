"""A browser to look at pages with."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from profiletool.report.markup import MINUS
from tests.programs import program

WIDE, NARROW = 1280, 390


FLAGS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--hide-scrollbars",
)  # fmt: skip


@contextmanager
def started(profile: Path) -> Iterator[Browser]:
    """Start Chromium with a folder for its own files."""
    chromium, chromedriver = program("chromium"), program("chromedriver")
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service

    options = Options()
    options.binary_location = chromium
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(chromedriver))
    try:
        yield Browser(driver)
    finally:
        driver.quit()


@dataclass(frozen=True)
class Browser:
    """Chromium, and what it says of a page."""

    driver: Any

    def command(self, name: str, **parameters: object) -> Any:
        return self.driver.execute_cdp_cmd(name, parameters)

    def open(
        self, page: Path | str, width: int = WIDE, *, dark: bool = False, media: str = ""
    ) -> None:
        """Open a file or an address afresh; what was heard of earlier pages is forgotten."""
        self.command(
            "Emulation.setDeviceMetricsOverride",
            width=width, height=900, deviceScaleFactor=1, mobile=width == NARROW,
        )  # fmt: skip
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.command("Emulation.setEmulatedMedia", media=media, features=[scheme])
        self.driver.get("about:blank")
        self.driver.get_log("browser")
        self.driver.get_log("performance")
        self.driver.get(page if isinstance(page, str) else page.as_uri())

    def js(self, expression: str, *arguments: object) -> Any:
        return self.driver.execute_script(f"return {expression}", *arguments)

    def move(self, step: int) -> None:
        self.driver.execute_script(
            "const s = document.getElementById('slider'); s.value = arguments[0];"
            "s.dispatchEvent(new Event('input', {bubbles: true}))",
            step,
        )

    @property
    def tube(self) -> str:
        return str(self.js("document.getElementById('tube').getAttribute('d')"))

    @property
    def theta(self) -> list[float]:
        said = self.js("[...document.querySelectorAll('.theta')].map(e => e.textContent)")
        return [float(text.rstrip("°").replace(MINUS, "-")) for text in said]

    @property
    def bar(self) -> float:
        return float(self.js("document.querySelector('.readout .bar').textContent"))

    @property
    def asked(self) -> list[str]:
        """Addresses that the page asked for."""
        heard = (json.loads(entry["message"])["message"] for entry in self._log("performance"))
        return [
            message["params"]["request"]["url"]
            for message in heard
            if message["method"] == "Network.requestWillBeSent"
        ]

    @property
    def complaints(self) -> list[str]:
        return [entry["message"] for entry in self._log("browser")]

    def _log(self, name: str) -> list[dict[str, Any]]:
        return list(self.driver.get_log(name))
