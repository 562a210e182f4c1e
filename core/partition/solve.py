"""The whole road of polygons through the stages: rings in, parts and cuts out.

`partition` walks it once for one polygon. `prepare`, `select` and `finish` walk it for a chunk of
polygons as one forest; the dual problem and the trade-off curve select for many tau what was prepared
once. A polygon that cannot be solved is a verdict, and nothing of it goes on.
"""

from __future__ import annotations

from functools import cached_property
from typing import Callable, NamedTuple

import numpy as np

from .. import metric
from ..errors import Sentence, Unsolvable
from ..progress import checker, ignore, stretch
from ..rings import Rings, groups, offsets_of, one_polygon, ranges, running, spread, take
from . import polygon as polygon_stage
from .candidates import Lines, counted, from_lines, from_triangulation
from .carving import Walk, carve, spanning_tree
from .dilation import at_least_one, boundary_graph, detours, drop_redundant, largest_dilation, true_dilations
from .dual_tree import build_tree
from .feet import Places, along_edges, with_feet
from .gates import Gates, gates
from .min_size import LEAF, ROOT, SELF, SLACK, Network, min_size, network, witness_lengths
from .min_weight import min_weight
from .natural import KEPT, RULES, SMALL
from .parts import Faces, Over, Parts, build_parts, faces_of
from .polygon import Polygons, boundary_components, from_rings

__all__ = ["Partition", "Prepared", "Selection", "finish", "partition", "prepare", "select", "without_vertex"]

AMBIGUOUS = Sentence("the rings could not be connected (their touching is ambiguous)")


class Prepared(NamedTuple):
    """Polygons with their candidates, ready to be solved for any tau.

    Lengths are in units of the metric.

    Attributes
    ----------
    polygons : Polygons
        Those that can be solved.
    verdict : (q,) object
        For each input polygon '', or why it cannot be solved.
    measure : metric.Metric
    component : (r,) int
        Boundary component of each ring.
    wanted : (r,) bool
        Which components count.
    edges : (k, 2) int
        Candidate edges and edges of T; those of a polygon stand together.
    owner : (k,) int
        The polygon of each.
    chord : (k,) float
        Straight length of each edge; of a gate that of its water.
    length : (k,) float
        What the solver takes for it: the chord, or the way along the generalised outline where that is
        shorter, so that these lengths keep the triangle inequality.
    detour : (k,) float
        Dilation in P.
    share : (k,) float
        Area of the smaller side, as a share of the polygon's; NaN where it was not measured, or where a
        diagonal joins two rings.
    bounded : (k,) bool
        The candidates proper: an edge of T shorter than the least length is none.
    edge_length : (c,) float
        Length of the polygon edge that leaves each corner, on the generalised outline if there is one.
    generalised : bool
        Whether there is one.
    natural : bool
        Whether the candidates are natural: of equally few cuts, those of salient parts are taken.
    set_aside : (q, 5) int
        For each input polygon, how many diagonals each rule of `natural` kept (the first column) or set
        aside.
    carved : Carved
    lines : list of Lines, or None
        What became of the lines given as candidates, for each input polygon (None where it is invalid).
    edge_line : (k,) int or None
        The line of each edge.
    new_rows : (f, d) float
        The rows from ``len(coords)`` on: new vertices inside edges, if these were asked for.
    places : feet.Places or None
        Where a cut was not possible for want of such a vertex, in the vertices and corners of the
        polygons; None where that was not looked for.
    gate : (k,) int or None
        Which of the gates each edge is, -1 for a diagonal; None where all are diagonals.
    gates : gates.Gates or None
    """

    polygons: Polygons
    verdict: np.ndarray
    measure: metric.Metric
    component: np.ndarray
    wanted: np.ndarray
    edges: np.ndarray
    owner: np.ndarray
    chord: np.ndarray
    length: np.ndarray
    detour: np.ndarray
    share: np.ndarray
    bounded: np.ndarray
    edge_length: np.ndarray
    generalised: bool
    natural: bool
    set_aside: np.ndarray
    carved: Carved
    lines: list[Lines] | None
    edge_line: np.ndarray | None
    new_rows: np.ndarray
    places: Places | None
    gate: np.ndarray | None
    gates: Gates | None

    @property
    def edge_rows(self) -> np.ndarray:
        """(k, 2) int: input rows at the ends of the edges."""
        return self.polygons.row_of_vertex[self.edges]

    def way_rows(self, which: np.ndarray) -> tuple[np.ndarray, np.ndarray | None]:
        """The rows of the lines along some edges: both ends, and None; or all rows, and where each begins.

        The line of a gate crosses its islands.
        """
        ends = self.edge_rows[which]
        if self.gate is None or self.gates is None or not (own := self.gate[which] >= 0).any():
            return ends, None
        index, its = take(self.gates.offsets, self.gate[which[own]])
        size = np.full(len(which), 2)
        size[own] = np.diff(its)
        offsets = offsets_of(size)
        rows = np.empty(offsets[-1], dtype=np.int64)
        rows[offsets[:-1]], rows[offsets[1:] - 1] = ends.T
        rows[ranges(offsets[:-1][own], size[own])] = self.polygons.row_of_vertex[self.gates.vertex[index]]
        return rows, offsets

    @property
    def over(self) -> Over | None:
        """The gates as `parts.build_parts` wants them."""
        return None if self.gate is None or self.gates is None else Over(self.gate, *self.gates)

    @property
    def toward(self) -> np.ndarray:
        """(k, 2) int: the vertices toward which the edges leave either end."""
        toward = self.edges[:, ::-1]
        if self.gate is not None and self.gates is not None:
            toward, own = toward.copy(), np.flatnonzero(self.gate >= 0)
            start, end = (self.gates.offsets[self.gate[own] + k] for k in (0, 1))
            toward[own] = self.gates.vertex[np.column_stack((start + 1, end - 2))]
        return toward

    @property
    def with_holes(self) -> np.ndarray:
        """(p,) bool: where distances on the carved polygon are only upper bounds."""
        return np.diff(self.polygons.polygon_offsets) > 1


