"""The tool isthmus:focusmap, as QGIS runs it."""

import builtins
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("qgis.core")
pytest.importorskip("scipy")

from qgis.core import (
    QgsApplication,
    QgsGeometry,
    QgsLineString,
    QgsPoint,
    QgsPolygon,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingModelAlgorithm,
    QgsProcessingUtils,
    QgsProject,
    QgsVectorLayer,
)

TOOL = "isthmus:focusmap"

# a square of side 10, joined with a tall rectangle by a corridor of width 1, and an island
DUMBBELL = "0 0, 10 0, 10 4, 20 4, 20 -10, 30 -10, 30 20, 20 20, 20 5, 10 5, 10 10, 0 10, 0 0"
ISLAND = "14 7, 16 7, 15 9, 14 7"


@pytest.fixture
def land(layer):
    return layer("Polygon?crs=EPSG:3035&field=name:string&field=n:integer", [
        (f"POLYGON(({DUMBBELL}))", ["dumbbell", 1]), (f"POLYGON(({ISLAND}))", ["island", 2]),
        (None, ["nothing", 3]),
    ])  # fmt: skip


@pytest.fixture
def focus(layer):
    return layer("Polygon?crs=EPSG:3035", [("POLYGON((-1 -1, 11 -1, 11 11, -1 11, -1 -1))", [])])


def features(results, name="OUTPUT"):
    return list(results[name].getFeatures())


def points(geometry):
    return np.array([(v.x(), v.y()) for v in geometry.vertices()])


def parameters(land, focus, **more):
    return {"INPUT": land, "FOCUS": focus, "SCALE": 1.3, "GROWTH": 0, "OUTPUT": "memory:", **more}


def test_map(run, land, focus, feedback):
    results = run(TOOL, parameters(land, focus, EDGES_USED="memory:"), feedback)
    found = features(results)
    assert [f["name"] for f in found] == ["dumbbell", "island", "nothing"]
    assert [f["n"] for f in found] == [1, 2, 3]
    assert not found[2].hasGeometry()
    before, after = (points(next(land.getFeatures()).geometry()), points(found[0].geometry()))
    inside = before[:, 0] <= 10.0
    assert np.allclose(after[inside] - after[0], 1.3 * (before[inside] - before[0]), atol=1e-8)
    for feature in found[:2]:
        assert feature.geometry().isGeosValid()
        box = feature.geometry().boundingBox()
        assert box.xMinimum() >= -1e-9 and box.xMaximum() <= 30 + 1e-9
        assert box.yMinimum() >= -10 - 1e-9 and box.yMaximum() <= 20 + 1e-9
    assert results["SCALE_REACHED"] == 1.3 and results["CROSSINGS"] == 0
    assert results["PROBLEM"] == "" and results["SECONDS"] > 0
    assert 0 <= results["FLIPPED_AREA"] < 1
    assert 0 < results["MEDIAN_DISTORTION"] <= results["HIGH_DISTORTION"] < 180
    edges = features(results, "EDGES_USED")
    assert len(edges) == results["EDGE_COUNT"] > 0
    assert {edge["kind"] for edge in edges} == {"selected", "join"}
    assert feedback.shares == sorted(feedback.shares) and feedback.shares[-1] == 100


def test_scale_one_is_the_identity(run, land, focus):
    results = run(TOOL, parameters(land, focus, SCALE=1.0))
    for before, after in zip(land.getFeatures(), features(results)):
        assert before.geometry().asWkb() == after.geometry().asWkb()


@pytest.mark.parametrize("rule", ["MinSize", "MinLength", "Greedy", "Proximity", "None"])
def test_rules(run, land, focus, rule):
    results = run(TOOL, parameters(land, focus, SELECTION=rule, EDGES_USED="memory:"))
    kinds = [edge["kind"] for edge in features(results, "EDGES_USED")]
    assert ("selected" in kinds) == (rule in ("MinSize", "MinLength", "Greedy"))  # no way of 8 segments here
    assert results["CROSSINGS"] == 0


