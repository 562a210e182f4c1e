"""The solver, the triangulation and its hierarchy, the measures, the rules for relevant edges."""

import itertools
import sys

import numpy as np
import pytest
import shapely

pytest.importorskip("scipy")

from isthmus.tests.core.checker import dilations
from isthmus.core.errors import MissingEngine
from isthmus.core.focus import deformation, graph, hierarchy, measures, mesh, selection

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
    shift, _ = deformation.relax(
        xy, triangles, edges, group, origin, 1.3, fixed, nothing, guard=1e-12
    )

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
    pytest.importorskip(engine)
    for other in {"triangle", "pythoncdt"} - {engine}:
        monkeypatch.setitem(sys.modules, other, None)
    rng = np.random.default_rng(seed)
    corners = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    edges = np.concatenate((
        graph.unique_pairs(rng.integers(4, 44, (20, 2)), 44), [(0, 1), (1, 2), (2, 3), (0, 3)]))
    noded = mesh.node(np.concatenate((corners, rng.uniform(0.1, 0.9, (40, 2)))), edges, nothing)
    triangles = mesh.frame_triangles(noded.xy, noded.edges)
    assert len(triangles) == 2 * len(noded.xy) - 2 - 4 and (mesh.heights(noded.xy, triangles) > 0.0).all()
    pairs = graph.unique_pairs(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), len(noded.xy))
    assert {tuple(e) for e in noded.edges.tolist()} <= {tuple(e) for e in pairs.tolist()}


def test_without_an_engine(monkeypatch):
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


def test_a_line_across_a_square_leaves_no_choice():
    xy = np.array([(x, y) for x in range(3) for y in range(3)], dtype=float) / 2.0
    rim = [(0, 1), (1, 2), (2, 5), (5, 8), (7, 8), (6, 7), (3, 6), (0, 3)]
    line = np.array([(0, 4)] + rim)
    triangles = mesh.frame_triangles(xy, line)
    squares = {frozenset((k, k + 1, k + 3, k + 4)) for k in (0, 1, 3, 4)}
    found = mesh.others(xy, triangles, line)
    assert len(found) == 12 and all(
        sum(set(one) < square for square in squares) == 1 for one in found.tolist())
    assert not any(set(one) < {0, 1, 3, 4} for one in found.tolist())
    assert len(mesh.others(xy + np.arange(18).reshape(9, 2) ** 2 * 1e-6, triangles, line)) == 0


def test_stiff_triangles_bend_less():
    xy, triangles, edges, fixed = frame(2)
    group = np.where(np.hypot(*(xy - 0.45).T) < 0.18, 0, -1)
    origin = xy[group == 0].mean(axis=0)[None]
    right = xy[triangles].mean(axis=1)[:, 0] > 0.6
    bent = []
    for side in (right, ~right):
        shift, _ = deformation.relax(xy, triangles, edges[:0], group, origin, 1.8, fixed, nothing,
                                     stiff=np.where(side, 100.0, 1.0))
        bent.append(measures.distortion(xy, xy + shift, triangles[right]).median)
    assert bent[0] < 0.5 * bent[1]


def coarse_of(seed, n=800):
    rng = np.random.default_rng(seed)
    xy = np.concatenate((rng.random((n, 2)), [(-0.1, -0.1), (1.1, -0.1), (1.1, 1.1), (-0.1, 1.1)]))
    triangles = mesh.frame_triangles(xy, np.empty((0, 2), dtype=int))
    ring = np.argsort(np.arctan2(*(xy[:n] - 0.5).T))[: n // 2]
    edges = graph.unique_pairs(np.column_stack((ring[:-1], ring[1:])), len(xy))
    edges = edges[np.isin(edges @ (len(xy), 1), graph.unique_pairs(
        triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), len(xy)) @ (len(xy), 1))]
    removable = np.arange(len(xy)) < n
    found = hierarchy.coarsen(xy, triangles, edges, removable, np.zeros(len(xy), bool), 60, nothing)
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


def test_what_is_put_back_is_carried_by_an_affine_map():
    xy, triangles, found = coarse_of(1)
    shift = xy @ np.array([(0.5, 0.2), (-0.1, 0.3)])
    known = hierarchy.reinsert(found, xy, np.where(
        np.isin(np.arange(len(xy)), found.triangles)[:, None], shift, 0.0),
        np.zeros(len(xy), bool), nothing)
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
