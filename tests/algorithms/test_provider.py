"""What a user sees before a tool runs: texts, icon, styles, and what is said when packages miss."""

import builtins
import configparser
import gc
import html
import sys
from pathlib import Path

import pytest
from qgis.core import (
    QgsApplication,
    QgsExpressionContext,
    QgsFeature,
    QgsProcessingContext,
    QgsProcessingModelAlgorithm,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterNumber,
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


def test_labels_fit_into_the_dialog_as_qgis_opens_it(tools):
    """The form is 380 pixels wide; a longer label moves the buttons out of sight."""
    for tool in tools:
        for parameter in tool.parameterDefinitions():
            optional = QgsProcessingParameterDefinition.Flag.FlagOptional
            label = parameter.description() + " [optional]" * bool(parameter.flags() & optional)
            assert len(label) <= 52, (tool.id(), label)


def test_help_panel_lists_everything(tools):
    for tool in tools:
        panel = tool.shortHelpString()
        assert "{" not in panel and "\n" not in panel
        assert "<b>" not in panel  # QGIS draws it dark in the dark theme, too
        for parameter in tool.parameterDefinitions():
            for text in (parameter.description(), parameter.help()):
                assert html.escape(text) in panel, (tool.id(), parameter.name())


def test_numbers_say_their_units_and_show_few_decimals(tools):
    for tool in tools:
        for parameter in tool.parameterDefinitions():
            if parameter.name() in ("MIN_LENGTH", "MIN_HOLE"):
                assert "layer units" in parameter.description()
                assert "if degrees" in parameter.description()
                # a distance parameter says "degrees" beside the field, where metres are meant
                assert parameter.type() == "number"
            if parameter.name() in ("MIN_HOLE", "THRESHOLD", "BUDGET"):
                assert parameter.maximum() >= 1e15  # the whole earth in square metres
            if parameter.type() == "number" and not parameter.name().startswith("WEIGHT"):
                whole = parameter.dataType() == QgsProcessingParameterNumber.Type.Integer
                shown = parameter.metadata().get("widget_wrapper", {}).get("decimals", 6)
                assert whole or shown <= 3, (tool.id(), parameter.name())


def test_the_first_look_is_short(tools):
    advanced = QgsProcessingParameterDefinition.Flag.FlagAdvanced
    for tool in tools:
        plain = [p for p in tool.parameterDefinitions() if not p.isDestination() and not p.flags() & advanced]
        assert len(plain) <= 9, (tool.id(), len(plain))


@pytest.mark.parametrize("path", sorted((ROOT / "resources" / "models").glob("*.model3")), ids=str)
def test_models_explain_themselves(provider, path):
    model = QgsProcessingModelAlgorithm()
    assert model.fromFile(str(path))
    assert model.helpContent()["ALG_DESC"]
    components = model.parameterComponents()
    names = [p.name() for p in model.parameterDefinitions() if not p.isDestination()]
    assert set(names) == set(components)
    # the dialog shows them in the order in which they stand below each other in the designer
    heights = [components[name].position().y() for name in names]
    assert heights == sorted(heights)
    for parameter in model.parameterDefinitions():
        assert parameter.description() and parameter.help(), parameter.name()
    for child in model.childAlgorithms().values():
        tool = child.algorithm()
        assert tool is not None and tool.id().startswith("isthmus:")
        known = {p.name() for p in tool.parameterDefinitions()}
        assert set(child.parameterSources()) <= known
        for name, sources in child.parameterSources().items():  # named as the tool's own
            assert all(one.parameterName() in ("", name) for one in sources), name


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
        "INPUT TAU OBJECTIVE WEIGHT PLACES SMALLEST_PART MIN_LENGTH MIN_HOLE CANDIDATES NEW_VERTICES MAX_GAP OUTPUT CUTS DIAGONALS",
        f"OUTPUT CUTS DIAGONALS {numbers}",
    )
    assert names["isthmus:partitionbudget"] == (
        "INPUT BUDGET OBJECTIVE WEIGHT PLACES SMALLEST_PART MIN_LENGTH MIN_HOLE CANDIDATES NEW_VERTICES OUTPUT CUTS DIAGONALS",
        f"OUTPUT CUTS DIAGONALS {numbers}",
    )
    assert names["isthmus:tradeoff"] == (
        "INPUT OBJECTIVE WEIGHT TAU_MIN TAU_MAX STEPS PLACES SMALLEST_PART MIN_LENGTH MIN_HOLE CANDIDATES NEW_VERTICES OUTPUT REPORT",
        "OUTPUT REPORT STEP_COUNT SKIPPED_COUNT",
    )
    assert names["isthmus:hierarchy"] == (
        "INPUT TAU PARTS PLACES SMALLEST_PART MIN_LENGTH MIN_HOLE NEW_VERTICES OUTPUT CUTS",
        "OUTPUT CUTS PART_COUNT CUT_COUNT SKIPPED_COUNT",
    )


