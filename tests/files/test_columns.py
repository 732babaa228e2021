"""Numbers as spreadsheets and instruments write them."""

from __future__ import annotations

import pytest

from profiletool.errors import UnreadableInput
from profiletool.files.columns import MAX_LINE, NUMBER, read_lines, shown


@pytest.mark.parametrize(
    ("line", "fields"),
    [
        ("1.5,2", ["1.5", "2"]),
        ("1,5;2", ["1.5", "2"]),  # decimal commas where semicolons separate
        ("1.5\t2,0", ["1.5", "2.0"]),
        ("  1.5   2 ", ["1.5", "2"]),
        ("1.5, 2 # the last", ["1.5", "2"]),
        ("1,,2", ["1", "", "2"]),
    ],
)
def test_separators(line: str, fields: list[str]) -> None:
    assert list(read_lines(line.encode())) == [(1, fields)]


def test_lines_keep_their_numbers() -> None:
    data = b"# a test\r\n\r\n1 2\n   \n3 4"
    assert list(read_lines(data)) == [(3, ["1", "2"]), (5, ["3", "4"])]


@pytest.mark.parametrize("data", ["\ufeffStärke;2".encode(), "Stärke;2".encode("latin-1")])
def test_words_in_other_encodings(data: bytes) -> None:
    assert list(read_lines(data)) == [(1, ["Stärke", "2"])]


def test_what_is_no_text_is_refused() -> None:
    with pytest.raises(UnreadableInput, match="not plain text"):
        list(read_lines(b"1,2\n\0"))
    assert len(list(read_lines(b"1" * MAX_LINE))) == 1
    with pytest.raises(UnreadableInput, match="line 2 never ends"):
        list(read_lines(b"1,2\n" + b"1" * (MAX_LINE + 1)))


def test_numbers() -> None:
    good, bad = ("1", "-1.", "+.5", "1e-3", "2.5E+07"), ("", ".", "1e", "nan", "inf", "1_0", "٣")
    assert all(NUMBER.fullmatch(text) for text in good)
    assert not any(NUMBER.fullmatch(text) for text in bad)


def test_a_bad_field_is_shown_short_and_in_ascii() -> None:
    assert shown("abc") == "'abc'"
    assert shown("ü\n\x1b[31m") == "'\\xfc\\n\\x1b[31m'"
    assert len(shown("9" * 1000)) == 22
