"""Last stage: the faces of P and S become polygons of input rows.

Cuts are intervals on the walk, so the parts are the faces of their own nesting tree, and one sort
lists the boundary walks of all of them. A walk that meets itself, along an edge of T or at a vertex,
falls apart into a shell and holes.
"""

from __future__ import annotations

from typing import Callable, Iterator, NamedTuple

import numpy as np
import shapely

from ..rings import cycles, groups, offsets_of, previous, ranges, signed_areas, take
from .carving import Walk
from .dual_tree import build_tree
from .polygon import Polygons

__all__ = ["Faces", "Over", "Parts", "build_parts", "faces_of", "merged_parts"]

_CUT = np.iinfo(np.int64).min


class Parts(NamedTuple):
    """The parts of polygons; those of a polygon stand together, the largest first.

    Attributes
    ----------
    rows : (k,) int
        Input rows of all rings, none repeated at the end of a ring.
    offsets : (r + 1,) int
        Where each ring starts.
    ring_offsets : (m + 1,) int
        Where the rings of each part start, its shell first.
    part_offsets : (p + 1,) int
        Where the parts of each polygon start.
    area : (m,) float
        In units of the metric.
    sides : (s, 2) int
        For each selected edge, in the order given, the parts on its two sides.
    """

    rows: np.ndarray
    offsets: np.ndarray
    ring_offsets: np.ndarray
    part_offsets: np.ndarray
    area: np.ndarray
    sides: np.ndarray

    @property
    def rings(self) -> list:
        """For each part the list of its rings."""
        rings = np.split(self.rows, self.offsets[1:-1])
        bounds = self.ring_offsets.tolist()
        return [rings[lo:hi] for lo, hi in zip(bounds[:-1], bounds[1:])]


class Faces(NamedTuple):
    """The half-edges of the faces of P and S: the walk's own, and each cut on its way up (i to j) and back.

    A cut has the face below it and that above it; the faces are the roots, then those below the cuts.

    Attributes
    ----------
    is_cut : (s,) bool
        Which of the selected edges are not in T.
    below, above : (c,) int
        The faces at each of these cuts.
    polygon : (f,) int
        The polygon of each face.
    face, place, edge : (h,) int
        For each half-edge its face, the place where it starts, and the walk's edge; of cut c it is _CUT + c.
    order : (h,) int
        The half-edges by face, those of a face in the order of its boundary.
    """

    is_cut: np.ndarray
    below: np.ndarray
    above: np.ndarray
    polygon: np.ndarray
    face: np.ndarray
    place: np.ndarray
    edge: np.ndarray
    order: np.ndarray


class Over(NamedTuple):
    """Which edges are ways over islands that no walk passes (`gates.Gates`).

    Attributes
    ----------
    gate : (k,) int
        The way of each, -1 for a diagonal.
    vertex, offsets
        See `gates.Gates`.
    """

    gate: np.ndarray
    vertex: np.ndarray
    offsets: np.ndarray

    def way(self, k: int) -> np.ndarray:
        """The vertices of a way."""
        return self.vertex[self.offsets[k] : self.offsets[k + 1]]


def faces_of(walk: Walk, selected: np.ndarray, tree: np.ndarray) -> Faces:
    """Return the faces of P and S; parameters as in `build_parts`.

    Notes
    -----
    O(n), but for a sort of n + 2 |S| integers.

    Examples
    --------
    A hexagon of six places, cut from place 1 to place 4: three edges of the walk on either side.

    >>> none = np.empty(0, dtype=int)
    >>> walk = Walk(np.arange(6), np.arange(6), np.array([1]), np.array([4]), np.array([0, 6]))
    >>> faces_of(walk, np.array([0]), none).face.tolist()
    [0, 1, 1, 1, 0, 0, 0, 1]
    """
    m, roots = len(walk.corner), len(walk.offsets) - 1
    is_cut = ~np.isin(selected, tree) if len(tree) else np.ones(len(selected), dtype=bool)
    cuts = selected[is_cut]
    i, j = walk.i[cuts], walk.j[cuts]
    faces = build_tree(walk.offsets, i, j)
    count = roots + len(cuts)
    below = np.empty(len(cuts), dtype=np.int64)
    below[faces.diagonal] = np.arange(roots, count)
    above = faces.parent[below]
    polygon = np.arange(count)
    polygon[below] = groups(walk.offsets)[i]
    face, place = np.concatenate((faces.edge_face, above, below)), np.concatenate((np.arange(m), i, j))
    edge = np.concatenate((walk.edge, _CUT + np.arange(len(cuts)), _CUT + np.arange(len(cuts))))
    order = np.argsort(face * m + place, kind="stable")
    return Faces(is_cut, below, above, polygon, face, place, edge, order)


