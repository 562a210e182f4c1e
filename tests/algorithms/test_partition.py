"""isthmus:partition in the toolbox: values, units, candidates, bad input, cancel."""

import math
import struct

import numpy as np
import pytest
from qgis.core import (
    NULL,
    Qgis,
    QgsApplication,
    QgsCoordinateReferenceSystem,
    QgsDistanceArea,
    QgsFeatureRequest,
    QgsGeometry,
    QgsLineString,
    QgsPointXY,
    QgsPolygon,
    QgsProcessingAlgorithm,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeatureSourceDefinition,
    QgsProject,
    QgsProperty,
    QgsVectorFileWriter,
    QgsVectorLayer,
    QgsWkbTypes,
)

DUMBBELL = "POLYGON((0 0,10 0,10 4.5,12 4.5,12 0,22 0,22 10,12 10,12 5.5,10 5.5,10 10,0 10,0 0))"
# the same, cut at both ends of its corridor
DUMBBELL_CUTS = {((10, 4.5), (10, 5.5)), ((12, 4.5), (12, 5.5))}
ANNULUS = "POLYGON((0 0,20 0,20 20,0 20,0 0),(1 8,1 12,12 12,12 8,1 8))"
BOWTIE = "POLYGON((0 0,10 10,10 0,0 10,0 0))"


def square_with(x):
    """A square with one odd coordinate; WKT has no word for it."""
    return QgsGeometry(QgsPolygon(QgsLineString([0, 10, 10, x, 0], [0, 0, 10, 5, 0])))


# the paper's problem: every diagonal of the triangulation is a candidate
EVERYWHERE = {"PLACES": "Any", "SMALLEST_PART": 0}


def partition(run, source, feedback=None, **more):
    parameters = {
        "INPUT": source, "TAU": 4, **EVERYWHERE, "OUTPUT": "memory:", "CUTS": "memory:", **more
    }  # fmt: skip
    return run("isthmus:partition", parameters, feedback)


def rows(layer):
    names = [field.name() for field in layer.fields()]
    return [dict(zip(names, f.attributes()), geometry=f.geometry()) for f in layer.getFeatures()]


def ends(line):
    points = [(v.x(), v.y()) for v in line["geometry"].vertices()]
    return tuple(sorted((points[0], points[-1])))


def test_a_dumbbell_falls_into_two_rooms_and_a_corridor(run, layer):
    source = layer("Polygon?crs=EPSG:3857&field=name:string", [(DUMBBELL, ["d"])])
    results = partition(run, source)
    parts, cuts = rows(results["OUTPUT"]), rows(results["CUTS"])
    assert [(p["name"], p["part"], p["parts"], p["status"]) for p in parts] == [
        ("d", k, 3, "") for k in (1, 2, 3)
    ]
    assert [p["geometry"].area() for p in parts] == [100, 100, 2]
    assert {ends(c) for c in cuts} == DUMBBELL_CUTS
    assert [c["source"] for c in cuts] == [next(source.getFeatures()).id()] * 2
    assert [c["length"] for c in cuts] == [1, 1]
    # around a room: 4.5 + 10 + 10 + 10 + 4.5
    assert [c["detour"] for c in cuts] == pytest.approx([39, 39])
    assert sorted((c["part_a"], c["part_b"]) for c in cuts) == [(1, 3), (2, 3)]
    assert (results["PART_COUNT"], results["CUT_COUNT"], results["CUT_LENGTH"]) == (3, 2, 2)
    assert results["SKIPPED_COUNT"] == 0
    assert 1 <= results["MAX_DILATION"] <= 4


