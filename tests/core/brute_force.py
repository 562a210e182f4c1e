"""The problems of section 2 of the paper, solved by trying all subsets of the candidates."""

import numpy as np


def fewest_cuts(points, candidates, taus):
    """Least size of a solution for each tau."""
    return [int(x) for x in cheapest(points, candidates, np.ones(len(candidates)), taus)]


def cheapest(points, candidates, weights, taus):
    """Least weight of a solution for each tau."""
    subset, dilation = all_subsets(points, candidates)
    cost = subset @ np.asarray(weights, dtype=float)
    return [cost[dilation <= tau * (1 + 1e-12)].min() for tau in taus]


def smallest_dilation(points, candidates, weights, budget):
    """Least dilation of a subset of at most this weight."""
    subset, dilation = all_subsets(points, candidates)
    return dilation[subset @ np.asarray(weights, dtype=float) <= budget * (1 + 1e-12)].min()


def all_subsets(points, candidates, direct=None):
    """All subsets of the candidates, a row each, and the largest dilation of a candidate in each.

    ``points`` is a simple polygon, ``candidates`` pairs of its indices, ``direct`` the (n, n) lengths
    of straight lines (default: Euclidean). All 2^k subsets at once: Floyd and Warshall's shortest
    paths, one matrix a subset.
    """
    points = np.asarray(points, dtype=float)
    u, v = np.array(candidates, dtype=int).reshape(-1, 2).T
    n, k = len(points), len(u)
    subset = (np.arange(2**k)[:, None] >> np.arange(k)) & 1 == 1
    if direct is None:
        direct = np.sqrt(((points[:, None] - points[None]) ** 2).sum(axis=2))

    distance = np.full((2**k, n, n), np.inf)
    around = np.arange(n)
    distance[:, around, around] = 0.0
    for a, b in [(around, np.roll(around, -1)), (np.roll(around, -1), around)]:
        distance[:, a, b] = direct[a, b]
    for c in range(k):
        distance[subset[:, c], u[c], v[c]] = direct[u[c], v[c]]
        distance[subset[:, c], v[c], u[c]] = direct[u[c], v[c]]
    for via in range(n):
        np.minimum(distance, distance[:, :, via, None] + distance[:, None, via, :], out=distance)

    return subset, (distance[:, u, v] / direct[u, v]).max(axis=1, initial=1.0)