def build_parts(
    polygons: Polygons,
    walk: Walk,
    selected: np.ndarray,
    tree: np.ndarray,
    equal_area: Callable,
    *,
    faces: Faces | None = None,
    over: Over | None = None,
) -> Parts:
    """Split polygons along their selected edges.

    Parameters
    ----------
    polygons : Polygons
    walk : Walk
    selected : (s,) int
        Candidates in S, T included.
    tree : (t,) int
        Candidates in T, ascending.
    equal_area : callable
        See `metric.Metric`.
    faces : Faces, optional
        Where they are known: see `faces_of`.
    over : Over, optional
        The ways over islands among the edges.

    Returns
    -------
    Parts

    Notes
    -----
    O(n), but for a sort of n + 2 |S| integers. Parts tile the polygon by construction: each
    half-edge of P and S is used exactly once.

    Examples
    --------
    An hourglass is cut in two at its waist, between rows 1 and 4; the right half is the larger one.

    >>> from isthmus.core.metric import planar
    >>> from isthmus.core.partition.carving import carve
    >>> from isthmus.core.partition.polygon import one
    >>> rows = np.array([(0, 0), (10, 4), (20, 0), (20, 10), (10, 5), (0, 9.0)])
    >>> hourglass, waist, uncut = one(rows, [0, 6]), np.array([(1, 4)]), np.empty(0, dtype=int)
    >>> walk, _ = carve(hourglass, np.zeros(1, dtype=int), waist, uncut, np.ones(1, dtype=bool))
    >>> parts = build_parts(hourglass, walk, np.array([0]), uncut, planar().equal_area)
    >>> [[ring.tolist() for ring in rings] for rings in parts.rings], parts.area.tolist()
    ([[[1, 2, 3, 4]], [[0, 1, 4, 5]]], [55.0, 50.0])
    >>> parts.sides.tolist()
    [[0, 1]]
    """
    faces = faces or faces_of(walk, selected, tree)
    roots, below, above, is_cut = len(polygons.unit), faces.below, faces.above, faces.is_cut
    count = roots + len(below)
    place, edge = faces.place[faces.order], faces.edge[faces.order]
    bounds = offsets_of(np.bincount(faces.face, minlength=count))

    ways = _Ways(polygons, faces, selected, tree, over) if over is not None else None
    owner, corners, offsets = _rings(polygons, walk, bounds, place, edge, ways)
    free, target = _free_holes(polygons, walk, ways, faces.polygon, owner, corners, offsets)
    owner, corners, offsets = _with_holes(polygons, owner, corners, offsets, free, target)
    plane = equal_area(polygons.corner_xy).take(corners, axis=0)
    area = np.bincount(owner, weights=signed_areas(plane, offsets), minlength=count)
    area = np.maximum(area, 0.0)  # a sliver may turn over in the equal-area map
    polygon = faces.polygon
    order = np.lexsort((np.arange(count), -area, polygon))
    rank = np.empty(count, dtype=np.int64)
    rank[order] = np.arange(count)

    sides = np.empty((len(selected), 2), dtype=np.int64)
    sides[is_cut] = np.column_stack((rank[below], rank[above]))
    if len(tree):
        sides[~is_cut] = rank[
            _faces_of_tree(walk, faces.face[: len(walk.corner)], np.searchsorted(tree, selected[~is_cut]))
        ]
    unit = polygons.unit[polygon[order]]
    with np.errstate(over="ignore"):
        area = area[order] * unit * unit
    rows, offsets, ring_offsets = _rows(polygons, rank[owner], corners, offsets, count, polygon[owner])
    return Parts(rows, offsets, ring_offsets, offsets_of(np.bincount(polygon, minlength=roots)), area, sides)