def test_diagonals_tell_the_whole_story(run, layer):
    source = layer("Polygon?crs=EPSG:3857", [(DUMBBELL, [])])
    results = partition(run, source, DIAGONALS="memory:")
    diagonals = rows(results["DIAGONALS"])
    assert len(diagonals) == 12 - 3
    assert {ends(d) for d in diagonals if d["role"] == "SELF"} == DUMBBELL_CUTS
    assert {d["role"] for d in diagonals} <= {"SELF", "LEAF", "ROOT"}
    assert max(d["dilation"] for d in diagonals) == pytest.approx(results["MAX_DILATION"])
    for d in diagonals:
        assert d["length"] == pytest.approx(d["geometry"].length())
        assert 1 <= d["dilation"] <= min(4, d["detour"]) * (1 + 1e-12)


def test_an_edge_that_only_connects_a_hole_has_no_detour_and_one_part(run, layer):
    source = layer("Polygon?crs=EPSG:3857", [(ANNULUS, [])])
    results = partition(run, source, TAU=1000)
    (cut,) = rows(results["CUTS"])
    assert ends(cut) == ((0, 0), (1, 8))
    assert (cut["detour"], cut["part_a"], cut["part_b"]) == (NULL, 1, 1)
    (part,) = rows(results["OUTPUT"])
    assert part["geometry"].equals(QgsGeometry.fromWkt(ANNULUS))


def test_tau_from_a_field(run, layer):
    source = layer(
        "Polygon?crs=EPSG:3857&field=t:double",
        [(DUMBBELL, [4.0]), (DUMBBELL, [100.0]), (DUMBBELL, [0.5]), (DUMBBELL, [NULL])],
    )
    feedback_rows = rows(partition(run, source, TAU=QgsProperty.fromField("t"))["OUTPUT"])
    statuses = {row["t"]: row["status"] for row in feedback_rows}
    assert [row["t"] for row in feedback_rows].count(4.0) == 3
    assert [row["t"] for row in feedback_rows].count(100.0) == 1
    assert statuses[4.0] == statuses[100.0] == ""
    assert "at least 1" in statuses[0.5]
    assert "at least 1" in statuses[NULL]


def test_short_diagonals_do_not_count(run, layer):
    source = layer("Polygon?crs=EPSG:3857", [(DUMBBELL, [])])
    assert partition(run, source, MIN_LENGTH=1)["CUT_COUNT"] == 2
    results = partition(run, source, MIN_LENGTH=2.3)  # the corridor's diagonal is sqrt(5) long
    assert results["CUT_COUNT"] == 0
    (part,) = rows(results["OUTPUT"])
    assert part["geometry"].asWkb() == QgsGeometry.fromWkt(DUMBBELL).asWkb()


def test_small_holes_stay_holes(run, layer):
    source = layer("Polygon?crs=EPSG:3857", [(ANNULUS, [])])
    results = partition(run, source, MIN_HOLE=44.1)
    assert results["CUT_COUNT"] == 0
    assert partition(run, source, MIN_HOLE=44)["CUT_COUNT"] > 0


def test_degrees_are_measured_in_metres(run, layer):
    # near the equator a degree is 111.32 km east and 110.57 km north
    source = layer("Polygon?crs=EPSG:4326", [(DUMBBELL, [])])
    results = partition(run, source)
    cuts = rows(results["CUTS"])
    assert {ends(c) for c in cuts} == DUMBBELL_CUTS
    assert [c["length"] for c in cuts] == pytest.approx([110574, 110574], rel=1e-3)
    assert partition(run, source, MIN_LENGTH=110000)["CUT_COUNT"] == 2
    assert partition(run, source, MIN_LENGTH=250000)["CUT_COUNT"] == 0


