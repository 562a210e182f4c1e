"""MinWeight and MinLength (section 4.4 of the paper) with Pareto fronts and a certificate.

The paper keeps one table entry per integer weight; here every edge e keeps its Pareto front
instead (see `pareto`), so real weights need no rounding.

Fronts stay short on most polygons: those of up to `SMALL` edges, and deep ones such as corridors, are
solved exactly at once, all together level by level or one node at a time, whichever is cheaper for them.

Fronts may grow exponentially (the problem is weakly NP-hard). Where they do, they are trimmed. A pass
that keeps real points yields a feasible solution, an upper bound; a pass that keeps (least weight, best
value) of every group yields a lower bound. From a lower-bound pass follows, top-down, a bound on
what the *rest* of the polygon must cost whatever an edge offers or demands. Where the gap is narrow, the
next, finer passes drop every point whose weight plus that rest is of no interest: for a solution, what is
no cheaper than the best known; for a bound, what is above the target.
"""

from __future__ import annotations

import time
from copy import copy
from typing import Callable, NamedTuple

import numpy as np

from ..progress import ignore
from ..rings import offsets_of, ranges
from . import pareto
from .exact_fronts import cheapest_by_node
from .min_size import SLACK, Network

__all__ = ["min_weight"]

NOISE = 1e-10  # relative; two costs closer than this are the same cost
ROOM = 512  # points on a front up to which trees are solved exactly at once
SMALL = 1000  # nodes up to which this is tried on a tree of any shape
NARROW = 20  # ... and nodes per level
FIRST_POINTS = 96  # points per front in the first lower-bound pass
NEAR = 0.5  # gap, in typical weights of the tree, below which a guide is worth its time
GROWTH = 20  # largest factor on the points from pass to pass
# Microseconds of an exact pass: a node by itself; a level, and a node in it
BY_NODE, BY_LEVEL, IN_LEVEL = 10.0, 600.0, 1.5


def min_weight(
    net: Network,
    weight: np.ndarray,
    tau: float | np.ndarray,
    *,
    max_gap: float = 0.001,
    start: np.ndarray | None = None,
    time_limit: float | None = None,
    check: Callable | None = None,
    max_points: int = 4096,
) -> tuple[np.ndarray, np.ndarray]:
    """Select candidate edges of least total weight such that every one has a witness.

    A forest of P trees is P problems; the cuts of a tree do not depend on the trees beside it.

    Parameters
    ----------
    net : Network
        Dual trees with lengths. The triangle inequality is taken for granted: no edge is longer
        than what lies below it.
    weight : (nodes,) float
        Weight of each node, not negative; those of root edges are ignored. The lengths for
        MinLength.
    tau : float or (nodes,) float
        Largest dilation allowed.
    max_gap : float
        A tree is done as soon as (cost - lower bound) / cost is proven to be no larger; 0 asks for a
        proof of optimality (to the noise of the floats, 1e-10).
    start : (nodes,) bool, optional
        A solution to begin with; the result never weighs more.
    time_limit : float, optional
        Seconds for the whole forest, after which the best solutions so far are returned, with their
        bounds.
    check : callable, optional
        Called often, sometimes with the share done; may raise `Cancelled`.
    max_points : int
        The search gives up narrowing the gap of a tree after a pass with that many points on a front
        of typical width (a front may get four times as many): this bounds the memory. With 0 only
        trees are improved that an exact pass solves at once.

    Returns
    -------
    cut : (nodes,) bool
        The edges to select (role SELF); never a root edge.
    lower_bound : (P,) float
        No solution of a tree weighs less.

    Raises
    ------
    ValueError
        For a weight that is negative or not finite.

    Notes
    -----
    A pass with at most K points per front takes O(n K^2 log K) time at worst. An exact pass over
    polygons with short fronts takes microseconds a node.

    Examples
    --------
    Two candidates, one below the other. Around the lower one it is 10, 3.3 times its length; with it
    selected, it is 2 + 3 around the upper one, 1.25 times its length:

    >>> import numpy as np
    >>> from isthmus.core.partition.dual_tree import DualTree
    >>> from isthmus.core.partition.min_size import Network
    >>> tree = DualTree(np.array([-1, 0, 1]), np.array([0, 1, 2, 3]), np.arange(2), np.zeros(0, int))
    >>> net = Network(tree, np.array([9.0, 4.0, 3.0]), np.array([30.0, 2.0, 10.0]))
    >>> min_weight(net, net.length, 2.0, max_gap=0.0)
    (array([False, False,  True]), array([3.]))
    >>> min_weight(net, net.length, 3.5, max_gap=0.0)
    (array([False, False, False]), array([0.]))
    """
    check = check or ignore
    deadline = np.inf if time_limit is None else time.monotonic() + time_limit

    def timed_check(share=None):
        check() if share is None else check(share)
        if time.monotonic() > deadline:
            raise _Stop

    forest, scale = _forest(net, weight, tau)
    best = _Best(forest, max_gap, start, timed_check)
    try:
        hard = _solve_easy(forest, best)
        if max_points and hard.any():
            _Search(forest, best, hard, max_points).run()
    except _Stop:
        pass
    return best.cut, best.lower * scale


