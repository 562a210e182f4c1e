"""First stage: the rings of one polygon become canonical, checked arrays.

Everything after this stage works on indices, so the result cannot depend on where a ring starts,
on its direction or on the order of the holes, and no coordinate is ever recomputed.

Vocabulary: a *row* is a vertex of the input with all its coordinates; a *corner* is a place on a
ring (consecutive rows at the same point share a corner); a *vertex* is a point of the plane (rings
that touch share a vertex, each with a corner of its own).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from ..errors import Unsolvable

__all__ = ["Polygon", "from_rings", "is_valid", "ring_polygon", "signed_areas", "without_rings"]


class Polygon(NamedTuple):
    """A valid polygon in canonical order (section 2 of the paper: the geometric graph G).

    Ring 0 is the shell, counter-clockwise; the others are holes, clockwise. Each starts at its
    lexicographically smallest vertex, and the holes follow in the order of these.

    Attributes
    ----------
    xy : (n, 2) float
        Coordinates of the vertices, divided by ``unit``.
    unit : float
        A power of two; 1 unless the coordinates are so large or small that squares would
        overflow.
    vertex : (c,) int
        The vertex at each corner.
    offsets : (r + 1,) int
        Ring k has the corners ``offsets[k]`` to ``offsets[k + 1] - 1``.
    rows : (k,) int
        Input rows in canonical order.
    row_start : (c + 1,) int
        Corner i has the rows ``rows[row_start[i]:row_start[i + 1]]``.
    inserted : (c,) bool
        Corners that the input does not have: a vertex of one ring inside an edge of another.
    input_ring : (r,) int
        The input's number of each ring.
    shell_reversed : bool
        Whether the input's shell was clockwise.
    """

    xy: np.ndarray
    unit: float
    vertex: np.ndarray
    offsets: np.ndarray
    rows: np.ndarray
    row_start: np.ndarray
    inserted: np.ndarray
    input_ring: np.ndarray
    shell_reversed: bool

    @property
    def next_corner(self):
        """(c,) int: the corner after each corner on its ring."""
        following = np.arange(1, len(self.vertex) + 1)
        following[self.offsets[1:] - 1] = self.offsets[:-1]
        return following

    @property
    def ring_of_corner(self):
        """(c,) int: the ring of each corner."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))


def from_rings(coords, offsets):
    """Check the rings of one polygon and bring them into canonical order.

    Parameters
    ----------
    coords : (k, d) float, d >= 2
        x, y and whatever else rides along, one row a vertex, without the closing rows.
    offsets : (r + 1,) int
        Ring i is ``coords[offsets[i]:offsets[i + 1]]``; ring 0 is the shell.

    Returns
    -------
    Polygon

    Raises
    ------
    Unsolvable
        If the polygon is empty, not finite, degenerate or not valid.

    Notes
    -----
    O(k log k): validity and, where there are holes, the search for touching rings.
    """
    offsets = np.asarray(offsets, dtype=np.int64)
    if len(offsets) < 2 or offsets[0] == offsets[-1]:
        raise Unsolvable("empty geometry")
    xy = np.array(coords[:, :2], dtype=float) + 0.0  # + 0.0: there is only one zero
    if not np.isfinite(xy).all():
        raise Unsolvable("coordinates are not finite (NaN or infinity)")
    xy, unit = _scaled(xy)

    rings = [_distinct(xy, lo, hi) for lo, hi in zip(offsets[:-1], offsets[1:])]
    if any(len(start) < 3 for _, start in rings):
        raise Unsolvable("a ring has fewer than three distinct vertices")
    lines = shapely.linearrings(
        xy[np.concatenate([rows[start] for rows, start in rings])],
        indices=np.repeat(np.arange(len(rings)), [len(start) for _, start in rings]),
    )
    shape = shapely.polygons(lines[0], lines[1:])
    if not is_valid(shape):
        raise Unsolvable("invalid geometry: " + _reason(shape, unit))

    ccw = shapely.is_ccw(lines)
    rings = [
        _canonical_ring(xy, rows, start, bool(is_ccw) != (number == 0))
        for number, ((rows, start), is_ccw) in enumerate(zip(rings, ccw))
    ]
    order = [0] + sorted(range(1, len(rings)), key=lambda k: _first_two(xy, *rings[k]))
    rows = np.concatenate([rings[k][0] for k in order])
    size = np.array([len(rings[k][1]) for k in order])
    row_start = np.concatenate(
        [rings[k][1] + shift for k, shift in zip(order, _starts([len(rings[k][0]) for k in order]))]
        + [[len(rows)]]
    )
    polygon = Polygon(
        xy=xy[rows[row_start[:-1]]],
        unit=unit,
        vertex=np.arange(len(row_start) - 1),
        offsets=np.append(_starts(size), size.sum()),
        rows=rows,
        row_start=row_start,
        inserted=np.zeros(len(row_start) - 1, dtype=bool),
        input_ring=np.array(order),
        shell_reversed=not ccw[0],
    )
    return polygon if len(order) == 1 else _merge_touching(polygon, lines[order])


