"""Exact geometric predicates on double coordinates."""

from __future__ import annotations

from fractions import Fraction
from functools import cmp_to_key
from typing import Sequence

import numpy as np

__all__ = ["ccw_order", "crossing", "orientation", "orientations", "sort_ccw"]

_ERROR_BOUND = 3.3306690738754716e-16  # Shewchuk's ccwerrboundA for IEEE doubles


def orientation(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> int:
    """Sign of the turn a -> b -> c, exact: 1 left, -1 right, 0 straight on.

    A float filter decides nearly always; rational arithmetic decides the rest.

    Examples
    --------
    >>> orientation(0, 0, 1, 0, 1, 1), orientation(0, 0, 1, 0, 1, -1), orientation(0, 0, 1, 0, 2, 0)
    (1, -1, 0)
    """
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    determinant = left - right
    if abs(determinant) > _ERROR_BOUND * (abs(left) + abs(right)):
        return 1 if determinant > 0 else -1
    fax, fay, fbx, fby, fcx, fcy = map(Fraction, (ax, ay, bx, by, cx, cy))
    exact = (fax - fcx) * (fby - fcy) - (fay - fcy) * (fbx - fcx)
    return (exact > 0) - (exact < 0)


def orientations(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Signs of many turns a -> b -> c, exact; see `orientation`.

    Parameters
    ----------
    a, b, c : (k, 2) float

    Returns
    -------
    (k,) int

    Examples
    --------
    >>> a, b, c = np.zeros((2, 2)), np.array([[1, 0], [1, 0.0]]), np.array([[1, 1], [1, -1.0]])
    >>> orientations(a, b, c).tolist()
    [1, -1]
    """
    left = (a[:, 0] - c[:, 0]) * (b[:, 1] - c[:, 1])
    right = (a[:, 1] - c[:, 1]) * (b[:, 0] - c[:, 0])
    determinant = left - right
    sign = np.sign(determinant).astype(np.int64)
    unsure = np.abs(determinant) <= _ERROR_BOUND * (np.abs(left) + np.abs(right))
    for k in np.flatnonzero(unsure).tolist():
        sign[k] = orientation(*a[k].tolist(), *b[k].tolist(), *c[k].tolist())
    return sign


def crossing(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Which of pairs of segments cross, each in the inside of both; exact.

    Parameters
    ----------
    one, other : (k, 2, 2) float
        The ends of the segments.

    Returns
    -------
    (k,) bool

    Notes
    -----
    GEOS rounds the point where they meet: at the scale of an ulp it takes some crossings for touches.

    Examples
    --------
    The diagonals of a square cross; two of its sides meet at a corner only.

    >>> one = np.array([[[0, 0], [1, 1]], [[0, 0], [1, 0.0]]])
    >>> other = np.array([[[1, 0], [0, 1]], [[1, 0], [1, 1.0]]])
    >>> crossing(one, other).tolist()
    [True, False]
    """
    a, b = one[:, 0], one[:, 1]
    c, d = other[:, 0], other[:, 1]
    return (orientations(a, b, c) * orientations(a, b, d) < 0) & (
        orientations(c, d, a) * orientations(c, d, b) < 0
    )


def sort_ccw(origin: Sequence[float], targets: Sequence) -> list:
    """Sort points counter-clockwise around an origin, from the positive x direction on.

    Parameters
    ----------
    origin : (x, y)
    targets : list of (x, y, ...)
        Distinct directions; whatever follows the coordinates rides along.

    Returns
    -------
    list
        The targets in angular order. Exact; O(k log k) for k targets.

    Examples
    --------
    >>> sort_ccw((0, 0), [(0, -1, "south"), (-1, 0, "west"), (0, 1, "north"), (1, 0, "east")])
    [(1, 0, 'east'), (0, 1, 'north'), (-1, 0, 'west'), (0, -1, 'south')]
    """
    ox, oy = origin

    def lower_half(point):
        return point[1] < oy or (point[1] == oy and point[0] < ox)

    def compare(a, b):
        half_a, half_b = lower_half(a), lower_half(b)
        if half_a != half_b:
            return 1 if half_a else -1
        return -orientation(ox, oy, a[0], a[1], b[0], b[1])

    return sorted(targets, key=cmp_to_key(compare))


def ccw_order(group: np.ndarray, origin: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Sort spokes by group, and counter-clockwise around the origin of each, from positive x on.

    Parameters
    ----------
    group : (k,) int
    origin : (k, 2) float
        The same for all spokes of a group.
    target : (k, 2) float
        Distinct directions within a group.

    Returns
    -------
    (k,) int
        The spokes in order.

    Notes
    -----
    Exact; O(k log k). Floats sort, exact orientations check the neighbours, and only the groups where they
    do not agree are sorted anew by `sort_ccw`.

    Examples
    --------
    >>> ccw_order(np.array([1, 0, 1]), np.zeros((3, 2)), np.array([[0, 1], [1, 1], [1, 0.0]]))
    array([1, 2, 0])
    """
    dx, dy = (target - origin).T  # the signs are exact
    lower = (dy < 0) | ((dy == 0) & (dx < 0))
    # rises by half a turn with the angle
    with np.errstate(all="ignore"):
        angle = np.where(lower, 1.0, -1.0) * dx / (np.abs(dx) + np.abs(dy))
    order = np.lexsort((angle, lower, group))
    one, other = order[:-1], order[1:]
    pairs = (group[one] == group[other]) & (lower[one] == lower[other])
    one, other = one[pairs], other[pairs]
    turn = orientations(origin[one], target[one], target[other])
    for g in np.unique(group[one[turn <= 0]]).tolist():
        lo, hi = np.searchsorted(group[order], [g, g + 1])
        spokes = np.sort(order[lo:hi])
        spokes = [(*target[k].tolist(), k) for k in spokes.tolist()]
        order[lo:hi] = [k for *_, k in sort_ccw(origin[order[lo]].tolist(), spokes)]
    return order
