"""Regions that are too small in the end: they take what others can spare, or join one."""

from __future__ import annotations

import math

import numpy as np

from .instance import best_core, enough
from .moves import Terms, group_price, prices, recore
from .regions import Regions

__all__ = ["HARD", "repair"]

HARD = Terms(temperature=0.0, lack=1e6)  # no square metre may be missing
FREE = Terms(temperature=0.0, lack=0.0)


def repair(regions: Regions, fixed: bool = False) -> None:
    """Make every region large enough.

    Parameters
    ----------
    regions : Regions
    fixed : bool
        Whether regions of one area may not be taken, because their number is wanted.

    Examples
    --------
    The area in the middle is too small to be a region; its boundary with the first is the longer one.

    >>> from isthmus.core.aggregation.instance import Solution, build
    >>> from isthmus.core.aggregation.regions import Regions
    >>> pairs, distance = [[0, 1], [1, 2]], 1 - np.eye(2)
    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], pairs, [2, 1], distance, [3, 3], boundary=1)
    >>> regions = Regions(row, Solution(np.arange(3), np.arange(3)))
    >>> repair(regions)
    >>> regions.labels
    [0, 0, 2]
    """
    for _ in range(len(regions.movable)):
        lack = np.where(regions.number > 0, regions.missing(regions.size, regions.core), 0.0)
        lack[regions.region[regions.frozen]] = 0.0
        lack[enough(regions.size, regions.theta[regions.core])] = 0.0
        small = np.flatnonzero(lack > 0.0)
        if not len(small):
            return
        r = int(small[np.argmin(lack[small])])
        regions.batch += 1
        core = best_core(regions.problem, np.array(sorted(regions.members[r])))
        if enough(regions.size[r], regions.theta[core]):
            regions.core[r] = core
        elif not _take(regions, r, fixed):
            _join(regions, r)
        recore(regions, HARD)


def _take(regions, r, fixed, most=12):
    """Let a region grow by areas that others can spare, if that is cheaper than to join one."""
    moved, spent = [], 0.0
    limit = _cheapest_join(regions, r)[0]
    while not enough(regions.size[r], regions.theta[regions.core[r]]):
        found = None if len(moved) >= most else _spare(regions, r, limit - spent, fixed)
        if found is None:
            for v, s in reversed(moved):
                regions.put([v], r, s)
            return False
        cost, v, s = found
        if len(regions.members[s]) == 1:  # the rest cannot be undone by a single move
            moved = []
        else:
            moved.append((v, s))
        spent += cost
        regions.put([v], s, r)
    return True


def _spare(regions, r, limit, fixed):
    """The cheapest area beside a region that its own can spare: its price, it, its region."""
    near = np.array(
        sorted({u for v in regions.members[r] for u in regions.adjacent[v] if regions.labels[u] != r}),
        dtype=np.int64,
    )
    delta = prices(regions, near, np.full(len(near), r), FREE)
    for k in np.argsort(delta, kind="stable").tolist():
        v, s = int(near[k]), regions.labels[near[k]]
        if not np.isfinite(delta[k]) or delta[k] > limit:
            return None
        alone = len(regions.members[s]) == 1
        rest = regions.size[s] - regions.problem.size[v]
        if fixed if alone else not enough(rest, regions.theta[regions.core[s]]):
            continue
        if alone or regions.cut_off(v, s) == ():
            return float(delta[k]), v, s
    return None


def _cheapest_join(regions, r):
    """Price and number of the neighbouring region that r joins at least cost."""
    return min(
        ((group_price(regions, regions.members[r], r, s, FREE), s) for s in regions.around(r)),
        default=(math.inf, -1),
    )


def _join(regions, r):
    """Merge a region into the neighbour where that costs least."""
    _, s = _cheapest_join(regions, r)
    both = np.array(sorted(regions.members[r] | regions.members[s]))
    regions.put(sorted(regions.members[r]), r, s)
    regions.core[s] = best_core(regions.problem, both)
    regions.dirty.add(s)
