"""New vertices at the feet of perpendiculars, and the places that lack one."""

import numpy as np
import pytest
import shapely

from isthmus.core import metric
from isthmus.core.partition import candidates
from isthmus.core.partition import solve as road
from isthmus.core.partition.feet import along_edges, places, with_feet
from isthmus.core.partition.min_size import SELF
from isthmus.core.partition.polygon import from_rings, without_rings
from isthmus.core.partition.triangulation import sides_of, triangulate
from isthmus.core.rings import one_polygon

from .. import checker, shapes, stages
from ..brute_force import fewest_cuts
from ..shapes import Shape, shape
from ..verify import check_dilations, check_no_cut_needless, check_parts, solve

# the smallest neck without a vertex opposite: 1 wide
NECK = shape([(0, 0), (20, 0), (20, 10), (11, 10), (10, 1), (9, 10), (0, 10)])
EVERY = np.zeros(1, dtype=bool)


def made():
    """Shapes of all kinds, with Z and M that tell the place of a point."""
    found = [shapes.tour(seed, 8 + seed) for seed in range(8)]
    found += [shapes.mosaic(seed, 14 + 3 * seed, 0.6, 10**6) for seed in range(8)]
    found += [shapes.mosaic(seed, 25, 0.7, 9) for seed in range(5)]  # a lattice: rings touch
    found += [shapes.polyomino(seed, 6, 5) for seed in range(5)]
    found += [NECK, shapes.comb(6), shapes.spiral(2, 8), teeth(5)]
    return [s.mapped(with_plane) for s in found]


def with_plane(xy):
    """A height that is linear in the plane: what is interpolated along an edge lies on it too."""
    return np.column_stack((xy[:, :2], xy[:, 0] + 2 * xy[:, 1] + 7, 3 * xy[:, 0] - xy[:, 1]))


def teeth(count):
    """A hall with teeth that hang from the ceiling before a bare wall, all as long."""
    ceiling = []
    for k in range(count):
        ceiling += [(10 * k + 4, 10), (10 * k + 5, 1), (10 * k + 6, 10)]
    return shape([(0, 0), (10 * count, 0), (10 * count, 10), *ceiling[::-1], (0, 10)])


def extended(result, s):
    """The shape with the new vertices that cuts use, by geometry alone; and the result in its rows."""
    cuts = result.edge_rows[result.role == SELF]
    old = len(s.coords)
    used = np.unique(cuts[cuts >= old])
    rows = np.concatenate((s.coords, result.new_rows))
    number = np.full(len(rows), -1)
    coords, sizes = [], []
    for lo, hi in zip(s.offsets[:-1].tolist(), s.offsets[1:].tolist()):
        start = len(coords)
        for k in range(lo, hi):
            number[k] = len(coords)
            coords.append(s.coords[k])
            a, b = s.coords[k, :2], s.coords[k + 1 if k + 1 < hi else lo, :2]
            near = shapely.distance(shapely.LineString([a, b]), shapely.points(rows[used, :2]))
            on = used[near <= 1e-12 * np.abs(s.coords[:, :2]).max()]
            for row in on[np.argsort(np.hypot(*(rows[on, :2] - a).T))].tolist():
                if number[row] < 0:
                    number[row] = len(coords)
                    coords.append(rows[row])
        sizes.append(len(coords) - start)
    assert (number[used] >= 0).all(), "a new vertex is on no edge"
    parts = result.parts._replace(rows=number[result.parts.rows])
    told = result._replace(parts=parts, edge_rows=number[result.edge_rows])
    return told, Shape(np.array(coords), np.append(0, np.cumsum(sizes)))


POOL = made()
every = pytest.mark.parametrize("k", range(len(POOL)))


@pytest.mark.parametrize("natural", [False, True])
def test_the_smallest_neck(natural):
    options = dict(natural=natural, smallest=1.0 * natural)
    missed = solve(NECK, 4.0, **options)
    assert len(missed.parts.area) == 1 and not len(missed.new_rows)
    found = solve(NECK, 4.0, new_vertices=True, **options)
    assert found.edge_rows[found.role == SELF].tolist() == [[7, 4]]
    assert found.new_rows.tolist() == [[10.0, 0.0]]
    assert found.parts.area.tolist() == [95.5, 95.5]
    assert [list(map(len, rings)) for rings in found.parts.rings] == [[5], [5]]


