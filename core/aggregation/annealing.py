"""Simulated annealing: areas change their region, regions merge and split, while it gets colder.

Many moves are drawn and priced at once, in arrays; the few that the Metropolis rule accepts are
made one after the other, each after a test that its old region stays contiguous. A move whose
region another move of the same batch has touched is left for a later batch, so that every price is
the true one. Regions may become too small at a price that rises while it gets colder; what is too
small in the end is repaired, and a descent with hard thresholds follows.

After a first run the result is heated again and again, less than at first, and the best of before and
after is kept, block by block (see `blocks`); with a fixed number of regions that is a knapsack, solved
exactly.
"""

from __future__ import annotations

from time import perf_counter
from typing import Callable, NamedTuple

import numpy as np

from .blocks import best_of_both
from .greedy import greedy, helpless, reach_count
from .instance import Instance, Solution, costs, problems
from .moves import (
    Terms,
    draw,
    every_move,
    gather,
    merge,
    move_area,
    move_core,
    prices,
    recore,
    split,
)
from .regions import Regions
from .repair import HARD, repair

__all__ = ["Schedule", "annealing"]

SMALL, RUNS_OF_SMALL = 100, 4  # areas of a small map, and into how many runs its effort is cut
FIRST = 0.45  # share of the effort of the first run
REST = 6  # batches between two choices of cores, times the areas of a region
REHEATS, LEAST_REHEAT = 8, 500  # at most so many, each with at least so many steps an area


class Schedule(NamedTuple):
    """How it gets colder, from the first to the last step, by constant factors.

    Attributes
    ----------
    hot, warm, cold : float
        First temperature, that of a reheat, and the last one, as multiples of a typical price of a
        move.
    soft, hard : float
        First and last price of a missing square metre.
    """

    hot: float = 3.0
    warm: float = 1.0
    cold: float = 0.03
    soft: float = 0.3
    hard: float = 30.0


class _Effort(NamedTuple):
    """Steps of a run, and seconds: what is over first ends it."""

    steps: float
    seconds: float | None

    def times(self, share):
        return _Effort(self.steps * share, self.seconds and self.seconds * share)


def annealing(
    problem: Instance,
    *,
    seed: int = 0,
    iterations: int | None = None,
    seconds: float | None = None,
    count: int | None = None,
    check: Callable | None = None,
    begin: Solution | None = None,
    schedule: Schedule = Schedule(),  # noqa: B008  it cannot be changed
) -> Solution:
    """Aggregate by simulated annealing from the greedy result.

    Parameters
    ----------
    problem : Instance
    seed : int
        The same seed and the same number of iterations give the same result.
    iterations : int, optional
        Number of moves that are priced. Default: 10,000 an area, or what the time is enough for.
    seconds : float, optional
        Use this much time; with a number of iterations, too, what is over first ends it.
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
    Simulated annealing is the heuristic of Haunert and Wolff (2010), with which Haunert and Meulemans
    aggregate in section 5.2.

    A batch of m moves is O(m) in arrays; for each that is accepted, Python looks at the areas of its region
    at most, mostly at the neighbours of one.

    Examples
    --------
    Two areas of 3 and two small ones between them, in a row; a region needs a size of 4. Region growing
    makes one region of all, and the last area loses its class. Annealing finds the two regions where only
    an area of size 1 does.

    >>> from isthmus.core.aggregation.instance import build
    >>> row = [[0, 1], [1, 2], [2, 3]]
    >>> problem = build([3, 1, 1, 3], [0, 0, 0, 1], range(4), row, np.ones(3), 1 - np.eye(2), [4.0, 4.0])
    >>> greedy(problem).region.tolist(), costs(problem, greedy(problem)).total
    ([0, 0, 0, 0], 3.0)
    >>> found = annealing(problem, iterations=4000)
    >>> found.region.tolist(), costs(problem, found).total
    ([0, 0, 1, 1], 1.0)
    """
    start = greedy(problem) if begin is None else begin
    if count is not None:
        start = reach_count(problem, start, count, check and (lambda _: check(0.0)))
    lost = helpless(problem)
    if lost.all():
        return start
    regions = Regions(problem, start)
    if not len(regions.movable):
        return start
    n, done, report = len(problem.size), 0.0, check or (lambda share: None)
    best = None
    bonus = 0.0  # price of a region that keeps their number; a run goes on with that of the last one
    if iterations is None:
        iterations = 10_000 * n if seconds is None else np.inf
    whole = _Effort(iterations, seconds)

    def run(begin, number, share, hot):
        """One run with a share of the effort, by its number; return what it found and its steps."""
        nonlocal bonus

        def tell(part):
            report(min(1.0, done + share * part))

        rng = np.random.Generator(np.random.PCG64([seed, number]))
        regions.load(begin)
        steps, bonus = _cool(regions, rng, whole.times(share), schedule._replace(hot=hot), count, bonus, tell)
        return _settle(regions, count, best is None, tell), steps

    def away(one):
        return 0 if count is None else abs(len(one.core) - count)

    def better(one, other):
        """The best of both; the one nearer to the number wanted, or cheaper, is what is improved."""
        one, other = sorted((one, other), key=lambda s: (away(s), costs(problem, s).total))
        return best_of_both(problem, one, other, count)

    # a small map has few ways out of a bad start, and time for several
    firsts = RUNS_OF_SMALL if n <= SMALL else 1
    for number in range(firsts):
        found, steps = run(start, number, FIRST / firsts, schedule.hot)
        best = found if best is None else better(best, found)
        done += FIRST / firsts
    fitting = int(steps * firsts * (1.0 - FIRST) / FIRST / (LEAST_REHEAT * n))
    reheats = min(REHEATS, max(1, fitting))
    share = (1.0 - FIRST) / reheats
    for number in range(firsts, firsts + reheats):
        found, _ = run(best, number, share, schedule.warm)
        best = better(best, found)
        done += share
    best = better(best, _settled(regions, best, count))

    def rank(one):
        faults = sum(not lost[one.core[r]] for r, _ in problems(problem, one))
        return faults, away(one), costs(problem, one).total

    return min((best, start), key=rank)


