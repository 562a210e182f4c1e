"""Region growing: the smallest area below its threshold joins the neighbour that costs least."""

from __future__ import annotations

import heapq
import math
from math import hypot, sqrt
from typing import Callable

import numpy as np

from .instance import (
    Instance,
    Solution,
    best_core,
    components,
    connected_parts,
    each_share,
    enough,
    enough_from,
    shares,
    solution,
)

__all__ = ["adjacency", "best_split", "greedy", "helpless", "reach_count"]

FEW = 24  # areas from which arrays are quicker than a loop
NEARLY = 1.0 + 1e-9


def helpless(problem: Instance) -> np.ndarray:
    """Return the areas that no region can help: (n,) bool.

    They belong to components (islands, for one) too small for any of their own classes.

    Examples
    --------
    Two areas side by side are together as large as wanted, 4; the third is an island of size 1.

    >>> from isthmus.core.aggregation.instance import build
    >>> problem = build([3, 1, 1], [0, 0, 0], range(3), [[0, 1]], [1.0], np.zeros((1, 1)), [4.0])
    >>> helpless(problem).tolist()
    [False, False, True]
    """
    component = components(problem)
    count = component.max(initial=-1) + 1
    total = np.bincount(component, weights=problem.size, minlength=count)
    least = np.full(count, np.inf)
    np.minimum.at(least, component, problem.theta[problem.cls])
    return np.logical_not(enough(total, least))[component]


def adjacency(problem: Instance) -> list[list[int]]:
    """Return for each area a list of its neighbours.

    Examples
    --------
    Four areas in a row.

    >>> from isthmus.core.aggregation.instance import build
    >>> row = [[0, 1], [1, 2], [2, 3]]
    >>> problem = build([3, 1, 1, 3], [0, 0, 0, 1], range(4), row, np.ones(3), 1 - np.eye(2), [4.0, 4.0])
    >>> adjacency(problem)
    [[1], [0, 2], [1, 3], [2]]
    """
    start, neighbour = problem.start.tolist(), problem.neighbour.tolist()
    return [neighbour[lo:hi] for lo, hi in zip(start[:-1], start[1:])]


def greedy(problem: Instance, check: Callable | None = None) -> Solution:
    """Aggregate by region growing.

    Parameters
    ----------
    problem : Instance
    check : callable, optional
        Called now and then with the share done; may raise to stop.

    Returns
    -------
    Solution
        Always large enough and contiguous; `helpless` areas only join neighbours of their class.

    Notes
    -----
    O(n log n) merges; each looks at the areas of the smaller region, for each of its neighbours.

    Examples
    --------
    Four areas in a row, the last one of another class; a region needs a size of 2. Only the small ones
    are too small, and they join a region of their class.

    >>> from isthmus.core.aggregation.instance import build
    >>> row = [[0, 1], [1, 2], [2, 3]]
    >>> problem = build([3, 1, 1, 3], [0, 0, 0, 1], range(4), row, np.ones(3), 1 - np.eye(2), [2.0, 2.0])
    >>> found = greedy(problem)
    >>> found.region.tolist(), found.core.tolist()
    ([0, 0, 0, 1], [0, 3])
    """
    n = len(problem.size)
    lost = helpless(problem)
    label = np.arange(n)
    if lost.any():
        parts = components(problem, problem.cls)
        label[lost] = n + parts[lost]
    grown = _Growing(problem)
    size, least, core = grown.size, grown.least, grown.core
    alive = (~lost).tolist()
    # single areas wait in a sorted list, and only regions that grew in a heap: it stays small
    single = sorted([(size[v], v) for v in range(n) if alive[v] and size[v] < least[v]], reverse=True)
    heap: list[tuple[float, int]] = []
    whole, steps = len(single) or 1, 0
    while single or heap:
        if not heap or (single and single[-1] < heap[0]):
            weight, r = single.pop()
        else:
            weight, r = heapq.heappop(heap)
        if not alive[r] or weight != size[r] or weight >= least[core[r]] or not grown.beside[r]:
            continue
        steps += 1
        if check is not None and steps % 256 == 0:
            check(min(1.0, steps / whole))
        s, share = grown.cheapest(r)
        grown.join(r, s, share)
        alive[r] = False
        if size[s] < least[core[s]]:
            heapq.heappush(heap, (size[s], s))
    for r in range(n):
        if alive[r]:
            label[grown.members[r]] = r
    return solution(problem, label)


