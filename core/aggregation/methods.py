"""The three methods of aggregation behind one call."""

from __future__ import annotations

import contextlib
from time import perf_counter
from typing import Callable, NamedTuple

from ..errors import MissingEngine
from ..progress import ignore
from .annealing import annealing
from .exact import Exact, exact, exact_where_small
from .greedy import greedy, reach_count
from .instance import Instance, Solution

__all__ = ["Aggregated", "by_method"]

FIRST = 0.25  # share of the time of 'exact' that goes to the annealing it starts from, at most


class Aggregated(NamedTuple):
    """What a method made.

    Attributes
    ----------
    found : Solution
    exact : Exact or None
        What the exact method tells of it.
    islands : int
        Annealing: on how many islands of a few areas the exact method was used, and proved its result.
    """

    found: Solution
    exact: Exact | None = None
    islands: int = 0


def by_method(
    problem: Instance,
    method: str,
    *,
    seed: int = 1,
    iterations: int = 0,
    seconds: float = 0.0,
    count: int | None = None,
    decompose: bool = True,
    check: Callable = ignore,
) -> Aggregated:
    """Aggregate by one of `presets.METHODS`.

    Parameters
    ----------
    problem : Instance
    method : str
        'greedy', 'annealing', or 'exact', which starts from a short annealing. Where nothing limits it, and
        the solver is there, 'annealing' leaves islands of a few areas to 'exact'.
    seed, iterations, seconds
        See `annealing.annealing`; 0 iterations are 10,000 an area, 0 seconds no limit. A limit of time
        stands instead of a number of iterations. For 'exact' it is that of all, 60 if 0.
    count : int, optional
        Number of regions wanted; not used by 'exact'.
    decompose : bool
        See `exact.exact`.
    check : callable, optional
        Called now and then with the share done; may raise to stop.

    Returns
    -------
    Aggregated

    Raises
    ------
    MissingEngine
        If 'exact' lacks its solver.

    Examples
    --------
    The small area in the middle joins the one with which it shares the longer boundary.

    >>> from isthmus.core.aggregation.instance import build
    >>> pairs, distance = [[0, 1], [1, 2]], 1 - np.eye(2)
    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], pairs, [2, 1], distance, [3, 3], boundary=1)
    >>> found = by_method(row, "greedy").found
    >>> found.region.tolist(), found.core.tolist()
    ([0, 0, 1], [0, 2])
    """
    if method == "greedy":
        found = greedy(problem, check)
        return Aggregated(reach_count(problem, found, count, check) if count else found)
    if method == "annealing":
        found = annealing(
            problem,
            seed=seed,
            iterations=None if seconds else iterations or None,
            seconds=seconds or None,
            count=count,
            check=check,
        )
        islands = 0
        if not (count or iterations or seconds):
            with contextlib.suppress(MissingEngine):
                found, islands = exact_where_small(problem, found, check)
        return Aggregated(found, None, islands)
    limit, began = seconds or 60.0, perf_counter()
    begin = annealing(
        problem, seed=seed, iterations=3000 * len(problem.size), seconds=FIRST * limit, check=check
    )
    result = exact(
        problem,
        seconds=max(0.0, limit - (perf_counter() - began)),
        decompose=decompose,
        begin=begin,
        check=check,
    )
    return Aggregated(result.found, result)
