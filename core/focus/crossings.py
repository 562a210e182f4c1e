"""Where edges of the deformed map cross, and the links that keep them apart.

A crossing is a relation that the graph does not know: two lines that shall not pass each other.
Van Dijk and Haunert (2014) glue the point of contact; here the two edges get a link of their own
where they were closest in the input. So they keep a gap, and nothing touches that did not touch.
"""

from __future__ import annotations

import numpy as np
import shapely

from .deformation import Links

__all__ = ["contacts", "crossing_pairs"]


def crossing_pairs(xy, edges):
    """Return the pairs of edges that meet, but for those that share an end.

    Parameters
    ----------
    xy : (n, 2) float
    edges : (m, 2) int

    Returns
    -------
    (k, 2) int
        Places in ``edges``, ascending.

    Notes
    -----
    O(m log m) for the short edges of a map.
    """
    segments = shapely.linestrings(xy[edges])
    a, b = shapely.STRtree(segments).query(segments, predicate="intersects")
    pairs = np.column_stack((a, b))[a < b]
    first, second = edges[pairs[:, 0]], edges[pairs[:, 1]]
    apart = (first[:, :, None] != second[:, None, :]).all(axis=(1, 2))
    pairs = pairs[apart]
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def contacts(xy, edges, pairs):
    """Return a link for each pair of edges, between their closest points in the input.

    Parameters
    ----------
    xy : (n, 2) float
        Positions in the input, where the edges of a pair do not meet.
    edges : (m, 2) int
    pairs : (k, 2) int

    Returns
    -------
    Links
    """
    first, second = edges[pairs[:, 0]], edges[pairs[:, 1]]
    ways = [  # a vertex of one, the edge of the other
        (first[:, 0], second), (first[:, 1], second), (second[:, 0], first), (second[:, 1], first)
    ]
    t = np.stack([_foot(xy, p, edge) for p, edge in ways])
    gap = np.stack([_distance(xy, p, edge, t[k]) for k, (p, edge) in enumerate(ways)])
    best = gap.argmin(axis=0)
    every = np.arange(len(pairs))
    p = np.stack([p for p, _ in ways])[best, every]
    edge = np.stack([edge for _, edge in ways])[best, every]
    t = t[best, every]
    # at an end of the edge the link is one between vertices
    u = np.where(t >= 1.0, edge[:, 1], edge[:, 0])
    return Links(p, u, edge[:, 1], np.where(t >= 1.0, 0.0, t), np.ones(len(p)))


def _foot(xy, p, edge):
    """Place on each edge nearest to a vertex, 0 to 1."""
    along = xy[edge[:, 1]] - xy[edge[:, 0]]
    towards = xy[p] - xy[edge[:, 0]]
    return np.clip((along * towards).sum(axis=1) / (along * along).sum(axis=1), 0.0, 1.0)


def _distance(xy, p, edge, t):
    gap = xy[p] - (1.0 - t)[:, None] * xy[edge[:, 0]] - t[:, None] * xy[edge[:, 1]]
    return np.hypot(gap[:, 0], gap[:, 1])
