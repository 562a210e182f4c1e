"""The tools isthmus:prepareaggregation and isthmus:aggregate, on small maps."""

import gc
import json
import math
import re
from pathlib import Path
from random import Random

import pytest

qgis_core = pytest.importorskip("qgis.core")

from isthmus.algorithms.aggregation.aggregate import AggregateAlgorithm  # noqa: E402
from isthmus.algorithms.aggregation.areas import text, texts  # noqa: E402
from isthmus.algorithms.aggregation.prepare_aggregation import PrepareAggregationAlgorithm  # noqa: E402
from isthmus.algorithms.layers.source import Reader  # noqa: E402
from qgis.core import (  # noqa: E402
    Qgis,
    NULL,
    QgsFeature,
    QgsGeometry,
    QgsLineString,
    QgsPoint,
    QgsPolygon,
    QgsProcessingContext,
    QgsProcessingFeatureSource,
    QgsProcessingFeedback,
    QgsProcessingOutputLayerDefinition,
    QgsProcessingUtils,
    QgsProject,
    QgsRenderContext,
    QgsVectorLayer,
)

ROOT = Path(__file__).resolve().parents[2]
# two squares of side 10, joined by a corridor of width 1
DUMBBELL = "Polygon ((0 0, 10 0, 10 4, 20 4, 20 0, 30 0, 30 10, 20 10, 20 5, 10 5, 10 10, 0 10, 0 0))"
BELOW = "Polygon ((10 0, 20 0, 20 4, 10 4, 10 0))"
ABOVE = "Polygon ((10 5, 20 5, 20 10, 10 10, 10 5))"
OUTER = "Polygon ((0 -5, 30 -5, 30 0, 0 0, 0 -5))"  # its long side has no nodes


class Listener(QgsProcessingFeedback):
    """Keeps what a tool says."""

    def __init__(self):
        super().__init__(False)
        self.said = []

    def pushInfo(self, text):
        self.said.append(text)

    pushWarning = pushInfo

    def reportError(self, text, fatalError=False):
        self.said.append(text)


def box(x, y, width=10, height=10):
    x1, y1 = x + width, y + height
    return f"Polygon (({x} {y}, {x1} {y}, {x1} {y1}, {x} {y1}, {x} {y}))"


def areas(rows, kind="Polygon", crs="EPSG:25832", fields="code:string(20)&field=name:string(20)"):
    """A layer of (wkt or None, class) rows."""
    layer = QgsVectorLayer(f"{kind}?crs={crs}&field={fields}", "areas", "memory")
    made = []
    for number, (wkt, code) in enumerate(rows):
        feature = QgsFeature(layer.fields())
        feature.setAttributes([code, f"n{number}"])
        if wkt:
            feature.setGeometry(QgsGeometry.fromWkt(wkt))
        made.append(feature)
    assert layer.dataProvider().addFeatures(made)[0]
    return layer


def table(fields, rows):
    layer = QgsVectorLayer("None?" + "&".join(f"field={f}" for f in fields), "table", "memory")
    for row in rows:
        feature = QgsFeature(layer.fields())
        feature.setAttributes(list(row))
        layer.dataProvider().addFeatures([feature])
    return layer


def run(tool, **parameters):
    """Return results, layers and messages of a tool."""
    context, feedback = QgsProcessingContext(), Listener()
    made = tool().create()
    parameters.setdefault("OUTPUT", "memory:")
    allowed, problem = made.checkParameterValues(parameters, context)
    if not allowed:
        return None, {}, [problem]
    results, fine = made.run(parameters, context, feedback)
    if not fine:
        return None, {}, feedback.said
    layers = {}
    for name in ("OUTPUT", "ADJACENCY", "ASSIGNMENT"):
        if name in results:
            layer = QgsProcessingUtils.mapLayerFromString(results[name], context)
            layers[name] = list(layer.getFeatures())
    return results, layers, feedback.said


def prepare(layer, **parameters):
    return run(PrepareAggregationAlgorithm, INPUT=layer, CLASS="code", ADJACENCY="memory:", **parameters)


def aggregate(layer, **parameters):
    chosen = {
        "CLASS": "code",
        "METHOD": "greedy",
        "ASSIGNMENT": "memory:",
        "WEIGHT_BOUNDARY": 1.0,
        **parameters,
    }
    return run(AggregateAlgorithm, INPUT=layer, **chosen)


def vertices(geometry):
    return sorted({(v.x(), v.y(), v.z()) for v in geometry.vertices()}, key=str)


def neck_map(**options):
    return areas([(DUMBBELL, "1"), (BELOW, "2"), (ABOVE, "2"), (OUTER, "3")], **options)


def with_heights(wkt):
    """The same polygon with a height at each vertex."""
    height = re.sub(r"(-?\d+) (-?\d+)", lambda m: f"{m[0]} {int(m[1]) + 100 * int(m[2])}", wkt)
    return height.replace("Polygon", "PolygonZ")


# ---- prepare


def test_prepare_cuts_and_lists_neighbours(qgis_app):
    results, layers, said = prepare(neck_map())
    pieces = layers["OUTPUT"]
    assert results["AREA_COUNT"] == 4
    assert results["PIECE_COUNT"] == len(pieces) == 6
    assert (results["OVERLAP_COUNT"], results["GAP_COUNT"], results["SKIPPED_COUNT"]) == (0, 0, 0)
    assert [p["piece"] for p in pieces] == list(range(1, 7))
    assert [p["area_id"] for p in pieces] == [1, 1, 1, 2, 3, 4]
    assert {p["name"] for p in pieces} == {"n0", "n1", "n2", "n3"}
    for piece in pieces:
        assert piece["size"] == pytest.approx(piece.geometry().area())
    area_of = {p["piece"]: p["area_id"] for p in pieces}
    rows = layers["ADJACENCY"]
    cuts = [row for row in rows if row["virtual"]]
    assert len(cuts) == 2
    for row in rows:
        assert (area_of[row["a"]] == area_of[row["b"]]) == bool(row["virtual"])
    # the whole upper side of the area without nodes is shared
    outer = next(p["piece"] for p in pieces if p["area_id"] == 4)
    assert sum(row["length"] for row in rows if outer in (row["a"], row["b"])) == pytest.approx(30.0)
    assert not [line for line in said if "overlap" in line or "gap" in line]


