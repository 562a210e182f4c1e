"""The dual problem and the trade-off curve: the largest dilation as a function of the cost.

The least cost is a falling step function of tau (section 2 of the paper). A solution found for tau
has a dilation d <= tau, and every bound in [d, tau] has the same least cost; so the search jumps from
achieved dilation to achieved dilation, and ends when the next trial, just below the best one, costs
too much: its answer is exact, not an interval.

A search is a generator that asks for a tau and is sent the solution. So those of many features go on
side by side (`together`), each step being one solution of the forest of all their polygons.
"""

from __future__ import annotations

import math
from typing import Callable, Generator, NamedTuple

import numpy as np

from ..progress import ignore
from .min_size import SLACK
from .solve import Prepared, select

__all__ = [
    "Joint",
    "OverBudget",
    "TradeOff",
    "joint_solver",
    "paying_steps",
    "smallest_dilation",
    "together",
    "trade_off",
]

# Bounds nearer to each other than this count as one: `objective` compares with SLACK.
NEXT = 1.0 - 8.0 * SLACK
MISSES = 4  # trials in vain before asking whether the best solution is the last


class Joint(NamedTuple):
    """A solution of several polygons for the same tau.

    Attributes
    ----------
    tau : float
        The bound that was asked for.
    cost, lower_bound : float
        Sums over the polygons.
    dilation : float
        The largest of a candidate.
    """

    tau: float
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


class TradeOff(NamedTuple):
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


def joint_solver(
    prepared: Prepared,
    group: np.ndarray,
    count: int,
    *,
    weight: np.ndarray | None = None,
    max_gap: float = 0.0,
    time_limit: float | None = None,
    check: Callable = ignore,
) -> Callable:
    """Return the function that solves groups of polygons, each for a tau of its own.

    Parameters
    ----------
    prepared : Prepared
    group : (p,) int
        The group (the feature, say) of each polygon; negative: none.
    count : int
        The number of groups.
    weight : (k,) float, optional
        Weights of the candidates; MinSize without.
    max_gap, time_limit, check
        See `solve.select`.

    Returns
    -------
    callable
        (count,) tau to a list of Joint.

    Examples
    --------
    An hourglass: the detour at its neck is 11.4; for less it takes a cut.

    >>> from isthmus.core.partition.solve import prepare
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> solve = joint_solver(prepare(one_polygon(xy, [0, 6])), np.array([0]), 1)
    >>> [(joint.cost, round(joint.dilation, 1)) for tau in (12.0, 4.0) for joint in solve([tau])]
    [(0.0, 11.4), (1.0, 1.1)]
    """
    own = np.flatnonzero(group >= 0)

    def solve(tau):
        bound = np.where(group >= 0, np.asarray(tau)[group], np.inf)
        selection = select(
            prepared, bound, weight=weight, max_gap=max_gap, time_limit=time_limit, check=check
        )
        cost, lower_bound = (
            np.bincount(group[own], weights=x[own], minlength=count)
            for x in (selection.cost, selection.lower_bound)
        )
        dilation = np.ones(count)
        np.maximum.at(dilation, group[own], selection.dilation[own])
        return [Joint(*row) for row in zip(tau, cost.tolist(), lower_bound.tolist(), dilation.tolist())]

    return solve


def together(searches: list, solve: Callable) -> list:
    """Run the searches of groups of polygons side by side.

    Parameters
    ----------
    searches : list of generator
        One a group, see `smallest_dilation` and `trade_off`.
    solve : callable
        See `joint_solver`.

    Returns
    -------
    list
        What each search returns.

    Examples
    --------
    Two hourglasses, one of them with a wider neck: the smallest largest detour of each without a cut.

    >>> from isthmus.core.partition.solve import prepare
    >>> from isthmus.core.rings import Rings
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> wider = np.array([[0, 0], [5, 3], [15, 0], [15, 10], [5, 7], [0, 10.0]])
    >>> both = prepare(Rings(np.concatenate((xy, wider)), np.array([0, 6, 12]), np.arange(3)))
    >>> found = together([smallest_dilation(0.0) for _ in range(2)], joint_solver(both, np.arange(2), 2))
    >>> [round(best.dilation, 1) for best, proven in found]
    [11.4, 5.4]
    """
    results, tau = [None] * len(searches), [next(search) for search in searches]
    active = list(range(len(searches)))
    while active:
        solutions, going = solve(tau), []
        for k in active:
            try:
                tau[k] = searches[k].send(solutions[k])
                going.append(k)
            except StopIteration as end:
                results[k], tau[k] = end.value, math.inf
        active = going
    return results