@pytest.mark.parametrize("crs, degrees, length", [
    (QgsCoordinateReferenceSystem("EPSG:4807"), 0.9, None),  # grads, of which QGIS does not know the unit
    (QgsCoordinateReferenceSystem.fromProj("+proj=longlat +R=3396190 +no_defs"), 1, 59274.7),  # Mars
])  # fmt: skip
def test_angles_of_every_geographic_crs_are_measured_in_metres(run, layer, feedback, crs, degrees, length):
    """QGIS 3.22 does not know that a CRS of the user is geographic: a degree of Mars was one metre."""
    source = layer("Polygon?crs=EPSG:4326", [(DUMBBELL, [])])
    source.setCrs(crs)
    if length is None:
        ground = QgsDistanceArea()
        ground.setEllipsoid("EPSG:7011")
        ground.setSourceCrs(
            QgsCoordinateReferenceSystem("EPSG:4275"), QgsProject.instance().transformContext()
        )
        length = ground.measureLine(QgsPointXY(9, 4.5 * degrees), QgsPointXY(9, 5.5 * degrees))
    results = partition(run, source, feedback)
    assert [c["length"] for c in rows(results["CUTS"])] == pytest.approx([length] * 2, rel=1e-4)
    assert any(" m in all" in text for text in feedback.infos)
    north = QgsGeometry.fromWkt(DUMBBELL)
    north.translate(0, 90 / degrees - 10)
    source = layer("Polygon?crs=EPSG:4326", [(north, [])])
    source.setCrs(crs)
    partition(run, source, feedback)
    assert not feedback.warnings  # the pole is no latitude beyond it


def test_a_line_of_no_length_is_told_whatever_qgis_does_with_invalid_features(run, layer, feedback):
    """QGIS's check would end the run by an exception through Python, which crashed some time later."""
    source = layer("Polygon?crs=EPSG:3857", [(DUMBBELL, [])])
    lines = layer(
        "LineString?crs=EPSG:3857", [("LINESTRING(1 1,1 1)", []), ("LINESTRING(10 4.5,10 5.5)", [])]
    )
    checked = QgsProcessingFeatureSourceDefinition(
        QgsProject.instance().addMapLayer(lines).id(), False, -1,
        QgsProcessingFeatureSourceDefinition.Flag.FlagOverrideDefaultGeometryCheck,
        QgsFeatureRequest.InvalidGeometryCheck.GeometryAbortOnInvalid,
    )  # fmt: skip
    assert partition(run, source, feedback, CANDIDATES=checked)["CUT_COUNT"] == 1
    assert [text for text in feedback.warnings if "line 1 was left out" in text]
    QgsProject.instance().clear()


def test_own_lines_as_candidates(run, layer, feedback):
    source = layer("Polygon?crs=EPSG:3857", [(DUMBBELL, [])])
    lines = layer(
        "LineString?crs=EPSG:3857",
        [
            ("LINESTRING(10 4.5,10 5.5)", []),
            ("LINESTRING(10 4.5,12 5.5)", []),
            ("LINESTRING(12 4.5,10 5.5)", []),  # crosses the one before
            ("LINESTRING(0 0,5 5)", []),  # ends nowhere
            ("LINESTRING(10 0,12 0)", []),  # outside
            ("LINESTRING(10 0,10 10)", []),  # passes other vertices
            ("LINESTRING(10 5.5,10 4.5)", []),  # again
            ("LINESTRING(0 0,5 1,10 4.5)", []),  # bends
        ],
    )
    results = partition(run, source, feedback, CANDIDATES=lines, DIAGONALS="memory:")
    assert {ends(c) for c in rows(results["CUTS"])} == {((10, 4.5), (10, 5.5))}
    assert len(rows(results["DIAGONALS"])) == 2
    text = "\n".join(feedback.warnings)
    for line, reason in (
        (3, "crosses the shorter line 2"),
        (4, "not a vertex"),
        (5, "leaves"),
        (6, "touches"),
        (7, "repeats line 1"),
        (8, "one straight line"),
    ):
        (message,) = [w for w in feedback.warnings if f"line {line} was" in w]
        assert reason in message, text
    assert len(feedback.warnings) == 6


