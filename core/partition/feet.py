"""Necks without a vertex: where a cut could end inside an edge, and new vertices there.

Blocks, floor plans and generalised outlines often have no vertex opposite a neck. What lies nearest to a
concave vertex is then a point inside an edge: the *foot* of the perpendicular on it. In a constrained
Delaunay triangulation a vertex beside a neck forms a triangle with the edge opposite, so feet are looked
for in triangles, and the way to them is free.

A foot is worth a vertex where both ends of the edge are farther away than the foot by the factor that
`natural` asks of places where a polygon opens up. So outlines with vertices enough get none.
"""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np

from ..metric import Metric
from ..progress import ignore
from ..rings import Rings, following, offsets_of, previous, running, shapes, take
from .natural import BENT, WIDER, Outline, bends
from .polygon import Polygons, is_valid, select, without_rings
from .triangulation import Sides, sides_of, triangulate

__all__ = ["Places", "along_edges", "concave_places", "large_places", "places", "with_feet"]

CONCAVE = np.radians(1.0)  # least turn of a concave vertex: points on a straight wall are none
# A new vertex splits an edge, and others may show before the halves. Of n concave vertices in a row before
# one edge, half of the rest, or more, come in each round.
ROUNDS = 16


class Places(NamedTuple):
    """Concave vertices with the foot on an edge opposite, and no vertex there.

    Attributes
    ----------
    apex : (m,) int
        The vertices.
    edge : (m,) int
        The corners that the edges leave; none twice.
    share : (m,) float
        Where on the edge the foot is, between 0 and 1.
    length : (m,) float
        From vertex to foot, in units of the metric (and of ``polygons.xy``).
    """

    apex: np.ndarray
    edge: np.ndarray
    share: np.ndarray
    length: np.ndarray


def places(polygons: Polygons, sides: Sides, position: np.ndarray, measure: Metric) -> Places:
    """Find the places where a cut could end inside an edge.

    Parameters
    ----------
    polygons : Polygons
    sides : triangulation.Sides
        Of the triangles of the constrained Delaunay triangulations.
    position : (n, 2 or 3) float
        ``measure.positions`` of the vertices.
    measure : metric.Metric

    Returns
    -------
    Places

    Notes
    -----
    O(n).

    Examples
    --------
    >>> from isthmus.core.metric import planar
    >>> from isthmus.core.partition.polygon import one
    >>> xy = np.array([[0, 0], [20, 0], [20, 10], [11, 10], [10, 1], [9, 10], [0, 10.0]])
    >>> polygon = one(xy, [0, 7])
    >>> triangles, *_ = triangulate(polygon)
    >>> found = places(polygon, sides_of(polygon, triangles), polygon.xy, planar())
    >>> polygon.xy[found.apex], polygon.xy[found.edge], found.share, found.length
    (array([[10.,  1.]]), array([[0., 0.]]), array([0.5]), array([1.]))
    """
    xy = polygons.xy
    side = np.flatnonzero(sides.boundary)
    v = sides.head.take(side + np.where(side % 3 == 2, -2, 1))  # the next side ends opposite
    start = position.take(sides.tail.take(side), axis=0)
    along = position.take(sides.head.take(side), axis=0) - start
    to = position.take(v, axis=0) - start
    with np.errstate(all="ignore"):  # magnitudes may be extreme; what overflows is no place
        squared, away, passed = (
            np.einsum("ij,ij->i", p, q) for p, q in ((along, along), (to, to), (along, to))
        )
        # where the ends are so much farther away than the foot, the edge is not much shorter than they are
        # far away; in most triangles of a dense outline it is
        inside = np.flatnonzero(
            (passed > 0.0) & (passed < squared) & ((1.0 - WIDER**-2) * away <= squared * (1.0 + 1e-6))
        )
        inside = inside[_concave(polygons, v[inside])]
        side, v, squared, away, passed = (x[inside] for x in (side, v, squared, away, passed))
        a, b, share = sides.tail[side], sides.head[side], passed / squared
        # the same in full, but for what chords through the Earth lie below it
        height = squared / 8.0 / np.maximum(np.abs(position[a]).max(axis=1), 1e-300)
        nearer = np.minimum(away, away - 2.0 * passed + squared)
        inside = np.flatnonzero(WIDER**2 * (away - share * passed - 4.0 * height**2) <= nearer * 1.01)
    a, b, v, share = (x[inside] for x in (a, b, v, share))
    foot = measure.positions(xy[a] + share[:, None] * (xy[b] - xy[a]))
    here = np.arange(len(v))
    length = measure.length(np.concatenate((position[v], foot)), here, here + len(v))
    nearer = np.minimum(measure.length(position, v, a), measure.length(position, v, b))
    wanted = np.flatnonzero((nearer >= WIDER * length) & (length > 0.0))
    edge = _edges_of(polygons, a[wanted], b[wanted])
    order = np.argsort(edge)
    wanted = wanted[order]
    return Places(v[wanted].astype(np.int64), edge[order], share[wanted], length[wanted])


