"""One triangulation of the whole frame: a map is carried by a piecewise linear map of it.

Where every triangle keeps its orientation, and the outline of the frame goes to a rectangle, the
piecewise linear map is one to one: nothing crosses, nests or folds that did not before. (Around each inner
vertex the triangles go around once, so the map is a local homeomorphism; its degree is one, as that of
the outline is: Floater, One-to-one piecewise linear mappings over triangulations, 2003; Lipman, Bijective
mappings of meshes with boundary and the degree in mesh processing, 2014.) The orientation is tested
exactly, where the points will be, before there is a result (`turned`, `crossed`).

That another triangulation of the same points keeps its orientation, too, is not needed for this, and
does not follow: of a square, which is as good with either diagonal, a corner may go beyond the one that
is not there. So that it does not, see `others`, is a matter of looks.
"""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np
import shapely

from ..errors import MissingEngine, Sentence, Unsolvable
from ..partition.triangulation import engine_name, missing_packages
from ..predicates import crossing, orientations
from .graph import components, unique_pairs

__all__ = ["Noded", "cross", "crossed", "flatness", "frame_triangles", "heights", "node", "others", "turned"]

TOO_FINE = Sentence("the map could not be triangulated (too fine for double precision)")
SNAP = 1e-10  # of the map's width: points and lines nearer than this touch
FLAT = 1e-11  # height of a triangle that lies between points on one line, but for rounding
ROUND = 1e-9  # how far off a circle four points may be, in its width, to count as on it
ROUNDS = 8  # of splitting edges; one or two are enough but for rounding


class Noded(NamedTuple):
    """A graph whose edges meet at vertices only.

    Attributes
    ----------
    xy : (n, 2) float
        The vertices given, then the crossings.
    edges : (m, 2) int
        Pairs u < v, each once.
    splits : (s, 3) int
        Edge of the input (its ends u < v) and the vertex that lies on it, in order from u to v.
    """

    xy: np.ndarray
    edges: np.ndarray
    splits: np.ndarray


def node(xy: np.ndarray, edges: np.ndarray, check: Callable, gap: float = 0.0) -> Noded:
    """Split edges where a vertex lies on them, or where they cross.

    Parameters
    ----------
    xy : (n, 2) float
        Of about size 1, no two points closer than `SNAP`.
    edges : (m, 2) int
        Pairs u < v, each once.
    check : callable
        Called now and then; may raise `Cancelled`.
    gap : float
        If more than `SNAP`: edges are also split beside vertices that are nearer than this. Then
        each sliver has short edges across it.

    Returns
    -------
    Noded

    Notes
    -----
    O(m log m) for the short edges of a map.

    Examples
    --------
    Two edges that cross get a vertex there.

    >>> xy = np.array([(0, 0), (1, 1), (0, 1), (1, 0.0)])
    >>> noded = node(xy, np.array([(0, 1), (2, 3)]), lambda: None)
    >>> noded.xy[4:].tolist()
    [[0.5, 0.5]]
    >>> noded.edges.tolist()
    [[0, 4], [1, 4], [2, 4], [3, 4]]
    >>> noded.splits.tolist()
    [[0, 1, 4], [2, 3, 4]]
    """
    given = edges
    parent = np.arange(len(edges))
    fresh = np.ones(len(edges), dtype=bool)
    for _ in range(ROUNDS):
        check()
        edge, at, xy = _meetings(xy, edges, fresh)
        if not len(edge) and gap > SNAP:
            (edge, at, xy), gap = _feet(xy, edges, gap), 0.0
        if not len(edge):
            break
        pieces, owner = _split(xy, edges, edge, at)
        touched = np.zeros(len(edges), dtype=bool)
        touched[edge] = True
        edges = np.concatenate((edges[~touched], pieces))
        parent = np.concatenate((parent[~touched], parent[owner]))
        fresh = np.arange(len(edges)) >= np.count_nonzero(~touched)
    splits = _splits(xy, given, edges, parent)
    return Noded(xy, unique_pairs(edges, len(xy)), splits)


