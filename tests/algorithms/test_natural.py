"""Natural places and the smallest part, in the tools."""

import math

import pytest
from qgis.core import QgsProcessingException, QgsProperty

from .test_partition import partition, rows


def coast(points=400, noise=0.08):
    """Two round lands joined by a neck, fringed with creeks; ring of points."""
    ring = []
    for k in range(points):
        t = 2 * math.pi * k / points
        # a peanut: wide at both ends, narrow in the middle
        r = 1.0 - 0.75 * abs(math.sin(t)) ** 3
        wiggle = 1.0 + noise * (k % 3 == 0)
        ring.append((100 * r * wiggle * math.cos(t), 100 * r * wiggle * math.sin(t)))
    return ring


def wkt(ring, *holes):
    rings = [[*one, one[0]] for one in (ring, *holes)]
    return (
        "POLYGON(" + ",".join("(" + ",".join(f"{x:.6f} {y:.6f}" for x, y in one) + ")" for one in rings) + ")"
    )


@pytest.fixture
def coasts(layer):
    islet = [(-60, 0), (-59, 0), (-59, 1), (-60, 1)]
    return layer(
        "Polygon?crs=EPSG:3857&field=least:double",
        [(wkt(coast()), [1.0]), (wkt(coast(), islet[::-1]), [5.0])],
    )


def defaults(run, source, feedback=None, **more):
    parameters = {"INPUT": source, "OUTPUT": "memory:", "CUTS": "memory:", **more}
    return run("isthmus:partition", parameters, feedback)


def test_defaults_cut_the_neck_and_nothing_else(run, coasts, feedback):
    results = defaults(run, coasts, feedback)
    cuts, parts = rows(results["CUTS"]), rows(results["OUTPUT"])
    assert [cut["source"] for cut in cuts] == [1, 2]
    for cut in cuts:
        middle = cut["geometry"].centroid().asPoint()
        assert math.hypot(middle.x(), middle.y()) < 12, "at the neck"
        assert 40 < cut["share"] <= 50.5
    assert len(parts) == 4
    for part in parts:  # parts can be joined to cuts by the id of their feature
        assert part["source"] == (1 if part["least"] == 1 else 2)
    # the islet attracts no cut, and is told of; every second vertex of the fringe would like one
    (text,) = [text for text in feedback.infos if "Set aside" in text]
    assert "1 hole" in text and "SMALLEST_PART" in text and "PLACES" in text
    assert partition(run, coasts)["CUT_COUNT"] > 10


def test_any_and_nothing_too_small_is_the_paper(run, coasts):
    one = partition(run, coasts, PLACES="Any", SMALLEST_PART=0)
    two = defaults(run, coasts, PLACES="Any", SMALLEST_PART=0, TAU=4)
    assert one["CUT_COUNT"] == two["CUT_COUNT"]
    assert all(cut["share"] is None or not cut["share"] for cut in rows(one["CUTS"]))


def test_smallest_part_from_a_field(run, coasts, feedback):
    by_field = defaults(
        run, coasts, feedback, PLACES="Any", TAU=2, SMALLEST_PART=QgsProperty.fromField("least")
    )
    for number, least in ((1, 1.0), (2, 5.0)):
        own = [c for c in rows(by_field["CUTS"]) if c["source"] == number]
        assert own and all(c["share"] >= least * (1 - 1e-9) for c in own)
    bad = defaults(run, coasts, feedback, SMALLEST_PART=QgsProperty.fromExpression("least - 2"))
    first = [row for row in rows(bad["OUTPUT"]) if row["source"] == 1]
    assert len(first) == 1 and "SMALLEST_PART" in first[0]["status"]


@pytest.mark.parametrize("value", [-1, 101, math.nan])
def test_a_share_that_is_none(run, coasts, value):
    with pytest.raises(QgsProcessingException, match="SMALLEST_PART"):
        defaults(run, coasts, SMALLEST_PART=value)


@pytest.mark.parametrize("tool", ["partitionbudget", "tradeoff"])
def test_other_tools_cut_at_the_same_places(run, coasts, tool):
    more = {"BUDGET": 1} if tool == "partitionbudget" else {"TAU_MIN": 3}
    results = run(f"isthmus:{tool}", {"INPUT": coasts, "OUTPUT": "memory:", **more})
    if tool == "partitionbudget":
        assert results["CUT_COUNT"] == 2
    else:
        assert max(row["cuts"] for row in rows(results["OUTPUT"])) == 1


def test_preparation_of_areas_at_natural_places(run, coasts):
    options = {"INPUT": coasts, "CLASS": "least", "OUTPUT": "memory:"}
    assert run("isthmus:prepareaggregation", options)["PIECE_COUNT"] > 10
    natural = {**options, "PLACES": "Natural", "SMALLEST_PART": 1, "TAU": 3}
    assert run("isthmus:prepareaggregation", natural)["PIECE_COUNT"] == 4


# a bay above a sea; an island below the smallest part that fills four fifths of its mouth
BAY = [(-20, 0), (30, 0), (30, 20), (10, 20), (20, 40), (-10, 40), (0, 20), (-20, 20)]
ISLAND = [(1, 20), (5, 19.5), (9, 20), (5, 20.5)]
OVER = {"SMALLEST_PART": 5, "OUTPUT": "memory:", "CUTS": "memory:"}


def measured_wkt(*rings):
    told = (",".join(f"{x} {y} {x - y}" for x, y in [*ring, ring[0]]) for ring in rings)
    return "POLYGON M (%s)" % ",".join(f"({ring})" for ring in told)


@pytest.fixture
def bay(layer):
    return layer("PolygonM?crs=EPSG:3857", [(measured_wkt(BAY, ISLAND), [])])


@pytest.mark.parametrize("tool", ["partition", "partitionbudget", "hierarchy"])
def test_a_cut_over_an_island_is_one_line_and_as_long_as_its_water(run, bay, tool):
    more = {"partition": {"TAU": 3}, "partitionbudget": {"BUDGET": 1}, "hierarchy": {"TAU": 1}}[tool]
    results = run(f"isthmus:{tool}", {"INPUT": bay, **OVER, **more})
    over = [c for c in rows(results["CUTS"]) if len(c["geometry"].asWkt().split(",")) > 2]
    assert len(over) == 1 and over[0]["length"] == pytest.approx(2)
    points = [(v.x(), v.y(), v.m()) for v in over[0]["geometry"].vertices()]
    assert sorted(points) == [(0, 20, -20), (1, 20, -19), (9, 20, -11), (10, 20, -10)]
    parts = [row for row in rows(results["OUTPUT"]) if row.get("level", 0) == 0]
    assert all(row["geometry"].isGeosValid() for row in parts)
    assert sum(row["geometry"].area() for row in parts) == pytest.approx(1000 + 400 - 4)
    if tool == "hierarchy":  # once the cut is gone the island is a hole again
        whole = max(rows(results["OUTPUT"]), key=lambda row: row["geometry"].area())["geometry"]
        assert whole.area() == pytest.approx(1396) and whole.isGeosValid()
        assert whole.constGet().numInteriorRings() == 1
    else:
        assert results["CUT_COUNT"] == 1 and len(parts) == 2
        assert all(row["geometry"].constGet().numInteriorRings() == 0 for row in parts)
