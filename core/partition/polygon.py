"""First stage: the rings of polygons become canonical, checked arrays.

Everything after this stage works on indices, so the result cannot depend on where a ring starts,
on its direction or on the order of the holes, and no coordinate is ever recomputed.

Vocabulary: a *row* is a vertex of the input with all its coordinates; a *corner* is a place on a
ring (consecutive rows at the same point share a corner); a *vertex* is a point of the plane (rings
that touch share a vertex, each with a corner of its own). Polygons never share any of these.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
import shapely

from ..errors import Sentence, Unsolvable
from ..predicates import orientations
from ..rings import Rings, following, groups, offsets_of, one_polygon, shapes, spread, take

__all__ = ["Polygons", "boundary_components", "from_rings", "is_valid", "one", "select", "without_rings"]

TOO_FINE = Sentence("it is too fine to be checked")


class _Arrays(NamedTuple):
    xy: np.ndarray
    unit: np.ndarray
    vertex: np.ndarray
    offsets: np.ndarray
    polygon_offsets: np.ndarray
    rows: np.ndarray
    row_start: np.ndarray
    inserted: np.ndarray
    shell_reversed: np.ndarray
    number: np.ndarray


class Polygons(_Arrays):  # with a __dict__, for what every stage asks for again
    """Valid polygons in canonical order (section 2 of the paper: the geometric graphs G).

    The first ring of each is its shell, counter-clockwise; the others are holes, clockwise. Each
    starts at its lexicographically smallest vertex, and the holes follow in the order of these.

    Attributes
    ----------
    xy : (n, 2) float
        Coordinates of the vertices, divided by ``unit``; those of a polygon stand together.
    unit : (p,) float
        Powers of two; 1 unless the coordinates are so large or small that squares would overflow.
    vertex : (c,) int
        The vertex at each corner.
    offsets : (r + 1,) int
        Ring k has the corners ``offsets[k]`` to ``offsets[k + 1] - 1``.
    polygon_offsets : (p + 1,) int
        Where the rings of each polygon start.
    rows : (k,) int
        Input rows in canonical order.
    row_start : (c + 1,) int
        Corner i has the rows ``rows[row_start[i]:row_start[i + 1]]``.
    inserted : (c,) bool
        Corners that the input does not have: a vertex of one ring inside an edge of another.
    shell_reversed : (p,) bool
        Whether the input's shell was clockwise.
    number : (p,) int
        The input's number of each polygon.
    """

    @cached_property
    def next_corner(self) -> np.ndarray:
        """(c,) int: the corner after each corner on its ring."""
        return following(self.offsets)

    @cached_property
    def next_vertex(self) -> np.ndarray:
        """(c,) int: the vertex at the corner after each corner on its ring."""
        return self.next_corner if self.apart else self.vertex[self.next_corner]

    @property
    def corner_xy(self) -> np.ndarray:
        """(c, 2) float: where each corner is."""
        return self.xy if self.apart else self.xy[self.vertex]

    @cached_property
    def ring_of_corner(self) -> np.ndarray:
        """(c,) int: the ring of each corner."""
        return groups(self.offsets)

    @property
    def apart(self) -> bool:
        """Whether no rings touch: then the vertex at each corner is that of its number."""
        return len(self.vertex) == len(self.xy)

    @property
    def polygon_of_ring(self) -> np.ndarray:
        """(r,) int: the polygon of each ring."""
        return groups(self.polygon_offsets)

    @property
    def corner_offsets(self) -> np.ndarray:
        """(p + 1,) int: where the corners of each polygon start."""
        return self.offsets[self.polygon_offsets]

    @cached_property
    def polygon_of_vertex(self) -> np.ndarray:
        """(n,) int: the polygon of each vertex."""
        of_corner = groups(self.corner_offsets)
        if self.apart:
            return of_corner
        polygon = np.empty(len(self.xy), dtype=np.int64)
        polygon[self.vertex] = of_corner
        return polygon

    @property
    def row_of_vertex(self) -> np.ndarray:
        """(n,) int: an input row at each vertex."""
        rows = self.rows if len(self.rows) == len(self.vertex) else self.rows[self.row_start[:-1]]
        if self.apart:
            return rows
        of_vertex = np.empty(len(self.xy), dtype=np.int64)
        of_vertex[self.vertex] = rows
        return of_vertex

    @cached_property
    def vertex_offsets(self) -> np.ndarray:
        """(p + 1,) int: where the vertices of each polygon start."""
        if self.apart:
            return self.corner_offsets
        return offsets_of(np.bincount(self.polygon_of_vertex, minlength=len(self.unit)))


def from_rings(rings: Rings) -> tuple[Polygons, np.ndarray]:
    """Check the rings of polygons and bring them into canonical order.

    Parameters
    ----------
    rings : Rings
        x, y and whatever else rides along, without closing rows.

    Returns
    -------
    polygons : Polygons
        The good ones, in the order given.
    verdict : (p,) object
        For each input polygon '', or why it is not among them: empty, not finite, degenerate or not valid.

    Notes
    -----
    O(k log k): validity and, where there are holes, the search for touching rings.

    Examples
    --------
    >>> square = np.array([[0, 0], [0, 1], [1, 1], [1, 0.0]])
    >>> polygons, verdict = from_rings(one_polygon(square, [0, 4]))
    >>> polygons.rows, polygons.shell_reversed
    (array([0, 3, 2, 1]), array([ True]))
    """
    offsets, polygon_offsets = rings.offsets, rings.polygon_offsets
    count = len(polygon_offsets) - 1
    verdict = np.full(count, "", dtype=object)
    size = np.diff(offsets)
    ring_polygon = groups(polygon_offsets)
    row_polygon = spread(ring_polygon, offsets)
    xy = np.add(rings.coords[:, :2], 0.0, dtype=float)  # + 0.0: there is only one zero
    row_offsets = offsets[polygon_offsets]

    empty = np.diff(row_offsets) == 0
    verdict[empty] = Sentence("empty geometry")
    bad = np.zeros(count, dtype=bool)
    finite = np.isfinite(xy)
    if not finite.all():
        finite = finite.all(axis=1)
        bad[row_polygon[~finite]] = True
        verdict[bad] = Sentence("coordinates are not finite (NaN or infinity)")
        xy[~finite] = 0.0
    xy, unit, lost = _scaled(xy, row_offsets)

    # corners: rows that differ from the one before on their ring
    is_start = np.ones(len(xy), dtype=bool)
    points = np.ascontiguousarray(xy).view(np.complex128).ravel()  # numpy takes its time for rows of two
    is_start[1:] = points[1:] != points[:-1]
    some = np.flatnonzero(size)
    first, last = offsets[:-1][some], offsets[1:][some] - 1
    is_start[first] = points[first] != points[last]
    corner_count = np.zeros(len(size), dtype=np.int64)
    corner_count[some] = np.add.reduceat(is_start, first) if len(some) else 0
    thin = np.zeros(count, dtype=bool)
    thin[ring_polygon[corner_count < 3]] = True
    verdict[thin & ~empty & ~bad] = Sentence("a ring has fewer than three distinct vertices")
    verdict[lost] = Sentence("invalid geometry: {}", TOO_FINE)
    good = verdict == ""
    kept = good[ring_polygon]  # rings
    starts = np.flatnonzero(is_start if good.all() else is_start & good[row_polygon])
    corner_offsets = offsets_of(corner_count[kept])
    shape = shapes(
        xy if len(starts) == len(xy) else xy.take(starts, axis=0),
        corner_offsets,
        offsets_of(np.diff(polygon_offsets)[good]),
    )
    valid = is_valid(shape)
    if not valid.all():
        number = np.flatnonzero(good)
        for k in np.flatnonzero(~valid).tolist():
            verdict[number[k]] = Sentence("invalid geometry: {}", _reason(shape[k], unit[number[k]]))
        again = np.flatnonzero(kept)
        keep = valid[np.repeat(np.arange(len(valid)), np.diff(polygon_offsets)[good])]
        kept[again[~keep]] = False
        good[number[~valid]] = False
        index, corner_offsets = take(corner_offsets, np.flatnonzero(keep))
        starts = starts[index]
    polygons = _canonical(xy, offsets, kept, is_start, starts, corner_offsets, ring_polygon, good)
    polygons = polygons._replace(unit=unit[good])
    return _merge_touching(polygons), verdict


def one(coords: np.ndarray, offsets: np.ndarray) -> Polygons:
    """Return a single polygon, a chunk of one; `Unsolvable` says why it cannot be used.

    Parameters
    ----------
    coords : (k, d) float
    offsets : (r + 1,) int
        Ring i is ``coords[offsets[i]:offsets[i + 1]]``; ring 0 is the shell.

    Examples
    --------
    A clockwise square comes out counter-clockwise; what is no polygon is an error.

    >>> one(np.array([[0, 0], [0, 1], [1, 1], [1, 0.0]]), [0, 4]).xy.tolist()
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    >>> one(np.zeros((4, 2)), [0, 4])
    Traceback (most recent call last):
        ...
    isthmus.core.errors.Unsolvable: a ring has fewer than three distinct vertices
    """
    polygons, (problem,) = from_rings(one_polygon(coords, offsets))
    if problem:
        raise Unsolvable(problem)
    return polygons


def is_valid(shape: np.ndarray) -> np.ndarray:
    """Whether shapely polygons are valid as far as GEOS can tell: on some it fails by underflow.

    Examples
    --------
    A square, and the same corners in an order in which two edges cross.

    >>> square, bow = [[0, 0], [1, 0], [1, 1], [0, 1]], [[0, 0], [1, 0], [0, 1], [1, 1]]
    >>> is_valid(shapely.polygons([square, bow])).tolist()
    [True, False]
    """
    try:
        return np.atleast_1d(shapely.is_valid(shape))
    except shapely.errors.GEOSException:
        if len(shape) == 1:
            return np.zeros(1, dtype=bool)
        return np.array([is_valid(shape[k : k + 1])[0] for k in range(len(shape))])


def select(polygons: Polygons, which: np.ndarray) -> tuple[Polygons, np.ndarray]:
    """Return some of the polygons, and the numbers that their vertices had.

    Parameters
    ----------
    polygons : Polygons
    which : (q,) int
        Ascending.

    Examples
    --------
    The second of two triangles.

    >>> xy = np.array([[0, 0], [1, 0], [0, 1], [5, 5], [6, 5], [5, 6.0]])
    >>> rings = Rings(xy, np.array([0, 3, 6]), np.arange(3))
    >>> second, vertex = select(from_rings(rings)[0], np.array([1]))
    >>> second.xy.tolist(), second.number.tolist(), vertex.tolist()
    ([[5.0, 5.0], [6.0, 5.0], [5.0, 6.0]], [1], [3, 4, 5])
    """
    ring, polygon_offsets = take(polygons.polygon_offsets, which)
    corner, offsets = take(polygons.offsets, ring)
    vertex, _ = take(polygons.vertex_offsets, which)
    number = np.full(len(polygons.xy), -1)
    number[vertex] = np.arange(len(vertex))
    row_index = row_start = polygons.row_start
    if len(row_start):  # not of polygons `without_rings`
        row_index, row_start = take(polygons.row_start, corner)
    return Polygons(
        xy=polygons.xy[vertex],
        unit=polygons.unit[which],
        vertex=number[polygons.vertex[corner]],
        offsets=offsets,
        polygon_offsets=polygon_offsets,
        rows=polygons.rows[row_index],
        row_start=row_start,
        inserted=polygons.inserted[corner],
        shell_reversed=polygons.shell_reversed[which],
        number=polygons.number[which],
    ), vertex


def boundary_components(polygons: Polygons) -> np.ndarray:
    """Return the (r,) number of the boundary component of each ring: that of its first ring.

    Notes
    -----
    O(c log c) for c corners at points where rings touch; nothing else is looked at.

    Examples
    --------
    >>> rings = [[0, 0], [9, 0], [9, 9], [0, 9], [4, 4], [4, 5], [5, 4], [5, 4], [6, 5], [6, 4.0]]
    >>> boundary_components(from_rings(one_polygon(np.array(rings), [0, 4, 7, 10]))[0])
    array([0, 1, 1])
    """
    number = np.arange(len(polygons.offsets) - 1)
    if polygons.apart:
        return number
    passes = np.bincount(polygons.vertex, minlength=len(polygons.xy))
    shared = np.flatnonzero(passes[polygons.vertex] > 1)
    shared = shared[np.argsort(polygons.vertex[shared], kind="stable")]
    same = polygons.vertex[shared[1:]] == polygons.vertex[shared[:-1]]
    ring = np.searchsorted(polygons.offsets, shared, side="right") - 1
    a, b = ring[:-1][same], ring[1:][same]
    while True:
        # hang the larger of two numbers on the smaller, then everything on its root
        a, b = number[a], number[b]
        apart = a != b
        if not apart.any():
            return number
        a, b = a[apart], b[apart]
        np.minimum.at(number, np.maximum(a, b), np.minimum(a, b))
        while True:
            root = number[number]
            if np.array_equal(root, number):
                break
            number = root


def without_rings(polygons: Polygons, left_out: np.ndarray) -> tuple[Polygons, np.ndarray]:
    """Return polygons without some holes, good for a triangulation, and their vertices' numbers.

    Parameters
    ----------
    polygons : Polygons
    left_out : (r,) bool
        Holes that touch no other ring.

    Returns
    -------
    Polygons
        Without rows.
    vertex : (n',) int
        For each of its vertices the one of the whole polygon, ascending.

    Examples
    --------
    A square without its first hole, whose vertices were 4 to 6.

    >>> xy = [[0, 0], [9, 0], [9, 9], [0, 9], [2, 2], [2, 3], [3, 2], [6, 6], [6, 7], [7, 6.0]]
    >>> rest, vertex = without_rings(one(np.array(xy), [0, 4, 7, 10]), np.array([False, True, False]))
    >>> len(rest.offsets) - 1, vertex.tolist()
    (2, [0, 1, 2, 3, 7, 8, 9])
    """
    corner, offsets = take(polygons.offsets, np.flatnonzero(~left_out))
    is_left = np.zeros(len(polygons.xy), dtype=bool)
    is_left[polygons.vertex[corner]] = True
    vertex = np.flatnonzero(is_left)
    number = np.cumsum(is_left) - 1
    none = np.empty(0, dtype=np.int64)
    rest = np.bincount(polygons.polygon_of_ring, weights=~left_out, minlength=len(polygons.unit))
    return polygons._replace(
        xy=polygons.xy[vertex],
        vertex=number[polygons.vertex[corner]],
        offsets=offsets,
        polygon_offsets=offsets_of(rest.astype(np.int64)),
        rows=none,
        row_start=none,
        inserted=polygons.inserted[corner],
    ), vertex


def _scaled(xy, offsets):
    """Bring extreme magnitudes to about 1, by a power of two: exact, but where digits would be lost."""
    count = len(offsets) - 1
    unit, largest, lost = np.ones(count), np.zeros(count), np.zeros(count, dtype=bool)
    some = np.flatnonzero(np.diff(offsets))
    if len(some):
        # along an axis numpy takes much longer
        largest[some] = np.maximum.reduceat(np.abs(xy).ravel(), 2 * offsets[some])
    extreme = np.flatnonzero(((largest <= 1e-50) & (largest > 0.0)) | (largest >= 1e50))
    for p in extreme.tolist():
        exponent = int(np.frexp(largest[p])[1])
        unit[p] = np.ldexp(1.0, exponent)
        own = slice(offsets[p], offsets[p + 1])
        scaled = np.ldexp(xy[own], -exponent)
        lost[p] = (np.ldexp(scaled, exponent) != xy[own]).any()
        xy[own] = scaled
    return xy, unit, lost


def _canonical(xy, offsets, kept, is_start, starts, corner_offsets, ring_polygon, good):
    """Turn the rings, rotate each to its smallest vertex, and sort the holes."""
    ring = np.flatnonzero(kept)
    polygon = np.cumsum(good)[ring_polygon[ring]] - 1
    is_hole = np.diff(polygon, prepend=-1) == 0
    if not len(ring):
        none = np.empty(0, dtype=np.int64)
        return Polygons(
            np.empty((0, 2)),
            np.empty(0),
            none,
            np.zeros(1, np.int64),
            np.zeros(1, np.int64),
            none,
            np.zeros(1, np.int64),
            np.empty(0, bool),
            np.empty(0, bool),
            none,
        )
    # the corner with the smallest x, of these the smallest y; rings are simple, so there is one
    first, end = corner_offsets[:-1], corner_offsets[1:]
    corner_xy = xy if len(starts) == len(xy) else xy.take(starts, axis=0)
    x = corner_xy[:, 0]
    leftmost = np.flatnonzero(x == spread(np.minimum.reduceat(x, first), corner_offsets))
    own = np.searchsorted(leftmost, first)
    y = corner_xy[leftmost, 1]
    lowest = np.repeat(np.minimum.reduceat(y, own), np.diff(np.append(own, len(leftmost))))
    smallest = leftmost[y == lowest]
    # where the ring turns left at it, it is counter-clockwise
    turn = orientations(
        corner_xy[np.where(smallest == first, end, smallest) - 1],
        corner_xy[smallest],
        corner_xy[np.where(smallest == end - 1, first, smallest + 1)],
    )
    backwards = (turn > 0) == is_hole

    lo, size = offsets[:-1][ring], np.diff(offsets)[ring]
    begin = starts[smallest]
    if backwards.any():
        # backwards a corner begins at its last row: the one before the next corner's first
        after = starts[following(corner_offsets)[smallest]] - lo - 1
        begin = np.where(backwards, lo + after % size, begin)
    row_offsets, step = offsets_of(size), np.where(backwards, -1, 1)
    rows = np.repeat(begin - step * row_offsets[:-1], size)
    rows += np.arange(len(rows)) if not backwards.any() else spread(step, row_offsets) * np.arange(len(rows))
    for past, back in (
        (rows >= spread(lo + size, row_offsets), -size),
        (rows < spread(lo, row_offsets), size),
    ):
        past = np.flatnonzero(past)
        rows[past] += back[np.searchsorted(row_offsets, past, side="right") - 1]
    whole = len(starts) == len(xy)  # every row is a corner
    begins = is_start if whole else is_start[rows]
    # a corner begins at its last row: the one before the next corner's first
    if backwards.any() and not whole:
        is_last = np.empty_like(is_start)
        is_last[:-1] = is_start[1:]
        is_last[lo + size - 1] = is_start[lo]
        begins = np.where(np.repeat(backwards, size), is_last[rows], begins)

    # holes in the order of their first two vertices
    if is_hole.any():
        head = np.flatnonzero(begins)
        at = corner_offsets[:-1]
        p, q = xy[rows[head[at]]], xy[rows[head[at + 1]]]
        key = np.where(is_hole[:, None], np.column_stack((p, q)), -np.inf)
        order = np.lexsort((key[:, 3], key[:, 2], key[:, 1], key[:, 0], polygon))
        index, _ = take(row_offsets, order)
        rows, begins = rows[index], begins[index]
        corner_offsets = offsets_of(np.diff(corner_offsets)[order])
    row_start = np.append(np.flatnonzero(begins), len(rows))
    return Polygons(
        xy=xy.take(rows[row_start[:-1]], axis=0),
        unit=None,
        vertex=np.arange(len(row_start) - 1),
        offsets=corner_offsets,
        polygon_offsets=np.append(np.flatnonzero(~is_hole), len(ring)),
        rows=rows,
        row_start=row_start,
        inserted=np.zeros(len(row_start) - 1, dtype=bool),
        shell_reversed=backwards[~is_hole],
        number=np.flatnonzero(good),
    )


def _reason(shape, unit):
    """GEOS's reason, its place in the units of the input."""
    try:
        reason = shapely.is_valid_reason(shape)
    except shapely.errors.GEOSException:
        return TOO_FINE
    if unit == 1.0:
        return reason
    return reason.split("[")[0].strip()


def _merge_touching(polygons):
    """Give touching rings common vertices; a touched edge gets a corner there.

    In a valid polygon two rings have at most one point in common. It is a vertex of at least one.
    """
    holes = np.diff(polygons.polygon_offsets) - 1
    if not holes.any():
        return polygons
    rings, _ = take(polygons.polygon_offsets, np.flatnonzero(holes > 0))
    merged = _one_vertex_a_place(polygons, rings)
    on_edge = _touching_on_edges(merged, rings)
    if not len(on_edge):
        return merged
    return _one_vertex_a_place(_insert_corners(polygons, merged.vertex, on_edge), rings)


def _one_vertex_a_place(polygons, rings):
    """Give the corners of some rings that are at one point of their polygon one vertex."""
    corners, _ = take(polygons.offsets, rings)
    x, y = polygons.xy[corners].T
    order = np.argsort(x, kind="stable")
    same = x[order[1:]] == x[order[:-1]]
    same = order[np.append(same, False) | np.append(False, same)]  # others are alone at their place
    owner = polygons.polygon_of_ring[polygons.ring_of_corner[corners[same]]]
    order = np.lexsort((y[same], x[same], owner))
    owner, x, y, corners = owner[order], x[same][order], y[same][order], corners[same][order]
    first = np.append(True, (owner[1:] != owner[:-1]) | (x[1:] != x[:-1]) | (y[1:] != y[:-1]))
    if first.all():
        return polygons
    representative = np.arange(len(polygons.vertex))
    representative[corners] = corners[np.maximum.accumulate(np.where(first, np.arange(len(first)), 0))]
    kept, vertex = np.unique(representative, return_inverse=True)
    return polygons._replace(xy=polygons.xy[kept], vertex=vertex.ravel())


def _touching_on_edges(polygons, rings):
    """Rings that touch others at no vertex that both have, ascending, and those joined to them by vertices.

    Rings that are joined by vertices do not touch anywhere else, or they would enclose a piece of the
    interior: so they are looked up as one. Else many holes at one point would be pairs, each with each.
    """
    component = boundary_components(polygons)
    corner, offsets = take(polygons.offsets, rings)
    lines = np.empty(len(component), dtype=object)
    lines[rings] = shapely.linearrings(polygons.xy[polygons.vertex[corner]], indices=groups(offsets))
    size = np.bincount(component)
    joined = rings[size[component[rings]] > 1]
    if len(joined):
        joined = joined[np.argsort(component[joined], kind="stable")]
        first, number = np.unique(component[joined], return_inverse=True)
        lines[first] = shapely.multilinestrings(lines[joined], indices=number)
    alone = rings[component[rings] == rings]
    owner = polygons.polygon_of_ring[alone]
    begin = np.flatnonzero(np.diff(owner, prepend=-1))
    size = np.diff(np.append(begin, len(alone)))
    # two: no tree is needed, and all such polygons are one call
    pair = alone[begin[size == 2]], alone[begin[size == 2] + 1]
    met = shapely.intersects(lines[pair[0]], lines[pair[1]])
    found = [pair[0][met], pair[1][met]]
    for lo, n in zip(begin[size > 2].tolist(), size[size > 2].tolist()):
        found += _intersecting(alone[lo : lo + n], lines)
    touching = np.zeros(len(component), dtype=bool)
    touching[np.concatenate(found)] = True
    return np.flatnonzero(touching[component])


def _intersecting(numbers, lines):
    """Those of some lines, given by their numbers, that meet another of them."""
    # the larger line of a pair is the prepared one: it is not walked again for each small line
    numbers = numbers[np.argsort(-shapely.get_num_coordinates(lines[numbers]), kind="stable")]
    lines = lines[numbers]
    shapely.prepare(lines)
    tree, found = shapely.STRtree(lines), []
    for lo in range(0, len(lines), 1000):  # boxes may meet each with each
        one, other = tree.query(lines[lo : lo + 1000])
        one += lo
        one, other = one[one < other], other[one < other]
        met = shapely.intersects(lines[one], lines[other])
        found += [numbers[one[met]], numbers[other[met]]]
    return found


def _insert_corners(polygons, vertex, touching):
    """Insert a corner where a vertex of one touching ring lies inside an edge of another.

    ``vertex`` tells which corners are at one point: each point is looked up once.
    """
    xy = polygons.xy
    owner = polygons.polygon_of_ring[touching]
    points, edges = [], []
    for rings in np.split(touching, np.flatnonzero(np.diff(owner)) + 1):
        corners, _ = take(polygons.offsets, rings)
        ends = corners[following(offsets_of(np.diff(polygons.offsets)[rings]))]
        segments = shapely.linestrings(np.stack((xy[corners], xy[ends]), axis=1))
        places = np.sort(corners[np.unique(vertex[corners], return_index=True)[1]])
        point, edge = shapely.STRtree(segments).query(shapely.points(xy[places]), predicate="intersects")
        points.append(places[point])
        edges.append(corners[edge])
    point, edge = np.concatenate(points), np.concatenate(edges)
    end = polygons.next_corner[edge]
    inside = (xy[point] != xy[edge]).any(axis=1) & (xy[point] != xy[end]).any(axis=1)
    point, edge = point[inside], edge[inside]
    if len(point) == 0:
        return polygons
    offset = xy[point] - xy[edge]
    along = np.lexsort((np.hypot(offset[:, 0], offset[:, 1]), edge))
    point, edge = point[along], edge[along]
    # two rings may touch an edge at the same point: one corner is enough
    repeated = np.append(False, (edge[1:] == edge[:-1]) & (xy[point[1:]] == xy[point[:-1]]).all(1))
    point, edge = point[~repeated], edge[~repeated]

    place = edge + 1
    added = np.bincount(
        np.searchsorted(polygons.offsets, edge, side="right"), minlength=len(polygons.offsets)
    )
    rows = np.insert(polygons.rows, polygons.row_start[place], polygons.rows[polygons.row_start[point]])
    row_count = np.insert(np.diff(polygons.row_start), place, 1)
    xy = np.insert(xy, place, xy[point], axis=0)
    return polygons._replace(
        xy=xy,
        vertex=np.arange(len(xy)),
        offsets=polygons.offsets + np.cumsum(added),
        rows=rows,
        row_start=offsets_of(row_count),
        inserted=np.insert(polygons.inserted, place, True),
    )
