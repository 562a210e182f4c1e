"""Second stage: the diagonals of constrained Delaunay triangulations.

By the first of the `engines` that is installed, and by the next where it fails. Some crash or hang on
invalid input, so only polygons that have passed `polygon.from_rings` may come here, and every answer is
checked. The engine's own call is the only loop over polygons.
"""

from __future__ import annotations

from types import ModuleType
from typing import Callable, NamedTuple

import numpy as np
import shapely

from ..errors import MissingEngine, Sentence
from ..progress import ignore
from ..rings import offsets_of, shapes, take
from . import engines
from .engines import engine_name
from .polygon import Polygons, is_valid

__all__ = [
    "Sides",
    "Triangulations",
    "diagonals",
    "engine_name",
    "missing_packages",
    "sides_of",
    "triangulate",
]

TOO_FINE = Sentence("the polygon could not be triangulated (too fine for double precision)")


def missing_packages(shapely_module: ModuleType = shapely) -> str:
    """Return what is missing in a few words, or '' if polygons can be triangulated.

    Examples
    --------
    With an old shapely it says:

    >>> from types import SimpleNamespace
    >>> missing_packages(SimpleNamespace(__version__="1.8.5"))
    'shapely 2 is needed, and 1.8.5 is installed'
    """
    version = shapely_module.__version__
    if not hasattr(shapely_module, "get_coordinates"):  # shapely 1 imports too
        return Sentence("shapely 2 is needed, and {} is installed", version)
    if not engine_name():
        only = engines.only_engine()
        if only:
            return Sentence(
                "the environment variable {} asks for {!r}, which is not installed", engines.VARIABLE, only
            )
        return Sentence("the package pythoncdt or triangle, or shapely 2.1 instead of {}, is needed", version)
    return ""


class Sides(NamedTuple):
    """The three sides of each triangle, one triangle after the other.

    Attributes
    ----------
    tail, head : (3 t,) int
        Vertices at the ends.
    boundary : (3 t,) bool
        Whether it is an edge of a polygon.
    inner : (m,) int
        The sides that are none and run upwards: each inner edge borders two triangles, and is one of these
        in one of them.
    """

    tail: np.ndarray
    head: np.ndarray
    boundary: np.ndarray
    inner: np.ndarray


class Triangulations(NamedTuple):
    """Triangles of polygons.

    Attributes
    ----------
    triangles : (t, 3) int
        Vertices, counter-clockwise; those of a polygon stand together, in the order of the polygons.
    verdict : (p,) object
        For each polygon '', or why it has no triangles.
    sides : Sides or None
        Those of the triangles, where they are known.
    """

    triangles: np.ndarray
    verdict: np.ndarray
    sides: Sides | None


def triangulate(
    polygons: Polygons,
    *,
    conformal: Callable | None = None,
    engine: str | None = None,
    check: Callable = ignore,
) -> Triangulations:
    """Return constrained Delaunay triangulations.

    Parameters
    ----------
    polygons : Polygons
    conformal : callable, optional
        Map of coordinates to the plane whose circles count (see `metric.Metric`). Where the
        triangulation of that plane is none of the polygon's own plane, because straight edges
        bend under the map, the polygon's own plane is used.
    engine : {'triangle', 'pythoncdt', 'shapely'}, optional
        The engine to begin with. Default: the first that is installed.
    check : callable, optional
        Called now and then with the share done; may raise `Cancelled`.

    Returns
    -------
    Triangulations

    Raises
    ------
    MissingEngine
        If no engine is installed.

    Notes
    -----
    O(n log n) (Triangle's divide and conquer).

    Examples
    --------
    A rhombus is cut along its short diagonal.

    >>> from isthmus.core.partition.polygon import one
    >>> rhombus = one(np.array([(0, 0), (3, -1), (6, 0), (3, 1.0)]), [0, 4])
    >>> triangles, verdict, _ = triangulate(rhombus)
    >>> sorted(np.sort(triangles, axis=1).tolist()), verdict.tolist()
    ([[0, 1, 3], [1, 2, 3]], [''])
    """
    names = engines.engine_names()
    if engine:
        rank = engines.ENGINES.index
        names = [engine] + [name for name in names if rank(name) > rank(engine)]
    if not names:
        raise MissingEngine(missing_packages())
    count = len(polygons.unit)
    planes = []
    if conformal is not None:
        bent, survives = _bent(polygons, conformal)
        planes.append((bent, survives))
    planes.append((polygons.xy, np.ones(count, dtype=bool)))
    found = []  # triangles, and their number in each polygon
    waiting = np.ones(count, dtype=bool)
    for plane, usable in planes:
        for name in names:
            which = np.flatnonzero(waiting & usable)
            if not len(which):
                continue
            triangles, offsets = _by_engine(name, polygons, plane, which, check)
            good, sides = _are_triangulations(polygons, which, triangles, offsets)
            if plane is not polygons.xy:
                good &= _same_sides(polygons.xy, triangles, offsets)
            if not good.all():
                index, offsets = take(offsets, np.flatnonzero(good))
                triangles = triangles[index]
            found.append((triangles, which[good], np.diff(offsets), sides if good.all() else None))
            waiting[which[good]] = False
    verdict = np.full(count, "", dtype=object)
    verdict[waiting] = TOO_FINE
    if len(found) == 1:
        return Triangulations(found[0][0], verdict, found[0][3])
    triangles, which, size = (
        (np.concatenate(x) for x in list(zip(*found))[:3])
        if found
        else (np.empty((0, 3), dtype=np.int64), *np.empty((2, 0), dtype=np.int64))
    )
    index, _ = take(offsets_of(size), np.argsort(which, kind="stable"))
    return Triangulations(triangles[index], verdict, None)


