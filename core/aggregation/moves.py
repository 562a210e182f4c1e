"""Moves of areas between regions: what each costs, and how it is made.

Every price is the exact difference of the costs that the move makes, plus the price of what regions
then lack, and of one region more or less. Moves of single areas are priced many at once, in
arrays; the others, of which few are tried, one by one.
"""

from __future__ import annotations

import heapq
import math
from typing import NamedTuple

import numpy as np

from .greedy import best_split
from .instance import cheapest_core, connected_parts, each_share, shares
from .regions import EXCLUDED, LARGEST_GROUP, Regions

__all__ = [
    "Terms",
    "draw",
    "every_move",
    "gather",
    "group_price",
    "merge",
    "move_area",
    "move_core",
    "prices",
    "recore",
    "split",
]

LARGEST_REGION = 400  # areas of a region for which every core is tried
DENSE = 24  # areas of a region from which its cores are compared in a table of its own


class Terms(NamedTuple):
    """On which terms moves are accepted.

    Attributes
    ----------
    temperature : float
    lack : float
        Price of a missing square metre.
    region : float
        Price of one more region, to steer towards the number wanted.
    """

    temperature: float
    lack: float
    region: float = 0.0

    def accepts(self, delta: float, rng: np.random.Generator) -> bool:
        """Whether the rule of Metropolis accepts a price."""
        return delta < -self.temperature * math.log(rng.random() + 1e-300)


# ---- single areas


def draw(regions: Regions, rng: np.random.Generator, m: int) -> tuple[np.ndarray, np.ndarray]:
    """Draw moves of areas to neighbouring regions, and some to new ones (-1).

    Examples
    --------
    Three areas in a row, the first two in region 0: among a hundred draws are both moves to a neighbour.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> regions = Regions(row, Solution(np.array([0, 0, 1]), np.array([0, 2])))
    >>> v, to = draw(regions, np.random.default_rng(1), 100)
    >>> sorted({(a, r) for a, r in zip(v.tolist(), to.tolist()) if r >= 0})
    [(1, 1), (2, 0)]
    """
    p = regions.problem
    v = regions.movable[rng.integers(len(regions.movable), size=m)]
    slot = p.start[v] + (rng.random(m) * regions.degree[v]).astype(np.int64)
    to, old = regions.region[p.neighbour[slot]], regions.region[v]
    fresh = (rng.random(m) < 0.02) & (regions.number[old] > 1)
    fresh &= regions.theta[v] < EXCLUDED
    useful = (to != old) | fresh
    if len(regions.free) < 64:
        useful &= ~fresh
    to = np.where(fresh, -1, to)
    return v[useful], to[useful]


