"""What all tools share: icon, group, parameters, layer styles."""

import functools
import html
import math
from pathlib import Path

from qgis.core import (
    QgsFeatureRequest,
    QgsProcessingAlgorithm,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeatureSource,
    QgsProcessingLayerPostProcessorInterface,
    QgsProcessingOutputNumber,
    QgsProcessingParameterDefinition,
    QgsProcessingUtils,
)
from qgis.PyQt import sip
from qgis.PyQt.QtGui import QIcon

from .dependencies import dependency_problem
from .layers.wkb import common_type

RESOURCES = Path(__file__).parent.parent / "resources"
ICON = str(RESOURCES / "icon.svg")

# Of a number that may be large, such as an area: without one, the fields of the window end at 1e9
LARGEST = 1e18

# Features at once: more take memory, and longer until a cancelled run stops, but hardly less time
CHUNK_FEATURES, CHUNK_VERTICES = 4096, 200_000

# the tools check geometries themselves, and pass invalid ones through
WITHOUT_VALIDITY_CHECK = QgsProcessingFeatureSource.Flag.FlagSkipGeometryValidityChecks


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

    def createInstance(self):
        return type(self)()

    def icon(self):
        return QIcon(ICON)

    def group(self):
        return "Partition"

    def groupId(self):
        return "partition"

    def canExecute(self):
        problem = dependency_problem()
        return not problem, problem

    def checkParameterValues(self, parameters, context):
        # qgis_process and scripts never ask canExecute
        problem = dependency_problem() or self.parameter_problem(parameters, context)
        if problem:
            return False, problem
        return super().checkParameterValues(parameters, context)

    def parameter_problem(self, parameters, context):
        """Return a sentence about a parameter that cannot be used, or ''."""
        return ""

    def number_problem(self, parameters, context, name, least):
        """Return a sentence about a number that is too small, infinite or none, or ''."""
        value = self.parameterAsDouble(parameters, name, context)
        if not least <= value < math.inf:
            return f"{name} must be a number of at least {least:g}, and is {value:g}."
        return ""

    def limit_problem(self, parameters, context, name):
        """Return a sentence about a number that is negative or above its largest value, or ''."""
        value = self.parameterAsDouble(parameters, name, context)
        if not value >= 0.0:
            return f"{name} must not be negative, and is {value:g}."
        largest = self.parameterDefinition(name).maximum()
        if value > largest:
            return f"{name} must be at most {largest:g}, and is {value:g}."
        return ""

    def add(self, parameter, help_text, advanced=False, decimals=None):
        """Add a parameter with its help; a number may say how many decimals its field shows."""
        parameter.setHelp(help_text)
        if decimals is not None:
            parameter.setMetadata({"widget_wrapper": {"decimals": decimals}})
        if advanced:
            flag = QgsProcessingParameterDefinition.Flag.FlagAdvanced
            parameter.setFlags(parameter.flags() | flag)
        self.addParameter(parameter)

    def add_numbers(self, labels):
        """Add the numbers that the tool returns, from (name, label) pairs."""
        for name, label in labels:
            self.addOutput(QgsProcessingOutputNumber(name, label))

    def shortHelpString(self):
        # QGIS shows the help of a parameter in its tool-tip only, and takes each line for a paragraph
        lists = []
        for title, wanted in (("Parameters", False), ("Results", True)):
            items = "".join(
                f"<h4>{html.escape(p.description())}</h4><p>{html.escape(p.help())}</p>"
                for p in self.parameterDefinitions()
                if p.isDestination() == wanted
            )
            lists.append(f"<h3>{title}</h3>{items}")
        return " ".join(self.help_text.replace("{lists}", "".join(lists)).split())

    def source(self, parameters, context):
        """Return the layer INPUT."""
        source = self.parameterAsSource(parameters, self.INPUT, context)
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(parameters, self.INPUT))
        return source


def _without_frames(process):
    """Let a tool fail by a new exception, in a frame that holds nothing.

    QGIS keeps the exception that it gets for ever, and with it the frames and the layers open in them.
    """

    @functools.wraps(process)
    def processAlgorithm(self, parameters, context, feedback):
        try:
            return process(self, parameters, context, feedback)
        except QgsProcessingException as problem:
            message = str(problem)
        del self, parameters, context, feedback
        raise QgsProcessingException(message)

    return processAlgorithm


