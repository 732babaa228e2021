"""A Mooney-Rivlin rubber from a uniaxial test: the law that `fem.material` computes with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

from fem.material import Law, MooneyRivlin, kinematics
from profiletool.errors import UnreadableInput
from profiletool.files.columns import NUMBER, read_lines
from profiletool.records.units import FloatArray
from profiletool.rubber.columns import Columns, columns_of, needs_header

MOST_POINTS = 20_000
LEAST_POINTS = 5  # stretched ones
LEAST_REACH = 1.1  # below, C10 and C01 cannot be told apart
STRETCHES = (0.4, 8.0)
WORST_RMS = 0.15  # of the range of the stress
STIFFNESSES = (5e-4, 5.0)  # of C10 + C01, MPa: from gels to tyres
_STEPS, _STEP, _TIGHT = 60, 0.2, 1e-13
MAX_WORDS = 30  # lines of words before the first point


@dataclass(frozen=True)
class UniaxialFit:
    """A law and how well it follows the test.

    Attributes
    ----------
    law : fem.material.MooneyRivlin
    points : int
    stretch_range : (float, float)
        Of the test.
    rms_MPa : float
        Of the nominal stress that the law gives minus that of the test.
    r2 : float
        Share of the stress's variance that the law explains.
    """

    law: MooneyRivlin
    points: int
    stretch_range: tuple[float, float]
    rms_MPa: float
    r2: float


def uniaxial_stress(law: Law, stretch: ArrayLike) -> FloatArray:
    """Nominal stress of a strip whose sides are free, in the compressible law.

    The paper's rubber (nu 0.46) gives 4 % less at stretch 2 than if it were incompressible,
    2 (lam - lam^-2) (C10 + C01 / lam).

    Parameters
    ----------
    law : fem.material.Law
    stretch : (n,)
        Positive.

    Returns
    -------
    FloatArray
        (n,), MPa; nan where the lateral stretch was not found.
    """
    along = np.atleast_1d(np.asarray(stretch, dtype=float))
    lateral = along**-0.5  # as if incompressible
    F = np.zeros((3, 3, along.size))
    F[0, 0] = along
    for _ in range(_STEPS):
        F[1, 1] = F[2, 2] = lateral
        k = kinematics(F)
        p, stiffness = law.volumetric(k.J)[1:]
        P, A = law.stress(k, p), law.tangent(k, p, stiffness)
        # dP22 of one lateral stretch: A_2222 + A_2233; a step of Newton's method, kept short.
        step = -P[1, 1] / (A[3, 1, 1] + A[4, 1, 2])
        step = np.clip(step, -_STEP * lateral, _STEP * lateral)
        lateral = lateral + step
        if np.all(np.abs(step) <= _TIGHT * lateral):
            break
    P[:, :, np.abs(step) > 1e-9 * lateral] = np.nan
    axial: FloatArray = P[0, 0]
    return axial


def fit_uniaxial(stretch: ArrayLike, stress_MPa: ArrayLike, nu: float) -> UniaxialFit:
    """Fit C10, C01 >= 0 to nominal stress against stretch by least squares.

    The curve is that of `uniaxial_stress`, so that a test of the very law comes out exactly. At a
    given nu it is C10 + C01 times a curve that only the share of C01 shapes; the best sum is then
    linear, and what remains is a search along the share.

    Parameters
    ----------
    stretch : (n,)
        In any order; below 1 is compression.
    stress_MPa : (n,)
        Force over the cross-section before the test, MPa.
    nu : float
        Poisson's ratio, 0 .. 0.5: the test does not give it.

    Raises
    ------
    UnreadableInput
        Too few points or of too short a reach, or no stable law follows them.
    """
    lam, measured = _points(stretch, stress_MPa)

    def fitted(share: float) -> tuple[float, float, FloatArray]:
        """C10 + C01, rms and residuals at a share of C01."""
        curve = uniaxial_stress(MooneyRivlin.from_poisson(1.0 - share, share, nu), lam)
        scale = float(curve @ measured / (curve @ curve))
        residuals = scale * curve - measured
        return scale, float(np.sqrt(np.mean(residuals**2))), residuals

    found = minimize_scalar(
        lambda share: fitted(share)[1],
        bounds=(0.0, 1.0),
        method="bounded",
        options={"xatol": 1e-12, "maxiter": 200},
    )
    # The search never tries the ends, and there they are exact: neo-Hooke is C01 = 0.
    share = min((float(found.x), 0.0, 1.0), key=lambda s: fitted(s)[1])
    scale, rms, residuals = fitted(share)
    extent = float(np.ptp(measured))
    if not (np.isfinite(rms) and scale > 0.0 and rms <= WORST_RMS * extent):
        raise UnreadableInput(
            f"no stable Mooney-Rivlin law (C10, C01 >= 0) follows this test within "
            f"{100 * WORST_RMS:g} % of its stress; give nominal stress, of loading only, up to "
            "the stretches that the tube will see (mostly below 2)"
        )
    if not STIFFNESSES[0] <= scale <= STIFFNESSES[1]:
        raise UnreadableInput(
            f"the fit gives C10 + C01 = {scale:.3g} MPa, which no soft rubber has; "
            "check the unit of the stress (MPa, or kPa in the header)"
        )
    variance = float(np.mean((measured - measured.mean()) ** 2))
    return UniaxialFit(
        law=MooneyRivlin.from_poisson(scale * (1.0 - share), scale * share, nu),
        points=lam.size,
        stretch_range=(float(lam[0]), float(lam[-1])),
        rms_MPa=rms,
        r2=1.0 - float(np.mean(residuals**2)) / variance,
    )


def _points(stretch: ArrayLike, stress_MPa: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Order the points by stretch, or say what is wrong with them."""
    lam = np.asarray(stretch, dtype=float)
    measured = np.asarray(stress_MPa, dtype=float)
    if lam.ndim != 1 or lam.shape != measured.shape:
        raise ValueError("stretch and stress must be two lists of the same length")
    if not (np.all(np.isfinite(lam)) and np.all(np.isfinite(measured))):
        raise UnreadableInput("a stretch or stress of the test is not finite")
    if lam.size > MOST_POINTS:
        raise UnreadableInput(f"more than {MOST_POINTS} points; thin them out")
    stretched = np.unique(lam[lam > 1.0]).size
    if stretched < LEAST_POINTS:
        raise UnreadableInput(
            f"only {stretched} different stretches above 1; a fit needs {LEAST_POINTS} at least"
        )
    low, high = float(lam.min()), float(lam.max())
    if high < LEAST_REACH:
        raise UnreadableInput(
            f"the test ends at stretch {high:.4g}; it takes {LEAST_REACH:g} to tell C10 from C01"
        )
    if low < STRETCHES[0]:
        raise UnreadableInput(
            f"stretch {low:.4g} is below {STRETCHES[0]:g}; "
            'if the column is strain, name it so in a header line: "strain,stress"'
        )
    if high > STRETCHES[1]:
        raise UnreadableInput(
            f"stretch {high:.4g} is past {STRETCHES[1]:g}; "
            "give strain as a fraction, not in percent, or leave out the end of the test"
        )
    if float(np.abs(measured).max()) > 1e6:
        raise UnreadableInput("a stress above 1e6 MPa; check its unit")
    order = np.argsort(lam, kind="stable")
    return lam[order], measured[order]


