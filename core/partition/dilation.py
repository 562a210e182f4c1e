"""Fifth stage: true distances in P and S, and what they say about the cuts.

On a polygon without holes the tree knows all distances. With holes, a path may pass a hole on
either side, and the carved polygon P_T only gives upper bounds (section 4.3 of the paper). The
boundary graph here gives the true ones: it keeps the ends of the cuts as nodes and contracts the
boundary between them, so its size is that of S.
"""

from __future__ import annotations

from heapq import heappop, heappush
from typing import NamedTuple

import numpy as np

from .min_size import SLACK

__all__ = ["BoundaryGraph", "at_least_one", "boundary_graph", "detours", "drop_redundant", "largest_dilation",
           "true_dilations"]


class BoundaryGraph(NamedTuple):
    """P and S with the boundary contracted between the nodes.

    Attributes
    ----------
    chains : list of dict
        For each node, the nodes next to it along the boundary, and how far they are.
    cuts : list of dict
        For each node, the nodes that an edge of S joins to it, and its length.
    node : (n,) int
        Node of each vertex, -1 where it is none.
    before, after : (n,) int
        Nodes next to each vertex along its ring (-1: the ring has no node).
    to_before, to_after : (n,) float
        Distances to these along the ring.
    ring, along, perimeter : (n,) int, (n,) float, (n,) float
        The ring of each vertex, its place along it, and the ring's perimeter.
    """

    chains: list
    cuts: list
    node: np.ndarray
    before: np.ndarray
    after: np.ndarray
    to_before: np.ndarray
    to_after: np.ndarray
    ring: np.ndarray
    along: np.ndarray
    perimeter: np.ndarray


def boundary_graph(polygon, edge_length, edges, length, selected):
    """Contract P and S to the ends of the selected edges and the points where rings touch.

    Parameters
    ----------
    polygon : Polygon
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
    """
    n, vertex, offsets = len(polygon.xy), polygon.vertex, polygon.offsets
    is_node = np.bincount(vertex, minlength=n) > 1
    is_node[edges[selected]] = True
    node = np.full(n, -1)
    node[is_node] = np.arange(np.count_nonzero(is_node))
    ring = polygon.ring_of_corner
    passed = np.append(0.0, np.cumsum(edge_length))
    along = passed[:-1] - passed[offsets[:-1]][ring]
    perimeter = (passed[offsets[1:]] - passed[offsets[:-1]])[ring]

    # the stops of a ring are its corners at nodes; find the last one up to here, and the next
    stop = np.flatnonzero(is_node[vertex])
    first = np.searchsorted(stop, offsets)
    here = np.searchsorted(stop, np.arange(len(vertex)), side="right")
    wraps_back, wraps_on = here == first[ring], here == first[ring + 1]
    bare = wraps_back & wraps_on
    stop = np.append(stop, 0)
    previous = stop[np.where(wraps_back, first[ring + 1], here) - 1]
    following = stop[np.where(wraps_on, first[ring], here)]
    back = along - along[previous] + np.where(wraps_back, perimeter, 0.0)
    on = along[following] - along + np.where(wraps_on, perimeter, 0.0)

    chains = [{} for _ in range(np.count_nonzero(is_node))]
    cuts = [{} for _ in chains]
    stop = stop[:-1]
    for a, b, d in zip(
        node[vertex[stop]].tolist(), node[vertex[following[stop]]].tolist(), on[stop].tolist()
    ):
        if a != b:
            chains[a][b] = chains[b][a] = min(d, chains[a].get(b, np.inf))
    for (a, b), d in zip(node[edges[selected]].tolist(), length[selected].tolist()):
        cuts[a][b] = cuts[b][a] = d

    def by_vertex(values):
        result = np.empty(n, dtype=values.dtype)
        result[vertex] = values
        return result

    return BoundaryGraph(
        chains=chains,
        cuts=cuts,
        node=node,
        before=by_vertex(np.where(bare, -1, node[vertex[previous]])),
        after=by_vertex(np.where(bare, -1, node[vertex[following]])),
        to_before=by_vertex(back),
        to_after=by_vertex(on),
        ring=by_vertex(ring),
        along=by_vertex(along),
        perimeter=by_vertex(perimeter),
    )


