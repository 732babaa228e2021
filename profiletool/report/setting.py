"""The pressure to set on a finished actuator, as text and as JSON."""

from __future__ import annotations

import json

from profiletool.records.setting import PressureSetting


def setting_text(found: PressureSetting) -> str:
    """Lay out the pressure to set, the stiffness found, what remains, and notes."""
    lines = [
        f"set {found.pressure_bar:.2f} bar (planned: {found.planned_bar:.2f}): this actuator is "
        f"{found.stiffness:.3f} times as stiff as planned"
    ]
    if found.operate_bar is not None:
        lines.append(f"against its object, work at {found.operate_bar:.2f} bar")
    if found.off_mm is not None:
        lines.append(f"its tip lies {found.off_mm:.1f} mm off the way of the planned one")
    if found.rms_deg is not None:
        lines.append(f"its angles lie {found.rms_deg:.1f} deg RMS off those of the planned one")
    if found.fit_mm is not None:
        lines.append(f"there it lies {found.fit_mm:.2f} mm RMS off the profile, by finite elements")
    if found.dead_bar:
        lines.append(f"of that the gauge reads {found.dead_bar:+.2f} bar too much")
    lines += [f"note: {note}" for note in found.notes]
    return "\n".join(lines) + "\n"


def setting_json(found: PressureSetting) -> str:
    """Write the same as one line of JSON."""
    off, rms = found.off_mm, found.rms_deg
    tree = {
        "pressure_bar": found.pressure_bar,
        "planned_bar": found.planned_bar,
        "operate_bar": found.operate_bar,
        "stiffness": round(found.stiffness, 4),
        "off_mm": None if off is None else round(off, 3),
        "rms_deg": None if rms is None else round(rms, 3),
        "joints_off": list(found.joints_off),
        "beyond": found.beyond,
        "notes": list(found.notes),
    }
    if found.fit_mm is not None:
        tree |= {"fit_mm": round(found.fit_mm, 3), "dead_bar": round(found.dead_bar, 4)}
    return json.dumps(tree, allow_nan=False) + "\n"
