"""Nested partitions for every tau: cuts go one by one, always the one that is needed least.

The optimum for one tau need not contain that for a larger one. A hierarchy begins with the optimum at
the smallest tau and takes away, again and again, the cut whose loss leaves the smallest largest
dilation. That dilation is the cut's *persistence*: the tau up to which it is needed. So the cuts with
a persistence above tau are a solution for tau, and these solutions are nested.

A cut joins two parts when it goes, and all distances that change lie in these: the way around a part
that led along the cut now leads around the other part. With per(P) the perimeter of a part, l the
length of the cut, a way that passed it becomes longer by per(Q) - 2 l. So each cut's price, the largest
dilation in its two parts once it has gone, is a matter of these parts alone, and it only ever rises:
a queue whose first entry is looked at again before it is believed always gives the least.
"""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from typing import Callable, NamedTuple

import numpy as np

from .min_size import witness_lengths
from .solve import Prepared, Selection
from ..progress import ignore

__all__ = ["Hierarchy", "Levels", "hierarchy", "levels"]


class Hierarchy(NamedTuple):
    """The cuts of an optimum, in the order in which they are needed.

    Attributes
    ----------
    cut : (s,) int
        The selected edges, ascending.
    persistence : (s,) float
        The tau up to which each is needed: from there on, the more persistent cuts suffice. Infinite
        for the edges that connect holes.
    rank : (s,) int
        1 for the most persistent in its polygon.
    """

    cut: np.ndarray
    persistence: np.ndarray
    rank: np.ndarray


class Levels(NamedTuple):
    """The parts of all levels, each once: first those of the finest partition, then as they are made.

    Attributes
    ----------
    parent : (m,) int
        The part that each becomes a piece of; -1 where it stays.
    from_tau, to_tau : (m,) float
        A part is one of the partition at tau where ``from_tau <= tau < to_tau``.
    leaf : (count,) int
        The parts of the finest partition, so ordered that those that make up any part stand together.
    first, last : (m,) int
        They are ``leaf[first:last]``.
    """

    parent: np.ndarray
    from_tau: np.ndarray
    to_tau: np.ndarray
    leaf: np.ndarray
    first: np.ndarray
    last: np.ndarray

    @property
    def pieces(self) -> list:
        """For each part those of the finest partition that make it up, ascending."""
        return [np.sort(self.leaf[lo:hi]) for lo, hi in zip(self.first.tolist(), self.last.tolist())]


