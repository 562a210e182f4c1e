"""Relevant edges: which diagonals hold a map together (section 5.1 of the paper).

Candidates are the diagonals of a constrained Delaunay triangulation of each polygon, for every rule
the same. Rules: the optimal sets of this project, the greedy heuristic of van Dijk et al. (2013)
and the proximity rule of Harrie and Sarjakoski (2002).
"""

from __future__ import annotations

from functools import partial
from typing import Callable

import numpy as np

from ..errors import Unsolvable
from ..partition import polygon as polygon_stage
from ..partition.carving import carve, spanning_tree
from ..partition.min_size import SELF
from ..partition.polygon import boundary_components
from ..partition.solve import AMBIGUOUS, partition
from ..partition.triangulation import diagonals, triangulate
from ..rings import signed_areas

__all__ = ["RULES", "greedy", "min_length", "min_size", "proximity", "rule_of", "select"]

HOPS = 8  # Harrie and Sarjakoski: an edge needs a way of at least so many segments
GAP, SECONDS = 0.001, 20.0  # of MinLength: relative, and for one polygon
REACH = 0.02  # their largest length, as a share of the diagonal of the map's extent


def min_size(
    coords: np.ndarray,
    offsets: np.ndarray,
    tau: float,
    check: Callable,
    *,
    natural: bool = False,
    smallest: float = 0.0,
) -> np.ndarray:
    """Return the fewest diagonals that keep every detour within tau (Theorem 1 of the paper).

    Parameters
    ----------
    coords, offsets
        Rings of one polygon, see `polygon.one`.
    tau : float
        At least 1.
    check : callable
        Called now and then; may raise `Cancelled`.
    natural : bool
        Whether only natural diagonals are candidates, see `natural.natural`; else all.
    smallest : float
        Share of the polygon's area; smaller parts are not cut off.

    Returns
    -------
    (s, 2) int
        Rows of ``coords`` at the ends.

    Examples
    --------
    An hourglass: the way around either half is much longer than across its waist, between rows 1 and 4.

    >>> hourglass = np.array([(0, 0), (10, 4), (20, 0), (20, 10), (10, 5), (0, 9.0)])
    >>> min_size(hourglass, [0, 6], 2.0, lambda: None).tolist()
    [[1, 4]]
    >>> min_size(hourglass, [0, 6], 50.0, lambda: None).tolist()
    []
    """
    solution = partition(
        coords, offsets, tau, natural=natural, smallest=_area(coords, offsets, smallest), over_islands=False,
        cancelled=_asks(check),
    )  # fmt: skip
    return solution.edge_rows[solution.role == SELF]


def min_length(
    coords: np.ndarray,
    offsets: np.ndarray,
    tau: float,
    check: Callable,
    *,
    natural: bool = False,
    smallest: float = 0.0,
) -> np.ndarray:
    """Return diagonals of least total length that keep every detour within tau.

    Parameters, returns: see `min_size`.

    Notes
    -----
    MinLength of section 4.4 of the paper, where it is shown to be weakly NP-hard: within `GAP` of the
    optimum, or what is found in `SECONDS`.

    Examples
    --------
    The waist of an hourglass, between rows 1 and 4:

    >>> hourglass = np.array([(0, 0), (10, 4), (20, 0), (20, 10), (10, 5), (0, 9.0)])
    >>> min_length(hourglass, [0, 6], 2.0, lambda: None).tolist()
    [[1, 4]]
    """
    solution = partition(
        coords, offsets, tau, natural=natural, smallest=_area(coords, offsets, smallest), over_islands=False,
        weigh=lambda prepared: prepared.chord, max_gap=GAP, time_limit=SECONDS, cancelled=_asks(check),
    )  # fmt: skip
    return solution.edge_rows[solution.role == SELF]