def smallest_dilation(budget: float) -> Generator[float, Joint, tuple[Joint | OverBudget, bool]]:
    """Search for the answer of the dual problem: the smallest dilation within a budget.

    Section 2 of the paper names it, and a binary search on tau for it; this search ends at the exact answer.

    Parameters
    ----------
    budget : float
        Largest cost.

    Returns
    -------
    best : Joint or OverBudget
        Its ``dilation`` is the answer: no smaller one is achievable within the budget, if every
        solution is optimal. That is so for polygons without holes, with MinSize or solutions proven
        optimal.
    proven : bool
        Whether the lower bounds prove it (for polygons carved open along their holes).

    Notes
    -----
    Measured: 8 to 30 solutions.

    Examples
    --------
    An hourglass: with one cut no detour is larger than 1.1.

    >>> from isthmus.core.partition.solve import prepare
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> solve = joint_solver(prepare(one_polygon(xy, [0, 6])), np.array([0]), 1)
    >>> [(best, proven)] = together([smallest_dilation(1.0)], solve)
    >>> best.cost, round(best.dilation, 1), proven
    (1.0, 1.1, True)
    """
    best = yield math.inf
    if _exceeds(best.cost, budget):
        return OverBudget(best.cost), True
    best, beyond = yield from _tighten(best, 1.0, budget)
    return best, beyond is None or _exceeds(beyond.lower_bound, budget)


def trade_off(low: float, high: float, most: int | None = None) -> Generator[float, Joint, TradeOff]:
    """Follow the step function cost(tau) from a large tau down to a small one.

    It falls since any solution for a tau is one for each larger tau (section 2 of the paper).

    Parameters
    ----------
    low, high : float
        Bounds of tau; high may be infinite.
    most : int, optional
        Stop after so many steps.

    Returns
    -------
    TradeOff

    Examples
    --------
    An hourglass: one cut at its neck makes the largest detour ten times smaller.

    >>> from isthmus.core.partition.solve import prepare
    >>> from isthmus.core.rings import one_polygon
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> solve = joint_solver(prepare(one_polygon(xy, [0, 6])), np.array([0]), 1)
    >>> curve = together([trade_off(2.0, math.inf)], solve)[0]
    >>> [(joint.cost, round(joint.dilation, 1)) for joint in curve.solutions], curve.complete
    ([(0.0, 11.4), (1.0, 1.1)], True)
    """
    solutions, after = [], (yield high)
    while after is not None:
        if len(solutions) == most:
            return TradeOff(solutions, False)
        best, after = yield from _tighten(after, low, after.cost)
        # costs of MinWeight are the same up to rounding: a later, better solution may cost no more
        if solutions and not _exceeds(best.cost, solutions[-1].cost):
            solutions.pop()
        solutions.append(best)
    return TradeOff(solutions, True)


def _tighten(best, low, budget):
    """The least dilation within a budget, and the next solution beyond it.

    The second is None where the dilation cannot or need not become smaller.
    """
    floor = max(low, 1.0)
    low = floor
    while True:
        trial = best.dilation * NEXT
        if trial < floor:
            return best, None
        probe = yield trial
        if _exceeds(probe.cost, budget):
            return best, probe
        if not probe.dilation < best.dilation:  # no solution that doubles could tell apart
            return best, None
        best, misses = probe, 0
        while misses < MISSES:
            trial = math.sqrt(low * best.dilation)
            if not low < trial < best.dilation * NEXT:
                break
            probe = yield trial
            if _exceeds(probe.cost, budget):
                low, misses = trial, misses + 1
            else:
                best, misses = probe, 0


def _exceeds(cost, budget):
    return cost > budget * (1.0 + SLACK)


def paying_steps(tau: list, cost: list, most: int = 5) -> list:
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

    Examples
    --------
    The first cut brings the detour from 9 to 3, the second hardly less than that, the third more again.

    >>> paying_steps([9.0, 3.0, 2.9, 1.2], [0, 1, 2, 3])
    [1, 3]
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