@every
def test_everything_holds_and_only_what_is_used_is_new(k):
    """Parts, dilations and needless cuts; the outline has no vertex more than cuts need."""
    s = POOL[k]
    size = shapely.area(s.polygon)
    for tau in (1.2, 3.0):
        for options in ({}, {"natural": True, "smallest": 0.02 * size}, {"min_length": 0.02 * size**0.5}):
            result = solve(s, tau, new_vertices=True, all_dilations=True, **options)
            told, more = extended(result, s)
            check_parts(told, more)  # that no vertex is lost, or there which no cut uses, is part of it
            if "smallest" not in options:
                check_dilations(result, tau, options.get("min_length", 0.0))
                check_no_cut_needless(result, tau, options.get("min_length", 0.0))
            assert np.allclose(more.coords, with_plane(more.coords), rtol=1e-12, atol=1e-12 * 1e6)


def test_the_pool_has_new_vertices():
    taken, touching = 0, 0
    for s in POOL:
        result = solve(s, 2.0, new_vertices=True)
        cuts = result.edge_rows[result.role == SELF]
        taken += (cuts >= len(s.coords)).any()
        touching += len(result.polygons.vertex) > len(result.polygons.xy) and len(result.new_rows) > 0
    assert taken >= 10 and touching >= 2, (taken, touching)


@pytest.mark.parametrize("seed", range(25))
def test_as_few_as_brute_force(seed):
    s = shapes.tour(seed, 4 + seed % 6)
    for tau in (1.0, 1.5, 2.0, 4.0):
        result = solve(s, tau, new_vertices=True)
        if len(result.edges) <= 12:
            walk = result.polygons.vertex
            place = np.argsort(walk)
            fewest = fewest_cuts(result.polygons.xy[walk], place[result.edges], [tau])
            assert [int((result.role == SELF).sum())] == fewest


@every
def test_feet_are_feet(k):
    """Each is the nearest point of an edge to a concave vertex that sees it; and none is left to be found."""
    s = POOL[k]
    rings = one_polygon(s.coords, s.offsets)
    polygons, _ = from_rings(rings)
    more, coords, (known, _) = with_feet(
        polygons, rings, np.zeros(len(polygons.offsets) - 1, dtype=bool), np.zeros(1), measure=metric.planar()
    )
    corner = np.flatnonzero(more.rows[more.row_start[:-1]] >= len(s.coords))
    assert len(corner) == len(coords)
    real = ~polygons.inserted
    after, xy = polygons.next_corner, polygons.xy[polygons.vertex]
    room = s.polygon.buffer(1e-9 * np.abs(xy).max())
    shapely.prepare(room)
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    (ax, ay), (bx, by) = (xy - xy[before]).T, (xy[after] - xy).T
    turn = ax * by - ay * bx
    concave = xy[(turn < 0) & real]
    for foot in more.xy[more.vertex[corner]]:
        lines = shapely.linestrings(np.stack((xy, xy[after]), axis=1))
        (edge,) = [np.argmin(shapely.distance(lines, shapely.Point(foot)))]
        way = xy[after[edge]] - xy[edge]
        to = concave - foot
        upright = np.abs(to @ way) <= 1e-9 * np.hypot(*way) * np.hypot(*to.T)
        sees = shapely.covers(room, shapely.linestrings([[v, foot] for v in concave]))
        assert (upright & sees).any()
    triangles, *_ = triangulate(more)
    assert np.array_equal(known, triangles)
    assert not len(places(more, sides_of(more, triangles), more.xy, metric.planar()).edge)


def test_the_triangulation_of_the_last_rounds_is_that_of_the_result():
    """Of many polygons, of which some need more rounds than others, and without the small holes."""
    rings = stages.together([(s.coords, s.offsets) for s in POOL])
    polygons, _ = from_rings(rings)
    alone = np.bincount(polygons.vertex)[polygons.vertex] == 1
    whole = np.bincount(polygons.ring_of_corner, weights=~alone) == 0
    free = whole & (np.arange(len(whole)) % 2 == 1)
    free[polygons.polygon_offsets[:-1]] = False
    assert free.any()
    more, coords, (known, problem) = with_feet(
        polygons, rings, free, np.zeros(len(polygons.unit)), measure=metric.planar()
    )
    assert len(coords)
    triangles, verdict, _ = triangulate(without_rings(more, free)[0])
    assert np.array_equal(known, triangles) and (problem == verdict).all()


