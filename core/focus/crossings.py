"""Where edges of the deformed map cross, and the bounds that keep them apart.

As van Dijk and Haunert (2014) do, the way to a map with crossings is followed until the first ones.
There they glue the point of contact to the edge; here, as in Haunert and Sering (2011), the two
edges must leave a strip free between them. So nothing touches that did not touch before, and lines
may slide along each other, and part again.

A triangle can turn over with no two of its edges apart from each other, so no crossing tells of it.
The triangles of the map are watched on their own.
"""

from __future__ import annotations

import numpy as np
import shapely

from .deformation import Bounds

__all__ = ["FLAT", "crossing_pairs", "cycles", "separations", "turned", "upright"]

FLAT = 1e-7  # height of a triangle that may turn over, as a share of the map: nobody will see


def crossing_pairs(xy, edges, moved=None):
    """Return the pairs of edges that meet, but for those that share an end.

    Parameters
    ----------
    xy : (n, 2) float
    edges : (m, 2) int
    moved : (m,) bool, optional
        Only pairs with at least one of these.

    Returns
    -------
    (k, 2) int
        Places in ``edges``, ascending.

    Notes
    -----
    O(m log m) for the short edges of a map.
    """
    segments = shapely.linestrings(xy[edges])
    few = np.arange(len(edges)) if moved is None else np.flatnonzero(moved)
    a, b = shapely.STRtree(segments[few]).query(segments, predicate="intersects")
    b = few[b]
    # a pair of two that moved is found twice
    once = a < b if moved is None else (a < b) | ~moved[a]
    pairs = np.sort(np.column_stack((a, b))[once & (a != b)], axis=1)
    first, second = edges[pairs[:, 0]], edges[pairs[:, 1]]
    apart = (first[:, :, None] != second[:, None, :]).all(axis=(1, 2))
    pairs = pairs[apart]
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def separations(xy, edges, pairs, gap):
    """Return bounds that keep pairs of edges apart (Haunert and Sering 2011).

    Across the closest points of two edges lies a strip that both leave free. Its direction stays,
    and each end of the one edge stays on its side of each end of the other.

    Parameters
    ----------
    xy : (n, 2) float
        Positions where the edges of a pair do not meet.
    edges : (m, 2) int
    pairs : (k, 2) int
    gap : float
        The share of the strip's width that must stay.

    Returns
    -------
    Bounds
        Four of each pair.
    """
    first, second = edges[pairs[:, 0]], edges[pairs[:, 1]]
    ways = [  # a vertex of one, the edge of the other
        (first[:, 0], second), (first[:, 1], second), (second[:, 0], first), (second[:, 1], first)
    ]
    strip = np.stack([xy[p] - _nearest(xy, p, edge) for p, edge in ways])
    strip[2:] *= -1.0  # from the second to the first
    width = np.hypot(strip[..., 0], strip[..., 1])
    best = width.argmin(axis=0), np.arange(len(pairs))
    strip, width = strip[best], width[best]
    return Bounds(
        p=first[:, [0, 0, 1, 1]].ravel(),
        q=second[:, [0, 1, 0, 1]].ravel(),
        normal=np.repeat(strip / width[:, None], 4, axis=0),
        least=np.repeat(gap * width, 4),
    )


def cycles(n, edges):
    """Return the triangles of a graph: three vertices with an edge between each two.

    Parameters
    ----------
    n : int
        Number of vertices.
    edges : (m, 2) int
        Pairs u < v, each once.

    Returns
    -------
    (k, 3) int

    Notes
    -----
    O(m sqrt(m)): each edge leaves its end of lower degree.
    """
    degree = np.bincount(edges.ravel(), minlength=n)
    swap = degree[edges[:, 0]] > degree[edges[:, 1]]
    low, high = np.where(swap, edges.T[::-1], edges.T)
    order = np.argsort(low, kind="stable")
    low, high = low[order], high[order]
    start = np.searchsorted(low, np.arange(n + 1))
    # beside each edge, the others that leave the same vertex
    count = start[low + 1] - np.arange(len(low)) - 1
    one = np.repeat(np.arange(len(low)), count)
    other = one + 1 + np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    a, b = np.sort((high[one], high[other]), axis=0)
    closed = np.isin(a * n + b, edges[:, 0] * n + edges[:, 1])
    return np.column_stack((low[one], a, b))[closed]


def turned(before, after, triangles):
    """Return the triangles that lie upside down, but for those that are too flat to be seen.

    Parameters
    ----------
    before, after : (n, 2) float
    triangles : (k, 3) int
    """
    if not len(triangles):
        return triangles
    cross, longest = _cross(before, triangles)
    return triangles[
        (np.abs(cross) > FLAT * longest.max(axis=1))
        & (cross * _cross(after, triangles)[0] < 0.0)
    ]


def upright(xy, triangles, gap):
    """Return bounds that keep triangles from turning over: each vertex stays off the longest side.

    Parameters
    ----------
    xy : (n, 2) float
    triangles : (k, 3) int
    gap : float
        The share of the height that must stay.

    Returns
    -------
    Bounds
        Two of each triangle.
    """
    cross, length = _cross(xy, triangles)
    top = length.argmax(axis=1)
    each = np.arange(len(triangles))
    p, u, v = (triangles[each, (top + k) % 3] for k in range(3))
    along = xy[v] - xy[u]
    normal = np.column_stack((-along[:, 1], along[:, 0])) / length[each, top][:, None]
    normal *= np.sign(cross)[:, None]
    return Bounds(
        p=np.repeat(p, 2),
        q=np.column_stack((u, v)).ravel(),
        normal=np.repeat(normal, 2, axis=0),
        least=np.repeat(gap * np.abs(cross) / length[each, top], 2),
    )


def _cross(xy, triangles):
    """Twice the signed area of triangles, and the length of the side across from each vertex."""
    a, b, c = xy[triangles].transpose(1, 0, 2)
    cross = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    return cross, np.stack([np.hypot(*(q - p).T) for p, q in ((b, c), (c, a), (a, b))], axis=1)


def _nearest(xy, p, edge):
    """The point of each edge nearest to a vertex."""
    along = xy[edge[:, 1]] - xy[edge[:, 0]]
    t = ((xy[p] - xy[edge[:, 0]]) * along).sum(axis=1) / (along * along).sum(axis=1)
    return xy[edge[:, 0]] + np.clip(t, 0.0, 1.0)[:, None] * along
