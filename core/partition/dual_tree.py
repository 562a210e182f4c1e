"""Third stage: the rooted trees T on the edges of P and C (section 4.1 of the paper), a forest.

Number the places of the closed walks around polygons without holes, one walk after the other, and take
the edge from the last place of a walk back to its first as root. Then a diagonal is an interval of
places, non-crossing diagonals are nested intervals, and T is their nesting: brackets, not triangles.
So one construction serves whole triangulations, any non-crossing candidate set (section 4.2), the parts
that cuts leave, and any number of polygons.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..rings import groups

__all__ = ["DualTree", "build_tree"]


class DualTree(NamedTuple):
    """The trees T of p polygons, polygon edges folded into the faces they bound.

    Nodes 0 to p - 1 are the root edges; the others are the diagonals in level order, so that parents
    come before their children and siblings stand together.

    Attributes
    ----------
    parent : (p + k,) int
        Parent node; -1 for the roots.
    level_start : (depth + 2,) int
        Level d has the nodes ``level_start[d]`` to ``level_start[d + 1] - 1``; level 0 the roots.
    diagonal : (k,) int
        The diagonal of nodes p to p + k - 1, as a place in the arrays given.
    edge_face : (m,) int
        For the walk's edge that leaves each place: the node just below which it lies; the root itself
        for the root edge.
    """

    parent: np.ndarray
    level_start: np.ndarray
    diagonal: np.ndarray
    edge_face: np.ndarray

    @property
    def roots(self) -> int:
        """The number of root edges."""
        return int(self.level_start[1])


def build_tree(offsets: np.ndarray, i: np.ndarray, j: np.ndarray) -> DualTree:
    """Nest non-crossing diagonals.

    Parameters
    ----------
    offsets : (p + 1,) int
        Where the places of each walk start.
    i, j : (k,) int
        Ends of the diagonals on one walk, i < j; no two alike, none crossing.

    Returns
    -------
    DualTree

    Notes
    -----
    O(m) but for two sorts of k integers (the first is linear where the diagonals already come
    with ascending i, then descending j).

    Examples
    --------
    >>> build_tree(np.array([0, 4, 7]), np.array([1]), np.array([3])).edge_face
    array([0, 2, 2, 0, 1, 1, 1])
    """
    k, m, roots = len(i), int(offsets[-1]), len(offsets) - 1
    preorder, key = None, i * m + (m - 1 - j)
    if not (key[1:] > key[:-1]).all():  # diagonals of triangulations come sorted
        preorder = np.argsort(key, kind="stable")
        i, j = i[preorder], j[preorder]
    closed = np.cumsum(np.bincount(j, minlength=m))
    # of the brackets opened before, those not closed yet are around this one
    depth = np.arange(k) - closed[i]

    depth_count = np.bincount(depth)
    small = depth.astype(np.uint16) if len(depth_count) < 2**16 else depth  # radix sort: linear
    level_order = np.argsort(small, kind="stable")
    node = np.empty(k, dtype=np.int64)  # node of a preorder rank
    node[level_order] = np.arange(roots, roots + k)

    # parent: the bracket opened just before, if that is around it; else that of the bracket before on its
    # own level; or the root edge of the walk
    top = depth_count[0] if k else 0
    outer, inner = level_order[:top], level_order[top:]
    deeper = np.append(False, depth[1:] > depth[:-1])[inner]
    parent = np.empty(roots + k, dtype=np.int64)
    parent[:roots] = -1
    parent[roots : roots + top] = groups(offsets)[i[outer]] if roots > 1 else 0
    parent[roots + top :] = np.maximum.accumulate(np.where(deeper, node[inner - 1], 0))  # parents ascend

    return DualTree(
        parent=parent,
        level_start=np.append(0, roots + np.append(0, np.cumsum(depth_count))),
        diagonal=level_order if preorder is None else preorder[level_order],
        edge_face=_innermost(offsets, i, j, node, parent[node]),
    )


def _innermost(offsets, i, j, node, parent_of):
    """Node of the innermost bracket around each step from a place to the next."""
    m, roots = int(offsets[-1]), np.arange(len(offsets) - 1)
    changed = np.zeros(m, dtype=np.int64)
    innermost = np.zeros(m, dtype=np.int64)
    changed[offsets[:-1]] = offsets[:-1]
    innermost[offsets[:-1]] = roots
    # where brackets close, the parent of the outermost of them remains, the last to be written ...
    innermost[j[::-1]] = parent_of[::-1]
    changed[j] = j
    # ... unless others open there: the innermost of these
    innermost[i] = node
    changed[i] = i
    innermost = innermost[np.maximum.accumulate(changed)]
    innermost[offsets[1:] - 1] = roots
    return innermost
