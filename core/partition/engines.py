"""The engines that triangulate: constrained Delaunay triangulations of polygons, by others' code.

* ``triangle``: Shewchuk's Triangle. Its licence forbids commercial use, so it is imported where it is
  installed and never shipped.
* ``pythoncdt``: the CDT library by A. Amirkhanov (MPL-2.0).
* ``shapely``: GEOS, from shapely 2.1 on; several times slower.

All give a constrained Delaunay triangulation; where four corners lie on a circle they may choose
different diagonals. The first two crash or hang on some input that is no polygon: only polygons that have
passed `polygon.from_rings` may come here. No answer is checked but for what an engine is known to do
wrong: `triangulation` checks them all.
"""

from __future__ import annotations

import ctypes
import os
from functools import cache
from typing import Callable

import numpy as np
import shapely

from ..predicates import orientations
from ..progress import ignore
from ..rings import groups, offsets_of, shapes, spread

__all__ = ["ENGINES", "engine_name", "engine_names", "only_engine", "triangulate"]

VARIABLE = "ISTHMUS_ENGINE"
CALLS = 256  # of an engine, between two checks for a cancel
DIRECT = ("20230923", "20250106")  # versions of Triangle's package whose library may be called itself
ENGINES = ("triangle", "pythoncdt", "shapely")


def only_engine() -> str:
    """Return the engine that the environment variable ISTHMUS_ENGINE asks for, or ''.

    For tests, and for those who may not use Triangle though it is installed.

    Examples
    --------
    >>> from unittest.mock import patch
    >>> with patch.dict("os.environ", ISTHMUS_ENGINE="shapely"):
    ...     only_engine()
    'shapely'
    """
    return os.environ.get(VARIABLE, "")


def engine_names() -> list[str]:
    """Return the engines that are installed (and asked for, see `only_engine`), the one to prefer first.

    Examples
    --------
    In the order of `ENGINES`; none where one is asked for that there is not.

    >>> from unittest.mock import patch
    >>> engine_names() == [name for name in ENGINES if name in engine_names()]
    True
    >>> with patch.dict("os.environ", ISTHMUS_ENGINE="abacus"):
    ...     engine_names()
    []
    """
    only = only_engine()
    return [name for name in ENGINES if only in ("", name) and _installed(name)]


def engine_name() -> str:
    """Return the engine to prefer, or '' where none is installed.

    Examples
    --------
    >>> [engine_name()] == engine_names()[:1]
    True
    """
    return next(iter(engine_names()), "")


def triangulate(
    engine: str,
    xy: np.ndarray,
    vertex_offsets: np.ndarray,
    segments: np.ndarray,
    segment_offsets: np.ndarray,
    check: Callable = ignore,
) -> tuple[np.ndarray, np.ndarray]:
    """Triangulate many polygons, each by itself.

    Parameters
    ----------
    engine : {'triangle', 'pythoncdt', 'shapely'}
    xy : (n, 2) float
        The vertices of all polygons, those of a polygon distinct.
    vertex_offsets : (p + 1,) int
        Where the vertices of each polygon start.
    segments : (c, 2) int
        Vertices at the ends of each ring edge, the inside on the left; ring after ring, the shell first.
    segment_offsets : (p + 1,) int
    check : callable, optional
        Called now and then with the share done; may raise `Cancelled`.

    Returns
    -------
    triangles : (m, 3) int
        Vertices of the triangles, counter-clockwise.
    offsets : (p + 1,) int
        Where the triangles of each polygon start; it has none where the engine fails.

    Notes
    -----
    O(n log n) for each polygon of n vertices.

    Examples
    --------
    >>> xy = np.array([[0, 0], [9, 0], [0, 9], [0, 0], [3, 0], [4, 1], [0, 2]], dtype=float)
    >>> ends = np.array([[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 6], [6, 3]])
    >>> triangulate(engine_name(), xy, [0, 3, 7], ends, [0, 3, 7])[1]
    array([0, 1, 3])
    """
    vertex_offsets, segment_offsets = np.asarray(vertex_offsets), np.asarray(segment_offsets)
    xy = np.ascontiguousarray(xy, dtype=float)
    if len(vertex_offsets) == 1:
        return np.empty((0, 3), dtype=np.int64), np.zeros(1, dtype=np.int64)
    call = {"triangle": _by_triangle, "pythoncdt": _by_pythoncdt, "shapely": _by_shapely}[engine]
    return call(xy, vertex_offsets, segments, segment_offsets, check)


def _installed(name):
    if name == "shapely":
        return hasattr(shapely, "constrained_delaunay_triangles")
    try:
        __import__(name)
    except ImportError:
        return False
    return True