def concave_places(polygons: Polygons, found: Places, outline: Outline) -> np.ndarray:
    """Which places are concave at the scale of the cut, as natural ones are (see `natural.natural`).

    At the foot the outline is straight. That the polygon opens up is true of all places; whether a shorter
    cut uses the same corner is not asked.

    Parameters
    ----------
    polygons : Polygons
    found : Places
    outline : natural.Outline

    Returns
    -------
    (m,) bool

    Examples
    --------
    The tip of a notch is a sharp bend, unless the whole notch, with an area of 9, is small detail.

    >>> from isthmus.core.metric import planar
    >>> from isthmus.core.partition.natural import generalised
    >>> from isthmus.core.partition.polygon import one
    >>> rows = np.array([[0, 0], [20, 0], [20, 10], [11, 10], [10, 1], [9, 10], [0, 10.0]])
    >>> polygon = one(rows, [0, 7])
    >>> sides = sides_of(polygon, triangulate(polygon)[0])
    >>> found = places(polygon, sides, polygon.xy, planar())
    >>> edge_length = planar().length(polygon.xy, np.arange(7), np.arange(1, 8) % 7)
    >>> for detail in (1.0, 10.0):
    ...     outline = generalised(polygon.xy, polygon.xy, polygon.offsets, edge_length, np.array([detail]))
    ...     print(concave_places(polygon, found, outline).tolist())
    [True]
    [False]
    """
    corner = np.empty(len(polygons.xy), dtype=np.int64)
    corner[polygons.vertex] = np.arange(len(polygons.vertex))
    own = corner[found.apex][:, None]
    return bends(outline, polygons.ring_of_corner, own, found.length)[:, 0] >= BENT


def large_places(polygons: Polygons, found: Places, measure: Metric, smallest: np.ndarray) -> np.ndarray:
    """At which places neither side of a cut is too small; true where it would join two rings.

    Parameters
    ----------
    polygons : Polygons
    found : Places
    measure : metric.Metric
    smallest : (p,) float
        See `natural.natural`.

    Returns
    -------
    (m,) bool

    Examples
    --------
    A notch hangs down to 1 above a bare floor: a cut there leaves 95.5 on either side.

    >>> from isthmus.core.metric import planar
    >>> from isthmus.core.partition.polygon import one
    >>> rows = np.array([[0, 0], [20, 0], [20, 10], [11, 10], [10, 1], [9, 10], [0, 10.0]])
    >>> polygon = one(rows, [0, 7])
    >>> sides = sides_of(polygon, triangulate(polygon)[0])
    >>> found = places(polygon, sides, polygon.xy, planar())
    >>> for smallest in (90.0, 100.0):
    ...     print(large_places(polygon, found, planar(), np.array([smallest])).tolist())
    [True]
    [False]
    """
    if not len(found.edge) or not (smallest > 0.0).any():
        return np.ones(len(found.edge), dtype=bool)
    vertex, ring = polygons.vertex, polygons.ring_of_corner
    polygon_of_ring = polygons.polygon_of_ring
    corner = np.empty(len(polygons.xy), dtype=np.int64)
    corner[vertex] = np.arange(len(vertex))
    u, v = corner[found.apex], found.edge
    # prefix sums of the shoelace terms, as in `natural.natural`; holes are left out
    plane = measure.equal_area(polygons.xy)[vertex]
    first = np.repeat(polygons.corner_offsets[:-1], np.diff(polygons.corner_offsets))
    plane = plane - plane[first]
    (x, y), (x2, y2) = plane.T, plane[following(polygons.offsets)].T
    passed, whole = running((x * y2 - x2 * y) / 2.0, polygons.offsets)
    fx, fy = (plane[v] + found.share[:, None] * (plane[following(polygons.offsets)[v]] - plane[v])).T
    side = passed[v] - passed[u] + (x[v] * fy - fx * y[v] + fx * y[u] - x[u] * fy) / 2.0
    smaller = np.minimum(np.abs(side), np.abs(whole[ring[u]] - side))
    return (smaller >= smallest[polygon_of_ring[ring[u]]]) | (ring[u] != ring[v])


