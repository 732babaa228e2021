"""From the picture of an object to a pneumatic bending actuator that mirrors its shape.

>>> from profiletool import design, files_of
>>> result = design("bulb.png", height_mm=107.5)
>>> print(result)
>>> files = files_of(result)

Lengths are in mm, angles in deg, pressures in bar, as the names say.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from profiletool.records import version as _version

if TYPE_CHECKING:
    from profiletool.api import derive_formula, design, find_subject, plan_joints, verify_design
    from profiletool.api.bench import measure_pictures, readings_of
    from profiletool.campaign.derive import CampaignPlan, Derivation
    from profiletool.campaign.formula_file import formula_file
    from profiletool.errors import ProfiletoolError
    from profiletool.files.angles_csv import read_angles
    from profiletool.files.design_json import load_design
    from profiletool.files.tube_json import load_tube, tube_json
    from profiletool.joints.plan import Plan
    from profiletool.pipeline import Result
    from profiletool.records.bench import Angle, Seen
    from profiletool.records.calibrated import CalibratedTube, request_with, with_tube
    from profiletool.records.design import Design, Joint
    from profiletool.records.picture import Picture
    from profiletool.records.profile import DrawnLine, Profile
    from profiletool.records.request import Request, TubeSpec
    from profiletool.records.setting import AngleReading, PressureSetting
    from profiletool.report.figures import figures_of
    from profiletool.report.outputs import files_of
    from profiletool.subject.find import Subject
    from profiletool.verify.calibration import calibrate
    from profiletool.verify.check import Check
    from profiletool.verify.setting import trim_pressure

__version__ = _version.VERSION

__all__ = [
    "Angle",
    "AngleReading",
    "CalibratedTube",
    "CampaignPlan",
    "Check",
    "Derivation",
    "Design",
    "DrawnLine",
    "Joint",
    "Picture",
    "Plan",
    "PressureSetting",
    "Profile",
    "ProfiletoolError",
    "Request",
    "Result",
    "Seen",
    "Subject",
    "TubeSpec",
    "calibrate",
    "derive_formula",
    "design",
    "figures_of",
    "files_of",
    "find_subject",
    "formula_file",
    "load_design",
    "load_tube",
    "measure_pictures",
    "plan_joints",
    "read_angles",
    "readings_of",
    "request_with",
    "trim_pressure",
    "tube_json",
    "verify_design",
    "with_tube",
]

# Where each name is at home; a room is loaded when one of its names is first asked for.
_HOMES = {
    "Angle": "records.bench",
    "AngleReading": "records.setting",
    "CalibratedTube": "records.calibrated",
    "CampaignPlan": "campaign.derive",
    "Check": "verify.check",
    "Derivation": "campaign.derive",
    "Design": "records.design",
    "DrawnLine": "records.profile",
    "Joint": "records.design",
    "Picture": "records.picture",
    "Plan": "joints.plan",
    "PressureSetting": "records.setting",
    "Profile": "records.profile",
    "ProfiletoolError": "errors",
    "Request": "records.request",
    "Result": "pipeline",
    "Seen": "records.bench",
    "Subject": "subject.find",
    "TubeSpec": "records.request",
    "calibrate": "verify.calibration",
    "derive_formula": "api",
    "design": "api",
    "figures_of": "report.figures",
    "files_of": "report.outputs",
    "find_subject": "api",
    "formula_file": "campaign.formula_file",
    "load_design": "files.design_json",
    "load_tube": "files.tube_json",
    "measure_pictures": "api.bench",
    "plan_joints": "api",
    "read_angles": "files.angles_csv",
    "readings_of": "api.bench",
    "request_with": "records.calibrated",
    "trim_pressure": "verify.setting",
    "tube_json": "files.tube_json",
    "verify_design": "api",
    "with_tube": "records.calibrated",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'profiletool' has no attribute {name!r}")
    value = getattr(import_module(f"profiletool.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
