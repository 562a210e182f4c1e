"""The solver, the triangulation and its hierarchy, the measures, the rules for relevant edges."""

import itertools
import sys

import numpy as np
import pytest
import shapely

pytest.importorskip("scipy")

from isthmus.tests.core.checker import dilations
from isthmus.core.errors import MissingEngine
from isthmus.core.focus.convex import stay_convex
from isthmus.core.focus import carrying, deformation, graph, hierarchy, measures, mesh, selection

from ..shapes import circle, tour
from .verify import crossing_pairs


def nothing(share=None):
    pass


def frame(seed, n=60):
    """A triangulated square, its side vertices, and some edges between its vertices."""
    rng = np.random.default_rng(seed)
    side = np.linspace(0.0, 1.0, 6)
    rim = np.array([(a, b) for a in side for b in side if {a, b} & {0.0, 1.0}])
    xy = np.concatenate((rim, rng.uniform(0.1, 0.9, (n, 2))))
    triangles = mesh.frame_triangles(xy, np.empty((0, 2), dtype=int))
    sides = [np.flatnonzero(xy[:, axis] == value) for axis in (0, 1) for value in (0.0, 1.0)]
    fixed = [(k // 2, one, 0.0) for k, one in enumerate(sides)]
    edges = graph.unique_pairs(triangles[:, [0, 1, 1, 2]].reshape(-1, 2), len(xy))[::2]
    return xy, triangles, edges, fixed


@pytest.mark.parametrize("scale", [0.3, 1.0, 1.5, 2.4])
@pytest.mark.parametrize("seed", range(3))
def test_relax(seed, scale):
    """The focus is exact, the sides stay, no triangle turns."""
    xy, triangles, edges, fixed = frame(seed)
    group = np.where(np.hypot(*(xy - 0.45).T) < 0.18, 0, -1)
    origin = xy[group == 0].mean(axis=0)[None]
    shift, reached = deformation.relax(xy, triangles, edges, group, origin, scale, fixed, nothing)
    assert reached == 1.0
    after, mine = xy + shift, group == 0
    assert np.allclose(after[mine] - after[mine][0], scale * (xy[mine] - xy[mine][0]), atol=1e-12)
    for axis, side, _ in fixed:
        assert np.array_equal(after[side, axis], xy[side, axis])
    assert not mesh.turned(xy, after, triangles, flat=0.0).any()
    if scale == 1.0:
        assert np.abs(shift).max() < 1e-12


def test_it_is_the_least_distortion():
    """Where the guard weighs nothing, no random change makes the sum of squares smaller."""
    xy, triangles, edges, fixed = frame(4)
    group = np.where(np.hypot(*(xy - 0.45).T) < 0.18, 0, -1)
    origin = xy[group == 0].mean(axis=0)[None]
    shift, _ = deformation.relax(xy, triangles, edges, group, origin, 1.3, fixed, nothing, guard=1e-12)

    def distortion_of(after):
        """Of Haunert and Sering, by its definition, with the best s."""
        total = 0.0
        for u in range(len(xy)):
            others = np.concatenate((edges[edges[:, 0] == u, 1], edges[edges[:, 1] == u, 0]))
            if not len(others):
                continue
            before, now = xy[others] - xy[u], after[others] - after[u]
            square = (before**2).sum(axis=1)
            s = 1.3 if group[u] == 0 else ((before * now).sum(axis=1) / square).mean()
            total += (((s * before - now) ** 2).sum(axis=1) / square).sum()
        return total

    rng = np.random.default_rng(5)
    inner = (group < 0) & ((xy > 0.0) & (xy < 1.0)).all(axis=1)
    least = distortion_of(xy + shift)
    for _ in range(30):
        change = np.where(inner[:, None], rng.normal(0.0, 1e-3, xy.shape), 0.0)
        assert distortion_of(xy + shift + change) > least


def test_without_room_it_stops_in_time():
    xy, triangles, edges, fixed = frame(1)
    group = np.where(np.hypot(*(xy - 0.45).T) < 0.18, 0, -1)
    origin = xy[group == 0].mean(axis=0)[None]
    shift, reached = deformation.relax(xy, triangles, edges, group, origin, 9.0, fixed, nothing)
    assert 0.0 < reached < 1.0
    assert not mesh.turned(xy, xy + shift, triangles, flat=0.0).any()


def test_node():
    """A crossing, a vertex on an edge, and edges that overlap."""
    xy = np.array([(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 0.0), (0.25, 0.25), (0.0, 0.25),
                   (0.2, 0.0), (0.6, 0.0)])  # fmt: skip
    edges = np.array([(0, 1), (2, 3), (4, 5), (0, 3), (6, 7)])
    noded = mesh.node(xy, edges, nothing)
    assert len(noded.xy) == 9 and noded.xy[8] == pytest.approx((0.5, 0.5))
    expected = {(0, 4), (4, 8), (1, 8), (2, 8), (3, 8), (4, 5), (0, 6), (6, 7), (3, 7)}
    assert {tuple(e) for e in noded.edges.tolist()} == expected
    assert noded.splits.tolist() == [[0, 1, 4], [0, 1, 8], [2, 3, 8], [0, 3, 6], [0, 3, 7]]


def test_node_takes_what_is_nearly_there():
    """A vertex that is across an edge but for rounding lies on it, and lines through one point have one there."""
    xy = np.array([(0.0, 0.0), (1.0, 0.0), (0.5, -1e-11), (0.5, 1.0)])
    noded = mesh.node(xy, np.array([(0, 1), (2, 3)]), nothing)
    assert np.array_equal(noded.xy, xy) and noded.splits.tolist() == [[0, 1, 2]]
    angle = np.linspace(0.1, 3.0, 7)
    arm = np.column_stack((np.cos(angle), np.sin(angle))) / 3.0
    xy = np.concatenate(((0.37, 0.41) + arm, (0.37, 0.41) - 1.1 * arm))
    noded = mesh.node(xy, np.column_stack((np.arange(7), np.arange(7, 14))), nothing)
    assert len(noded.xy) == 15 and len(noded.edges) == 14


def test_lines_that_cross_at_a_vertex_of_another_share_it():
    """Where the two cross, rounding makes a point that is not that vertex to the last bit."""
    for angle in np.linspace(0.01, 3.0, 60):
        arm = np.array([(np.cos(k), np.sin(k)) for k in angle + np.array((0.0, 1.1))])
        xy = 0.1 + np.concatenate(([(0.0, 0.0), (0.3, 0.4)], arm / 3.0, -arm / 7.0))
        noded = mesh.node(xy, np.array([(2, 4), (3, 5), (0, 1)]), nothing)
        assert np.array_equal(noded.xy, xy) and len(noded.edges) == 5


def test_a_line_of_one_point_has_no_edge():
    found = graph.build_graph(
        np.array([(5.0, 5.0), (0.0, 0.0), (1.0, 0.0), (2.0, 2.0)]), np.array([0, 1, 3, 4])
    )
    assert found.xy[found.edges].tolist() == [[[0.0, 0.0], [1.0, 0.0]]]


def test_a_triangle_that_becomes_flat_has_turned():
    before = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    for y, wrong in ((1e-300, False), (0.0, True), (-1e-300, True)):
        after = np.array([(0.0, 0.0), (1.0, 0.0), (0.5, y)])
        assert mesh.turned(before, after, np.array([(0, 1, 2)])).tolist() == [wrong]


def test_a_flat_triangle_that_turns_tells_of_lines_that_cross():
    """A point of a line that nearly touches another one, farther from it than what counts as touching."""
    before = np.array([(0.0, 0.0), (1.0, 0.0), (0.5, 5e-12), (0.5, 1.0)])
    after = before.copy()
    after[2, 1] = -5e-12
    triangles = np.array([(0, 1, 2), (1, 3, 2), (0, 2, 3)])
    assert not mesh.turned(before, after, triangles).any()
    lines = np.array([(0, 1), (2, 3)])
    assert mesh.crossed(before, after, triangles, lines).tolist() == [True, False, False]
    assert not mesh.crossed(before, after, triangles, lines[:1]).any()
    assert not mesh.crossed(after, after, triangles, lines).any()  # they did before
    assert not mesh.crossed(before, before, triangles, lines).any()


@pytest.mark.parametrize("seed", range(4))
def test_node_leaves_no_crossing(seed):
    rng = np.random.default_rng(seed)
    xy = rng.random((40, 2))
    edges = graph.unique_pairs(rng.integers(0, 40, (50, 2)), 40)
    noded = mesh.node(xy, edges, nothing)
    assert len(crossing_pairs(xy, edges)) > 20 and len(crossing_pairs(noded.xy, noded.edges)) == 0
    length = lambda p, e: np.hypot(*(p[e[:, 0]] - p[e[:, 1]]).T).sum()  # noqa: E731
    assert length(noded.xy, noded.edges) == pytest.approx(length(xy, edges))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("engine", ["triangle", "pythoncdt", "shapely"])
def test_frame_triangles(engine, seed, monkeypatch):
    """All points, all segments, and as many triangles as the convex hull has room for."""
    alone(engine, monkeypatch)
    rng = np.random.default_rng(seed)
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    edges = np.concatenate(
        (graph.unique_pairs(rng.integers(4, 44, (20, 2)), 44), [(0, 1), (1, 2), (2, 3), (0, 3)])
    )
    noded = mesh.node(np.concatenate((corners, rng.uniform(0.1, 0.9, (40, 2)))), edges, nothing)
    check_frame_triangles(noded.xy, noded.edges)


@pytest.mark.parametrize("engine", ["triangle", "pythoncdt", "shapely"])
def test_frame_triangles_between_lines_that_hide_points(engine, monkeypatch):
    """Points, and lines with loose ends, whose nearest neighbours are all behind a line."""
    alone(engine, monkeypatch)
    rng = np.random.default_rng(5)
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    rows = [(x, y) for y in np.arange(0.1, 0.9, 0.02) for x in (0.1, 0.9)]
    height = rng.integers(0, 39, 60) * 0.02 + rng.uniform(0.105, 0.115, 60)
    between = np.column_stack((rng.uniform(0.2, 0.8, 60), height))
    lines = [(k, k + 1) for k in range(4, 4 + len(rows), 2)]
    first = 4 + len(rows)
    loose = [(first + k, first + k + 1) for k in range(0, 20, 2)]
    between[1:20:2, 1] = between[0:20:2, 1]
    edges = np.array(lines + loose + [(0, 1), (1, 2), (2, 3), (0, 3)])
    noded = mesh.node(
        np.concatenate((corners, rows, between)), graph.unique_pairs(edges, first + 60), nothing
    )
    check_frame_triangles(noded.xy, noded.edges)


def alone(engine, monkeypatch):
    pytest.importorskip(engine)
    monkeypatch.delenv("ISTHMUS_ENGINE", raising=False)
    for other in {"triangle", "pythoncdt"} - {engine}:
        monkeypatch.setitem(sys.modules, other, None)


def check_frame_triangles(xy, edges):
    triangles = mesh.frame_triangles(xy, edges)
    assert len(triangles) == 2 * len(xy) - 2 - 4 and (mesh.heights(xy, triangles) > 0.0).all()
    pairs = graph.unique_pairs(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), len(xy))
    assert {tuple(e) for e in edges.tolist()} <= {tuple(e) for e in pairs.tolist()}


def test_without_an_engine(monkeypatch):
    monkeypatch.delenv("ISTHMUS_ENGINE", raising=False)
    for name in ("triangle", "pythoncdt"):
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.delattr(mesh.shapely, "constrained_delaunay_triangles", raising=False)
    with pytest.raises(MissingEngine, match="pythoncdt"):
        mesh.frame_triangles(np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]), np.array([(0, 1)]))


