"""An independent checker of focus maps: what was promised, from the lines before and after alone."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np
import shapely

__all__ = ["Verdict", "crossing_pairs", "faults", "verify", "with_splits"]

AT_ONCE = 200_000  # segments that are asked for their neighbours at a time


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
    place, vertex = _numbered(before)
    apart = int(np.count_nonzero((after[vertex[place]] != after).any(axis=1)))
    pairs = _segments(place, starts)
    one, other = (crossing_pairs(xy[vertex], pairs) @ (len(pairs), 1) for xy in (before, after))
    crossings = int(np.count_nonzero(~np.isin(other, one)))
    feature = np.repeat(np.arange(len(features)), [len(polygons) for polygons in features])
    polygons = [lines for one in features for lines in one]
    valid, whole = [], []
    for xy in (before, after):
        shapes = _shapes(xy, starts, polygons)
        valid.append(shapely.is_valid(shapes))
        many = np.full(len(features), None, dtype=object)
        shapely.multipolygons(shapes, indices=feature, out=many)
        whole.append(shapely.is_valid(many))
    broken = np.union1d(np.flatnonzero(whole[0] & ~whole[1]), feature[valid[0] & ~valid[1]])
    flat = 1e-11 * np.ptp(before, axis=0).max(initial=0.0)
    turned = sum(_turned(before, after, starts, polygons[k], flat) for k in np.flatnonzero(valid[0]).tolist())
    return Verdict(turned, crossings, len(broken), apart, True)


def _numbered(xy):
    """The number of each point, equal ones counted once, and the first row of each number."""
    points = np.ascontiguousarray(xy + 0.0).view(np.complex128).ravel()  # + 0.0: there is only one zero
    _, first, place = np.unique(points, return_index=True, return_inverse=True)
    return place.ravel(), first


def _segments(place, starts):
    """The segments of lines, as pairs of numbers of points, each once."""
    inner = np.ones(max(len(place) - 1, 0), dtype=bool)
    ends = np.asarray(starts[1:-1])
    inner[ends[(ends > 0) & (ends < len(place))] - 1] = False
    pairs = np.sort(np.column_stack((place[:-1], place[1:]))[inner], axis=1)
    n = int(place.max(initial=0)) + 1
    key = np.unique(pairs[pairs[:, 0] != pairs[:, 1]] @ (n, 1))
    return np.column_stack((key // n, key % n))


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
    rim = left = np.unique(np.concatenate((rim // n, rim % n)))
    for axis in (0, 1):
        for end in (np.min, np.max):
            x, y = result.points[:, axis], result.moved[:, axis]
            side = rim[np.abs(x[rim] - end(x)) <= 1e-9 * size[axis]]
            if np.ptp(y[side]) > 1e-9 * np.ptp(y) or abs(y[side][0] - end(y)) > 1e-9 * np.ptp(y):
                found.append(f"a side of the frame is bent (axis {axis})")
            left = np.setdiff1d(left, side)
    if len(left):
        found.append("the frame is no rectangle")
    longest = np.maximum.reduce([np.hypot(*(q - p).T) for p, q in ((a, b), (b, c), (c, a))])
    rounding = 4.0 * 2.0**-52 * max(np.abs(result.points).max(), np.abs(result.moved).max())
    height = 2.0 * area / np.maximum(longest, 1e-300)
    sign = _signs(result.moved[triangles[height > max(1e-11 * size.max(), rounding)]])
    if (sign <= 0).any():
        found.append(f"{np.count_nonzero(sign <= 0)} triangles are turned")
    number, first = _numbered(np.concatenate((result.points, before)))
    place = first[number[n:]]  # the first of equal points
    if (place >= n).any():
        return found + ["a point of the map is no vertex"]
    edges = np.sort(np.column_stack((directed // n, directed % n)), axis=1) @ (n, 1)
    if not np.isin(_segments(place, starts) @ (n, 1), edges).all():
        found.append("a line of the map is no edge of triangles")
    if not np.array_equal(result.moved[place], after):
        found.append("a point is not where its vertex is")
    return found


def _signs(corners):
    """The orientation of (k, 3, 2) corners, exactly."""
    a, b, c = corners.transpose(1, 0, 2)
    one = (b - a)[:, 0] * (c - a)[:, 1]
    other = (b - a)[:, 1] * (c - a)[:, 0]
    sign = np.sign(one - other).astype(int)
    for k in np.flatnonzero(~(np.abs(one - other) > 1e-14 * (np.abs(one) + np.abs(other)))).tolist():
        (ax, ay), (bx, by), (cx, cy) = ([Fraction(x) for x in point] for point in corners[k].tolist())
        exact = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        sign[k] = (exact > 0) - (exact < 0)
    return sign


def crossing_pairs(xy, edges):
    """Return the pairs of edges that meet, but for those that share an end, by shapely."""
    tree = shapely.STRtree(shapely.linestrings(xy[edges]))
    found = [np.empty((0, 2), dtype=np.int64)]
    for start in range(0, len(edges), AT_ONCE):
        some = tree.geometries[start : start + AT_ONCE]
        a, b = tree.query(some)  # boxes that meet; most of these share an end
        a += start
        a, b = a[a < b], b[a < b]
        apart = (edges[a][:, :, None] != edges[b][:, None, :]).all(axis=(1, 2))
        a, b = a[apart], b[apart]
        meet = shapely.intersects(tree.geometries[a], tree.geometries[b])
        found.append(np.column_stack((a[meet], b[meet])))
    return np.concatenate(found)


def _shapes(xy, starts, polygons):
    """Polygons of lines that are rings; those with less than four points do not count."""
    shapes = np.full(len(polygons), shapely.Polygon(), dtype=object)
    used = [[k for k in lines if starts[k + 1] - starts[k] >= 4] for lines in polygons]
    count = [len(lines) for lines in used]
    line = np.array([k for lines in used for k in lines], dtype=np.int64)
    if len(line):
        length = np.diff(starts)[line]
        row = np.arange(length.sum()) + np.repeat(starts[line] - np.cumsum(length) + length, length)
        rings = shapely.linearrings(xy[row], indices=np.repeat(np.arange(len(line)), length))
        shapely.polygons(rings, indices=np.repeat(np.arange(len(polygons)), count), out=shapes)
    return shapes


def _corners(points, number):
    """Corners of the triangles of a polygon, given as rings of points: by Triangle, or by shapely without it."""
    try:
        import triangle
    except ImportError:  # there is none for Python 3.14
        polygon = shapely.Polygon(points[number[0]], [points[ring] for ring in number[1:]])
        triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
        corner = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3] @ (1.0, 1j)
        key = points @ (1.0, 1j)  # coordinates come back to the last bit
        order = np.argsort(key)
        return order[np.searchsorted(key[order], corner)]
    segments = np.concatenate([np.column_stack((ring, np.roll(ring, -1))) for ring in number])
    graph = {"vertices": points, "segments": segments.astype(np.int32)}
    if len(number) > 1:
        holes = [shapely.Polygon(points[ring]) for ring in number[1:]]
        graph["holes"] = shapely.get_coordinates(shapely.point_on_surface(holes))
    return triangle.triangulate(graph, "pQBPN")["triangles"]


def _turned(before, after, starts, lines, flat):
    """Triangles of the constrained Delaunay triangulation of a polygon that are turned, unless flat."""
    rings = [np.arange(starts[k], starts[k + 1] - 1) for k in lines]
    rows = np.concatenate(rings)
    place, first = _numbered(before[rows])
    number = np.split(place, np.cumsum([len(ring) for ring in rings])[:-1])
    points = before[rows[first]]
    points = (points - points.min(axis=0)) / (np.ptp(points, axis=0).max() or 1.0)
    at = rows[first][_corners(points, number)]
    sign = []
    for xy in (before, after):
        a, b, c = xy[at].transpose(1, 0, 2)
        sign.append((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    a, b, c = before[at].transpose(1, 0, 2)
    longest = np.maximum.reduce([np.hypot(*(q - p).T) for p, q in ((a, b), (b, c), (c, a))])
    seen = np.abs(sign[0]) > flat * longest  # else flat but for rounding
    return int(np.count_nonzero(seen & (sign[0] * sign[1] <= 0.0)))
