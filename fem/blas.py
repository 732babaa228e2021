"""Dense kernels in double or single precision that let other threads run; BLAS on one thread.

numpy lets go of the interpreter's lock in products; scipy's wrappers of Cholesky and triangular
solves do not, so these are called through the pointers that scipy exports (see the
documentation of scipy.linalg.cython_blas). At the sizes of one cross-section BLAS's own threads
make the whole several times slower; they are held to one while a solver works. (threadpoolctl
3.8 is no help there: with OpenBLAS only the thread that first set the count may change it, so that
of two solvers in two threads the one that ends last could not give the count back.)
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from fem.arrays import SINGLE, FloatArray


@cache
def _kernel(module: str, name: str, arguments: int) -> Callable[..., None]:
    """Load a kernel at its first use: scipy.linalg takes most of the package's import time."""
    capsule = import_module(f"scipy.linalg.{module}").__pyx_capi__[name]
    api = ctypes.pythonapi
    api.PyCapsule_GetName.restype = ctypes.c_char_p
    api.PyCapsule_GetName.argtypes = [ctypes.py_object]
    api.PyCapsule_GetPointer.restype = ctypes.c_void_p
    api.PyCapsule_GetPointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
    pointer = api.PyCapsule_GetPointer(capsule, api.PyCapsule_GetName(capsule))
    return ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * arguments)(pointer)


_STRIDE = ctypes.c_int(1)
_FEW = 3  # right sides up to which one at a time is quicker
_ONE = {"d": ctypes.c_double(1.0), "s": ctypes.c_float(1.0)}
_MINUS = {"d": ctypes.c_double(-1.0), "s": ctypes.c_float(-1.0)}
_ref = ctypes.byref


def _letter(A: FloatArray) -> str:
    """Give the letter of the kernels for an array's precision."""
    return "s" if A.dtype == SINGLE else "d"


def cholesky(A: FloatArray) -> bool:
    """Factor A (n, n), given by its upper triangle, in place: A = U^T U.

    Returns
    -------
    bool
        Whether A is positive definite; it is spoilt where it is not.
    """
    n, info = ctypes.c_int(len(A)), ctypes.c_int()
    _kernel("cython_lapack", f"{_letter(A)}potrf", 5)(
        b"L", _ref(n), A.ctypes.data, _ref(n), _ref(info)
    )
    return info.value == 0


def solve_lower(U: FloatArray, B: FloatArray) -> None:
    """Overwrite B (n, m) with U^-T B."""
    if B.size == 0:
        return
    # C order is LAPACK's transpose: B^T U^-1 with a lower triangle there.
    n, m, letter = ctypes.c_int(B.shape[0]), ctypes.c_int(B.shape[1]), _letter(B)
    _kernel("cython_blas", f"{letter}trsm", 11)(
        b"R", b"L", b"T", b"N", _ref(m), _ref(n), _ref(_ONE[letter]),
        U.ctypes.data, _ref(n), B.ctypes.data, _ref(m),
    )  # fmt: skip


def solve_rows(U: FloatArray, rows: FloatArray, transposed: bool) -> None:
    """Overwrite every row r of rows (k, n) with U^-T r, or U^-1 r where ``transposed``."""
    if rows.size == 0:
        return
    n, k, letter = ctypes.c_int(rows.shape[1]), ctypes.c_int(rows.shape[0]), _letter(rows)
    side = b"T" if transposed else b"N"
    if k.value <= _FEW:
        solve = _kernel("cython_blas", f"{letter}trsv", 8)
        for row in rows:
            solve(b"L", side, b"N", _ref(n), U.ctypes.data, _ref(n), row.ctypes.data, _ref(_STRIDE))
        return
    _kernel("cython_blas", f"{letter}trsm", 11)(
        b"L", b"L", side, b"N", _ref(n), _ref(k), _ref(_ONE[letter]),
        U.ctypes.data, _ref(n), rows.ctypes.data, _ref(n),
    )  # fmt: skip


def subtract_gram(C: FloatArray, B: FloatArray) -> None:
    """Take B^T B from the upper triangle of C (m, m), for B (n, m)."""
    if B.size == 0:
        return
    n, m, letter = ctypes.c_int(B.shape[0]), ctypes.c_int(B.shape[1]), _letter(B)
    _kernel("cython_blas", f"{letter}syrk", 10)(
        b"L", b"N", _ref(m), _ref(n), _ref(_MINUS[letter]),
        B.ctypes.data, _ref(m), _ref(_ONE[letter]), C.ctypes.data, _ref(m),
    )  # fmt: skip


@cache
def _thread_switches() -> tuple[tuple[Any, Any], ...]:
    """Getter and setter of the thread count of every OpenBLAS that numpy and scipy brought."""
    switches = []
    for package in (np, scipy):
        home = Path(str(package.__file__)).parent
        for folder in (home.parent / f"{package.__name__}.libs", home / ".dylibs"):
            for path in sorted(folder.glob("*openblas*")):
                library = ctypes.CDLL(str(path))
                for prefix in ("scipy_", ""):
                    for suffix in ("64_", ""):
                        name = f"{prefix}openblas_%s_num_threads{suffix}"
                        get = getattr(library, name % "get", None)
                        put = getattr(library, name % "set", None)
                        if get is not None and put is not None:
                            switches.append((get, put))
    return tuple(switches)


class _Hold:
    """How many solvers are at work, and what to go back to after the last."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.users = 0
        self.before: list[int] = []


_HOLD = _Hold()


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold BLAS to one thread while any solver is inside; the count before comes back after.

    A process has one count, so this is the one thing here that is shared. A BLAS that did not
    come with numpy's or scipy's wheels keeps its own count: slower at worst, not wrong.
    """
    with _HOLD.lock:
        if _HOLD.users == 0:
            _HOLD.before = [get() for get, _ in _thread_switches()]
            for _, put in _thread_switches():
                put(1)
        _HOLD.users += 1
    try:
        yield
    finally:
        with _HOLD.lock:
            _HOLD.users -= 1
            if _HOLD.users == 0:
                for (_, put), count in zip(_thread_switches(), _HOLD.before, strict=True):
                    put(count)
