"""Names and numbers of choices, help pages, and what the plugin does at its start."""

import ast
import pickle
from pathlib import Path

import pytest
from qgis.core import (
    QgsApplication,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingModelAlgorithm,
    QgsProcessingModelChildAlgorithm,
    QgsProcessingModelChildParameterSource,
    QgsProcessingModelOutput,
    QgsProcessingModelParameter,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFeatureSource,
    QgsProperty,
)
from qgis.PyQt.QtCore import QUrl

from isthmus.algorithms.base import OPTIONAL

ROOMS = "POLYGON((0 0,10 0,10 4.5,12 4.5,12 0,22 0,22 10,12 10,12 5.5,10 5.5,10 10,0 10,0 0))"


@pytest.mark.parametrize("number, name", [(0, "Natural"), ("0", "Natural"), (1, "Any"), ("1", "Any")])
def test_a_choice_has_a_number_too(run, layer, number, name):
    source = layer("Polygon?crs=EPSG:3857", [(ROOMS, [])])
    given = {"INPUT": source, "OUTPUT": "memory:", "CUTS": "memory:"}
    results = [
        run("isthmus:partition", {**given, "PLACES": places, "SMALLEST_PART": 0, "OBJECTIVE": objective})
        for places, objective in ((name, "MinLength"), (number, 1))
    ]
    assert results[0]["CUT_LENGTH"] == results[1]["CUT_LENGTH"] > 0
    assert results[0]["CUT_COUNT"] == results[1]["CUT_COUNT"]


def test_every_choice_takes_its_numbers_and_no_others(provider):
    context, seen = QgsProcessingContext(), 0
    for tool in provider.algorithms():
        for definition in tool.parameterDefinitions():
            if not isinstance(definition, QgsProcessingParameterEnum):
                continue
            seen += 1
            options, name = definition.options(), definition.name()
            for k, option in enumerate(options):
                assert tool.with_names({name: k, "INPUT": 1}) == {name: option, "INPUT": 1}
                assert tool.with_names({name: str(k)}) == {name: option}
            for wrong in (len(options), -1, "Nowhere", str(len(options))):
                ok, said = tool.checkParameterValues({name: wrong}, context)
                assert not ok and tool.with_names({name: wrong}) == {name: wrong}
                # which there are
                assert (
                    said.startswith(f"{name} must be one of {', '.join(options)} (") and repr(wrong) in said
                )
            assert "must be one of" not in tool.checkParameterValues({name: None}, context)[1]
    assert seen >= 6


def test_a_wrong_number_is_refused(run, layer):
    source = layer("Polygon?crs=EPSG:3857", [(ROOMS, [])])
    with pytest.raises(QgsProcessingException):
        run("isthmus:partition", {"INPUT": source, "OUTPUT": "memory:", "PLACES": 2})


@pytest.mark.parametrize("tool, name", [
    ("partition", "SMALLEST_PART"), ("partition", "TAU"), ("aggregate", "WEIGHT_CHANGE"),
    ("focusmap", "SCALE"),
])  # fmt: skip
def test_a_text_is_no_number(provider, tool, name):
    """QGIS takes any text for a number that is optional."""
    tool, context = provider.algorithm(tool), QgsProcessingContext()
    assert tool.checkParameterValues({name: "x"}, context) == (False, f"{name} must be a number, and is 'x'.")
    for number in ("2.5", " 2 ", "1e1", 3, None):
        assert "must be a number, and" not in tool.checkParameterValues({name: number}, context)[1]
    said = tool.checkParameterValues({name: ""}, context)[1]
    needed = not tool.parameterDefinition(name).flags() & OPTIONAL
    assert (said == f"{name} must be a number, and is ''.") == needed == (name in ("TAU", "SCALE"))


