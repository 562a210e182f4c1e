"""Shared boundaries, faults, and polygons joined without a trace."""

import numpy as np
import pytest
import shapely

import shapely.ops
from isthmus.core import metric
from isthmus.core.aggregation.areas import arrange, posed
from isthmus.core.aggregation.coverage import (
    centroids,
    cover,
    faults,
    joined,
    overlapping,
    shared,
    spreads,
)
from isthmus.core.aggregation.instance import Solution, costs
from isthmus.core.rings import Rings


def rows_of(polygons):
    coords, sizes, owner = [], [], []
    for number, polygon in enumerate(polygons):
        for ring in (polygon.exterior, *polygon.interiors):
            coords.append(np.array(ring.coords)[:-1])
            sizes.append(len(coords[-1]))
            owner.append(number)
    return np.concatenate(coords), np.append(0, np.cumsum(sizes)), np.array(owner)


def covered(*polygons):
    return cover(*rows_of(polygons))


def shape(coverage, polygons):
    xy = coverage.coords
    return shapely.MultiPolygon([(xy[r[0]], [xy[h] for h in r[1:]]) for r in polygons])


def test_lengths_of_a_noded_coverage():
    left, right = shapely.box(0, 0, 2, 2), shapely.box(2, 0, 3, 2)
    pairs, length = shared(covered(left, right), metric.planar())
    assert pairs.tolist() == [[0, 1]]
    assert length.tolist() == [2.0]


@pytest.mark.parametrize("rings", [0, 2])
def test_no_edge_at_all(rings):
    # no polygon, or polygons that are but a point
    found = cover(np.zeros((4 * rings, 2)), 4 * np.arange(rings + 1), np.arange(rings))
    assert not len(found.edge) and not len(shared(found, metric.planar())[0])


def test_t_junctions_without_nodes():
    # a tall box beside three low ones: its long side has none of their corners
    tall = shapely.box(0, 0, 1, 3)
    low = [shapely.box(1, y, 2, y + 1) for y in range(3)]
    pairs, length = shared(covered(tall, *low), metric.planar())
    assert pairs.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]
    assert length.tolist() == [1.0] * 5


def test_edges_that_overlap_in_part_on_both_sides():
    pairs, length = shared(covered(shapely.box(0, 0, 1, 3), shapely.box(1, 1, 2, 5)), metric.planar())
    assert pairs.tolist() == [[0, 1]]
    assert length.tolist() == [2.0]


def test_a_junction_off_the_edge_by_rounding():
    # the corner of the second lies on a slanted edge of the first only up to rounding
    first = shapely.Polygon([(0, 0), (3.3, 1.1), (0, 5)])
    third = np.array([3.3, 1.1]) / 3.0
    second = shapely.Polygon([(0, 0), (0, -3), tuple(third)])
    pairs, length = shared(covered(first, second), metric.planar())
    assert length == pytest.approx([np.hypot(*third)])


def test_corners_apart_by_rounding():
    x = 10 + 0.001 * 3
    other = (10 + 0.001 + 0.001) + 0.001
    assert x != other
    left, right = shapely.box(10, 0, x, 2), shapely.box(other, 0, 11, 2)
    coverage = covered(left, right)
    assert shared(coverage, metric.planar())[1] == pytest.approx([2.0])
    ((ring,),) = joined(coverage, [0, 0])[0]
    assert len(ring) == 6
    ((ring,),) = joined(coverage, [-1, 0])[0]
    assert sorted(map(tuple, coverage.coords[ring])) == [(other, 0), (other, 2), (11, 0), (11, 2)]


def test_a_polygon_keeps_corners_closer_than_the_tolerance():
    x = 1e6
    notch = [(x, 0), (x + 9, 0), (x + 9, 5), (x + 4.0002, 5), (x + 4, 2), (x + 3.9998, 5), (x, 5)]
    spike = [(x, -5), (x + 9, -5), (x + 9, 0), (x + 5, 0), (x + 4.9998, -4), (x + 4.9996, 0), (x, 0)]
    polygons = [shapely.Polygon(notch), shapely.Polygon(spike)]
    coverage = covered(*polygons)
    found = joined(coverage, [0, 1])
    for k, polygon in enumerate(polygons):
        assert shape(coverage, found[k]).equals(polygon)
        assert sum(map(len, found[k][0])) == 7