class _Stop(Exception):
    """The time is up."""


# --- forests ------------------------------------------------------------------------------------------


class _Forest(NamedTuple):
    """Rooted trees with everything that does not depend on the pass.

    Nodes stand in level order, the roots first; ``start[d]`` is the first one of level d. ``limit`` is
    the longest path allowed, ``count`` the number of children, ``owner`` the tree of each node; in
    ``typical`` is the typical weight of each tree.
    """

    parent: np.ndarray
    start: np.ndarray
    length: np.ndarray
    base: np.ndarray
    weight: np.ndarray
    limit: np.ndarray
    count: np.ndarray
    owner: np.ndarray
    typical: np.ndarray

    @property
    def trees(self):
        """Number of trees."""
        return len(self.typical)

    @property
    def depth(self):
        """Number of levels."""
        return len(self.start) - 1

    def level(self, d):
        """Slice of the nodes on level d."""
        return slice(self.start[d], self.start[d + 1])

    def total(self, weight):
        """Sum over each tree. In the order of the nodes, so that no tree depends on another."""
        return np.bincount(self.owner, weight, minlength=self.trees)

    def part(self, keep):
        """The trees to keep, and their nodes here."""
        nodes = np.flatnonzero(keep[self.owner])
        place = np.cumsum(keep[self.owner]) - 1
        parent = self.parent[nodes]
        start = np.unique(np.searchsorted(nodes, self.start))
        fields = (x[nodes] for x in (self.length, self.base, self.weight, self.limit, self.count))
        owner = (np.cumsum(keep) - 1)[self.owner[nodes]]
        parent = np.where(parent < 0, -1, place[parent])
        return _Forest(parent, start, *fields, owner, self.typical[keep]), nodes


def _forest(net, weight, tau):
    """The forest of a network with weights of about 1, and what each tree's were divided by."""
    parent, start = net.tree.parent, np.asarray(net.tree.level_start)
    n, trees = len(parent), int(start[1])
    weight = np.array(weight, float)
    weight[:trees] = 0.0
    if not (np.isfinite(weight) & (weight >= 0.0)).all():
        raise ValueError("weights must be finite and not negative")
    owner = _owners(parent, trees)
    # a power of two, so exact: squares of very large or small weights leave the range of doubles
    heaviest = np.zeros(trees)
    np.maximum.at(heaviest, owner, weight)
    scale = np.exp2(np.floor(np.log2(np.where(heaviest > 0.0, heaviest, 1.0))))
    weight /= scale[owner]
    total = np.bincount(owner, weight, minlength=trees)
    square = np.bincount(owner, weight**2, minlength=trees)
    typical = np.divide(square, total, out=np.ones(trees), where=total > 0.0)
    limit = np.broadcast_to(tau, n) * net.length * (1 + SLACK)
    count = np.bincount(parent[trees:], minlength=n)
    return _Forest(parent, start, net.length, net.base, weight, limit, count, owner, typical), scale


def _owners(parent, trees):
    """The tree of each node, by pointer jumping. O(n log depth)."""
    if trees == 1:
        return np.zeros(len(parent), np.int64)
    owner = parent.copy()
    owner[:trees] = np.arange(trees)
    while (owner >= trees).any():
        owner = owner[owner]
    return owner