def is_valid(shape):
    """Whether a shapely polygon is valid as far as GEOS can tell: on some it fails by underflow."""
    try:
        return bool(shapely.is_valid(shape))
    except shapely.errors.GEOSException:
        return False


def ring_polygon(polygon, xy):
    """Return the shapely polygon of all rings, with the vertices at ``xy``."""
    lines = shapely.linearrings(xy[polygon.vertex], indices=polygon.ring_of_corner)
    return shapely.polygons(lines[0], lines[1:])


def without_rings(polygon, left_out):
    """Return a polygon without some holes, good for a triangulation, and its vertices' numbers.

    Parameters
    ----------
    polygon : Polygon
    left_out : (r,) bool
        Holes that touch no other ring.

    Returns
    -------
    Polygon
        Without rows.
    vertex : (n',) int
        For each of its vertices the one of the whole polygon, ascending.
    """
    kept = ~left_out[polygon.ring_of_corner]
    vertex, numbers = np.unique(polygon.vertex[kept], return_inverse=True)
    size = np.diff(polygon.offsets)[~left_out]
    none = np.empty(0, dtype=np.int64)
    return polygon._replace(
        xy=polygon.xy[vertex],
        vertex=numbers.ravel(),
        offsets=np.append(_starts(size), size.sum()),
        rows=none,
        row_start=none,
        inserted=polygon.inserted[kept],
        input_ring=polygon.input_ring[~left_out],
    ), vertex