def test_direction_of_rings_does_not_matter():
    boxes = [shapely.box(0, 0, 1, 1), shapely.box(1, 0, 2, 1), shapely.box(0, 1, 2, 2)]
    turned = [boxes[0], boxes[1].reverse(), boxes[2].reverse()]
    one, other = (shared(covered(*some), metric.planar()) for some in (boxes, turned))
    assert one[0].tolist() == other[0].tolist()
    assert one[1].tolist() == other[1].tolist()


def test_neighbours_only_at_a_corner_are_none():
    pairs, _ = shared(covered(shapely.box(0, 0, 1, 1), shapely.box(1, 1, 2, 2)), metric.planar())
    assert len(pairs) == 0


def test_an_island_in_a_hole():
    ring = shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 2, 2))
    pairs, length = shared(covered(ring, shapely.box(1, 1, 2, 2)), metric.planar())
    assert length.tolist() == [4.0]


def test_a_good_coverage_has_no_faults():
    found = faults(covered(*(shapely.box(x, y, x + 1, y + 1) for x in range(3) for y in range(3))))
    assert len(found.overlaps) == len(found.gaps) == 0


@pytest.mark.parametrize("second", [
    shapely.box(1, 1, 3, 3),  # crosses
    shapely.box(0.5, 0.5, 1, 1),  # inside
    shapely.box(0, 0, 2, 2),  # equal
    shapely.box(-1, -1, 3, 3),  # around
    shapely.box(1, 0, 3, 2),  # shares parts of edges
])  # fmt: skip
def test_overlaps(second):
    found = faults(covered(shapely.box(0, 0, 2, 2), second, shapely.box(9, 9, 10, 10)))
    assert found.overlaps.tolist() == [[0, 1]]


def test_gaps():
    around = [shapely.box(0, 0, 3, 1), shapely.box(0, 1, 1, 3), shapely.box(2, 1, 3, 3),
              shapely.box(1, 2, 2, 3)]  # fmt: skip
    found = faults(covered(*around))
    assert len(found.overlaps) == 0
    assert found.gaps.shape == (1, 2)
    assert shapely.box(1, 1, 2, 2).contains(shapely.Point(found.gaps[0]))


def random_coverage(seed, n=60):
    points = shapely.MultiPoint(np.random.default_rng(seed).random((n, 2)) * 100)
    cells = shapely.get_parts(shapely.voronoi_polygons(points, extend_to=shapely.box(0, 0, 100, 100)))
    return list(cells)


@pytest.mark.parametrize("seed", range(40))
def test_where_areas_overlap_some_pair_is_found_and_all_of_them_do(seed):
    rng = np.random.default_rng(seed)
    kind = seed % 4
    polygons = random_coverage(seed, 25)
    if kind == 1:  # some larger, some smaller
        for k in rng.choice(len(polygons), 3, replace=False).tolist():
            polygons[k] = polygons[k].buffer(rng.uniform(-3, 3), join_style="mitre")
    elif kind == 2:  # another map on it, as large, or larger
        polygons += [shapely.affinity.scale(one, 1 + seed % 3, 1, origin=(0, 0))
                     for one in random_coverage(seed + 1000, 9)]  # fmt: skip
    elif kind == 3:  # one that holds, or is held by, or crosses
        x, y, side = *rng.uniform(-20, 60, 2), rng.uniform(1, 140)
        polygons = [shapely.box(x, y, x + side, y + side), *polygons[: rng.integers(1, 25)]]
    true = {
        (a, b)
        for b, one in enumerate(polygons)
        for a in range(b)
        if polygons[a].intersection(one).area > 1e-6
    }
    coverage = covered(*polygons)
    found = overlapping(coverage, np.array(polygons), np.ones(len(polygons), dtype=bool))
    assert set(map(tuple, found.tolist())) <= true
    assert bool(len(found)) == bool(true)
    if kind == 0:
        assert not true


@pytest.mark.parametrize("seed", range(5))
def test_joined_regions_are_the_unions(seed):
    polygons = random_coverage(seed)
    coverage = covered(*polygons)
    label = np.random.default_rng(seed).integers(-1, 5, len(polygons))
    found = joined(coverage, label)
    for one in range(5):
        group = [polygon for polygon, l in zip(polygons, label) if l == one]
        whole = shapely.union_all(group)
        made = shape(coverage, found[one])
        assert made.is_valid
        assert made.area == pytest.approx(whole.area)
        assert made.symmetric_difference(whole).area < 1e-6
    assert -1 not in found


