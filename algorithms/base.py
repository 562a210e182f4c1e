"""What all tools share: icon, group, parameters."""

from __future__ import annotations

import functools
import html
import math
import re
from pathlib import Path
from typing import Any, Iterable

from qgis.core import (
    NULL,
    QgsApplication,
    QgsProcessing,
    QgsProcessingAlgorithm,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeatureSource,
    QgsProcessingOutputNumber,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterNumber,
    QgsWkbTypes,
)
from qgis.PyQt.QtGui import QIcon

from .dependencies import dependency_problem
from .layers.sinks import overwriting, unwritable
from .words import help_url, tr

RESOURCES = Path(__file__).parent.parent / "resources"
ICON = str(RESOURCES / "icon.svg")

OPTIONAL = QgsProcessingParameterDefinition.Flag.FlagOptional
# The geometries of a parameter that takes one kind of layers
KINDS: dict[tuple[int, ...], Any] = {
    (int(QgsProcessing.SourceType.TypeVectorPolygon),): QgsWkbTypes.GeometryType.PolygonGeometry,
    (int(QgsProcessing.SourceType.TypeVectorLine),): QgsWkbTypes.GeometryType.LineGeometry,
}
UNKNOWN = QgsWkbTypes.GeometryType.UnknownGeometry
NO_GEOMETRY = QgsWkbTypes.GeometryType.NullGeometry
# Of a number that may be large, such as an area: without one, the fields of the window end at 1e9
LARGEST = 1e18


