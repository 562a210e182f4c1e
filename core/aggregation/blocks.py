"""The best of two solutions, block by block."""

from __future__ import annotations

import numpy as np

from .instance import Instance, Solution, costs, each_share

__all__ = ["best_of_both", "block_of_areas", "cheapest_choice"]

MOST = 64  # blocks that are exchanged one by one, at most
FARTHEST = 1000  # regions that a choice of blocks may be off while it is made


def block_of_areas(one: Solution, other: Solution) -> np.ndarray:
    """Return the block of each area: (n,) int, numbered from 0.

    Regions of two solutions that share an area belong to one block; so each block is a set of areas
    that regions of both cover exactly.

    Examples
    --------
    Of six areas, both solutions have a boundary after the third only.

    >>> one = Solution(np.array([0, 0, 1, 2, 2, 2]), np.array([0, 2, 3]))
    >>> other = Solution(np.array([0, 1, 1, 2, 3, 3]), np.array([0, 1, 3, 4]))
    >>> block_of_areas(one, other).tolist()
    [0, 0, 0, 1, 1, 1]
    """
    pairs = np.unique(np.column_stack((one.region, len(one.core) + other.region)), axis=0)
    a, b = pairs.T
    block = np.arange(len(one.core) + len(other.core))
    while True:  # the smallest number in reach, from both sides in turn
        before = block.copy()
        np.minimum.at(block, b, block[a])
        np.minimum.at(block, a, block[b])
        block = block[block]
        if (block == before).all():
            break
    return np.unique(block[one.region], return_inverse=True)[1].ravel()


def best_of_both(problem: Instance, one: Solution, other: Solution, count: int | None = None) -> Solution:
    """Return the cheaper version of each block of two solutions.

    Parameters
    ----------
    one, other : Solution
        Feasible.
    count : int, optional
        Number of regions wanted; then the blocks are exchanged that save most of those choices that
        come nearest to it.

    Returns
    -------
    Solution
        Feasible, as the regions of both are. Not more expensive than ``one``, nor than ``other``;
        if a number of regions is wanted, not farther from it than ``one``, and as near not more
        expensive.

    Notes
    -----
    Boundaries between blocks cost the same in all versions, as both solutions have them there; the
    blocks are independent. Not so where only boundaries between classes count: there
    at most `MOST` blocks are exchanged one by one, the most promising first, each if the recount falls. O(h),
    and O(h) more for each of them.

    Examples
    --------
    Six areas in a row, of two classes; a region needs a size of 2, so that the two areas of size 1 must
    join a neighbour. One solution takes the wrong one on the right, the other on the left.

    >>> from isthmus.core.aggregation.instance import build
    >>> row = np.column_stack((range(5), range(1, 6)))
    >>> sizes, classes = [2, 1, 2, 2, 1, 2], [0, 0, 1, 0, 1, 1]
    >>> problem = build(sizes, classes, range(6), row, np.ones(5), 1 - np.eye(2), [2.0, 2.0])
    >>> one = Solution(np.array([0, 0, 1, 2, 2, 3]), np.array([0, 2, 3, 5]))
    >>> other = Solution(np.array([0, 1, 1, 2, 3, 3]), np.array([0, 2, 3, 5]))
    >>> costs(problem, one).total, costs(problem, other).total
    (1.0, 1.0)
    >>> found = best_of_both(problem, one, other)
    >>> found.region.tolist(), costs(problem, found).total
    ([0, 0, 1, 2, 3, 3], 0.0)
    """
    block = block_of_areas(one, other)
    number = int(block.max(initial=-1)) + 1
    gain = _block_costs(problem, one, block, number) - _block_costs(problem, other, block, number)
    if count is None:
        wins = gain > 0.0
    else:
        more = np.bincount(block[other.core], minlength=number)
        more -= np.bincount(block[one.core], minlength=number)
        wins = cheapest_choice(gain, more, count - len(one.core))
    if not (problem.by_class and problem.boundary):
        return _mixed(one, other, wins[block])
    if count is not None:  # one by one their number would change
        found = _mixed(one, other, wins[block])
        return min((one, found), key=lambda some: (abs(len(some.core) - count), costs(problem, some).total))
    total, chosen = costs(problem, one).total, np.zeros(number, dtype=bool)
    best = one
    if costs(problem, other).total < total:
        best, total, chosen = other, costs(problem, other).total, ~chosen
    order = np.argsort(np.where(chosen, gain, -gain), kind="stable")
    for k in order[:MOST].tolist():
        if gain[k] == 0.0:
            continue
        chosen[k] = not chosen[k]
        found = _mixed(one, other, chosen[block])
        cost = costs(problem, found).total
        if cost < total:
            best, total = found, cost
        else:
            chosen[k] = not chosen[k]
    return best


