"""Region growing: the smallest area below its threshold joins the neighbour that costs least."""

from __future__ import annotations

import heapq

import numpy as np

from .instance import best_core, components, connected_parts, enough, shares, solution

__all__ = ["adjacency", "best_split", "greedy", "helpless", "reach_count"]


def helpless(problem):
    """Return the areas that no region can help: (n,) bool.

    They belong to components (islands, for one) too small for any of their own classes.
    """
    component = components(problem)
    count = component.max(initial=-1) + 1
    total = np.bincount(component, weights=problem.size, minlength=count)
    least = np.full(count, np.inf)
    np.minimum.at(least, component, problem.theta[problem.cls])
    return ~enough(total, least)[component]


def adjacency(problem):
    """Return for each area a list of its neighbours."""
    start, neighbour = problem.start.tolist(), problem.neighbour.tolist()
    return [neighbour[lo:hi] for lo, hi in zip(start[:-1], start[1:])]


def greedy(problem, check=None):
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
    O(n log n) merges; each looks at the neighbours of the smaller region.
    """
    n = len(problem.size)
    lost = helpless(problem)
    label = np.arange(n)
    if lost.any():
        parts = components(problem, problem.cls)
        label[lost] = n + parts[lost]
    theta = problem.theta[problem.cls].tolist()
    size = problem.size.tolist()
    members = [[v] for v in range(n)]
    core = list(range(n))
    start, neighbour, length = (
        problem.start.tolist(), problem.neighbour.tolist(), problem.length.tolist()
    )
    beside = [
        dict(zip(neighbour[lo:hi], length[lo:hi])) for lo, hi in zip(start[:-1], start[1:])
    ]
    alive = ~lost
    heap = [(size[v], v) for v in np.flatnonzero(alive).tolist() if not enough(size[v], theta[v])]
    heapq.heapify(heap)
    whole = len(heap) or 1
    steps = 0
    while heap:
        weight, r = heapq.heappop(heap)
        if not alive[r] or weight != size[r] or enough(size[r], theta[core[r]]) or not beside[r]:
            continue
        steps += 1
        if check is not None and steps % 256 == 0:
            check(min(1.0, steps / whole))
        s = _cheapest(problem, members[r], core, beside, r)
        core[s] = _core_of_both(problem, members, core, r, s, size[r] + size[s])
        if len(members[r]) > len(members[s]):
            members[r], members[s] = members[s], members[r]
        members[s] += members[r]
        members[r] = []
        size[s] += size[r]
        alive[r] = False
        del beside[s][r]
        for t, shared in beside[r].items():
            if t != s:
                del beside[t][r]
                beside[t][s] = beside[s][t] = beside[s].get(t, 0.0) + shared
        beside[r] = {}
        if not enough(size[s], theta[core[s]]):
            heapq.heappush(heap, (size[s], s))
    for r in np.flatnonzero(alive).tolist():
        label[members[r]] = r
    return solution(problem, label)


def _cheapest(problem, areas, core, beside, r):
    """The neighbouring region that r joins at least cost."""
    around = list(beside[r])
    cores = np.array([core[s] for s in around])
    cost = shares(problem, np.array(areas), cores).sum(axis=0)
    saved = np.array(list(beside[r].values()))
    kept = problem.cls[cores]
    if problem.by_class:
        # joining s removes the boundary to all neighbours of its class
        by_class = np.bincount(kept, weights=saved, minlength=len(problem.theta))
        saved = by_class[kept]
    cost -= problem.boundary * saved
    # an excluded class is the last resort: its own turn to join comes later
    cost[np.isinf(problem.theta[kept])] += np.abs(cost).sum()
    return around[int(np.lexsort((around, cost))[0])]


def _core_of_both(problem, members, core, r, s, size):
    """The cheaper of two cores for two regions that join; large enough goes first."""
    both = np.array(sorted((core[r], core[s])))
    theta = problem.theta[problem.cls[both]]
    rank = np.where(enough(size, theta), 0, np.where(np.isfinite(theta), 1, 2))
    if rank[0] != rank[1]:
        return int(both[np.argmin(rank)])
    cost = shares(problem, np.array(members[r] + members[s]), both).sum(axis=0)
    return int(both[np.argmin(cost)])


def reach_count(problem, found, count, check=None):
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
    """
    region = found.region.copy()
    adjacent = adjacency(problem)
    groups = {r: np.flatnonzero(region == r) for r in range(len(found.core))}
    core = dict(enumerate(found.core.tolist()))
    lost = helpless(problem)
    following = len(core)
    heap = []

    def cost_of(r):
        return float(shares(problem, groups[r], np.array([core[r]])).sum())

    def kept_of(v):
        return problem.cls[core[int(region[v])]]

    def offer(r):
        if lost[core[r]]:
            return
        if len(core) < count:
            split = best_split(problem, adjacent, groups[r], core[r], kept_of)
            if split is not None:
                heapq.heappush(heap, (split[0], r, len(groups[r]), -1, 0, split[1], split[2]))
            return
        around = {}
        for v in groups[r].tolist():
            for slot in range(problem.start[v], problem.start[v + 1]):
                s = int(region[problem.neighbour[slot]])
                if s != r:
                    around[s] = around.get(s, 0.0) + problem.length[slot]
        for s, shared in around.items():
            both = np.concatenate((groups[r], groups[s]))
            kept = best_core(problem, both)
            cost = float(shares(problem, both, np.array([kept])).sum()) - cost_of(r) - cost_of(s)
            if not problem.by_class or problem.cls[core[r]] != problem.cls[core[s]]:
                cost -= problem.boundary * shared
            heapq.heappush(heap, (cost, r, len(groups[r]), s, len(groups[s]), both.tolist(), kept))

    splitting = len(core) < count
    for r in list(core):
        offer(r)
    while heap and (len(core) < count if splitting else len(core) > count):
        if check is not None:
            check(None)
        _, r, size_r, s, size_s, areas, kept = heapq.heappop(heap)
        if r not in core or len(groups[r]) != size_r:
            continue
        if s >= 0 and (s not in core or len(groups[s]) != size_s):
            continue
        if splitting:
            fresh, following = following, following + 1
            groups[fresh] = np.array(areas)
            groups[r] = np.setdiff1d(groups[r], groups[fresh])
            core[fresh] = kept
            region[groups[fresh]] = fresh
            core[r] = best_core(problem, groups[r])
            core[fresh] = best_core(problem, groups[fresh])
            offer(fresh)
        else:
            groups[r] = np.array(areas)
            region[groups[r]] = r
            del core[s], groups[s]
            core[r] = kept
        offer(r)
    return solution(problem, region)


def best_split(problem, adjacent, members, core, kept, most=24):
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