def greedy(coords: np.ndarray, offsets: np.ndarray, tau: float, check: Callable) -> np.ndarray:
    """Return the diagonals of van Dijk et al. (2013): add that of largest dilation until none is above tau.

    Parameters, returns: see `min_size`.

    Notes
    -----
    An added diagonal splits the polygon in two, and no shortest path between two points of one part
    needs the other: so each part goes on by itself, and the dilation of a diagonal is the shorter
    way around its part over its length. O(n) for each edge added, less as the parts get smaller.
    A polygon with holes is first joined by a shortest spanning tree (section 4.3).

    Examples
    --------
    The waist of an hourglass, between rows 1 and 4:

    >>> hourglass = np.array([(0, 0), (10, 4), (20, 0), (20, 10), (10, 5), (0, 9.0)])
    >>> greedy(hourglass, [0, 6], 2.0, lambda: None).tolist()
    [[1, 4]]
    """
    polygon, edges = _candidates(coords, offsets)
    component = boundary_components(polygon)
    length = np.hypot(*(polygon.xy[edges[:, 0]] - polygon.xy[edges[:, 1]]).T)
    wanted = np.zeros(len(component), dtype=bool)
    wanted[component] = True
    tree, _ = spanning_tree(polygon, component, edges, length, wanted)
    walk, ambiguous = carve(polygon, component, edges, tree, wanted)
    if ambiguous[0]:
        raise Unsolvable(AMBIGUOUS)
    free = np.ones(len(edges), dtype=bool)
    free[tree] = False
    free = np.flatnonzero(free)

    xy = polygon.xy[polygon.vertex[walk.corner]]
    step = np.hypot(*(np.roll(xy, -1, axis=0) - xy).T)
    chosen = [tree]
    # a part: the distance from each of its places to the next, and its candidates
    parts = [(step, walk.i[free], walk.j[free], free)]
    while parts:
        check()
        step, i, j, edge = parts.pop()
        along = np.append(0.0, np.cumsum(step))
        arc = along[j] - along[i]
        dilation = np.minimum(arc, along[-1] - arc) / length[edge]
        worst = int(np.argmax(dilation)) if len(edge) else -1
        if worst < 0 or dilation[worst] <= tau * (1.0 + 1e-12):
            continue
        chosen.append(edge[worst : worst + 1])
        a, b, cut = i[worst], j[worst], length[edge[worst]]
        within = (i >= a) & (j <= b)
        within[worst] = False
        beyond = ~within
        beyond[worst] = False
        parts.append((np.append(step[a:b], cut), i[within] - a, j[within] - a, edge[within]))
        shift = b - a - 1
        parts.append(
            (
                np.concatenate((step[:a], [cut], step[b:])),
                i[beyond] - np.where(i[beyond] >= b, shift, 0),
                j[beyond] - np.where(j[beyond] >= b, shift, 0),
                edge[beyond],
            )
        )
    return _rows(polygon, edges[np.sort(np.concatenate(chosen))])


def proximity(coords: np.ndarray, offsets: np.ndarray, reach: float, check: Callable) -> np.ndarray:
    """Return the diagonals of Harrie and Sarjakoski (2002): shorter than ``reach``, with no short way.

    Parameters
    ----------
    coords, offsets, check
        See `min_size`.
    reach : float

    Returns
    -------
    (s, 2) int

    Notes
    -----
    A way is short if it has fewer than `HOPS` segments of the outline: k in section 5.1 of the paper, where
    ``reach`` is epsilon.

    Examples
    --------
    The waist of an hourglass is 1 wide. Where the way around has few segments, it is no edge; where each
    side is of four pieces, it is.

    >>> hourglass = np.array([(0, 0), (10, 4), (20, 0), (20, 10), (10, 5), (0, 9.0)])
    >>> proximity(hourglass, [0, 6], 2.0, lambda: None).tolist()
    []
    >>> between = np.linspace(hourglass, np.roll(hourglass, -1, axis=0), 5)[:-1]
    >>> dense = between.transpose(1, 0, 2).reshape(-1, 2)
    >>> proximity(dense, [0, 24], 2.0, lambda: None).tolist(), dense[[4, 16]].tolist()
    ([[4, 16]], [[10.0, 4.0], [10.0, 5.0]])
    """
    polygon, edges = _candidates(coords, offsets)
    check()
    length = np.hypot(*(polygon.xy[edges[:, 0]] - polygon.xy[edges[:, 1]]).T) * polygon.unit[0]
    edges = edges[length < reach]
    corner = np.empty(len(polygon.xy), dtype=np.int64)
    corner[polygon.vertex] = np.arange(len(polygon.vertex))
    ring = polygon.ring_of_corner[corner[edges]]
    hops = np.abs(corner[edges[:, 0]] - corner[edges[:, 1]])
    around = np.diff(polygon.offsets)[ring[:, 0]]
    short = (ring[:, 0] == ring[:, 1]) & (np.minimum(hops, around - hops) < HOPS)
    return _rows(polygon, edges[~short])


