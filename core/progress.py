"""Progress and cancel in one callable.

Every stage that takes time gets ``check``: it calls ``check()`` now and then, or ``check(share)`` with
the share it has done, and stops where that raises `Cancelled`.
"""

from __future__ import annotations

from typing import Callable

from .errors import Cancelled

__all__ = ["checker", "ignore", "stretch"]


def checker(progress: Callable | None, cancelled: Callable | None) -> Callable:
    """Return the ``check`` of a ``progress(share)`` and a ``cancelled()``; each may be None."""

    def check(share=None):
        if cancelled is not None and cancelled():
            raise Cancelled("cancelled")
        if progress is not None and share is not None:
            progress(share)

    return check


def stretch(check: Callable, start: float, stop: float) -> Callable:
    """Return the ``check`` of a stage that runs from one share of the whole to another."""

    def check_stage(share=None):
        check(None if share is None else start + (stop - start) * share)

    return check_stage


def ignore(_share: float | None = None) -> None:
    """The ``check`` of a caller that has none."""
