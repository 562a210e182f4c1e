"""Where edges of the deformed map cross, and the bounds that keep them apart.

As van Dijk and Haunert (2014) do, the way to a map with crossings is followed until the first ones.
There they glue the point of contact to the edge; here, as in Haunert and Sering (2011), the two
edges must leave a strip free between them. So nothing touches that did not touch before, and lines
may slide along each other, and part again.
"""

from __future__ import annotations

import numpy as np
import shapely

from .deformation import Bounds

__all__ = ["crossing_pairs", "separations"]


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


def _nearest(xy, p, edge):
    """The point of each edge nearest to a vertex."""
    along = xy[edge[:, 1]] - xy[edge[:, 0]]
    t = ((xy[p] - xy[edge[:, 0]]) * along).sum(axis=1) / (along * along).sum(axis=1)
    return xy[edge[:, 0]] + np.clip(t, 0.0, 1.0)[:, None] * along