RULES = ("MinSize", "MinLength", "Greedy", "Proximity", "None")


def select(
    rule: str | Callable, coords: np.ndarray, offsets: np.ndarray, tau: float, extent: float, check: Callable
) -> np.ndarray:
    """Return the relevant edges of one polygon by one of the `RULES`.

    Parameters
    ----------
    rule : str or callable
        A name, or a function that is called as `min_size` is.
    coords, offsets, tau, check
        See `min_size`.
    extent : float
        The diagonal of the map's extent.

    Returns
    -------
    (s, 2) int

    Raises
    ------
    Unsolvable

    Examples
    --------
    The waist of an hourglass, between rows 1 and 4:

    >>> hourglass = np.array([(0, 0), (10, 4), (20, 0), (20, 10), (10, 5), (0, 9.0)])
    >>> select("MinSize", hourglass, [0, 6], 2.0, 22.4, lambda: None).tolist()
    [[1, 4]]
    >>> select("None", hourglass, [0, 6], 2.0, 22.4, lambda: None).tolist()
    []
    """
    if callable(rule):
        return rule(coords, offsets, tau, check)
    if rule == "MinSize":
        return min_size(coords, offsets, tau, check)
    if rule == "MinLength":
        return min_length(coords, offsets, tau, check)
    if rule == "Greedy":
        return greedy(coords, offsets, tau, check)
    if rule == "Proximity":
        return proximity(coords, offsets, REACH * extent, check)
    return np.empty((0, 2), dtype=np.int64)


def _candidates(coords, offsets):
    """A polygon, and the diagonals of its triangulation."""
    polygon = polygon_stage.one(coords, offsets)
    triangles, (problem,), _ = triangulate(polygon)
    if problem:
        raise Unsolvable(problem)
    return polygon, diagonals(polygon, triangles)


def _area(coords, offsets, share):
    """A share of a polygon's area."""
    size = np.abs(signed_areas(np.asarray(coords, dtype=float)[:, :2], np.asarray(offsets)))
    return share * (2.0 * size[0] - size.sum())


def _rows(polygon, edges):
    """Input rows at the ends of edges."""
    row = np.empty(len(polygon.xy), dtype=np.int64)
    row[polygon.vertex] = polygon.rows[polygon.row_start[:-1]]
    return row[edges]


def _asks(check):
    """``check`` as the question that `partition` asks."""

    def cancelled():
        check()
        return False

    return cancelled


def rule_of(name: str, *, natural: bool = False, smallest: float = 0.0) -> str | Callable:
    """Return a rule for `select`: one of `RULES`, for MinSize and MinLength with what may be an edge.

    Parameters
    ----------
    name : str
    natural : bool
        Whether only those diagonals are candidates where people would cut.
    smallest : float
        The smallest part, as a share of each polygon.

    Examples
    --------
    The waist of an hourglass, between rows 1 and 4, but not where a half of it is too small:

    >>> hourglass = np.array([(0, 0), (10, 4), (20, 0), (20, 10), (10, 5), (0, 9.0)])
    >>> select(rule_of("MinSize"), hourglass, [0, 6], 2.0, 22.4, lambda: None).tolist()
    [[1, 4]]
    >>> select(rule_of("MinSize", smallest=0.6), hourglass, [0, 6], 2.0, 22.4, lambda: None).tolist()
    []
    """
    function = {"MinSize": min_size, "MinLength": min_length}.get(name)
    return name if function is None else partial(function, natural=natural, smallest=smallest)
