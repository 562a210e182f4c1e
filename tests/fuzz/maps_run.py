"""Run a tool on a case, as QGIS would, and tell what came of it."""

import inspect
import os
import sys
import tempfile
import traceback
import uuid
from pathlib import Path
from types import SimpleNamespace

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parent)]
import conftest  # noqa: E402, F401
from isthmus.tests.full_disk import small_files  # noqa: E402
from maps_layers import wkb  # noqa: E402
from qgis.core import (  # noqa: E402
    QgsApplication,
    QgsCoordinateTransformContext,
    QgsFeature,
    QgsGeometry,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingModelAlgorithm,
    QgsProcessingUtils,
    QgsProject,
    QgsVectorFileWriter,
    QgsVectorLayer,
)

from isthmus.algorithms.layers.fields import LONG, REAL, TEXT, field  # noqa: E402
from isthmus.algorithms.aggregation.aggregate import AggregateAlgorithm  # noqa: E402
from isthmus.algorithms.focus.focus_map import FocusMapAlgorithm  # noqa: E402
from isthmus.algorithms.aggregation.prepare_aggregation import PrepareAggregationAlgorithm  # noqa: E402
from isthmus.algorithms.provider import IsthmusProvider  # noqa: E402

KINDS = {"string": TEXT, "integer": LONG, "double": REAL}
DRIVERS = {"gpkg": "GPKG", "shp": "ESRI Shapefile", "geojson": "GeoJSON"}


class Listener(QgsProcessingFeedback):
    """Keeps what a tool says; cancels when it was asked, or told of progress, so many times."""

    def __init__(self, cancel=None):
        super().__init__(False)
        self.left, self.infos, self.warnings, self.errors = cancel, [], [], []
        self.progressChanged.connect(self._count)  # a model asks by other means

    def _count(self, share=None):
        if self.left is not None:
            self.left -= 1
            if self.left <= 0:
                self.cancel()

    def isCanceled(self):
        self._count()
        return super().isCanceled()

    def pushInfo(self, text):
        self.infos.append(text)

    def pushWarning(self, text):
        self.warnings.append(text)

    def reportError(self, text, fatalError=False):
        self.errors.append(text)

    @property
    def said(self):
        return self.infos + self.warnings + self.errors


def watched(tool, crashes):
    """The tool, with a record of exceptions that are no `QgsProcessingException`."""

    class Watched(tool):
        def createInstance(self):
            return Watched()

        def processAlgorithm(self, *arguments):
            return _noted(super().processAlgorithm, arguments, crashes)

        def checkParameterValues(self, *arguments):
            return _noted(super().checkParameterValues, arguments, crashes)

    return Watched().create()


def _noted(call, arguments, crashes):
    try:
        return call(*arguments)
    except QgsProcessingException:
        raise
    except BaseException:
        crashes.append(traceback.format_exc())
        raise


def model(name):
    """An example model; its tools come from the registry, so that their errors come as words only."""
    if not QgsApplication.processingRegistry().providerById("isthmus"):
        model.provider = IsthmusProvider()  # Python must keep it alive
        QgsApplication.processingRegistry().addProvider(model.provider)
    made = QgsProcessingModelAlgorithm()
    assert made.fromFile(str(Path(__file__).resolve().parents[2] / "resources" / "models" / f"{name}.model3"))
    return made


TOOLS = {
    "prepareaggregation": PrepareAggregationAlgorithm,
    "aggregate": AggregateAlgorithm,
    "focusmap": FocusMapAlgorithm,
}


def open_layer(one, folder):
    """A layer in memory, or in a file that was written and opened again."""
    uri = one["type"] + (f"?crs={one['crs']}" if one["crs"] else "")
    made = QgsVectorLayer(uri, "layer", "memory")
    provider = made.dataProvider()
    provider.addAttributes([field(name, KINDS[kind]) for name, kind in one["fields"]])
    made.updateFields()
    rows = []
    for geometry, values in one["rows"]:
        feature = QgsFeature(made.fields())
        feature.setAttributes(list(values))
        if geometry:
            shape = QgsGeometry()
            shape.fromWkb(wkb(geometry))
            feature.setGeometry(shape)
        # what does not go into such a layer is no input
        if not provider.addFeatures([feature])[0]:
            feature.clearGeometry()
            provider.addFeatures([feature])
        rows.append(feature)
    store = one.get("store", "memory")
    if store == "memory":
        return made
    path = os.path.join(folder, f"{uuid.uuid4().hex}.{store}")
    options = QgsVectorFileWriter.SaveVectorOptions()
    options.driverName = DRIVERS[store]
    QgsVectorFileWriter.writeAsVectorFormatV3(made, path, QgsCoordinateTransformContext(), options)
    stored = QgsVectorLayer(path, "layer", "ogr")
    whole = stored.isValid() and stored.featureCount() == made.featureCount()
    return stored if whole and len(stored.fields()) >= len(made.fields()) else made


