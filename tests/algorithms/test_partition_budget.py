"""isthmus:partitionbudget and isthmus:tradeoff."""

import math
import re
from pathlib import Path

import pytest
from isthmus.core.partition import features
from qgis.core import NULL, QgsProcessingException, QgsProperty, QgsVectorLayer

from .test_partition import ANNULUS, BOWTIE, DUMBBELL, EVERYWHERE, partition, rows

THREE_ROOMS = (
    "POLYGON((0 0,10 0,10 4.5,12 4.5,12 0,22 0,22 4,24 4,24 0,34 0,34 10,24 10,24 6,22 6,22 10,"
    "12 10,12 5.5,10 5.5,10 10,0 10,0 0))"
)
OUTLINE = Path(__file__).resolve().parents[1] / "data" / "western_europe.csv"


def within_budget(run, source, feedback=None, **more):
    parameters = {"INPUT": source, **EVERYWHERE, "OUTPUT": "memory:", "CUTS": "memory:", **more}
    return run("isthmus:partitionbudget", parameters, feedback)


@pytest.fixture
def rooms(layer):
    return layer("Polygon?crs=EPSG:3857&field=n:integer", [(THREE_ROOMS, [2])])


@pytest.fixture(scope="module")
def western_europe():
    """As a plane in kilometres, without CRS; see tests/data/README.md."""
    points = []
    for line in OUTLINE.read_text().splitlines()[1:]:
        lon, lat = map(float, line.split(","))
        x = (lon - 10) * math.cos(math.radians(lat)) * 111.32
        points.append(f"{x!r} {(lat - 48) * 111.32!r}")
    return "POLYGON((%s))" % ",".join(points + points[:1])


@pytest.mark.parametrize("tau, cuts", [(2, 509), (4, 151), (6, 77), (10, 40)])
def test_western_europe(run, layer, western_europe, tau, cuts):
    source = layer("Polygon", [(western_europe, [])])
    results = partition(run, source, TAU=tau)
    assert results["CUT_COUNT"] == results["COST"] == results["LOWER_BOUND"] == cuts
    assert results["MAX_DILATION"] <= tau


def test_the_budget_is_used_well(run, rooms):
    previous = math.inf
    for budget in range(5):
        results = within_budget(run, rooms, BUDGET=budget)
        parts = rows(results["OUTPUT"])
        assert results["CUT_COUNT"] <= budget
        tau = parts[0]["tau"]
        assert tau == results["MAX_DILATION"] < previous
        assert parts[0]["cost"] == results["COST"] and parts[0]["gap"] == 0
        # the same by asking for tau, and no smaller tau at that price
        assert partition(run, rooms, TAU=tau)["CUT_COUNT"] <= budget
        assert partition(run, rooms, TAU=tau * (1 - 1e-9))["CUT_COUNT"] > budget
        previous = tau


def test_budget_from_a_field(run, rooms):
    assert within_budget(run, rooms, BUDGET=QgsProperty.fromField("n"))["CUT_COUNT"] == 2


def test_a_budget_that_cannot_be_met(run, layer, feedback):
    source = layer("Polygon?crs=EPSG:3857", [(ANNULUS, []), (DUMBBELL, []), (BOWTIE, [])])
    results = within_budget(run, source, feedback, BUDGET=0)
    statuses = [row["status"] for row in rows(results["OUTPUT"])]
    assert "least possible cost is 1" in statuses[0]
    assert statuses[1] == ""
    assert "Self-intersection" in statuses[2]
    assert rows(results["OUTPUT"])[0]["tau"] == NULL
    assert results["SKIPPED_COUNT"] == len(feedback.warnings) == 2


def test_a_detour_that_is_not_proven_least_is_told(run, rooms, feedback, monkeypatch):
    together = features.together
    monkeypatch.setattr(features, "together", lambda *given: [(a, False) for a, _ in together(*given)])
    results = within_budget(run, rooms, feedback, BUDGET=2)
    (text,) = feedback.warnings
    assert f"Feature 1: a smaller detour than {results['MAX_DILATION']:.6g} may be possible" in text


@pytest.mark.parametrize("budget", [-1, math.nan])
def test_bad_budget(run, rooms, budget):
    with pytest.raises(QgsProcessingException, match="BUDGET"):
        within_budget(run, rooms, BUDGET=budget)


