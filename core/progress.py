"""Progress and cancel in one callable.

Every stage that takes time gets ``check``: it calls ``check()`` now and then, or ``check(share)`` with
the share it has done, and stops where that raises `Cancelled`.
"""

from __future__ import annotations

from typing import Callable

from .errors import Cancelled

__all__ = ["checker", "ignore", "stretch"]


def checker(progress: Callable | None, cancelled: Callable | None) -> Callable:
    """Return the ``check`` of a ``progress(share)`` and a ``cancelled()``; each may be None.

    Examples
    --------
    What it is called with is told on, until the user cancels.

    >>> check = checker(print, lambda: False)
    >>> check(), check(0.5)
    0.5
    (None, None)
    >>> checker(print, lambda: True)(0.5)
    Traceback (most recent call last):
    isthmus.core.errors.Cancelled: cancelled
    """

    def check(share=None):
        if cancelled is not None and cancelled():
            raise Cancelled("cancelled")
        if progress is not None and share is not None:
            progress(share)

    return check


def stretch(check: Callable, start: float, stop: float) -> Callable:
    """Return the ``check`` of a stage that runs from one share of the whole to another.

    Examples
    --------
    Half of what is between a half and the whole.

    >>> check_stage = stretch(checker(print, None), 0.5, 1.0)
    >>> check_stage(0.5)
    0.75
    """

    def check_stage(share=None):
        check(None if share is None else start + (stop - start) * share)

    return check_stage


def ignore(_share: float | None = None) -> None:
    """The ``check`` of a caller that has none.

    Examples
    --------
    >>> ignore(), ignore(0.5)
    (None, None)
    """
