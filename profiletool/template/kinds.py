"""Kinds of template and their words: a sheet of gauze, a sleeve's pattern, a paper strip."""

from __future__ import annotations

from dataclasses import dataclass

from profiletool.joints.roll import Variant

_CUT = (
    "Cut the blue lines only: they sever the axial threads. Do not remove the windows. "
    "The hoop threads stay whole."
)
_WELD = "Weld the layers together beside the cuts, so that they cannot slip."
_MEASURE = "at 100 %. Measure bar and box."


@dataclass(frozen=True)
class Wish:
    """What a template is asked to be.

    Attributes
    ----------
    variant : {"gauze", "sleeve", "strip"}
    kerf_mm : float
        Width that the beam or blade takes away.
    date : str
        As it shall be printed; the sheet itself knows no time.
    """

    variant: Variant = "gauze"
    kerf_mm: float = 0.0
    date: str = ""


PLAIN = Wish()


@dataclass(frozen=True)
class TemplateKind:
    """What a kind of template says.

    Attributes
    ----------
    title, piece : str
        Of the drawing, and of the piece in its data.
    start, end : str
        What becomes of the edges y = 0 and y = roll length.
    register : tuple of str
        What stands at the register line; empty where there is none.
    steps : tuple of str
        How to work with it, a sentence or two each; ``{seam}``, ``{diameter}``, ``{size}`` and
        ``{times}`` are filled in.
    tab_mm : float
        How far the piece goes on beyond its end edge.
    """

    title: str
    piece: str
    start: str
    end: str
    register: str
    steps: tuple[str, ...]
    tab_mm: float = 0.0


KINDS: dict[Variant, TemplateKind] = {
    "gauze": TemplateKind(
        title="Cut template",
        piece="Gauze",
        start="Start edge: glue to tube",
        end="End edge: weld on register line",
        register="Register line: weld end edge here",
        steps=(
            f"Plot {_MEASURE}",
            "Cut the black outline with its notch: straight side at x = 0, the clamp's edge.",
            _CUT,
            "Lay the sheet this face up, the tube on top. Glue the start edge on the tube's "
            "{seam}° line.",
            "Roll {times}, tight: the cuts of all turns must lie over each other.",
            "Weld the end edge on the register line.",
            _WELD,
        ),
    ),
    "sleeve": TemplateKind(
        title="Sleeve template",
        piece="Sleeve, cut open",
        start="Start edge: on the sleeve's seam line",
        end="End edge: meets the start edge",
        register="",
        steps=(
            f"Plot {_MEASURE}",
            "By hand: pull the sleeve over a rod of {diameter} mm, cut the black outline, wrap it "
            "around, this face outside. On a rotary cutter: x along the rod, y around it, as seen "
            "from outside.",
            _CUT,
            "Pull the sleeve over the tube, up to its open end: the notch's straight side is "
            "x = 0, the clamp's edge. Seam line on the tube's {seam}° line.",
            "Fasten both ends. It must neither turn nor slide.",
        ),
    ),
    "strip": TemplateKind(
        title="Marking strip",
        piece="Paper",
        start="Start edge: on the weld line",
        end="Tab: over the start edge, register line on it",
        register="Register line: meets start edge",
        tab_mm=8.0,
        steps=(
            f"Print {_MEASURE}",
            "Roll gauze of {size} mm {times} around the tube: glued on its {seam}° line, welded "
            "there at the end.",
            "Cut the strip out with its notch: its straight side is x = 0, the clamp's edge. Wrap "
            "it around the gauze from the open end on, this face outside, start edge on the weld "
            "line. Tape the tab down.",
            "Prick through both ends of each blue line. Take the strip off.",
            "Cut from prick to prick with fine scissors, all layers: they sever the axial threads. "
            "The hoop threads stay whole.",
            _WELD,
        ),
    ),
}
