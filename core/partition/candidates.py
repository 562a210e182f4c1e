"""Which edges may be selected: a triangulation's diagonals or a user's own lines.

Section 4.2 of the paper: any set of diagonals that do not cross serves as candidate set C.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Callable, NamedTuple

import numpy as np
import shapely

from ..metric import Metric
from ..predicates import crossing
from ..progress import ignore
from ..rings import shapes, signed_areas, take
from .feet import Places, concave_places, large_places, places
from .natural import KEPT, Ways, natural
from .polygon import Polygons, select, without_rings
from .triangulation import diagonals, sides_of, triangulate

if TYPE_CHECKING:
    from .gates import Gates

__all__ = [
    "ACCEPTED",
    "CROSSES",
    "Diagonals",
    "Lines",
    "OFF_VERTICES",
    "clear",
    "counted",
    "from_lines",
    "from_triangulation",
]

# What became of a line; PROBLEMS says it in words. The higher, the closer it was to a diagonal.
ACCEPTED, OFF_VERTICES, LEAVES, TOUCHES, REPEATED, CROSSES = range(6)

# Line ends are matched with vertices within this share of the largest coordinate.
TOLERANCE = 1e-9


class Lines(NamedTuple):
    """Lines matched with a polygon.

    Attributes
    ----------
    edges : (k, 2) int
        Vertex indices u < v of the diagonals, u ascending, then v descending.
    edge_line : (k,) int
        The line of each.
    verdict : (l,) int
        For each line ACCEPTED, OFF_VERTICES (an end is no vertex), LEAVES (the polygon), TOUCHES
        (the boundary between its ends), REPEATED (another line) or CROSSES (another line).
    other : (l,) int
        The line that it repeats or crosses, else -1.
    """

    edges: np.ndarray
    edge_line: np.ndarray
    verdict: np.ndarray
    other: np.ndarray


def from_lines(polygon: Polygons, lines: np.ndarray) -> Lines:
    """Find out which lines are diagonals of a polygon that do not cross.

    Parameters
    ----------
    polygon : Polygons
        A chunk of one.
    lines : (l, 2, 2) float
        The ends of straight lines.

    Returns
    -------
    Lines
        Where two lines cross, the shorter one is accepted.

    Notes
    -----
    Section 4.2 of the paper: any diagonals that do not cross may be the candidates. O((n + l) log n), but
    for one test of each line against the polygon.

    Examples
    --------
    The diagonals of a kite cross, and the shorter one stays; the third line ends where there is no vertex.

    >>> from isthmus.core.partition.polygon import from_rings
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [9, -1], [20, 0], [9, 1.0]])
    >>> kite, _ = from_rings(one_polygon(xy, [0, 4]))
    >>> found = from_lines(kite, [[[0, 0], [20, 0]], [[9, 1], [9, -1]], [[0, 0], [5, 0]]])
    >>> found.edges.tolist(), found.verdict.tolist() == [CROSSES, ACCEPTED, OFF_VERTICES]
    ([[1, 3]], True)
    """
    with np.errstate(over="ignore"):  # a line far off a tiny polygon
        lines = np.asarray(lines, dtype=float).reshape(-1, 2, 2) / polygon.unit[0]
    verdict = np.full(len(lines), OFF_VERTICES)
    other = np.full(len(lines), -1)
    ends = _nearest_vertices(polygon.xy, lines)
    found = np.flatnonzero((ends >= 0).all(axis=1) & (ends[:, 0] != ends[:, 1]))
    if len(found) == 0:
        return Lines(np.empty((0, 2), dtype=np.int64), found, verdict, other)
    segments = shapely.linestrings(polygon.xy[ends[found]])
    verdict[found] = _against_polygon(polygon, segments)
    borders = np.stack((polygon.vertex, polygon.vertex[polygon.next_corner]), axis=1)
    leaving, _ = _crossings(polygon.xy[ends[found]], polygon.xy[borders])
    verdict[found[leaving]] = LEAVES

    # shortest first; ties by place, so that the order of the lines does not matter
    good = found[verdict[found] == ACCEPTED]
    xy = np.sort(_complex(polygon.xy)[ends[good]], axis=1)
    length = np.abs(xy[:, 1] - xy[:, 0])
    good = good[np.lexsort((good, xy[:, 1], xy[:, 0], length))]
    key = np.sort(ends[good], axis=1)
    _, first, inverse = np.unique(key, axis=0, return_index=True, return_inverse=True)
    original = good[first][inverse.ravel()]
    verdict[good[original != good]] = REPEATED
    other[good[original != good]] = original[original != good]
    good = good[original == good]

    crossed = {}
    for p, q in zip(*_crossings(polygon.xy[ends[good]], polygon.xy[ends[good]])):
        if q < p:
            crossed.setdefault(p, []).append(q)
    for p in sorted(crossed):
        for q in sorted(crossed[p]):
            if verdict[good[q]] == ACCEPTED:
                verdict[good[p]], other[good[p]] = CROSSES, good[q]
                break
    good = good[verdict[good] == ACCEPTED]
    u, v = np.sort(ends[good], axis=1).T
    order = np.lexsort((-v, u))
    return Lines(np.column_stack((u, v))[order], good[order], verdict, other)


class Diagonals(NamedTuple):
    """The diagonals of triangulations.

    Attributes
    ----------
    edges : (k, 2) int
        Vertices u < v, u ascending, then v descending.
    verdict : (p,) object
        For each polygon '', or why it could not be triangulated; it has no edges then.
    why : (k,) int8 or None
        Why each is no candidate for natural parts; `natural.KEPT` where it is one.
    share : (k,) float or None
        Area of the smaller side, as a share of the polygon's; NaN where a diagonal joins two rings.
    edge_length : (c,) float or None
        Length of the polygon edge that leaves each corner, on the generalised outline; NaN at corners
        that are left out.
    places : feet.Places or None
        Where a cut could end inside an edge, if that was asked; the natural ones, if only these are wanted.
    gate : (k,) int or None
        Which of the gates each is, -1 if none; None where no gates are candidates.
    """

    edges: np.ndarray
    verdict: np.ndarray
    places: Places | None
    why: np.ndarray | None = None
    share: np.ndarray | None = None
    edge_length: np.ndarray | None = None
    gate: np.ndarray | None = None


def from_triangulation(
    polygons: Polygons,
    component: np.ndarray,
    wanted: np.ndarray,
    *,
    measure: Metric,
    smallest: np.ndarray | None = None,
    only_natural: bool = False,
    gates: Gates | None = None,
    known: tuple | None = None,
    with_places: bool = True,
    engine: str | None = None,
    check: Callable = ignore,
) -> Diagonals:
    """Find the diagonals of triangulations that do not touch the boundary components left out.

    Parameters
    ----------
    polygons : Polygons
    component : (r,) int
        Component of each ring.
    wanted : (r,) bool
        The components that count. The triangulation is that of the polygon without the others, so
        that a neck with an islet in it can still be cut beside the islet.
    smallest : (p,) float, optional
        Area of the smallest part of each polygon: asks which diagonals are natural (`natural.natural`).
    only_natural : bool
        Whether only these will be candidates; so are the places then.
    gates : Gates, optional
        Ways over islands that may be candidates, too.
    known : tuple, optional
        What `triangulation.triangulate` says of the polygons without the others, if that is known.
    with_places : bool
        Whether places where a cut could end inside an edge are asked for.
    measure, engine, check
        See `triangulation.triangulate`.

    Returns
    -------
    Diagonals

    Examples
    --------
    A flat kite: the Delaunay diagonal is the short one.

    >>> from isthmus.core.metric import planar
    >>> from isthmus.core.partition.polygon import from_rings
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [9, -1], [20, 0], [9, 1.0]])
    >>> kite, _ = from_rings(one_polygon(xy, [0, 4]))
    >>> component, wanted = np.zeros(1, dtype=int), np.ones(1, dtype=bool)
    >>> from_triangulation(kite, component, wanted, measure=planar()).edges.tolist()
    [[1, 3]]
    """
    free = ~wanted[component]
    corner = np.arange(len(polygons.vertex))
    vertex, rest = np.arange(len(polygons.xy)), polygons
    if free.any():
        rest, vertex = without_rings(polygons, free)
        corner, _ = take(polygons.offsets, np.flatnonzero(~free))
    if known:
        triangles, verdict, sides = *known, None
    else:
        triangles, verdict, sides = triangulate(rest, conformal=measure.conformal, engine=engine, check=check)
    if (verdict != "").any():
        which = np.flatnonzero(verdict == "")
        corner = corner[take(rest.corner_offsets, which)[0]]
        rest, number = select(rest, which)
        back = np.empty(len(vertex), dtype=np.int64)
        back[number] = np.arange(len(number))
        triangles, vertex, sides = back[triangles], vertex[number], None
    sides = sides or sides_of(rest, triangles)
    edges = diagonals(rest, triangles, sides)
    position = measure.positions(rest.xy)
    short = places(rest, sides, position, measure) if with_places else None
    if free.any():  # before the natural ones are chosen: an islet must not use up the corners beside it
        edges = edges[clear(polygons, free, vertex[edges])]
    found = Diagonals(edges if rest is polygons else vertex[edges], verdict, short)
    if smallest is not None:
        own = np.flatnonzero(verdict == "")
        unit = polygons.unit[own]
        least = smallest[own] / unit / unit
        ways, number = None, None
        if gates is not None:
            ways, number = _over_islands(gates, polygons, component, vertex)
        chosen = natural(rest, edges, triangles, position, measure, least, ways)
        if short is not None:
            good = large_places(rest, short, measure, least)
            if only_natural:
                good &= concave_places(rest, short, chosen.outline)
            short = Places(*(x[good] for x in short))
        edge_length = np.full(len(polygons.vertex), np.nan)
        edge_length[corner] = chosen.edge_length * np.repeat(unit, np.diff(rest.corner_offsets))
        found = found._replace(why=chosen.why, share=chosen.share, edge_length=edge_length)
        if ways is not None and chosen.way.any():
            found = _with_gates(found, vertex[ways.ends], number, chosen)
    if short is None:
        return found
    return found._replace(places=short._replace(apex=vertex[short.apex], edge=corner[short.edge]))


def _over_islands(gates, polygons, component, vertex):
    """The gates as `natural` wants them, by the vertices that are left, and their numbers."""
    back = np.full(len(polygons.xy), -1)
    back[vertex] = np.arange(len(vertex))
    ends = back[np.column_stack((gates.vertex[gates.offsets[:-1]], gates.vertex[gates.offsets[1:] - 1]))]
    number = np.flatnonzero((ends >= 0).all(axis=1))  # the others' polygons could not be triangulated
    index, offsets = take(gates.offsets, number)
    island = np.empty(len(polygons.xy), dtype=np.int64)
    island[polygons.vertex] = component[polygons.ring_of_corner]
    island[vertex] = -1
    way = gates.vertex[index]
    return Ways(ends[number], polygons.xy[way], island[way], offsets), number


def _with_gates(found, ends, number, chosen):
    """With the gates that are candidates among the diagonals."""
    own = np.flatnonzero(chosen.way)
    edges = np.concatenate((found.edges, ends[own]))
    order = np.lexsort((-edges[:, 1], edges[:, 0]))
    gate = np.append(np.full(len(found.edges), -1), number[own])
    why = np.append(found.why, np.full(len(own), KEPT, dtype=found.why.dtype))
    share = np.append(found.share, chosen.way_share[own])
    return found._replace(edges=edges[order], why=why[order], share=share[order], gate=gate[order])


def clear(polygons: Polygons, free: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Find the edges that meet none of the rings that are left out.

    Parameters
    ----------
    polygons : Polygons
    free : (r,) bool
        The rings left out.
    edges : (k, 2) int
        Those of a polygon together, in the order of the polygons.

    Returns
    -------
    (k,) bool

    Examples
    --------
    One diagonal of a square leads across a hole.

    >>> from isthmus.core.partition.polygon import one
    >>> xy = np.array([[0, 0], [9, 0], [9, 9], [0, 9], [4, 4], [4, 5], [5, 4.0]])
    >>> square = one(xy, [0, 4, 7])
    >>> clear(square, np.array([False, True]), np.array([[0, 2], [0, 1]])).tolist()
    [False, True]
    """
    owner = polygons.polygon_of_vertex[edges[:, 0]]
    bounds = np.searchsorted(owner, np.arange(len(polygons.unit) + 1))
    clear = np.ones(len(edges), dtype=bool)
    for p in np.unique(polygons.polygon_of_ring[free]).tolist():
        ring = np.arange(*polygons.polygon_offsets[p : p + 2])
        index, offsets = take(polygons.offsets, ring[free[ring]])
        holes = shapes(polygons.xy[polygons.vertex[index]], offsets, np.arange(len(offsets)))
        lines = shapely.linestrings(polygons.xy[edges[bounds[p] : bounds[p + 1]]])
        hit, _ = shapely.STRtree(holes).query(lines, predicate="intersects")
        clear[bounds[p] + hit] = False
    return clear


