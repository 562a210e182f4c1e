"""The map with the least distortion, by sparse least squares (Haunert and Sering 2011).

With D the vector of an edge u-v before, d the one after, and s_u a local scale, unknown as the
positions are, the distortion is the sum over vertices u and their neighbours v of

    |s_u D - d|^2 / |D|^2

There is no rotation: north stays up. In the focus s is given, and positions are those of the
scaled region up to one translation, so all of it is exact. Other coordinates may be fixed, to
keep the frame. What is solved for are the displacements, and s - 1: at scale 1 they are zero.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

__all__ = ["Links", "edge_links", "solve"]

REFINEMENTS = 4  # of the normal equations, whose condition is that of the problem squared


class Links(NamedTuple):
    """Pairs of points whose vector is to keep its direction and the local scale.

    A link leads from the vertex p to the point (1 - t) u + t v; on an edge of the graph t is 0.

    Attributes
    ----------
    p, u, v : (m,) int
    t : (m,) float
    weight : (m,) float
    """

    p: np.ndarray
    u: np.ndarray
    v: np.ndarray
    t: np.ndarray
    weight: np.ndarray

    def vectors(self, xy):
        """(m, 2): from p to the other end."""
        t = self.t[:, None]
        return (1.0 - t) * xy[self.u] + t * xy[self.v] - xy[self.p]

    def joined(self, other):
        """These links, then others."""
        return Links(*(np.concatenate(pair) for pair in zip(self, other)))


def edge_links(edges):
    """Return the edges of a graph as links of weight 1."""
    p, u = edges.T
    return Links(p, u, u, np.zeros(len(p)), np.ones(len(p)))


def solve(xy, links, group, origin, scale, fixed):
    """Return positions and local scales of least distortion.

    Parameters
    ----------
    xy : (n, 2) float
        Of about size 1.
    links : Links
        They connect all vertices.
    group : (n,) int
        The region in focus that each vertex belongs to, -1 for none.
    origin : (g, 2) float
        A point of each region; what its scaling is counted from.
    scale : float
    fixed : sequence of (axis, vertex, displacement)
        Axis 0 is x, 1 is y, 2 is s. A vertex in focus fixes its region.

    Returns
    -------
    xy : (n, 2) float
    s : (n,) float

    Notes
    -----
    One sparse factorisation of 3 n unknowns; nearly O(n) for the graph of a map.
    """
    n = len(xy)
    column, constant = _unknowns(xy, group, origin, scale, fixed)
    jacobian = _jacobian(xy, links)
    used = np.unique(column[column >= 0])
    number = np.full(3 * n + 1, -1)
    number[used] = np.arange(len(used))
    column = number[column]  # -1 stays -1
    z = constant.copy()
    free = column >= 0
    if len(used):
        from scipy.sparse import csr_matrix

        rows = np.flatnonzero(free)
        spread = csr_matrix((np.ones(len(rows)), (rows, column[rows])), (3 * n, len(used)))
        reduced = (jacobian @ spread).tocsc()
        factor = _factorise((reduced.T @ reduced).tocsc())
        y = np.zeros(len(used))
        for _ in range(1 + REFINEMENTS):
            y -= factor.solve(reduced.T @ (jacobian @ (constant + spread @ y)))
        z = constant + spread @ y
    return xy + np.column_stack((z[:n], z[n:2 * n])), 1.0 + z[2 * n:]


def _unknowns(xy, group, origin, scale, fixed):
    """Unknown of each x, y and s (-1: none), and the constant to add to it."""
    n = len(xy)
    column = np.arange(3 * n)
    constant = np.zeros(3 * n)
    inside = np.flatnonzero(group >= 0)
    first = np.full(len(origin), -1)
    first[group[inside][::-1]] = inside[::-1]
    for axis in (0, 1):
        place = axis * n + inside
        column[place] = axis * n + first[group[inside]]
        constant[place] = (scale - 1.0) * (xy[inside, axis] - origin[group[inside], axis])
    column[2 * n + inside] = -1
    constant[2 * n + inside] = scale - 1.0
    for axis, vertex, displacement in fixed:
        place = axis * n + vertex
        if column[place] < 0:
            continue  # fixed already
        if group[vertex] >= 0:
            region = axis * n + np.flatnonzero(group == group[vertex])
            constant[region] += displacement - constant[place]
            column[region] = -1
        else:
            constant[place] = displacement
            column[place] = -1
    return column, constant


def _jacobian(xy, links):
    """The matrix of s D - d at both ends of each link, of displacements and s - 1."""
    from scipy.sparse import csr_matrix

    n, m = len(xy), len(links.p)
    vector = links.vectors(xy)
    factor = np.sqrt(links.weight) / np.hypot(vector[:, 0], vector[:, 1])
    first, second = factor * (1.0 - links.t), factor * links.t
    bent = np.flatnonzero(links.t)
    row, column, value = [], [], []

    def add(which, axis, end, at, entry):
        row.append((2 * end + axis) * m + which)
        column.append(at)
        value.append(entry)

    every = np.arange(m)
    for axis in (0, 1):
        direction = factor * vector[:, axis]
        for end in (0, 1):
            add(every, axis, end, axis * n + links.p, factor)
            add(every, axis, end, axis * n + links.u, -first)
            add(bent, axis, end, axis * n + links.v[bent], -second[bent])
        add(every, axis, 0, 2 * n + links.p, direction)
        add(every, axis, 1, 2 * n + links.u, direction * (1.0 - links.t))
        add(bent, axis, 1, 2 * n + links.v[bent], (direction * links.t)[bent])
    return csr_matrix(
        (np.concatenate(value), (np.concatenate(row), np.concatenate(column))), (4 * m, 3 * n)
    )


def _factorise(matrix):
    from scipy.sparse.linalg import splu

    return splu(
        matrix,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
