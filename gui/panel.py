"""The panel to try tau: a slider moves the cuts on the map, and a button writes them."""

from __future__ import annotations

import math
import re
import shlex
import shutil
import sys
import time
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsApplication,
    QgsFeatureRequest,
    QgsGeometry,
    QgsMapLayerProxyModel,
    QgsProcessing,
    QgsProcessingAlgRunnerTask,
    QgsProcessingContext,
    QgsProcessingFeatureSourceDefinition,
    QgsProcessingFeedback,
    QgsProcessingOutputLayerDefinition,
    QgsProject,
    QgsVectorLayerFeatureSource,
    QgsWkbTypes,
)
from qgis.gui import QgsDockWidget, QgsMapLayerComboBox, QgsRubberBand
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtGui import QColor
from qgis.PyQt.QtWidgets import (
    QApplication,
    QCheckBox,
    QComboBox,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QRadioButton,
    QSlider,
    QVBoxLayout,
    QWidget,
)

from ..algorithms.base import counted
from ..algorithms.partition.cutting import PLACES, SMALLEST
from ..algorithms.words import spoken, tr
from ..core.errors import Cancelled
from ..core.progress import checker
from .task import Task

if TYPE_CHECKING:
    from qgis.gui import QgisInterface

    from ..algorithms.partition.preview import Preview, Shown


STEPS = 1000  # of the slider
SMALLEST_TAU, DEFAULT_TAU = 1.5, 3.0
QUICK = 0.1  # seconds: what takes longer waits until the slider is let go
COLOUR = QColor(215, 48, 39)


def shell_command(words: list[str], system: str = sys.platform) -> str:
    """Return words as one command for the shell of a system; Windows' knows no ' as a quote."""
    if system != "win32":
        return shlex.join(words)
    # backslashes count twice before a quotation mark, and nowhere else
    return " ".join(
        word if re.fullmatch(r"[\w.:/\\=-]+", word) else '"' + re.sub(r'(\\*)("|$)', _escaped, word) + '"'
        for word in words
    )


def _escaped(match):
    return 2 * match[1] + ('\\"' if match[2] else "")


