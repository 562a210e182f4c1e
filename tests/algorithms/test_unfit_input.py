"""What does not fit a tool: one sentence that says what it is, of which feature, and what to do."""

import re

import pytest
from osgeo import ogr, osr
from qgis.core import QgsProcessingAlgorithm, QgsProcessingException, QgsProperty, QgsVectorLayer

from .test_partition import DUMBBELL, partition, rows

BESIDE = "POLYGON((22 0,30 0,30 10,22 10,22 0))"


@pytest.mark.parametrize("uri, wkt, kind", [
    ("Point", "POINT(1 1)", "Point"), ("MultiLineString", "MULTILINESTRING((0 0,1 1))", "Line"),
])  # fmt: skip
@pytest.mark.parametrize(
    "tool", ["partition", "partitionbudget", "tradeoff", "hierarchy", "prepareaggregation", "aggregate"]
)
def test_a_layer_of_another_kind_is_refused(run, layer, tool, uri, wkt, kind):
    source = layer(f"{uri}?crs=EPSG:3857&field=name:string", [(wkt, ["x"])])
    options = {"INPUT": source, "CLASS": "name", "THRESHOLD": 50, "OUTPUT": "memory:"}
    with pytest.raises(QgsProcessingException, match=f"INPUT must be .* Polygon, and is of the type {kind}"):
        run(f"isthmus:{tool}", options)


def test_candidates_and_a_focus_of_another_kind_are_refused(run, layer):
    source = layer("Polygon?crs=EPSG:3857", [(DUMBBELL, [])])
    with pytest.raises(
        QgsProcessingException, match="CANDIDATES must be .* Line, and is of the type Polygon"
    ):
        partition(run, source, CANDIDATES=source)
    line = layer("LineString?crs=EPSG:3857", [("LINESTRING(0 0,1 1)", [])])
    with pytest.raises(QgsProcessingException, match="FOCUS must be .* Polygon, and is of the type Line"):
        run("isthmus:focusmap", {"INPUT": source, "FOCUS": line, "SCALE": 2, "OUTPUT": "memory:"})


@pytest.fixture
def mixed(tmp_path):
    """A layer of all kinds of geometries, as one opens it by its path."""
    crs = osr.SpatialReference()
    crs.ImportFromEPSG(3857)
    file = ogr.GetDriverByName("GPKG").CreateDataSource(str(tmp_path / "mixed.gpkg"))
    table = file.CreateLayer("mixed", crs, ogr.wkbUnknown)
    for wkt in (DUMBBELL, "POINT(3 3)", "POLYGON EMPTY", f"GEOMETRYCOLLECTION({BESIDE})", None, BESIDE):
        feature = ogr.Feature(table.GetLayerDefn())
        if wkt:
            feature.SetGeometry(ogr.CreateGeometryFromWkt(wkt))
        table.CreateFeature(feature)
    del feature, table, file
    return str(tmp_path / "mixed.gpkg")


def test_features_of_other_kinds_keep_their_place_where_the_format_has_one(run, mixed, feedback, tmp_path):
    results = partition(run, mixed, feedback, OUTPUT=str(tmp_path / "parts.gpkg"))
    assert results["SKIPPED_COUNT"] == 4
    parts = QgsVectorLayer(results["OUTPUT"], "parts", "ogr")
    status = {part["source"]: part["status"] for part in parts.getFeatures() if part["status"]}
    assert status == {2: "it is no polygon", 3: "it is empty", 4: "it is no polygon", 5: "it has no geometry"}
    assert [text for text in feedback.warnings if "Feature 2 was not cut: it is no polygon." in text]


def test_where_it_has_none_the_feature_and_both_kinds_are_named(run, mixed):
    with pytest.raises(QgsProcessingException) as refused:
        partition(run, mixed)
    said = str(refused.value)
    assert "(feature 2)" in said and "of the type Point" in said and "takes MultiPolygon only" in said
    assert "disk" not in said


def test_curves_say_why_they_have_none(run, mixed, feedback):
    results = run("isthmus:tradeoff", {"INPUT": mixed, "OUTPUT": "memory:"}, feedback)
    assert {row["source"] for row in rows(results["OUTPUT"])} == {1, 6}
    told = [text.partition(": ")[2] for text in feedback.warnings]
    assert told == ["it is no polygon.", "it is empty.", "it is no polygon.", "it has no geometry."]


@pytest.mark.parametrize("name, kind", [("fid", "string"), ("FID", "double"), ("geom", "string")])
@pytest.mark.parametrize("tool, result", [("partition", "OUTPUT"), ("aggregate", "ASSIGNMENT")])
def test_a_field_that_a_geopackage_has_itself(run, layer, tmp_path, tool, result, name, kind):
    source = layer(f"Polygon?crs=EPSG:3857&field={name}:{kind}", [(DUMBBELL, [1]), (BESIDE, [2])])
    options = {"INPUT": source, "CLASS": name, "THRESHOLD": 50, "OUTPUT": "memory:"}
    with pytest.raises(QgsProcessingException, match=f"a field {name} of its own: rename that of the input"):
        run(f"isthmus:{tool}", {**options, result: str(tmp_path / "parts.gpkg")})
    assert not list(tmp_path.iterdir())
    run(f"isthmus:{tool}", {**options, result: str(tmp_path / "parts.geojson")})