def test_prepare_loses_nothing_and_says_why(qgis_app):
    bow = "Polygon ((100 0, 110 10, 110 0, 100 10, 100 0))"
    layer = areas([(DUMBBELL, "1"), (None, "2"), (bow, "3"), (box(200, 0), NULL)])
    results, layers, said = prepare(layer)
    assert {p["area_id"] for p in layers["OUTPUT"]} == {1, 2, 3, 4}
    assert results["SKIPPED_COUNT"] == 2
    text = "\n".join(said)
    assert "Area 2 was not cut: it has no geometry" in text
    assert "Area 3 was not cut: invalid geometry" in text
    assert "Without a class: 1 area." in text


def test_prepare_counts_overlaps_and_gaps(qgis_app):
    frame = "Polygon ((0 0, 30 0, 30 30, 0 30, 0 0), (10 10, 10 20, 20 20, 20 10, 10 10))"
    results, _, said = prepare(areas([(frame, "1"), (box(25, 0), "2")]))
    assert results["OVERLAP_COUNT"] == 1
    assert results["GAP_COUNT"] == 1
    assert any("overlap: 1 and 2" in line for line in said)


def test_prepare_takes_several_parts_and_heights(qgis_app):
    wkt = "MultiPolygonZ (((0 0 1, 10 0 2, 10 10 3, 0 0 1)), ((20 0 4, 30 0 5, 30 10 6, 20 0 4)))"
    results, layers, _ = prepare(areas([(wkt, "1")], kind="MultiPolygonZ"))
    assert results["PIECE_COUNT"] == 2
    assert {p["area_id"] for p in layers["OUTPUT"]} == {1}
    found = [v for p in layers["OUTPUT"] for v in vertices(p.geometry())]
    assert sorted(z for *_, z in found) == [1, 2, 3, 4, 5, 6]


def test_sizes_are_square_metres(qgis_app):
    _, layers, _ = prepare(areas([(box(0, 0, 100, 100), "1")], crs="EPSG:2263"))  # US feet
    assert layers["OUTPUT"][0]["size"] == pytest.approx(10_000 * 0.3048**2, rel=1e-4)
    _, layers, _ = prepare(areas([(box(0, 0, 1, 1), "1")], crs="EPSG:4326"))
    assert layers["OUTPUT"][0]["size"] == pytest.approx(12_308_778_361, rel=1e-3)


def test_neighbours_and_floors_in_degrees_are_in_metres(qgis_app):
    """A dumbbell, 10 units to a square; a unit is 1e-4 degrees, 11.1 m to the north and 7.2 m to the east."""
    wkt = re.sub(r"(\d+) (-?\d+)", lambda m: f"{10 + int(m[1]) * 1e-4} {50 + int(m[2]) * 1e-4}", DUMBBELL)
    layer = areas([(wkt, "1")], crs="EPSG:4326")
    results, layers, _ = prepare(layer)
    assert results["PIECE_COUNT"] == 3
    assert [pair["length"] for pair in layers["ADJACENCY"]] == pytest.approx([11.12, 11.12], rel=2e-3)
    assert prepare(layer, MIN_LENGTH=11.0)[0]["PIECE_COUNT"] == 3
    assert prepare(layer, MIN_LENGTH=200.0)[0]["PIECE_COUNT"] == 1


# ---- aggregate


def strip(codes, **options):
    """Squares of 10 m in a row."""
    return areas([(box(10 * k, 0), code) for k, code in enumerate(codes)], **options)


def test_small_areas_join(qgis_app):
    results, layers, _ = aggregate(strip("aaabba"), THRESHOLD=300)
    regions = layers["OUTPUT"]
    assert results["REGION_COUNT"] == len(regions) == 2
    for region in regions:
        assert region["size"] == pytest.approx(region.geometry().area())
        assert region["size"] >= 300
        assert region["areas"] == 3
        assert region["status"] == ""
    assert [r["code"] for r in regions] == ["a", "b"]
    given = layers["ASSIGNMENT"]
    assert len(given) == 6
    assert [a["new_class"] for a in given] == list("aaabbb")
    assert [a["changed"] for a in given] == [0, 0, 0, 0, 0, 1]
    assert results["CHANGED_SHARE"] == pytest.approx(1 / 6)
    assert results["CHANGE_COST"] == pytest.approx(100.0)
    assert results["BOUNDARY_COST"] == pytest.approx(10.0)
    assert results["TOTAL_COST"] == pytest.approx(
        results["CHANGE_COST"] + results["BOUNDARY_COST"] + results["CENTRE_COST"]
    )


@pytest.mark.parametrize("method", ["greedy", "annealing", "exact"])
def test_every_method_runs(qgis_app, method):
    if method == "exact":
        pytest.importorskip("scipy", minversion="1.9")
    results, layers, said = aggregate(
        strip("abababbaab"), THRESHOLD=300, METHOD=method, ITERATIONS=3000, SEED=4
    )
    assert all(r["size"] >= 300 for r in layers["OUTPUT"])
    assert sum(r["size"] for r in layers["OUTPUT"]) == pytest.approx(1000)
    if method == "exact":
        assert type(results["LOWER_BOUND"]) is float  # others are lost on the way out
        assert results["LOWER_BOUND"] == pytest.approx(results["TOTAL_COST"])
        assert any("No solution" in line and "gap 0.00 %" in line for line in said)


def test_annealing_repeats_itself(qgis_app):
    codes = [str((7 * k * k + k) % 5) for k in range(60)]
    options = {"THRESHOLD": 450, "METHOD": "annealing", "ITERATIONS": 20000}
    runs = [
        [a["region"] for a in aggregate(strip(codes), SEED=seed, **options)[1]["ASSIGNMENT"]]
        for seed in (3, 3)
    ]
    assert runs[0] == runs[1]


