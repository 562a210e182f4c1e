"""Classes as text, and tables of what is set for each: smallest sizes, and distances of two classes."""

from __future__ import annotations

import math
from typing import Any, Iterable

import numpy as np

from ..errors import IsthmusError, Sentence
from .instance import hierarchical_distance

__all__ = ["distances", "text", "thresholds"]


def text(value: Any) -> str | None:
    """Return a class as text: 311, 311.0 and "311" are one class; None where there is none.

    Examples
    --------
    >>> text(311.0), text(" 311"), text("")
    ('311', '311', None)
    """
    if value is None:
        return None
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    return str(value).strip() or None


def thresholds(
    classes: list[str], least: float, *, table: Iterable[tuple] = (), excluded: Iterable[str] = ()
) -> tuple[np.ndarray, list[str]]:
    """Return the smallest size of a region of each class, infinite where it is excluded.

    Parameters
    ----------
    classes : list of str
    least : float
        For classes that are not in the table.
    table : iterable of (class, size)
        A size of None excludes the class; classes that are not on the map do not matter.
    excluded : iterable of str

    Returns
    -------
    theta : (c,) float
    absent : list of str
        The excluded classes that are not on the map.

    Raises
    ------
    IsthmusError
        If a size is no number of at least 0.

    Examples
    --------
    >>> theta, absent = thresholds(["311", "312", "511"], 50, table=[(312, 80)], excluded=["511", "999"])
    >>> theta.tolist(), absent
    ([50.0, 80.0, inf], ['999'])
    """
    theta = dict.fromkeys(classes, float(least))
    for name, value in table:
        one = text(name)
        if one in theta:
            theta[one] = (
                math.inf
                if text(value) is None
                else _number(value, Sentence("The threshold of class {}", one))
            )
    absent = []
    for one in excluded:
        if one in theta:
            theta[one] = math.inf
        else:
            absent.append(one)
    return np.array([theta[one] for one in classes]), absent


def distances(classes: list[str], kind: str, table: Iterable[tuple] = ()) -> tuple[np.ndarray, int]:
    """Return the distance of each class to each other.

    Parameters
    ----------
    classes : list of str
    kind : str
        'equal', 'code' (see `instance.hierarchical_distance`) or 'table'.
    table : iterable of (from, to, distance)

    Returns
    -------
    matrix : (c, c) float
    one_way : int
        How many are listed in one direction only, and taken as equal the other way.

    Raises
    ------
    IsthmusError
        If the table lacks a pair of classes that are on the map.

    Examples
    --------
    From b to a it is taken to be as far as from a to b.

    >>> matrix, one_way = distances(["a", "b"], "table", [("a", "b", 0.5)])
    >>> matrix.tolist(), one_way
    ([[0.0, 0.5], [0.5, 0.0]], 1)
    """
    if kind == "code":
        return (hierarchical_distance(classes) if classes else np.zeros((0, 0))), 0
    if kind == "equal":
        return 1.0 - np.eye(len(classes)), 0
    number = {one: k for k, one in enumerate(classes)}
    matrix = np.full((len(classes), len(classes)), np.nan)
    np.fill_diagonal(matrix, 0.0)
    for start, end, value in table:
        a, b = text(start), text(end)
        if a in number and b in number:
            matrix[number[a], number[b]] = _number(value, Sentence("The distance from {} to {}", a, b))
    known = ~np.isnan(matrix)
    np.fill_diagonal(known, False)
    alone = ~(known.any(axis=0) | known.any(axis=1)) & (len(classes) > 1)
    absent = [one for one, is_alone in zip(classes, alone) if is_alone]
    if absent:
        unknown = Sentence(
            "The table of class distances (DISTANCES) knows nothing of class {}, "
            "which is on the map. Add rows from this class to the others.",
            ", ".join(absent),
        )
        raise IsthmusError(unknown)
    one_way = np.isnan(matrix) & ~np.isnan(matrix.T)
    matrix[one_way] = matrix.T[one_way]
    missing = np.argwhere(np.isnan(matrix))
    if len(missing):
        some = ", ".join(f"{classes[a]} > {classes[b]}" for a, b in missing[:8].tolist())
        lacking = Sentence(
            "The table of class distances (DISTANCES) lacks {} pairs of classes that are "
            "on the map: {}. Add rows for them.",
            len(missing), some + " ..." * (len(missing) > 8),
        )  # fmt: skip
        raise IsthmusError(lacking)
    return matrix, int(one_way.sum())


def _number(value: Any, what: Sentence) -> float:
    """Return a number of at least 0, also from a text column."""
    try:
        number = float(text(value) or "nan")
    except ValueError:
        number = math.nan
    if not 0.0 <= number < math.inf:
        raise IsthmusError(Sentence("{} is no number of at least 0: {}.", what, value))
    return number
