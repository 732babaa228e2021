"""Dense kernels by pointer, and the count of BLAS's threads."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from fem import blas
from fem.arrays import DOUBLE, SINGLE, DType


def counts() -> list[int]:
    return [get() for get, _ in blas._thread_switches()]


@pytest.fixture
def told() -> None:
    """Skip where this BLAS cannot be told how many threads to use."""
    if not counts():
        pytest.skip("this BLAS keeps its own count")


def definite(n: int, seed: int) -> np.ndarray:
    M = np.random.default_rng(seed).normal(size=(n, n))
    return M @ M.T + n * np.eye(n)


def test_cholesky_reads_and_writes_the_upper_triangle() -> None:
    A = definite(6, 0)
    U = np.triu(A) + np.tril(np.full((6, 6), 77.0), -1)
    assert blas.cholesky(U)
    np.testing.assert_allclose(np.triu(U).T @ np.triu(U), A, rtol=1e-12)
    np.testing.assert_array_equal(np.tril(U, -1), np.tril(np.full((6, 6), 77.0), -1))


def test_cholesky_tells_an_indefinite_matrix() -> None:
    assert not blas.cholesky(np.array([[1.0, 2.0], [2.0, 1.0]]))


@pytest.mark.parametrize("dtype", [DOUBLE, SINGLE])
@pytest.mark.parametrize("n", [5, 48, 73, 131])
def test_triangular_solves_and_the_gram_matrix(n: int, dtype: DType) -> None:
    U, rng = definite(n, 1).astype(dtype), np.random.default_rng(2)
    blas.cholesky(U)
    T, close = np.triu(U), 1e5 * np.finfo(dtype).eps
    B, rows = rng.normal(size=(n, 3)).astype(dtype), rng.normal(size=(4, n)).astype(dtype)
    solved = B.copy()
    blas.solve_lower(U, solved)
    np.testing.assert_allclose(T.T @ solved, B, atol=close)
    for some in (rows, rows[:1]):  # many at once, and one by one
        forward, backward = some.copy(), some.copy()
        blas.solve_rows(U, forward, transposed=False)
        blas.solve_rows(U, backward, transposed=True)
        np.testing.assert_allclose(forward @ T, some, atol=close)
        np.testing.assert_allclose(backward @ T.T, some, atol=close)
    C = np.zeros((3, 3), dtype)
    blas.subtract_gram(C, B)
    np.testing.assert_allclose(C, -np.triu(B.T @ B), atol=close)


def test_nothing_to_solve() -> None:
    U, empty = np.eye(2), np.empty((2, 0))
    blas.solve_lower(U, empty)
    blas.subtract_gram(np.empty((0, 0)), empty)
    blas.solve_rows(U, np.empty((0, 2)), transposed=True)
    np.testing.assert_array_equal(U, np.eye(2))


@pytest.mark.usefixtures("told")
def test_one_thread_gives_the_count_back() -> None:
    switches, before = blas._thread_switches(), counts()
    try:
        for _, put in switches:
            put(2)
        with blas.one_thread():
            assert counts() == [1] * len(switches)
        assert counts() == [2] * len(switches)
        with pytest.raises(KeyError), blas.one_thread():
            raise KeyError
        assert counts() == [2] * len(switches)
    finally:
        for (_, put), count in zip(switches, before, strict=True):
            put(count)


@pytest.mark.usefixtures("told")
def test_one_thread_nests_over_threads() -> None:
    switches, before = blas._thread_switches(), counts()
    inside, leave = threading.Event(), threading.Event()

    def other() -> None:
        with blas.one_thread():
            inside.set()
            leave.wait(10.0)

    try:
        for _, put in switches:
            put(2)
        worker = threading.Thread(target=other)
        with blas.one_thread():
            worker.start()
            assert inside.wait(10.0)
        # The other solver is still at work.
        assert counts() == [1] * len(switches)
        leave.set()
        worker.join(10.0)
        assert counts() == [2] * len(switches)
    finally:
        leave.set()
        for (_, put), count in zip(switches, before, strict=True):
            put(count)
