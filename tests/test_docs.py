"""What the pages say is so: names, defaults, values, commands, snippets, numbers, pictures and links.

Each check is a function that returns a list of problems, so that it can be shown to fail: the last tests
plant drifts in copies.
"""

import ast
import copy
import json
import re
import shlex
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
import shapely

pytest.importorskip("qgis.core", reason="these tests need QGIS")

from qgis.core import (  # noqa: E402
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingModelAlgorithm,
    QgsProcessingParameterDefinition,
    QgsProject,
    QgsVectorFileWriter,
    QgsVectorLayer,
)
from qgis.PyQt.QtGui import QImage  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))

import measured  # noqa: E402
import reference  # noqa: E402

pytestmark = pytest.mark.skipif(not (ROOT / "docs").is_dir(), reason="the pages are not here")

PROSE = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/gallery.md", "docs/choosing_tau.md",
         "docs/architecture.md", "docs/more_than_one_machine.md", "docs/first_ten_minutes.md"]  # fmt: skip
CODE = re.compile(r"`([^`]+)`")
# Lower-case words in code that are no field of a tool
OTHER_WORDS = {"algorithms", "core", "check", "isthmus", *"arabia baltic countries countries_europe".split()}
UNITS = (
    "s|seconds?|minutes?|GB|MB|km|km²|m|m²|metres|hectares|%|cuts?|parts|pieces|areas|vertices|countries|islands|degrees|times|"
    "necks|rooms|doors|triangles|boxes|diagonals"
)
# Numbers with a unit that are no results of a measurement
CHOSEN = {
    "README.md": ["0.1 %"],  # the gap that is asked for
    "docs/gallery.md": ["180 degrees"],  # where the data end
    "docs/choosing_tau.md": [  # rows and settings of the tables
        "20 km",
        "10,000 km²",
        "0.2 %",
        "1,000 km²",
        "60 km",
        "2 %",
    ],
}


def page(name, root=ROOT):
    return (root / name).read_text(encoding="utf-8")


def prose(text):
    """Return a page without its blocks of code and its generated blocks."""
    text = measured.BLOCK.sub("", text)
    text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"^    .*$", "", text, flags=re.MULTILINE)