def diagonals(polygons: Polygons, triangles: np.ndarray, sides: Sides | None = None) -> np.ndarray:
    """Return the inner edges of triangulations.

    Parameters
    ----------
    polygons : Polygons
    triangles : (t, 3) int
    sides : Sides, optional
        Those of the triangles, where they are known.

    Returns
    -------
    (m, 2) int
        Vertices u < v of the n + 3 (h - 1) diagonals of each polygon, u ascending, then v descending.

    Examples
    --------
    A rhombus in two triangles has one:

    >>> from isthmus.core.partition.polygon import one
    >>> rhombus = one(np.array([(0, 0), (3, -1), (6, 0), (3, 1.0)]), [0, 4])
    >>> diagonals(rhombus, np.array([(0, 1, 3), (1, 2, 3)])).tolist()
    [[1, 3]]
    """
    sides = sides or sides_of(polygons, triangles)
    a, b = (ends.take(sides.inner).astype(np.int64) for ends in (sides.tail, sides.head))
    span = int((b - a).max(initial=0)) + 1
    key = a * span + (span - 1 - (b - a))
    if len(polygons.xy) * span < 2**31:  # many small polygons: numpy sorts these several times faster
        key = key.astype(np.int32)
    key.sort()
    a = key // span
    return np.column_stack((a, a + (span - 1 - (key - a * span)))).astype(np.int64, copy=False)


def _bent(polygons, conformal):
    """The vertices in the conformal plane, and which polygons survive the map."""
    unit = polygons.unit[polygons.polygon_of_vertex]
    with np.errstate(all="ignore"):
        plane = conformal(polygons.xy * unit[:, None])
    # a pole, or no degrees at all; or so small that GEOS fails
    bounds = polygons.vertex_offsets[:-1]
    with np.errstate(invalid="ignore"):
        largest = np.maximum.reduceat(np.abs(plane).max(axis=1), bounds)
        survives = (largest > 1e-50) & (largest < 1e50)
    # vertices that rounding makes one crash Triangle
    polygon = polygons.polygon_of_vertex
    order = np.lexsort((plane[:, 1], plane[:, 0], polygon))
    same = (plane[order][1:] == plane[order][:-1]).all(axis=1)
    same &= polygon[order][1:] == polygon[order][:-1]
    survives[polygon[order][1:][same]] = False
    # a vertex that all but touches an edge may be beyond it in the plane: Triangle may never end there
    which = np.flatnonzero(survives)
    if len(which):
        ring, polygon_offsets = take(polygons.polygon_offsets, which)
        corner, offsets = take(polygons.offsets, ring)
        valid = is_valid(shapes(plane[polygons.vertex[corner]], offsets, polygon_offsets))
        survives[which[~valid]] = False
    return plane, survives


