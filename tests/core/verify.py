"""What must hold for every result, checked without the solver's own data structures."""

from collections import Counter

import numpy as np
import pytest
import shapely

from . import checker
from isthmus.core.partition.min_size import SELF
from isthmus.core.partition.solve import partition

CLOSE = 1e-9  # relative


def solve(shape, tau=4.0, **options):
    return partition(shape.coords, shape.offsets, tau, **options)


def polygons(result, coords):
    """The parts as shapely polygons."""
    return [
        shapely.Polygon(coords[rings[0], :2], [coords[ring, :2] for ring in rings[1:]])
        for rings in result.parts.rings
    ]


def cut_pairs(result, coords):
    """Selected edges as unordered pairs of points."""
    rows = result.edge_rows[result.role == SELF]
    return {frozenset((tuple(coords[u, :2]), tuple(coords[v, :2]))) for u, v in rows}


def selected_edges(result):
    return result.edges[result.role == SELF]


def check_everything(result, shape, tau, min_length=0.0, min_hole=0.0):
    """All that is guaranteed for a planar polygon, tau and the two floors."""
    check_parts(result, shape)
    check_dilations(result, tau, min_length)
    if min_hole == 0.0:
        check_no_cut_needless(result, tau, min_length)


def check_parts(result, shape):
    """Valid parts that tile the polygon edge by edge, out of the input's own rows."""
    coords = shape.coords
    parts = polygons(result, coords)
    assert all(shapely.is_valid(part) for part in parts)

    area = [part.area for part in parts]
    assert np.allclose(result.parts.area, area, rtol=1e-9, atol=1e-12 * sum(area))
    assert sum(area) == approx(shape.polygon.area)
    assert (np.diff(result.parts.area) <= 0).all(), "largest first"
    difference = shapely.symmetric_difference(shapely.union_all(parts), shape.polygon)
    assert difference.area <= 1e-9 * sum(area)

    used = np.concatenate([np.concatenate(rings) for rings in result.parts.rings])
    assert used.dtype.kind == "i" and used.min() >= 0
    assert set(used.tolist()) == set(range(len(coords))), "a vertex was lost"
    check_half_edges(result, shape)


def check_half_edges(result, shape):
    """Each polygon edge borders one part, and each cut the two parts that it names."""
    points = np.unique(shape.coords[:, :2], axis=0)
    forward = -1 if not shapely.is_ccw(shapely.LinearRing(shape.rings[0][:, :2])) else 1

    expected = Counter()
    for number, ring in enumerate(shape.rings):
        ring = ring[:, :2]
        ccw = shapely.is_ccw(shapely.LinearRing(ring))
        expected.update(_steps(ring if ccw == (number == 0) else ring[::-1], points))
    part_of = {}
    for number, rings in enumerate(result.parts.rings):
        for place, ring in enumerate(rings):
            xy = shape.coords[ring[::forward], :2]
            assert shapely.is_ccw(shapely.LinearRing(xy)) == (place == 0)
            for step in _steps(xy, points):
                assert step not in part_of, "two parts on one side of an edge"
                part_of[step] = number

    rows = result.edge_rows[result.role == SELF]
    assert len(rows) == len(result.parts.sides)
    for (u, v), (a, b) in zip(rows, result.parts.sides.tolist()):
        u, v = tuple(shape.coords[u, :2]), tuple(shape.coords[v, :2])
        if a != b:
            assert {part_of[u, v], part_of[v, u]} == {a, b}
            expected.update([(u, v), (v, u)])
        else:
            assert (u, v) not in part_of and (v, u) not in part_of
    assert Counter(part_of.keys()) == expected


def check_dilations(result, tau, min_length=0.0):
    """The result's own numbers against shortest paths in P and in P and S."""
    xy, rings = result.polygons.xy, vertex_rings(result)
    bounded = result.length >= min_length
    selected = result.role == SELF

    before = checker.dilations(xy, rings, np.empty((0, 2), int), result.edges)
    assert_close(result.detour, before)

    after = checker.dilations(xy, rings, result.edges[selected], result.edges)
    assert (after[bounded] <= tau * (1 + CLOSE)).all(), "not a solution"
    assert result.largest_dilation == approx(after[bounded].max(initial=1.0))
    if result.dilation is not None:
        assert_close(result.dilation, after)


def check_no_cut_needless(result, tau, min_length=0.0):
    """Without any one of the cuts, some candidate is beyond tau, or a ring apart from the rest."""
    xy, rings = result.polygons.xy, vertex_rings(result)
    bounded = result.length >= min_length
    selected = np.flatnonzero(result.role == SELF)
    for s in selected:
        others = result.edges[selected[selected != s]]
        asked = result.edges[np.append(s, np.flatnonzero(bounded))]
        dilation = checker.dilations(xy, rings, others, asked)
        assert np.isinf(dilation[0]) or dilation[1:].max(initial=0.0) > tau * (1 - CLOSE)


def vertex_rings(result):
    polygon = result.polygons
    return [polygon.vertex[lo:hi] for lo, hi in zip(polygon.offsets[:-1], polygon.offsets[1:])]


def approx(value):
    return pytest.approx(value, rel=CLOSE)


def assert_close(actual, expected):
    finite = np.isfinite(expected)
    assert (np.isfinite(actual) == finite).all()
    assert np.allclose(actual[finite], expected[finite], rtol=CLOSE, atol=0)


def _steps(ring, points):
    """Directed edges of a ring, split where another of the points lies on them."""
    corners = [p for k, p in enumerate(map(tuple, ring)) if p != tuple(ring[k - 1])]
    steps = []
    for a, b in zip(corners, corners[1:] + corners[:1]):
        chain = [a] + _on_segment(points, a, b) + [b]
        steps += zip(chain[:-1], chain[1:])
    return steps


def _on_segment(points, a, b):
    """Points inside the segment a-b, in order; exact for integers below 2^26."""
    a, b = np.array(a), np.array(b)
    ahead, d = points - a, b - a
    cross = ahead[:, 0] * d[1] - ahead[:, 1] * d[0]
    # both by the same sums: a product of matrices may round otherwise than one of vectors
    dot, whole = (ahead * d).sum(axis=1), (d * d).sum()
    found = points[(cross == 0) & (dot > 0) & (dot < whole)]
    return [tuple(p) for p in found[np.argsort(np.abs(found - a).sum(axis=1))]]