def _meetings(xy, edges, fresh):
    """Edges and the vertices on them: those that are there, and new ones where edges cross."""
    ends = xy[edges]
    low, high = ends.min(axis=1) - SNAP, ends.max(axis=1) + SNAP
    few = np.flatnonzero(fresh)
    tree = shapely.STRtree(shapely.linestrings(ends))
    a, b = tree.query(shapely.box(*low[few].T, *high[few].T))
    a = few[a]
    once = (a != b) & ((a < b) | ~fresh[b])
    a, b = a[once], b[once]
    edge, vertex = [], []
    apart = np.ones(len(a), dtype=bool)
    for one, other in ((a, b), (b, a)):
        for end in (0, 1):
            p = edges[one, end]
            on = _lies_on(xy, p, edges[other])
            edge.append(other[on])
            vertex.append(p[on])
            apart &= ~on & (p != edges[other, 0]) & (p != edges[other, 1])
    a, b = a[apart], b[apart]
    real = crossing(ends[a], ends[b])
    a, b = a[real], b[real]
    if len(a):
        p, q, r, s = ends[a, 0], ends[a, 1], ends[b, 0], ends[b, 1]
        d, e = q - p, s - r
        t = cross(r - p, e) / cross(d, e)
        points = p + np.clip(t, 0.0, 1.0)[:, None] * d
        number, xy = _vertices_at(xy, points)
        edge += [a, b]
        vertex += [number, number]
    edge, vertex = np.concatenate(edge), np.concatenate(vertex)
    inner = (edges[edge] != vertex[:, None]).all(axis=1)
    return edge[inner], vertex[inner], xy


def _feet(xy, edges, gap):
    """Edges and new vertices on them, each beside a vertex that is near."""
    tree = shapely.STRtree(shapely.linestrings(xy[edges]))
    vertex, edge = tree.query(shapely.points(xy), predicate="dwithin", distance=gap)
    own = (edges[edge] == vertex[:, None]).any(axis=1)
    vertex, edge = vertex[~own], edge[~own]
    start, along = xy[edges[edge, 0]], xy[edges[edge, 1]] - xy[edges[edge, 0]]
    length = np.hypot(*along.T)
    t = ((xy[vertex] - start) * along).sum(axis=1) / length**2
    inside = (t * length > gap) & ((1.0 - t) * length > gap)
    number, xy = _vertices_at(xy, (start + t[:, None] * along)[inside])
    return edge[inside], number, xy


def _lies_on(xy, p, edges):
    """Whether vertices lie on edges, apart from their ends."""
    u, v = xy[edges[:, 0]], xy[edges[:, 1]]
    along = v - u
    gap = xy[p] - u
    square = np.maximum((along * along).sum(axis=1), 1e-300)
    t = (gap * along).sum(axis=1) / square
    off = np.abs(cross(gap, along)) / np.sqrt(square)
    return (p != edges[:, 0]) & (p != edges[:, 1]) & (t > 0.0) & (t < 1.0) & (off <= SNAP)


def _vertices_at(xy, points):
    """The vertex at each point, there already or new, those nearly the same once; and all vertices."""
    from scipy.spatial import cKDTree

    off, vertex = cKDTree(xy).query(points) if len(points) else (np.empty(0), np.empty(0, dtype=np.int64))
    new = np.flatnonzero(off > SNAP)
    if not len(new):
        return vertex, xy
    near = cKDTree(points[new]).query_pairs(SNAP, output_type="ndarray")
    same = components(len(new), near) if len(near) else np.arange(len(new))
    vertex[new] = len(xy) + same
    first = np.unique(same, return_index=True)[1]
    return vertex, np.concatenate((xy, points[new[first]]))


def _split(xy, edges, edge, at):
    """The pieces of edges, and the edge that each is of."""
    key = np.unique(edge * len(xy) + at)
    edge, at = key // len(xy), key % len(xy)
    u, v = edges[edge].T
    along = xy[v] - xy[u]
    t = ((xy[at] - xy[u]) * along).sum(axis=1) / (along * along).sum(axis=1)
    which = np.unique(edge)
    owner = np.concatenate((edge, which, which))
    vertex = np.concatenate((at, edges[which, 0], edges[which, 1]))
    place = np.concatenate((t, np.full(len(which), -np.inf), np.full(len(which), np.inf)))
    order = np.lexsort((place, owner))
    owner, vertex = owner[order], vertex[order]
    same = owner[1:] == owner[:-1]
    return np.sort(np.column_stack((vertex[:-1], vertex[1:]))[same], axis=1), owner[:-1][same]


def _splits(xy, given, edges, parent):
    """Vertices on the edges given, in order."""
    pieces = np.bincount(parent, minlength=len(given))[parent] > 1
    vertex, owner = edges[pieces].ravel(), np.repeat(parent[pieces], 2)
    inner = (vertex != given[owner, 0]) & (vertex != given[owner, 1])
    key = np.unique(owner[inner] * len(xy) + vertex[inner])
    owner, vertex = key // len(xy), key % len(xy)
    u, v = given[owner].T
    t = ((xy[vertex] - xy[u]) * (xy[v] - xy[u])).sum(axis=1)
    order = np.lexsort((t, owner))
    return np.column_stack((given[owner], vertex))[order]