def test_lines_that_do_not_connect_a_hole(run, layer, feedback):
    source = layer("Polygon?crs=EPSG:3857", [(ANNULUS, [])])
    lines = layer("LineString?crs=EPSG:3857", [("LINESTRING(0 0,12 8)", [])])
    assert partition(run, source, CANDIDATES=lines)["CUT_COUNT"] == 1
    nowhere = layer("LineString?crs=EPSG:3857", [("LINESTRING(5 5,6 6)", [])])
    results = partition(run, source, feedback, CANDIDATES=nowhere)
    (part,) = rows(results["OUTPUT"])
    assert "connect" in part["status"]
    assert results["SKIPPED_COUNT"] == 1


@pytest.mark.parametrize(
    "wkt, reason",
    [
        (None, "no geometry"),
        ("POLYGON EMPTY", "empty"),
        (BOWTIE, "Self-intersection"),
        ("POLYGON((0 0,1 1,0 0))", "three distinct"),
        (square_with(math.nan), "not finite"),
        (square_with(-math.inf), "not finite"),
        ("POLYGON((0 0,5 0,10 0,0 0))", "invalid"),
        ("POLYGON((0 0,9 0,9 9,0 9,0 0),(20 0,21 0,21 1,20 0))", "outside"),
    ],
)
def test_bad_geometry_passes_through_with_a_reason(run, layer, feedback, wkt, reason):
    source = layer(
        "Polygon?crs=EPSG:3857&field=name:string",
        [(DUMBBELL, ["good"]), (wkt, ["bad"]), (DUMBBELL, ["good"])],
    )
    tool = QgsApplication.processingRegistry().createAlgorithmById("isthmus:partition")
    try:
        QgsProcessingAlgorithm.parameterAsSource(tool, {"INPUT": source}, "INPUT", QgsProcessingContext())
    except Exception:  # one of C++, without a name: QGIS 3.34 throws at an infinite coordinate
        with pytest.raises(QgsProcessingException, match="cannot read INPUT .* not finite"):
            partition(run, source, feedback)
        return
    results = partition(run, source, feedback)
    parts = rows(results["OUTPUT"])
    assert [p["name"] for p in parts] == ["good"] * 3 + ["bad"] + ["good"] * 3
    (bad,) = [p for p in parts if p["name"] == "bad"]
    assert reason in bad["status"]
    original = list(source.getFeatures())[1].geometry()
    assert bad["geometry"].asWkb() == original.asWkb()
    assert results["SKIPPED_COUNT"] == 1
    assert [w for w in feedback.warnings if reason in w] == feedback.warnings != []


def test_an_empty_ring_in_one_of_several_polygons(run, layer):
    """It passes through beside those that are cut."""
    rings = struct.pack("<BIIII", 1, 3, 2, 4, 0)[:13]
    square = np.array([(40, 0), (41, 0), (41, 1), (40, 0)], dtype="<f8").tobytes()
    odd = rings + square + struct.pack("<I", 0)
    good = bytes(QgsGeometry.fromWkt(DUMBBELL).asWkb())
    geometry = QgsGeometry()
    geometry.fromWkb(struct.pack("<BII", 1, 6, 2) + odd + good)
    source = layer("MultiPolygon?crs=EPSG:3857", [(geometry, [])])
    parts = rows(partition(run, source)["OUTPUT"])
    assert [p["status"] != "" for p in parts] == [False, False, False, True]
    assert parts[3]["geometry"].constGet().geometryN(0).asWkb() == odd


def test_multipart_features_part_by_part(run, layer):
    island = "((30 0,31 0,31 1,30 1,30 0))"
    wkt = f"MULTIPOLYGON({island},({DUMBBELL[8:-1]}),({BOWTIE[8:-1]}))".replace("((((", "(((")
    source = layer("MultiPolygon?crs=EPSG:3857", [(wkt, [])])
    results = partition(run, source)
    parts = rows(results["OUTPUT"])
    assert [(p["part"], p["parts"]) for p in parts] == [(k, 5) for k in range(1, 6)]
    assert [p["geometry"].area() for p in parts if not p["status"]] == [100, 100, 2, 1]
    assert sum(bool(p["status"]) for p in parts) == 1
    assert results["OUTPUT"].wkbType() == QgsWkbTypes.Type.MultiPolygon