class Carved(NamedTuple):
    """Polygons carved open along T (section 4.3).

    Attributes
    ----------
    tree : (t,) int
        The edges of T, ascending.
    free : (f,) int
        All other edges.
    walk : Walk
    net : Network
        Its nodes but the roots are the free edges.
    """

    tree: np.ndarray
    free: np.ndarray
    walk: Walk
    net: Network

    @property
    def node_edge(self) -> np.ndarray:
        """(f,) int: the edge of each node but the roots."""
        return self.free[self.net.tree.diagonal] if len(self.tree) else self.net.tree.diagonal


class _Selected(NamedTuple):
    selected: np.ndarray
    carved: Carved
    cost: np.ndarray
    lower_bound: np.ndarray
    dilation: np.ndarray | None


class Selection(_Selected):  # with a __dict__, for the faces
    """Solutions S.

    Attributes
    ----------
    selected : (s,) int
        The edges in S, ascending.
    carved : Carved
        With a T that is part of S.
    cost, lower_bound : (p,) float
        What S costs, and what a solution for the carved polygon must cost.
    dilation : (p,) float or None
        The largest dilation of a candidate in P and S, if it was asked for.
    """

    @cached_property
    def faces(self) -> Faces:
        """The faces of P and S."""
        return faces_of(self.carved.walk, self.selected, self.carved.tree)


class Partition(NamedTuple):
    """Solved polygons.

    Candidate edges are those whose dilation is bounded, and the edges of T; vertices count as in
    ``polygons.xy``. Of a single polygon (see `partition`), what is one number a polygon here is a float.

    Attributes
    ----------
    polygons : Polygons
    verdict : (q,) object
        For each input polygon '', or why it was not solved.
    edges : (k, 2) int
        Ends of the candidate edges.
    owner : (k,) int
        The polygon of each.
    edge_rows : (k, 2) int
        Input rows at these ends.
    length : (k,) float
        Straight length, in units of the metric; of a gate that of its water.
    detour : (k,) float
        Dilation in P before any cut; infinite where only a cut connects the ends.
    share
        See `Prepared`.
    dilation : (k,) float or None
        Dilation in P and S, if it was asked for.
    largest_dilation : (p,) float
        The largest of these (1 if there are no candidates).
    cost, lower_bound : (p,) float
        What the selected edges cost (MinSize: their number), and what they must cost at least;
        for a polygon with holes, on the polygon carved open.
    role : (k,) int
        SELF (in S), LEAF or ROOT: on which side the witness lies.
    parts : Parts
        Its ``sides`` belong to the edges with role SELF, in their order.
    lines, edge_line, new_rows
        See `Prepared`.
    """

    polygons: Polygons
    verdict: np.ndarray
    edges: np.ndarray
    owner: np.ndarray
    edge_rows: np.ndarray
    length: np.ndarray
    detour: np.ndarray
    share: np.ndarray
    dilation: np.ndarray | None
    largest_dilation: np.ndarray | float
    cost: np.ndarray | float
    lower_bound: np.ndarray | float
    role: np.ndarray
    parts: Parts
    lines: list[Lines] | None
    edge_line: np.ndarray | None
    new_rows: np.ndarray