def test_defaults(tools):
    (tool,) = [tool for tool in tools if tool.id() == "isthmus:partition"]
    parameters = {p.name(): p for p in tool.parameterDefinitions()}
    assert parameters["TAU"].defaultValue() == 3 and parameters["TAU"].isDynamic()
    assert parameters["PLACES"].defaultValue() == "Natural"
    assert parameters["PLACES"].options() == ["Natural", "Any"]
    assert parameters["SMALLEST_PART"].defaultValue() == 1
    for name in ("SMALLEST_PART", "MIN_LENGTH", "MIN_HOLE"):
        assert parameters[name].isDynamic()
    assert parameters["OBJECTIVE"].defaultValue() == "MinSize"
    assert parameters["OBJECTIVE"].options() == ["MinSize", "MinLength", "MinWeight"]
    assert parameters["CUTS"].createByDefault() and not parameters["DIAGONALS"].createByDefault()
    (tool,) = [tool for tool in tools if tool.id() == "isthmus:prepareaggregation"]
    parameters = {p.name(): p for p in tool.parameterDefinitions()}
    assert parameters["PLACES"].defaultValue() == "Any"
    assert parameters["SMALLEST_PART"].defaultValue() == 0


def load(destinations):
    """Load results as the window does: each on top of the one before, in the order of their ids."""
    from isthmus.algorithms.layers.styles import style_on_load

    project = QgsProject()
    context = QgsProcessingContext()
    context.setProject(project)
    layers = {}
    for style, kind, name, rank in destinations:
        layer = QgsVectorLayer(kind, name, "memory")
        layers[layer.id()] = layer
        details = QgsProcessingContext.LayerDetails(name, project, name)
        context.addLayerToLoadOnCompletion(layer.id(), details)
        style_on_load(context, layer.id(), style, rank)
    for key, details in context.layersToLoadOnCompletion().items():
        project.addMapLayer(layers[key])
        details.postProcessor().postProcessLayer(layers[key], context, None)
    return project


def test_loaded_results_are_styled_and_cuts_lie_on_top(provider):
    for _ in range(3):  # the context of a run takes its post-processors with it
        project = load(
            [
                ("parts.qml", "Polygon", "Parts", 3),
                (None, "LineString", "All diagonals", 1),
                ("cuts.qml", "LineString", "Cuts", 0),
                (None, "Polygon", "Focus map", 2),
            ]
        )
        tree = project.layerTreeRoot().layerOrder()
        assert [layer.name() for layer in tree] == ["Cuts", "All diagonals", "Focus map", "Parts"]
        assert [layer.renderer().symbol().symbolLayerCount() for layer in tree] == [2, 1, 1, 1]
        gc.collect()


def test_parts_have_eight_colours_whatever_their_fields(qgis_app):
    for kind in ("Polygon", "Polygon?field=piece:integer"):
        parts = QgsVectorLayer(kind, "x", "memory")
        parts.loadNamedStyle(str(ROOT / "resources" / "styles" / "parts.qml"))
        fill = parts.renderer().symbol().symbolLayer(0)
        colour = fill.dataDefinedProperties().property(QgsSymbolLayer.Property.PropertyFillColor)
        colours = set()
        for number in range(-9, 9):  # new features of a layer in editing have negative ids
            context = QgsExpressionContext()
            context.setFeature(QgsFeature(parts.fields(), number))
            value, valid = colour.valueAsColor(context)
            assert valid
            colours.add(value.name())
        assert len(colours) == 8


@pytest.mark.parametrize(
    "absent", [{"shapely"}, {"triangle"}, {"triangle", "pythoncdt"}, {"shapely", "triangle", "pythoncdt"}]
)
def test_missing_packages(provider, run, layer, monkeypatch, absent):
    """The tools stay listed; running one says which command installs what."""
    from isthmus.algorithms import dependencies

    monkeypatch.delenv("ISTHMUS_ENGINE", raising=False)

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
    problem = dependencies.dependency_problem()
    assert "shapely" in problem and "pip install" in problem and "numpy==" in problem
    ok, message = tool.canExecute()
    assert not ok and message == problem
    assert tool.checkParameterValues(parameters, QgsProcessingContext()) == (False, problem)


