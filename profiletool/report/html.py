"""The report: one page that opens from disk, with no network and no file but itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import PurePath

from profiletool.records.fe import Verification
from profiletool.records.seal import proven
from profiletool.report.dossier import Dossier
from profiletool.report.error import error_figure
from profiletool.report.expectation import expectation
from profiletool.report.film import Film, film_of, still_of
from profiletool.report.gripping import gripping
from profiletool.report.markup import Markup, adopted, joined, pairs, tag
from profiletool.report.measured import measured
from profiletool.report.neighbours import neighbours
from profiletool.report.page import asset, page
from profiletool.report.plots import theta_figure
from profiletool.report.plotted import plotted
from profiletool.report.stage import controls, legend, readout, stage
from profiletool.report.steps import steps
from profiletool.report.tables import joint_table, loads, provenance, sensitivity_table
from profiletool.report.tradeoff import trade_off_figure
from profiletool.report.trimming import trimming
from profiletool.verdict.summary import built_text, off_text


def report_html(dossier: Dossier) -> bytes:
    """Write the report: the same dossier gives the same bytes."""
    name = _name(dossier)
    style, states, motion = (asset(name) for name in ("report.css", "film.js", "report.js"))
    # A page from disk has no modules.
    script = Markup(states.replace("\nexport ", "\n") + motion)
    film = _film(dossier)
    sections = _sections(dossier, film)
    moves = dossier.found is not None and film.moves
    return page(
        f"{name}: bending actuator", style, script,
        _header(dossier, sections),
        tag("main", *(section.drawn() for section in sections)),
        *([_states(film), tag("script", script)] if moves else []),
    )  # fmt: skip


@dataclass(frozen=True)
class _Section:
    """A part of the page; ``id`` is what links call it."""

    id: str
    title: str
    body: Markup

    def drawn(self) -> Markup:
        return tag(
            "section", tag("h2", self.title, id=f"{self.id}-title"), self.body, id=self.id,
            aria_labelledby=f"{self.id}-title",
        )  # fmt: skip


def _sections(dossier: Dossier, film: Film) -> list[_Section]:
    scene, found = dossier.scene, dossier.found
    design = scene.design
    parts = [
        _Section("shape", "Shape under pressure", _shape(dossier, film)),
        _Section("joints", "Joints", joint_table(design, scene.places)),
        _Section("error", "Distance to the profile", _error(dossier)),
    ]
    notes = _notes(dossier)
    if notes:
        listed = tag("ul", *(tag("li", note) for note in notes), class_="notes")
        parts.insert(1, _Section("notes", "What to know", listed))
    if found is not None:
        parts.append(_Section("pressure", "Angles and loads", _pressure(dossier, found)))
    if dossier.trade_off is not None:
        figure = trade_off_figure(dossier.trade_off, design)
        said = (
            "Distance to the profile that the best choice of joints leaves, as the "
            f"{scene.by} predicts it, for every number of joints and every pressure."
        )
        parts.append(
            _Section("trade-off", "More joints, more pressure", plotted(figure, "to", said))
        )
    if design.neighbours:
        told = neighbours(design, dossier.request)
        parts.append(_Section("neighbours", "Neighbours of this design", told))
    parts.append(_Section("build", "How to build it", _build(dossier)))
    if design.trim:
        parts.append(
            _Section("setting", "Setting the pressure", trimming(design, dossier.most_bar))
        )
    parts.append(_Section("template", "Cut template", _template(dossier)))
    if design.built is not None:
        parts.append(_Section("built", "What to expect of the built actuator", expectation(design)))
    if dossier.grip is not None and dossier.grip.states:
        told = gripping(dossier.grip, design, scene.profile.points)
        parts.append(_Section("grip", "Against its object", told))
    if design.sensitivity:
        parts.append(_Section("sensitivity", "What small errors do", sensitivity_table(design)))
    told = provenance(design, found, dossier.options)
    parts.append(_Section("provenance", "Where this comes from", joined((told, measured()))))
    return parts


def _header(dossier: Dossier, sections: Sequence[_Section]) -> Markup:
    links = (tag("li", tag("a", part.title, href=f"#{part.id}")) for part in sections)
    return tag(
        "header",
        tag("p", "Pneumatic bending actuator for", class_="eyebrow"),
        tag("h1", tag("bdi", _name(dossier))),
        _verdict(dossier),
        _facts(dossier),
        tag("nav", tag("ul", *links), aria_label="Parts of this report"),
    )


def _verdict(dossier: Dossier) -> Markup:
    """Say at a glance whether the design can be trusted."""
    design = dossier.scene.design
    fit, pressure = design.fit, f"{design.pressure_bar:.2f} bar"
    lines: list[Markup] = []
    if not design.feasible:
        lines.append(tag("p", "INFEASIBLE: best attempt", class_="word"))
        lines.append(tag("ul", *(tag("li", reason) for reason in dossier.reasons)))
    if dossier.unverified is not None:
        lines.append(tag("p", "NOT VERIFIED", class_="word"))
        lines.append(tag("p", f"Reason: {dossier.unverified}."))
        best = fit.response or fit.formula
        by = "joint response" if fit.response is not None else "formula"
        lines.append(tag("p", f"By the {by} {off_text(best)} off the profile at {pressure}."))
    elif fit.fe is not None:
        if design.feasible:
            lines.append(tag("p", "Verified by finite elements (FE)", class_="word"))
        said = f"{off_text(fit.fe)} off the profile at {pressure}, with perfect parts"
        lines.append(tag("p", said if design.feasible else f"By finite elements (FE) {said}."))
        if design.built is not None:
            lines.append(tag("p", f"Built by hand: {built_text(design.built)}."))
    good = design.feasible and proven(design)
    return tag("div", *lines, class_=f"verdict {'good' if good else 'bad'}", id="verdict")


def _facts(dossier: Dossier) -> Markup:
    design = dossier.scene.design
    tube, source, joints = design.tube, design.source, design.joints
    away = sum(joint.away for joint in joints)
    rows = [
        ("Pressure", f"{design.pressure_bar:.2f} bar"),
        ("Joints", f"{len(joints)}" + (f" ({away} away)" if away else "")),
        (
            "Tube, D × wall × length",
            f"{tube.outer_diameter_mm:g} × {tube.wall_mm:g} × {tube.length_mm:.1f} mm",
        ),
        (f"Profile, {source.side} side", f"{source.profile_length_mm:.1f} mm"),
    ]
    found = dossier.found
    if found is not None and dossier.unverified is None:
        rows.append(("Air", f"{found.last.air_ml:.1f} ml"))
        rows.append(("Rubber, stretched", f"{found.last.largest_stretch:.2f} times"))
    return pairs(rows, "facts")


def _notes(dossier: Dossier) -> list[str]:
    """Give the warnings that the verdict does not say already."""
    warnings = dossier.scene.design.warnings
    return [
        note
        for note in warnings
        if note not in dossier.reasons and not note.startswith("NOT VERIFIED")
    ]


def _film(dossier: Dossier) -> Film:
    scene, found = dossier.scene, dossier.found
    if found is None:
        return still_of(scene.bent, scene.design)
    return film_of(found, scene.design, dossier.grip)


def _shape(dossier: Dossier, film: Film) -> Markup:
    scene, by_fe = dossier.scene, dossier.found is not None
    moving = [controls(film)] if by_fe and film.moves else []
    aside = [readout(film)] if moving else []
    if moving:
        said = (
            "The slider's ticks are the pressures that finite elements were run at; between them "
            "the shape is interpolated."
        )
        if film.shown < len(film.lines) - 1:
            said += f" Beyond {film.pressure_bar[film.shown]:.2f} bar the object is in the way."
        aside.append(tag("p", said, class_="small screen"))
    if dossier.unverified is not None:
        aside.append(tag("p", _short_of(dossier), class_="mind"))
    caption = tag("figcaption", legend(scene, film, by_fe=by_fe))
    picture = tag("figure", stage(scene, film, by_fe=by_fe), *moving, caption)
    if moving:
        said = "A slider that inflates the tube would be here, but scripts are off."
        aside.append(tag("p", said, class_="small screen", id="still"))
    return tag("div", picture, tag("div", *aside, class_="aside"), class_="beside")


def _short_of(dossier: Dossier) -> str:
    """Say what the stage shows of a design that is not verified."""
    found, check = dossier.found, dossier.check
    failure = None if check is None else check.failure
    if found is None:
        said = "No finite elements were run" if failure is None else f"Finite elements: {failure}"
        return f"{said}. The tube is drawn as the {dossier.scene.by} bends it."
    shown = f"up to {found.last.pressure_bar:.2f} bar" if found.states else "at rest"
    return f"Finite elements: {failure}. The tube is drawn as far as they got, {shown}."


def _error(dossier: Dossier) -> Markup:
    figure = error_figure(dossier.scene, dossier.by_formula)
    said = (
        "Distance between the object-facing line of the bent tube and the profile, in mm along "
        "the arc: positive off the object, negative pressed into it. Grey: the joints' cuts, "
        "numbered."
    )
    return plotted(figure, "error", said)


def _pressure(dossier: Dossier, found: Verification) -> Markup:
    said = "Angle of every joint against pressure by finite elements, positive toward the object."
    if found.critical is not None:
        said += f" The path ends in a {found.critical.kind}."
    if found.failure is not None:
        said += f" The run ended early: {found.failure}."
    figure = theta_figure(found, "", dossier.marks if dossier.unverified is None else ())
    title = tag("h3", f"What the tube bears at {found.last.pressure_bar:.2f} bar")
    return tag(
        "div",
        plotted(figure, "theta", said),
        tag("div", title, loads(found.last, dossier.scene.design)),
        class_="two",
    )


def _build(dossier: Dossier) -> Markup:
    design = dossier.scene.design
    told = (tag("li", tag("h3", step.title), step.body) for step in steps(design, dossier.found))
    listed = tag("ol", *told, class_="steps")
    if design.feasible and proven(design):
        return listed
    lacking = "NOT VERIFIED" if design.feasible else "INFEASIBLE"
    said = f"This design is {lacking}: build it to try it, not to rely on it."
    return joined((tag("p", said, class_="mind"), listed))


def _template(dossier: Dossier) -> Markup:
    said = (
        "The gauze on the flat, made small: not to be cut from this page. Blue: slits. Black: "
        "outline. Green: marks."
    )
    return tag(
        "figure", tag("div", adopted(dossier.template_svg, "template-"), class_="sheet"),
        tag("figcaption", said), class_="plot",
    )  # fmt: skip


def _states(film: Film) -> Markup:
    # "</" would end the element early; JSON may write it with a backslash.
    told = Markup(film.as_json().replace("</", "<\\/"))
    return tag("script", told, type="application/json", id="states")


def _name(dossier: Dossier) -> str:
    return PurePath(dossier.scene.design.source.file).stem