class IsthmusAlgorithm(QgsProcessingAlgorithm):
    """Base of the tools: a tool adds its texts, its parameters and one call into the core.

    Attributes
    ----------
    help_text : str
        HTML of the help panel; the lists of parameters and results come where it has ``{lists}``.
    """

    INPUT = "INPUT"
    help_text = "{lists}"

    def __init_subclass__(cls, **options):
        super().__init_subclass__(**options)
        if "processAlgorithm" in vars(cls):
            cls.processAlgorithm = _without_frames(cls.processAlgorithm)
        for name in ("displayName", "shortDescription", "group"):
            if name in vars(cls):
                setattr(cls, name, _translated(getattr(cls, name)))

    def createInstance(self) -> IsthmusAlgorithm:
        return type(self)()

    def icon(self) -> QIcon:
        return QIcon(ICON)

    def group(self) -> str:
        return tr("Partition")

    def helpUrl(self) -> str:
        return help_url(self.name())

    def groupId(self) -> str:
        return "partition"

    def canExecute(self) -> tuple[bool, str]:
        problem = dependency_problem()
        return not problem, problem

    def checkParameterValues(
        self, parameters: dict[str, Any], context: QgsProcessingContext
    ) -> tuple[bool, str]:
        # qgis_process and scripts never ask canExecute
        parameters = self.with_names(parameters)
        try:
            problem = self.any_problem(parameters, context)
            if problem:
                return False, problem
            good, problem = super().checkParameterValues(parameters, context)
            if good:  # before anything is computed
                problem = (
                    self.kind_problem(parameters, context)
                    or overwriting(self, parameters, context)
                    or unwritable(self, parameters)
                )
        except QgsProcessingException as unreadable:
            return False, str(unreadable)
        return good and not problem, problem

    def parameterAsSource(
        self, parameters: dict[str, Any], name: str, context: QgsProcessingContext
    ) -> QgsProcessingFeatureSource | None:
        try:
            return super().parameterAsSource(parameters, name, context)
        except QgsProcessingException:
            raise
        except Exception as error:  # one of C++, without a name, while QGIS 3.34 takes the layer's extent
            raise QgsProcessingException(
                tr(
                    "QGIS cannot read {} ({}): has it a coordinate that is not finite? Delete such features, "
                    "or use another version of QGIS."
                ).format(name, error)
            ) from error

    def with_names(self, parameters: dict[str, Any]) -> dict[str, Any]:
        """Return parameters in which a choice has its name, though its number was given.

        QGIS takes the numbers of other tools' choices, but not of those that have names. Of an optional
        number that is NULL or no text it would make 0, not the default.
        """
        named = dict(parameters)
        for definition in self.parameterDefinitions():
            if definition.name() not in named:
                continue
            if isinstance(definition, QgsProcessingParameterNumber) and definition.flags() & OPTIONAL:
                if named[definition.name()] in ("", NULL):
                    named[definition.name()] = None
            if isinstance(definition, QgsProcessingParameterEnum):
                named[definition.name()] = _name_of(named[definition.name()], definition.options())
        return named

    def any_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        """Return a sentence about what is missing or what cannot be used, or ''."""
        return (
            dependency_problem() or self.text_problem(parameters) or self.choice_problem(parameters)
            or self.parameter_problem(parameters, context) or self.range_problem(parameters)
        )  # fmt: skip

    def parameter_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        """Return a sentence about a parameter that cannot be used, or ''."""
        return ""

    def text_problem(self, parameters: dict[str, Any]) -> str:
        """Return a sentence about a text where a number is wanted, or ''.

        QGIS takes any text for an optional number, and 0 for its value.
        """
        for definition in self.parameterDefinitions():
            value = parameters.get(definition.name())
            if isinstance(definition, QgsProcessingParameterNumber) and isinstance(value, str):
                try:
                    float(value)
                except ValueError:
                    return tr("{} must be a number, and is {!r}.").format(definition.name(), value)
        return ""

    def range_problem(self, parameters: dict[str, Any]) -> str:
        """Return a sentence about a number that its parameter does not take, or ''.

        QGIS does not say why, and takes any number for a whole one: 1 for 1.5, say.
        """
        whole = QgsProcessingParameterNumber.Type.Integer
        for definition in self.parameterDefinitions():
            value = parameters.get(definition.name())
            if not isinstance(definition, QgsProcessingParameterNumber):
                continue
            if not isinstance(value, (int, float, str)):
                continue
            value, least, most = float(value), definition.minimum(), definition.maximum()
            if definition.dataType() == whole:
                most = min(most, 2**31 - 1)
            if value > most:
                return tr("{} must be at most {:g}, and is {:g}.").format(definition.name(), most, value)
            if not value >= least:
                return tr("{} must be a number of at least {:g}, and is {:g}.").format(
                    definition.name(), least, value
                )
            if definition.dataType() == whole and not value.is_integer():
                return tr("{} must be a whole number, and is {}.").format(definition.name(), value)
        return ""

    def choice_problem(self, parameters: dict[str, Any]) -> str:
        """Return a sentence about a choice that there is not, or ''. QGIS does not say which there are."""
        for definition in self.parameterDefinitions():
            if not isinstance(definition, QgsProcessingParameterEnum):
                continue
            value, options = parameters.get(definition.name()), definition.options()
            empty = value == "" and definition.flags() & OPTIONAL
            if isinstance(value, (str, int, float)) and value not in options and not empty:
                return tr("{} must be one of {} (or its number, 0 to {}), and is {!r}.").format(
                    definition.name(), ", ".join(options), len(options) - 1, value
                )
        return ""

    def kind_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        """Return a sentence about a layer of points where one of polygons is wanted, or ''.

        The window offers none; qgis_process and scripts take any. A layer of mixed geometries has no type.
        """
        for definition in self.parameterDefinitions():
            name, wanted = definition.name(), None
            if isinstance(definition, QgsProcessingParameterFeatureSource):
                wanted = KINDS.get(tuple(map(int, definition.dataTypes())))
            source = None if wanted is None else self.parameterAsSource(parameters, name, context)
            kind = wanted if source is None else QgsWkbTypes.geometryType(source.wkbType())
            if kind not in (wanted, UNKNOWN, NO_GEOMETRY):
                return tr("{} must be a layer of the type {}, and is of the type {}.").format(
                    name, *map(QgsWkbTypes.geometryDisplayString, (wanted, kind))
                )
        return ""

    def number_problem(
        self, parameters: dict[str, Any], context: QgsProcessingContext, name: str, least: float
    ) -> str:
        """Return a sentence about a number that is too small, infinite or none, or ''."""
        value = self.parameterAsDouble(parameters, name, context)
        if not least <= value < math.inf:
            return tr("{} must be a number of at least {:g}, and is {:g}.").format(name, least, value)
        return ""

    def limit_problem(self, parameters: dict[str, Any], context: QgsProcessingContext, name: str) -> str:
        """Return a sentence about a number that is negative or above its largest value, or ''."""
        value = self.parameterAsDouble(parameters, name, context)
        if not value >= 0.0:
            return tr("{} must not be negative, and is {:g}.").format(name, value)
        largest = self.parameterDefinition(name).maximum()
        if value > largest:
            return tr("{} must be at most {:g}, and is {:g}.").format(name, largest, value)
        return ""

    def add(
        self,
        parameter: QgsProcessingParameterDefinition,
        help_text: str,
        *,
        advanced: bool = False,
        decimals: int | None = None,
    ) -> None:
        """Add a parameter with its help; a number may say how many decimals its field shows."""
        parameter.setDescription(tr(parameter.description()))
        parameter.setHelp(tr(help_text))
        if decimals is not None:
            parameter.setMetadata({"widget_wrapper": {"decimals": decimals}})
        if advanced:
            flag = QgsProcessingParameterDefinition.Flag.FlagAdvanced
            parameter.setFlags(parameter.flags() | flag)
        self.addParameter(parameter)

    def add_numbers(self, labels: Iterable[tuple[str, str]]) -> None:
        """Add the numbers that the tool returns, from (name, label) pairs."""
        for name, label in labels:
            self.addOutput(QgsProcessingOutputNumber(name, tr(label)))

    def shortHelpString(self) -> str:
        blocks = [tr(block) for block in help_blocks(self.help_text)]
        if QgsApplication.platform() == "qgis_process":  # shows no HTML, and the parameters by itself
            texts = [re.sub("<[^>]*>", "", block.replace("<br/> ", "\n")) for block in blocks]
            return "\n\n".join(html.unescape(text) for text in texts if text != "{lists}")
        # QGIS shows the help of a parameter in its tool-tip only, and takes each line for a paragraph
        lists = []
        for title, wanted in (("Parameters", False), ("Results", True)):
            items = "".join(
                f"<h4>{html.escape(p.description())}</h4><p>{html.escape(p.help())}</p>"
                for p in self.parameterDefinitions()
                if p.isDestination() == wanted
            )
            lists.append(f"<h3>{tr(title)}</h3>{items}")
        text = "".join(blocks)
        return " ".join(text.replace("{lists}", "".join(lists)).split())

    def source(self, parameters: dict[str, Any], context: QgsProcessingContext) -> QgsProcessingFeatureSource:
        """Return the layer INPUT."""
        source = self.parameterAsSource(parameters, self.INPUT, context)
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(parameters, self.INPUT))
        return source