def test_joined_pieces_leave_no_trace():
    """Cut along a diagonal between vertices, joined again: the very same vertices."""
    coords = np.array([[0, 0, 7], [4, 0, 8], [4, 1, 9], [2, 1.5, 1], [4, 2, 2], [4, 4, 3], [0, 4, 4.0]])
    pieces = [[0, 1, 2, 3], [3, 4, 5, 6], [6, 0, 3]]
    rows = np.concatenate(pieces)
    offsets = np.append(0, np.cumsum([len(p) for p in pieces]))
    coverage = cover(coords[rows], offsets, np.arange(3))
    (rings,) = joined(coverage, np.zeros(3))[0]
    (ring,) = rings
    assert sorted(map(tuple, coverage.coords[ring])) == sorted(map(tuple, coords))


def test_points_of_neighbours_leave_no_trace():
    """A junction on an outer edge is a vertex of the neighbour only."""
    tall, low, lower = shapely.box(0, 0, 1, 3), shapely.box(1, 1, 2, 3), shapely.box(1, 0, 2, 1)
    top = shapely.box(0, 3, 2, 4)
    coverage = covered(tall, low, lower, top)
    ((ring,),) = joined(coverage, [0, -1, -1, -1])[0]
    assert sorted(map(tuple, coverage.coords[ring])) == [(0, 0), (0, 3), (1, 0), (1, 3)]
    ((ring,),) = joined(coverage, [0, 0, 1, 1])[0]
    assert sorted(map(tuple, coverage.coords[ring])) == [(0, 0), (0, 3), (1, 0), (1, 1), (1, 3),
                                                         (2, 1), (2, 3)]  # fmt: skip


def test_a_region_that_touches_itself_at_a_point():
    # a ring of eight boxes without its middle and one beside it: the hole touches the outside
    boxes = [shapely.box(x, y, x + 1, y + 1) for x in range(4) for y in range(3)]
    missing = {(1, 1), (2, 2)}
    kept = [b for b in boxes if (int(b.bounds[0]), int(b.bounds[1])) not in missing]
    coverage = covered(*kept)
    (polygon,) = joined(coverage, np.zeros(len(kept)))[0]
    made = shape(coverage, [polygon])
    assert made.is_valid
    assert made.equals(shapely.union_all(kept))
    assert len(polygon) == 2


def test_an_island_inside_the_hole_of_another_part():
    outer = shapely.box(0, 0, 9, 9).difference(shapely.box(1, 1, 8, 8))
    middle = shapely.box(1, 1, 8, 8).difference(shapely.box(3, 3, 5, 5))
    coverage = covered(outer, middle, shapely.box(3, 3, 5, 5))
    found = joined(coverage, [0, 1, 0])
    assert len(found[0]) == 2
    made = shape(coverage, found[0])
    assert made.is_valid
    assert made.area == outer.area + 4.0


def test_centroids_with_holes():
    ring = shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 2, 3)).reverse()
    far = shapely.affinity.translate(ring, 1e6, 5e6)
    coverage = covered(ring, far)
    area, moment = centroids(coverage, coverage.coords, 2)
    assert area == pytest.approx([14.0, 14.0])
    for k, polygon in enumerate((ring, far)):
        assert moment[k] / area[k] == pytest.approx([polygon.centroid.x, polygon.centroid.y], abs=1e-7)


def spread_of(polygons, owner=None):
    """Spreads of polygons, or of areas of several, each from its own centroid."""
    coverage = covered(*polygons)
    owner = np.arange(len(polygons)) if owner is None else np.array(owner)
    area, moment = centroids(coverage, coverage.coords, len(polygons))
    area = np.bincount(owner, weights=area)
    middle = np.column_stack([np.bincount(owner, weights=one) / area for one in moment.T])
    rows = np.repeat(owner[coverage.ring_polygon], np.diff(coverage.offsets))
    return spreads(coverage, coverage.coords - middle[rows], owner)


def test_spread_of_boxes_by_hand():
    wide, tall = shapely.box(1e6, 5e6, 1e6 + 4, 5e6 + 1), shapely.box(0, 0, 1, 3).reverse()
    assert spread_of([wide, tall]) == pytest.approx([17 / 12, 10 / 12])
    # two boxes of one area: their own spread and the way to the common centroid
    assert spread_of([shapely.box(0, 0, 1, 1), shapely.box(9, 0, 10, 1)], [0, 0]) == pytest.approx(
        [1 / 6 + 4.5**2]
    )
    frame = shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 3, 3))
    assert spread_of([frame]) == pytest.approx([(16 * 32 / 12 - 4 * 8 / 12) / 12])


