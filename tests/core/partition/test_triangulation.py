import sys
from fractions import Fraction

import numpy as np
import pytest
import shapely

from isthmus.core import metric

from isthmus.core.partition import engines
from isthmus.core.errors import MissingEngine, Unsolvable
from isthmus.core.partition.polygon import one as from_rings
from isthmus.core.partition.triangulation import (
    _bent,
    _same_sides,
    engine_name,
    missing_packages,
    triangulate,
)
from isthmus.core.predicates import orientations

from .. import shapes
from ..shapes import ENGINES, INSTALLED, needs
from ..stages import diagonals

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
def test_a_triangulation(name, engine, monkeypatch):
    monkeypatch.setenv("ISTHMUS_ENGINE", engine)  # no other may take over
    check_triangulation(CASES[name], diagonals(from_rings(*CASES[name]), engine=engine))


@pytest.mark.skipif(len(INSTALLED) < 2, reason="there is only one engine")
@pytest.mark.parametrize("seed", range(20))
def test_engines_agree_where_no_four_points_are_cocircular(seed):
    for s in (shapes.tour(seed, 40), shapes.mosaic(seed, 50)):
        polygon = from_rings(*s)
        first, *others = (diagonals(polygon, engine=engine) for engine in INSTALLED)
        assert all(np.array_equal(first, other) for other in others)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", CASES)
def test_delaunay(name, engine, monkeypatch):
    """No triangle sees the corner of its neighbour inside its circle; exact, of many collinear points too.

    But that of shapely 2.2 (GEOS 3.14) only up to rounding.
    """
    monkeypatch.setenv("ISTHMUS_ENGINE", engine)
    polygon = from_rings(*CASES[name])
    found, *_ = triangulate(polygon, engine=engine)
    opposite = {}
    for corners in found.tolist():
        for k in range(3):
            opposite[corners[k], corners[k - 2]] = corners[k - 1]
    assert len(opposite) == 3 * len(found)
    points = [tuple(map(Fraction, point)) for point in polygon.xy.tolist()]
    slack = Fraction(1, 10**12) if engine == "shapely" else 0
    assert not any(
        _in_circle(points[a], points[b], points[c], points[opposite[b, a]], slack)
        for (a, b), c in opposite.items()
        if (b, a) in opposite
    )


def _in_circle(a, b, c, d, slack):
    """Whether d is inside the circle through a, b, c, which turn left, by more than a share of what is added up."""
    (ax, ay), (bx, by), (cx, cy) = ((x - d[0], y - d[1]) for x, y in (a, b, c))
    turn = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    assert turn > 0
    terms = (
        (ax * ax + ay * ay) * (bx * cy - cx * by),
        -(bx * bx + by * by) * (ax * cy - cx * ay),
        (cx * cx + cy * cy) * (ax * by - bx * ay),
    )
    return sum(terms) > slack * sum(map(abs, terms))


# ---------------------------------------------------------------- longitudes and latitudes

T = np.linspace(0, 1, 9)
LONLAT = {
    "oblique line": shapes.shape(np.concatenate((np.column_stack((T * 40, T * 40)), [(10, 40)]))),
    "oblique line, other side": shapes.shape(np.concatenate((np.column_stack((T * 40, T * 40)), [(40, 0)]))),
    "parallel": shapes.shape(np.concatenate((np.column_stack((T * 40, 0 * T + 50)), [(10, 70)]))),
    "pole": shapes.shape([(-180, -90), (180, -90), (180, -70), (90, -65), (0, -72), (-180, -70)]),
    "both poles": shapes.shape([(-180, -90), (180, -90), (180, 90), (0, 80), (-180, 90)]),
    "antimeridian": shapes.shape([(179, 10), (181, 10), (181, 12), (180, 10.5), (179, 12)]),
    "beyond the pole": shapes.shape([(0, 80), (10, 80), (10, 95), (7, 85), (0, 95)]),
    "hole at a bent edge": shapes.shape([(0, 0), (60, 60), (0, 60)], [(29.5, 30), (29, 31), (29.5, 31)]),
    "two holes touch": shapes.shape(
        [(0, 0), (60, 0), (60, 80), (0, 80)], [(10, 10), (30, 40), (20, 50)], [(20, 25), (50, 20), (50, 50)]
    ),
}


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", LONLAT)
def test_conformal_plane_or_own_plane(name, engine):
    s = LONLAT[name]
    edges = diagonals(from_rings(*s), metric.ellipsoidal().conformal, engine)
    check_triangulation(s, edges)


