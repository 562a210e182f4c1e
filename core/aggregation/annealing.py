"""Simulated annealing: areas change their region, regions merge and split, while it gets colder.

Many moves are drawn and priced at once, in arrays; the few that the Metropolis rule accepts are
applied one after the other, each after a test that its old region stays contiguous. A move whose
region another move of the same batch has touched is left for a later batch, so that every price is
the true one. Regions may become too small at a price that rises while it gets colder; what is too
small in the end is repaired, and a descent with hard thresholds follows.
"""

from __future__ import annotations

import math
from time import perf_counter
from typing import NamedTuple

import numpy as np

from .greedy import adjacency, best_split, greedy, helpless, reach_count
from .instance import (
    best_core, connected_parts, costs, enough, problems, shares, solution,
)

__all__ = ["Schedule", "annealing"]

LARGEST_GROUP = 40  # areas that follow one that would cut them off
LARGEST_EXACT = 400  # areas of a region for which every core is tried
SMALL, RUNS_OF_SMALL = 100, 4  # areas of a small map, and into how many runs its effort is cut
HARD = 1e6  # price of a missing square metre when none may be missing
EXCLUDED = 1e30  # least to stand for an infinite threshold: finite, so that differences are numbers


class Schedule(NamedTuple):
    """How it gets colder, from the first to the last step, by constant factors.

    Attributes
    ----------
    hot, cold : float
        First and last temperature, as multiples of a typical price of a move.
    soft, hard : float
        First and last price of a missing square metre.
    """

    hot: float = 1.0
    cold: float = 0.03
    soft: float = 0.04
    hard: float = 30.0


def annealing(
    problem, seed=0, iterations=None, seconds=None, count=None, check=None, begin=None,
    schedule=Schedule(),
):
    """Aggregate by simulated annealing from the greedy result.

    Parameters
    ----------
    problem : Instance
    seed : int
        The same seed and the same number of iterations give the same result.
    iterations : int, optional
        Number of moves that are priced. Default: 10,000 an area.
    seconds : float, optional
        Use this much time instead of a number of iterations.
    count : int, optional
        Number of regions wanted; default: free.
    check : callable, optional
        Called now and then with the share done; may raise to stop.
    begin : Solution, optional
        Feasible, to start from instead of the greedy one.
    schedule : Schedule, optional

    Returns
    -------
    Solution
        Feasible. Not more expensive than the one it started from, unless that is farther from the
        number of regions wanted.

    Notes
    -----
    A batch of m moves is O(m) in arrays, and O(1) in Python for each move that is accepted.
    """
    start = greedy(problem) if begin is None else begin
    if count is not None:
        start = reach_count(problem, start, count, check and (lambda _: check(0.0)))
    if iterations is None:
        iterations = 10_000 * len(problem.size)
    lost = helpless(problem)
    if lost.all():
        return start
    check = check or (lambda share: None)
    results = [start]
    # a small map has few ways out of a bad start, and time for several
    runs = RUNS_OF_SMALL if len(problem.size) <= SMALL else 1
    for run in range(runs):
        state = _State(problem, start, [seed, run], count)
        if not len(state.movable):
            return start

        def report(share, run=run):
            check((run + share) / runs)

        state.cool(iterations / runs, seconds and seconds / runs, schedule, report)
        found = state.settle(report)
        if count is not None and len(found.core) != count:
            found = reach_count(problem, found, count)
            found = _State(problem, found, seed, count).settle(report)
        results.append(found)

    def rank(one):
        away = 0 if count is None else abs(len(one.core) - count)
        faults = sum(not lost[one.core[r]] for r, _ in problems(problem, one))
        return faults, away, costs(problem, one).total

    return min(results, key=rank)


