"""Keep polygons of points on a circle convex where the detail of a map was put back.

A map made from a raster has many squares, each with two diagonals that are as good. With one of them
the piecewise linear map folds nothing, and yet a corner may have gone beyond the other diagonal: the
square is a dart. Nothing crosses, but it is no square that anybody would know again.
"""

from __future__ import annotations

from typing import Callable

import numpy as np

from .graph import components
from .mesh import cross, flatness, heights, turned

__all__ = ["stay_convex"]

ROUNDS = 10  # over what is left; two are enough but where much is squeezed
KEEP = 0.7  # of the area of a triangle beside one that cannot be put right at once
LEAST = 1e-3  # share of its area, below which a triangle counts as turned
RINGS = 3  # of neighbours that move together where a corner alone has no room
CORNERS = 400  # that move together; more take long, and were never needed
STEPS = 30  # of those that move together; nine were enough on a map of 911,826 points
SHORTEST = 1e-4  # step, in the longest side of a corner's triangles


def stay_convex(
    xy: np.ndarray,
    shift: np.ndarray,
    triangles: np.ndarray,
    spare: np.ndarray,
    free: np.ndarray,
    check: Callable,
) -> np.ndarray:
    """Move corners of turned triangles of other triangulations to where none at them is turned.

    Parameters
    ----------
    xy : (n, 2) float
    shift : (n, 2) float
        Displacements that turn no triangle; they never do on the way either.
    triangles : (t, 3) int
        Counter-clockwise.
    spare : (q, 3) int
        Triangles of other triangulations, see `mesh.others`.
    free : (n,) bool
        What may move.
    check : callable
        Called for each corner; may raise `Cancelled`.

    Returns
    -------
    (n, 2) float
        The displacements; some of ``spare`` may still be turned where there is no room.

    Notes
    -----
    The area of each triangle is linear in the place of one corner. So a linear programme of three
    unknowns finds the place where the smallest share of its area left to a triangle is largest; the
    corner goes half as far towards that as it has to. Where a corner alone has no room, its neighbours move
    with it, by steps that are short enough for areas to be linear in all of them. O(n) and a programme for
    each corner of a turned one.

    Examples
    --------
    A square is cut along its diagonal 0-2, and corner 2 has gone beyond the other diagonal: a dart.

    >>> square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    >>> halves, spare = np.array([(0, 1, 2), (0, 2, 3)]), np.array([(1, 2, 3), (0, 1, 3)])
    >>> shift, free = np.zeros((4, 2)), np.array([False, False, True, False])
    >>> shift[2] = -0.6
    >>> turned(square, square + shift, spare).tolist()
    [True, False]
    >>> shift = stay_convex(square, shift, halves, spare, free, lambda: None)
    >>> turned(square, square + shift, spare).tolist()
    [False, False]
    """
    now = xy + shift
    for _ in range(ROUNDS):
        todo = np.unique(spare[turned(xy, now, spare)])
        todo = todo[free[todo]]
        if not len(todo):
            break
        star, ours = _stars(len(xy), triangles, spare, todo)
        begin = np.searchsorted(star[:, 0], todo)
        end = np.searchsorted(star[:, 0], todo, side="right")
        before = now.copy()
        for vertex, lo, hi in zip(todo.tolist(), begin.tolist(), end.tolist()):
            check()
            step = _step(xy, now, star[lo:hi], ours[lo:hi])
            if step is not None:
                now[vertex] += step
        if np.array_equal(before, now):
            break
    for rings in range(1, RINGS + 1):
        patches = _patches(xy, now, triangles, spare, free, rings)
        if not patches:
            break
        for star, ours, corners in patches:
            _make_room(xy, now, star, ours, corners, check)
    moved = (now != xy + shift).any(axis=1)
    return np.where(moved[:, None], now - xy, shift)


def _stars(n, triangles, spare, todo):
    """The triangles at vertices, these first and sorted by them, and which are no spare ones."""
    wanted = np.zeros(n, dtype=bool)
    wanted[todo] = True
    found = []
    for some in (triangles, spare):
        some = some[wanted[some].any(axis=1)]
        some = np.concatenate([np.roll(some, -k, axis=1) for k in range(3)])
        found.append(some[wanted[some[:, 0]]])
    star = np.concatenate(found)
    order = np.argsort(star[:, 0], kind="stable")
    return star[order], order < len(found[0])