def partition(
    coords: np.ndarray,
    offsets: np.ndarray,
    tau: float = 4.0,
    *,
    natural: bool = False,
    smallest: float = 0.0,
    min_length: float = 0.0,
    min_hole: float = 0.0,
    lines: np.ndarray | None = None,
    new_vertices: bool = False,
    over_islands: bool = True,
    measure: metric.Metric | None = None,
    engine: str | None = None,
    weigh: Callable | None = None,
    max_gap: float = 0.001,
    time_limit: float | None = None,
    all_dilations: bool = False,
    progress: Callable | None = None,
    cancelled: Callable | None = None,
) -> Partition:
    """Partition a polygon at its bottlenecks with the cheapest cuts.

    Parameters
    ----------
    coords : (k, d) float, d >= 2
        The rings' vertices, the shell's first, without closing rows: x, y and what rides along.
    offsets : (r + 1,) int
        Ring i is ``coords[offsets[i]:offsets[i + 1]]``.
    tau : float
        Largest dilation allowed for each candidate edge, at least 1.
    natural : bool
        Whether only those diagonals are candidates where people would cut (see `natural.natural`).
    smallest : float
        Area of the smallest part: smaller ones are not cut off, smaller holes do not count, and detail
        of the outline that is much smaller is not measured.
    min_length : float
        Candidates shorter than this are dropped (section 4.2 of the paper); a hole may still be
        connected by one.
    min_hole : float
        Holes with a smaller area stay holes of a part; no cut is attached to them.
    lines : (l, 2, 2) float, optional
        Ends of the candidates to use instead of a triangulation's diagonals; those that are no
        diagonals are left out (see `candidates.from_lines`).
    new_vertices : bool
        Whether cuts may also end inside edges, at the foot of a perpendicular from a concave vertex
        (see `feet.with_feet`). Those that a cut uses become vertices: rows of ``new_rows``. With lines
        given it has no effect.
    over_islands : bool
        Whether natural candidates may lead over islands that are too small to count (see `gates.gates`).
    measure : metric.Metric, optional
        Default: `metric.planar()`.
    engine : str, optional
        See `triangulation.triangulate`.
    weigh : callable, optional
        Weighs the candidates for MinWeight: called with the prepared polygon, it returns (k,)
        weights >= 0; ``lambda prepared: prepared.chord`` gives MinLength. Default: MinSize.
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

    Examples
    --------
    >>> rooms = np.array([[0, 0], [10, 0], [10, 4.5], [12, 4.5], [12, 0], [22, 0], [22, 10], [12, 10],
    ...                   [12, 5.5], [10, 5.5], [10, 10], [0, 10]])
    >>> partition(rooms, [0, 12], tau=4).parts.area
    array([100., 100.,   2.])
    """
    check = checker(progress, cancelled)
    prepared = prepare(
        one_polygon(coords, offsets),
        natural=natural,
        smallest=smallest,
        min_length=min_length,
        min_hole=min_hole,
        lines=None if lines is None else [lines],
        new_vertices=new_vertices,
        measure=measure,
        over_islands=over_islands,
        engine=engine,
        check=stretch(check, 0.0, 0.65),
    )
    if prepared.verdict[0]:
        raise Unsolvable(prepared.verdict[0])
    selection = select(
        prepared,
        tau,
        weight=None if weigh is None else weigh(prepared),
        max_gap=max_gap,
        time_limit=time_limit,
        check=stretch(check, 0.65, 0.9),
        with_dilation=False,
    )
    result = finish(prepared, selection, all_dilations=all_dilations, check=stretch(check, 0.9, 1.0))
    check(1.0)
    return result._replace(
        largest_dilation=float(np.asarray(result.largest_dilation)[0]),
        cost=float(np.asarray(result.cost)[0]),
        lower_bound=float(np.asarray(result.lower_bound)[0]),
    )


def prepare(
    rings: Rings,
    *,
    natural: bool = False,
    smallest: float | np.ndarray = 0.0,
    min_length: float | np.ndarray = 0.0,
    min_hole: float | np.ndarray = 0.0,
    lines: list | None = None,
    new_vertices: bool = False,
    over_islands: bool = True,
    measure: metric.Metric | None = None,
    engine: str | None = None,
    check: Callable = ignore,
) -> Prepared:
    """Triangulate polygons, connect their holes and carve them open (section 4.3 of the paper).

    Parameters
    ----------
    rings : Rings
    natural : bool
        See `partition`. Lines given as candidates are taken as they are.
    smallest, min_length, min_hole : float, or (q,) float
        For all polygons or each; see `partition`.
    lines : list of (l, 2, 2) float, optional
        For each polygon the candidates to use; see `partition`.
    new_vertices, over_islands, measure, engine
        See `partition`.
    check : callable, optional
        Called with the share done; may raise `Cancelled`.

    Returns
    -------
    Prepared

    Raises
    ------
    MissingEngine

    Examples
    --------
    An hourglass: the shorter way around its neck is 11.4 times as long as the way across.

    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> prepared = prepare(one_polygon(xy, [0, 6]))
    >>> neck = prepared.detour.argmax()
    >>> prepared.edge_rows[neck].tolist(), round(float(prepared.detour[neck]), 1)
    ([1, 4], 11.4)
    """
    measure = measure or metric.planar()
    check(0.0)
    polygons, verdict = from_rings(rings)
    sizes = (smallest, min_length, np.maximum(min_hole, smallest), min_hole)
    limits = _Limits(*(np.broadcast_to(np.asarray(x, dtype=float), len(verdict)) for x in sizes))
    check(0.15)
    if lines is None:
        found = _diagonals(
            polygons,
            rings,
            limits,
            only_natural=natural,
            over_islands=natural and over_islands,
            new_vertices=new_vertices,
            measure=measure,
            engine=engine,
            check=check,
        )
    else:
        found = _from_lines(polygons, rings, lines, limits, measure)
    check(0.7)
    prepared = _measured(found, verdict, limits, measure)
    prepared = _connected(prepared, found.problem, limits.min_hole)
    if prepared.generalised:
        prepared = _metric(prepared)
    return prepared._replace(
        detour=detours(prepared.polygons, prepared.edge_length, prepared.edges, prepared.length)
    )


