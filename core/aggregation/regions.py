"""Regions while they change: lists and sets for single areas, arrays for the prices of many moves."""

from __future__ import annotations

from typing import Collection, Sequence

import numpy as np

from .greedy import adjacency, helpless
from .instance import Instance, Solution, connected_parts, solution

__all__ = ["EXCLUDED", "LARGEST_GROUP", "Regions"]

LARGEST_GROUP = 40  # areas that follow one that would cut them off
EXCLUDED = 1e30  # least to stand for an infinite threshold: finite, so that differences are numbers


class Regions:
    """A partition of the areas into contiguous regions, perhaps too small ones.

    Always true: ``region`` and ``labels`` name the region of each area, ``members`` holds its areas,
    ``number`` and ``size`` their number and size (up to rounding), and its ``core`` is one of them;
    ``free`` are the numbers that no region has, and ``count`` is how many regions there are.
    Regions that changed since the cores were last chosen are ``dirty``; those that changed in this
    batch have its number as their ``stamp``.

    Parameters
    ----------
    problem : Instance
    begin : Solution
    """

    def __init__(self, problem: Instance, begin: Solution) -> None:
        self.problem = problem
        n = len(problem.size)
        self.adjacent = adjacency(problem)
        self.degree = np.diff(problem.start)
        length, start = problem.length.tolist(), problem.start.tolist()
        self.length_of = [dict(zip(self.adjacent[v], length[start[v] : start[v + 1]])) for v in range(n)]
        self.frozen = helpless(problem)
        self.movable = np.flatnonzero(~self.frozen & (self.degree > 0))
        excluded = max(EXCLUDED, 1e6 * float(problem.size.sum()))
        self.theta = np.minimum(problem.theta, excluded)[problem.cls]
        self.by_class = problem.by_class and problem.boundary > 0.0
        self.load(begin)

    def load(self, begin: Solution) -> None:
        """Become the regions of a solution."""
        problem, slots = self.problem, len(self.problem.size)
        self.region = begin.region.astype(np.int64).copy()
        self.labels = self.region.tolist()
        self.count = len(begin.core)
        self.core = np.zeros(slots, dtype=np.int64)
        self.core[: self.count] = begin.core
        self.size = np.bincount(self.region, weights=problem.size, minlength=slots)
        self.number = np.bincount(self.region, minlength=slots)
        self.members = [set() for _ in range(slots)]
        for v, r in enumerate(self.labels):
            self.members[r].add(v)
        self.free = list(range(slots - 1, self.count - 1, -1))
        self.stamp = np.zeros(slots, dtype=np.int64)
        self.batch = 0
        self.dirty = set()

    def missing(self, size: np.ndarray | float, core: np.ndarray | int) -> np.ndarray | float:
        """Square metres that regions of these sizes lack for the classes of these cores."""
        return np.maximum(self.theta[core] - size, 0.0)

    def put(self, areas: Sequence[int], r: int, to: int) -> int:
        """Move areas from region r to another one, or a new one if ``to`` is -1; return it."""
        if to < 0:
            to = self.free.pop()
            self.core[to] = areas[0]
            self.size[to] = 0.0
            self.count += 1
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
            self.count -= 1
            self.dirty.discard(r)
        return to

    def around(self, r: int) -> list[int]:
        """The regions beside a region, ascending."""
        return sorted({self.labels[u] for v in self.members[r] for u in self.adjacent[v]} - {r})

    def cut_off(self, v: int, r: int) -> Collection[int] | None:
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

    def weigh(self) -> None:
        """Sum the sizes anew: those of millions of steps are off by rounding."""
        self.size = np.bincount(self.region, weights=self.problem.size, minlength=len(self.size))

    def current(self) -> Solution:
        """The regions as they are, with their best cores."""
        return solution(self.problem, self.region)