def test_z_and_m_ride_along(run, layer):
    points = [tuple(map(float, p.split())) for p in DUMBBELL[9:-2].split(",")]
    wkt = "POLYGON ZM ((%s))" % ",".join(f"{x} {y} {x + 100} {y - 7}" for x, y in points)
    source = layer("PolygonZM?crs=EPSG:3857", [(wkt, [])])
    results = partition(run, source)
    vertices = [v for p in rows(results["OUTPUT"]) + rows(results["CUTS"]) for v in p["geometry"].vertices()]
    assert len(vertices) == 7 + 7 + 5 + 2 * 2
    assert all((v.z(), v.m()) == (v.x() + 100, v.y() - 7) for v in vertices)


def test_z_is_kept_where_the_layer_does_not_declare_it(run, layer, tmp_path):
    wkt = "POLYGON Z((0 0 1,9 0 2,9 9 3,0 9 4,0 0 1))"
    source = layer("Polygon?crs=EPSG:3857", [(wkt, [])])
    results = partition(run, source, OUTPUT=str(tmp_path / "parts.gpkg"))
    (part,) = rows(QgsVectorLayer(results["OUTPUT"]))
    assert sorted(v.z() for v in part["geometry"].vertices()) == [1, 1, 2, 3, 4]


def test_triangles_and_surfaces_are_polygons(run, layer):
    """They were called empty, and a GeoPackage lost them."""
    source = layer("PolygonZ?crs=EPSG:3857", [("TRIANGLE Z((0 0 1,9 0 2,0 9 3,0 0 1))", [])])
    (part,) = rows(partition(run, source)["OUTPUT"])
    assert part["status"] == "" and part["geometry"].wkbType() == QgsWkbTypes.Type.PolygonZ
    assert [v.z() for v in part["geometry"].vertices()] == [1, 2, 3, 1]


@pytest.mark.skipif(Qgis.QGIS_VERSION_INT < 34000, reason="QGIS 3.22 cannot read them")
@pytest.mark.parametrize("wkt", [
    f"POLYHEDRALSURFACE(({DUMBBELL[8:-1]}),((40 0,49 0,40 9,40 0)))", "TIN(((0 0,9 0,0 9,0 0)),((9 0,9 9,0 9,9 0)))",
])  # fmt: skip
def test_surfaces_patch_by_patch(run, layer, tmp_path, wkt):
    geometry = QgsGeometry.fromWkt(wkt)
    source = layer(f"{wkt.partition('(')[0]}?crs=EPSG:3857", [(geometry, [])] * 2)
    path = str(tmp_path / "parts.gpkg")
    partition(run, source, OUTPUT=path, TAU=QgsProperty.fromExpression("if($id = 1, 4, 0)"))
    parts = rows(QgsVectorLayer(path))
    good = [p["geometry"] for p in parts if p["source"] == 1]
    assert len(good) == (4 if "POLY" in wkt else 2)
    assert sum(one.area() for one in good) == pytest.approx(242.5 if "POLY" in wkt else 81)
    (whole,) = [p["geometry"] for p in parts if p["source"] == 2]
    assert whole.area() == pytest.approx(sum(one.area() for one in good))


def test_curves_become_segments(run, layer):
    wkt = "CURVEPOLYGON(COMPOUNDCURVE(CIRCULARSTRING(0 0,5 5,10 0),(10 0,0 0)))"
    source = layer("CurvePolygon?crs=EPSG:3857", [(wkt, [])])
    (part,) = rows(partition(run, source)["OUTPUT"])
    assert part["status"] == ""
    assert part["geometry"].wkbType() == QgsWkbTypes.Type.Polygon
    assert part["geometry"].area() == pytest.approx(math.pi * 25 / 2, rel=1e-3)


