"""isthmus:hierarchy in the toolbox: levels that tile, and the partition that it begins with."""

import html
import math
import re

import pytest
from qgis.core import (
    NULL,
    QgsApplication,
    QgsExpression,
    QgsExpressionContext,
    QgsExpressionContextUtils,
    QgsGeometry,
    QgsProcessingException,
    QgsProject,
    QgsProperty,
    QgsSymbolLayer,
    QgsVectorLayer,
)

from .test_natural import coast, wkt
from .test_partition import ANNULUS, BOWTIE, DUMBBELL, EVERYWHERE, partition, rows
from .test_provider import ROOT

# two rooms and a corridor, and a third room behind a wider door
ROOMS = (
    "POLYGON((0 0,10 0,10 4.5,12 4.5,12 0,22 0,22 3,24 3,24 0,34 0,34 10,24 10,24 7,22 7,22 10,12 10,12 5.5,"
    "10 5.5,10 10,0 10,0 0))"
)
HOLED = "POLYGON((0 0,30 0,30 12,0 12,0 0),(4 4,8 4,8 8,4 8,4 4),(14 5,16 5,16 7,14 7,14 5))"
NO_END = 1e9


def hierarchy(run, source, feedback=None, **more):
    parameters = {"INPUT": source, "OUTPUT": "memory:", "CUTS": "memory:", **EVERYWHERE, **more}
    return run("isthmus:hierarchy", parameters, feedback)


def moved(polygon, by):
    """A polygon further east, as a part of a multipolygon."""
    return re.sub(r"(\d+(?:\.\d+)?) (\d)", lambda m: f"{float(m[1]) + by:g} {m[2]}", polygon[7:])


def at(parts, tau, source=None):
    return [
        part
        for part in parts
        if part["from_tau"] <= tau < part["to_tau"] and source in (None, part["source"])
    ]


def rings_of(part):
    """The rings as sets of directed edges, whatever they start with, Z and M included."""
    rings = []
    for polygon in part["geometry"].constParts():
        for k in range(-1, polygon.numInteriorRings()):
            ring = polygon.exteriorRing() if k < 0 else polygon.interiorRing(k)
            points = [(p.x(), p.y(), str(p.z()), str(p.m())) for p in ring.points()]
            rings.append(frozenset(zip(points[:-1], points[1:])))
    return frozenset(rings)


def assert_levels(parts, source):
    """The parts of each level tile each feature, and each part is the union of its pieces."""
    for feature in source.getFeatures():
        own = [part for part in parts if part["source"] == feature.id()]
        assert [part["part"] for part in own] == list(range(1, len(own) + 1))
        taus = sorted({part["from_tau"] for part in own})
        assert [part["level"] for part in own] == [taus.index(part["from_tau"]) for part in own]
        for tau in taus:
            now = at(own, tau)
            area = sum(part["geometry"].area() for part in now)
            assert area == pytest.approx(feature.geometry().area(), rel=1e-12)
            joined = QgsGeometry.unaryUnion([part["geometry"] for part in now])
            assert joined.symDifference(feature.geometry()).area() <= 1e-9 * area
        number = {part["part"]: part for part in own}
        for part in own:
            assert part["from_tau"] < part["to_tau"]
            pieces = [piece for piece in own if piece["parent"] == part["part"]]
            if pieces:
                assert len(pieces) > 1
                area = sum(piece["geometry"].area() for piece in pieces)
                assert part["geometry"].area() == pytest.approx(area, rel=1e-12)
            if part["parent"] != NULL:
                assert number[part["parent"]]["from_tau"] == part["to_tau"]
                assert number[part["parent"]]["geometry"].buffer(1e-6, 2).contains(part["geometry"])
            else:
                assert part["to_tau"] == NO_END


