"""NEW_VERTICES in all tools that cut: cuts that end inside edges, and what the log says without it."""

import pytest
from qgis.core import NULL, QgsGeometry

from .test_aggregation import areas, prepare, vertices
from .test_hierarchy import at, hierarchy
from .test_partition import EVERYWHERE, partition, rows

# 1 wide at x = 10, where the lower wall has no vertex; z and m tell the place
NECK = "POLYGON((0 0,20 0,20 10,11 10,10 1,9 10,0 10,0 0))"
NECK_ZM = "POLYGON ZM((0 0 5 0,20 0 9 100,20 10 9 0,11 10 7 0,10 1 7 0,9 10 7 0,0 10 5 0,0 0 5 0))"
TWICE = (
    "MULTIPOLYGON(((0 0,20 0,20 10,11 10,10 1,9 10,0 10,0 0)),"
    "((100 0,120 0,120 10,111 10,110 1,109 10,100 10,100 0)))"
)
SQUARE = "POLYGON((30 0,40 0,40 10,30 10,30 0))"


@pytest.fixture
def made(layer):
    """Make a layer of geometries."""

    def made(geometries, kind="Polygon"):
        return layer(f"{kind}?crs=EPSG:3857", [(wkt, []) for wkt in geometries])

    return made


def said(feedback):
    return [line for line in feedback.infos if "No vertex to end a cut at" in line]


@pytest.mark.parametrize("places", ["Natural", "Any"])
def test_partition_misses_the_neck_and_says_so(run, made, feedback, places):
    source = made([NECK, SQUARE])
    parts = rows(partition(run, source, feedback, PLACES=places)["OUTPUT"])
    assert len(parts) == 2
    (line,) = said(feedback)
    assert "1 place" in line and "NEW_VERTICES" in line


@pytest.mark.parametrize("places", ["Natural", "Any"])
def test_partition_finds_the_neck(run, made, feedback, places):
    source = made([NECK, SQUARE])
    results = partition(run, source, feedback, PLACES=places, NEW_VERTICES=True)
    parts = [part.geometry() for part in results["OUTPUT"].getFeatures()]
    assert sorted(part.area() for part in parts) == [95.5, 95.5, 100.0]
    (cut,) = results["CUTS"].getFeatures()
    assert {(p.x(), p.y()) for p in cut.geometry().vertices()} == {(10, 0), (10, 1)}
    assert not said(feedback)
    square = max(parts, key=lambda part: part.centroid().asPoint().x())
    assert square.asWkb() == QgsGeometry.fromWkt(SQUARE).asWkb()  # no trace of feet that no cut uses


def test_z_and_m_are_interpolated(run, made, feedback):
    source = made([NECK_ZM], "PolygonZM")
    results = partition(run, source, feedback, NEW_VERTICES=True)
    for feature in [*results["OUTPUT"].getFeatures(), *results["CUTS"].getFeatures()]:
        points = {(p.x(), p.y(), p.z(), p.m()) for p in feature.geometry().vertices()}
        (new,) = {point for point in points if point[:2] == (10, 0)}
        assert new == (10.0, 0.0, 7.0, 50.0)


def test_weights_see_the_new_lines(run, made, feedback):
    """And features of several parts, with budgets."""
    source = made([TWICE], "MultiPolygon")
    options = {"OBJECTIVE": "MinWeight", "WEIGHT": "length($geometry)", "NEW_VERTICES": True}
    results = partition(run, source, feedback, **options)
    assert results["COST"] == pytest.approx(2.0) and results["PART_COUNT"] == 4
    options = {"INPUT": source, "OUTPUT": "memory:", "CUTS": "memory:", **EVERYWHERE}
    results = run("isthmus:partitionbudget", {**options, "BUDGET": 2, "NEW_VERTICES": True}, feedback)
    assert results["CUT_COUNT"] == 2 and results["CUT_LENGTH"] == pytest.approx(2.0)
    assert not said(feedback)
    run("isthmus:partitionbudget", {**options, "BUDGET": 0}, feedback)
    assert "2 places" in said(feedback)[0]


def test_candidate_lines_have_no_new_vertices(run, made, feedback):
    lines = made(["LINESTRING(10 1,0 0)"], "LineString")
    results = partition(run, made([NECK]), feedback, CANDIDATES=lines, TAU=1, NEW_VERTICES=True)
    assert results["PART_COUNT"] == 2
    for part in results["OUTPUT"].getFeatures():
        assert (10.0, 0.0) not in {(p.x(), p.y()) for p in part.geometry().vertices()}


def test_tradeoff(run, made, feedback):
    options = {"INPUT": made([NECK]), "OUTPUT": "memory:", "TAU_MIN": 3, **EVERYWHERE}
    steps = rows(run("isthmus:tradeoff", options, feedback)["OUTPUT"])
    assert "1 place" in said(feedback)[0]
    more = rows(run("isthmus:tradeoff", {**options, "NEW_VERTICES": True}, feedback)["OUTPUT"])
    assert len(said(feedback)) == 1
    assert more[-1]["length"] == pytest.approx(1.0) and steps[-1]["length"] != pytest.approx(1.0)


def test_hierarchy(run, made, feedback):
    """A level without the cut has no vertex of it either."""
    source = made([NECK])
    hierarchy(run, source, feedback, TAU=4)
    assert "1 place" in said(feedback)[0]
    results = hierarchy(run, source, feedback, TAU=4, NEW_VERTICES=True)
    parts = rows(results["OUTPUT"])
    (cut,) = rows(results["CUTS"])
    assert len(at(parts, 4.0)) == 2 and cut["length"] == pytest.approx(1.0)
    (whole,) = at(parts, cut["persistence"] + 1.0)
    assert whole["geometry"].asWkb() == QgsGeometry.fromWkt(NECK).asWkb()
    assert whole["parent"] == NULL