@pytest.mark.parametrize("rule", ["MinSize", "MinLength"])
@pytest.mark.parametrize("places, smallest", [("Natural", 1), ("Natural", 60), ("Any", 0)])
def test_selected_edges_are_the_cuts_of_the_partition_tool(run, land, focus, rule, places, smallest):
    asked = {"PLACES": places, "SMALLEST_PART": smallest, "TAU": 1}
    cuts = run("isthmus:partition", {
        "INPUT": land, "OBJECTIVE": rule, **asked, "OUTPUT": "memory:", "CUTS": "memory:",
    })["CUTS"]  # fmt: skip
    results = run(TOOL, parameters(land, focus, SELECTION=rule, **asked, EDGES_USED="memory:"))
    edges = [edge for edge in features(results, "EDGES_USED") if edge["kind"] == "selected"]
    lengths = sorted(cut.geometry().length() for cut in cuts.getFeatures())
    assert sorted(edge["length"] for edge in edges) == pytest.approx(lengths)
    assert len(edges) == {60: 0, 1: 2}[smallest] if smallest else len(edges) > 2


def test_cuts_of_the_partition_tool_as_edges(run, land, focus, layer, feedback):
    cuts = run(
        "isthmus:partition",
        {
            "INPUT": land,
            "TAU": 2,
            "PLACES": "Any",
            "SMALLEST_PART": 0,
            "OUTPUT": "memory:",
            "CUTS": "memory:",
        },
    )
    lines = cuts["CUTS"]
    results = run(TOOL, parameters(land, focus, EDGES=lines, EDGES_USED="memory:"), feedback)
    kinds = [edge["kind"] for edge in features(results, "EDGES_USED")]
    assert kinds.count("given") == lines.featureCount() > 0 and not feedback.warnings
    stray = layer("LineString?crs=EPSG:3035", [("LINESTRING(1 1, 2 2)", [])])
    run(TOOL, parameters(land, focus, EDGES=stray), feedback)
    assert any("1 of 1 relevant edges were left out" in text for text in feedback.warnings)


def test_carried_layers(run, land, focus, layer, tmp_path):
    towns = layer("Point?crs=EPSG:4326&field=name:string", [])
    from qgis.core import QgsCoordinateReferenceSystem, QgsCoordinateTransform, QgsProject

    corner = QgsGeometry.fromWkt("POINT(10 4)")
    corner.transform(QgsCoordinateTransform(
        QgsCoordinateReferenceSystem("EPSG:3035"), towns.crs(), QgsProject.instance()
    ))  # fmt: skip
    towns = layer("Point?crs=EPSG:4326&field=name:string", [(corner, ["corner"])])
    rivers = layer("LineStringZM?crs=EPSG:3035&field=name:string", [
        ("LINESTRING ZM(2 2 7 8, 10 4 1 2, 500 500 3 4)", ["river"]), (None, ["dry"]),
    ])  # fmt: skip
    path = str(tmp_path / "carried.gpkg")
    results = run(TOOL, parameters(land, focus, ALONG=[towns, rivers], CARRIED=path))
    assert len(results["CARRIED_LAYERS"]) == 2
    town, river = (QgsVectorLayer(address, "", "ogr") for address in results["CARRIED_LAYERS"])
    assert town.crs().authid() == river.crs().authid() == "EPSG:3035"
    moved = points(features(results)[0].geometry())[2]
    assert np.allclose(points(next(town.getFeatures()).geometry())[0], moved, atol=0.01)  # there and back
    line, dry = river.getFeatures()
    assert (line["name"], dry["name"]) == ("river", "dry") and dry.geometry().isEmpty()
    heights = np.array([(v.z(), v.m()) for v in line.geometry().vertices()])
    assert heights[[0, 1, -1]].tolist() == [[7, 8], [1, 2], [3, 4]]
    assert (np.diff(heights[1:], axis=0) > 0).all()  # where it bends, between those of its ends
    assert np.allclose(points(line.geometry())[1], moved, atol=1e-8)
    assert np.allclose(points(line.geometry())[-1], (500, 500), atol=1e-6)