@pytest.mark.parametrize("count", [1, 2, 9, 40])
def test_every_tooth_before_a_bare_wall(count):
    """Only one of them is in a triangle with the wall; the others show when it has been split."""
    s = teeth(count)
    result = solve(s, 3.0, new_vertices=True)
    assert np.allclose(np.sort(result.new_rows[:, 0]), 10.0 * np.arange(count) + 5, rtol=1e-15)
    assert (result.new_rows[:, 1] == 0.0).all()
    cuts = result.edge_rows[result.role == SELF]
    assert sum((cuts >= len(s.coords)).any(axis=1)) == count == len(cuts)
    missed = solve(s, 3.0)
    assert (missed.length[missed.role == SELF] > 5.0).all()  # at best from wall to wall


def test_outlines_with_vertices_enough_get_none():
    """A round basin, a corridor with a vertex opposite each vertex, and a convex polygon."""
    corridor = shape(
        [(0, 0), (9, 0), (9, 4), (13, 4), (13, 0), (22, 0), (22, 9), (13, 9), (13, 5), (9, 5), (9, 9), (0, 9)]
    )
    for s in (shape(shapes.circle(50, 10.0)), corridor):
        assert not len(solve(s, 2.0, new_vertices=True).new_rows)


def test_a_wall_with_points_on_it_is_not_concave():
    """Whatever rounding makes of them."""
    x = np.linspace(0.0, 90.0, 31)
    turned = np.column_stack((x * np.cos(0.3), x * np.sin(0.3)))
    over = turned[[-1, 0]] + [-3 * np.sin(0.3), 3 * np.cos(0.3)]
    assert not len(solve(shape(np.concatenate((turned, over))), 2.0, new_vertices=True).new_rows)


def test_it_does_not_matter_where_rings_start():
    for s in POOL[5:20]:
        one = solve(s, 2.0, new_vertices=True)
        other = solve(shapes.reversed_rings(shapes.restarted(s, 2)), 2.0, new_vertices=True)
        assert np.array_equal(one.polygons.xy, other.polygons.xy)
        assert np.array_equal(one.edges[one.role == SELF], other.edges[other.role == SELF])


def test_on_the_ellipsoid():
    """A foot is upright in metres, not in degrees."""
    slanted = NECK.mapped(lambda xy: np.column_stack((0.01 * (xy[:, 0] + xy[:, 1]), 65 + 0.01 * xy[:, 1])))
    result = solve(slanted, 4.0, new_vertices=True, measure=metric.ellipsoidal())
    foot, tip = result.new_rows[0], slanted.coords[4]
    assert result.edge_rows[result.role == SELF].tolist() == [[7, 4]]
    assert foot[1] == 65.0
    assert abs(foot[0] - tip[0]) < 1e-5  # north of each other, but for the curve of the parallel


def test_several_polygons_and_lines():
    """Bad ones are left out, feet go to their own polygons, and lines given are all there is."""
    rings = stages.together([NECK, shape([(0, 0), (1, 1), (1, 0), (0, 1)]), teeth(3), NECK])
    prepared = road.prepare(rings, new_vertices=True)
    assert [bool(text) for text in prepared.verdict] == [False, True, False, False]
    result = road.finish(prepared, road.select(prepared, 3.0))
    assert np.diff(result.parts.part_offsets).tolist() == [2, 4, 2]
    together = result.new_rows[np.unique(result.edge_rows[result.role == SELF])[-5:] - len(rings.coords)]
    alone = [solve(s, 3.0, new_vertices=True).new_rows for s in (NECK, teeth(3))]
    assert set(map(tuple, together)) == set(map(tuple, np.concatenate(alone)))
    lines = [np.array([[[10, 1], [0, 0]]])] * 4
    assert not len(road.prepare(rings, lines=lines, new_vertices=True).new_rows)


def test_small_holes_do_not_count():
    """No foot on an islet that does not count; one behind it all the same, and the cut beside it."""
    islet = [(4.0, 5.0), (4.1, 5.0), (4.1, 5.1), (4.0, 5.1)]
    s = Shape(np.concatenate((NECK.coords, islet)), np.array([0, 7, 11]))
    result = solve(s, 4.0, new_vertices=True, min_hole=1.0)
    assert result.new_rows.tolist() == [[10.0, 0.0]]
    assert len(result.parts.area) == 2 and sum(map(len, result.parts.rings)) == 3