def test_a_dumbbell(run, layer, feedback):
    source = layer("Polygon?crs=EPSG:3857&field=name:string", [(DUMBBELL, ["d"])])
    results = hierarchy(run, source, feedback)
    parts, cuts = rows(results["OUTPUT"]), rows(results["CUTS"])
    # without a cut at one end of the corridor, the way between its ends is around the corridor (2 + 1 + 2);
    # without both it is around a room, whose sides are 40 - 1
    assert [(cut["source"], cut["rank"], cut["length"]) for cut in cuts] == [(1, 1, 1.0), (1, 2, 1.0)]
    assert [cut["persistence"] for cut in cuts] == pytest.approx([39.0, 5.0])
    assert [(part["part"], part["parent"], part["level"], round(part["from_tau"], 6)) for part in parts] in (
        [(1, 5, 0, 1.5), (2, 4, 0, 1.5), (3, 4, 0, 1.5), (4, 5, 1, 5.0), (5, NULL, 2, 39.0)],
        [(1, 4, 0, 1.5), (2, 5, 0, 1.5), (3, 4, 0, 1.5), (4, 5, 1, 5.0), (5, NULL, 2, 39.0)],
    )
    assert all(part["name"] == "d" and part["status"] == "" for part in parts)
    assert (results["PART_COUNT"], results["CUT_COUNT"], results["SKIPPED_COUNT"]) == (5, 2, 0)
    assert_levels(parts, source)
    assert parts[-1]["geometry"].asWkt() == QgsGeometry.fromWkt(DUMBBELL).asWkt()
    assert "5 parts in at most 3 levels of a feature, made by 2 cuts." in feedback.infos


@pytest.mark.parametrize("places", ["Natural", "Any"])
@pytest.mark.parametrize("tau", [1.5, 2.5])
def test_levels_tile_and_the_first_is_the_partition(run, layer, places, tau):
    islet = [(-60, 0), (-59, 0), (-59, 1), (-60, 1)]
    source = layer(
        "MultiPolygon?crs=EPSG:3857&field=k:integer",
        [
            (ROOMS, [1]),
            (wkt(coast(200)), [2]),
            (HOLED, [3]),
            (wkt(coast(100), islet[::-1]), [4]),
            (ANNULUS, [5]),
        ],
    )
    options = {"PLACES": places, "SMALLEST_PART": 0, "TAU": tau}
    results = hierarchy(run, source, **options)
    parts = rows(results["OUTPUT"])
    assert_levels(parts, source)
    best = partition(run, source, **options)
    for feature in source.getFeatures():
        whole = [part for part in rows(best["OUTPUT"]) if part["source"] == feature.id()]
        first = at(parts, tau, feature.id())
        assert {rings_of(part) for part in first} == {rings_of(part) for part in whole}
        cuts = [cut for cut in rows(results["CUTS"]) if cut["source"] == feature.id()]
        assert [cut["rank"] for cut in cuts] == list(range(1, len(cuts) + 1))
        persistence = [cut["persistence"] for cut in cuts]
        assert persistence == sorted(persistence, reverse=True)
        for part in parts:
            if part["source"] == feature.id() and part["level"]:
                assert part["from_tau"] in persistence
    # every level: as many parts as its cuts make
    for tau in sorted({part["from_tau"] for part in parts}):
        left = [cut for cut in rows(results["CUTS"]) if cut["persistence"] > tau]
        walls = {p["part"] for p in at(parts, tau, 1)}
        assert len(walls) == 1 + sum(cut["source"] == 1 for cut in left)


