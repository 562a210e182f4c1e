"""Second stage: the diagonals of constrained Delaunay triangulations.

Two engines: ``triangle`` (Shewchuk's Triangle) where it is installed, else shapely's. Triangle
crashes or hangs on some invalid input, so only polygons that have passed `polygon.from_rings` may
come here, and every answer is checked. The engine's own call is the only loop over polygons.
"""

from __future__ import annotations

from typing import Callable

import numpy as np
import shapely

from ..errors import MissingEngine
from ..progress import ignore
from ..rings import groups, offsets_of, shapes, take
from .polygon import Polygons, is_valid

__all__ = ["diagonals", "engine_name", "missing_packages", "triangulate"]

TOO_FINE = "the polygon could not be triangulated (too fine for double precision)"


def missing_packages(shapely_module=shapely):
    """Return what is missing in a few words, or '' if polygons can be triangulated."""
    version = shapely_module.__version__
    if not hasattr(shapely_module, "get_coordinates"):  # shapely 1 imports too
        return f"shapely 2 is needed, and {version} is installed"
    if not engine_name():
        return f"the package triangle, or shapely 2.1 instead of {version}, is needed"
    return ""


def engine_name():
    """Return 'triangle', 'shapely', or '' where no triangulation is available."""
    if _triangle():
        return "triangle"
    return "shapely" if hasattr(shapely, "constrained_delaunay_triangles") else ""


def triangulate(
    polygons: Polygons, *, conformal: Callable | None = None, engine: str | None = None,
    check: Callable = ignore,
) -> tuple[np.ndarray, np.ndarray]:
    """Return constrained Delaunay triangulations.

    Parameters
    ----------
    polygons : Polygons
    conformal : callable, optional
        Map of coordinates to the plane whose circles count (see `metric.Metric`). Where the
        triangulation of that plane is none of the polygon's own plane, because straight edges
        bend under the map, the polygon's own plane is used.
    engine : {'triangle', 'shapely'}, optional
        Default: the first that is installed.
    check : callable, optional
        Called now and then with the share done; may raise `Cancelled`.

    Returns
    -------
    triangles : (t, 3) int
        Vertices, counter-clockwise; those of a polygon stand together, in the order of the polygons.
    verdict : (p,) object
        For each polygon '', or why it has no triangles.

    Raises
    ------
    MissingEngine
        If no engine is installed.

    Notes
    -----
    O(n log n) (Triangle's divide and conquer).
    """
    engine = engine or engine_name()
    if not engine:
        raise MissingEngine(missing_packages())
    engines = [engine] + ["shapely"] * (
        engine == "triangle" and hasattr(shapely, "constrained_delaunay_triangles")
    )
    count = len(polygons.unit)
    planes = []
    if conformal is not None:
        bent, survives = _bent(polygons, conformal)
        planes.append((bent, survives))
    planes.append((polygons.xy, np.ones(count, dtype=bool)))
    job = _Job(polygons)
    found = [None] * count
    waiting = np.ones(count, dtype=bool)
    for plane, usable in planes:
        for name in engines:
            which = np.flatnonzero(waiting & usable)
            if not len(which):
                continue
            own = (_by_triangle if name == "triangle" else _by_shapely)(job, plane, which, check)
            good = _are_triangulations(job, which, own)
            if plane is not polygons.xy:
                good &= _same_sides(polygons.xy, own)
            for k in np.flatnonzero(good).tolist():
                found[which[k]] = own[k]
            waiting[which[good]] = False
    verdict = np.where(waiting, TOO_FINE, "").astype(object)
    found = [one for one in found if one is not None]
    return np.concatenate(found) if found else np.empty((0, 3), dtype=np.int64), verdict