def with_feet(
    polygons: Polygons,
    rings: Rings,
    free: np.ndarray,
    smallest: np.ndarray,
    *,
    measure: Metric,
    engine: str | None = None,
    check: Callable = ignore,
) -> tuple[Polygons, np.ndarray, tuple[np.ndarray, np.ndarray] | None]:
    """Insert the feet as vertices.

    They are inserted corners, so a part in which no cut ends at one does not get it.

    Parameters
    ----------
    polygons : Polygons
    rings : Rings
        What they were made of.
    free : (r,) bool
        Holes that do not count, and touch no other ring: no cut ends there.
    smallest : (p,) float
        Area of the smallest part of each polygon, in the units of ``measure.equal_area`` of ``polygons.xy``:
        no foot where a cut would leave less on one side.
    measure, engine, check
        See `triangulation.triangulate`.

    Returns
    -------
    polygons : Polygons
        Their rows from ``len(rings.coords)`` on are the new ones.
    coords : (f, d) float
        The new rows: x and y, and what rides along interpolated between the ends of the edge. Some may
        be used by no corner.
    known : ((t, 3) int, (p,) object), or None
        What `triangulation.triangulate` says of the new polygons without the free rings, if the last round
        left nothing to insert.

    Notes
    -----
    A triangulation of the polygons with new vertices in each round, most often three or four; the last one of
    each polygon is that of the result.

    Examples
    --------
    >>> from isthmus.core.metric import planar
    >>> from isthmus.core.partition.polygon import one
    >>> from isthmus.core.rings import one_polygon
    >>> rows = np.array([[0, 0, 5], [20, 0, 7], [20, 10, 7], [11, 10, 6], [10, 1, 6], [9, 10, 6],
    ...                  [0, 10, 5.0]])
    >>> whole, none_free = one_polygon(rows, [0, 7]), np.zeros(1, dtype=bool)
    >>> polygon, coords, (triangles, _) = with_feet(
    ...     one(rows, [0, 7]), whole, none_free, np.zeros(1), measure=planar())
    >>> coords
    array([[10.,  0.,  6.]])
    >>> polygon.rows
    array([0, 7, 1, 2, 3, 4, 5, 6])
    >>> len(triangles)
    6
    """
    new = np.empty((0, rings.coords.shape[1]))
    changed = np.arange(len(polygons.unit))
    problem = np.full(len(polygons.unit), "", dtype=object)
    done = []  # of the polygons that a round leaves as they are: number, triangles, and how many of each
    for _ in range(ROUNDS):
        some, _ = select(polygons, changed)
        corner, _ = take(polygons.corner_offsets, changed)
        own = free[take(polygons.polygon_offsets, changed)[0]]
        if own.any():
            kept, _ = take(some.offsets, np.flatnonzero(~own))
            corner, (some, _) = corner[kept], without_rings(some, own)
        own_smallest = smallest[changed]
        triangles, verdict, _ = triangulate(
            some, conformal=measure.conformal, engine=engine, check=lambda share: check()
        )
        asked, problem[changed] = changed, verdict
        if (verdict != "").any():
            good = np.flatnonzero(verdict == "")
            asked = asked[good]
            corner = corner[take(some.corner_offsets, good)[0]]
            some, number = select(some, good)
            own_smallest = own_smallest[good]
            back = np.empty(int(number.max(initial=-1)) + 1, dtype=np.int64)
            back[number] = np.arange(len(number))
            triangles = back[triangles]
        found = places(some, sides_of(some, triangles), measure.positions(some.xy), measure)
        large = large_places(some, found, measure, own_smallest)
        found = Places(*(x[large] for x in found))
        polygons, coords, changed = _inserted(
            polygons, rings.coords, len(new), corner[found.edge], found.share
        )
        owner = some.polygon_of_vertex[triangles[:, 0]]
        size = np.bincount(owner, minlength=len(asked))
        still = np.flatnonzero(~np.isin(asked, changed))
        index, _ = take(offsets_of(size), still)
        done.append((asked[still], (triangles - some.vertex_offsets[owner][:, None])[index], size[still]))
        if not len(changed):
            return polygons, new, (_together(polygons, free, done), problem)
        new = np.concatenate((new, coords))
    return polygons, new, None