def upright(xy, triangles):
    a, b, c = xy[triangles].transpose(1, 0, 2)
    return (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] > 0.0


@pytest.mark.parametrize("seed", range(6))
def test_other_triangulations_of_points_on_a_circle(seed):
    """Any three of them stay upright if those that `others` tells do, and only then."""
    rng = np.random.default_rng(seed)
    xy = np.concatenate((circle(6, 1.0, (2.0, 0.5)), [(-3.0, -3.0), (6.1, -3.0), (6.0, 4.0), (-3.0, 4.2)]))
    triangles = mesh.frame_triangles(xy, np.empty((0, 2), dtype=int))
    found = mesh.others(xy, triangles, np.empty((0, 2), dtype=int))
    assert len(found) == 6 and (found < 6).all() and upright(xy, found).all()
    every = np.array(list(itertools.combinations(range(6), 3)))
    every = np.where(upright(xy, every)[:, None], every, every[:, ::-1])
    seen = set()
    for _ in range(200):
        after = xy + rng.normal(0.0, 0.25, xy.shape)
        if upright(after, triangles).all():
            seen.add(bool(upright(after, every).all()))
            assert upright(after, found).all() == upright(after, every).all()
    assert seen == {False, True}


@pytest.mark.parametrize(
    "seed, far, times",
    [(0, 0.11, 1), (1, 0.11, 1), (2, 0.11, 1), (8, 0.2, 4), (46, 0.2, 4), (57, 0.2, 4), (130, 0.2, 4)],
)
def test_darts_become_convex_again(seed, far, times):
    """Corners beyond the other diagonal of their square come back, and no triangle is turned on the way.

    In the last four a corner is left where it has no room unless its neighbours move with it.
    """
    rng = np.random.default_rng(seed)
    xy = np.array([(x, y) for x in range(9) for y in range(9)], dtype=float) / 8.0
    none = np.empty((0, 2), dtype=int)
    triangles = mesh.frame_triangles(xy, none)
    spare = mesh.others(xy, triangles, none)
    inner = ((xy > 0.0) & (xy < 1.0)).all(axis=1)
    shift = np.zeros_like(xy)
    for _ in range(times):
        for vertex in rng.permutation(np.flatnonzero(inner)):
            trial = shift.copy()
            trial[vertex] += rng.uniform(-far, far, 2)
            if upright(xy + trial, triangles).all():
                shift = trial
    assert not upright(xy + shift, spare).all()
    held = np.flatnonzero(inner)[0]
    free = inner & (np.arange(len(xy)) != held)
    found = stay_convex(xy, shift, triangles, spare, free, lambda: None)
    assert upright(xy + found, triangles).all() and upright(xy + found, spare).all()
    assert np.array_equal(found[~free], shift[~free])