def test_a_foot_beside_a_touching_hole():
    """The hole's tip is a corner of the wall, which no part shows where no cut ends."""
    s = shape([(0, 0), (20, 0), (20, 10), (11, 10), (10, 1), (9, 10), (0, 10)], [(15, 0), (16, 3), (14, 3)])
    for tau in (2.0, 4.0, 9.0):
        result = solve(s.mapped(with_plane), tau, new_vertices=True)
        told, more = extended(result, s.mapped(with_plane))
        check_parts(told, more)
        assert (10.0, 0.0) in set(map(tuple, more.coords[:, :2]))


def test_edges_along_an_edge():
    rings = one_polygon(NECK.coords, NECK.offsets)
    polygons, _, _ = with_feet(from_rings(rings)[0], rings, EVERY, np.zeros(1), measure=metric.planar())
    pairs = np.array([(u, v) for u in range(8) for v in range(8) if u != v])
    along = {frozenset(pair) for pair in pairs[along_edges(polygons, pairs)].tolist()}
    neighbours = {frozenset((k, (k + 1) % 8)) for k in range(8)}
    assert along == neighbours | {frozenset((0, 2))}  # vertex 1 is the foot


# ---------------------------------------------------------------- how many are missing


@every
def test_how_many_places_lack_a_vertex(k):
    """Against shortest paths in P and S with the foot on its edge."""
    s = POOL[k]
    for tau in (1.2, 2.0):
        prepared = road.prepare(one_polygon(s.coords, s.offsets))
        selection = road.select(prepared, tau)
        (told,) = road.without_vertex(prepared, selection, np.array([tau]))
        polygons, cuts = prepared.polygons, prepared.edges[selection.selected]
        after, foot, count = polygons.vertex[polygons.next_corner], len(polygons.xy), 0
        for apex, edge, share, length in zip(*prepared.places):
            a, b = polygons.xy[polygons.vertex[edge]], polygons.xy[after[edge]]
            xy = np.vstack((polygons.xy, a + share * (b - a)))
            assert length == pytest.approx(np.hypot(*(xy[apex] - xy[foot])))
            ring = [
                [polygons.vertex[c], foot] if c == edge else [polygons.vertex[c]]
                for c in range(len(polygons.vertex))
            ]
            ring = [sum(ring[lo:hi], []) for lo, hi in zip(polygons.offsets[:-1], polygons.offsets[1:])]
            count += checker.dilations(xy, ring, cuts, [(apex, foot)])[0] > tau * (1 + 1e-9)
        assert told == count if len(s.offsets) == 2 else told >= count


def test_natural_places_only():
    """A place that would cut off too little is none, nor is one with a line that is too short."""
    smallest = 1.0
    for s in (NECK, teeth(3)):  # an edge counts once, however many teeth are before it
        for share, count in ((0.0, 1), (0.6, 0)):
            prepared = road.prepare(
                one_polygon(s.coords, s.offsets),
                natural=True,
                smallest=max(smallest, share * s.polygon.area),
            )
            selection = road.select(prepared, 3.0)
            assert road.without_vertex(prepared, selection, np.array([3.0])).tolist() == [count]
    for floor, count in ((0.9, 1), (1.1, 0)):  # the neck is 1 wide
        prepared = road.prepare(one_polygon(NECK.coords, NECK.offsets), min_length=floor)
        assert road.without_vertex(prepared, road.select(prepared, 3.0), np.array([3.0])) == [count]


def test_none_is_missing_with_new_vertices():
    prepared = road.prepare(one_polygon(NECK.coords, NECK.offsets), new_vertices=True)
    assert road.without_vertex(prepared, road.select(prepared, 3.0), np.array([3.0])).tolist() == [0]


def test_places_of_a_chunk_with_bad_polygons():
    rings = stages.together([shape([(0, 0), (1, 1), (1, 0), (0, 1)]), NECK, teeth(3)])
    prepared = road.prepare(rings)
    assert road.without_vertex(prepared, road.select(prepared, 3.0), np.full(2, 3.0)).tolist() == [1, 1]


def test_places_are_not_looked_for_once_vertices_are_there(monkeypatch):
    """Nobody reads them then; they used to be computed and thrown away."""
    ring = one_polygon(NECK.coords, NECK.offsets)
    assert len(road.prepare(ring).places.edge) == 1
    monkeypatch.setattr(candidates, "places", None)
    found = road.prepare(ring, new_vertices=True)
    assert found.places is None and len(found.new_rows) == 1
