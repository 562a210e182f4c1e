"""Candidates for natural parts: what must hold for each, and made shapes with the cuts people see."""

import numpy as np
import pytest
import shapely

from .. import checker, natural_parts, shapes, stages
from isthmus.core import metric
from isthmus.core.partition import natural as stage
from isthmus.core.partition.natural import EVEN, KEPT, SMALL, STRAIGHT, USED, edges_of_triangles, generalised
from isthmus.core.partition.polygon import one
from isthmus.core.partition.solve import finish, select
from isthmus.core.rings import one_polygon


def natural(shape, smallest=0.002, **options):
    """The stage on one polygon; the smallest part as a share of the polygon."""
    return natural_parts.prepare(one_polygon(*shape), lambda area: smallest * area, **options)


def cuts(shape, tau=1.0, smallest=0.002):
    """The cuts of the optimum for natural candidates, as unordered pairs of points."""
    prepared, _, _, _ = natural(shape, smallest)
    selected = prepared.edges[select(prepared, tau).selected]
    return {frozenset(map(tuple, prepared.polygons.xy[pair].tolist())) for pair in selected}


def pair(a, b):
    return frozenset((tuple(map(float, a)), tuple(map(float, b))))


# ----------------------------------------------------------------------------------- made shapes


def test_dumbbell_is_cut_at_both_ends_of_its_bar():
    shape = shapes.shape(shapes.HALLS)
    assert cuts(shape) == {pair((10, 4), (10, 6)), pair((14, 4), (14, 6))}


def test_limbs_are_cut_off_at_their_bases_and_the_body_is_not_cut_across():
    # two legs and, above them, two humps: their corners face each other over the body
    shape = shapes.shape(
        [
            (0, 0),
            (4, 0),
            (4, -9),
            (8, -9),
            (8, 0),
            (24, 0),
            (24, -9),
            (28, -9),
            (28, 0),
            (32, 0),
            (32, 10),
            (28, 10),
            (28, 16),
            (24, 16),
            (24, 10),
            (8, 10),
            (8, 16),
            (4, 16),
            (4, 10),
            (0, 10),
        ]
    )
    bases = {pair((x, y), (x + 4, y)) for x in (4, 24) for y in (0, 10)}
    assert cuts(shape) == bases
    assert cuts(shape, tau=3.0) == bases


def test_a_shallow_bump_with_sharp_corners_is_a_part():
    # a wheel: half a circle would have a detour of pi / 2, this has less than 1.2
    angle = np.radians(np.arange(40, 141, 10))
    wheel = np.column_stack((20 + 8 * np.cos(angle), -8 * np.sin(angle) + 8 * np.sin(angle[0])))
    shape = shapes.shape([(0, 0), *wheel[::-1], (40, 0), (40, 15), (0, 15)])
    assert cuts(shape) == {pair(wheel[0], wheel[-1])}
    prepared = natural(shape)[0]
    assert prepared.detour.max() < 1.2


@pytest.mark.parametrize("angle", (0.0, 90.0, 37.0))
@pytest.mark.parametrize("mirrored", (False, True))
def test_a_body_is_not_halved_at_a_shallow_corner(monkeypatch, angle, mirrored):
    # a van: windscreen and bonnet meet above the end of a wheel, which is too shallow for a part
    wheel = np.radians(np.arange(36, 145, 12))
    wheel = np.column_stack((14 - 4 * np.cos(wheel), 1.6 - 4 * np.sin(wheel)))
    top = [(36, 0), (36, 16), (24, 15), (20, 8), (0, 5)]
    ring = shapely.segmentize(shapely.Polygon([(0, 0), (10.3, 0), *wheel, (17.7, 0), *top]), 1.5)
    z = shapely.get_coordinates(ring)[:-1] @ (1.0, 1j)
    z = (z.conj() if mirrored else z) * np.exp(1j * np.radians(angle))
    van = shapes.shape(np.column_stack((z.real, z.imag)))

    def shares():
        prepared = natural(van)[0]
        return prepared.share[select(prepared, 1.0).selected].tolist()

    assert shares() == []
    monkeypatch.setattr(stage, "HALF", 0.5)
    assert max(shares()) > 0.35, "without the rule it is cut across"


