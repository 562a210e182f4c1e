"""Polygons that fill a map: who shares which boundary, and what they look like joined.

Every polygon keeps its own vertices. Where a vertex of one lies inside an edge of another (a
T-junction that is not noded), that edge is cut into *pieces* here, for the comparison only: a piece
that no boundary ends at is put together again before anybody sees it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from ..metric import Metric
from ..rings import Rings, cycles, groups, offsets_of, signed_areas, starts, take
from ..rings import following as next_in_ring
from ..rings import shapes as shapes_of_rings

__all__ = [
    "Coverage",
    "Faults",
    "centroids",
    "cover",
    "each_pair",
    "faults",
    "joined",
    "overlapping",
    "shapes",
    "shared",
    "spreads",
    "with_shared_vertices",
]


class Coverage(NamedTuple):
    """Polygons as pieces of edges; the polygon is on the left of each.

    Attributes
    ----------
    coords : (k, d) float
        The input's rows.
    offsets : (r + 1,) int
        Ring i has the rows ``offsets[i]`` to ``offsets[i + 1] - 1``.
    ring_polygon : (r,) int
        Polygon of each ring; its first ring is the shell.
    row : (s,) int
        A row at the tail of each piece.
    tail, head : (s,) int
        Its ends; equal numbers are points of the plane that are equal but for the tolerance.
    xy : (p, 2) float
        These points.
    polygon : (s,) int
        The polygon of each piece.
    edge : (s,) int
        The input edge of each piece, by its first row.
    twin : (s,) int
        The piece on the other side, -1 where there is none.
    repeated : (t, 2) int
        Pairs of polygons with an edge in common that both have on the same side.
    """

    coords: np.ndarray
    offsets: np.ndarray
    ring_polygon: np.ndarray
    row: np.ndarray
    tail: np.ndarray
    head: np.ndarray
    xy: np.ndarray
    polygon: np.ndarray
    edge: np.ndarray
    twin: np.ndarray
    repeated: np.ndarray


class Faults(NamedTuple):
    """Where polygons are no coverage.

    Attributes
    ----------
    overlaps : (o, 2) int
        Pairs of polygons that overlap.
    gaps : (g, 2) float
        A point in each hole of the map that no polygon fills.
    """

    overlaps: np.ndarray
    gaps: np.ndarray


def cover(
    coords: np.ndarray, offsets: np.ndarray, ring_polygon: np.ndarray, tolerance: float | None = None
) -> Coverage:
    """Find the boundaries that polygons share.

    Parameters
    ----------
    coords : (k, d) float
        Rows of all rings of all polygons, without closing rows.
    offsets : (r + 1,) int
    ring_polygon : (r,) int
        Polygon of each ring, ascending; the first ring of each is its shell.
    tolerance : float, optional
        How far a vertex may lie from a vertex or an edge of a neighbour to count as on it; no vertex
        is moved. Default: 1e-9 of the largest coordinate of the edges there (6 mm in UTM
        coordinates); an area far away does not make the others imprecise.

    Returns
    -------
    Coverage

    Notes
    -----
    O(k log k). Only edges without an equal one on the other side are looked at for T-junctions.

    Examples
    --------
    A hall, and two rooms on its right. Its right edge, number 1, has no vertex where the rooms meet: so it
    is cut into two pieces, each with a room beyond it. Nothing is beyond the other edges of the hall.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> coords = np.concatenate((2 * square, square + [2, 0], square + [2, 1]))
    >>> coverage = cover(coords, [0, 4, 8, 12], [0, 1, 2])
    >>> its = coverage.polygon == 0
    >>> coverage.edge[its].tolist()
    [0, 1, 1, 2, 3]
    >>> [int(coverage.polygon[twin]) if twin >= 0 else None for twin in coverage.twin[its]]
    [None, 1, 2, None, None]
    """
    coords, offsets = np.asarray(coords, dtype=float), np.asarray(offsets, dtype=np.int64)
    ring_polygon = np.asarray(ring_polygon, dtype=np.int64)
    k = len(coords)
    if k == 0:
        none = np.zeros(0, dtype=np.int64)
        return Coverage(
            coords,
            offsets,
            ring_polygon,
            none,
            none,
            none,
            np.zeros((0, 2)),
            none,
            none,
            none,
            np.zeros((0, 2), dtype=np.int64),
        )
    xy = coords[:, :2] + 0.0  # + 0.0: there is only one zero
    flat = np.ascontiguousarray(xy).view(complex).ravel()
    points, point = np.unique(flat, return_inverse=True)
    point = point.ravel()
    points = np.column_stack((points.real, points.imag))
    ring = groups(offsets)
    following = next_in_ring(offsets)
    first = np.append(True, ring_polygon[1:] != ring_polygon[:-1])
    backwards = (signed_areas(xy, offsets) > 0) != first
    edge = np.arange(k)
    start = np.where(backwards[ring], following, edge)
    end = np.where(backwards[ring], edge, following)
    real = point[start] != point[end]
    edge, start, end = edge[real], start[real], end[real]
    tail, head, row = point[start], point[end], start
    polygon = ring_polygon[ring[edge]]

    twin = _twins(tail, head, len(points))
    if tolerance is None:  # asked for at the ends of open edges only
        is_end = np.zeros(len(points), dtype=bool)
        is_end[tail[twin < 0]] = is_end[head[twin < 0]] = True
        own = np.abs(points).max(axis=1)
        reach = own.copy()
        for one, other in ((tail, head), (head, tail)):
            some = np.flatnonzero(is_end[one])
            np.maximum.at(reach, one[some], own[other[some]])
        tolerance = 1e-9 * reach
    else:
        tolerance = np.full(len(points), tolerance)
    same = _close(points, tail, head, polygon, twin < 0, tolerance)
    if same is not None:
        point, tail, head = same[point], same[tail], same[head]
        twin = _twins(tail, head, len(points))
    inside = _junctions(points, tail, head, polygon, np.flatnonzero(twin < 0), tolerance)
    if len(inside[0]):
        at, new = inside
        # the row at a new tail is any row at that point
        any_row = np.empty(len(points), dtype=np.int64)
        any_row[point] = np.arange(k)
        count = np.bincount(at, minlength=len(tail))
        last = np.cumsum(1 + count)  # pieces of each edge follow one another
        whole = np.repeat(np.arange(len(tail)), 1 + count)
        begins = np.ones(last[-1], dtype=bool)
        begins[np.arange(len(at)) + at + 1] = False
        new_tail = np.empty(last[-1], dtype=np.int64)
        new_tail[begins], new_tail[~begins] = tail, new
        new_row = np.empty(last[-1], dtype=np.int64)
        new_row[begins], new_row[~begins] = row, any_row[new]
        new_head = np.append(new_tail[1:], 0)
        new_head[last - 1] = head
        tail, head, row, edge, polygon = new_tail, new_head, new_row, edge[whole], polygon[whole]
        twin = _twins(tail, head, len(points))
    repeated = _repeated(tail, head, polygon, twin, len(points))
    return Coverage(coords, offsets, ring_polygon, row, tail, head, points, polygon, edge, twin, repeated)


def _twins(tail, head, count):
    """For each piece one that runs the other way, each used once; -1 where there is none.

    Of several equal pieces the first one has a twin.
    """
    low, high = np.minimum(tail, head), np.maximum(tail, head)
    key = 2 * (low * count + high) + (tail > head)  # those of both directions follow one another
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    first = starts(ordered)
    keys = ordered[first]
    pair = np.flatnonzero((keys[1:] == keys[:-1] + 1) & (keys[:-1] % 2 == 0))
    one, other = order[first[pair]], order[first[pair + 1]]
    twin = np.full(len(key), -1)
    twin[one], twin[other] = other, one
    return twin


def _close(points, tail, head, polygon, is_open, tolerance):
    """Number for each point, equal for those that only rounding keeps apart; None if none are.

    Only ends of open edges are looked at. Points of one polygon stay apart: they are its shape.
    """
    some = np.unique(np.concatenate((tail[is_open], head[is_open])))
    if len(some) < 2:
        return None
    places = shapely.points(points[some])
    a, b = shapely.STRtree(places).query(places, predicate="dwithin", distance=tolerance[some])
    a, b = some[a[a != b]], some[b[a != b]]
    if not len(a):
        return None
    a, b = np.concatenate((a, b)), np.concatenate((b, a))
    same = np.arange(len(points))
    while (same[a] != same[b]).any():
        np.minimum.at(same, a, same[b])
    near = np.zeros(len(points), dtype=bool)
    near[a] = True
    ends = np.flatnonzero(near[tail])
    corners = np.unique(np.column_stack((polygon[ends], same[tail[ends]], tail[ends])), axis=0)
    twice = (corners[1:, :2] == corners[:-1, :2]).all(axis=1)
    spoilt = np.isin(same, corners[1:, 1][twice])
    return np.where(spoilt, np.arange(len(points)), same)


def _junctions(points, tail, head, polygon, open_edges, tolerance):
    """Points of others inside open edges: the edges, and the points along each in their order."""
    none = np.zeros(0, dtype=np.int64)
    if len(open_edges) < 2:
        return none, none
    a, b = points[tail[open_edges]], points[head[open_edges]]
    ends = np.unique(np.concatenate((tail[open_edges], head[open_edges])))
    reach = np.maximum(tolerance[tail[open_edges]], tolerance[head[open_edges]])
    tree = shapely.STRtree(shapely.points(points[ends]))
    lines = shapely.linestrings(np.stack((a, b), axis=1))
    line, which = tree.query(lines, predicate="dwithin", distance=reach)
    at, point = open_edges[line], ends[which]
    # a polygon's own corner beside its edge is its shape, and no junction
    own = np.isin(polygon[at] * len(points) + point, polygon * len(points) + tail)
    at, point = at[~own], point[~own]
    along = points[head[at]] - points[tail[at]]
    off = points[point] - points[tail[at]]
    share = (off * along).sum(axis=1) / (along**2).sum(axis=1)
    # an edge that comes from far away is imprecise, and must not take the points around here
    beside = np.abs(off[:, 0] * along[:, 1] - off[:, 1] * along[:, 0])
    inner = (share > 0.0) & (share < 1.0) & (beside <= tolerance[point] * np.hypot(*along.T))
    at, point, share = at[inner], point[inner], share[inner]
    order = np.lexsort((share, at))
    return at[order], point[order]


def _repeated(tail, head, polygon, twin, count):
    """Pairs of polygons with the same directed piece."""
    key = tail * count + head
    alone = np.sort(key[twin < 0])  # of equal pieces all but the first have no twin
    if not len(alone):
        return np.zeros((0, 2), dtype=np.int64)
    some = np.flatnonzero(alone[np.minimum(np.searchsorted(alone, key), len(alone) - 1)] == key)
    key, polygon = key[some], polygon[some]
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    return each_pair(np.column_stack((polygon[order[same]], polygon[order[same + 1]])))


def shared(coverage: Coverage, measure: Metric) -> tuple[np.ndarray, np.ndarray]:
    """Return the shared boundaries.

    Parameters
    ----------
    measure : core.metric.Metric

    Returns
    -------
    pairs : (m, 2) int
        Polygons, the smaller number first, each pair once.
    length : (m,) float
        What they have in common.

    Examples
    --------
    A hall, and two rooms on its right, one above the other.

    >>> from isthmus.core.metric import planar
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> coords = np.concatenate((2 * square, square + [2, 0], square + [2, 1]))
    >>> coverage = cover(coords, [0, 4, 8, 12], [0, 1, 2])
    >>> pairs, length = shared(coverage, planar())
    >>> pairs.tolist(), length.tolist()
    ([[0, 1], [0, 2], [1, 2]], [1.0, 1.0, 1.0])
    """
    s = np.flatnonzero(coverage.twin > np.arange(len(coverage.twin)))
    pairs = np.sort(np.column_stack((coverage.polygon[s], coverage.polygon[coverage.twin[s]])), axis=1)
    s, pairs = s[pairs[:, 0] != pairs[:, 1]], pairs[pairs[:, 0] != pairs[:, 1]]
    if not len(s):
        return pairs, np.zeros(0)
    position = measure.positions(coverage.xy)
    length = measure.length(position, coverage.tail[s], coverage.head[s])
    count = int(pairs.max()) + 1
    key, group = np.unique(pairs[:, 0] * count + pairs[:, 1], return_inverse=True)
    return np.column_stack((key // count, key % count)), np.bincount(group.ravel(), weights=length)


def with_shared_vertices(
    rings: Rings, is_new: np.ndarray, coverage: Coverage, row: np.ndarray
) -> tuple[Rings, np.ndarray]:
    """Give new vertices on shared boundaries to the neighbours, so that these stay shared bit for bit.

    Parameters
    ----------
    rings : core.rings.Rings
    is_new : (k,) bool
        The rows of new vertices, each on an edge that its polygon had.
    coverage : Coverage
        Of all or some of the polygons.
    row : (k',) int
        The row in ``rings`` of each of its rows.

    Returns
    -------
    core.rings.Rings
        Where two new vertices, or a new one and one that was there, are equal but for the tolerance, the
        new one is moved to the other. What a new row of a neighbour has beside x and y is interpolated
        between the ends of the edge.
    changed : (p,) bool
        The polygons that got vertices. One that would become invalid does not get any.

    Notes
    -----
    O(k log k).

    Examples
    --------
    >>> room, hall = [[0, 0], [2, 0], [4, 0], [4, 3], [0, 3.0]], [[0, -2], [4, -2], [4, 0], [0, 0.0]]
    >>> rings = Rings(np.array(room + hall), np.array([0, 5, 9]), np.array([0, 1, 2]))
    >>> coverage = cover(rings.coords, rings.offsets, np.array([0, 1]))
    >>> made, changed = with_shared_vertices(rings, np.arange(9) == 1, coverage, np.arange(9))
    >>> made.coords[5:].tolist(), changed
    ([[0.0, -2.0], [4.0, -2.0], [4.0, 0.0], [2.0, 0.0], [0.0, 0.0]], array([False,  True]))
    """
    coords = rings.coords.copy()
    begins = np.diff(coverage.edge, prepend=-1) != 0
    whole = np.flatnonzero(begins)
    label, of = coverage.tail[whole], row[coverage.row[whole]]
    new = is_new[of]
    # the row whose place all vertices with a label take: one that is not new, if there is one
    order = np.lexsort((of, new, label))
    first = np.diff(label[order], prepend=-1) != 0
    chosen = np.full(len(coverage.xy), -1)
    chosen[label[order[first]]] = of[order[first]]
    coords[of[new], :2] = coords[chosen[label[new]], :2]
    has_new = np.zeros(len(coverage.xy), dtype=bool)
    has_new[label[new]] = True

    piece = np.flatnonzero(~begins & has_new[coverage.tail])
    edge, like = row[coverage.edge[piece]], chosen[coverage.tail[piece]]
    after = next_in_ring(rings.offsets)
    low, way = coords[edge], coords[after[edge]] - coords[edge]
    share = ((coords[like, :2] - low[:, :2]) * way[:, :2]).sum(axis=1) / (way[:, :2] ** 2).sum(axis=1)
    with np.errstate(all="ignore"):  # Z and M may be anything
        more = low + share[:, None] * way
        same = np.abs(more - coords[like]) <= 1e-9 * np.abs(coords[like])
    more = np.where(same, coords[like], more)
    more[:, :2] = coords[like, :2]
    order = np.lexsort((share, edge))
    edge, more = edge[order], more[order]
    ring = groups(rings.offsets)[edge]
    owner = groups(rings.polygon_offsets)[ring]
    thin = groups(rings.polygon_offsets)[np.diff(rings.offsets) < 3]  # no polygon for GEOS
    kept = ~np.isin(owner, thin)
    while True:
        edge, more, ring, owner = edge[kept], more[kept], ring[kept], owner[kept]
        changed = np.zeros(len(rings.polygon_offsets) - 1, dtype=bool)
        changed[owner] = True
        size = np.diff(rings.offsets) + np.bincount(ring, minlength=len(rings.offsets) - 1)
        made = Rings(np.insert(coords, edge + 1, more, axis=0), offsets_of(size), rings.polygon_offsets)
        which = np.flatnonzero(changed)
        index, polygon_offsets = take(made.polygon_offsets, which)
        index, offsets = take(made.offsets, index)
        valid = shapely.is_valid(shapes_of_rings(made.coords[index, :2], offsets, polygon_offsets))
        if not len(which) or valid.all():
            return made, changed
        kept = ~np.isin(owner, which[~valid])


def centroids(coverage: Coverage, plane: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return area and centroid of each polygon in a plane with true areas.

    Parameters
    ----------
    plane : (k, 2) float
        The rows in that plane.
    count : int
        Number of polygons.

    Returns
    -------
    area : (count,) float
    moment : (count, 2) float
        Centroid times area, so that parts can be added up.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> coords = np.concatenate((2 * square, square + [2, 0]))
    >>> area, moment = centroids(cover(coords, [0, 4, 8], [0, 1]), coords, 2)
    >>> area.tolist(), (moment / area[:, None]).tolist()
    ([4.0, 1.0], [[1.0, 1.0], [2.5, 0.5]])
    """
    offsets = coverage.offsets
    if len(offsets) < 2:
        return np.zeros(count), np.zeros((count, 2))
    origin = plane[offsets[:-1]]
    ring = groups(offsets)
    x, y = (plane - origin[ring]).T
    following = next_in_ring(offsets)
    cross = x * y[following] - x[following] * y
    area = 0.5 * np.add.reduceat(cross, offsets[:-1])
    moment = (
        np.column_stack(
            (
                np.add.reduceat((x + x[following]) * cross, offsets[:-1]),
                np.add.reduceat((y + y[following]) * cross, offsets[:-1]),
            )
        )
        / 6.0
        + origin * area[:, None]
    )
    first = np.append(True, coverage.ring_polygon[1:] != coverage.ring_polygon[:-1])
    sign = np.where((area > 0) == first, 1.0, -1.0)  # shells add, holes take away

    def total(values):
        return np.bincount(coverage.ring_polygon, weights=sign * values, minlength=count)

    return total(area), np.column_stack((total(moment[:, 0]), total(moment[:, 1])))


def spreads(coverage: Coverage, plane: np.ndarray, owner: np.ndarray) -> np.ndarray:
    """Return the mean squared distance of the points of each area from the origin, exactly.

    Parameters
    ----------
    plane : (k, 2) float
        The rows, those of each area from its own centroid.
    owner : (q,) int
        The area of each polygon.

    Returns
    -------
    (n,) float
        Up to the last area that ``owner`` names. 0 for areas without size; of an area that crosses
        itself, whose parts cancel out, no more than its farthest row.

    Examples
    --------
    A square with sides of 6, from its centre: 6 * 6 / 6.

    >>> square = np.array([[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]])
    >>> spreads(cover(square, [0, 4], [0]), square, [0]).round(9).tolist()
    [6.0]
    """
    offsets, owner = coverage.offsets, np.asarray(owner, dtype=np.int64)
    count = int(owner.max(initial=-1)) + 1
    if len(offsets) < 2 or not len(plane):
        return np.zeros(count)
    following = next_in_ring(offsets)
    x, y = plane.T
    u, v = plane[following].T
    cross = x * v - u * y
    area = np.add.reduceat(cross, offsets[:-1]) / 2.0
    second = np.add.reduceat((x * x + x * u + u * u + y * y + y * v + v * v) * cross, offsets[:-1]) / 12.0
    first = np.append(True, coverage.ring_polygon[1:] != coverage.ring_polygon[:-1])
    sign = np.where((area > 0) == first, 1.0, -1.0)
    ring_area = owner[coverage.ring_polygon]
    area = np.bincount(ring_area, weights=sign * area, minlength=count)
    second = np.bincount(ring_area, weights=sign * second, minlength=count)
    most = np.zeros(count)
    # ring by ring first: `at` is slow in older numpy
    np.maximum.at(most, ring_area, np.maximum.reduceat(x * x + y * y, offsets[:-1]))
    mean = np.divide(second, area, out=np.zeros(count), where=area > 0.0)
    return np.clip(mean, 0.0, most)


def faults(coverage: Coverage) -> Faults:
    """Find overlaps and gaps.

    Returns
    -------
    Faults

    Notes
    -----
    Looks at the edges without a twin and at one inner point of each polygon. Two complete coverages
    on top of each other with polygons that only cross may have more overlaps than are listed.

    Examples
    --------
    Two squares that overlap; and a square with a hole that no other polygon fills.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> coords = np.concatenate((2 * square, 2 * square + 1))
    >>> faults(cover(coords, [0, 4, 8], [0, 1])).overlaps.tolist()
    [[0, 1]]
    >>> coords = np.concatenate((3 * square, square + 1))
    >>> faults(cover(coords, [0, 4, 8], [0, 0])).gaps.round(6).tolist()
    [[1.5, 1.5]]
    """
    polygons = shapes(coverage)
    valid = shapely.is_valid(polygons) & ~shapely.is_empty(polygons)
    number = np.flatnonzero(valid)
    tree = shapely.STRtree(polygons[valid])
    inner, other = tree.query(shapely.point_on_surface(polygons[valid]), predicate="within")
    pairs = np.concatenate(
        (overlapping(coverage, polygons, valid), np.column_stack((number[inner], number[other])))
    )
    gaps = np.zeros((0, 2))
    lines = _open_edges(coverage)[1]
    if len(lines):
        faces = shapely.get_parts(shapely.polygonize(lines))
        inside = shapely.point_on_surface(faces)
        filled = np.unique(tree.query(inside, predicate="intersects")[0])
        empty = np.setdiff1d(np.arange(len(faces)), filled)
        gaps = shapely.get_coordinates(inside[empty])
    return Faults(each_pair(pairs), gaps)


def overlapping(coverage: Coverage, polygons: np.ndarray, valid: np.ndarray) -> np.ndarray:
    """Return pairs of polygons that overlap, some of each place where any do: (o, 2) int.

    Parameters
    ----------
    coverage : Coverage
    polygons : (q,) array of shapely polygons
        See `shapes`.
    valid : (q,) bool
        Those that may be asked what lies in them.

    Notes
    -----
    O(q log e) for the e edges without a twin. Where polygons overlap more than one of them is on the left of
    the boundary of that place, and one at most beyond it: that boundary is of edges without a twin. They are
    few where polygons fill a map; so this is quick, but lists fewer pairs than `faults`.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> coverage = cover(np.concatenate((2 * square, 2 * square + 1)), [0, 4, 8], [0, 1])
    >>> overlapping(coverage, shapes(coverage), np.ones(2, dtype=bool)).tolist()
    [[0, 1]]
    """
    edge, lines = _open_edges(coverage)
    if not len(edge):
        return each_pair(coverage.repeated)
    owner, number = coverage.polygon[edge], np.flatnonzero(valid)
    # a polygon is asked for the points in it, and not the other way: GEOS prepares what asks, and one of a
    # million edges has a million points in its bounds
    ends = shapely.get_coordinates(lines).reshape(-1, 2, 2)
    middle = shapely.STRtree(shapely.points((ends[:, 0] + ends[:, 1]) / 2.0))
    around, which = middle.query(polygons[number], predicate="contains")
    one, other = shapely.STRtree(lines).query(lines, predicate="crosses")
    return each_pair(
        np.concatenate(
            (
                coverage.repeated,
                np.column_stack((owner[which], number[around])),
                np.column_stack((owner[one], owner[other])),
            )
        )
    )


def _open_edges(coverage):
    """The pieces without a twin, and as lines."""
    lone = np.flatnonzero(coverage.twin < 0)
    ends = np.stack((coverage.xy[coverage.tail[lone]], coverage.xy[coverage.head[lone]]), axis=1)
    return lone, shapely.linestrings(ends)


def each_pair(pairs: np.ndarray) -> np.ndarray:
    """Return pairs of two, each once, the smaller number first.

    Examples
    --------
    >>> each_pair(np.array([[2, 1], [1, 2], [3, 3]])).tolist()
    [[1, 2]]
    """
    pairs = np.sort(pairs.reshape(-1, 2), axis=1)
    return np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0)