@pytest.mark.parametrize("tool, name, wrong, said", [
    ("partition", "TAU", 0.5, "TAU must be a number of at least 1, and is 0.5."),
    ("aggregate", "WEIGHT_BOUNDARY", -1.0, "WEIGHT_BOUNDARY must be a number of at least 0, and is -1."),
    ("aggregate", "SEED", -1, "SEED must be a number of at least 0, and is -1."),
    ("aggregate", "WEIGHTS", "light", "WEIGHTS must be one of keep classes, balanced, compact (or its number, "
     "0 to 2), and is 'light'."),
    ("prepareaggregation", "TAU", 0.5, "TAU must be a number of at least 1, and is 0.5."),
])  # fmt: skip
def test_a_model_gets_the_same_sentence(provider, layer, tool, name, wrong, said):
    """QGIS does not ask the tools of a model whether they can use what they get."""
    model, child = QgsProcessingModelAlgorithm("model", "group"), QgsProcessingModelChildAlgorithm()
    child.setChildId("tool")
    assert child.setAlgorithmId(f"isthmus:{tool}")
    source = QgsProcessingModelChildParameterSource
    for one, value in {"CLASS": "code", "METHOD": "greedy", name: wrong}.items():
        child.addParameterSources(one, [source.fromStaticValue(value)])
    child.addParameterSources("INPUT", [source.fromModelParameter("areas")])
    output = QgsProcessingModelOutput("made")
    output.setChildId("tool")
    output.setChildOutputName("OUTPUT")
    child.setModelOutputs({"made": output})
    areas = QgsProcessingParameterFeatureSource("areas")
    model.addModelParameter(areas, QgsProcessingModelParameter("areas"))
    model.addChildAlgorithm(child)
    given = {
        "areas": layer("Polygon?crs=EPSG:3857&field=code:string", [(ROOMS, ["a"])]),
        "tool:made": "memory:",
    }
    feedback = QgsProcessingFeedback(False)
    _, fine = model.run(given, QgsProcessingContext(), feedback)
    assert not fine
    assert said in feedback.textLog() and "Traceback" not in feedback.textLog()


def test_help_opens_the_page_of_the_tool(provider):
    for tool in provider.algorithms():
        url = QUrl(tool.helpUrl())
        assert url.isLocalFile()
        page = Path(url.toLocalFile())
        assert page.stem == tool.name() and tool.displayName() in page.read_text(encoding="utf-8")


def test_help_is_german_in_a_german_qgis(provider, monkeypatch):
    from isthmus.algorithms import words

    class Locale:
        name = "de_CH"

        @classmethod
        def locale(cls):
            return cls.name

    monkeypatch.setattr(words, "QgsApplication", Locale)
    for name, title in (("README", "# Referenz\n"), ("partition", "# Polygone an Engstellen zerlegen\n")):
        german = Path(QUrl(words.help_url(name)).toLocalFile())
        assert german.parent.name == "de" and german.read_text(encoding="utf-8").startswith(title)
    Locale.name = "fr"  # there is none
    assert "de" not in Path(QUrl(words.help_url()).toLocalFile()).parts[-2:]


def test_the_plugin_starts_and_stops_without_a_window(qgis_app, provider):
    from isthmus.plugin import IsthmusPlugin

    registry = QgsApplication.processingRegistry()
    before = registry.providers()
    plugin = IsthmusPlugin(None)
    assert plugin.menu is None
    plugin.unload()
    assert registry.providers() == before