@pytest.mark.parametrize(
    "ring, cut",
    (
        ([(0, 0), (6, 0), (6, 1), (1, 1), (1, 6), (0, 6), (0, 1)], ((0, 1), (1, 1))),  # two even legs
        ([(0, 0), (7, 3), (14, 0), (14, 12), (7, 9), (0, 12)], None),  # a waist, hardly narrower
        ([(0, 0), (4, 3), (8, 0), (8, 12), (4, 9), (0, 12)], ((4, 3), (4, 9))),  # as wide, but it opens up
        ([(0, 0), (20, 4.4), (40, 0), (40, 10), (20, 5.6), (0, 10)], ((20, 4.4), (20, 5.6))),  # narrow
    ),
)
def test_what_halves_a_body_is_cut_where_that_opens_up(ring, cut):
    assert cuts(shapes.shape(ring)) == ({pair(*cut)} if cut else set())


BLOCKS = {
    "U": (
        [(0, 0), (1, 0), (3, 0), (4, 0), (4, 1), (4, 3), (3, 3), (3, 1), (1, 1), (1, 3), (0, 3), (0, 1)],
        [((1, 0), (1, 1)), ((3, 0), (3, 1))],  # at its foot an arm of 3 by 1 is larger than one of 2 by 1
    ),
    "E": (
        [(0, 0), (1, 0), (4, 0), (4, 1), (1, 1), (1, 2), (3, 2), (3, 3), (1, 3), (1, 4), (4, 4), (4, 5)]
        + [(1, 5), (0, 5), (0, 4), (0, 3), (0, 2), (0, 1)],
        [((0, 1), (1, 1)), ((1, 2), (1, 3)), ((0, 4), (1, 4))],
    ),
}


@pytest.mark.parametrize("name", BLOCKS)
@pytest.mark.parametrize("angle", (0.0, 90.0, 180.0, 270.0, 37.0, 73.3))
@pytest.mark.parametrize("mirrored", (False, True))
def test_of_equal_corners_of_a_block_the_larger_part_whichever_way_it_stands(name, angle, mirrored):
    ring, expected = BLOCKS[name]
    turn = np.exp(1j * np.radians(angle))
    z = np.array(ring) @ (1.0, 1j)
    z = (z.conj() if mirrored else z) * turn
    block = shapes.shape(np.column_stack((z.real, z.imag)))
    prepared, _, _, _ = natural(block, 0.01)
    ends = prepared.polygons.xy[prepared.edges[select(prepared, 3.0).selected]]
    nearest = np.linalg.norm(ends[:, :, None] - block.coords, axis=3).argmin(axis=2)
    assert {frozenset(ring[k] for k in cut) for cut in nearest} == {pair(*cut) for cut in expected}


@pytest.mark.parametrize("length", [3, 10, 60])
def test_an_even_limb_stays_in_one_piece(length):
    x = np.arange(length + 1.0)
    lower, upper = np.column_stack((x, 0 * x)), np.column_stack((x[::-1], 0 * x + 1))
    assert cuts(shapes.shape([*lower, *upper])) == set()


def test_noise_below_the_scale_of_the_smallest_part_makes_no_cuts():
    rng = np.random.default_rng(5)
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    radius = 100 + rng.uniform(-1, 1, len(angle))
    shape = shapes.shape(np.column_stack((radius * np.cos(angle), radius * np.sin(angle))))
    assert cuts(shape, smallest=0.01) == set()
    any_place = stages.prepared(shape)
    assert len(select(any_place, 1.5).selected) > 0, "all diagonals see parts in the noise"


def test_noise_on_the_outline_leaves_the_neck_where_it_is():
    rng = np.random.default_rng(6)
    outline = shapely.union_all(
        [shapely.Point(0, 0).buffer(10), shapely.Point(24, 0).buffer(8), shapely.box(0, -2, 24, 2)]
    )
    ring = shapely.get_coordinates(shapely.segmentize(outline, 0.4))[:-1]
    for amount in (0.0, 0.1):
        noisy = shapes.shape(ring + rng.uniform(-amount, amount, ring.shape))
        middles = np.array([np.mean([*c], axis=0) for c in cuts(noisy, tau=3.0, smallest=0.01)])
        assert 1 <= len(middles) <= 2
        assert (np.abs(middles[:, 1]) < 1.0).all() and ((middles[:, 0] > 8) & (middles[:, 0] < 18)).all()


def test_small_parts_are_not_cut_off():
    thorn = shapes.shape([(0, 0), (20, 0), (20, 20), (11, 20), (10.5, 24), (10, 20), (0, 20)])
    assert cuts(thorn, smallest=0.001) == {pair((11, 20), (10, 20))}
    assert cuts(thorn, smallest=0.01) == set()


