from collections import Counter

import numpy as np
import pytest

from isthmus.core.partition.carving import carve, spanning_tree
from isthmus.core.metric import planar
from isthmus.core.partition.polygon import boundary_components
from isthmus.core.partition.polygon import one as from_rings

from .. import shapes, stages

CASES = {
    **shapes.TOUCHING,
    "dumbbell": shapes.DUMBBELL,
    "annulus": shapes.ANNULUS,
    "lattice of holes": shapes.lattice_of_holes(4),
    **{f"mosaic {seed}": shapes.mosaic(seed, 40) for seed in range(15)},
    **{f"polyomino {seed}": shapes.polyomino(seed, 7, 7, 0.75, 0.5) for seed in range(15)},
}


def prepared(s):
    polygon = from_rings(*s)
    edges = stages.diagonals(polygon)
    length = planar().length(polygon.xy, *edges.T)
    component = boundary_components(polygon)
    wanted = np.zeros(len(component), dtype=bool)
    wanted[component] = True
    return polygon, component, edges, length, wanted


@pytest.mark.parametrize(
    "name, expected",
    [
        ("touch at vertex", [0, 0]),
        ("touch in edge", [0, 0]),
        ("holes touch", [0, 1, 1]),
        ("chain of holes", [0, 1, 1, 1]),
        ("three at a point", [0, 1, 1, 1]),
        ("notch touches last hole", [0, 1, 0]),
        ("annulus", [0, 1]),
        ("dumbbell", [0]),
    ],
)
def test_components(name, expected):
    assert boundary_components(from_rings(*CASES[name])).tolist() == expected


@pytest.mark.parametrize("name", CASES)
def test_minimum_spanning_tree(name):
    """As short as the tree that Prim's algorithm finds."""
    polygon, component, edges, length, wanted = prepared(CASES[name])
    of_vertex = dict(zip(polygon.vertex.tolist(), component[polygon.ring_of_corner].tolist()))
    ends = [(of_vertex[u], of_vertex[v]) for u, v in edges.tolist()]
    reached, total = {0}, 0.0
    while reached != set(component.tolist()):
        d, k = min((length[k], k) for k, (a, b) in enumerate(ends) if (a in reached) != (b in reached))
        reached |= set(ends[k])
        total += d
    tree, apart = spanning_tree(polygon, component, edges, length, wanted)
    assert not apart.any() and len(tree) == wanted.sum() - 1
    assert length[tree].sum() == pytest.approx(total)
    assert (np.diff(tree) > 0).all()


@pytest.mark.parametrize("name", CASES)
def test_ties_are_broken_by_coordinates(name):
    """Kruskal by length, then the smaller end, then the larger one: however the vertices are numbered."""
    polygon, component, edges, length, wanted = prepared(CASES[name])
    of_vertex = dict(zip(polygon.vertex.tolist(), component[polygon.ring_of_corner].tolist()))
    xy = [tuple(point) for point in polygon.xy.tolist()]
    group = {c: {c} for c in component.tolist()}
    expected = []
    for k in sorted(range(len(edges)), key=lambda k: (length[k], *sorted(xy[v] for v in edges[k]))):
        a, b = (group[of_vertex[v]] for v in edges[k].tolist())
        if a is not b:
            expected.append(k)
            a |= b
            group.update(dict.fromkeys(b, a))
    assert spanning_tree(polygon, component, edges, length, wanted)[0].tolist() == sorted(expected)


def test_the_tree_leaves_unwanted_components_out():
    polygon, component, edges, length, wanted = prepared(shapes.TWO_HOLES)
    wanted[2] = False
    tree, apart = spanning_tree(polygon, component, edges, length, wanted)
    assert apart.tolist() == [0]
    assert sorted(polygon.ring_of_corner[edges[tree]].ravel().tolist()) == [0, 1]


def test_holes_that_the_edges_do_not_connect():
    polygon, component, edges, length, wanted = prepared(shapes.TWO_HOLES)
    left = polygon.xy[edges].max(axis=(1, 2)) < 12
    _, apart = spanning_tree(polygon, component, edges[left], length[left], wanted)
    assert apart.tolist() == [1]


@pytest.mark.parametrize("name", CASES)
def test_walk(name):
    """Once along each polygon edge and twice along each of T; candidates nest on it."""
    polygon, component, edges, length, wanted = prepared(CASES[name])
    tree, walk = stages.carved(polygon, edges, length)
    m = len(walk.corner)
    assert walk.corner[0] == 0

    count = Counter(walk.edge.tolist())
    assert count == {**{c: 1 for c in range(len(polygon.vertex))}, **{-1 - t: 2 for t in range(len(tree))}}
    at = polygon.vertex[walk.corner]
    steps = zip(at.tolist(), np.roll(at, -1).tolist(), walk.edge.tolist())
    for a, b, edge in steps:
        if edge >= 0:
            assert (a, b) == (polygon.vertex[edge], polygon.vertex[polygon.next_corner[edge]])
        else:
            assert {a, b} == set(edges[tree[-1 - edge]].tolist())

    free = np.setdiff1d(np.arange(len(edges)), tree)
    i, j = walk.i[free], walk.j[free]
    assert (i < j).all()
    assert np.array_equal(np.sort(np.column_stack((at[i], at[j])), axis=1), edges[free])
    crossing = (i[:, None] < i) & (i < j[:, None]) & (j[:, None] < j)
    assert not crossing.any()
    assert len(free) == m - 3, "the candidates triangulate P_T"


def test_the_walk_leaves_unwanted_rings_out():
    polygon, component, edges, length, _ = prepared(shapes.TWO_HOLES)
    ends = component[polygon.ring_of_corner][edges]
    kept = edges[(ends != 2).all(axis=1)]
    length = planar().length(polygon.xy, *kept.T)
    wanted = np.array([True, True, False])
    tree, _ = spanning_tree(polygon, component, kept, length, wanted)
    walk, _ = carve(polygon, component, kept, tree, wanted)
    assert set(polygon.ring_of_corner[walk.corner].tolist()) == {0, 1}
    assert len(walk.corner) == 8 + 2
