"""The whole road of one polygon through the stages: rings in, parts and cuts out.

`partition` walks it once. `prepare` and `select` let the dual problem and the trade-off curve solve
for many tau on one triangulation; `finish` makes the parts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .. import metric
from .candidates import Lines, counted, from_lines, from_triangulation
from .carving import Walk, carve, components, spanning_tree
from .dilation import at_least_one, boundary_graph, detours, drop_redundant, largest_dilation, true_dilations
from .dual_tree import build_tree
from .min_size import LEAF, ROOT, SELF, Network, min_size, network, witness_lengths
from .min_weight import min_weight
from .parts import Parts, build_parts
from .polygon import Polygon, from_rings
from ..progress import checker, ignore, stretch

__all__ = ["Partition", "Prepared", "Selection", "finish", "partition", "prepare", "select"]


class Prepared(NamedTuple):
    """A polygon with its candidates, ready to be solved for any tau.

    Lengths are in units of the metric divided by ``polygon.unit``.

    Attributes
    ----------
    polygon : Polygon
    measure : metric.Metric
    position : (n, k) float
        Where the vertices are, for ``measure.length``.
    component, wanted : (r,) int, set of int
        Boundary component of each ring, and which of them count.
    edges : (k, 2) int
        Candidate edges and edges of T.
    length, detour : (k,) float
    bounded : (k,) bool
        The candidates proper: an edge of T shorter than the least length is none.
    edge_length : (c,) float
        Length of the polygon edge that leaves each corner.
    carved : Carved
    lines : Lines or None
        What became of the lines given as candidates.
    """

    polygon: Polygon
    measure: metric.Metric
    position: np.ndarray
    component: np.ndarray
    wanted: set
    edges: np.ndarray
    length: np.ndarray
    detour: np.ndarray
    bounded: np.ndarray
    edge_length: np.ndarray
    carved: Carved
    lines: Lines | None

    @property
    def edge_rows(self):
        """(k, 2) int: input rows at the ends of the edges."""
        row = np.empty(len(self.polygon.xy), dtype=np.int64)
        row[self.polygon.vertex] = self.polygon.rows[self.polygon.row_start[:-1]]
        return row[self.edges]

    @property
    def has_holes(self):
        """Whether distances on the carved polygon are only upper bounds."""
        return len(self.polygon.offsets) > 2


class Carved(NamedTuple):
    """A polygon carved open along T (section 4.3).

    Attributes
    ----------
    tree : (t,) int
        The edges of T, ascending.
    free : (f,) int
        All other edges.
    walk : Walk
    net : Network
        Its nodes are the free edges.
    """

    tree: np.ndarray
    free: np.ndarray
    walk: Walk
    net: Network

    @property
    def node_edge(self):
        """(f,) int: the edge of each node but the root."""
        return self.free[self.net.tree.diagonal]


class Selection(NamedTuple):
    """A solution S.

    Attributes
    ----------
    selected : (s,) int
        The edges in S, ascending.
    carved : Carved
        With a T that is part of S.
    cost, lower_bound : float
        What S costs, and what a solution for the carved polygon must cost.
    dilation : float or None
        The largest dilation of a candidate in P and S, if it was asked for.
    """

    selected: np.ndarray
    carved: Carved
    cost: float
    lower_bound: float
    dilation: float | None


class Partition(NamedTuple):
    """A solved polygon.

    Candidate edges are those whose dilation is bounded, and the edges of T; vertices count as in
    ``polygon.xy``.

    Attributes
    ----------
    polygon : Polygon
    edges : (k, 2) int
        Ends of the candidate edges.
    edge_rows : (k, 2) int
        Input rows at these ends.
    length : (k,) float
        In units of the metric.
    detour : (k,) float
        Dilation in P before any cut; infinite where only a cut connects the ends.
    dilation : (k,) float or None
        Dilation in P and S, if it was asked for.
    largest_dilation : float
        The largest of these (1 if there are no candidates).
    cost, lower_bound : float
        What the selected edges cost (MinSize: their number), and what they must cost at least;
        for a polygon with holes, on the polygon carved open.
    role : (k,) int
        SELF (in S), LEAF or ROOT: on which side the witness lies.
    parts : Parts
        Its ``sides`` belong to the edges with role SELF, in their order.
    lines : Lines or None
        What became of the lines given as candidates.
    """

    polygon: Polygon
    edges: np.ndarray
    edge_rows: np.ndarray
    length: np.ndarray
    detour: np.ndarray
    dilation: np.ndarray | None
    largest_dilation: float
    cost: float
    lower_bound: float
    role: np.ndarray
    parts: Parts
    lines: Lines | None


def partition(
    coords,
    offsets,
    tau=4.0,
    min_length=0.0,
    min_hole=0.0,
    lines=None,
    measure=None,
    engine=None,
    weigh=None,
    max_gap=0.001,
    time_limit=None,
    all_dilations=False,
    progress=None,
    cancelled=None,
):
    """Partition a polygon at its bottlenecks with the cheapest cuts.

    Parameters
    ----------
    coords : (k, d) float, d >= 2
        The rings' vertices, the shell's first, without closing rows: x, y and what rides along.
    offsets : (r + 1,) int
        Ring i is ``coords[offsets[i]:offsets[i + 1]]``.
    tau : float
        Largest dilation allowed for each candidate edge, at least 1.
    min_length : float
        Candidates shorter than this are dropped (section 4.2 of the paper); a hole may still be
        connected by one.
    min_hole : float
        Holes with a smaller area stay holes of a part; no cut is attached to them.
    lines : (l, 2, 2) float, optional
        Ends of the candidates to use instead of a triangulation's diagonals; those that are no
        diagonals are left out (see `candidates.from_lines`).
    measure : metric.Metric, optional
        Default: `metric.planar()`.
    engine : str, optional
        See `triangulation.diagonals`.
    weigh : callable, optional
        Weighs the candidates for MinWeight: called with the prepared polygon, it returns (k,)
        weights >= 0; ``lambda prepared: prepared.length`` gives MinLength. Default: MinSize.
    max_gap, time_limit : float
        See `select`.
    all_dilations : bool
        Whether ``dilation`` is wanted. On large polygons with many holes it takes time.
    progress : callable, optional
        Called with the share done, 0 to 1.
    cancelled : callable, optional
        Asked now and then; true stops the run.

    Returns
    -------
    Partition

    Raises
    ------
    Unsolvable
        If the polygon cannot be partitioned; it says why.
    Cancelled, MissingEngine

    Notes
    -----
    O(n) after validation, triangulation and sorting, for polygons without holes. Optimal for these
    (Theorem 1), a heuristic with checked dilations for polygons with holes (section 4.3).
    """
    check = checker(progress, cancelled)
    prepared = prepare(
        coords, offsets, min_length, min_hole, lines, measure, engine, stretch(check, 0.0, 0.65)
    )
    weight = None if weigh is None else weigh(prepared)
    selection = select(
        prepared, tau, weight, max_gap, time_limit, stretch(check, 0.65, 0.9), False
    )
    result = finish(prepared, selection, all_dilations, stretch(check, 0.9, 1.0))
    check(1.0)
    return result


def prepare(
    coords, offsets, min_length=0.0, min_hole=0.0, lines=None, measure=None, engine=None, check=None
):
    """Triangulate a polygon, connect its holes and carve it open.

    Parameters
    ----------
    coords, offsets, min_length, min_hole, lines, measure, engine
        See `partition`.
    check : callable, optional
        Called with the share done; may raise `Cancelled`.

    Returns
    -------
    Prepared

    Raises
    ------
    Unsolvable, MissingEngine
    """
    measure = measure or metric.planar()
    check = check or ignore
    check(0.0)
    polygon = from_rings(coords, offsets)
    position = measure.positions(polygon.xy)
    check(0.15)
    component = components(polygon)
    wanted, attachable = counted(polygon, component, measure.equal_area, min_hole)
    if lines is None:
        accepted = None
        edges = from_triangulation(polygon, component, wanted, measure.conformal, engine)
    else:
        accepted = from_lines(polygon, lines)
        edges = accepted.edges
    check(0.8)

    kept = attachable[edges].all(axis=1) if min_hole > 0.0 else np.ones(len(edges), dtype=bool)
    length = measure.length(position, edges[:, 0], edges[:, 1])
    tree = np.empty(0, dtype=np.int64)
    if len(wanted) > 1:
        joining = np.flatnonzero(kept)
        tree = joining[
            spanning_tree(polygon, component, edges[joining], length[joining], wanted)
        ]
    bounded = kept & (length * polygon.unit >= min_length)
    needed = bounded | _mask(tree, len(edges))
    if not needed.all():
        edges, length, bounded = edges[needed], length[needed], bounded[needed]
        tree = np.searchsorted(np.flatnonzero(needed), tree)
        if accepted is not None:
            accepted = accepted._replace(edge_line=accepted.edge_line[needed])
    edge_length = measure.length(position, polygon.vertex, polygon.vertex[polygon.next_corner])
    prepared = Prepared(
        polygon=polygon,
        measure=measure,
        position=position,
        component=component,
        wanted=wanted,
        edges=edges,
        length=length,
        detour=detours(polygon, edge_length, edges, length),
        bounded=bounded,
        edge_length=edge_length,
        carved=None,
        lines=accepted,
    )
    return prepared._replace(carved=_carve(prepared, tree))


@np.errstate(over="ignore")  # a tau of 1e300 is as good as none
def select(
    prepared, tau, weight=None, max_gap=0.001, time_limit=None, check=None, with_dilation=True
):
    """Choose the edges to cut.

    Parameters
    ----------
    prepared : Prepared
    tau : float
        Largest dilation allowed.
    weight : (k,) float, optional
        Weight of each edge for MinWeight; MinSize without.
    max_gap : float
        For MinWeight: largest accepted gap between cost and lower bound, as a share of the cost.
    time_limit : float, optional
        For MinWeight: seconds after which the best solution so far is taken, with its gap.
    check : callable, optional
        Called now and then; may raise `Cancelled`.
    with_dilation : bool
        Whether ``dilation`` is wanted.

    Returns
    -------
    Selection
    """
    check = check or ignore
    check(0.0)
    carved = prepared.carved
    search = stretch(check, 0.0, 0.8)
    cut = min_size(carved.net, tau, search if weight is None else check) == SELF
    lower_bound = float(np.count_nonzero(cut[1:]) + len(carved.tree))
    if weight is not None:
        # a MinSize solution to begin with: the result never costs more
        cut, lower_bound = min_weight(
            carved.net,
            np.append(0.0, weight[carved.node_edge]),
            tau,
            max_gap,
            cut,
            time_limit,
            search,
        )
        lower_bound += float(weight[carved.tree].sum())
    selected = np.sort(np.append(carved.tree, carved.node_edge[cut[1:]]))
    check(0.8)
    if prepared.has_holes:
        selected, carved = _without_redundant(prepared, carved, selected, tau, weight, check)
        if weight is not None:
            # which cuts turn out to be redundant is a matter of luck: never end up dearer
            fewest = select(prepared, tau, check=check, with_dilation=False)
            if weight[fewest.selected].sum() < weight[selected].sum():
                selected, carved = fewest.selected, fewest.carved
    dilation = None
    if with_dilation:
        _, bound = _witnesses(prepared, carved, selected, check)
        dilation = _largest_dilation(prepared, selected, bound, check)
    cost = float(len(selected) if weight is None else weight[selected].sum())
    return Selection(selected, carved, cost, min(lower_bound, cost), dilation)


def finish(prepared, selection, all_dilations=False, check=None):
    """Make the parts of a solution.

    Parameters
    ----------
    prepared : Prepared
    selection : Selection
    all_dilations : bool
        See `partition`.
    check : callable, optional
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    Partition
    """
    check = check or ignore
    polygon, carved = prepared.polygon, selection.carved
    role, dilation = _witnesses(prepared, carved, selection.selected, check)
    largest = selection.dilation
    if largest is None:
        largest = _largest_dilation(prepared, selection.selected, dilation, check)
    if prepared.has_holes:
        dilation = true_dilations(
            _graph(prepared, selection.selected), prepared.edges, prepared.length, dilation, check
        ) if all_dilations else None
    check()
    return Partition(
        polygon=polygon,
        edges=prepared.edges,
        edge_rows=prepared.edge_rows,
        length=prepared.length * polygon.unit,
        detour=prepared.detour,
        dilation=dilation,
        largest_dilation=largest,
        cost=selection.cost,
        lower_bound=selection.lower_bound,
        role=role,
        parts=build_parts(
            polygon, carved.walk, selection.selected, carved.tree, prepared.measure.equal_area
        ),
        lines=prepared.lines,
    )


def _mask(indices, size):
    mask = np.zeros(size, dtype=bool)
    mask[indices] = True
    return mask


def _carve(prepared, tree):
    polygon, edges, measure = prepared.polygon, prepared.edges, prepared.measure
    walk = carve(polygon, prepared.component, edges, tree, prepared.wanted)
    free = np.flatnonzero(~_mask(tree, len(edges)))
    steps = prepared.edge_length
    if len(polygon.offsets) > 2:
        at = polygon.vertex[walk.corner]
        steps = measure.length(prepared.position, at, np.roll(at, -1))
    dual = build_tree(len(steps), walk.i[free], walk.j[free])
    return Carved(tree, free, walk, network(dual, steps[-1], steps[:-1], prepared.length[free]))


def _graph(prepared, selected):
    return boundary_graph(
        prepared.polygon, prepared.edge_length, prepared.edges, prepared.length, selected
    )


def _without_redundant(prepared, carved, selected, tau, weight, check):
    """Use what the carved polygon cannot know: a path may pass a hole on its other side."""
    selected = drop_redundant(
        _graph(prepared, selected),
        prepared.edges,
        prepared.length,
        selected,
        prepared.length if weight is None else weight,
        prepared.bounded,
        tau,
        check,
    )
    if not np.isin(carved.tree, selected).all():
        joined = spanning_tree(
            prepared.polygon,
            prepared.component,
            prepared.edges[selected],
            prepared.length[selected],
            prepared.wanted,
        )
        carved = _carve(prepared, selected[joined])
    return selected, carved


def _witnesses(prepared, carved, selected, check):
    """Role and dilation of each edge, the shortest path in P_T and S being the witness."""
    length, edge = prepared.length, carved.node_edge
    role = np.full(len(length), SELF, dtype=np.int8)
    dilation = np.ones(len(length))
    cut = np.append(True, _mask(selected, len(length))[edge])
    below, above = witness_lengths(carved.net, cut, check)
    side = np.where(below <= above, LEAF, ROOT).astype(np.int8)
    side[cut] = SELF
    path = np.where(cut, carved.net.length, np.minimum(below, above))
    role[edge] = side[1:]
    dilation[edge] = at_least_one(path[1:] / carved.net.length[1:])
    return role, dilation


def _largest_dilation(prepared, selected, bound, check):
    """Largest dilation of a candidate, given upper bounds: those in the carved polygon."""
    bounded = prepared.bounded
    if not prepared.has_holes:
        return float(bound[bounded].max(initial=1.0))
    return float(
        largest_dilation(
            _graph(prepared, selected),
            prepared.edges[bounded],
            prepared.length[bounded],
            bound[bounded],
            check,
        )
    )