def test_degrees_are_measured_in_metres(qgis_app):
    square = 0.001
    layer = areas(
        [(box(10 + k * square, 50, square, square), code) for k, code in enumerate("aab")],
        crs="EPSG:4326",
    )
    results, layers, _ = aggregate(layer, THRESHOLD=10_000, WEIGHT_CENTRE=1.0)
    east, north = 71.696, 111.229
    size = east * north
    assert [r["size"] for r in layers["OUTPUT"]] == pytest.approx([3 * size], rel=2e-3)
    # the middle one is the core: two squares are one width away
    spread = (east**2 + north**2) / 12
    centre = size * (math.sqrt(spread) + 2 * math.sqrt(east**2 + spread))
    assert results["CENTRE_COST"] == pytest.approx(centre, rel=5e-3)


def test_the_centre_distance_is_that_of_all_points(qgis_app):
    """Two parts of one area, in feet: its mean square distance to its own centroid counts."""
    parts = "MultiPolygon (((0 0, 10 0, 10 10, 0 10, 0 0)), ((30 0, 40 0, 40 10, 30 10, 30 0)))"
    layer = areas([(parts, "a")], kind="MultiPolygon", crs="EPSG:2263")
    results, _, _ = aggregate(layer, THRESHOLD=0, WEIGHT_CENTRE=1.0)
    foot = 0.3048006096
    away = math.sqrt(15.0**2 + 200.0 / 12.0) * foot
    assert results["CENTRE_COST"] == pytest.approx(200.0 * foot**2 * away, rel=1e-4)


def test_named_weights_and_numbers_that_win(qgis_app):
    def costs_of(**weights):
        chosen = {"WEIGHT_BOUNDARY": None, "THRESHOLD": 300, **weights}
        results = aggregate(strip("aaabba"), **chosen)[0]
        return {name: value for name, value in results.items() if not isinstance(value, str)}

    balanced, keep, compact = (costs_of(WEIGHTS=w) for w in ("balanced", "keep classes", "compact"))
    assert costs_of() == balanced
    assert balanced["BOUNDARY_COST"] == pytest.approx(450.0)
    assert keep["BOUNDARY_COST"] == pytest.approx(450.0 / 4)
    assert compact["BOUNDARY_COST"] == pytest.approx(900.0)
    assert compact["CENTRE_COST"] == pytest.approx(4 * balanced["CENTRE_COST"])
    own = costs_of(WEIGHTS="compact", WEIGHT_BOUNDARY=0.0, WEIGHT_CHANGE=2.0)
    assert own["BOUNDARY_COST"] == 0.0
    assert own["CHANGE_COST"] == pytest.approx(200.0)
    assert own["CENTRE_COST"] == pytest.approx(compact["CENTRE_COST"])


def test_areas_that_lost_their_class_are_counted_and_told(qgis_app):
    layer = areas([(box(0, 0, 40), "a"), (box(40, 0, 16), "b"), (box(56, 0, 12), "c"), (box(68, 0, 40), "a")])
    results, _, said = aggregate(layer, THRESHOLD=300)
    # b is above half of 300, c is not
    assert results["LOST_COUNT"] == 1
    assert "Areas above half of the minimum size that lost their class: 1 of 3 (b: 1 of 1)." in said
    assert "Classes without any region: b (1 area, 0.016 ha), c (1 area, 0.012 ha)." in said


def test_pieces_of_an_area_lose_its_class_by_most_of_its_size(qgis_app):
    rows = [
        (box(0, 0, 30), "a", 1),
        (box(30, 0, 4), "b", 2),
        (box(34, 0, 12), "b", 2),
        (box(46, 0, 30), "c", 3),
    ]
    layer = areas([(wkt, code) for wkt, code, _ in rows])
    layer.dataProvider().changeAttributeValues(
        {f.id(): {1: f"area {area}"} for f, (_, _, area) in zip(layer.getFeatures(), rows)}
    )
    results, layers, _ = aggregate(layer, THRESHOLD=250, AREA_ID="name")
    assert len(layers["OUTPUT"]) == 2
    assert results["LOST_COUNT"] == 1


def test_the_report(qgis_app, tmp_path):
    path = tmp_path / "report.html"
    results, _, _ = aggregate(strip(["a", "a", "a<b", "a<b", "a"]), THRESHOLD=300, REPORT=str(path))
    assert results["REPORT"] == str(path)
    text = path.read_text(encoding="utf-8")
    assert "<script" not in text and "http" not in text
    assert "a&lt;b" in text and "a<b" not in text
    cells = re.findall(r"<tr>(.*?)</tr>", text)
    (total,) = [row for row in cells if row.startswith("<td class=text>total<")]
    assert f"<td>{results['TOTAL_COST']:.6g}</td>" in total
    assert "Minimum size: 300 square metres.</p>" in text
    (lost,) = [row for row in cells if row.startswith("<td class=text>a&lt;b</td><td>2</td>")]
    told = [text for text in re.findall(r"<td[^>]*>([^<]*)", lost) if text]
    assert told == ["a&lt;b", "2", "0.0", "40.0 %", "0", "0.0", "0.0 %"]  # ha, before and after
    (won,) = [row for row in cells if row.startswith("<td class=text>a</td><td>3</td>")]
    told = [text for text in re.findall(r"<td[^>]*>([^<]*)", won) if text]
    assert told == ["a", "3", "0.0", "60.0 %", "1", "0.1", "100.0 %"]
    refused, _, said = aggregate(strip("ab"), REPORT=str(tmp_path / "nothere" / "x.html"))
    assert refused is None and any("report could not be written" in line for line in said)


def test_regions_have_a_colour_for_each_class(qgis_app):
    from qgis.core import QgsExpressionContext, QgsSymbolLayer

    made = QgsVectorLayer(
        "Polygon?field=region:integer&field=code:string(9)&field=size:double&field=areas:integer"
        "&field=core:integer&field=status:string(9)",
        "x",
        "memory",
    )
    made.loadNamedStyle(str(ROOT / "resources" / "styles" / "regions.qml"))
    fill = made.renderer().symbol().symbolLayer(0)
    colour = fill.dataDefinedProperties().property(QgsSymbolLayer.Property.PropertyFillColor)
    found = {}
    for number, code in enumerate(["311", "312", "211", "311"]):
        feature = QgsFeature(made.fields(), number)
        feature.setAttributes([number, code, 10.0 * number, 1, number, ""])
        context = QgsExpressionContext()
        context.setFeature(feature)
        context.setFields(made.fields())
        value, valid = colour.valueAsColor(context)
        assert valid
        found.setdefault(code, set()).add(value.name())
    assert all(len(one) == 1 for one in found.values())
    assert len(set.union(*found.values())) == 3


