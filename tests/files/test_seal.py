"""The seal of a design: no edit of its file is called verified."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from profiletool.errors import UnreadableInput
from profiletool.files.design_json import from_json, load_design, to_json
from profiletool.records.built import BuildErrors, Built, BuiltMisfit, BuiltPart, TrimPoint
from profiletool.records.design import Design, Misfit, Sensitivity
from profiletool.records.neighbour import Neighbour
from profiletool.records.seal import proven, sealed
from profiletool.template.layout import build_sheet
from profiletool.verdict.summary import headline, summary

SAMPLE = Path(__file__).parents[2] / "samples" / "paper_bulb.json"


def made() -> Design:
    """A design that holds something under every key, as if finite elements had verified it."""
    paper = load_design(SAMPLE)
    off = BuiltMisfit(5.0, 1.0)
    joints = tuple(replace(j, theta_fe_deg=30.0, stretch_fe=2.0) for j in paper.joints)
    return sealed(
        replace(
            paper,
            joints=joints,
            fit=replace(paper.fit, fe=Misfit(0.2, 0.5), response=Misfit(0.3, 0.6)),
            verified=True,
            sensitivity=(Sensitivity("pressure 0.05 bar off", None, 1.0, 2.0),),
            built=Built(BuildErrors(), off, off, (BuiltPart("wall", 2.0, 0.1),)),
            trim=(TrimPoint(1.9, (1.0, 2.0), (30.0,) * 6),),
            threads_off_mm=off,
            neighbours=(
                Neighbour("as chosen", 6, 1.9, 0.2, 1.0, "joint response"),
                Neighbour("lower pressure", 6, 1.7, 0.3, None, "FE"),
            ),
        )
    )


DESIGN = made()
TREE = json.loads(to_json(DESIGN))


def paths(node: Any, here: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Every place in a tree but its root."""
    if here:
        yield here
    inner = node if isinstance(node, list) else list(node) if isinstance(node, dict) else ()
    pairs = enumerate(inner) if isinstance(node, list) else ((key, node[key]) for key in inner)
    for key, value in pairs:
        yield from paths(value, (*here, key))


PATHS = list(paths(TREE))
ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=2) | st.dictionaries(st.text(max_size=4), inner, max_size=2)
    ),
    max_leaves=3,
)


def edited(path: tuple[Any, ...], change: Any) -> str:
    """The file with one place given to ``change``: its container and its key."""
    tree = copy.deepcopy(TREE)
    holder = tree
    for key in path[:-1]:
        holder = holder[key]
    change(holder, path[-1])
    return json.dumps(tree)


def assert_never_verified(text: str) -> None:
    try:
        read = from_json(text, "design.json")
    except UnreadableInput:
        return
    if replace(read, seal=None) == replace(DESIGN, seal=None) and read.seal == DESIGN.seal:
        return  # another way to write the same value
    assert not proven(read)
    assert not read.verified
    assert "NOT VERIFIED" in summary(read)
    assert "NOT VERIFIED" in headline(read)


def test_a_design_that_was_not_edited_is_verified() -> None:
    read = from_json(to_json(DESIGN), "x")
    assert proven(read)
    assert "NOT VERIFIED" not in summary(read)
    respaced = json.dumps(json.loads(to_json(DESIGN)), sort_keys=True).replace(" 20.0,", " 20,")
    assert from_json(respaced, "x") == DESIGN


@settings(max_examples=300)
@given(path=st.sampled_from(PATHS), value=ANYTHING)
def test_any_value_at_any_key(path: tuple[Any, ...], value: Any) -> None:
    assert_never_verified(edited(path, lambda holder, key: holder.__setitem__(key, value)))


@settings(max_examples=200)
@given(
    path=st.sampled_from([p for p in PATHS if isinstance(p[-1], str)]),
    share=st.floats(-0.5, 0.5).filter(lambda x: abs(x) > 1e-5),
)
def test_any_number_a_little_off(path: tuple[Any, ...], share: float) -> None:
    def off(holder: Any, key: Any) -> None:
        if isinstance(holder[key], float):
            holder[key] = holder[key] * (1.0 + share) + share

    text = edited(path, off)
    if text != json.dumps(TREE):
        assert_never_verified(text)


@pytest.mark.parametrize(
    "path", [p for p in PATHS if isinstance(p[-1], str) and "constants" not in p]
)
def test_no_key_can_be_left_out_or_added(path: tuple[Any, ...]) -> None:
    assert_never_verified(edited(path, lambda holder, key: holder.pop(key)))
    text = edited(path, lambda holder, key: holder.__setitem__(f"{key}_", 1.0))
    with pytest.raises(UnreadableInput, match="no key of a design"):
        from_json(text, "design.json")


def test_an_edit_is_said() -> None:
    text = edited(("pressure_bar",), lambda holder, key: holder.__setitem__(key, 1.8))
    read = from_json(text, "design.json")
    assert "NOT VERIFIED: it was changed since" in read.warnings[0]
    assert build_sheet(read).drawing.title.endswith("NOT VERIFIED")


def test_a_change_in_python_is_no_verified_design_either() -> None:
    other = replace(DESIGN, pressure_bar=1.8)
    assert other.verified
    assert not proven(other)
    assert "NOT VERIFIED" in summary(other)
    assert not from_json(to_json(other), "x").verified


def test_an_older_file_cannot_be_known_to_be_verified() -> None:
    tree = {**TREE, "schema": "profiletool.design/2"}
    del tree["seal"], tree["clamp"]
    read = from_json(json.dumps(tree), "x")
    assert not read.verified
    assert "nothing tells whether it was changed" in read.warnings[0]


def test_a_file_from_before_there_were_neighbours_and_grips_is_verified_still() -> None:
    tree = json.loads(to_json(sealed(replace(DESIGN, neighbours=()))))
    del tree["neighbours"], tree["grip"]
    read = from_json(json.dumps(tree), "x")
    assert proven(read)
    # To take them out of a file that has them is an edit, though.
    text = edited(("neighbours",), lambda holder, key: holder.__setitem__(key, []))
    assert not proven(from_json(text, "x"))


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        (("joints", 1, "F_mm"), 20.0, "F_mm of joint 2 is 20 mm, by the joints' places"),
        (("joints", 2, "centre_mm"), 47.5, "F_mm of joint 2 is 19 mm"),
        (("tube", "root_mm"), 11.0, "tube.root_mm is 11 mm"),
        (("joints", 5, "F_mm"), 40.0, "F_mm of joint 6 goes beyond"),
    ],
)
def test_facts_that_are_stored_twice_agree(path: tuple[Any, ...], value: float, says: str) -> None:
    with pytest.raises(UnreadableInput, match=says):
        from_json(edited(path, lambda holder, key: holder.__setitem__(key, value)), "x")


def test_a_key_stands_once() -> None:
    text = to_json(DESIGN).replace(
        '"pressure_bar": 1.9', '"pressure_bar": 1.8, "pressure_bar": 1.9', 1
    )
    with pytest.raises(UnreadableInput, match="'pressure_bar' stands twice"):
        from_json(text, "x")
