"""Polygons with holes (section 4.3 of the paper): carve them open along spanning trees.

The edges of the tree T join the boundary components; walking around all of them, passing each edge
of T twice, gives one closed walk, and with it a polygon without holes P_T. Rings that touch are one
component: the walk simply passes from one to the other.

All polygons of a chunk go together. Those without holes stay as they are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..predicates import ccw_order
from ..rings import groups, offsets_of, ranges
from .polygon import Polygons

__all__ = ["Walk", "carve", "spanning_tree"]


class Walk(NamedTuple):
    """The closed walks around the P_T, with the interior on the left, one after the other.

    Attributes
    ----------
    corner : (m,) int
        For each place, the corner where it lies.
    edge : (m,) int
        The edge from each place to the next: c for the polygon edge that starts at corner c, or
        -1 - t for edge t of T.
    i, j : (k,) int
        Places of the ends of each candidate, i < j (both 0 for edges of T).
    offsets : (p + 1,) int
        Where the places of each polygon start.
    """

    corner: np.ndarray
    edge: np.ndarray
    i: np.ndarray
    j: np.ndarray
    offsets: np.ndarray


def spanning_tree(
    polygons: Polygons,
    component: np.ndarray,
    edges: np.ndarray,
    length: np.ndarray,
    wanted: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Join the wanted boundary components of each polygon by a minimum spanning tree (Kruskal).

    Parameters
    ----------
    polygons : Polygons
    component : (r,) int
        Component of each ring.
    edges : (k, 2) int
        Vertex indices of the edges to choose from.
    length : (k,) float
    wanted : (r,) bool
        Whether a component, by its number, is to be joined.

    Returns
    -------
    tree : (t,) int
        The edges of T, ascending. Ties of length are broken by the coordinates of the ends.
    apart : (p,) int
        How many components of each polygon its edges do not join to the others.

    Notes
    -----
    Section 4.3 of the paper. O(k log k) for k edges between components.

    Examples
    --------
    Of two edges from the shell to the hole the shorter one is taken.

    >>> from isthmus.core.partition.polygon import boundary_components, from_rings
    >>> from isthmus.core.rings import one_polygon
    >>> rings = np.array([[0, 0], [9, 0], [9, 9], [0, 9], [4, 4], [4, 5], [5, 4.0]])
    >>> polygons, _ = from_rings(one_polygon(rings, [0, 4, 7]))
    >>> edges, length = np.array([[2, 5], [0, 4]]), np.array([6.4, 5.7])
    >>> spanning_tree(polygons, boundary_components(polygons), edges, length, np.ones(2, dtype=bool))
    (array([1]), array([0]))
    """
    count = len(polygons.polygon_offsets) - 1
    own = np.flatnonzero(component == np.arange(len(component)))
    owner = polygons.polygon_of_ring
    apart = np.maximum(np.bincount(owner[own[wanted[own]]], minlength=count) - 1, 0)
    missing = int(apart.sum())
    if missing == 0:
        return np.empty(0, dtype=np.int64), apart
    of_vertex = np.empty(len(polygons.xy), dtype=np.int64)
    of_vertex[polygons.vertex] = np.repeat(component, np.diff(polygons.offsets))
    ends = of_vertex[edges]
    joining = np.flatnonzero((ends[:, 0] != ends[:, 1]) & wanted[ends].all(axis=1))
    joining = joining[_by_length(polygons.xy, edges[joining], length[joining])]
    root, tree = list(range(len(component))), []
    for edge, a, b in zip(joining.tolist(), *ends[joining].T.tolist()):
        while root[a] != a:
            root[a] = a = root[root[a]]
        while root[b] != b:
            root[b] = b = root[root[b]]
        if a != b:
            root[max(a, b)] = min(a, b)
            tree.append(edge)
            if len(tree) == missing:
                break
    tree = np.sort(np.array(tree, dtype=np.int64))
    return tree, apart - np.bincount(owner[ends[tree, 0]], minlength=count)