def test_multipart_features_are_ranked_as_one(run, layer):
    far = moved(ROOMS, 100)
    both = f"MULTIPOLYGON({DUMBBELL[7:]},{far},((200 0,201 0,201 1,200 1,200 0)))"
    source = layer("MultiPolygon?crs=EPSG:3857", [(both, [])])
    results = hierarchy(run, source)
    parts, cuts = rows(results["OUTPUT"]), rows(results["CUTS"])
    assert_levels(parts, source)
    assert [cut["rank"] for cut in cuts] == [1, 2, 3, 4, 5, 6, 7]
    assert {cut["geometry"].boundingBox().xMinimum() > 50 for cut in cuts[:3]} == {True, False}
    assert len(at(parts, 1.5)) == 10 and len(at(parts, 1e6)) == 3
    assert {p["geometry"].asWkt() for p in at(parts, 1e6)} == {
        QgsGeometry.fromWkt(f"MULTIPOLYGON({polygon})").asWkt()
        for polygon in (DUMBBELL[7:], far, "((200 0,201 0,201 1,200 1,200 0))")
    }
    for count in (3, 5, 10):
        some = hierarchy(run, source, PARTS=count)
        assert some["PART_COUNT"] == count and some["CUT_COUNT"] == count - 3
        assert [cut["rank"] for cut in rows(some["CUTS"])] == list(range(1, count - 2))


def test_z_and_m_stay_bit_for_bit(run, layer):
    points = QgsGeometry.fromWkt(ROOMS).asPolygon()[0]
    ring = [f"{p.x()} {p.y()} {math.sin(k):.17g} {k}.125" for k, p in enumerate(points[:-1])]
    # closed in Z and M too: newer versions of QGIS see no area in a ring that is not
    source = layer("PolygonZM?crs=EPSG:3857", [(f"PolygonZM(({','.join([*ring, ring[0]])}))", [])])
    given = {(v.x(), v.y()): [] for v in source.getFeature(1).geometry().vertices()}
    for v in source.getFeature(1).geometry().vertices():
        given[v.x(), v.y()].append((v.z(), v.m()))
    results = hierarchy(run, source)
    assert_levels(rows(results["OUTPUT"]), source)
    for layer_name in ("OUTPUT", "CUTS"):
        for row in rows(results[layer_name]):
            for v in row["geometry"].vertices():
                assert (v.z(), v.m()) in given[v.x(), v.y()]


def test_degrees_are_metres(run, layer):
    small = re.sub(r"\d+(?:\.\d+)?", lambda m: f"{float(m[0]) / 1e3:g}", ROOMS)
    source = layer("Polygon?crs=EPSG:4326", [(small, [])])
    results = hierarchy(run, source)
    parts, cuts = rows(results["OUTPUT"]), rows(results["CUTS"])
    assert_levels(parts, source)
    plane = rows(hierarchy(run, layer("Polygon?crs=EPSG:3857", [(ROOMS, [])]))["CUTS"])
    # a thousandth of a degree on the equator is 111 m
    # on the ellipsoid another of two ends of a passage that are as good may be cut
    for name, scale, room in (("persistence", 1, 0.2), ("length", 111, 0.01)):
        assert [cut[name] for cut in cuts] == pytest.approx([scale * cut[name] for cut in plane], rel=room)


def test_what_cannot_be_solved_shows_at_every_tau(run, layer, feedback):
    source = layer(
        "MultiPolygon?crs=EPSG:3857&field=tau:double",
        [
            (BOWTIE, [2]),
            (None, [2]),
            (ROOMS, [0.5]),
            ("MULTIPOLYGON EMPTY", [2]),
            (ROOMS, [2]),
            (f"MULTIPOLYGON({BOWTIE[7:]},{moved(DUMBBELL, 20)})", [2]),
            (ROOMS, [NULL]),
            (ROOMS, [1e300]),
        ],
    )
    results = hierarchy(run, source, feedback, TAU=QgsProperty.fromField("tau"))
    parts = rows(results["OUTPUT"])
    assert results["SKIPPED_COUNT"] == 7
    for number, reason in {
        1: "invalid",
        2: "no geometry",
        3: "tau must be",
        4: "empty",
        7: "tau must be",
        8: "tau must be",
    }.items():
        (part,) = [part for part in parts if part["source"] == number]
        assert reason in part["status"].lower() or number == 1 and part["status"]
        assert (part["part"], part["parent"], part["level"]) == (1, NULL, 0)
        assert part in at(parts, 2) and part in at(parts, 1e8)
        assert part["geometry"].asWkt() == source.getFeature(number).geometry().asWkt()
        assert any(text.startswith(f"Feature {number} was not cut") for text in feedback.warnings)
    assert all(part["status"] == "" for part in parts if part["source"] == 5)
    mixed = [part for part in parts if part["source"] == 6]
    assert len(mixed) == 6 and sum(part["status"] != "" for part in mixed) == 1
    assert {cut["source"] for cut in rows(results["CUTS"])} == {5, 6}


