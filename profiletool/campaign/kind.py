"""The kind of a run: all that the campaign engine needs to know of tasks and outcomes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

TaskT = TypeVar("TaskT")
OutcomeT = TypeVar("OutcomeT")


@dataclass(frozen=True)
class RunKind(Generic[TaskT, OutcomeT]):
    """A kind of runs, as functions that every process finds by their names.

    Attributes
    ----------
    run : callable
        Task to outcome, on one thread; what the model refuses is part of the outcome.
    key : callable
        Task to a file's name that tells all that the outcome depends on, the model's own source
        files included. Equal tasks are run once.
    order : callable
        Task to a sort key that puts the longest runs first.
    died : callable
        Outcome of a task whose process died at every trial.
    write, read : callable
        Outcome to bytes and back. ``read`` raises ValueError where a byte is not as written.
    """

    run: Callable[[TaskT], OutcomeT]
    key: Callable[[TaskT], str]
    order: Callable[[TaskT], Any]
    died: Callable[[TaskT], OutcomeT]
    write: Callable[[OutcomeT], bytes]
    read: Callable[[bytes], OutcomeT]