def _shortest_outside(forest):
    """Length of the shortest path round the root side when every edge is selected. O(n).

    No smaller front-allowance is ever of use. (The paper asks for R >= ||e||, which the triangle
    inequality makes the weaker test.)
    """
    length, parent = forest.length, forest.parent
    face = forest.base.copy()
    offer = np.empty(len(length))
    for d in reversed(range(forest.depth)):
        s = forest.level(d)
        offer[s] = np.minimum(length[s], face[s])
        if d:
            up = parent[s]
            face[up[0] : up[-1] + 1] += np.bincount(up - up[0], offer[s])
    outside = np.full(len(length), np.inf)
    for d in range(1, forest.depth):
        s = forest.level(d)
        up = parent[s]
        outside[s] = face[up] - offer[s] + np.minimum(length[up], outside[up])
    return outside * (1 - SLACK)


class _Best:
    """Best solution and best lower bound of each tree so far."""

    def __init__(self, forest, max_gap, start, check):
        self.forest, self.max_gap, self.check = forest, max(max_gap, NOISE), check
        # selecting all candidates is always feasible
        self.cut = np.ones(len(forest.parent), bool) if start is None else start.copy()
        self.cut[: forest.trees] = False
        self.cost = forest.total(forest.weight * self.cut)
        self.lower = np.zeros(forest.trees)
        self.share = 0.0

    @property
    def target(self):
        """Cost from which on a lower bound is good enough."""
        return self.cost * (1 - self.max_gap)

    @property
    def proven(self):
        """Whether the gap is small enough."""
        return self.lower >= self.target

    @property
    def gap(self):
        """What is not proven, as a share of the cost."""
        missing = np.maximum(self.cost - self.lower, 0.0)
        return np.divide(missing, self.cost, out=np.zeros(len(missing)), where=self.cost > 0.0)

    def offer_solution(self, trees, nodes, cost, cut):
        """Take over the solutions of some trees where they are better; nodes are those of the trees."""
        better = np.zeros(len(self.cost), bool)
        better[trees] = cost < self.cost[trees]
        taken = better[self.forest.owner[nodes]]
        if taken.any():
            self.cut[nodes[taken]] = cut[taken]
            self.cost[better] = self.forest.total(self.forest.weight * self.cut)[better]
            self.tell()

    def offer_bound(self, trees, bound):
        """Take over lower bounds of some trees."""
        self.lower[trees] = np.maximum(self.lower[trees], np.minimum(bound, self.cost[trees]))
        self.tell()

    def tell(self):
        """Report how far the gaps are closed, on a logarithmic scale."""
        open_gap = np.where(self.proven, self.max_gap, np.clip(self.gap, self.max_gap, 1.0))
        scale = np.log(self.max_gap) if self.max_gap < 1.0 else -1.0
        done = self.forest.total(np.minimum(np.log(open_gap) / scale, 1.0)[self.forest.owner])
        self.report(done.sum() / len(self.forest.owner))

    def report(self, share):
        """Report the share done; it never falls."""
        self.share = max(self.share, float(share))
        self.check(self.share)


# --- exactly at once ----------------------------------------------------------------------------------


def _solve_easy(forest, best):
    """Solve exactly what short fronts allow. Returns which trees are left."""
    nodes = np.bincount(forest.owner, minlength=forest.trees)
    depth = np.zeros(forest.trees, np.int64)
    # the last value counts, that of the deepest node
    depth[forest.owner] = np.repeat(np.arange(1, forest.depth + 1), np.diff(forest.start))
    easy = (nodes <= SMALL) | (nodes < NARROW * depth)
    easy &= ~best.proven
    deep = _deep(nodes, depth, easy)
    for trees, solve in ((deep, _exact_by_node), (easy & ~deep, _exact_by_level)):
        if trees.any():
            part, at = forest.part(trees)
            cost, cut = solve(part, best, len(at) / len(forest.owner))
            trees = np.flatnonzero(trees)
            solved = np.isfinite(cost)
            best.offer_solution(trees, at, cost, cut)
            best.offer_bound(trees[solved], cost[solved])
    return ~best.proven


def _deep(nodes, depth, easy):
    """Which of the easy trees are cheaper one node at a time than level by level.

    Either way gives the same cuts, so the choice may depend on the trees together.
    """
    order = np.flatnonzero(easy)
    order = order[np.argsort(-depth[order], kind="stable")]
    by_node = BY_NODE * offsets_of(nodes[order])
    rest = nodes[order].sum() - offsets_of(nodes[order])
    by_level = BY_LEVEL * np.append(depth[order], 0) + IN_LEVEL * rest
    deep = np.zeros(len(nodes), bool)
    deep[order[: np.argmin(by_node + by_level)]] = True
    return deep