def help_blocks(text: str) -> list[str]:
    """Return the headings and paragraphs of a help text, each on one line: what is translated at once."""
    return [" ".join(block.split()) for block in re.split(r"(?=<p>|<h3>|\{lists\})", text) if block.strip()]


def _translated(method):
    @functools.wraps(method)
    def words(self):
        return tr(method(self))

    return words


def _name_of(value, options):
    """The name that a number stands for, given as a number or as its digits; anything else as it is."""
    if isinstance(value, (list, tuple)):
        return [_name_of(one, options) for one in value]
    number = value
    if isinstance(value, str) and value.isdecimal() and value not in options:
        number = int(value)
    if isinstance(number, int) and not isinstance(number, bool) and 0 <= number < len(options):
        return options[number]
    return value


def _without_frames(process):
    """Let a tool refuse what it cannot use, and fail by a new exception, in a frame that holds nothing.

    QGIS keeps the exception that it gets for ever, and with it the frames and the layers open in them. A
    model does not ask its tools whether they can use what it computed for them.
    """

    @functools.wraps(process)
    def processAlgorithm(self, parameters, context, feedback):
        try:
            parameters = self.with_names(parameters)
            problem = self.any_problem(parameters, context)
            if problem:
                raise QgsProcessingException(problem)
            return process(self, parameters, context, feedback)
        except QgsProcessingException as problem:
            message = str(problem)
        del self, parameters, context, feedback
        raise QgsProcessingException(message)

    return processAlgorithm


def grouped(number: float, form: str = ",") -> str:
    """Return a number with its digits in groups of three."""
    return format(number, form).replace(",", tr(","))  # elsewhere a comma stands before decimals


def amount(value: float) -> str:
    """Return a size or a cost as text: 1,234,567 or 12.3457."""
    return grouped(value, ",.0f") if 1000.0 <= abs(value) < 1e15 else f"{value:.6g}"


def counted(number: int, what: str) -> str:
    """Return "1 area" or "2 areas"."""
    return f"{grouped(number)} {tr(what if number == 1 else f'{what}s')}"
