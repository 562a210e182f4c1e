"""Pareto fronts of many edges at once, and their algebra.

Two fronts per edge, weight ascending, value strictly descending:

* *offer*: assignments with e as LEAF or SELF, value = front-length L (the length ||e|| if SELF);
* *demand*: assignments with e as ROOT, value = minus the front-allowance R.

With that sign both are minimised, and children combine by plain addition: two offers add up to an
offer, an offer and a demand to a demand (what the sibling's path uses up of the allowance), and
two demands never meet (Lemma 1 of the paper). So MinWeight needs no integer weights, as it
does in section 4.4 there (see `min_weight`).

The fronts of all edges of a level stand one after the other in flat arrays. Nothing here mixes edges:
what becomes of a front is the same, to the last bit, whatever stands beside it.
"""

from __future__ import annotations

from typing import Any, Callable, Iterator

import numpy as np

from ..rings import groups, offsets_of, ranges, starts

__all__ = [
    "CHUNK", "DENSE", "Front", "Join", "Table", "assemble", "dense_pairs", "first_points", "point_groups",
    "pack", "pair_count", "pareto", "products", "sizes", "small_pairs", "strips",
]  # fmt: skip

CHUNK = 1 << 18  # pairs of points handled in one numpy call
DENSE = 3000  # pairs from which on one edge is worth numpy calls of its own
TILE = 32  # points a side of what is looked at as a whole before its sums are made
STRIP = 1 << 15  # sums handled in one numpy call, at least
ROWS = 32  # rows looked at by the quick dominance test
CELLS = 2  # cells of that test, and of large tables, for each of the others
RADIX = 2000  # points from which on sorting them roughly first pays
NEAR = 0.1  # how much finer groups are near the cheapest point: 1 / NEAR times
TABLE = 1024  # cells of a tabulated rest
FIXED = 40  # binary places of the position along a front, an integer: sums of integers are exact


class Front:
    """The fronts of many edges, one after the other: offer of edge 0, demand of edge 0, ...

    Segment s holds the points ptr[s]:ptr[s+1]; edge k owns the segments 2k and 2k+1.
    ``left`` and ``right`` say which two points of the children were added up (SELF and ROOT keep
    those of the assignment below them), ``cut`` whether the edge itself is selected. ``rest`` is
    a bound on the cost outside, ``floor`` its minimum per edge.
    """

    __slots__ = (
        "ptr", "weight", "value", "left", "right", "cut", "rest", "floor", "_key", "_least"
    )  # fmt: skip

    def __init__(
        self,
        ptr: np.ndarray,
        weight: np.ndarray | None,
        value: np.ndarray,
        *,
        left: np.ndarray | None = None,
        right: np.ndarray | None = None,
        cut: np.ndarray | None = None,
    ) -> None:
        self.ptr, self.value = ptr, value
        # None where a front has none: then nobody asks for it
        self.weight: Any = weight
        self.left: Any = left
        self.right: Any = right
        self.cut: Any = cut
        self.rest: Any = None
        self.floor: Any = None
        self._key: Any = None
        self._least: Any = None

    def segments(self) -> np.ndarray:
        """Segment of every point."""
        return groups(self.ptr)

    def take(self, points: np.ndarray, segments: np.ndarray) -> Front:
        """Sub-front of some points (ascending) that lie in the given segments."""
        ptr = offsets_of(np.bincount(segments, minlength=len(self.ptr) - 1))
        left, right, cut = (None if x is None else x[points] for x in (self.left, self.right, self.cut))
        return Front(ptr, self.weight[points], self.value[points], left=left, right=right, cut=cut)

    def of_edges(self, edges: np.ndarray) -> Front:
        """The values and rests of some edges (ascending) only."""
        segments = np.repeat(2 * edges, 2)
        segments[1::2] += 1
        size = np.diff(self.ptr)[segments]
        points = ranges(self.ptr[segments], size)
        part = Front(offsets_of(size), None, self.value[points])
        part.rest, part.floor = self.rest[points], self.floor[edges]
        return part

    def with_neutral(self) -> Front:
        """With an edge more that offers nothing at no cost: the partner of an unpaired child."""
        ptr = np.append(self.ptr, [self.ptr[-1] + 1] * 2)
        return Front(ptr, np.append(self.weight, 0.0), np.append(self.value, 0.0))

    def cheapest(self) -> np.ndarray:
        """Weight of each edge's cheapest offer; inf if there is none."""
        least = np.full(len(self.ptr) >> 1, np.inf)
        some = np.flatnonzero(self.ptr[1::2] > self.ptr[:-1:2])
        least[some] = self.weight[self.ptr[2 * some]]
        return least

    def rest_at(
        self, segment: np.ndarray, value: np.ndarray, rounded: bool | np.ndarray = False
    ) -> np.ndarray:
        """Bound on the rest for arbitrary values: that of the first point at least as good.

        Where no point is as good, the better ones were dropped as hopeless. A demand may also have
        been dropped for a cheaper offer, whose rest is bounded by the floor of the edge.

        A value that was rounded down may find a later point than it should, one that is too dear
        to matter (infinite rest) though an earlier one is not. So it gets the least rest up to
        that point, and the floor where there is none.
        """
        if self._key is None:
            self._key = pack(self.segments(), -self.value)
        found = np.searchsorted(self._key, pack(segment, -value))
        missing = found >= self.ptr[segment + 1]
        rest = np.full(len(value), np.inf)
        rest[~missing] = (self._least_rest() if rounded else self.rest)[found[~missing]]
        edge = segment[missing]
        rest[missing] = np.where(rounded | (edge & 1 == 1), self.floor[edge >> 1], np.inf)
        return rest

    def forget_index(self) -> None:
        """Free what `rest_at` keeps to be fast."""
        self._key = self._least = None

    def _least_rest(self):
        """The running minimum of the rest along each segment."""
        if self._least is None:
            # the major key falls from segment to segment, so the minimum restarts by itself
            self._least = np.minimum.accumulate(pack(-self.segments(), self.rest)).imag
        return self._least