@pytest.mark.parametrize("gap, crosses", [(0.1, False), (1e-3, True), (1e-9, True)])
def test_a_ring_that_crosses_itself_in_the_conformal_plane(gap, crosses):
    """Its long edge is straight in degrees and in the plane: not the same line, with a corner between them."""
    ring = [(0, 50), (2, 52), (1.2, 52), (1 - gap, 51 + gap), (0, 50.6)]
    polygon = from_rings(*shapes.shape(ring))
    conformal = metric.ellipsoidal().conformal
    plane, survives = _bent(polygon, conformal)
    assert shapely.is_valid(shapely.Polygon(plane[polygon.vertex])) == survives[0] == (not crosses)
    assert len(diagonals(polygon, conformal)) == 2


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
    "1e140 and 1e-160": shapes.shape([(0, 0), (1e-160, 0), (1e140, 1e140), (0, 1e-160)]),
    "latitudes that Mercator makes one": shapes.shape(
        [(0, 30), (1, 30), (1, 31.3), (1, 31.3 + ULP), (1, 31.3 + 2 * ULP), (0.2, 32), (0, 31)],
        [(0.4, 30.4), (0.4, 30.6), (0.6, 30.6), (0.6, 30.4)],
    ),
}


ONLY_SHAPELY = ("1 and 1e-300", "1e140 and 1e-160")
HARD = {**CRASHES, **LONLAT, **shapes.TOUCHING}


def check_points(points):
    """What Triangle crashes on and CDT hangs on: coincident points, underflow of products of four."""
    assert np.isfinite(points).all()
    assert len(np.unique(points, axis=0)) == len(points)
    magnitude = np.abs(points[points != 0])
    assert 1e-70 < magnitude.min() and magnitude.max() < 1e70


def check_count(name, engine):
    s = HARD[name]
    for conformal in (None, metric.ellipsoidal().conformal):
        polygon = from_rings(*s)
        if name in ONLY_SHAPELY and "shapely" not in INSTALLED:
            with pytest.raises(Unsolvable, match="too fine"):
                diagonals(polygon, conformal, engine)
            continue
        corners, n = len(polygon.vertex), len(polygon.xy)
        holes = len(s.rings) - 1
        edges = diagonals(polygon, conformal, engine)
        assert len(edges) == corners + 3 * (holes - (corners - n) - 1)


@needs["triangle"]
@pytest.mark.parametrize("name", HARD)
def test_triangle_gets_only_what_it_survives(name, monkeypatch):
    import triangle

    original = triangle.triangulate

    def spy(graph, options):
        check_points(graph["vertices"])
        return original(graph, options)

    monkeypatch.setattr(triangle, "triangulate", spy)
    check_count(name, "triangle")


@needs["pythoncdt"]
@pytest.mark.parametrize("name", HARD)
def test_cdt_gets_only_what_it_survives(name, monkeypatch):
    import pythoncdt

    class Spy(pythoncdt.Triangulation):
        def insert_vertices(self, points):
            check_points(points)
            super().insert_vertices(points)

    monkeypatch.setattr(pythoncdt, "Triangulation", Spy)
    check_count(name, "pythoncdt")


# ---------------------------------------------------------------- many polygons at once


@pytest.mark.parametrize("engine", ENGINES)
def test_a_polygon_does_not_depend_on_its_neighbours(engine):
    """Some share all their points, some fail; nothing but the numbers of the vertices may differ."""
    polygons = [from_rings(*s) for s in CASES.values()] * 2
    turned = from_rings(*shapes.DUMBBELL)
    polygons += [turned._replace(xy=turned.xy[::-1])] * 2
    polygons.append(polygons[3]._replace(xy=polygons[3].xy * 1e-100))
    order = np.random.default_rng(1).permutation(len(polygons))
    polygons = [polygons[k] for k in order]
    ends = [np.column_stack((p.vertex, p.vertex[p.next_corner])) for p in polygons]
    shift = np.cumsum([0] + [len(p.xy) for p in polygons])
    found, offsets = engines.triangulate(
        engine,
        np.concatenate([p.xy for p in polygons]),
        shift,
        np.concatenate([one + first for one, first in zip(ends, shift)]),
        np.cumsum([0] + [len(one) for one in ends]),
    )
    for k, polygon in enumerate(polygons):
        alone, _ = engines.triangulate(engine, polygon.xy, [0, len(polygon.xy)], ends[k], [0, len(ends[k])])
        assert np.array_equal(found[offsets[k] : offsets[k + 1]] - shift[k], alone)
    assert len(engines.triangulate(engine, np.empty((0, 2)), [0], np.empty((0, 2), int), [0])[0]) == 0


