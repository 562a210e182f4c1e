"""Fifth stage: true distances in P and S, and what they say about the cuts.

On a polygon without holes the tree knows all distances. With holes, a path may pass a hole on
either side, and the carved polygon P_T only gives upper bounds (section 4.3 of the paper). The
boundary graph here gives the true ones: it keeps the ends of the cuts as nodes and contracts the
boundary between them, so its size is that of S. That of a chunk of polygons is the union of theirs.
"""

from __future__ import annotations

from heapq import heappop, heappush
from math import dist, inf
from typing import TYPE_CHECKING, Callable, NamedTuple

import numpy as np

from ..rings import offsets_of, running
from .min_size import LEAF, SLACK
from .polygon import Polygons

if TYPE_CHECKING:
    from .solve import Carved

__all__ = [
    "BoundaryGraph",
    "at_least_one",
    "boundary_graph",
    "detours",
    "drop_redundant",
    "largest_dilation",
    "true_dilations",
]


class BoundaryGraph(NamedTuple):
    """P and S with the boundary contracted between the nodes.

    Attributes
    ----------
    links : list of dict
        For each node its links, (other node, length) by number: that of the edge of S, or a negative one
        for a stretch of the boundary.
    place : list of tuple
        Where each node is. No way between two places is shorter than the straight line.
    position : (n, d) float
        Where each vertex is.
    node : (n,) int
        Node of each vertex, -1 where it is none.
    before, after : (n,) int
        Nodes next to each vertex along its ring (-1: the ring has no node).
    to_before, to_after : (n,) float
        Distances to these along the ring.
    ring, along, perimeter : (n,) int, (n,) float, (n,) float
        The ring of each vertex, its place along it, and the ring's perimeter.
    """

    links: list
    place: list
    position: np.ndarray
    node: np.ndarray
    before: np.ndarray
    after: np.ndarray
    to_before: np.ndarray
    to_after: np.ndarray
    ring: np.ndarray
    along: np.ndarray
    perimeter: np.ndarray


def boundary_graph(
    polygons: Polygons,
    position: np.ndarray,
    edge_length: np.ndarray,
    edges: np.ndarray,
    length: np.ndarray,
    selected: np.ndarray,
) -> BoundaryGraph:
    """Contract P and S to the ends of the selected edges and the points where rings touch.

    Parameters
    ----------
    polygons : Polygons
    position : (n, d) float
        Where the vertices are, in the unit of the lengths: straight lines between them are at most as long
        as the edges.
    edge_length : (c,) float
        Length of the polygon edge that leaves each corner.
    edges : (k, 2) int
    length : (k,) float
    selected : (s,) int
        The edges in S.

    Returns
    -------
    BoundaryGraph

    Notes
    -----
    O(n + |S|).

    Examples
    --------
    A rectangle and its diagonal: two nodes, half of the boundary between them on either side.

    >>> from isthmus.core.partition.polygon import from_rings
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [4, 0], [4, 3], [0, 3.0]])
    >>> rectangle, _ = from_rings(one_polygon(xy, [0, 4]))
    >>> around, diagonal, length = np.array([4, 3, 4, 3.0]), np.array([[0, 2]]), np.array([5.0])
    >>> boundary_graph(rectangle, rectangle.xy, around, diagonal, length, np.array([0])).links[0]
    {-1: (1, 7.0), -2: (1, 7.0), 0: (1, 5.0)}
    """
    n, vertex, offsets = len(polygons.xy), polygons.vertex, polygons.offsets
    is_node = np.bincount(vertex, minlength=n) > 1
    is_node[edges[selected]] = True
    at_node = np.flatnonzero(is_node)
    node = np.full(n, -1)
    node[at_node] = np.arange(len(at_node))
    ring = polygons.ring_of_corner
    along, perimeter = running(edge_length, offsets)
    perimeter = perimeter[ring]

    # the stops of a ring are its corners at nodes; find the last one up to here, and the next
    stop = np.flatnonzero(is_node[vertex])
    first = np.searchsorted(stop, offsets)
    here = np.cumsum(is_node[vertex])
    wraps_back, wraps_on = here == first[ring], here == first[ring + 1]
    bare = wraps_back & wraps_on
    stop = np.append(stop, 0)
    previous = stop[np.where(wraps_back, first[ring + 1], here) - 1]
    following = stop[np.where(wraps_on, first[ring], here)]
    back = along - along[previous] + np.where(wraps_back, perimeter, 0.0)
    on = along[following] - along + np.where(wraps_on, perimeter, 0.0)

    links = [{} for _ in range(len(at_node))]
    stop = stop[:-1]
    stretches = node[vertex[stop]], node[vertex[following[stop]]], on[stop]
    for k, (a, b, d) in enumerate(zip(*(x.tolist() for x in stretches)), start=1):
        if a != b:
            links[a][-k] = b, d
            links[b][-k] = a, d
    ends = node[edges[selected]].T.tolist()
    for k, a, b, d in zip(selected.tolist(), *ends, length[selected].tolist()):
        links[a][k] = b, d
        links[b][k] = a, d

    def by_vertex(values):
        result = np.empty(n, dtype=values.dtype)
        result[vertex] = values
        return result

    return BoundaryGraph(
        links=links,
        place=list(map(tuple, position[at_node].tolist())),
        position=position,
        node=node,
        before=by_vertex(np.where(bare, -1, node[vertex[previous]])),
        after=by_vertex(np.where(bare, -1, node[vertex[following]])),
        to_before=by_vertex(back),
        to_after=by_vertex(on),
        ring=by_vertex(ring),
        along=by_vertex(along),
        perimeter=by_vertex(perimeter),
    )


