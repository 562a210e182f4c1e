"""All partitions of a few areas: the truth that `exact` is compared with."""

from itertools import product

import numpy as np
from isthmus.core.aggregation.instance import Solution, costs, enough


def partitions(n):
    """Restricted growth strings: every partition of n areas once."""

    def extend(prefix, used):
        if len(prefix) == n:
            yield tuple(prefix)
            return
        for label in range(used + 1):
            yield from extend([*prefix, label], max(used, label + 1))

    yield from extend([], 0)


def is_connected(problem, areas):
    areas = set(areas)
    reached, stack = {min(areas)}, [min(areas)]
    while stack:
        v = stack.pop()
        for u in problem.neighbour[problem.start[v] : problem.start[v + 1]].tolist():
            if u in areas and u not in reached:
                reached.add(u)
                stack.append(u)
    return reached == areas


def cheapest(problem, big=None):
    """Return the least cost of all feasible solutions, infinite if there is none.

    With ``big`` only solutions in which each of these areas is the core of its region.
    """
    n = len(problem.size)
    theta = problem.theta[problem.cls]
    best = np.inf
    for labels in partitions(n):
        groups = [[v for v in range(n) if labels[v] == r] for r in range(max(labels) + 1)]
        if not all(is_connected(problem, group) for group in groups):
            continue
        choices = []
        for group in groups:
            size = problem.size[group].sum()
            cores = [u for u in group if enough(size, theta[u])]
            if big is not None and any(big[u] for u in group):
                cores = [u for u in cores if all(u == v for v in group if big[v])]
            choices.append(cores)
        for core in product(*choices):
            found = Solution(np.array(labels), np.array(core))
            best = min(best, costs(problem, found).total)
    return best