@pytest.mark.parametrize(
    "version, machine, wheels",
    [
        ((3, 9), "win-amd64", ["triangle"]),  # QGIS 3.22 on Windows
        ((3, 12), "win-amd64", ["pythoncdt", "triangle"]),
        ((3, 11), "linux-x86_64", ["pythoncdt", "triangle"]),
        ((3, 11), "linux-aarch64", ["pythoncdt"]),
        ((3, 14), "linux-x86_64", ["pythoncdt"]),
        ((3, 14), "linux-aarch64", ["pythoncdt"]),
        ((3, 9), "macosx-x86_64", []),
        ((3, 9), "linux-aarch64", []),
        ((3, 12), "win-arm64", []),
    ],
)
def test_the_engine_to_install_is_one_that_has_a_wheel(monkeypatch, version, machine, wheels):
    """The free one first; and the licence is said of the one that is not."""
    from isthmus.algorithms import dependencies

    assert dependencies.engines_with_wheels(version=version, machine=machine) == wheels
    monkeypatch.setattr(dependencies, "engines_with_wheels", lambda: wheels)
    hint = dependencies.install_hint("1.24.2")
    assert [name for name in ("pythoncdt", "triangle") if f'" {name} "numpy==1.24.2"' in hint] == wheels[:1]
    assert ("commercial" in hint) == ("triangle" in hint) == (wheels == ["triangle"])


def test_requirements_ask_for_the_same_wheels():
    """What `./run` installs here is what the messages would name."""
    from isthmus.algorithms import dependencies
    from packaging.requirements import Requirement

    text = "".join((ROOT / name).read_text() for name in ("requirements.txt", "tools/requirements-test.txt"))
    lines = (line.split("#")[0].strip() for line in text.splitlines())
    wanted = {r.name: r.marker for r in map(Requirement, filter(None, lines))}
    machines = {
        "linux-x86_64": ("linux", "x86_64"),
        "linux-aarch64": ("linux", "aarch64"),
        "win-amd64": ("win32", "AMD64"),
        "win-arm64": ("win32", "ARM64"),
        "macosx-x86_64": ("darwin", "x86_64"),
        "macosx-arm64": ("darwin", "arm64"),
    }
    for minor in range(9, 18):
        for machine, (system, processor) in machines.items():
            place = {
                "python_version": f"3.{minor}",
                "sys_platform": system,
                "platform_machine": processor,
                "implementation_name": "cpython",
            }
            wheels = dependencies.engines_with_wheels(version=(3, minor), machine=machine)
            assert [name for name in ("pythoncdt", "triangle") if wanted[name].evaluate(place)] == wheels


def test_the_note_on_a_slow_engine(monkeypatch):
    """Only where shapely is not a choice; and only a package that can be installed is named."""
    from isthmus.algorithms.partition import solving

    monkeypatch.delenv("ISTHMUS_ENGINE", raising=False)
    for name in ("triangle", "pythoncdt"):
        monkeypatch.setitem(sys.modules, name, None)
    for wheels, said in (
        (["pythoncdt", "triangle"], "pythoncdt is faster"),
        (["triangle"], "commercially"),
        ([], "slower."),
    ):
        monkeypatch.setattr(solving, "engines_with_wheels", lambda wheels=wheels: wheels)
        assert said in solving.slow_engine_note()
    monkeypatch.setenv("ISTHMUS_ENGINE", "shapely")
    assert solving.slow_engine_note() == ""


def test_an_old_shapely_is_told_apart(monkeypatch):
    from isthmus.core.partition import triangulation

    monkeypatch.delenv("ISTHMUS_ENGINE", raising=False)

    class Shapely1:
        __version__ = "1.8.5"

    class Shapely20:
        __version__ = "2.0.7"

        def get_coordinates():
            """Shapely 2 has this one."""

    monkeypatch.setattr(triangulation, "engine_name", lambda: "")
    assert "shapely 2 is needed, and 1.8.5" in triangulation.missing_packages(Shapely1)
    assert "triangle, or shapely 2.1 instead of 2.0.7" in triangulation.missing_packages(Shapely20)