def test_regions_that_are_loaded_have_a_legend_of_the_classes(qgis_app):
    from isthmus.algorithms.aggregation.style import by_class

    def drawn(found, classes, kind="string(9)"):
        """The colour and the label of each value."""
        made = QgsVectorLayer(f"Polygon?field=region:integer&field=code:{kind}", "x", "memory")
        for value in found:
            feature = QgsFeature(made.fields())
            feature.setAttributes([1, value])
            feature.setGeometry(QgsGeometry.fromWkt(box(0, 0)))
            made.dataProvider().addFeature(feature)
        made.loadNamedStyle(str(ROOT / "resources" / "styles" / "regions.qml"))
        by_class(made, "code", classes)
        renderer, context = made.renderer(), QgsRenderContext()
        renderer.startRender(context, made.fields())
        colours = []
        for feature in made.getFeatures():
            symbol = renderer.symbolForFeature(feature, context)
            colours.append(symbol.color().name())
        renderer.stopRender(context)
        return colours, [item.label() for item in renderer.legendSymbolItems()]

    colours, labels = drawn(["311", "312", "311", NULL], ["312", "311", "512", "312 ", NULL])
    assert labels == ["311", "312", "512", "no class"]
    assert colours[0] == colours[2] and len(set(colours)) == 3
    # a class that is gone does not change the colours of the others, and a number is no text
    assert drawn([311, 312], [512, 312, 311], "integer")[0] == colours[:2]
    many, labels = drawn(["1", "2"], [str(k) for k in range(101)])
    assert labels == [""]  # one symbol, coloured by an expression


def test_the_result_gets_the_legend_when_it_is_loaded(qgis_app):
    context = QgsProcessingContext()
    project = QgsProject()
    context.setProject(project)
    output = QgsProcessingOutputLayerDefinition("memory:", project)
    output.destinationName = "Regions"
    parameters = {
        "INPUT": strip("aab"),
        "CLASS": "code",
        "METHOD": "greedy",
        "THRESHOLD": 150,
        "OUTPUT": output,
    }
    results, fine = AggregateAlgorithm().create().run(parameters, context, Listener())
    assert fine
    details = context.layerToLoadOnCompletionDetails(results["OUTPUT"])
    layer = context.takeResultLayer(results["OUTPUT"])
    details.postProcessor().postProcessLayer(layer, context, Listener())
    assert [item.label() for item in layer.renderer().legendSymbolItems()] == ["a", "b"]


def test_areas_on_top_of_each_other_are_kept(qgis_app):
    layer = areas([(box(0, 0), "a"), (box(0, 0), "a"), (box(10, 0), "b"), (box(5, 2, 2, 2), "b")])
    results, layers, _ = aggregate(layer, THRESHOLD=150)
    assert len(layers["ASSIGNMENT"]) == 4
    assert sum(r["areas"] for r in layers["OUTPUT"]) == 4
    assert sum(r.geometry().area() for r in layers["OUTPUT"]) == pytest.approx(304.0)
    assert prepare(layer)[0]["OVERLAP_COUNT"] == 3


def test_areas_that_overlap_become_a_valid_region(qgis_app):
    around = "Polygon ((0 0, 30 0, 30 20, 0 20, 0 0))"
    layer = areas([(around, "a"), (box(0, 0), "b"), (box(0, -10, 30, 10), "b"), (box(30, 0), "b")])
    _, layers, _ = aggregate(layer, THRESHOLD=900)
    (region,) = [r for r in layers["OUTPUT"] if r["areas"] > 1]
    assert region.geometry().isGeosValid()
    assert sum(r["areas"] for r in layers["OUTPUT"]) == 4
    assert region.geometry().area() == pytest.approx(1000.0)


def test_areas_that_overlap_are_told(qgis_app):
    _, _, said = aggregate(areas([(box(0, 0), "a"), (box(10, 0), "b"), (box(20, 0), "c")]), THRESHOLD=1)
    assert not any("overlap" in line for line in said)
    rows = [(box(0, 0), "a"), (box(10, 0), "b"), (box(18, 0, 12), "c"), (box(0, 0), "b")]
    _, _, said = aggregate(areas(rows), THRESHOLD=1)
    (line,) = [line for line in said if "overlap" in line]
    assert line.startswith("2 pairs of areas overlap: 1 and 4, 2 and 3. ")


def test_a_gap_that_keeps_a_small_area_from_its_neighbour_is_told(qgis_app):
    _, _, said = aggregate(areas([(box(0, 0, 30), "a"), (box(30.001, 0), "b")]), THRESHOLD=200)
    (line,) = [line for line in said if "no boundary in common" in line]
    assert "1 region, such as area 2 beside area 1." in line
    for rows in (
        [(box(0, 0, 30), "a"), (box(40, 0), "b")],  # a gap as wide as the area: an island
        [(box(0, 0, 30), "a"), (box(30, 0), "b")],  # none
        [(box(0, 0, 30), None), (box(30, 0), "b")],  # the neighbour has no class
    ):
        _, _, said = aggregate(areas(rows), THRESHOLD=200)
        assert not any("no boundary in common" in line for line in said)


@pytest.mark.parametrize("tool", [prepare, aggregate])
def test_a_plane_that_is_no_place_to_measure_is_told(qgis_app, tool):
    def told(crs, x, y):
        _, _, said = tool(areas([(box(x, y), "a"), (box(x + 10, y), "b")], crs=crs))
        return [line for line in said if "times as large" in line or "from latitude" in line]

    (line,) = told("EPSG:3857", 1_100_000, 6_650_000)  # at 51.2 degrees north, 1 / cos^2
    assert "EPSG:3857" in line and "2.54 times as large" in line
    assert not told("EPSG:3857", 0, 0)  # true at the equator
    assert not told("EPSG:25832", 500_000, 5_700_000) and not told("EPSG:3035", 4_000_000, 3_000_000)
    assert not told("EPSG:2263", 980_000, 200_000)  # feet, in New York
    assert not told("EPSG:4326", 10, 50)
    (line,) = told("EPSG:4326", 500_000, 5_700_000)
    assert "from latitude 5700000 to 5700010" in line


