import sys

import numpy as np
import pytest
import shapely

from isthmus.core import metric

from isthmus.core.partition import triangulation
from isthmus.core.errors import MissingEngine, Unsolvable
from isthmus.core.partition.polygon import one as from_rings
from isthmus.core.partition.triangulation import engine_name, missing_packages

from .. import shapes
from ..stages import diagonals
from ..shapes import ENGINES, needs_triangle

CASES = {
    **shapes.TOUCHING,
    "triangle": shapes.TRIANGLE,
    "square": shapes.SQUARE,
    "dumbbell": shapes.DUMBBELL,
    "annulus": shapes.ANNULUS,
    "lattice of holes": shapes.lattice_of_holes(4),
    "circle": shapes.shape(shapes.circle(64)),
    "comb": shapes.comb(6),
    "spiral": shapes.spiral(3),
    "koch": shapes.koch(3),
    **{f"mosaic {seed}": shapes.mosaic(seed, 40) for seed in range(10)},
    **{f"lattice mosaic {seed}": shapes.mosaic(seed, 40, size=8) for seed in range(10)},
    **{f"polyomino {seed}": shapes.polyomino(seed, 6, 6, 0.75, 0.5) for seed in range(10)},
}


def check_triangulation(s, edges):
    """As many diagonals as there are in a triangulation, inside the polygon, none crossing."""
    polygon = from_rings(*s)
    n, corners, holes = len(polygon.xy), len(polygon.vertex), len(s.rings) - 1
    assert len(edges) == corners + 3 * (holes - (corners - n) - 1)
    assert (edges[:, 0] < edges[:, 1]).all()
    assert edges.tolist() == sorted(edges.tolist(), key=lambda e: (e[0], -e[1]))
    lines = shapely.linestrings(polygon.xy[edges])
    # DE-9IM: the inside of each meets neither the boundary nor the outside
    assert shapely.relate_pattern(s.polygon, lines, "1**F**F**").all()
    assert len(shapely.STRtree(lines).query(lines, predicate="crosses")[0]) == 0


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", CASES)
def test_a_triangulation(name, engine):
    check_triangulation(CASES[name], diagonals(from_rings(*CASES[name]), engine=engine))


@needs_triangle
@pytest.mark.parametrize("seed", range(20))
def test_engines_agree_where_no_four_points_are_cocircular(seed):
    for s in (shapes.tour(seed, 40), shapes.mosaic(seed, 50)):
        polygon = from_rings(*s)
        assert np.array_equal(*(diagonals(polygon, engine=engine) for engine in ("triangle", "shapely")))


@pytest.mark.parametrize("seed", range(5))
def test_delaunay(seed):
    """Of each two triangles at a diagonal, neither sees the other's corner inside its circle."""
    s = shapes.tour(seed, 30)
    polygon = from_rings(*s)
    edges = diagonals(polygon)
    n = len(polygon.xy)
    near = {v: {(v + 1) % n, (v - 1) % n} for v in range(n)}
    for u, v in edges.tolist():
        near[u].add(v)
        near[v].add(u)
    for u, v in edges.tolist():
        opposite = [w for w in near[u] & near[v]
                    if shapely.contains_properly(s.polygon.buffer(1e-6), shapely.polygons(
                        polygon.xy[[u, v, w]]))]
        angles = 0.0
        for side in (1, -1):
            seen = [w for w in opposite if side * _turn(polygon.xy, u, v, w) > 0]
            w = min(seen, key=lambda w: abs(_turn(polygon.xy, u, v, w)))
            a, b = polygon.xy[u] - polygon.xy[w], polygon.xy[v] - polygon.xy[w]
            angles += np.arctan2(abs(a[0] * b[1] - a[1] * b[0]), a @ b)
        assert angles <= np.pi + 1e-9


def _turn(xy, u, v, w):
    (ax, ay), (bx, by) = xy[v] - xy[u], xy[w] - xy[u]
    return ax * by - ay * bx


# ---------------------------------------------------------------- longitudes and latitudes