def counted(
    polygons: Polygons, component: np.ndarray, equal_area: Callable, min_hole: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Find the boundary components that count, and the vertices where cuts may end.

    Parameters
    ----------
    polygons : Polygons
    component : (r,) int
        Component of each ring.
    equal_area : callable
        See `metric.Metric`.
    min_hole : (p,) float
        Holes with a smaller area do not count, unless they touch a ring that does.

    Returns
    -------
    wanted : (r,) bool
        Whether a component, by its number, counts.
    attachable : (n,) bool
        Vertices on a ring that counts by itself.

    Examples
    --------
    A hole of half a square metre does not count where the smallest that does is of one.

    >>> from isthmus.core.metric import planar
    >>> from isthmus.core.partition.polygon import from_rings
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [9, 0], [9, 9], [0, 9], [4, 4], [4, 5], [5, 4.0]])
    >>> polygon, _ = from_rings(one_polygon(xy, [0, 4, 7]))
    >>> wanted, attachable = counted(polygon, np.arange(2), planar().equal_area, np.ones(1))
    >>> wanted.tolist(), attachable.tolist()
    ([True, False], [True, True, True, True, False, False, False])
    """
    wanted = np.zeros(len(component), dtype=bool)
    attachable = np.ones(len(polygons.xy), dtype=bool)
    if not (min_hole > 0.0).any() or len(component) == len(polygons.unit):
        wanted[component] = True
        return wanted, attachable
    of_ring = polygons.polygon_of_ring
    unit = polygons.unit[of_ring]
    xy = equal_area(polygons.xy)
    area = np.abs(signed_areas(xy[polygons.vertex], polygons.offsets))
    with np.errstate(over="ignore"):
        counts = area * unit * unit >= min_hole[of_ring]
    counts[polygons.polygon_offsets[:-1]] = True
    # a corner inserted where a small hole touches an edge is a vertex of that hole alone
    alone = np.bincount(polygons.vertex, minlength=len(polygons.xy))[polygons.vertex] == 1
    own = counts[polygons.ring_of_corner] & (alone | ~polygons.inserted)
    attachable[:] = False
    attachable[polygons.vertex[own]] = True
    attachable |= (min_hole <= 0.0)[polygons.polygon_of_vertex]
    wanted[component[counts]] = True
    return wanted, attachable


def _nearest_vertices(xy, lines):
    """(l, 2): the vertex at each end, or -1."""
    lines = lines.reshape(-1, 2)
    points = shapely.points(np.where(np.isfinite(lines), lines, np.inf))  # GEOS fails on NaN
    place, vertex = shapely.STRtree(shapely.points(xy)).query_nearest(
        points, max_distance=TOLERANCE * max(np.abs(xy).max(), 1e-300), all_matches=False
    )
    ends = np.full(len(points), -1)
    ends[place] = vertex
    return ends.reshape(-1, 2)


def _against_polygon(polygon, segments):
    """Whether the interior of each segment lies in the interior of the polygon."""
    (shape,) = shapes(polygon.xy[polygon.vertex], polygon.offsets, polygon.polygon_offsets)
    shapely.prepare(shape)
    inside = shapely.covers(shape, segments)
    verdict = np.where(inside, TOUCHES, LEAVES)
    # DE-9IM, polygon against line: the line's interior meets neither boundary nor exterior
    inside[inside] = shapely.relate_pattern(shape, segments[inside], "1**F**F**")
    verdict[inside] = ACCEPTED
    return verdict


def _crossings(one, other):
    """Pairs of segments that cross: lists of places in the one and in the other array."""
    boxes = (shapely.box(*segments.min(axis=1).T, *segments.max(axis=1).T) for segments in (other, one))
    tree, boxes = shapely.STRtree(next(boxes)), next(boxes)
    a, b = tree.query(boxes)
    cross = crossing(one[a], other[b])
    return a[cross].tolist(), b[cross].tolist()


def _complex(xy):
    """Points as complex numbers, which numpy sorts by x, then y."""
    return np.ascontiguousarray(xy).view(np.complex128).ravel()
