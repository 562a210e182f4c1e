"""Cuts that lead over islands too small to count: which there are, what they cost, and the parts beside them."""

import numpy as np
import pytest
import shapely

from .. import shapes, stages
from isthmus.core.partition import gates as stage
from isthmus.core.partition import natural as natural_stage
from isthmus.core.partition.hierarchy import hierarchy
from isthmus.core.partition.min_size import SELF
from isthmus.core.partition.parts import build_parts, merged_parts
from isthmus.core.partition.polygon import from_rings
from isthmus.core.partition.solve import finish, prepare, select
from isthmus.core.rings import one_polygon

SMALLEST = 0.06  # of the polygon: larger than any island here


def archipelago(seed, rows=2):
    """A sea with tongues of land from both sides, and rows of islands between them."""
    rng = np.random.default_rng(seed)
    sea, land = shapely.box(0, 0, 120, 30 * rows), []
    for y in 30 * np.arange(1, rows):
        west, east = rng.uniform(15, 40), rng.uniform(80, 105)
        for x, tip in ((0, west), (120, east)):
            land.append(shapely.Polygon([(x, y - 3), (tip, y + rng.uniform(-2, 2)), (x, y + 3)]))
        x = west
        while True:
            begin = x + rng.uniform(0.5, 6)
            x = begin + rng.uniform(4, 16)
            if x > east - 0.5:
                break
            land.append(island(rng, begin, x, y + rng.uniform(-2, 2)))
    for _ in range(6):
        x, y = rng.uniform(5, 110), rng.uniform(5, 30 * rows - 5)
        land.append(island(rng, x, x + rng.uniform(1, 4), y))
    water = max(shapely.get_parts(sea - shapely.union_all(land)), key=shapely.area)
    return shapes.from_shapely(
        shapely.orient_polygons(water) if hasattr(shapely, "orient_polygons") else water
    )


def island(rng, begin, end, y):
    angle = np.sort(rng.uniform(0, 2 * np.pi, 7))
    angle = np.concatenate(([0.0, np.pi], angle))
    x, high = (begin + end) / 2, min((end - begin) / 2, 2.5)
    xy = np.column_stack((x + (end - begin) / 2 * np.cos(angle), y + high * np.sin(angle)))
    return shapely.Polygon(xy[np.argsort(angle)])


def prepared(shape, smallest=SMALLEST, **options):
    return prepare(one_polygon(*shape), natural=True, smallest=smallest * shape.polygon.area, **options)


def ways(found, which=None):
    """The points of the ways of edges that are gates."""
    own = np.flatnonzero(found.gate >= 0) if found.gate is not None else np.empty(0, int)
    xy, gates = found.polygons.xy * found.polygons.unit[0], found.gates
    return {
        k: xy[gates.vertex[gates.offsets[found.gate[k]] : gates.offsets[found.gate[k] + 1]]]
        for k in (own if which is None else np.intersect1d(own, which)).tolist()
    }


SEAS = [archipelago(seed, 2 + seed % 3) for seed in range(16)]
WITH_GATES = [shape for shape in SEAS if prepared(shape).gate is not None]


def test_there_are_gates_to_test_with():
    assert len(WITH_GATES) >= 12
    assert max(len(way) for shape in WITH_GATES for way in ways(prepared(shape)).values()) >= 8


def bay(island, mouth=10.0):
    """A bay of 20 by 20 above a sea, with an island in its mouth."""
    sea = [(-20, 0), (30, 0), (30, 20), (mouth, 20), (20, 40), (-10, 40), (0, 20), (-20, 20)]
    return shapes.shape(sea, island) if island else shapes.shape(sea)


LENS = [(1, 20), (5, 20.5), (9, 20), (5, 19.5)]


def test_an_island_in_the_mouth_of_a_bay_closes_it():
    shape = bay(LENS)
    found = prepared(shape)
    selection = select(found, 3.0)
    assert found.chord[selection.selected].tolist() == pytest.approx([2.0])  # its water
    rows, offsets = found.way_rows(selection.selected)
    assert shape.coords[rows].tolist() == [[10, 20], [9, 20], [1, 20], [0, 20]] or shape.coords[rows][
        ::-1
    ].tolist() == [[10, 20], [9, 20], [1, 20], [0, 20]]
    assert offsets.tolist() == [0, 4]
    parts = finish(found, selection).parts
    # one outline each, with one side of the island
    assert len(parts.area) == 2 and len(parts.offsets) == 3
    assert sorted(map(len, parts.rings[0] + parts.rings[1])) == [4 + 3, 4 + 3 + 2]


