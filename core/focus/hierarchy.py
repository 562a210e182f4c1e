"""From the full triangulation of a map to a coarse one and back, no triangle ever turned.

On the way down a vertex goes into one of its neighbours, if that turns none of its triangles (half-edge
collapse). On the way back it comes out again: where the coarse map takes its place, if that turns
none of its triangles, else near enough to the neighbour, where there always is a place (Shen et al.,
Progressive embedding, 2019). So a coarse map without a fold gives a full one without.
"""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np

from ..rings import starts
from .graph import unique_pairs

__all__ = ["Coarse", "coarsen", "reinsert"]

DEGREE = 8  # where more lines meet, a vertex stays
SHAPE = 0.02  # area over the longest side squared, below which a triangle should not get
LONGEST = 0.05  # of the map's width, for an edge that replaces two
TINY = 1e-7  # of the map's width: shorter edges never are solved for
HALVINGS = 48
IDLE = 4  # rounds in a row without any way across gaps: each draws one of several for a vertex


class Coarse(NamedTuple):
    """A coarse triangulation, and what was taken out.

    Attributes
    ----------
    triangles : (t, 3) int
    edges : (m, 2) int
        What is left of the edges of the map.
    into : (n,) int
        The vertex that each vertex went into, itself where it is still there.
    levels : list of ((k,) int, (k,) int, (r, 3) int)
        Vertices taken out together, what they went into, and their triangles (the vertex first,
        sorted by it).
    """

    triangles: np.ndarray
    edges: np.ndarray
    into: np.ndarray
    levels: list


def coarsen(
    xy: np.ndarray,
    triangles: np.ndarray,
    edges: np.ndarray,
    removable: np.ndarray,
    rigid: np.ndarray,
    most: int,
    check: Callable,
    *,
    gap: float = 0.0,
    side: np.ndarray | None = None,
) -> Coarse:
    """Take out vertices of a triangulation, the smallest detail first.

    Parameters
    ----------
    xy : (n, 2) float
        Of about size 1.
    triangles : (t, 3) int
        Counter-clockwise.
    edges : (m, 2) int
        Edges of the map; they are edges of the triangulation. What is removed goes along one of
        its own, as far as it has any, so outlines stay outlines.
    removable : (n,) bool
        Inner vertices, and others as told below.
    rigid : (n,) bool
        Vertices whose neighbours move with them: their detail costs nothing.
    most : int
        Stop when no more than so many of the others among ``removable`` are left.
    check : callable
        Called with the share done; may raise `Cancelled`.
    gap : float
        If more than `TINY`: what is nearer than this goes across gaps first, so that slivers of a map with
        vertices beside each other are not solved for.
    side : (n,) int, optional
        The sides of the frame that each vertex is on, as bits: what is on one goes along it, and only if
        that is less than ``gap``.

    Returns
    -------
    Coarse

    Notes
    -----
    O(n log n): each round takes out a share of what is left.

    Examples
    --------
    The end of a tiny edge in the middle of a square goes into its beginning.

    >>> from isthmus.core.focus.mesh import frame_triangles
    >>> xy = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5), (0.51, 0.5)])
    >>> triangles, stub = frame_triangles(xy, np.empty((0, 2), dtype=int)), np.array([(4, 5)])
    >>> small, rigid = np.arange(6) == 5, np.zeros(6, dtype=bool)
    >>> coarse = coarsen(xy, triangles, stub, small, rigid, 0, lambda share: None)
    >>> coarse.into.tolist()
    [0, 1, 2, 3, 4, 4]
    >>> len(triangles), len(coarse.triangles)
    (6, 4)
    """
    n = len(xy)
    rng = np.random.default_rng(1)
    into, levels = np.arange(n), []
    alive = np.ones(n, dtype=bool)
    if side is None:
        side = np.zeros(n, dtype=np.int64)
    inner = removable & (side == 0)
    if np.count_nonzero(inner) <= most:
        rigid = np.zeros_like(rigid)  # a small map is solved for as it is
    tiny = max(gap, TINY)
    tolerance, idle = tiny, 0
    while True:
        check(1.0 - np.count_nonzero(alive) / n)
        left = np.count_nonzero(alive & inner & ~rigid)
        narrow = gap > TINY and tolerance == tiny
        free = alive & (removable if narrow else inner)
        if narrow:
            u, v = _across(xy, triangles, free, gap, rng)
        else:
            u, v = _ways(xy, triangles, edges, free, rigid, tolerance, rng)
        along = side[u] & ~side[v] == 0
        u, v = u[along], v[along]
        goes = np.full(n, -1)
        goes[u[::-1]] = v[::-1]
        chosen = _independent(xy, triangles, goes, rng)
        if left <= most and tolerance > tiny:
            chosen &= rigid
        elif left - np.count_nonzero(chosen & ~rigid) < most and tolerance > tiny:
            some = np.flatnonzero(chosen & ~rigid)
            chosen[some[max(left - most, 0) :]] = False
        count = np.count_nonzero(chosen)
        if count:
            inside = chosen[triangles]
            star = inside.any(axis=1)
            turn = inside[star].argmax(axis=1)
            rows = triangles[star]
            each = np.arange(len(rows))
            rows = np.column_stack([rows[each, (turn + k) % 3] for k in range(3)])
            rows = rows[np.argsort(rows[:, 0], kind="stable")]
            gone = np.flatnonzero(chosen)
            levels.append((gone, goes[gone], rows))
            into[gone] = goes[gone]
            alive[gone] = False
            new = np.column_stack((goes[rows[:, 0]], rows[:, 1:]))
            new = new[(new[:, 0] != new[:, 1]) & (new[:, 0] != new[:, 2])]
            triangles = np.concatenate((triangles[~star], new))
            edges = unique_pairs(into[edges], n)
        idle = 0 if count else idle + 1
        if narrow and idle < IDLE:
            continue
        enough = 0.03 * (len(u) if left <= most else np.count_nonzero(alive & inner))
        if count <= max(enough, 10):
            if (left <= most and count == 0 and tolerance > tiny) or tolerance > 0.2:
                break
            tolerance = max(1e-5, 1.7 * tiny) if tolerance == tiny else tolerance * 1.7
    while True:
        further = into[into]
        if np.array_equal(further, into):
            return Coarse(triangles, edges, into, levels)
        into = further


