"""Whatever names a rubber gives one or is refused in one line."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import example, given
from hypothesis import strategies as st

from profiletool.errors import UnreadableInput, UsageError
from profiletool.rubber.presets import NUS, parse_rubber
from profiletool.rubber.uniaxial import STIFFNESSES


def refusal(text: str, *errors: type[Exception]) -> str:
    """Why the text is refused, or "" where it gives a sound rubber."""
    try:
        rubber = parse_rubber(text)
    except errors as error:
        return str(error)
    assert rubber.law.C10 >= 0.0
    assert rubber.law.C01 >= 0.0
    assert STIFFNESSES[0] <= rubber.law.C10 + rubber.law.C01 <= STIFFNESSES[1]
    assert NUS[0] - 1e-9 <= rubber.nu <= NUS[1] + 1e-9
    return ""


NUMBERS = st.one_of(
    st.floats(0.0, 1.0).map(repr), st.floats().map(repr), st.text("0123456789.eE+- ", max_size=8)
)


@given(
    st.one_of(
        st.text(),
        st.builds(
            lambda law, numbers: f"{law}:{','.join(numbers)}",
            st.sampled_from(["mooney-rivlin", "neo-hooke", "Neo-Hooke ", "yeoh", "ogden"]),
            st.lists(NUMBERS, max_size=4),
        ),
        st.text().map(lambda stem: stem + ".csv"),
    )
)
def test_any_text_is_a_rubber_or_refused(text: str) -> None:
    assert refusal(text, UsageError, UnreadableInput).count("\n") == 0


ROWS = st.lists(
    st.tuples(st.floats(0.3, 9.0), st.one_of(st.floats(-1.0, 10.0), st.floats())), max_size=12
).map(lambda rows: "\n".join(f"{x!r},{y!r}" for x, y in rows).encode())


@given(
    st.sampled_from([b"", b"stretch,stress\n", b"strain;stress_kPa\n", b"\xef\xbb\xbf"]),
    st.one_of(st.binary(), st.text("0123456789.,;eE+-#\n\t naif%").map(str.encode), ROWS),
)
@example(b"", b"1.1,5e-324\n1.2,5e-324\n1.3,5e-324\n1.4,5e-324\n1.5,1e-323")
@example(b"", b"1.1,-1e6\n1.2,1e6\n1.3,-1e6\n1.4,1e6\n1.5,-1e6")
def test_any_bytes_are_a_test_or_refused(header: bytes, data: bytes) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "x.csv"
        path.write_bytes(header + data)
        assert refusal(str(path), UnreadableInput).count("\n") == 0