class Panel(QgsDockWidget):
    """Shows the cuts of a layer for a tau, or for a number of parts, on the map of ``iface``."""

    def __init__(self, iface: QgisInterface) -> None:
        super().__init__(tr("Isthmus: try values of tau"), iface.mainWindow())
        self.setObjectName("IsthmusPanel")
        self.iface, self.canvas = iface, iface.mapCanvas()
        self.task: Task | None = None
        self.preview: Preview | None = None
        self.shown: Shown | None = None
        self.asked: dict[str, Any] = {}  # for what the cuts were found: the layer and the parameters
        self.writing: Any = None  # what runs: task, tool, context and feedback
        self.quick = True
        self.band = QgsRubberBand(self.canvas, QgsWkbTypes.GeometryType.LineGeometry)
        self.band.setColor(COLOUR)
        self.band.setWidth(3)
        self._build()
        self.layer_box.layerChanged.connect(self._chosen)
        QgsProject.instance().layersRemoved.connect(self._removed)
        self.find_button.clicked.connect(self.find)
        self.slider.valueChanged.connect(self.update_cuts)
        self.slider.sliderReleased.connect(self.update_cuts)
        self.by_tau.toggled.connect(self._set_range)
        self.write_button.clicked.connect(self.write)
        self.copy_button.clicked.connect(self.copy_command)
        self.canvas.destinationCrsChanged.connect(self.draw)
        self.visibilityChanged.connect(self.band.setVisible)
        self.forget()
        iface.addDockWidget(Qt.DockWidgetArea.RightDockWidgetArea, self)

    def _build(self):
        content = QWidget()
        layout = QVBoxLayout(content)
        form = QFormLayout()
        self.layer_box = QgsMapLayerComboBox()
        self.layer_box.setFilters(QgsMapLayerProxyModel.Filter.PolygonLayer)
        self.only_selected = QCheckBox(tr("Selected features only"))
        self.places_box = QComboBox()
        for name in PLACES:
            self.places_box.addItem(tr(name), name)
        self.smallest_box = QDoubleSpinBox()
        self.smallest_box.setRange(0.0, 100.0)
        self.smallest_box.setDecimals(3)
        self.smallest_box.setValue(SMALLEST)
        form.addRow(tr("Polygons"), self.layer_box)
        form.addRow("", self.only_selected)
        form.addRow(tr("Where a cut may lie"), self.places_box)
        form.addRow(tr("Smallest part (per cent)"), self.smallest_box)
        layout.addLayout(form)
        self.find_button = QPushButton(tr("Find the cuts"))
        self.progress = QProgressBar()
        self.progress.setRange(0, 100)
        row = QHBoxLayout()
        row.addWidget(self.find_button)
        row.addWidget(self.progress, 1)
        layout.addLayout(row)
        self.by_tau = QRadioButton(tr("Largest detour (tau)"))
        self.by_parts = QRadioButton(tr("Number of parts of each feature"))
        self.by_tau.setChecked(True)
        layout.addWidget(self.by_tau)
        layout.addWidget(self.by_parts)
        self.slider = QSlider(Qt.Orientation.Horizontal)
        layout.addWidget(self.slider)
        self.text = QLabel()
        self.text.setWordWrap(True)
        layout.addWidget(self.text)
        row = QHBoxLayout()
        self.write_button = QPushButton(tr("Write the layers"))
        self.copy_button = QPushButton(tr("Copy the command"))
        row.addWidget(self.write_button)
        row.addWidget(self.copy_button)
        layout.addLayout(row)
        layout.addStretch(1)
        self.setWidget(content)

    # --- finding -------------------------------------------------------------------------------------

    def _chosen(self, layer):
        # the box says so, too, where other layers have come or gone
        if not self.asked or layer is not self.asked["INPUT"]:
            self.forget()

    def _removed(self, ids):
        # of this the box says nothing where another layer has come before
        if self.asked and self.asked["id"] in ids:
            self.forget()

    def forget(self) -> None:
        """Take the cuts of another layer off the map."""
        if self.task is not None:
            self.task.cancel()
            self.task = None
        self.preview = self.shown = None
        self.asked = {}
        self.band.reset(QgsWkbTypes.GeometryType.LineGeometry)
        self.progress.setValue(0)
        self.text.setText(tr("Choose a layer, and find its cuts once. Then move the slider."))
        self._enable()

    def _enable(self):
        ready = self.preview is not None
        for widget in (self.slider, self.copy_button, self.by_tau, self.by_parts):
            widget.setEnabled(ready)
        self.write_button.setEnabled(ready and self.writing is None)
        busy = self.task is not None
        self.find_button.setText(tr("Cancel") if busy else tr("Find the cuts"))
        self.find_button.setEnabled(busy or self.layer_box.currentLayer() is not None)

    def find(self, _checked: bool = False) -> Task | None:
        """Solve the layer in the background; pressed again, cancel."""
        if self.task is not None:
            self.forget()
            return None
        self.forget()
        layer = self.layer_box.currentLayer()
        if layer is None:
            return None
        self.asked = asked = {
            "INPUT": layer, "id": layer.id(), "selected": self.only_selected.isChecked(),
            "PLACES": self.places_box.currentData(), "SMALLEST_PART": self.smallest_box.value(),
        }  # fmt: skip
        source, crs, request = QgsVectorLayerFeatureSource(layer), layer.crs(), QgsFeatureRequest()
        if asked["selected"]:
            request.setFilterFids(layer.selectedFeatureIds())

        def work(task):
            from ..algorithms.partition.preview import preview

            check = checker(lambda share: task.setProgress(100.0 * share), task.isCanceled)
            features = list(source.getFeatures(request))
            try:
                found = preview(
                    features, crs, tau=SMALLEST_TAU, places=asked["PLACES"],
                    smallest_part=asked["SMALLEST_PART"], check=check, feedback=QgsProcessingFeedback(False),
                )  # fmt: skip
                begun = time.thread_time()
                found.at_tau(DEFAULT_TAU)
                return found, time.thread_time() - begun
            except Cancelled:
                return None

        self.task = Task(tr("Isthmus: finding cuts"), work, self.found)
        self.task.progressChanged.connect(lambda share: self.progress.setValue(int(share)))
        self._enable()
        self.task.start()
        return self.task

    def found(self, result: tuple[Preview, float] | None, problem: Exception | None) -> None:
        """Take what the background has found."""
        self.task = None
        if problem is not None:
            self.text.setText(f"{type(problem).__name__}: {problem}")
        elif result is not None:
            self.preview, seconds = result
            self.quick = seconds < QUICK
            self.progress.setValue(100)
            self._set_range()
        self._enable()

    # --- showing -------------------------------------------------------------------------------------

    def _set_range(self, _checked=False):
        if self.preview is None:
            return
        self.slider.blockSignals(True)
        if self.by_tau.isChecked():
            self.slider.setRange(0, STEPS)
            self.set_tau(DEFAULT_TAU, quiet=True)
        else:
            self.slider.setRange(1, self.preview.most_parts())
            self.slider.setValue(min(5, self.preview.most_parts()))
        self.slider.blockSignals(False)
        self.update_cuts()

    def _largest(self):
        return max(self.preview.largest_tau(), DEFAULT_TAU) * 1.01

    def tau(self) -> float:
        """Return the tau that the slider stands at: it goes up by a factor, not by a difference."""
        share = self.slider.value() / STEPS
        value = SMALLEST_TAU * (self._largest() / SMALLEST_TAU) ** share
        return float(f"{value:.3g}")

    def set_tau(self, tau: float, quiet: bool = False) -> None:
        """Move the slider to a tau, or next to it."""
        share = math.log(tau / SMALLEST_TAU) / math.log(self._largest() / SMALLEST_TAU)
        self.slider.setValue(round(STEPS * min(max(share, 0.0), 1.0)))
        if not quiet:
            self.update_cuts()

    def update_cuts(self, _value: int | None = None) -> None:
        """Show the cuts for where the slider stands."""
        if self.preview is None:
            return
        if self.by_tau.isChecked():
            if not self.quick and self.slider.isSliderDown():
                self.text.setText(tr("tau = {tau:g}").format(tau=self.tau()))
                return
            self.shown = self.preview.at_tau(self.tau())
            text = tr("tau = {tau:g}").format(tau=self.tau())
        else:
            self.shown = self.preview.at_parts(self.slider.value())
            text = tr("{} of each feature").format(counted(self.slider.value(), "part"))
        text += f": {counted(self.shown.parts, 'part')}, {counted(self.shown.cuts, 'cut')}"
        unsolved = self.preview.unsolved()
        if unsolved:
            text += "\n" + tr("Not everything can be cut: {reasons}").format(
                reasons="; ".join(map(spoken, unsolved))
            )
        self.text.setText(text)
        self.draw()

    def draw(self) -> None:
        """Draw the cuts that are shown, in the CRS of the map."""
        if self.shown is None:
            return
        geometry = QgsGeometry()
        geometry.fromWkb(self.shown.wkb)
        layer = self.asked["INPUT"]
        if layer.crs() == self.canvas.mapSettings().destinationCrs():
            self.band.setToGeometry(geometry)  # half the time where there are many
        else:
            self.band.setToGeometry(geometry, layer)

    # --- writing -------------------------------------------------------------------------------------

    def command(self) -> tuple[str, dict[str, Any]]:
        """Return the tool that makes what is shown, and its parameters but for the layers."""
        asked = {name: self.asked[name] for name in ("PLACES", "SMALLEST_PART")}
        if self.by_tau.isChecked():
            return "isthmus:partition", {"TAU": self.tau(), **asked}
        return "isthmus:hierarchy", {"TAU": SMALLEST_TAU, "PARTS": self.slider.value(), **asked}

    def write(self, _checked: bool = False) -> QgsProcessingAlgRunnerTask:
        """Run the tool in the background, and load its layers."""
        tool, parameters = self.command()
        layer, project = self.asked["INPUT"], QgsProject.instance()
        parameters["INPUT"] = QgsProcessingFeatureSourceDefinition(layer.id(), self.asked["selected"])
        for name in ("OUTPUT", "CUTS"):
            parameters[name] = QgsProcessingOutputLayerDefinition(QgsProcessing.TEMPORARY_OUTPUT, project)
        context, feedback = QgsProcessingContext(), QgsProcessingFeedback(False)
        context.setProject(project)
        algorithm = QgsApplication.processingRegistry().createAlgorithmById(tool)
        task = QgsProcessingAlgRunnerTask(algorithm, parameters, context, feedback)
        self.writing = task, algorithm, context, feedback  # for as long as it runs
        task.executed.connect(self.written)
        self._enable()
        QgsApplication.taskManager().addTask(task)
        return task

    def written(self, ok: bool, _results: dict[str, Any]) -> None:
        """Load the layers that the tool has made."""
        from processing.gui.Postprocessing import handleAlgorithmResults

        _, algorithm, context, feedback = self.writing
        self.writing = None
        self._enable()
        if ok:
            handleAlgorithmResults(algorithm, context, feedback)
        else:
            self.iface.messageBar().pushWarning("Isthmus", tr("The layers could not be written."))

    def copy_command(self, _checked: bool = False) -> None:
        """Put the command that makes the layers onto the clipboard."""
        tool, parameters = self.command()
        layer = self.asked["INPUT"]
        on_disk = layer.providerType() != "memory"
        words = [
            "qgis_process.bin" if shutil.which("qgis_process.bin") else "qgis_process", "run", tool,
            f"--INPUT={layer.source() if on_disk else 'polygons.gpkg'}",
            *(f"--{name}={value}" for name, value in parameters.items()),
            "--OUTPUT=parts.gpkg", "--CUTS=cuts.gpkg",
        ]  # fmt: skip
        QApplication.clipboard().setText(shell_command(words))
        said = tr("The command is on the clipboard.")
        if self.asked["selected"]:
            said += " " + tr("It cuts all features of the layer, for the command line knows no selection.")
        if not on_disk:
            said += " " + tr("Save the layer first, as polygons.gpkg: it is only in memory.")
        self.iface.messageBar().pushInfo("Isthmus", said)

    # --- the end -------------------------------------------------------------------------------------

    def unload(self) -> None:
        """Take the panel and its cuts out of the window."""
        self.forget()
        self.canvas.destinationCrsChanged.disconnect(self.draw)
        QgsProject.instance().layersRemoved.disconnect(self._removed)
        self.canvas.scene().removeItem(self.band)
        self.iface.removeDockWidget(self)
        self.deleteLater()