@pytest.mark.parametrize("tool, name", [
    ("partition", "TAU"), ("partition", "SMALLEST_PART"), ("partitionbudget", "BUDGET"),
    ("tradeoff", "MIN_HOLE"), ("hierarchy", "TAU"), ("hierarchy", "PARTS"), ("prepareaggregation", "MIN_LENGTH"),
])  # fmt: skip
def test_an_expression_for_a_number_that_no_feature_can_have(run, layer, tool, name):
    source = layer("Polygon?crs=EPSG:3857&field=Name:string", [(DUMBBELL, ["5"])])
    options = {"INPUT": source, "CLASS": "Name", "OUTPUT": "memory:"}
    for own, said in (
        (QgsProperty.fromExpression("1 +"), f"for {name} is not valid"),
        (QgsProperty.fromExpression('"nope" + 1'), f"for {name} uses an unknown field: nope"),
        (QgsProperty.fromField("nope"), f"for {name} uses an unknown field: nope"),
    ):
        with pytest.raises(QgsProcessingException, match=said):
            run(f"isthmus:{tool}", {**options, name: own})
    # QGIS finds a field whatever its case
    assert run(f"isthmus:{tool}", {**options, name: QgsProperty.fromField("name")})


def test_a_text_where_a_number_is_wanted_is_called_none(run, layer, feedback):
    rooms = [(DUMBBELL, ["many"]), (DUMBBELL, ["4"]), (DUMBBELL, [None])]
    source = layer("Polygon?crs=EPSG:3857&field=tau:string", rooms)
    results = partition(run, source, feedback, TAU=QgsProperty.fromField("tau"))
    assert results["SKIPPED_COUNT"] == 2
    said = "was not cut: tau must be a number of at least 1, and is no number."
    assert feedback.warnings == [f"Feature {number} {said}" for number in (1, 3)]


def test_a_weight_by_a_field_in_another_case(run, layer):
    source = layer("Polygon?crs=EPSG:3857&field=Price:double", [(DUMBBELL, [2.5])])
    results = partition(run, source, OBJECTIVE="MinWeight", WEIGHT="PRICE")
    assert results["COST"] == 2.5 * results["CUT_COUNT"] > 0


@pytest.mark.parametrize("tool", ["partition", "tradeoff", "hierarchy", "aggregate", "focusmap"])
def test_a_layer_that_qgis_cannot_read(run, layer, monkeypatch, tool):
    """QGIS 3.34 throws at an infinite coordinate, an exception of C++ without a name."""

    def throw(*_):
        raise Exception("unknown")

    source = layer("Polygon?crs=EPSG:3857&field=name:string", [(DUMBBELL, ["x"])])
    monkeypatch.setattr(QgsProcessingAlgorithm, "parameterAsSource", throw)
    options = {"FOCUS": source, "CLASS": "name", "THRESHOLD": 50, "OUTPUT": "memory:"}
    with pytest.raises(QgsProcessingException) as refused:
        run(f"isthmus:{tool}", {"INPUT": source, **options})
    said = str(refused.value)
    assert re.search(
        r"QGIS cannot read (INPUT|FOCUS) \(unknown\): has it a coordinate that is not finite\?", said
    )
    assert "Traceback" not in said


@pytest.mark.parametrize("tool, name, value, said", [
    ("aggregate", "THRESHOLD", 1e300, "THRESHOLD must be at most 1e\\+18, and is 1e\\+300"),
    ("aggregate", "SEED", 1e30, "SEED must be at most 2.14748e\\+09, and is 1e\\+30"),
    ("focusmap", "GROWTH", 1e9, "GROWTH must be at most 1000, and is 1e\\+09"),
    ("partition", "TAU", "1e400", "TAU must be at most 1e\\+18, and is inf"),
    ("partition", "TAU", "", "TAU must be a number, and is ''"),
    ("tradeoff", "STEPS", -1, "STEPS must be a number of at least 1, and is -1"),
    ("tradeoff", "STEPS", 2.5, "STEPS must be a whole number, and is 2.5"),
    ("hierarchy", "PARTS", 2.5, "PARTS must be a whole number, and is 2.5"),
    ("aggregate", "REGIONS", 1.5, "REGIONS must be a whole number, and is 1.5"),
    ("aggregate", "REGIONS", "0.5", "REGIONS must be a whole number, and is 0.5"),
    ("aggregate", "ITERATIONS", 2.0000001, "ITERATIONS must be a whole number, and is 2.0000001"),
])  # fmt: skip
def test_a_number_out_of_its_range_is_told_with_the_range(run, layer, tool, name, value, said):
    source = layer("Polygon?crs=EPSG:3857&field=name:string", [(DUMBBELL, ["x"])])
    options = {"INPUT": source, "FOCUS": source, "CLASS": "name", "THRESHOLD": 50, "OUTPUT": "memory:"}
    with pytest.raises(QgsProcessingException, match=said):
        run(f"isthmus:{tool}", {**options, name: value})
