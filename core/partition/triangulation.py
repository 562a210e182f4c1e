"""Second stage: the diagonals of a constrained Delaunay triangulation.

Two engines: ``triangle`` (Shewchuk's Triangle) where it is installed, else shapely's. Triangle
crashes or hangs on some invalid input, so only polygons that have passed `polygon.from_rings` may
come here, and every answer is checked.
"""

from __future__ import annotations

import numpy as np
import shapely

from ..errors import MissingEngine, Unsolvable
from .polygon import is_valid, ring_polygon

__all__ = ["diagonals", "engine_name", "missing_packages", "triangles"]


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


def diagonals(polygon, conformal=None, engine=None):
    """Return the inner edges of a constrained Delaunay triangulation of a polygon.

    Parameters
    ----------
    polygon : Polygon
    conformal : callable, optional
        Map of coordinates to the plane whose circles count (see `metric.Metric`). Where the
        triangulation of that plane is none of the polygon's own plane, because straight edges
        bend under the map, the polygon's own plane is used.
    engine : {'triangle', 'shapely'}, optional
        Default: the first that is installed.

    Returns
    -------
    (m, 2) int
        Vertex indices u < v of the n + 3 (h - 1) diagonals, u ascending, then v descending.

    Raises
    ------
    MissingEngine
        If no engine is installed.
    Unsolvable
        If no engine returns a triangulation of this polygon.

    Notes
    -----
    O(n log n) (Triangle's divide and conquer), and a sort.
    """
    return _triangulate(polygon, conformal, engine)[1]


def triangles(polygon, engine=None):
    """Return the triangles themselves, as an (m, 3) array of vertex indices; see `diagonals`."""
    return _triangulate(polygon, None, engine)[0]


def _triangulate(polygon, conformal, engine):
    """Triangles and their inner edges."""
    engine = engine or engine_name()
    if not engine:
        raise MissingEngine(missing_packages())
    engines = [engine] + ["shapely"] * (
        engine == "triangle" and hasattr(shapely, "constrained_delaunay_triangles")
    )
    planes = [polygon.xy]
    if conformal is not None:
        bent = _bent(polygon, conformal)
        if bent is not None:
            planes.insert(0, bent)
    for plane in planes:
        for name in engines:
            found = (_by_triangle if name == "triangle" else _by_shapely)(polygon, plane)
            edges = _checked_edges(polygon, found)
            if edges is not None and (plane is polygon.xy or _same_sides(polygon.xy, found)):
                return found, edges
    raise Unsolvable("the polygon could not be triangulated (too fine for double precision)")


def _triangle():
    try:
        import triangle
    except ImportError:
        return None
    return triangle


def _bent(polygon, conformal):
    """The vertices in the conformal plane, or None where the polygon does not survive the map."""
    with np.errstate(all="ignore"):
        plane = conformal(polygon.xy * polygon.unit)
    # a pole, or no degrees at all; or so small that GEOS fails
    if not 1e-50 < np.abs(plane).max() < 1e50:
        return None
    points = np.sort(np.ascontiguousarray(plane).view(np.complex128).ravel())
    if (points[1:] == points[:-1]).any():  # vertices that rounding makes one crash Triangle
        return None
    # Triangle may hang on holes that overlap the shell, but not on a single ring
    if len(polygon.offsets) > 2 and not is_valid(ring_polygon(polygon, plane)):
        return None
    return plane


def _by_triangle(polygon, plane):
    nothing = np.empty((0, 3), dtype=np.int32)
    magnitude = np.abs(plane)
    if magnitude.min(where=magnitude > 0.0, initial=1.0) < 1e-70:
        return nothing  # its arithmetic multiplies four of them: underflow, and a crash
    segments = np.column_stack((polygon.vertex, polygon.vertex[polygon.next_corner]))
    graph = {"vertices": plane, "segments": segments.astype(np.int32)}
    if len(polygon.offsets) > 2:
        shape = ring_polygon(polygon, plane)
        holes = shapely.polygons(shapely.get_rings(shape)[1:])
        graph["holes"] = shapely.get_coordinates(shapely.point_on_surface(holes))
    # p: with segments; Q: quiet; B, P, N: no markers, segments and vertices in the answer
    try:
        return _triangle().triangulate(graph, "pQBPN").get("triangles", nothing)
    except RuntimeError:  # its own checks failed: coordinates too close for its arithmetic
        return nothing


def _by_shapely(polygon, plane):
    # GEOS joins holes from the left; where they touch, it fails now and then, but not mirrored
    for flip in ((1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
        mirrored = plane * flip + 0.0
        shape = ring_polygon(polygon, mirrored)
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
        triangles = order[np.minimum(place, len(key) - 1)].reshape(-1, 3)
        return triangles if flip[0] * flip[1] < 0.0 else triangles[:, ::-1]
    return np.empty((0, 3), dtype=np.int64)


def _checked_edges(polygon, triangles):
    """The diagonals of the triangles, or None if these are no triangulation of the polygon."""
    n, corners = len(polygon.xy), len(polygon.vertex)
    holes = len(polygon.offsets) - 2 - (corners - n)  # a hole that touches is part of a ring
    if len(triangles) != corners + 2 * holes - 2 or triangles.max() >= n:
        return None
    a = triangles.ravel()
    b = triangles[:, [1, 2, 0]].ravel()
    vertex, following = polygon.vertex, polygon.vertex[polygon.next_corner]
    next_vertex = np.empty(n, dtype=a.dtype)
    next_vertex[vertex] = following
    boundary = next_vertex[a] == b
    if corners > n:  # rings touch: some vertices have several ring edges
        boundary |= np.isin(a.astype(np.int64) * n + b, vertex * n + following)
    if np.count_nonzero(boundary) != corners:
        return None
    # an inner edge borders two triangles, and runs upwards in one of them
    inner = np.flatnonzero((a < b) & ~boundary)
    if 2 * len(inner) + corners != len(a):
        return None
    a, b = a[inner].astype(np.int64), b[inner].astype(np.int64)
    order = np.argsort(a * n + (n - 1 - b))
    return np.column_stack((a[order], b[order]))


def _same_sides(xy, triangles):
    """Whether all triangles have their orientation in this plane too (so they tile it)."""
    p, q, r = (xy[triangles[:, k]] for k in range(3))
    left = (p[:, 0] - r[:, 0]) * (q[:, 1] - r[:, 1])
    right = (p[:, 1] - r[:, 1]) * (q[:, 0] - r[:, 0])
    return bool((left - right > 4e-16 * (np.abs(left) + np.abs(right))).all())