def _by_engine(name, polygons, plane, which, check):
    """Triangles of polygons in a plane, by an engine, and where those of each start; none where it fails."""
    vertex, vertex_offsets = take(polygons.vertex_offsets, which)
    corner, corner_offsets = take(polygons.corner_offsets, which)
    ends = np.column_stack([vertices.take(corner) for vertices in (polygons.vertex, polygons.next_vertex)])
    if len(vertex) < len(plane):
        number = np.empty(len(plane), dtype=np.int64)
        number[vertex] = np.arange(len(vertex))
        plane, ends = plane[vertex], number[ends]
    triangles, offsets = engines.triangulate(name, plane, vertex_offsets, ends, corner_offsets, check=check)
    return triangles if len(vertex) == len(polygons.xy) else vertex[triangles], offsets


def sides_of(polygons: Polygons, triangles: np.ndarray) -> Sides:
    """Return the sides of triangles.

    Parameters
    ----------
    polygons : Polygons
    triangles : (t, 3) int
        Counter-clockwise.

    Returns
    -------
    Sides

    Notes
    -----
    O(t), but where rings touch a sort of some n.

    Examples
    --------
    A rhombus in two triangles: both have the diagonal 1-3, which is no edge of the rhombus.

    >>> from isthmus.core.partition.polygon import one
    >>> rhombus = one(np.array([(0, 0), (3, -1), (6, 0), (3, 1.0)]), [0, 4])
    >>> sides = sides_of(rhombus, np.array([(0, 1, 3), (1, 2, 3)]))
    >>> list(zip(sides.tail.tolist(), sides.head.tolist(), sides.boundary.tolist()))
    [(0, 1, True), (1, 3, False), (3, 0, True), (1, 2, True), (2, 3, True), (3, 1, False)]
    """
    n = len(polygons.xy)
    a, b = triangles.ravel(), triangles.take([1, 2, 0], axis=1).ravel()
    vertex, after = polygons.vertex, polygons.next_vertex
    next_vertex = after.astype(a.dtype)
    if not polygons.apart:
        next_vertex = np.full(n, -1, dtype=a.dtype)
        next_vertex[vertex] = after
    boundary = next_vertex[a] == b
    if not polygons.apart:  # some vertices have several ring edges
        several = np.bincount(vertex, minlength=n) > 1
        k = np.flatnonzero(several[a] & ~boundary)
        mine = several[vertex]
        boundary[k] = np.isin(a[k].astype(np.int64) * n + b[k], vertex[mine] * n + after[mine])
    return Sides(a, b, boundary, np.flatnonzero((a < b) & ~boundary))


def _are_triangulations(polygons, which, triangles, offsets):
    """Whether the triangles found for some polygons are triangulations of these; their sides."""
    size = np.diff(offsets)
    corners = np.diff(polygons.corner_offsets)[which]
    touches = corners - np.diff(polygons.vertex_offsets)[which]
    holes = np.diff(polygons.polygon_offsets)[which] - 1 - touches  # one that touches is part of a ring
    good = size == corners + 2 * holes - 2
    bounds = 3 * offsets
    some = np.flatnonzero(size)
    if len(some):
        flat, first = triangles.ravel(), bounds[some]
        outside = np.zeros(len(size), dtype=bool)
        outside[some] = np.minimum.reduceat(flat, first) < polygons.vertex_offsets[which[some]]
        outside[some] |= np.maximum.reduceat(flat, first) >= polygons.vertex_offsets[which[some] + 1]
        if outside.any():
            good &= ~outside
            triangles = np.where(np.repeat(outside, size)[:, None], 0, triangles)
    sides = sides_of(polygons, triangles)
    good &= _numbers_of(sides.boundary, bounds) == corners
    inner = np.diff(np.searchsorted(sides.inner, bounds))
    return good & (2 * inner + corners == 3 * size), sides


def _numbers_of(flags, offsets):
    """How many flags of each group are set; groups may be empty."""
    return np.diff(np.searchsorted(np.flatnonzero(flags), offsets))


def _same_sides(xy, triangles, offsets):
    """Whether all triangles of each polygon have their orientation in this plane too (so they tile it)."""
    p, q, r = (xy[k] for k in triangles.T)
    left = (p[:, 0] - r[:, 0]) * (q[:, 1] - r[:, 1])
    right = (p[:, 1] - r[:, 1]) * (q[:, 0] - r[:, 0])
    turned = ~(left - right > 4e-16 * (np.abs(left) + np.abs(right)))
    return _numbers_of(turned, offsets) == 0
