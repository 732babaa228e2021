"""One pivot of a block elimination: Cholesky, or its eigenvalues where it is not positive."""

from __future__ import annotations

import numpy as np

from fem import blas
from fem.arrays import DOUBLE, DType, FloatArray


class DoubtfulPivot(ArithmeticError):
    """A pivot in single precision is not positive: in double it may be, or is known to be not."""


class Pivot:
    """A symmetric matrix A (n, n) as L S L^T with S = 1, or a diagonal of signs.

    L is the Cholesky factor in the usual case. Where A is indefinite, its eigenvalues take its
    place: L = Q |E|^(1/2), S = sign(E). They tell how many directions are unstable.
    In single precision nobody can tell, and `DoubtfulPivot` is raised.
    """

    def __init__(self, n: int, dtype: DType = DOUBLE) -> None:
        self.factor = np.empty((n, n), dtype)
        self.signs: FloatArray | None = None

    def factorise(self, A: FloatArray, last: FloatArray) -> None:
        """Factor A plus ``last`` (k, k) in its last rows, both given by their upper triangles."""
        self.signs = None
        self._sum(A, last)
        if len(A) and not blas.cholesky(self.factor):
            if self.factor.dtype != DOUBLE:
                raise DoubtfulPivot
            self._sum(A, last)
            self._decompose(np.triu(self.factor) + np.triu(self.factor, 1).T)

    def _sum(self, A: FloatArray, last: FloatArray) -> None:
        np.copyto(self.factor, A)
        behind = len(A) - len(last)
        self.factor[behind:, behind:] += last

    def _decompose(self, A: FloatArray) -> None:
        """Factor by eigenvalues; ``factor`` then holds L^-1 transposed."""
        E, Q = np.linalg.eigh(A)
        size = np.maximum(np.abs(E), 1e-14 * np.abs(E).max())
        self.factor[...] = Q / np.sqrt(size)
        self.signs = np.where(E < 0.0, -1.0, 1.0)

    @property
    def negative(self) -> int:
        """How many negative eigenvalues A has."""
        return 0 if self.signs is None else int((self.signs < 0.0).sum())

    def reduce(self, B: FloatArray) -> None:
        """Overwrite B (n, m) with L^-1 B."""
        if self.signs is None:
            blas.solve_lower(self.factor, B)
        else:
            B[...] = self.factor.T @ B

    def update(self, C: FloatArray, B: FloatArray) -> None:
        """Take B^T S B from the upper triangle of C (m, m), for B (n, m) reduced."""
        if self.signs is None:
            blas.subtract_gram(C, B)
        else:
            C -= B.T @ (self.signs[:, None] * B)

    def forward(self, rows: FloatArray) -> None:
        """Overwrite every row r of rows (k, n) with S L^-1 r."""
        if self.signs is None:
            blas.solve_rows(self.factor, rows, transposed=False)
        else:
            rows[...] = (rows @ self.factor) * self.signs

    def backward(self, rows: FloatArray) -> None:
        """Overwrite every row r of rows (k, n) with L^-T r."""
        if self.signs is None:
            blas.solve_rows(self.factor, rows, transposed=True)
        else:
            rows[...] = rows @ self.factor.T