TOO_CLOSE = 1.0 + np.array([[11, 4], [-17.5, 12], [6, -7.5], [8, 5], [4, 0]]) * 2.0**-52


@needs["triangle"]
def test_triangle_itself_answers_as_its_package_does(monkeypatch):
    """Also where its own checks fail, and after that."""
    if not engines._library():
        pytest.skip("this package of Triangle can only be called as a package")
    polygons = [from_rings(*s) for s in CASES.values()]
    ends = [np.column_stack((p.vertex, p.vertex[p.next_corner])) for p in polygons]
    xy = [p.xy for p in polygons]
    place = len(xy) // 2
    xy.insert(place, TOO_CLOSE)
    ends.insert(place, np.column_stack((np.arange(5), [1, 2, 3, 4, 0])))
    shift = np.cumsum([0] + [len(one) for one in xy])
    given = (
        "triangle",
        np.concatenate(xy),
        shift,
        np.concatenate([one + first for one, first in zip(ends, shift)]),
        np.cumsum([0] + [len(one) for one in ends]),
    )
    itself = engines.triangulate(*given)
    turned = engines.triangulate("triangle", *map(np.asfortranarray, given[1:]))
    assert all(map(np.array_equal, itself, turned)), "it depends on how arrays lie in memory"
    monkeypatch.setattr(engines, "_library", lambda: None)
    package = engines.triangulate(*given)
    assert all(map(np.array_equal, itself, package))
    assert np.flatnonzero(np.diff(itself[1]) == 0).tolist() == [place]
    assert any(len(p.offsets) > 2 for p in polygons), "none with a hole"


@needs["pythoncdt"]
@pytest.mark.parametrize(
    "ring",
    [
        [(0, 0), (4, 0), (4, 4), (2, -1), (0, 4)],  # crosses itself
        [(0, 0), (4, 0), (4, 4), (4, 4), (0, 4)],  # a point twice
        [(0, 0), (0, 4), (4, 4), (4, 0)],  # the wrong way round: open to the outside
        [(0, 0), (2, 0), (4, 0), (6, 0)],  # flat
    ],
)
def test_cdt_has_no_answer_for_what_is_no_polygon(ring):
    """And those before and after it keep theirs."""
    rings = [shapes.box(0, 0, 3, 2), ring, shapes.box(0, 0, 2, 3)]
    offsets = np.cumsum([0] + [len(one) for one in rings])
    ends = [np.column_stack((one, np.roll(one, -1))) for one in map(np.arange, offsets[:-1], offsets[1:])]
    _, found = engines.triangulate(
        "pythoncdt", np.concatenate(rings).astype(float), offsets, np.concatenate(ends), offsets
    )
    assert found.tolist() == [0, 2, 2, 4]


# ---------------------------------------------------------------- missing packages


@pytest.fixture
def without(monkeypatch):
    """Hide engines; what ISTHMUS_ENGINE asks for does not count."""
    monkeypatch.delenv("ISTHMUS_ENGINE", raising=False)

    def hide(*names):
        for name in names:
            if name == "shapely":
                monkeypatch.delattr(shapely, "constrained_delaunay_triangles", raising=False)
            else:
                monkeypatch.setitem(sys.modules, name, None)

    return hide


def test_the_first_engine_that_is_there():
    assert engine_name() == INSTALLED[0]
    assert engines.engine_names() == INSTALLED
    assert missing_packages() == ""


@needs["shapely"]
def test_shapely_alone(without):
    without("triangle", "pythoncdt")
    assert engine_name() == "shapely"
    assert missing_packages() == ""
    check_triangulation(shapes.DUMBBELL, diagonals(from_rings(*shapes.DUMBBELL)))


