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

from array import array
from heapq import heapify, heappop, heappush
from typing import Callable, NamedTuple

import numpy as np

from ..progress import ignore
from .min_size import witness_lengths
from .solve import Prepared, Selection

__all__ = ["Hierarchy", "Levels", "hierarchy", "levels"]

# Steps along paths that take as long as an array call; one more for each 16 members
STEPS = 64


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
    A few looks at the queue for each of the s cuts, each O(log s) and one path up and two down the dual
    tree of the two parts: O(s d) for a tree of depth d.

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
    chosen = np.zeros(len(length), dtype=bool)
    chosen[selection.selected] = True
    roots = net.tree.roots
    cut = np.append(np.ones(roots, dtype=bool), chosen[node_edge])
    bounded = np.append(np.zeros(roots, dtype=bool), prepared.bounded[node_edge])
    around = (
        np.append(np.full(roots, -1), carved.walk.i[node_edge]),
        np.append(np.full(roots, -1), carved.walk.j[node_edge]),
    )
    parts = _Parts(net, cut, bounded, *around, check)

    cuts = [k for k in np.flatnonzero(cut).tolist() if k >= roots]
    owner = prepared.owner[node_edge]
    # what the candidates need at the smallest tau, whatever goes
    least = np.ones(len(prepared.polygons.unit))
    worst = np.array(list(parts.worst.values()))
    which = np.array(list(parts.worst), dtype=np.int64)  # none, where nothing can be solved
    np.maximum.at(least, np.append(np.arange(roots), owner)[which], worst)
    version = dict.fromkeys(parts.worst, 0)  # the cut that changed each part last
    queue = [(parts.price(k), k, 0, 0) for k in cuts]
    heapify(queue)
    persistence = np.full(len(length), np.inf)
    order = []
    while queue:
        cost, node, seen_upper, seen_lower = heappop(queue)
        upper = parts.above(node)
        if (version[upper], version[node]) != (seen_upper, seen_lower):
            heappush(queue, (parts.price(node), node, version[upper], version[node]))
            continue
        if len(order) % 64 == 0:
            check(len(order) / len(cuts))
        parts.join(node, cost)
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


