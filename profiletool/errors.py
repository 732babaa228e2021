"""One exception tree; each class knows the exit code that the command line ends with."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:  # the command line answers --help without numpy
    import numpy as np
    from numpy.typing import NDArray

    Candidate: TypeAlias = tuple[NDArray[np.bool_], float, str]


class ProfiletoolError(Exception):
    """A failure that the user can act on: one line says what is wrong and what to try."""

    exit_code = 1


class OutputError(ProfiletoolError):
    """The results cannot be written where they were asked for."""

    exit_code = 1


class UsageError(ProfiletoolError):
    """An option or a combination of options makes no sense."""

    exit_code = 2


class UnreadableInput(ProfiletoolError):
    """The file cannot be read, is unsafe to decode, or is no picture or profile."""

    exit_code = 3


class NoScale(ProfiletoolError):
    """Nothing says how many millimetres a pixel is."""

    exit_code = 4


class NoObject(ProfiletoolError):
    """No usable object or profile: none found, several alike, or it runs out of the frame."""

    exit_code = 5


class Unsure(NoObject):
    """Something was found, but not for certain.

    Attributes
    ----------
    candidates : tuple of (mask, confidence, method)
        The best first; masks are (H, W) bool of the picture's size, confidences 0 to 1.
    rgb : (H, W, 3) uint8
        The picture that they were found in.
    """

    def __init__(
        self, message: str, candidates: tuple[Candidate, ...], rgb: NDArray[np.uint8]
    ) -> None:
        super().__init__(message)
        self.candidates = candidates
        self.rgb = rgb


class Infeasible(ProfiletoolError):
    """No design within the physical limits."""

    exit_code = 6


class NotVerified(ProfiletoolError):
    """The finite-element run did not reach the pressure it was asked for."""

    exit_code = 7