def test_towns_stay_on_their_road(run, land, focus, layer, tmp_path):
    """A straight road through the region bends there, and no province gets a gap to the next."""
    at = np.linspace(-5.0, 35.0, 401)[1:-1]
    towns = layer("Point?crs=EPSG:3035", [(f"POINT({x!r} {x / 4 + 1!r})", []) for x in at.tolist()])
    road = layer("MultiLineString?crs=EPSG:3035", [("MULTILINESTRING((35 9.75, -5 -0.25), (1 1, 2 2))", [])])
    provinces = layer("Polygon?crs=EPSG:3035", [
        ("POLYGON((0 -10, 30 20, 30 -10, 0 -10))", []), ("POLYGON((0 -10, 0 20, 30 20, 0 -10))", []),
    ])  # fmt: skip
    more = {"ALONG": [towns, road, provinces], "CARRIED": str(tmp_path / "carried.gpkg")}
    results = run(TOOL, parameters(land, focus, **more))
    towns, road, provinces = (
        [f.geometry() for f in QgsVectorLayer(address, "", "ogr").getFeatures()]
        for address in results["CARRIED_LAYERS"]
    )
    assert len(towns) == len(at) and max(town.distance(road[0]) for town in towns) < 1e-9 * 30
    straight = QgsGeometry.fromWkt("LINESTRING(35 9.75, -5 -0.25)")
    assert max(town.distance(straight) for town in towns) > 0.3
    assert all(province.isGeosValid() for province in provinces)
    shared = [{(v.x(), v.y()) for v in one.vertices()} for one in provinces]
    assert len(shared[0] & shared[1]) > 10
    assert sum(one.area() for one in provinces) == pytest.approx(900.0)


def test_z_and_m_and_multipart(run, layer, focus):
    land = layer("MultiPolygonZM?crs=EPSG:3035", [
        ("MULTIPOLYGON ZM(((0 0 1 2, 10 0 3 4, 20 8 5 6, 0 8 7 8, 0 0 1 2), "
         "(2 2 0 1, 3 4 0 1, 4 2 0 1, 2 2 0 1)), ((22 -9 1 1, 25 -9 1 1, 25 18 1 1, 22 -9 1 1)))", []),
    ])  # fmt: skip
    results = run(TOOL, parameters(land, focus))
    before, after = next(land.getFeatures()).geometry(), features(results)[0].geometry()
    assert after.isGeosValid() and after.wkbType() == before.wkbType()
    assert [(v.z(), v.m()) for v in before.vertices()] == [(v.z(), v.m()) for v in after.vertices()]


def test_lines(run, layer, focus):
    roads = layer("LineString?crs=EPSG:3035&field=name:string", [
        ("LINESTRING(0 5, 10 5, 20 6, 30 5)", ["a"]), ("LINESTRING(10 0, 10 5, 12 25)", ["b"]),
    ])  # fmt: skip
    results = run(TOOL, parameters(roads, focus))
    a, b = (points(f.geometry()) for f in features(results))
    assert (a[1] == b[1]).all()
    assert a[1, 0] - a[0, 0] == pytest.approx(13.0, abs=1e-8)


def test_degrees(run, layer, feedback):
    """Solved in a projection, and back in degrees; a degree of longitude is half as long as one of latitude."""
    ring = [(10 + x, 60 + y) for x in (0, 1, 2, 3, 4) for y in (0,)] + [(14, 62), (10, 62)]
    wkt = "POLYGON((" + ", ".join(f"{x} {y}" for x, y in ring + ring[:1]) + "))"
    land = layer("Polygon?crs=EPSG:4326", [(wkt, [])])
    focus = layer("Polygon?crs=EPSG:4326", [("POLYGON((11 59, 13.5 59, 13.5 61, 11 61, 11 59))", [])])
    results = run(TOOL, parameters(land, focus, GROWTH=50), feedback)
    after = points(features(results)[0].geometry())
    assert results["OUTPUT"].crs().authid() == "EPSG:4326"
    assert np.allclose(after[2:4] - after[1], [(1.3, 0.0), (2.6, 0.0)], atol=1e-9)
    assert any("latitude 61.0" in text for text in feedback.infos)


def test_grads(run, layer, feedback):
    """The middle latitude of a map in grads is told and used in degrees."""

    def polygon(*ring):
        return "POLYGON((" + ", ".join(f"{x / 0.9} {y / 0.9}" for x, y in (*ring, ring[0])) + "))"

    land = layer("Polygon?crs=EPSG:4902", [(polygon((10, 60), (12, 60), (14, 60), (14, 62), (10, 62)), [])])
    focus = layer("Polygon?crs=EPSG:4902", [(polygon((11, 59), (13.5, 59), (13.5, 61), (11, 61)), [])])
    run(TOOL, parameters(land, focus, GROWTH=50), feedback)
    assert any("latitude 61.0" in text for text in feedback.infos)