def every_move(regions: Regions, changed: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """All moves of an area to the region of a neighbour, each once.

    Parameters
    ----------
    changed : (n,) bool, optional
        Only moves from or to these regions.

    Examples
    --------
    Three areas in a row, the first two in region 0.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> regions = Regions(row, Solution(np.array([0, 0, 1]), np.array([0, 2])))
    >>> v, to = every_move(regions)
    >>> v.tolist(), to.tolist()
    ([1, 2], [1, 0])
    """
    p, owner = regions.problem, regions.problem.owner
    to, old = regions.region[p.neighbour], regions.region[owner]
    useful = (to != old) & ~regions.frozen[owner]
    if changed is not None:
        useful &= changed[to] | changed[old]
    useful = np.flatnonzero(useful)
    key = np.unique(owner[useful] * len(p.size) + to[useful])
    return key // len(p.size), key % len(p.size)


def prices(regions: Regions, v: np.ndarray, to: np.ndarray, terms: Terms) -> np.ndarray:
    """Prices of single moves: area v[i] to region to[i], or to a new one if that is -1.

    Returns
    -------
    (m,) float
        Infinite for a move of the core of a region with other areas.

    Notes
    -----
    O(the neighbours of these areas), in arrays.

    Examples
    --------
    Three areas in a row, the first two in region 0: the second may change sides at no cost, alone it would
    save the change of its class but lack 2 m2, and the first is the core.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> regions = Regions(row, Solution(np.array([0, 0, 1]), np.array([0, 2])))
    >>> prices(regions, np.array([1, 1, 0]), np.array([1, -1, 1]), Terms(temperature=0.0, lack=10.0)).tolist()
    [0.0, 19.0, inf]
    """
    p = regions.problem
    if not len(v):
        return np.zeros(0)
    old = regions.region[v]
    fresh = to < 0
    core_old = regions.core[old]
    core_new = np.where(fresh, v, regions.core[to])
    delta = each_share(p, v, core_new) - each_share(p, v, core_old)
    if p.boundary:
        degree = regions.degree[v]
        first = np.cumsum(degree) - degree
        slot = np.repeat(p.start[v] - first, degree)
        slot += np.arange(len(slot))
        other = regions.region[p.neighbour[slot]]
        if regions.by_class:
            kept = p.cls[regions.core]
            other, left, right = kept[other], p.cls[core_old], p.cls[core_new]
        else:
            left, right = old, to
        saved = (other == np.repeat(left, degree)).astype(np.int8)
        saved -= other == np.repeat(right, degree)
        delta += p.boundary * np.add.reduceat(p.length[slot] * saved, first)
    size, size_old = p.size[v], regions.size[old]
    size_new = np.where(fresh, 0.0, regions.size[to])
    alone = regions.number[old] == 1
    lack = np.where(alone, 0.0, regions.missing(size_old - size, core_old))
    lack -= regions.missing(size_old, core_old)
    lack += regions.missing(size_new + size, core_new)
    lack -= np.where(fresh, 0.0, regions.missing(size_new, core_new))
    delta += terms.lack * lack
    if terms.region:
        delta += terms.region * (fresh.astype(float) - alone)
    delta[(core_old == v) & ~alone] = np.inf
    return delta


def group_price(regions: Regions, group: set[int], r: int, to: int, terms: Terms) -> float:
    """Price of moving a connected group of areas (without the core) from r to a region.

    Examples
    --------
    Two areas of class 2 leave a region of class 0 for one of their own class.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> pairs = [[0, 1], [1, 2], [2, 3]]
    >>> row = build([4, 1, 2, 5], [0, 2, 2, 2], [0, 1, 2, 3], pairs, [1, 1, 1], 1 - np.eye(3), [3, 3, 3])
    >>> regions = Regions(row, Solution(np.array([0, 0, 0, 1]), np.array([0, 3])))
    >>> group_price(regions, {1, 2}, 0, 1, Terms(temperature=0.0, lack=10.0))
    -3.0
    """
    p = regions.problem
    areas = np.array(sorted(group))
    core_old, core_new = regions.core[r], regions.core[to]
    pair = shares(p, areas, np.array([core_old, core_new])).sum(axis=0)
    delta = float(pair[1] - pair[0])
    if p.boundary:
        left, right = (p.cls[core_old], p.cls[core_new]) if regions.by_class else (r, to)
        change = 0.0
        for v in areas.tolist():
            for u, length in regions.length_of[v].items():
                if u in group:
                    continue
                s = regions.labels[u]
                kept = p.cls[regions.core[s]] if regions.by_class else s
                change += length * (int(kept == left) - int(kept == right))
        delta += p.boundary * change
    size = float(p.size[areas].sum())
    return delta + terms.lack * float(
        regions.missing(regions.size[r] - size, core_old)
        - regions.missing(regions.size[r], core_old)
        + regions.missing(regions.size[to] + size, core_new)
        - regions.missing(regions.size[to], core_new)
    )


def move_area(regions: Regions, v: int, to: int, terms: Terms, rng: np.random.Generator) -> bool:
    """Make a single move if its regions are untouched and stay contiguous; whether it was made.

    Areas that it would cut off follow, if that is accepted, too.

    Examples
    --------
    In one batch each region changes once.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> regions = Regions(row, Solution(np.array([0, 0, 1]), np.array([0, 2])))
    >>> terms, rng = Terms(temperature=0.0, lack=10.0), np.random.default_rng(1)
    >>> regions.batch += 1
    >>> move_area(regions, 1, 1, terms, rng), move_area(regions, 1, 0, terms, rng), regions.labels
    (True, False, [0, 1, 1])
    """
    r = regions.labels[v]
    stamp, batch = regions.stamp, regions.batch
    if stamp[r] == batch or (to >= 0 and stamp[to] == batch):
        return False
    if regions.by_class and any(stamp[regions.labels[u]] == batch for u in regions.adjacent[v]):
        return False
    if len(regions.members[r]) > 1:
        lost = regions.cut_off(v, r)
        if lost is None or (lost and to < 0):
            return False
        if lost:
            group = {v, *lost}
            if not terms.accepts(group_price(regions, group, r, to, terms), rng):
                return False
            regions.put(sorted(group), r, to)
            return True
    regions.put([v], r, to)
    return True


# ---- cores


def recore(regions: Regions, terms: Terms) -> list[int]:
    """Give the regions that changed their best cores, all at once; return who got one.

    Notes
    -----
    O(sum of m^2) over changed regions of m areas; of large regions only some cores are tried.

    Examples
    --------
    The core of region 0 is the smaller one of its areas; the larger one is better.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> regions = Regions(row, Solution(np.array([0, 0, 1]), np.array([1, 2])))
    >>> regions.dirty.add(0)
    >>> recore(regions, Terms(temperature=0.0, lack=10.0)), regions.core[:2].tolist()
    ([0], [0, 2])
    """
    p, changed = regions.problem, sorted(regions.dirty)
    regions.dirty.clear()
    touched, got, few, lists = set(), [], [], []
    for r in changed:
        m = len(regions.members[r])
        if m == 1:
            continue
        members = np.array(sorted(regions.members[r]))
        if m > DENSE and not regions.by_class:
            if _core_of_large(regions, r, members, terms):
                got.append(r)
        elif m <= LARGEST_REGION:
            few.append(r)
            lists.append(members)
    if not few:
        return got
    count = np.array([len(one) for one in lists])
    members, few = np.concatenate(lists), np.array(few)
    first = np.cumsum(count) - count
    group = np.repeat(np.arange(len(count)), count)
    # all pairs of areas of one region
    row = np.repeat(np.arange(len(members)), count[group])
    ends = np.cumsum(count[group])
    column = np.arange(ends[-1]) - np.repeat(ends - count[group] - first[group], count[group])
    cost = np.bincount(column, each_share(p, members[row], members[column]), len(members))
    cost += terms.lack * regions.missing(regions.size[few][group], members)
    if regions.by_class:
        cost -= p.boundary * _class_lengths(regions, members, group, few)
    now = np.flatnonzero(members == regions.core[few][group])
    least = np.minimum.reduceat(cost, first)
    better = np.flatnonzero(least < cost[now] - 1e-9 * np.abs(cost[now]))
    for k in better.tolist():
        best = members[first[k] + int(np.argmin(cost[first[k] : first[k] + count[k]]))]
        r = int(few[k])
        if regions.by_class and p.cls[best] != p.cls[regions.core[r]]:
            if touched.intersection(regions.around(r)):  # its price is no longer true
                regions.dirty.add(r)
                continue
            touched.add(r)
        regions.core[r] = best
        got.append(r)
    return got


def _core_of_large(regions, r, members, terms):
    """Give one region its best core; whether it is another one."""
    p, core = regions.problem, int(regions.core[r])
    extra = terms.lack * regions.missing(regions.size[r], members)
    now = np.flatnonzero(members == core)[0]
    before = float(shares(p, members, np.array([core])).sum() + extra[now])
    best, cost = cheapest_core(p, members, extra)
    if not cost < before - 1e-9 * abs(before):
        return False
    regions.core[r] = members[best]
    return True


def _class_lengths(regions, members, group, changed):
    """Boundary of each member's region to regions of the member's class."""
    p, classes = regions.problem, len(regions.problem.theta)
    degree = regions.degree[members]
    ends = np.cumsum(degree)
    slot = np.arange(ends[-1]) + np.repeat(p.start[members] - ends + degree, degree)
    other = regions.region[p.neighbour[slot]]
    own = np.repeat(group, degree)
    out = other != changed[own]
    table = np.bincount(
        own[out] * classes + p.cls[regions.core[other[out]]],
        p.length[slot[out]],
        len(changed) * classes,
    )
    return table[group * classes + p.cls[members]]


# ---- moves of several areas: each is proposed once, for a random place


def _random_area(regions, rng):
    return int(regions.movable[rng.integers(len(regions.movable))])


def merge(regions: Regions, terms: Terms, rng: np.random.Generator) -> None:
    """Propose to merge two neighbouring regions.

    Examples
    --------
    Three areas in a row, the first two in region 0; one region fewer is worth 2, and some
    proposals later they are one.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> regions = Regions(row, Solution(np.array([0, 0, 1]), np.array([0, 2])))
    >>> rng = np.random.default_rng(1)
    >>> for _ in range(30):
    ...     merge(regions, Terms(temperature=0.0, lack=10.0, region=2.0), rng)
    >>> len(set(regions.labels)), regions.count
    (1, 1)
    """
    v = _random_area(regions, rng)
    r = regions.labels[v]
    near = [s for s in (regions.labels[u] for u in regions.adjacent[v]) if s != r]
    if not near or len(regions.members[r]) > LARGEST_REGION:
        return
    to = near[rng.integers(len(near))]
    if len(regions.members[to]) > LARGEST_REGION:
        return
    p = regions.problem
    areas = np.array(sorted(regions.members[r]))
    others = np.array(sorted(regions.members[to]))
    both = np.concatenate((areas, others))
    core_r, core_to = regions.core[r], regions.core[to]
    total = regions.size[r] + regions.size[to]
    before = shares(p, areas, core_r[None]).sum() + shares(p, others, core_to[None]).sum()
    before += terms.lack * regions.missing(regions.size[r], core_r)
    before += terms.lack * regions.missing(regions.size[to], core_to)
    if not regions.by_class:
        best, after = cheapest_core(p, both, terms.lack * regions.missing(total, both))
        core = both[best]
    else:
        choice = np.array([core_r, core_to])
        after = shares(p, both, choice).sum(axis=0)
        after += terms.lack * regions.missing(total, choice)
        for k, (one, other) in enumerate(((to, r), (r, to))):  # `one` takes the class of `other`
            a, b = p.cls[regions.core[one]], p.cls[regions.core[other]]
            if a != b:
                after[k] += p.boundary * sum(
                    length * (int(c == a) - int(c == b))
                    for v in regions.members[one]
                    for u, length in regions.length_of[v].items()
                    if regions.labels[u] != one
                    for c in (p.cls[regions.core[regions.labels[u]]],)
                )
        core, after = choice[int(np.argmin(after))], after.min()
    delta = after - before - terms.region
    if not regions.by_class:
        delta -= p.boundary * sum(
            length
            for v in areas.tolist()
            for u, length in regions.length_of[v].items()
            if regions.labels[u] == to
        )
    if terms.accepts(delta, rng):
        regions.put(areas.tolist(), r, to)
        regions.core[to] = core


def split(regions: Regions, terms: Terms, rng: np.random.Generator, most: int = 4) -> None:
    """Propose to split a region in two that are large enough.

    Examples
    --------
    A region of two areas of each of two classes; some proposals later it is two.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> pairs = [[0, 1], [1, 2], [2, 3]]
    >>> row = build([5, 5, 5, 5], [0, 0, 1, 1], [0, 1, 2, 3], pairs, [1, 1, 1], 1 - np.eye(2), [8, 8])
    >>> regions = Regions(row, Solution(np.zeros(4, dtype=int), np.array([0])))
    >>> rng = np.random.default_rng(1)
    >>> for _ in range(30):
    ...     split(regions, Terms(temperature=0.0, lack=10.0), rng)
    >>> regions.current().region.tolist()
    [0, 0, 1, 1]
    """
    r = regions.labels[_random_area(regions, rng)]
    if not 2 <= len(regions.members[r]) <= LARGEST_REGION or not regions.free:
        return
    members = np.array(sorted(regions.members[r]))
    # half of the time with another core for what stays: the old one may be in the middle
    p, old, stays, extra = regions.problem, int(regions.core[r]), int(regions.core[r]), 0.0
    if rng.random() < 0.5:
        stays = int(rng.choice(members, p=p.size[members] / p.size[members].sum()))
        if regions.by_class and p.cls[stays] != p.cls[old]:
            stays = old
        elif stays != old:
            extra = float(np.diff(shares(p, members, np.array([old, stays])).sum(axis=0))[0])

    def kept(v):
        return p.cls[regions.core[regions.labels[v]]]

    found = best_split(p, regions.adjacent, members, stays, kept, most)
    if found is None:
        return
    # what the region lacked before is no longer missing
    extra -= terms.lack * float(regions.missing(regions.size[r], old))
    cost, areas, core = found
    if terms.accepts(cost + extra + terms.region, rng):
        to = regions.put(areas, r, -1)
        regions.core[to] = core
        regions.core[r] = stays


def move_core(regions: Regions, terms: Terms, rng: np.random.Generator) -> None:
    """Propose to move the core of a region to a neighbour; the rest gets the best new core.

    Examples
    --------
    The core of region 0 is of the class of region 1. Some proposals later it is there, and the others have a
    core of their class.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> pairs = [[0, 1], [1, 2], [2, 3]]
    >>> row = build([5, 5, 5, 5], [0, 0, 1, 1], [0, 1, 2, 3], pairs, [1, 1, 1], 1 - np.eye(2), [8, 8])
    >>> regions = Regions(row, Solution(np.array([0, 0, 0, 1]), np.array([2, 3])))
    >>> rng = np.random.default_rng(1)
    >>> for _ in range(30):
    ...     move_core(regions, Terms(temperature=0.0, lack=10.0), rng)
    >>> regions.labels, regions.core[:2].tolist()
    ([0, 0, 1, 1], [0, 3])
    """
    p = regions.problem
    r = regions.labels[_random_area(regions, rng)]
    v = int(regions.core[r])
    near = sorted({regions.labels[u] for u in regions.adjacent[v]} - {r})
    if not near or not 1 < len(regions.members[r]) <= LARGEST_REGION:
        return
    to = near[rng.integers(len(near))]
    rest = regions.members[r] - {v}
    if len(connected_parts(regions.adjacent, rest)) > 1:
        return
    rest = np.array(sorted(rest))
    size = float(p.size[v])
    best, delta = _core_of_rest(regions, rest, regions.size[r] - size, v, terms)
    if not np.isfinite(delta):
        return
    core = int(regions.core[to])
    pair = shares(p, np.array([v]), np.array([v, core]))[0]
    delta += float(pair[1] - pair[0])
    delta += terms.lack * float(
        regions.missing(regions.size[to] + size, core)
        - regions.missing(regions.size[to], core)
        - regions.missing(regions.size[r], v)
    )
    left, right = (p.cls[v], p.cls[core]) if regions.by_class else (r, to)
    for u, length in regions.length_of[v].items():
        s = regions.labels[u]
        kept = p.cls[regions.core[s]] if regions.by_class else s
        delta += p.boundary * length * (int(kept == left) - int(kept == right))
    if terms.accepts(delta, rng):
        regions.put([v], r, to)
        regions.core[r] = best


def _core_of_rest(regions, rest, size, old, terms):
    """Best core for what is left of a region without its core, and what that and its lack cost."""
    p = regions.problem
    extra = terms.lack * regions.missing(size, rest)
    if regions.by_class:  # its class stays, so that the boundaries of the rest keep their price
        extra = np.where(p.cls[rest] == p.cls[old], extra, np.inf)
    best, cost = cheapest_core(p, rest, extra)
    return int(rest[best]), cost - float(shares(p, rest, np.array([old])).sum())


def gather(regions: Regions, terms: Terms, rng: np.random.Generator) -> None:
    """Propose a new region of an area and others around it, from any regions, until it is enough.

    Where several small areas of a class lie together in regions of other classes, no move of one of
    them is cheap: they must leave at once.

    Examples
    --------
    Areas 1 and 3 are of a class of their own, next to each other, and lost to two regions: neither is large
    enough alone. Some proposals later they are a region.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> pairs = [[0, 1], [1, 2], [2, 3], [3, 4], [1, 3]]
    >>> lost = build([6, 3, 6, 3, 6], [0, 1, 0, 1, 0], [0] * 5, pairs, [1] * 5, 1 - np.eye(2), [6, 6])
    >>> regions = Regions(lost, Solution(np.array([0, 0, 1, 1, 2]), np.array([0, 2, 4])))
    >>> rng = np.random.default_rng(1)
    >>> for _ in range(30):
    ...     gather(regions, Terms(temperature=0.0, lack=10.0), rng)
    >>> regions.current().region.tolist()
    [0, 1, 2, 1, 3]
    """
    u = _random_area(regions, rng)
    if regions.theta[u] >= EXCLUDED or not regions.free:
        return
    part = _around(regions, u, rng)
    if part is None:
        return
    p, labels = regions.problem, regions.labels
    sources = {}
    for v in part:
        sources.setdefault(labels[v], set()).add(v)
    rests = {}
    for r, taken in sources.items():
        rest = regions.members[r] - taken
        if len(regions.members[r]) > LARGEST_REGION:
            return
        if rest:  # of what falls apart one part stays, with the core if that was not taken
            pieces = connected_parts(regions.adjacent, rest)
            kept = max(pieces, key=lambda piece: (regions.core[r] in piece, len(piece)))
            taken |= rest - set(kept)
            rest = set(kept)
        rests[r] = rest
    part = set().union(*sources.values())
    if len(part) > LARGEST_GROUP:
        return
    delta, cores, size = terms.region, {}, 0.0
    for r, taken in sources.items():
        old, rest = int(regions.core[r]), np.array(sorted(rests[r]), dtype=np.int64)
        moved = float(p.size[list(taken)].sum())
        size += moved
        pair = shares(p, np.array(sorted(taken)), np.array([old, u])).sum(axis=0)
        delta += float(pair[1] - pair[0]) - terms.lack * float(regions.missing(regions.size[r], old))
        left = regions.size[r] - moved
        if not len(rest):
            delta -= terms.region
        elif old in taken:
            cores[r], cost = _core_of_rest(regions, rest, left, old, terms)
            delta += cost
        else:
            delta += terms.lack * float(regions.missing(left, old))
    delta += terms.lack * float(regions.missing(size, u))
    if p.boundary and np.isfinite(delta):
        delta += p.boundary * _new_boundary(regions, part, u)
    if not terms.accepts(delta, rng):
        return
    own = labels[u]
    to = regions.put([u, *sorted(sources[own] - {u})], own, -1)
    for r, taken in sources.items():
        if r != own:
            regions.put(sorted(taken), r, to)
    regions.core[to] = u
    for r, core in cores.items():
        regions.core[r] = core


def _around(regions, u, rng):
    """Areas around one that are large enough together, the cheapest first, but for some chance."""
    p, part, total = regions.problem, {u}, regions.problem.size[u]
    heap, seen, last = [], {u}, u
    while total < regions.theta[u]:
        fresh = [v for v in regions.adjacent[last] if v not in seen and not regions.frozen[v]]
        if fresh:
            seen.update(fresh)
            areas = np.array(fresh)
            gain = each_share(p, areas, np.full(len(areas), u))
            gain -= each_share(p, areas, regions.core[regions.region[areas]])
            for cost, v in zip((gain / np.maximum(p.size[areas], 1e-300)).tolist(), fresh):
                heapq.heappush(heap, (cost, v))
        if not heap or len(part) >= LARGEST_GROUP:
            return None
        first = heapq.heappop(heap)
        if heap and rng.random() < 0.25:
            first = heapq.heapreplace(heap, first)
        last = first[1]
        part.add(last)
        total += p.size[last]
    return part


def _new_boundary(regions, part, u):
    """What a new region with core u adds to the boundary."""
    p, labels, change = regions.problem, regions.labels, 0.0
    kept = p.cls[regions.core] if regions.by_class else np.arange(len(regions.core))
    own = int(p.cls[u]) if regions.by_class else -1
    for v in part:
        mine = int(kept[labels[v]])
        for x, length in regions.length_of[v].items():
            other = int(kept[labels[x]])
            if x in part:
                change -= 0.5 * length * (mine != other)
            else:
                change += length * (int(own != other) - int(mine != other))
    return change
