"""What a user sees before a tool runs: texts, icon, styles, and what is said when packages miss."""

import builtins
import configparser
import gc
from pathlib import Path

import pytest
from qgis.core import (
    QgsApplication,
    QgsExpressionContext,
    QgsFeature,
    QgsProcessingContext,
    QgsProcessingParameterDefinition,
    QgsProject,
    QgsSymbolLayer,
    QgsVectorLayer,
)

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def tools(provider):
    return provider.algorithms()


def test_metadata_names_the_same_version(provider):
    metadata = configparser.ConfigParser()
    metadata.read(ROOT / "metadata.txt", encoding="utf-8")
    general = metadata["general"]
    assert provider.versionInfo() == general["version"]
    assert general["hasProcessingProvider"] == "yes"
    assert (ROOT / general["icon"]).exists()
    assert provider.id() == "isthmus"


def test_every_tool_explains_itself(tools):
    assert tools
    for tool in tools:
        assert tool.id().startswith("isthmus:")
        assert tool.shortHelpString() and tool.shortDescription() and tool.tags()
        assert not tool.icon().isNull()
        for parameter in tool.parameterDefinitions():
            assert parameter.help(), (tool.id(), parameter.name())
            hidden = QgsProcessingParameterDefinition.Flag.FlagHidden
            assert parameter.description() and not parameter.flags() & hidden


def test_frozen_names(tools):
    """Models and scripts depend on these."""
    names = {
        tool.id(): (
            " ".join(p.name() for p in tool.parameterDefinitions()),
            " ".join(o.name() for o in tool.outputDefinitions()),
        )
        for tool in tools
    }
    numbers = "PART_COUNT CUT_COUNT CUT_LENGTH MAX_DILATION SKIPPED_COUNT COST LOWER_BOUND"
    assert names["isthmus:partition"] == (
        "INPUT TAU OBJECTIVE WEIGHT MIN_LENGTH MIN_HOLE CANDIDATES MAX_GAP OUTPUT CUTS DIAGONALS",
        f"OUTPUT CUTS DIAGONALS {numbers}",
    )
    assert names["isthmus:partitionbudget"] == (
        "INPUT BUDGET OBJECTIVE WEIGHT MIN_LENGTH MIN_HOLE CANDIDATES OUTPUT CUTS DIAGONALS",
        f"OUTPUT CUTS DIAGONALS {numbers}",
    )
    assert names["isthmus:tradeoff"] == (
        "INPUT OBJECTIVE WEIGHT TAU_MIN TAU_MAX STEPS MIN_LENGTH MIN_HOLE CANDIDATES OUTPUT REPORT",
        "OUTPUT REPORT STEP_COUNT SKIPPED_COUNT",
    )


def test_defaults(tools):
    (tool,) = [tool for tool in tools if tool.id() == "isthmus:partition"]
    parameters = {p.name(): p for p in tool.parameterDefinitions()}
    assert parameters["TAU"].defaultValue() == 4 and parameters["TAU"].isDynamic()
    assert parameters["OBJECTIVE"].defaultValue() == "MinSize"
    assert parameters["OBJECTIVE"].options() == ["MinSize", "MinLength", "MinWeight"]
    assert parameters["CUTS"].createByDefault() and not parameters["DIAGONALS"].createByDefault()


def load(destinations):
    """Load results as the window does: each on top of the one before, in the order of their ids."""
    from isthmus.algorithms.base import style_on_load

    project = QgsProject()
    context = QgsProcessingContext()
    context.setProject(project)
    layers = {}
    for style, kind, name in destinations:
        layer = QgsVectorLayer(kind, name, "memory")
        layers[layer.id()] = layer
        details = QgsProcessingContext.LayerDetails(name, project, name)
        context.addLayerToLoadOnCompletion(layer.id(), details)
        style_on_load(context, layer.id(), style)
    for key, details in context.layersToLoadOnCompletion().items():
        project.addMapLayer(layers[key])
        details.postProcessor().postProcessLayer(layers[key], context, None)
    return project


def test_loaded_results_are_styled_and_cuts_lie_on_top(provider):
    for _ in range(3):  # the context of a run takes its post-processors with it
        results = (("cuts.qml", "LineString", "Cuts"), ("parts.qml", "Polygon", "Parts"))
        project = load(results)
        tree = project.layerTreeRoot().layerOrder()
        assert [layer.name() for layer in tree] == ["Cuts", "Parts"]
        assert [layer.renderer().symbol().symbolLayerCount() for layer in tree] == [2, 1]
        gc.collect()


def test_parts_have_eight_colours_whatever_their_fields(qgis_app):
    for kind in ("Polygon", "Polygon?field=piece:integer"):
        parts = QgsVectorLayer(kind, "x", "memory")
        parts.loadNamedStyle(str(ROOT / "resources" / "styles" / "parts.qml"))
        fill = parts.renderer().symbol().symbolLayer(0)
        colour = fill.dataDefinedProperties().property(
            QgsSymbolLayer.Property.PropertyFillColor
        )
        colours = set()
        for number in range(-9, 9):  # new features of a layer in editing have negative ids
            context = QgsExpressionContext()
            context.setFeature(QgsFeature(parts.fields(), number))
            value, valid = colour.valueAsColor(context)
            assert valid
            colours.add(value.name())
        assert len(colours) == 8


@pytest.mark.parametrize("absent", [{"shapely"}, {"triangle"}, {"shapely", "triangle"}])
def test_missing_packages(provider, run, layer, monkeypatch, absent):
    """The tools stay listed; running one says which command installs what."""
    from isthmus.algorithms import base

    real = builtins.__import__

    def without(name, *arguments, **more):
        if name.split(".")[0] in absent:
            raise ImportError(f"No module named '{name}'")
        return real(name, *arguments, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    source = layer("Polygon?crs=EPSG:3857", [("POLYGON((0 0,9 0,9 9,0 9,0 0))", [])])
    parameters = {"INPUT": source, "OUTPUT": "memory:"}
    registry = QgsApplication.processingRegistry()
    tool = registry.algorithmById("isthmus:partition")
    assert tool is not None
    if "shapely" not in absent:
        assert run("isthmus:partition", parameters)["PART_COUNT"] == 1
        return
    problem = base.dependency_problem()
    assert "shapely" in problem and "pip install" in problem and "numpy==" in problem
    ok, message = tool.canExecute()
    assert not ok and message == problem
    assert tool.checkParameterValues(parameters, QgsProcessingContext()) == (False, problem)


def test_an_old_shapely_is_told_apart(monkeypatch):
    from isthmus.core import triangulation

    class Shapely1:
        __version__ = "1.8.5"

    class Shapely20:
        __version__ = "2.0.7"

        def get_coordinates():
            """Shapely 2 has this one."""

    monkeypatch.setattr(triangulation, "engine_name", lambda: "")
    assert "shapely 2 is needed, and 1.8.5" in triangulation.missing_packages(Shapely1)
    assert "triangle, or shapely 2.1 instead of 2.0.7" in triangulation.missing_packages(Shapely20)
