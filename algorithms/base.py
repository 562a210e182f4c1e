"""What all tools share: icon, group, the check for missing packages, layer styles."""

import functools
import sysconfig
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
)
from qgis.PyQt.QtGui import QIcon

from .features import common_type

RESOURCES = Path(__file__).parent.parent / "resources"
ICON = str(RESOURCES / "icon.svg")

# the tools check geometries themselves, and pass invalid ones through
WITHOUT_VALIDITY_CHECK = QgsProcessingFeatureSource.Flag.FlagSkipGeometryValidityChecks


class IsthmusAlgorithm(QgsProcessingAlgorithm):
    """Base of the tools: a tool adds its texts, its parameters and one call into the core."""

    INPUT = "INPUT"

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

    def add(self, parameter, help_text, advanced=False):
        """Add a parameter with its help."""
        parameter.setHelp(help_text)
        if advanced:
            flag = QgsProcessingParameterDefinition.Flag.FlagAdvanced
            parameter.setFlags(parameter.flags() | flag)
        self.addParameter(parameter)

    def add_numbers(self, labels):
        """Add the numbers that the tool returns, from (name, label) pairs."""
        for name, label in labels:
            self.addOutput(QgsProcessingOutputNumber(name, label))

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


def one_line(text):
    """Return a help text as QGIS wants it: its help panel takes each line for a paragraph."""
    return " ".join(text.split())


def dependency_problem():
    """Return what is missing and which command installs it, or '' if the tools can run."""
    try:
        import numpy
    except ImportError:
        return "The Python package numpy is missing. Install it with QGIS's own package manager."
    try:
        import shapely

        from ..core.triangulation import missing_packages

        problem = missing_packages(shapely)
    except ImportError:
        problem = "the Python package shapely is missing"
    return problem and f"{problem[0].upper()}{problem[1:]}. {install_hint(numpy.__version__)}"


def install_hint(numpy_version):
    """Return how to install the packages without touching QGIS's numpy."""
    managed = Path(sysconfig.get_path("stdlib"), "EXTERNALLY-MANAGED").exists()
    return (
        "To install what is needed, run this (on Windows in the OSGeo4W Shell), then restart QGIS: "
        f'python3 -m pip install --user {"--break-system-packages " * managed}'
        f'"shapely>=2.1" triangle "numpy=={numpy_version}"'
        " (leave out triangle where pip does not find it; the last word keeps QGIS's own numpy)"
    )


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
        self.sizes, types = [1], {source.wkbType()}
        if source.featureCount() != 1:
            request = QgsFeatureRequest().setSubsetOfAttributes([])
            self.sizes = []
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

    def progress(self, share):
        """Report the share done of the current feature."""
        self.feedback.setProgress(100.0 * (self.done + share * self.size) / self.total)


class _Styler(QgsProcessingLayerPostProcessorInterface):
    """Gives a loaded result its style."""

    def __init__(self, style):
        super().__init__()
        self.style = style

    def postProcessLayer(self, layer, context, feedback):
        layer.loadNamedStyle(str(RESOURCES / "styles" / self.style))
        layer.triggerRepaint()


_stylers = {}  # Processing does not own them: they must stay alive


def style_on_load(context: QgsProcessingContext, destination, style):
    """Give a result its style if Processing loads it into a project."""
    if destination and context.willLoadLayerOnCompletion(destination):
        styler = _stylers.setdefault(style, _Styler(style))
        context.layerToLoadOnCompletionDetails(destination).setPostProcessor(styler)
