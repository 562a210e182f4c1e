"""The map with the least distortion in which no triangle turns.

The distortion is that of Haunert and Sering (2011). With D the vector of an edge u-v before, d the
one after, and s_u a local scale, unknown as the positions are, it is the sum over vertices u and
their neighbours v of

    |s_u D - d|^2 / |D|^2

There is no rotation: north stays up. In the focus s is given, and positions are those of the scaled
region up to one translation, so all of it is exact.

All triangles of the frame stand guard: each adds a little of |J|^2 / (2 det J) + (det J + 1 / det J) / 2,
J being the matrix of its affine map, which is infinite where a triangle is flat. From the identity
the focus grows by Newton steps, none of which leaves a triangle less than `LEFT` of its area (the bound
of Smith and Schaefer 2015). So every state on the way is without a fold.
"""

from __future__ import annotations

from typing import Callable, Sequence

import numpy as np

from .mesh import cross, heights

__all__ = ["relax", "unbounded"]

GUARD = 1e-4  # weight of all triangles beside that of the edges
AREA = 0.5  # weight of the change of area beside that of the change of shape in a triangle
THIN = 1e-11  # height of a triangle that the precision of the program does not reach
LEFT = 0.05  # of a triangle's area, what a step must leave
STEPS = 150  # Newton steps before giving up
LAST = 12  # of these, after the scale is reached
SMALL = 1e-3  # share of the energy, below which a step is the last
STUCK = 1e-4  # of the way, below which a step is none


def relax(
    xy: np.ndarray,
    triangles: np.ndarray,
    edges: np.ndarray,
    group: np.ndarray,
    origin: np.ndarray,
    scale: float,
    fixed: Sequence[tuple[int, np.ndarray, float]],
    check: Callable,
    *,
    stiff: np.ndarray | None = None,
    guard: float = GUARD,
) -> tuple[np.ndarray, float]:
    """Move the vertices of a triangulation so that its edges are distorted least.

    Parameters
    ----------
    xy : (n, 2) float
        Of about size 1.
    triangles : (t, 3) int
        Counter-clockwise, of a convex region.
    edges : (m, 2) int
        What is to keep its shape; they need not be sides of triangles.
    group : (n,) int
        The region in focus that each vertex belongs to, -1 for none.
    origin : (g, 2) float
        A point of each region; what its scaling is counted from.
    scale : float
    fixed : sequence of (axis, vertices, displacement)
        Axis 0 is x, 1 is y. A vertex in focus fixes its region.
    check : callable
        Called with the share done; may raise `Cancelled`.
    stiff : (t,) float, optional
        How much more than others a triangle is to keep its shape.
    guard : float
        Weight of the triangles beside the edges.

    Returns
    -------
    shift : (n, 2) float
        Displacements.
    reached : float
        The share of the way from the identity that was gone: 1 unless there is no room.

    Notes
    -----
    The distortion is that of Haunert and Sering (2011), the bound of the steps that of Smith and Schaefer
    (2015). A sparse factorisation, nearly O(n), for each of about 10 to 30 steps.

    Examples
    --------
    The middle cell of nine becomes 1.5 times as wide, the sides stay, and no triangle turns.

    >>> from isthmus.core.focus.mesh import frame_triangles, turned
    >>> xy = np.array([(x, y) for x in range(4) for y in range(4)]) / 3.0
    >>> triangles = frame_triangles(xy, np.empty((0, 2), dtype=int))
    >>> edges = np.array([(5, 6), (6, 10), (9, 10), (5, 9)])
    >>> group = np.where(((xy > 0.0) & (xy < 1.0)).all(axis=1), 0, -1)
    >>> sides = [(axis, np.flatnonzero(xy[:, axis] == end), 0.0) for axis in (0, 1) for end in (0.0, 1.0)]
    >>> shift, reached = relax(xy, triangles, edges, group, xy[[5]], 1.5, sides, lambda share: None)
    >>> moved = xy + shift
    >>> np.ptp(moved[group == 0], axis=0).round(6).tolist(), np.ptp(moved, axis=0).round(6).tolist()
    ([0.5, 0.5], [1.0, 1.0])
    >>> reached, bool(turned(xy, moved, triangles).any())
    (1.0, False)
    """
    n = len(xy)
    column, constant = _unknowns(xy, edges, group, origin, scale, fixed)
    spread, used = _spread(column)
    ends = group[edges]
    edges = edges[(ends[:, 0] != ends[:, 1]) | (ends[:, 0] < 0)]
    matrix = _distortion(xy, edges)
    reduced = (matrix @ spread).tocsr()
    square = (2.0 * (reduced.T @ reduced)).tocsc()
    pull = 2.0 * (reduced.T @ (matrix @ constant))
    corner = group[triangles]
    loose = (corner.min(axis=1) != corner.max(axis=1)) | (corner[:, 0] < 0)
    loose &= heights(xy, triangles) > THIN
    triangles = triangles[loose]
    gradient, area = _gradient(xy, triangles)
    weight = guard * max(len(edges), 1) * area / area.sum()
    if stiff is not None:
        weight = weight * stiff[loose]
    slope = (gradient @ spread[: 2 * n]).tocsr()
    fast = gradient @ constant[: 2 * n]
    pattern = _Blocks(len(triangles))
    q, done = np.zeros(used), 0.0

    def energy(jacobian, q):
        residual = reduced @ q + matrix @ (constant * done)
        return residual @ residual + weight @ _shape_energy(jacobian)

    def jacobian_of(q, done):
        return (slope @ q + fast * done).reshape(-1, 4) + (1.0, 0.0, 0.0, 1.0)

    last, idle, short = 0, 0, False
    jacobian = jacobian_of(q, done)
    for step in range(STEPS):
        check(min(0.9 * done + 0.1 * step / STEPS, 1.0))
        first, second = _derivatives(jacobian)
        force = square @ q + pull * done + slope.T @ (weight[:, None] * first).ravel()
        bend = pattern.matrix(weight[:, None, None] * second)
        hessian = (square + slope.T @ (bend @ slope)).tocsc()
        go = 0.0 if short else 1.0 - done
        target = -force
        if go:
            target = target - go * (pull + slope.T @ (bend @ fast))
        move = _solve(hessian, target)
        change = (slope @ move + fast * go).reshape(-1, 4)
        length = _bound(jacobian, change)
        if go:
            q, gone = q + length * move, length * go
            done = 1.0 if length == 1.0 else done + gone
            jacobian = jacobian_of(q, done)
            idle = idle + 1 if gone < STUCK else 0
            if idle > 8:
                break
            short = done < 1.0 and length < 0.1
            continue
        now = energy(jacobian, q)
        decrement = force @ move
        for _ in range(30):
            trial = jacobian_of(q + length * move, done)
            # where the focus is all there is, no triangle is left that could turn
            if _determinant(trial).min(initial=np.inf) > 0.0 and energy(trial, q + length * move) <= (
                now + 1e-4 * length * decrement
            ):
                q, jacobian = q + length * move, trial
                break
            length *= 0.5
        short = False
        if done == 1.0:
            last += 1
            if -decrement < SMALL * now or last >= LAST:
                break
            short = True
    z = spread @ q + constant * done
    return np.column_stack((z[:n], z[n : 2 * n])), done