def test_a_line_across_a_square_leaves_no_choice():
    xy = np.array([(x, y) for x in range(3) for y in range(3)], dtype=float) / 2.0
    rim = [(0, 1), (1, 2), (2, 5), (5, 8), (7, 8), (6, 7), (3, 6), (0, 3)]
    line = np.array([(0, 4)] + rim)
    triangles = mesh.frame_triangles(xy, line)
    squares = {frozenset((k, k + 1, k + 3, k + 4)) for k in (0, 1, 3, 4)}
    found = mesh.others(xy, triangles, line)
    assert len(found) == 12 and all(
        sum(set(one) < square for square in squares) == 1 for one in found.tolist()
    )
    assert not any(set(one) < {0, 1, 3, 4} for one in found.tolist())
    assert len(mesh.others(xy + np.arange(18).reshape(9, 2) ** 2 * 1e-6, triangles, line)) == 0


def test_stiff_triangles_bend_less():
    xy, triangles, edges, fixed = frame(2)
    group = np.where(np.hypot(*(xy - 0.45).T) < 0.18, 0, -1)
    origin = xy[group == 0].mean(axis=0)[None]
    right = xy[triangles].mean(axis=1)[:, 0] > 0.6
    bent = []
    for side in (right, ~right):
        shift, _ = deformation.relax(
            xy, triangles, edges[:0], group, origin, 1.8, fixed, nothing, stiff=np.where(side, 100.0, 1.0)
        )
        bent.append(measures.distortion(xy, xy + shift, triangles[right]).median)
    assert bent[0] < 0.5 * bent[1]


