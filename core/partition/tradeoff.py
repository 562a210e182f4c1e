"""The dual problem and the trade-off curve: the largest dilation as a function of the cost.

The least cost is a falling step function of tau (section 2 of the paper). A solution found for tau
has a dilation d <= tau, and every bound in [d, tau] has the same least cost; so the search jumps from
achieved dilation to achieved dilation, and ends when the next trial, just below the best one, costs
too much: its answer is exact, not an interval.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from .min_size import SLACK
from .solve import select

__all__ = ["Joint", "OverBudget", "Steps", "joint_solver", "paying_steps", "smallest_dilation", "trade_off"]

# Bounds nearer to each other than this count as one: `objective` compares with SLACK.
NEXT = 1.0 - 8.0 * SLACK
MISSES = 4  # trials in vain before asking whether the best solution is the last


class Joint(NamedTuple):
    """Solutions of several polygons for the same tau.

    Attributes
    ----------
    selections : list of Selection
    cost, lower_bound : float
        Sums over the polygons.
    dilation : float
        The largest of a candidate.
    """

    selections: list
    cost: float
    lower_bound: float
    dilation: float


class OverBudget(NamedTuple):
    """No solution is cheap enough.

    Attributes
    ----------
    least : float
        What the cheapest costs.
    """

    least: float


class Steps(NamedTuple):
    """A trade-off curve.

    Attributes
    ----------
    solutions : list of Joint
        One for each cost, cheapest first: the least dilation achievable at that cost.
    complete : bool
        Whether they go down to the lower bound of tau.
    """

    solutions: list
    complete: bool


def joint_solver(prepared, weights, max_gap=0.0, time_limit=None, check=None):
    """Return the function that solves several polygons for a given tau.

    Parameters
    ----------
    prepared : list of Prepared
        The polygons of a feature.
    weights : list of (k,) float or None
        Weights of their candidates; None for MinSize.
    max_gap, time_limit : float
        See `partition.select`.
    check : callable, optional
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    callable
        ``tau`` to a Joint.
    """

    def solve(tau):
        selections = [
            select(polygon, tau, weight, max_gap, time_limit, check)
            for polygon, weight in zip(prepared, weights)
        ]
        return Joint(
            selections,
            math.fsum(selection.cost for selection in selections),
            math.fsum(selection.lower_bound for selection in selections),
            max(selection.dilation for selection in selections),
        )

    return solve


def smallest_dilation(solve, budget):
    """Solve the dual problem: the smallest dilation within a budget.

    Parameters
    ----------
    solve : callable
        ``tau`` to a Joint; see `joint_solver`.
    budget : float
        Largest cost.

    Returns
    -------
    best : Joint or OverBudget
        Its ``dilation`` is the answer: no smaller one is achievable within the budget, if every
        solution of `solve` is optimal. That is so for polygons without holes, with MinSize or
        solutions proven optimal.
    proven : bool
        Whether the lower bounds prove it (for polygons carved open along their holes).

    Notes
    -----
    Measured: 8 to 30 calls of `solve`.
    """
    best = solve(math.inf)
    if _exceeds(best.cost, budget):
        return OverBudget(best.cost), True
    best, beyond = _tighten(solve, best, 1.0, budget)
    return best, beyond is None or _exceeds(beyond.lower_bound, budget)


def trade_off(solve, low, high, most=None):
    """Follow the step function cost(tau) from a large tau down to a small one.

    Parameters
    ----------
    solve : callable
        See `smallest_dilation`.
    low, high : float
        Bounds of tau; high may be infinite.
    most : int, optional
        Stop after so many steps.

    Returns
    -------
    Steps
    """
    solutions, following = [], solve(high)
    while following is not None:
        if len(solutions) == most:
            return Steps(solutions, False)
        best, following = _tighten(solve, following, low, following.cost)
        # costs of MinWeight are the same up to rounding: a later, better solution may cost no more
        if solutions and not _exceeds(best.cost, solutions[-1].cost):
            solutions.pop()
        solutions.append(best)
    return Steps(solutions, True)


def _tighten(solve, best, low, budget):
    """The least dilation within a budget, and the next solution beyond it.

    The second is None where the dilation cannot or need not become smaller.
    """
    floor = max(low, 1.0)
    low = floor
    while True:
        trial = best.dilation * NEXT
        if trial < floor:
            return best, None
        probe = solve(trial)
        if _exceeds(probe.cost, budget):
            return best, probe
        if not probe.dilation < best.dilation:  # no solution that doubles could tell apart
            return best, None
        best, misses = probe, 0
        while misses < MISSES:
            trial = math.sqrt(low * best.dilation)
            if not low < trial < best.dilation * NEXT:
                break
            probe = solve(trial)
            if _exceeds(probe.cost, budget):
                low, misses = trial, misses + 1
            else:
                best, misses = probe, 0


def _exceeds(cost, budget):
    return cost > budget * (1.0 + SLACK)


def paying_steps(tau, cost, most=5):
    """Find the steps that buy most: the largest fall of the detour for what they cost more.

    Parameters
    ----------
    tau : list of float
        Falling: the least dilation achievable at each cost.
    cost : list of float
        Rising.
    most : int
        How many steps to find.

    Returns
    -------
    list of int
        Steps, ascending. The first step is never one: nothing was paid for it.

    Notes
    -----
    The fall is measured on a logarithmic scale: halving a detour of 40 is worth as much as halving
    one of 4. Only steps on the lower convex hull of the curve count, since any other is a bad buy:
    some mixture of its neighbours would be cheaper.
    """
    hull = []
    for k in range(len(tau)):
        while len(hull) > 1 and (  # steps in line with their neighbours stay, noise apart
            _slope(tau, cost, hull[-2], hull[-1]) > _slope(tau, cost, hull[-1], k) * (1.0 - 1e-9)
        ):
            hull.pop()
        hull.append(k)
    gain = {b: -_slope(tau, cost, a, b) for a, b in zip(hull[:-1], hull[1:])}
    best = sorted(gain, key=lambda k: (-gain[k], k))[:most]
    return sorted(best)


def _slope(tau, cost, a, b):
    """Change of log tau for each unit of cost from step a to step b; negative."""
    rise = cost[b] - cost[a]
    return (math.log(tau[b]) - math.log(tau[a])) / rise if rise > 0.0 else -math.inf
