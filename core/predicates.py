"""Exact geometric predicates on double coordinates."""

from __future__ import annotations

from fractions import Fraction
from functools import cmp_to_key

import numpy as np

__all__ = ["crossing", "orientation", "orientations", "sort_ccw"]

_ERROR_BOUND = 3.3306690738754716e-16  # Shewchuk's ccwerrboundA for IEEE doubles


def orientation(ax, ay, bx, by, cx, cy):
    """Sign of the turn a -> b -> c, exact: 1 left, -1 right, 0 straight on.

    A float filter decides nearly always; rational arithmetic decides the rest.
    """
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    determinant = left - right
    if abs(determinant) > _ERROR_BOUND * (abs(left) + abs(right)):
        return 1 if determinant > 0 else -1
    ax, ay, bx, by, cx, cy = map(Fraction, (ax, ay, bx, by, cx, cy))
    determinant = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    return (determinant > 0) - (determinant < 0)


def orientations(a, b, c):
    """Signs of many turns a -> b -> c, exact; see `orientation`.

    Parameters
    ----------
    a, b, c : (k, 2) float

    Returns
    -------
    (k,) int
    """
    left = (a[:, 0] - c[:, 0]) * (b[:, 1] - c[:, 1])
    right = (a[:, 1] - c[:, 1]) * (b[:, 0] - c[:, 0])
    determinant = left - right
    sign = np.sign(determinant).astype(np.int64)
    unsure = np.abs(determinant) <= _ERROR_BOUND * (np.abs(left) + np.abs(right))
    for k in np.flatnonzero(unsure).tolist():
        sign[k] = orientation(*a[k].tolist(), *b[k].tolist(), *c[k].tolist())
    return sign


def crossing(one, other):
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
    """
    a, b = one[:, 0], one[:, 1]
    c, d = other[:, 0], other[:, 1]
    return (orientations(a, b, c) * orientations(a, b, d) < 0) & (
        orientations(c, d, a) * orientations(c, d, b) < 0
    )


def sort_ccw(origin, targets):
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
