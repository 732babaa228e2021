"""The law of a rubber from its name and constants."""

from __future__ import annotations

import pytest

from fem.material import PAPER_RUBBER, Yeoh
from formula.rubber import RubberLaw
from profiletool.records.rubber import constants_text, law_of


def test_no_rubber_is_the_papers() -> None:
    assert law_of(None) is PAPER_RUBBER
    paper = RubberLaw("paper", PAPER_RUBBER.name, PAPER_RUBBER.constants)
    assert law_of(paper) == PAPER_RUBBER
    assert constants_text(paper) == "C10 0.0694, C01 0.0628, K 3.217 MPa"


def test_a_law_by_its_name() -> None:
    law = law_of(RubberLaw("x", "yeoh", {"C10": 0.1, "C20": -0.01, "C30": 0.001, "K": 3.0}))
    assert law == Yeoh(0.1, -0.01, 0.001, 3.0)
    two = RubberLaw("x", "ogden", {"mu": (0.1, 0.2), "alpha": (2.0, 4.0), "K": 3.0})
    assert constants_text(two) == "mu 0.1 0.2, alpha 2 4, K 3 MPa"


@pytest.mark.parametrize(
    ("law", "constants", "says"),
    [
        ("gent", {"mu": 1.0}, 'no law "gent"'),
        ("neo-hooke", {"C10": 0.1}, "takes C10, K"),
        ("neo-hooke", {"C10": -0.1, "K": 3.0}, "C10 > 0"),
        ("neo-hooke", {"C10": 5e-5, "K": 3.0}, "shear modulus of 0.0001 MPa"),
        ("neo-hooke", {"C10": 1.1e3, "K": 1e5}, "shear modulus"),
        ("neo-hooke", {"C10": 0.1, "K": 0.09}, "bulk modulus of 0.09 MPa"),
        ("neo-hooke", {"C10": 0.1, "K": 2e6}, "bulk modulus"),
    ],
)
def test_what_no_rubber_can_be(law: str, constants: dict[str, float], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        law_of(RubberLaw("x", law, constants))
