"""A short run of the fuzzing of the tools for whole maps; the long one is `./run fuzz maps`."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("qgis.core", reason="these tests need QGIS")
pytest.importorskip("scipy")
pytest.importorskip("hypothesis")

sys.path[:0] = [str(Path(__file__).resolve().parent)]

import frame  # noqa: E402
import maps  # noqa: E402
from qgis.core import QgsApplication  # noqa: E402

SEED = 20240607
CASES = {"prepareaggregation": 30, "aggregate": 40, "focusmap": 35, "prepare_and_aggregate": 8,
         "partition_and_focus_map": 8}  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def _nothing_stays(qgis_app):
    """What holds on to QGIS must go before it does."""
    yield
    # the other short run watches the same tools, and keeps what they raise, with open layers
    getattr(sys.modules.get("cases"), "_raised", []).clear()
    from maps_run import model

    if hasattr(model, "provider"):
        QgsApplication.processingRegistry().removeProvider(model.provider)
        del model.provider


@pytest.mark.parametrize("tool", CASES)
def test_short_run(qgis_app, tool):
    print(f"seed {SEED}")
    counts, failures = maps.Counter(), {}
    frame.attack(maps, tool, SEED, CASES[tool], counts, failures)
    print(dict(counts))
    assert not failures
    assert counts[f"{tool} cases"] >= CASES[tool] // 2


def test_the_checks_notice(qgis_app):
    """What a tool might do wrong is found: these checks are no decoration."""
    import maps_checks as checks
    from maps_run import run

    areas = {
        "type": "Polygon",
        "crs": "EPSG:25832",
        "fields": [["code", "string"], ["key", "integer"]],
        "rows": [
            [geometry, ["ab"[k % 2], k]]
            for k, geometry in enumerate(maps.layers.tessellation(3, "quads", 3, 2, 0.2, 0.0))
        ],
    }
    parameters = {
        "THRESHOLD": 2.5,
        "DISTANCE": "equal",
        "WEIGHT_CHANGE": 1.0,
        "WEIGHT_BOUNDARY": 1.0,
        "WEIGHT_CENTRE": 0.1,
        "BOUNDARY": "regions",
        "METHOD": "exact",
        "SEED": 1,
        "ITERATIONS": 500,
        "SECONDS": 5.0,
        "REGIONS": 0,
        "DECOMPOSE": False,
    }
    case = {
        "tool": "aggregate",
        "layers": {"INPUT": areas},
        "fields": {"CLASS": "code"},
        "parameters": parameters,
        "outputs": ["OUTPUT", "ASSIGNMENT"],
        "output": "memory",
        "thresholds": {},
        "distance": "equal",
        "brute": True,
    }

    def found(change):
        out = run(case)
        change(out)
        return " ".join(checks.check_aggregate(case, out))

    assert found(lambda out: None) == ""
    assert "areas in" in found(lambda out: out.layers["ASSIGNMENT"].pop())
    assert "CHANGE_COST" in found(lambda out: out.results.update(CHANGE_COST=1e3))
    assert "exact costs" in found(lambda out: out.results.update(TOTAL_COST=1e3))
    assert "above the cost" in found(lambda out: out.results.update(LOWER_BOUND=1e9))
    first = lambda out: out.layers["OUTPUT"][0]  # noqa: E731
    assert "too small" in found(lambda out: first(out).setAttribute("size", 0.1))
    assert "union" in found(lambda out: first(out).setGeometry(out.rows["INPUT"][0].geometry()))
