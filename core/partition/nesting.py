"""Nested partitions of the features of a chunk: every part of every level, from tau on.

What the QGIS tool ``isthmus:hierarchy`` and ``isthmus.hierarchy`` of the Python package share: `nest` solves
and orders, `items_of` lists what there is to write, and `shapes` makes the geometries.
"""

from __future__ import annotations

from typing import Callable, Iterator, NamedTuple

import numpy as np

from ..errors import Sentence, number_or_none
from ..progress import ignore, stretch
from ..rings import groups, offsets_of, ranges, take
from .features import Pieces, Problem, pieces
from .hierarchy import Hierarchy, Levels, hierarchy, levels
from .parts import Parts, build_parts, merged_parts
from .solve import Selection, select

__all__ = ["NO_END", "Items", "Nested", "cuts", "items_of", "nest", "ranked", "shapes"]

# "Without end": every format stores it, a shapefile's 24 characters too
NO_END = 1e9


class Nested(NamedTuple):
    """The levels of a chunk.

    Attributes
    ----------
    selection, parts : Selection, Parts
        The finest partition of the prepared polygons.
    pieces : Pieces
        The same, and what could not be solved.
    persistence, rank : (s,) float, (s,) int
        Of each selected edge; rank in its feature.
    cuts : (s,) bool
        Those to write.
    levels : Levels
        Of the finest parts.
    tau : (f,) float
        Where the levels of each feature begin.
    ranges : dict
        From and to which tau there is the only level of a feature that is wanted, by feature.
    missed : int
        Features that have no level with so many parts.
    """

    selection: Selection
    parts: Parts
    pieces: Pieces
    persistence: np.ndarray
    rank: np.ndarray
    cuts: np.ndarray
    levels: Levels
    tau: np.ndarray
    ranges: dict
    missed: int


def nest(
    problem: Problem, tau: np.ndarray, *, count: np.ndarray | None = None, check: Callable = ignore
) -> Nested:
    """Solve a chunk and order its cuts.

    Parameters
    ----------
    problem : Problem
        Features with a tau or a number of parts that cannot be are refused.
    tau : (f,) float
        Where the levels of each feature begin.
    count : (f,) float, optional
        The number of parts of the only level that is wanted; NaN for all levels.
    check : callable, optional
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    Nested

    Examples
    --------
    The neck of an hourglass is cut for each tau below 11.4: that is the detour around it.

    >>> from isthmus.core import metric, rings
    >>> from isthmus.core.partition.features import Chunk, prepare
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> nested = nest(problem, np.array([4.0]))
    >>> nested.persistence.round(1).tolist(), nested.rank.tolist(), nested.pieces.area.tolist()
    ([11.4], [1], [60.0, 30.0])
    """
    prepared, features = problem.prepared, problem.chunk.features
    bad = ~((tau >= 1.0) & (tau < NO_END))
    for f in np.flatnonzero(bad).tolist():
        own = number_or_none(tau[f])
        problem.refuse(f, Sentence("tau must be a number from 1 to below {:g}, and is {}", NO_END, own))
    tau = np.where(bad, 1.0, tau)
    wanted = np.full(len(features), np.nan)
    if count is not None:
        wanted = np.array(count, dtype=float)
        bad = (wanted < 1.0) | (wanted != np.floor(wanted)) & ~np.isnan(wanted) | np.isinf(wanted)
        for f in np.flatnonzero(bad).tolist():
            problem.refuse(f, Sentence("PARTS must be a whole number of at least 1, and is {:g}", wanted[f]))
            wanted[f] = np.nan

    selection = select(prepared, tau[problem.owner], check=stretch(check, 0.0, 0.2), with_dilation=False)
    found = hierarchy(prepared, selection, stretch(check, 0.2, 1.0))
    selected, tree = selection.selected, selection.carved.tree
    parts = build_parts(
        prepared.polygons,
        selection.carved.walk,
        selected,
        tree,
        prepared.measure.equal_area,
        over=prepared.over,
    )

    feature = problem.owner[prepared.owner[selected]]
    cuts = problem.solved[prepared.owner[selected]]
    persistence, rank, by_rank = ranked(problem, selected, found, tau, cuts)
    first = np.searchsorted(feature[by_rank], np.arange(len(features) + 1))

    # a cut that goes at once parts nothing; one that never goes parts all levels
    goes = np.where(cuts, np.where(persistence < NO_END, persistence, np.inf), 0.0)
    spans: dict[int, tuple[float, float]] = {}
    missed = 0
    in_tree = np.isin(selected, tree)
    polygons = np.bincount(problem.chunk.owner, minlength=len(features))
    for f in np.flatnonzero(wanted >= 1.0).tolist():
        own = by_rank[first[f] : first[f + 1]]
        own = own[~in_tree[own]]
        kept = int(min(max(wanted[f] - polygons[f], 0), len(own)))
        missed += int(polygons[f] > 0 and polygons[f] + kept != wanted[f])
        goes[own[:kept]], goes[own[kept:]] = np.inf, 0.0
        cuts[own[kept:]] = False
        spans[f] = (
            float(persistence[own[kept]]) if kept < len(own) else float(tau[f]),
            float(persistence[own[kept - 1]]) if kept else NO_END,
        )
    part_polygon = groups(parts.part_offsets)
    return Nested(
        selection=selection,
        parts=parts,
        pieces=pieces(problem, parts),
        persistence=persistence,
        rank=rank,
        cuts=cuts,
        levels=levels(
            found._replace(persistence=goes),
            parts.sides,
            len(part_polygon),
            tau[problem.owner[part_polygon]],
        ),
        tau=tau,
        ranges=spans,
        missed=missed,
    )