def shapes(coverage: Coverage, count: int | None = None) -> np.ndarray:
    """Return the polygons as shapely geometries; empty where a ring has fewer than three points.

    Parameters
    ----------
    count : int, optional
        Number of polygons. Default: up to the last one that has a ring.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> coords = np.concatenate((3 * square, square + 1, 2 * square + 5))
    >>> one, other = shapes(cover(coords, [0, 4, 8, 12], [0, 0, 1]))
    >>> one.area, len(one.interiors), other.bounds
    (8.0, 1, (5.0, 5.0, 7.0, 7.0))
    """
    if count is None:
        count = int(coverage.ring_polygon.max(initial=-1)) + 1
    size = np.diff(coverage.offsets)
    short = np.unique(coverage.ring_polygon[size < 3])
    good = ~np.isin(coverage.ring_polygon, short)
    rows = np.flatnonzero(np.repeat(good, size))
    ring = np.repeat(np.cumsum(good) - 1, size)[rows]
    result = np.full(count, shapely.Polygon(), dtype=object)
    if not len(rows):
        return result
    lines, owner = shapely.linearrings(coverage.coords[rows, :2], indices=ring), coverage.ring_polygon[good]
    its = np.append(True, owner[1:] != owner[:-1])
    result[owner[its]] = shapely.polygons(lines, indices=np.cumsum(its) - 1)
    return result


