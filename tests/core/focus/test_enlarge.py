"""The whole road: what must hold for every focus map."""

import numpy as np
import pytest
import shapely

pytest.importorskip("scipy")

import isthmus.core.focus.enlarge as road
from isthmus.core.errors import Cancelled, Unsolvable
from isthmus.core.focus.carrying import Carrier
from isthmus.core.focus.enlarge import enlarge
from isthmus.core.focus.mesh import turned

from ..shapes import box, circle, mosaic, tour
from .verify import faults, verify, with_splits


def rings_of(*rings):
    """Rows, starts and polygons of closed rings, each a polygon of its own."""
    rings = [np.array(ring, dtype=float) for ring in rings]
    rings = [np.concatenate((ring, ring[:1])) for ring in rings]
    starts = np.cumsum([0] + [len(ring) for ring in rings])
    return np.concatenate(rings), starts, [[k] for k in range(len(rings))]


def check(rows, starts, polygons, focus, scale, result, frame=True):
    """Everything that is promised of a map."""
    inside = shapely.covers(focus, shapely.points(rows))
    assert result.scale == scale
    if inside.any() and len(shapely.get_parts(focus)) == 1:
        size = np.ptp(rows, axis=0).max()
        expected = (rows[inside] - rows[inside][0]) * result.scale + result.rows[inside][0]
        assert np.abs(result.rows[inside] - expected).max() < 1e-9 * size
    if frame:
        margin = 1e-9 * np.ptp(rows, axis=0).max()
        assert (result.rows.min(axis=0) >= rows.min(axis=0) - margin).all()
        assert (result.rows.max(axis=0) <= rows.max(axis=0) + margin).all()
    lines_of_map = with_splits(rows, starts, result)
    assert verify(*lines_of_map, [[lines] for lines in polygons]).good
    assert faults(result, *lines_of_map) == []
    assert not turned(result.points, result.moved, result.triangles).any()
    assert result.distortion.flipped == 0.0


@pytest.mark.parametrize("rule", ["MinSize", "Greedy", "Proximity", "None"])
@pytest.mark.parametrize("scale", [0.5, 1.7])
def test_random_polygons(rule, scale):
    for seed in range(3):
        rows, starts, polygons = rings_of(tour(seed, 60).coords)
        focus = shapely.box(2e5, 2e5, 5.5e5, 5e5)
        result = enlarge(rows, starts, polygons, focus, scale, rule=rule)
        check(rows, starts, polygons, focus, scale, result)


def test_scale_one_is_the_identity():
    rows, starts, polygons = rings_of(tour(1, 50).coords)
    result = enlarge(rows, starts, polygons, shapely.box(0, 0, 5e5, 5e5), 1.0)
    assert np.array_equal(result.rows, rows)
    assert result.scale == 1.0


def test_the_change_vanishes_as_the_scale_tends_to_one():
    rows, starts, polygons = rings_of(tour(1, 50).coords)
    result = enlarge(rows, starts, polygons, shapely.box(0, 0, 5e5, 5e5), 1.0 + 1e-12)
    assert np.abs(result.rows - rows).max() < 1e-9 * 1e6


def test_polygons_with_holes():
    shape = mosaic(3, 60)
    rings = [np.concatenate((ring, ring[:1])) for ring in shape.rings]
    rows, starts = np.concatenate(rings), np.cumsum([0] + [len(ring) for ring in rings])
    polygons = [list(range(len(rings)))]
    focus = shapely.box(3e5, 3e5, 6e5, 6e5)
    result = enlarge(rows, starts, polygons, focus, 1.5)
    check(rows, starts, polygons, focus, 1.5, result)


def grid(n=4):
    """n x n squares that share borders and corners."""
    return rings_of(*(box(x, y, x + 1, y + 1) for x in range(n) for y in range(n)))


@pytest.mark.parametrize("scale", [0.4, 2.0])
def test_shared_borders_stay_shared(scale):
    rows, starts, polygons = grid()
    focus = shapely.box(0.9, 0.9, 2.1, 2.1)
    result = enlarge(rows, starts, polygons, focus, scale)
    check(rows, starts, polygons, focus, scale, result)