def test_of_many_areas_without_a_class_some_are_named(qgis_app):
    _, _, said = aggregate(strip([None] * 30 + ["a"] * 3), THRESHOLD=1)
    assert sum("is left as it is" in line for line in said) == 20
    assert "... and 10 more; see the field status." in said


def test_a_number_of_regions(qgis_app):
    for method in ("greedy", "annealing"):
        results, _, _ = aggregate(
            strip("aaaabbbbaaaa"), THRESHOLD=100, METHOD=method, REGIONS=3, ITERATIONS=5000
        )
        assert results["REGION_COUNT"] == 3
    results, _, said = aggregate(strip("aab"), THRESHOLD=200, REGIONS=3)
    assert results["REGION_COUNT"] == 1
    assert any("3 regions were wanted" in line for line in said)


def test_thresholds_and_excluded_classes(qgis_app):
    sizes = table(["class:string(5)", "threshold:double"], [("b", 100.0), ("c", NULL)])
    results, layers, _ = aggregate(strip("aaabccaa"), THRESHOLD=200, THRESHOLDS=sizes)
    kept = {r["code"]: r["size"] for r in layers["OUTPUT"]}
    assert set(kept) == {"a", "b"}
    _, layers, said = aggregate(strip("aaabccaa"), THRESHOLD=100, EXCLUDED="b, c, x")
    assert {r["code"] for r in layers["OUTPUT"]} == {"a"}
    assert any("excluded class x is not on the map" in line for line in said)


def test_distances_from_a_table_and_by_code(qgis_app):
    rows = [("311", "312", 0.1), ("311", "211", 1.0), ("312", "211", 1.0)]
    fields = ["from:string(5)", "to:string(5)", "distance:double"]
    layer = strip(["211", "211", "312", "311", "311"])
    for options in (
        {"DISTANCE": "table", "DISTANCES": table(fields, rows)},
        {"DISTANCE": "code"},
    ):
        results, layers, _ = aggregate(layer, THRESHOLD=200, **options)
        assert [a["new_class"] for a in layers["ASSIGNMENT"]] == ["211", "211", "311", "311", "311"]
        assert results["CHANGE_COST"] == pytest.approx(10.0 if "DISTANCES" in options else 100 / 3)


def test_distances_that_are_not_used_are_told(qgis_app):
    """Whatever is in the table: nobody reads it."""
    plain = aggregate(strip("aab"), THRESHOLD=200)
    for distance in ("equal", "code"):
        given = table(["start:string(5)"], [("a",)])
        results, _, said = aggregate(strip("aab"), THRESHOLD=200, DISTANCE=distance, DISTANCES=given)
        assert any(f"(DISTANCES) is not used, since DISTANCE is {distance}." in line for line in said)
        assert results["TOTAL_COST"] == plain[0]["TOTAL_COST"]
    assert not any("is not used" in line for line in plain[2])


def test_what_a_distance_table_lacks_is_said(qgis_app):
    fields = ["from:string(5)", "to:string(5)", "distance:double"]
    _, _, said = aggregate(strip("abc"), DISTANCE="table", DISTANCES=table(fields, [("a", "b", 1)]))
    assert any("knows nothing of class c" in line for line in said)
    rows = [("a", "b", 1), ("b", "c", 1)]
    _, _, said = aggregate(strip("abc"), DISTANCE="table", DISTANCES=table(fields, rows))
    assert any("lacks 2 pairs" in line and "a > c" in line for line in said)
    _, _, said = aggregate(strip("abc"), DISTANCE="table")
    assert any("DISTANCES" in line for line in said)
    _, _, said = aggregate(strip("ab"), DISTANCE="table", DISTANCES=table(fields[:2], []))
    assert any("has no field distance" in line for line in said)
    _, _, said = aggregate(strip("ab"), DISTANCE="table", DISTANCES=table(fields, [("a", "b", -1)]))
    assert any("from a to b is no number" in line for line in said)


def test_a_missing_class_field_is_said(qgis_app):
    for tool in (PrepareAggregationAlgorithm, AggregateAlgorithm):
        results, _, said = run(tool, INPUT=strip("ab"), CLASS="nothere")
        assert results is None
        assert any("nothere" in line or "CLASS" in line for line in said)


def test_bad_areas_are_kept_and_reported(qgis_app):
    several = f"Multi{box(100, 0).replace('((', '(((').replace('))', ')))')}"
    far = several[:-1] + ", ((200 0, 210 0, 210 10, 200 0)))"
    layer = areas(
        [(box(0, 0), "a"), (box(10, 0), "b"), (None, "a"), (box(20, 0), NULL), (far, "c")],
        kind="MultiPolygon",
    )
    results, layers, said = aggregate(layer, THRESHOLD=150)
    given = {a["name"]: a for a in layers["ASSIGNMENT"]}
    assert len(given) == 5
    assert given["n2"]["region"] == NULL
    assert given["n2"]["status"] == "it has no geometry"
    assert given["n3"]["status"] == "it has no class"
    assert given["n3"]["changed"] == 0
    assert results["SKIPPED_COUNT"] == 2
    assert results["TOO_SMALL_COUNT"] == 0  # the two parts together are 150 large
    assert sum(r.geometry().area() for r in layers["OUTPUT"]) == pytest.approx(450.0)
    text = "\n".join(said)
    assert "Area 3 is left as it is: it has no geometry" in text
    assert "Area 4 is left as it is: it has no class" in text


def test_an_area_that_is_left_costs_nothing(qgis_app):
    alone, _, _ = aggregate(strip("a"), WEIGHT_CENTRE=1.0)
    beside, _, _ = aggregate(strip(["a", NULL]), WEIGHT_CENTRE=1.0)
    assert beside["CENTRE_COST"] == pytest.approx(alone["CENTRE_COST"]) and alone["CENTRE_COST"] > 0


