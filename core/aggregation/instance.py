"""An aggregation problem as compact arrays, and what a solution of it costs.

The problem of Haunert and Wolff (2010): group areas into contiguous regions; each region is as large
as its class demands, and has the class of its *core*, one of its areas. It costs, for each area v of
a region with core u,

* class change: ``size(v) * distance(class(v), class(u))``,
* centre distance: ``size(v)`` times the root mean square distance of the points of v from the centroid
  of u, ``sqrt(|centroid(v) - centroid(u)|^2 + spread(v))``,

and the length of the boundary between regions (or between classes). The core is the area that makes
this least.

Haunert and Wolff measure the distance between the centroids, ``spread(v) = 0``. An area in one piece
is then billed less than the same area in several, whose centroids lie apart: what is cut looks
worse than it is. The root mean square is true to every point of the area, and cutting cannot raise
it: for parts of sizes w with mean squared distances m from a centre, ``sum(w sqrt(m)) <= sum(w)
sqrt(sum(w m) / sum(w))``, because the square root is concave.
"""

from __future__ import annotations

from typing import Iterable, NamedTuple

import numpy as np

from ..errors import Sentence
from ..rings import groups

__all__ = [
    "Costs",
    "Instance",
    "Solution",
    "away",
    "best_core",
    "build",
    "cheapest_core",
    "components",
    "connected_parts",
    "costs",
    "each_share",
    "enough",
    "hierarchical_distance",
    "problems",
    "shares",
    "solution",
]

FEW_CORES = 32  # areas of a region for which all cores are compared at once


class Instance(NamedTuple):
    """Areas, who is next to whom, and what is wanted. Sizes in m2, lengths in m.

    Attributes
    ----------
    size : (n,) float
    cls : (n,) int
        Class of each area, 0 to K - 1.
    place : (n,) complex
        Centroids, x + iy.
    spread : (n,) float
        Mean squared distance of the points of each area from its centroid, in m2; 0: areas are points.
    start : (n + 1,) int
        The neighbours of area v are ``neighbour[start[v]:start[v + 1]]``, ascending.
    neighbour : (h,) int
    length : (h,) float
        Length of the boundary shared with each.
    distance : (K, K) float
        ``distance[c, d]``: cost of one square metre that changes from class c to d.
    theta : (K,) float
        Smallest size of a region of each class; infinite: no region may have this class.
    change, boundary, centre : float
        Weights of the three costs.
    by_class : bool
        Whether a boundary between two regions of one class is free.
    """

    size: np.ndarray
    cls: np.ndarray
    place: np.ndarray
    spread: np.ndarray
    start: np.ndarray
    neighbour: np.ndarray
    length: np.ndarray
    distance: np.ndarray
    theta: np.ndarray
    change: float
    boundary: float
    centre: float
    by_class: bool

    @property
    def owner(self) -> np.ndarray:
        """(h,) int: the area whose neighbour each entry of ``neighbour`` is."""
        return groups(self.start)


class Solution(NamedTuple):
    """Regions, numbered from 0 by their smallest area.

    Attributes
    ----------
    region : (n,) int
        Region of each area.
    core : (r,) int
        The area of each region that gives it its class and its centre.
    """

    region: np.ndarray
    core: np.ndarray


class Costs(NamedTuple):
    """What a solution costs: the weighted parts, and the plain measures behind them.

    Attributes
    ----------
    change, boundary, centre : float
        The three parts, weighted.
    changed_size : float
        Size of the areas whose class changes.
    weighted_change : float
        Sum of size times class distance.
    region_boundary, class_boundary : float
        Length between regions, and between regions of different class.
    centre_distance : float
        Mean root mean square distance to the core, weighted by size.
    """

    change: float
    boundary: float
    centre: float
    changed_size: float
    weighted_change: float
    region_boundary: float
    class_boundary: float
    centre_distance: float

    @property
    def total(self) -> float:
        """The total cost."""
        return self.change + self.boundary + self.centre


