"""The page of a measurement: angles, agreement, and the film of its pictures."""

from __future__ import annotations

from collections.abc import Iterable

from matplotlib.figure import Figure

from profiletool.records.bench import Agreement
from profiletool.report.bench import NAMES, BenchOutput, compare_json
from profiletool.report.bench_figures import angles_figure, regression_figure, ways_figure
from profiletool.report.bench_film import bench_film
from profiletool.report.figure import png, svg
from profiletool.report.markup import Markup, adopted, pairs, signed, table, tag
from profiletool.report.markup import text as escaped
from profiletool.report.page import asset, page
from profiletool.report.registry import Writers

R2_ALONE = (
    "R² alone says little: a model that is 30 % too stiff has an R² near 1. Slope, bias and limits "
    "of agreement tell whether it is right."
)


def bench_html(output: BenchOutput) -> bytes:
    """Write the page: the same output gives the same bytes."""
    name = output.design.source.file
    script, style = asset("bench.js"), Markup(asset("report.css") + asset("bench.css"))
    header = tag(
        "header",
        tag("p", "Measured on the bench", class_="eyebrow"),
        tag("h1", tag("bdi", name)),
        pairs(list(_facts(output)), "facts"),
    )
    main = tag("main", *_sections(output))
    return page(f"{name}: on the bench", style, script, header, main, tag("script", script))


def _facts(output: BenchOutput) -> Iterable[tuple[str, str]]:
    states = [angle.state for one in output.seen for angle in one.angles]
    yield "Pictures", str(len(output.seen))
    yield (
        "Angles",
        ", ".join(f"{states.count(word)} {word}" for word in ("measured", "by hand", "lost")),
    )
    for name, (_, whole) in output.compared.items():
        if whole is not None:
            yield (
                f"Off {NAMES[name]}",
                f"{whole.rmse_deg:.2f}° RMS, bias {signed(whole.bias_deg, 2)}°",
            )


def _sections(output: BenchOutput) -> Iterable[Markup]:
    if output.notes:
        yield _section("notes", "What to know", tag("ul", *(tag("li", n) for n in output.notes)))
    said = (
        f"Measured angles, those by {NAMES[output.by]} (lines) and by the formula (dashed), "
        "positive toward the object."
    )
    yield _section(
        "angles",
        "Angles against pressure",
        _plot(angles_figure(output), "a", said),
        _angles(output),
    )
    yield _section(
        "agreement", "Agreement", tag("p", R2_ALONE), _agreement(output),
        _plot(regression_figure(output), "r", "Measured against predicted, and their difference."),
    )  # fmt: skip
    said = "Midpoints of the wrapped sectors as the pressure rises."
    yield _section("ways", "Trajectories", _plot(ways_figure(output), "w", said))
    yield _section("pictures", "Pictures", bench_film(output))


def _section(name: str, title: str, *inner: Markup) -> Markup:
    return tag(
        "section", tag("h2", title, id=f"{name}-title"), *inner, id=name,
        aria_labelledby=f"{name}-title",
    )  # fmt: skip


def _plot(figure: Figure, name: str, said: str) -> Markup:
    drawn = adopted(svg(figure), f"{name}-")
    named = Markup(drawn.replace("<svg", f'<svg role="img" aria-label="{escaped(said)}"', 1))
    return tag("figure", tag("div", named, class_="drawn"), tag("figcaption", said), class_="plot")


def _angles(output: BenchOutput) -> Markup:
    count = len(output.design.joints)
    heads = ("P (bar)", *(f"θ{k} (°)" for k in range(1, count + 1)), "edges off (px)", "picture")
    rows = [
        (
            f"{one.pressure_bar:.2f}",
            *(
                "lost"
                if a.state == "lost"
                else f"{signed(a.theta_deg)} ± {a.sigma_deg:.2f}"
                + (" by hand" if a.state == "by hand" else "")
                for a in one.angles
            ),
            f"{one.rms_px:.2f}",
            one.picture,
        )
        for one in output.seen
    ]
    return table(heads, rows, "Angle of every joint, with one standard deviation.")


def _agreement(output: BenchOutput) -> Markup:
    heads = ("", "n", "slope", "intercept (°)", "R²", "RMS (°)", "bias (°)", "limits (°)")
    rows = []
    for name, (each, whole) in output.compared.items():
        rows += [_row(f"joint {k}, {NAMES[name]}", one) for k, one in enumerate(each, start=1)]
        rows.append(_row(f"all, {NAMES[name]}", whole))
    said = "Measured = slope × predicted + intercept; measured less predicted: RMS, bias, limits."
    return table(heads, rows, said)


def _row(name: str, one: Agreement | None) -> tuple[str, ...]:
    if one is None:
        return (name, "0", *["–"] * 6)
    low, high = one.limits_deg
    return (
        name, str(one.count), f"{one.slope:.3f}", signed(one.intercept_deg, 2), f"{one.r2:.4f}",
        f"{one.rmse_deg:.2f}", signed(one.bias_deg, 2), f"{signed(low, 2)} to {signed(high, 2)}",
    )  # fmt: skip


BENCH_FILES: Writers[BenchOutput] = {
    "compare.json": lambda output: compare_json(output).encode(),
    "theta_vs_pressure.png": lambda output: png(angles_figure(output)),
    "theta_vs_pressure.svg": lambda output: svg(angles_figure(output)).encode(),
    "agreement.png": lambda output: png(regression_figure(output)),
    "trajectories.png": lambda output: png(ways_figure(output)),
    "trajectories.svg": lambda output: svg(ways_figure(output)).encode(),
    "overlay_{:02d}.png": lambda output: output.overlays,
    "report.html": bench_html,
}