def diagonals(polygons: Polygons, triangles: np.ndarray) -> np.ndarray:
    """Return the inner edges of triangulations.

    Returns
    -------
    (m, 2) int
        Vertices u < v of the n + 3 (h - 1) diagonals of each polygon, u ascending, then v descending.
    """
    n = len(polygons.xy)
    a, b, boundary = _half_edges(polygons, triangles)
    # an inner edge borders two triangles, and runs upwards in one of them
    inner = np.flatnonzero((a < b) & ~boundary)
    a, b = a[inner].astype(np.int64), b[inner].astype(np.int64)
    order = np.argsort(a * n + (n - 1 - b))
    return np.column_stack((a[order], b[order]))


class _Job:
    """What the engines need of polygons, each as a slice of flat arrays."""

    def __init__(self, polygons):
        self.polygons = polygons
        self.ring_bounds = polygons.polygon_offsets.tolist()
        self.corner_bounds = polygons.corner_offsets.tolist()
        self.vertex_bounds = polygons.vertex_offsets.tolist()
        first = np.repeat(polygons.vertex_offsets[:-1], np.diff(polygons.corner_offsets))
        tail = polygons.vertex - first
        self.segments = np.column_stack((tail, tail[polygons.next_corner])).astype(np.int32)


def _triangle():
    try:
        import triangle
    except ImportError:
        return None
    return triangle


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
    # Triangle may hang on holes that overlap the shell, but not on a single ring
    with_holes = np.flatnonzero(survives & (np.diff(polygons.polygon_offsets) > 1))
    if len(with_holes):
        ring, polygon_offsets = take(polygons.polygon_offsets, with_holes)
        corner, offsets = take(polygons.offsets, ring)
        valid = is_valid(shapes(plane[polygons.vertex[corner]], offsets, polygon_offsets))
        survives[with_holes[~valid]] = False
    return plane, survives


def _by_triangle(job, plane, which, check):
    """Triangles of polygons in a plane, by Triangle; empty where it fails."""
    polygons, nothing = job.polygons, np.empty((0, 3), dtype=np.int64)
    triangulate = _triangle().triangulate
    magnitude = np.where(plane == 0.0, 1.0, np.abs(plane)).min(axis=1)
    least = np.minimum.reduceat(magnitude, polygons.vertex_offsets[:-1])
    holes, hole_bounds = _hole_points(polygons, plane, which)
    result = []
    for place, p in enumerate(which.tolist()):
        if place % 256 == 0:
            check(place / len(which))
        if least[p] < 1e-70:  # its arithmetic multiplies four of them: underflow, and a crash
            result.append(nothing)
            continue
        lo, hi = job.vertex_bounds[p], job.vertex_bounds[p + 1]
        graph = {
            "vertices": plane[lo:hi],
            "segments": job.segments[job.corner_bounds[p]:job.corner_bounds[p + 1]],
        }
        if hole_bounds[place] < hole_bounds[place + 1]:
            graph["holes"] = holes[hole_bounds[place]:hole_bounds[place + 1]]
        # p: with segments; Q: quiet; B, P, N: no markers, segments and vertices in the answer
        try:
            result.append(triangulate(graph, "pQBPN").get("triangles", nothing) + lo)
        except RuntimeError:  # its own checks failed: coordinates too close for its arithmetic
            result.append(nothing)
    return result


def _hole_points(polygons, plane, which):
    """A point in each hole, and where those of each polygon start."""
    count = np.diff(polygons.polygon_offsets)[which] - 1
    bounds = offsets_of(count).tolist()
    if not bounds[-1]:
        return np.empty((0, 2)), bounds
    ring, ring_offsets = take(polygons.polygon_offsets, which)
    ring = np.delete(ring, ring_offsets[:-1])
    corner, offsets = take(polygons.offsets, ring)
    holes = shapely.polygons(
        shapely.linearrings(plane[polygons.vertex[corner]], indices=groups(offsets))
    )
    return shapely.get_coordinates(shapely.point_on_surface(holes)), bounds


def _by_shapely(job, plane, which, check):
    """Triangles of polygons in a plane, by GEOS; empty where it fails."""
    result = []
    for place, p in enumerate(which.tolist()):
        if place % 64 == 0:
            check(place / len(which))
        result.append(_one_by_shapely(job, plane, p))
    return result


