from functools import lru_cache

import numpy as np
import pytest

from .. import checker
from isthmus.core.partition import triangulation
from isthmus.core.partition.carving import carve, spanning_tree
from isthmus.core.partition.polygon import boundary_components
from isthmus.core.partition.dilation import (
    boundary_graph,
    detours,
    drop_redundant,
    largest_dilation,
    true_dilations,
)
from isthmus.core.metric import planar
from isthmus.core.partition.min_size import LEAF, ROOT, SELF, min_size, witness_lengths
from isthmus.core.partition.polygon import from_rings, one
from isthmus.core.partition.solve import prepare
from isthmus.core.rings import groups

from .. import shapes, stages
from ..verify import assert_close

NONE = np.empty(0, dtype=np.int64)
CASES = {
    **shapes.TOUCHING,
    "dumbbell": shapes.DUMBBELL,
    "annulus": shapes.ANNULUS,
    "two holes": shapes.TWO_HOLES,
    "lattice of holes": shapes.lattice_of_holes(3),
    **{f"mosaic {seed}": shapes.mosaic(seed, 35) for seed in range(12)},
    **{f"lattice mosaic {seed}": shapes.mosaic(seed, 35, size=7) for seed in range(6)},
    **{f"polyomino {seed}": shapes.polyomino(seed, 6, 6, 0.7, 0.5) for seed in range(8)},
}


def nothing(share=None):
    pass


class Case:
    def __init__(self, name):
        self.name = name
        self.polygon = polygon = one(*CASES[name])
        self.edges = stages.diagonals(polygon)
        self.length = planar().length(polygon.xy, *self.edges.T)
        self.edge_length = planar().length(polygon.xy, polygon.vertex, polygon.vertex[polygon.next_corner])

    def graph(self, selected):
        return boundary_graph(
            self.polygon, self.polygon.xy, self.edge_length, self.edges, self.length, selected
        )

    def dropped(self, selected, bounded, tau, check):
        """What `drop_redundant` keeps of edges, T among them."""
        prepared = stages.prepared(CASES[self.name])
        assert np.array_equal(prepared.edges, self.edges)
        role = np.zeros(len(self.edges), dtype=int)  # all are selected: none has a witness yet
        return drop_redundant(
            self.graph(selected),
            self.edges,
            self.length,
            selected,
            self.length,
            bounded,
            np.full(len(self.edges), tau),
            prepared.carved,
            role,
            np.ones(len(self.edges)),
            check,
        )

    def expected(self, selected):
        offsets = self.polygon.offsets
        rings = [self.polygon.vertex[a:b] for a, b in zip(offsets[:-1], offsets[1:])]
        return checker.dilations(self.polygon.xy, rings, self.edges[selected], self.edges)

    def some(self, seed, share):
        return np.flatnonzero(np.random.default_rng(seed).random(len(self.edges)) < share)


@pytest.mark.parametrize("name", CASES)
def test_detours(name):
    case = Case(name)
    assert_close(detours(case.polygon, case.edge_length, case.edges, case.length), case.expected(NONE))


@pytest.mark.parametrize("share", [0.0, 0.1, 0.4, 1.0])
@pytest.mark.parametrize("name", CASES)
def test_true_dilations(name, share):
    """With any edges selected, whether they make sense or not."""
    case = Case(name)
    selected = case.some(1, share)
    expected = case.expected(selected)
    bound = np.where(np.isin(np.arange(len(case.edges)), selected), 1.0, np.inf)
    asked = case.graph(selected), case.edges, case.length
    assert_close(true_dilations(*asked, bound, nothing), expected)
    owner = np.zeros(len(case.edges), dtype=int)
    assert largest_dilation(*asked, bound, owner, 1, nothing)[0] == pytest.approx(expected.max())
    closer = np.where(bound > 1, expected * 1.5, 1.0)
    assert_close(true_dilations(*asked, closer, nothing), expected)
    assert largest_dilation(*asked, closer, owner, 1, nothing)[0] == pytest.approx(expected.max())