def test_hierarchy_drops_a_vertex_with_its_cut(run, made, feedback):
    """Three teeth, of which one is shorter: the body that two cuts are gone from has no vertex of theirs."""
    teeth = "POLYGON((0 0,40 0,40 10,31 10,30 1,29 10,21 10,20 1.5,19 10,11 10,10 1,9 10,0 10,0 0))"
    results = hierarchy(run, made([teeth]), feedback, TAU=3, NEW_VERTICES=True)
    parts, cuts = rows(results["OUTPUT"]), rows(results["CUTS"])
    assert len(cuts) == 3
    for cut in cuts:
        tau = cut["persistence"]
        left = {
            (p.x(), p.y())
            for other in cuts
            if other["persistence"] > tau
            for p in other["geometry"].vertices()
        }
        foot = {
            (p.x(), p.y())
            for part in at(parts, tau)
            for p in part["geometry"].vertices()
            if p.y() == 0.0 and 0.0 < p.x() < 40.0
        }
        assert foot == {point for point in left if point[1] == 0.0}
        assert sum(part["geometry"].area() for part in at(parts, tau)) == pytest.approx(
            QgsGeometry.fromWkt(teeth).area()
        )


def neighbours(below="Polygon ((0 -5, 20 -5, 20 0, 0 0, 0 -5))"):
    return [("Polygon ((0 0, 20 0, 20 10, 11 10, 10 1, 9 10, 0 10, 0 0))", "1"), (below, "2")]


def test_neighbours_in_a_coverage_get_the_vertex(qgis_app):
    results, layers, told = prepare(areas(neighbours()))
    assert results["PIECE_COUNT"] == 2
    assert any("No vertex to end a cut at: 1 place" in line for line in told)
    results, layers, told = prepare(areas(neighbours()), NEW_VERTICES=True)
    pieces = {piece["area_id"]: piece.geometry() for piece in layers["OUTPUT"]}
    assert results["PIECE_COUNT"] == 3
    assert (results["OVERLAP_COUNT"], results["GAP_COUNT"]) == (0, 0)
    assert (10.0, 0.0) in {(x, y) for x, y, _ in vertices(pieces[2])}
    shared = sorted((row["a"], row["b"], row["length"]) for row in layers["ADJACENCY"] if not row["virtual"])
    assert [length for _, _, length in shared] == [10.0, 10.0]


def slanted(wkt, angle=0.3, scale=317.0):
    """Turned and moved, so that feet are not on their edges to the last bit."""
    geometry = QgsGeometry.fromWkt(wkt)
    from qgis.PyQt.QtGui import QTransform

    geometry.transform(QTransform().translate(4321.7, 8765.1).rotateRadians(angle).scale(scale, scale))
    return geometry.asWkt(17)


def directed(geometry):
    """Directed edges of the rings, the shell counter-clockwise."""
    points = [(p.x(), p.y()) for p in geometry.constGet().exteriorRing().points()]
    if geometry.constGet().exteriorRing().orientation() == 1:  # clockwise
        points = points[::-1]
    steps = list(zip(points[:-1], points[1:]))
    assert points[0] == points[-1]
    return steps


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.1, 2.7])
def test_both_sides_of_a_wall(qgis_app, angle):
    """Necks on both sides, at the same place, near it and elsewhere: the boundary is shared bit for bit."""
    for other in ((10.0, 1.0), (10.0 + 1e-10, 2.0), (7.0, 1.5)):
        x, depth = other
        below = f"Polygon ((0 0, 0 -10, {x - 1} -10, {x!r} {-depth}, {x + 1} -10, 20 -10, 20 0, 0 0))"
        rows_ = [(slanted(wkt, angle), code) for wkt, code in neighbours(below)]
        results, layers, _ = prepare(areas(rows_), NEW_VERTICES=True)
        assert results["PIECE_COUNT"] == 4
        edges = [edge for piece in layers["OUTPUT"] for edge in directed(piece.geometry())]
        assert len(set(edges)) == len(edges)
        inner = [edge for edge in edges if edge[::-1] in edges]
        # two cuts, and the wall in two or three pieces
        assert len(inner) == 2 * (2 + (2 if abs(x - 10) < 1 else 3))
        assert (results["OVERLAP_COUNT"], results["GAP_COUNT"]) == (0, 0)
        assert all(piece.geometry().isGeosValid() for piece in layers["OUTPUT"])


def test_neighbours_keep_their_own_heights(qgis_app):
    """x and y are the same; z is that of the neighbour's edge, to the bit where the two agree."""
    mine = "PolygonZ ((0 0 5, 20 0 9, 20 10 9, 11 10 7, 10 1 7, 9 10 7, 0 10 5, 0 0 5))"
    for z, expected in (((5, 9), 7.0), ((0, 1), 0.5)):
        below = f"PolygonZ ((0 0 {z[0]}, 0 -5 0, 20 -5 0, 20 0 {z[1]}, 0 0 {z[0]}))"
        _, layers, _ = prepare(areas([(mine, "1"), (below, "2")], kind="PolygonZ"), NEW_VERTICES=True)
        pieces = [piece for piece in layers["OUTPUT"] if piece["area_id"] == 2]
        assert (10.0, 0.0, expected) in vertices(pieces[0].geometry())
