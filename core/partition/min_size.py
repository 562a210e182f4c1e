"""Fourth stage: which diagonals to select (section 4 of the paper).

MinSize needs one small state per edge instead of the paper's three tables:

* A LEAF or ROOT assignment helps only if it is one edge smaller than the SELF assignment (Lemma 2).
* Where such a LEAF assignment exists, no ROOT assignment of that size is needed: LEAF offers a path
  as well, and its front-allowance is infinite.

So a node is in state LEAF with a front-length L, or in state ROOT with a front-allowance R. With
l(e) the length of e, and over the children x of e

    b(x) = L(x) if x is in state LEAF, else l(x)     what x offers as a path
    F    = sum of b(x)
    a    = max of R(x) + b(x) over the x in state ROOT, minus F

the node e can serve one ROOT child if a >= l(e); then it is in state ROOT with R = min(tau l(e), a).
Otherwise it is in state LEAF with L = F if F <= tau l(e), else in state ROOT with R = tau l(e). Only
assignments of exactly the least size matter, so every child that can save an edge must save it, and
nothing is left to choose: any number of children costs O(1) each, and no sorting is needed where
section 4.2 of the paper sorts.
"""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np

from ..progress import ignore
from ..rings import starts
from .dual_tree import DualTree

__all__ = ["LEAF", "ROOT", "SELF", "Network", "min_size", "network", "witness_lengths"]

SELF, LEAF, ROOT = 0, 1, 2

SLACK = 1e-12  # relative; ties path = tau * length are common on lattices

# Below this mean number of nodes in a level, a scalar loop over all nodes beats vector calls on each
# level: 1.3 microseconds a node against 25 a level (corridors, spirals).
NARROW = 20


class Network(NamedTuple):
    """A forest of dual trees with lengths.

    Attributes
    ----------
    tree : DualTree
    length : (p + k,) float
        l(e) of each node, the root edges first.
    base : (p + k,) float
        Summed length of the polygon edges on the face just below each node.
    """

    tree: DualTree
    length: np.ndarray
    base: np.ndarray

    @property
    def narrow(self) -> bool:
        """Whether the trees are so deep that scalar loops are faster."""
        return len(self.length) < NARROW * len(self.tree.level_start)


def network(tree: DualTree, offsets: np.ndarray, step: np.ndarray, diagonal_length: np.ndarray) -> Network:
    """Join dual trees with the lengths of their edges (T and ||e|| in section 4.1 of the paper).

    Parameters
    ----------
    tree : DualTree
    offsets : (p + 1,) int
        Where the places of each walk start.
    step : (m,) float
        Length of the walk's edge that leaves each place.
    diagonal_length : (k,) float
        Lengths of the diagonals, in the order in which the tree was given them.

    Examples
    --------
    A long rhombus, cut across by its short diagonal: the edge from place 3 back to place 0 is the root.

    >>> from isthmus.core.partition.dual_tree import build_tree
    >>> walk = np.array([0, 4])
    >>> tree = build_tree(walk, np.array([1]), np.array([3]))
    >>> net = network(tree, walk, np.full(4, 10.0), np.array([2.0]))
    >>> net.length.tolist(), net.base.tolist()
    ([10.0, 2.0], [10.0, 20.0])
    """
    root = offsets[1:] - 1
    length = np.append(step[root], diagonal_length[tree.diagonal])
    below = step.copy()
    below[root] = 0.0
    base = np.bincount(tree.edge_face, weights=below, minlength=len(length))
    return Network(tree, length, base)