def test_islands_move_with_their_mainland():
    """Straits neither close nor open to seas."""
    mainland = circle(60, 10.0)
    islands = [circle(10, 0.3, (11.0 * np.cos(a), 11.0 * np.sin(a))) for a in np.arange(12) * 0.5]
    rows, starts, polygons = rings_of(mainland, *islands)
    focus = shapely.box(5.0, -5.0, 14.0, 5.0)
    result = enlarge(rows, starts, polygons, focus, 1.4)
    check(rows, starts, polygons, focus, 1.4, result)
    assert (result.kind == "join").any()
    land = shapely.Polygon(result.rows[starts[0] : starts[1]])
    for k in range(1, 13):
        island = shapely.Polygon(result.rows[starts[k] : starts[k + 1]])
        assert 0.1 < land.distance(island) < 2.0


def test_lines_that_share_vertices_stay_joined():
    rng = np.random.default_rng(2)
    streets = [np.column_stack((np.arange(9.0), np.full(9, y))) for y in range(9)]
    streets += [street[:, ::-1] for street in streets]
    noise = rng.normal(0.0, 0.15, (9, 9, 2))
    streets = [street + noise[street[:, 0].astype(int), street[:, 1].astype(int)] for street in streets]
    starts = np.arange(19) * 9
    rows = np.concatenate(streets)
    focus = shapely.Point(4, 4).buffer(1.6)
    result = enlarge(rows, starts, [], focus, 2.0)
    check(rows, starts, [], focus, 2.0, result)
    assert (result.kind == "selected").any() == (len(result.kind) > 0)


def test_given_edges_are_used():
    rows, starts, polygons = rings_of(circle(40, 5.0))
    result = enlarge(
        rows, starts, polygons, shapely.box(2, -2, 6, 2), 1.5, edges=np.array([(5, 20), (20, 5), (30, 12)])
    )
    assert set(result.kind) == {"given"} and len(result.edges) == 2


def test_a_focus_between_the_vertices_pushes_the_rest_away():
    rows, starts, polygons = rings_of(circle(80, 10.0))
    focus = shapely.Point(3.0, 0.0).buffer(2.0)
    edges, shares = np.array([(0, 40), (20, 60)]), []
    result = enlarge(rows, starts, polygons, focus, 2.0, edges=edges, progress=shares.append)
    assert shares == sorted(shares)
    given = {frozenset(map(tuple, rows[pair])) for pair in edges}
    used = result.points[result.edges[result.kind == "given"]]
    assert {frozenset(map(tuple, pair)) for pair in used} == given
    result = enlarge(rows, starts, polygons, focus, 2.0)
    check(rows, starts, polygons, focus, 2.0, result)
    outline = shapely.covers(focus.buffer(1e-9), shapely.points(result.points))
    moved = shapely.Polygon(result.rows)
    assert outline.sum() >= 40
    assert shapely.covers(moved, shapely.points(result.moved[outline])).all()


@pytest.mark.parametrize("focus, words", [
    (shapely.box(50, 50, 60, 60), "touches nothing"),
    (shapely.Polygon(), "empty"),
    (shapely.LineString([(0, 0), (1, 1)]), "no area"),
    (shapely.box(-50, -50, 60, 60), "covers all"),
    (shapely.box(-50, -9.5, 60, 9.5), "larger than the frame"),
])  # fmt: skip
def test_a_focus_that_cannot_be_enlarged(focus, words):
    rows, starts, polygons = rings_of(circle(40, 10.0))
    with pytest.raises(Unsolvable, match=words):
        enlarge(rows, starts, polygons, focus, 2.0)


def test_the_frame_grows_with_the_modulus_of_the_ring():
    """Twice and three times as large, the map bends alike; a small region needs no growth at all."""
    rows, starts, polygons = rings_of(circle(400, 10.0))
    focus = shapely.box(-3, -4, 3, 4)
    made = [enlarge(rows, starts, polygons, focus, scale, growth=9.0) for scale in (2.0, 3.0)]
    for one, scale in zip(made, (2.0, 3.0)):
        assert one.growth == pytest.approx(scale * 0.4 ** (2 / 7), rel=0.01)
        check(rows, starts, polygons, focus, scale, one, frame=False)
    assert made[0].distortion.median == pytest.approx(made[1].distortion.median, abs=0.3)
    assert enlarge(rows, starts, polygons, focus, 2.0, growth=0.2).growth == pytest.approx(1.2)
    assert enlarge(
        rows, starts, polygons, shapely.box(-0.2, -0.2, 0.2, 0.2), 2.0, growth=9.0
    ).growth.tolist() == [1, 1]


