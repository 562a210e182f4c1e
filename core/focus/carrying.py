"""Other layers, carried along by the deformation of a map."""

from __future__ import annotations

from typing import Any, Iterator, Sequence

import numpy as np
import shapely

from ..wkb import joined
from .graph import unique_pairs
from .mesh import cross, flatness, heights

__all__ = ["Carrier", "carried", "placed"]

AT_ONCE = 200_000  # triangles or lines that are shapely's at a time
STRAIGHT = 1e-10  # of the map's width: what bends less gets no point


class Carrier:
    """The piecewise linear map of the frame that moves the map itself.

    A point on a line of the map stays on it, and a point in the focus scales with it. Beyond the
    frame a point moves as the nearest point of the frame does.

    Parameters
    ----------
    points, moved : (n, 2) float
        Vertices of the triangulation before and after.
    triangles : (t, 3) int
        They cover the rectangle around all points.

    Examples
    --------
    >>> square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.0, 1.0)])
    >>> moved = square + (0.0, 0.0)
    >>> moved[4] = 1.5, 1.0
    >>> fan = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])
    >>> Carrier(square, moved, fan)(np.array([(0.5, 1.0)]))
    array([[0.75, 1.  ]])
    """

    def __init__(self, points: np.ndarray, moved: np.ndarray, triangles: np.ndarray) -> None:
        self._points, self._shift = points, moved - points
        self._flat = flatness(points)
        # of triangles that meet in a point the largest tells most exactly where it goes, a flat one nothing
        a, b, c = points[triangles].transpose(1, 0, 2)
        order = np.argsort(cross(b - a, c - a), kind="stable")
        self._triangles = triangles[order[heights(points, triangles[order]) > self._flat]]
        self._low, self._high = points.min(axis=0), points.max(axis=0)
        self._width = float((self._high - self._low).max(initial=0.0))
        self._edges = _edges_of(triangles, len(points))

    def __call__(self, xy: np.ndarray) -> np.ndarray:
        """Return where points go.

        Parameters
        ----------
        xy : (k, 2) float
            Those that are not finite stay.

        Notes
        -----
        O((t + k) log k) for t triangles.
        """
        result = np.array(xy, dtype=float)
        finite = np.flatnonzero(np.isfinite(result).all(axis=1))
        if not len(finite):
            return result
        near = np.clip(result[finite], self._low, self._high)
        result[finite] += self._shift_at(near)
        return result

    def lines(self, rows: np.ndarray, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return where lines go, and the points to put into them where they bend.

        From one triangle to the next a straight line bends. With a point there, all of it is where the map
        takes it, and it keeps to the towns on it and off the lakes beside it.

        Parameters
        ----------
        rows : (k, 2) float
            The points of all lines one after the other. Those that are not finite stay.
        starts : (l + 1,) int
            Line i is ``rows[starts[i]:starts[i + 1]]``.

        Returns
        -------
        moved : (k, 2) float
        bends : (b, 4) float
            In order: the row that a point follows, its x and y, and the share of the way to the next row.

        Notes
        -----
        All that is left out bends a line by less than `STRAIGHT`. What lies between the same two points
        bends alike in both directions, so lines that were one stay one. O((t + k + x) log t), x being the
        number of times that lines meet edges of triangles.

        Examples
        --------
        The middle of a square moves to the right, and a line through it bends there.

        >>> square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.0, 1.0)])
        >>> moved = square + (0.0, 0.0)
        >>> moved[4] = 1.5, 1.0
        >>> fan = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])
        >>> line = np.array([(1.0, 0.0), (1.0, 2.0)])
        >>> Carrier(square, moved, fan).lines(line, [0, 2])[1]
        array([[0. , 1.5, 1. , 0.5]])
        """
        rows = np.asarray(rows, dtype=float)
        moved = self(rows)
        inner = np.isfinite(rows).all(axis=1)
        inner[np.asarray(starts[1:])[np.diff(starts) > 0] - 1] = False
        row = np.flatnonzero(inner[:-1] & np.isfinite(rows[1:]).all(axis=1))
        # towards the end that is farther right, whichever comes first
        turned = (rows[row, 0] > rows[row + 1, 0]) | (
            (rows[row, 0] == rows[row + 1, 0]) & (rows[row, 1] > rows[row + 1, 1])
        )
        begin, end = row + turned, row + ~turned
        found = [np.empty((0, 4))]
        for start in range(0, len(row), AT_ONCE):
            some = slice(start, start + AT_ONCE)
            p, q = begin[some], end[some]
            line, share, shift = self._bends(rows[p], rows[q], (moved - rows)[p], (moved - rows)[q])
            at = rows[p[line]] + share[:, None] * (rows[q[line]] - rows[p[line]]) + shift
            share = np.where(turned[some][line], 1.0 - share, share)
            order = np.lexsort((share, line))
            found.append(np.column_stack((row[some][line], at, share))[order])
        return moved, np.concatenate(found)

    def _bends(self, a, b, shift_a, shift_b):
        """Of lines a-b: which one bends, at which share of its way, and how the point there moves."""
        begin, end, before, after = self._creases(a, b)
        lines, creases = (shapely.linestrings(np.stack(ends, axis=1)) for ends in ((a, b), (begin, end)))
        crease, line = shapely.STRtree(lines).query(creases, predicate="intersects")
        along, across, gap = (b - a)[line], (end - begin)[crease], begin[crease] - a[line]
        turn = cross(along, across)
        with np.errstate(all="ignore"):  # what runs along a crease does not bend there, but at its ends
            t, s = cross(gap, across) / turn, cross(gap, along) / turn
        length = np.hypot(*along.T)
        near = STRAIGHT * self._width
        inside = (t * length > near) & ((1.0 - t) * length > near)
        line, crease, t, s = (v[inside] for v in (line, crease, t, s))
        s = np.clip(s, 0.0, 1.0)[:, None]
        shift = (1.0 - s) * before[crease] + s * after[crease]
        # in order, between the ends of each line; where several creases meet, once
        every = np.arange(len(a))
        line = np.concatenate((every, line, every))
        t = np.concatenate((np.zeros(len(a)), t, np.ones(len(a))))
        shift = np.concatenate((shift_a, shift, shift_b))
        order = np.lexsort((t, line))
        line, t, shift = line[order], t[order], shift[order]
        length = np.hypot(*(b - a).T)
        once = np.append(True, (np.diff(t) * length[line[1:]] > near) | (line[1:] != line[:-1]))
        once |= t == 1.0
        line, t, shift = line[once], t[once], shift[once]
        inside = np.flatnonzero((t > 0.0) & (t < 1.0))
        count = np.bincount(line[inside], minlength=len(a))[line[inside]]
        steps = [
            (shift[inside + k] - shift[inside + k - 1]) / (t[inside + k] - t[inside + k - 1])[:, None]
            for k in (0, 1)
        ]
        own = t[inside]
        # how far the line would be off without this point alone: all of them together no farther than near
        off = np.hypot(*(steps[1] - steps[0]).T) * own * (1.0 - own)
        kept = inside[off * count > near]
        return line[kept], t[kept], shift[kept]

    def _creases(self, a, b):
        """Where the map may bend: the ends of edges, and of rays from its sides, and how they move."""
        p, q = self._edges.T
        low, high = np.minimum(a, b).min(axis=0), np.maximum(a, b).max(axis=0)
        near = np.minimum(self._points[p], self._points[q]) <= high
        near &= np.maximum(self._points[p], self._points[q]) >= low
        p, q = p[near.all(axis=1)], q[near.all(axis=1)]
        begin, end, one, other = [self._points[p]], [self._points[q]], [self._shift[p]], [self._shift[q]]
        for axis in (0, 1):
            for value, far in ((self._low[axis], low[axis]), (self._high[axis], high[axis])):
                if self._low[axis] <= far <= self._high[axis]:
                    continue
                side = np.flatnonzero(np.abs(self._points[:, axis] - value) <= self._flat)
                there = self._points[side].copy()
                there[:, axis] = far
                begin.append(self._points[side])
                end.append(there)
                one.append(self._shift[side])
                other.append(self._shift[side])
        return tuple(np.concatenate(part) for part in (begin, end, one, other))

    def _shift_at(self, xy):
        found = self._found(xy)
        lost = np.flatnonzero(found < 0)  # in a gap of rounding, or a flat triangle
        found[lost] = self._found(xy[lost], 10.0 * self._flat)
        corner = self._triangles[found]
        a, b, c = self._points[corner].transpose(1, 0, 2)
        whole = cross(b - a, c - a)
        weight = np.column_stack((cross(xy - a, c - a), cross(b - a, xy - a))) / whole[:, None]
        weight = np.column_stack((1.0 - weight.sum(axis=1), weight))
        # displacements rather than positions: where nothing moves, not a bit changes
        shift = np.einsum("ij,ijk->ik", weight, self._shift[corner])
        shift[found < 0] = 0.0
        return shift

    def _found(self, xy, near=None):
        """The largest triangle at each point, or near it, -1 for none."""
        found = np.full(len(xy), -1)
        if not len(xy):
            return found
        tree = shapely.STRtree(shapely.points(xy))
        how = {"predicate": "intersects"} if near is None else {"predicate": "dwithin", "distance": near}
        for start in range(0, len(self._triangles), AT_ONCE):
            corners = self._points[self._triangles[start : start + AT_ONCE]]
            one, other = tree.query(shapely.polygons(corners), **how)
            np.maximum.at(found, other, start + one)
        return found


def carried(carrier: Carrier, runs: Sequence[Any]) -> Iterator[Any]:
    """Yield geometries carried along, with points where their lines bend.

    Parameters
    ----------
    carrier : Carrier
    runs : sequence of `core.wkb.Runs`, or what has their ``xy``, ``counts`` and ``moved``
        Asked for all at once: a map has many triangles, and a geometry mostly few points.

    Examples
    --------
    Two towns in a square that becomes twice as wide.

    >>> from isthmus.core.wkb import Runs
    >>> square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)])
    >>> carrier = Carrier(square, 2.0 * square, np.array([(0, 1, 2), (0, 2, 3)]))
    >>> towns = [Runs(shapely.to_wkb(shapely.Point(x, 1), byte_order=1)) for x in (0.5, 1.5)]
    >>> [shapely.from_wkb(one).x for one in carried(carrier, towns)]
    [1.0, 3.0]
    """
    rows, starts, _ = joined(runs)
    return placed(runs, *carrier.lines(rows, starts))


def placed(runs: Sequence[Any], moved: np.ndarray, splits: np.ndarray) -> Iterator[Any]:
    """Yield geometries with their points moved, and points put in.

    Parameters
    ----------
    runs : sequence of `core.wkb.Runs`, or what has their ``counts`` and ``moved``
    moved : (n, 2) float
        The points of all, one geometry after the other.
    splits : (s, 4) float
        Points to put in, sorted: the row before, where, and the share of the way to the next row.

    Examples
    --------
    >>> from isthmus.core.wkb import Runs
    >>> road = Runs(shapely.to_wkb(shapely.LineString([(0, 0), (2, 0)]), byte_order=1))
    >>> (found,) = placed([road], np.array([(0.0, 0), (4, 0)]), np.array([(0, 2.0, 1, 0.5)]))
    >>> shapely.get_coordinates(shapely.from_wkb(found)).tolist()
    [[0.0, 0.0], [2.0, 1.0], [4.0, 0.0]]
    """
    start = 0
    for one in runs:
        stop = start + sum(one.counts)
        lo, hi = splits[:, 0].searchsorted((start, stop))
        own = [(int(row) - start, (x, y), share) for row, x, y, share in splits[lo:hi].tolist()]
        yield one.moved(moved[start:stop], own)
        start = stop


def _edges_of(triangles, n):
    """The sides of triangles, each once."""
    return unique_pairs(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), n)
