"""Any smooth object ends in a design that can be built, or is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from profiletool.errors import NoObject
from profiletool.files.design_json import from_json, to_json
from profiletool.joints.bounds import END_WRAP_MM, WRAP_MM
from profiletool.pipeline import Request, run
from profiletool.report.outputs import template_files

T = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]
waves = st.lists(st.tuples(st.floats(-0.12, 0.12), st.floats(0, 6.3)), min_size=3, max_size=3)


@pytest.mark.slow
@settings(max_examples=80)
@given(
    radius=st.floats(15, 70),
    slender=st.floats(0.6, 2.5),
    shape=waves,
    side=st.sampled_from(["left", "right"]),
)
def test_any_smooth_object(
    radius: float,
    slender: float,
    shape: list[tuple[float, float]],
    side: str,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    r = radius * (1.0 + sum(a * np.cos((k + 2) * T + p) for k, (a, p) in enumerate(shape)))
    outline = np.column_stack([r * np.cos(T), slender * r * np.sin(T)])
    file = tmp_path_factory.mktemp("object") / "object.csv"
    file.write_text("\n".join(f"{x:.4f},{y:.4f}" for x, y in [*outline, outline[0]]))
    try:
        result = run(Request(file, side=side, method="paper", verify=False), lambda line: None)
    except NoObject:
        return
    design = result.design
    assert from_json(to_json(design), "x").joints  # which checks that no cuts overlap
    starts = [j.centre_mm - j.openF_mm / 2 for j in design.joints]
    ends = [j.centre_mm + j.openF_mm / 2 for j in design.joints]
    assert min(np.subtract(starts[1:], ends[:-1]), default=WRAP_MM) >= WRAP_MM - 0.06
    assert design.tube.length_mm - ends[-1] >= END_WRAP_MM - 0.06
    assert starts[0] >= WRAP_MM - 0.06
    assert design.feasible == (not result.reasons)
    if design.feasible:
        assert all(j.theta_formula_deg >= j.theta_target_deg - 1e-6 for j in design.joints)
        assert max(s.deviation_mm for s in result.plan.sectors) <= 1.0
    assert template_files(design)["template.dxf"].startswith(b"  0\nSECTION")