def signed_areas(xy, offsets):
    """Signed areas of rings that lie one after the other, ccw positive.

    Parameters
    ----------
    xy : (k, 2) float
        Corners of all rings, none repeated at its end.
    offsets : (r + 1,) int
    """
    first = np.repeat(offsets[:-1], np.diff(offsets))
    x, y = (xy - xy[first]).T  # near the origin the shoelace formula cancels least
    following = np.arange(1, len(xy) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    return 0.5 * np.add.reduceat(x * y[following] - x[following] * y, offsets[:-1])


def _scaled(xy):
    """Bring extreme magnitudes to about 1, by a power of two: exact."""
    largest = np.abs(xy).max()
    if 1e-50 < largest < 1e50:
        return xy, 1.0
    exponent = int(np.frexp(largest)[1]) if largest > 0 else 0
    return np.ldexp(xy, -exponent), float(np.ldexp(1.0, exponent))


def _distinct(xy, lo, hi):
    """Rows of a ring from the start of a corner on, and where in them each corner starts."""
    ring = xy[lo:hi]
    first = np.flatnonzero((ring != np.roll(ring, 1, axis=0)).any(axis=1))
    if len(first) == 0:
        return np.arange(lo, hi), first
    return lo + np.roll(np.arange(hi - lo), -first[0]), first - first[0]


def _canonical_ring(xy, rows, start, reverse):
    """Rotate a ring to its smallest vertex and turn it if asked to."""
    if reverse:
        start = np.append(0, len(rows) - start[:0:-1])
        rows = rows[::-1]
    x, y = xy[rows[start]].T
    leftmost = np.flatnonzero(x == x.min())
    first = start[leftmost[np.argmin(y[leftmost])]]
    return np.roll(rows, -first), np.concatenate(
        (start[start >= first] - first, start[start < first] + (len(rows) - first))
    )


def _first_two(xy, rows, start):
    return tuple(xy[rows[start[0]]]) + tuple(xy[rows[start[1]]])


def _starts(sizes):
    return np.append(0, np.cumsum(sizes)[:-1])


def _reason(shape, unit):
    """GEOS's reason, its place in the units of the input."""
    try:
        reason = shapely.is_valid_reason(shape)
    except shapely.errors.GEOSException:
        return "it is too fine to be checked"
    if unit == 1.0:
        return reason
    return reason.split("[")[0].strip()


def _merge_touching(polygon, lines):
    """Give touching rings common vertices; a touched edge gets a corner there.

    In a valid polygon two rings have at most one point in common. It is a vertex of at least one.
    """
    pairs = shapely.STRtree(lines).query(lines, predicate="intersects")
    touching = np.unique(pairs[:, pairs[0] != pairs[1]])
    if len(touching) == 0:
        return polygon
    polygon = _insert_corners(polygon, touching)
    corners = np.flatnonzero(np.isin(polygon.ring_of_corner, touching))
    _, first, inverse = np.unique(
        polygon.xy[corners], axis=0, return_index=True, return_inverse=True
    )
    representative = np.arange(len(polygon.vertex))
    representative[corners] = corners[first][inverse.ravel()]
    kept, vertex = np.unique(representative, return_inverse=True)
    return polygon._replace(xy=polygon.xy[kept], vertex=vertex.ravel())


def _insert_corners(polygon, touching):
    """Insert a corner where a vertex of one touching ring lies inside an edge of another."""
    corners = np.flatnonzero(np.isin(polygon.ring_of_corner, touching))
    ends = polygon.next_corner[corners]
    segments = shapely.linestrings(np.stack((polygon.xy[corners], polygon.xy[ends]), axis=1))
    point, edge = shapely.STRtree(segments).query(
        shapely.points(polygon.xy[corners]), predicate="intersects"
    )
    point, edge = corners[point], corners[edge]
    end = polygon.next_corner[edge]
    inside = (polygon.xy[point] != polygon.xy[edge]).any(axis=1)
    inside &= (polygon.xy[point] != polygon.xy[end]).any(axis=1)
    point, edge = point[inside], edge[inside]
    if len(point) == 0:
        return polygon
    offset = polygon.xy[point] - polygon.xy[edge]
    along = np.lexsort((np.hypot(offset[:, 0], offset[:, 1]), edge))
    point, edge = point[along], edge[along]
    # two rings may touch an edge at the same point: one corner is enough
    repeated = np.append(
        False, (edge[1:] == edge[:-1]) & (polygon.xy[point[1:]] == polygon.xy[point[:-1]]).all(1)
    )
    point, edge = point[~repeated], edge[~repeated]

    place = edge + 1
    added = np.bincount(np.searchsorted(polygon.offsets, edge, side="right"), minlength=len(
        polygon.offsets))
    rows = np.insert(polygon.rows, polygon.row_start[place], polygon.rows[polygon.row_start[point]])
    row_count = np.insert(np.diff(polygon.row_start), place, 1)
    xy = np.insert(polygon.xy, place, polygon.xy[point], axis=0)
    return polygon._replace(
        xy=xy,
        vertex=np.arange(len(xy)),
        offsets=polygon.offsets + np.cumsum(added),
        rows=rows,
        row_start=np.append(0, np.cumsum(row_count)),
        inserted=np.insert(polygon.inserted, place, True),
    )