def test_parts_by_number_and_expression(run, layer, feedback):
    source = layer("Polygon?crs=EPSG:3857&field=n:integer", [(ROOMS, [k]) for k in (1, 2, 3, 4, 9, NULL, -1)])
    results = hierarchy(run, source, feedback, PARTS=QgsProperty.fromField("n"))
    parts, cuts = rows(results["OUTPUT"]), rows(results["CUTS"])
    everything = [part for part in parts if part["source"] == 6]
    ranked = [cut for cut in cuts if cut["source"] == 6]
    finest = len(at(everything, 1.5))
    assert finest == 6 and len(everything) > finest
    for number, count in ((1, 1), (2, 2), (3, 3), (4, 4), (5, finest)):
        own = [part for part in parts if part["source"] == number]
        assert len(own) == count
        assert all(part["level"] == 0 and part["parent"] == NULL for part in own)
        left = [cut for cut in cuts if cut["source"] == number]
        assert [cut["geometry"].asWkt() for cut in left] == [
            c["geometry"].asWkt() for c in ranked[: count - 1]
        ]
        (least,), (most,) = ({part[name] for part in own} for name in ("from_tau", "to_tau"))
        assert least == (1.5 if count == finest else ranked[count - 1]["persistence"])
        assert most == (NO_END if count == 1 else ranked[count - 2]["persistence"])
        if least < most:  # the same as in the levels
            assert {rings_of(p) for p in at(everything, least)} == {rings_of(p) for p in own}
    (bad,) = [part for part in parts if part["source"] == 7]
    assert "PARTS" in bad["status"]
    assert any(text.startswith("1 feature cannot have so many") for text in feedback.infos)
    by_expression = hierarchy(run, source, PARTS=QgsProperty.fromExpression("1 + 1"))
    assert by_expression["PART_COUNT"] == 2 * 7
    with pytest.raises(QgsProcessingException):
        hierarchy(run, source, PARTS=0)
    with pytest.raises(QgsProcessingException, match="TAU"):
        hierarchy(run, source, TAU=0.5)


@pytest.mark.parametrize("nothing", [None, NULL, ""])
def test_an_optional_number_that_is_nothing_is_not_given(run, layer, nothing):
    """QGIS makes 0 of NULL: a hierarchy of 0 parts, and of parts of 0 per cent."""
    source = layer("Polygon?crs=EPSG:3857", [(DUMBBELL, [])])
    given = {"INPUT": source, "OUTPUT": "memory:", "CUTS": "memory:", "TAU": 1.2, "PLACES": "Any"}
    assert run("isthmus:hierarchy", given | {"PARTS": nothing})["PART_COUNT"] > 3
    least = [
        run("isthmus:partition", given | {"TAU": 4} | one)["CUT_COUNT"]
        for one in ({"SMALLEST_PART": nothing}, {}, {"SMALLEST_PART": 0})
    ]
    assert least[0] == least[1] < least[2]


def test_the_filter_works_in_files(run, layer, tmp_path):
    source = layer("Polygon?crs=EPSG:4326", [(ROOMS, []), (None, []), (DUMBBELL, [])])
    for name in ("parts.gpkg", "parts.geojson", "parts.shp"):
        hierarchy(run, source, OUTPUT=str(tmp_path / name), CUTS=None)
        written = QgsVectorLayer(str(tmp_path / name), "parts", "ogr")
        assert written.isValid()
        for tau in (1.5, 3, 1000):
            assert written.setSubsetString(f"from_tau <= {tau} AND {tau} < to_tau")
            found = [f["source"] for f in written.getFeatures()]
            assert found.count(2) == 1
            if tau == 1000:
                assert sorted(found) == [1, 2, 3]
        assert written.setSubsetString("to_tau = 1000000000")
        assert written.featureCount() == 3


