"""MinWeight and MinLength (section 4.4 of the paper) with Pareto fronts and a certificate.

The paper keeps one table entry per integer weight; here every edge e keeps its Pareto front
instead, so real weights need no rounding. Two fronts per edge, weight ascending, value strictly
descending:

* *offer*: assignments with e as LEAF or SELF, value = front-length L (the length ||e|| if SELF);
* *demand*: assignments with e as ROOT, value = minus the front-allowance R.

With that sign both are minimised, and children combine by plain addition: two offers add up to an
offer, an offer and a demand to a demand (what the sibling's path uses up of the allowance), and
two demands never meet (Lemma 1).

Fronts may grow exponentially (the problem is weakly NP-hard), so they are trimmed. A pass that
keeps real points yields a feasible solution, an upper bound; a pass that keeps (least weight, best
value) of every group yields a lower bound. From a lower-bound pass follows, top-down, a bound on
what the *rest* of the polygon must cost whatever an edge offers or demands. The next, finer passes
drop every point whose weight plus that rest cannot beat the best solution known.
"""

import time

import numpy as np

from ..progress import ignore

SLACK = 1e-12  # relative; path = tau * length ties are common on lattices
NOISE = 1e-10  # relative; two costs closer than this are the same cost
FIRST_POINTS = 96  # points per front in the first lower-bound pass
GROWTH = 3  # factor on the points from pass to pass
CHUNK = 1 << 20  # pairs of points handled in one numpy call
DENSE = 3000  # pairs from which on one node is worth numpy calls of its own
ROWS = 16  # rows looked at by the quick dominance test
TABLE = 1024  # cells of a tabulated rest


class _Stop(Exception):
    """The time is up."""


class _Front:
    """The fronts of many edges, one after the other: offer of edge 0, demand of edge 0, ...

    Segment s holds the points ptr[s]:ptr[s+1]; edge k owns the segments 2k and 2k+1.
    ``left`` and ``right`` say which two points of the children were added up (SELF and ROOT keep
    those of the assignment below them), ``cut`` whether the edge itself is selected. ``rest`` is
    the bound on the cost outside, ``floor`` its minimum per edge.
    """

    __slots__ = (
        "ptr", "weight", "value", "left", "right", "cut", "rest", "floor", "_key", "_least"
    )

    def __init__(self, ptr, weight, value, left=None, right=None, cut=None):
        self.ptr, self.weight, self.value = ptr, weight, value
        self.left, self.right, self.cut = left, right, cut
        self.rest = self.floor = self._key = self._least = None

    def segments(self):
        """Segment of every point."""
        return np.repeat(np.arange(len(self.ptr) - 1), np.diff(self.ptr))

    def take(self, points, segments):
        """Sub-front of some points (ascending) that lie in the given segments."""
        ptr = _offsets(np.bincount(segments, minlength=len(self.ptr) - 1))
        pick = [None if x is None else x[points] for x in (self.left, self.right, self.cut)]
        return _Front(ptr, self.weight[points], self.value[points], *pick)

    def with_neutral(self):
        """With an edge more that offers nothing at no cost: the partner of an unpaired child."""
        ptr = np.append(self.ptr, [self.ptr[-1] + 1] * 2)
        return _Front(ptr, np.append(self.weight, 0.0), np.append(self.value, 0.0))

    def rest_at(self, segment, value, rounded=False):
        """Bound on the rest for arbitrary values: that of the first point at least as good.

        Where no point is as good, the better ones were dropped as hopeless. A demand may also have
        been dropped for a cheaper offer, whose rest is bounded by the floor of the edge.

        A value that was rounded down may find a later point than it should, one that is too dear
        to matter (infinite rest) though an earlier one is not. So it gets the least rest up to
        that point, and the floor where there is none.
        """
        if self._key is None:
            self._key = _pack(self.segments(), -self.value)
        found = np.searchsorted(self._key, _pack(segment, -value))
        missing = found >= self.ptr[segment + 1]
        rest = np.full(len(value), np.inf)
        rest[~missing] = (self._least_rest() if rounded else self.rest)[found[~missing]]
        edge = segment[missing]
        rest[missing] = np.where(rounded | (edge & 1 == 1), self.floor[edge >> 1], np.inf)
        return rest

    def _least_rest(self):
        """The running minimum of the rest along each segment."""
        if self._least is None:
            # the major key falls from segment to segment, so the minimum restarts by itself
            self._least = np.minimum.accumulate(_pack(-self.segments(), self.rest)).imag
        return self._least