def _survives(xy, vertex_offsets):
    """Polygons whose coordinates the engines' arithmetic can multiply by fours: at 1e-70 that underflows.

    Then Triangle crashes, and CDT hangs.
    """
    magnitude = np.abs(xy)
    tiny = (magnitude < 1e-70) & (magnitude > 0.0)
    wanted = np.ones(len(vertex_offsets) - 1, dtype=bool)
    if tiny.any():
        tiny = tiny.any(axis=1)
        wanted[np.searchsorted(vertex_offsets, np.flatnonzero(tiny), side="right") - 1] = False
    return wanted


def _local(vertex_offsets, segments, segment_offsets, dtype):
    """The segments of each polygon by the numbers of its own vertices."""
    shift = spread(vertex_offsets[:-1], segment_offsets)
    return (segments - shift[:, None]).astype(dtype, order="C")


def _ring_offsets(segments):
    """Where each ring starts among the segments: it ends where it is back at its first vertex."""
    start, end = segments.T
    broken = np.append(True, end[:-1] != start[1:])  # not where rings touch at their first vertices
    first = start[broken][np.cumsum(broken) - 1]
    return np.append(0, np.flatnonzero(end == first) + 1)


# ---------------------------------------------------------------- Triangle


# what Triangle reads and writes, of its triangle.h: counts and addresses
_LISTS = """
    pointlist pointattributelist pointmarkerlist numberofpoints numberofpointattributes
    trianglelist triangleattributelist trianglearealist neighborlist
    numberoftriangles numberofcorners numberoftriangleattributes
    segmentlist segmentmarkerlist numberofsegments holelist numberofholes regionlist numberofregions
    edgelist edgemarkerlist normlist numberofedges
""".split()
# p: with segments; z: counted from 0; Q: quiet; B, P, N: no markers, segments and vertices in the answer
_OPTIONS = "pzQBPN"
_NOTHING = np.empty(0, dtype=np.int32)


class _Lists(ctypes.Structure):
    _fields_ = [(name, ctypes.c_int if "number" in name else ctypes.c_void_p) for name in _LISTS]


def _by_triangle(xy, vertex_offsets, segments, segment_offsets, check):
    survives = _survives(xy, vertex_offsets).tolist()
    holes, hole_offsets = _hole_points(xy, segments, segment_offsets)
    segments = _local(vertex_offsets, segments, segment_offsets, np.int32)
    call = (_directly if _library() else _by_package)(xy, segments, holes)
    vertex, segment, hole = vertex_offsets.tolist(), segment_offsets.tolist(), hole_offsets.tolist()
    found = []
    for p in range(len(survives)):
        if p % CALLS == 0:
            check(p / len(survives))
        own = (vertex[p], vertex[p + 1], segment[p], segment[p + 1], hole[p], hole[p + 1])
        found.append(call(*own) if survives[p] else _NOTHING)
    size = np.array([len(corners) for corners in found]) // 3
    corners = np.concatenate(found)
    some, highest = size > 0, np.zeros(len(size), dtype=np.int64)
    highest[some] = np.maximum.reduceat(corners, 3 * (np.cumsum(size) - size)[some]) if some.any() else 0
    new = highest >= np.diff(vertex_offsets)
    corners += spread(vertex_offsets[:-1].astype(np.int32), offsets_of(3 * size))
    triangles = corners.reshape(-1, 3)
    if new.any():  # where its segments cross, it adds vertices without a word
        triangles, size = triangles[~np.repeat(new, size)], np.where(new, 0, size)
    return triangles, offsets_of(size)


def _by_package(xy, segments, holes):
    """Return the function that calls Triangle's package, for the corners of the triangles of a polygon."""
    from triangle import triangulate

    def call(v, v_end, s, s_end, h, h_end):
        graph = {"vertices": xy[v:v_end], "segments": segments[s:s_end]}
        if h < h_end:
            graph["holes"] = holes[h:h_end]
        try:
            return triangulate(graph, _OPTIONS).get("triangles", _NOTHING).ravel()
        except RuntimeError:  # its own checks failed: coordinates too close for its arithmetic
            return _NOTHING

    return call


@cache
def _library():
    """Return Triangle's library inside its Python package, or None where it cannot be called itself.

    The package makes 126 functions around each call: 13 of 19 microseconds for a building, and 12 of 105 for
    a lake of 90 vertices. Windows hides what is in a library; in other versions it may be called otherwise.
    """
    import triangle

    if triangle.__version__ not in DIRECT:
        return None
    # not CDLL: Triangle has variables of its own, so that no other thread may call it meanwhile
    library = ctypes.PyDLL(triangle.core.__file__)
    try:
        library.triangulate.restype, library.trifree.restype = ctypes.c_int, None
    except AttributeError:
        return None
    library.trifree.argtypes = [ctypes.c_void_p]
    return library