T = np.linspace(0, 1, 9)
LONLAT = {
    "oblique line": shapes.shape(np.concatenate((np.column_stack((T * 40, T * 40)), [(10, 40)]))),
    "oblique line, other side": shapes.shape(
        np.concatenate((np.column_stack((T * 40, T * 40)), [(40, 0)]))),
    "parallel": shapes.shape(np.concatenate((np.column_stack((T * 40, 0 * T + 50)), [(10, 70)]))),
    "pole": shapes.shape([(-180, -90), (180, -90), (180, -70), (90, -65), (0, -72), (-180, -70)]),
    "both poles": shapes.shape([(-180, -90), (180, -90), (180, 90), (0, 80), (-180, 90)]),
    "antimeridian": shapes.shape([(179, 10), (181, 10), (181, 12), (180, 10.5), (179, 12)]),
    "beyond the pole": shapes.shape([(0, 80), (10, 80), (10, 95), (7, 85), (0, 95)]),
    "hole at a bent edge": shapes.shape(
        [(0, 0), (60, 60), (0, 60)], [(29.5, 30), (29, 31), (29.5, 31)]),
    "two holes touch": shapes.shape(
        [(0, 0), (60, 0), (60, 80), (0, 80)], [(10, 10), (30, 40), (20, 50)],
        [(20, 25), (50, 20), (50, 50)]),
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", LONLAT)
def test_conformal_plane_or_own_plane(name, engine):
    s = LONLAT[name]
    edges = diagonals(from_rings(*s), metric.ellipsoidal().conformal, engine)
    check_triangulation(s, edges)


def test_delaunay_of_the_conformal_plane():
    """At 60 degrees a degree of longitude is half as long: another diagonal is Delaunay."""
    kite = shapes.shape([(-1.5, 60), (0, 59), (1.5, 60), (0, 61)])
    polygon = from_rings(*kite)
    ends = [
        {tuple(p) for p in polygon.xy[diagonals(polygon, conformal)[0]]}
        for conformal in (None, metric.ellipsoidal().conformal)
    ]
    assert ends == [{(0, 59), (0, 61)}, {(-1.5, 60), (1.5, 60)}]


# ---------------------------------------------------------------- what would crash the process

ULP = np.spacing(31.3)
CRASHES = {
    "values of 1e80": shapes.tour(0, 30).mapped(lambda xy: xy * 1e75),
    "values of 1e-90": shapes.tour(0, 30).mapped(lambda xy: xy * 1e-96),
    "1 and 1e-300": shapes.shape([(0, 0), (1e-300, 0), (1, 1), (0, 1), (0, 1e-300)]),
    "1e150 and 1e-170": shapes.shape([(0, 0), (1e-170, 0), (1e150, 1e150), (0, 1e-170)]),
    "latitudes that Mercator makes one": shapes.shape(
        [(0, 30), (1, 30), (1, 31.3), (1, 31.3 + ULP), (1, 31.3 + 2 * ULP), (0.2, 32), (0, 31)],
        [(0.4, 30.4), (0.4, 30.6), (0.6, 30.6), (0.6, 30.4)],
    ),
}


@needs_triangle
@pytest.mark.parametrize("name", {**CRASHES, **LONLAT, **shapes.TOUCHING})
def test_triangle_gets_only_what_it_survives(name, monkeypatch):
    """Coincident points, overflow and underflow (of products of four) are segmentation faults."""
    import triangle

    original = triangle.triangulate

    def spy(graph, options):
        points = graph["vertices"]
        assert np.isfinite(points).all()
        assert len(np.unique(points, axis=0)) == len(points)
        magnitude = np.abs(points[points != 0])
        assert 1e-70 < magnitude.min() and magnitude.max() < 1e70
        return original(graph, options)

    monkeypatch.setattr(triangle, "triangulate", spy)
    s = {**CRASHES, **LONLAT, **shapes.TOUCHING}[name]
    for conformal in (None, metric.ellipsoidal().conformal):
        polygon = from_rings(*s)
        corners, n = len(polygon.vertex), len(polygon.xy)
        holes = len(s.rings) - 1
        edges = diagonals(polygon, conformal)
        assert len(edges) == corners + 3 * (holes - (corners - n) - 1)


# ---------------------------------------------------------------- missing packages


@needs_triangle
def test_triangle_first():
    assert engine_name() == "triangle"
    assert missing_packages() == ""


def test_without_triangle(monkeypatch):
    monkeypatch.setitem(sys.modules, "triangle", None)
    assert engine_name() == "shapely"
    assert missing_packages() == ""
    check_triangulation(shapes.DUMBBELL, diagonals(from_rings(*shapes.DUMBBELL)))


def test_without_both(monkeypatch):
    monkeypatch.setitem(sys.modules, "triangle", None)
    monkeypatch.delattr(shapely, "constrained_delaunay_triangles")
    assert engine_name() == ""
    assert "triangle" in missing_packages() and "shapely 2.1" in missing_packages()
    with pytest.raises(MissingEngine, match="triangle.*shapely 2.1"):
        diagonals(from_rings(*shapes.SQUARE))


def test_shapely_1_is_said_to_be_too_old(monkeypatch):
    monkeypatch.delattr(shapely, "get_coordinates")
    assert shapely.__version__ in missing_packages()


@pytest.mark.parametrize("answer", [
    np.empty((0, 3), dtype=int),
    np.array([[0, 1, 2]]),
    np.array([[0, 1, 2], [0, 1, 2]]),
    np.array([[0, 1, 2], [0, 2, 4]]),
    np.array([[0, 2, 1], [0, 3, 2]]),
])
def test_a_wrong_answer_is_never_used(answer, monkeypatch):
    """Triangle adds vertices or gives up without a word: shapely takes over."""
    monkeypatch.setattr(triangulation, "_by_triangle", lambda job, plane, which, check: [answer])
    polygon = from_rings(*shapes.SQUARE)
    assert len(diagonals(polygon, engine="triangle")) == 1
    monkeypatch.delattr(shapely, "constrained_delaunay_triangles")
    with pytest.raises(Unsolvable, match="could not be triangulated"):
        diagonals(polygon, engine="triangle")


@pytest.mark.parametrize("size", [1e-299, 1e-120, 1e-60])
def test_degrees_too_small_for_geos(size):
    """GEOS fails on the map of a polygon with a hole that is this small."""
    s = shapes.ANNULUS.mapped(lambda xy: xy * size)
    polygon = from_rings(*s)
    assert len(diagonals(polygon, metric.ellipsoidal().conformal)) == 8