def detours(polygon, edge_length, edges, length):
    """Dilation of each edge in P before any cut; infinite where P does not connect its ends.

    Returns
    -------
    (k,) float

    Notes
    -----
    O(n + k), but for one shortest-path search for each edge between rings that touch.
    """
    ring, passed = polygon.ring_of_corner, np.append(0.0, np.cumsum(edge_length))
    along = np.empty(len(polygon.xy))
    along[polygon.vertex] = passed[:-1]
    ring_of = np.empty(len(polygon.xy), dtype=np.int64)
    ring_of[polygon.vertex] = ring
    perimeter = np.diff(passed[polygon.offsets])
    u, v = edges.T
    arc = np.abs(along[u] - along[v])
    same = ring_of[u] == ring_of[v]
    path = np.where(same, np.minimum(arc, perimeter[ring_of[u]] - arc), np.inf)
    if len(polygon.vertex) > len(polygon.xy):
        # where rings touch, a vertex may lie on several, and a path may use them all
        nothing = np.empty(0, dtype=np.int64)
        graph = boundary_graph(polygon, edge_length, edges, length, nothing)
        touches = np.zeros(len(perimeter), dtype=bool)
        touches[ring[graph.node[polygon.vertex] >= 0]] = True
        search = touches[ring_of[u]] & touches[ring_of[v]]
        search &= ~same | (graph.node[u] >= 0) | (graph.node[v] >= 0)
        for k in np.flatnonzero(search).tolist():
            path[k] = _distance(graph, u[k], v[k], np.inf)
    return at_least_one(path / length)


def at_least_one(dilation):
    """Dilations as they are in a metric; arcs from chords make long edges a little too long."""
    return np.maximum(dilation, 1.0)