# ------------------------------------------------------------------------------------ properties

RANDOM = [shapes.tour(seed, 60) for seed in range(8)]
HOLED = [shapes.mosaic(seed, 60) for seed in range(8)]


@pytest.mark.parametrize("shape", RANDOM + HOLED)
def test_each_diagonal_has_one_verdict_that_holds(shape):
    prepared, found, index, edges = natural(shape, 0.004)
    assert len(found.kept) == len(found.why) == len(found.share) == len(edges)
    assert (found.kept == (found.why == KEPT)).all()
    assert set(np.unique(found.why)) <= {KEPT, SMALL, STRAIGHT, EVEN, USED}
    assert np.isin(np.flatnonzero(found.kept), index).all(), "candidates are diagonals"
    polygon = prepared.polygons
    if len(polygon.vertex) == len(polygon.xy):  # no rings touch
        ring = polygon.ring_of_corner[np.argsort(polygon.vertex)][edges]
        assert (np.isnan(found.share) == (ring[:, 0] != ring[:, 1])).all()


@pytest.mark.parametrize("seed", [0, 1, 7, 8])
def test_what_is_used_up_was_used_by_shorter_cuts_or_by_sharper_ones_about_as_short(seed):
    prepared, found, _, edges = natural(shapes.tour(seed, 150), 0.001)
    polygon = prepared.polygons
    corner = np.argsort(polygon.vertex)[edges]
    length = np.linalg.norm(polygon.xy[edges[:, 0]] - polygon.xy[edges[:, 1]], axis=1)
    bend = stage.bends(found.outline, polygon.ring_of_corner, corner, length).sum(axis=1)
    with np.errstate(invalid="ignore"):
        turn = length / np.sqrt(bend)
    cut = np.flatnonzero(found.kept)
    used = np.flatnonzero(found.why == USED)
    assert len(used)
    along, perimeter = found.outline.along[corner], found.outline.perimeter[0]
    for k in used:  # some cut before it ends where its bends are measured
        apart = np.abs(along[cut][:, :, None] - along[k])
        apart = np.minimum(apart, perimeter - apart).min(axis=(1, 2))
        assert (turn[cut[apart <= stage.REACH * length[k]]] <= turn[k]).any()


@pytest.mark.parametrize("shape", RANDOM)
def test_sides_against_shapely(shape):
    prepared, found, _, edges = natural(shape, 0.01)
    polygon = prepared.polygons
    for (u, v), share in zip(edges.tolist(), found.share.tolist()):
        side = shapely.Polygon(polygon.xy[u : v + 1]).area / shape.polygon.area
        assert share == pytest.approx(min(side, 1 - side), abs=1e-12)


@pytest.mark.parametrize("shape", RANDOM)
def test_no_part_is_smaller_than_the_smallest(shape):
    for smallest in (0.01, 0.05):
        prepared, found, _, _ = natural(shape, smallest)
        parts = finish(prepared, select(prepared, 1.0)).parts
        assert parts.area.min() >= smallest * shape.polygon.area * (1 - 1e-12)


def lines(shape, smallest=0.004, **options):
    """Candidates by their ends, with rows as names; and the generalised length by the ends of edges."""
    prepared, found, _, edges = natural(shape, smallest, **options)
    polygon = prepared.polygons
    row = np.empty(len(polygon.xy), dtype=np.int64)
    row[polygon.vertex] = polygon.rows[polygon.row_start[:-1]]
    return prepared, found, row, edges


@pytest.mark.parametrize("shape", RANDOM + HOLED)
def test_result_does_not_depend_on_how_the_rings_are_told(shape):
    told = [shapes.restarted(shape, 7), shapes.reversed_rings(shape), shapes.reordered_holes(shape, 1)]
    mine, found, _, edges = natural(shape, 0.004)
    for other in told:
        theirs, same, _, other_edges = natural(other, 0.004)
        assert (theirs.polygons.xy == mine.polygons.xy).all()
        assert (other_edges == edges).all() and (same.why == found.why).all()
        assert (same.edge_length == found.edge_length).all()