class _Join:
    """One round of adding up children: of which edges of `front`, and with which base on top."""

    __slots__ = ("front", "left", "right", "base")

    def __init__(self, front, left, right, base):
        self.front, self.left, self.right, self.base = front, left, right, base


class _Tree:
    """The rooted tree with everything that does not depend on the pass."""

    def __init__(self, parent, length, base, weight, tau):
        self.n = n = len(parent)
        self.length, self.base = length, base
        self.weight = weight.copy()
        self.weight[0] = 0.0
        total = self.weight.sum()
        self.typical = (self.weight**2).sum() / total if total > 0 else 1.0
        self.limit = tau * length * (1 + SLACK)
        self.count = np.bincount(parent[1:], minlength=n)
        start = [0, 1]
        while start[-1] < n:
            start.append(1 + int(np.searchsorted(parent[1:], start[-1])))
        self.start = start
        self.depth = len(start) - 1
        self.outside = self._shortest_outside(parent)

    def level(self, d):
        """Slice of the nodes on level d."""
        return slice(self.start[d], self.start[d + 1])

    def _shortest_outside(self, parent):
        """Length of the shortest path round the root side when every edge is selected. O(n).

        No smaller front-allowance is ever of use. (The paper asks for R >= ||e||, which the
        triangle inequality makes the weaker test.)
        """
        n = self.n
        face = self.base.copy()
        offer = np.empty(n)
        for d in reversed(range(self.depth)):
            s = self.level(d)
            offer[s] = np.minimum(self.length[s], face[s])
            if d:
                up = parent[s]
                face[up[0] : up[-1] + 1] += np.bincount(up - up[0], offer[s])
        outside = np.full(n, np.inf)
        for d in range(1, self.depth):
            s = self.level(d)
            up = parent[s]
            outside[s] = face[up] - offer[s] + np.minimum(self.length[up], outside[up])
        return outside * (1 - SLACK)


def _offsets(count):
    return np.concatenate(([0], np.cumsum(count)))


def _pack(major, minor):
    """Key that numpy sorts and minimises by (major, minor), exactly: complex is lexicographic."""
    key = np.empty(len(minor), complex)
    key.real = major
    key.imag = minor
    return key


def _ranges(start, count):
    """start[0], start[0]+1, ... (count[0] numbers), start[1], ..."""
    end = np.cumsum(count)
    total = int(end[-1]) if len(end) else 0
    return np.arange(total) + np.repeat(start - end + count, count)


def _pareto(segment, weight, value):
    """Points that no other of the same segment dominates, sorted by (segment, weight).

    O(N log N). Returns their positions and segments.
    """
    order = np.argsort(_pack(segment, weight))
    seg, val = segment[order], value[order]
    # the major key falls from segment to segment, so the running minimum restarts by itself
    best = np.minimum.accumulate(_pack(-seg, val)).imag
    keep = np.ones(len(order), bool)
    keep[1:] = (seg[1:] != seg[:-1]) | (val[1:] < best[:-1])
    order, seg = order[keep], seg[keep]
    w = weight[order]
    keep = np.ones(len(order), bool)
    keep[:-1] = (seg[1:] != seg[:-1]) | (w[1:] != w[:-1])
    return order[keep], seg[keep]


def _sizes(front, left, right):
    """Numbers of points: offer and demand of the left, offer and demand of the right."""
    size = np.diff(front.ptr)
    return size[2 * left], size[2 * left + 1], size[2 * right], size[2 * right + 1]


