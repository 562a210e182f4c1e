"""An independent check of a solution: distances in P and S from scratch.

Nothing here uses the tree, the carved polygon or the boundary graph. Every vertex is a node, every
edge of P and S a link, and every candidate a shortest-path search of its own.
"""

from __future__ import annotations

from heapq import heappop, heappush

import numpy as np

__all__ = ["dilations"]


def dilations(xy, rings, selected, candidates, length=None):
    """Dilation of candidate edges in the graph of a polygon and selected edges.

    Parameters
    ----------
    xy : (n, 2) float
    rings : list of (k,) int
        Vertex indices of each ring, none repeated at its end.
    selected : (s, 2) int
        The edges in S.
    candidates : (c, 2) int
        The edges to check.
    length : callable, optional
        ``(u, v)`` to the length of the edge u-v; default: Euclidean.

    Returns
    -------
    (c,) float
        Shortest path over length; infinite where the graph does not connect the ends.

    Notes
    -----
    Dijkstra for each candidate: O(c n log n).
    """
    if length is None:

        def length(u, v):
            return float(np.hypot(*(xy[u] - xy[v])))

    links = {}

    def link(u, v):
        d = length(u, v)
        links.setdefault(u, []).append((v, d))
        links.setdefault(v, []).append((u, d))

    for ring in rings:
        ring = [int(v) for v in ring]
        for u, v in zip(ring, ring[1:] + ring[:1]):
            link(u, v)
    for u, v in selected:
        link(int(u), int(v))
    return np.array([_shortest(links, int(u), int(v)) / length(int(u), int(v)) for u, v in candidates])


def _shortest(links, source, goal):
    heap, done = [(0.0, source)], set()
    while heap:
        d, u = heappop(heap)
        if u == goal:
            return d
        if u in done:
            continue
        done.add(u)
        for v, step in links[u]:
            if v not in done:
                heappush(heap, (d + step, v))
    return np.inf