def cheapest_choice(gain: np.ndarray, more: np.ndarray, wanted: int) -> np.ndarray:
    """Return which blocks to exchange so that the number of regions changes as wanted: (b,) bool.

    Parameters
    ----------
    gain : (b,) float
        What exchanging each block saves.
    more : (b,) int
        How many regions it adds.
    wanted : int
        How many regions all together are to add; if no choice adds so many, the nearest number.

    Returns
    -------
    (b,) bool
        The choice that saves most, as long as no more than `FARTHEST` regions are ever between the number
        reached and the one wanted or none.

    Notes
    -----
    A knapsack by dynamic programming: O(b s) for a sum s of the numbers that are not 0.

    Examples
    --------
    Exchanging the first or the second block adds a region; the third takes one away, and costs something;
    the last one leaves their number. If it shall stay, the third makes room for the first; two regions
    more are what the first two add.

    >>> gain, more = np.array([5.0, 3.0, -1.0, 2.0]), np.array([1, 1, -1, 0])
    >>> cheapest_choice(gain, more, wanted=0).tolist()
    [True, False, True, True]
    >>> cheapest_choice(gain, more, wanted=2).tolist()
    [True, True, False, True]
    """
    chosen = (more == 0) & (gain > 0.0)
    some = np.flatnonzero(more)
    share = np.zeros(len(some))  # blocks with more and with fewer in turn: so the sums stay small
    for its in (more[some] > 0, more[some] < 0):
        share[its] = np.cumsum(more[some][its]) / more[some][its].sum()
    some = some[np.argsort(share, kind="stable")]
    low = max(int(more[some][more[some] < 0].sum()), min(0, wanted) - FARTHEST)
    high = min(int(more[some][more[some] > 0].sum()), max(0, wanted) + FARTHEST)
    best = np.full(high - low + 1, -np.inf)
    best[-low] = 0.0
    taken = np.zeros((len(some), len(best)), dtype=bool)
    for k, b in enumerate(some.tolist()):
        step = int(more[b])
        with_it = np.full(len(best), -np.inf)
        if step > 0:
            with_it[step:] = best[:-step] + gain[b]
        else:
            with_it[:step] = best[-step:] + gain[b]
        taken[k] = with_it > best
        best = np.maximum(best, with_it)
    reached = np.flatnonzero(best > -np.inf)
    away = np.abs(reached + low - wanted)
    at = int(reached[np.lexsort((-best[reached], away))[0]])
    for k in range(len(some) - 1, -1, -1):
        if taken[k, at]:
            chosen[some[k]] = True
            at -= int(more[some[k]])
    return chosen


def _block_costs(problem, found, block, number):
    """What each block costs, without the boundaries to others."""
    core = found.core[found.region]
    share = each_share(problem, np.arange(len(core)), core)
    total = np.bincount(block, weights=share, minlength=number)
    if problem.boundary:
        owner, beside = problem.owner, problem.neighbour
        kept = problem.cls[core] if problem.by_class else found.region
        inner = (owner < beside) & (block[owner] == block[beside]) & (kept[owner] != kept[beside])
        total += problem.boundary * np.bincount(
            block[owner[inner]], weights=problem.length[inner], minlength=number
        )
    return total


def _mixed(one, other, from_other):
    """The regions of ``other`` where ``from_other`` says so, those of ``one`` elsewhere."""
    core = np.where(from_other, other.core[other.region], one.core[one.region])
    # a region has one core, and no two regions have the same
    _, first, label = np.unique(core, return_index=True, return_inverse=True)
    rank = np.argsort(np.argsort(first))
    cores = np.empty(len(first), dtype=np.int64)
    cores[rank] = core[first]
    return Solution(rank[label.ravel()], cores)