def code_blocks(text):
    """Return the blocks of code of a page, fenced and indented."""
    fenced = re.findall(r"^```\w*\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)
    rest = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    found = re.findall(r"(?:^(?:    .*)?\n)+", rest, flags=re.MULTILINE)
    return fenced + [re.sub(r"^    ", "", one, flags=re.MULTILINE) for one in found if one.strip()]


# --- What is so -------------------------------------------------------------------------------------


@pytest.fixture(scope="session")
def tools(provider):
    return sorted(provider.algorithms(), key=lambda tool: tool.id())


@pytest.fixture(scope="module")
def facts(tools):
    """What the tools are, as plain dicts: the checks see nothing else."""
    flags = QgsProcessingParameterDefinition.Flag
    fields = reference.fields()
    return {
        tool.id(): {
            "name": tool.displayName(),
            "fields": sorted({name for its in fields[tool.name()].values() for name, _ in its}),
            "numbers": [
                o.name() for o in tool.outputDefinitions() if tool.parameterDefinition(o.name()) is None
            ],
            "parameters": {
                p.name(): {
                    "label": p.description(),
                    "result": p.isDestination(),
                    "default": reference.shown(p.defaultValue()).strip("`"),
                    "options": list(p.options()) if p.type() == "enum" else None,
                    "limits": (
                        [p.minimum(), p.maximum()] if p.type() in ("number", "distance") else None
                    ),
                    "needed": not p.flags() & flags.FlagOptional and p.defaultValue() is None,
                }
                for p in tool.parameterDefinitions()
            },
        }
        for tool in tools
    }  # fmt: skip


# --- The checks -------------------------------------------------------------------------------------


def name_problems(text, facts, root=ROOT):
    """Tool ids, parameters, results, enum values and fields that are not there."""
    parameters = {name for tool in facts.values() for name in tool["parameters"]}
    numbers = {name for tool in facts.values() for name in tool["numbers"]}
    fields = {name for tool in facts.values() for name in tool["fields"]}
    options = {
        option
        for tool in facts.values()
        for one in tool["parameters"].values()
        for option in one["options"] or ()
    }
    problems = [f"there is no tool {one}" for one in re.findall(r"isthmus:\w+", text) if one not in facts]
    for word in CODE.findall(prose(text)):
        if re.fullmatch(r"[A-Z][A-Z_]+", word) and word not in parameters | numbers:
            problems.append(f"there is no parameter or result {word}")
        if re.fullmatch(r"[a-z_]+", word) and word not in fields | options | OTHER_WORDS:
            problems.append(f"there is no field or value {word}")
    # MinSize and its kind are written without code, too
    for word in set(re.findall(r"\bMin[A-Z]\w+", text)) - options:
        problems.append(f"there is no value {word}")
    return problems


def default_problems(text, facts):
    """Defaults, labels and values that are not so: "`TAU` (default 4)", "`TAU` (*Label*)", "`TAU` = 4"."""
    problems = []
    for name, label in re.findall(r"`([A-Z_]+)` \(\*([^*]+)\*\)", " ".join(prose(text).split())):
        labels = {t["parameters"][name]["label"] for t in facts.values() if name in t["parameters"]}
        if not any(one.startswith(label) for one in labels):
            problems.append(f"the label of {name} is {labels}, and not {label}")
    for line in prose(text).splitlines():
        named = re.search(r"\[`(isthmus:\w+)`\]", line)
        tools = [facts[named[1]]] if named and named[1] in facts else list(facts.values())
        for name, value in re.findall(r"`([A-Z_]+)` \(default ([\w.]+)", line):
            known = {t["parameters"][name]["default"] for t in tools if name in t["parameters"]}
            if value not in known:
                problems.append(f"the default of {name} is {known}, and not {value}")
    for name, value in re.findall(r"`([A-Z_]+)` = (\w+)", prose(text)):
        if not re.fullmatch(r"[\d.]+|Min\w+", value):
            continue
        its = [t["parameters"][name] for t in facts.values() if name in t["parameters"]]
        if not any(value_fits(one, value) for one in its):
            problems.append(f"{name} cannot be {value}")
    return problems


def value_fits(parameter, value):
    """Whether a value may be typed for a parameter."""
    if parameter["options"] is not None:
        return value in parameter["options"]
    if parameter["limits"] is None:
        return bool(value)
    try:
        low, high = parameter["limits"]
        return low <= float(value) <= high
    except ValueError:
        return False


def command_lines(text, model=False):
    """Return the qgis_process commands of a page that run tools, or models, as lists of words."""
    lines = [
        line.strip() for block in code_blocks(text) for line in re.sub(r"\\\n\s*", "", block).splitlines()
    ]
    return [
        shlex.split(line) for line in lines if "qgis_process run " in line and (".model3" in line) == model
    ]


def command_problems(text, facts):
    """Commands with tools, parameters or values that are not there."""
    problems = []
    for words in command_lines(text):
        tool, *rest = words[words.index("run") + 1 :]
        if tool not in facts:
            problems.append(f"there is no tool {tool}")
            continue
        parameters, given = facts[tool]["parameters"], set()
        for word in rest:
            name, equals, value = word.removeprefix("--").partition("=")
            given.add(name)
            if not (word.startswith("--") and equals and name in parameters):
                problems.append(f"{tool} has no parameter for {word}")
            elif not value_fits(parameters[name], value):
                problems.append(f"{tool}: {name} cannot be {value}")
        missing = {name for name, its in parameters.items() if its["needed"] and not its["result"]}
        problems += [f"{tool} needs {name}" for name in sorted(missing - given)]
    return problems


def table_problems(text, facts):
    """Tools whose row in the README's table has not exactly their parameters and results."""
    rows = dict(re.findall(r"^\| \[`(isthmus:\w+)`\]\S+ (\|.*)$", text, flags=re.MULTILINE))
    problems = [f"{tool} is in no row" for tool in facts if tool not in rows]
    for tool, row in rows.items():
        named = re.findall(r"`([A-Z_]+)`", row)
        wanted = list(facts.get(tool, {"parameters": {}})["parameters"])
        if sorted(named) != sorted(wanted):
            problems.append(f"{tool}: {sorted(set(named) ^ set(wanted))} differ")
    return problems


def number_problems(name, text):
    """Numbers with a unit that are neither measured nor known as chosen."""
    text = re.sub(r"<!-- end -->", "", prose(text))
    text = CODE.sub("", re.sub(r"\]\([^)]*\)", "]", text))
    found = re.findall(rf"(?<![\w.,-])(\d(?:[\d,.]*\d)?\s(?:{UNITS}))(?!\w)", text)
    found = [" ".join(one.split()) for one in found]
    return [f"{one!r} is not measured" for one in found if one not in CHOSEN.get(name, [])]


def picture_problems(name, text, root=ROOT):
    """Pictures that are not there, too large, or with no command beside them that makes them."""
    problems = []
    for match in re.finditer(r"!\[([^]]*)\]\(([^)]+)\)", text):
        path = (root / name).parent / match[2]
        if not path.exists():
            problems.append(f"there is no picture {match[2]}")
            continue
        image = QImage(str(path))
        if image.isNull() or image.width() > 1280 or path.stat().st_size > 250_000:
            problems.append(f"{match[2]} is larger than 1280 pixels or 250 kB")
        if not match[1]:
            problems.append(f"{match[2]} has no text for those who do not see it")
        section = text[match.end() :].partition("\n## ")[0]
        script, word = maker(path, root)
        if not script or word not in section + text.partition("\n## ")[0]:
            problems.append(f"{match[2]} has no word beside it of what makes it ({script or 'nothing'})")
    return problems


def maker(path, root=ROOT):
    """Return the script that draws a picture, and what must stand beside the picture."""
    if path.name == "readme.png":
        return "tools/demo.py", "./run demo"
    if path.parent.name == "resources":
        script = f"tools/{path.stem}.py"
        return (script, script) if (root / script).exists() else (None, None)
    if path.parent.name == "first_minutes":
        return "tools/first_minutes.py", "./run first-minutes"
    if path.stem == "python":
        return "tools/python_picture.py", "python_picture"
    for script in ("gallery", "choosing_tau"):
        source = (root / "tools" / f"{script}.py").read_text(encoding="utf-8")
        drawn = {
            call.args[-1 if call.func.id == "finish" else 0].value
            for call in ast.walk(ast.parse(source))
            if isinstance(call, ast.Call)
            and getattr(call.func, "id", "") in ("picture", "finish")
            and isinstance(call.args[-1 if call.func.id == "finish" else 0], ast.Constant)
        }
        if path.stem in drawn:
            return f"tools/{script}.py", path.stem if script == "gallery" else script
    return None, None


def slug(heading):
    """The anchor that GitHub gives to a heading."""
    text = re.sub(r"[^\w\- ]", "", re.sub(r"`", "", heading).lower())
    return text.strip().replace(" ", "-")


def link_problems(name, text, root=ROOT):
    """Relative links, and paths in code, that lead nowhere."""
    problems = []
    for target in re.findall(r"(?<!!)\[[^]]*\]\(([^)]+)\)", text):
        if re.match(r"\w+:", target):
            continue
        file, _, anchor = target.partition("#")
        path = (root / name).parent / file if file else root / name
        if not path.exists():
            problems.append(f"the link {target} leads nowhere")
        elif anchor:
            headings = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
            if anchor not in map(slug, headings):
                problems.append(f"{file or name} has no heading #{anchor}")
    for path in re.findall(r"`((?:tests|tools|core|algorithms|python|docs|resources)/[\w./]+)`", text):
        if not (root / path).exists():
            problems.append(f"there is no {path}")
    return problems


def code_problems(text, root=ROOT):
    """Names like `module.name` or `module.Class.attribute`, in blocks too, that are not in the code."""
    modules = {}
    for folder in ("core", "algorithms", "python"):
        for path in (root / folder).rglob("*.py"):
            modules.setdefault(path.stem, []).append(ast.parse(path.read_text(encoding="utf-8")).body)
    text = "\n".join([*CODE.findall(prose(text)), *code_blocks(text)])
    problems = []
    for module, *names in re.findall(r"(?<![\w./])([a-z_]+)\.(\w+)(?:\.(\w+))?(?![\w./-])", text):
        if names[0] in ("py", "md", "txt", "toml"):
            continue
        scopes = modules.get(module, [])
        for name in filter(None, names):
            scopes = [found for body in scopes for found in defined(body, name)]
        if not scopes:
            problems.append(f"there is no {'.'.join(filter(None, [module, *names]))}")
    return list(dict.fromkeys(problems))


def defined(body, name):
    """Return the bodies of what has a name in the body of a module or a class; a value's is empty."""
    found = []
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found += [node.body] if node.name == name else []
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        named = {n.id for target in targets if target for n in ast.walk(target) if isinstance(n, ast.Name)}
        found += [[]] if name in named else []
    return found


def run_problems(text, root=ROOT):
    """Commands ./run that are not there, and scripts and maps that they name."""
    script = (root / "run").read_text(encoding="utf-8")
    cases = {word for one in re.findall(r"^([\w |-]+)\)$", script, re.MULTILINE) for word in one.split(" | ")}
    maps = re.search(r"^MAPS = .*?^\}", (root / "tools/gallery.py").read_text(encoding="utf-8"),
                     re.DOTALL | re.MULTILINE)[0]  # fmt: skip
    problems = []
    for case, rest in re.findall(r"\./run +([\w-]+)((?: +[\w./-]+)*)", text):
        words = rest.split()
        if case not in cases:
            problems.append(f"there is no ./run {case}")
        if case == "docs" and words:
            if not (root / "tools" / f"{words[0]}.py").exists():
                problems.append(f"there is no tools/{words[0]}.py")
            if words[0] == "gallery" and len(words) > 1 and not words[1].startswith("--"):
                if not re.search(rf"\b{words[1]}\b", maps):
                    problems.append(f"the gallery has no map {words[1]}")
        if case == "python" and words and not (root / words[0]).exists():
            problems.append(f"there is no {words[0]}")
    return problems


def reference_problems(tools, root=ROOT):
    """Pages of the reference that are not as they would be written now."""
    made = reference.pages(tools)
    folder = root / "docs" / "reference"
    there = {
        path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8") for path in folder.rglob("*.md")
    }
    return [
        f"docs/reference/{name} is not as ./run docs would write it"
        for name in sorted(set(made) | set(there))
        if made.get(name) != there.get(name)
    ]


def measured_problems(root=ROOT):
    """Pages whose numbers are not those that were measured."""
    results, problems = measured.results(root), []
    for path in measured.pages(root):
        text = path.read_text(encoding="utf-8")
        try:
            new = measured.filled(text, results)
        except KeyError as missing:
            problems.append(str(missing))
            continue
        for old, line in zip(text.splitlines(), new.splitlines()):
            if old != line:
                problems.append(f"{path.name}: {old!r} should be {line!r}")
    return problems


# --- The pages --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", PROSE)
def test_page(facts, name):
    text = page(name)
    assert not name_problems(text, facts)
    assert not default_problems(text, facts)
    assert not command_problems(text, facts)
    assert not number_problems(name, text)
    assert not picture_problems(name, text)
    assert not link_problems(name, text)
    assert not run_problems(text)


def test_names_of_the_code():
    assert not code_problems(page("docs/architecture.md"))


def test_readme_lists_every_parameter(facts):
    assert not table_problems(page("README.md"), facts)


def test_reference(tools, facts):
    assert not reference_problems(tools)
    for path in (ROOT / "docs" / "reference").rglob("*.md"):
        name = str(path.relative_to(ROOT))
        assert not command_problems(page(name), facts) + link_problems(name, page(name))


def test_measured_numbers():
    assert not measured_problems()


def test_what_was_transcribed_was_recorded():
    """Numbers that no script has written yet stand in the record of the benchmarks."""
    record = page("tests/benchmarks/RESULTS.md").replace(",", "")
    known = {float(word) for word in re.findall(r"\d+(?:\.\d+)?", record)}

    def numbers(one):
        if isinstance(one, dict):
            return [number for value in one.values() for number in numbers(value)]
        return [one] if isinstance(one, (int, float)) else []

    for name, result in measured.results().items():
        if str(result.get("source", "")).startswith("transcribed"):
            assert set(map(float, numbers(result))) <= known, name


def test_tool_names_are_those_of_the_toolbox(facts):
    text = " ".join(page(name) for name in PROSE[:1] + PROSE[3:])
    for one in re.findall(r"\*((?:Partition polygons|Detour|Aggregate|Prepare|Enlarge)[^*]+)\*", text):
        assert " ".join(one.split()) in {tool["name"] for tool in facts.values()}


def test_commands_of_models(tools):
    found = command_lines(page("README.md"), model=True)
    assert {Path(words[2]) for words in found} == {
        path.relative_to(ROOT) for path in (ROOT / "resources/models").glob("*.model3")
    }
    optional = QgsProcessingParameterDefinition.Flag.FlagOptional
    for words in found:
        model = QgsProcessingModelAlgorithm()
        assert words[3] == "--" and model.fromFile(str(ROOT / words[2]))
        given = {word.partition("=")[0] for word in words[4:]}
        known = {one.name(): one for one in model.parameterDefinitions()}
        assert given <= set(known), given - set(known)
        needed = {
            name for name, one in known.items() if not one.flags() & optional and one.defaultValue() is None
        }
        assert needed <= given


def test_version():
    version = re.search(r"^version=(.*)$", page("metadata.txt"), re.MULTILINE)[1]
    assert f"\nversion: {version}\n" in page("CITATION.cff")
    assert re.search(r"^## (\S+)", page("CHANGELOG.md"), re.MULTILINE)[1] == version


# --- Real runs --------------------------------------------------------------------------------------


def outline(path):
    """Write Western Europe as the gallery does."""
    ring = np.loadtxt(ROOT / "tests/data/western_europe.csv", delimiter=",", skiprows=1)
    path.parent.mkdir(parents=True, exist_ok=True)
    feature = {"type": "Feature", "properties": {"name": "Western Europe"}}
    feature["geometry"] = json.loads(shapely.to_geojson(shapely.Polygon(ring)))
    geojson = path.with_suffix(".geojson")
    geojson.write_text(json.dumps({"type": "FeatureCollection", "features": [feature]}))
    layer, options = QgsVectorLayer(str(geojson)), QgsVectorFileWriter.SaveVectorOptions()
    options.layerName = path.stem
    context = QgsProject.instance().transformContext()
    assert QgsVectorFileWriter.writeAsVectorFormatV3(layer, str(path), context, options)[0] == 0


def test_commands_for_real(qgis_process, tmp_path):
    """The README's command, and one of the gallery, whose numbers must be those on the page."""
    outline(tmp_path / "build/gallery/western_europe.gpkg")
    shutil.copy(tmp_path / "build/gallery/western_europe.gpkg", tmp_path / "countries.gpkg")
    (readme,) = command_lines(page("README.md"))
    qgis_process(*readme[1:], folder=tmp_path)
    assert QgsVectorLayer(str(tmp_path / "parts.gpkg")).featureCount() > 1
    result = measured.entry(measured.results(), "gallery.western_europe.MinSize")
    gallery = shlex.split(result["command"].replace("\\\n", ""))
    assert gallery[:2] == ["./run", "qgis_process"] and gallery in command_lines(page("docs/gallery.md"))
    answer = qgis_process("run", "--json", *gallery[3:], folder=tmp_path)
    found = json.loads(answer[answer.index("{") :])["results"]
    assert (found["PART_COUNT"], found["CUT_COUNT"]) == (result["parts"], result["cuts"])
    assert found["CUT_LENGTH"] / 1000 == pytest.approx(result["km"], abs=0.001)


def test_python_snippets(tools, package):
    """The README's Python does what its comments say."""
    snippets = [one for one in code_blocks(page("README.md")) if "import " in one]
    assert len(snippets) == 2
    inside, alone = sorted(snippets, key=lambda one: "import isthmus" in one)
    layer = QgsVectorLayer("Polygon?crs=EPSG:3857", "rooms", "memory")
    from qgis.core import QgsFeature, QgsGeometry

    feature = QgsFeature()
    feature.setGeometry(QgsGeometry.fromWkt(
        "POLYGON((0 0,10 0,10 4.5,12 4.5,12 0,22 0,22 10,12 10,12 5.5,10 5.5,10 10,0 10,0 0))"
    ))  # fmt: skip
    layer.dataProvider().addFeature(feature)
    (call,) = [n for n in ast.walk(ast.parse(inside)) if isinstance(n, ast.Call)]
    code = inside.replace("processing.run(", "result = processing.run(")
    names = {"layer": layer}
    exec(code, names)
    assert call.args[0].value == "isthmus:partition"
    # the passage between the rooms is smaller than the smallest part
    assert names["result"]["PART_COUNT"] == 2 and names["result"]["CUT_COUNT"] == 1
    # the package, as pip would install it
    names = {"isthmus": package}
    exec(alone.replace("import isthmus, shapely", "import shapely"), names)
    assert [round(part.area) for part in names["parts"].geoms] == [100, 100, 2]
    assert len(names["cuts"].geoms) == 2 and names["fields"]["length"].tolist() == [1, 1]


def test_fields(tools):
    """The tools write the fields that the reference lists."""
    import processing

    def polygons(rows):
        layer = QgsVectorLayer("Polygon?crs=EPSG:32632&field=class:integer", "layer", "memory")
        from qgis.core import QgsFeature, QgsGeometry

        features = []
        for wkt, kind in rows:
            feature = QgsFeature(layer.fields())
            feature.setGeometry(QgsGeometry.fromWkt(wkt))
            feature.setAttributes([kind])
            features.append(feature)
        layer.dataProvider().addFeatures(features)
        return layer

    rooms = "POLYGON((0 0,10 0,10 4.5,12 4.5,12 0,22 0,22 10,12 10,12 5.5,10 5.5,10 10,0 10,0 0))"
    one = polygons([(rooms, 1)])
    two = polygons([("POLYGON((0 0,9 0,9 9,0 9,0 0))", 1), ("POLYGON((9 0,18 0,18 9,9 9,9 0))", 2)])
    focus = polygons([("POLYGON((-1 -1,11 -1,11 11,-1 11,-1 -1))", 1)])
    runs = {
        "aggregate": {"INPUT": two, "CLASS": "class", "THRESHOLD": 10},
        "focusmap": {"INPUT": one, "FOCUS": focus, "FRAME": False},
        "partition": {"INPUT": one}, "partitionbudget": {"INPUT": one}, "tradeoff": {"INPUT": one},
        "hierarchy": {"INPUT": one},
        "prepareaggregation": {"INPUT": two, "CLASS": "class"},
    }  # fmt: skip
    listed = reference.fields()
    assert set(listed) == set(runs) == {tool.name() for tool in tools}
    for name, parameters in runs.items():
        if name == "focusmap":
            pytest.importorskip("scipy")
        context, wanted = QgsProcessingContext(), listed[name]
        context.setProject(QgsProject.instance())
        results = processing.run(
            f"isthmus:{name}", {**parameters, **{output: "memory:" for output in wanted}},
            context=context, feedback=QgsProcessingFeedback(False),
        )  # fmt: skip
        for output, fields in wanted.items():
            named = []
            for field, _ in fields:
                named += ["class"] if field in ("...", "CLASS") else [field]
            assert results[output].fields().names() == named, (name, output)


# --- The checks see drifts --------------------------------------------------------------------------


def renamed(facts, tool, old, new):
    facts = copy.deepcopy(facts)
    parameters = facts[tool]["parameters"]
    facts[tool]["parameters"] = {new if k == old else k: v for k, v in parameters.items()}
    return facts


def test_drift_of_a_tool_is_seen(facts):
    readme, gallery = page("README.md"), page("docs/gallery.md")
    without = {k: v for k, v in facts.items() if k != "isthmus:tradeoff"}
    assert "there is no tool isthmus:tradeoff" in name_problems(readme, without)
    changed = facts
    for tool in facts:
        changed = renamed(changed, tool, "MIN_HOLE", "SMALLEST_HOLE")
    assert "there is no parameter or result MIN_HOLE" in name_problems(readme, changed)
    assert any("MIN_HOLE=1000000000" in one for one in command_problems(gallery, changed))
    assert table_problems(readme, renamed(facts, "isthmus:focusmap", "ALONG", "LAYERS"))
    changed = copy.deepcopy(facts)
    changed["isthmus:partition"]["parameters"]["TAU"]["default"] = "5"
    assert default_problems(readme, changed) == ["the default of TAU is {'5'}, and not 3"]
    changed = copy.deepcopy(facts)
    for tool in changed.values():
        if "MIN_LENGTH" in tool["parameters"]:
            tool["parameters"]["MIN_LENGTH"]["label"] = "Shortest cut"
    assert any("the label of MIN_LENGTH" in one for one in default_problems(readme, changed))
    changed = copy.deepcopy(facts)
    for tool in changed.values():
        for one in tool["parameters"].values():
            one["options"] = one["options"] and [o.replace("MinLength", "Shortest") for o in one["options"]]
    assert "there is no value MinLength" in name_problems(readme, changed)
    assert any("OBJECTIVE cannot be MinLength" in one for one in command_problems(gallery, changed))
    changed = copy.deepcopy(facts)
    changed["isthmus:partition"]["parameters"]["TAU"]["limits"] = [1.0, 3.0]
    assert any("TAU cannot be 4" in one for one in command_problems(readme, changed))
    changed = copy.deepcopy(facts)
    changed["isthmus:aggregate"]["parameters"]["METHOD"]["needed"] = True
    assert "isthmus:aggregate needs METHOD" in command_problems(gallery, changed)
    changed = copy.deepcopy(facts)
    for tool in changed.values():
        tool["fields"] = [field for field in tool["fields"] if field != "part_a"]
    assert "there is no field or value part_a" in name_problems(readme, changed)


def test_drift_of_a_page_is_seen(tools, facts, tmp_path):
    for name in ("docs", "tools", "resources", "tests/benchmarks"):
        shutil.copytree(ROOT / name, tmp_path / name)
    for name in ("README.md", "run", "CHANGELOG.md", "CONTRIBUTING.md", "CITATION.cff"):
        shutil.copy(ROOT / name, tmp_path / name)
    assert not measured_problems(tmp_path) + reference_problems(tools, tmp_path)

    def edited(name, old, new):
        text = page(name)
        assert old in text, old
        (tmp_path / name).write_text(text.replace(old, new, 1), encoding="utf-8")
        return page(name, tmp_path)

    # numbers
    cuts = measured.entry(measured.results(), "demo.cuts")
    edited("README.md", f"{cuts}<!-- demo.cuts -->", f"{cuts + 1}<!-- demo.cuts -->")
    assert any("demo.cuts" in one for one in measured_problems(tmp_path))
    edited("README.md", "<!-- demo.cuts -->", "<!-- demo.slices -->")
    assert any("demo.slices" in one for one in measured_problems(tmp_path))
    edited("README.md", "", "")
    edited("docs/choosing_tau.md", "| Jutland |", "| Jutland, Denmark |")
    assert any("Jutland" in one for one in measured_problems(tmp_path))
    text = edited("README.md", f"{cuts}<!-- demo.cuts -->", f"{cuts}")
    assert number_problems("README.md", text) == [f"'{cuts} cuts' is not measured"]
    # the reference
    edited("docs/reference/partition.md", "at least 1", "at least 0")
    assert any("partition.md" in one for one in reference_problems(tools, tmp_path))
    (tmp_path / "docs/reference/partition.md").unlink()
    assert any("partition.md" in one for one in reference_problems(tools, tmp_path))
    assert any("partition.md leads nowhere" in one for one in link_problems(
        "README.md", page("README.md"), tmp_path))  # fmt: skip
    # names of the code
    text = page("docs/architecture.md")
    for old, new in (
        ("min_size.min_size", "min_sizes.min_size"), ("carving.Walk", "carving.Stroll"),
        ("solve.Carved.tree", "solve.Carved.bush"), ("sinks.Sinks  ", "sinks.Drains  "),
        ("engines.ENGINES", "engines.MOTORS"),
    ):  # fmt: skip
        assert old in text and code_problems(text.replace(old, new)) == [f"there is no {new.strip()}"]
    # commands, links, pictures
    text = edited("docs/gallery.md", "--TAU=6", "--TAV=6")
    assert any("--TAV=6" in one for one in command_problems(text, facts))
    text = edited("README.md", "./run zip", "./run zap")
    assert run_problems(text, tmp_path) == ["there is no ./run zap"]
    text = edited("docs/gallery.md", "docs gallery river", "docs gallery brook")
    assert run_problems(text, tmp_path) == ["the gallery has no map brook"]
    text = edited("docs/gallery.md", "(#a-river)", "(#a-brook)")
    assert link_problems("docs/gallery.md", text, tmp_path)
    (tmp_path / "docs/pictures/river.png").unlink()
    assert picture_problems("docs/gallery.md", page("docs/gallery.md"), tmp_path)
    text = edited("docs/gallery.md", "Picture: `./run docs gallery two_lakes", "Picture: `./run")
    text = text.replace("two_lakes", "lakes").replace("lakes.png", "two_lakes.png")
    assert any("two_lakes.png" in one for one in picture_problems("docs/gallery.md", text))