def merged_parts(
    polygons: Polygons,
    walk: Walk,
    selected: np.ndarray,
    tree: np.ndarray,
    parts: Parts,
    pieces: np.ndarray,
    offsets: np.ndarray,
    *,
    most: int = 2_000_000,
    over: Over | None = None,
) -> Iterator:
    """Yield what `build_parts` makes of unions of parts, without the cuts between their pieces.

    Parameters
    ----------
    polygons, walk, selected, tree
        See `build_parts`.
    parts : Parts
        What it made of these.
    pieces : (k,) int
        The parts that make up each union; these must hang together by cuts.
    offsets : (u + 1,) int
        Where the pieces of each union start.
    most : int
        Half-edges that are worked on at once, or those of one union: a body may come again and again.
    over : Over, optional
        See `build_parts`.

    Yields
    ------
    rows, offsets, ring_offsets
        Of the next unions, as in `Parts`.

    Notes
    -----
    O(n) and a sort of the half-edges of all unions, pieces counted as often as they are in one.

    Examples
    --------
    The halves of an hourglass, and what they make together:

    >>> from isthmus.core.metric import planar
    >>> from isthmus.core.partition.carving import carve
    >>> from isthmus.core.partition.polygon import one
    >>> rows = np.array([(0, 0), (10, 4), (20, 0), (20, 10), (10, 5), (0, 9.0)])
    >>> hourglass, waist, uncut = one(rows, [0, 6]), np.array([(1, 4)]), np.empty(0, dtype=int)
    >>> walk, _ = carve(hourglass, np.zeros(1, dtype=int), waist, uncut, np.ones(1, dtype=bool))
    >>> parts = build_parts(hourglass, walk, np.array([0]), uncut, planar().equal_area)
    >>> [[ring.tolist() for ring in rings] for rings in parts.rings]
    [[[1, 2, 3, 4]], [[0, 1, 4, 5]]]
    >>> both, offsets = np.array([0, 1]), np.array([0, 2])
    >>> union, _, _ = next(merged_parts(hourglass, walk, np.array([0]), uncut, parts, both, offsets))
    >>> union.tolist()
    [0, 1, 2, 3, 4, 5]
    """
    faces = faces_of(walk, selected, tree)
    m, roots, below = len(walk.corner), len(polygons.unit), faces.below
    number = parts.part_offsets[:-1]  # the part of each face
    number = np.append(number, np.empty(len(below), dtype=np.int64))
    cut_sides = parts.sides[faces.is_cut]
    number[below], number[faces.above] = cut_sides[:, 0], cut_sides[:, 1]
    part = number[faces.face]
    order = np.argsort(part, kind="stable")
    start = np.searchsorted(part[order], np.arange(len(number) + 1))
    # each cut is two half-edges; the walk's own edges are none
    cut = np.append(np.full(m, -1), np.tile(np.arange(len(below)), 2))
    polygon_of_part = np.repeat(np.arange(roots), np.diff(parts.part_offsets))

    ways = _Ways(polygons, faces, selected, tree, over) if over is not None else None
    finest = _rings(
        polygons,
        walk,
        offsets_of(np.bincount(faces.face, minlength=len(number))),
        faces.place[faces.order],
        faces.edge[faces.order],
        ways,
    )
    free, target = _free_holes(polygons, walk, ways, faces.polygon, *finest)
    by_target = np.argsort(number[target], kind="stable")
    free_start = np.searchsorted(number[target[by_target]], np.arange(len(number) + 1))

    size = np.add.reduceat(np.diff(start)[pieces], offsets[:-1]) if len(pieces) else offsets[:0]
    total = np.cumsum(size)
    lo = 0
    while lo < len(size):
        hi = max(int(np.searchsorted(total, total[lo] - size[lo] + most, side="right")), lo + 1)
        own = pieces[offsets[lo] : offsets[hi]]
        union = np.repeat(np.arange(hi - lo), np.diff(offsets[lo : hi + 1]))
        index, its = take(start, own)
        half, of = order[index], np.repeat(union, np.diff(its))
        # a cut with both half-edges in a union is inside
        sides = np.flatnonzero(cut[half] >= 0)
        key = of[sides] * len(below) + cut[half[sides]]
        inside, which, times = np.unique(key, return_inverse=True, return_counts=True)
        kept = np.ones(len(half), dtype=bool)
        kept[sides[times[which] == 2]] = False
        half, of = half[kept], of[kept]
        along = np.argsort(of * m + faces.place[half], kind="stable")
        half, of = half[along], of[along]
        owner, corners, rings = _rings(
            polygons,
            walk,
            np.searchsorted(of, np.arange(hi - lo + 1)),
            faces.place[half],
            faces.edge[half],
            ways,
        )
        index, its = take(free_start, own)
        holes, of = free[by_target[index]], np.repeat(union, np.diff(its))
        if ways is not None:  # the islands of a way inside are holes again
            its_union, number = np.divmod(inside[times == 2], len(below))
            of_inside, islands = ways.islands(ways.of_cut[number])
            holes, of = np.append(holes, islands), np.append(of, its_union[of_inside])
        owner, corners, rings = _with_holes(polygons, owner, corners, rings, holes, of)
        polygon = polygon_of_part[pieces[offsets[lo:hi]]]
        yield _rows(polygons, owner, corners, rings, hi - lo, polygon[owner])
        lo = hi