class _State:
    """Regions while they change: lists for single moves, arrays for the prices of many."""

    def __init__(self, problem, begin, seed, count):
        self.problem = problem
        n = len(problem.size)
        self.rng = np.random.Generator(np.random.PCG64(seed))
        self.count = count
        self.adjacent = adjacency(problem)
        self.degree = np.diff(problem.start)
        self.owner = problem.owner
        self.frozen = helpless(problem)
        self.movable = np.flatnonzero(~self.frozen & (self.degree > 0))
        slots = n  # numbers of regions, most of them unused
        self.region = begin.region.astype(np.int64).copy()
        self.labels = self.region.tolist()
        used = len(begin.core)
        self.core = np.zeros(slots, dtype=np.int64)
        self.core[:used] = begin.core
        self.size = np.bincount(self.region, weights=problem.size, minlength=slots)
        self.number = np.bincount(self.region, minlength=slots)
        self.members = [set() for _ in range(slots)]
        for v, r in enumerate(self.labels):
            self.members[r].add(v)
        self.free = list(range(slots - 1, used - 1, -1))
        self.regions = used
        excluded = max(EXCLUDED, 1e6 * float(problem.size.sum()))
        self.theta = np.minimum(problem.theta, excluded)[problem.cls]
        self.by_class = problem.by_class and problem.boundary > 0.0
        self.bonus = 0.0  # price of one more region, to steer towards the number wanted
        self.stamp = np.zeros(slots, dtype=np.int64)
        self.batch = 0
        self.dirty = set()
        length, start = problem.length.tolist(), problem.start.tolist()
        self.length_of = [
            dict(zip(self.adjacent[v], length[start[v]:start[v + 1]])) for v in range(n)
        ]
        self.priced = self.applied = 0

    # ---- prices

    def share(self, areas, cores):
        """Price of each area under the core beside it, elementwise."""
        p = self.problem
        cost = p.change * p.distance[p.cls[areas], p.cls[cores]]
        if p.centre:
            cost = cost + p.centre * np.abs(p.place[areas] - p.place[cores])
        return cost * p.size[areas]

    def lack(self, size, theta):
        """Missing square metres."""
        return np.maximum(theta - size, 0.0)

    def price(self, v, to, price_of_lack):
        """Prices of single moves: area v[i] to region to[i], or to a new one if that is -1.

        Returns
        -------
        (m,) float
            Infinite for a move of the core of a region with other areas.
        """
        p = self.problem
        old = self.region[v]
        fresh = to < 0
        core_old = self.core[old]
        core_new = np.where(fresh, v, self.core[to])
        # boundary to both regions
        degree = self.degree[v]
        ends = np.cumsum(degree)
        row = np.repeat(np.arange(len(v)), degree)
        slot = np.arange(degree.sum()) + np.repeat(p.start[v] - ends + degree, degree)
        other = self.region[p.neighbour[slot]]
        length = p.length[slot]
        if self.by_class:
            kept = p.cls[self.core[other]]
            to_old = np.bincount(row, length * (kept == p.cls[core_old][row]), len(v))
            to_new = np.bincount(row, length * (kept == p.cls[core_new][row]), len(v))
        else:
            to_old = np.bincount(row, length * (other == old[row]), len(v))
            to_new = np.bincount(row, length * (other == to[row]), len(v))
        delta = p.boundary * (to_old - to_new)
        delta += self.share(v, core_new) - self.share(v, core_old)
        size = p.size[v]
        theta_old, theta_new = self.theta[core_old], self.theta[core_new]
        size_old = self.size[old]
        size_new = np.where(fresh, 0.0, self.size[to])
        alone = self.number[old] == 1
        lack = np.where(alone, 0.0, self.lack(size_old - size, theta_old))
        lack -= self.lack(size_old, theta_old)
        lack += self.lack(size_new + size, theta_new)
        lack -= np.where(fresh, 0.0, self.lack(size_new, theta_new))
        delta += price_of_lack * lack
        delta += self.bonus * (fresh.astype(float) - alone)
        delta[(core_old == v) & ~alone] = np.inf
        return delta

    def group_price(self, group, r, to, price_of_lack):
        """Price of moving a connected group of areas (without the core) from r to a region."""
        p = self.problem
        areas = np.array(sorted(group))
        pair = shares(p, areas, np.array([self.core[r], self.core[to]])).sum(axis=0)
        delta = float(pair[1] - pair[0])
        if p.boundary:
            cls_old, cls_new = p.cls[self.core[r]], p.cls[self.core[to]]
            change = 0.0
            for v in areas.tolist():
                for u, length in self.length_of[v].items():
                    if u in group:
                        continue
                    s = self.labels[u]
                    if self.by_class:
                        kept = p.cls[self.core[s]]
                        change += length * (int(kept == cls_old) - int(kept == cls_new))
                    else:
                        change += length * ((s == r) - (s == to))
            delta += p.boundary * change
        size = float(p.size[areas].sum())
        old, new = self.theta[self.core[r]], self.theta[self.core[to]]
        return delta + price_of_lack * float(
            self.lack(self.size[r] - size, old) - self.lack(self.size[r], old)
            + self.lack(self.size[to] + size, new) - self.lack(self.size[to], new)
        )

    # ---- changes

    def put(self, areas, r, to):
        """Move areas from region r to another one, or a new one if ``to`` is -1; return it."""
        if to < 0:
            to = self.free.pop()
            self.core[to] = areas[0]
            self.size[to] = 0.0
            self.regions += 1
        size = 0.0
        for v in areas:
            self.labels[v] = to
            self.region[v] = to
            size += float(self.problem.size[v])
        self.members[r].difference_update(areas)
        self.members[to].update(areas)
        left = len(self.members[r])
        self.number[r] = left
        self.number[to] = len(self.members[to])
        self.size[to] += size
        self.size[r] -= size
        self.stamp[r] = self.stamp[to] = self.batch
        self.dirty.add(to)
        if left:
            self.dirty.add(r)
        else:
            self.size[r] = 0.0
            self.free.append(r)
            self.regions -= 1
            self.dirty.discard(r)
        self.applied += 1
        return to

    def cut_off(self, v, r):
        """Areas of region r that only v connects to its core; None if they are many."""
        members, labels = self.members[r], self.labels
        near = [u for u in self.adjacent[v] if labels[u] == r]
        if len(near) < 2:
            return ()
        # cheap test first: neighbours that touch one another in a chain
        reached, stack, left = {near[0], v}, [near[0]], set(near[1:])
        while stack and left:
            for u in self.adjacent[stack.pop()]:
                if labels[u] == r and u not in reached:
                    reached.add(u)
                    left.discard(u)
                    stack.append(u)
        if not left:
            return ()
        core = int(self.core[r])
        rest = members - reached
        rest.discard(v)
        reached.discard(v)
        lost = rest if core in reached else reached
        if core not in reached:
            # the core may be in one of several other parts
            keep = next(part for part in connected_parts(self.adjacent, rest) if core in part)
            lost = (reached | rest) - set(keep)
        return lost if len(lost) <= LARGEST_GROUP else None

    def apply(self, v, to, temperature, price_of_lack):
        """Apply a single move if its regions are untouched and stay contiguous."""
        r = self.labels[v]
        if self.stamp[r] == self.batch or (to >= 0 and self.stamp[to] == self.batch):
            return False
        if self.by_class and any(
            self.stamp[self.labels[u]] == self.batch for u in self.adjacent[v]
        ):
            return False
        if len(self.members[r]) > 1:
            lost = self.cut_off(v, r)
            if lost is None:
                return False
            if lost:
                if to < 0:
                    return False
                group = set(lost)
                group.add(v)
                delta = self.group_price(group, r, to, price_of_lack)
                if not delta < -temperature * math.log(self.rng.random() + 1e-300):
                    return False
                self.put(sorted(group), r, to)
                return True
        self.put([v], r, to)
        return True

    def recore(self, price_of_lack):
        """Give the regions that changed their best cores, all at once; return who got one."""
        p, changed = self.problem, sorted(self.dirty)
        self.dirty.clear()
        for r in [r for r in changed if len(self.members[r]) > LARGEST_EXACT]:
            members = np.array(sorted(self.members[r]))
            near = np.argsort(np.abs(p.place[members] - p.place[self.core[r]]), kind="stable")
            choice = np.append(self.core[r], members[near[:32]])
            cost = shares(p, members, choice).sum(axis=0)
            cost += price_of_lack * self.lack(self.size[r], self.theta[choice])
            if not self.by_class:
                self.core[r] = choice[np.argmin(cost)]
        lists = [sorted(self.members[r]) for r in changed if len(self.members[r]) <= LARGEST_EXACT]
        changed = np.array([self.labels[one[0]] for one in lists], dtype=np.int64)
        if not len(changed):
            return []
        count = np.array([len(one) for one in lists])
        members = np.array([v for one in lists for v in one])
        first = np.cumsum(count) - count
        group = np.repeat(np.arange(len(count)), count)
        # all pairs of areas of one region
        row = np.repeat(np.arange(len(members)), count[group])
        ends = np.cumsum(count[group])
        column = np.arange(ends[-1]) - np.repeat(ends - count[group] - first[group], count[group])
        cost = np.bincount(column, self.share(members[row], members[column]), len(members))
        cost += price_of_lack * self.lack(self.size[changed][group], self.theta[members])
        if self.by_class:
            cost -= p.boundary * self._class_lengths(members, group, changed)
        now = np.flatnonzero(members == self.core[changed][group])
        least = np.minimum.reduceat(cost, first)
        better = np.flatnonzero(least < cost[now] - 1e-9 * np.abs(cost[now]))
        touched, got = set(), []
        for k in better.tolist():
            best = members[first[k] + int(np.argmin(cost[first[k]:first[k] + count[k]]))]
            r = int(changed[k])
            if self.by_class and p.cls[best] != p.cls[self.core[r]]:
                around = {self.labels[u] for v in lists[k] for u in self.adjacent[v]}
                if around & touched:  # its price is no longer true
                    self.dirty.add(r)
                    continue
                touched.add(r)
            self.core[r] = best
            got.append(r)
        return got

    def _class_lengths(self, members, group, changed):
        """Boundary of each member's region to regions of the member's class."""
        p, classes = self.problem, len(self.problem.theta)
        degree = self.degree[members]
        ends = np.cumsum(degree)
        slot = np.arange(ends[-1]) + np.repeat(p.start[members] - ends + degree, degree)
        other = self.region[p.neighbour[slot]]
        own = np.repeat(group, degree)
        out = other != changed[own]
        table = np.bincount(
            own[out] * classes + p.cls[self.core[other[out]]], p.length[slot[out]],
            len(changed) * classes,
        )
        return table[group * classes + p.cls[members]]

    def merge(self, temperature, price_of_lack):
        """Propose to merge two neighbouring regions."""
        v = int(self.movable[self.rng.integers(len(self.movable))])
        r = self.labels[v]
        near = [s for s in (self.labels[u] for u in self.adjacent[v]) if s != r]
        if not near or len(self.members[r]) > LARGEST_EXACT:
            return
        to = near[self.rng.integers(len(near))]
        if len(self.members[to]) > LARGEST_EXACT:
            return
        p = self.problem
        group = self.members[r]
        areas = np.array(sorted(group))
        both = np.concatenate((areas, np.array(sorted(self.members[to]))))
        total = self.size[r] + self.size[to]
        before = (
            self.share(areas, self.core[r]).sum()
            + self.share(both[len(areas):], self.core[to]).sum()
            + price_of_lack * self.lack(self.size[r], self.theta[self.core[r]])
            + price_of_lack * self.lack(self.size[to], self.theta[self.core[to]])
        )
        choice = np.array([self.core[r], self.core[to]]) if self.by_class else both
        after = shares(p, both, choice).sum(axis=0)
        after += price_of_lack * self.lack(total, self.theta[choice])
        if self.by_class:
            for k in (0, 1):
                one, other = (r, to) if k else (to, r)  # `one` takes the class of `other`
                a, b = p.cls[self.core[one]], p.cls[self.core[other]]
                if a != b:
                    after[k] += p.boundary * sum(
                        length * (int(c == a) - int(c == b))
                        for v in self.members[one]
                        for u, length in self.length_of[v].items()
                        if self.labels[u] != one
                        for c in (p.cls[self.core[self.labels[u]]],)
                    )
        best = int(np.argmin(after))
        delta = after[best] - before - self.bonus
        if not self.by_class:
            delta -= p.boundary * sum(
                length
                for v in group
                for u, length in self.length_of[v].items()
                if self.labels[u] == to
            )
        self.priced += 1
        if delta < -temperature * math.log(self.rng.random() + 1e-300):
            self.put(areas.tolist(), r, to)
            self.core[to] = choice[best]

    def split(self, temperature, price_of_lack, most=4):
        """Propose to split a region in two that are large enough."""
        v = int(self.movable[self.rng.integers(len(self.movable))])
        r = self.labels[v]
        if len(self.members[r]) < 2 or len(self.members[r]) > LARGEST_EXACT or not self.free:
            return
        members = np.array(sorted(self.members[r]))
        # half of the time with another core for what stays: the old one may be in the middle
        p, old, stays, extra = self.problem, int(self.core[r]), int(self.core[r]), 0.0
        if self.rng.random() < 0.5:
            stays = int(self.rng.choice(members, p=p.size[members] / p.size[members].sum()))
            if self.by_class and p.cls[stays] != p.cls[old]:
                stays = old
            elif stays != old:
                extra = float(self.share(members, stays).sum() - self.share(members, old).sum())
        found = best_split(p, self.adjacent, members, stays, most)
        self.priced += 1
        if found is None:
            return
        # what the region lacked before is no longer missing
        extra -= price_of_lack * float(self.lack(self.size[r], self.theta[old]))
        cost = found[0] + extra + self.bonus
        if cost < -temperature * math.log(self.rng.random() + 1e-300):
            _, areas, core = found
            to = self.put(areas, r, -1)
            self.core[to] = core
            self.core[r] = stays

    def move_core(self, temperature, price_of_lack):
        """Propose to move the core of a region to a neighbour; the rest gets the best new core."""
        p = self.problem
        r = self.labels[int(self.movable[self.rng.integers(len(self.movable))])]
        v = int(self.core[r])
        near = sorted({self.labels[u] for u in self.adjacent[v]} - {r})
        if not near or not 1 < len(self.members[r]) <= LARGEST_EXACT:
            return
        to = near[self.rng.integers(len(near))]
        rest = self.members[r] - {v}
        if len(connected_parts(self.adjacent, rest)) > 1:
            return
        rest = np.array(sorted(rest))
        size = float(p.size[v])
        cost = shares(p, rest, rest).sum(axis=0)
        cost += price_of_lack * self.lack(self.size[r] - size, self.theta[rest])
        if self.by_class:  # its class stays, so that the boundaries of the rest keep their price
            cost[p.cls[rest] != p.cls[v]] = np.inf
        best = int(np.argmin(cost))
        if not np.isfinite(cost[best]):
            return
        before = self.share(rest, v).sum()
        before += price_of_lack * self.lack(self.size[r], self.theta[v])
        core = int(self.core[to])
        delta = float(cost[best] - before + self.share(v, core))
        delta += price_of_lack * float(
            self.lack(self.size[to] + size, self.theta[core])
            - self.lack(self.size[to], self.theta[core])
        )
        own, other = p.cls[v], p.cls[core]
        for u, length in self.length_of[v].items():
            s = self.labels[u]
            if self.by_class:
                kept = p.cls[self.core[s]]
                delta += p.boundary * length * (int(kept == own) - int(kept == other))
            else:
                delta += p.boundary * length * ((s == r) - (s == to))
        self.priced += 1
        if delta < -temperature * math.log(self.rng.random() + 1e-300):
            self.put([v], r, to)
            self.core[r] = rest[best]

    # ---- the run

    def draw(self, m):
        """Draw moves of areas to neighbouring regions, and some to new ones."""
        p = self.problem
        v = self.movable[self.rng.integers(len(self.movable), size=m)]
        slot = p.start[v] + (self.rng.random(m) * self.degree[v]).astype(np.int64)
        to = self.region[p.neighbour[slot]]
        fresh = (self.rng.random(m) < 0.02) & (self.number[self.region[v]] > 1)
        fresh &= self.theta[v] < EXCLUDED
        useful = (to != self.region[v]) | fresh
        if len(self.free) < 64:
            useful &= ~fresh
        to = np.where(fresh, -1, to)
        return v[useful], to[useful]

    def scale(self, price_of_lack):
        """A typical price of a move: the median of those that cost something."""
        v, to = self.draw(20_000)
        delta = self.price(v, to, price_of_lack) if len(v) else np.zeros(0)
        delta = delta[np.isfinite(delta) & (delta > 0)]
        return float(np.median(delta)) if len(delta) else 1.0

    def cool(self, iterations, seconds, schedule, check):
        """Anneal."""
        hot, cold, soft, hard = schedule
        scale = self.scale(soft)
        m = max(8, min(4096, len(self.movable) // 4))
        began = perf_counter()
        wanted = max(4.0, self.regions / 12)
        # new cores cost the square of the areas of a region: the larger, the rarer
        rest = int(np.clip(len(self.movable) / max(self.regions, 1) / 2, 4, 64))
        share = 0.0
        while True:
            if seconds is None:
                share = self.priced / max(iterations, 1)
            else:
                share = (perf_counter() - began) / max(seconds, 1e-9)
            if share >= 1.0:
                break
            self.batch += 1
            temperature = scale * hot * (cold / hot) ** share
            price_of_lack = soft * (hard / soft) ** min(1.0, share / 0.8)
            v, to = self.draw(m)
            self.priced += m
            if len(v):
                delta = self.price(v, to, price_of_lack)
                threshold = -temperature * np.log(self.rng.random(len(v)) + 1e-300)
                accepted = np.flatnonzero(delta < threshold)
                for k in accepted.tolist():
                    self.apply(int(v[k]), int(to[k]), temperature, price_of_lack)
                if len(accepted) > 1.5 * wanted:
                    m = max(8, int(m * 0.9))
                elif len(accepted) < wanted:
                    m = min(16384, int(m * 1.1) + 1)
            if self.batch % 4 == 0:
                self.merge(temperature, price_of_lack)
                self.split(temperature, price_of_lack)
                self.move_core(temperature, price_of_lack)
            if self.batch % rest == 0:
                self.recore(price_of_lack)
            if self.count is not None:
                self.bonus += 0.002 * temperature * max(-20, min(20, self.regions - self.count))
            if self.batch % 64 == 0:
                check(share)

    def settle(self, check=lambda share: None):
        """Repair what is too small and descend with hard thresholds; return a Solution."""
        # sums of millions of steps are off by rounding
        self.size = np.bincount(
            self.region, weights=self.problem.size, minlength=len(self.size)
        )
        self.recore(HARD)
        self.repair()
        self.bonus = 0.0
        hot = None  # regions that changed in the last round: only their moves have new prices
        for _ in range(1000):
            self.batch += 1
            check(1.0)
            v, to = self.every_move(hot)
            delta = self.price(v, to, HARD) if len(v) else np.zeros(0)
            if self.count is not None:
                delta[self.number[self.region[v]] == 1] = np.inf
            better = np.flatnonzero(delta < -1e-6)
            for k in better[np.argsort(delta[better], kind="stable")].tolist():
                self.apply(int(v[k]), int(to[k]), 0.0, HARD)
            changed = self.stamp == self.batch
            changed[self.recore(HARD)] = True
            if changed.any():
                hot = changed
            elif hot is None:
                break
            else:
                hot = None
        return self.current()

    def every_move(self, hot=None):
        """All moves of an area to the region of a neighbour, each once; or those of hot regions."""
        p = self.problem
        owner = self.owner
        to, old = self.region[p.neighbour], self.region[owner]
        useful = (to != old) & ~self.frozen[owner]
        if hot is not None:
            useful &= hot[to] | hot[old]
        useful = np.flatnonzero(useful)
        key = np.unique(owner[useful] * len(self.size) + to[useful])
        return key // len(self.size), key % len(self.size)

    def repair(self):
        """Make every region large enough: it takes areas that others can spare, or joins one."""
        for _ in range(len(self.movable)):
            lack = np.where(self.number > 0, self.lack(self.size, self.theta[self.core]), 0.0)
            lack[self.region[self.frozen]] = 0.0
            lack[enough(self.size, self.theta[self.core])] = 0.0
            small = np.flatnonzero(lack > 0.0)
            if not len(small):
                return
            r = int(small[np.argmin(lack[small])])
            self.batch += 1
            core = best_core(self.problem, np.array(sorted(self.members[r])))
            if enough(self.size[r], self.theta[core]):
                self.core[r] = core
            elif not self.take(r):
                self.join(r)
            self.recore(HARD)

    def take(self, r, most=12):
        """Let a region grow by areas that others can spare, if that is cheaper than to join one."""
        moved, spent = [], 0.0
        limit = self.cheapest_join(r)[0]
        while not enough(self.size[r], self.theta[self.core[r]]):
            near = sorted({
                u for v in self.members[r] for u in self.adjacent[v] if self.labels[u] != r
            })
            options = []
            if near and len(moved) < most:
                near = np.array(near)
                delta = self.price(near, np.full(len(near), r), 0.0)
                for k in np.argsort(delta, kind="stable").tolist():
                    v, s = int(near[k]), self.labels[near[k]]
                    rest = self.size[s] - self.problem.size[v]
                    if not np.isfinite(delta[k]) or spent + delta[k] > limit:
                        break
                    if len(self.members[s]) > 1 and not enough(rest, self.theta[self.core[s]]):
                        continue
                    if len(self.members[s]) == 1 and self.count is not None:
                        continue
                    if len(self.members[s]) == 1 or self.cut_off(v, s) == ():
                        options.append((float(delta[k]), v, s))
                        break
            if not options:
                for v, s in reversed(moved):
                    self.put([v], r, s)
                return False
            cost, v, s = options[0]
            if len(self.members[s]) == 1:  # the rest cannot be undone by a single move
                moved = []
            else:
                moved.append((v, s))
            spent += cost
            self.put([v], s, r)
        return True

    def cheapest_join(self, r):
        """Price and number of the neighbouring region that r joins at least cost."""
        around = sorted({
            self.labels[u] for v in self.members[r] for u in self.adjacent[v]
        } - {r})
        best = (math.inf, -1)
        for s in around:
            price = self.group_price(self.members[r], r, s, 0.0)
            if price < best[0]:
                best = (price, s)
        return best

    def join(self, r):
        """Merge a region into the neighbour where that costs least."""
        _, s = self.cheapest_join(r)
        both = np.array(sorted(self.members[r] | self.members[s]))
        self.put(sorted(self.members[r]), r, s)
        self.core[s] = best_core(self.problem, both)
        self.dirty.add(s)

    def current(self):
        """The regions as they are, with their best cores."""
        return solution(self.problem, self.region)
