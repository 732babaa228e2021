"""The rubber of the tube by name: a preset, constants of a law, or a file of test data."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

from fem.material import PAPER_RUBBER, Law, MooneyRivlin, law
from formula.rubber import RubberLaw
from profiletool.errors import UnreadableInput, UsageError
from profiletool.files.columns import NUMBER
from profiletool.files.read import read_file
from profiletool.records.rubber import constants_text, law_of
from profiletool.rubber.columns import first_loading
from profiletool.rubber.uniaxial import STIFFNESSES, fit_uniaxial, read_uniaxial, uniaxial_stress

PAPER_NU = 0.46
NUS = (0.3, 0.4995)  # below is foam; beyond, the bulk modulus is 1000 times the shear modulus
_MOST_BYTES = 5_000_000
_SHOWN = 60  # characters of what was given, in a message
_LAWS = {
    "mooney-rivlin": ("C10", "C01", "nu"),
    "neo-hooke": ("C10", "nu"),
    "yeoh": ("C10", "C20", "C30", "nu"),
    "ogden": ("mu1", "alpha1", "mu2", "alpha2", "...", "nu"),
}
_FORMS = (
    f"{', '.join(f'{law}:{chr(44).join(names)}' for law, names in _LAWS.items())} (MPa), or a CSV "
    "file of stretch,stress"
)
_STABLE = np.linspace(0.35, 3.0, 54)  # stretches at which a pull that grows must lengthen a strip


@dataclass(frozen=True)
class Rubber:
    """A rubber and where its numbers are from.

    Attributes
    ----------
    name : str
    law : fem.material.Law
        MPa.
    source : str
        One line.
    stretch_range : (float, float) or None
        Of the uniaxial test that the law was fitted to; None where the constants were given.
    rms_MPa : float or None
        Of the nominal stress that the law gives minus that of the test.
    """

    name: str
    law: Law
    source: str
    stretch_range: tuple[float, float] | None = None
    rms_MPa: float | None = None

    @property
    def nu(self) -> float:
        """Poisson's ratio at small strain."""
        mu, K = self.law.shear_modulus, self.law.bulk_modulus
        return (3.0 * K - 2.0 * mu) / (6.0 * K + 2.0 * mu)

    @property
    def record(self) -> RubberLaw:
        """Name, law and constants, as files hold them."""
        return RubberLaw(self.name, self.law.name, dict(self.law.constants))


_ASSUMED = f"nu {PAPER_NU:g} is assumed"
# github.com/LucMarechal/Soft-Robotics-Materials-Database, commit 8ff66c3 (2024), "Engineering"
# columns up to 100 % strain: first pulls at 450 mm/min, with the strain from the crosshead, which
# makes the rubber look soft. All three curves stiffen from the start, so the best C01 is 0.
_MARECHAL = (
    "our fit to the raw tensile data of Marechal et al., Soft Robotics 8(3):284-297, 2021 "
    "(their Soft-Robotics-Materials-Database), stretch 1 .. 2"
)


def _tested(name: str, C10: float, rms_MPa: float, below: int) -> Rubber:
    """One of Marechal's; ``below`` its data sheet's 100 % modulus, in %."""
    return Rubber(
        name,
        MooneyRivlin.from_poisson(C10, 0.0, PAPER_NU),
        f"{_MARECHAL}; at stretch 2 {below} % below Smooth-On's data sheet; {_ASSUMED}",
        (1.04, 2.0),
        rms_MPa,
    )


# Only rubbers whose constants or data were seen, and whose law is within a factor of 1.6 of the
# data sheet at 100 % strain. Ecoflex is missing for that: Marechal's Ecoflex 00-30 and 00-50 are
# 2.5 and 2.1 times softer than their data sheets.
PRESETS: Mapping[str, Rubber] = MappingProxyType(
    {
        rubber.name: rubber
        for rubber in (
            Rubber(
                "paper",
                PAPER_RUBBER,
                "XIAMETER RTV-4250-S, Antonelli et al., Actuators 9(4):113, 2020, section 2.2",
            ),
            _tested("dragon-skin-10", 0.0299, 0.0074, below=35),
            _tested("dragon-skin-20", 0.0845, 0.0218, below=18),
            _tested("dragon-skin-30", 0.1180, 0.0246, below=35),
            Rubber(
                "elastosil-m4601",
                MooneyRivlin.from_poisson(0.12, 0.0, PAPER_NU),
                "neo-Hookean C10 of the Soft Robotics Toolkit, Fiber-Reinforced Actuators, Finite "
                f"Element Modeling (softroboticstoolkit.com/book/export/html/448881); {_ASSUMED}",
            ),
        )
    }
)


def rubber_of(law: RubberLaw, source: str) -> Rubber:
    """Take the rubber of a file."""
    return Rubber(law.name, law_of(law), source)


def parse_rubber(text: str) -> Rubber:
    """Find the rubber that a user names.

    Parameters
    ----------
    text : str
        The name of a preset; a law and its constants, ``mooney-rivlin:C10,C01,nu``,
        ``neo-hooke:C10,nu``, ``yeoh:C10,C20,C30,nu`` or ``ogden:mu1,alpha1,...,nu`` (MPa but for
        alpha and nu); or the path of a CSV file of uniaxial test data
        (`profiletool.rubber.uniaxial.read_uniaxial`), which is fitted with nu = 0.46.

    Raises
    ------
    UsageError
        No such preset or law, or constants that no rubber has.
    UnreadableInput
        A file that cannot be read, holds no test, or that no stable law follows.
    """
    given = text.strip()
    name = re.sub(r"[\s_]+", "-", given.lower())
    if name in PRESETS:
        return PRESETS[name]
    kind, colon, constants = given.partition(":")
    if colon and kind.strip().lower() in _LAWS:
        return _by_constants(kind.strip().lower(), constants)
    path = Path(given)
    if given and (_exists(path) or path.suffix.lower() in (".csv", ".txt", ".tsv", ".dat")):
        return _by_test(path)
    raise UsageError(f"no rubber {_quoted(given)}; give one of {', '.join(PRESETS)}, or {_FORMS}")