def test_regions_above_each_other_count_once():
    """And those beside each other twice."""
    rows, starts, polygons = rings_of(circle(400, 10.0))
    above, beside = (
        shapely.MultiPolygon([shapely.box(*(at - 1.5), *(at + 1.5)) for at in np.array(middles)])
        for middles in ([(0, -6.0), (0, 0), (0, 6.0)], [(-6.0, -3), (0.0, -1), (6.0, 1)])
    )
    growth = [enlarge(rows, starts, polygons, one, 2.0, growth=9.0).growth.max() for one in (above, beside)]
    assert growth == pytest.approx([2.0 * 0.45 ** (2 / 7)] * 2, rel=0.02)


def test_half_of_a_map_and_five_times():
    rows, starts, polygons = rings_of(circle(200, 10.0))
    for focus, scale in ((shapely.box(-11, -11, 11, 0), 2.0), (shapely.box(-3, -3, 3, 3), 5.0)):
        check(
            rows,
            starts,
            polygons,
            focus,
            scale,
            enlarge(rows, starts, polygons, focus, scale, growth=2.0),
            frame=False,
        )


def raster(seed, n):
    """Rows, starts and polygons of three classes of squares; in the middle of them, a focus."""
    kind = np.random.default_rng(seed).integers(0, 3, (n, n))
    squares = np.array([[box(x, y, x + 1, y + 1) for x in range(n)] for y in range(n)])
    shapes = shapely.get_parts([shapely.union_all(shapely.polygons(squares[kind == k])) for k in range(3)])
    features = [[shapely.get_coordinates(r) for r in shapely.get_rings(shape)] for shape in shapes]
    rings = [ring for feature in features for ring in feature]
    starts = np.append(0, np.cumsum([len(ring) for ring in rings]))
    number = iter(range(len(rings)))
    polygons = [[next(number) for _ in feature] for feature in features]
    return np.concatenate(rings), starts, polygons, shapely.box(0.3 * n, 0.3 * n, 0.7 * n, 0.7 * n)


@pytest.mark.parametrize("seed, n, most", [(0, 18, 3000), (1, 18, 3000), (2, 18, 3000), (2, 30, 100)])
def test_a_raster_holds_for_other_diagonals(seed, n, most):
    """Any triangulation of its squares, solved for or put back: the checker's is another one."""
    rows, starts, polygons, focus = raster(seed, n)
    result = enlarge(rows, starts, polygons, focus, 2.0, growth=0.3, most=most)
    lines = with_splits(rows, starts, result)
    assert verify(*lines, [[one] for one in polygons]).good and faults(result, *lines) == []
    assert result.dented == 0


def test_dents_that_cannot_be_put_right_are_solved_for_or_told(monkeypatch):
    """Nothing else is wrong with such a map."""
    monkeypatch.setattr(road, "stay_convex", lambda xy, shift, *more: shift)
    rows, starts, polygons, focus = raster(2, 30)
    again = enlarge(rows, starts, polygons, focus, 2.0, growth=0.3, most=100)
    monkeypatch.setattr(road, "ATTEMPTS", 1)
    once = enlarge(rows, starts, polygons, focus, 2.0, growth=0.3, most=100)
    lines = with_splits(rows, starts, once)
    assert once.dented > 0 and verify(*lines, [[one] for one in polygons])[1:] == (0, 0, 0, True)
    assert faults(once, *lines) == []
    lines = with_splits(rows, starts, again)
    assert again.dented == 0 and verify(*lines, [[one] for one in polygons]).good


