"""The best of two solutions, block by block."""

from __future__ import annotations

import numpy as np

from .instance import Instance, Solution, costs, each_share

__all__ = ["best_of_both", "block_of_areas"]


def block_of_areas(one: Solution, other: Solution) -> np.ndarray:
    """Return the block of each area: (n,) int, numbered from 0.

    Regions of two solutions that share an area belong to one block; so each block is a set of areas
    that regions of both cover exactly.
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
        Whether the number of regions matters: then blocks are exchanged that have as many regions in
        both, or two at once of which one has more and the other as many fewer.

    Returns
    -------
    Solution
        Feasible, as the regions of both are. Not more expensive than ``one``, nor than ``other``
        unless a number of regions is wanted.

    Notes
    -----
    Boundaries between blocks cost the same in all versions, as both solutions have them there; the
    blocks are independent. Not so where only boundaries between classes count: there
    blocks are exchanged one by one, the most promising first, each if the recount falls. O(h), and
    O(h) more for each block in that case.
    """
    block = block_of_areas(one, other)
    number = int(block.max(initial=-1)) + 1
    gain = _block_costs(problem, one, block, number) - _block_costs(problem, other, block, number)
    if count is not None:
        more = np.bincount(block[other.core], minlength=number)
        more -= np.bincount(block[one.core], minlength=number)
        gain = _balanced(gain, more)
    if not (problem.by_class and problem.boundary):
        return _mixed(one, other, (gain > 0.0)[block])
    total, chosen = costs(problem, one).total, np.zeros(number, dtype=bool)
    best = one
    if count is not None:  # one by one their number would change
        found = _mixed(one, other, (gain > 0.0)[block])
        return found if costs(problem, found).total < total else one
    if costs(problem, other).total < total:
        best, total, chosen = other, costs(problem, other).total, ~chosen
    order = np.argsort(np.where(chosen, gain, -gain), kind="stable")
    for k in order[:64].tolist():
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


def _balanced(gain, more):
    """The gain of each block where exchanging keeps the number of regions; elsewhere 0.

    Of blocks that have k regions more and of those that have k fewer, the best are taken in pairs.
    """
    kept = np.where(more == 0, gain, 0.0)
    for k in np.unique(more[more > 0]).tolist():
        plus, minus = (
            some[np.argsort(-gain[some], kind="stable")]
            for some in (np.flatnonzero(more == k), np.flatnonzero(more == -k))
        )
        for a, b in zip(plus.tolist(), minus.tolist()):
            if gain[a] + gain[b] <= 0.0:
                break
            kept[[a, b]] = (gain[a] + gain[b]) / 2.0
    return kept


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