def test_degrees_stay_on_the_globe(run, layer):
    ring = [(x, -90) for x in range(-180, 181, 30)] + [(180, 90), (-180, 90), (-180, -90)]
    wkt = "POLYGON((" + ", ".join(f"{x} {y}" for x, y in ring) + "))"
    land = layer("Polygon?crs=EPSG:4326", [(wkt, []), ("POLYGON((0 0, 20 0, 20 20, 0 20, 0 0))", [])])
    focus = layer("Polygon?crs=EPSG:4326", [("POLYGON((-1 -1, 21 -1, 21 21, -1 21, -1 -1))", [])])
    results = run(TOOL, parameters(land, focus, SCALE=2, GROWTH=50))
    world, island = (points(f.geometry()) for f in features(results))
    assert np.ptp(island, axis=0) == pytest.approx((40.0, 40.0)) and (np.abs(world) <= (180, 90)).all()


def test_longitudes_from_0_to_360(run, layer):
    land = layer(
        "Polygon?crs=EPSG:4326",
        [(f"POLYGON(({x} 0, {x + 90} 0, {x + 90} 60, {x} 60, {x} 0))", []) for x in (0, 90, 180, 270)],
    )
    focus = layer("Polygon?crs=EPSG:4326", [("POLYGON((80 -1, 280 -1, 280 61, 80 61, 80 -1))", [])])
    found = features(run(TOOL, parameters(land, focus, SCALE=1.0)))
    assert [f.geometry().boundingBox().xMaximum() for f in found] == [90, 180, 270, 360]
    found = features(run(TOOL, parameters(land, focus, SCALE=0.5)))
    assert np.ptp(points(found[1].geometry()), axis=0) == pytest.approx((45.0, 30.0))
    assert found[3].geometry().boundingBox().xMaximum() == pytest.approx(360.0)


@pytest.mark.parametrize("crs, region, words", [
    ("EPSG:4326", "EPSG:4326", r"in degrees \(EPSG:4326\), and \(4e\+06 .*Is its CRS right"),
    ("EPSG:3035", "EPSG:4326", "has no place in the CRS of the map .EPSG:3035"),
])  # fmt: skip
def test_metres_in_a_layer_of_degrees_are_told(run, layer, crs, region, words):
    square = "POLYGON((4e6 3e6, 4.1e6 3e6, 4.1e6 3.1e6, 4e6 3.1e6, 4e6 3e6))"
    land = layer(f"Polygon?crs={crs}", [(square, [])])
    with pytest.raises(QgsProcessingException, match=words):
        run(TOOL, parameters(land, layer(f"Polygon?crs={region}", [(square, [])])))


def test_growth(run, land, focus):
    """By what the region needs, three times as much at most: 12 of 30 are in focus."""
    for scale, growth in ((2.0, {}), (2.2, {}), (2.0, {"GROWTH": 30})):
        results = run(TOOL, {"INPUT": land, "FOCUS": focus, "SCALE": scale, "OUTPUT": "memory:", **growth})
        box = features(results)[0].geometry().boundingBox()
        expected = 1.3 if growth else scale * 0.4 ** (2 / 7)
        assert box.width() / 30 == pytest.approx(expected, rel=0.005)
        assert box.height() / 30 == pytest.approx(expected, rel=0.005)
    with pytest.raises(QgsProcessingException, match="larger than the frame"):
        run(TOOL, {"INPUT": land, "FOCUS": focus, "SCALE": 8.0, "OUTPUT": "memory:"})


def test_a_vertex_on_the_edge_of_a_neighbour_stays_on_it(run, layer, focus):
    """The neighbour gets a point there, with its Z."""
    land = layer("PolygonZ?crs=EPSG:3035", [
        ("POLYGON Z((0 0 0, 10 0 0, 10 10 8, 0 10 0, 0 0 0))", []),
        ("POLYGON Z((10 0 0, 20 0 0, 20 5 0, 10 5 1, 10 0 0))", []),
        ("POLYGON Z((10 5 1, 20 5 0, 20 10 0, 10 10 8, 10 5 1))", []),
    ])  # fmt: skip
    focus = layer("Polygon?crs=EPSG:3035", [("POLYGON((4 4, 12 4, 12 6, 4 6, 4 4))", [])])
    first, second, third = (f.geometry() for f in features(run(TOOL, parameters(land, focus))))
    shared = [(v.x(), v.y()) for v in second.vertices()][3]
    assert shared in [(v.x(), v.y()) for v in first.vertices()]
    assert [v.z() for v in first.vertices()] == [0, 0, 4, 8, 0, 0]
    assert first.intersection(second).area() == pytest.approx(0.0, abs=1e-12)
    assert first.isGeosValid() and third.isGeosValid()