def coarse_of(seed, n=800):
    rng = np.random.default_rng(seed)
    xy = np.concatenate((rng.random((n, 2)), [(-0.1, -0.1), (1.1, -0.1), (1.1, 1.1), (-0.1, 1.1)]))
    triangles = mesh.frame_triangles(xy, np.empty((0, 2), dtype=int))
    ring = np.argsort(np.arctan2(*(xy[:n] - 0.5).T))[: n // 2]
    edges = graph.unique_pairs(np.column_stack((ring[:-1], ring[1:])), len(xy))
    edges = edges[
        np.isin(
            edges @ (len(xy), 1),
            graph.unique_pairs(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), len(xy)) @ (len(xy), 1),
        )
    ]
    removable = np.arange(len(xy)) < n
    found = hierarchy.coarsen(
        xy, triangles, edges, removable, np.zeros(len(xy), bool), 60, lambda share: None
    )
    return xy, triangles, found


@pytest.mark.parametrize("seed", range(3))
def test_coarsen_tiles_the_same_square(seed):
    xy, triangles, found = coarse_of(seed)
    assert len(np.unique(found.triangles)) <= 120
    assert (mesh.heights(xy, found.triangles) > 0.0).all()
    a, b, c = xy[found.triangles].transpose(1, 0, 2)
    area = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]).sum() / 2.0
    assert area == pytest.approx(1.44)
    sides = graph.unique_pairs(found.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), len(xy))
    assert {tuple(e) for e in found.edges.tolist()} <= {tuple(e) for e in sides.tolist()}