@pytest.mark.parametrize("tau", [1.0, 1.5, 2.0, 4.0])
@pytest.mark.parametrize("name", CASES)
def test_drop_redundant(name, tau):
    """From all edges down to a solution that can spare none; every second edge is bounded."""
    case = Case(name)
    everything = np.arange(len(case.edges))
    bounded = everything % 2 == 0
    kept = case.dropped(everything, bounded, tau, nothing)
    dilation = case.expected(kept)
    assert np.isfinite(dilation).all(), "all rings are still connected"
    assert (dilation[bounded] <= tau * (1 + 1e-9)).all()
    for k in kept:
        without = case.expected(kept[kept != k])
        assert np.isinf(without[k]) or without[bounded].max() > tau * (1 - 1e-9)


def test_check_may_stop_each_search():
    case = Case("lattice of holes")

    class Stop(Exception):
        pass

    def stop(share=None):
        raise Stop

    bound = np.full(len(case.edges), np.inf)
    asked = case.graph(NONE), case.edges, case.length, bound
    with pytest.raises(Stop):
        true_dilations(*asked, stop)
    with pytest.raises(Stop):
        largest_dilation(*asked, np.zeros(len(bound), dtype=int), 1, stop)
    with pytest.raises(Stop):
        case.dropped(np.arange(len(case.edges)), bound > 0, 2.0, stop)


# ---------------------------------------------------------------- which cuts are dropped


def solution(prepared, tau, extra=0.0):
    """Edges that bring all within tau, some more of them than need be, and the witnesses then."""
    carved, roots = prepared.carved, prepared.carved.net.tree.roots
    of_node = np.append(np.arange(roots), prepared.owner[carved.node_edge])
    cut = min_size(carved.net, tau[of_node]) == SELF
    cut[roots:] |= carved.net.length[roots:] * 618.034 % 1.0 < extra  # as good as random, and its own
    below, above = witness_lengths(carved.net, cut)
    role, bound = np.full(len(prepared.edges), SELF), np.ones(len(prepared.edges))
    role[carved.node_edge] = np.where(cut, SELF, np.where(below <= above, LEAF, ROOT))[roots:]
    path = np.where(cut, carved.net.length, np.minimum(below, above))
    bound[carved.node_edge] = np.maximum(path / carved.net.length, 1.0)[roots:]
    return np.sort(np.append(carved.tree, carved.node_edge[cut[roots:]])), role, bound


def graph_of(prepared, selected):
    return boundary_graph(
        prepared.polygons,
        prepared.polygons.xy,
        prepared.edge_length,
        prepared.edges,
        prepared.length,
        selected,
    )


def dropped(prepared, selected, role, bound, tau, graph=None, weight=None):
    return drop_redundant(
        graph or graph_of(prepared, selected),
        prepared.edges,
        prepared.length,
        selected,
        prepared.length if weight is None else weight,
        prepared.bounded,
        tau[prepared.owner],
        prepared.carved,
        role,
        bound,
        nothing,
    )


def greedy(prepared, selected, tau, weight):
    """What stays if each edge, the heaviest first, goes where all candidates remain within tau without it."""
    polygon = prepared.polygons
    rings = [polygon.vertex[a:b] for a, b in zip(polygon.offsets[:-1], polygon.offsets[1:])]
    kept = selected.tolist()
    for c in sorted(kept, key=lambda k: -weight[k]):
        rest = [k for k in kept if k != c]
        dilation = checker.dilations(polygon.xy, rings, prepared.edges[rest], prepared.edges)
        if dilation[c] < np.inf and (dilation[prepared.bounded] <= tau * (1.0 + 1e-12)).all():
            kept = rest
    return kept


