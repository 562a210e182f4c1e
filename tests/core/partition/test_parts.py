"""Parts out of any edges at all: here no solver chooses them."""

import numpy as np
import pytest
import shapely

from isthmus.core.metric import ellipsoidal, planar
from isthmus.core.partition.solve import partition
from isthmus.core.partition.parts import build_parts, merged_parts
from isthmus.core.partition.polygon import one

from .. import shapes, stages
from ..verify import check_parts, polygons


class Result:
    """Just what `check_parts` looks at."""

    def __init__(self, s, seed=0, share=0.3):
        polygon = one(*s)
        edges = stages.diagonals(polygon)
        length = planar().length(polygon.xy, *edges.T)
        tree, walk = stages.carved(polygon, edges, length)
        chosen = np.random.default_rng(seed).random(len(edges)) < share
        chosen[tree] = True
        corner = np.empty(len(polygon.xy), dtype=int)
        corner[polygon.vertex] = np.arange(len(polygon.vertex))
        self.edge_rows = polygon.rows[polygon.row_start[corner[edges]]]
        self.role = np.where(chosen, 0, 1)
        self.parts = build_parts(polygon, walk, np.flatnonzero(chosen), tree, planar().equal_area)


CASES = {
    **shapes.TOUCHING,
    "triangle": shapes.TRIANGLE,
    "dumbbell": shapes.DUMBBELL,
    "annulus": shapes.ANNULUS,
    "lattice of holes": shapes.lattice_of_holes(3),
    **{f"mosaic {seed}": shapes.mosaic(seed, 40) for seed in range(12)},
    **{f"lattice mosaic {seed}": shapes.mosaic(seed, 40, size=8) for seed in range(12)},
    **{f"polyomino {seed}": shapes.polyomino(seed, 7, 7, 0.7, 0.4) for seed in range(12)},
}


@pytest.mark.parametrize("share", [0.0, 0.15, 0.5, 1.0])
@pytest.mark.parametrize("name", CASES)
def test_tiling(name, share):
    s = CASES[name]
    check_parts(Result(s, 7, share), s)


@pytest.mark.parametrize("name", ["mosaic 3", "touch in edge", "lattice of holes"])
def test_reversed_input_gives_reversed_parts(name):
    s = shapes.reversed_rings(CASES[name])
    result = Result(s)
    check_parts(result, s)
    input_ccw = shapely.is_ccw(shapely.LinearRing(s.rings[0]))
    for rings in result.parts.rings:
        assert shapely.is_ccw(shapely.LinearRing(s.coords[rings[0]])) == input_ccw


@pytest.mark.parametrize("seed", range(10))
def test_duplicates_and_other_ordinates_ride_along(seed):
    """Rows of one corner stay together, in their order, wherever the corner is used."""
    s = shapes.numbered(shapes.with_duplicates(shapes.mosaic(seed, 30), seed))
    result = Result(s, seed)
    check_parts(result, s)
    xy, doubled = s.coords[:, :2], 0
    for ring in (ring for rings in result.parts.rings for ring in rings):
        follows = (np.roll(xy[ring], -1, axis=0) == xy[ring]).all(axis=1)
        doubled += int(follows.sum())
        for row, after in zip(ring[follows].tolist(), np.roll(ring, -1)[follows].tolist()):
            k = np.searchsorted(s.offsets, row, side="right") - 1
            lo, size = s.offsets[k], s.offsets[k + 1] - s.offsets[k]
            assert after - lo in ((row - lo + 1) % size, (row - lo - 1) % size)
        for row in set(ring.tolist()):
            twins = _run(xy, s.offsets, row)
            assert set(twins) <= set(ring.tolist())
    assert doubled > 0


def _run(xy, offsets, row):
    """Rows at the same point just before and after one on its ring."""
    k = np.searchsorted(offsets, row, side="right") - 1
    lo, size = offsets[k], offsets[k + 1] - offsets[k]
    found = [row]
    for step in (1, -1):
        at = row
        while (xy[at] == xy[lo + (at - lo + step) % size]).all():
            at = lo + (at - lo + step) % size
            found.append(at)
    return found