def _step(xy, now, star, ours):
    """How a vertex should move; None if it is well where it is, or cannot move."""
    from scipy.optimize import linprog

    (u, p, q), vertex = star.T, star[0, 0]
    area = cross(xy[p] - xy[u], xy[q] - xy[u])
    p, q = now[p] - now[vertex], now[q] - now[vertex]
    size = np.abs(np.concatenate((p, q))).max()
    # what is left of each area, as a linear function of the step in units of size
    left = cross(p, q) / area
    slope = np.column_stack((p[:, 1] - q[:, 1], q[:, 0] - p[:, 0])) * size / area[:, None]
    if left.min() > 0.0:
        return None

    def best(counts, least):
        """The step for which the smallest of some is largest, and of the others none is below least."""
        bounds = [(-2.0, 2.0), (-2.0, 2.0), (None, 1.0)]
        found = linprog(
            (0.0, 0.0, -1.0),
            np.column_stack((-slope, counts * 1.0)),
            left - least,
            bounds=bounds,
            method="highs",
        )
        return found.x if found.status == 0 else None

    found = best(np.ones(len(star), dtype=bool), 0.0)
    if found is None or found[2] < LEAST:
        # the spare ones as far as they go, and ours keep most of what they have
        found = best(~ours, np.where(ours, KEEP * left, 0.0))
        return None if found is None or found[2] <= left.min() else found[:2] * size
    # as far along as leaves each at least half of that
    gain = slope @ found[:2]
    short = left < found[2] / 2.0
    share = ((found[2] / 2.0 - left[short]) / gain[short]).max()
    return min(share, 1.0) * found[:2] * size


def _patches(xy, now, triangles, spare, free, rings):
    """Corners around triangles that are still turned, so many rings of them, and their triangles."""
    near = np.zeros(len(xy), dtype=bool)
    near[spare[turned(xy, now, spare)]] = True
    if not near.any():
        return []
    for _ in range(rings):
        for some in (triangles, spare):
            near[some[near[some].any(axis=1)]] = True
    near &= free
    star = [some[near[some].any(axis=1)] for some in (triangles, spare)]
    ours = np.arange(len(star[0]) + len(star[1])) < len(star[0])
    star = np.concatenate(star)
    seen = heights(xy, star) > flatness(xy)
    star, ours = star[seen], ours[seen]
    # those that share a triangle are one patch
    corner = np.flatnonzero(near)
    sides = np.concatenate([star[:, [k, k - 1]] for k in range(3)])
    sides = np.searchsorted(corner, sides[near[sides].all(axis=1)])
    patch = components(len(corner), sides)
    first = star[np.arange(len(star)), near[star].argmax(axis=1)]
    of = patch[np.searchsorted(corner, first)]
    found = []
    for k in range(patch.max() + 1):
        mine = of == k
        found.append((star[mine], ours[mine], corner[patch == k]))
    return found


def _make_room(xy, now, star, ours, corners, check):
    """Move corners together, in place, to where none of their triangles is turned, as far as that goes."""
    if len(corners) > CORNERS:
        return
    before = _areas(xy, star)
    left = _areas(now, star) / before
    for _ in range(STEPS):
        check()
        if left[~ours].min() > LEAST:
            return
        matrix, unit = _linear(now, star, before, corners)
        # ours keep most of what they have, unless they have more than they had
        least = np.where(ours, KEEP * np.minimum(left, 1.0), 0.0)
        reach, start = 0.5, now[corners]
        while reach > SHORTEST:
            step = _best_step(matrix, left, least, ours, reach)
            now[corners] = start + step * unit
            then = _areas(now, star) / before
            if (then[ours] > least[ours] / 2.0).all() and then[~ours].min() > left[~ours].min():
                left = then
                break
            now[corners] = start
            reach /= 2.0
        else:
            return


def _linear(now, star, before, corners):
    """What is left of the areas of triangles, as a linear function of steps of corners, and their units."""
    from scipy.sparse import csr_matrix

    n, m = len(now), len(corners)
    place, longest = np.full(n, -1), np.zeros(n)
    place[corners] = np.arange(m)
    for k in range(3):
        side = np.hypot(*(now[star[:, k]] - now[star[:, k - 1]]).T)
        np.maximum.at(longest, star[:, k], side)
        np.maximum.at(longest, star[:, k - 1], side)
    entries = []
    for k in range(3):
        row = np.flatnonzero(place[star[:, k]] >= 0)
        u, p, q = np.roll(star[row], -k, axis=1).T
        x, y = ((now[p] - now[q]) * (longest[u] / before[row])[:, None]).T
        entries += [(y, row, 2 * place[u]), (-x, row, 2 * place[u] + 1)]
    slope, row, column = (np.concatenate(part) for part in zip(*entries))
    return csr_matrix((slope, (row, column)), (len(star), 2 * m)), longest[corners][:, None]


def _best_step(slope, left, least, ours, reach):
    """The steps for which the smallest share of a spare triangle is largest; none where there are none."""
    from scipy.optimize import linprog
    from scipy.sparse import csr_matrix, hstack

    count = slope.shape[1]
    found = linprog(
        np.append(np.zeros(count), -1.0),
        hstack((-slope, csr_matrix(~ours[:, None] * 1.0))),
        left - least,
        bounds=[(-reach, reach)] * count + [(None, 1.0)],
        method="highs",
    )
    return found.x[:-1].reshape(-1, 2) if found.status == 0 else np.zeros((count // 2, 2))


def _areas(xy, triangles):
    """Twice their areas."""
    a, b, c = xy[triangles].transpose(1, 0, 2)
    return cross(b - a, c - a)
