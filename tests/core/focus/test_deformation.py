"""The least squares, the bounds, the measures, the rules for relevant edges."""

import numpy as np
import pytest
import shapely

pytest.importorskip("scipy")

from isthmus.tests.core.checker import dilations
from isthmus.core.focus import crossings, deformation, graph, measures, outline, selection
from isthmus.core.partition.polygon import from_rings
from isthmus.core.partition.triangulation import diagonals

from ..shapes import circle, tour


def nothing(share=None):
    pass


def line_program(scale):
    """Five points on a line, the middle two in focus, the ends fixed."""
    xy = np.array([(0.0, 0.0), (0.25, 0.0), (0.5, 0.0), (0.75, 0.0), (1.0, 0.0)])
    edges = np.array([(0, 1), (1, 2), (2, 3), (3, 4)])
    group = np.array([-1, 0, 0, -1, -1])
    fixed = [(0, 0, 0.0), (0, 4, 0.0), (1, 0, 0.0)]
    origin = xy[1:3].mean(axis=0)[None]
    return deformation.focus_program(xy, edges, group, origin, scale, fixed)


def test_the_focus_is_exact_and_the_frame_kept():
    program = line_program(1.3)
    x = program.xy[:, 0]
    assert x[2] - x[1] == pytest.approx(0.325, abs=1e-12)
    assert (x[0], x[4]) == (0.0, 1.0)
    assert (np.diff(x) > 0).all()
    assert program.s[1] == program.s[2] == 1.3


def test_scale_one_changes_nothing():
    program = line_program(1.0)
    assert np.array_equal(program.xy, program.start)
    assert (program.s == 1.0).all()


def test_it_is_the_least_distortion():
    """No random change of the free coordinates makes the sum of squares smaller."""
    program = line_program(1.5)
    rng = np.random.default_rng(5)
    least = np.sum((program.matrix @ program.z) ** 2)
    for _ in range(50):
        change = program.spread @ rng.normal(0.0, 1e-3, program.spread.shape[1])
        assert np.sum((program.matrix @ (program.z + change)) ** 2) > least


def test_a_bound_is_met_exactly_and_released():
    program = line_program(1.5)
    free = program.xy[3, 0]
    bound = deformation.Bounds(
        np.array([3, 3]), np.array([-1, -1]), np.array([(1.0, 0.0), (-1.0, 0.0)]),
        np.array([free + 0.02, -1.0]),
    )  # fmt: skip
    assert program.add(bound)
    assert program.xy[3, 0] == pytest.approx(free + 0.02, abs=2e-9)
    # a further bound that is more than enough takes the load off the first
    assert program.add(deformation.Bounds(
        np.array([3]), np.array([2]), np.array([(1.0, 0.0)]), np.array([0.2])
    ))  # fmt: skip
    assert program.bounds.excess(program.xy).min() > -2e-9


def test_bounds_that_contradict_are_refused():
    program = line_program(1.5)
    assert not program.add(deformation.Bounds(
        np.array([3, 3]), np.array([-1, -1]), np.array([(1.0, 0.0), (-1.0, 0.0)]),
        np.array([0.9, -0.8]),
    ))  # fmt: skip


def test_a_fixed_vertex_in_focus_fixes_its_region():
    xy = circle(12)
    edges = np.column_stack((np.arange(12), np.roll(np.arange(12), -1)))
    group = np.where(np.arange(12) < 3, 0, -1)
    program = deformation.focus_program(
        xy, edges, group, xy[:1], 2.0, [(0, 0, 0.0), (1, 0, 0.0), (0, 6, 0.0), (1, 6, 0.0)]
    )
    assert np.allclose(program.xy[:3], xy[0] + 2.0 * (xy[:3] - xy[0]), atol=1e-14)


def test_crossing_pairs_by_brute_force():
    rng = np.random.default_rng(7)
    xy = rng.random((30, 2))
    edges = graph.unique_pairs(rng.integers(0, 30, (40, 2)), 30)
    found = {tuple(pair) for pair in crossings.crossing_pairs(xy, edges)}
    expected = set()
    for a in range(len(edges)):
        for b in range(a + 1, len(edges)):
            if not set(edges[a]) & set(edges[b]):
                if shapely.LineString(xy[edges[a]]).intersects(shapely.LineString(xy[edges[b]])):
                    expected.add((a, b))
    assert found == expected and len(found) > 20
    moved = rng.random(len(edges)) < 0.3
    some = [tuple(pair) for pair in crossings.crossing_pairs(xy, edges, moved)]
    assert sorted(some) == sorted(pair for pair in expected if moved[list(pair)].any())