def _one_by_shapely(job, plane, p):
    lo, hi = job.vertex_bounds[p], job.vertex_bounds[p + 1]
    ring = slice(job.ring_bounds[p], job.ring_bounds[p + 1])
    offsets = job.polygons.offsets[ring.start:ring.stop + 1]
    vertex = job.polygons.vertex[offsets[0]:offsets[-1]] - lo
    bounds = np.array([0, len(offsets) - 1])
    # GEOS joins holes from the left; where they touch, it fails now and then, but not mirrored
    for flip in ((1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
        mirrored = plane[lo:hi] * flip + 0.0
        (shape,) = shapes(mirrored[vertex], offsets - offsets[0], bounds)
        try:
            triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(shape))
        except shapely.errors.GEOSException:
            continue
        corners = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3].reshape(-1, 2)
        # as complex numbers, points have numpy's lexicographic order
        key, corners = (np.ascontiguousarray(x).view(np.complex128).ravel()
                        for x in (mirrored, corners))
        order = np.argsort(key)
        place = np.searchsorted(key, corners, sorter=order)
        triangles = lo + order[np.minimum(place, len(key) - 1)].reshape(-1, 3)
        return triangles if flip[0] * flip[1] < 0.0 else triangles[:, ::-1]
    return np.empty((0, 3), dtype=np.int64)


def _half_edges(polygons, triangles):
    """Tails and heads of the sides of triangles, and which are edges of the polygons."""
    n = len(polygons.xy)
    a, b = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    vertex, after = polygons.vertex, polygons.vertex[polygons.next_corner]
    next_vertex = np.full(n, -1, dtype=a.dtype)
    next_vertex[vertex] = after
    boundary = next_vertex[a] == b
    if len(vertex) > n:  # rings touch: some vertices have several ring edges
        several = np.bincount(vertex, minlength=n) > 1
        k = np.flatnonzero(several[a] & ~boundary)
        mine = several[vertex]
        boundary[k] = np.isin(a[k].astype(np.int64) * n + b[k], vertex[mine] * n + after[mine])
    return a, b, boundary


def _are_triangulations(job, which, found):
    """Whether the triangles found for some polygons are triangulations of these."""
    polygons = job.polygons
    size = np.array([len(one) for one in found])
    corners = np.diff(polygons.corner_offsets)[which]
    touches = corners - np.diff(polygons.vertex_offsets)[which]
    holes = np.diff(polygons.polygon_offsets)[which] - 1 - touches  # one that touches is part of a ring
    good = size == corners + 2 * holes - 2
    triangles = np.concatenate(found)
    low = np.repeat(polygons.vertex_offsets[which], size)
    high = np.repeat(polygons.vertex_offsets[which + 1], size)
    owner = np.repeat(np.arange(len(which)), size)
    inside = (triangles >= low[:, None]).all(axis=1) & (triangles < high[:, None]).all(axis=1)
    good[owner[~inside]] = False
    triangles[~inside] = 0
    a, b, boundary = _half_edges(polygons, triangles)
    half_owner = np.repeat(owner, 3)
    good &= np.bincount(half_owner[boundary], minlength=len(which)) == corners
    inner = np.bincount(half_owner[(a < b) & ~boundary], minlength=len(which))
    return good & (2 * inner + corners == 3 * size)


def _same_sides(xy, found):
    """Whether all triangles of each polygon have their orientation in this plane too (so they tile it)."""
    size = np.array([len(one) for one in found])
    p, q, r = (xy[k] for k in np.concatenate(found).T)
    left = (p[:, 0] - r[:, 0]) * (q[:, 1] - r[:, 1])
    right = (p[:, 1] - r[:, 1]) * (q[:, 0] - r[:, 0])
    turned = ~(left - right > 4e-16 * (np.abs(left) + np.abs(right)))
    return np.bincount(np.repeat(np.arange(len(found)), size), weights=turned,
                       minlength=len(found)) == 0