def test_what_was_found_is_kept_if_more_has_no_room(monkeypatch):
    """A map with dents is one; that solving for more of it stops on the way is no reason to refuse."""
    monkeypatch.setattr(road, "stay_convex", lambda xy, shift, *more: shift)
    rows, starts, polygons, focus = raster(2, 30)
    relax, calls = road.relax, []

    def once(*given, **options):
        calls.append(given)
        return relax(*given, **options) if len(calls) == 1 else (np.zeros_like(given[0]), 0.5)

    monkeypatch.setattr(road, "relax", once)
    result = enlarge(rows, starts, polygons, focus, 2.0, growth=0.3, most=100)
    assert len(calls) == 2 and result.dented > 0
    assert faults(result, *with_splits(rows, starts, result)) == []


def test_without_a_frame_the_map_grows():
    rows, starts, polygons = rings_of(circle(60, 10.0))
    focus = shapely.box(-50, -4, 60, 4)
    result = enlarge(rows, starts, polygons, focus, 2.0, frame=False)
    check(rows, starts, polygons, focus, 2.0, result, frame=False)
    assert (np.ptp(result.rows, axis=0) > np.ptp(rows, axis=0)).any()
    inside = shapely.covers(focus, shapely.points(rows[:-1]))
    assert result.rows[:-1][inside].mean(axis=0) == pytest.approx(rows[:-1][inside].mean(axis=0), abs=1e-9)
    whole = enlarge(rows, starts, polygons, shapely.box(-50, -50, 60, 60), 2.0, frame=False)
    assert np.ptp(whole.rows, axis=0) == pytest.approx(2.0 * np.ptp(rows, axis=0), rel=1e-12)


def test_a_region_from_side_to_side_becomes_smaller():
    """It leaves the sides of the frame, which stay where they are."""
    rows, starts, polygons = rings_of(circle(60, 10.0))
    focus = shapely.box(-50, -4, 60, 4)
    check(rows, starts, polygons, focus, 0.5, enlarge(rows, starts, polygons, focus, 0.5))


def test_two_regions():
    rows, starts, polygons = rings_of(circle(90, 10.0))
    parts = [shapely.box(6, -3, 12, 3), shapely.box(-12, -3, -6, 3)]
    focus = shapely.MultiPolygon(parts)
    result = enlarge(rows, starts, polygons, focus, 1.5)
    check(rows, starts, polygons, focus, 1.5, result)
    for part in parts:
        inside = shapely.covers(part, shapely.points(rows))
        grown = np.ptp(result.rows[inside], axis=0) / np.ptp(rows[inside], axis=0)
        assert grown == pytest.approx(1.5, rel=1e-9)


def test_too_large_a_scale_gives_a_reason():
    """Two regions that fit each, but not both."""
    corners = [(-10, -5), (-1, -5), (0, -20), (1, -5), (10, -5), (10, 5), (1, 5), (0, 20), (-1, 5), (-10, 5)]
    ring = shapely.segmentize(shapely.Polygon(corners), 1.0)
    rows, starts, polygons = rings_of(shapely.get_coordinates(ring)[:-1])
    parts = [shapely.box(1, -6, 12, 6), shapely.box(-12, -6, -1, 6)]
    with pytest.raises(Unsolvable, match="no room for a scale of 1.2: it ends at 1.1"):
        enlarge(rows, starts, polygons, shapely.MultiPolygon(parts), 1.2)
    focus = shapely.MultiPolygon(parts)
    check(
        rows,
        starts,
        polygons,
        focus,
        1.2,
        enlarge(rows, starts, polygons, focus, 1.2, growth=0.2),
        frame=False,
    )


def test_detail_is_carried():
    """Solved on a simplified outline, and all promises hold."""
    angle = np.linspace(0.0, 2.0 * np.pi, 6001)[:-1]
    radius = 10.0 + 1.0 * np.sin(5 * angle) + 0.03 * np.sin(700 * angle)
    coast = np.column_stack((np.cos(angle), np.sin(angle))) * radius[:, None]
    rows, starts, polygons = rings_of(coast)
    focus = shapely.box(8, -5, 14, 5)
    result = enlarge(rows, starts, polygons, focus, 1.6, most=300)
    check(rows, starts, polygons, focus, 1.6, result)
    assert result.distortion.flipped < 0.05


def test_many_islands():
    rng = np.random.default_rng(9)
    centres = np.argwhere(np.ones((16, 16))) + rng.uniform(-0.2, 0.2, (256, 2))
    rows, starts, polygons = rings_of(*(circle(5, 0.2, centre) for centre in centres))
    focus = shapely.box(5, 5, 9, 9)
    result = enlarge(rows, starts, polygons, focus, 1.5)
    check(rows, starts, polygons, focus, 1.5, result)