def frame_triangles(xy: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """Return a constrained Delaunay triangulation of the convex hull of points.

    Parameters
    ----------
    xy : (n, 2) float
        Distinct points.
    segments : (m, 2) int
        They meet at their ends only, and have no other points on them. If there are any, those around
        all points are among them.

    Returns
    -------
    (t, 3) int
        Counter-clockwise.

    Raises
    ------
    Unsolvable, MissingEngine

    Examples
    --------
    Of a rhombus the short diagonal is an edge of the triangulation, unless the long one is asked for.

    >>> rhombus = np.array([(0, 0), (3, -1), (6, 0), (3, 1.0)])
    >>> none = np.empty((0, 2), dtype=int)
    >>> sorted(np.sort(frame_triangles(rhombus, none), axis=1).tolist())
    [[0, 1, 3], [1, 2, 3]]
    >>> segments = np.array([(0, 1), (1, 2), (2, 3), (0, 3), (0, 2)])
    >>> sorted(np.sort(frame_triangles(rhombus, segments), axis=1).tolist())
    [[0, 1, 2], [0, 2, 3]]
    """
    name = engine_name()
    if not name:
        raise MissingEngine(missing_packages())
    call = {"triangle": _by_triangle, "pythoncdt": _by_pythoncdt, "shapely": _by_shapely}[name]
    triangles = call(xy, segments)
    if triangles is None:
        raise Unsolvable(TOO_FINE)
    return _counter_clockwise(xy, triangles)


def _by_triangle(xy, segments):
    import triangle

    graph = {"vertices": xy}
    if len(segments):
        graph["segments"] = segments.astype(np.int32)
    try:
        found = triangle.triangulate(graph, "pQBP" if len(segments) else "QBP")
    except RuntimeError:  # its own checks failed
        return None
    return found["triangles"].astype(np.int64) if len(found["vertices"]) == len(xy) else None


def _by_pythoncdt(xy, segments):
    import pythoncdt

    try:
        found = pythoncdt.Triangulation(
            pythoncdt.VertexInsertionOrder.AUTO, pythoncdt.IntersectingConstraintEdges.NOT_ALLOWED, 0.0
        )
        found.insert_vertices(np.ascontiguousarray(xy))
        found.insert_edges(segments.astype(np.uintc))
        triangles = np.array(found.triangles_array(copy=True)["vertices"], dtype=np.int64)
    except (RuntimeError, ValueError):
        return None
    return triangles[(triangles > 2).all(axis=1)] - 3  # the first three are its own


def _by_shapely(xy, segments):
    """GEOS triangulates polygons: the faces between the segments and the Delaunay edges that cross none.

    Those edges are part of the constrained triangulation. Points inside a face are joined to near ones that
    they see, so that there the triangulation need not be Delaunay's.
    """
    points = np.ascontiguousarray(xy).view(np.complex128).ravel()  # in numpy's lexicographic order
    order = np.argsort(points)

    def vertices(found):
        at = np.searchsorted(points, shapely.get_coordinates(found).view(np.complex128).ravel(), sorter=order)
        return order[np.minimum(at, len(order) - 1)]

    try:
        lines = shapely.get_parts(shapely.delaunay_triangles(shapely.multipoints(xy), only_edges=True))
        edges = unique_pairs(vertices(lines).reshape(-1, 2), len(xy))
        tree = shapely.STRtree(shapely.linestrings(xy[segments]))
        a, b = tree.query(shapely.linestrings(xy[edges]), predicate="crosses")
        wrong = crossing(xy[edges[a]], xy[segments[b]])
        edges = np.concatenate((segments, np.delete(edges, a[wrong], axis=0)))
        while True:
            edges = unique_pairs(edges, len(xy))
            faces = shapely.get_parts(shapely.polygonize(shapely.linestrings(xy[edges])))
            inside = np.setdiff1d(np.arange(len(xy)), vertices(faces))
            more = _bridges(xy, edges, inside)
            if not len(more):
                break
            edges = np.concatenate((edges, more))
        large = shapely.get_num_coordinates(faces) > 4
        parts = shapely.get_parts(shapely.constrained_delaunay_triangles(faces[large]))
    except shapely.errors.GEOSException:
        return None
    return vertices(np.concatenate((faces[~large], parts))).reshape(-1, 4)[:, :3]


def _bridges(xy, edges, inside, most=200):
    """Up to three edges from some points to near ones that they see: through no point, across no edge.

    O(``most`` n) a point, and there are few.
    """
    given = len(edges)
    for v in inside.tolist():
        before = len(edges)
        for w in np.argsort(np.hypot(*(xy - xy[v]).T))[1 : most + 1].tolist():
            there = (np.sort(edges, axis=1) == sorted((v, w))).all(axis=1)
            through = orientations(*(np.broadcast_to(xy[k], xy.shape) for k in (v, w)), xy) == 0
            through &= ((xy - xy[v]) * (xy - xy[w])).sum(axis=1) <= 0.0
            through[[v, w]] = False
            across = crossing(np.broadcast_to(xy[[v, w]], (len(edges), 2, 2)), xy[edges])
            if not (there.any() or through.any() or across.any()):
                edges = np.concatenate((edges, [(v, w)]))
                if len(edges) == before + 3:
                    break
    return edges[given:]


def _counter_clockwise(xy, triangles):
    a, b, c = xy[triangles].transpose(1, 0, 2)
    sign = orientations(a, b, c)
    triangles = np.where((sign < 0)[:, None], triangles[:, ::-1], triangles)
    if (sign == 0).any() or len(np.unique(triangles)) < len(xy):
        raise Unsolvable(TOO_FINE)
    return triangles


def others(xy: np.ndarray, triangles: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return triangles that stay upright only if all other Delaunay triangulations do.

    Of a square each diagonal is as good as the other, and a map of many squares, as made from a raster,
    has many Delaunay triangulations: each triangulates the polygons of points on a circle in its way. A
    piecewise linear map of one may turn triangles of another. It turns none if and only if these polygons
    stay convex: the map is one to one, so each of them stays a simple polygon, and that is convex if it turns
    left at each corner, which is what three corners in sequence tell. Then each triangle of its corners is
    upright.

    Parameters
    ----------
    xy : (n, 2) float
    triangles : (t, 3) int
        Counter-clockwise.
    edges : (m, 2) int
        Pairs u < v that all triangulations have.

    Returns
    -------
    (q, 3) int
        Counter-clockwise.

    Notes
    -----
    O(t log t).

    Examples
    --------
    A square cut along one diagonal stays convex if the triangles beside the other stay upright, too.

    >>> square = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)])
    >>> halves, sides = np.array([(0, 1, 2), (0, 2, 3)]), np.array([(0, 1), (1, 2), (2, 3), (0, 3)])
    >>> others(square, halves, sides).tolist()
    [[0, 1, 2], [1, 2, 3], [2, 3, 0], [3, 0, 1]]
    """
    n = len(xy)
    side = np.concatenate([np.roll(triangles, -k, axis=1) for k in range(3)])  # an edge, what is opposite
    key = np.sort(side[:, :2], axis=1) @ (n, 1)
    order = np.argsort(key, kind="stable")
    twin = np.flatnonzero(key[order][1:] == key[order][:-1])
    twin = twin[~np.isin(key[order][twin], edges @ (n, 1))]
    one, other = order[twin], order[twin + 1]
    a, b, c, d = (xy[k] for k in (*side[one].T, side[other, 2]))
    sides = (b - a, c - a, c - b, d - a, d - b)
    width = np.maximum.reduce([(one * one).sum(axis=1) for one in sides])
    lift = np.stack([np.column_stack((p - d, ((p - d) ** 2).sum(axis=1))) for p in (a, b, c)], axis=1)
    round_ = np.abs(np.linalg.det(lift)) <= ROUND * width**2
    t = len(triangles)
    face = components(t, np.column_stack((one, other))[round_] % t).astype(np.int64)
    face = np.where(np.bincount(face)[face] > 1, face, -1)
    key = np.unique((face[:, None] * n + triangles)[face >= 0])
    face, vertex = key // n, key % n
    count = np.bincount(face)
    middle = np.column_stack([np.bincount(face, xy[vertex, axis]) for axis in (0, 1)])
    arm = xy[vertex] - middle[face] / count[face][:, None]
    vertex = vertex[np.lexsort((np.arctan2(arm[:, 1], arm[:, 0]), face))]
    last = np.cumsum(count)[face] - 1
    place = np.arange(len(vertex))
    after = np.where(place < last, place + 1, place - count[face] + 1)
    found = np.column_stack((vertex, vertex[after], vertex[after[after]]))
    return found[heights(xy, found) > FLAT]


def turned(before: np.ndarray, after: np.ndarray, triangles: np.ndarray, flat: float = FLAT) -> np.ndarray:
    """Return which triangles are not counter-clockwise after, exact; flat ones do not count.

    Parameters
    ----------
    before, after : (n, 2) float
    triangles : (t, 3) int
        Counter-clockwise before.
    flat : float
        The height of a flat triangle, as a share of the width of all.

    Examples
    --------
    The top of the second of two triangles is pulled down through its base.

    >>> before = np.array([(0, 0), (4, 0), (2, 1), (2, 2.0)])
    >>> after = np.array([(0, 0), (4, 0), (2, 1), (2, 0.5)])
    >>> turned(before, after, np.array([(0, 1, 2), (1, 3, 2)])).tolist()
    [False, True]
    """
    a, b, c = after[triangles].transpose(1, 0, 2)
    wrong = np.flatnonzero(orientations(a, b, c) <= 0)
    found = np.zeros(len(triangles), dtype=bool)
    least = max(flatness(before, flat), flatness(after, 0.0))
    found[wrong] = heights(before, triangles[wrong]) > least
    return found


def crossed(before: np.ndarray, after: np.ndarray, triangles: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return which turned triangles, flat ones included, have edges that cross in them, and did not; exact.

    Where two points of a map come to lie on each other, some triangle is turned that has the place in it.
    So if none of the flat ones that `turned` does not count is found here, no edges cross at all.

    Parameters
    ----------
    before, after : (n, 2) float
    triangles : (t, 3) int
        Counter-clockwise before, but for rounding.
    edges : (m, 2) int
        They are edges of triangles.

    Examples
    --------
    A point goes from one side of a line to the other, and takes the end of another line with it.

    >>> before = np.array([(0, 0), (4, 0), (2, 1), (2, 2.0)])
    >>> after, flat = np.array([(0, 0), (4, 0), (2, -1), (2, 2.0)]), np.array([(0, 1, 2)])
    >>> crossed(before, after, flat, np.array([(0, 1), (2, 3)])).tolist()
    [True]
    >>> crossed(before, after, flat, np.array([(0, 1), (1, 3)])).tolist()
    [False]
    """
    found = np.zeros(len(triangles), dtype=bool)
    wrong = np.flatnonzero(orientations(*after[triangles].transpose(1, 0, 2)) <= 0)
    if not len(wrong) or not len(edges):
        return found
    tree = shapely.STRtree(shapely.linestrings(after[edges]))
    corners = after[triangles[wrong]]
    place = shapely.convex_hull(
        shapely.multipoints(corners.reshape(-1, 2), indices=np.repeat(np.arange(len(wrong)), 3))
    )
    near = np.full(len(wrong), flatness(after))
    number, edge = tree.query(place, predicate="dwithin", distance=near)
    for k in range(len(wrong)):
        mine = edge[number == k]
        one, other = np.triu_indices(len(mine), 1)
        one, other = edges[mine[one]], edges[mine[other]]
        found[wrong[k]] = (crossing(after[one], after[other]) & ~crossing(before[one], before[other])).any()
    return found