def test_german(tool, tmp_path, monkeypatch, provider, run, layer, feedback):
    """The tools speak German where QGIS does; names, values and defaults stay."""
    from isthmus.algorithms import words
    from isthmus.algorithms.base import counted
    from qgis.PyQt.QtCore import QCoreApplication

    translate = tool("translate")
    (tmp_path / "i18n").mkdir()
    data = translate.compiled(translate.read(translate.FILE.read_text(encoding="utf-8")))
    (tmp_path / "i18n" / "isthmus_de.qm").write_bytes(data)
    monkeypatch.setattr(words, "ROOT", tmp_path)
    english = QgsApplication.processingRegistry().algorithmById("isthmus:partition").create()
    assert words.load_translation("fr") is None
    translator = words.load_translation("de_AT")
    try:
        german = english.create()
        assert german.displayName() == "Polygone an Engstellen zerlegen" and german.group() == "Zerlegung"
        assert "Halbinsel" in german.shortHelpString() and "{lists}" not in german.shortHelpString()
        (tau,) = [p for p in german.parameterDefinitions() if p.name() == "TAU"]
        assert tau.description() == "Größter Umweg (tau)" and tau.defaultValue() == 3
        assert [p.name() for p in german.parameterDefinitions()] == [
            p.name() for p in english.parameterDefinitions()
        ]
        groups = {one.create().group() for one in provider.algorithms()}
        assert groups == {"Zerlegung", "Flächenaggregation", "Deformation"}
        for parameter in german.parameterDefinitions():  # the form is that wide
            assert len(parameter.description()) <= 52, parameter.description()
        # and what the log tells of a run
        source = layer("Polygon?crs=EPSG:3857", [(ROOMS, []), ("POLYGON((0 0,9 9,9 0,0 9,0 0))", [])])
        given = {"INPUT": source, "SMALLEST_PART": 0, "OUTPUT": "memory:", "CUTS": "memory:"}
        run("isthmus:partition", given, feedback)
        assert feedback.infos[-2] == "Nicht zerlegt: 1 Objekt; siehe das Feld status der Teile."
        assert any(text.startswith("4 Teile, durch 2 Schnitte von insgesamt 2 ") for text in feedback.infos)
        assert feedback.warnings[0].startswith("Objekt 2 wurde nicht zerlegt: ")
        said = "\n".join(feedback.infos[:-1])  # Processing itself ends with the results
        assert not any(word in said for word in (" the ", " of ", " is ", " cut")), said
        # reasons of the core and of parameters, too; in the fields they stay as they are
        assert "ungültige Geometrie: Self-intersection" in feedback.warnings[0]
        given["TAU"] = QgsProperty.fromExpression("0.5")
        result = run("isthmus:partition", given, feedback)
        assert any("tau muss eine Zahl ab 1 sein und ist 0.5" in text for text in feedback.warnings)
        status = {feature["status"] for feature in result["OUTPUT"].getFeatures()}
        assert "tau must be a number of at least 1, and is 0.5" in status
        # a comma stands before decimals there
        assert counted(1234567, "part") == "1\u00a0234\u00a0567 Teile" and counted(1, "cut") == "1 Schnitt"
        ok, problem = german.checkParameterValues({"MIN_LENGTH": "x"}, QgsProcessingContext())
        assert not ok and problem == "MIN_LENGTH muss eine Zahl sein und ist 'x'."
    finally:
        QCoreApplication.removeTranslator(translator)
    assert english.create().displayName() == "Partition polygons at bottlenecks"
    assert counted(1234567, "part") == "1,234,567 parts"


def test_texts_that_nobody_would_translate_are_found(tool):
    """Sentences that are raised, returned, shown or refused without tr() or Sentence()."""
    translate = tool("translate")
    code = """
def f(x):
    feedback.pushInfo("this is said")
    raise QgsProcessingException(f"{x} is raised")
    raise Unsolvable("the core says so")
    raise ValueError("what a programmer reads")
    verdict[x] = "some geometry is odd"
    return "too many of them" if x else tr("is heard")
    return Sentence("is kept {}", x), "heard by tr"
"""
    found = translate.untold([("f.py", ast.parse(code))], {"heard by tr"})
    texts = {one.split(": ", 2)[-1] for one in found}
    assert texts == {
        "this is said", "{} is raised", "the core says so", "some geometry is odd", "too many of them",
    }  # fmt: skip
    assert not translate.untold([("f.py", ast.parse(code))], {*texts, "heard by tr"})


def test_a_sentence_of_the_core_keeps_what_it_is_made_of(monkeypatch):
    from isthmus.algorithms import words
    from isthmus.core.errors import Sentence, Unsolvable

    inner = Sentence("line {}", 7)
    sentence = Sentence("it is {:.1f} and {}: {}", 0.25, inner, "line {}")
    again = pickle.loads(pickle.dumps(sentence))
    assert sentence == again == "it is 0.2 and line 7: line {}" and again.values == sentence.values
    assert Unsolvable(sentence).sentence is sentence and str(Unsolvable(sentence)) == sentence
    german = {"line {}": "Linie {}", "it is {:.1f} and {}: {}": "es ist {:.1f} und {}: {}"}
    monkeypatch.setattr(words, "tr", german.__getitem__)
    assert words.spoken(again) == "es ist 0.2 und Linie 7: line {}"
    assert words.spoken("line {}") == "line {}"  # no sentence, but a name of the user's
    assert words.as_sentence("is it?") == "Is it?" and words.as_sentence("it is.") == "It is."