def _scale(regions, rng, lack):
    """A typical price of a move: the median of those that cost something."""
    delta = prices(regions, *draw(regions, rng, 20_000), Terms(0.0, lack))
    delta = delta[np.isfinite(delta) & (delta > 0)]
    return float(np.median(delta)) if len(delta) else 1.0


def _cool(regions, rng, effort, schedule, count, bonus, check):
    """Anneal; return the number of steps, and the price of a region in the end."""
    hot, _, cold, soft, hard = schedule
    scale = _scale(regions, rng, soft)
    m = max(8, min(4096, len(regions.movable) // 4))
    began, priced, share = perf_counter(), 0, 0.0
    wanted = max(4.0, regions.count / 12)
    # new cores cost the square of the areas of a region: the larger, the rarer; twelve times as often
    # took half of the time, and found worse regions in it
    rest = int(np.clip(REST * len(regions.movable) / max(regions.count, 1), 8 * REST, 128 * REST))
    while True:
        share = priced / max(effort.steps, 1)
        if effort.seconds is not None:
            share = max(share, (perf_counter() - began) / max(effort.seconds, 1e-9))
        if share >= 1.0:
            return priced, bonus
        regions.batch += 1
        temperature = scale * hot * (cold / hot) ** share
        terms = Terms(temperature, soft * (hard / soft) ** min(1.0, share / 0.8), bonus)
        v, to = draw(regions, rng, m)
        priced += m
        if len(v):
            threshold = -temperature * np.log(rng.random(len(v)) + 1e-300)
            accepted = np.flatnonzero(prices(regions, v, to, terms) < threshold)
            for k in accepted.tolist():
                move_area(regions, int(v[k]), int(to[k]), terms, rng)
            if len(accepted) > 1.5 * wanted:
                m = max(8, int(m * 0.9))
            elif len(accepted) < wanted:
                m = min(16384, int(m * 1.1) + 1)
        if regions.batch % 4 == 0:
            for move in (merge, split, move_core, gather):
                move(regions, terms, rng)
                priced += 1
        if regions.batch % rest == 0:
            recore(regions, terms)
        if count is not None:
            bonus += 0.002 * temperature * max(-20, min(20, regions.count - count))
        if regions.batch % 64 == 0:
            check(share)


def _settle(regions, count, alone, check):
    """Repair what is too small and descend with hard thresholds; return a Solution.

    One that is not ``alone`` may have some regions more or fewer than wanted: the choice of its blocks
    gets their number right.
    """
    problem = regions.problem
    _descend(regions, count, check)
    found = regions.current()
    if alone and count is not None and len(found.core) != count:
        found = reach_count(problem, found, count)
        found = _settled(regions, found, count, check)
    return found


def _settled(regions, found, count, check=lambda share: None):
    """What a descent makes of a solution."""
    regions.load(found)
    regions.dirty.update(range(regions.count))
    _descend(regions, count, check)
    return regions.current()


def _descend(regions, count, check):
    regions.weigh()
    recore(regions, HARD)
    repair(regions, fixed=count is not None)
    changed = None  # regions that changed in the last round: only their moves have new prices
    rng = np.random.Generator(np.random.PCG64(0))  # asked only where chance plays no part
    for _ in range(1000):
        regions.batch += 1
        check(1.0)
        v, to = every_move(regions, changed)
        delta = prices(regions, v, to, HARD)
        if count is not None:
            delta[regions.number[regions.region[v]] == 1] = np.inf
        better = np.flatnonzero(delta < -1e-6)
        for k in better[np.argsort(delta[better], kind="stable")].tolist():
            move_area(regions, int(v[k]), int(to[k]), HARD, rng)
        now = regions.stamp == regions.batch
        now[recore(regions, HARD)] = True
        if now.any():
            changed = now
        elif changed is None:
            break
        else:
            changed = None