def joined(coverage: Coverage, label: np.ndarray) -> dict[int, list[list[np.ndarray]]]:
    """Join the polygons of each label along their shared boundaries.

    Parameters
    ----------
    label : (q,) int
        Label of each polygon; negative: left out.

    Returns
    -------
    dict of int to list of list of (m,) int
        For each label its polygons, each a list of rings of rows, the shell first. Labels that do
        not become valid, because the input overlaps or is not valid, are missing.

    Notes
    -----
    O(s log s). No coordinate is computed: the rings are made of rows of the input.

    Examples
    --------
    A hall, and two rooms on its right, one above the other: the hall and the lower room together.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> coords = np.concatenate((2 * square, square + [2, 0], square + [2, 1]))
    >>> coverage = cover(coords, [0, 4, 8, 12], [0, 1, 2])
    >>> polygons = joined(coverage, [0, 0, 1])
    >>> [[shell]] = polygons[0]  # one polygon, without holes
    >>> coords[shell].astype(int).tolist()
    [[0, 0], [2, 0], [3, 0], [3, 1], [2, 1], [2, 2], [0, 2]]
    """
    label = np.asarray(label, dtype=np.int64)
    own = label[coverage.polygon]
    beyond = np.where(coverage.twin >= 0, own[coverage.twin], -1)
    kept = np.flatnonzero((own >= 0) & ((coverage.twin < 0) | (own != beyond)))
    result = {}
    if not len(kept):
        return result
    count = len(coverage.xy)
    begin = own[kept] * count + coverage.tail[kept]
    order = np.argsort(begin, kind="stable")
    kept, begin = kept[order], begin[order]
    end = own[kept] * count + coverage.head[kept]
    low = np.searchsorted(begin, end, "left")
    several = np.searchsorted(begin, end, "right") - low
    after = low.copy()
    for k in np.flatnonzero(several > 1).tolist():
        after[k] = _next_around(coverage, kept, k, range(low[k], low[k] + several[k]))

    seen, following = [False] * len(kept), after.tolist()
    walks, lengths = [], []
    for first in range(len(kept)):
        if seen[first]:
            continue
        before, k = len(walks), first
        while not seen[k]:
            seen[k] = True
            walks.append(k)
            k = following[k]
        lengths.append(len(walks) - before)
    walk = np.array(walks)
    place, offsets, _ = cycles(coverage.tail[kept[walk]], offsets_of(lengths))
    if not len(place):
        return result
    pieces = kept[walk[place]]
    one_of = own[pieces[offsets[:-1]]].tolist()
    for which, *ring in _corners(coverage, pieces, offsets):
        result.setdefault(one_of[which], []).append(ring)
    nested = {one: _nest(coverage, its) for one, its in result.items()}
    nested = {one: polygons for one, polygons in nested.items() if polygons}
    good = _uncrossed(coverage, list(nested.values()))
    return {one: polygons for (one, polygons), fine in zip(nested.items(), good.tolist()) if fine}


