"""The report's part on what was measured and what is predicted: docs/measured.md in short."""

from __future__ import annotations

from profiletool.report.markup import Markup, joined, tag

_FACTS = (
    "Nothing on this page was measured: all is predicted, by finite elements, the joint response "
    "or a formula. No actuator of this project has been built yet.",
    "The paper measured three prototypes. The joints of its finger bend through 0 to 75°, 0 to "
    "100° and 0 to 65° below 2.0 bar. Beyond 1.5 bar they bend more than the paper's model says; "
    "our finite elements do so too, but by how much the prototypes do is not published as numbers.",
    "The paper's bulb mirrored its object well to the eye, with bulges and deviations; no distance "
    "was measured. By our finite elements it lies 11 mm RMS off the drawn shape.",
    "Formula (9) was fitted to the paper's finite elements, on a coarse mesh. A joint of α 84°, "
    "openF 10 mm bends 18.7° at 1.0 bar by it and by ours; at 2.0 bar 50.5° by it, 59.3° by ours.",
    "Nobody has measured the rubber of your batch, the stiffness and slip of the gauze, the shape "
    "of any actuator under pressure, the scatter from one to the next, or contact with an object.",
)


def measured() -> Markup:
    """Tell what was measured, and what was not."""
    listed = tag("ul", *(tag("li", fact) for fact in _FACTS))
    return joined((tag("h3", "What was measured, what we predict"), listed))