def build(
    size: np.ndarray,
    cls: np.ndarray,
    place: np.ndarray,
    pairs: np.ndarray,
    length: np.ndarray,
    distance: np.ndarray,
    theta: np.ndarray,
    *,
    change: float = 1.0,
    boundary: float = 0.0,
    centre: float = 0.0,
    by_class: bool = False,
    spread: np.ndarray | None = None,
) -> Instance:
    """Return an instance of the problem of Haunert and Wolff (2010).

    Parameters
    ----------
    pairs : (m, 2) int
        Neighbours; each pair may be listed once, twice or in parts.
    length : (m,) float
        What each entry adds to the pair's shared boundary.
    spread : (n,) float, optional
        Default: areas are points.

    The others are attributes of `Instance`.

    Examples
    --------
    Three areas in a row; the one in the middle is of another class, and too small.

    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> row.start.tolist(), row.neighbour.tolist(), row.length.tolist()
    ([0, 1, 3, 4], [1, 0, 2, 1], [2.0, 2.0, 1.0, 1.0])
    """
    n = len(size)
    pairs = np.asarray(pairs, dtype=np.int64).reshape(-1, 2)
    length = np.asarray(length, dtype=float)
    low, high = pairs.min(axis=1), pairs.max(axis=1)
    apart = low != high
    key, place_of = np.unique(low[apart] * n + high[apart], return_inverse=True)
    total = np.bincount(place_of.ravel(), weights=length[apart], minlength=len(key))
    a, b = key // max(n, 1), key % max(n, 1)
    tail, head = np.concatenate((a, b)), np.concatenate((b, a))
    order = np.lexsort((head, tail))
    return Instance(
        size=np.asarray(size, dtype=float),
        cls=np.asarray(cls, dtype=np.int64),
        place=np.asarray(place, dtype=complex),
        spread=np.zeros(n) if spread is None else np.asarray(spread, dtype=float),
        start=np.searchsorted(tail[order], np.arange(n + 1)),
        neighbour=head[order],
        length=np.concatenate((total, total))[order],
        distance=np.asarray(distance, dtype=float),
        theta=np.asarray(theta, dtype=float),
        change=float(change),
        boundary=float(boundary),
        centre=float(centre),
        by_class=bool(by_class),
    )


def hierarchical_distance(codes: list[str]) -> np.ndarray:
    """Class distance from hierarchical codes: the share of the digits after the common beginning.

    Parameters
    ----------
    codes : list of str

    Returns
    -------
    (K, K) float
        0 for equal codes, 1 where the first digit differs; shorter codes are filled up at the end.

    Examples
    --------
    >>> hierarchical_distance(["311", "312", "211"])[0].round(2).tolist()
    [0.0, 0.33, 1.0]
    """
    width = max((len(code) for code in codes), default=1)
    letters = np.array([list(code.ljust(width)) for code in codes]).reshape(len(codes), width)
    same = np.cumprod(letters[:, None, :] == letters[None, :, :], axis=2)
    return 1.0 - same.sum(axis=2) / width


def shares(problem: Instance, areas: np.ndarray, cores: np.ndarray) -> np.ndarray:
    """Cost of each area in a region with each core: class change and centre distance.

    Parameters
    ----------
    areas : (i,) int
    cores : (j,) int

    Returns
    -------
    (i, j) float

    Examples
    --------
    The middle one of three areas is of another class: what each costs with each of two cores.

    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> shares(row, np.array([0, 1, 2]), np.array([0, 1])).tolist()
    [[0.0, 4.0], [1.0, 0.0], [0.0, 5.0]]
    """
    cost = problem.change * problem.distance[problem.cls[areas][:, None], problem.cls[cores]]
    if problem.centre:
        cost = cost + problem.centre * away(
            problem.place[areas][:, None] - problem.place[cores], problem.spread[areas][:, None]
        )
    return cost * problem.size[areas][:, None]


def each_share(problem: Instance, areas: np.ndarray, cores: np.ndarray) -> np.ndarray:
    """Cost of each area in a region with the core beside it; `shares`, elementwise.

    Examples
    --------
    The first two of three areas, each with the next one as its core.

    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> each_share(row, np.array([0, 1]), np.array([1, 2])).tolist()
    [4.0, 1.0]
    """
    cost = problem.change * problem.distance[problem.cls[areas], problem.cls[cores]]
    if problem.centre:
        cost = cost + problem.centre * away(
            problem.place[areas] - problem.place[cores], problem.spread[areas]
        )
    return cost * problem.size[areas]