def test_tradeoff(run, rooms, tmp_path):
    report = tmp_path / "report.html"
    results = run(
        "isthmus:tradeoff",
        {"INPUT": rooms, "TAU_MIN": 1.5, **EVERYWHERE, "OUTPUT": "memory:", "REPORT": str(report)},
    )
    steps = rows(results["OUTPUT"])
    assert len(steps) == results["STEP_COUNT"] > 3
    assert [s["cuts"] for s in steps] == sorted({s["cuts"] for s in steps})
    assert [s["tau"] for s in steps] == sorted((s["tau"] for s in steps), reverse=True)
    assert steps[0]["cuts"] == 0 and steps[0]["largest_part_share"] == 1
    for step in steps:
        assert step["cost"] == step["cuts"]
        budget = within_budget(run, rooms, BUDGET=step["cuts"])
        if step["tau"] > 1.5:
            assert budget["MAX_DILATION"] == step["tau"]
        solution = partition(run, rooms, TAU=step["tau"])
        assert solution["CUT_COUNT"] == step["cuts"]
        assert solution["CUT_LENGTH"] == pytest.approx(step["length"])
        areas = [p["geometry"].area() for p in rows(solution["OUTPUT"])]
        assert step["largest_part_share"] == pytest.approx(max(areas) / sum(areas))
    text = report.read_text(encoding="utf-8")
    assert text.count("<svg") == 1 and "http" not in text
    assert re.findall(r"<circle", text)
    assert "<h2>Feature 1</h2>" in text
    shown = re.findall(r"<tr><td>([\d.]+)</td><td>(\d+)</td>", text)
    assert shown
    for tau, cuts in shown:  # a tau of the report, typed into the dialog, gives what it says
        assert len(tau.split(".")[1]) == 2
        assert partition(run, rooms, TAU=float(tau))["CUT_COUNT"] == int(cuts)


def test_report_calls_features_by_their_names(run, layer, tmp_path):
    report = tmp_path / "report.html"
    source = layer("Polygon?crs=EPSG:3857&field=name:string", [(THREE_ROOMS, ["<Rooms>"])])
    run("isthmus:tradeoff", {"INPUT": source, "OUTPUT": "memory:", "REPORT": str(report)})
    assert "<h2>&lt;Rooms&gt; (feature 1)</h2>" in report.read_text(encoding="utf-8")


def test_tradeoff_stops_where_it_is_told_to(run, layer, feedback, tmp_path):
    source = layer("Polygon?crs=EPSG:3857", [(THREE_ROOMS, []), (BOWTIE, []), (None, [])])
    results = run(
        "isthmus:tradeoff",
        {"INPUT": source, "STEPS": 2, "TAU_MIN": 1, "TAU_MAX": 30, **EVERYWHERE, "OUTPUT": "memory:"},
        feedback,
    )
    steps = rows(results["OUTPUT"])
    assert len(steps) == 2 and steps[0]["tau"] <= 30
    assert results["SKIPPED_COUNT"] == len(feedback.warnings) == 2
    with pytest.raises(QgsProcessingException, match="TAU_MAX"):
        run("isthmus:tradeoff", {"INPUT": source, "TAU_MIN": 5, "TAU_MAX": 4, "OUTPUT": "memory:"})


def test_tradeoff_to_a_table_file(run, rooms, tmp_path):
    path = str(tmp_path / "steps.csv")
    run("isthmus:tradeoff", {"INPUT": rooms, "TAU_MIN": 2, **EVERYWHERE, "OUTPUT": path})
    assert QgsVectorLayer(path).featureCount() >= 3


def test_tradeoff_of_a_polygon_whose_area_no_double_holds(run, layer, tmp_path):
    wkt = "POLYGON((0 0,1e200 0,1e200 1e200,0 1e200,0 0))"
    report = tmp_path / "report.html"
    results = run(
        "isthmus:tradeoff",
        {
            "INPUT": layer("Polygon", [(wkt, [])]),
            "TAU_MIN": 1,
            **EVERYWHERE,
            "OUTPUT": "memory:",
            "REPORT": str(report),
        },
    )
    steps = rows(results["OUTPUT"])
    assert [s["cuts"] for s in steps] == [0, 1]
    assert {s["largest_part_share"] for s in steps} == {NULL}
    assert "nan" not in report.read_text(encoding="utf-8")