def _directly(xy, segments, holes):
    """Return the function that calls Triangle itself, as `_by_package` does through its package.

    It reads the arrays by their addresses: they must be C-contiguous, and stay as long as it is called.
    """
    triangulate, free = _library().triangulate, _library().trifree
    given, found, rest = _Lists(), _Lists(), _Lists()
    arguments = (_OPTIONS.encode(), ctypes.byref(given), ctypes.byref(found), ctypes.byref(rest))
    xy_at, segments_at, holes_at = (values.ctypes.data for values in (xy, segments, holes))

    def call(v, v_end, s, s_end, h, h_end):
        given.pointlist, given.numberofpoints = xy_at + 16 * v, v_end - v
        given.segmentlist, given.numberofsegments = segments_at + 8 * s, s_end - s
        given.holelist, given.numberofholes = holes_at + 16 * h, h_end - h
        found.trianglelist = None
        if triangulate(*arguments) or not found.trianglelist:  # not 0: its own checks failed
            return _NOTHING
        corners = ctypes.string_at(found.trianglelist, 12 * found.numberoftriangles)
        free(found.trianglelist)
        return np.frombuffer(corners, dtype=np.int32)

    return call


def _hole_points(xy, segments, segment_offsets):
    """A point in each hole, and where those of each polygon start."""
    offsets = _ring_offsets(segments)
    hole = ~np.isin(offsets[:-1], segment_offsets)
    hole_offsets = np.searchsorted(offsets[:-1][hole], segment_offsets)
    if not hole.any():
        return np.empty((0, 2)), hole_offsets
    corners = np.repeat(hole, np.diff(offsets))
    size = np.diff(offsets)[hole]
    inside = shapes(xy[segments[corners, 0]], offsets_of(size), np.arange(len(size) + 1))
    return shapely.get_coordinates(shapely.point_on_surface(inside)), hole_offsets


# ---------------------------------------------------------------- CDT

_SUPER = 3  # CDT's own vertices, before those given: a triangle around them all
_CDT_TRIANGLE = np.dtype([("vertices", "<u4", (3,)), ("neighbors", "<u4", (3,))])


def _by_pythoncdt(xy, vertex_offsets, segments, segment_offsets, check):
    import pythoncdt

    auto = pythoncdt.VertexInsertionOrder.AUTO
    no_crossings = pythoncdt.IntersectingConstraintEdges.NOT_ALLOWED
    local = _local(vertex_offsets, segments, segment_offsets, np.uintc)
    # n vertices and three around them: 2 n + 1 triangles
    offsets = offsets_of(2 * np.diff(vertex_offsets) + 1)
    raw = np.zeros(offsets[-1], dtype=_CDT_TRIANGLE)
    vertex, segment, place = vertex_offsets.tolist(), segment_offsets.tolist(), offsets.tolist()
    good = _survives(xy, vertex_offsets)
    for p in np.flatnonzero(good).tolist():
        if p % CALLS == 0:
            check(p / len(good))
        try:
            found = pythoncdt.Triangulation(auto, no_crossings, 0.0)
            found.insert_vertices(xy[vertex[p] : vertex[p + 1]])
            found.insert_edges(local[segment[p] : segment[p + 1]])
            raw[place[p] : place[p + 1]] = found.triangles_array(copy=False)
        except (RuntimeError, ValueError):  # vertices or edges that coincide or cross
            good[p] = False
    return _inner(raw, offsets, xy, vertex_offsets, segments, segment_offsets, good)


