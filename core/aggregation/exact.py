"""The mixed-integer programme of Haunert and Wolff, solved by HiGHS, with contiguity cuts.

``x[u, v]`` is 1 where area v belongs to the region with core u. Contiguity is not in the model at
first: where a solution violates it, cuts ``x[u, v] <= sum of x[u, s] over a separator`` are added and
the programme is solved again (Oehrlein and Haunert 2017). The bound of every round holds.
"""

from __future__ import annotations

from time import perf_counter
from typing import NamedTuple

import numpy as np

from ..errors import MissingEngine
from .greedy import greedy, helpless
from .instance import (
    Solution, build, components, connected_parts, costs, each_share, enough, problems, shares, solution,
)

__all__ = ["Exact", "exact", "require_highs"]

LARGEST_PROGRAMME = 20_000  # pairs of an area and a core; a part with more is left to greedy


class Exact(NamedTuple):
    """Result of the exact method.

    Attributes
    ----------
    found : Solution
    bound : float
        No solution costs less (with ``decompose``: none in which every area that is large enough by
        itself is the core of its region).
    proven : bool
        Whether ``found`` is the best one.
    rounds, parts : int
        How many programmes were solved, and for how many independent parts.
    """

    found: Solution
    bound: float
    proven: bool
    rounds: int
    parts: int


def require_highs():
    """Return scipy's ``milp`` and ``sparse``.

    Raises
    ------
    MissingEngine
        If scipy is missing or older than 1.9; it says what to install.
    """
    try:
        from scipy import sparse
        from scipy.optimize import LinearConstraint, milp
    except ImportError:
        raise MissingEngine(
            "the exact method needs the solver HiGHS from the Python package scipy, 1.9 or newer"
        ) from None
    return milp, LinearConstraint, sparse


def exact(problem, seconds=60.0, decompose=True, begin=None, check=None):
    """Aggregate at least cost.

    Parameters
    ----------
    problem : Instance
    seconds : float
        Time for all parts together.
    decompose : bool
        Whether an area that is large enough by itself is always the core of a region: the map
        then falls into parts that are solved one by one.
    begin : Solution, optional
        Returned where the time is over and nothing better was found. Default: greedy.
    check : callable, optional
        Called now and then with the share done; may raise to stop.

    Returns
    -------
    Exact

    Raises
    ------
    MissingEngine

    Notes
    -----
    Exponential. A dozen areas a part take seconds, twenty take minutes.
    """
    tools = require_highs()
    check = check or (lambda share: None)
    until = perf_counter() + seconds
    n = len(problem.size)
    lost = helpless(problem)
    own = problem.theta[problem.cls]
    big = ~lost & enough(problem.size, own) if decompose else np.zeros(n, dtype=bool)
    label = np.where(lost, 2, big.astype(np.int64))
    pieces = components(problem, label)
    groups = [np.flatnonzero(pieces == k) for k in np.unique(pieces[label == 0])]

    core_of = np.full(n, -1)
    core_of[big] = np.flatnonzero(big)
    if lost.any():
        alike = components(problem, np.where(lost, problem.cls, -1))
        for k in np.unique(alike[lost]):
            areas = np.flatnonzero(alike == k)
            core_of[areas] = areas[0]
    bound, proven, rounds = 0.0, True, 0
    for k, group in enumerate(sorted(groups, key=len)):
        check(k / len(groups))
        left = max(0.1, (until - perf_counter()) / (len(groups) - k))
        part = _Part(problem, group, big, tools)
        best, at_least, solved, tried = part.solve(left, check)
        core_of[group] = best
        bound += at_least
        proven &= solved
        rounds += tried
    found = _numbered(problem, core_of)
    bound += _constant(problem, big, core_of, lost)
    if not proven or problems_of(problem, found, lost):
        other = begin or greedy(problem)
        cheaper = costs(problem, other).total < costs(problem, found).total
        if cheaper or problems_of(problem, found, lost):
            found = other
    return Exact(found, bound, proven, rounds, len(groups))


def problems_of(problem, found, lost):
    """Faults of a solution apart from those that nothing can help."""
    return [fault for fault in problems(problem, found) if not lost[found.core[fault[0]]]]