def _next_around(coverage, kept, k, choices):
    """At a point that a boundary passes several times: the next piece around the same corner."""
    here = coverage.xy[coverage.head[kept[k]]]
    back = coverage.xy[coverage.tail[kept[k]]] - here
    best = None
    for other in choices:
        ahead = coverage.xy[coverage.head[kept[other]]] - here
        # clockwise from the way back
        cross, dot = back[0] * ahead[1] - back[1] * ahead[0], back @ ahead
        turn = (-np.arctan2(cross, dot)) % (2.0 * np.pi)
        if turn == 0.0:
            turn = 2.0 * np.pi
        if best is None or turn < best[0]:
            best = (turn, other)
    return best[1]


def _corners(coverage, pieces, offsets):
    """The rings of closed walks: which walk, area, rows; points that only cut an edge are dropped."""
    edge = coverage.edge[pieces]
    before = np.roll(edge, 1)
    before[offsets[:-1]] = edge[offsets[1:] - 1]
    corner = edge != before
    count = np.add.reduceat(corner.astype(np.int64), offsets[:-1])
    large = count > 2
    rows = coverage.row[pieces][corner & np.repeat(large, np.diff(offsets))]
    offsets = offsets_of(count[large])
    area = signed_areas(coverage.coords[rows, :2], offsets)
    return zip(np.flatnonzero(large).tolist(), area.tolist(), np.split(rows, offsets[1:-1]))