def test_without_all(without):
    without("triangle", "pythoncdt", "shapely")
    assert engine_name() == ""
    assert "pythoncdt" in missing_packages() and "shapely 2.1" in missing_packages()
    with pytest.raises(MissingEngine, match="triangle.*shapely 2.1"):
        diagonals(from_rings(*shapes.SQUARE))


def test_one_engine_alone_by_the_environment(monkeypatch):
    for name in INSTALLED:
        monkeypatch.setenv("ISTHMUS_ENGINE", name)
        assert engines.engine_names() == [name]
    monkeypatch.setenv("ISTHMUS_ENGINE", "abacus")
    assert engine_name() == ""
    assert "ISTHMUS_ENGINE" in missing_packages() and "abacus" in missing_packages()


def test_shapely_1_is_said_to_be_too_old(monkeypatch):
    monkeypatch.delattr(shapely, "get_coordinates")
    assert shapely.__version__ in missing_packages()


@pytest.mark.skipif(len(INSTALLED) < 2, reason="there is only one engine")
@pytest.mark.parametrize(
    "answer",
    [
        np.empty((0, 3), dtype=int),
        np.array([[0, 1, 2]]),
        np.array([[0, 1, 2], [0, 1, 2]]),
        np.array([[0, 2, 1], [0, 3, 2]]),
    ],
)
def test_a_wrong_answer_is_never_used(answer, monkeypatch):
    """Engines give up without a word: the next takes over, and in the end none."""
    real, failing = engines.triangulate, []

    def triangulate(engine, *arguments, **more):
        if engine in failing:
            return answer, np.array([0, len(answer)])
        return real(engine, *arguments, **more)

    monkeypatch.setattr(engines, "triangulate", triangulate)
    polygon = from_rings(*shapes.SQUARE)
    for engine in INSTALLED:
        assert len(diagonals(polygon)) == 1
        failing.append(engine)
    with pytest.raises(Unsolvable, match="could not be triangulated"):
        diagonals(polygon)


@needs["triangle"]
def test_vertices_that_triangle_adds_are_no_answer(monkeypatch):
    import triangle

    polygon = from_rings(*shapes.SQUARE)
    monkeypatch.setattr(triangle, "triangulate", lambda *_: {"triangles": np.array([[0, 1, 2], [0, 2, 4]])})
    monkeypatch.setattr(engines, "_library", lambda: None)
    ends = np.column_stack((np.arange(8), [1, 2, 3, 0, 5, 6, 7, 4]))
    found, offsets = engines.triangulate(
        "triangle", np.concatenate((polygon.xy, polygon.xy)), [0, 4, 8], ends, [0, 4, 8]
    )
    assert len(found) == 0 and offsets.tolist() == [0, 0, 0]


@pytest.mark.parametrize("size", [1e-299, 1e-120, 1e-60])
def test_degrees_too_small_for_geos(size):
    """GEOS fails on the map of a polygon with a hole that is this small."""
    s = shapes.ANNULUS.mapped(lambda xy: xy * size)
    polygon = from_rings(*s)
    assert len(diagonals(polygon, metric.ellipsoidal().conformal)) == 8


@pytest.mark.parametrize("seed", range(10))
def test_sides_in_another_plane_against_exact_orientations(seed):
    """Most of the groups have one triangle that is turned round, some a flat one; each group by itself."""
    rng = np.random.default_rng(seed)
    xy = rng.integers(0, 9, (60, 2)) + rng.choice([0.0, 1e6, -3e5], 2)
    triangles = rng.integers(0, 60, (300, 3))
    sign = orientations(*(xy[k] for k in triangles.T))
    triangles[sign < 0] = triangles[sign < 0][:, ::-1]
    triangles = triangles[sign != 0]
    turned = rng.random(len(triangles)) < 0.2
    triangles[turned] = triangles[turned][:, ::-1]
    triangles[::31, 2] = triangles[::31, 1]
    offsets = np.sort(np.append([0, len(triangles)], rng.integers(0, len(triangles), 60)))
    left = orientations(*(xy[k] for k in triangles.T)) > 0
    expected = [left[lo:hi].all() for lo, hi in zip(offsets[:-1], offsets[1:])]
    assert 10 < sum(expected) < 60
    assert _same_sides(xy, triangles, offsets).tolist() == expected
