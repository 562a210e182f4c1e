"""Polygons with holes (section 4.3 of the paper): carve the polygon open along a spanning tree.

The edges of the tree T join the boundary components; walking around all of them, passing each edge
of T twice, gives one closed walk, and with it a polygon without holes P_T. Rings that touch are one
component: the walk simply passes from one to the other.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..errors import Unsolvable
from ..predicates import sort_ccw

__all__ = ["Walk", "carve", "components", "spanning_tree"]


class Walk(NamedTuple):
    """The closed walk around P_T, with the interior on its left.

    Attributes
    ----------
    corner : (m,) int
        For each place, the corner where it lies.
    edge : (m,) int
        The edge from each place to the next: c for the polygon edge that starts at corner c, or
        -1 - t for edge t of T.
    i, j : (k,) int
        Places of the ends of each candidate, i < j (both 0 for edges of T).
    """

    corner: np.ndarray
    edge: np.ndarray
    i: np.ndarray
    j: np.ndarray


def components(polygon):
    """Return the (r,) number of the boundary component of each ring; the shell has 0."""
    root = list(range(len(polygon.offsets) - 1))

    ring = polygon.ring_of_corner
    shared = np.flatnonzero(np.bincount(polygon.vertex)[polygon.vertex] > 1)
    shared = shared[np.argsort(polygon.vertex[shared], kind="stable")]
    for a, b in zip(shared[:-1], shared[1:]):
        if polygon.vertex[a] == polygon.vertex[b]:
            _union(root, ring[a], ring[b])
    return np.array([_find(root, k) for k in range(len(root))])


def spanning_tree(polygon, component, edges, length, wanted):
    """Join the wanted boundary components by a minimum spanning tree (Kruskal).

    Parameters
    ----------
    polygon : Polygon
    component : (r,) int
        Component of each ring.
    edges : (k, 2) int
        Vertex indices of the edges to choose from.
    length : (k,) float
    wanted : set of int
        The components to join.

    Returns
    -------
    (t,) int
        The edges of T, ascending. Ties of length are broken by the coordinates of the ends.

    Raises
    ------
    Unsolvable
        If the edges do not connect all of them.
    """
    if len(wanted) < 2:
        return np.empty(0, dtype=np.int64)
    of_vertex = np.empty(len(polygon.xy), dtype=np.int64)
    of_vertex[polygon.vertex] = component[polygon.ring_of_corner]
    ends = of_vertex[edges]
    joining = np.flatnonzero(
        (ends[:, 0] != ends[:, 1]) & np.isin(ends, list(wanted)).all(axis=1)
    )
    first, second = np.sort(_lexicographic_rank(polygon.xy)[edges[joining]], axis=1).T
    joining = joining[np.lexsort((second, first, length[joining]))]
    root = list(range(len(component)))
    tree = []
    for edge, (a, b) in zip(joining.tolist(), ends[joining].tolist()):
        if _union(root, a, b):
            tree.append(edge)
            if len(tree) == len(wanted) - 1:
                return np.sort(tree)
    apart = len({_find(root, k) for k in wanted}) - 1
    raise Unsolvable(
        f"the candidate diagonals do not connect {apart} of {len(wanted) - 1} holes to the rest"
    )


def carve(polygon, component, edges, tree, wanted):
    """Walk around the polygon carved open along T, and place all candidates on the walk.

    Parameters
    ----------
    polygon : Polygon
    component : (r,) int
    edges : (k, 2) int
        Candidates; none at a vertex that only unwanted components have.
    tree : (t,) int
        Which of them are in T.
    wanted : set of int
        The components that T joins. Others are no part of the walk.

    Returns
    -------
    Walk
        Starts at the shell's first corner.

    Notes
    -----
    O(n), and O(d log d) for a vertex of degree d that is passed more than once.
    """
    corners = len(polygon.vertex)
    in_walk = np.isin(component, list(wanted))[polygon.ring_of_corner]
    following = np.append(polygon.next_corner, np.empty(2 * len(tree), dtype=np.int64))
    # half-edges: c leaves corner c; corners + 2 t and + 2 t + 1 are edge t of T, there and back
    corner_of = np.zeros(len(polygon.xy), dtype=np.int64)
    corner_of[polygon.vertex] = np.arange(corners)
    is_tree = np.zeros(len(edges), dtype=bool)
    is_tree[tree] = True
    leaves = corner_of[edges]  # the half-edge that leaves the place of each end

    passes = np.bincount(polygon.vertex[in_walk], minlength=len(polygon.xy))
    passes += np.bincount(edges[tree].ravel(), minlength=len(polygon.xy))
    for vertex, spokes in _spokes(polygon, edges, tree, is_tree, passes, in_walk).items():
        _turn(polygon, vertex, spokes, following, leaves)

    halves = _follow(following, corners)
    if len(halves) != np.count_nonzero(in_walk) + 2 * len(tree):
        raise Unsolvable("the rings could not be connected (their touching is ambiguous)")
    start = np.append(np.arange(corners), corner_of[edges[tree]].ravel())
    place = np.zeros(len(following), dtype=np.int64)
    place[halves] = np.arange(len(halves))
    ends = np.sort(place[leaves], axis=1)
    ends[tree] = 0
    edge = np.where(halves < corners, halves, -1 - (halves - corners) // 2)
    return Walk(start[halves], edge, ends[:, 0], ends[:, 1])


def _spokes(polygon, edges, tree, is_tree, passes, in_walk):
    """For each vertex passed several times: (x, y, what, half-edge or candidate) of its edges."""
    several = np.flatnonzero(passes > 1)
    spokes = {vertex: [] for vertex in several.tolist()}
    if not spokes:
        return spokes
    corners, vertex = len(polygon.vertex), polygon.vertex

    def add(at, towards, what, payload):
        x, y = polygon.xy[towards]
        spokes[int(at)].append((x, y, what, int(payload)))

    at = np.flatnonzero((passes[vertex] > 1) & in_walk)
    previous = np.empty(corners, dtype=np.int64)
    previous[polygon.next_corner] = np.arange(corners)
    for c in at:
        add(vertex[c], vertex[previous[c]], "in", previous[c])
        add(vertex[c], vertex[polygon.next_corner[c]], "out", c)
    for t, (u, v) in enumerate(edges[tree]):
        add(u, v, "tree", corners + 2 * t)
        add(v, u, "tree", corners + 2 * t + 1)
    for side in (0, 1):
        for k in np.flatnonzero((passes[edges[:, side]] > 1) & ~is_tree):
            add(edges[k, side], edges[k, 1 - side], "candidate", 2 * k + side)
    return spokes


def _turn(polygon, vertex, spokes, following, leaves):
    """Link the half-edges at a vertex, and give candidates the wedge they leave from.

    Counter-clockwise, a wedge of the interior opens at the half-edge that leaves it and closes at
    the one that comes in: walking in, one turns clockwise to the next way out.
    """
    spokes = sort_ccw(polygon.xy[vertex], spokes)
    opening = [k for k, spoke in enumerate(spokes) if spoke[2] in ("out", "tree")]
    out = None
    for *_, what, payload in spokes[opening[0]:] + spokes[: opening[0] + 1]:
        if what == "candidate":
            leaves[payload // 2, payload % 2] = out
        elif what == "in":
            following[payload] = out
        elif what == "tree" and out is not None:
            following[_twin(payload, len(polygon.vertex))] = out
        if what in ("out", "tree"):
            out = payload


def _twin(half, corners):
    """The same edge of T, the other way."""
    return corners + ((half - corners) ^ 1)


def _follow(following, corners):
    """The half-edges of the walk, from the shell's first corner on, in runs along the rings."""
    jumps = np.flatnonzero(
        (following[:corners] != np.arange(1, corners + 1)) | (np.arange(1, corners + 1) == corners)
    )
    runs, half = [], 0
    for _ in range(len(following)):
        if half < corners:
            last = jumps[np.searchsorted(jumps, half)]
            runs.append(np.arange(half, last + 1))
            half = following[last]
        else:
            runs.append([half])
            half = following[half]
        if half == 0:
            break
    return np.concatenate(runs)


def _lexicographic_rank(xy):
    rank = np.empty(len(xy), dtype=np.int64)
    rank[np.lexsort((xy[:, 1], xy[:, 0]))] = np.arange(len(xy))
    return rank


def _find(root, k):
    while root[k] != k:
        root[k] = root[root[k]]
        k = root[k]
    return k


def _union(root, a, b):
    """Join two sets; whether they were apart. The smaller number stays the root."""
    a, b = _find(root, a), _find(root, b)
    if a == b:
        return False
    root[max(a, b)] = min(a, b)
    return True