@np.errstate(over="ignore")  # a tau of 1e300 is as good as none
def select(
    prepared: Prepared,
    tau: float | np.ndarray,
    *,
    weight: np.ndarray | None = None,
    max_gap: float = 0.001,
    time_limit: float | None = None,
    check: Callable = ignore,
    with_dilation: bool = True,
) -> Selection:
    """Choose the edges to cut: MinSize, or MinWeight (sections 4.1 and 4.4 of the paper).

    Parameters
    ----------
    prepared : Prepared
    tau : float, or (p,) float
        Largest dilation allowed, for all polygons or each.
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

    Notes
    -----
    Of several sets of fewest cuts, MinSize takes any; among natural candidates that where the cuts are
    shortest beside the size of their parts (see `_salient`).

    Examples
    --------
    An hourglass is cut at its neck, unless so large a detour is allowed.

    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> prepared = prepare(one_polygon(xy, [0, 6]))
    >>> prepared.edge_rows[select(prepared, 4.0).selected].tolist(), len(select(prepared, 12.0).selected)
    ([[1, 4]], 0)
    """
    check(0.0)
    carved, owner, count = prepared.carved, prepared.owner, len(prepared.polygons.unit)
    tau = np.broadcast_to(np.asarray(tau, dtype=float), count)
    by_node = tau[:1] if (tau == tau[:1]).all() else tau[np.append(np.arange(count), owner[carved.node_edge])]
    search = stretch(check, 0.0, 0.8)
    cut = min_size(carved.net, by_node, search if weight is None else check) == SELF
    ones = np.ones(len(owner))
    lower_bound = _sums(owner, ones, np.append(carved.tree, carved.node_edge[cut[count:]]), count)
    if weight is None and prepared.natural:
        cut = _salient(prepared, cut, by_node, search)
    if weight is not None:
        # a MinSize solution to begin with: the result never costs more
        cut, lower_bound = min_weight(
            carved.net,
            np.append(np.zeros(count), weight[carved.node_edge]),
            by_node,
            max_gap=max_gap,
            start=cut,
            time_limit=time_limit,
            check=search,
        )
        lower_bound = lower_bound + _sums(owner, weight, carved.tree, count)
    selected = np.sort(np.append(carved.tree, carved.node_edge[cut[count:]]))
    check(0.8)
    if prepared.with_holes.any():
        price = prepared.chord if weight is None else weight
        selected = _without_redundant(prepared, selected, tau, price, check)
        if weight is not None or prepared.natural:
            # which cuts turn out to be redundant is a matter of luck: never end up dearer
            plain = prepared._replace(natural=False)
            fewest = select(plain, tau, check=check, with_dilation=False).selected
            paid = ones if weight is None else weight
            dearer = _sums(owner, paid, fewest, count) < _sums(owner, paid, selected, count)
            selected = np.sort(np.append(selected[~dearer[owner[selected]]], fewest[dearer[owner[fewest]]]))
        carved = _with_tree_in(prepared, selected)
    dilation = None
    if with_dilation:
        _, bound = _witnesses(prepared, carved, selected, check)
        dilation = _largest_dilation(prepared, selected, bound, check)
    cost = _sums(owner, ones if weight is None else weight, selected, count)
    return Selection(selected, carved, cost, np.minimum(lower_bound, cost), dilation)