class _Growing:
    """Regions that only grow, in plain lists: most are so small that arrays would cost more.

    ``cost`` is what the areas of a region cost under its core, ``moment`` the sum of their size times
    place, ``width`` that of their size times the root of their spread, ``by_class`` their size by class,
    ``beside`` the boundary to each neighbouring region.
    """

    def __init__(self, problem):
        self.problem = problem
        n = len(problem.size)
        self.size, self.place = problem.size.tolist(), problem.place.tolist()
        self.spread, self.cls = problem.spread.tolist(), problem.cls.tolist()
        self.area = problem.size.tolist()
        self.to = (problem.change * problem.distance).T.tolist()  # the price of a class, by the other one
        self.least = enough_from(problem.theta)[problem.cls].tolist()
        self.excludes = bool(np.isinf(problem.theta[problem.cls[problem.neighbour]]).any())
        self.core = list(range(n))
        self.members = [[v] for v in range(n)]
        self.cost = each_share(problem, np.arange(n), np.arange(n)).tolist()
        self.moment = (problem.size * problem.place).tolist()
        self.width = (problem.size * np.sqrt(problem.spread)).tolist()
        self.by_class = [{c: w} for c, w in zip(self.cls, self.size)]
        start = problem.start.tolist()
        neighbour, length = problem.neighbour.tolist(), problem.length.tolist()
        self.beside = [dict(zip(neighbour[lo:hi], length[lo:hi])) for lo, hi in zip(start[:-1], start[1:])]

    def shares(self, areas, core):
        """What areas cost under a core."""
        if len(areas) > FEW:
            return float(shares(self.problem, np.array(areas), np.array([core])).sum())
        centre, there, price = self.problem.centre, self.place[core], self.to[self.cls[core]]
        area, cls, place, spread = self.area, self.cls, self.place, self.spread
        total = 0.0
        for v in areas:
            away = abs(place[v] - there)
            total += area[v] * (price[cls[v]] + centre * sqrt(away * away + spread[v]))
        return total

    def cheapest(self, r):
        """The neighbouring region that r joins at least cost, and what the areas of r cost there."""
        around, areas, core = self.beside[r], self.members[r], self.core
        if len(around) == 1:  # as an area in another one: nearly half of them
            (s,) = around
            return s, self.shares(areas, core[s])
        boundary, saved = self.problem.boundary, around
        if self.problem.by_class:  # joining s removes the boundary to all neighbours of its class
            lengths = {}
            for s, length in around.items():
                kept = self.cls[core[s]]
                lengths[kept] = lengths.get(kept, 0.0) + length
            saved = {s: lengths[self.cls[core[s]]] for s in around}
        there = {s: self.shares(areas, core[s]) for s in around}
        costs = [(share - boundary * saved[s], s) for s, share in there.items()]
        if self.excludes:  # an excluded class is the last resort: its own turn to join comes later
            excluded = [self.least[core[s]] == math.inf for s in around]
            more = sum(abs(cost) for cost, _ in costs)
            costs = [(cost + more * last, s) for (cost, s), last in zip(costs, excluded)]
        s = min(costs)[1]
        return s, there[s]

    def join(self, r, s, share):
        """Region r becomes a part of s, where it costs a share; the core is the cheaper of both, if that
        is large enough.
        """
        self._choose_core(r, s, share)
        members, by_class, beside = self.members, self.by_class[s], self.beside
        if len(members[r]) > len(members[s]):
            members[r], members[s] = members[s], members[r]
        members[s] += members[r]
        members[r] = []
        self.size[s] += self.size[r]
        self.moment[s] += self.moment[r]
        self.width[s] += self.width[r]
        for kept, size in self.by_class[r].items():
            by_class[kept] = by_class.get(kept, 0.0) + size
        around, others = beside[s], beside[r]
        del around[r], others[s]
        for t, shared in others.items():
            its = beside[t]
            del its[r]
            its[s] = around[t] = around.get(t, 0.0) + shared
        beside[r] = {}

    def _rank(self, size, core):
        """0: large enough for the class of a core, 1: too small, 2: the class is excluded."""
        least = self.least[core]
        return 0 if size >= least else 1 if least < math.inf else 2

    def _choose_core(self, r, s, share):
        total = self.size[r] + self.size[s]
        u, v = self.core[r], self.core[s]
        ranks = [self._rank(total, u), self._rank(total, v)]
        stays = self.cost[s] + share
        if ranks[0] > ranks[1]:
            self.cost[s] = stays
            return
        if ranks[0] == ranks[1]:
            # no areas are nearer to a place than all of them would be in their centroid, each as wide as
            # it is; what is as near as rounding must be measured
            away = abs(self.moment[s] - self.size[s] * self.place[u])
            least = self.cost[r] + self.problem.centre * hypot(away, self.width[s])
            if least <= NEARLY * stays:
                price = self.to[self.cls[u]]
                least += sum([size * price[kept] for kept, size in self.by_class[s].items()])
            if least > NEARLY * stays:
                self.cost[s] = stays
                return
        goes = self.cost[r] + self.shares(self.members[s], u)
        if ranks[0] < ranks[1] or (goes, u) < (stays, v):
            self.core[s], self.cost[s] = u, goes
        else:
            self.cost[s] = stays