def _together(polygons, free, done):
    """(t, 3) int: triangles, told by the vertices of their polygons, in the order of the polygons."""
    which, triangles, size = (np.concatenate(x) for x in zip(*done))
    rest = without_rings(polygons, free)[0] if free.any() else polygons
    triangles = triangles + np.repeat(rest.vertex_offsets[which], size)[:, None]
    index, _ = take(offsets_of(size), np.argsort(which, kind="stable"))
    return triangles[index]


def along_edges(polygons: Polygons, edges: np.ndarray) -> np.ndarray:
    """Which edges run along an edge of the input that has inserted corners.

    Parameters
    ----------
    polygons : Polygons
    edges : (k, 2) int

    Returns
    -------
    (k,) bool

    Examples
    --------
    The floor below a notch gets a new vertex, number 1: from 0 to 2 is along the floor, from 1 to 5 is not.

    >>> from isthmus.core.metric import planar
    >>> from isthmus.core.partition.polygon import one
    >>> from isthmus.core.rings import one_polygon
    >>> rows = np.array([[0, 0], [20, 0], [20, 10], [11, 10], [10, 1], [9, 10], [0, 10.0]])
    >>> polygon = one(rows, [0, 7])
    >>> split, _, _ = with_feet(
    ...     polygon, one_polygon(rows, [0, 7]), np.zeros(1, dtype=bool), np.zeros(1), measure=planar()
    ... )
    >>> split.xy[:3].tolist()
    [[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]]
    >>> along_edges(split, np.array([(0, 2), (1, 5)])).tolist()
    [True, False]
    """
    corner = np.empty(len(polygons.xy), dtype=np.int64)
    corner[polygons.vertex] = np.arange(len(polygons.vertex))
    first, last = np.sort(corner[edges], axis=1).T
    ring = polygons.ring_of_corner
    real = np.append(0, np.cumsum(~polygons.inserted))  # corners of the input before each
    of_ring = np.diff(real[polygons.offsets])[ring[first]]
    between = real[last] - real[first + 1]
    outside = of_ring - (real[last + 1] - real[first])
    return (ring[first] == ring[last]) & ((between == 0) | (outside == 0))


def _edges_of(polygons, a, b):
    """The edges of polygons from vertices to others, by the corners they leave."""
    n, vertex = len(polygons.xy), polygons.vertex
    if polygons.apart:
        return a.astype(np.int64)
    # some vertices have several edges
    key = vertex * n + polygons.next_vertex
    order = np.argsort(key)
    return order[np.searchsorted(key, a.astype(np.int64) * n + b, sorter=order)]


def _concave(polygons, which):
    """At which of some vertices the outline turns away from the inside."""
    xy, vertex = polygons.xy, polygons.vertex
    concave = np.zeros(len(xy), dtype=bool)
    concave[which] = True
    corner = np.flatnonzero(concave[vertex])
    here = xy[vertex[corner]]
    out_x, out_y = (xy[polygons.next_vertex[corner]] - here).T
    into_x, into_y = (here - xy[vertex[previous(polygons.offsets)[corner]]]).T
    turns = into_x * out_y - into_y * out_x < -np.tan(CONCAVE) * np.maximum(
        into_x * out_x + into_y * out_y, 0.0
    )
    concave[:] = False
    concave[vertex[corner[turns & ~polygons.inserted[corner]]]] = True
    return concave[which]