def _exact_by_node(forest, best, share):
    before = best.share

    def check(done=None):
        best.check() if done is None else best.report(before + share * done)

    return cheapest_by_node(
        forest.count, forest.trees, forest.length, forest.base, forest.weight, forest.limit, ROOM, check
    )


def _exact_by_level(forest, best, _share):
    zero = np.zeros(forest.trees)
    solved = _Pass(forest, _shortest_outside(forest), None, False, None, zero, zero, best.check)
    return solved.cost, solved.trace()


# --- passes -------------------------------------------------------------------------------------------


class _Pass:
    """One bottom-up pass over a forest.

    Parameters
    ----------
    forest : _Forest
    outside : (nodes,) float
        See `_shortest_outside`.
    points : (P,) int or None
        For each tree, number of points of a trimmed front of typical width (four times as many at
        most). None for an exact pass: a front of more than `ROOM` points is dropped, and with it
        all hope for its tree.
    lower : bool
        Trim to optimistic points (a lower bound) instead of real ones (a solution).
    guide : list of Front or None
        Fronts of an earlier lower-bound pass, with their rests, level by level.
    low, prune : (P,) float
        Best lower bounds known, and the cost from which on solutions are of no interest; only with a
        guide.
    check : callable
        Called with nothing at least every half second; may raise `_Stop`.

    Attributes
    ----------
    cost : (P,) float
        Weight of the cheapest assignment of each root; inf if there is none below ``prune``.
    trimmed : (P,) bool
        Whether any front was trimmed; if not, the cost is exact (or ``prune`` is).
    """

    def __init__(self, forest, outside, points, lower, guide, low, prune, check):
        self.forest, self.outside, self.points, self.lower = forest, outside, points, lower
        self.guide, self.low, self.prune, self.check = guide, low, prune, check
        self.trimmed = np.zeros(forest.trees, bool)
        self.fronts = [None] * forest.depth
        self.joins = [None] * forest.depth
        front = pareto.Front(np.zeros(1, np.int64), np.zeros(0), np.zeros(0))
        for d in reversed(range(forest.depth)):
            check()
            whole = self._join_children(d, front)
            front = self._close(d, whole)
            front = self.fronts[d] = self._trim(front, forest.owner[forest.level(d)], d)
        self.cost = front.cheapest()

    @property
    def bound(self):
        """What the cheapest assignment of each root weighs at least, if none or only a lower pass trims."""
        return self.cost if self.guide is None else np.minimum(self.cost, self.prune)

    # -- children ---------------------------------------------------------------------------

    def _join_children(self, d, front):
        """Add up the fronts of the children of every node on level d, in rounds of pairs.

        Children of nodes that have at most two wait for the last round.
        """
        forest, level = self.forest, self.forest.level(d)
        count = forest.count[level]
        rounds = []
        while True:
            none = len(front.ptr) - 1 >> 1
            last = bool((count <= 2).all())
            pair = last | (count > 2)
            items = np.maximum(1, np.where(pair, (count + 1) >> 1, count))
            node = np.repeat(np.arange(len(count)), items)
            k = ranges(np.zeros(len(count), np.int64), items)
            base = np.where((k == 0) & (not rounds), forest.base[level][node], 0.0)
            k *= 1 + pair[node]
            first = (np.cumsum(count) - count)[node]
            left = np.where(k < count[node], first + k, none)
            right = np.where(pair[node] & (k + 1 < count[node]), first + k + 1, none)
            join = pareto.Join(front, left, right, base)
            joined = self._product(join, node, d, last)
            if not self.lower:  # only the way back is needed
                front.weight = front.value = None
            rounds.append(join)
            front, count = joined, items
            if last:
                self.joins[d] = rounds
                return front
            front = self._trim(front, np.where(right < none, forest.owner[level][node], -1))

    def _product(self, join, node, d, last):
        """Pareto front of all sums of a left and a right point, item by item.

        In the last round of a level, sums without use for the node are dropped: demands that no
        path outside can meet or that cost no less than the cheapest offer, offers that miss the
        limit (the cheapest one apart, on which SELF and ROOT build) or cost no less than selecting
        the node on top of the cheapest offer (Lemma 2). Not before: what is cheaper here may be
        too optimistic, so `bound_rest` must find a bound for the dropped ones, too; in the last
        round it asks the node itself.
        """
        front, left, right, base = join.front.with_neutral(), join.left, join.right, join.base
        cheapest = front.cheapest()
        least = cheapest[left] + cheapest[right]
        value_cap, weight_cap = self._caps(node, d, least, last)
        total = pareto.pair_count(front, left, right)
        parts = [(np.zeros(0, np.int64), np.zeros(0), np.zeros(0), np.zeros(0, int), np.zeros(0, int))]

        def collect(seg, i, j, weight, value):
            order, seg = pareto.pareto(seg, weight, value)
            parts.append((seg, weight[order], value[order], i[order], j[order]))

        few = np.flatnonzero(total <= pareto.DENSE)
        for demand, item, i, row, j in pareto.small_pairs(front, left, right, few):
            self.check()
            weight = front.weight[i][row] + front.weight[j]
            value = (front.value[i] + base[item])[row] + front.value[j]
            useful = value <= value_cap[int(demand), item][row]
            useful &= weight < weight_cap[int(demand), item][row]
            if not demand:
                first = np.flatnonzero(np.diff(item, prepend=-1))
                useful[np.searchsorted(row, first)] = True
            k = np.flatnonzero(useful)
            row = row[k]
            collect((2 * item + demand)[row], i[row], j[k], weight[k], value[k])
        for item in np.flatnonzero(total > pareto.DENSE):
            for demand, *found in pareto.dense_pairs(
                front,
                left[item],
                right[item],
                base[item],
                value_cap[:, item],
                weight_cap[:, item],
                self.check,
            ):
                collect(np.full(len(found[0]), 2 * item + demand), *found)
        seg, weight, value, i, j = (np.concatenate(x) for x in zip(*parts))
        if len(parts) > 2:
            order = np.argsort(seg, kind="stable")
            seg, weight, value, i, j = (x[order] for x in (seg, weight, value, i, j))
        ptr = offsets_of(np.bincount(seg, minlength=2 * len(left)))
        if self.lower:  # never traced
            return pareto.Front(ptr, weight, value)
        return pareto.Front(ptr, weight, value, left=i.astype(np.int32), right=j.astype(np.int32))

    def _caps(self, node, d, least, last):
        """Largest value and first useless weight per kind (offer, demand) and item."""
        forest, level = self.forest, self.forest.level(d)
        reach = np.minimum(forest.length[level], self.outside[level])
        value_cap = np.stack((forest.limit[level], -reach))[:, node]
        weight_cap = np.stack((least + forest.weight[level][node], least))
        if not last:
            value_cap[0] = weight_cap[:] = np.inf
        if self.guide is not None:
            room = self.prune[forest.owner[level]] - self.guide[d].floor
            weight_cap = np.minimum(weight_cap, room[node])
        return value_cap, weight_cap

    # -- roles ------------------------------------------------------------------------------

    def _close(self, d, whole):
        """Fronts of the nodes of level d, from the sums over their children: SELF, LEAF, ROOT."""
        forest, level = self.forest, self.forest.level(d)
        length, limit, outside = forest.length[level], forest.limit[level], self.outside[level]
        n = len(length)
        seg = whole.segments()
        node, demand = seg >> 1, (seg & 1).astype(bool)
        weight, value = whole.weight, whole.value

        # SELF: the cheapest of all, a served demand included
        least, least_at = pareto.first_points(node, np.flatnonzero(~demand), weight, n)
        meets = demand & (value <= -length[node])
        served, served_at = pareto.first_points(node, np.flatnonzero(meets), weight, n)
        own = np.minimum(least, served) + forest.weight[level]
        own_at = np.where(served < least, served_at, least_at)
        add_own = np.isfinite(own)
        if d == 0:
            nothing = np.zeros(0, np.int64)
            return pareto.assemble(whole, nothing, seg, value, (add_own, own, length, own_at))

        # LEAF, and SELF behind it unless a LEAF offers a path as short for less
        leaf = ~demand & (value <= limit[node]) & (weight < own[node])
        cheapest_leaf, _ = pareto.first_points(node, np.flatnonzero(leaf), weight, n)
        shortest = np.full(n, np.inf)
        shortest[node[leaf]] = value[leaf]
        add_own &= shortest > length

        # ROOT: handed-on demands, and at last the whole allowance tau * l on the cheapest offer
        cap = np.minimum(cheapest_leaf, own)
        root = demand & (weight < cap[node]) & (value <= -outside[node])
        value = np.where(demand, np.maximum(value, -limit[node]), value)
        k = np.flatnonzero(root)
        again = (node[k[1:]] == node[k[:-1]]) & (value[k[1:]] >= value[k[:-1]])
        root[k[1:][again]] = False
        most = np.zeros(n)
        most[node[root]] = value[root]
        add_root = (least < cap) & (most > -limit) & (limit >= outside)

        return pareto.assemble(
            whole, np.flatnonzero(leaf | root), seg, value,
            (add_own, own, length, own_at), (add_root, least, -limit, least_at),
        )  # fmt: skip

    # -- trimming ---------------------------------------------------------------------------

    def _trim(self, front, owner, d=None):
        """Drop hopeless points, then trim long fronts to at most `points` groups.

        Owner is the tree of each edge, -1 for edges not to be touched. Level d is None for
        half-joined children, which no guide knows.
        """
        slack = None
        if self.guide is not None and d is not None:
            front, slack = self._hopeful(front, owner, d)
        size = np.diff(front.ptr)
        if self.points is None:
            return self._short(front, size, owner)
        allowed = self._allowed(front, owner)
        long = np.flatnonzero((size > allowed) & (np.repeat(owner, 2) >= 0))
        if not len(long):
            return front
        self.trimmed[owner[long >> 1]] = True
        head = pareto.point_groups(front, long, allowed[long])
        seg = front.segments()
        if self.lower:
            last = np.append(head[1:], len(seg)) - 1
            trimmed = front.take(head, seg[head])
            trimmed.value = front.value[last]
            return trimmed
        if slack is not None:
            group = np.zeros(len(seg), np.int64)
            group[head] = 1
            group = np.cumsum(group)
            order = np.argsort(pareto.pack(group, slack), kind="stable")
            head = order[np.diff(group[order], prepend=0) > 0]
        return front.take(head, seg[head])

    def _hopeful(self, front, owner, d):
        """The points of interest, and how far weight plus rest of each is above the lower bound."""
        seg = front.segments()
        tree = owner[seg >> 1]
        total = front.weight + self.guide[d].rest_at(seg, front.value)
        self.guide[d].forget_index()
        keep = np.flatnonzero(total < self.prune[tree])
        slack = total[keep] - self.low[tree[keep]]
        return front.take(keep, seg[keep]), np.maximum(slack, 0.0)

    def _short(self, front, size, owner):
        """Exact pass: without the edges that have too long a front."""
        long = np.maximum(size[::2], size[1::2]) > ROOM
        long &= owner >= 0
        if not long.any():
            return front
        self.trimmed[owner[long]] = True
        seg = front.segments()
        keep = np.flatnonzero(~long[seg >> 1])
        return front.take(keep, seg[keep])

    def _allowed(self, front, owner):
        """Largest number of points of every segment.

        A segment of width W (in weight) trimmed to K points errs by about W / K and costs about
        K^2 pairs. For a given total of pairs K ~ W^(1/3) would err least if all wide fronts
        mattered alike; the wide ones matter more often, and W^(1/2) was measured to be better.
        """
        owner = np.repeat(owner, 2)
        full = np.flatnonzero(front.ptr[1:] > front.ptr[:-1])
        width = np.zeros(len(owner))
        width[full] = front.weight[front.ptr[full + 1] - 1] - front.weight[front.ptr[full]]
        share = np.clip(np.sqrt(width / self.forest.typical[owner]), 0.25, 4.0)
        return np.maximum(2, self.points[owner] * share).astype(np.int64)

    # -- top-down ---------------------------------------------------------------------------

    def bound_rest(self, prune):
        """Bound, for every point of every front, the cost of the rest of its tree.

        Top-down; points of solutions no cheaper than ``prune`` may get inf. Returns the fronts.
        """
        root = self.fronts[0]
        root.rest, root.floor = np.zeros(len(root.weight)), np.zeros(self.forest.trees)
        for d in range(self.forest.depth - 1):
            self.check()
            rest = self._rest_of_sums(d)
            floor = self.fronts[d].floor
            floor = np.minimum(floor, rest(2 * np.arange(len(floor)), np.full(len(floor), np.inf)))
            node_prune = prune[self.forest.owner[self.forest.level(d)]]
            for join in reversed(self.joins[d]):
                front = self._share_rest(join, rest, node_prune, node_prune - floor)
                node_prune = self._prune_below(join, node_prune)
                rest, floor = front.rest_at, front.floor
            self.fronts[d].weight = None
            self.fronts[d].forget_index()
            self.joins[d] = None
        return self.fronts

    @staticmethod
    def _prune_below(join, prune):
        """The prune of the edges that were added up, from that of their sums."""
        below = np.empty((len(join.front.ptr) >> 1) + 1)
        below[join.left], below[join.right] = prune, prune
        return below[:-1]

    def _rest_of_sums(self, d):
        """Rest as a function of what the children of a node of level d offer or demand together."""
        forest, level, front = self.forest, self.forest.level(d), self.fronts[d]
        length, limit, outside = forest.length[level], forest.limit[level], self.outside[level]
        offer = 2 * np.arange(len(length))
        if_self = forest.weight[level] + front.rest_at(offer, length)
        if_root = front.rest_at(offer + 1, -limit) if d else np.full(len(length), np.inf)
        if_any = np.minimum(if_self, if_root)

        def rest(segment, value, rounded=False):
            node, demand = segment >> 1, (segment & 1).astype(bool)
            result = np.where(demand, np.where(value <= -length[node], if_self[node], np.inf), if_any[node])
            if d:
                k = np.flatnonzero(value <= np.where(demand, -outside[node], limit[node]))
                at = np.where(demand[k], np.maximum(value[k], -limit[node[k]]), value[k])
                result[k] = np.minimum(result[k], front.rest_at(segment[k], at, rounded))
            return result

        return rest

    def _share_rest(self, join, rest, most, room):
        """Rest of the points that were added up, from the rest of their sums.

        Only sums are of interest that weigh, with their rest, less than ``most`` of their item, and so
        less than its room, what remains of that without the least rest.
        """
        front, left, right, base = join.front.with_neutral(), join.left, join.right, join.base
        bound = np.full(len(front.weight), np.inf)
        total = pareto.pair_count(front, left, right)
        few = np.flatnonzero(total <= pareto.DENSE)
        for demand, item, i, row, j in pareto.small_pairs(front, left, right, few):
            self.check()
            left_weight = front.weight[i]
            k = np.flatnonzero(left_weight[row] + front.weight[j] < room[item][row])
            row, j = row[k], j[k]
            value = (front.value[i] + base[item])[row] + front.value[j]
            more = rest((2 * item + demand)[row], value)
            if len(k):
                run = np.flatnonzero(np.diff(row, prepend=-1))
                best = np.minimum.reduceat(more + front.weight[j], run)
                at = i[row[run]]
                bound[at] = np.minimum(bound[at], best)
            np.minimum.at(bound, j, more + left_weight[row])
        for item in np.flatnonzero(total > pareto.DENSE):
            for demand, x, y in pareto.products(front, left[item], right[item]):
                rest_of = pareto.Table(rest, 2 * item + demand, front, x, y, base[item])

                def hopeful(weight, value, rest_of=rest_of, most=most[item]):
                    return weight + rest_of.least(value) < most

                for i, j, _, value in pareto.strips(front, x, y, base[item], hopeful):
                    self.check()
                    more = rest_of(value)
                    np.minimum(bound[i], (more + front.weight[j]).min(axis=1), out=bound[i])
                    np.minimum(bound[j], (more + front.weight[i, None]).min(axis=0), out=bound[j])
        below = join.front
        below.rest = bound[:-1]
        below.floor = np.full(len(below.ptr) >> 1, np.inf)
        np.minimum.at(below.floor, below.segments() >> 1, below.rest)
        return below

    def trace(self):
        """Selected edges of the cheapest assignment of each root. O(n)."""
        forest = self.forest
        cut = np.zeros(len(forest.parent), bool)
        point = np.where(np.isfinite(self.cost), self.fronts[0].ptr[:-1:2], -1)
        for d in range(forest.depth):
            front = self.fronts[d]
            at = np.flatnonzero(point >= 0)
            cut[forest.start[d] + at] = front.cut[point[at]]
            for join in reversed(self.joins[d]):
                below = np.full((len(join.front.ptr) >> 1) + 1, -1)
                at = np.flatnonzero(point >= 0)
                below[join.left[at]] = front.left[point[at]]
                below[join.right[at]] = front.right[point[at]]
                front, point = join.front, below[:-1]
        cut[: forest.trees] = False
        return cut


