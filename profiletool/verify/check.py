"""The check of a design: its finite-element run, angles, shape and misfit."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fem.errors import BadGeometry, NotConverged
from profiletool.joints.misfit import misfit_to
from profiletool.records.design import Design
from profiletool.records.fe import FeState
from profiletool.records.frames import Shape
from profiletool.records.units import FloatArray
from profiletool.verify.run import Progress, Run, reason, run_design, shortly, too_little

DECIMALS = 4  # of what FE puts into design.json: far above the noise of the last bits


@dataclass(frozen=True)
class Check:
    """A design after its finite-element run.

    Attributes
    ----------
    design : Design
        Verified where the run reached the operating pressure, and stands a little more.
    run : Run or None
        None where there is not even a part of it.
    failure : str or None
        Why the design is not verified.
    """

    design: Design
    run: Run | None
    failure: str | None

    @property
    def shape(self) -> Shape | None:
        """The tube at the operating pressure; None where FE did not get there."""
        done = self.run is not None and self.failure is None
        return self.run.verification.last.shape if done and self.run is not None else None


def runs_into_itself(state: FeState) -> str:
    """Say that a bent tube runs into itself; empty where it does not."""
    if not state.touches:
        return ""
    return f"the bent tube runs into itself by {state.overlap_mm:.1f} mm"


def withdrawn(done: Check, failure: str) -> Check:
    """Take a verification back for a reason."""
    return replace(done, design=replace(done.design, verified=False), failure=failure)


def check(design: Design, target: FloatArray, progress: Progress | None = None) -> Check:
    """Verify a design at its operating pressure; a failure leaves it unverified and says why.

    ``target`` holds the profile's points (N, 2), mm, object frame.
    """
    try:
        run = run_design(design, design.pressure_bar, progress)
    except NotConverged as error:
        return Check(design, None, shortly(error))
    except BadGeometry as error:
        return Check(design, None, f"cannot be modelled: {error}")
    found = run.verification
    if found.critical is not None or found.failure is not None:
        return Check(design, run, reason(found))
    if found.ahead is not None:
        return Check(design, run, too_little(found))
    by_joint = zip(design.joints, found.last.theta_deg, found.last.joint_stretch, strict=True)
    joints = tuple(
        replace(
            joint,
            theta_fe_deg=round(joint.signed(theta), DECIMALS),
            stretch_fe=round(stretch, DECIMALS - 1),
        )
        for joint, theta, stretch in by_joint
    )
    off = misfit_to(found.last.shape, target)
    off = replace(off, rms_mm=round(off.rms_mm, DECIMALS), max_mm=round(off.max_mm, DECIMALS))
    fit = replace(design.fit, fe=off)
    return Check(replace(design, joints=joints, fit=fit, verified=True), run, None)