def test_spread_of_an_area_that_crosses_itself_is_in_it():
    bow = shapely.Polygon([(0, 0), (10, 10), (10, 0), (0, 9.999999)])
    (found,) = spreads(covered(bow), np.array(bow.exterior.coords)[:-1], np.array([0]))
    assert 0.0 <= found <= 200.0


@pytest.mark.parametrize("seed", range(5))
def test_cutting_never_raises_the_distance_to_a_centre(seed):
    rng = np.random.default_rng(seed)
    whole = max(random_coverage(seed, 12), key=lambda cell: cell.area)
    through, turn = np.array(whole.centroid.coords[0]), rng.random(3) * np.pi
    along = 1e3 * np.column_stack((np.cos(turn), np.sin(turn)))
    off = through + rng.random((3, 2))
    lines = shapely.linestrings(np.stack((off - along, off + along), axis=1))
    noded = shapely.union_all([whole.exterior, *shapely.intersection(lines, whole)])
    cells = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    assert len(cells) > 1
    area, centre = shapely.area(cells), [[one.centroid.x, one.centroid.y] for one in cells]
    own, parts = spread_of([whole])[0], spread_of(list(cells))
    middle = np.array([whole.centroid.x, whole.centroid.y])
    for there in rng.random((20, 2)) * 200 - 50:
        away = np.hypot(*(middle - there))
        split = np.sqrt(((np.array(centre) - there) ** 2).sum(axis=1) + parts)
        assert area @ split <= whole.area * np.hypot(away, np.sqrt(own)) * (1 + 1e-12)
        # the mean squares add up exactly
        assert area @ split**2 == pytest.approx(whole.area * (away**2 + own))


@pytest.mark.parametrize("measure", [metric.planar(), metric.ellipsoidal()])
@pytest.mark.parametrize("seed", range(6))
def test_cutting_never_raises_the_cost_of_a_region_with_the_same_centre(seed, measure):
    """From outlines to costs; between centroids it does, or nothing would be tested here."""
    rng = np.random.default_rng(seed)
    # where it is degrees a map of 500 m: an edge is no straight line on the ground
    cells = shapely.transform(random_coverage(seed, 40), lambda xy: 5e-5 * xy + [10.0, 50.0])
    region = _regions_of(cells, 6, rng)
    core = np.array([rng.choice(np.flatnonzero(region == r)) for r in range(6)])

    def costs_of(polygons, owner, points=False):
        coords, offsets, ring_polygon = rows_of(polygons)
        rings = Rings(coords, offsets, np.append(0, np.cumsum(np.bincount(ring_polygon))))
        areas = arrange(range(len(polygons)), rings, np.arange(len(polygons)), measure)
        classes = [str(k % 3) for k in owner.tolist()]
        weights = (1.0, 1e4, 1e-3)
        problem = posed(areas, classes, ["0", "1", "2"], [], np.zeros(3), 1 - np.eye(3), weights, False)
        if points:
            problem = problem._replace(spread=np.zeros(len(polygons)))
        at = np.array([owner.tolist().index(k) for k in core.tolist()])  # cores stay whole: the same centres
        return costs(problem, Solution(region[owner], at))

    parts, owner = [], []
    for k, cell in enumerate(cells):
        own = [cell]
        if k not in core:
            x, y = cell.centroid.coords[0]
            line = shapely.LineString([(x - 9, y - 9 * np.tan(seed)), (x + 9, y + 9 * np.tan(seed))])
            own = list(shapely.ops.split(cell, line).geoms)
        parts += own
        owner += [k] * len(own)
    before = costs_of(cells, np.arange(len(cells)))
    after = costs_of(parts, np.array(owner))
    assert len(parts) > len(cells) + 20
    assert after.change == pytest.approx(before.change, rel=1e-5)
    assert after.boundary == pytest.approx(before.boundary, rel=1e-5)
    assert before.centre * (1 - 0.1) < after.centre < before.centre
    points = costs_of(parts, np.array(owner), True).centre / costs_of(cells, np.arange(40), True).centre
    assert points > 1.0


def _regions_of(cells, count, rng):
    """A region for each cell: that of the nearest of some of them."""
    places = np.array([cell.centroid.coords[0] for cell in cells])
    seeds = places[rng.choice(len(cells), count, replace=False)]
    return np.hypot(*(places[:, None] - seeds).T).T.argmin(axis=1)


def test_nothing():
    coverage = cover(np.zeros((0, 2)), np.array([0]), np.zeros(0, dtype=int))
    assert joined(coverage, np.zeros(0)) == {}
    assert len(shared(coverage, metric.planar())[0]) == 0