# --- search -------------------------------------------------------------------------------------------


class _Search:
    """Passes from coarse to fine until the gaps are small enough or the fronts get too long.

    Trees leave it one by one. ``trees`` and ``nodes`` are those that are still here, ``points`` the
    points of each in the next lower-bound pass.
    """

    def __init__(self, forest, best, hard, max_points):
        self.best, self.max_points = best, max_points
        self.trees = np.flatnonzero(hard)
        self.forest, self.nodes = forest.part(hard)
        self.outside = _shortest_outside(self.forest)
        self.points = np.full(len(self.trees), min(FIRST_POINTS, max_points))
        self.guide = None

    def run(self):
        """Search."""
        self._solution(np.maximum(2, self.points // 8))
        self._refine()

    def _refine(self):
        best = self.best
        while self._keep(~best.proven[self.trees]):
            lower = self._pass(self.points, True, best.target[self.trees])
            best.offer_bound(self.trees, lower.bound)
            open_still = ~best.proven[self.trees]
            near = open_still & self._near()
            trimmed, guide = lower.trimmed, None
            if near.any():
                guide = lower.bound_rest(best.cost[self.trees])
            del lower
            if near.any() and (open_still & ~near).any():
                other = copy(self)
                other._go_on(open_still & ~near, None, trimmed)
                other._refine()
                open_still = near
            self._go_on(open_still, guide, trimmed)

    def _near(self):
        """Where a guide is worth its time: what is open can be told from one cut more or less.

        A point is dropped only if a cut in its place costs more than the gap of the whole tree is wide. On
        coasts of 139,785 and 1.16 million vertices, whose gap was wider by far, no point was dropped, and to
        bound the rest took two thirds of the time of the pass before.
        """
        gap = self.best.cost - self.best.lower
        return gap[self.trees] < NEAR * self.forest.typical

    def _go_on(self, keep, guide, trimmed):
        """Solutions, and the next number of points, for some of the trees."""
        self.guide, trimmed = guide, trimmed[keep]
        if not self._keep(keep):
            return
        # real points err less than optimistic ones: half as many do
        self._solution(np.where(trimmed, self.points // 2, self.points))
        last = ~trimmed | (self.points >= self.max_points)
        self.points = self._more_points()
        self._keep(~last)

    def _pass(self, points, lower, prune):
        low = self.best.lower[self.trees]
        return _Pass(self.forest, self.outside, points, lower, self.guide, low, prune, self.best.check)

    def _solution(self, points):
        """An upper-bound pass: what is cheaper than the best known is of interest, however little."""
        solved = self._pass(points, False, self.best.cost[self.trees])
        self.best.offer_solution(self.trees, self.nodes, solved.cost, solved.trace())
        exact = ~solved.trimmed
        self.best.offer_bound(self.trees[exact], solved.bound[exact])

    def _more_points(self):
        """As many as the last gap lets expect to be enough: it falls faster than as 1 / points.

        On the coast of 1.16 million vertices it fell as points ** -1.08, on one of 139,785 as -1.34, -1.42.
        Too few cost more than too many: with 0.88 instead of 0.95 the largest coast was 0.14 per cent short,
        and took a whole round more.
        """
        factor = (self.best.gap[self.trees] / self.best.max_gap) ** 0.95
        more = self.points * np.clip(factor, 1.0, GROWTH) + 1
        return np.minimum(more.astype(np.int64), self.max_points)

    def _keep(self, keep):
        """Go on with some of the trees only. Returns whether there are any."""
        if not keep.all():
            levels = [self.forest.level(d) for d in range(self.forest.depth)]
            kept = keep[self.forest.owner]
            self.forest, nodes = self.forest.part(keep)
            if self.guide is not None:
                self.guide = [g.of_edges(np.flatnonzero(kept[s])) for g, s in zip(self.guide, levels)]
            self.nodes, self.outside = self.nodes[nodes], self.outside[nodes]
            self.trees, self.points = self.trees[keep], self.points[keep]
        return keep.any()