class _Parts:
    """The parts while cuts go, each named after its top node: the cut or root that it hangs from.

    The two ways of a candidate in its part sum up to the part's perimeter, so the way below is enough.
    When parts join, the ways below change only on the path from the cut to the top of the upper part.
    Of the others the shorter way changes only where it was the one above: where the way below is more
    than half of the perimeter. These nodes are one path down from the top. So a few short paths tell the
    price; where the tree is so narrow that they are long (corridors), one array call over all members.
    """

    def __init__(self, net, cut, bounded, i, j, check):
        tree, count = net.tree, len(cut)
        below, above = witness_lengths(net, cut, check)
        top = np.arange(count)
        for level in zip(tree.level_start[1:-1].tolist(), tree.level_start[2:].tolist()):
            nodes = np.arange(*level)
            inner = nodes[~cut[nodes]]
            top[inner] = top[tree.parent[inner]]
        tops, inner = np.flatnonzero(cut), np.flatnonzero(~cut)
        self.top, self.up = top.tolist(), tree.parent.tolist()
        self.perimeter = dict(zip(tops.tolist(), (below + net.length)[tops].tolist()))
        dilation = np.ones(count)
        some = np.flatnonzero(~cut & bounded)
        np.maximum.at(dilation, top[some], np.minimum(below, above)[some] / net.length[some])
        self.worst = dict(zip(tops.tolist(), dilation[tops].tolist()))
        self.joined = {}  # part: the one it has become a piece of
        # the nodes of each part in arrays, put together when they are asked for
        inner = inner[np.argsort(top[inner], kind="stable")]
        start = np.searchsorted(top[inner], tops)
        stop = np.searchsorted(top[inner], tops, side="right")
        self.nodes = {k: [inner[lo:hi]] for k, lo, hi in zip(tops.tolist(), start.tolist(), stop.tolist())}
        self.size = dict(zip(tops.tolist(), (stop - start).tolist()))
        # one memory for the loops, which want plain numbers, and for the array calls
        self.low = array("d", np.where(cut, -np.inf, below).tobytes())  # ways below; cuts have none
        self.lows, self.lengths, self.bounded = np.frombuffer(self.low), net.length, bounded
        self.length, self.is_bounded = net.length.tolist(), bounded.tolist()
        self.i, self.j = i, j
        self.i_of, self.j_of = i.tolist(), j.tolist()
        self.kid = np.argsort(tree.parent[tree.roots :], kind="stable") + tree.roots
        kids = np.searchsorted(tree.parent[self.kid], np.arange(count + 1))
        self.kids, self.kid_start = self.kid.tolist(), kids.tolist()

    def above(self, cut):
        """The part above a cut; that below has its name."""
        joined, part = self.joined, self.top[self.up[cut]]
        while part in joined:
            if joined[part] in joined:
                joined[part] = joined[joined[part]]
            part = joined[part]
        return part

    def price(self, cut):
        """The largest dilation in the two parts of a cut once it has gone."""
        upper, length = self.above(cut), self.length[cut]
        mine, its = self.perimeter[cut], self.perimeter[upper]
        worst = max(self.worst[upper], self.worst[cut], (min(mine, its) - length) / length)
        steps = STEPS + (self.size[upper] + self.size[cut]) // 16
        more, whole = mine - 2.0 * length, its + mine - 2.0 * length
        low, lengths, is_bounded, up = self.low, self.length, self.is_bounded, self.up
        node = up[cut]
        while node != upper and steps:
            if is_bounded[node]:
                way = min(low[node] + more, its - low[node])
                if way > worst * lengths[node]:
                    worst = way / lengths[node]
            node = up[node]
            steps -= 1
        first, last = self.i_of[cut], self.j_of[cut]
        for part, half in ((upper, 0.5 * its), (cut, 0.5 * mine)):
            node = self._heavy(part)
            while node >= 0 and low[node] > half and steps:
                if is_bounded[node] and not (
                    part == upper and self.i_of[node] <= first and last <= self.j_of[node]
                ):
                    way = min(low[node], whole - low[node])
                    if way > worst * lengths[node]:
                        worst = way / lengths[node]
                node = self._heavy(node)
                steps -= 1
        return worst if steps else self._price_of_all(cut, upper, worst)

    def _price_of_all(self, cut, upper, worst):
        whole = self.perimeter[upper] + self.perimeter[cut] - 2.0 * self.length[cut]
        for part in (upper, cut):
            nodes = self._members(part)
            way = self.lows[nodes]
            if part == upper:
                way = way + np.where(
                    self._around(nodes, cut), self.perimeter[cut] - 2.0 * self.length[cut], 0.0
                )
            dilation = np.minimum(way, whole - way) / self.lengths[nodes]
            worst = max(worst, float(dilation[self.bounded[nodes]].max(initial=1.0)))
        return worst

    def join(self, cut, price):
        """Take a cut away."""
        upper, length = self.above(cut), self.length[cut]
        more = self.perimeter[cut] - 2.0 * length
        node, path, steps = self.up[cut], [], STEPS + self.size[upper] // 16
        while node != upper and len(path) < steps:
            path.append(node)
            node = self.up[node]
        if node == upper:
            for node in path:
                self.low[node] += more
        else:
            nodes = self._members(upper)
            self.lows[nodes[self._around(nodes, cut)]] += more
        self.low[cut] = self.perimeter[cut] - length
        self.bounded[cut] = self.is_bounded[cut] = True
        self.perimeter[upper] += more
        self.worst[upper] = price
        self.joined[cut] = upper
        self.size[upper] += self.size[cut] + 1
        some, others = self.nodes[upper], self.nodes.pop(cut)
        if len(some) < len(others):
            some, others = others, some
        some += [*others, np.array([cut])]
        self.nodes[upper] = some

    def _heavy(self, node):
        """The node just below another that has the longest way below; -1 where there is none."""
        lo, hi = self.kid_start[node], self.kid_start[node + 1]
        if hi - lo > 16:
            return int(self.kid[lo + self.lows[self.kid[lo:hi]].argmax()])
        low, best, most = self.low, -1, 0.0
        for kid in self.kids[lo:hi]:
            if low[kid] > most:
                best, most = kid, low[kid]
        return best

    def _members(self, part):
        arrays = self.nodes[part]
        if len(arrays) > 1:
            self.nodes[part] = arrays = [np.concatenate(arrays)]
        return arrays[0]

    def _around(self, nodes, cut):
        return (self.i[nodes] <= self.i[cut]) & (self.j[cut] <= self.j[nodes])


def levels(found: Hierarchy, sides: np.ndarray, count: int, smallest_tau: float | np.ndarray) -> Levels:
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
