"""Claims of the README and the guide, one by one, each with the command that shows it."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from PIL import Image

from tests.calls import Result, call

ROOT = Path(__file__).parents[2]
EGG = ROOT / "samples" / "egg.png"
QUICK = ("--method", "paper", "--no-verify")  # without the time of a choice, and of FE
BULB = "30,30,30,25,20,45"


@dataclass(frozen=True)
class Claim:
    """A sentence of a page, the command that shows it, and what is to be seen."""

    page: str
    says: str
    command: tuple[object, ...]
    shown: Callable[[Result], bool]

    def __str__(self) -> str:
        return re.sub(r"\W+", "_", f"{self.page} {self.says}")[:60]


def words(text: str) -> str:
    return " ".join(text.split())


def design() -> dict[str, object]:
    found: dict[str, object] = json.loads(Path("egg_design/design.json").read_text("utf-8"))
    return found


def written(*names: str) -> bool:
    return all((Path("egg_design") / name).exists() for name in names)


def table_cell(result: Result, bar: float, alpha: float) -> float:
    cells = json.loads(result.stdout)
    (theta,) = (
        cell["theta_deg"]
        for cell in cells
        if (cell["pressure_bar"], cell["alpha_closed_deg"]) == (bar, alpha)
    )
    return float(theta)


def six_decimals(_: Result) -> bool:
    numbers = re.findall(r"\d+\.(\d+)", Path("egg_design/design.json").read_text("utf-8"))
    return max(map(len, numbers)) <= 6


def same_bytes(_: Result) -> bool:
    call("design", EGG, *QUICK, "--out", "again")
    files = ("design.json", "template.dxf")
    folders = (Path("egg_design"), Path("again"))
    first, second = ([(folder / name).read_bytes() for name in files] for folder in folders)
    return first == second


def rows_per_joint(_: Result) -> bool:
    """Count, at every joint, the places along the tube that have slits."""
    slits = ezdxf.readfile("egg_design/template.dxf").modelspace().query("LWPOLYLINE")
    places = [line.get_points("xy") for line in slits if line.dxf.layer == "CUT_INNER"]
    along = {round(float(np.mean([x for x, _ in points])), 2) for points in places}
    joints = json.loads(Path("egg_design/design.json").read_text("utf-8"))["joints"]
    return len(along) == sum(round(joint["openF_mm"] / 2.0) for joint in joints)


def one_outline(_: Result) -> bool:
    lines = ezdxf.readfile("egg_design/template.dxf").modelspace().query("LWPOLYLINE")
    outer = [line for line in lines if line.dxf.layer == "CUT_OUTER"]
    return len(outer) == 1 and outer[0].closed


def cut_edit(_: Result) -> bool:
    tree = design() | {"colour": "blue"}
    Path("egg_design/design.json").write_text(json.dumps(tree), "utf-8")
    refused = call("template", "egg_design")
    return refused.exit_code == 3 and "colour: no key of a design" in refused.stderr


def ends(code: int, *texts: str) -> Callable[[Result], bool]:
    def shown(result: Result) -> bool:
        lines = [line for line in result.stderr.splitlines() if line.startswith("error: ")]
        return (
            result.exit_code == code and len(lines) == 1 and all(text in lines[0] for text in texts)
        )

    return shown


DESIGN = ("design", EGG, *QUICK)
CLAIMS = [
    Claim("README.md", "the design then says NOT VERIFIED.", DESIGN,
          lambda _: "NOT VERIFIED" in Path("egg_design/template.svg").read_text("utf-8")),
    Claim("docs/commands.md", "Without `--out` the folder is the picture's name with `_design`.",
          DESIGN, lambda _: written("design.json")),
    Claim("docs/commands.md", "Results go to standard output, progress and messages to standard "
          "error.", DESIGN,
          lambda r: r.stdout.startswith("egg.png: ") and r.stderr.startswith("object: ")),
    Claim("docs/commands.md", "`--version` tells the version", ("--version",),
          lambda r: bool(re.fullmatch(r"profiletool \d+\.\d+\S*\n", r.stdout))),
    Claim("docs/commands.md", "Only folders that hold a `design.json`, a `fe.json` or a "
          "`formula.json` are replaced.", (*DESIGN, "--out", "mine", "--force"),
          lambda r: r.exit_code == 2 and Path("mine/diary.txt").exists()),
    Claim("docs/commands.md", "pressure 1.90 bar",
          ("assign", "--openF", "8,8,8,8,6,10", "--theta", BULB),
          lambda r: "1         8         30               132         30.6" in r.stdout),
    Claim("docs/theory.md", "For the bulb of the paper it gives Table 5: α of 132°, 132°, 132°, "
          "144°, 144° and 108° at 1.90 bar.",
          ("assign", "--openF", "8,8,8,8,6,10", "--theta", BULB, "--json"),
          lambda r: json.loads(r.stdout)["alpha_closed_deg"] == [132, 132, 132, 144, 144, 108]),
    Claim("docs/theory.md", "the table has 44.9°, the formula gives 45.3°.",
          ("table", "--openF", "10", "--json"),
          lambda r: abs(table_cell(r, 2.0, 120.0) - 45.3) < 0.05),
    Claim("docs/measured.md", "| formula (9), fitted to the paper's FE | 18.7° | 50.5° |",
          ("table", "--openF", "10", "--json"),
          lambda r: abs(table_cell(r, 1.0, 84.0) - 18.7) < 0.06
          and abs(table_cell(r, 2.0, 84.0) - 50.5) < 0.06),
    Claim("docs/formats.md", "Numbers are rounded to six decimals.", DESIGN, six_decimals),
    Claim("docs/formats.md", '`"schema": "profiletool.design/3"`', DESIGN,
          lambda _: design()["schema"] == "profiletool.design/3"),
    Claim("docs/formats.md", "Files of FE are missing where no FE was run.", DESIGN,
          lambda _: not written("actuator.vtu") and not written("theta_vs_pressure.csv")),
    Claim("docs/formats.md", "The same input, options and library versions give the same "
          "`design.json` and `template.dxf`, byte for byte.", DESIGN, same_bytes),
    Claim("docs/formats.md", "Columns `curve,s_mm,x_mm,y_mm`", DESIGN,
          lambda _: Path("egg_design/shape.csv").read_text().startswith("curve,s_mm,x_mm,y_mm\n")),
    Claim("docs/formats.md", "Refused are unknown keys", DESIGN, cut_edit),
    Claim("docs/formats.md", "so there are openF / pitch of them.", DESIGN, rows_per_joint),
    Claim("docs/formats.md", "outline of the piece, one closed polyline, with the notch", DESIGN,
          one_outline),
    Claim("docs/pictures_and_drawings.md", "With none of these the run ends with exit code 4.",
          ("design", "unsized.png", *QUICK), ends(4, "--height")),
    Claim("docs/pictures_and_drawings.md", "those of cameras and screens (72, 96, 120, 144 dpi "
          "and so on) count as not stored", ("design", "screen.png", *QUICK), ends(4, "--height")),
    Claim("docs/pictures_and_drawings.md", "GIF, PDF and camera raw files are refused: export "
          "them as JPEG or PNG.", ("design", "a.gif", "--height", "60"), ends(3)),
    Claim("docs/pictures_and_drawings.md", "`--rotate auto` and `--symmetric` need a closed "
          "outline.", ("design", "arc.csv", "--rotate", "auto"), ends(2, "--rotate")),
    Claim("docs/pictures_and_drawings.md", "The profile must be at least two diameters of the tube "
          "long", ("design", "arc.csv", "--diameter", "40", "--wall", "4", *QUICK),
          ends(5, "shorter than two diameters")),
    Claim("docs/pictures_and_drawings.md", "`--mm-per-px X`", (*DESIGN, "--mm-per-px", "0"),
          ends(2, "--mm-per-px")),
    Claim("docs/commands.md", "More than `--max-pressure` is bad usage.",
          (*DESIGN, "--pressure", "1.5", "--max-pressure", "1.2"),
          ends(2, "--pressure", "--max-pressure")),
    Claim("docs/commands.md", "profiletool sheet                       # sheet_a4.pdf", ("sheet",),
          lambda _: Path("sheet_a4.pdf").exists()),
    Claim("docs/own_tube.md", "`--rubber list` prints the presets with their sources",
          ("derive", "--rubber", "list"),
          lambda r: "dragon-skin-20" in r.stdout and "Marechal" in r.stdout),
]  # fmt: skip


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with the files that the commands name."""
    monkeypatch.chdir(tmp_path)
    Path("mine").mkdir()
    Path("mine/diary.txt").write_text("mine")
    angle = np.linspace(0.0, 0.5 * np.pi, 60)
    np.savetxt("arc.csv", 30.0 * np.column_stack([-np.sin(angle), np.cos(angle)]), delimiter=",")
    with Image.open(EGG) as egg:
        small = egg.convert("RGB").resize((400, 450))
        small.save("unsized.png")
        small.save("screen.png", dpi=(72, 72))
        small.save("a.gif")


@pytest.fixture(scope="module")
def egg(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Path]:
    """The command that most claims are shown by, run once, and its folder."""
    out = tmp_path_factory.mktemp("egg") / "egg_design"
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(out.parent)
        return call(*DESIGN), out


SLOW = {same_bytes}  # a design with all its files once more


@pytest.mark.parametrize(
    "claim",
    [
        pytest.param(claim, id=str(claim), marks=pytest.mark.slow if claim.shown in SLOW else ())
        for claim in CLAIMS
    ],
)
def test_a_claim(claim: Claim, egg: tuple[Result, Path]) -> None:
    assert words(claim.says) in words((ROOT / claim.page).read_text("utf-8"))
    if claim.command == DESIGN:
        result = egg[0]
        shutil.copytree(egg[1], "egg_design")
    else:
        result = call(*claim.command)
    assert claim.shown(result)


def test_they_are_many() -> None:
    assert len(CLAIMS) >= 25