def _across(xy, triangles, free, gap, rng):
    """Vertices, and others nearer than a gap that they could go into, in random order."""
    ways = triangles[:, [[0, 1], [1, 2], [2, 0], [1, 0], [2, 1], [0, 2]]].reshape(-1, 2)
    ways = ways[free[ways[:, 0]]]
    length = np.hypot(*(xy[ways[:, 0]] - xy[ways[:, 1]]).T)
    return rng.permutation(ways[length <= gap]).T


def _ways(xy, triangles, edges, free, rigid, tolerance, rng):
    """Vertices, and what they could go into without changing the map by more, in random order."""
    n = len(xy)
    both = np.concatenate((edges, edges[:, ::-1]))
    both = both[free[both[:, 0]]]
    both = both[np.argsort(both[:, 0], kind="stable")]
    degree = np.bincount(both[:, 0], minlength=n)
    both = both[degree[both[:, 0]] <= DEGREE]
    u, v = both.T
    count = degree[u]
    begin = starts(u)
    begin = np.repeat(begin, count[begin])
    # beside each way u-v, the other edges u-x
    several = np.flatnonzero(count > 1)
    others = count[several] - 1
    first = np.cumsum(others) - others
    one = np.repeat(several, others)
    other = np.arange(len(one)) - np.repeat(first - begin[several], others)
    other += other >= one
    x = v[other]
    z = np.ascontiguousarray(xy).view(np.complex128).ravel()  # one number a point: half as long to look up
    side = z[u] - z[v]
    along, gap = z[x] - z[v[one]], side[one]
    square = along.real**2 + along.imag**2
    t = (gap.real * along.real + gap.imag * along.imag) / np.maximum(square, 1e-300)
    gap -= np.clip(t, 0.0, 1.0) * along
    off = np.hypot(gap.real, gap.imag)
    off[square > LONGEST**2] = np.inf
    cost = np.hypot(side.real, side.imag)
    if len(several):
        cost[several] = np.maximum.reduceat(off, first) + 0.02 * cost[several]
    cost[rigid[u]] = 0.0
    # what is on no line goes anywhere
    lonely = free & (np.bincount(edges.ravel(), minlength=n) == 0)
    corner = np.flatnonzero(lonely[triangles].any(axis=1))
    rows = triangles[corner][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    rows = rows[lonely[rows[:, 0]]]
    ways = np.concatenate((both, rows))
    good = np.append(cost <= tolerance, np.ones(len(rows), dtype=bool))
    order = rng.permutation(len(ways))
    return ways[order[good[order]]].T


def _independent(xy, triangles, goes, rng):
    """Vertices that can go at once: none turns a triangle, no two are neighbours."""
    n = len(xy)
    wants = goes >= 0
    rows = triangles[wants[triangles].any(axis=1)]
    corner = np.concatenate([np.roll(rows, -k, axis=1) for k in range(3)])
    corner = corner[wants[corner[:, 0]]]
    target = goes[corner[:, 0]]
    stays = (target != corner[:, 1]) & (target != corner[:, 2])
    old, new = corner[stays], corner[stays].copy()
    new[:, 0] = target[stays]
    before, after = _shape(xy, old), _shape(xy, new)
    worst = np.full(n, np.inf)
    np.minimum.at(worst, old[:, 0], before)
    limit = np.maximum(np.minimum(SHAPE, 0.5 * worst[old[:, 0]]), 1e-12)
    wants[old[after < limit, 0]] = False
    # Luby: of those that are left, the first of each neighbourhood; three times
    size = np.bincount(rows.ravel(), minlength=n)
    rank = rng.permutation(n).astype(float)
    chosen = np.zeros(n, dtype=bool)
    for _ in range(3):
        rows = rows[wants[rows].any(axis=1)]
        if not len(rows):
            break
        order = np.where(wants, rank, np.inf)
        first = rows[np.arange(len(rows)), order[rows].argmin(axis=1)]
        won = wants & (np.bincount(first, minlength=n) == size)
        chosen |= won
        near = rows[won[rows].any(axis=1)]
        wants[near] = False
    return chosen


def _shape(xy, triangles):
    """Signed area over the longest side squared."""
    a, b, c = xy[triangles].transpose(1, 0, 2)
    square = np.maximum.reduce([_dot(q - p, q - p) for p, q in ((a, b), (b, c), (c, a))])
    return _cross(a, b, c) / (2.0 * np.maximum(square, 1e-300))


def _dot(p, q):
    return p[:, 0] * q[:, 0] + p[:, 1] * q[:, 1]  # several times as fast as a sum over so short an axis


def _cross(a, b, c):
    """Twice the signed area."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (
        c[..., 0] - a[..., 0]
    )


def reinsert(
    coarse: Coarse, xy: np.ndarray, shift: np.ndarray, known: np.ndarray, check: Callable
) -> np.ndarray:
    """Put back what was taken out.

    Parameters
    ----------
    coarse : Coarse
    xy : (n, 2) float
        Positions before.
    shift : (n, 2) float
        How the vertices of the coarse triangulation move, and those that are known.
    known : (n,) bool
        Vertices whose shift is known, though they were taken out.
    check : callable
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    (n, 2) float
        The shift of all.

    Notes
    -----
    Shen et al., Progressive embedding, 2019: there always is a place near the neighbour.

    Examples
    --------
    The end of a tiny edge was taken out: it comes back beside its beginning, and moves with that.

    >>> from isthmus.core.focus.mesh import frame_triangles
    >>> xy = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5), (0.51, 0.5)])
    >>> triangles, stub = frame_triangles(xy, np.empty((0, 2), dtype=int)), np.array([(4, 5)])
    >>> small, rigid = np.arange(6) == 5, np.zeros(6, dtype=bool)
    >>> coarse = coarsen(xy, triangles, stub, small, rigid, 0, lambda share: None)
    >>> shift = np.zeros((6, 2))
    >>> shift[4] = 0.1, 0.0
    >>> reinsert(coarse, xy, shift, rigid, lambda: None)[4:].round(6).tolist()
    [[0.1, 0.0], [0.098, 0.0]]
    """
    shift = shift.copy()
    for gone, into, rows in reversed(coarse.levels):
        check()
        begin = starts(rows[:, 0])
        count = np.diff(np.append(begin, len(rows)))
        number = np.repeat(np.arange(len(gone)), count)
        v = into[number]
        u, p, q = rows.T
        whole = _cross(xy[v], xy[p], xy[q])
        part = np.stack(
            (_cross(xy[u], xy[p], xy[q]), _cross(xy[v], xy[u], xy[q]), _cross(xy[v], xy[p], xy[u])), axis=1
        )
        fan = (p != v) & (q != v)
        with np.errstate(all="ignore"):
            part = part / whole[:, None]
        least = np.where(fan, part.min(axis=1), -np.inf)
        least[~np.isfinite(least)] = -1e300
        best = np.maximum.reduceat(least, begin)
        at = np.flatnonzero(least == best[number])
        at = at[np.unique(number[at], return_index=True)[1]]
        part = np.clip(part[at], 0.0, None)
        part /= part.sum(axis=1)[:, None]
        corner = np.column_stack((into, p[at], q[at]))
        moved = np.einsum("ij,ijk->ik", part, shift[corner])
        free = ~known[gone]
        shift[gone[free]] = moved[free]
        bad = np.unique(number[~_upright(xy, shift, u, p, q)])
        bad = bad[free[bad]]
        if len(bad):
            mine = np.isin(number, bad)
            _squeeze(xy, shift, gone[bad], into[bad], np.searchsorted(bad, number[mine]), rows[mine])
    return shift


def _upright(xy, shift, u, p, q):
    """Which triangles are clearly counter-clockwise after."""
    a, b, c = (xy[k] + shift[k] for k in (u, p, q))
    left = (a[:, 0] - c[:, 0]) * (b[:, 1] - c[:, 1])
    right = (a[:, 1] - c[:, 1]) * (b[:, 0] - c[:, 0])
    return left - right > 1e-15 * (np.abs(left) + np.abs(right))


def _squeeze(xy, shift, gone, into, number, rows):
    """Find a place for each vertex where none of its triangles is turned: the roomiest of many."""
    u, p, q = rows.T
    k = len(gone)
    at = lambda w: xy[w] + shift[w]  # noqa: E731
    p_at, q_at, v_at = at(p), at(q), at(into)
    wish = at(gone)
    sums = np.stack([np.bincount(number, 0.5 * (p_at + q_at)[:, axis], k) for axis in (0, 1)], axis=1)
    middle = sums / np.bincount(number, minlength=k)[:, None]
    # the wedge at the neighbour: the fan of triangles without it turns from first to last
    left = np.full(k, -1)
    right = np.full(k, -1)
    v = into[number]
    right[number[p == v]] = q[p == v]  # triangle (u, v, q)
    left[number[q == v]] = p[q == v]  # triangle (u, p, v)
    a, b = at(right) - v_at, at(left) - v_at
    angle_a, angle_b = np.arctan2(a[:, 1], a[:, 0]), np.arctan2(b[:, 1], b[:, 0])
    direction = angle_a + (angle_b - angle_a) % (2.0 * np.pi) / 2.0
    reach = np.minimum(np.hypot(*a.T), np.hypot(*b.T))
    wedge = np.column_stack((np.cos(direction), np.sin(direction)))
    side = (left < 0) | (right < 0)  # of the frame: it stays on it
    wedge[side], reach[side], middle[side] = (wish - v_at)[side], 1.0, wish[side]
    area = _cross(xy[u], xy[p], xy[q])
    best, found = np.full(k, -np.inf), wish.copy()

    def offer(candidate):
        ratio = _cross(candidate[number], p_at, q_at) / np.maximum(area, 1e-300)
        least = np.full(k, np.inf)
        np.minimum.at(least, number, ratio)
        better = least > best
        best[better], found[better] = least[better], candidate[better]

    for t in (0.125, 0.25, 0.5, 0.75, 1.0):
        offer(wish + t * (middle - wish))
        offer(wish + t * (v_at - wish))
    for t in (0.25, 0.5, 0.75):
        offer(v_at + t * (middle - v_at))
    for halving in range(HALVINGS):
        offer(v_at + (reach * 0.5**halving)[:, None] * wedge)
        if halving >= 6 and (best > 0.0).all():
            break
    shift[gone] = found - xy[gone]