@pytest.mark.parametrize("seed", range(3))
def test_what_is_put_back_never_turns(seed):
    """Under a wild map of the coarse vertices that turns none of the coarse triangles."""
    xy, triangles, found = coarse_of(seed)
    kept = np.unique(found.triangles)
    rng = np.random.default_rng(seed)
    shift = np.zeros_like(xy)
    for _ in range(400):  # one coarse vertex after the other, as far as it may go
        v = rng.choice(kept[kept < len(xy) - 4])
        old = shift[v].copy()
        shift[v] += rng.normal(0.0, 0.1, 2)
        while mesh.turned(xy, xy + shift, found.triangles, flat=0.0).any():
            shift[v] = old + 0.5 * (shift[v] - old)
    after = xy + hierarchy.reinsert(found, xy, shift, np.zeros(len(xy), bool), nothing)
    assert not mesh.turned(xy, after, triangles, flat=0.0).any()
    assert np.array_equal(after[kept], (xy + shift)[kept]) and np.abs(after - xy).max() > 0.1


def test_what_is_known_stays_when_it_is_put_back():
    xy, triangles, edges, _ = frame(3)
    free = ((xy > 0.0) & (xy < 1.0)).all(axis=1)
    known = free & (xy[:, 0] < 0.5)
    coarse = hierarchy.coarsen(xy, triangles, edges, free, known, 5, lambda share: None)
    gone = known & (coarse.into != np.arange(len(xy)))
    assert np.count_nonzero(gone) > 5
    shift = np.zeros_like(xy)
    shift[known] = 1e-5, 2e-5
    assert (hierarchy.reinsert(coarse, xy, shift, known, nothing)[known] == (1e-5, 2e-5)).all()


def test_what_is_put_back_is_carried_by_an_affine_map():
    xy, triangles, found = coarse_of(1)
    shift = xy @ np.array([(0.5, 0.2), (-0.1, 0.3)])
    known = hierarchy.reinsert(
        found,
        xy,
        np.where(np.isin(np.arange(len(xy)), found.triangles)[:, None], shift, 0.0),
        np.zeros(len(xy), bool),
        nothing,
    )
    assert np.allclose(known, shift, atol=1e-12)


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
    polygon, edges = selection._candidates(shape.coords, shape.offsets)
    rows = np.empty(len(polygon.xy), dtype=int)
    rows[polygon.vertex] = polygon.rows[polygon.row_start[:-1]]
    candidates = rows[edges]
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
    teeth = [
        (x, y) for k in range(5) for x, y in ((2 * k, 9.0), (2 * k, 0.5), (2 * k + 1, 0.5), (2 * k + 1, 9.0))
    ]
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


