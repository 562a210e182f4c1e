"""The whole road of one polygon through the stages: rings in, parts and cuts out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from . import metric
from .candidates import Lines, from_lines, selectable
from .carving import Walk, carve, components, spanning_tree
from .cuts import boundary_graph, detours, drop_redundant, largest_dilation, true_dilations
from .dual_tree import build_tree
from .errors import Cancelled
from .objective import LEAF, ROOT, SELF, Network, min_size, network, witness_lengths
from .parts import Parts, build_parts
from .polygon import Polygon, from_rings
from .triangulation import diagonals

__all__ = ["Partition", "partition"]


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
    all_dilations=False,
    progress=None,
    cancelled=None,
):
    """Partition a polygon at its bottlenecks with the fewest cuts (MinSize).

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
    measure = measure or metric.planar()

    def check(share=None):
        if cancelled is not None and cancelled():
            raise Cancelled("cancelled")
        if progress is not None and share is not None:
            progress(share)

    check(0.0)
    polygon = from_rings(coords, offsets)
    position = measure.positions(polygon.xy)
    check(0.1)
    if lines is None:
        accepted, edges = None, diagonals(polygon, measure.conformal, engine)
    else:
        accepted = from_lines(polygon, lines)
        edges = accepted.edges
    check(0.5)

    # which edges are candidates, and which join the holes
    component = components(polygon)
    wanted, kept = selectable(polygon, component, edges, measure.equal_area, min_hole)
    edges = edges[kept]
    length = measure.length(position, edges[:, 0], edges[:, 1])
    tree = spanning_tree(polygon, component, edges, length, wanted)
    bounded = length * polygon.unit >= min_length
    needed = bounded | _mask(tree, len(edges))
    if accepted is not None:
        accepted = accepted._replace(edge_line=accepted.edge_line[kept][needed])
    tree = np.searchsorted(np.flatnonzero(needed), tree)
    edges, length, bounded = edges[needed], length[needed], bounded[needed]
    edge_length = measure.length(position, polygon.vertex, polygon.vertex[polygon.next_corner])
    detour = detours(polygon, edge_length, edges, length)
    check(0.6)

    # solve on the carved polygon
    carved = _carve(polygon, component, wanted, position, measure, edges, length, tree)
    check(0.7)
    cut = min_size(carved.net, tau, check)[1:] == SELF
    selected = np.sort(np.append(tree, carved.free[carved.net.tree.diagonal[cut]]))
    check(0.8)

    # what the carved polygon cannot know: a path may pass a hole on its other side
    holes = len(polygon.offsets) > 2
    if holes:
        selected = drop_redundant(
            polygon, edge_length, edges, length, selected, bounded, tau, lambda _: check()
        )
        if not np.isin(tree, selected).all():
            tree = selected[
                spanning_tree(polygon, component, edges[selected], length[selected], wanted)
            ]
            carved = _carve(polygon, component, wanted, position, measure, edges, length, tree)
    role, dilation = _witnesses(carved, length, selected, check)
    largest = dilation[bounded].max(initial=1.0)
    if holes:
        graph = boundary_graph(polygon, edge_length, edges, length, selected)
        if all_dilations:
            dilation = true_dilations(graph, edges, length, dilation, check)
            largest = dilation[bounded].max(initial=1.0)
        else:
            largest = largest_dilation(
                graph, edges[bounded], length[bounded], dilation[bounded], check
            )
    check(0.9)

    result = build_parts(polygon, carved.walk, selected, tree, measure.equal_area)
    check(1.0)
    row = np.empty(len(polygon.xy), dtype=np.int64)
    row[polygon.vertex] = polygon.rows[polygon.row_start[:-1]]
    return Partition(
        polygon=polygon,
        edges=edges,
        edge_rows=row[edges],
        length=length * polygon.unit,
        detour=detour,
        dilation=dilation if all_dilations or not holes else None,
        largest_dilation=float(largest),
        role=role,
        parts=result,
        lines=accepted,
    )


class _Carved(NamedTuple):
    """A polygon carved along T: the walk, the edges outside T, and the tree on them."""

    walk: Walk
    free: np.ndarray
    net: Network


def _carve(polygon, component, wanted, position, measure, edges, length, tree):
    walk = carve(polygon, component, edges, tree, wanted)
    free = np.flatnonzero(~_mask(tree, len(edges)))
    at = polygon.vertex[walk.corner]
    steps = measure.length(position, at, np.roll(at, -1))
    dual = build_tree(len(at), walk.i[free], walk.j[free])
    return _Carved(walk, free, network(dual, steps[-1], steps[:-1], length[free]))


def _mask(indices, size):
    mask = np.zeros(size, dtype=bool)
    mask[indices] = True
    return mask


def _witnesses(carved, length, selected, check):
    """Role and dilation of each edge, the shortest path in P_T and S being the witness."""
    edge = carved.free[carved.net.tree.diagonal]
    role = np.full(len(length), SELF, dtype=np.int8)
    dilation = np.ones(len(length))
    cut = np.append(True, _mask(selected, len(length))[edge])
    below, above = witness_lengths(carved.net, cut, check)
    others = ~cut[1:]
    edge, below, above = edge[others], below[1:][others], above[1:][others]
    role[edge] = np.where(below <= above, LEAF, ROOT)
    dilation[edge] = np.minimum(below, above) / length[edge]
    return role, dilation