def flatness(xy: np.ndarray, flat: float = FLAT) -> float:
    """Return the height of what is flat to these coordinates: far from the origin they tell less apart.

    Parameters
    ----------
    xy : (n, 2) float
    flat : float
        As a share of their width.

    Examples
    --------
    A square of size 1, and the same far from the origin:

    >>> square = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)])
    >>> flatness(square), flatness(square + 1e7) > 1e-9
    (1e-11, True)
    """
    rounding = 4.0 * np.finfo(float).eps * np.abs(xy).max(initial=0.0)
    return float(max(flat * np.ptp(xy, axis=0).max(initial=0.0), rounding)) if len(xy) else 0.0


def heights(xy: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return the least height of each triangle, negative if it is clockwise.

    Examples
    --------
    A triangle whose sides are 3, 4 and 5 long, counter-clockwise and clockwise:

    >>> heights(np.array([(0, 0), (4, 0), (0, 3.0)]), np.array([(0, 1, 2), (0, 2, 1)])).round(3).tolist()
    [2.4, -2.4]
    """
    a, b, c = xy[triangles].transpose(1, 0, 2)
    longest = np.maximum.reduce([np.hypot(*(q - p).T) for p, q in ((a, b), (b, c), (c, a))])
    return cross(b - a, c - a) / np.maximum(longest, 1e-300)


def cross(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the (k,) cross products of (k, 2) vectors: twice the area of the triangles that they span.

    Examples
    --------
    >>> cross(np.array([(2, 0), (0, 1.0)]), np.array([(0, 3), (1, 0.0)])).tolist()
    [6.0, -1.0]
    """
    return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