@pytest.mark.parametrize("tau, extra", [(1.3, 0.0), (2.0, 0.3), (3.0, 0.0), (5.0, 0.3), (20.0, 0.3)])
@pytest.mark.parametrize("name", CASES)
def test_each_cut_goes_that_can_be_spared(name, tau, extra):
    """The same edges as by trying each with all distances anew, from T and cuts with witnesses on P_T.

    With random weights edges of T are tried before others that join their holes.
    """
    for min_length in (0.0, np.ptp(CASES[name].coords[:, 0]) / 5):
        prepared = stages.prepared(CASES[name], min_length=min_length)
        limit = np.array([tau])
        selected, role, bound = solution(prepared, limit, extra)
        for weight in (prepared.length, np.random.default_rng(1).random(len(prepared.edges))):
            kept = dropped(prepared, selected, role, bound, limit, weight=weight)
            assert kept.tolist() == greedy(prepared, selected, tau, weight)


def test_edges_of_t_go_where_others_join_their_holes():
    """So the cases above do see it."""
    gone = 0
    for name in CASES:
        prepared = stages.prepared(CASES[name])
        tau = np.array([5.0])
        selected, role, bound = solution(prepared, tau, 0.3)
        weight = np.random.default_rng(1).random(len(prepared.edges))
        kept = dropped(prepared, selected, role, bound, tau, weight=weight)
        gone += len(np.setdiff1d(prepared.carved.tree, kept))
    assert gone > 10


def test_the_graph_loses_what_is_dropped():
    prepared = stages.prepared(shapes.lattice_of_holes(4))
    tau = np.array([4.0])
    selected, role, bound = solution(prepared, tau, 0.4)
    graph = graph_of(prepared, selected)
    kept = dropped(prepared, selected, role, bound, tau, graph)
    assert 0 < len(kept) < len(selected)
    assert {k for links in graph.links for k in links if k >= 0} == set(kept.tolist())


@pytest.mark.parametrize("tau", [4.0, 1e6, np.inf])
def test_many_holes_take_time_in_proportion(tau):
    """Steps, not seconds: how many links the searches look at, for four times the holes."""

    class Counting(list):
        looks = 0

        def __getitem__(self, k):
            Counting.looks += 1
            return super().__getitem__(k)

    looks = []
    for k in (8, 16):
        prepared = stages.prepared(shapes.lattice_of_holes(k))
        limit = np.array([tau])
        selected, role, bound = solution(prepared, limit)
        graph = graph_of(prepared, selected)
        Counting.looks = 0
        dropped(prepared, selected, role, bound, limit, graph._replace(links=Counting(graph.links)))
        looks.append(Counting.looks)
    assert looks[1] <= 10 * looks[0]  # none, where all edges are bridges


# ---------------------------------------------------------------- a chunk of polygons

POOL = [
    *shapes.TOUCHING.values(),
    shapes.DUMBBELL,
    shapes.ANNULUS,
    shapes.TWO_HOLES,
    shapes.SQUARE,
    shapes.TRIANGLE,
    shapes.lattice_of_holes(3),
    shapes.koch(2),
    shapes.comb(4),
    *(shapes.mosaic(seed, 40) for seed in range(40)),
    *(shapes.mosaic(seed, 40, size=8) for seed in range(40)),
    *(shapes.polyomino(seed, 7, 7, 0.75, 0.5) for seed in range(40)),
]
TAUS = np.random.default_rng(5).choice([1.0, 1.5, 2.0, 3.0, 5.0, 30.0, np.inf], len(POOL))


def by_polygon(prepared, values, of=None):
    """Values of edges, or numbers of edges, split by polygon."""
    count = len(prepared.polygons.unit)
    first = np.searchsorted(prepared.owner, np.arange(count + 1))
    if of is None:
        return [values[a:b] for a, b in zip(first[:-1], first[1:])]
    of = prepared.owner[values]
    return [values[of == p] - first[p] for p in range(count)]