def _inserted(polygons, coords, count, edge, share):
    """Insert corners into edges, at most one in each: the polygons, the new rows, whose they are.

    A polygon that would become invalid is left as it is; ``count`` new rows there are already.
    """
    nothing = polygons, np.empty((0, coords.shape[1])), np.empty(0, dtype=np.int64)
    if not len(edge):
        return nothing
    order = np.argsort(edge)
    edge, share = edge[order], share[order]
    start, end = _ends(polygons, edge)
    xy, vertex = polygons.xy, polygons.vertex
    a, b = xy[vertex[edge]], xy[vertex[polygons.next_corner[edge]]]
    begin, way = xy[vertex[start]], xy[vertex[end]] - xy[vertex[start]]
    # on the edge of the input, whatever was inserted before
    foot = a + share[:, None] * (b - a)
    share = ((foot - begin) * way).sum(axis=1) / (way * way).sum(axis=1)
    foot = begin + share[:, None] * way + 0.0
    good = ((foot - a) * (b - a)).sum(axis=1) > 0.0
    good &= ((b - foot) * (b - a)).sum(axis=1) > 0.0
    ring = polygons.ring_of_corner
    owner = polygons.polygon_of_ring[ring[edge]]
    while good.any():
        some = np.flatnonzero(good)
        made = _with_corners(polygons, edge[some], foot[some], len(coords) + count)
        changed = np.unique(owner[some])
        ring_index, polygon_offsets = take(made.polygon_offsets, changed)
        index, offsets = take(made.offsets, ring_index)
        bad = ~is_valid(shapes(made.xy[made.vertex[index]], offsets, polygon_offsets))
        if bad.any():
            good &= ~np.isin(owner, changed[bad])
            continue
        unit = polygons.unit[owner[some]][:, None]
        low = coords[polygons.rows[polygons.row_start[start[some] + 1] - 1]]
        high = coords[polygons.rows[polygons.row_start[end[some]]]]
        with np.errstate(all="ignore"):  # Z and M may be anything
            rows = low + share[some][:, None] * (high - low)
        rows[:, :2] = foot[some] * unit
        return made, rows, changed
    return nothing


def _ends(polygons, edge):
    """Corners of the input at the ends of the edges that others were inserted into."""
    real = np.flatnonzero(~polygons.inserted)  # a ring's first corner is one
    place = np.searchsorted(real, edge, side="right")
    start = real[place - 1]
    end = real[np.minimum(place, len(real) - 1)]
    ring = polygons.ring_of_corner[start]
    past = (place == len(real)) | (end >= polygons.offsets[ring + 1])
    return start, np.where(past, polygons.offsets[ring], end)


def _with_corners(polygons, edge, xy, first_row):
    """Polygons with a corner of its own vertex inside each of some edges, ascending."""
    place = edge + 1
    after = polygons.vertex[edge] + 1  # vertices of a polygon stand together
    order = np.argsort(after, kind="stable")
    number = np.empty(len(edge), dtype=np.int64)
    number[order] = after[order] + np.arange(len(edge))
    vertex = polygons.vertex + np.searchsorted(after[order], polygons.vertex, side="right")
    added = np.bincount(
        np.searchsorted(polygons.offsets, edge, side="right"), minlength=len(polygons.offsets)
    )
    return polygons._replace(
        xy=np.insert(polygons.xy, after[order], xy[order], axis=0),
        vertex=np.insert(vertex, place, number),
        offsets=polygons.offsets + np.cumsum(added),
        rows=np.insert(polygons.rows, polygons.row_start[place], first_row + np.arange(len(edge))),
        row_start=offsets_of(np.insert(np.diff(polygons.row_start), place, 1)),
        inserted=np.insert(polygons.inserted, place, True),
    )
