"""A page taken apart."""

from __future__ import annotations

import json
from html.parser import HTMLParser

VOID = {"meta", "link", "input", "br", "img"}


class Page(HTMLParser):
    """What is in a page, and what is wrong with how it is written."""

    def __init__(self, source: bytes) -> None:
        super().__init__(convert_charrefs=True)
        self.source = source.decode()
        self.open: list[str] = []
        self.wrong: list[str] = []
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.texts: list[tuple[str, str]] = []
        self.feed(self.source)
        self.close()
        self.wrong += self.open

    def handle_starttag(self, name: str, attributes: list[tuple[str, str | None]]) -> None:
        if len({key for key, _ in attributes}) < len(attributes):
            self.wrong.append(f"{name}: an attribute twice")
        self.elements.append((name, {key: value or "" for key, value in attributes}))
        if name not in VOID:
            self.open.append(name)

    def handle_startendtag(self, name: str, attributes: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(name, attributes)
        if name not in VOID:
            self.open.pop()

    def handle_endtag(self, name: str) -> None:
        if not self.open or self.open.pop() != name:
            self.wrong.append(f"</{name}>")

    def handle_data(self, data: str) -> None:
        self.texts.append((self.open[-1] if self.open else "", data))

    def every(self, name: str) -> list[dict[str, str]]:
        return [attributes for element, attributes in self.elements if element == name]

    @property
    def text(self) -> str:
        """All that is to be read, spaces made single."""
        said = "".join(text for name, text in self.texts if name not in ("script", "style"))
        return " ".join(said.split())

    @property
    def states(self) -> dict[str, list[list[float]]]:
        """What the script is given; nothing where there is no script."""
        told = [text for name, text in self.texts if name == "script"]
        return dict(json.loads(told[0])) if told else {}


def spaced(page: Page) -> str:
    """All that is to be read, with a space between elements."""
    said = (text for name, text in page.texts if name not in ("script", "style"))
    return " ".join(" ".join(said).split())