def field_name(opened, one, name):
    """The name that a field has after storing: by its place, since formats cut names."""
    place = [field for field, _ in one["fields"]].index(name)
    return opened.fields()[place + len(opened.fields()) - len(one["fields"])].name()


def _disk(kind):
    """No file may get longer than ``full N`` says: what writes it is told of an error, as by a full disk."""
    return small_files(int(kind.split()[1]) if kind.startswith("full") else None)


def run(case, folder=None):
    """Run a case.

    Returns
    -------
    SimpleNamespace
        ``refused`` (the words, or ''), ``crashes``, ``results``, ``layers`` (lists of features by the
        name of their parameter), ``inputs`` (layers that were opened), ``feedback``.
    """
    frames = []
    with tempfile.TemporaryDirectory(dir=folder) as scratch:
        out = _run(case, scratch, frames)
    # the exception of a tool that fails is kept by QGIS, with the frames that it came through
    frames[0].clear()
    return out


def _run(case, folder, frames):
    frames.append(inspect.currentframe())
    parameters = dict(case["parameters"])
    inputs = {}
    for name, one in case["layers"].items():
        many = (
            [open_layer(each, folder) for each in one] if isinstance(one, list) else open_layer(one, folder)
        )
        inputs[name] = parameters[name] = many
    for name, field in case.get("fields", {}).items():
        parameters[name] = field_name(inputs["INPUT"], case["layers"]["INPUT"], field)
    for name in case["outputs"]:
        kind = case["output"]
        if kind == "unwritable":
            parameters[name] = os.path.join(folder, "no", "such", "folder", "out.gpkg")
        elif kind == "folder":  # one of this name is there already
            parameters[name] = os.path.join(folder, f"{name}.gpkg")
            os.makedirs(parameters[name], exist_ok=True)
        elif kind.startswith("full"):
            parameters[name] = os.path.join(folder, f"{name}.gpkg")
        elif kind != "memory":  # a table is no shapefile
            parameters[name] = os.path.join(
                folder, f"{name}.{'csv' if name == 'ADJACENCY' and kind == 'shp' else kind}"
            )
        else:
            parameters[name] = "memory:"
    if "CARRIED" in parameters:
        parameters["CARRIED"] = os.path.join(folder, "carried.gpkg")
    context, feedback, crashes = QgsProcessingContext(), Listener(case.get("cancel")), []
    context.setProject(QgsProject.instance())
    tool = watched(TOOLS[case["tool"]], crashes) if case["tool"] in TOOLS else model(case["tool"])
    out = SimpleNamespace(
        refused="", crashes=crashes, left=[], results=None, layers={}, inputs=inputs, feedback=feedback, parameters=parameters,
        rows={name: list(one.getFeatures()) for name, one in inputs.items() if not isinstance(one, list)},
    )  # fmt: skip
    try:
        allowed, problem = tool.checkParameterValues(parameters, context)
    except Exception:  # it is in crashes
        return out
    if not allowed:
        out.refused = problem or "(no words)"
        return out
    with _disk(case["output"]):
        results, fine = tool.run(parameters, context, feedback)
    feedback.left = None  # nobody else cancels
    if case["output"] != "folder":
        out.left = [one for one in os.listdir(folder) if one.split(".")[0] in [*case["outputs"], "carried"]]
    if not fine:
        out.refused = " ".join(feedback.errors) or "(no words)"
        return out
    out.results = results
    for name in case["outputs"]:
        if name in results:
            made = QgsProcessingUtils.mapLayerFromString(results[name], context)
            out.layers[name] = list(made.getFeatures()) if made else None
    carried = results.get("CARRIED_LAYERS") or []
    out.carried = [list(QgsVectorLayer(address, "", "ogr").getFeatures()) for address in carried]
    return out