def finish(
    prepared: Prepared,
    selection: Selection,
    *,
    all_dilations: bool = False,
    check: Callable = ignore,
) -> Partition:
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

    Examples
    --------
    An hourglass, cut at its neck.

    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> prepared = prepare(one_polygon(xy, [0, 6]))
    >>> solution = finish(prepared, select(prepared, 4.0))
    >>> sorted(solution.parts.area.tolist()), solution.largest_dilation.round(2).tolist()
    ([30.0, 60.0], [1.1])
    """
    polygons, carved = prepared.polygons, selection.carved
    role, dilation = _witnesses(prepared, carved, selection.selected, check)
    largest = selection.dilation
    if largest is None:
        largest = _largest_dilation(prepared, selection.selected, dilation, check)
    if not all_dilations:
        dilation = None
    elif prepared.with_holes.any():
        some = np.flatnonzero(prepared.with_holes[prepared.owner])
        dilation[some] = true_dilations(
            _graph(prepared, selection.selected),
            prepared.edges[some],
            prepared.length[some],
            dilation[some],
            check,
        )
    check()
    return Partition(
        polygons=polygons,
        verdict=prepared.verdict,
        edges=prepared.edges,
        owner=prepared.owner,
        edge_rows=prepared.edge_rows,
        length=prepared.chord,
        detour=prepared.detour,
        share=prepared.share,
        dilation=dilation,
        largest_dilation=largest,
        cost=selection.cost,
        lower_bound=selection.lower_bound,
        role=role,
        parts=build_parts(
            polygons,
            carved.walk,
            selection.selected,
            carved.tree,
            prepared.measure.equal_area,
            faces=selection.faces,
            over=prepared.over,
        ),
        lines=prepared.lines,
        edge_line=prepared.edge_line,
        new_rows=prepared.new_rows,
    )


def without_vertex(prepared: Prepared, selection: Selection, tau: np.ndarray) -> np.ndarray:
    """Count the edges where a cut is missing because there is no vertex to end at.

    These are the edges of P with the foot of a perpendicular from the concave vertex opposite (that of the
    triangle beside the edge, see `feet.places`), natural ones if the candidates are, for which the shortest
    way in P and S is more than tau times as long as the perpendicular.

    Parameters
    ----------
    prepared : Prepared
        Without new vertices.
    selection : Selection
    tau : (p,) float

    Returns
    -------
    (p,) int
        For each polygon; with holes, as far as ways around these are known from the polygon carved open:
        never too few.

    Notes
    -----
    O(n), but for a sort of n + 2 |S| integers. A place lies in a triangle, and so in one face of P and S;
    by the triangle inequality the shortest way leads along the boundary of that face.

    Examples
    --------
    >>> xy = np.array([[0, 0], [20, 0], [20, 10], [11, 10], [10, 1], [9, 10], [0, 10.0]])
    >>> prepared = prepare(one_polygon(xy, [0, 7]))
    >>> without_vertex(prepared, select(prepared, 4.0), np.array([4.0]))
    array([1])
    """
    short, polygons, (tree, _, walk, _) = prepared.places, prepared.polygons, selection.carved
    roots = len(polygons.unit)
    if short is None or not len(short.edge):
        return np.zeros(roots, dtype=np.int64)
    edge, faces = short.edge, selection.faces
    if len(polygons.offsets) > roots + 1:  # with holes: the walk goes another way than the corners
        place = np.empty(len(polygons.vertex), dtype=np.int64)
        on_edge = np.flatnonzero(walk.edge >= 0)
        place[walk.edge[on_edge]] = on_edge
        edge = place[edge]
    # the half-edges along each face with such a place: the walk's own, and both sides of the cuts
    found, own = np.unique(faces.face[edge], return_inverse=True)
    index, offsets = take(offsets_of(np.bincount(faces.face)), found)
    half = faces.order[index]
    size = np.empty(len(half))
    cuts, by_cut = selection.selected[faces.is_cut], half >= len(walk.edge)
    size[~by_cut] = _steps(prepared, walk.edge[half[~by_cut]], tree)
    size[by_cut] = prepared.length[cuts[(half[by_cut] - len(walk.edge)) % len(cuts)]]
    passed, around = running(size, offsets)
    at = np.empty(len(faces.face), dtype=np.int64)
    at[half] = np.arange(len(half))
    foot = passed[at[edge]] + short.share * size[at[edge]]
    # a walk may pass a vertex several times, and so may a face
    n = len(polygons.xy)
    key = groups(offsets) * n + polygons.vertex[walk.corner[faces.place[half]]]
    by_vertex = np.argsort(key, kind="stable")
    key, wanted = key[by_vertex], own * n + short.apex
    first = np.searchsorted(key, wanted)
    times = np.searchsorted(key, wanted, side="right") - first
    which, at = np.repeat(np.arange(len(edge)), times), by_vertex[ranges(first, times)]
    way = np.abs(passed[at] - foot[which])
    shortest = np.full(len(edge), np.inf)
    np.minimum.at(shortest, which, np.minimum(way, around[own[which]] - way))
    owner = polygons.polygon_of_vertex[short.apex]
    length = short.length * polygons.unit[owner]
    beyond = shortest > np.broadcast_to(tau, roots)[owner] * length * (1.0 + SLACK)
    return np.bincount(owner[beyond], minlength=roots)


def _salient(prepared, cut, tau, check):
    """Of the solutions with as few cuts, that whose parts are the most salient (Hoffman and Singh 1997).

    A part is the more salient the shorter its cut is beside the root of its area. The sum of these ratios
    is a second objective: a cut weighs one and a bit, and the bits of the first solution are a half
    together, so another cut is never worth them. Trees that are too large for an exact pass stay as they
    are. On provinces 15.7 instead of 18.0 % of the cuts got a part with less area than a square on them.
    """
    carved, owner = prepared.carved, prepared.owner
    count = len(prepared.polygons.unit)
    # a cut between two rings has no side of its own: as if it halved the polygon
    ratio = prepared.chord / np.sqrt(np.where(np.isnan(prepared.share), 0.5, prepared.share))
    first = _sums(owner, ratio, carved.node_edge[cut[count:]], count)
    bit = np.divide(0.5, first, out=np.zeros(count), where=first > 0.0)
    weight = 1.0 + ratio * bit[owner]
    cut, _ = min_weight(
        carved.net, np.append(np.zeros(count), weight[carved.node_edge]), tau,
        max_gap=0.0, start=cut, check=check, max_points=0,
    )  # fmt: skip
    return cut


def _mask(indices, size):
    mask = np.zeros(size, dtype=bool)
    mask[indices] = True
    return mask


def _sums(owner, values, which, count):
    """Sum of the values of some edges, for each polygon."""
    # of none, numpy before 2 counts in integers
    return np.bincount(owner[which], weights=values[which], minlength=count).astype(float)


class _Limits(NamedTuple):
    """What is too small to count, for each input polygon; see `partition`."""

    smallest: np.ndarray
    min_length: np.ndarray
    min_hole: np.ndarray
    any_hole: np.ndarray  # as told, though the smallest part may be larger


class _Boundary(NamedTuple):
    """Component of each ring, which of them count, and at which vertices cuts may end."""

    component: np.ndarray
    wanted: np.ndarray
    attachable: np.ndarray


class _Candidates(NamedTuple):
    """Candidates as they were found, not measured yet.

    polygons : Polygons
        With the new vertices, if some were asked for.
    boundary : _Boundary
    problem : (p,) object
        For each polygon '', or why it has no candidates.
    edges : (k, 2) int
    chosen : (k,) bool
        The others may be edges of T, but are no candidates.
    share, edge_line, natural, set_aside, lines, new_rows, places, gate, gates
        See `Prepared`.
    outline : (c,) float or None
        See ``edge_length`` of `candidates.Diagonals`.
    """

    polygons: Polygons
    boundary: _Boundary
    problem: np.ndarray
    edges: np.ndarray
    chosen: np.ndarray
    share: np.ndarray
    edge_line: np.ndarray | None
    outline: np.ndarray | None
    natural: bool
    set_aside: np.ndarray
    lines: list[Lines] | None
    new_rows: np.ndarray
    places: Places | None
    gate: np.ndarray | None
    gates: Gates | None


def _boundary(polygons, measure, min_hole):
    component = boundary_components(polygons)
    return _Boundary(component, *counted(polygons, component, measure.equal_area, min_hole[polygons.number]))


def _diagonals(polygons, rings, limits, *, only_natural, over_islands, new_vertices, measure, engine, check):
    """The candidates among the diagonals of triangulations (section 4.2)."""
    boundary = _boundary(polygons, measure, limits.min_hole)
    new_rows, known = np.empty((0, rings.coords.shape[1])), None
    if new_vertices:
        free = ~boundary.wanted[boundary.component]
        least = limits.smallest[polygons.number] / polygons.unit / polygons.unit
        polygons, new_rows, known = with_feet(
            polygons, rings, free, least, measure=measure, engine=engine, check=check
        )
        boundary = _boundary(polygons, measure, limits.min_hole)
        if (free != ~boundary.wanted[boundary.component]).any():
            known = None  # a vertex more changed the area of a hole by its last bit
    found_gates = None
    if over_islands:
        number = polygons.number
        found_gates = gates(
            polygons,
            boundary.component,
            boundary.wanted,
            limits.smallest[number],
            limits.any_hole[number],
            measure=measure,
            engine=engine,
            check=check,
        )
    generalise = only_natural or bool((limits.smallest > 0.0).any())
    found = from_triangulation(
        polygons,
        boundary.component,
        boundary.wanted,
        measure=measure,
        engine=engine,
        smallest=limits.smallest[polygons.number] if generalise else None,
        only_natural=only_natural,
        gates=found_gates,
        known=known,
        with_places=not new_vertices,
        check=stretch(check, 0.15, 0.7),
    )
    chosen = np.ones(len(found.edges), dtype=bool)
    set_aside = np.zeros((len(limits.smallest), len(RULES)), dtype=np.int64)
    if generalise:
        chosen = found.why == KEPT if only_natural else found.why != SMALL
        number = polygons.number[polygons.polygon_of_vertex[found.edges[:, 0]]]
        np.add.at(set_aside, (number, found.why if only_natural else SMALL * ~chosen), 1)
    if len(new_rows):
        chosen &= ~along_edges(polygons, found.edges)
    return _Candidates(
        polygons=polygons,
        boundary=boundary,
        problem=found.verdict,
        edges=found.edges,
        chosen=chosen,
        share=found.share if generalise else np.full(len(chosen), np.nan),
        edge_line=None,
        outline=found.edge_length,
        natural=only_natural,
        set_aside=set_aside,
        lines=None,
        new_rows=new_rows,
        places=_long_enough(polygons, found.places, limits.min_length),
        gate=found.gate,
        gates=found_gates,
    )


def _long_enough(polygons, places, min_length):
    """The places where a cut would be as long as a candidate must be."""
    if places is None:
        return None
    owner = polygons.polygon_of_vertex[places.apex]
    kept = places.length * polygons.unit[owner] >= min_length[polygons.number][owner]
    return Places(*(x[kept] for x in places))


def _from_lines(polygons, rings, lines, limits, measure):
    """The candidates among the lines of each input polygon."""
    accepted = [None] * len(lines)
    edges, edge_line = [np.empty((0, 2), dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    first = polygons.vertex_offsets.tolist()
    for p, number in enumerate(polygons.number.tolist()):
        one, _ = polygon_stage.select(polygons, np.array([p]))
        accepted[number] = found = from_lines(one, lines[number])
        edges.append(found.edges + first[p])
        edge_line.append(found.edge_line)
    edges, edge_line = np.concatenate(edges), np.concatenate(edge_line)
    return _Candidates(
        polygons=polygons,
        boundary=_boundary(polygons, measure, limits.min_hole),
        problem=np.full(len(polygons.unit), "", dtype=object),
        edges=edges,
        chosen=np.ones(len(edges), dtype=bool),
        share=np.full(len(edges), np.nan),
        edge_line=edge_line,
        outline=None,
        natural=False,
        set_aside=np.zeros((len(lines), len(RULES)), dtype=np.int64),
        lines=accepted,
        new_rows=np.empty((0, rings.coords.shape[1])),
        places=None,
        gate=None,
        gates=None,
    )


def _measured(found, verdict, limits, measure):
    """Candidates and polygon edges with their lengths; T is not known yet."""
    polygons, edges = found.polygons, found.edges
    owner = polygons.polygon_of_vertex[edges[:, 0]]
    position = measure.positions(polygons.xy)
    chord = measure.length(position, edges[:, 0], edges[:, 1])
    if found.gate is not None:
        own = np.flatnonzero(found.gate >= 0)
        chord[own] = found.gates.lengths(position, measure)[found.gate[own]]
    chord *= polygons.unit[owner]
    edge_length = measure.length(position, polygons.vertex, polygons.next_vertex)
    edge_length = edge_length * spread(polygons.unit, polygons.corner_offsets)
    if found.outline is not None:
        edge_length = np.where(np.isnan(found.outline), edge_length, found.outline)
    prepared = Prepared(
        polygons=polygons,
        verdict=verdict,
        measure=measure,
        component=found.boundary.component,
        wanted=found.boundary.wanted,
        edges=edges,
        owner=owner,
        chord=chord,
        length=chord,
        detour=None,  # type: ignore[arg-type]  # comes with T
        share=found.share,
        bounded=found.chosen & (chord >= limits.min_length[polygons.number][owner]),
        edge_length=edge_length,
        generalised=found.outline is not None,
        natural=found.natural,
        set_aside=found.set_aside,
        carved=None,  # type: ignore[arg-type]  # comes with T
        lines=found.lines,
        edge_line=found.edge_line,
        new_rows=found.new_rows,
        places=found.places,
        gate=found.gate,
        gates=found.gates,
    )
    attachable = found.boundary.attachable
    return prepared if attachable.all() else _with_edges(prepared, attachable[edges].all(axis=1))


def _connected(prepared, problem, min_hole):
    """The polygons carved open along T (section 4.3), without those where that cannot be."""
    while True:
        prepared.verdict[prepared.polygons.number] = problem
        if (problem != "").any():
            prepared = _with_polygons(prepared, problem == "", min_hole)
        prepared, tree, problem = _with_tree(prepared)
        if (problem != "").any():
            continue
        carved, ambiguous = _carve(prepared, tree)
        if not ambiguous.any():
            return prepared._replace(carved=carved)
        problem[ambiguous] = AMBIGUOUS


def _with_tree(prepared):
    """T, with no edges but T and the candidates; for each polygon '', or why it has no T."""
    polygons, component, wanted = prepared.polygons, prepared.component, prepared.wanted
    straight = slice(None) if prepared.gate is None else np.flatnonzero(prepared.gate < 0)
    edges, chord = prepared.edges[straight], prepared.chord[straight]
    tree, apart = spanning_tree(polygons, component, edges, chord, wanted)
    if prepared.gate is not None:
        tree = straight[tree]
    needed = prepared.bounded | _mask(tree, len(prepared.edges))
    if not needed.all():
        prepared = _with_edges(prepared, needed)
        tree = np.searchsorted(np.flatnonzero(needed), tree)
    return prepared, tree, _connection_problems(polygons, component, wanted, apart)


def _with_edges(prepared, kept):
    """With some of the edges."""
    names = ("edges", "owner", "chord", "length", "share", "bounded", "edge_line", "gate")
    own = ((name, getattr(prepared, name)) for name in names)
    return prepared._replace(**{name: x[kept] for name, x in own if x is not None})


def _with_polygons(prepared, good, min_hole):
    """With some of the polygons."""
    which = np.flatnonzero(good)
    polygons, vertex = polygon_stage.select(prepared.polygons, which)
    number = np.full(len(prepared.polygons.xy), -1)
    number[vertex] = np.arange(len(vertex))
    boundary = _boundary(polygons, prepared.measure, min_hole)
    corner, _ = take(prepared.polygons.corner_offsets, which)
    places = _still(prepared.polygons, good, prepared.places)
    prepared = _with_edges(prepared, good[prepared.owner])
    return prepared._replace(
        polygons=polygons,
        component=boundary.component,
        wanted=boundary.wanted,
        edges=number[prepared.edges],
        owner=np.searchsorted(which, prepared.owner),
        edge_length=prepared.edge_length[corner],
        places=places,
        gates=prepared.gates and prepared.gates._replace(vertex=number[prepared.gates.vertex]),
    )


def _still(polygons, good, places):
    """The places in some of the polygons, by the numbers in these."""
    if places is None:
        return None
    kept = good[polygons.polygon_of_vertex[places.apex]]
    places = Places(*(x[kept] for x in places))
    corner, vertex = (
        np.cumsum(np.repeat(good, np.diff(offsets))) - 1
        for offsets in (polygons.corner_offsets, polygons.vertex_offsets)
    )
    return places._replace(apex=vertex[places.apex], edge=corner[places.edge])


def _metric(prepared):
    """Lengths of the edges that keep the triangle inequality though the outline got shorter.

    A chord may be longer than the generalised outline beside it. The shortest way between its ends, with
    all candidates selected, is taken for its length then; the dual tree gives it in two passes.
    """
    carved = prepared.carved
    net = carved.net
    below, above = witness_lengths(net, None)
    node_length = np.minimum(net.length, np.minimum(below, above))
    length = prepared.length.copy()
    length[carved.node_edge] = node_length[net.tree.roots :]
    return prepared._replace(length=length, carved=carved._replace(net=net._replace(length=node_length)))


def _connection_problems(polygons, component, wanted, apart):
    """For each polygon '', or which holes its candidates do not connect."""
    problem = np.full(len(apart), "", dtype=object)
    for p in np.flatnonzero(apart).tolist():
        own = np.unique(component[slice(*polygons.polygon_offsets[p : p + 2])])
        holes = np.count_nonzero(wanted[own]) - 1
        problem[p] = Sentence(
            "the candidate diagonals do not connect {} of {} holes to the rest", apart[p], holes
        )
    return problem


def _carve(prepared, tree):
    """The carved polygons, and where the rings cannot be connected."""
    polygons, edges, length = prepared.polygons, prepared.edges, prepared.length
    walk, ambiguous = carve(polygons, prepared.component, edges, tree, prepared.wanted, prepared.toward)
    if ambiguous.any():
        return None, ambiguous
    free, i, j, own = np.arange(len(edges)), walk.i, walk.j, length
    if len(tree):
        free = np.flatnonzero(~_mask(tree, len(edges)))
        i, j, own = i[free], j[free], own[free]
    net = network(build_tree(walk.offsets, i, j), walk.offsets, _steps(prepared, walk.edge, tree), own)
    return Carved(tree, free, walk, net), ambiguous


def _steps(prepared, edge, tree):
    """Lengths of edges of walks."""
    step = prepared.edge_length[edge]
    along_tree = edge < 0
    step[along_tree] = prepared.length[tree[-1 - edge[along_tree]]]
    return step


def _graph(prepared, selected):
    """P and S of the polygons with holes."""
    some = selected[prepared.with_holes[prepared.owner[selected]]]
    return boundary_graph(
        prepared.polygons,
        _positions(prepared),
        prepared.edge_length,
        prepared.edges,
        prepared.length,
        some,
    )


def _positions(prepared):
    """Where the vertices are, in the unit of the lengths."""
    polygons = prepared.polygons
    if prepared.generalised:  # the outline is shorter than the straight lines: these bound nothing
        return np.zeros((len(polygons.xy), 1))
    unit = polygons.unit[polygons.polygon_of_vertex]
    return prepared.measure.positions(polygons.xy) * unit[:, None]


def _without_redundant(prepared, selected, tau, price, check):
    """Use what the carved polygon cannot know: a path may pass a hole on its other side."""
    holed = prepared.with_holes[prepared.owner]
    some = selected[holed[selected]]
    role, bound = _witnesses(prepared, prepared.carved, selected, check)
    stay = drop_redundant(
        _graph(prepared, selected),
        prepared.edges,
        prepared.length,
        some,
        price,
        prepared.bounded & holed,
        tau[prepared.owner],
        prepared.carved,
        role,
        bound,
        check,
    )
    return np.sort(np.append(selected[~holed[selected]], stay))


def _with_tree_in(prepared, selected):
    """The polygons carved open along a T that is part of S."""
    carved = prepared.carved
    if np.isin(carved.tree, selected).all():
        return carved
    # the shortest tree within S; where T stayed, it is T
    joined, _ = spanning_tree(
        prepared.polygons,
        prepared.component,
        prepared.edges[selected],
        prepared.length[selected],
        prepared.wanted,
    )
    return _carve(prepared, selected[joined])[0]


def _witnesses(prepared, carved, selected, check):
    """Role and dilation of each edge, the shortest path in P_T and S being the witness."""
    length, edge, roots = prepared.length, carved.node_edge, carved.net.tree.roots
    role = np.full(len(length), SELF, dtype=np.int8)
    dilation = np.ones(len(length))
    cut = np.append(np.ones(roots, dtype=bool), _mask(selected, len(length))[edge])
    below, above = witness_lengths(carved.net, cut, check)
    side = np.where(below <= above, np.int8(LEAF), np.int8(ROOT))
    side[cut] = SELF
    path = np.where(cut, carved.net.length, np.minimum(below, above))
    role[edge] = side[roots:]
    dilation[edge] = at_least_one(path[roots:] / carved.net.length[roots:])
    return role, dilation


def _largest_dilation(prepared, selected, bound, check):
    """Largest dilation of a candidate, given upper bounds: those in the carved polygon."""
    largest = np.ones(len(prepared.polygons.unit))
    first = np.flatnonzero(np.diff(prepared.owner, prepend=-1))
    if len(first):  # exact without holes; what is not bounded is in T
        largest[prepared.owner[first]] = np.maximum.reduceat(bound, first)
    if prepared.with_holes.any():
        largest[prepared.with_holes] = 1.0
        some = np.flatnonzero(prepared.bounded & prepared.with_holes[prepared.owner])
        found = largest_dilation(
            _graph(prepared, selected),
            prepared.edges[some],
            prepared.length[some],
            bound[some],
            prepared.owner[some],
            len(largest),
            check,
        )
        largest = np.maximum(largest, found)
    return largest
