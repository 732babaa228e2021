"""The errors of this package, both a ValueError."""


class OutOfRange(ValueError):
    """A wanted value lies outside what the formula covers; the message names the limit."""


class BadFormula(ValueError):
    """A formula file does not hold a formula."""
