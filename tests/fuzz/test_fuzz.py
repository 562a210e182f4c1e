"""A short run of what `./run fuzz` does for long: hostile layers through the real tools."""

from collections import Counter

import numpy as np
import pytest

pytest.importorskip("qgis.core", reason="these tests need QGIS")

import cases  # noqa: E402
import cuts  # noqa: E402
import frame  # noqa: E402
import holds  # noqa: E402
import hostile  # noqa: E402

SEED = 20160927


def test_hostile_layers(tools):
    print(f"seed {SEED}")
    counts, failures = Counter(), {}
    frame.attack(cuts, "partition", SEED, 45, counts, failures)
    print(dict(counts))
    assert not failures
    assert counts["polygons solved"] > 50


def test_every_kind_place_and_mutation(tools):
    """Each alone, so that none is missing because of the dice."""
    recipes = [(kind, "as it is", ()) for kind in hostile.KINDS]
    recipes += [("tour", place, ()) for place in hostile.PLACES]
    recipes += [("lattice_mosaic", "as it is", (name,)) for name in hostile.MUTATIONS]
    for crs in ("EPSG:25832", "EPSG:4326"):
        features = [
            (hostile.geometry(kind, SEED + k, place, mutations).hex(), ["x"])
            for k, (kind, place, mutations) in enumerate(recipes)
        ]
        case = cases.Case(
            parameters={"TAU": 2.0, "MAX_GAP": 0.1, "OBJECTIVE": "MinSize", "MIN_LENGTH": 0.0,
                        "MIN_HOLE": 0.0},
            fields=[("name", "String")], features=features, crs=crs, twin=True,
        )  # fmt: skip
        outcome = cases.run(case)
        counts = holds.check(case, outcome, np.random.default_rng(SEED))
        cases.clean(outcome)
        assert counts["features solved"] > 35 and counts["features passed through"] > 6
        assert counts["features told otherwise"] == len(recipes)


# ---------------------------------------------------------------- the checks can fail


@pytest.fixture
def solved(tools):
    """A case with its outcome, to be spoilt."""
    features = [(hostile.geometry("tour", k).hex(), ["x"]) for k in range(5)]
    case = cases.Case(
        parameters={"TAU": 2.0, "MAX_GAP": 0.1, "OBJECTIVE": "MinSize", "MIN_LENGTH": 0.0,
                    "MIN_HOLE": 0.0},
        fields=[("name", "String")], features=features,
    )  # fmt: skip
    outcome = cases.run(case)
    yield case, outcome
    cases.clean(outcome)


def fails(solved, words, **changes):
    case, outcome = solved
    with pytest.raises(AssertionError, match=words):
        holds.check(case._replace(**changes), outcome, np.random.default_rng(1))


def test_a_lost_feature_is_seen(solved):
    layer = solved[1].layers["OUTPUT"]
    last = max(f.id() for f in layer.getFeatures())
    layer.dataProvider().deleteFeatures([last])
    fails(solved, "PART_COUNT")


def test_a_moved_vertex_is_seen(solved):
    layer = solved[1].layers["OUTPUT"]
    geometry = next(layer.getFeatures()).geometry()
    point = geometry.vertexAt(1)
    geometry.moveVertex(np.nextafter(point.x(), 1e9), point.y(), 1)
    layer.dataProvider().changeGeometryValues({next(layer.getFeatures()).id(): geometry})
    fails(solved, "a coordinate was changed")


def test_a_changed_attribute_is_seen(solved):
    layer = solved[1].layers["OUTPUT"]
    layer.dataProvider().changeAttributeValues({next(layer.getFeatures()).id(): {0: "y"}})
    fails(solved, "'y'")


def test_a_dilation_beyond_tau_is_seen(solved):
    fails(solved, "beyond tau", parameters={**solved[0].parameters, "TAU": 1.9})


def test_a_cut_too_many_is_seen(solved):
    """What is right for tau = 2 has too many cuts for tau = 4."""
    case, outcome = solved
    small = case._replace(features=[(hostile.geometry("small_tour", k).hex(), ["x"]) for k in range(30)])
    outcome = cases.run(small)
    larger = small._replace(parameters={**small.parameters, "TAU": 4.0})
    with pytest.raises(AssertionError, match="cost .* best"):
        holds.check(larger, outcome, np.random.default_rng(1))
    cases.clean(outcome)
