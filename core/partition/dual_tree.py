"""Third stage: the rooted tree T on the edges of P and C (section 4.1 of the paper).

Number the places of the closed walk around a polygon without holes 0 to m - 1, and take the edge
from m - 1 back to 0 as root. Then a diagonal is an interval of places, non-crossing diagonals are
nested intervals, and T is their nesting: brackets, not triangles. So one construction serves whole
triangulations, any non-crossing candidate set (section 4.2), and the parts that cuts leave.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

__all__ = ["DualTree", "build_tree"]


class DualTree(NamedTuple):
    """The tree T, polygon edges folded into the faces they bound.

    Node 0 is the root edge; the others are the diagonals in level order, so that parents come
    before their children and siblings stand together.

    Attributes
    ----------
    parent : (k + 1,) int
        Parent node; -1 for the root.
    level_start : (depth + 2,) int
        Level d has the nodes ``level_start[d]`` to ``level_start[d + 1] - 1``.
    diagonal : (k,) int
        The diagonal of nodes 1 to k, as a place in the arrays given.
    edge_face : (m - 1,) int
        For the walk's edge from place i to i + 1: the node just below which it lies.
    """

    parent: np.ndarray
    level_start: np.ndarray
    diagonal: np.ndarray
    edge_face: np.ndarray


def build_tree(m, i, j):
    """Nest non-crossing diagonals.

    Parameters
    ----------
    m : int
        Number of places on the walk.
    i, j : (k,) int
        Ends of the diagonals, i < j; no two alike, none crossing.

    Returns
    -------
    DualTree

    Notes
    -----
    O(m) but for two sorts of k integers (the first is linear where the diagonals already come
    with ascending i, then descending j).
    """
    k = len(i)
    preorder = np.argsort(i * m + (m - 1 - j), kind="stable")
    i, j = i[preorder], j[preorder]
    opened = np.cumsum(np.bincount(i, minlength=m))
    closed = np.cumsum(np.bincount(j, minlength=m))
    rank = np.arange(k)
    # of the `rank` brackets opened before, those not closed yet are around this one
    depth = rank - closed[i]

    depth_count = np.bincount(depth)
    small = depth.astype(np.uint16) if len(depth_count) < 2**16 else depth  # radix sort: linear
    level_order = np.argsort(small, kind="stable")
    node = np.empty(k + 1, dtype=np.int64)  # node of a preorder rank; rank -1 is the root
    node[level_order] = np.arange(1, k + 1)
    node[-1] = 0

    # parent: the last bracket opened before, one level up
    parent_rank = np.full(k, -1)
    deeper = depth[level_order] > 0
    key = depth[level_order] * k + level_order
    parent_rank[level_order[deeper]] = level_order[
        np.searchsorted(key, key[deeper] - k, side="right") - 1
    ]
    parent = np.full(k + 1, -1)
    parent[node[:-1]] = node[parent_rank]

    return DualTree(
        parent=parent,
        level_start=np.append(0, 1 + np.append(0, np.cumsum(depth_count))),
        diagonal=preorder[level_order],
        edge_face=node[_innermost(m, i, j, opened, closed, parent_rank)],
    )


def _innermost(m, i, j, opened, closed, parent_rank):
    """Preorder rank of the innermost bracket around each step from a place to the next."""
    changed = np.zeros(m, dtype=np.int64)
    innermost = np.full(m, -1)
    # where brackets close, the parent of the outermost of them remains ...
    innermost[j[::-1]] = parent_rank[::-1]
    changed[j] = j
    # ... unless others open there
    innermost[i] = opened[i] - 1
    changed[i] = i
    return innermost[np.maximum.accumulate(changed)][: m - 1]
