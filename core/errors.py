"""The errors that the core raises; every message is a sentence for a map-maker."""

from __future__ import annotations

from typing import Any

__all__ = ["Cancelled", "IsthmusError", "MissingEngine", "Sentence", "Unsolvable", "number_or_none"]


class Sentence(str):
    """A sentence of the core in English, which remembers what it was made of.

    The core knows no other language. Who shows the sentence may look up its template in a dictionary and
    fill in the values again (`algorithms.words.spoken`); in a field it stays as it is.

    Attributes
    ----------
    template : str
    values : tuple
        What fills the template; those that are sentences have templates of their own.

    Examples
    --------
    >>> Sentence("the scale must be a number above 0, and is {:g}", -0.5)
    'the scale must be a number above 0, and is -0.5'
    """

    template: str
    values: tuple

    def __new__(cls, template: str, *values: Any) -> Sentence:
        sentence = super().__new__(cls, template.format(*values) if values else template)
        sentence.template, sentence.values = str(template), values
        return sentence


def number_or_none(value: float) -> str:
    """Return a number as a sentence shows it: where a field has a text, or nothing, there is none.

    Examples
    --------
    >>> Sentence("tau must be a number of at least 1, and is {}", number_or_none(0.5))
    'tau must be a number of at least 1, and is 0.5'
    >>> Sentence("tau must be a number of at least 1, and is {}", number_or_none(float("nan")))
    'tau must be a number of at least 1, and is no number'
    """
    return f"{value:g}" if value == value else Sentence("no number")


class IsthmusError(Exception):
    """Root of all errors of this package."""

    @property
    def sentence(self) -> str:
        """The message as it was given, a `Sentence` if it was one: ``str`` makes a plain text of it."""
        return self.args[0] if self.args else ""


class Unsolvable(IsthmusError):
    """This polygon cannot be partitioned; the message says why."""


class MissingEngine(IsthmusError):
    """No usable triangulation engine is installed; the message says what to install."""


class Cancelled(IsthmusError):
    """The user asked to stop."""