def min_size(net: Network, tau: float | np.ndarray, check: Callable | None = None) -> np.ndarray:
    """Solve MinSize: the fewest diagonals so that all are within tau (Theorem 1 of the paper, section 4.1).

    Parameters
    ----------
    net : Network
    tau : float, or (p + k,) float
        Largest dilation allowed, at least 1, for all nodes or each.
    check : callable, optional
        Called now and then with the share done; may raise `Cancelled`.

    Returns
    -------
    (p + k,) int8
        The role assignment alpha: SELF, LEAF or ROOT for each node. The root edges have SELF; the
        other SELF nodes are the solution S.

    Notes
    -----
    O(n) for n edges. The size does not depend on the root edge.

    Examples
    --------
    A long rhombus, and its short diagonal as the only candidate: the way around it is 10 times as long.

    >>> from isthmus.core.partition.dual_tree import build_tree
    >>> walk = np.array([0, 4])
    >>> tree = build_tree(walk, np.array([1]), np.array([3]))
    >>> net = network(tree, walk, np.full(4, 10.0), np.array([2.0]))
    >>> min_size(net, 9.0).tolist() == [SELF, SELF], min_size(net, 10.0).tolist() == [SELF, LEAF]
    (True, True)
    """
    solve = _states_by_node if net.narrow else _states_by_level
    leaf, value, serves = solve(net, tau, check or ignore)
    role = np.where(leaf, np.int8(LEAF), np.int8(SELF))
    role[: net.tree.roots] = SELF
    role[_served(net, leaf, value, serves)] = ROOT
    return role


