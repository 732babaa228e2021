"""Sampled builds beside what was expected of them, as text and as a tree."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from profiletool.campaign.builds import SampledBuilds
from profiletool.records.built import Built


def samples_tree(found: SampledBuilds, linear: Built) -> dict[str, Any]:
    """Give sampled builds and the figures to first order, for `verify --json`."""
    return {"samples": asdict(found), "linear": asdict(linear)}


def samples_text(found: SampledBuilds, linear: Built) -> str:
    """Lay out sampled builds beside the figures to first order."""
    rows = [
        f"{found.samples} builds by finite elements, off the profile:   as set   pressure set",
        *(
            f"{what:<52}{_mm(values.as_set)}{_mm(values.trimmed)}"
            for what, values in (
                ("expected, mm RMS", found.expected_rms_mm),
                ("  to first order", linear.expected_rms_mm),
                ("95 % lie within, mm RMS", found.p95_rms_mm),
                ("  to first order", linear.p95_rms_mm),
            )
        ),
        f"errors: {linear.build}",
    ]
    counts = {why: found.failures.count(why) for why in dict.fromkeys(found.failures)}
    rows += [f"not among them: {count} ({why})" for why, count in counts.items()]
    return "\n".join(rows) + "\n"


def _mm(value: float | None) -> str:
    return f"{'-' if value is None else format(value, '.2f'):>9}"
