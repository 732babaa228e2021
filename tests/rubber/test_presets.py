"""The rubber by name: presets, constants and files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fem.arrays import FloatArray
from fem.material import PAPER_RUBBER, NeoHooke, Ogden, Yeoh, full_tangent, kinematics
from profiletool.errors import UnreadableInput, UsageError
from profiletool.records.rubber import constants_text, law_of
from profiletool.rubber.presets import NUS, PRESETS, Rubber, parse_rubber, presets_text
from profiletool.rubber.uniaxial import MOST_POINTS, STIFFNESSES, uniaxial_stress

PSI = 6.894757e-3  # MPa


# Nominal stress at 100 % strain, MPa. Dragon Skin: "100 % modulus" (ASTM D412) of Smooth-On's
# Dragon Skin Series technical bulletin, 22, 49 and 86 psi. Elastosil M4601: Wacker's data sheet
# has Shore A 28 only; Gent (1958) makes E = 1.051 MPa of it, and neo-Hooke E / 3 (2 - 1 / 4).
DATA_SHEET = {
    "dragon-skin-10": 22 * PSI,
    "dragon-skin-20": 49 * PSI,
    "dragon-skin-30": 86 * PSI,
    "elastosil-m4601": 1.051 / 3.0 * 1.75,
}


def csv(lam: FloatArray, measured: FloatArray, header: str = "") -> str:
    rows = [f"{x!r},{y!r}" for x, y in zip(lam.tolist(), measured.tolist(), strict=True)]
    return "\n".join([*([header] if header else []), *rows]) + "\n"


def test_presets_are_keyed_by_their_names() -> None:
    assert all(name == rubber.name == name.lower() for name, rubber in PRESETS.items())
    assert not any(c in name for name in PRESETS for c in " _")


def test_the_papers_rubber() -> None:
    paper = PRESETS["paper"]
    assert paper.law is PAPER_RUBBER
    assert (paper.law.C10, paper.law.C01) == (0.0694, 0.0628)
    assert paper.nu == pytest.approx(0.46, rel=1e-12)
    assert "Actuators 9(4):113, 2020" in paper.source


@pytest.mark.parametrize("name", PRESETS)
def test_presets_are_stable_rubbers(name: str) -> None:
    rubber = PRESETS[name]
    law = rubber.law
    assert law.C10 >= 0.0
    assert law.C01 >= 0.0
    assert STIFFNESSES[0] <= law.C10 + law.C01 <= STIFFNESSES[1]
    assert NUS[0] <= rubber.nu <= NUS[1]
    assert rubber.source
    assert "\n" not in rubber.source
    assert (rubber.stretch_range is None) == (rubber.rms_MPa is None)
    # the stress grows with stretch, and the tangent at rest is positive definite on strains
    assert np.all(np.diff(uniaxial_stress(law, np.linspace(0.5, 3.0, 60))) > 0.0)
    k = kinematics(np.eye(3)[:, :, None])
    p, stiffness = law.volumetric(k.J)[1:]
    A = full_tangent(law.tangent(k, p, stiffness))[..., 0].reshape(9, 9)
    assert np.sum(np.linalg.eigvalsh(A) > 1e-6) == 6  # three rotations cost nothing


@pytest.mark.parametrize("name", [name for name in PRESETS if name != "paper"])
def test_presets_are_near_their_data_sheets(name: str) -> None:
    ours = float(uniaxial_stress(PRESETS[name].law, [2.0])[0])
    assert 1 / 1.6 < ours / DATA_SHEET[name] < 1.6
    if "below" in PRESETS[name].source:
        below = round(100 * (1.0 - ours / DATA_SHEET[name]))
        assert f"{below} % below" in PRESETS[name].source


def test_elastosil_agrees_with_a_yeoh_law_in_use() -> None:
    # C1 0.11, C2 0.02 MPa, as in SorotokiCode (Elastosil28.m); up to 50 % strain
    lam = np.linspace(1.05, 1.5, 10)
    yeoh = 2.0 * (lam - lam**-2) * (0.11 + 0.04 * (lam**2 + 2.0 / lam - 3.0))
    ours = uniaxial_stress(PRESETS["elastosil-m4601"].law, lam)
    assert np.all(np.abs(ours / yeoh - 1.0) < 0.15)


def test_presets_text_shows_what_the_presets_are() -> None:
    header, *lines = presets_text().splitlines()
    assert header.split()[:4] == ["name", "law", "constants", "nu"]
    assert len(lines) == len(PRESETS)
    for line, rubber in zip(lines, PRESETS.values(), strict=True):
        name, law, rest = line.split(maxsplit=2)
        assert (name, law) == (rubber.name, rubber.law.name)
        assert rest.startswith(constants_text(rubber.record))
        nu, mu = rest.removeprefix(constants_text(rubber.record)).split()[:2]
        expected = (rubber.nu, rubber.law.shear_modulus)
        assert (float(nu), float(mu)) == pytest.approx(expected, abs=6e-5)
        assert line.endswith(rubber.source)


@pytest.mark.parametrize(
    "text", ["dragon-skin-30", " Dragon Skin 30 ", "DRAGON_SKIN_30", "dragon  skin-30"]
)
def test_a_preset_is_found_however_it_is_written(text: str) -> None:
    assert parse_rubber(text) is PRESETS["dragon-skin-30"]


def test_constants_of_mooney_rivlin() -> None:
    rubber = parse_rubber("Mooney-Rivlin: 0.0694, .0628 ,4.6e-1")
    assert rubber.law == PAPER_RUBBER
    assert rubber == Rubber(
        "mooney-rivlin:0.0694,.0628,4.6e-1", PAPER_RUBBER, "constants as given", None, None
    )


def test_constants_of_neo_hooke() -> None:
    rubber = parse_rubber("neo-hooke:0.12,0.49")
    assert rubber.law == NeoHooke.from_poisson(0.12, 0.49)
    assert rubber.nu == pytest.approx(0.49, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "law"),
    [
        ("yeoh:0.11,-0.01,0.002,0.46", Yeoh.from_poisson(0.11, -0.01, 0.002, 0.46)),
        ("Ogden:0.2,1.5,0.01,4,0.46", Ogden.from_poisson((0.2, 0.01), (1.5, 4.0), 0.46)),
    ],
)
def test_constants_of_other_laws(text: str, law: Yeoh | Ogden) -> None:
    rubber = parse_rubber(text)
    assert rubber.law == law
    assert law_of(rubber.record) == law
    assert rubber.record.law == law.name


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "give one of paper, "),
        ("ecoflex-00-30", "give one of paper, dragon-skin-10"),
        ("gent:0.1,2", "neo-hooke:C10,nu"),
        ("a\nb", "give one of"),
        ("x" * 10_000, "xxx..."),
        ("neo-hooke:", "as in mooney-rivlin:"),
        ("neo-hooke:0.1", "neo-hooke:C10,nu takes"),
        ("mooney-rivlin:0.1,0.46", "mooney-rivlin:C10,C01,nu takes"),
        ("mooney-rivlin:0.1,0.1,0.46,1", "C10,C01,nu takes"),
        ("mooney-rivlin:0.1,one,0.46", "C10,C01,nu takes"),
        ("yeoh:0.1,0,0.46", "yeoh:C10,C20,C30,nu takes"),
        ("yeoh:0.1,-0.09,0,0.46", "unstable between stretches"),
        ("ogden:0.1,2,0.29", "nu must"),
        ("ogden:0.1,2,3,0.46", "ogden:mu1"),
        ("ogden:0.1,0,0.46", "no alpha of 0"),
        ("neo-hooke:nan,0.46", "neo-hooke:C10,nu takes"),
        ("neo-hooke:0.1,0.5", "nu must lie in 0.3 .. 0.4995"),
        ("neo-hooke:0.1,0.49951", "nu must lie in"),
        ("neo-hooke:0.1,0.29", "nu must lie in"),
        ("neo-hooke:0.1,-0.4", "nu must lie in"),
        ("mooney-rivlin:0.1,-0.01,0.46", "unstable"),
        ("mooney-rivlin:-0.01,0.1,0.46", "unstable"),
        ("mooney-rivlin:0,0,0.46", "C10 + C01 > 0"),
        ("mooney-rivlin:69.4,62.8,0.46", "in MPa"),
        ("neo-hooke:1e999,0.46", "finite"),
    ],
)
def test_what_makes_no_sense_is_refused(text: str, says: str) -> None:
    with pytest.raises(UsageError) as caught:
        parse_rubber(text)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


LAM = np.array([1.0, 1.1, 1.25, 1.4, 1.6, 1.8, 2.0])


STRESS = uniaxial_stress(PAPER_RUBBER, LAM)


@pytest.mark.parametrize(
    "text",
    [
        csv(LAM, STRESS),
        csv(LAM[::-1], STRESS[::-1]),
        csv(LAM, STRESS, "stretch,stress"),
        csv(LAM, STRESS, "# a test of 2020\n\n Lambda ,Nominal stress [MPa]"),
        csv(LAM - 1.0, STRESS, "strain,stress_MPa"),
        csv(LAM - 1.0, STRESS, '"Engineering Strain","Engineering Stress (N/mm²)"'),
        csv(LAM, 1e3 * STRESS, "stretch,stress_kPa"),
        csv(STRESS, LAM - 1.0, "stress / MPa,strain"),
        csv(LAM, STRESS, "stretch,stress").replace(",", ";").replace(".", ","),
        csv(LAM, STRESS).replace(",", "\t"),
        csv(LAM, STRESS).replace(",", "   "),
        csv(LAM, STRESS).replace("\n", "\r\n"),
        csv(LAM, STRESS).replace(",", ",7,").replace("1.0,7", "stretch,time,stress\n1.0,7", 1),
    ],
)
def test_a_file_may_be_written_in_many_ways(tmp_path: Path, text: str) -> None:
    (tmp_path / "test 1.csv").write_text(text, encoding="utf-8", newline="")
    rubber = parse_rubber(str(tmp_path / "test 1.csv"))
    assert rubber.name == "test 1.csv"
    assert pytest.approx(0.0694, abs=1e-7) == rubber.law.C10
    assert pytest.approx(0.0628, abs=1e-7) == rubber.law.C01
    assert rubber.nu == pytest.approx(0.46, rel=1e-9)
    assert rubber.stretch_range == pytest.approx((1.0, 2.0))
    assert rubber.rms_MPa is not None
    assert rubber.rms_MPa < 1e-7
    assert "fit to 7 points" in rubber.source
    assert "nu 0.46 is assumed" in rubber.source
    assert "\n" not in rubber.source


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "only 0 different"),
        (b"stretch,stress\n", "only 0 different"),
        (b"\0\1\2", "not plain text"),
        (b"1.1,0.1\n1.2\n", "line 2 holds 1 fields"),
        (b"1.1,0.1,3\n", "line 1 holds 3 fields"),
        (b"1.1,0.1\n\n1.2,abc\n", "line 3: 'abc' is no finite number"),
        (b"1.1,0.1\n1.2,nan\n", "line 2: 'nan' is no finite number"),
        (b"1.1,0.1\n1.2,1e999\n", "line 2: '1e999' is no finite number"),
        (b"a,b\n1.1,0.1\n", "the header must name"),
        (b"strain,stretch,stress\n1,1,1\n", "the header must name"),
        (b"stress-strain\n1\n", "the header must name"),
        (b"true strain,true stress\n1.1,0.1\n", "not true stress"),
        (b"strain,stress (stone/acre)\n0.1,10\n", "not known; convert it to MPa"),
        (b"strain,stress_N\n0.1,10\n", "a force"),
        (b"strain (mm),stress\n0.1,10\n", "a length"),
        (b"strain,stress\n10,0.1\n20,0.2\n30,0.3\n40,0.4\n50,0.5\n", "in percent"),
        (b"0,0\n0.1,0.1\n0.2,0.2\n1.5,0.3\n1.6,1\n1.7,1\n1.8,1\n1.9,1", '"strain,stress"'),
        (b"1.5,0.1\n" * (MOST_POINTS + 1), "thin them out"),
        (b"#" * 5_000_001, "too large"),
    ],
)
def test_a_malformed_file_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, data: bytes, says: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bad.csv").write_bytes(data)
    with pytest.raises(UnreadableInput) as caught:
        parse_rubber("bad.csv")
    assert says in str(caught.value)
    assert "bad.csv" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["absent.csv", "absent.TXT", ".", "\0.csv", "x" * 300 + ".csv"])
def test_a_file_that_cannot_be_read(text: str) -> None:
    with pytest.raises(UnreadableInput, match="cannot read") as caught:
        parse_rubber(text)
    assert "\n" not in str(caught.value)


def test_a_file_that_may_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    (tmp_path / "mine.csv").write_text(csv(LAM, STRESS))
    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(UnreadableInput, match="no permission"):
        parse_rubber(str(tmp_path / "mine.csv"))


def test_a_file_needs_no_suffix_and_a_preset_goes_before_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("mine", "paper"):
        Path(name).write_text(csv(LAM, 2.0 * STRESS))
    assert pytest.approx(2.0 * 0.0694, abs=1e-7) == parse_rubber("mine").law.C10
    assert parse_rubber("paper") is PRESETS["paper"]
    assert pytest.approx(2.0 * 0.0694, abs=1e-7) == parse_rubber("./paper").law.C10