@pytest.mark.parametrize("wkt, words", [
    ("POLYGON((100 100, 110 100, 110 110, 100 100))", "touches nothing"),
    ("POLYGON((-99 -99, 99 -99, 99 99, -99 99, -99 -99))", "covers all"),
    (None, "no polygons"),
])  # fmt: skip
def test_a_focus_that_cannot_be(run, land, layer, wkt, words):
    wrong = layer("Polygon?crs=EPSG:3035", [(wkt, [])])
    with pytest.raises(QgsProcessingException, match=words):
        run(TOOL, parameters(land, wrong))


def test_cancel(run, land, focus, cancelling):
    feedback = cancelling(cancel_after=1)
    results = run(TOOL, parameters(land, focus), feedback)
    assert feedback.isCanceled() and "OUTPUT" not in results


def test_without_scipy_the_tool_says_what_to_install(provider, monkeypatch):
    imported = builtins.__import__

    def without(name, *arguments, **keywords):
        if name.startswith("scipy"):
            raise ImportError(name)
        return imported(name, *arguments, **keywords)

    monkeypatch.setattr(builtins, "__import__", without)
    registry = QgsApplication.processingRegistry()
    ok, message = registry.algorithmById(TOOL).canExecute()
    assert not ok and "scipy" in message and "pip install" in message
    assert registry.algorithmById("isthmus:partition").canExecute()[0]


MODEL = Path(__file__).resolve().parents[2] / "resources" / "models" / "partition_and_focus_map.model3"


def test_the_example_model(provider, land, focus):
    """Partition, then focus map: the cuts are the relevant edges."""
    model = QgsProcessingModelAlgorithm()
    assert model.fromFile(str(MODEL))
    assert model.validate()[0], model.validate()[1]
    context = QgsProcessingContext()
    context.setProject(QgsProject.instance())
    sinks = {
        "partition:Parts": "memory:",
        "focusmap:Focus map": "memory:",
        "focusmap:Relevant edges": "memory:",
    }
    results, ok = model.run(
        {"INPUT": land, "FOCUS": focus, "TAU": 2.0, "SCALE": 1.3, **sinks},
        context, QgsProcessingFeedback(),
    )  # fmt: skip
    assert ok
    edges, moved = (
        QgsProcessingUtils.mapLayerFromString(results[name], context)
        for name in ("focusmap:Relevant edges", "focusmap:Focus map")
    )
    assert moved.featureCount() == 3
    assert {edge["kind"] for edge in edges.getFeatures()} == {"given", "join"}


# ---- found by fuzzing


def ring(*points):
    return QgsGeometry(QgsPolygon(QgsLineString([QgsPoint(*p) for p in points])))


def test_a_feature_that_is_not_finite_stays_and_is_told(run, layer, focus, feedback):
    odd = ring((40, 0), (float("nan"), 0), (45, 5), (40, 0))
    land = layer("Polygon?crs=EPSG:3035&field=n:integer", [(f"POLYGON(({DUMBBELL}))", [1]), (odd, [2])])
    first, second = features(run(TOOL, parameters(land, focus), feedback))
    assert first.geometry().isGeosValid() and first["n"] == 1
    assert second.geometry().asWkb() == odd.asWkb() and second["n"] == 2
    assert any("not finite" in text and "feature 2" in text for text in feedback.warnings)