def test_a_ring_that_touches_itself_becomes_shell_and_hole():
    result = Result(shapes.TOUCH_AT_VERTEX, share=0.0)
    assert [[len(ring) for ring in rings] for rings in result.parts.rings] == [[5, 3]]


def test_a_touched_edge_keeps_its_two_vertices():
    result = Result(shapes.TOUCH_IN_EDGE, share=0.0)
    assert [[len(ring) for ring in rings] for rings in result.parts.rings] == [[4, 3]]


def test_an_edge_that_only_connects_a_hole_borders_nothing():
    result = Result(shapes.ANNULUS, share=0.0)
    assert result.parts.sides.tolist() == [[0, 0]]
    assert [[len(ring) for ring in rings] for rings in result.parts.rings] == [[4, 4]]


@pytest.mark.parametrize("factor", [1e200, 1e150, 1e90, 1e-90, 1e-170])
def test_largest_first_at_extreme_values(factor):
    room = shapes.shape(
        [(0, 0), (3, 0), (3, 4), (4, 4), (4, 0), (14, 0), (14, 9), (4, 9), (4, 5), (3, 5), (3, 9), (0, 9)]
    )
    expected = [part.area for part in polygons(Result(room, 3, 0.5), room.coords)]
    assert len(set(expected)) > 3
    scaled = Result(room.mapped(lambda xy: xy * factor), 3, 0.5)
    actual = [part.area for part in polygons(scaled, room.coords)]
    assert actual == sorted(actual, reverse=True)
    assert not np.isnan(scaled.parts.area).any()


def test_no_area_is_negative():
    """A sliver that turns over in the equal-area map of the ellipsoid has an area of zero."""
    s = shapes.shape([
        (-8.893350617879417, 5.4688494939487775), (-11.13285190576362, 3.472694694950213),
        (-9.639851047174151, 4.803464560949256), (-11.960467831353565, 1.3954243996564362),
    ])  # fmt: skip
    area = partition(*s, tau=1.0, measure=ellipsoidal()).parts.area
    assert len(area) == 2 and area.min() == 0.0


@pytest.mark.parametrize("most", [1, 10**6])
@pytest.mark.parametrize("name", CASES)
def test_merged_parts_are_those_of_the_cuts_that_are_left(name, most):
    rng = np.random.default_rng(11)
    for shape in (CASES[name], shapes.reversed_rings(CASES[name])):
        polygon = one(*shape)
        edges = stages.diagonals(polygon)
        tree, walk = stages.carved(polygon, edges, planar().length(polygon.xy, *edges.T))
        free = np.setdiff1d(np.arange(len(edges)), tree)
        chosen = np.sort(np.append(tree, free[rng.random(len(free)) < 0.6]))
        some = np.isin(chosen, tree) | (rng.random(len(chosen)) < 0.4)
        finest = build_parts(polygon, walk, chosen, tree, planar().equal_area)
        wanted = build_parts(polygon, walk, chosen[some], tree, planar().equal_area)
        union = np.arange(len(finest.area))
        for a, b in finest.sides[~some]:
            union[union == union[a]] = union[b]
        names, union = np.unique(union, return_inverse=True)
        pieces = np.argsort(union, kind="stable")
        offsets = np.searchsorted(union[pieces], np.arange(len(names) + 1))
        merged = []
        for rows, rings, parts in merged_parts(
            polygon, walk, chosen, tree, finest, pieces, offsets, most=most
        ):
            own = np.split(rows, rings[1:-1])
            merged += [own[lo:hi] for lo, hi in zip(parts[:-1].tolist(), parts[1:].tolist())]

        def key(part):
            return [ring.tolist() for ring in part]

        assert sorted(map(key, merged)) == sorted(map(key, wanted.rings))