def _inner(raw, offsets, xy, vertex_offsets, segments, segment_offsets, good):
    """Of CDT's triangles those inside the polygons: its own eraser takes longer than all else.

    Inside is a triangle that has a ring edge in its direction, and its neighbours across other edges.
    Triangles without ring edges form trees of degree three, no deeper than the logarithm of their number
    (a little more around holes): a few rounds.
    """
    polygon = np.repeat(np.arange(len(good), dtype=np.int32), np.diff(offsets))
    # each polygon's vertices follow its three of CDT; three rows, as numpy takes its time for rows of three
    shift = (vertex_offsets[:-1] + _SUPER * np.arange(len(good))).astype(np.int32)
    corner = raw["vertices"].T.astype(np.int32, order="C")
    corner += shift[polygon]
    start, end = segments.T + _SUPER * (groups(segment_offsets) + 1)
    following = np.full(len(xy) + _SUPER * len(good), -1, dtype=np.int32)
    following[start] = end
    ring = np.stack([following[corner[k]] == corner[k - 2] for k in range(3)])  # edges along the ring
    several = np.bincount(start, minlength=len(following)) > 1
    if several.any():  # rings touch
        k, place = np.nonzero(several[corner])
        key = corner[k, place] * np.int64(len(following)) + corner[k - 2, place]
        ring[k, place] = np.isin(key, start * np.int64(len(following)) + end)

    neighbour = raw["neighbors"].T.astype(np.int32, order="C")
    k, place = np.nonzero(neighbour < 0)
    neighbour += offsets[:-1].astype(np.int32)[polygon]
    neighbour[k, place] = place  # none, at CDT's own triangle
    inside = ring[0] | ring[1] | ring[2]
    front = np.flatnonzero(inside)
    while len(front):
        near = np.concatenate([neighbour[k].take(front[~ring[k].take(front)]) for k in range(3)])
        near = near[~inside.take(near)]
        inside[near] = True
        front = np.unique(near)

    # input that only looked valid may come back turned over, or open to the outside
    polygon = polygon[inside]
    triangles = corner[:, inside] - _SUPER * (polygon + 1)
    lowest = np.minimum(np.minimum(triangles[0], triangles[1]), triangles[2])
    wrong = orientations(*(xy.take(corners, axis=0, mode="clip") for corners in triangles)) <= 0
    wrong |= lowest < vertex_offsets[polygon]
    good = good & (np.bincount(polygon[wrong], minlength=len(good)) == 0)
    if not good.all():
        triangles, polygon = triangles[:, good[polygon]], polygon[good[polygon]]
    return np.ascontiguousarray(triangles.T), offsets_of(np.bincount(polygon, minlength=len(good)))


# ---------------------------------------------------------------- GEOS


def _by_shapely(xy, vertex_offsets, segments, segment_offsets, check):
    """GEOS joins holes from the left; where they touch, it fails now and then, but not mirrored."""
    count = len(vertex_offsets) - 1
    found = [np.empty((0, 3), dtype=np.int64)]
    owner = [np.empty(0, dtype=np.int64)]
    waiting = np.arange(count)
    for flip in ((1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
        if not len(waiting):
            break
        mirrored = xy * flip + 0.0
        shapes = _shapes(mirrored, segments, segment_offsets)[waiting]
        answers = []
        for k in range(0, len(shapes), CALLS):
            check(k / count if len(waiting) == count else None)
            answers.append(_by_geos(shapes[k : k + CALLS]))
        answers = np.concatenate(answers)
        parts, polygon = shapely.get_parts(answers, return_index=True)
        polygon = waiting[polygon]
        triangles = _vertices_at(
            shapely.get_coordinates(parts).reshape(-1, 4, 2)[:, :3], polygon, mirrored, vertex_offsets
        )
        found.append(triangles if flip[0] * flip[1] < 0.0 else triangles[:, ::-1])
        owner.append(polygon)
        waiting = waiting[shapely.is_missing(answers)]
    triangles, owner = np.concatenate(found), np.concatenate(owner)
    if count > 1:
        triangles = triangles[np.argsort(owner, kind="stable")]
    return triangles, offsets_of(np.bincount(owner, minlength=count))


def _by_geos(shapes):
    """Triangulations, or None where GEOS fails."""
    try:
        return shapely.constrained_delaunay_triangles(shapes)
    except shapely.errors.GEOSException:
        if len(shapes) == 1:
            return np.array([None])
    return np.concatenate([_by_geos(shapes[k : k + 1]) for k in range(len(shapes))])


def _shapes(xy, segments, segment_offsets):
    """The polygons."""
    offsets = _ring_offsets(segments)
    return shapes(xy[segments[:, 0]], offsets, np.searchsorted(offsets[:-1], segment_offsets))


def _vertices_at(corners, polygon, xy, vertex_offsets):
    """The vertices of each triangle's polygon at its corners: GEOS returns coordinates as they were."""
    # as complex numbers, points have numpy's lexicographic order
    points, corners = (np.ascontiguousarray(x).view(np.complex128).ravel() for x in (xy, corners))
    if len(vertex_offsets) == 2:
        order = np.argsort(points)
        place = np.searchsorted(points, corners, sorter=order)
    else:  # polygons may share points
        site, number = np.unique(points, return_inverse=True)
        key = groups(vertex_offsets) * len(site) + number.ravel()
        order = np.argsort(key)
        wanted = np.repeat(polygon * len(site), 3) + np.searchsorted(site, corners)
        place = np.searchsorted(key, wanted, sorter=order)
    return order[np.minimum(place, len(order) - 1)].reshape(-1, 3)