def test_geopackage_to_geopackage_loses_nothing(run, layer, tmp_path):
    fields = "field=fid:integer&field=part:string&field=grün:string&field=none:integer"
    source = layer(
        "Polygon?crs=EPSG:3857&" + fields,
        [(DUMBBELL, [7, "mine", "ß", NULL]), (BOWTIE, [9, "his", "", 1])],
    )
    path = str(tmp_path / "in.gpkg")
    options = QgsVectorFileWriter.SaveVectorOptions()
    context = QgsApplication.instance() and source.transformContext()
    assert QgsVectorFileWriter.writeAsVectorFormatV3(source, path, context, options)[0] == 0
    results = partition(run, path, OUTPUT=str(tmp_path / "out.gpkg"), CUTS=str(tmp_path / "c.gpkg"))
    parts = rows(QgsVectorLayer(results["OUTPUT"]))
    assert len(parts) == 4 == len({p["fid"] for p in parts})
    assert [(p["part"], p["grün"], p["none"]) for p in parts] == [("mine", "ß", NULL)] * 3 + [("his", "", 1)]
    assert [p["part_2"] for p in parts] == [1, 2, 3, 1]
    assert {c["source"] for c in rows(QgsVectorLayer(results["CUTS"]))} == {7}


def test_selected_features_only(run, layer):
    source = layer("Polygon?crs=EPSG:3857", [(DUMBBELL, []), (DUMBBELL, [])])
    source.selectByIds([2])
    chosen = QgsProcessingFeatureSourceDefinition(source.id(), True)
    from qgis.core import QgsProject

    QgsProject.instance().addMapLayer(source, False)
    results = partition(run, chosen)
    assert {c["source"] for c in rows(results["CUTS"])} == {2}


@pytest.mark.parametrize(
    "wrong, word",
    [
        ({"TAU": 0.99}, "TAU"),
        ({"TAU": math.nan}, "TAU"),
        ({"MIN_LENGTH": -1}, "MIN_LENGTH"),
        ({"MIN_HOLE": -1}, "MIN_HOLE"),
    ],
)
def test_bad_parameters_are_refused_before_any_output(run, layer, tmp_path, wrong, word):
    source = layer("Polygon?crs=EPSG:3857", [(DUMBBELL, [])])
    out = tmp_path / "out.gpkg"
    with pytest.raises(QgsProcessingException, match=word):
        partition(run, source, OUTPUT=str(out), **wrong)
    assert not out.exists()


def test_an_unwritable_target_is_an_error(run, layer):
    source = layer("Polygon?crs=EPSG:3857", [(DUMBBELL, [])])
    with pytest.raises(QgsProcessingException):
        partition(run, source, OUTPUT="/proc/nowhere/out.gpkg")


def test_progress_moves_and_cancel_stops_within_one_large_polygon(run, layer, cancelling):
    n = 20000
    points = [
        (math.cos(a) * r, math.sin(a) * r)
        for k in range(n)
        for a, r in [(2 * math.pi * k / n, 1000 + 300 * math.sin(k * 0.05))]
    ]
    wkt = "POLYGON((%s))" % ",".join(f"{x} {y}" for x, y in points + points[:1])
    source = layer("Polygon?crs=EPSG:3857", [(wkt, [])])
    feedback = cancelling()
    partition(run, source, feedback)
    assert len(set(feedback.shares)) > 5
    assert feedback.shares == sorted(feedback.shares)
    assert feedback.shares[-1] == 100
    cancelled = cancelling(cancel_after=2)
    assert partition(run, source, cancelled)["PART_COUNT"] == 0
    assert len(cancelled.shares) <= 3


def test_a_latitude_beyond_the_pole_is_said_and_solved(run, layer, feedback):
    moved = QgsGeometry.fromWkt(DUMBBELL)
    moved.translate(0, 1000)
    source = layer("Polygon?crs=EPSG:4326", [(moved, [])])
    results = partition(run, source, feedback)
    assert [c["length"] for c in rows(results["CUTS"])] == [1, 1]
    assert any("CRS" in w for w in feedback.warnings)