def read_uniaxial(data: bytes) -> tuple[FloatArray, FloatArray]:
    """Read a uniaxial test from text.

    Parameters
    ----------
    data : bytes
        Text as `profiletool.files.columns.read_lines` takes it, of the columns stretch and nominal
        stress in MPa. A header line may name them in any order and among others: ``stretch``,
        ``strain`` or ``log strain``, and ``stress``; and their units, as in ``strain (%)`` and
        ``stress_kPa``, or in a line of their own.

    Returns
    -------
    stretch, stress_MPa : FloatArray
        (n,) each, in the order of the file.

    Raises
    ------
    UnreadableInput
        Naming the line that makes no sense.
    """
    columns: Columns | None = None
    header: list[str] = []
    rows: list[tuple[float, float]] = []
    words = 0
    for number, fields in read_lines(data):
        if not rows and not any(NUMBER.fullmatch(field) for field in fields) and words < MAX_WORDS:
            words += 1
            found = columns_of(fields)
            if found is not None:
                columns, header = found, fields
            elif columns is not None and len(fields) == len(header):
                columns = columns_of(header, fields) or columns
            continue
        if columns is None and words:
            raise needs_header()
        columns = columns or Columns()
        rows.append(columns.row(fields, number))
        if len(rows) > MOST_POINTS:
            raise UnreadableInput(f"more than {MOST_POINTS} points; thin them out")
    points = np.array(rows).reshape(-1, 2)
    return points[:, 0], points[:, 1]