def reach_count(problem: Instance, found: Solution, count: int, check: Callable | None = None) -> Solution:
    """Merge or split regions at least cost until there are as many as wanted.

    Parameters
    ----------
    found : Solution
        Feasible.
    count : int

    Returns
    -------
    Solution
        With a number of regions as near to ``count`` as single merges and splits lead.

    Examples
    --------
    Three regions in a row of four areas. With one less, the areas of one class are together; with one more,
    each is alone.

    >>> from isthmus.core.aggregation.instance import build
    >>> row = [[0, 1], [1, 2], [2, 3]]
    >>> problem = build([3, 1, 1, 3], [0, 0, 0, 1], range(4), row, np.ones(3), 1 - np.eye(2), [1.0, 1.0])
    >>> found = Solution(np.array([0, 1, 1, 2]), np.array([0, 1, 3]))
    >>> reach_count(problem, found, 2).region.tolist()
    [0, 0, 0, 1]
    >>> reach_count(problem, found, 4).region.tolist()
    [0, 1, 2, 3]
    """
    counted = _Counted(problem, found, len(found.core) < count)
    counted.offer_all()
    while counted.heap and counted.number != count:
        if check is not None:
            check(None)
        counted.take()
    return solution(problem, counted.region)


class _Counted:
    """Regions that are split, or merged, one after the other, the cheapest first.

    ``heap`` has what is on offer: the price, the region and the number of its areas, the same of the
    one it merges with (-1: it is split), the areas of the new region and its core.
    """

    def __init__(self, problem, found, splitting):
        self.problem, self.splitting = problem, splitting
        self.adjacent, self.lost = adjacency(problem), helpless(problem)
        self.region, self.heap = found.region.copy(), []
        self.groups = {r: np.flatnonzero(self.region == r) for r in range(len(found.core))}
        self.core = dict(enumerate(found.core.tolist()))
        self.following = len(self.core)

    @property
    def number(self):
        """How many regions there are."""
        return len(self.core)

    def offer_all(self):
        for r in list(self.core):
            self.offer(r)

    def offer(self, r):
        """Offer what can be done with a region."""
        if self.lost[self.core[r]]:
            return
        if self.splitting:
            self._offer_split(r)
        else:
            self._offer_merges(r)

    def _kept(self, v):
        return self.problem.cls[self.core[int(self.region[v])]]

    def _cost(self, areas, core):
        return float(shares(self.problem, areas, np.array([core])).sum())

    def _offer_split(self, r):
        areas = self.groups[r]
        found = best_split(self.problem, self.adjacent, areas, self.core[r], self._kept)
        if found is not None:
            heapq.heappush(self.heap, (found[0], r, len(areas), -1, 0, found[1], found[2]))

    def _offer_merges(self, r):
        p, groups, core, around = self.problem, self.groups, self.core, {}
        for v in groups[r].tolist():
            for slot in range(p.start[v], p.start[v + 1]):
                s = int(self.region[p.neighbour[slot]])
                if s != r:
                    around[s] = around.get(s, 0.0) + p.length[slot]
        for s, shared in around.items():
            both = np.concatenate((groups[r], groups[s]))
            kept = best_core(p, both)
            cost = self._cost(both, kept) - self._cost(groups[r], core[r])
            cost -= self._cost(groups[s], core[s])
            if not p.by_class or p.cls[core[r]] != p.cls[core[s]]:
                cost -= p.boundary * shared
            heapq.heappush(self.heap, (cost, r, len(groups[r]), s, len(groups[s]), both.tolist(), kept))

    def take(self):
        """Do the cheapest that is on offer, unless its regions have changed since."""
        _, r, size_r, s, size_s, areas, kept = heapq.heappop(self.heap)
        groups, core = self.groups, self.core
        if r not in core or len(groups[r]) != size_r:
            return
        if s >= 0 and (s not in core or len(groups[s]) != size_s):
            return
        if self.splitting:
            fresh, self.following = self.following, self.following + 1
            groups[fresh] = np.array(areas)
            groups[r] = np.setdiff1d(groups[r], groups[fresh])
            self.region[groups[fresh]] = fresh
            core[r] = best_core(self.problem, groups[r])
            core[fresh] = best_core(self.problem, groups[fresh])
            self.offer(fresh)
        else:
            groups[r] = np.array(areas)
            self.region[groups[r]] = r
            del core[s], groups[s]
            core[r] = kept
        self.offer(r)


