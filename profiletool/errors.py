"""One exception tree; each class knows the exit code that the command line ends with."""


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


class Infeasible(ProfiletoolError):
    """No design within the physical limits."""

    exit_code = 6


class NotVerified(ProfiletoolError):
    """The finite-element run did not reach the pressure it was asked for."""

    exit_code = 7