def test_separations_hold_now_and_forbid_crossing():
    xy = np.array([(0.0, 0.0), (1.0, 0.0), (0.2, 0.1), (0.6, 0.4)])
    edges = np.array([(0, 1), (2, 3)])
    bounds = crossings.separations(xy, edges, np.array([(0, 1)]), 0.1)
    assert (bounds.excess(xy) > 0).all()
    over = xy.copy()
    over[2, 1] = -0.1
    assert (bounds.excess(over) < 0).any()


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_angular_distortion(turn):
    before = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    triangle = np.array([(0, 1, 2)])
    rotation = np.array([(np.cos(turn), -np.sin(turn)), (np.sin(turn), np.cos(turn))])
    _, kept, angle = measures.angular_distortion(before, 3.0 * before @ rotation, triangle)
    assert kept.all() and angle == pytest.approx(0.0, abs=1e-6)
    # stretched twice in x: 2 arcsin(1 / 3)
    _, kept, angle = measures.angular_distortion(before, before * (2, 1) @ rotation, triangle)
    assert kept.all() and angle == pytest.approx(np.degrees(2 * np.arcsin(1 / 3)))
    _, kept, angle = measures.angular_distortion(before, before * (-1, 1) @ rotation, triangle)
    assert not kept.any() and angle == 180.0


@pytest.mark.parametrize("seed", range(4))
def test_greedy_is_greedy(seed):
    """Against the definition: add the diagonal of largest dilation, all distances from scratch."""
    shape = tour(seed, 24)
    polygon = from_rings(shape.coords, shape.offsets)
    rows = np.empty(len(polygon.xy), dtype=int)
    rows[polygon.vertex] = polygon.rows[polygon.row_start[:-1]]
    candidates = rows[diagonals(polygon)]
    ring, chosen = [np.arange(24)], []
    while True:
        dilation = dilations(shape.coords, ring, chosen, candidates)
        if dilation.max() <= 2.0:
            break
        chosen.append(tuple(candidates[dilation.argmax()]))
    found = selection.greedy(shape.coords, shape.offsets, 2.0, nothing)
    assert {frozenset(e) for e in found.tolist()} == {frozenset(map(int, e)) for e in chosen}
    assert len(selection.min_size(shape.coords, shape.offsets, 2.0, nothing)) <= len(chosen)


def test_proximity():
    """A comb: the teeth are near, and far along the outline."""
    teeth = [(x, y) for k in range(5) for x, y in ((2 * k, 9.0), (2 * k, 0.5), (2 * k + 1, 0.5),
                                                    (2 * k + 1, 9.0))]
    ring = np.array([(-1.0, 9.0), (-1.0, 0.0), (10.0, 0.0), (10.0, 9.0)] + teeth[::-1])
    assert shapely.Polygon(ring).is_valid
    offsets = np.array([0, len(ring)])
    length = lambda edges: np.hypot(*(ring[edges[:, 0]] - ring[edges[:, 1]]).T)
    near = selection.proximity(ring, offsets, 5.0, nothing)
    hops = np.abs(near[:, 0] - near[:, 1])
    assert len(near) and (length(near) < 5.0).all()
    assert (np.minimum(hops, len(ring) - hops) >= selection.HOPS).all()


def test_joins_connect_islands():
    rng = np.random.default_rng(3)
    islands = [circle(8, 0.3, centre) for centre in rng.permutation(25)[:, None] % (5, 1000) // (1, 5)]
    xy = np.concatenate(islands)
    ring = np.arange(8)
    edges = np.concatenate([np.column_stack((ring, np.roll(ring, -1))) + 8 * k for k in range(25)])
    found = graph.joins(xy, edges, 2.0)
    assert graph.components(len(xy), np.concatenate((edges, found))).max() == 0
    assert (found[:, 0] // 8 != found[:, 1] // 8).all()


def test_joins_of_points_on_a_line():
    xy = np.array([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)])
    edges = np.array([(0, 1), (2, 3)])
    assert graph.joins(xy, edges, 2.0).tolist() == [[1, 2]]


def test_simplified_outline_has_no_crossings_and_carries_exactly():
    """A coast with fine detail, and an island close to it."""
    angle = np.linspace(0.0, 2.0 * np.pi, 3001)[:-1]
    radius = 0.4 + 0.03 * np.sin(9 * angle) + 0.004 * np.sin(301 * angle)
    coast = np.column_stack((np.cos(angle), np.sin(angle))) * radius[:, None]
    rows = np.concatenate((coast, coast[:1], circle(40, 0.01, (0.45, 0.0))))
    made = graph.build_graph(rows, np.array([0, 3001, 3041]))
    simple = outline.simplify(made.xy, made.edges, np.zeros(len(made.xy), dtype=bool), 400, nothing)
    assert len(simple.kept) <= 450
    assert len(crossings.crossing_pairs(made.xy, simple.edges)) == 0
    assert len(simple.kept) + len(simple.rider) == len(made.xy)
    # what scales the kept vertices about a point scales the detail as well
    after = np.zeros_like(made.xy)
    after[simple.kept] = 3.0 * made.xy[simple.kept] + 1.0
    carried = outline.carry(simple, made.xy, after, np.full(len(made.xy), 3.0))
    assert np.allclose(carried, 3.0 * made.xy + 1.0, atol=1e-12)


def test_min_length_is_no_longer_than_the_others():
    shape = tour(5, 40)
    length = {
        rule: sum(
            np.hypot(*(shape.coords[u] - shape.coords[v]))
            for u, v in selection.select(rule, shape.coords, shape.offsets, 2.0, 1.0, nothing)
        )
        for rule in ("MinLength", "MinSize", "Greedy")
    }
    assert 0.0 < length["MinLength"] <= 1.001 * min(length.values())