def witness_lengths(
    net: Network, cut: np.ndarray | None, check: Callable | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Lengths of the shortest paths on the two sides of each edge, in P and a set of cuts.

    The sides are the components T^LEAF and T^ROOT of section 4.1 of the paper; the paths that are short
    enough are its witnesses (section 2).

    Exact for a polygon without holes, where a shortest path between the ends of a diagonal stays
    on one side of it. For a carved polygon both are upper bounds.

    Parameters
    ----------
    net : Network
    cut : (p + k,) bool
        The selected nodes; true for the root edges. None: every edge may be walked, or the way around
        it where that is shorter.
    check : callable, optional
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    below, above : (p + k,) float
        Through the component T^LEAF and through T^ROOT of each node.

    Notes
    -----
    O(n).

    Examples
    --------
    A long rhombus with its short diagonal, which is not selected: 20 around it on either side.

    >>> from isthmus.core.partition.dual_tree import build_tree
    >>> walk = np.array([0, 4])
    >>> tree = build_tree(walk, np.array([1]), np.array([3]))
    >>> net = network(tree, walk, np.full(4, 10.0), np.array([2.0]))
    >>> below, above = witness_lengths(net, np.array([True, False]))
    >>> float(below[1]), float(above[1])
    (20.0, 20.0)
    """
    sides = _sides_by_node if net.narrow else _sides_by_level
    return sides(net, cut, check or ignore)


def _levels(tree):
    """Slices of the nodes of each level, the root's first."""
    bounds = tree.level_start.tolist()
    return [slice(lo, hi) for lo, hi in zip(bounds[:-1], bounds[1:])]


def _states_by_level(net, tau, check):
    """State of each node, the deepest level first."""
    length, parent = net.length, net.tree.parent
    allowed = tau * length
    at_most, at_least = allowed * (1.0 + SLACK), length * (1.0 - SLACK)
    levels = _levels(net.tree)
    total = net.base.copy()  # F
    leaf = np.empty(len(length), dtype=bool)
    value = allowed.copy()  # R; L is F
    serves = np.zeros(len(length), dtype=bool)
    # nodes with children in state ROOT, and of each the maximum of R(x) + b(x)
    asked, best = np.empty(0, dtype=np.int64), np.empty(0)
    for d in range(len(levels) - 1, -1, -1):
        if d % 64 == 0:
            check(1.0 - d / len(levels))
        e = levels[d]
        is_leaf = np.less_equal(total[e], at_most[e], out=leaf[e])
        if len(asked):  # few are
            spare = best - total[asked]
            able = spare >= at_least[asked]
            asked, spare = asked[able], spare[able]
            serves[asked], leaf[asked] = True, False
            value[asked] = np.minimum(allowed[asked], spare)
        if d:
            up = levels[d - 1]
            offer = np.where(is_leaf, total[e], length[e])
            total[up] += np.bincount(parent[e] - up.start, weights=offer, minlength=up.stop - up.start)
            asked, best = np.flatnonzero(~is_leaf) + e.start, np.empty(0)
            if len(asked):
                of, demand = parent[asked], value[asked] + length[asked]
                first = starts(of)
                asked, best = of[first], np.maximum.reduceat(demand, first)
    return leaf, np.where(leaf, total, value), serves


def _states_by_node(net, tau, check):
    """The same, one node at a time."""
    parent, length = net.tree.parent.tolist(), net.length.tolist()
    limit = (tau * net.length).tolist()
    total = net.base.tolist()
    n = len(length)
    best = [-np.inf] * n
    leaf, value, serves = [False] * n, [0.0] * n, [False] * n
    shrink, grow = 1.0 - SLACK, 1.0 + SLACK
    for e in range(n - 1, -1, -1):
        if e % 65536 == 0:
            check(1.0 - e / n)
        own, up = length[e], parent[e]
        allowed, path = limit[e], total[e]
        spare = best[e] - path
        if spare >= own * shrink:
            serves[e] = True
            allowed = min(allowed, spare)
        elif path <= allowed * grow:
            leaf[e] = True
            value[e] = path
            if up >= 0:
                total[up] += path
            continue
        value[e] = allowed
        if up < 0:
            continue
        total[up] += own
        if allowed + own > best[up]:
            best[up] = allowed + own
    return np.array(leaf, dtype=bool), np.array(value), np.array(serves, dtype=bool)


def _served(net, leaf, value, serves):
    """The child in state ROOT that each serving node serves: the first with the most to spare."""
    parent = net.tree.parent
    roots = net.tree.roots
    asking = np.flatnonzero(~leaf[roots:]) + roots
    asking = asking[serves[parent[asking]]]
    if not len(asking):
        return asking
    demand = value[asking] + net.length[asking]
    first = np.flatnonzero(np.diff(parent[asking], prepend=-1))  # children stand together
    offsets = np.append(first, len(asking))
    most = np.flatnonzero(demand == np.repeat(np.maximum.reduceat(demand, first), np.diff(offsets)))
    return asking[most[np.searchsorted(most, first)]]


def _sides_by_level(net, cut, check):
    """Lengths of the paths on the leaf side and on the root side of each node."""
    length, parent = net.length, net.tree.parent
    levels = _levels(net.tree)
    below = net.base.copy()
    for d in range(len(levels) - 1, 0, -1):
        if d % 64 == 0:
            check()
        e, up = levels[d], levels[d - 1]
        offer = _way(cut, e, length[e], below[e])
        below[up] += np.bincount(parent[e] - up.start, weights=offer, minlength=up.stop - up.start)
    # the way around below the parent, without the node's own; to come is the way above it
    above = below[parent] - _way(cut, slice(None), length, below)
    above[: net.tree.roots] = np.inf
    for d in range(1, len(levels)):
        if d % 64 == 0:
            check()
        e, up = levels[d], levels[d - 1]
        above[e] += _way(cut, up, length[up], above[up])[parent[e] - up.start]
    return below, above


def _way(cut, nodes, length, around):
    """What edges contribute to a path: themselves where they are selected, else the way around."""
    return np.minimum(length, around) if cut is None else np.where(cut[nodes], length, around)


def _sides_by_node(net, cut, check):
    """The same, one node at a time."""
    parent, length = net.tree.parent.tolist(), net.length.tolist()
    shortest = cut is None
    cut = [False] * len(length) if shortest else cut.tolist()
    below = net.base.tolist()
    n, roots = len(length), net.tree.roots
    above = [np.inf] * n
    for e in range(n - 1, roots - 1, -1):
        if e % 65536 == 0:
            check()
        below[parent[e]] += length[e] if cut[e] or shortest and length[e] < below[e] else below[e]
    for e in range(roots, n):
        if e % 65536 == 0:
            check()
        up = parent[e]
        above[e] = (
            below[up]
            - (length[e] if cut[e] or shortest and length[e] < below[e] else below[e])
            + (length[up] if cut[up] or shortest and length[up] < above[up] else above[up])
        )
    return np.array(below), np.array(above)
