"""The tool in a saved model, and through the real qgis_process."""

import json

import pytest
from qgis.core import (
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingModelAlgorithm,
    QgsProcessingModelChildAlgorithm,
    QgsProcessingModelChildParameterSource,
    QgsProcessingModelOutput,
    QgsProcessingModelParameter,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterNumber,
    QgsVectorLayer,
)

ROOMS = {  # two squares and the corridor between them
    "type": "FeatureCollection",
    "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::3857"}},
    "features": [
        {
            "type": "Feature",
            "properties": {"name": "rooms"},
            "geometry": {
                "type": "Polygon",
                "coordinates": [[
                    [0, 0], [10, 0], [10, 4.5], [12, 4.5], [12, 0], [22, 0], [22, 10], [12, 10],
                    [12, 5.5], [10, 5.5], [10, 10], [0, 10], [0, 0],
                ]],
            },
        }
    ],
}  # fmt: skip


@pytest.fixture
def rooms(tmp_path):
    path = tmp_path / "rooms.geojson"
    path.write_text(json.dumps(ROOMS))
    return path


@pytest.fixture
def model(provider, tmp_path):
    """A model of one step, tau being its input, read back from its file."""
    source, number = QgsProcessingModelChildParameterSource, QgsProcessingParameterNumber
    model = QgsProcessingModelAlgorithm("Rooms", "test")
    model.addModelParameter(
        QgsProcessingParameterFeatureSource("polygons", "Polygons"),
        QgsProcessingModelParameter("polygons"),
    )
    model.addModelParameter(
        number("detour", "Detour", number.Type.Double), QgsProcessingModelParameter("detour")
    )
    child = QgsProcessingModelChildAlgorithm("isthmus:partition")
    child.setChildId("cut")
    child.addParameterSources("INPUT", [source.fromModelParameter("polygons")])
    child.addParameterSources("TAU", [source.fromModelParameter("detour")])
    child.addParameterSources("PLACES", [source.fromStaticValue("Any")])
    child.addParameterSources("SMALLEST_PART", [source.fromStaticValue(0)])
    outputs = {}
    for name in ("OUTPUT", "CUTS"):
        output = QgsProcessingModelOutput(name.lower())
        output.setChildId("cut")
        output.setChildOutputName(name)
        outputs[name.lower()] = output
    child.setModelOutputs(outputs)
    model.addChildAlgorithm(child)
    path = tmp_path / "rooms.model3"
    assert model.toFile(str(path))
    return path


def results_of(answer):
    return json.loads(answer[answer.index("{") :])["results"]


def test_model(model, rooms, tmp_path):
    saved = QgsProcessingModelAlgorithm()
    assert saved.fromFile(str(model))
    context = QgsProcessingContext()
    results, ok = saved.run(
        {
            "polygons": str(rooms),
            "detour": 4,
            "cut:output": str(tmp_path / "parts.gpkg"),
            "cut:cuts": str(tmp_path / "cuts.gpkg"),
        },
        context,
        QgsProcessingFeedback(False),
    )
    assert ok
    assert QgsVectorLayer(results["cut:output"]).featureCount() == 3
    assert results["CHILD_RESULTS"]["cut"]["CUT_COUNT"] == 2


def test_command_line(qgis_process, rooms, tmp_path):
    parts, cuts = tmp_path / "parts.gpkg", tmp_path / "cuts.shp"
    answer = qgis_process(
        "run", "--json", "isthmus:partition", "--",
        f"INPUT={rooms}", "TAU=4", "PLACES=Any", "SMALLEST_PART=0", f"OUTPUT={parts}", f"CUTS={cuts}",
    )  # fmt: skip
    results = results_of(answer)
    assert (results["PART_COUNT"], results["CUT_COUNT"], results["SKIPPED_COUNT"]) == (3, 2, 0)
    assert results["CUT_LENGTH"] == 2
    assert QgsVectorLayer(str(parts)).featureCount() == 3
    assert QgsVectorLayer(str(cuts)).featureCount() == 2

    message = qgis_process(
        "run", "isthmus:partition", "--", f"INPUT={rooms}", "TAU=0.5", "OUTPUT=never.gpkg",
        fails=True,
    )  # fmt: skip
    assert "must be a number of at least 1" in message


def test_help_in_a_terminal_is_plain_text(qgis_process):
    text = qgis_process("help", "isthmus:aggregate")
    assert "\nThe sum of three parts, each with a weight:\nclass change: size in square metres times" in text
    assert not [line for line in text.splitlines() if "</" in line or "{lists}" in line]
    assert text.count("THRESHOLD: ") == 1