def best_split(
    problem: Instance,
    adjacent: list[list[int]],
    members: np.ndarray,
    core: int,
    kept: Callable,
    most: int = 24,
) -> tuple[float, list[int], int] | None:
    """Return the cheapest way to split a region in two that are both large enough.

    Parameters
    ----------
    members : (m,) int
    core : int
        The one keeps this core.
    kept : callable
        Class of the region of an area: asked where only boundaries between classes count.
    most : int
        How many areas, the largest first, are tried as the core of the other.

    Returns
    -------
    (cost, areas, core) or None
        What the split adds to the cost, the areas of the other region and its core.

    Examples
    --------
    Four areas in a row, all in the region of the first; the last one is of another class. A split gives it
    its own class back, which cost 3.

    >>> from isthmus.core.aggregation.instance import build
    >>> row = [[0, 1], [1, 2], [2, 3]]
    >>> problem = build([3, 1, 1, 3], [0, 0, 0, 1], range(4), row, np.ones(3), 1 - np.eye(2), [2.0, 2.0])
    >>> cost, areas, core = best_split(problem, adjacency(problem), np.arange(4), 0, lambda area: 0)
    >>> float(cost), areas, core
    (-3.0, [3], 3)
    """
    size = problem.size
    theta = problem.theta[problem.cls]
    members = np.asarray(members)
    total = size[members].sum()
    seeds = members[(members != core) & (theta[members] <= total - theta[core])]
    seeds = seeds[np.argsort(-size[seeds], kind="stable")][:most]
    best = None
    inside = set(members.tolist())
    for u in seeds.tolist():
        gain = np.diff(shares(problem, members, np.array([core, u])), axis=1)[:, 0]
        gain_of = dict(zip(members.tolist(), gain.tolist()))
        part = _grow(adjacent, inside, gain_of, size, u, core, theta[u])
        if part is None:
            continue
        rest = inside - part
        pieces = connected_parts(adjacent, rest)
        if len(pieces) > 1:  # what the core cannot reach goes with the other
            rest = set(next(piece for piece in pieces if core in piece))
            part = inside - rest
        if sum(size[v] for v in rest) < theta[core]:
            continue
        cost = sum(gain_of[v] for v in part)
        cost += problem.boundary * _split_boundary(problem, part, rest, u, core, kept)
        if best is None or cost < best[0]:
            best = (float(cost), sorted(part), u)
    return best


def _split_boundary(problem, part, rest, u, core, kept):
    """Length of boundary that a part adds when it leaves a region and gets the core u."""
    own, old, added = problem.cls[u], problem.cls[core], 0.0
    for v in part if not problem.by_class or own != old else ():
        for slot in range(problem.start[v], problem.start[v + 1]):
            x, length = int(problem.neighbour[slot]), float(problem.length[slot])
            if x in rest:
                added += length
            elif problem.by_class and x not in part:
                added += length * (int(kept(x) != own) - int(kept(x) != old))
    return added


def _grow(adjacent, inside, gain, size, u, core, theta):
    """Areas that prefer u, or are needed to make its region large enough, grown from u."""
    part, total = {u}, size[u]
    heap = [(gain[v], v) for v in adjacent[u] if v in inside and v != core]
    heapq.heapify(heap)
    while heap:
        cost, v = heapq.heappop(heap)
        if v in part:
            continue
        if cost >= 0.0 and total >= theta:
            break
        part.add(v)
        total += size[v]
        for x in adjacent[v]:
            if x in inside and x not in part and x != core:
                heapq.heappush(heap, (gain[x], x))
    return part if total >= theta else None