def _nest(coverage, rings):
    """Rings, by their area and rows, as shells with their holes; none where there is no shell."""
    rings = sorted(rings, key=lambda ring: -abs(ring[0]))
    shells = [ring for ring in rings if ring[0] > 0.0]
    holes = [ring for ring in rings if not ring[0] > 0.0]
    if not shells:
        return []
    polygons = [[rows] for _, rows in shells]
    for (_, rows), k in zip(holes, _shells_around(coverage, shells, holes)):
        polygons[k].append(rows)
    return polygons


def _uncrossed(coverage, nested):
    """Whether the polygons of each region are valid: where the input overlaps, rings may cross."""
    if not nested:
        return np.zeros(0, dtype=bool)
    polygons = [polygon for its in nested for polygon in its]
    rings = [ring for polygon in polygons for ring in polygon]
    made = shapes_of_rings(
        coverage.coords[np.concatenate(rings), :2],
        offsets_of([len(ring) for ring in rings]),
        offsets_of([len(polygon) for polygon in polygons]),
    )
    several = np.repeat(np.arange(len(nested)), [len(its) for its in nested])
    return shapely.is_valid(shapely.multipolygons(made, indices=several))


def _shells_around(coverage, shells, holes):
    """The smallest shell around each hole, by its number; shells stand by falling area."""
    if len(shells) == 1:
        return [0] * len(holes)
    shapes = [shapely.Polygon(coverage.coords[rows, :2]) for _, rows in shells] if holes else []
    found = []
    for area, rows in holes:
        # an island in the hole may contain its inner point, but is not larger than the hole
        inside = shapely.Polygon(coverage.coords[rows, :2]).representative_point()
        larger = reversed([k for k, (size, _) in enumerate(shells) if size > -area])
        found.append(next((k for k in larger if shapes[k].contains(inside)), 0))
    return found
