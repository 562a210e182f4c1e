"""Last stage: the faces of P and S become polygons of input rows.

Cuts are intervals on the walk, so the parts are the faces of their own nesting tree, and one sort
lists the boundary walks of all of them. A walk that meets itself, along an edge of T or at a vertex,
falls apart into a shell and holes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from .dual_tree import build_tree
from .polygon import signed_areas

__all__ = ["Parts", "build_parts"]


class Parts(NamedTuple):
    """The parts of a polygon, the largest first.

    Attributes
    ----------
    rings : list of list of (k,) int
        For each part its rings, the shell first: input rows, none repeated at the end.
    area : (m,) float
        In units of the metric.
    sides : (s, 2) int
        For each selected edge, in the order given, the parts on its two sides.
    """

    rings: list
    area: np.ndarray
    sides: np.ndarray


def build_parts(polygon, walk, selected, tree, equal_area):
    """Split a polygon along its selected edges.

    Parameters
    ----------
    polygon : Polygon
    walk : Walk
    selected : (s,) int
        Candidates in S, T included.
    tree : (t,) int
        Candidates in T.
    equal_area : callable
        See `metric.Metric`.

    Returns
    -------
    Parts

    Notes
    -----
    O(n), but for a sort of n + 2 |S| integers. Parts tile the polygon by construction: each
    half-edge of P and S is used exactly once.
    """
    m = len(walk.corner)
    is_cut = ~np.isin(selected, tree)
    cuts = selected[is_cut]
    i, j = walk.i[cuts], walk.j[cuts]
    faces = build_tree(m, i, j)
    count = len(cuts) + 1
    below = np.empty(len(cuts), dtype=np.int64)
    below[faces.diagonal] = np.arange(1, count)
    above = faces.parent[below]

    # half-edges: the walk's own, each cut on its way up (i to j), each cut on its way back
    face = np.concatenate((faces.edge_face, [0], above, below))
    place = np.concatenate((np.arange(m), i, j))
    edge = np.concatenate((walk.edge, np.full(2 * len(cuts), _CUT)))
    order = np.argsort(face * m + place, kind="stable")
    face, place, edge = face[order], place[order], edge[order]
    bounds = np.searchsorted(face, np.arange(count + 1))

    rings = _Rings(polygon, walk, bounds, place, edge)
    owner, corners, offsets = rings.split()
    owner, corners, offsets = _add_free_holes(polygon, walk, owner, corners, offsets)
    xy = equal_area(polygon.xy)
    area = np.bincount(owner, weights=signed_areas(xy[polygon.vertex[corners]], offsets),
                       minlength=count)
    area = np.maximum(area, 0.0)  # a sliver may turn over in the equal-area map
    rank = np.empty(count, dtype=np.int64)
    rank[np.lexsort((np.arange(count), -area))] = np.arange(count)

    sides = np.empty((len(selected), 2), dtype=np.int64)
    sides[is_cut] = np.column_stack((rank[below], rank[above]))
    if not is_cut.all():
        sides[~is_cut] = rank[_faces_of_tree(walk, faces.edge_face, np.searchsorted(
            tree, selected[~is_cut]))]
    with np.errstate(over="ignore"):
        area = np.sort(area)[::-1] * polygon.unit * polygon.unit
    return Parts(_rows(polygon, rank[owner], corners, offsets, count), area, sides)


_CUT = np.iinfo(np.int64).min


class _Rings(NamedTuple):
    """Boundary walks of the faces: face f has the half-edges bounds[f] to bounds[f + 1] - 1."""

    polygon: object
    walk: object
    bounds: np.ndarray
    place: np.ndarray
    edge: np.ndarray

    def split(self):
        """Rings of corners: the face of each, all corners, and where each ring starts."""
        vertex = self.polygon.vertex[self.walk.corner[self.place]]
        face = np.repeat(np.arange(len(self.bounds) - 1), np.diff(self.bounds))
        passes = np.bincount(self.polygon.vertex[self.walk.corner])
        meeting = np.unique(face[passes[vertex] > 1])
        meeting = meeting[self._meets_itself(meeting, vertex)]

        cycles = []
        for f in meeting:
            cycles += [(f, c) for c in _cycles(vertex, self.bounds[f], self.bounds[f + 1])]
        plain = np.ones(len(self.bounds) - 1, dtype=bool)
        plain[meeting] = False
        index = np.flatnonzero(plain[face])
        sizes = np.diff(self.bounds)[plain]
        owner = np.flatnonzero(plain)
        if cycles:
            index = np.concatenate([index] + [c for _, c in cycles])
            sizes = np.concatenate((sizes, [len(c) for _, c in cycles]))
            owner = np.concatenate((owner, [f for f, _ in cycles]))
        return self._corners(owner, index, np.append(0, np.cumsum(sizes)))

    def _meets_itself(self, faces, vertex):
        """Which of these faces pass a vertex twice."""
        return np.array(
            [
                len(np.unique(vertex[self.bounds[f]:self.bounds[f + 1]]))
                < self.bounds[f + 1] - self.bounds[f]
                for f in faces
            ],
            dtype=bool,
        )

    def _corners(self, owner, index, offsets):
        """Turn half-edges into the corners where they start, without inserted ones."""
        edge = self.edge[index]
        previous = edge[_previous(offsets)]
        own = np.where(edge >= 0, edge, 0)
        after = self.polygon.next_corner[np.where(previous >= 0, previous, 0)]
        corner = np.where(
            edge >= 0, own, np.where(previous >= 0, after, self.walk.corner[self.place[index]])
        )
        # an inserted corner was only needed to walk; along its edge nobody shall see it
        needless = self.polygon.inserted[own] & (edge >= 0) & (previous >= 0) & (after == own)
        kept = np.add.reduceat((~needless).astype(np.int64), offsets[:-1])
        return owner, corner[~needless], np.append(0, np.cumsum(kept))


def _cycles(vertex, lo, hi):
    """Split a closed walk where it meets itself: arrays of places in it, one a simple cycle."""
    vertex = vertex[lo:hi].tolist()
    stack, depth, cycles = [], {}, []
    for k, v in enumerate(vertex):
        if v in depth:
            base = depth[v]
            cycles.append(stack[base:])
            for passed in stack[base:]:
                del depth[vertex[passed]]
            del stack[base:]
        depth[v] = len(stack)
        stack.append(k)
    cycles.append(stack)
    # an edge of T there and back is no ring
    return [lo + np.array(cycle) for cycle in cycles if len(cycle) > 2]


def _previous(offsets):
    """Index of the element before each in its ring."""
    before = np.arange(-1, offsets[-1] - 1)
    before[offsets[:-1]] = offsets[1:] - 1
    return before


def _add_free_holes(polygon, walk, owner, corners, offsets):
    """Put the rings that the walk leaves out into the parts that contain them."""
    walked = np.zeros(len(polygon.offsets) - 1, dtype=bool)
    walked[polygon.ring_of_corner[walk.corner]] = True
    free = np.flatnonzero(~walked)
    if len(free) == 0:
        return owner, corners, offsets
    points = polygon.xy[polygon.vertex]
    lines = shapely.linearrings(
        points[corners], indices=np.repeat(np.arange(len(owner)), np.diff(offsets))
    )
    shells = np.flatnonzero(shapely.is_ccw(lines))
    # a free hole touches nothing: the innermost shell around it is that of its part
    inside, around = shapely.STRtree(shapely.polygons(lines[shells])).query(
        shapely.points(points[polygon.offsets[free]]), predicate="within"
    )
    around = shells[around]
    order = np.lexsort((signed_areas(points[corners], offsets)[around], inside))
    first = order[np.diff(inside[order], prepend=-1) != 0]
    rings = [np.arange(polygon.offsets[r], polygon.offsets[r + 1]) for r in free]
    rings = [ring[~polygon.inserted[ring]] for ring in rings]
    return (
        np.concatenate((owner, owner[around[first]])),
        np.concatenate([corners] + rings),
        np.concatenate((offsets, offsets[-1] + np.cumsum([len(ring) for ring in rings]))),
    )


def _faces_of_tree(walk, edge_face, numbers):
    """Faces on the two sides of edges of T."""
    edge_face = np.append(edge_face, 0)
    places = np.flatnonzero(walk.edge < 0)
    places = places[np.argsort(-1 - walk.edge[places], kind="stable")].reshape(-1, 2)
    return edge_face[places[numbers]]


def _rows(polygon, owner, corners, offsets, count):
    """Rings of input rows for each part, shells turned as the input's."""
    repeat = np.diff(polygon.row_start)[corners]
    ends = np.cumsum(repeat)
    within = np.arange(ends[-1]) - np.repeat(ends - repeat, repeat)
    rows = polygon.rows[np.repeat(polygon.row_start[corners], repeat) + within]
    ring_ends = np.append(0, ends)[offsets]
    order = np.argsort(owner, kind="stable")
    several = np.flatnonzero(np.bincount(owner, minlength=count)[owner[order]] > 1)
    if len(several):
        order[several] = order[several][_shells_first(polygon, owner, corners, offsets,
                                                      order[several])]
    rings = [[] for _ in range(count)]
    step = -1 if polygon.shell_reversed else 1
    for ring, part in zip(order.tolist(), owner[order].tolist()):
        rings[part].append(rows[ring_ends[ring]:ring_ends[ring + 1]][::step])
    return rings


def _shells_first(polygon, owner, corners, offsets, rings):
    """Order of the rings of parts with holes: by part, its only counter-clockwise ring first."""
    points = polygon.xy[polygon.vertex]
    ccw = shapely.is_ccw(
        shapely.linearrings(
            np.concatenate([points[corners[offsets[r]:offsets[r + 1]]] for r in rings]),
            indices=np.repeat(np.arange(len(rings)), np.diff(offsets)[rings]),
        )
    )
    return np.lexsort((rings, ~ccw, owner[rings]))