def presets_text() -> str:
    """Table of the presets, a line each."""
    heads = ("name", "law", "constants")
    rows = [
        (name, rubber.law.name, constants_text(rubber.record)) for name, rubber in PRESETS.items()
    ]
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    lines = [
        "  ".join(f"{head:{width}}" for head, width in zip(heads, widths, strict=True))
        + "    nu  shear modulus/MPa  source"
    ]
    for words, rubber in zip(rows, PRESETS.values(), strict=True):
        cells = "  ".join(f"{word:{width}}" for word, width in zip(words, widths, strict=True))
        lines.append(
            f"{cells}  {rubber.nu:4.2f}  {rubber.law.shear_modulus:17.4f}  {rubber.source}"
        )
    return "\n".join(lines) + "\n"


def _by_constants(kind: str, text: str) -> Rubber:
    fields = [field.strip() for field in text.split(",")]
    numbers = [float(field) for field in fields if NUMBER.fullmatch(field)]
    fits = (
        len(fields) >= 3 and len(fields) % 2 == 1
        if kind == "ogden"
        else (len(fields) == len(_LAWS[kind]))
    )
    if not fits or len(numbers) != len(fields):
        raise UsageError(
            f"{_quoted(text)} is not what {kind}:{','.join(_LAWS[kind])} takes: numbers with "
            "commas between, as in mooney-rivlin:0.0694,0.0628,0.46"
        )
    *values, nu = numbers
    if not NUS[0] <= nu <= NUS[1]:
        raise UsageError(
            f"nu must lie in {NUS[0]:g} .. {NUS[1]:g}, not {nu:g}; the paper takes {PAPER_NU:g}"
        )
    rubber = Rubber(f"{kind}:{','.join(fields)}", _made(kind, values, nu), "constants as given")
    half = 0.5 * rubber.law.shear_modulus
    if not STIFFNESSES[0] <= half <= STIFFNESSES[1]:
        raise UsageError(
            f"half of the shear modulus (C10 + C01) must lie in {STIFFNESSES[0]:g} .. "
            f"{STIFFNESSES[1]:g} MPa, not {half:g}; give the constants in MPa"
        )
    return rubber


def _made(kind: str, values: list[float], nu: float) -> Law:
    """Make a law that is stable: a strip is the longer, the harder it is pulled.

    A negative C10 turns soft in tension, a negative C01 in compression and equibiaxial tension;
    with both >= 0 the law is polyconvex.
    """
    names = _LAWS[kind][:-1]
    constants: dict[str, float | tuple[float, ...]] = dict(zip(names, values, strict=False))
    if kind == "ogden":
        constants = {"mu": tuple(values[::2]), "alpha": tuple(values[1::2])}
    try:
        made = law(kind, {**constants, "nu": nu})
    except ValueError as error:
        raise UsageError(
            f"{kind}: {error}, else the rubber is unstable; fit again, or give the test data as a "
            "CSV file"
        ) from error
    # The constants but for nu: of foam-like rubbers compression says little.
    stress = uniaxial_stress(law(kind, {**constants, "nu": 0.49}), _STABLE)
    if not (np.isfinite(stress).all() and (np.diff(stress) > 0.0).all()):
        raise UsageError(
            f"{kind}: the rubber is unstable between stretches {_STABLE[0]:g} and "
            f"{_STABLE[-1]:g}: its stress does not rise all along; fit again, or give the test "
            "data as a CSV file"
        )
    return made


def _by_test(path: Path) -> Rubber:
    shown = _quoted(str(path))
    try:
        data = read_file(path, _MOST_BYTES, "a file of test data")
    except UnreadableInput as error:
        raise UnreadableInput(f"cannot read {shown}: {error}") from None
    try:
        stretch, stress = read_uniaxial(data)
        kept = first_loading(stretch)
        fit = fit_uniaxial(stretch[kept], stress[kept], PAPER_NU)
    except UnreadableInput as error:
        raise UnreadableInput(f"{shown}: {error}") from error
    low, high = fit.stretch_range
    alone = (
        "" if len(kept) == len(stretch) else f", the first loading alone of {len(stretch)} points"
    )
    return Rubber(
        name=path.name,
        law=fit.law,
        source=(
            f"fit to {fit.points} points of {shown}, stretch {low:.3g} .. {high:.3g}, "
            f"rms {fit.rms_MPa:.2g} MPa, R2 {fit.r2:.4f}{alone}; {_ASSUMED}"
        ),
        stretch_range=fit.stretch_range,
        rms_MPa=fit.rms_MPa,
    )


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except (OSError, ValueError):  # a name too long, or with characters no file has
        return False


def _quoted(text: str) -> str:
    """Quote what was given, on one line and not for ever."""
    short = text if len(text) <= _SHOWN else text[: _SHOWN - 3] + "..."
    return f'"{short}"' if short.isprintable() else ascii(short)