@pytest.mark.parametrize("shape", RANDOM + HOLED)
def test_result_moves_and_grows_with_the_polygon(shape):
    _, found, _, edges = natural(shape, 0.004)
    # by powers of two: nothing is rounded
    for factor, shift in ((2.0**-7, 0.0), (1.0, 2.0**20), (2.0**9, -(2.0**22))):
        _, same, _, other_edges = natural(shape.mapped(lambda xy: xy * factor + shift), 0.004)
        assert (other_edges == edges).all()
        assert np.mean(same.why == found.why) > 0.99
        assert np.allclose(same.edge_length, found.edge_length * factor, rtol=1e-6)


def test_result_of_one_polygon_does_not_depend_on_the_others():
    several = RANDOM[:4] + HOLED[:3]
    alone = [natural(shape, 0.004)[1] for shape in several]
    together = natural_parts.prepare(stages.together(several), lambda area: 0.004 * area)[1]
    for name in ("kept", "edge_length", "why"):
        assert (getattr(together, name) == np.concatenate([getattr(x, name) for x in alone])).all(), name
    share = np.concatenate([x.share for x in alone])
    assert np.allclose(together.share, share, rtol=0, atol=1e-12, equal_nan=True)


@pytest.mark.parametrize("seed", range(25))
def test_fewest_cuts_against_all_subsets(seed):
    shape = shapes.tour(seed, 24)
    prepared, _, _, _ = natural(shape, 1e-4)
    polygon = prepared.polygons
    if not 1 <= len(prepared.edges) <= 12:
        pytest.skip("too many candidates to try all subsets, or none")
    # with the generalised lengths: the checker's graph, all subsets
    taus = (1.0, 1.3, 2.0, 3.0)
    ratio = prepared.chord / np.sqrt(prepared.share)
    for tau, (size, least) in zip(taus, fewest(prepared, polygon, taus, ratio)):
        selected = select(prepared, tau).selected
        assert len(selected) == size
        assert ratio[selected].sum() == pytest.approx(least)  # of the most salient parts


def fewest(prepared, polygon, taus, ratio):
    """Fewest cuts and their least sum of ratios, by trying all subsets; ways along the outline by summing."""
    n, k = len(polygon.xy), len(prepared.edges)
    along = np.append(0.0, np.cumsum(prepared.edge_length))
    best = {tau: (k, ratio.sum()) for tau in taus}
    for subset in range(2**k):
        chosen = [c for c in range(k) if subset >> c & 1]
        nodes = sorted({0, *prepared.edges.ravel().tolist()})
        place = {v: p for p, v in enumerate(nodes)}
        d = np.full((len(nodes), len(nodes)), np.inf)
        np.fill_diagonal(d, 0.0)
        for a, b in zip(nodes, nodes[1:] + [n]):
            p, q = place[a], place[b % n]
            d[p, q] = d[q, p] = min(d[p, q], along[b] - along[a])
        for c in chosen:
            p, q = (place[v] for v in prepared.edges[c].tolist())
            d[p, q] = d[q, p] = min(d[p, q], prepared.length[c])
        for via in range(len(nodes)):
            d = np.minimum(d, d[:, via, None] + d[None, via])
        p, q = np.array([[place[v] for v in e] for e in prepared.edges.tolist()]).T
        worst = (d[p, q] / prepared.length).max()
        for tau in taus:
            if worst <= tau * (1 + 1e-12):
                best[tau] = min(best[tau], (len(chosen), ratio[chosen].sum()))
    return [best[tau] for tau in taus]


def test_of_equally_few_cuts_those_of_salient_parts():
    seen = 0
    for seed in range(60):
        prepared, _, _, _ = natural(shapes.tour(seed, 60), 1e-4)
        ratio = prepared.chord / np.sqrt(prepared.share)
        for tau in (1.3, 2.0, 3.0):
            new = select(prepared, tau).selected
            old = select(prepared._replace(natural=False), tau).selected
            assert len(new) == len(old)
            assert ratio[new].sum() <= ratio[old].sum() * (1 + 1e-12)
            seen += not np.array_equal(new, old)
    assert seen > 5


def test_an_islet_does_not_take_a_neck_away():
    # the shortest way over the neck leads through an islet that does not count: it is cut beside it
    below, above = [(10.5, 4.5), (11.5, 4.4)], [(11.5, 5.6), (10.5, 5.5)]
    shell = [(0, 0), (9, 0), *below, (13, 0), (22, 0), (22, 10), (13, 10), *above, (9, 10), (0, 10)]
    islet = shapes.box(10.45, 4.9, 10.55, 5.1)[::-1]
    prepared, _, _, _ = natural(shapes.shape(shell, islet), 0.01)
    ends = prepared.polygons.xy[prepared.edges[select(prepared, 3.0).selected]]
    assert len(ends) == 1
    cut = shapely.LineString(ends[0] * prepared.polygons.unit[0])
    assert cut.disjoint(shapely.Polygon(islet))
    assert cut.length < 1.5


