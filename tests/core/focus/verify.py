"""An independent checker of focus maps: what was promised, from the lines before and after alone."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np
import shapely

__all__ = ["Verdict", "crossing_pairs", "faults", "verify", "with_splits"]


class Verdict(NamedTuple):
    """What an independent look at a focus map finds.

    Attributes
    ----------
    turned : int
        Triangles of a triangulation of each polygon of the input that turned over: its own Delaunay
        triangulation. What it may and may not prove, see `faults`.
    crossings : int
        Pairs of segments that meet, and share no end, and did not meet before.
    invalid : int
        Features that were valid and are not.
    apart : int
        Points that were one, and are not.
    finite : bool
    """

    turned: int
    crossings: int
    invalid: int
    apart: int
    finite: bool

    @property
    def good(self):
        """Whether nothing is wrong."""
        return self == (0, 0, 0, 0, True)


def with_splits(rows, starts, result):
    """Rows before and after, and starts, with the vertices put in where other lines meet an edge."""
    after_row = result.splits[:, 0].astype(np.int64)
    vertex = result.splits[:, 1].astype(np.int64)
    order = np.argsort(np.concatenate((np.arange(len(rows)) * 1.0, after_row + 0.5)), kind="stable")
    before = np.concatenate((rows, result.points[vertex]))[order]
    after = np.concatenate((result.rows, result.moved[vertex]))[order]
    starts = np.asarray(starts) + np.searchsorted(after_row, starts)
    return before, after, starts


def verify(before, after, starts, features):
    """Return the `Verdict` on a map.

    Parameters
    ----------
    before, after : (k, 2) float
        The points of all lines and rings, one after the other.
    starts : (l + 1,) int
    features : list of list of list of int
        The lines that are rings of each polygon of each feature, its shell first.
    """
    if not np.isfinite(after).all():
        return Verdict(0, 0, 0, 0, False)
    _, vertex, place = np.unique(before, axis=0, return_index=True, return_inverse=True)
    place = place.ravel()
    apart = int(np.count_nonzero((after[vertex[place]] != after).any(axis=1)))
    inner = np.ones(max(len(before) - 1, 0), dtype=bool)
    ends = np.asarray(starts[1:-1])
    inner[ends[(ends > 0) & (ends < len(before))] - 1] = False
    pairs = np.sort(np.column_stack((place[:-1], place[1:]))[inner], axis=1)
    pairs = np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)
    one, other = (crossing_pairs(xy[vertex], pairs) for xy in (before, after))
    known = set(map(tuple, one.tolist()))
    crossings = sum(tuple(pair) not in known for pair in other.tolist())
    turned = invalid = 0
    for polygons in features:
        valid = []
        for xy in (before, after):
            shapes = [_shape(xy, starts, lines) for lines in polygons]
            valid.append([bool(shapely.is_valid(s)) for s in shapes] + [
                bool(shapely.is_valid(shapely.multipolygons(shapes)))])
        invalid += any(a and not b for a, b in zip(*valid))
        for lines, good in zip(polygons, valid[0]):
            if good:
                turned += _turned(before, after, starts, lines)
    return Verdict(turned, crossings, int(invalid), apart, True)


def faults(result, before, after, starts):
    """Return why a focus map is not proven to be one to one, from its own triangles; [] if it is.

    A piecewise linear map of triangles that tile a rectangle is one to one, onto a rectangle, if every
    triangle keeps its orientation and each side of the rectangle goes to a side: around an inner point
    it is a local homeomorphism, of degree one at the rim. So lines that are edges of the triangulation
    cross, touch and nest as they did. Of another triangulation of the same points this does not tell:
    with the diagonal from (0, 0) to (1, 1) the first corner of the unit square may go to (0.7, 0.6),
    and the triangle (0, 0), (1, 0), (0, 1) is upside down, with nothing folded.

    Parameters
    ----------
    result : FocusMap
    before, after, starts
        The lines, see `with_splits`.
    """
    found = []
    triangles, n = result.triangles, len(result.points)
    a, b, c = result.points[triangles].transpose(1, 0, 2)
    area = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2.0
    size = np.ptp(result.points, axis=0)
    if abs(area.sum() - size.prod()) > 1e-9 * size.prod():
        found.append("the triangles do not fill the frame")
    directed = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2) @ (n, 1)
    back = triangles[:, [[1, 0], [2, 1], [0, 2]]].reshape(-1, 2) @ (n, 1)
    if len(np.unique(directed)) < len(directed):
        found.append("triangles overlap")
    rim = directed[~np.isin(directed, back)]
    rim = np.unique(np.concatenate((rim // n, rim % n)))
    for axis in (0, 1):
        for end in (np.min, np.max):
            x, y = result.points[:, axis], result.moved[:, axis]
            side = np.flatnonzero(np.abs(x - end(x)) <= 1e-9 * size[axis])
            if np.ptp(y[side]) > 1e-9 * np.ptp(y) or abs(y[side][0] - end(y)) > 1e-9 * np.ptp(y):
                found.append(f"a side of the frame is bent (axis {axis})")
            rim = np.setdiff1d(rim, side)
    if len(rim):
        found.append("the frame is no rectangle")
    height = area / np.maximum.reduce([np.hypot(*(q - p).T) for p, q in ((a, b), (b, c), (c, a))])
    sign = np.array([_sign(*one) for one in result.moved[triangles[height > 1e-11 * size.max()]].tolist()])
    if (sign <= 0).any():
        found.append(f"{np.count_nonzero(sign <= 0)} triangles are turned")
    known = {}
    for k, point in enumerate(result.points.tolist()):
        known.setdefault(tuple(point), k)
    place = np.array([known.get(tuple(point), -1) for point in before.tolist()])
    if (place < 0).any():
        return found + ["a point of the map is no vertex"]
    inner = np.ones(len(place) - 1, dtype=bool)
    ends = np.asarray(starts[1:-1])
    inner[ends[(ends > 0) & (ends < len(place))] - 1] = False
    pairs = np.sort(np.column_stack((place[:-1], place[1:]))[inner], axis=1)
    edges = np.sort(np.column_stack((directed // n, directed % n)), axis=1) @ (n, 1)
    if not np.isin(pairs[pairs[:, 0] != pairs[:, 1]] @ (n, 1), edges).all():
        found.append("a line of the map is no edge of triangles")
    if not np.array_equal(result.moved[place], after):
        found.append("a point is not where its vertex is")
    return found


def _sign(a, b, c):
    """The orientation of three points, exactly."""
    one, other = (b[0] - a[0]) * (c[1] - a[1]), (b[1] - a[1]) * (c[0] - a[0])
    if abs(one - other) > 1e-14 * (abs(one) + abs(other)):
        return 1 if one > other else -1
    (ax, ay), (bx, by), (cx, cy) = ([Fraction(x) for x in point] for point in (a, b, c))
    exact = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    return (exact > 0) - (exact < 0)


def crossing_pairs(xy, edges):
    """Return the pairs of edges that meet, but for those that share an end, by shapely."""
    segments = shapely.linestrings(xy[edges])
    a, b = shapely.STRtree(segments).query(segments, predicate="intersects")
    pairs = np.column_stack((a, b))[a < b]
    first, second = edges[pairs[:, 0]], edges[pairs[:, 1]]
    return pairs[(first[:, :, None] != second[:, None, :]).all(axis=(1, 2))]


def _shape(xy, starts, lines):
    rings = [xy[starts[k]:starts[k + 1]] for k in lines if starts[k + 1] - starts[k] >= 4]
    return shapely.Polygon(rings[0], rings[1:]) if rings else shapely.Polygon()


def _turned(before, after, starts, lines):
    """Triangles of the constrained Delaunay triangulation of a polygon that are turned."""
    import triangle

    rows = np.concatenate([np.arange(starts[k], starts[k + 1] - 1) for k in lines])
    following = np.concatenate([np.append(np.arange(starts[k] + 1, starts[k + 1] - 1), starts[k])
                                for k in lines])
    points, first, place = np.unique(before[rows], axis=0, return_index=True, return_inverse=True)
    number = dict(zip(rows.tolist(), place.ravel().tolist()))
    number.update((starts[k + 1] - 1, number[starts[k]]) for k in lines)
    segments = [(number[a], number[b]) for a, b in zip(rows.tolist(), following.tolist())]
    points = (points - points.min(axis=0)) / (np.ptp(points, axis=0).max() or 1.0)
    graph = {"vertices": points, "segments": np.array(segments, dtype=np.int32)}
    if len(lines) > 1:
        rings = [[number[row] for row in range(starts[k], starts[k + 1])] for k in lines[1:]]
        holes = [shapely.Polygon(points[ring]) for ring in rings]
        graph["holes"] = shapely.get_coordinates(shapely.point_on_surface(holes))
    at = rows[first][triangle.triangulate(graph, "pQBPN")["triangles"]]
    sign = []
    for xy in (before, after):
        a, b, c = xy[at].transpose(1, 0, 2)
        sign.append((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    a, b, c = before[at].transpose(1, 0, 2)
    longest = np.maximum.reduce([np.hypot(*(q - p).T) for p, q in ((a, b), (b, c), (c, a))])
    seen = np.abs(sign[0]) > 1e-11 * longest * np.ptp(before, axis=0).max()  # else flat but for rounding
    return int(np.count_nonzero(seen & (sign[0] * sign[1] <= 0.0)))