def carve(
    polygons: Polygons,
    component: np.ndarray,
    edges: np.ndarray,
    tree: np.ndarray,
    wanted: np.ndarray,
    toward: np.ndarray | None = None,
) -> tuple[Walk, np.ndarray]:
    """Walk around the polygons carved open along T, and place all candidates on the walks.

    Parameters
    ----------
    polygons : Polygons
    component : (r,) int
    edges : (k, 2) int
        Candidates; none at a vertex that only unwanted components have.
    tree : (t,) int
        Which of them are in T.
    wanted : (r,) bool
        The components that T joins, by their numbers. Others are no part of a walk.
    toward : (k, 2) int, optional
        For candidates that are not straight, the vertices toward which they leave either end.

    Returns
    -------
    walk : Walk
        Each polygon's starts at its shell's first corner.
    ambiguous : (p,) bool
        Polygons whose rings touch in such a way that there is no single walk around all of them. They
        have no places, and their candidates are nowhere.

    Notes
    -----
    Section 4.3 of the paper. O(n), and O(d log d) for a vertex of degree d that is passed more than once.
    A loop only over the turns of the walks from ring to ring.

    Examples
    --------
    Around the shell, along the edge of T to the hole, around the hole, and back.

    >>> from isthmus.core.partition.polygon import boundary_components, from_rings
    >>> from isthmus.core.rings import one_polygon
    >>> rings = np.array([[0, 0], [9, 0], [9, 9], [0, 9], [4, 4], [4, 5], [5, 4.0]])
    >>> polygons, _ = from_rings(one_polygon(rings, [0, 4, 7]))
    >>> edges, component = np.array([[2, 5], [0, 4]]), boundary_components(polygons)
    >>> walk, _ = carve(polygons, component, edges, np.array([1]), np.ones(2, dtype=bool))
    >>> walk.corner.tolist()
    [0, 1, 2, 3, 0, 4, 5, 6, 4]
    """
    corners, count = len(polygons.vertex), len(polygons.polygon_offsets) - 1
    if len(polygons.offsets) == count + 1:  # no holes: corners and vertices have the same numbers
        place = np.arange(corners)
        walk = Walk(place, place, np.minimum(*edges.T), np.maximum(*edges.T), polygons.corner_offsets)
        return walk, np.zeros(count, dtype=bool)

    corner_of = np.zeros(len(polygons.xy), dtype=np.int64)
    corner_of[polygons.vertex] = np.arange(corners)
    in_walk = np.repeat(wanted[component], np.diff(polygons.offsets))
    # half-edges: c leaves corner c; corners + 2 t and + 2 t + 1 are edge t of T, there and back
    after = np.append(polygons.next_corner, np.zeros(2 * len(tree), dtype=np.int64))
    leaves = corner_of[edges]  # the half-edge that leaves the place of each end
    toward = edges[:, ::-1] if toward is None else toward
    _turn(polygons, edges, toward, tree, in_walk, after, leaves)

    owner = groups(polygons.corner_offsets)
    owner = np.append(owner, np.repeat(owner[corner_of[edges[tree, 0]]], 2))
    expected = np.bincount(owner[:corners][in_walk], minlength=count)
    expected += np.bincount(owner[corners:], minlength=count)
    halves, offsets = _follow(polygons, after)
    ambiguous = np.diff(offsets) != expected
    if ambiguous.any():
        halves = halves[~np.repeat(ambiguous, np.diff(offsets))]
        offsets = offsets_of(np.where(ambiguous, 0, expected))

    start = np.append(np.arange(corners), corner_of[edges[tree]].ravel())
    place = np.zeros(len(after), dtype=np.int64)
    place[halves] = np.arange(len(halves))
    ends = np.sort(place[leaves], axis=1)
    ends[tree] = 0
    edge = np.where(halves < corners, halves, -1 - (halves - corners) // 2)
    return Walk(start[halves], edge, ends[:, 0], ends[:, 1], offsets), ambiguous


def _by_length(xy, edges, length):
    """Order of edges by length, ties by the coordinates of their ends."""
    vertex, ends = np.unique(edges, return_inverse=True)
    rank = np.empty(len(vertex), dtype=np.int64)
    rank[np.lexsort((xy[vertex, 1], xy[vertex, 0]))] = np.arange(len(vertex))
    first, second = np.sort(rank[ends.reshape(edges.shape)], axis=1).T
    return np.lexsort((second, first, length))


def _turn(polygons, edges, toward, tree, in_walk, after, leaves):
    """Link the half-edges at vertices passed several times; give candidates the wedge they leave from.

    Counter-clockwise, a wedge of the interior opens at the half-edge that leaves it and closes at
    the one that comes in: walking in, one turns clockwise to the next way out.
    """
    corners, vertex, n = len(polygons.vertex), polygons.vertex, len(polygons.xy)
    passes = np.bincount(vertex[in_walk], minlength=n)
    passes += np.bincount(edges[tree].ravel(), minlength=n)
    several = passes > 1

    # the spokes around these: boundary in and out, T, candidates
    out = np.flatnonzero(several[vertex] & in_walk)
    before = np.empty(corners, dtype=np.int64)
    before[polygons.next_corner] = np.arange(corners)
    ways = corners + np.arange(2 * len(tree))
    sides = edges.copy()
    sides[tree] = -1
    candidate, side = np.nonzero(np.append(several, False)[sides])
    at = np.concatenate((vertex[out], vertex[out], edges[tree].ravel(), edges[candidate, side]))
    to = np.concatenate(
        (
            vertex[before[out]],
            vertex[polygons.next_corner[out]],
            toward[tree].ravel(),
            toward[candidate, side],
        )
    )
    half = np.concatenate((before[out], out, ways, np.zeros(len(candidate), dtype=np.int64)))
    kind = np.repeat([_IN, _OUT, _TREE, _CANDIDATE], [len(out), len(out), len(ways), len(candidate)])
    number = np.append(np.zeros(len(at) - len(candidate), dtype=np.int64), 2 * candidate + side)
    order = ccw_order(at, polygons.xy[at], polygons.xy[to])
    at, half, kind, number = (x[order] for x in (at, half, kind, number))

    # the last way out before each spoke; before the first one, the last one around the vertex
    opens = (kind == _OUT) | (kind == _TREE)
    first = np.flatnonzero(np.diff(at, prepend=-1))
    size = np.diff(np.append(first, len(at)))
    latest = np.maximum.accumulate(np.where(opens, np.arange(len(at)), -1))
    around = np.repeat(latest[first + size - 1], size)
    latest = np.append(-1, latest)[: len(at)]
    latest = half[np.where(latest >= np.repeat(first, size), latest, around)]

    closing = kind == _IN
    after[half[closing]] = latest[closing]
    turning = kind == _TREE  # coming in along an edge of T is leaving it the other way
    after[corners + ((half[turning] - corners) ^ 1)] = latest[turning]
    placed = kind == _CANDIDATE
    leaves[number[placed] // 2, number[placed] % 2] = latest[placed]


_IN, _OUT, _TREE, _CANDIDATE = range(4)


def _follow(polygons, after):
    """The half-edges of the walks, each from its shell's first corner on, and where each walk starts.

    A walk that does not close is cut short.
    """
    corners, count = len(polygons.vertex), len(polygons.polygon_offsets) - 1
    jump = np.append(after[:corners] != np.arange(1, corners + 1), np.ones(len(after) - corners, bool))
    jump = np.flatnonzero(jump)
    # runs of half-edges along the rings: from where a jump leads to the next jump
    shell = polygons.corner_offsets[:-1]
    start = np.unique(np.append(after[jump], shell))
    end = jump[np.searchsorted(jump, start)]
    then = np.searchsorted(start, after[end])
    first = np.searchsorted(start, shell)

    runs, owner = [first], [np.arange(count)]
    several = np.flatnonzero(then[first] != first)
    following_run, most = then.tolist(), len(start)
    for p, begin in zip(several.tolist(), first[several].tolist()):
        path, run = [], following_run[begin]
        while run != begin and len(path) < most:
            path.append(run)
            run = following_run[run]
        runs.append(path)
        owner.append(np.full(len(path), p))
    runs, owner = np.concatenate(runs).astype(np.int64), np.concatenate(owner)
    order = np.argsort(owner, kind="stable")
    runs, owner = runs[order], owner[order]
    size = (end - start + 1)[runs]
    places = np.bincount(owner, weights=size, minlength=count).astype(np.int64)
    return ranges(start[runs], size), offsets_of(places)