def hierarchy(prepared: Prepared, selection: Selection, check: Callable = ignore) -> Hierarchy:
    """Order the cuts of solutions by the tau up to which they are needed.

    Parameters
    ----------
    prepared : Prepared
    selection : Selection
        The optimum at the smallest tau.
    check : callable, optional
        Called now and then with the share done; may raise `Cancelled`.

    Returns
    -------
    Hierarchy
        For polygons with holes, persistences are upper bounds, as are the dilations of the carved
        polygon, and the edges of T stay.

    Notes
    -----
    O(log s) for each look at the queue, and one array call over the candidates of the two parts; a
    few looks for each of the s cuts.

    Examples
    --------
    Two squares joined by a corridor that is 1 wide and 4 long; one end of it is as good as the other.

    >>> import numpy as np
    >>> from isthmus.core.partition.solve import prepare, select
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [4, 0], [4, 4], [8, 4], [8, 0], [12, 0], [12, 9], [8, 9], [8, 5], [4, 5],
    ...                [4, 9], [0, 9.0]])
    >>> prepared = prepare(one_polygon(xy, [0, 12]))
    >>> found = hierarchy(prepared, select(prepared, 8.0))
    >>> found.rank, found.persistence.round(1)
    (array([2, 1]), array([ 9., 25.]))
    """
    carved, length = selection.carved, prepared.length
    net, node_edge = carved.net, carved.node_edge
    roots, parent = net.tree.roots, net.tree.parent
    chosen = np.zeros(len(length), dtype=bool)
    chosen[selection.selected] = True
    cut = np.append(np.ones(roots, dtype=bool), chosen[node_edge])
    below, above = witness_lengths(net, cut, check)

    # a part is named after its top face, just below a cut or a root
    top = np.arange(len(cut))
    for level in zip(net.tree.level_start[1:-1].tolist(), net.tree.level_start[2:].tolist()):
        nodes = np.arange(*level)
        inner = nodes[~cut[nodes]]
        top[inner] = top[parent[inner]]
    perimeter = below + net.length  # right for the tops, where it is used
    members = {int(k): np.empty(0, dtype=np.int64) for k in np.flatnonzero(cut)}
    bounded = np.append(np.zeros(roots, dtype=bool), prepared.bounded[node_edge])
    inner = np.flatnonzero(~cut & bounded)
    inner = inner[np.argsort(top[inner], kind="stable")]
    first = np.flatnonzero(np.diff(top[inner], prepend=-1))
    for group in np.split(inner, first[1:]) if len(inner) else ():
        members[int(top[group[0]])] = group

    i = np.append(np.full(roots, -1), carved.walk.i[node_edge])
    j = np.append(np.full(roots, -1), carved.walk.j[node_edge])
    merged = {}  # part: the one it has become a piece of

    def part(face):
        while face in merged:
            if merged[face] in merged:
                merged[face] = merged[merged[face]]
            face = merged[face]
        return face

    def ways(node):
        """The parts above and below a cut, their members, and the two ways of these without it."""
        upper, lower = part(int(top[parent[node]])), part(int(node))
        p, q = members[upper], members[lower]
        more_p = perimeter[lower] - 2.0 * net.length[node]
        more_q = perimeter[upper] - 2.0 * net.length[node]
        around = (i[p] <= i[node]) & (j[node] <= j[p])
        new_below = np.concatenate((below[p] + np.where(around, more_p, 0.0), below[q]))
        new_above = np.concatenate((above[p] + np.where(around, 0.0, more_p), above[q] + more_q))
        own = perimeter[lower] - net.length[node], perimeter[upper] - net.length[node]
        return upper, lower, np.append(p, q), new_below, new_above, own

    def price(node):
        _, _, nodes, new_below, new_above, own = ways(node)
        dilation = np.minimum(new_below, new_above) / net.length[nodes]
        return max(dilation.max(initial=1.0), min(own) / net.length[node])

    cuts = [k for k in np.flatnonzero(cut).tolist() if k >= roots]
    owner = prepared.owner[node_edge]
    # what the candidates need at the smallest tau, whatever goes
    least = np.ones(len(prepared.polygons.unit))
    inside = np.minimum(below, above)[roots:] / net.length[roots:]
    some = bounded[roots:] & ~cut[roots:]
    np.maximum.at(least, owner[some], inside[some])
    version = dict.fromkeys(members, 0)  # the cut that changed each part last
    queue = [(price(k), k, 0, 0) for k in cuts]
    heapify(queue)
    persistence = np.full(len(length), np.inf)
    order = []
    while queue:
        cost, node, seen_upper, seen_lower = heappop(queue)
        upper, lower = part(int(top[parent[node]])), part(int(node))
        if (version[upper], version[lower]) != (seen_upper, seen_lower):
            heappush(queue, (price(node), node, version[upper], version[lower]))
            continue
        if len(order) % 64 == 0:
            check(len(order) / len(cuts))
        upper, lower, nodes, new_below, new_above, own = ways(node)
        below[nodes], above[nodes] = new_below, new_above
        below[node], above[node] = own
        perimeter[upper] += perimeter[lower] - 2.0 * net.length[node]
        members[upper] = np.append(nodes, node)
        del members[lower]
        merged[lower] = upper
        version[upper] = len(order) + 1
        edge, polygon = int(node_edge[node - roots]), int(owner[node - roots])
        least[polygon] = max(least[polygon], cost)
        persistence[edge] = least[polygon]
        order.append(edge)

    selected = selection.selected
    # the last to go is the most persistent; the edges of T come before all
    gone = np.full(len(length), len(order))
    gone[order] = np.arange(len(order))
    by_rank = np.lexsort((selected, -gone[selected], prepared.owner[selected]))
    polygon = prepared.owner[selected][by_rank]
    rank = np.empty(len(selected), dtype=np.int64)
    rank[by_rank] = np.arange(len(selected)) - np.searchsorted(polygon, polygon) + 1
    return Hierarchy(selected, persistence[selected], rank)


