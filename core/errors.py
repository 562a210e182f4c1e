"""The errors that the core raises; every message is a sentence for a map-maker."""

__all__ = ["Cancelled", "IsthmusError", "MissingEngine", "Unsolvable"]


class IsthmusError(Exception):
    """Root of all errors of this package."""


class Unsolvable(IsthmusError):
    """This polygon cannot be partitioned; the message says why."""


class MissingEngine(IsthmusError):
    """No usable triangulation engine is installed; the message says what to install."""


class Cancelled(IsthmusError):
    """The user asked to stop."""