def _numbered(problem, core_of):
    """Solution from the core of each area, with cheaper cores where there are some."""
    _, first, region = np.unique(core_of, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    core = np.empty(len(first), dtype=np.int64)
    core[rank] = core_of[first]
    mine = Solution(rank[region.ravel()], core)
    other = solution(problem, mine.region)
    worse = costs(problem, other).total >= costs(problem, mine).total
    return mine if worse else other


def _constant(problem, big, core_of, lost):
    """Cost that no choice changes: of areas fixed beforehand, and between them."""
    fixed, own = big | lost, np.flatnonzero(big)
    total = float(each_share(problem, own, own).sum())
    if lost.any():
        for u in np.unique(core_of[lost]):
            members = np.flatnonzero((core_of == u) & lost)
            total += shares(problem, members, members).sum(axis=0).min()
    owner, other = problem.owner, problem.neighbour
    both = (owner < other) & fixed[owner] & fixed[other] & (core_of[owner] != core_of[other])
    if problem.by_class:
        both &= problem.cls[core_of[owner]] != problem.cls[core_of[other]]
    return total + problem.boundary * float(problem.length[both].sum())


class _Part:
    """The programme of one part: free areas, and the large ones around them that are cores."""

    def __init__(self, problem, group, big, tools):
        self.problem, self.tools = problem, tools
        self.free = group.tolist()
        around = {
            v: slice(problem.start[v], problem.start[v + 1]) for v in self.free
        }
        self.fixed = sorted({
            u for v in self.free for u in problem.neighbour[around[v]].tolist() if big[u]
        })
        self.areas = self.free + self.fixed
        total = problem.size[group].sum()
        theta = problem.theta[problem.cls]
        self.cores = [u for u in self.free if enough(total, theta[u])] + self.fixed
        self.edges = [
            (v, u, length)
            for v in self.free
            for u, length in zip(
                problem.neighbour[around[v]].tolist(), problem.length[around[v]].tolist()
            )
            if big[u] or v < u
        ]
        self.adjacent = {v: [] for v in self.areas}
        for v, u, _ in self.edges:
            self.adjacent[v].append(u)
            self.adjacent[u].append(v)
        self.too_large = len(self.free) * len(self.cores) > LARGEST_PROGRAMME
        self.rows, self.columns, self.values, self.low = [], [], [], []
        self.upper = []
        if not self.too_large:
            self._build()

    def _row(self, entries, low, high=np.inf):
        number = len(self.low)
        for column, value in entries:
            self.rows.append(number)
            self.columns.append(column)
            self.values.append(value)
        self.low.append(low)
        self.upper.append(high)

    def _build(self):
        p = self.problem
        fixed = set(self.fixed)
        self.x = {}
        cost = []
        matrix = shares(p, np.array(self.free), np.array(self.cores, dtype=np.int64))
        for i, v in enumerate(self.free):
            for j, u in enumerate(self.cores):
                self.x[u, v] = len(cost)
                cost.append(matrix[i, j])
        self.whole = len(cost)
        theta = p.theta[p.cls]
        for v in self.free:
            self._row([(self.x[u, v], 1.0) for u in self.cores], 1.0, 1.0)
        for u in self.cores:
            if u not in fixed:
                for v in self.free:
                    if v != u:
                        self._row([(self.x[u, u], 1.0), (self.x[u, v], -1.0)], 0.0)
                if theta[u] > 0.0:
                    entries = [(self.x[u, v], p.size[v] / theta[u]) for v in self.free if v != u]
                    self._row(entries + [(self.x[u, u], p.size[u] / theta[u] - 1.0)], 0.0)
            for v in self.free:  # the first contiguity cuts: neighbours at both ends are there, too
                if v == u or u in self.adjacent[v]:
                    continue
                for end in (u, v):
                    around = [s for s in self.adjacent[end] if s not in fixed]
                    self._row([(self.x[u, s], 1.0) for s in around] + [(self.x[u, v], -1.0)], 0.0)
        self._most_regions(fixed, theta)
        self.offset = 0.0
        if p.boundary:
            self._boundaries(cost, fixed)
        self.cost = np.array(cost)

    def _most_regions(self, fixed, theta):
        """No more regions than there is room for: what rounding adds to the thresholds."""
        total = float(self.problem.size[self.free].sum())
        least = min((theta[u] for u in self.cores if u not in fixed), default=0.0)
        if least > 0.0:
            most = np.floor(total / least * (1.0 + 1e-9))
            self._row([(self.x[u, u], 1.0) for u in self.cores if u not in fixed], 0.0, most)

    def _boundaries(self, cost, fixed):
        """Terms for what two neighbours have in common: their region, or their class."""
        p = self.problem
        groups = {}
        for u in self.cores:
            groups.setdefault(int(p.cls[u]) if p.by_class else u, []).append(u)
        for v, w, length in self.edges:
            price = p.boundary * length
            self.offset += price
            if w in fixed:
                for u in groups[int(p.cls[w]) if p.by_class else w]:
                    cost[self.x[u, v]] -= price
                continue
            for cores in groups.values():
                same = len(cost)
                cost.append(-price)
                for end in (v, w):
                    self._row([(self.x[u, end], 1.0) for u in cores] + [(same, -1.0)], 0.0)

    def solve(self, seconds, check):
        """Return the core of each free area, a lower bound, whether it is reached, and the rounds."""
        if self.too_large:
            return self._greedy(), self._floor(-np.inf), False, 0
        milp, constraint, sparse = self.tools
        until = perf_counter() + seconds
        unit = max(np.abs(self.cost).max() / 100.0, 1e-300)
        integral = np.zeros(len(self.cost))
        integral[:self.whole] = 1
        bound, rounds = -np.inf, 0
        while True:
            left = until - perf_counter()
            if left <= 0.0 and rounds:
                break
            rounds += 1
            check(None)
            # HiGHS takes indices of 32 bits; scipy before 1.12 hands on others as they are
            places = np.array([self.rows, self.columns], dtype=np.int32)
            matrix = sparse.csr_array(
                (self.values, (places[0], places[1])), shape=(len(self.low), len(self.cost))
            )
            answer = milp(
                self.cost / unit, integrality=integral, bounds=(0.0, 1.0),
                constraints=constraint(matrix, self.low, self.upper),
                options={"time_limit": max(left, 0.1), "mip_rel_gap": 1e-9},
            )
            if answer.status == 2 or (answer.x is None and answer.mip_dual_bound is None):
                break
            if answer.mip_dual_bound is not None and np.isfinite(answer.mip_dual_bound):
                bound = max(bound, answer.mip_dual_bound * unit + self.offset)
            if answer.x is None:
                break
            chosen = {
                v: max(self.cores, key=lambda u: answer.x[self.x[u, v]]) for v in self.free
            }
            if self._cut(chosen) == 0:
                if answer.status == 0:
                    cost = self._cost(chosen)  # the bound is that, but for the solver's tolerance
                    bound = min(cost, max(bound, cost * (1.0 - 1e-9)))
                    return [chosen[v] for v in self.free], bound, True, rounds
                return [chosen[v] for v in self.free], self._floor(bound), False, rounds
            if answer.status != 0:
                break
        return self._greedy(), self._floor(bound), False, rounds

    def _floor(self, bound):
        """A bound that always holds: every area at its cheapest core, no boundary."""
        p = self.problem
        least = [
            shares(p, np.array([v]), np.array(self.cores, dtype=np.int64)).min() for v in self.free
        ]
        return max(bound, float(sum(least)))

    def _cost(self, chosen):
        p = self.problem
        total = sum(float(shares(p, np.array([v]), np.array([u]))[0, 0]) for v, u in chosen.items())
        for v, w, length in self.edges:
            a, b = chosen[v], chosen.get(w, w)
            if (p.cls[a] != p.cls[b]) if p.by_class else a != b:
                total += p.boundary * length
        return total

    def _cut(self, chosen):
        """Add cuts for what a solution violates; return their number."""
        added, fixed, regions = 0, set(self.fixed), {}
        for v, u in chosen.items():
            regions.setdefault(u, set()).add(v)
        for u, members in regions.items():
            members.add(u)
            parts = connected_parts(self.adjacent, members)
            for part in parts:
                if u in part:
                    continue
                part = set(part)
                around = {s for v in part for s in self.adjacent[v]} - part
                # what separates this part from its core separates it from others, too
                for core in self.cores:
                    if core in part or core in around:
                        continue
                    separator = self._facing(core, around)
                    inside = [(self.x[core, s], 1.0) for s in sorted(separator - fixed)]
                    for v in sorted(part):
                        self._row([*inside, (self.x[core, v], -1.0)], 0.0)
                        added += 1
            theta = self.problem.theta[self.problem.cls[u]]
            size = self.problem.size[sorted(members)].sum()
            if u not in self.fixed and not enough(size, theta):  # within the solver's tolerance
                outside = [(self.x[u, v], 1.0) for v in self.free if v not in members]
                self._row(outside + [(self.x[u, u], -1.0)], 0.0)
                added += 1
        return added

    def _facing(self, u, around):
        """The areas of a separator that are reached from u."""
        reached, stack, facing = {u}, [u], set()
        while stack:
            v = stack.pop()
            for s in self.adjacent[v]:
                if s in around:
                    facing.add(s)
                elif s not in reached:
                    reached.add(s)
                    stack.append(s)
        return facing

    def _greedy(self):
        """The greedy solution of this part, in which no two of the large areas join."""
        p = self.problem
        number = {v: k for k, v in enumerate(self.areas)}
        pairs = [(number[v], number[w]) for v, w, _ in self.edges]
        areas = np.array(self.areas)
        part = build(
            p.size[areas], p.cls[areas], p.place[areas], pairs, [e[2] for e in self.edges],
            p.distance, p.theta, p.change, p.boundary, p.centre, p.by_class, p.spread[areas],
        )
        found = greedy(part)
        core = areas[found.core]
        for u in self.fixed:
            core[found.region[number[u]]] = u
        return core[found.region[:len(self.free)]].tolist()