def test_cancelled(run, layer, cancelling):
    source = layer("Polygon?crs=EPSG:3857", [(wkt(coast(300)), [])] * 20)
    feedback = cancelling(3)
    results = hierarchy(run, source, feedback)
    assert any("Cancelled" in text for text in feedback.warnings)
    assert results["PART_COUNT"] < hierarchy(run, source)["PART_COUNT"]


def test_progress_rises(run, layer, feedback):
    source = layer("Polygon?crs=EPSG:3857", [(wkt(coast(300)), [])] * 3)
    hierarchy(run, source, feedback)
    assert feedback.shares == sorted(feedback.shares) and feedback.shares[-1] == 100.0
    assert len(feedback.shares) > 5


def test_style_of_the_parts_shows_the_level_of_a_variable(run, layer):
    source = layer("Polygon?crs=EPSG:3857", [(ROOMS, [])])
    results = hierarchy(run, source)
    parts = results["OUTPUT"]
    parts.loadNamedStyle(str(ROOT / "resources" / "styles" / "hierarchy_parts.qml"))
    (rule,) = parts.renderer().rootRule().children()
    for tau in (None, 1.5, 6.0, 100.0):
        context = QgsExpressionContext(QgsExpressionContextUtils.globalProjectLayerScopes(parts))
        if tau is not None:
            context.lastScope().setVariable("isthmus_tau", tau)
        shown = []
        for feature in parts.getFeatures():
            context.setFeature(feature)
            shown.append(bool(QgsExpression(rule.filterExpression()).evaluate(context)))
        expected = at(rows(parts), 3.0 if tau is None else tau)
        assert sum(shown) == len(expected) > 0
    assert rule.symbol().symbolLayerCount() == 1


def test_style_of_the_cuts_follows_the_persistence(run, layer):
    cuts = hierarchy(run, layer("Polygon?crs=EPSG:3857", [(ROOMS, [])]))["CUTS"]
    cuts.loadNamedStyle(str(ROOT / "resources" / "styles" / "hierarchy_cuts.qml"))
    symbol = cuts.renderer().symbol()
    assert symbol.symbolLayerCount() == 2
    for k in range(2):
        width = (
            symbol.symbolLayer(k)
            .dataDefinedProperties()
            .property(QgsSymbolLayer.Property.PropertyStrokeWidth)
        )
        context, widths = QgsExpressionContext(), []
        for feature in cuts.getFeatures():
            context.setFeature(feature)
            context.setFields(cuts.fields())
            value, valid = width.valueAsDouble(context)
            assert valid and value > 0
            widths.append(value)
        assert widths == sorted(widths, reverse=True) and widths[0] > widths[-1]


def test_the_line_for_a_slider_runs(provider):
    tool = QgsApplication.processingRegistry().algorithmById("isthmus:hierarchy")
    (line,) = re.findall(r"<p>(from qgis.*?)</p>", tool.shortHelpString())

    class Canvas:
        refreshed = 0

        def mapCanvas(self):
            return self

        def refreshAllLayers(self):
            self.refreshed += 1

    names = {
        "iface": Canvas(),
        "QgsProject": QgsProject,
        "QgsExpressionContextUtils": QgsExpressionContextUtils,
    }
    exec(html.unescape(line), names)
    names["slider"].setValue(45)
    project = QgsProject.instance()
    assert float(QgsExpressionContextUtils.projectScope(project).variable("isthmus_tau")) == 4.5
    assert names["iface"].refreshed >= 1
    names["slider"].close()
    QgsExpressionContextUtils.setProjectVariables(project, {})