def test_cancel():
    rows, starts, polygons = rings_of(tour(1, 60).coords)
    with pytest.raises(Cancelled):
        enlarge(rows, starts, polygons, shapely.box(2e5, 2e5, 6e5, 6e5), 2.0, cancelled=lambda: True)


def test_coordinates_that_are_not_finite():
    rows, starts, polygons = rings_of(circle(10))
    rows[3] = np.nan
    with pytest.raises(Unsolvable, match="finite"):
        enlarge(rows, starts, polygons, shapely.box(0, 0, 2, 2), 2.0)


@pytest.mark.parametrize("focus", [shapely.box(4, -3, 12, 3), shapely.box(1, 1, 3, 3)])
def test_carrier(focus):
    """With a focus on the coast, and with one that holds no vertex of the map."""
    rows, starts, polygons = rings_of(circle(60, 10.0))
    result = enlarge(rows, starts, polygons, focus, 1.5)
    carrier = Carrier(result.points, result.moved, result.triangles)
    assert np.allclose(carrier(rows), result.rows, atol=1e-12)  # what was joined stays joined
    share = np.linspace(0.0, 1.0, 7)[:, None, None]
    on_border = rows[:-1] + share * (rows[1:] - rows[:-1])
    expected = result.rows[:-1] + share * (result.rows[1:] - result.rows[:-1])
    assert np.abs(carrier(on_border.reshape(-1, 2)) - expected.reshape(-1, 2)).max() < 1e-9 * 20
    low, high = (np.array(v) for v in (shapely.bounds(focus)[:2], shapely.bounds(focus)[2:]))
    within = low + np.array([(0.2, 0.2), (0.45, 0.6), (0.5, 0.4)]) * (high - low)
    gaps = carrier(within)[1:] - carrier(within)[:-1]
    assert np.allclose(gaps, 1.5 * np.diff(within, axis=0), atol=1e-9)
    far = np.array([(100.0, 100.0), (-50.0, -100.0), (np.nan, 3.0)])
    assert np.array_equal(carrier(far), far, equal_nan=True)


