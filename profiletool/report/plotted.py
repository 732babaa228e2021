"""A plot on a page: drawn in line, named for those who do not see it, and told below."""

from __future__ import annotations

from matplotlib.figure import Figure

from profiletool.report.figure import svg
from profiletool.report.markup import Markup, adopted, tag, text


def plotted(figure: Figure, name: str, said: str) -> Markup:
    """Put a figure on the page; ``name`` keeps its ids apart from those of others."""
    drawn = adopted(svg(figure), f"{name}-")
    named = Markup(drawn.replace("<svg", f'<svg role="img" aria-label="{text(said)}"', 1))
    return tag("figure", tag("div", named, class_="drawn"), tag("figcaption", said), class_="plot")
