"""The law of a rubber: from its name and constants to what finite elements take."""

from __future__ import annotations

from fem.material import PAPER_RUBBER, Law, law
from formula.rubber import RubberLaw

# Stretch at break, by the data sheets: the paper's XIAMETER RTV-4250-S 850 % of strain, Smooth-On's
# Dragon Skins 1000, 620 and 364 %, Wacker's Elastosil M 4601 700 %.
BREAKS = {
    "paper": 9.5, "dragon-skin-10": 11.0, "dragon-skin-20": 7.2, "dragon-skin-30": 4.6,
    "elastosil-m4601": 8.0,
}  # fmt: skip
PAPER_BREAKS = BREAKS["paper"]
_SHEAR_MPA = 2e-4, 2e3  # from gels to hard plastics
_MOST_BULK_MPA = 1e6


def law_of(rubber: RubberLaw | None, nu: float | None = None) -> Law:
    """Law of a rubber; None is the paper's.

    Parameters
    ----------
    rubber : RubberLaw or None
    nu : float, optional
        Poisson's ratio at small strain in place of the rubber's own; the shear modulus stays.

    Raises
    ------
    ValueError
        There is no such law, or no rubber can have such constants.
    """
    if rubber is None:
        made: Law = PAPER_RUBBER
    else:
        made = law(rubber.law, rubber.constants)
    if nu is not None:
        others = {key: value for key, value in made.constants.items() if key != "K"}
        made = law(made.name, {**others, "nu": nu})
    low, high = _SHEAR_MPA
    if not low <= made.shear_modulus <= high:
        raise ValueError(
            f"a shear modulus of {made.shear_modulus:.3g} MPa: no rubber can have such constants"
        )
    if not 0.5 * made.shear_modulus <= made.bulk_modulus <= _MOST_BULK_MPA:
        raise ValueError(
            f"a bulk modulus of {made.bulk_modulus:.3g} MPa: no rubber can have such constants"
        )
    return made


def usual_rubber(rubber: RubberLaw | None) -> bool:
    """Whether a rubber is the paper's silicone."""
    return rubber is None or rubber.name == "paper"


def breaking_stretch(rubber: RubberLaw | None) -> float | None:
    """Stretch at which a rubber breaks; None where nothing tells, and None's is the paper's."""
    return PAPER_BREAKS if rubber is None else BREAKS.get(rubber.name)


def constants_text(rubber: RubberLaw) -> str:
    """Constants of a rubber in words: "C10 0.0694, C01 0.0628, K 3.217 MPa"."""
    values = (
        (key, value if isinstance(value, tuple) else (value,))
        for key, value in rubber.constants.items()
    )
    return (
        ", ".join(f"{key} {' '.join(f'{v:.4g}' for v in value)}" for key, value in values) + " MPa"
    )