def by_brute_force(result, xy):
    """Where points go: the triangle that holds each best, one after the other; beyond the frame, the nearest."""
    corner = result.points[result.triangles]
    shift = (result.moved - result.points)[result.triangles]
    near = np.clip(xy, result.points.min(axis=0), result.points.max(axis=0))
    found = np.array(xy)
    side = np.stack((corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=2)
    for k, point in enumerate(near):
        share = np.linalg.solve(side, (point - corner[:, 0])[:, :, None])[:, :, 0]
        share = np.column_stack((1.0 - share.sum(axis=1), share))
        best = share.min(axis=1).argmax()
        assert share[best].min() > -1e-9
        found[k] += share[best] @ shift[best]
    return found


@pytest.mark.parametrize("focus", [shapely.box(4, -3, 12, 3), shapely.box(1, 1, 3, 3)])
def test_lines_are_carried_all_along(focus):
    """Not at their points alone; to both sides alike, and with no points where nothing bends."""
    rows, starts, polygons = rings_of(circle(60, 10.0))
    result = enlarge(rows, starts, polygons, focus, 1.5, growth=0.3)
    carrier = Carrier(result.points, result.moved, result.triangles)
    rng = np.random.default_rng(1)
    lines = rng.uniform(-14.0, 14.0, (40, 2))
    lines[5] = lines[6]
    lines[20] = np.nan
    lines = np.concatenate((lines, lines[::-1], rows[:9]))
    moved, bends = carrier.lines(lines, [0, 40, 40, 80, 89])
    there, back = (bends[(bends[:, 0] >= lo) & (bends[:, 0] < lo + 39)] for lo in (0, 40))
    assert np.array_equal(there[:, 1:3], back[::-1, 1:3]) and np.allclose(there[:, 3] + back[::-1, 3], 1.0)
    assert len(bends) == 2 * len(there) > 2 * 38 and not np.isin(bends[:, 0], (5, 19, 20, 39, 79)).any()
    share = np.linspace(0.0, 1.0, 41)
    off = 0.0
    for row in np.setdiff1d(np.arange(39), (19, 20)):
        own = bends[bends[:, 0] == row]
        at = np.concatenate(([0.0], own[:, 3], [1.0]))
        assert (np.diff(at) > 0.0).all()
        way = np.concatenate((moved[row : row + 1], own[:, 1:3], moved[row + 1 : row + 2]))
        carried = np.column_stack([np.interp(share, at, way[:, axis]) for axis in (0, 1)])
        expected = by_brute_force(result, lines[row] + share[:, None] * (lines[row + 1] - lines[row]))
        off = max(off, np.abs(carried - expected).max())
    assert off < 1e-9 * 20.0
    still = enlarge(rows, starts, polygons, focus, 1.0)
    assert len(Carrier(still.points, still.moved, still.triangles).lines(lines, [0, len(lines)])[1]) == 0


@pytest.mark.parametrize("gap", [1e-8, 1e-5, -1e-3])
def test_slivers_are_not_in_the_way(gap):
    """Parcels of size 1 that should meet, and do not quite."""
    rng = np.random.default_rng(1)
    post = np.stack(np.meshgrid(*[np.arange(6.0)] * 2, indexing="ij"), axis=-1)
    post += rng.uniform(-0.2, 0.2, post.shape)
    corners = [post[i : i + 2, j : j + 2].reshape(4, 2)[[0, 2, 3, 1]] for i in range(5) for j in range(5)]
    parcels = shapely.buffer(shapely.polygons(corners), -gap * rng.integers(0, 2, 25), join_style="mitre")
    rows, starts, polygons = rings_of(*(shapely.get_coordinates(one)[:-1] for one in parcels))
    focus = shapely.box(1.5, 1.5, 3.2, 3.2)
    result = enlarge(rows, starts, polygons, focus, 2.0, growth=2.0)
    lines = with_splits(rows, starts, result)
    assert result.scale == 2.0 and faults(result, *lines) == []
    assert verify(*lines, [[one] for one in polygons])[1:] == (0, 0, 0, True)


def digitised_twice(seed, per, off):
    """Five columns; what should be one border between two is drawn twice, with points at other places."""
    rng = np.random.default_rng(seed)

    def side(k):
        y = np.sort(np.concatenate(([0.0, 5.0], rng.uniform(0.0, 5.0, per))))
        x = k + (0.2 * np.sin(1.3 * y + k) + rng.uniform(-off, off, len(y))) * (0 < k < 5)
        return np.column_stack((x, y))

    return rings_of(*(np.concatenate((side(k)[::-1], side(k + 1))) for k in range(5)))


def parcels_that_nearly_meet():
    """A square cut in two again and again, turned, and rounded: corners lie beside the edges of neighbours."""
    rng, boxes = np.random.default_rng(5), [(0.0, 0.0, 100.0, 80.0)]
    for _ in range(5):
        halves = []
        for x0, y0, x1, y1 in boxes:
            t = rng.uniform(0.3, 0.7)
            x, y = x0 + t * (x1 - x0), y0 + t * (y1 - y0)
            wide = x1 - x0 > y1 - y0
            halves += [(x0, y0, x, y1), (x, y0, x1, y1)] if wide else [(x0, y0, x1, y), (x0, y, x1, y1)]
        boxes = halves
    turn = np.array([(0.9, 0.4), (-0.4, 0.9)])
    rows, starts, polygons = rings_of(*(np.round(box(*one) @ turn, 7) for one in boxes))
    return rows, starts, polygons


@pytest.mark.parametrize("made, scale", [
    ("twice, far", 2.0), ("twice, near", 5.0), ("parcels", 5.0), ("from side to side", 2.0),
])  # fmt: skip
def test_slivers_without_points_beside_each_other(made, scale):
    """They are not in the way, nor are those that end on the frame, or go from side to side of it."""
    if made == "parcels":
        rows, starts, polygons = parcels_that_nearly_meet()
    elif made == "from side to side":
        lower = [box(k, 0.0, k + 1, 2.0) for k in range(5)]
        upper = [box(k + 0.4, 2.0 + 3e-9, k + 1.4, 4.0) for k in range(4)]
        rows, starts, polygons = rings_of(*lower, *upper)
    else:
        rows, starts, polygons = digitised_twice(1, 40 if made == "twice, far" else 2, 1e-9)
    low, high = rows.min(axis=0), rows.max(axis=0)
    focus = shapely.box(*(low + 0.35 * (high - low)), *(low + 0.6 * (high - low)))
    result = enlarge(rows, starts, polygons, focus, scale, growth=2.0)
    lines = with_splits(rows, starts, result)
    assert result.scale == scale and faults(result, *lines) == []
    assert verify(*lines, [[one] for one in polygons])[1:] == (0, 0, 0, True)


# ---- found by fuzzing


def test_points_that_are_one_on_the_side_of_the_frame():
    """Beside it by less than 1e-9 of the width: Triangle died of two at one place."""
    rows, starts, polygons = rings_of(*(box(-2e-8 * (k % 3), k, 50, k + 1) for k in range(80)))
    focus = shapely.box(15, 25, 35, 55)
    result = enlarge(rows, starts, polygons, focus, 2.0, growth=2.0)
    assert result.scale == 2.0
    assert not turned(result.points, result.moved, result.triangles).any()


def test_parts_of_the_focus_that_touch_at_a_vertex_move_together():
    rows, starts, polygons = grid(3)
    focus = shapely.MultiPolygon([shapely.box(0.5, 0.5, 1, 1), shapely.box(1, 1, 1.5, 1.5)])
    result = enlarge(rows, starts, polygons, focus, 1.5)
    check(rows, starts, polygons, focus, 1.5, result)
    assert result.scale == 1.5


@pytest.mark.parametrize("height", [1e-3, 1e-4, 1e-5, 1e-6])
def test_triangles_do_not_turn_over(height):
    """A sliver whose tip is pushed through its own long side: none of its edges crosses another."""
    squares = [box(x, y, x + 1, y + 1) for x in range(2) for y in range(3)]
    for at in (0.5, 0.9):
        rows, starts, polygons = rings_of(*squares, [(0, 2), (1, 2), (at, 2 + height)])
        for focus in (shapely.box(0.5, 1.7, 1.5, 2.3), shapely.box(0.9, 0.9, 1.1, 1.1)):
            for scale in (0.6, 1.5):
                result = enlarge(rows, starts, polygons, focus, scale, rule="None")
                check(rows, starts, polygons, focus, scale, result)
                assert result.scale == scale
                assert shapely.LinearRing(result.rows[starts[-2] :]).is_ccw


def test_points_that_only_rounding_keeps_apart():
    rows, starts, polygons = rings_of(
        [(0, 0), (10, 0), (10, 10), (0, 10)], [(10, 0), (20, 0), (20, 10), (10, 1e-17), (10, 0)]
    )
    focus = shapely.box(-1, -1, 4, 4)
    result = enlarge(rows, starts, polygons, focus, 1.4)
    assert result.scale == 1.4 and np.isfinite(result.rows).all()


def test_one_coordinate_beside_which_the_map_is_a_point():
    rows, starts, polygons = rings_of(box(0, 0, 10, 10), box(1e40, 0, 2e40, 10))
    with pytest.raises(Unsolvable, match="Is this coordinate right"):
        enlarge(rows, starts, polygons, shapely.box(-1, -1, 4, 4), 1.4)


def test_what_does_not_move_does_not_change_a_bit():
    rows, starts, polygons = grid(4)
    rows = rows / 7.0 + 1e7 / 3.0
    result = enlarge(rows, starts, polygons, shapely.box(*rows[5] - 0.05, *rows[5] + 0.05), 1.2)
    low, high = rows.min(axis=0), rows.max(axis=0)
    still = (rows == low) | (rows == high)
    assert still.any() and np.array_equal(result.rows[still], rows[still])


def test_a_map_that_is_flat_has_room():
    rows = np.array([(0.0, 5.0), (3.0, 5.0), (6.0, 5.0), (20.0, 5.0)])
    result = enlarge(rows, np.array([0, 4]), [], shapely.box(2, 4, 7, 6), 1.5)
    assert result.scale == 1.5 and result.rows[2, 0] - result.rows[1, 0] == pytest.approx(4.5)


def test_a_ring_that_is_mirrored_has_turned_over():
    """No edges cross in the end: what is left of the way from the input would not show it."""
    rows, starts, polygons = rings_of(
        [(-0.21, 1.37), (1.19, 0.78), (0.96, 0.36), (-0.24, -0.4)], [(-0.14, 2.34), (0.94, 1.77), (1.19, 0.78), (-0.21, 1.37)],
        [(0.28, 2.61), (1.26, 2.96), (0.94, 1.77), (-0.14, 2.34)], [(1.26, 2.96), (2.41, 3.44), (2.06, 1.69), (0.94, 1.77)],
        [(2.19, 0.88), (2.68, 1.37), (2.93, -0.15), (2.2, 0.25)], [(2.06, 1.69), (3.27, 1.84), (2.68, 1.37), (2.19, 0.88)],
    )  # fmt: skip
    focus = shapely.MultiPolygon([shapely.box(-0.47, 0.78, 0.05, 1.97), shapely.box(1.31, 1.44, 2.81, 1.95)])
    with pytest.raises(Unsolvable, match="larger than the frame"):
        enlarge(rows, starts, polygons, focus, 100.0)
    for scale in (1.3, 1.8):
        result = enlarge(rows, starts, polygons, focus, scale)
        check(rows, starts, polygons, focus, scale, result)
        for lo, hi in zip(starts[:-1], starts[1:]):
            before, after = (shapely.LinearRing(one[lo:hi]) for one in (rows, result.rows))
            assert before.is_ccw == after.is_ccw


def test_parts_of_the_focus_that_become_one_point():
    rows = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1e40, 0.0), (1e40, 1e40)])
    focus = shapely.MultiPolygon([shapely.box(-0.1, -0.1, 0.1, 0.1), shapely.box(0.9, -0.1, 1.1, 0.1)])
    with pytest.raises(Unsolvable, match="parts of the focus are one point"):
        enlarge(rows, np.arange(6), [], focus, 1.4)