class Items(NamedTuple):
    """What to write of a chunk, by feature, level and size; arrays with an entry for each.

    Attributes
    ----------
    feature, number, parent, level : int
        The parent 0 for none.
    from_tau, to_tau, area : float
    part : int
        The part in the levels; -1 for a polygon that could not be solved.
    whole : int
        The polygon of the chunk that it is all of; -1 where it is not.
    """

    feature: np.ndarray
    number: np.ndarray
    parent: np.ndarray
    level: np.ndarray
    from_tau: np.ndarray
    to_tau: np.ndarray
    area: np.ndarray
    part: np.ndarray
    whole: np.ndarray


def ranked(
    problem: Problem, selected: np.ndarray, found: Hierarchy, tau: np.ndarray, counted: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return how persistent selected edges are, and their rank in their feature.

    Parameters
    ----------
    problem : Problem
    selected : (s,) int
    found : hierarchy.Hierarchy
        Of these.
    tau : (f,) float
        Where the levels of each feature begin.
    counted : (s,) bool
        The edges that have a rank.

    Returns
    -------
    persistence : (s,) float
    rank : (s,) int
        1 for the most persistent of a feature; 0 for those without.
    order : (c,) int
        Those with a rank, by feature and rank.

    Examples
    --------
    The one cut of an hourglass, which is needed for each tau below 11.4.

    >>> from isthmus.core import metric, rings
    >>> from isthmus.core.partition.features import Chunk, prepare
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> tau = np.array([4.0])
    >>> selection = select(problem.prepared, tau)
    >>> found = hierarchy(problem.prepared, selection)
    >>> persistence, rank, _ = ranked(problem, selection.selected, found, tau, np.array([True]))
    >>> persistence.round(1).tolist(), rank.tolist()
    ([11.4], [1])
    """
    owner = problem.prepared.owner[selected]
    feature = problem.owner[owner]
    # the finest level has all cuts, though in another T one may turn out not to be needed
    persistence = np.clip(found.persistence, np.nextafter(tau[feature], np.inf), NO_END)
    order = np.lexsort((found.rank, owner, -persistence, feature))
    order = order[counted[order]]
    rank = np.zeros(len(selected), dtype=np.int64)
    first = np.searchsorted(feature[order], np.arange(len(tau) + 1))
    rank[order] = np.arange(len(order)) - first[feature[order]] + 1
    return persistence, rank, order


def items_of(problem: Problem, nested: Nested) -> Items:
    """List the parts of all levels of a chunk, and the polygons that could not be solved.

    Examples
    --------
    The two parts of an hourglass, below a tau of 11.4, and from there on their parent, number 3.

    >>> from isthmus.core import metric, rings
    >>> from isthmus.core.partition.features import Chunk, prepare
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> items = items_of(problem, nest(problem, np.array([4.0])))
    >>> for name in ("number", "parent", "level", "from_tau", "area"):
    ...     print(name, getattr(items, name).round(1).tolist())
    number [1, 2, 3]
    parent [3, 3, 0]
    level [0, 0, 1]
    from_tau [4.0, 4.0, 11.4]
    area [60.0, 30.0, 90.0]
    """
    prepared, made, parts = problem.prepared, nested.levels, nested.parts
    count = len(parts.area)
    of_part = groups(parts.part_offsets)
    summed = [*parts.area.tolist(), *[0.0] * (len(made.parent) - count)]
    for k, whole_of in enumerate(made.parent.tolist()):  # comes after its pieces
        if whole_of >= 0:
            summed[whole_of] += summed[k]
    area = np.array(summed)
    polygon = of_part[made.leaf[made.first]]
    number = prepared.polygons.number[polygon]
    shown = np.flatnonzero((made.from_tau < made.to_tau) & (problem.verdict[number] == ""))
    # those that could not be solved
    left = np.flatnonzero(problem.verdict != "")
    of_piece = problem.verdict[nested.pieces.polygon] != ""
    left_area = np.zeros(len(problem.verdict))
    left_area[nested.pieces.polygon[of_piece]] = nested.pieces.area[of_piece]

    part = np.append(shown, np.full(len(left), -1))
    all_of_it = (made.last - made.first == np.diff(parts.part_offsets)[polygon])[shown]
    whole = np.append(np.where(all_of_it, number[shown], -1), left)
    area = np.append(area[shown], left_area[left])
    feature = problem.chunk.owner[np.append(number[shown], left)]
    from_tau = np.append(made.from_tau[shown], nested.tau[problem.chunk.owner[left]])
    to_tau = np.append(np.minimum(made.to_tau[shown], NO_END), np.full(len(left), NO_END))
    order = np.lexsort((part, -area, from_tau, feature))
    part, whole, area, feature, from_tau, to_tau = (
        x[order] for x in (part, whole, area, feature, from_tau, to_tau)
    )

    new_feature = np.diff(feature, prepend=-1) != 0
    first = np.maximum.accumulate(np.where(new_feature, np.arange(len(order)), 0))
    place = np.arange(len(order)) - first + 1
    steps = np.cumsum((np.diff(from_tau, prepend=0.0) != 0) & ~new_feature)
    place_of = np.zeros(len(made.parent) + 1, dtype=np.int64)  # the last one is for no parent
    place_of[part[part >= 0]] = place[part >= 0]
    parent = np.append(made.parent, -1)[part]
    for f, (least, most) in nested.ranges.items():
        from_tau[feature == f], to_tau[feature == f] = least, most
    return Items(feature, place, place_of[parent], steps - steps[first], from_tau, to_tau, area, part, whole)


def cuts(problem: Problem, nested: Nested) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Return the feature of each cut, the candidate that it is, and what is told of it, by feature and rank.

    The fields are length, detour (infinite where only a cut connects the ends), persistence and rank.

    Examples
    --------
    The neck of an hourglass: it is 2 wide, and the way around is 11.4 times as long.

    >>> from isthmus.core import metric, rings
    >>> from isthmus.core.partition.features import Chunk, prepare
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> feature, edges, fields = cuts(problem, nest(problem, np.array([4.0])))
    >>> problem.prepared.edge_rows[edges].tolist()
    [[1, 4]]
    >>> [(name, values.round(1).tolist()) for name, values in fields.items()]
    [('length', [2.0]), ('detour', [11.4]), ('persistence', [11.4]), ('rank', [1])]
    """
    prepared, selected = problem.prepared, nested.selection.selected
    which = np.flatnonzero(nested.cuts)
    feature = problem.owner[prepared.owner[selected[which]]]
    order = np.lexsort((nested.rank[which], feature))
    which, feature = which[order], feature[order]
    edges = selected[which]
    return (
        feature,
        edges,
        {
            "length": prepared.chord[edges],
            "detour": prepared.detour[edges],
            "persistence": nested.persistence[which],
            "rank": nested.rank[which],
        },
    )


def shapes(problem: Problem, nested: Nested, items: Items, polygons: Callable[..., Iterator]) -> Iterator:
    """Yield the geometry of each item.

    Parameters
    ----------
    problem, nested, items
    polygons : callable
        ``(which, rows, offsets, ring_offsets)`` to the geometries of the items ``which``.

    Examples
    --------
    The two parts of an hourglass, and all of it, as rows of their only rings.

    >>> from isthmus.core import metric, rings
    >>> from isthmus.core.partition.features import Chunk, prepare
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> def polygons(which, rows, offsets, ring_offsets):
    ...     return (rows[lo:hi].tolist() for lo, hi in zip(offsets[:-1], offsets[1:]))
    >>> nested = nest(problem, np.array([4.0]))
    >>> list(shapes(problem, nested, items_of(problem, nested), polygons))
    [[1, 2, 3, 4], [0, 1, 4, 5], [0, 1, 2, 3, 4, 5]]
    """
    chunk, made, parts = problem.chunk, nested.levels, nested.parts
    rings, carved = chunk.rings, nested.selection.carved

    def taken(which, groups, rows, offsets, ring_offsets):
        ring, ring_offsets = take(ring_offsets, groups)
        row, offsets = take(offsets, ring)
        return polygons(which, rows[row], offsets, ring_offsets)

    def unions(which):
        own = items.part[which]
        size = made.last[own] - made.first[own]
        lo = 0
        for rows, offsets, ring_offsets in merged_parts(
            problem.prepared.polygons,
            carved.walk,
            nested.selection.selected,
            carved.tree,
            parts,
            made.leaf[ranges(made.first[own], size)],
            offsets_of(size),
            over=problem.prepared.over,
        ):
            hi = lo + len(ring_offsets) - 1
            yield from polygons(which[lo:hi], rows, offsets, ring_offsets)
            lo = hi

    kind = np.where(items.whole >= 0, 0, np.where(items.part < len(parts.area), 1, 2))
    whole, finest, merged = (np.flatnonzero(kind == k) for k in range(3))
    of_kind = (
        taken(whole, items.whole[whole], np.arange(len(rings.coords)), rings.offsets, rings.polygon_offsets),
        taken(finest, items.part[finest], parts.rows, parts.offsets, parts.ring_offsets),
        unions(merged),
    )
    for k in kind.tolist():
        yield next(of_kind[k])