@pytest.mark.parametrize(
    "island",
    [
        [(3.1, 20), (5, 20.5), (7, 20), (5, 19.5)],  # less than half of the mouth
        [(1, 32), (5, 32.5), (9, 32), (5, 31.5)],  # not in the mouth
        [(4.99, 20), (5, 20.01), (5.01, 20), (5, 19.99)],  # a rock
    ],
)
def test_other_islands_close_nothing(island):
    found = prepared(bay(island))
    assert found.gate is None and found.polygons.polygon_offsets.tolist() == [0, 2]


def test_the_user_may_not_want_to_see_the_island():
    assert prepared(bay(LENS), min_hole=5.0).gate is None  # it has 4
    assert prepared(bay(LENS), min_hole=3.0).gate is not None
    assert prepared(bay(LENS), over_islands=False).gate is None


def test_no_way_touches_an_island_at_one_vertex_only():
    # between two long islands one that reaches their row with its tip
    land = [LENS, [(10, 20), (8.8, 18.5), (11.2, 18.5)], [(x + 10, y) for x, y in LENS]]
    shape = shapes.shape(*bay(None, mouth=20.0).rings, *land)
    found = prepared(shape)
    assert found.gate is None
    assert set(finish(found, select(found, 1.0)).parts.rows.tolist()) == set(range(len(shape.coords)))
    without = prepared(shapes.shape(*bay(None, mouth=20.0).rings, land[0], land[2]))
    assert len(ways(without)) == 1