def test_points_that_are_one_beside_a_wide_map():
    """Closer than the solver can tell: they move together, and keep their distance."""
    rows = np.array([(1e13, 1e4), (1e13 + 1.0, 1e4), (0.0, 2.0), (1.0, 2.0), (1.0, 1.0), (2e12, 3e12)])
    result = enlarge(rows, np.arange(7), [], shapely.box(-1e12, -1e12, 1e12, 1e12), 1.5)
    assert result.scale == 1.5
    assert result.rows[2:5] - result.rows[2] == pytest.approx(rows[2:5] - rows[2], abs=1e-2)


def test_far_from_the_origin_nothing_is_turned_by_rounding():
    """Coordinates as large as 10^6 widths tell points 10^-10 of the width apart, no less."""
    told = 0
    for seed in range(6):
        rows, starts, polygons = rings_of(tour(seed, 40).coords)
        width = np.ptp(rows, axis=0).max()
        rows = rows + 1e6 * width * np.array((0.7, -0.4))
        focus = shapely.Point(rows[5]).buffer((1e-9, 1e-8, 1e-7)[seed % 3] * width)
        try:
            result = enlarge(rows, starts, polygons, focus, 5.0, growth=2.0)
        except Unsolvable as problem:
            told += "too close to each other" in str(problem)
            continue
        assert faults(result, *with_splits(rows, starts, result)) == []
        carried = Carrier(result.points, result.moved, result.triangles)(rows)
        assert np.abs(carried - result.rows).max() < 1e-8 * width
    assert told <= 3


def test_flat_triangles_carry_nothing():
    """On three points of one line there is no telling where a point between them goes: the others do."""
    points = np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (1.0, 0.0), (3.0, 0.0), (1.0, 1.0)])
    triangles = np.array(
        [(0, 5, 6), (5, 1, 6), (1, 2, 6), (2, 3, 6), (3, 0, 6), (0, 4, 5)]
    )  # the last is flat
    moved = points * 2.0
    at = np.array([(0.5, 0.0), (1.0, 0.0), (2.0, 0.0), (1.0, 1.0), (3.9, 3.9)])
    assert np.allclose(Carrier(points, moved, triangles)(at), 2.0 * at, rtol=0, atol=1e-15)