@pytest.mark.parametrize("tau", [1.5, 3.0, 8.0])
def test_joins_are_needed_and_enough(tau):
    """By the rule: each has no shorter one that offers a way, and every Delaunay edge across the water has."""
    rng = np.random.default_rng(7)
    shores = [np.column_stack((x + rng.uniform(-0.2, 0.2, 15), np.arange(15))) for x in (0.0, 1.5, 4.0)]
    xy = np.unique(np.concatenate(shores), axis=0)
    shore = np.digitize(xy[:, 0], (0.75, 2.75))
    edges = np.concatenate(
        [
            np.column_stack((v[:-1], v[1:]))
            for v in (np.flatnonzero(shore == k)[np.argsort(xy[shore == k, 1])] for k in range(3))
        ]
    )
    found = graph.joins(xy, np.sort(edges, axis=1), tau)
    length = np.hypot(*(xy[found[:, 0]] - xy[found[:, 1]]).T)
    lines = shapely.get_parts(shapely.delaunay_triangles(shapely.multipoints(xy), only_edges=True))
    place = {tuple(p): k for k, p in enumerate(xy.tolist())}
    across = [
        (place[tuple(a)], place[tuple(b)])
        for a, b in (shapely.get_coordinates(one).tolist() for one in lines)
    ]
    chosen = {frozenset(one) for one in found.tolist()}
    for u, v in across:
        if shore[u] == shore[v]:
            continue
        own = np.hypot(*(xy[u] - xy[v]))
        alike = (length < own) & (np.sort(shore[found], axis=1) == sorted((shore[u], shore[v]))).all(axis=1)
        ends = np.where(shore[found[alike]] == shore[u], 0, 1)
        way = length[alike] + sum(
            np.hypot(*(xy[found[alike]] - xy[np.where(ends == 0, u, v)]).transpose(2, 0, 1))[:, k]
            for k in (0, 1)
        )
        assert (frozenset((u, v)) in chosen) == bool((way > tau * own).all())


def test_joins_of_points_on_a_line():
    xy = np.array([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)])
    edges = np.array([(0, 1), (2, 3)])
    assert graph.joins(xy, edges, 2.0).tolist() == [[1, 2]]


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


def test_distortion_is_weighed_by_area():
    """Ten triangles, each stretched more than the one before; the last one is a fifth of the area."""
    corner = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    size = np.sqrt(np.append(np.full(9, 1.0), 9 / 4))
    before = np.concatenate([s * corner for s in size])
    stretch = np.linspace(1.0, 2.8, 10)
    after = np.concatenate([s * corner * (f, 1.0) for s, f in zip(size, stretch)])
    found = measures.distortion(before, after, np.arange(30).reshape(-1, 3))
    angle = np.degrees(2.0 * np.arcsin((stretch - 1.0) / (stretch + 1.0)))
    assert found.flipped == 0.0 and (found.median, found.high) == pytest.approx((angle[5], angle[9]))
    mirrored = measures.distortion(corner, corner * (-1.0, 1.0), np.array([(0, 1, 2)]))
    assert mirrored == (1.0, 180.0, 180.0)


def test_beyond_the_frame_all_moves_as_its_border_does():
    square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.0, 1.0)])
    fan = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])
    points = np.array([(9.0, 1.0), (-5.0, -7.0), (1.0, 1.9)])
    moved = carrying.Carrier(square, square + (1.0, 2.0), fan)(points)
    assert np.allclose(moved, points + (1.0, 2.0))
    # where no triangle is, nothing moves
    assert carrying.Carrier(square, square + (1.0, 2.0), fan[:2])(points[2:]).tolist() == [[1.0, 1.9]]


def test_the_smallest_part_is_a_share_of_the_land_without_its_holes():
    coords = np.array([(0, 0), (10, 0), (10, 10), (0, 10), (2, 2), (2, 4), (4, 4), (4, 2)], dtype=float)
    assert selection._area(coords, np.array([0, 4, 8]), 0.5) == 48.0


def test_a_rule_knows_the_smallest_part():
    shape = tour(2, 80)
    found = [
        len(selection.rule_of("MinSize", smallest=share)(shape.coords, shape.offsets, 2.0, nothing))
        for share in (0.0, 0.9)
    ]
    assert found[0] > 3 and found[1] == 0