def levels(
    found: Hierarchy, sides: np.ndarray, count: int, smallest_tau: float | np.ndarray
) -> Levels:
    """Make the parts of all levels from those of the finest partition.

    Parameters
    ----------
    found : Hierarchy
    sides : (s, 2) int
        The parts on the two sides of each cut (see `parts.Parts`).
    count : int
        Number of parts of the finest partition.
    smallest_tau : float or (count,) float
        Where it begins, for all of its parts or each.

    Returns
    -------
    Levels
        Where a cut is not needed even at the smallest tau, the parts beside it live for no time.

    Notes
    -----
    O(s log s).

    Examples
    --------
    >>> import numpy as np
    >>> found = Hierarchy(np.array([3, 5]), np.array([9.0, 4.0]), np.array([1, 2]))
    >>> made = levels(found, np.array([[0, 1], [1, 2]]), 3, 2.0)
    >>> made.parent, made.from_tau, made.to_tau
    (array([ 4,  3,  3,  4, -1]), array([2., 2., 2., 4., 9.]), array([ 9.,  4.,  4.,  9., inf]))
    >>> made.pieces[3:]
    [array([1, 2]), array([0, 1, 2])]
    """
    parent = [-1] * count
    start = np.broadcast_to(np.asarray(smallest_tau, dtype=float), count).tolist()
    stop, children = [np.inf] * count, {}
    made_of = list(range(count))  # a part of the finest partition: one in the same part now
    now = list(range(count))  # the part that such a representative is in

    def find(k):
        while made_of[k] != k:
            made_of[k] = made_of[made_of[k]]
            k = made_of[k]
        return k

    # those that go at the same tau go at once: no part lives for no time
    order = np.lexsort((-found.rank, found.persistence))
    order = order[np.isfinite(found.persistence[order])]
    tau = found.persistence[order]
    for group in np.split(order, np.flatnonzero(np.diff(tau)) + 1) if len(order) else ():
        at, joined = float(found.persistence[group[0]]), {}
        for a, b in sides[group].tolist():
            a, b = find(a), find(b)
            if a != b:
                a, b = min(a, b), max(a, b)
                made_of[b] = a
                mine = joined.setdefault(a, [now[a]])
                mine += joined.pop(b, [now[b]])
        for root in sorted(joined):
            new, own = len(parent), joined[root]
            for k in own:
                parent[k], stop[k] = new, max(at, start[k])
            children[new] = own
            now[root] = new
            parent.append(-1)
            start.append(max(at, max(start[k] for k in own)))
            stop.append(np.inf)

    leaf, first, last = [], [0] * len(parent), [0] * len(parent)
    stack = [k for k in range(len(parent) - 1, -1, -1) if parent[k] < 0]
    while stack:
        k = stack.pop()
        if k < 0:  # all pieces of this part have been listed
            last[-1 - k] = len(leaf)
            continue
        first[k] = len(leaf)
        if k < count:
            leaf.append(k)
        stack.append(-1 - k)
        stack += children.get(k, ())
    whole = [np.array(x, dtype=np.int64) for x in (parent, leaf, first, last)]
    return Levels(whole[0], np.array(start), np.array(stop), *whole[1:])