def all_stages(prepared, tau):
    """Everything that carving and dilations say, for each polygon, in its own numbers."""
    polygons, edges = prepared.polygons, prepared.edges
    count = len(polygons.unit)
    component = boundary_components(polygons)
    ring_of = polygons.polygon_offsets[:-1]
    selected, role, bound = solution(prepared, tau, 0.2)
    kept = dropped(prepared, selected, role, bound, tau)
    graph = graph_of(prepared, kept)
    some = np.flatnonzero(bound > 1.0)
    carved, walk = prepared.carved, prepared.carved.walk
    tree = by_polygon(prepared, carved.tree, True)
    before = np.cumsum([0] + [len(t) for t in tree])
    joined, apart = spanning_tree(polygons, component, edges[kept], prepared.length[kept], prepared.wanted)
    loose = bound * 2.0  # a bound that is none: all distances are searched
    result = []
    largest = largest_dilation(graph, edges, prepared.length, loose, prepared.owner, count, nothing)
    true = by_polygon(prepared, true_dilations(graph, edges, prepared.length, loose, nothing))
    detour = by_polygon(prepared, detours(polygons, prepared.edge_length, edges, prepared.length))
    kept, joined, some = (by_polygon(prepared, x, True) for x in (kept, kept[joined], some))
    i, j = by_polygon(prepared, walk.i), by_polygon(prepared, walk.j)
    for p in range(count):
        lo, hi = walk.offsets[p : p + 2]
        edge, free = walk.edge[lo:hi], np.setdiff1d(np.arange(len(i[p])), tree[p])
        result.append(
            (
                component[ring_of[p] : polygons.polygon_offsets[p + 1]] - ring_of[p],
                tree[p],
                walk.corner[lo:hi] - polygons.corner_offsets[p],
                np.where(edge < 0, edge + before[p], edge - polygons.corner_offsets[p]),
                i[p][free] - lo,
                j[p][free] - lo,
                kept[p],
                joined[p],
                apart[p],
                some[p],
                largest[p],
                true[p],
                detour[p],
            )
        )
    return result


@lru_cache(maxsize=None)
def alone(k):
    return all_stages(prepare(stages.together([POOL[k]])), TAUS[[k]])[0]


@pytest.mark.parametrize("seed", range(40))
def test_a_polygon_does_not_depend_on_its_chunk(seed):
    """2,000 polygons in random chunks: bit by bit what they are alone."""
    rng = np.random.default_rng([7, seed])
    chosen = rng.integers(0, len(POOL), rng.integers(1, 100))
    prepared = prepare(stages.together([POOL[k] for k in chosen]))
    assert not (prepared.verdict != "").any()
    for k, found in zip(chosen, all_stages(prepared, TAUS[chosen])):
        for one_value, other in zip(alone(k), found):
            assert np.array_equal(one_value, other)


def test_parts_of_a_chunk_that_fail_leave_the_rest():
    """Polygons whose holes the edges do not join, or whose touching is ambiguous, among good ones."""
    polygons, _ = from_rings(stages.together([shapes.TWO_HOLES, shapes.ANNULUS, shapes.TWO_HOLES]))
    triangles, problems, _ = triangulation.triangulate(polygons)
    assert not (problems != "").any()
    edges = triangulation.diagonals(polygons, triangles)
    length = planar().length(polygons.xy, *edges.T)
    component = boundary_components(polygons)
    wanted = np.zeros(len(component), dtype=bool)
    wanted[component] = True
    owner = polygons.polygon_of_vertex[edges[:, 0]]
    reaching = (owner < 2) | (polygons.xy[edges].max(axis=(1, 2)) < 12)
    edges, length = edges[reaching], length[reaching]
    tree, apart = spanning_tree(polygons, component, edges, length, wanted)
    assert apart.tolist() == [0, 0, 1]
    walk, ambiguous = carve(polygons, component, edges, tree, wanted)
    assert ambiguous.tolist() == [False, False, True], "its rings are not one walk"
    assert np.diff(walk.offsets).tolist() == [12 + 2 * 2, 8 + 2, 0]
    assert (groups(polygons.corner_offsets)[walk.corner] == groups(walk.offsets)).all()
