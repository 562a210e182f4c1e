"""Write docs/reference: a page for each tool, made of the tool's own help, parameters and results.

    ./run docs

The pages in the folder de are the same in German, where the tools and this file say it by tr().

Only words of ours go into the pages, so they are the same whichever QGIS writes them;
tests/test_docs.py fails when a page is not as it would be written.
"""

import contextlib
import html
import re
import sys
import tempfile
from pathlib import Path

import translate

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs" / "reference"
# folders of the languages, and what leads from each to the other
LANGUAGES = {".": "[Deutsch](de/README.md)", "de": "[English](../README.md)"}
KINDS = {
    "source": "layer", "multilayer": "layers", "field": "name of a field", "expression": "expression",
    "number": "number", "distance": "number", "enum": "choice", "boolean": "true or false",
    "string": "text", "sink": "layer to write", "fileDestination": "file to write",
}  # fmt: skip
# what a reader may put there, in the example of a page
FILES = {
    "sink": "{}.gpkg", "source": "{}.gpkg", "fileDestination": "{}.html", "field": "class",
}  # fmt: skip


def tr(text):
    from isthmus.algorithms.words import tr as said

    return said(text)


@contextlib.contextmanager
def speaking(language):
    """Let the tools speak the language of a folder, as the zip's translation does."""
    from qgis.PyQt.QtCore import QCoreApplication, QTranslator

    if language != "de":
        yield
        return
    with tempfile.NamedTemporaryFile(suffix=".qm") as file:
        file.write(translate.compiled(translate.read(translate.FILE.read_text(encoding="utf-8"))))
        file.flush()
        translator = QTranslator()
        if not translator.load(file.name):
            raise ValueError(f"Qt does not read {file.name}")
        QCoreApplication.installTranslator(translator)
        try:
            yield
        finally:
            QCoreApplication.removeTranslator(translator)


def fields():
    """Return the fields that the tools write: (tool, output) to (name, kind) pairs.

    "..." stands for the fields of the input, "CLASS" for the field that this parameter names.
    """
    from isthmus.algorithms.aggregation import aggregate
    from isthmus.algorithms.partition import cutting
    from isthmus.algorithms.focus import focus_map
    from isthmus.algorithms.partition import hierarchy
    from isthmus.algorithms.partition import partition_budget
    from isthmus.algorithms.aggregation import prepare_aggregation
    from isthmus.algorithms.partition import tradeoff

    every = ("...", None)
    lines = {"CUTS": cutting.CUT_FIELDS, "DIAGONALS": cutting.DIAGONAL_FIELDS}
    budget = cutting.PART_FIELDS + partition_budget.PartitionBudgetAlgorithm.extra_fields
    regions = (aggregate.REGION_FIELDS[0], ("CLASS", None), *aggregate.REGION_FIELDS[1:])
    return {
        "partition": {"OUTPUT": (every, *cutting.PART_FIELDS), **lines},
        "partitionbudget": {"OUTPUT": (every, *budget), **lines},
        "tradeoff": {"OUTPUT": tradeoff.FIELDS},
        "hierarchy": {"OUTPUT": (every, *hierarchy.LEVEL_FIELDS), "CUTS": hierarchy.RANKED_FIELDS},
        "prepareaggregation": {
            "OUTPUT": (every, *prepare_aggregation.PIECE_FIELDS),
            "ADJACENCY": prepare_aggregation.PAIR_FIELDS,
        },
        "aggregate": {
            "OUTPUT": regions,
            "ASSIGNMENT": (
                every, aggregate.ASSIGNED_FIELDS[0], ("new_class", None),
                *aggregate.ASSIGNED_FIELDS[1:],
            ),
        },
        "focusmap": {"OUTPUT": (every,), "EDGES_USED": focus_map.EDGE_FIELDS},
    }  # fmt: skip


def pages(tools):
    """Return the text of each file of the reference, by its name."""
    result, written = {}, fields()
    for folder, other in LANGUAGES.items():
        with speaking(folder):
            made = [tool.create() for tool in tools]
            texts = {tool.name(): page(tool, written[tool.name()]) for tool in made}
            rows = [
                f"| [{tool.displayName()}]({tool.name()}.md) | `{tool.id()}` | {tool.shortDescription()} |"
                for tool in made
            ]
            texts["README"] = "\n".join([
                f"# {tr('Reference')}", "",
                f"{tr('One page for each tool, written by `./run docs` from the tool itself.')} {other}", "",
                f"| {tr('tool')} | id | |", "|---|---|---|", *rows, "",
            ])  # fmt: skip
        result |= {Path(folder, f"{name}.md").as_posix(): text for name, text in texts.items()}
    return result


def page(tool, written):
    """Return the page of a tool."""
    parameters = tool.parameterDefinitions()
    inputs = [p for p in parameters if not p.isDestination()]
    outputs = [p for p in parameters if p.isDestination()]
    name, shown_as, what = tr("name"), tr("in the dialog"), tr("what")
    where = tr("in the group {}").format(f"*{tool.group()}*")
    lines = [
        f"# {tool.displayName()}", "",
        f"`{tool.id()}`, {where}. {tool.shortDescription()}", "",
        *markdown(help_of(tool)),
        f"## {tr('Parameters')}", "",
        f"| {name} | {shown_as} | {what} | {tr('default')} | |", "|---|---|---|---|---|",
        *(row(p) for p in inputs), "",
        f"## {tr('Results')}", "", f"| {name} | {shown_as} | {what} | |", "|---|---|---|---|",
        *(result_row(p) for p in outputs), "",
    ]  # fmt: skip
    for output, its in written.items():
        lines += [tr("Fields of {}: {}.").format(f"`{output}`", ", ".join(field(*one) for one in its)), ""]
    known = {p.name() for p in parameters}
    numbers = [o for o in tool.outputDefinitions() if o.name() not in known]
    lines += [tr("Returned as well:"), "", f"| {name} | |", "|---|---|"]
    lines += [f"| `{o.name()}` | {o.description()} |" for o in numbers] + [""]
    lines += [f"## {tr('On the command line')}", "", "```", example(tool, parameters), "```", ""]
    return "\n".join(lines)