def away(vector: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Root mean square distance of an area from a point, by the vector from it to the centroid.

    Examples
    --------
    A point, and an area around the same place.

    >>> away(np.array([3 + 4j, 3 + 4j]), np.array([0, 11])).tolist()
    [5.0, 6.0]
    """
    return np.sqrt(vector.real**2 + vector.imag**2 + spread)


def costs(problem: Instance, found: Solution) -> Costs:
    """Return what a solution costs, recomputed from scratch. O(n + h).

    Examples
    --------
    The middle one of three areas changes its class to join the first.

    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> found = costs(row, Solution(np.array([0, 0, 1]), np.array([0, 2])))
    >>> found.total, found.changed_size, found.region_boundary, found.class_boundary
    (1.0, 1.0, 1.0, 0.0)
    """
    core = found.core[found.region]
    kept = problem.cls[core]
    per_size = problem.distance[problem.cls, kept]
    owner = problem.owner
    once = owner < problem.neighbour
    tail, head, length = owner[once], problem.neighbour[once], problem.length[once]
    between = found.region[tail] != found.region[head]
    classes = kept[tail] != kept[head]
    boundary = float(length[between].sum())
    class_boundary = float(length[classes].sum())
    total = float(problem.size.sum())
    change = float(problem.size @ per_size)
    distance = float(problem.size @ away(problem.place - problem.place[core], problem.spread))
    return Costs(
        change=problem.change * change,
        boundary=problem.boundary * (class_boundary if problem.by_class else boundary),
        centre=problem.centre * distance,
        changed_size=float(problem.size[problem.cls != kept].sum()),
        weighted_change=change,
        region_boundary=boundary,
        class_boundary=class_boundary,
        centre_distance=distance / total if total else 0.0,
    )


def components(problem: Instance, label: np.ndarray | None = None) -> np.ndarray:
    """Connected components of the areas, or of the areas of each label.

    Returns
    -------
    (n,) int
        Component of each area, numbered by their smallest areas.

    Examples
    --------
    Three areas in a row; two labels.

    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> components(row).tolist(), components(row, [7, 8, 7]).tolist()
    ([0, 0, 0], [0, 1, 2])
    """
    n = len(problem.size)
    label = [0] * n if label is None else np.asarray(label).tolist()
    start, neighbour = problem.start.tolist(), problem.neighbour.tolist()
    component, count = [-1] * n, 0
    for root in range(n):
        if component[root] >= 0:
            continue
        component[root], stack = count, [root]
        while stack:
            v = stack.pop()
            for u in neighbour[start[v] : start[v + 1]]:
                if component[u] < 0 and label[u] == label[v]:
                    component[u] = count
                    stack.append(u)
        count += 1
    return np.array(component, dtype=np.int64)


def connected_parts(adjacent: list[list[int]], areas: Iterable[int]) -> list[list[int]]:
    """Split some areas into connected parts, as lists; ``adjacent[v]`` are the neighbours of v.

    Examples
    --------
    Of a chain of four areas, the second is not among them.

    >>> connected_parts([[1], [0, 2], [1, 3], [2]], [0, 2, 3])
    [[0], [2, 3]]
    """
    left, parts = set(areas), []
    while left:
        root = min(left)
        left.discard(root)
        part, stack = [root], [root]
        while stack:
            for u in adjacent[stack.pop()]:
                if u in left:
                    left.discard(u)
                    stack.append(u)
                    part.append(u)
        parts.append(part)
    return parts


def solution(problem: Instance, region: np.ndarray) -> Solution:
    """Complete regions by their best cores.

    Parameters
    ----------
    region : (n,) int
        Any labels. The core of each region is the cheapest area with whose class the region is
        large enough; the cheapest of all where there is none. Boundaries between classes are
        counted with the cores chosen so far, in two rounds.

    Returns
    -------
    Solution

    Notes
    -----
    O(sum of m^2) over regions of m areas, O(m) memory.

    Examples
    --------
    The first two of three areas are one region: the larger one is its core.

    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> found = solution(row, [8, 8, 3])
    >>> found.region.tolist(), found.core.tolist()
    ([0, 0, 1], [0, 2])
    """
    _, first, region = np.unique(region, return_index=True, return_inverse=True)
    region = region.ravel()
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first, kind="stable")] = np.arange(len(first))
    region = rank[region]
    order = np.argsort(region, kind="stable")
    starts = np.searchsorted(region[order], np.arange(len(first) + 1))
    groups = [order[lo:hi] for lo, hi in zip(starts[:-1], starts[1:])]
    core = np.empty(len(first), dtype=np.int64)
    for number, members in enumerate(groups):
        core[number] = best_core(problem, members)
    if problem.by_class and problem.boundary:
        for _ in range(2):
            for number, members in enumerate(groups):
                core[number] = best_core(
                    problem, members, _class_lengths(problem, members, region, core, number)
                )
    return Solution(region, core)


def best_core(problem: Instance, members: np.ndarray, class_length: np.ndarray | None = None) -> int:
    """Return the cheapest core of a region; ``class_length`` adds a cost for each class.

    Examples
    --------
    The large area is the core: it would cost more to change its class.

    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> best_core(row, np.array([1, 2]))
    2
    """
    size = problem.size[members].sum()
    kept = problem.cls[members]
    # an excluded class only where there is no other; one too demanding before an excluded one
    theta = problem.theta[kept]
    rank = np.where(enough(size, theta), 0, np.where(np.isfinite(theta), 1, 2))
    extra = np.zeros(len(members)) if class_length is None else class_length[kept]
    extra = np.where(rank == rank.min(), extra, np.inf)
    return int(members[cheapest_core(problem, members, extra)[0]])


def cheapest_core(problem: Instance, members: np.ndarray, extra: np.ndarray) -> tuple[int, float]:
    """Return which of some areas is their cheapest core, and what they cost under it.

    Parameters
    ----------
    members : (m,) int
    extra : (m,) float
        What else each costs as a core; infinite: it may not be one.

    Returns
    -------
    index : int
        Of equal ones the smallest area's.
    cost : float
        With ``extra``.

    Notes
    -----
    O(m^2), but mostly O(m): the sum of the distances to a place is at least the length of the sum of
    the vectors, so that most cores need not be tried.

    Examples
    --------
    Two areas of different classes: the larger one is the core, unless it may not be.

    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> cheapest_core(row, np.array([1, 2]), np.zeros(2))
    (1, 1.0)
    >>> cheapest_core(row, np.array([1, 2]), np.array([0, np.inf]))
    (0, 5.0)
    """
    m = len(members)
    if m <= FEW_CORES:
        cost = shares(problem, members, members).sum(axis=0) + extra
        best = np.lexsort((members, cost))[0]
        return int(best), float(cost[best])
    size, place, kept = problem.size[members], problem.place[members], problem.cls[members]
    by_class = np.bincount(kept, weights=size, minlength=len(problem.theta))
    known = extra + problem.change * (by_class @ problem.distance)[kept]
    vector = (size @ place) - size.sum() * place
    spread = size @ np.sqrt(problem.spread[members])
    least = known + problem.centre * np.sqrt(vector.real**2 + vector.imag**2 + spread**2)
    order = np.argsort(least, kind="stable")
    best = (np.inf, np.inf, -1)
    for lo in range(0, m, 16):
        some = order[lo : lo + 16]
        if least[some[0]] > best[0] * (1.0 + 1e-12):
            break
        cost = known[some]
        if problem.centre:
            cost = cost + problem.centre * (
                size @ away(place[:, None] - place[some], problem.spread[members][:, None])
            )
        for k in np.flatnonzero(cost <= best[0]).tolist():
            best = min(best, (float(cost[k]), int(members[some[k]]), int(some[k])))
    return best[2] if best[2] >= 0 else int(order[0]), best[0]


def enough(size: np.ndarray | float, theta: np.ndarray | float) -> np.ndarray | bool:
    """Whether a size reaches a threshold; sums of sizes may be off by rounding.

    Examples
    --------
    >>> 0.7 + 0.1 + 0.1 + 0.1 >= 1.0, enough(0.7 + 0.1 + 0.1 + 0.1, 1.0), enough(0.9, 1.0)
    (False, True, False)
    """
    return size >= enough_from(theta)


def enough_from(theta: np.ndarray | float) -> np.ndarray | float:
    """The size from which `enough` holds."""
    return theta * (1.0 - 1e-12)


def _class_lengths(problem, members, region, core, number):
    """Weighted boundary of a region if it had each class."""
    slots = np.concatenate([np.arange(problem.start[v], problem.start[v + 1]) for v in members])
    other = region[problem.neighbour[slots]]
    out = other != number
    length = np.bincount(
        problem.cls[core[other[out]]],
        weights=problem.length[slots[out]],
        minlength=len(problem.theta),
    )
    return problem.boundary * (length.sum() - length)


def problems(problem: Instance, found: Solution) -> list[tuple[int, Sentence]]:
    """Check a solution from scratch.

    Returns
    -------
    list of (int, Sentence)
        Regions that are not contiguous, too small, or of a class that none of their areas had.

    Examples
    --------
    The first and the last of three areas in a row are no region, and the one in the middle is too small.

    >>> row = build([4, 1, 5], [0, 1, 0], [0, 2, 4], [[0, 1], [1, 2]], [2, 1], 1 - np.eye(2), [3, 3])
    >>> problems(row, Solution(np.array([0, 1, 0]), np.array([0, 1])))
    [(0, 'not contiguous'), (1, 'too small')]
    """
    result: list[tuple[int, Sentence]] = []
    parts = components(problem, found.region)
    count = len(found.core)
    _, pieces = np.unique(parts, return_index=True)
    broken = np.bincount(found.region[pieces], minlength=count)
    size = np.bincount(found.region, weights=problem.size, minlength=count)
    theta = problem.theta[problem.cls[found.core]]
    for r in range(count):
        if broken[r] != 1:
            result.append((r, Sentence("not contiguous")))
        if found.region[found.core[r]] != r:
            result.append((r, Sentence("core outside")))
        if not enough(size[r], theta[r]):
            result.append((r, Sentence("excluded class") if np.isinf(theta[r]) else Sentence("too small")))
    return result