def test_an_island_is_reported(qgis_app):
    layer = areas([(box(0, 0), "a"), (box(10, 0), "b"), (box(100, 0, 5, 5), "b")])
    results, layers, said = aggregate(layer, THRESHOLD=150)
    assert results["TOO_SMALL_COUNT"] == 1
    assert [r["status"] for r in layers["OUTPUT"]] == ["", "too small"]
    assert any("around area 3" in line and "could not be helped" in line for line in said)


def test_a_threshold_larger_than_the_map(qgis_app):
    results, layers, said = aggregate(strip("aab"), THRESHOLD=1e9)
    assert sum(r["size"] for r in layers["OUTPUT"]) == pytest.approx(300.0)
    assert results["CHANGED_SHARE"] == 0.0
    assert any("larger than the map? Those that hang together by shared boundaries have 300 sq" in line
               for line in said)  # fmt: skip
    assert not any("could not be helped" in line for line in said)  # of each region, that would be noise


def test_a_threshold_larger_than_a_map_with_areas_that_are_left(qgis_app):
    """They are no regions that reach their minimum size, and do not hang together with others."""
    large = (box(50, 0, 100, 10), NULL)
    layer = areas([(box(0, 0), "a"), (None, "a"), (box(10, 0), "b"), large])
    results, _, said = aggregate(layer, THRESHOLD=1e9)
    assert (results["TOO_SMALL_COUNT"], results["SKIPPED_COUNT"]) == (2, 2)
    assert any("No region reaches its minimum size" in line and " 200 square metres" in line for line in said)
    assert not any("could not be helped" in line for line in said)
    alone, _, said = aggregate(areas([(None, "a"), large]), THRESHOLD=1e9)
    assert alone["TOO_SMALL_COUNT"] == 0 and not any("No region reaches" in line for line in said)


def test_when_all_classes_are_excluded_that_is_said(qgis_app):
    results, layers, said = aggregate(strip("ab"), THRESHOLD=50, EXCLUDED="a,b")
    assert results["TOO_SMALL_COUNT"] == 2
    assert any("all of them are excluded" in line for line in said)
    assert not any("threshold larger" in line or "large enough" in line for line in said)


