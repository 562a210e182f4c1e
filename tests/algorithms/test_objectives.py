"""OBJECTIVE, WEIGHT and MAX_GAP of the tools that cut."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from qgis.core import QgsProcessingException

from .test_partition import DUMBBELL, partition, rows
from .test_partition_budget import THREE_ROOMS, within_budget


@pytest.fixture
def rooms(layer):
    uri = "Polygon?crs=EPSG:3857&field=dear:double&field=name:string"
    return layer(uri, [(THREE_ROOMS, [10.0, "x"])])


def length(results):
    return sum(c["length"] for c in rows(results["CUTS"]))


@pytest.mark.parametrize("tau", [1.5, 2, 4])
def test_min_length_is_never_longer_and_min_size_never_more(run, rooms, tau):
    fewest = partition(run, rooms, TAU=tau)
    shortest = partition(run, rooms, TAU=tau, OBJECTIVE="MinLength", MAX_GAP=0)
    assert length(shortest) <= length(fewest) * (1 + 1e-12)
    assert fewest["CUT_COUNT"] <= shortest["CUT_COUNT"]
    assert shortest["COST"] == pytest.approx(length(shortest))
    assert shortest["LOWER_BOUND"] == pytest.approx(shortest["COST"], rel=1e-9)
    assert shortest["MAX_DILATION"] <= tau
    part = rows(shortest["OUTPUT"])[0]
    assert part["cost"] == shortest["COST"] and part["gap"] == pytest.approx(0, abs=1e-6)


def test_weights_see_everything(run, rooms, layer):
    """The weight 1 is MinSize, @length is MinLength, and so is what the geometry tells."""
    fewest = partition(run, rooms, TAU=2)
    same = partition(run, rooms, TAU=2, OBJECTIVE="MinWeight", WEIGHT='"dear" / 10', MAX_GAP=0)
    assert same["COST"] == pytest.approx(fewest["CUT_COUNT"])
    costs = [
        partition(run, rooms, TAU=2, OBJECTIVE="MinWeight", WEIGHT=weight, MAX_GAP=0)["COST"]
        for weight in ("@length", "length($geometry)")
    ]
    shortest = partition(run, rooms, TAU=2, OBJECTIVE="MinLength", MAX_GAP=0)
    assert costs == pytest.approx([shortest["COST"]] * 2)
    free = partition(run, rooms, TAU=2, OBJECTIVE="MinWeight", WEIGHT="0")
    assert free["COST"] == free["LOWER_BOUND"] == 0
    steep = partition(run, rooms, TAU=2, OBJECTIVE="MinWeight", WEIGHT="1 / @detour", MAX_GAP=0)
    assert 0 < steep["COST"] < fewest["CUT_COUNT"]


def test_weights_of_own_lines(run, layer):
    source = layer("Polygon?crs=EPSG:3857&field=w:double", [(DUMBBELL, [5.0])])
    lines = layer(
        "LineString?crs=EPSG:3857&field=price:double",
        [("LINESTRING(10 4.5,10 5.5)", [7.0]), ("LINESTRING(12 4.5,12 5.5)", [2.0])],
    )
    results = partition(
        run, source, TAU=5, CANDIDATES=lines, OBJECTIVE="MinWeight", WEIGHT='"price" + "w"',
        MAX_GAP=0,
    )  # fmt: skip
    assert (results["CUT_COUNT"], results["COST"]) == (1, 7.0)


@pytest.mark.parametrize(
    "weight, reason",
    [("-1", "at least 0"), ("NULL", "at least 0"), ("'much'", "at least 0")],
)
def test_a_bad_weight_names_its_candidate(run, rooms, feedback, weight, reason):
    results = partition(run, rooms, feedback, OBJECTIVE="MinWeight", WEIGHT=weight)
    (part,) = rows(results["OUTPUT"])
    assert reason in part["status"] and "LineString" in part["status"]
    assert len(feedback.warnings) == 1


@pytest.mark.parametrize("weight", ["", "1 +", "nope + 1"])
def test_no_weight_is_refused(run, rooms, weight):
    with pytest.raises(QgsProcessingException, match="WEIGHT"):
        partition(run, rooms, OBJECTIVE="MinWeight", WEIGHT=weight)


def test_a_budget_of_length(run, rooms):
    results = within_budget(run, rooms, OBJECTIVE="MinLength", BUDGET=3.0)
    assert length(results) <= 3.0
    tau = rows(results["OUTPUT"])[0]["tau"]
    assert partition(run, rooms, TAU=tau, OBJECTIVE="MinLength", MAX_GAP=0)["COST"] <= 3.0
    less = partition(run, rooms, TAU=tau * (1 - 1e-9), OBJECTIVE="MinLength", MAX_GAP=0)
    assert less["COST"] > 3.0


def western_europe(layer):
    """A layer with an outline that is not solved at once."""
    path = Path(__file__).parents[1] / "data" / "western_europe.csv"
    outline = shapely.Polygon(np.loadtxt(path, delimiter=",", skiprows=1)).simplify(0.32)
    return layer("Polygon?crs=EPSG:4326", [(outline.wkt, [])])


def test_a_search_that_ends_early_says_so(run, layer, feedback, monkeypatch):
    from isthmus.core.partition import features

    monkeypatch.setattr(features, "TIME_LIMIT", 0.0)
    results = partition(run, western_europe(layer), feedback, TAU=6, OBJECTIVE="MinLength", MAX_GAP=0)
    assert results["LOWER_BOUND"] < results["COST"]
    (warning,) = feedback.warnings
    assert "gap" in warning
    part = rows(results["OUTPUT"])[0]
    assert part["gap"] == pytest.approx(100 * (results["COST"] - results["LOWER_BOUND"]) / results["COST"])


@pytest.mark.parametrize("tau", [6, 8, 20, 30])
def test_no_warning_where_the_gap_is_the_one_allowed(run, layer, feedback, tau):
    """A bound that just reaches the target may miss it by a rounding error: that is no lack of time."""
    results = partition(run, western_europe(layer), feedback, TAU=tau, OBJECTIVE="MinLength")
    assert results["COST"] >= results["LOWER_BOUND"] > 0
    assert not feedback.warnings
