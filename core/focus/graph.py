"""The graph of a map: vertices that lines share, edges between them, connected components."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..errors import Sentence, Unsolvable

__all__ = ["Graph", "build_graph", "components", "joins", "match"]

# Line ends are matched with vertices within this share of the largest coordinate.
TOLERANCE = 1e-9


class Graph(NamedTuple):
    """A geometric graph.

    Attributes
    ----------
    xy : (n, 2) float
        Distinct points, ascending by x, then y.
    vertex : (k,) int
        The vertex at each input row.
    edges : (m, 2) int
        Pairs u < v, each once, ascending.
    """

    xy: np.ndarray
    vertex: np.ndarray
    edges: np.ndarray


def build_graph(rows: np.ndarray, starts: np.ndarray) -> Graph:
    """Merge equal points and equal segments.

    Parameters
    ----------
    rows : (k, 2) float
        The points of all lines and rings one after the other (rings closed).
    starts : (l + 1,) int
        Line i is ``rows[starts[i]:starts[i + 1]]``.

    Returns
    -------
    Graph

    Raises
    ------
    Unsolvable
        If a coordinate is not finite.

    Notes
    -----
    O(k log k).

    Examples
    --------
    Two triangles with a side in common: four points and five edges are left of eight rows.

    >>> rows = np.array([(0, 0), (1, 0), (0, 1), (0, 0), (1, 0), (1, 1), (0, 1), (1, 0)])
    >>> graph = build_graph(rows, np.array([0, 4, 8]))
    >>> graph.xy.tolist()
    [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]
    >>> graph.vertex.tolist()
    [0, 2, 1, 0, 2, 3, 1, 2]
    >>> graph.edges.tolist()
    [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]
    """
    rows = np.ascontiguousarray(rows, dtype=float) + 0.0  # + 0.0: there is only one zero
    if not np.isfinite(rows).all():
        raise Unsolvable(Sentence("some coordinates are not finite (NaN or infinity)"))
    points, vertex = np.unique(rows.view(np.complex128).ravel(), return_inverse=True)
    vertex = vertex.ravel()
    inside = np.ones(max(len(rows) - 1, 0), dtype=bool)
    ends = np.asarray(starts[1:-1])
    inside[ends[(ends > 0) & (ends < len(rows))] - 1] = False
    pairs = np.sort(np.column_stack((vertex[:-1], vertex[1:]))[inside], axis=1)
    return Graph(points.view(float).reshape(-1, 2), vertex, unique_pairs(pairs, len(points)))


def unique_pairs(pairs: np.ndarray, n: int) -> np.ndarray:
    """Return each pair once, u < v, ascending; those of equal ends are left out.

    Parameters
    ----------
    pairs : (m, 2) int
    n : int
        Number of vertices.
    """
    pairs = np.sort(np.asarray(pairs, dtype=np.int64).reshape(-1, 2), axis=1)
    key = np.unique((pairs[:, 0] * n + pairs[:, 1])[pairs[:, 0] != pairs[:, 1]])
    return np.column_stack((key // n, key % n))


def components(n: int, edges: np.ndarray) -> np.ndarray:
    """Return the (n,) number of the connected component of each vertex.

    Examples
    --------
    Of five vertices, 0 and 3 hang together, and 1 and 4:

    >>> components(5, np.array([(0, 3), (1, 4)])).tolist()
    [0, 1, 2, 0, 1]
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    matrix = coo_matrix((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), (n, n))
    return connected_components(matrix, directed=False)[1]


def match(xy: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the vertex at each point, -1 where there is none.

    Parameters
    ----------
    xy : (n, 2) float
    points : (k, 2) float

    Examples
    --------
    >>> match(np.array([(0.0, 0.0), (2.0, 1.0)]), np.array([(2.0, 1.0), (5.0, 5.0)])).tolist()
    [1, -1]
    """
    from scipy.spatial import cKDTree

    if not len(points):
        return np.empty(0, dtype=np.int64)
    near, vertex = cKDTree(xy).query(points)
    return np.where(near <= TOLERANCE * max(np.abs(xy).max(), 1e-300), vertex, -1)


def joins(xy: np.ndarray, edges: np.ndarray, tau: float) -> np.ndarray:
    """Return edges that join the components of a graph: an island moves with its neighbours.

    Of the edges of a Delaunay triangulation between two components the shortest counts, and each
    other one unless those that count before offer a way that is at most tau times as long, taken
    as the crow flies to their ends: the idea of the dilation, across the water.

    Parameters
    ----------
    xy : (n, 2) float
    edges : (m, 2) int
    tau : float

    Returns
    -------
    (j, 2) int

    Notes
    -----
    O(n log n), and O(k j) for k edges between two components of which j count.

    Examples
    --------
    Two banks of a river: where long detours are allowed, one bridge is enough.

    >>> xy, banks = np.array([(0, 0), (4, 0), (0, 1), (4, 2.0)]), np.array([(0, 1), (2, 3)])
    >>> joins(xy, banks, 2.0).tolist()
    [[0, 2], [1, 3]]
    >>> joins(xy, banks, 5.0).tolist()
    [[0, 2]]
    """
    from scipy.spatial import Delaunay, QhullError

    component = components(len(xy), edges)
    if component.max(initial=0) == 0:
        return np.empty((0, 2), dtype=np.int64)
    size = np.ptp(xy, axis=0).max()
    try:
        triangles = Delaunay((xy - xy.mean(axis=0)) / size).simplices
        pairs = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    except (QhullError, ValueError):  # all on one line, or fewer than three: one after the other
        order = np.lexsort((xy[:, 1], xy[:, 0]))
        pairs = np.column_stack((order[:-1], order[1:]))
    pairs = unique_pairs(pairs, len(xy))
    pairs = pairs[component[pairs[:, 0]] != component[pairs[:, 1]]]
    side = component[pairs]
    pairs = np.where((side[:, 0] > side[:, 1])[:, None], pairs[:, ::-1], pairs)
    side = np.sort(side, axis=1)
    length = np.hypot(*(xy[pairs[:, 0]] - xy[pairs[:, 1]]).T)
    order = np.lexsort((length, side[:, 1], side[:, 0]))
    pairs, side, length = pairs[order], side[order], length[order]
    first = np.flatnonzero(np.append(True, (np.diff(side, axis=0) != 0).any(axis=1)))
    chosen = []
    for lo, hi in zip(first.tolist(), np.append(first[1:], len(pairs)).tolist()):
        waiting = np.arange(lo, hi)
        while len(waiting):
            e, waiting = waiting[0], waiting[1:]
            chosen.append(e)
            gap = xy[pairs[waiting]] - xy[pairs[e]]
            way = length[e] + np.hypot(gap[..., 0], gap[..., 1]).sum(axis=1)
            waiting = waiting[way > tau * length[waiting]]
    return unique_pairs(pairs[chosen], len(xy))