def true_dilations(graph, edges, length, bound, check):
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
    """
    dilation = bound.copy()
    for count, k in enumerate(np.flatnonzero(bound > 1.0).tolist()):
        if count % 256 == 0:
            check()
        path = _distance(graph, *edges[k], bound[k] * length[k])
        dilation[k] = min(bound[k], path / length[k])
    return at_least_one(dilation)


def largest_dilation(graph, edges, length, bound, check):
    """Largest dilation in P and S, searching only where the upper bound may matter.

    Parameters
    ----------
    graph, edges, length, bound, check
        See `true_dilations`.
    """
    largest = 1.0
    for count, k in enumerate(np.argsort(-bound, kind="stable").tolist()):
        if bound[k] <= largest:
            break
        if count % 256 == 0:
            check()
        path = _distance(graph, *edges[k], bound[k] * length[k])
        largest = max(largest, min(bound[k], path / length[k]))
    return largest


def drop_redundant(graph, edges, length, selected, weight, bounded, tau, check):
    """Drop selected edges without which all candidates are still within tau.

    Parameters
    ----------
    graph : BoundaryGraph
        Of P and S; loses the edges that are dropped.
    edges, length : (k, 2) int, (k,) float
    selected : (s,) int
        The edges in S, T included.
    weight : (k,) float
        The heaviest edge is tried first.
    bounded : (k,) bool
        The candidates proper; other edges only connect holes and need no witness.
    tau : float
    check : callable
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    (s',) int
        The edges that stay, in the order given.

    Notes
    -----
    One bounded shortest-path search for each selected edge; a pass over all candidates for the few
    that survive it.
    """
    allowed = tau * length * (1.0 + SLACK)
    waiting = bounded.copy()
    waiting[selected] = False
    keep = np.ones(len(selected), dtype=bool)
    for count, s in enumerate(np.argsort(-weight[selected], kind="stable").tolist()):
        if count % 64 == 0:
            check()
        c = selected[s]
        a, b = graph.node[edges[c]].tolist()
        del graph.cuts[a][b], graph.cuts[b][a]
        limit = allowed[c] if bounded[c] else np.inf
        # without the cut its ends may be apart, though `limit` is infinite: then it must stay
        if _distance(graph, *edges[c], limit) < np.inf and _still_satisfied(
            graph, edges, length[c], allowed, waiting, a, b, check
        ):
            keep[s] = False
            waiting[c] = bounded[c]
        else:
            graph.cuts[a][b] = graph.cuts[b][a] = float(length[c])
    return selected[keep]


def _still_satisfied(graph, edges, cut_length, allowed, waiting, a, b, check):
    """Whether the waiting edges are within their limits though the cut a-b is gone."""
    limit = allowed[waiting].max(initial=0.0)
    from_a, from_b = (_distances_from(graph, end, limit) for end in (a, b))
    u, v = edges.T
    via = cut_length + np.minimum(
        _to_vertices(graph, from_a, u) + _to_vertices(graph, from_b, v),
        _to_vertices(graph, from_b, u) + _to_vertices(graph, from_a, v),
    )
    concerned = np.flatnonzero(waiting & (via <= allowed))
    for count, e in enumerate(concerned.tolist()):
        if count % 256 == 255:
            check()
        if _distance(graph, u[e], v[e], allowed[e]) > allowed[e]:
            return False
    return True


def _entries(graph, v):
    """Nodes through which a path leaves vertex v, with the distances to them."""
    if graph.node[v] >= 0:
        return [(0.0, int(graph.node[v]))]
    if graph.before[v] < 0:
        return []
    return [
        (float(graph.to_before[v]), int(graph.before[v])),
        (float(graph.to_after[v]), int(graph.after[v])),
    ]


def _direct(graph, u, v):
    """Length of the boundary from u to v where it passes no node, else infinity."""
    if graph.node[u] >= 0 or graph.node[v] >= 0 or graph.ring[u] != graph.ring[v]:
        return np.inf
    if graph.before[u] < 0:
        arc = abs(graph.along[u] - graph.along[v])
        return min(arc, graph.perimeter[u] - arc)
    if graph.before[u] == graph.before[v] and graph.after[u] == graph.after[v]:
        return abs(graph.to_before[u] - graph.to_before[v])
    return np.inf


def _distance(graph, u, v, limit):
    """Shortest path between two vertices (Dijkstra), infinity where it is longer than the limit."""
    best = _direct(graph, u, v)
    goals = {a: d for d, a in sorted(_entries(graph, v), reverse=True)}  # the nearest way in
    heap, done = sorted(_entries(graph, u)), set()
    while heap:
        d, a = heappop(heap)
        if d >= best or d > limit:
            break
        if a in done:
            continue
        done.add(a)
        if a in goals:
            best = min(best, d + goals[a])
        for links in (graph.chains[a], graph.cuts[a]):
            for b, step in links.items():
                if b not in done:
                    heappush(heap, (d + step, b))
    return best if best <= limit else np.inf


def _distances_from(graph, source, limit):
    """Distances from a node to all nodes within the limit (Dijkstra); infinity for the others."""
    distance = np.full(len(graph.chains), np.inf)
    heap = [(0.0, source)]
    while heap:
        d, a = heappop(heap)
        if d >= distance[a]:
            continue
        distance[a] = d
        for links in (graph.chains[a], graph.cuts[a]):
            for b, step in links.items():
                if d + step <= limit and d + step < distance[b]:
                    heappush(heap, (d + step, b))
    return distance


def _to_vertices(graph, distance, vertices):
    """Extend distances of nodes to vertices."""
    node, before, after = (x[vertices] for x in (graph.node, graph.before, graph.after))
    distance = np.append(distance, np.inf)  # node -1 is nowhere
    return np.where(
        node >= 0,
        distance[node],
        np.minimum(
            distance[before] + graph.to_before[vertices], distance[after] + graph.to_after[vertices]
        ),
    )