def unbounded(
    xy: np.ndarray,
    edges: np.ndarray,
    group: np.ndarray,
    origin: np.ndarray,
    scale: float,
    fixed: Sequence[tuple[int, np.ndarray, float]],
    anchors: np.ndarray,
) -> np.ndarray:
    """Return displacements of least distortion without triangles, and with s = 1 at some vertices.

    Parameters, returns: see `relax`; ``anchors`` are vertices.

    Notes
    -----
    The distortion is that of Haunert and Sering (2011), and its least is one linear system.

    Examples
    --------
    Of three links of a chain the first is in the focus and grows most, the last grows least.

    >>> chain = np.array([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0)])
    >>> links = np.array([(0, 1), (1, 2), (2, 3)])
    >>> group, first, last = np.array([0, 0, -1, -1]), np.array([0]), np.array([3])
    >>> shift = unbounded(chain, links, group, chain[:1], 2.0, [(0, first, 0.0), (1, first, 0.0)], last)
    >>> (chain + shift)[:, 0].round(6).tolist()
    [0.0, 2.0, 3.75, 5.0]
    """
    column, constant = _unknowns(xy, edges, group, origin, scale, fixed)
    n = len(xy)
    free = anchors[group[anchors] < 0]
    column[2 * n + free] = -1
    spread, used = _spread(column)
    matrix = _distortion(xy, edges)
    reduced = (matrix @ spread).tocsc()
    y = _solve((reduced.T @ reduced).tocsc(), -(reduced.T @ (matrix @ constant)))
    z = spread @ y + constant
    return np.column_stack((z[:n], z[n : 2 * n]))


def _unknowns(xy, edges, group, origin, scale, fixed):
    """Unknown of each x, y and s (-1: none), and the constant to add to it."""
    n = len(xy)
    column = np.arange(3 * n)
    constant = np.zeros(3 * n)
    column[2 * n :][np.bincount(edges.ravel(), minlength=n) == 0] = -1
    inside = np.flatnonzero(group >= 0)
    first = np.full(len(origin), -1)
    first[group[inside][::-1]] = inside[::-1]
    for axis in (0, 1):
        place = axis * n + inside
        column[place] = axis * n + first[group[inside]]
        constant[place] = (scale - 1.0) * (xy[inside, axis] - origin[group[inside], axis])
    column[2 * n + inside] = -1
    constant[2 * n + inside] = scale - 1.0
    for axis, vertices, displacement in fixed:
        outside = vertices[group[vertices] < 0]
        column[axis * n + outside] = -1
        constant[axis * n + outside] = displacement
        for g in np.unique(group[vertices][group[vertices] >= 0]).tolist():
            at = vertices[group[vertices] == g][0]
            region = axis * n + np.flatnonzero(group == g)
            if column[region[0]] >= 0:
                constant[region] += displacement - constant[axis * n + at]
                column[region] = -1
    return column, constant