def counted(number, what):
    """Return "1 area" or "2 areas"."""
    return f"{number:,} {what}{'s' * (number != 1)}"


class Steps:
    """Iterates over the features of a polygon source, with progress weighed by vertices.

    Parameters
    ----------
    source : QgsProcessingFeatureSource
    feedback : QgsProcessingFeedback

    Attributes
    ----------
    wkb_type : QgsWkbTypes.Type
        What all geometries fit in: linear, and with Z, M or several parts where any has them,
        though the source (GeoJSON, for one) may declare less.
    """

    def __init__(self, source, feedback):
        self.source, self.feedback = source, feedback
        self.sizes, types = [], {source.wkbType()}
        request = QgsFeatureRequest().setSubsetOfAttributes([])
        for feature in source.getFeatures(request, WITHOUT_VALIDITY_CHECK):
            if feature.hasGeometry():
                geometry = feature.geometry().constGet()
                types.add(geometry.wkbType())
            self.sizes.append(1 + geometry.nCoordinates() if feature.hasGeometry() else 1)
        self.wkb_type = common_type(types)
        self.total = sum(self.sizes) or 1
        self.done, self.size = 0, 0

    def __iter__(self):
        features = self.source.getFeatures(QgsFeatureRequest(), WITHOUT_VALIDITY_CHECK)
        for feature, size in zip(features, self.sizes):
            self.size = size
            if self.feedback.isCanceled():
                return
            yield feature
            self.done += self.size
            self.feedback.setProgress(100.0 * self.done / self.total)

    def chunks(self):
        """Yield lists of features, few or small enough to be worked on at once.

        What is yielded counts as done when the next is asked for.
        """
        features = self.source.getFeatures(QgsFeatureRequest(), WITHOUT_VALIDITY_CHECK)
        chunk, self.size = [], 0
        for feature, size in zip(features, self.sizes):
            if chunk and (len(chunk) >= CHUNK_FEATURES or self.size + size > CHUNK_VERTICES):
                yield chunk
                self.done += self.size
                chunk, self.size = [], 0
            if self.feedback.isCanceled():
                return
            chunk.append(feature)
            self.size += size
        if chunk:
            yield chunk
        self.done += self.size
        self.feedback.setProgress(100.0 * self.done / self.total)

    def progress(self, share):
        """Report the share done of the current feature or chunk."""
        self.feedback.setProgress(100.0 * (self.done + share * self.size) / self.total)


class _Styler(QgsProcessingLayerPostProcessorInterface):
    """Gives a loaded result its style, and its place among the results of the run."""

    def __init__(self, style, rank):
        super().__init__()
        self.style, self.rank = style, rank

    def postProcessLayer(self, layer, context, feedback):
        if self.style:
            layer.loadNamedStyle(str(RESOURCES / "styles" / self.style))
            layer.triggerRepaint()
        _arrange(context)


def _arrange(context):
    """Put the results of a run into the order of their ranks in the layer tree.

    QGIS 3.22 loads them in the order of their ids or paths, each on top of the one before.
    """
    ranked = {}  # by group
    for destination, details in context.layersToLoadOnCompletion().items():
        styler = details.postProcessor()
        layer = QgsProcessingUtils.mapLayerFromString(destination, context, False)
        if details.project is None or layer is None or not isinstance(styler, _Styler):
            continue
        node = details.project.layerTreeRoot().findLayer(layer.id())
        if node is not None:
            ranked.setdefault(node.parent(), []).append((styler.rank, node))
    for group, found in ranked.items():
        places = [group.children().index(node) for _, node in sorted(found, key=lambda f: f[0])]
        if places == sorted(places):
            continue
        top = min(places)
        for _, node in sorted(found, key=lambda f: -f[0]):
            group.insertChildNode(top, node.clone())
            group.removeChildNode(node)


_stylers = []  # those that wait for their layer: Python must not delete them


def style_on_load(context: QgsProcessingContext, destination, style, rank=1):
    """Give a result its style, if any, and its place if Processing loads it into a project.

    Results of a lower rank lie above those of a higher one.
    """
    if destination and context.willLoadLayerOnCompletion(destination):
        # one for each result: the context deletes it in the end, whatever the documentation says
        styler = _Styler(style, rank)
        _stylers[:] = [old for old in _stylers if not sip.isdeleted(old)] + [styler]
        context.layerToLoadOnCompletionDetails(destination).setPostProcessor(styler)
