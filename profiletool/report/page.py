"""Pages that hold all they need: style, script and pictures."""

from __future__ import annotations

from importlib.resources import files

from profiletool.report.markup import Markup, policy, tag


def asset(name: str) -> Markup:
    """Read a style sheet or a script that comes along."""
    return Markup(files("profiletool.report").joinpath(name).read_text("utf-8"))


def page(title: str, style: Markup, script: Markup, *body: Markup) -> bytes:
    """Write a page whose own script is the only one that may run."""
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=policy(script)),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("link", rel="icon", href="data:,"),
        tag("title", title),
        tag("style", style),
    )
    whole = tag("html", head, tag("body", *body), lang="en")
    return f"<!doctype html>\n{whole}\n".encode()