def detours(polygons: Polygons, edge_length: np.ndarray, edges: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Dilation of each edge in P before any cut; infinite where P does not connect its ends.

    Parameters
    ----------
    polygons, edge_length, edges, length
        See `boundary_graph`.

    Returns
    -------
    (k,) float

    Notes
    -----
    Dilation as in section 2 of the paper, with S empty. O(n + k), and a step for each ring that a path
    passes. Rings that touch form a tree, since the interior of a polygon is connected: so there is one way
    from ring to ring.

    Examples
    --------
    From corner to corner of a rectangle it is 7 around, and 5 straight on.

    >>> from isthmus.core.partition.polygon import from_rings
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [4, 0], [4, 3], [0, 3.0]])
    >>> rectangle, _ = from_rings(one_polygon(xy, [0, 4]))
    >>> detours(rectangle, np.array([4, 3, 4, 3.0]), np.array([[0, 2]]), np.array([5.0])).tolist()
    [1.4]
    """
    vertex, ring = polygons.vertex, polygons.ring_of_corner
    passed, perimeter = running(edge_length, polygons.offsets)
    u, v = edges.T
    if polygons.apart:
        a = ring[u]
        path = _arc(passed[u], passed[v], perimeter[a])
        if len(perimeter) > len(polygons.unit):  # with holes
            path[a != ring[v]] = np.inf
        return at_least_one(path / length)
    along = np.empty(len(polygons.xy))
    along[vertex] = passed
    ring_of = np.empty(len(polygons.xy), dtype=np.int64)
    ring_of[vertex] = ring
    a, b = ring_of[u], ring_of[v]

    root, parent, depth, gate, above = _ring_trees(polygons, passed)
    path = np.where(root[a] == root[b], 0.0, np.inf)
    at_u, at_v = along[u], along[v]
    apart = np.flatnonzero((a != b) & (root[a] == root[b]))
    while len(apart):
        for ends, places, others in ((a, at_u, b), (b, at_v, a)):
            deeper = apart[depth[ends[apart]] >= depth[others[apart]]]
            deeper = deeper[ends[deeper] != others[deeper]]
            own = ends[deeper]
            path[deeper] += _arc(places[deeper], gate[own], perimeter[own])
            places[deeper], ends[deeper] = above[own], parent[own]
        apart = apart[a[apart] != b[apart]]
    path += _arc(at_u, at_v, perimeter[a])
    return at_least_one(path / length)


def _arc(one, other, perimeter):
    """Length of the shorter way between two places on a ring."""
    arc = np.abs(one - other)
    return np.minimum(arc, perimeter - arc)


def _ring_trees(polygons, passed):
    """Trees of the rings that touch: for each ring its tree, parent, depth, and the gate to the parent.

    The gate is given as a place along the ring itself, and as one along the parent.
    """
    count = len(polygons.offsets) - 1
    root, parent, depth = list(range(count)), [-1] * count, [0] * count
    gate, above = np.zeros(count), np.zeros(count)
    shared = np.flatnonzero(np.bincount(polygons.vertex)[polygons.vertex] > 1)
    ring = polygons.ring_of_corner[shared].tolist()
    at, points = {}, {}  # rings by point, points by ring, each with the place along the ring
    for v, r, d in zip(polygons.vertex[shared].tolist(), ring, passed[shared].tolist()):
        at.setdefault(v, []).append((r, d))
        points.setdefault(r, []).append((v, d))
    reached = set()
    for first in points:
        if first in reached:
            continue
        reached.add(first)
        front = [first]
        while front:
            r = front.pop()
            for v, d in points[r]:
                for other, there in at.pop(v, ()):  # once: then all that are there are reached
                    if other not in reached:
                        reached.add(other)
                        root[other], parent[other], depth[other] = first, r, depth[r] + 1
                        gate[other], above[other] = there, d
                        front.append(other)
    return np.array(root), np.array(parent), np.array(depth), gate, above


def at_least_one(dilation: np.ndarray) -> np.ndarray:
    """Dilations as they are in a metric; arcs from chords make long edges a little too long.

    Examples
    --------
    >>> at_least_one(np.array([1.5, 0.999])).tolist()
    [1.5, 1.0]
    """
    return np.maximum(dilation, 1.0)


def true_dilations(
    graph: BoundaryGraph, edges: np.ndarray, length: np.ndarray, bound: np.ndarray, check: Callable
) -> np.ndarray:
    """Dilation of each edge in P and S.

    Parameters
    ----------
    graph : BoundaryGraph
    edges, length : (k, 2) int, (k,) float
    bound : (k,) float
        Upper bounds: the dilations in the carved polygon.
    check : callable
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    (k,) float

    Notes
    -----
    Dilation as in section 2 of the paper. That in the carved polygon may be larger: section 4.3.

    Examples
    --------
    A frame with a cut of length 5 from the first corner to the hole: how much longer it is to pass there
    than to cut at each corner.

    >>> from isthmus.core.partition.solve import prepare
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [12, 0], [12, 14], [0, 14], [3, 4], [3, 10], [9, 10], [9, 4.0]])
    >>> corners = xy[[[0, 4], [1, 7], [2, 6], [3, 5]]]
    >>> p = prepare(one_polygon(xy, [0, 4, 8]), lines=[corners])
    >>> graph = boundary_graph(p.polygons, p.polygons.xy, p.edge_length, p.edges, p.length, np.array([0]))
    >>> true_dilations(graph, p.edges, p.length, np.full(4, 99.0), lambda: None).tolist()
    [1.0, 4.6, 8.6, 5.0]
    """
    dilation = bound.copy()
    for count, k in enumerate(np.flatnonzero(bound > 1.0).tolist()):
        if count % 256 == 0:
            check()
        u, v = edges[k].tolist()
        path, _ = _path(graph, u, v, limit=float(bound[k] * length[k]))
        dilation[k] = min(bound[k], path / length[k])
    return at_least_one(dilation)


def largest_dilation(
    graph: BoundaryGraph,
    edges: np.ndarray,
    length: np.ndarray,
    bound: np.ndarray,
    owner: np.ndarray,
    count: int,
    check: Callable,
) -> np.ndarray:
    """Largest dilation of each polygon in P and S, searching only where the upper bound may matter.

    Parameters
    ----------
    graph, edges, length, bound
        See `true_dilations`.
    owner : (k,) int
        The polygon of each edge.
    count : int
        The number of polygons.
    check : callable
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    (count,) float
        1 where there are no edges.

    Examples
    --------
    A frame with a cut from the first corner to the hole: the detour is longest at the opposite one.

    >>> from isthmus.core.partition.solve import prepare
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [12, 0], [12, 14], [0, 14], [3, 4], [3, 10], [9, 10], [9, 4.0]])
    >>> corners = xy[[[0, 4], [1, 7], [2, 6], [3, 5]]]
    >>> p = prepare(one_polygon(xy, [0, 4, 8]), lines=[corners])
    >>> graph = boundary_graph(p.polygons, p.polygons.xy, p.edge_length, p.edges, p.length, np.array([0]))
    >>> largest_dilation(graph, p.edges, p.length, np.full(4, 99.0), p.owner, 1, lambda: None).tolist()
    [8.6]
    """
    largest, searches = [1.0] * count, 0
    order = np.lexsort((-bound, owner))
    for k, p, most in zip(*(x.tolist() for x in (order, owner[order], bound[order]))):
        if most <= largest[p]:
            continue
        if searches % 256 == 0:
            check()
        searches += 1
        own = float(length[k])
        # any way that is no longer than what is known will do
        u, v = edges[k].tolist()
        path, _ = _path(graph, u, v, limit=most * own, enough=largest[p] * own)
        largest[p] = max(largest[p], min(most, path / own))
    return np.array(largest)


def drop_redundant(
    graph: BoundaryGraph,
    edges: np.ndarray,
    length: np.ndarray,
    selected: np.ndarray,
    weight: np.ndarray,
    bounded: np.ndarray,
    tau: np.ndarray,
    carved: Carved,
    role: np.ndarray,
    bound: np.ndarray,
    check: Callable,
) -> np.ndarray:
    """Drop selected edges without which all candidates are still within tau.

    Parameters
    ----------
    graph : BoundaryGraph
        Of P and S; loses the edges that are dropped.
    edges, length : (k, 2) int, (k,) float
    selected : (s,) int
        The edges in S, T included.
    weight : (k,) float
        The heaviest edge of each polygon is tried first.
    bounded : (k,) bool
        The candidates proper; other edges only connect holes and need no witness.
    tau : (k,) float
    carved : solve.Carved
        With a T that is part of S.
    role, bound : (k,) int, (k,) float
        LEAF or ROOT, the side of each candidate where its witness in the carved polygon lies, and its
        dilation.
    check : callable
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    (s',) int
        The edges that stay, in the order given.

    Notes
    -----
    The heuristic of section 4.3 of the paper may select edges unnecessarily: distances in the carved polygon
    can be longer than in P and S.

    One shortest-path search for each selected edge, for a detour around it. The few that have one are
    dropped if all candidates whose witness uses the edge have a witness without it: the old one with
    the detour in it where that is short enough, else one that a search finds.

    Examples
    --------
    A frame with cuts at all four corners: the two of lower weight do for tau = 5.

    >>> from isthmus.core.partition.solve import prepare
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [12, 0], [12, 14], [0, 14], [3, 4], [3, 10], [9, 10], [9, 4.0]])
    >>> corners = xy[[[0, 4], [1, 7], [2, 6], [3, 5]]]
    >>> p = prepare(one_polygon(xy, [0, 4, 8]), lines=[corners])
    >>> every = np.arange(4)
    >>> graph = boundary_graph(p.polygons, p.polygons.xy, p.edge_length, p.edges, p.length, every)
    >>> limits, weight = np.full(4, 5.0), np.array([1, 2, 1, 2.0])
    >>> roles, bounds = np.zeros(4, dtype=int), np.ones(4)
    >>> rest = graph, p.edges, p.length, every, weight, p.bounded, limits, p.carved, roles, bounds
    >>> drop_redundant(*rest, lambda: None).tolist()
    [0, 2]
    """
    allowed = tau * length * (1.0 + SLACK)
    waiting = bounded.copy()
    waiting[selected] = False
    known = _Witnesses(carved, edges, selected, waiting, role, bound * length)
    keep = np.ones(len(selected), dtype=bool)
    for count, s in enumerate(np.argsort(-weight[selected], kind="stable").tolist()):
        if count % 64 == 0:
            check()
        c = int(selected[s])
        if known.same_face(c):
            continue  # nothing else connects its ends
        u, v = edges[c].tolist()
        a, b = int(graph.node[u]), int(graph.node[v])
        link = graph.links[a].pop(c), graph.links[b].pop(c)
        detour, by = _path(graph, u, v, limit=float(allowed[c]) if bounded[c] else inf)
        stays = detour == inf
        if not stays:
            users = known.users(c)
            longer = known.path[users] + max(detour - float(length[c]), 0.0)
            served = longer <= allowed[users]
            found = _other_ways(graph, edges, allowed, users[~served], check)
            stays = found is None
        if stays:
            graph.links[a][c], graph.links[b][c] = link
            continue
        keep[s] = False
        known.join_faces(c)
        known.lead_around(c, users[served], longer[served], by)
        if bounded[c]:
            found.append((c, detour, by))
        for e, path, cuts in found:
            known.replace(e, path, cuts)
    return selected[keep]


def _other_ways(graph, edges, allowed, candidates, check):
    """For each candidate its number, the length of a path and the cuts on it; None if one has no path."""
    found = []
    for count, e in enumerate(candidates[np.argsort(allowed[candidates], kind="stable")].tolist()):
        if count % 256 == 255:
            check()
        path, cuts = _path(graph, *edges[e].tolist(), limit=float(allowed[e]))
        if path == inf:
            return None
        found.append((e, path, cuts))
    return found


class _Witnesses:
    """For each candidate the length of a path within its limit, and which cuts that path may use.

    At first it runs around the candidate's face in the carved polygon and S: the users of a cut are
    found in the faces on its two sides, by the roles and places of the candidates there. Paths that come
    later have sets of their cuts.
    """

    def __init__(self, carved, edges, selected, waiting, role, path):
        tree, walk = carved.net.tree, carved.walk
        roots = tree.roots
        self.path = path
        self.node = np.full(len(edges), -1)
        self.node[carved.node_edge] = np.arange(roots, len(tree.parent))
        # a node that is a root or a cut opens a face; the others lie in that of their parent
        opens = np.zeros(len(edges), dtype=bool)
        opens[selected] = True
        opens = np.append(np.ones(roots, dtype=bool), opens[carved.node_edge])
        face = np.where(opens, np.arange(len(opens)), tree.parent)
        while True:
            above = face[face]
            if np.array_equal(above, face):
                break
            face = above
        self.above = face[np.where(opens, tree.parent, np.arange(len(opens)))]
        members = np.flatnonzero(waiting & (self.node >= 0))
        of = face[self.node[members]]
        order = np.argsort(of, kind="stable")
        self.members = members[order]
        self.start = offsets_of(np.bincount(of, minlength=len(opens))).tolist()
        self.i, self.j = walk.i, walk.j
        self.leaf = role == LEAF
        along_tree = np.flatnonzero(walk.edge < 0)
        along_tree = along_tree[np.argsort(-walk.edge[along_tree], kind="stable")].reshape(-1, 2)
        self.passes = dict(
            zip(carved.tree.tolist(), zip(along_tree.tolist(), face[tree.edge_face[along_tree]].tolist()))
        )
        self.face = list(range(len(opens)))  # what each has become part of
        self.cuts = {}  # of the paths that are not the first ones
        self.added = {}  # for each cut, what came to use it

    def same_face(self, c):
        """Whether the same face of P and S lies on both sides of a cut: then it is a bridge."""
        one, other = self._faces(c)
        return one == other

    def join_faces(self, c):
        """Make the faces on the two sides of a cut one."""
        one, other = self._faces(c)
        self.face[max(one, other)] = min(one, other)

    def _faces(self, c):
        node = int(self.node[c])
        face = self.face
        for f in self.passes[c][1] if c in self.passes else (node, int(self.above[node])):
            while face[f] != f:
                face[f] = f = face[face[f]]
            yield f

    def users(self, c):
        """The candidates whose path may use a cut, ascending."""
        if c in self.passes:
            (p, q), (one, other) = self.passes[c]
            found = [
                e[within == self.leaf[e]]
                for e, within in (self._within(one, p, p + 1), self._within(other, q, q + 1))
            ]
        else:
            node = int(self.node[c])
            e, within = self._within(int(self.above[node]), int(self.i[c]), int(self.j[c]))
            below = self.members[self.start[node] : self.start[node + 1]]
            found = [e[within == self.leaf[e]], below[~self.leaf[below]]]
        cuts = self.cuts
        first = np.concatenate(found)
        if cuts:
            first = first[[e not in cuts for e in first.tolist()]]
        added = [e for e in self.added.pop(c, ()) if e not in cuts or c in cuts[e]]
        return np.unique(np.append(first, np.array(added, dtype=np.int64)))

    def _within(self, face, i, j):
        """The candidates in a face, and which of them are around the places from i to j."""
        e = self.members[self.start[face] : self.start[face + 1]]
        return e, (self.i[e] <= i) & (self.j[e] >= j)

    def lead_around(self, c, users, path, by):
        """Lead the paths of candidates around a cut along others."""
        self.path[users] = path
        users = users.tolist()
        for e in users:
            if e in self.cuts:
                self.cuts[e].discard(c)
                self.cuts[e].update(by)
        for k in by:
            self.added.setdefault(k, []).extend(users)

    def replace(self, e, path, cuts):
        """Give a candidate a path of its own."""
        self.path[e] = path
        self.cuts[e] = set(cuts)
        for k in cuts:
            self.added.setdefault(k, []).append(e)


def _entries(graph, v):
    """Nodes through which a path leaves vertex v, and the distances to them."""
    node = int(graph.node[v])
    if node >= 0:
        return {node: 0.0}
    before, after = int(graph.before[v]), int(graph.after[v])
    if before < 0:
        return {}
    to_before, to_after = float(graph.to_before[v]), float(graph.to_after[v])
    if before == after:
        return {before: min(to_before, to_after)}
    return {before: to_before, after: to_after}


def _direct(graph, u, v):
    """Length of the boundary from u to v where it passes no node, else infinity."""
    if graph.node[u] >= 0 or graph.node[v] >= 0 or graph.ring[u] != graph.ring[v]:
        return inf
    if graph.before[u] < 0:
        arc = float(abs(graph.along[u] - graph.along[v]))
        return min(arc, float(graph.perimeter[u]) - arc)
    if graph.before[u] == graph.before[v] and graph.after[u] == graph.after[v]:
        return float(abs(graph.to_before[u] - graph.to_before[v]))
    return inf


def _path(graph, u, v, limit=inf, enough=0.0):
    """Shortest path between two vertices, searched from both ends: its length, and the cuts on it.

    Infinite where it is longer than the limit. The first path that is found no longer than ``enough``
    is good enough.
    """
    best, meeting = _direct(graph, u, v), -1
    near, far = _search(graph, u, v), _search(graph, v, u)
    for a, d in near.reached.items():
        if a in far.reached and d + far.reached[a] < best:
            best, meeting = d + far.reached[a], a
    best, meeting = _meet(graph, near, far, best, meeting, limit, enough)
    if best > limit:
        return inf, ()
    return best, _cuts_back(near.came, meeting) + _cuts_back(far.came, meeting)


class _Search(NamedTuple):
    """A search from one end of a path for the other.

    heap : list of (float, int)
        The nodes that wait, by their distance.
    reached : dict of int to float
        The distance of each node that was seen.
    came : dict of int to (int, int)
        The node before each of them but the first, and the cut between, or less than 0.
    goal : list of float
        Where the other end is.
    """

    heap: list
    reached: dict
    came: dict
    goal: list


def _search(graph, end, goal):
    reached = _entries(graph, end)
    return _Search(sorted((d, a) for a, d in reached.items()), reached, {}, graph.position[goal].tolist())


def _meet(graph, near, far, best, meeting, limit, enough):
    """Go on from both ends until no path can be shorter: the shortest, and where its two halves meet."""
    links, place = graph.links, graph.place
    heap, reached, came, goal = near
    other_heap, beyond, _, _ = far
    while heap and other_heap and best > enough:
        least = heap[0][0] + other_heap[0][0]
        if least >= best or least > limit:
            break
        # the smaller front goes on: where one end is cut off, this does not search all around the other
        if len(other_heap) < len(heap):
            near, far = far, near
            heap, reached, came, goal = near
            other_heap, beyond, _, _ = far
        d, a = heappop(heap)
        if d > reached[a]:
            continue
        for cut, (b, step) in links[a].items():
            there = d + step
            if there < reached.get(b, inf):
                least = there + dist(place[b], goal)
                if least < best and least <= limit:
                    reached[b] = there
                    came[b] = a, cut
                    heappush(heap, (there, b))
                    if b in beyond and there + beyond[b] < best:
                        best, meeting = there + beyond[b], b
    return best, meeting


def _cuts_back(came, a):
    """The cuts on the way back from a node."""
    cuts = []
    while a in came:
        a, cut = came[a]
        if cut >= 0:
            cuts.append(cut)
    return cuts