def test_a_focus_that_is_not_finite_or_no_polygon(run, land, layer):
    square = "POLYGON((-1 -1, 11 -1, 11 11, -1 11, -1 -1))"
    odd = ring((0, 0), (float("nan"), 0), (5, 5), (0, 0))
    line = ring((0, 0), (5, 5), (0, 0))
    results = run(
        TOOL, parameters(land, layer("Polygon?crs=EPSG:3035", [(odd, []), (line, []), (square, [])]))
    )
    assert results["SCALE_REACHED"] == 1.3
    with pytest.raises(QgsProcessingException, match="no polygons whose coordinates are finite"):
        run(TOOL, parameters(land, layer("Polygon?crs=EPSG:3035", [(odd, [])])))


def test_numbers_that_are_none_are_refused(provider, land, focus):
    tool = QgsApplication.processingRegistry().algorithmById(TOOL)
    for name in ("SCALE", "TAU", "SMALLEST_PART"):
        ok, message = tool.checkParameterValues(
            parameters(land, focus, **{name: float("nan")}), QgsProcessingContext()
        )
        assert not ok and name in message
    for scale in (0.0, 1000.0):
        ok, message = tool.checkParameterValues(parameters(land, focus, SCALE=scale), QgsProcessingContext())
        assert not ok and "0.01" * (scale == 0.0) + "at most 100" * (scale > 0.0) in message


def test_a_single_point(run, layer, focus):
    """Nothing to deform, and yet a map, with layers carried along."""
    towns = layer("Point?crs=EPSG:3035", [("POINT(5 5)", []), ("POINT(7 7)", [])])
    here = layer("Point?crs=EPSG:3035", [("POINT(5 5)", [])])
    results = run(TOOL, parameters(here, focus, FRAME=False, ALONG=[towns]))
    assert points(features(results)[0].geometry()).tolist() == [[5, 5]]


def test_points_beside_a_focus_that_has_none(run, layer, focus):
    towns = layer("Point?crs=EPSG:3035", [("POINT(50 5)", []), ("POINT(70 7)", [])])
    with pytest.raises(QgsProcessingException, match=r"layers right\?$"):
        run(TOOL, parameters(towns, focus))


def test_carried_layers_of_one_name(run, land, focus, layer, tmp_path):
    """To a GeoPackage, Roads and roads are one."""
    roads = [layer("Point?crs=EPSG:3035", [(f"POINT({k} 1)", [])] * k) for k in (1, 2)]
    for one, name in zip(roads, ("Roads", "roads")):
        one.setName(name)
    path = str(tmp_path / "carried.gpkg")
    results = run(TOOL, parameters(land, focus, ALONG=roads, CARRIED=path))
    counts = [QgsVectorLayer(address, "", "ogr").featureCount() for address in results["CARRIED_LAYERS"]]
    assert counts == [1, 2]


def test_a_carried_feature_without_a_place_in_the_map(run, land, focus, layer, tmp_path, feedback):
    towns = layer(
        "Point?crs=EPSG:4326&field=name:string", [("POINT(10 500)", ["nowhere"]), ("POINT(10 52)", ["here"])]
    )
    path = str(tmp_path / "carried.gpkg")
    results = run(TOOL, parameters(land, focus, ALONG=[towns], CARRIED=path), feedback)
    lost, kept = QgsVectorLayer(results["CARRIED_LAYERS"][0], "", "ogr").getFeatures()
    assert (lost["name"], kept["name"]) == ("nowhere", "here")
    assert lost.geometry().isEmpty() and not kept.geometry().isEmpty()
    assert any("have no place" in text for text in feedback.warnings)


def test_what_is_too_narrow_to_stay_valid_is_told(run, layer, feedback):
    """The long sides of the third are one where the border of the others crosses them."""
    left, right = "POLYGON((0 0,30 0,33 100,0 100,0 0))", "POLYGON((30 0,100 0,100 100,33 100,30 0))"
    thin = "POLYGON((10 50,90 50,90 50.000000001,10 50.000000001,10 50))"
    fields = layer("Polygon?crs=EPSG:3035", [(one, []) for one in (left, right, thin)])
    region = layer("Polygon?crs=EPSG:3035", [("POLYGON((40 60,60 60,60 80,40 80,40 60))", [])])
    results = run(TOOL, parameters(fields, region, SCALE=2, GROWTH=200), feedback)
    valid = [feature.geometry().isGeosValid() for feature in features(results)]
    told = [text for text in feedback.warnings if text.startswith("No longer valid")]
    assert valid == [True, True, False] and len(told) == 1 and told[0].endswith("feature 3.")