def test_long_rows_are_left_alone(monkeypatch):
    shape = WITH_GATES[0]
    longest = max(len(way) // 2 - 1 for way in ways(prepared(shape)).values())
    monkeypatch.setattr(stage, "MOST", longest)
    assert max(len(way) // 2 - 1 for way in ways(prepared(shape)).values()) == longest
    monkeypatch.setattr(stage, "MOST", longest - 1)
    assert all(len(way) // 2 - 1 < longest for way in ways(prepared(shape)).values())


@pytest.mark.parametrize("shape", SEAS)
def test_gates_change_nothing_for_diagonals(shape):
    with_them, without = prepared(shape), prepared(shape, over_islands=False)
    straight = np.ones(len(with_them.edges), dtype=bool) if with_them.gate is None else with_them.gate < 0
    for name in ("edges", "chord", "share", "bounded"):
        assert np.array_equal(
            getattr(with_them, name)[straight], getattr(without, name), equal_nan=name == "share"
        )
    assert (with_them.edge_length == without.edge_length)[np.isfinite(without.edge_length)].all()


@pytest.mark.parametrize("shape", WITH_GATES)
def test_rules_of_gates_from_scratch(shape):
    found = prepared(shape)
    xy, water = shape.polygon, found.polygons.xy
    rings = [np.array(ring.coords) for ring in xy.interiors]
    large = [shapely.Polygon(ring).area >= SMALLEST * xy.area for ring in rings]
    seen = []
    for k, way in ways(found).items():
        links = way.reshape(-1, 2, 2)
        gaps = np.linalg.norm(links[:, 0] - links[:, 1], axis=1)
        whole = np.linalg.norm(np.diff(way, axis=0), axis=1).sum()
        assert found.chord[k] == pytest.approx(gaps.sum())
        assert gaps.sum() <= (1 - stage.SUPPORT) * whole * (1 + 1e-9)
        assert whole <= stage.BULGE * np.linalg.norm(way[0] - way[-1]) * (1 + 1e-9)
        assert (way[[0, -1]] == water[found.edges[k]]).all()
        # each stretch lies in the water and touches land at its ends only
        lines = shapely.linestrings(links)
        assert shapely.relate_pattern(lines, xy, "1FFF0F212").all() or shapely.covers(xy, lines).all()
        # both ends of each stretch across an island are on one that does not count, on a way of its own
        for land, leave in way[1:-1].reshape(-1, 2, 2).tolist():
            own = [n for n, ring in enumerate(rings) if land in ring.tolist() and leave in ring.tolist()]
            assert len(own) == 1 and not large[own[0]] and own[0] not in seen
            seen += own
        # a part that counts on both sides, holes included: of the sea, whose shell has the ends here
        shell = shapely.Polygon(xy.exterior)
        if not any(large):
            halves = shapely.get_parts(
                shapely.polygonize([shapely.union(shell.exterior, shapely.linestrings(way))])
            )
            area = sorted(shapely.area(halves))
            assert len(area) == 2 and area[0] >= SMALLEST * xy.area
            assert found.share[k] == pytest.approx(area[0] / shell.area)
    diagonals = found.edges[(found.gate < 0) & found.bounded]
    if len(diagonals):
        stretches = np.concatenate([way.reshape(-1, 2, 2) for way in ways(found).values()])
        cross = shapely.crosses(
            shapely.linestrings(water[diagonals])[:, None], shapely.linestrings(stretches)
        )
        assert not cross.any()


@pytest.mark.parametrize("shape", WITH_GATES)
@pytest.mark.parametrize("tau", [1.0, 2.0, 5.0])
def test_parts_tile_and_islands_stay(shape, tau):
    found = prepared(shape)
    result = finish(found, select(found, tau))
    parts = [
        shapely.Polygon(shape.coords[rings[0]], [shape.coords[ring] for ring in rings[1:]])
        for rings in result.parts.rings
    ]
    assert shapely.is_valid(parts).all()
    assert np.allclose(shapely.area(parts), result.parts.area)
    assert shapely.symmetric_difference(shapely.union_all(parts), shape.polygon).area < 1e-9
    assert sum(shapely.area(parts)) == pytest.approx(shape.polygon.area)
    cut = np.flatnonzero(result.role == SELF)
    for k, sides in zip(cut.tolist(), result.parts.sides.tolist()):
        if found.gate[k] >= 0:
            line = shapely.linestrings(ways(found)[k].reshape(-1, 2, 2))
            assert sides[0] != sides[1]
            for side in sides:  # each stretch is an edge of both
                assert shapely.covers(shapely.boundary(parts[side]), line).all()


@pytest.mark.parametrize("shape", WITH_GATES)
def test_fewest_cuts_against_all_subsets(shape):
    found = prepared(shape)
    k, polygon = len(found.edges), found.polygons
    assert len(polygon.polygon_offsets) == 2 and not found.wanted[found.component][1:].any()
    if k > 10:
        pytest.skip("too many candidates to try all subsets")
    size = np.diff(polygon.offsets)[0]
    along = np.append(0.0, np.cumsum(found.edge_length[:size]))
    nodes = np.unique(found.edges)  # all on the shell
    place = np.searchsorted(nodes, found.edges)
    way = np.abs(along[nodes][:, None] - along[nodes])
    way = np.minimum(way, along[-1] - way)
    for tau in (1.0, 1.5, 3.0):
        best = k
        for subset in range(2**k):
            chosen = [c for c in range(k) if subset >> c & 1]
            d = way.copy()
            for c in chosen:
                a, b = place[c]
                d[a, b] = d[b, a] = min(d[a, b], found.length[c])
            for via in range(len(nodes)):
                d = np.minimum(d, d[:, via, None] + d[None, via])
            if (d[place[:, 0], place[:, 1]] <= tau * found.length * (1 + 1e-12)).all():
                best = min(best, len(chosen))
        assert len(select(found, tau).selected) == best


@pytest.mark.parametrize("shape", WITH_GATES[:12])
def test_turned_and_mirrored(shape):
    def told(xy):
        return {frozenset(map(tuple, np.round(way, 6).tolist())) for way in ways(prepared(xy)).values()}

    mine = told(shape)
    for matrix in ([[-1, 0], [0, 1]], [[0, -1], [1, 0]], [[-1, 0], [0, -1]]):
        matrix = np.array(matrix, dtype=float)
        other = told(shape.mapped(lambda xy, matrix=matrix: xy @ matrix))
        assert {frozenset(tuple(np.round(np.array(p) @ matrix.T, 6)) for p in way) for way in other} == mine


@pytest.mark.parametrize("shape", WITH_GATES[:12])
def test_how_the_rings_are_told_does_not_matter(shape):
    mine = prepared(shape)
    for other in (
        shapes.restarted(shape, 3),
        shapes.reversed_rings(shape),
        shapes.reordered_holes(shape, 1),
    ):
        theirs = prepared(other)
        assert {k: way.tolist() for k, way in ways(theirs).items()} == {
            k: way.tolist() for k, way in ways(mine).items()
        }
        assert (select(theirs, 2.0).selected == select(mine, 2.0).selected).all()


def test_together_as_alone():
    several = [*WITH_GATES[:4], shapes.shape(shapes.HALLS), *SEAS[:4]]
    area = np.array([shape.polygon.area for shape in several])
    together = prepare(stages.together(several), natural=True, smallest=SMALLEST * area)
    mine = together.polygons.xy
    found = [mine[together.gates.vertex[lo:hi]] for lo, hi in spans(together)]
    alone = [way for shape in several for way in ways(prepared(shape)).values()]
    assert sorted(way.tolist() for way in found) == sorted(way.tolist() for way in alone)


def spans(found):
    own = found.gate[found.gate >= 0]
    return zip(found.gates.offsets[own].tolist(), found.gates.offsets[own + 1].tolist())


@pytest.mark.parametrize("shape", WITH_GATES)
def test_unions_of_parts_have_their_islands(shape):
    found = prepared(shape)
    selection = select(found, 1.0)
    nested = hierarchy(found, selection)
    walk, tree = selection.carved.walk, selection.carved.tree
    equal_area = found.measure.equal_area
    finest = finish(found, selection).parts
    for rank in range(len(nested.cut)):
        left = np.isin(selection.selected, nested.cut[nested.rank <= rank])
        union = np.arange(len(finest.area))
        for a, b in finest.sides[~left]:
            union[union == union[a]] = union[b]
        _, union = np.unique(union, return_inverse=True)
        pieces = np.argsort(union, kind="stable")
        offsets = np.searchsorted(union[pieces], np.arange(union.max() + 2))
        wanted = build_parts(
            found.polygons, walk, selection.selected[left], tree, equal_area, over=found.over
        )
        merged = []
        for rows, rings, parts in merged_parts(
            found.polygons, walk, selection.selected, tree, finest, pieces, offsets, over=found.over
        ):
            own = np.split(rows, rings[1:-1])
            merged += [own[lo:hi] for lo, hi in zip(parts[:-1].tolist(), parts[1:].tolist())]

        def key(part):
            return [ring.tolist() for ring in part[:1]] + sorted(ring.tolist() for ring in part[1:])

        assert sorted(map(key, merged)) == sorted(map(key, wanted.rings))


def test_what_bars_a_way():
    sea = np.array([(0, 0), (10, 0), (20, 0), (20, 10), (10, 10), (0, 10.0)])
    other = sea + [0, 1]  # a polygon that overlaps the first one
    polygons = stages.together([shapes.shape(sea), shapes.shape(other)])
    polygons, _ = from_rings(polygons)
    at = {tuple(xy): k for k, xy in enumerate(polygons.xy.tolist())}
    south, north, west, east = at[10, 0], at[10, 10], at[0, 10], at[20, 10]

    def ways(*told):
        xy = np.concatenate(
            [[polygons.xy[ends[0]], *middle, polygons.xy[ends[1]]] for ends, middle, _ in told]
        )
        island = np.concatenate([[-1, *own, -1] for _, _, own in told])
        size = [len(middle) + 2 for _, middle, _ in told]
        return natural_stage.Ways(
            np.array([ends for ends, _, _ in told]), xy, island, np.append(0, np.cumsum(size))
        )

    bend = ((south, north), [(12, 3), (12, 7)], [5, 5])
    twin = ((south, north), [(8, 7), (8, 8)], [6, 6])
    along = ((west, east), [(8, 8), (12, 6)], [7, 5])
    edges = np.array([(south, north), (west, at[20, 0]), (at[0, 1], at[20, 11])])
    found = natural_stage._barred(polygons, ways(bend, twin, along), edges, np.array([0, 2, 1]))
    assert list(found) == [3, 4, 5]
    first, third, second = found[3], found[4], found[5]
    shared = {name for name in first if name < 0}
    assert len(shared & set(second)) == 1 and len(shared & set(third)) == 1  # ends; an island
    assert not set(second) & set(third) & set(range(-99, 0))
    # two have the ends of diagonal 0, one crosses diagonal 1; the third diagonal is the other polygon's
    assert [{x for x in own if x >= 0} for own in (first, second, third)] == [{0}, {0, 1}, set()]


def test_polygons_without_a_triangulation_have_no_gates(monkeypatch):
    several = [bay(LENS), bay(LENS), bay(LENS)]
    area = np.array([shape.polygon.area for shape in several])
    real = stage.triangulate

    def but_the_first(polygons, **options):
        triangles, verdict, sides = real(polygons, **options)
        verdict = verdict.copy()
        verdict[0] = "no"
        return triangles[triangles[:, 0] >= polygons.vertex_offsets[1]], verdict, sides

    monkeypatch.setattr(stage, "triangulate", but_the_first)
    found = prepare(stages.together(several), natural=True, smallest=SMALLEST * area)
    assert found.owner[found.gate >= 0].tolist() == [1, 2]
    assert prepared(several[0]).gate is None


@pytest.mark.parametrize("factor", [1e-160, 1e-60, 1e60, 1e150])
def test_extreme_magnitudes(factor):
    shape = bay(LENS).mapped(lambda xy: xy * factor)
    with np.errstate(under="ignore"):
        found = prepare(
            one_polygon(*shape), natural=True, smallest=SMALLEST * bay(LENS).polygon.area * factor * factor
        )
    assert found.chord[found.gate >= 0] / factor == pytest.approx([2.0])