class Join:
    """One round of adding up children: of which edges of `front`, and with which base on top."""

    __slots__ = ("front", "left", "right", "base")

    def __init__(self, front: Front, left: np.ndarray, right: np.ndarray, base: np.ndarray) -> None:
        self.front, self.left, self.right, self.base = front, left, right, base


def pack(major: np.ndarray, minor: np.ndarray) -> np.ndarray:
    """Key that numpy sorts and minimises by (major, minor), exactly: complex is lexicographic.

    Examples
    --------
    Two points of segment 0, by weight, come before that of segment 1.

    >>> np.argsort(pack(np.array([1, 0, 0]), np.array([1.0, 5.0, 2.0]))).tolist()
    [2, 1, 0]
    """
    key = np.empty(len(minor), complex)
    key.real = major
    key.imag = minor
    return key


def pareto(seg: np.ndarray, weight: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points that no other of the same segment dominates, sorted by (segment, weight).

    Segments must ascend. Of equal points the first remains. O(N log N). Returns positions and segments.

    Examples
    --------
    Point 1 goes: it weighs more than point 0 of the same segment, and its value is not smaller.

    >>> segment, weight, value = np.array([[0, 1, 5], [0, 2, 6], [0, 3, 2], [1, 2, 6]]).T
    >>> [x.tolist() for x in pareto(segment, weight, value)]
    [[0, 2, 3], [0, 0, 1]]
    """
    if len(seg) and seg[0] == seg[-1]:  # floats alone are faster, and most need no sorting at all
        some = _not_far_behind(weight, value)
        order = some[np.argsort(weight[some], kind="stable")]
        val, seg = value[order], seg[order]
        best = np.minimum.accumulate(val)
    else:
        order = np.argsort(pack(seg, weight), kind="stable")
        val = value[order]
        # the major key falls from segment to segment, so the running minimum restarts by itself
        best = np.minimum.accumulate(pack(-seg, val)).imag
    keep = np.ones(len(order), bool)
    keep[1:] = (seg[1:] != seg[:-1]) | (val[1:] < best[:-1])
    order, seg = order[keep], seg[keep]
    w = weight[order]
    keep = np.ones(len(order), bool)
    keep[:-1] = (seg[1:] != seg[:-1]) | (w[1:] != w[:-1])
    return order[keep], seg[keep]


def _not_far_behind(weight, value):
    """Points that none in an earlier one of 65,536 cells beats: integers of 16 bits are sorted by radix."""
    low, high = weight.min(), weight.max()
    if len(weight) < RADIX or not high > low:
        return np.arange(len(weight))
    cell = ((weight - low) * (65535 / (high - low))).astype(np.uint16)
    order = np.argsort(cell, kind="stable")
    val, cell = value[order], cell[order]
    first = starts(cell)
    before = np.minimum.accumulate(np.append(np.inf, np.minimum.reduceat(val, first)[:-1]))
    return order[val < np.repeat(before, np.diff(np.append(first, len(val))))]


def sizes(
    front: Front, left: np.ndarray, right: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of points: offer and demand of the left, offer and demand of the right.

    Examples
    --------
    Edge 0 has two offers and a demand, edge 1 has one offer.

    >>> front = Front(np.array([0, 2, 3, 4, 4]), np.array([0, 1, 0, 1.0]), np.array([5, 2, -3, 4.0]))
    >>> [size.tolist() for size in sizes(front, np.array([0]), np.array([1]))]
    [[2], [1], [1], [0]]
    """
    size = np.diff(front.ptr)
    return size[2 * left], size[2 * left + 1], size[2 * right], size[2 * right + 1]


def pair_count(front: Front, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Number of pairs of points that can be added up, for each left and right edge.

    Examples
    --------
    Edge 0 has two offers and a demand; the one offer of edge 1 can be added to each of them.

    >>> front = Front(np.array([0, 2, 3, 4, 4]), np.array([0, 1, 0, 1.0]), np.array([5, 2, -3, 4.0]))
    >>> pair_count(front, np.array([0]), np.array([1])).tolist()
    [3]
    """
    offer_l, demand_l, offer_r, demand_r = sizes(front, left, right)
    return offer_l * (offer_r + demand_r) + demand_l * offer_r


def small_pairs(front: Front, left: np.ndarray, right: np.ndarray, items: np.ndarray) -> Iterator[tuple]:
    """All pairs of points of the given items, in chunks: are they demands, and rows and pairs.

    A row is a point of a left edge with all points of the right one that it can be added to. Rows:
    item and point; pairs: row and right point. Of each item the first pair is that of the cheapest
    points.

    Examples
    --------
    Edge 0 has the points 0 and 1 as offers and 2 as a demand, edge 1 point 3 as an offer.

    >>> front = Front(np.array([0, 2, 3, 4, 4]), np.array([0, 1, 0, 1.0]), np.array([5, 2, -3, 4.0]))
    >>> for demand, item, point, row, right in small_pairs(front, *np.array([[0], [1], [0]])):
    ...     print(demand, [(int(point[k]), int(j)) for k, j in zip(row, right)])
    False [(0, 3), (1, 3)]
    True [(2, 3)]
    """
    total = np.cumsum(pair_count(front, left[items], right[items]))
    a = 0
    while a < len(items):
        done = total[a - 1] if a else 0
        b = max(a + 1, int(np.searchsorted(total, done + CHUNK, "right")))
        of = items[a:b]
        start, size = front.ptr, np.diff(front.ptr)
        offer, other = 2 * left[of], 2 * right[of]
        for demand in (False, True):
            points = size[offer] + size[offer + 1] if demand else size[offer]
            own = np.repeat(np.arange(len(of)), points)
            i = ranges(start[offer], points)
            # a demand on the left is met by offers on the right, and the other way round
            to = other[own] + (demand & (i < start[offer[own] + 1]))
            some = np.flatnonzero(size[to])
            own, i, to = own[some], i[some], to[some]
            partners = size[to]
            yield demand, of[own], i, np.repeat(np.arange(len(i)), partners), ranges(start[to], partners)
        a = b


def products(front: Front, left: int, right: int) -> list[tuple[int, slice, slice]]:
    """The three products of one item: is it a demand, points of the left, points of the right.

    Examples
    --------
    Edge 0 has the points 0 and 1 as offers and 2 as a demand, edge 1 point 3 as an offer, and no demand.

    >>> front = Front(np.array([0, 2, 3, 4, 4]), np.array([0, 1, 0, 1.0]), np.array([5, 2, -3, 4.0]))
    >>> place = np.arange(4)
    >>> [(demand, place[x].tolist(), place[y].tolist()) for demand, x, y in products(front, 0, 1)]
    [(0, [0, 1], [3]), (1, [2], [3])]
    """
    offer_l, demand_l, offer_r, demand_r = (
        slice(front.ptr[s], front.ptr[s + 1]) for s in (2 * left, 2 * left + 1, 2 * right, 2 * right + 1)
    )
    three = ((0, offer_l, offer_r), (1, offer_l, demand_r), (1, demand_l, offer_r))
    return [(k, x, y) for k, x, y in three if x.stop > x.start and y.stop > y.start]


def strips(
    front: Front, x: slice, y: slice, base: float, hopeful: Callable
) -> Iterator[tuple[slice, slice, np.ndarray, np.ndarray]]:
    """Strips of a product that may matter: their rows and columns, and the weights and values of the sums.

    The product is looked at in tiles. ``hopeful`` says of the least weight and value of each whether
    there can be a sum of interest in it; a strip goes from the first to the last such tile of a row.

    Examples
    --------
    >>> front = Front(np.array([0, 2, 4]), np.array([0, 1, 0, 2.0]), np.array([5, 2, 6, 4.0]))
    >>> (strip,) = strips(front, slice(0, 2), slice(2, 4), 1.0, lambda weight, value: weight >= 0.0)
    >>> [sums.tolist() for sums in strip[2:]]
    [[[0.0, 2.0], [1.0, 3.0]], [[12.0, 10.0], [9.0, 7.0]]]
    """
    wx, vx, wy, vy = front.weight[x], front.value[x] + base, front.weight[y], front.value[y]
    rows = np.arange(0, len(wx), max(TILE, STRIP // len(wy)))
    columns = np.arange(0, len(wy), TILE)
    row_end, column_end = np.append(rows[1:], len(wx)), np.append(columns[1:], len(wy))
    alive = hopeful(wx[rows, None] + wy[columns], vx[row_end - 1, None] + vy[column_end - 1])
    some = np.flatnonzero(alive.any(axis=1))
    first = columns[alive.argmax(axis=1)].tolist()
    last = column_end[::-1][alive[:, ::-1].argmax(axis=1)].tolist()
    for k in some.tolist():
        i, j = slice(int(rows[k]), int(row_end[k])), slice(first[k], last[k])
        weight, value = wx[i, None] + wy[j], vx[i, None] + vy[j]
        yield (
            slice(x.start + i.start, x.start + i.stop),
            slice(y.start + j.start, y.start + j.stop),
            weight,
            value,
        )


def dense_pairs(
    front: Front,
    left: int,
    right: int,
    base: float,
    value_cap: np.ndarray,
    weight_cap: np.ndarray,
    check: Callable,
) -> Iterator[tuple]:
    """Useful sums of one item with many pairs: are they demands, points, points, weights, values.

    Examples
    --------
    Edge 0 has the points 0 and 1 as offers and 2 as a demand, edge 1 point 3 as an offer; the base is 1 long.

    >>> front = Front(np.array([0, 2, 3, 4, 4]), np.array([0, 1, 0, 1.0]), np.array([5, 2, -3, 4.0]))
    >>> cap = np.full(2, np.inf)
    >>> for demand, *found in dense_pairs(front, 0, 1, 1.0, cap, cap, lambda: None):
    ...     print(demand, [x.tolist() for x in found])
    0 [[0, 1], [3, 3], [1.0, 2.0], [10.0, 7.0]]
    1 [[2], [3], [1.0], [2.0]]
    """
    for demand in (0, 1):
        own = [(x, y) for kind, x, y in products(front, left, right) if kind == demand]
        if not own:
            continue
        undominated = _Envelope(front, own, base, weight_cap[demand])
        # the cheapest offer stays in any case: SELF and ROOT build on it
        keep = None if demand else (own[0][0].start, own[0][1].start)

        def hopeful(weight, value, demand=demand, keep=keep, undominated=undominated):
            alive = (weight < weight_cap[demand]) & (value <= value_cap[demand])
            alive &= undominated(weight, value)
            if keep:
                alive[0, 0] = True
            return alive

        parts = []
        for x, y in own:
            for i, j, weight, value in strips(front, x, y, base, hopeful):
                check()
                useful = undominated(weight, value)
                if not weight[-1, -1] < weight_cap[demand]:
                    useful &= weight < weight_cap[demand]
                if not value[0, 0] <= value_cap[demand]:
                    useful &= value <= value_cap[demand]
                if (i.start, j.start) == keep:
                    useful[0, 0] = True
                k = np.flatnonzero(useful)
                row, column = np.divmod(k, j.stop - j.start)
                parts.append((row + i.start, column + j.start, weight.ravel()[k], value.ravel()[k]))
        if parts:
            yield demand, *(np.concatenate(x) for x in zip(*parts))


class _Envelope:
    """A quick test that shows most dominated sums of one item to be so.

    For each of some thresholds t the best value of weight <= t is found among the sums of some of the
    rows; a sum at or above t with a worse value is dominated.
    """

    def __init__(self, front, own, base, weight_cap):
        self.low = min(front.weight[x.start] + front.weight[y.start] for x, y in own)
        high = max(front.weight[x.stop - 1] + front.weight[y.stop - 1] for x, y in own)
        width = min(high, weight_cap) - self.low
        self.best = None
        if not width > 0:
            return
        self.cells = max(y.stop - y.start for _, y in own) * CELLS
        step = width / self.cells
        self.scale = 1 / step
        threshold = self.low + step * np.arange(self.cells)
        best = np.full(self.cells, np.inf)
        for x, y in own:
            some = slice(x.start, x.stop, 1 + (x.stop - x.start) // ROWS)
            wx, vx, wy, vy = front.weight[some], front.value[some] + base, front.weight[y], front.value[y]
            j = np.searchsorted(wy, threshold - wx[:, None], "right") - 1
            np.minimum(best, np.where(j >= 0, vx[:, None] + vy[j], np.inf).min(axis=0), out=best)
        # rounding may place t - w(x) a hair beside w(y): one cell of distance makes that harmless
        self.best = np.concatenate(([np.inf], np.minimum.accumulate(best)))

    def __call__(self, weight, value):
        """Whether the test cannot show a sum to be dominated."""
        if self.best is None:
            return np.ones(weight.shape, bool)
        cell = weight - self.low
        cell *= self.scale
        np.minimum(cell, self.cells, out=cell)
        return value <= self.best.take(cell.astype(np.int32))


def first_points(
    node: np.ndarray, points: np.ndarray, weight: np.ndarray, n: int
) -> tuple[np.ndarray, np.ndarray]:
    """Weight and position of each node's first one of some points (ascending); inf and 0 if none.

    Examples
    --------
    Points 0 and 1 belong to node 0, points 2 and 3 to node 2, and node 1 has none.

    >>> best, where = first_points(np.array([0, 0, 2, 2]), np.array([1, 2, 3]), np.array([4, 5, 6, 7.0]), 3)
    >>> best.tolist(), where.tolist()
    ([5.0, inf, 6.0], [1, 0, 2])
    """
    nodes = node[points]
    at = np.flatnonzero(np.diff(nodes, prepend=-1))
    best, where = np.full(n, np.inf), np.zeros(n, np.int64)
    where[nodes[at]] = points[at]
    best[nodes[at]] = weight[points[at]]
    return best, where


def assemble(
    whole: Front,
    keep: np.ndarray,
    seg: np.ndarray,
    value: np.ndarray,
    own: tuple,
    root: tuple | None = None,
) -> Front:
    """Fronts of the points to keep, with SELF behind the offers and full ROOT behind the demands.

    `own` and `root` are (for which nodes, weight, value, point of `whole` below it).

    Examples
    --------
    An edge 3 long with two offers and a demand; the second offer is dropped, and SELF comes behind the first.

    >>> front = Front(np.array([0, 2, 3]), np.array([0, 1, 0.0]), np.array([5, 4, -3.0]))
    >>> own = np.array([True]), np.array([1.0]), np.array([3.0]), np.array([0])
    >>> found = assemble(front, np.array([0, 2]), np.array([0, 0, 1]), front.value, own)
    >>> found.ptr.tolist(), found.weight.tolist(), found.value.tolist()
    ([0, 2, 3], [0.0, 1.0, 0.0], [5.0, 3.0, -3.0])
    """
    segments = len(whole.ptr) - 1
    add = np.zeros(segments, np.int64)
    add[::2] = own[0]
    if root is not None:
        add[1::2] = root[0]
    ptr = offsets_of(np.bincount(seg[keep], minlength=segments) + add)
    source = np.empty(ptr[-1], np.int64)
    weights, values, cut = np.empty(ptr[-1]), np.empty(ptr[-1]), np.zeros(ptr[-1], bool)
    at = np.arange(len(keep)) + offsets_of(add)[seg[keep]]
    source[at], weights[at], values[at] = keep, whole.weight[keep], value[keep]
    for kind, extra in enumerate((own, root)):
        if extra is not None:
            nodes = np.flatnonzero(extra[0])
            at = ptr[2 * nodes + kind + 1] - 1
            weights[at], values[at], source[at] = (x[nodes] for x in extra[1:])
            cut[at] = kind == 0
    if whole.left is None:
        return Front(ptr, weights, values)
    return Front(ptr, weights, values, left=whole.left[source], right=whole.right[source], cut=cut)


def point_groups(
    front: Front,
    long: np.ndarray,
    allowed: np.ndarray,
) -> np.ndarray:
    """First point of every group of long fronts; points of the other fronts are groups of their own.

    The groups are steps of equal length along the (normalised) front, finer near the cheapest point. Finer
    where little is above the lower bound, as a guide knows it, was worse: as long as a gap is wide beside
    the front it says little, and later few points are left.

    Parameters
    ----------
    front : Front
    long : (s,) int
        Segments to be grouped; each has at least two points.
    allowed : (s,) int
        Largest number of groups in each.

    Examples
    --------
    Five offers make three groups; the demand behind them is a group of its own.

    >>> front = Front(np.array([0, 5, 6]), np.array([0, 1, 2, 3, 4, 0.0]), np.array([8, 6, 4, 2, 0, -1.0]))
    >>> point_groups(front, np.array([0]), np.array([3])).tolist()
    [0, 2, 4, 5]
    """
    first, last = front.ptr[long], front.ptr[long + 1] - 1
    size = last - first + 1
    at = ranges(first, size)
    own = np.repeat(np.arange(len(long)), size)
    begin = np.cumsum(size) - size
    weight, value = front.weight[at], front.value[at]
    width = (front.weight[last] - front.weight[first])[own]
    step = np.diff(weight, prepend=0.0) / width
    step -= np.diff(value, prepend=0.0) / (front.value[first] - front.value[last])[own]
    step /= (weight - front.weight[first][own]) / width + NEAR
    step[begin] = 0.0
    # in integers: sums of floats would depend on the fronts before
    total = np.add.reduceat(step, begin)[own]
    along = np.cumsum((step * (2.0**FIXED / total)).astype(np.int64))
    along -= along[begin][own]
    whole = along[begin + size - 1][own]
    group = np.floor(along * ((allowed - 1)[own] / whole))
    head = np.ones(len(front.weight), bool)
    head[at[1:]] = (group[1:] != group[:-1]) | (own[1:] != own[:-1])
    return np.flatnonzero(head)


class Table:
    """The rest of all sums of a product, rounded down to the lower end of a cell of a table.

    Examples
    --------
    Where the rest is ten times the value: exact but for a cell of the table, and never too large.

    >>> def rest(segment, value, rounded=False):
    ...     return 10.0 * value
    >>> front = Front(np.array([0, 2, 4]), np.array([0, 1, 0, 2.0]), np.array([4, 0, 6, 1.0]))
    >>> table = Table(rest, 0, front, slice(0, 2), slice(2, 4), 0.0)
    >>> table(np.array([10.0, 5, 6, 1])).round().tolist()
    [100.0, 50.0, 60.0, 10.0]
    """

    def __init__(self, rest: Callable, segment: int, front: Front, x: slice, y: slice, base: float) -> None:
        # values descend
        self.low = front.value[x.stop - 1] + base + front.value[y.stop - 1]
        width = front.value[x.start] + base + front.value[y.start] - self.low
        cells = CELLS * TABLE if (x.stop - x.start) * (y.stop - y.start) > CHUNK else TABLE
        step = width / cells
        self.scale = 1 / step if width > 0 else 0.0
        # a millionth of a cell below its end: rounding can never lift a value into a better cell
        at = self.low + step * (np.arange(cells + 1) - 1e-6)
        self.rest = rest(np.full(cells + 1, segment), at, True)
        self.from_here = np.minimum.accumulate(self.rest[::-1])[::-1]

    def _cell(self, value):
        cell = value - self.low
        cell *= self.scale
        return cell.astype(np.int32)

    def __call__(self, value: np.ndarray) -> np.ndarray:
        """At most the rest of each value."""
        return self.rest.take(self._cell(value))

    def least(self, value: np.ndarray) -> np.ndarray:
        """At most the rest of each value and of all larger ones."""
        return self.from_here.take(self._cell(value))
