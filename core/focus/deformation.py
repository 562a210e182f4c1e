"""The map with the least distortion, by sparse least squares (Haunert and Sering 2011).

With D the vector of an edge u-v before, d the one after, and s_u a local scale, unknown as the
positions are, the distortion is the sum over vertices u and their neighbours v of

    |s_u D - d|^2 / |D|^2

There is no rotation: north stays up. In the focus s is given, and positions are those of the
scaled region up to one translation, so all of it is exact. Single coordinates may be fixed, and
`Bounds` keep vertices in the frame, and lines from crossing. What is solved for are the
displacements, and s - 1: at scale 1 they are zero.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

__all__ = ["Bounds", "NO_BOUNDS", "Program", "focus_program", "repair_program"]

REFINEMENTS = 3  # of the normal equations, whose condition is that of the problem squared
TOLERANCE = 1e-9  # of bounds


class Bounds(NamedTuple):
    """Bounds a (x_p - x_q) + b (y_p - y_q) >= least.

    Attributes
    ----------
    p, q : (k,) int
        Vertices; q is -1 where the coordinates of p themselves are bounded.
    normal : (k, 2) float
        (a, b), of length 1.
    least : (k,) float
    """

    p: np.ndarray
    q: np.ndarray
    normal: np.ndarray
    least: np.ndarray

    def excess(self, xy):
        """(k,): by how much each bound is kept; negative where it is not."""
        other = np.where((self.q >= 0)[:, None], xy[self.q], 0.0)
        return ((xy[self.p] - other) * self.normal).sum(axis=1) - self.least

    def where(self, chosen):
        """Some of these."""
        return Bounds(*(values[chosen] for values in self))

    def joined(self, other):
        """These, then others."""
        return Bounds(*(np.concatenate(values) for values in zip(self, other)))


NO_BOUNDS = Bounds(*np.empty((2, 0), dtype=np.int64), np.empty((0, 2)), np.empty(0))


class Program:
    """A quadratic program over the displacements of a map, with the bounds added so far.

    The matrix is factorised once. A bound that is not kept costs one more solution with it, and
    from then on belongs to a small dense program for the forces that the bounds exert.

    Parameters
    ----------
    start : (n, 2) float
        Positions that displacements are counted from.
    matrix : (r, k n) sparse
        The sum of squares of its product with the displacements of x, then of y, and then whatever
        follows, is to be least.
    column : (k n,) int
        The unknown behind each of these, -1 for none.
    constant : (k n,) float
        What is added to the unknown.

    Notes
    -----
    One sparse factorisation, nearly O(n) for the graph of a map; about O(n) for each bound.
    """

    def __init__(self, start, matrix, column, constant):
        self.start, self.matrix, self.constant = start, matrix, constant
        free = np.flatnonzero(column >= 0)
        used, number = np.unique(column[free], return_inverse=True)
        self.spread = _sparse(np.ones(len(free)), free, number.ravel(), (len(column), len(used)))
        self.reduced = (matrix @ self.spread).tocsc()
        self.factor = _factorise((self.reduced.T @ self.reduced).tocsc()) if len(used) else None
        self.bounds, self.rows, self.gram = NO_BOUNDS, None, np.empty((0, 0))
        self.free = self._least(np.zeros(len(used)))
        self.z = self.free

    @property
    def xy(self):
        """(n, 2): positions."""
        n = len(self.start)
        return self.start + np.column_stack((self.z[:n], self.z[n:2 * n]))

    @property
    def s(self):
        """(n,): local scales."""
        return 1.0 + self.z[2 * len(self.start):]

    def add(self, bounds):
        """Meet more bounds; return whether that was possible.

        Parameters
        ----------
        bounds : Bounds
        """
        from scipy.sparse import vstack

        rows = (self._full_rows(bounds) @ self.spread).tocsr()
        movable = np.flatnonzero(np.diff(rows.indptr))
        if len(movable) < len(bounds.p):
            return False
        target = rows.T.toarray()
        response = self.factor.solve(target)
        response += self.factor.solve(target - self.reduced.T @ (self.reduced @ response))
        old = len(self.bounds.p)
        self.rows = rows if self.rows is None else vstack((self.rows, rows)).tocsr()
        gram = np.empty((len(response.T) + old,) * 2)
        gram[:old, :old] = self.gram
        gram[:, old:] = self.rows @ response
        gram[old:, :old] = gram[:old, old:].T
        gram[old:, old:] = (gram[old:, old:] + gram[old:, old:].T) / 2.0
        self.gram, self.bounds = gram, self.bounds.joined(bounds)
        n = len(self.start)
        at_rest = self.start + np.column_stack((self.free[:n], self.free[n:2 * n]))
        unit = 1.0 / np.sqrt(np.diag(gram))
        gram = gram * np.outer(unit, unit)
        lack = -self.bounds.excess(at_rest) * unit
        for _ in range(8):
            force = _forces(gram, lack)
            if force is None:
                return False
            self.z = self._least(self.rows.T @ (force * unit))
            excess = self.bounds.excess(self.xy)
            if excess.min() > -2.0 * TOLERANCE:
                return True
            # the matrix has the precision of its factorisation only: aim at what is missing
            lack += gram @ force - lack - excess * unit
        return False

    def _least(self, force):
        """Displacements and s - 1 of least distortion under forces on the unknowns."""
        if self.factor is None:
            return self.constant
        y = np.zeros(len(force))
        for _ in range(1 + REFINEMENTS):
            gradient = self.reduced.T @ (self.matrix @ (self.constant + self.spread @ y))
            y -= self.factor.solve(gradient - force)
        return self.constant + self.spread @ y

    def _full_rows(self, bounds):
        """Bounds as rows over all displacements."""
        n, k = len(self.start), len(bounds.p)
        row, two = np.arange(k), np.flatnonzero(bounds.q >= 0)
        entries = []
        for axis in (0, 1):
            value = bounds.normal[:, axis]
            entries.append((value, row, axis * n + bounds.p))
            entries.append((-value[two], two, axis * n + bounds.q[two]))
        shape = (k, len(self.constant))
        rows = _sparse(*(np.concatenate(part) for part in zip(*entries)), shape)
        rows.eliminate_zeros()
        return rows


def _forces(gram, lack):
    """Solve gram f >= lack, f >= 0, one of both equal everywhere.

    By block principal pivoting, which mostly takes a few steps.

    Returns
    -------
    (k,) float or None
        None where there is no solution, or none was found.
    """
    k = len(lack)
    gram = gram + 1e-12 * np.eye(k)  # four bounds of a pair, and more, may say the same
    pressing = np.zeros(k, dtype=bool)
    fewest, patience = k + 1, 10
    while patience:
        force = np.zeros(k)
        at = np.flatnonzero(pressing)
        try:
            force[at] = np.linalg.solve(gram[np.ix_(at, at)], lack[at])
        except np.linalg.LinAlgError:
            break
        wrong = np.where(pressing, force < 0.0, gram @ force - lack < -0.1 * TOLERANCE)
        count = np.count_nonzero(wrong)
        if count == 0:
            return force
        patience = 10 if count < fewest else patience - 1
        fewest = min(count, fewest)
        pressing ^= wrong
    return _forces_slowly(gram, lack)


def _forces_slowly(gram, lack):
    """The same by the method of Lawson and Hanson, which always ends."""
    from scipy.optimize import nnls

    try:
        root = np.linalg.cholesky(gram)
        force = nnls(root.T, np.linalg.solve(root, lack), maxiter=30 * len(lack))[0]
    except (np.linalg.LinAlgError, RuntimeError):
        return None
    return force if (gram @ force - lack).min() > -1e-7 else None


def focus_program(xy, edges, group, origin, scale, fixed):
    """Return the program of a map with regions in focus.

    Parameters
    ----------
    xy : (n, 2) float
        Of about size 1.
    edges : (m, 2) int
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
    Program
    """
    column, constant = _unknowns(xy, group, origin, scale, fixed)
    return Program(xy, _distortion(xy, edges), column, constant)


def repair_program(xy, carried, edges, fixed):
    """Return the program that changes the edges of a map as little as possible.

    It minimises |d - d'|^2 / |D|^2, d being the vector of an edge as given, and d' the one after.

    Parameters
    ----------
    xy : (n, 2) float
        Positions in the input, for D.
    carried : (n, 2) float
        Positions as given.
    edges : (m, 2) int
    fixed : (n,) bool
        Vertices that stay.

    Returns
    -------
    Program
    """
    n, m = len(xy), len(edges)
    u, v = edges.T
    factor = 1.0 / np.hypot(*(xy[v] - xy[u]).T)
    row = np.arange(m)
    entries = []
    for axis in (0, 1):
        entries.append((factor, axis * m + row, axis * n + u))
        entries.append((-factor, axis * m + row, axis * n + v))
    # a component without a fixed vertex would float
    anchor = max(1e-3, 1e-6 * factor.max(initial=0.0))
    entries.append((np.full(2 * n, anchor), 2 * m + np.arange(2 * n), np.arange(2 * n)))
    matrix = _sparse(*(np.concatenate(part) for part in zip(*entries)), (2 * m + 2 * n, 2 * n))
    column = np.where(np.tile(fixed, 2), -1, np.arange(2 * n))
    return Program(carried, matrix, column, np.zeros(2 * n))


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


def _distortion(xy, edges):
    """The matrix of (s D - d) / |D| at both ends of each edge, of displacements and s - 1."""
    n, m = len(xy), len(edges)
    u, v = edges.T
    vector = xy[v] - xy[u]
    factor = 1.0 / np.hypot(vector[:, 0], vector[:, 1])
    entries = []
    for axis in (0, 1):
        for end, at in enumerate((u, v)):
            row = (2 * end + axis) * m + np.arange(m)
            entries.append((factor, row, axis * n + u))
            entries.append((-factor, row, axis * n + v))
            entries.append((factor * vector[:, axis], row, 2 * n + at))
    return _sparse(*(np.concatenate(part) for part in zip(*entries)), (4 * m, 3 * n))


def _sparse(values, rows, columns, shape):
    from scipy.sparse import csr_matrix

    return csr_matrix((values, (rows, columns)), shape)


def _factorise(matrix):
    from scipy.sparse import diags
    from scipy.sparse.linalg import splu

    how = {
        "permc_spec": "MMD_AT_PLUS_A",
        "diag_pivot_thresh": 0.0,
        "options": {"SymmetricMode": True},
    }
    try:
        return splu(matrix, **how)
    except RuntimeError:  # singular to the last digit; the refinement makes up for the change
        return splu((matrix + 1e-12 * diags(matrix.diagonal())).tocsc(), **how)