def test_degrees_are_measured_on_the_ellipsoid():
    # the same dumbbell in metres near the pole and, by its equal-area coordinates, in degrees
    body = np.array(shapes.HALLS, dtype=float)
    for north in (0.0, 60.0, 75.0):
        stretch = 1.0 / np.cos(np.radians(north + 0.05))
        degrees = body * [0.01 * stretch, 0.01] + [30.0, north]
        prepared, found, _, _ = natural(shapes.shape(degrees), 0.01, measure=metric.ellipsoidal())
        assert len(select(prepared, 1.0).selected) == 2
        plane = natural(shapes.shape(body), 0.01)[1]
        # which diagonal of a square the triangulation has is a matter of the last digit
        assert np.allclose(found.share[found.kept], plane.share[plane.kept], atol=2e-3)
        assert np.allclose(
            found.edge_length / found.edge_length[0], plane.edge_length / plane.edge_length[0], rtol=2e-2
        )


# ------------------------------------------------------------------------------ the generalised outline


def outline(shape, least):
    polygon = one(*shape)
    plane = polygon.xy[polygon.vertex]
    length = np.hypot(*(plane[polygon.next_corner] - plane).T)
    return (
        polygon,
        plane,
        length,
        generalised(plane, plane, polygon.offsets, length, np.full(len(polygon.offsets) - 1, least)),
    )


@pytest.mark.parametrize("shape", RANDOM + HOLED)
def test_generalised_outline(shape):
    area = shape.polygon.area
    for least in (0.0, 1e-5 * area, 1e-3 * area, 10 * area):
        polygon, plane, length, made = outline(shape, least)
        kept = np.diff(made.ring_start)
        assert (kept >= np.minimum(3, np.diff(polygon.offsets))).all()
        # each original edge has its part of the length of its generalised edge
        assert made.edge_length.sum() == pytest.approx(made.step.sum())
        assert (made.edge_length <= length * (1 + 1e-9)).all(), "a straight way is never longer"
        if least == 0.0:
            assert (made.corner == np.arange(len(plane))).all()
            assert np.allclose(made.edge_length, length)
        # what stays is large, but in rings of which hardly anything is left
        before, after = plane[np.roll(made.corner, 1)], plane[np.roll(made.corner, -1)]
        b, c = plane[made.corner] - before, after - before
        triangle = np.abs(b[:, 0] * c[:, 1] - c[:, 0] * b[:, 1]) / 2
        if len(kept) == 1 and kept[0] > 5:
            assert triangle.min() >= least


def test_a_long_taper_needs_few_rounds(monkeypatch):
    """Areas that grow steadily along the ring: taking one local minimum at a time would take ages."""
    x = np.cumsum(np.linspace(1, 2, 4000))
    wave = np.column_stack((x, np.where(np.arange(4000) % 2, 1e-3, 0.0) * np.linspace(1, 9, 4000)))
    shape = shapes.shape([*wave, (x[-1], 5000.0), (x[0], 5000.0)])
    rounds = []
    every = stage._every_second
    monkeypatch.setattr(stage, "_every_second", lambda *a: rounds.append(1) or every(*a))
    _, _, _, made = outline(shape, 100.0)
    assert len(made.corner) < 20 and len(rounds) < 120


def dense(polygon, spacing):
    """A polygon told by far more vertices than it has corners."""
    return shapes.from_shapely(shapely.segmentize(polygon, spacing))


def rough(seed):
    """A star of a few limbs with a rough outline, and a hole in it; no four vertices lie on a circle."""
    random = np.random.default_rng(seed)
    rings = []
    for radius, wave, count in ((10.0, 4.0, 300), (2.5, 0.5, 60)):
        angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
        far = radius + wave * np.sin(random.integers(3, 7) * angle + random.uniform(0, 6))
        far += random.uniform(-0.02, 0.02, count) * radius
        rings.append(np.column_stack((np.cos(angle), np.sin(angle))) * far[:, None])
    return shapes.shape(*rings)