def _small_pairs(front, left, right, items):
    """All pairs of points of the given items, in chunks: item, is it a demand, point, point."""
    offer_l, demand_l, offer_r, demand_r = _sizes(front, left[items], right[items])
    total = np.cumsum(offer_l * (offer_r + demand_r) + demand_l * offer_r)
    a = 0
    while a < len(items):
        done = total[a - 1] if a else 0
        b = max(a + 1, int(np.searchsorted(total, done + CHUNK, "right")))
        it = items[a:b]
        points = offer_l[a:b] + demand_l[a:b]
        own = np.repeat(np.arange(a, b), points)
        i = _ranges(front.ptr[2 * left[it]], points)
        demand = i >= front.ptr[2 * left[items[own]] + 1]
        partners = np.where(demand, offer_r[own], offer_r[own] + demand_r[own])
        j = _ranges(front.ptr[2 * right[items[own]]], partners)
        item = items[np.repeat(own, partners)]
        demand = np.repeat(demand, partners) | (j >= front.ptr[2 * right[item] + 1])
        yield item, demand, np.repeat(i, partners), j
        a = b


def _blocks(front, left, right):
    """The three products of one item: is it a demand, points of the left, points of the right."""
    offer_l, demand_l, offer_r, demand_r = (
        slice(front.ptr[s], front.ptr[s + 1])
        for s in (2 * left, 2 * left + 1, 2 * right, 2 * right + 1)
    )
    for demand, x, y in ((0, offer_l, offer_r), (1, offer_l, demand_r), (1, demand_l, offer_r)):
        rows = max(1, CHUNK // max(1, y.stop - y.start))
        if y.stop > y.start:
            for a in range(x.start, x.stop, rows):
                yield demand, slice(a, min(a + rows, x.stop)), y


def _undominated(wx, vx, wy, vy):
    """Mask over the outer sum: pairs that a quick test cannot show to be dominated.

    For each of some thresholds t the best value of weight <= t is found among some of the rows;
    a pair at or above t with a worse value is dominated.
    """
    weight = wx[:, None] + wy
    low, high = weight[0, 0], weight[-1, -1]
    width = high - low
    if not width > 0:
        return np.ones(weight.shape, bool), weight
    cells = len(wy)
    step = width / cells
    some = slice(None, None, 1 + len(wx) // ROWS)
    threshold = low + step * np.arange(cells)
    j = np.searchsorted(wy, threshold - wx[some, None], "right") - 1
    value = np.where(j >= 0, vx[some, None] + vy[j], np.inf)
    # rounding may place t - w(x) a hair beside w(y): one cell of distance makes that harmless
    best = np.concatenate(([np.inf] * 2, np.minimum.accumulate(value.min(axis=0))))
    cell = ((weight - low) * (1 / step)).astype(np.int32)
    return vx[:, None] + vy <= best[cell + 1], weight


def _first(node, points, weight, n):
    """Weight and position of each node's first one of some points (ascending); inf and 0 if none."""
    nodes, at = np.unique(node[points], return_index=True)
    best, where = np.full(n, np.inf), np.zeros(n, np.int64)
    where[nodes] = points[at]
    best[nodes] = weight[where[nodes]]
    return best, where


def _assemble(whole, keep, seg, value, own, root=None):
    """Fronts of the points to keep, with SELF behind the offers and full ROOT behind the demands.

    `own` and `root` are (for which nodes, weight, value, point of `whole` below it).
    """
    segments = len(whole.ptr) - 1
    add = np.zeros(segments, np.int64)
    add[::2] = own[0]
    if root is not None:
        add[1::2] = root[0]
    ptr = _offsets(np.bincount(seg[keep], minlength=segments) + add)
    source = np.empty(ptr[-1], np.int64)
    weights, values, cut = np.empty(ptr[-1]), np.empty(ptr[-1]), np.zeros(ptr[-1], bool)
    at = np.arange(len(keep)) + _offsets(add)[seg[keep]]
    source[at], weights[at], values[at] = keep, whole.weight[keep], value[keep]
    for kind, extra in enumerate((own, root)):
        if extra is not None:
            nodes = np.flatnonzero(extra[0])
            at = ptr[2 * nodes + kind + 1] - 1
            weights[at], values[at], source[at] = (x[nodes] for x in extra[1:])
            cut[at] = kind == 0
    if whole.left is None:
        return _Front(ptr, weights, values)
    return _Front(ptr, weights, values, whole.left[source], whole.right[source], cut)


def _tabulated(rest, segment, vx, vy):
    """Rest of all sums of vx and vy, rounded down to the lower end of a cell of a table."""
    value = vx[:, None] + vy
    low = value[-1, -1]  # values descend
    width = value[0, 0] - low
    if not width > 0:
        return np.broadcast_to(rest(np.array([segment]), np.array([low])), value.shape)
    step = width / TABLE
    # a millionth of a cell below its end: rounding can never lift a value into a better cell
    table = rest(np.full(TABLE + 1, segment), low + step * (np.arange(TABLE + 1) - 1e-6), True)
    value -= low
    value *= 1 / step
    return table[value.astype(np.int32)]


class _Pass:
    """One bottom-up pass over the tree.

    Parameters
    ----------
    tree : _Tree
    points : int
        Number of points of a trimmed front of typical width (four times as many at most).
    lower : bool
        Trim to optimistic points (a lower bound) instead of real ones (a solution).
    guide : list of _Front or None
        Fronts of an earlier lower-bound pass, with their rests, level by level.
    bound : tuple (lower, target)
        Best lower bound known; only solutions cheaper than the target matter.
    check : callable
        Called once per level with nothing; may raise `_Stop`.

    Attributes
    ----------
    cost : float
        Weight of the cheapest assignment of the root; inf if none beats the target.
    trimmed : bool
        Whether any front was trimmed; if not, the cost is exact (or the target is).
    """

    def __init__(self, tree, points, lower, guide, bound, check):
        self.tree, self.points, self.lower, self.guide = tree, points, lower, guide
        self.low, self.target = bound
        self.trimmed = False
        self.fronts = [None] * tree.depth
        self.joins = [None] * tree.depth
        front = _Front(np.zeros(1, np.int64), np.zeros(0), np.zeros(0))
        for d in reversed(range(tree.depth)):
            check()
            whole = self._join_children(d, front)
            front = self.fronts[d] = self._trim(self._close(d, whole), d)
        self.cost = front.weight[0] if len(front.weight) else np.inf

    # -- children ---------------------------------------------------------------------------

    def _join_children(self, d, front):
        """Add up the fronts of the children of every node on level d, in rounds of pairs."""
        tree = self.tree
        count = tree.count[tree.level(d)]
        rounds = []
        while True:
            none = len(front.ptr) - 1 >> 1
            first = np.cumsum(count) - count
            items = np.maximum(1, (count + 1) >> 1)
            node = np.repeat(np.arange(len(count)), items)
            k = 2 * _ranges(np.zeros(len(count), np.int64), items)
            left = np.where(k < count[node], first[node] + k, none)
            right = np.where(k + 1 < count[node], first[node] + k + 1, none)
            last = bool((count <= 2).all())
            node += tree.start[d]
            base = np.where((k == 0) & (not rounds), tree.base[node], 0.0)
            join = _Join(front, left, right, base)
            joined = self._product(join, node, last)
            if not self.lower:  # only the way back is needed
                front.weight = front.value = None
            rounds.append(join)
            front, count = joined, items
            if last:
                self.joins[d] = rounds
                return front
            front = self._trim(front)

    def _product(self, join, node, last):
        """Pareto front of all sums of a left and a right point, item by item.

        In the last round of a level, sums without use for the node are dropped: demands that no
        path outside can meet or that cost no less than the cheapest offer, offers that miss the
        limit (the cheapest one apart, on which SELF and ROOT build) or cost no less than selecting
        the node on top of the cheapest offer (Lemma 2). Not before: what is cheaper here may be
        too optimistic, so `bound_rest` must find a bound for the dropped ones, too; in the last
        round it asks the node itself.
        """
        tree = self.tree
        front, left, right, base = join.front.with_neutral(), join.left, join.right, join.base
        cheapest = np.full(len(front.ptr) >> 1, np.inf)
        offers = np.flatnonzero(front.ptr[1::2] > front.ptr[:-1:2])
        cheapest[offers] = front.weight[front.ptr[2 * offers]]
        least = cheapest[left] + cheapest[right]
        # per item and kind (offer, demand): largest value, first useless weight
        value_cap = np.stack((tree.limit[node], -np.minimum(tree.length[node], tree.outside[node])))
        weight_cap = np.stack((least + tree.weight[node], least))
        if not last:
            value_cap[0] = weight_cap[:] = np.inf
        if self.guide is not None:
            d = int(np.searchsorted(tree.start, node[0], "right")) - 1
            room = self.target - self.guide[d].floor[node - tree.start[d]]
            weight_cap = np.minimum(weight_cap, room)
        offer_l, demand_l, offer_r, demand_r = _sizes(front, left, right)
        total = offer_l * (offer_r + demand_r) + demand_l * offer_r
        parts = []

        def collect(item, demand, i, j, weight, value):
            order, seg = _pareto(2 * item + demand, weight, value)
            parts.append((seg, weight[order], value[order], i[order], j[order]))

        for item, demand, i, j in _small_pairs(front, left, right, np.flatnonzero(total <= DENSE)):
            weight = front.weight[i] + front.weight[j]
            value = front.value[i] + front.value[j] + base[item]
            kind = demand.astype(np.int8)
            useful = (value <= value_cap[kind, item]) & (weight < weight_cap[kind, item])
            useful |= ~demand & (weight == least[item])
            k = np.flatnonzero(useful)
            collect(item[k], kind[k], i[k], j[k], weight[k], value[k])
        for item in np.flatnonzero(total > DENSE):
            found = self._dense(front, left[item], right[item], base[item],
                                value_cap[:, item], weight_cap[:, item], least[item])
            collect(np.full(len(found[0]), item), *found)
        seg, weight, value, i, j = (np.concatenate(x) for x in zip(*parts))
        if len(parts) > 1:
            order = np.argsort(seg, kind="stable")
            seg, weight, value, i, j = (x[order] for x in (seg, weight, value, i, j))
        ptr = _offsets(np.bincount(seg, minlength=2 * len(left)))
        if self.lower:  # never traced
            return _Front(ptr, weight, value)
        return _Front(ptr, weight, value, i.astype(np.int32), j.astype(np.int32))

    @staticmethod
    def _dense(front, left, right, base, value_cap, weight_cap, least):
        """Useful sums of one item with many pairs."""
        parts = []
        for demand, x, y in _blocks(front, left, right):
            wx, vx, wy, vy = front.weight[x], front.value[x] + base, front.weight[y], front.value[y]
            useful, weight = _undominated(wx, vx, wy, vy)
            useful &= weight < weight_cap[demand]
            value = vx[:, None] + vy
            useful &= value <= value_cap[demand]
            if not demand and weight[0, 0] == least:
                useful[0, 0] = True
            k = np.flatnonzero(useful)
            i, j = np.divmod(k, len(wy))
            parts.append((np.full(len(k), demand, np.int8), i + x.start, j + y.start,
                          weight.ravel()[k], value.ravel()[k]))
        return [np.concatenate(x) for x in zip(*parts)]

    # -- roles ------------------------------------------------------------------------------

    def _close(self, d, whole):
        """Fronts of the nodes of level d, from the sums over their children: SELF, LEAF, ROOT."""
        tree, level = self.tree, self.tree.level(d)
        length, limit, outside = tree.length[level], tree.limit[level], tree.outside[level]
        n = len(length)
        seg = whole.segments()
        node, demand = seg >> 1, (seg & 1).astype(bool)
        weight, value = whole.weight, whole.value

        # SELF: the cheapest of all, a served demand included
        least, least_at = _first(node, np.flatnonzero(~demand), weight, n)
        served, served_at = _first(node, np.flatnonzero(demand & (value <= -length[node])), weight, n)
        own = np.minimum(least, served) + tree.weight[level]
        own_at = np.where(served < least, served_at, least_at)
        if d == 0:
            return _assemble(whole, np.zeros(0, np.int64), seg, value,
                             (np.isfinite(own), own, length, own_at))

        # LEAF, and SELF behind it unless a LEAF offers a path as short for less
        leaf = ~demand & (value <= limit[node]) & (weight < own[node])
        cheapest_leaf, _ = _first(node, np.flatnonzero(leaf), weight, n)
        shortest = np.full(n, np.inf)
        shortest[node[leaf]] = value[leaf]
        add_own = np.isfinite(own) & (shortest > length)

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

        return _assemble(
            whole, np.flatnonzero(leaf | root), seg, value,
            (add_own, own, length, own_at), (add_root, least, -limit, least_at),
        )

    # -- trimming ---------------------------------------------------------------------------

    def _trim(self, front, d=None):
        """Drop hopeless points, then trim long fronts to at most `points` groups.

        The groups are steps of equal length along the (normalised) front, finer where weight plus
        rest is near the lower bound; without a guide, near the cheapest point. Level d is None for
        half-joined children, which no guide knows.
        """
        seg = front.segments()
        total = None
        if self.guide is not None and d is not None:
            total = front.weight + self.guide[d].rest_at(seg, front.value)
            self.guide[d]._key = self.guide[d]._least = None
            keep = np.flatnonzero(total < self.target)
            if len(keep) < len(seg):
                seg, total = seg[keep], total[keep]
                front = front.take(keep, seg)
        size = np.diff(front.ptr)
        allowed = self._allowed(front)
        long = np.flatnonzero(size > allowed)
        if not len(long):
            return front
        self.trimmed = True
        head = self._heads(front, long, size[long], allowed[long], total)
        if self.lower:
            last = np.append(head[1:], len(seg)) - 1
            trimmed = front.take(head, seg[head])
            trimmed.value = front.value[last]
            return trimmed
        if total is not None:
            group = np.zeros(len(seg), np.int64)
            group[head] = 1
            group = np.cumsum(group)
            order = np.argsort(_pack(group, total), kind="stable")
            group = group[order]
            head = order[np.append(True, group[1:] != group[:-1])]
        return front.take(head, seg[head])

    def _allowed(self, front):
        """Largest number of points of every segment.

        A segment of width W (in weight) trimmed to K points errs by about W / K and costs about
        K^2 pairs. For a given total of pairs K ~ W^(1/3) would err least if all wide fronts
        mattered alike; the wide ones matter more often, and W^(1/2) was measured to be better.
        """
        full = np.flatnonzero(front.ptr[1:] > front.ptr[:-1])
        width = np.zeros(len(front.ptr) - 1)
        width[full] = front.weight[front.ptr[full + 1] - 1] - front.weight[front.ptr[full]]
        share = np.clip(np.sqrt(width / self.tree.typical), 0.25, 4.0)
        return np.maximum(2, self.points * share).astype(np.int64)

    def _heads(self, front, long, size, allowed, total):
        """First point of every group (points of short fronts are groups of their own)."""
        at = _ranges(front.ptr[long], size)
        own = np.repeat(np.arange(len(long)), size)
        begin = np.cumsum(size) - size
        first, last = front.ptr[long], front.ptr[long + 1] - 1
        weight, value = front.weight[at], front.value[at]
        width = (front.weight[last] - front.weight[first])[own]
        step = np.diff(weight, prepend=0.0) / width
        step -= np.diff(value, prepend=0.0) / (front.value[first] - front.value[last])[own]
        if total is None:
            step /= (weight - front.weight[first][own]) / width + 0.1
        else:
            slack = np.maximum(total[at] - self.low, 0.0)
            slack = np.minimum(slack, np.append(slack[0], slack[:-1]))
            step /= slack + 0.05 * (self.target - self.low)
        step[begin] = 0.0
        along = np.cumsum(step)
        along -= along[begin][own]
        group = np.floor(along * ((allowed - 1) / along[begin + size - 1])[own])
        head = np.ones(len(front.weight), bool)
        head[at[1:]] = (group[1:] != group[:-1]) | (own[1:] != own[:-1])
        return np.flatnonzero(head)

    # -- top-down ---------------------------------------------------------------------------

    def bound_rest(self, target, check):
        """Bound, for every point of every front, the cost of the rest of the tree.

        Top-down; points of solutions no cheaper than the target may get inf. Returns the fronts.
        """
        root = self.fronts[0]
        root.rest, root.floor = np.zeros(len(root.weight)), np.zeros(1)
        for d in range(self.tree.depth - 1):
            check()
            rest = self._rest_of_sums(d)
            floor = self.fronts[d].floor
            floor = np.minimum(floor, rest(2 * np.arange(len(floor)), np.full(len(floor), np.inf)))
            for join in reversed(self.joins[d]):
                front = self._share_rest(join, rest, floor, target)
                rest, floor = front.rest_at, front.floor
            self.fronts[d].weight = self.fronts[d]._key = self.fronts[d]._least = None
            self.joins[d] = None
        return self.fronts

    def _rest_of_sums(self, d):
        """Rest as a function of what the children of a node of level d offer or demand together."""
        tree, level, front = self.tree, self.tree.level(d), self.fronts[d]
        length, limit, outside = tree.length[level], tree.limit[level], tree.outside[level]
        offer = 2 * np.arange(len(length))
        if_self = tree.weight[level] + front.rest_at(offer, length)
        if_root = front.rest_at(offer + 1, -limit) if d else np.full(1, np.inf)
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

    @staticmethod
    def _share_rest(join, rest, floor, target):
        """Rest of the points that were added up, from the rest of their sums."""
        front, left, right, base = join.front.with_neutral(), join.left, join.right, join.base
        bound = np.full(len(front.weight), np.inf)
        offer_l, demand_l, offer_r, demand_r = _sizes(front, left, right)
        total = offer_l * (offer_r + demand_r) + demand_l * offer_r
        for item, demand, i, j in _small_pairs(front, left, right, np.flatnonzero(total <= DENSE)):
            k = np.flatnonzero(front.weight[i] + front.weight[j] + floor[item] < target)
            item, demand, i, j = item[k], demand[k], i[k], j[k]
            more = rest(2 * item + demand, front.value[i] + front.value[j] + base[item])
            if len(i):
                run = np.flatnonzero(np.append(True, i[1:] != i[:-1]))
                best = np.minimum.reduceat(more + front.weight[j], run)
                bound[i[run]] = np.minimum(bound[i[run]], best)
            np.minimum.at(bound, j, more + front.weight[i])
        for item in np.flatnonzero(total > DENSE):
            for demand, x, y in _blocks(front, left[item], right[item]):
                wx, vx = front.weight[x], front.value[x] + base[item]
                wy, vy = front.weight[y], front.value[y]
                more = _tabulated(rest, 2 * item + demand, vx, vy)
                bound[x] = np.minimum(bound[x], (more + wy).min(axis=1))
                bound[y] = np.minimum(bound[y], (more + wx[:, None]).min(axis=0))
        below = join.front
        below.rest = bound[:-1]
        below.floor = np.full(len(below.ptr) >> 1, np.inf)
        np.minimum.at(below.floor, below.segments() >> 1, below.rest)
        return below

    def trace(self):
        """Selected edges of the cheapest assignment of the root. O(n)."""
        tree = self.tree
        cut = np.zeros(tree.n, bool)
        point = np.zeros(1, np.int64)
        for d in range(tree.depth):
            front = self.fronts[d]
            cut[tree.level(d)] = front.cut[point]
            for join in reversed(self.joins[d]):
                below = np.empty((len(join.front.ptr) >> 1) + 1, np.int64)
                below[join.left], below[join.right] = front.left[point], front.right[point]
                front, point = join.front, below[:-1]
        cut[0] = False
        return cut


def min_weight(
    net, weight, tau, max_gap=0.001, start=None, time_limit=None, check=None, max_points=4096
):
    """Select candidate edges of least total weight such that every one has a witness.

    Parameters
    ----------
    net : Network
        A dual tree with lengths. The triangle inequality is taken for granted: no edge is longer
        than what lies below it.
    weight : (k + 1,) float
        Weight of each node, not negative; that of the root edge is ignored. The lengths for
        MinLength.
    tau : float
        Largest dilation allowed.
    max_gap : float
        Stop as soon as (cost - lower bound) / cost is proven to be no larger; 0 asks for a proof
        of optimality (to the noise of the floats, 1e-10).
    start : (k + 1,) bool, optional
        A solution to begin with; the result never weighs more.
    time_limit : float, optional
        Seconds after which the best solution so far is returned, with its proven gap.
    check : callable, optional
        Called often, sometimes with the share done; may raise `Cancelled`.
    max_points : int
        The search gives up narrowing the gap after a pass with that many points on a front of
        typical width (a front may get four times as many): this bounds the memory.

    Returns
    -------
    cut : (k + 1,) bool
        The edges to select (role SELF); never the root edge.
    lower_bound : float
        No solution weighs less.

    Raises
    ------
    ValueError
        For a weight that is negative or not finite.

    Notes
    -----
    A pass with at most K points per front takes O(n K^2 log K) time at worst. Each level of the
    tree costs some vector calls, so very deep trees are slow.
    """
    weight = np.asarray(weight, float)
    if not (np.isfinite(weight[1:]).all() and (weight[1:] >= 0).all()):
        raise ValueError("weights must be finite and not negative")
    # a power of two, so exact: squares of very large or small weights leave the range of doubles
    scale = float(np.exp2(np.floor(np.log2(weight[1:].max(initial=0.0) or 1.0))))
    tree = _Tree(net.tree.parent, net.length, net.base, weight / scale, tau)
    best = _Best(tree, max_gap, start, check or ignore)
    deadline = np.inf if time_limit is None else time.monotonic() + time_limit

    def timed_check():
        best.check()
        if time.monotonic() > deadline:
            raise _Stop

    try:
        _search(tree, best, max_points, timed_check)
    except _Stop:
        pass
    return best.cut, best.lower * scale


class _Best:
    """Best solution and best lower bound so far."""

    def __init__(self, tree, max_gap, start, check):
        self.tree, self.max_gap, self.check = tree, max(max_gap, NOISE), check
        # selecting all candidates is always feasible
        self.cut = np.ones(tree.n, bool) if start is None else start.copy()
        self.cut[0] = False
        self.cost, self.lower = float(tree.weight[self.cut].sum()), 0.0

    @property
    def target(self):
        """Cost below which a solution would still be of interest."""
        return self.cost * (1 - self.max_gap)

    @property
    def bound(self):
        """Lower bound and target, for a pass."""
        return self.lower, self.target

    @property
    def proven(self):
        """Whether the gap is small enough."""
        return self.lower >= self.target

    def offer_solution(self, solved):
        """Take over the solution of an upper-bound pass if it is better."""
        if solved.cost < self.cost:
            self.cut = solved.trace()
            self.cost = float(self.tree.weight[self.cut].sum())
            self._tell()

    def offer_bound(self, solved):
        """Take over the bound of a lower-bound pass; solutions above its target it never saw."""
        bound = min(solved.cost, solved.target, self.cost)
        if bound > self.lower:
            self.lower = float(bound)
            self._tell()

    def _tell(self):
        """Report how far the gap is closed, on a logarithmic scale."""
        gap = (self.cost - self.lower) / self.cost if self.cost > 0 else 0.0
        self.check(min(1.0, np.log(max(gap, self.max_gap)) / np.log(self.max_gap)))


def _search(tree, best, max_points, check):
    """Passes from coarse to fine until the gap is small enough or the fronts get too long."""
    points = min(FIRST_POINTS, max_points)
    best.offer_solution(_Pass(tree, max(2, points // 8), False, None, best.bound, check))
    guide = None
    while not best.proven:
        lower = _Pass(tree, points, True, guide, best.bound, check)
        best.offer_bound(lower)
        if best.proven:
            return
        trimmed = lower.trimmed
        guide = lower.bound_rest(best.target, check)
        del lower
        # guided real points err less than optimistic ones: half as many do
        enough = points // 2 if trimmed else points
        best.offer_solution(_Pass(tree, enough, False, guide, best.bound, check))
        if not trimmed or points >= max_points:
            return
        points = min(int(GROWTH * points) + 1, max_points)