class _Ways:
    """Ways over islands among cuts: what they add to the boundaries of faces, and what they leave open."""

    def __init__(self, polygons, faces, selected, tree, over):
        self.polygons, self.over = polygons, over
        self.of_cut, self.of_tree = over.gate[selected[faces.is_cut]], over.gate[tree]
        self.corner_of = np.empty(len(polygons.xy), dtype=np.int64)
        self.corner_of[polygons.vertex] = np.arange(len(polygons.vertex))

    def opened(self, walk, bounds, place, edge):
        """Half-edges of faces with those along the islands; a place beyond the walk is a corner."""
        cut = np.flatnonzero(edge < 0)
        number = edge[cut] - _CUT
        by_tree = number >= len(self.of_cut)
        way = np.empty(len(cut), dtype=np.int64)
        way[by_tree], way[~by_tree] = self.of_tree[-1 - edge[cut[by_tree]]], self.of_cut[number[~by_tree]]
        cut, way = cut[way >= 0], way[way >= 0]
        if not len(cut):
            return bounds, place, edge
        polygons, m = self.polygons, len(walk.corner)
        start = polygons.vertex[walk.corner[place[cut]]]
        after, places, edges = [], [], []
        for k, own, begin in zip(cut.tolist(), way.tolist(), start.tolist()):
            vertex = self.over.way(own)
            vertex = vertex if vertex[0] == begin else vertex[::-1]
            for land, leave in self.corner_of[vertex[1:-1]].reshape(-1, 2).tolist():
                lo, hi = polygons.offsets[polygons.ring_of_corner[land] + np.arange(2)]
                path = lo + np.arange(land - lo, land - lo + (leave - land) % (hi - lo)) % (hi - lo)
                places += [m + path, [m + leave]]
                edges += [path, [_CUT]]
                after.append(np.full(len(path) + 1, k + 1))
        after = np.concatenate(after)
        return (
            bounds + np.searchsorted(np.sort(after), bounds, side="right"),
            np.insert(place, after, np.concatenate(places)),
            np.insert(edge, after, np.concatenate(edges)),
        )

    def islands(self, ways):
        """The rings on ways: for each the place of its way, and its number."""
        some = np.flatnonzero(ways >= 0)
        index, offsets = take(self.over.offsets, ways[some])
        inner = np.ones(len(index), dtype=bool)
        inner[offsets[:-1]] = inner[offsets[1:] - 1] = False
        landing = self.corner_of[self.over.vertex[index[inner][::2]]]
        return np.repeat(some, np.diff(offsets) // 2 - 1), self.polygons.ring_of_corner[landing]


def _rings(polygons, walk, bounds, place, edge, ways):
    """Rings of corners: the face of each, all corners, and where each ring starts."""
    corner_at = walk.corner
    if ways is not None:
        bounds, place, edge = ways.opened(walk, bounds, place, edge)
        corner_at = np.append(corner_at, np.arange(len(polygons.vertex)))
    if polygons.apart and not (walk.edge < 0).any():
        owner, index, offsets = np.arange(len(bounds) - 1), slice(None), bounds
    else:
        index, offsets, owner = cycles(polygons.vertex[corner_at[place]], bounds)
    edge, place = edge[index], place[index]
    # half-edges become the corners where they start
    corner, before, cut = edge.copy(), previous(offsets), np.flatnonzero(edge < 0)
    edge_before = edge[before[cut]]
    after = polygons.next_corner[np.maximum(edge_before, 0)]
    corner[cut] = np.where(edge_before >= 0, after, corner_at[place[cut]])
    if not polygons.inserted.any():
        return owner, corner, offsets
    # an inserted corner was only needed to walk; along its edge nobody shall see it
    before = edge[before]
    after = polygons.next_corner[np.maximum(before, 0)]
    needless = polygons.inserted[corner] & (edge >= 0) & (before >= 0) & (after == edge)
    kept = np.add.reduceat((~needless).astype(np.int64), offsets[:-1])
    return owner, corner[~needless], offsets_of(kept)


def _free_holes(polygons, walk, ways, polygon_of, owner, corners, offsets):
    """The rings that the walks leave out, and the face that contains each."""
    walked = np.zeros(len(polygons.offsets) - 1, dtype=bool)
    if len(walked) == len(polygons.unit):  # no holes
        return np.empty((2, 0), dtype=np.int64)
    walked[polygons.ring_of_corner[walk.corner]] = True
    if ways is not None:
        walked[ways.islands(np.append(ways.of_cut, ways.of_tree))[1]] = True
    free = np.flatnonzero(~walked)
    if not len(free):
        return free, free
    ring_polygon = polygon_of[owner]
    by_polygon = np.argsort(ring_polygon, kind="stable")
    bounds = np.searchsorted(ring_polygon[by_polygon], np.arange(len(polygons.unit) + 1))
    points = polygons.corner_xy
    free_polygon = polygons.polygon_of_ring[free]
    target = np.empty(len(free), dtype=np.int64)
    for holes in np.split(np.arange(len(free)), np.flatnonzero(np.diff(free_polygon)) + 1):
        p = free_polygon[holes[0]]
        ring = by_polygon[bounds[p] : bounds[p + 1]]
        index, own = take(offsets, ring)
        lines = shapely.linearrings(points[corners[index]], indices=groups(own))
        is_shell = shapely.is_ccw(lines)
        size = signed_areas(points[corners[index]], own)[is_shell]
        # a free hole touches nothing: the innermost shell around it is that of its part
        inside, around = shapely.STRtree(shapely.polygons(lines[is_shell])).query(
            shapely.points(points[polygons.offsets[free[holes]]]), predicate="within"
        )
        order = np.lexsort((size[around], inside))
        first = order[np.diff(inside[order], prepend=-1) != 0]
        target[holes[inside[first]]] = owner[ring[is_shell][around[first]]]
    return free, target


def _with_holes(polygons, owner, corners, offsets, free, target):
    """Put rings that the walks leave out into the faces that contain them."""
    if not len(free):
        return owner, corners, offsets
    index, sizes = take(polygons.offsets, free)
    kept = ~polygons.inserted[index]
    return (
        np.concatenate((owner, target)),
        np.concatenate((corners, index[kept])),
        np.append(offsets, offsets[-1] + np.cumsum(np.add.reduceat(kept.astype(np.int64), sizes[:-1]))),
    )


def _faces_of_tree(walk, edge_face, numbers):
    """Faces on the two sides of edges of T."""
    places = np.flatnonzero(walk.edge < 0)
    places = places[np.argsort(-1 - walk.edge[places], kind="stable")].reshape(-1, 2)
    return edge_face[places[numbers]]


def _rows(polygons, owner, corners, offsets, count, polygon):
    """Rings of input rows for each part, shells turned as the input's: rows, rings, parts."""
    ring_size = np.diff(offsets)
    order = np.argsort(owner, kind="stable")
    several = np.flatnonzero(np.bincount(owner, minlength=count)[owner[order]] > 1)
    if len(several):
        order[several] = order[several][_shells_first(polygons, owner, corners, offsets, order[several])]
    corner, _ = take(offsets, order)
    corner = corners[corner]
    offsets = offsets_of(ring_size[order])
    if len(polygons.rows) == len(polygons.vertex):  # a row for each corner
        rows = polygons.rows[corner]
    else:
        repeat = np.diff(polygons.row_start)[corner]
        rows = polygons.rows[ranges(polygons.row_start[corner], repeat)]
        offsets = offsets_of(repeat)[offsets]
    turned = polygons.shell_reversed[polygon[order]]
    if turned.any():
        size = np.diff(offsets)
        back = np.repeat(offsets[1:] + offsets[:-1] - 1, size) - np.arange(len(rows))
        rows = rows[back if turned.all() else np.where(np.repeat(turned, size), back, np.arange(len(rows)))]
    return rows, offsets, offsets_of(np.bincount(owner, minlength=count))


def _shells_first(polygons, owner, corners, offsets, rings):
    """Order of the rings of parts with holes: by part, its only counter-clockwise ring first."""
    points = polygons.corner_xy
    index, own = take(offsets, rings)
    ccw = shapely.is_ccw(shapely.linearrings(points[corners[index]], indices=groups(own)))
    return np.lexsort((rings, ~ccw, owner[rings]))