@pytest.mark.parametrize("way", [(-1, 1), (1, -1), (-1, -1), 1j, -1j], ids=str)
@pytest.mark.parametrize("seed", range(4))
def test_a_polygon_is_cut_alike_whichever_way_it_lies(seed, way):
    """Mirrored, or turned by quarters, which rounds nothing, and its rings begun elsewhere."""

    def there(xy):
        x, y = xy.T
        return np.column_stack((-way.imag * y, way.imag * x)) if isinstance(way, complex) else xy * way

    def back(xy):
        x, y = xy.T
        return np.column_stack((way.imag * y, -way.imag * x)) if isinstance(way, complex) else xy * way

    def told(shape, back):
        prepared, found, _, edges = natural(shape, 0.03)
        polygons = prepared.polygons
        xy = back(polygons.xy)
        ends = [frozenset(map(tuple, one)) for one in xy[edges].tolist()]
        sides = np.stack((polygons.vertex, polygons.vertex[polygons.next_corner]), axis=1)
        length = {frozenset(map(tuple, one)): x for one, x in zip(xy[sides].tolist(), found.edge_length)}
        cut = {
            frozenset(map(tuple, one)) for one in xy[prepared.edges[select(prepared, 2.0).selected]].tolist()
        }
        return dict(zip(ends, found.why.tolist())), length, cut

    shape = rough(seed)
    why, length, cut = told(shape, lambda xy: xy)
    assert cut
    other_why, other_length, other_cut = told(shapes.restarted(shape.mapped(there), 11), back)
    assert other_why == why and other_cut == cut
    assert other_length == pytest.approx(length, rel=1e-9)


@pytest.mark.parametrize("shape", RANDOM[:3] + HOLED[:3])
def test_leaps_find_what_steps_find(monkeypatch, shape):
    told = dense(shape.polygon, 0.02 * shape.polygon.area**0.5)
    found = []
    for plain in (np.inf, -1):
        monkeypatch.setattr(stage, "PLAIN", plain)
        found.append(natural(told, 0.001)[1].why)
    assert (found[0] == found[1]).all() and (found[0] == EVEN).any()


def test_an_outline_with_far_more_vertices_than_corners_takes_leaps(monkeypatch):
    """A channel told by so many: walking along it from each diagonal at its corners would take ages."""
    hall = shapely.box(0, 0, 9, 9)
    both = shapely.union_all([hall, shapely.box(9, 4, 18, 5), shapely.box(18, 0, 27, 9)])
    told = dense(both, 0.01)
    steps = []
    walk = np.nonzero  # of the edges of the triangles that are reached
    monkeypatch.setattr(np, "nonzero", lambda x: steps.append(len(x) * (np.ndim(x) == 2)) or walk(x))
    assert natural(told, 0.01)[1].kept.any()
    assert 0 < sum(steps) < 20 * len(told.coords)


def test_triangles_beside_edges():
    polygon = one(*RANDOM[0])
    edges = stages.diagonals(polygon)
    from isthmus.core.partition.triangulation import triangulate

    triangles, *_ = triangulate(polygon)
    beside, across = edges_of_triangles(triangles, edges, len(polygon.xy))
    assert (beside >= 0).all() and (across[-1] == -1).all()
    for (u, v), pair_ in zip(edges.tolist(), beside.tolist()):
        assert pair_[0] != pair_[1] and all({u, v} <= set(triangles[t].tolist()) for t in pair_)
    assert (np.bincount(across[:-1][across[:-1] >= 0]) == 2).all()


def test_dilations_of_natural_candidates_by_the_checker():
    """Without detail below the scale, lengths are the true ones, and the checker can say so."""
    for shape in RANDOM[:4]:
        prepared, found, _, _ = natural(shape, 1e-7)
        assert np.allclose(found.edge_length, outline(shape, 0.0)[2])
        for tau in (1.0, 1.5, 3.0):
            selected = select(prepared, tau).selected
            polygon = prepared.polygons
            worst = checker.dilations(polygon.xy, [polygon.vertex], prepared.edges[selected], prepared.edges)
            assert worst.max(initial=1.0) <= tau * (1 + 1e-9)


@pytest.mark.parametrize(
    "reach, end",
    [(0.0, (0, 0)), (1.5, (1.5, 0)), (2.0, (2, 0)), (2.25, (2, 0.25)), (6.0, (0, 0)), (99.0, (0, 0))],
)
def test_a_walk_along_an_outline_ends_after_its_length_or_where_it_began(reach, end):
    corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)]
    assert stage._walk(0, [1, 2, 3, 0], corners, reach) == end