def _spread(column):
    """The matrix from unknowns to x, y and s, and the number of unknowns."""
    free = np.flatnonzero(column >= 0)
    used, number = np.unique(column[free], return_inverse=True)
    return _sparse(np.ones(len(free)), free, number.ravel(), (len(column), len(used))), len(used)


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


def _gradient(xy, triangles):
    """The matrix from displacements to J - 1 of each triangle (xx, xy, yx, yy), and their areas."""
    n, t = len(xy), len(triangles)
    a, b, c = xy[triangles].transpose(1, 0, 2)
    double = cross(b - a, c - a)
    entries = []
    for vertex, (p, q) in zip(triangles.T, ((b, c), (c, a), (a, b))):
        side = q - p
        slope = np.column_stack((-side[:, 1], side[:, 0])) / double[:, None]
        for i in (0, 1):
            for j in (0, 1):
                entries.append((slope[:, j], 4 * np.arange(t) + 2 * i + j, i * n + vertex))
    return _sparse(*(np.concatenate(part) for part in zip(*entries)), (4 * t, 2 * n)), double / 2.0


def _determinant(jacobian):
    return jacobian[:, 0] * jacobian[:, 3] - jacobian[:, 1] * jacobian[:, 2]


def _shape_energy(jacobian):
    square, det = (jacobian**2).sum(axis=1), _determinant(jacobian)
    return square / (2.0 * det) + AREA / 2.0 * (det + 1.0 / det)


def _derivatives(jacobian):
    """Gradient (t, 4) and positive semidefinite Hessian (t, 4, 4) of `_shape_energy`."""
    square, det = (jacobian**2).sum(axis=1)[:, None], _determinant(jacobian)[:, None]
    cofactor = jacobian[:, [3, 2, 1, 0]] * (1.0, -1.0, -1.0, 1.0)
    by_det = -square / (2.0 * det**2) + AREA / 2.0 * (1.0 - 1.0 / det**2)
    first = jacobian / det + by_det * cofactor
    mixed = -1.0 / det**2
    twice = (square + AREA) / det**3
    outer = jacobian[:, :, None] * cofactor[:, None, :]
    second = mixed[:, :, None] * (outer + outer.transpose(0, 2, 1))
    second += twice[:, :, None] * cofactor[:, :, None] * cofactor[:, None, :]
    second += (1.0 / det)[:, :, None] * np.eye(4)
    turn = np.zeros((4, 4))
    turn[0, 3] = turn[3, 0] = 1.0
    turn[1, 2] = turn[2, 1] = -1.0
    second += by_det[:, :, None] * turn
    value, vector = np.linalg.eigh(second)
    return first, np.einsum("tij,tj,tkj->tik", vector, np.maximum(value, 0.0), vector)


def _bound(jacobian, change):
    """The longest step, at most 1, that leaves each triangle enough of its area."""
    a, b, c, d = jacobian.T
    e, f, g, h = change.T
    now = _determinant(jacobian)
    # det(J + t C) = now + t linear + t^2 bend; where is it LEFT * now?
    linear, bend = a * h + d * e - b * g - c * f, e * h - f * g
    rest = (1.0 - LEFT) * now
    root = linear**2 - 4.0 * bend * rest
    with np.errstate(all="ignore"):
        t = 2.0 * rest / (-linear + np.sqrt(root))
    t[~(root >= 0.0) | ~(t > 0.0)] = np.inf
    return min(1.0, float(t.min(initial=np.inf)))


class _Blocks:
    """Block diagonal matrices of 4 x 4 blocks."""

    def __init__(self, count):
        self.columns = np.arange(count)
        self.begin = np.arange(count + 1)
        self.size = 4 * count

    def matrix(self, blocks):
        from scipy.sparse import bsr_matrix

        return bsr_matrix((blocks, self.columns, self.begin), shape=(self.size, self.size)).tocsr()


def _solve(matrix, target):
    """Solve a symmetric positive definite system."""
    from scipy.sparse import diags
    from scipy.sparse.linalg import splu

    size = matrix.diagonal()
    matrix = matrix + diags(1e-12 * size + 1e-14 * size.max(initial=1.0))
    how = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    if not len(target):
        return target
    return splu(matrix.tocsc(), **how).solve(target)


def _sparse(values, rows, columns, shape):
    from scipy.sparse import csr_matrix

    return csr_matrix((values, (rows, columns)), shape)