def test_small_islands_are_solved_by_the_exact_method_and_that_is_said(qgis_app):
    pytest.importorskip("scipy", minversion="1.9")
    apart = areas([(box(10 * k + 50 * (k // 4), 0), code) for k, code in enumerate("abbaabab")])
    said = aggregate(apart, THRESHOLD=200, METHOD="annealing")[2]
    assert "Solved by the exact method, since they have at most 20 areas: 2 independent parts." in said
    said = aggregate(apart, THRESHOLD=200, METHOD="annealing", ITERATIONS=100)[2]
    assert not any("exact method" in line for line in said)


def test_a_map_that_is_too_large_for_a_proof_is_told(qgis_app, monkeypatch):
    pytest.importorskip("scipy", minversion="1.9")
    monkeypatch.setattr("isthmus.core.aggregation.exact.LARGEST_PROGRAMME", 100)
    said = aggregate(strip("abababbaabab"), THRESHOLD=300, METHOD="exact", SECONDS=2)[2]
    (line,) = [line for line in said if "No solution" in line]
    assert line.startswith("Too large to be solved, and left as annealing found it: 1 independent part. No ")


@pytest.mark.parametrize("method", ["greedy", "annealing"])
def test_python_searches_for_garbage_again_afterwards(qgis_app, method):
    assert gc.isenabled()
    for boundary in (1.0, 1e308):  # the second is refused while the map is read
        results, _, _ = aggregate(
            strip("aab"), THRESHOLD=150, METHOD=method, ITERATIONS=100, WEIGHT_BOUNDARY=boundary
        )
        assert (results is None) == (boundary > 1.0)
        assert gc.isenabled()


def test_an_empty_layer(qgis_app):
    results, layers, said = aggregate(areas([]))
    assert results["REGION_COUNT"] == 0
    assert layers["ASSIGNMENT"] == []
    results, _, _ = prepare(areas([]))
    assert results["PIECE_COUNT"] == 0


def test_impossible_parameters_are_refused(qgis_app):
    for bad in ({"THRESHOLD": -1}, {"WEIGHT_CENTRE": -0.5}, {"METHOD": "magic"}):
        assert aggregate(strip("ab"), **bad)[0] is None
    assert prepare(strip("ab"), TAU=0.5)[0] is None


def test_pieces_are_merged_without_a_trace(qgis_app):
    context = QgsProcessingContext()
    layer = areas(
        [(with_heights(wkt), code) for wkt, code in zip((DUMBBELL, BELOW, ABOVE, OUTER), "1223")],
        kind="PolygonZ",
    )
    tool = PrepareAggregationAlgorithm().create()
    results, _ = tool.run({"INPUT": layer, "CLASS": "code", "OUTPUT": "memory:"}, context, Listener())
    pieces = QgsProcessingUtils.mapLayerFromString(results["OUTPUT"], context)
    assert pieces.featureCount() == 6
    # everything ends in one region: each area is what it was
    _, layers, said = aggregate(pieces, THRESHOLD=400)
    (region,) = layers["OUTPUT"]
    assert region["areas"] == 4
    given = {a["name"]: a for a in layers["ASSIGNMENT"]}
    assert len(layers["ASSIGNMENT"]) == 4
    assert any("area_id" in line for line in said)
    for feature in layer.getFeatures():
        made = given[feature["name"]]
        assert vertices(made.geometry()) == vertices(feature.geometry())
        assert made.geometry().equals(feature.geometry())
        assert made["size"] == pytest.approx(feature.geometry().area())
    assert region.geometry().constGet().ringCount() == 1
    assert {(x, y) for x, y, _ in vertices(region.geometry())} == {
        (0, -5), (30, -5), (30, 0), (30, 10), (20, 10), (10, 10), (0, 10), (0, 0)
    }  # fmt: skip
    assert all(z == x + 100 * y for x, y, z in vertices(region.geometry()))
    # the two squares of the dumbbell end in two regions
    results, layers, _ = aggregate(pieces, THRESHOLD=100)
    assert len({a["region"] for a in layers["ASSIGNMENT"] if a["name"] == "n0"}) >= 2
    assert sum(a.geometry().area() for a in layers["ASSIGNMENT"]) == pytest.approx(450.0)


def test_the_model_runs_in_qgis_process(qgis_process, tmp_path):
    features = [
        {"type": "Feature", "properties": {"code": code},
         "geometry": json.loads(QgsGeometry.fromWkt(wkt).asJson())}
        for wkt, code in ((DUMBBELL, "1"), (BELOW, "2"), (ABOVE, "2"), (OUTER, "3"))
    ]  # fmt: skip
    source, regions, given = (tmp_path / name for name in ("a.geojson", "r.gpkg", "g.gpkg"))
    source.write_text(
        json.dumps(
            {
                "type": "FeatureCollection",
                "features": features,
                "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}},
            }
        )
    )
    qgis_process(
        "run", ROOT / "resources" / "models" / "prepare_and_aggregate.model3", "--",
        f"INPUT={source}", "CLASS=code", "THRESHOLD=120", "METHOD=greedy",
        f"aggregate:regions={regions}", f"aggregate:areas={given}",
    )  # fmt: skip
    made = QgsVectorLayer(str(regions), "r", "ogr")
    assert made.featureCount() >= 2
    assert sum(f.geometry().area() for f in made.getFeatures()) == pytest.approx(450.0)
    assert all(f["size"] >= 120 for f in made.getFeatures())
    assert QgsVectorLayer(str(given), "g", "ogr").featureCount() >= 4


def test_objective_of_the_preparation():
    """A star with many bays: the fewest cuts are not the shortest."""
    random = Random(5)
    radii = [random.uniform(20, 100) for _ in range(50)]
    star = [(r * math.cos(k / 8), r * math.sin(k / 8)) for k, r in enumerate(radii)]
    wkt = "Polygon((%s))" % ", ".join(f"{x} {y}" for x, y in star + star[:1])
    layer = areas([(wkt, "1")])

    def cuts(objective, tau):
        _, layers, _ = prepare(layer, TAU=tau, OBJECTIVE=objective)
        return [pair["length"] for pair in layers["ADJACENCY"]]

    better = 0
    for tau in (1.2, 1.5, 2, 3):
        fewest, shortest = cuts("MinSize", tau), cuts("MinLength", tau)
        assert len(fewest) <= len(shortest)
        assert sum(shortest) <= sum(fewest) + 1e-9
        better += sum(shortest) < sum(fewest) - 1e-9
    assert better


# ---- found by fuzzing


def test_a_null_geometry_in_a_layer_with_heights(qgis_app):
    layer = areas(
        [(with_heights(box(0, 0)), "a"), (None, "a"), (with_heights(box(10, 0)), "b")], kind="PolygonZ"
    )
    results, layers, _ = prepare(layer)
    assert results["AREA_COUNT"] == 3 and len(layers["OUTPUT"]) == 3
    results, layers, _ = aggregate(layer, THRESHOLD=150)
    assert results["SKIPPED_COUNT"] == 1 and len(layers["ASSIGNMENT"]) == 3


@pytest.mark.parametrize("wrong", [math.nan, math.inf, 1e300])
def test_an_area_with_coordinates_that_cannot_be_measured(qgis_app, wrong):
    ring = QgsLineString([QgsPoint(*p) for p in ((0, 0), (10, 0), (wrong, 10), (0, 10), (0, 0))])
    layer = areas([(box(10, 0), "a"), (box(20, 0), "b"), (box(0, 0), "b")])
    odd = QgsFeature(layer.fields())
    odd.setAttributes(["a", "odd"])
    odd.setGeometry(QgsGeometry(QgsPolygon(ring)))
    assert layer.dataProvider().addFeatures([odd])[0]
    if wrong == math.inf and Qgis.QGIS_VERSION_INT // 100 == 334:  # QGIS itself throws
        refused, _, said = aggregate(layer, THRESHOLD=300)
        assert refused is None and any("cannot read INPUT" in line for line in said)
        return
    for method in ("greedy", "annealing"):
        results, layers, said = aggregate(layer, THRESHOLD=300, METHOD=method, ITERATIONS=500)
        assert results["SKIPPED_COUNT"] == 1 and math.isfinite(results["TOTAL_COST"])
        assert [r["size"] for r in layers["OUTPUT"] if r["areas"] > 1] == [pytest.approx(300.0)]
        (given,) = [a for a in layers["ASSIGNMENT"] if a["name"] == "odd"]
        assert "coordinates" in given["status"]
    assert prepare(layer)[0]["PIECE_COUNT"] == 4


def test_one_area_far_away_does_not_blur_the_others(qgis_app):
    """What counts as equal follows from the coordinates around, not from the largest of the layer."""
    near = areas([(box(0, 0), "a"), (box(12, 0), "b")])  # 2 m apart
    assert prepare(near)[1]["ADJACENCY"] == []
    far = areas([(box(0, 0), "a"), (box(12, 0), "b"), (box(4e9, 4e9), "c")])
    assert prepare(far)[1]["ADJACENCY"] == []


def test_costs_that_are_no_numbers_are_refused(qgis_app):
    rows = [("a", "b", 1e308)]
    fields = ["from:string(5)", "to:string(5)", "distance:double"]
    for options, words in (
        ({"WEIGHT_BOUNDARY": 1e308}, "boundary length"),
        ({"WEIGHT_CENTRE": 1e308}, "centre distance"),
        ({"DISTANCE": "table", "DISTANCES": table(fields, rows)}, "class change"),
    ):
        for method in ("greedy", "exact"):
            results, _, said = aggregate(strip("aabb"), THRESHOLD=150, METHOD=method, **options)
            assert results is None
            assert any(f"costs of {words} cannot be computed" in line for line in said)


def test_numbers_that_are_none_are_refused(qgis_app):
    for name in ("REGIONS", "SEED", "ITERATIONS"):
        results, _, said = aggregate(strip("ab"), **{name: math.nan})
        assert results is None and name in said[0]


@pytest.mark.parametrize("name", ["region", "size", "areas", "core", "status"])
def test_a_class_field_with_a_name_of_ours(qgis_app, name):
    layer = areas(
        [(box(10 * k, 0), code) for k, code in enumerate("aaabba")],
        fields=f"{name}:string(20)&field=name:string(20)",
    )
    _, layers, _ = aggregate(layer, THRESHOLD=300, CLASS=name)
    for region in layers["OUTPUT"]:
        values = dict(zip(region.fields().names(), region.attributes()))
        own = {"region", "size", "areas", "core", "status"}
        assert set(values) == own | {f"{name}_2"}
        assert values[name] in ("a", "b")
        ours = {one: values[f"{one}_2" if one == name else one] for one in own}
        assert ours["size"] == pytest.approx(300.0) and ours["areas"] == 3 and ours["status"] == ""


def test_pieces_of_areas_with_fields_of_these_names(qgis_app):
    """The field area_id of the user is not that of the pieces, nor is his size."""
    layer = areas(
        [(DUMBBELL, "1"), (BELOW, "2"), (ABOVE, "2"), (OUTER, "3")],
        fields="code:string(20)&field=area_id:string(20)&field=size:string(20)",
    )
    provider = layer.dataProvider()
    provider.changeAttributeValues({f.id(): {1: "same for all", 2: "large"} for f in layer.getFeatures()})
    context = QgsProcessingContext()
    results, _ = (
        PrepareAggregationAlgorithm()
        .create()
        .run({"INPUT": layer, "CLASS": "code", "OUTPUT": "memory:"}, context, Listener())
    )
    pieces = QgsProcessingUtils.mapLayerFromString(results["OUTPUT"], context)
    _, layers, said = aggregate(pieces, THRESHOLD=400)
    assert any("area_id_2" in line for line in said)
    assert len(layers["ASSIGNMENT"]) == 4
    assert {a["size"] for a in layers["ASSIGNMENT"]} == {"large"}
    assert sum(a["size_2"] for a in layers["ASSIGNMENT"]) == pytest.approx(450.0)


def test_a_region_with_an_invalid_area_is_valid_and_told(qgis_app):
    bow = "Polygon ((0 0, 10 10, 10 0, 0 10, 0 0))"
    _, layers, said = aggregate(areas([(bow, "a"), (box(10, 0), "a"), (box(20, 0), "b")]), THRESHOLD=150)
    assert all(r.geometry().isGeosValid() for r in layers["OUTPUT"])
    assert sum(r.geometry().area() for r in layers["OUTPUT"]) == pytest.approx(250.0)
    assert any(line.startswith("Not valid") and "1 area, 1" in line for line in said)


def test_an_area_that_is_not_cut_stays_bit_for_bit(qgis_app):
    layer = areas([("Polygon ((0 0, 10 10, 10 0, 0 9))", "a")])  # crosses itself, and is not closed
    _, layers, _ = prepare(layer)
    assert layers["OUTPUT"][0].geometry().asWkb() == next(layer.getFeatures()).geometry().asWkb()


def test_the_centroid_of_an_area_that_crosses_itself_is_in_it(qgis_app):
    """Its two halves cancel out: centre distances were those to a place far away."""
    bow = "Polygon ((0 0, 10 10, 10 0, 0 9.999999, 0 0))"
    layer = areas([(bow, "a"), (box(10, 0), "b")])
    results, layers, _ = aggregate(layer, WEIGHT_CENTRE=1.0, THRESHOLD=90, EXCLUDED="b", METHOD="greedy")
    assert [r["code"] for r in layers["OUTPUT"]] == ["a"]
    assert 100.0 * 5.0 <= results["CENTRE_COST"] <= 100.0 * 16.0


def test_the_bound_is_not_above_the_cost(qgis_app):
    """Where large areas must be cores, cheaper ones are exchanged for them afterwards."""
    pytest.importorskip("scipy")
    a, b, c, d, e, f = (
        "1.406 0.792",
        "1.027 0.080",
        "-0.019 0.426",
        "-0.425 1.352",
        "0.761 2.128",
        "-0.195 1.742",
    )
    layer = areas(
        [
            (f"Polygon (({p}, {q}, {r}, {p}))", code)
            for p, q, r, code in ((a, b, c, "c"), (d, a, c, "b"), (e, a, d, "c"), (f, e, d, "c"))
        ]
    )
    results, _, _ = aggregate(
        layer, THRESHOLD=0.7, METHOD="exact", BOUNDARY="classes", WEIGHT_BOUNDARY=1.0, WEIGHT_CENTRE=3.0,
        ITERATIONS=3000,
    )  # fmt: skip
    assert 0.0 < results["LOWER_BOUND"] <= results["TOTAL_COST"]


def test_the_texts_of_a_field_are_those_of_its_values():
    class Row:
        def __init__(self, value):
            self.value = value

        def attribute(self, index):
            return self.value

    values = [1, 1.0, True, "1", " 1", "True", NULL, None, "", "NULL", 311.0, 311.5, 1, NULL]
    assert texts([Row(one) for one in values], 0) == [text(one) for one in values]
    assert texts([Row(NULL), Row("NULL"), Row(True)], 0) == [None, "NULL", "True"]


@pytest.mark.parametrize("keep", [False, True])
def test_a_reader_that_keeps_the_features_gives_the_same(keep):
    layer = areas([(box(0, 0), "a"), (None, "b"), (DUMBBELL, "c"), (box(10, 0), NULL)])
    context = QgsProcessingContext()
    reader, shares = Reader(QgsProcessingFeatureSource(layer, context), Listener(), keep), []
    reader.feedback.setProgress = shares.append
    for _ in range(2):
        found = [(one.id(), one.attributes(), one.geometry().asWkt()) for one in reader]
        assert found == [(one.id(), one.attributes(), one.geometry().asWkt()) for one in layer.getFeatures()]
        assert shares[:4] == sorted(shares[:4]) and shares[3] == 100.0
        reader.done = 0