def help_of(tool):
    """Return the help without the lists of parameters, which the page has as tables."""
    from isthmus.algorithms.base import help_blocks

    return " ".join(tr(block) for block in help_blocks(tool.help_text) if block != "{lists}")


def markdown(text):
    """Return a help text as paragraphs of Markdown."""
    text = re.sub(r"</?i>", "*", re.sub(r"</?b>", "**", text))
    text = re.sub(r"<h[34]>(.*?)</h[34]>", r"<p>### \1</p>", text)
    text = re.sub(r"\s*<br\s*/?>\s*", "\n\n", text)
    lines = []
    for paragraph in re.split(r"</?p>|\n\n", text):
        if re.search(r"<[/\w]", paragraph):
            raise ValueError(f"a tag that the reference does not know: {paragraph}")
        if paragraph.strip():
            lines += [html.unescape(paragraph.strip()), ""]
    return lines


def row(parameter):
    """Return a row of the table of parameters."""
    from qgis.core import QgsProcessingParameterDefinition

    flags, what = QgsProcessingParameterDefinition.Flag, tr(KINDS[parameter.type()])
    if parameter.type() == "enum":
        what = f" {tr('or')} ".join(f"`{option}`" for option in parameter.options())
    if parameter.type() in ("number", "distance"):
        what += limits(parameter)
    if parameter.isDynamic():
        what += f"; {tr('a field or an expression, too')}"
    default = shown(parameter.defaultValue())
    if parameter.flags() & flags.FlagOptional:
        default = default or tr("none (optional)")
    more = f" *{tr('Advanced.')}*" if parameter.flags() & flags.FlagAdvanced else ""
    return (
        f"| `{parameter.name()}` | {cell(parameter.description())} | {what} | {default} | "
        f"{cell(parameter.help())}{more} |"
    )


def result_row(parameter):
    from qgis.core import QgsProcessingParameterDefinition

    optional = parameter.flags() & QgsProcessingParameterDefinition.Flag.FlagOptional
    what = tr(KINDS[parameter.type()]) + (f", {tr('optional')}" if optional else "")
    if optional and not parameter.createByDefault():
        what += f", {tr('off by default')}"
    return f"| `{parameter.name()}` | {cell(parameter.description())} | {what} | {cell(parameter.help())} |"


def limits(parameter):
    """Return the range of a number in words."""
    from qgis.core import QgsProcessingParameterNumber

    low, high = parameter.minimum(), parameter.maximum()
    text = ""
    if parameter.dataType() == QgsProcessingParameterNumber.Type.Integer:
        text += f", {tr('whole')}"
    # without a limit QGIS has the largest number that there is, or the tool one that fits its field
    if low > -(2**31):
        text += ", " + tr("at least {:g}").format(low)
    if high < 2**31 - 1:
        text += ", " + tr("at most {:g}").format(high)
    return text


def shown(value):
    """Return a default as it is typed."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f"`{value:.15g}`" if isinstance(value, (int, float)) else f"`{value}`"


def field(name, kind):
    """Return a field in words."""
    if name == "...":
        return tr("all of the input")
    if name == "CLASS":
        return tr("the class field")
    if kind is None:
        return f"`{name}`"
    from isthmus.algorithms.layers import fields

    whole = tr("whole number")
    kinds = {
        fields.INTEGER: whole, fields.LONG: whole, fields.REAL: tr("number"), fields.TEXT: tr("text"),
    }  # fmt: skip
    return f"`{name}` ({kinds[kind]})"


def cell(text):
    return text.replace("|", "\\|")


def example(tool, parameters):
    """Return a command with what must be given."""
    from qgis.core import QgsProcessingParameterDefinition

    words = ["qgis_process", "run", tool.id()]
    for p in parameters:
        optional = p.flags() & QgsProcessingParameterDefinition.Flag.FlagOptional
        if not optional and (p.isDestination() or p.defaultValue() is None):
            value = FILES[p.type()].format(p.description().split(" (")[0].split()[-1].lower())
            words.append(f"--{p.name()}={value}")
    return " ".join(words)


def main():
    from maps import start, stop
    from qgis.core import QgsApplication

    application = start()
    tools = QgsApplication.processingRegistry().providerById("isthmus").algorithms()
    made = pages(sorted(tools, key=lambda tool: tool.id()))
    for old in {path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*.md")} - set(made):
        (FOLDER / old).unlink()
    for name, text in made.items():
        (FOLDER / name).parent.mkdir(parents=True, exist_ok=True)
        (FOLDER / name).write_text(text, encoding="utf-8")
    print(f"{len(made)} pages in {FOLDER.relative_to(ROOT)}")
    stop(application)


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT / "tools"))
    main()
