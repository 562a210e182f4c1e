"""Screenshots of the tools in the real QGIS window, on a virtual screen.

    ./run python tools/window.py [--size 1600x1000] [--lang de] [--theme "Night Mapping"] [SCENE ...]

The pictures are in build/window. Without a scene, all are made; ``--list`` names them. Needs the
packages qgis, xvfb and openbox.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
import traceback
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TOOLS = (
    "partition", "partitionbudget", "tradeoff", "hierarchy", "prepareaggregation", "aggregate", "focusmap",
)  # fmt: skip
COUNTRIES = "iso_a2 IN ('AL','AT','BA','BG','GR','HR','HU','IT','ME','MK','RO','RS','SI','TR','XK')"
# in metres and square metres, for the map's coordinates are degrees
CUTTING = {"TAU": 3}

SETTINGS = """\
[PythonPlugins]
isthmus=true
processing=true

[qgis]
checkVersion=false
projOpenAtLaunch=3

[app]
projections\\unknownCrsBehavior=NoAction
projections\\promptWhenMultipleTransformsExist=false

[core]
NewsFeed\\httpsfeedqgisorg\\disabled=true

[UI]
UITheme={theme}

[locale]
overrideFlag={override}
userLocale={lang}
globalLocale={lang}

[Processing]
Configuration\\MAX_THREADS=1
"""

# --- Outside: start QGIS on a virtual screen ---------------------------------------------------------


def main():
    """Start QGIS with this file inside."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    parser.add_argument("--list", action="store_true", help="name the scenes")
    parser.add_argument("--size", default="1600x1000", help="of the screen (default %(default)s)")
    parser.add_argument("--lang", default="en_US", help="of the window (default %(default)s)")
    parser.add_argument("--theme", default="default", help='of the window, such as "Night Mapping"')
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "window")
    choice = parser.parse_args()
    unknown = set(choice.scenes) - set(SCENES)
    if choice.list or unknown:
        sys.exit(f"{'unknown: ' * bool(unknown)}{' '.join(unknown)}\nscenes: {' '.join(SCENES)}")
    missing = [name for name in ("qgis", "xvfb-run", "openbox") if not shutil.which(name)]
    if missing:
        sys.exit(f"missing: {' '.join(missing)}. On Debian: apt-get install qgis xvfb xauth openbox")

    out = choice.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    profile = Path(os.environ["QGIS_CUSTOM_CONFIG_PATH"]) / "profiles" / "default"
    (profile / "QGIS").mkdir(parents=True)
    (profile / "QGIS" / "QGIS3.ini").write_text(
        SETTINGS.format(theme=choice.theme, lang=choice.lang, override=str(choice.lang != "en_US").lower())
    )
    shutil.copytree(ROOT / "resources" / "models", profile / "processing" / "models")
    start = profile / "start.py"
    start.write_text(
        f"import sys\nsys.path.insert(0, {str(ROOT / 'tools')!r})\nimport window\nwindow.inside()\n"
    )
    environment = dict(os.environ, ISTHMUS_WINDOW=json.dumps([str(out), choice.scenes or list(SCENES)]))
    done = on_a_screen(
        ["qgis", "--nologo", "--noversioncheck", "--code", str(start)], out, environment, choice.size
    )
    print((out / "said.txt").read_text(encoding="utf-8") if (out / "said.txt").exists() else "")
    if done.returncode:
        sys.exit(f"QGIS ended with {done.returncode}; see {out / 'qgis.log'}")


def on_a_screen(command, out, environment, size):
    """Run a command that opens windows on a virtual screen with a window manager; log in ``out``."""
    with open(out / "qgis.log", "w", encoding="utf-8") as log:
        return subprocess.run(
            ["xvfb-run", "-a", "-s", f"-screen 0 {size}x24", "sh", "-c",
             'openbox 2>/dev/null & exec "$@"', "sh", "timeout", "1800", *command],
            env={**environment, "QT_QPA_PLATFORM": "xcb"},
            stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
        )  # fmt: skip


# --- Inside: scenes, each a generator that yields what to wait for ------------------------------------
# A number of seconds, or a function that is asked until it says yes.


def inside():
    """Play the scenes in the window that has just opened, then end QGIS."""
    out, names = json.loads(os.environ["ISTHMUS_WINDOW"])
    stage = Stage(Path(out))

    def play():
        yield from stage.open()
        for name in names:
            stage.say(f"scene {name}")
            yield from SCENES[name](stage)
            yield from stage.clear()

    stage.run(play())


class Stage:
    """The window, and what the scenes do with it."""

    patience = 300.0  # seconds

    def __init__(self, out):
        self.out = out
        (out / "said.txt").write_text("")

    def say(self, *words):
        with open(self.out / "said.txt", "a", encoding="utf-8") as said:
            print(*words, file=said)

    def run(self, steps):
        from qgis.PyQt.QtCore import QTimer

        def later(seconds):
            QTimer.singleShot(int(1000 * seconds), step)

        asked = None, 0.0

        def step():
            nonlocal asked
            try:
                ready, deadline = asked
                if ready is not None and not ready():
                    if time.monotonic() > deadline:
                        raise TimeoutError("waited too long")
                    return later(0.05)
                wanted = next(steps)
            except StopIteration:
                os._exit(0)  # nobody is there to answer "save the project?"
            except BaseException:
                self.say(traceback.format_exc())
                self.shot("failed")
                os._exit(1)
            if callable(wanted):
                asked = wanted, time.monotonic() + self.patience
                return later(0.05)
            asked = None, 0.0
            later(wanted)

        later(2)

    def open(self):
        from qgis.core import QgsProject, QgsVectorLayer, QgsApplication
        from qgis.utils import iface

        self.iface, self.project = iface, QgsProject.instance()
        self.window = iface.mainWindow()
        self.window.showMaximized()
        # a copy, because opening a GeoPackage may write to it, and this one belongs to the system
        world = self.out / "world_map.gpkg"
        shutil.copyfile(Path(QgsApplication.pkgDataPath()) / "resources/data/world_map.gpkg", world)
        self.countries = QgsVectorLayer(f"{world}|layername=countries", "countries", "ogr")
        self.countries.setSubsetString(COUNTRIES)
        self.project.addMapLayer(self.countries)
        iface.setActiveLayer(self.countries)
        for name in ("Browser", "Browser2"):
            self.window.findChild(object, name).hide()
        iface.mapCanvas().setExtent(self.countries.extent())
        yield 2

    def clear(self):
        """Close what a scene has opened."""
        from qgis.PyQt.QtWidgets import QApplication, QDialog, QMainWindow

        for widget in QApplication.topLevelWidgets():
            if widget.isVisible() and widget is not self.window:
                if isinstance(widget, (QDialog, QMainWindow)):
                    widget.close()
        for layer in list(self.project.mapLayers().values()):
            if layer is not self.countries:
                self.project.removeMapLayer(layer)
        self.countries.removeSelection()
        self.iface.messageBar().clearWidgets()
        self.iface.setActiveLayer(self.countries)
        self.iface.mapCanvas().setExtent(self.countries.extent())
        self.iface.mapCanvas().refresh()
        yield 0.5

    def shot(self, name, widget=None):
        """Grab the screen, or what it shows of a widget."""
        screen = self.window.windowHandle().screen()
        if widget is None:
            picture = screen.grabWindow(0)
        else:
            frame = widget.frameGeometry()
            picture = screen.grabWindow(0, frame.x(), frame.y(), frame.width(), frame.height())
        picture.save(str(self.out / f"{name}.png"))
        self.say(f"  {name}.png")

    def dialog(self, tool, parameters=None):
        """Open the dialog of a tool of ours, or of a model by its id."""
        import processing

        dialog = processing.createAlgorithmDialog(
            tool if ":" in tool else f"isthmus:{tool}", parameters or {}
        )
        dialog.show()
        return dialog

    def finished(self, dialog):
        """Whether the tool that a dialog runs is done."""
        return lambda: dialog.wasExecuted() and dialog.runButton().isEnabled()


SCENES = {}


def scene(function):
    SCENES[function.__name__] = function
    return function


def expand(dialog):
    """Open the advanced section of a dialog."""
    from qgis.PyQt.QtWidgets import QGroupBox

    for box in dialog.findChildren(QGroupBox):
        if box.property("collapsed"):
            box.setProperty("collapsed", False)


@scene
def toolbox(stage):
    """The tools as the toolbox lists them."""
    from qgis.PyQt.QtWidgets import QDockWidget

    dock = stage.window.findChild(QDockWidget, "ProcessingToolbox")
    dock.show()
    yield 1
    dock.algorithmTree.expandAll()
    dock.searchBox.setText("isthmus")
    yield 1
    stage.shot("toolbox")
    dock.searchBox.setText("split polygon narrow")
    yield 1
    stage.shot("toolbox-search", dock)
    dock.searchBox.setText("")
    dock.hide()


@scene
def dialogs(stage):
    """Every dialog as QGIS opens it, and with its advanced section and all of the form."""
    for tool in TOOLS:
        dialog = stage.dialog(tool)
        yield 0.7
        stage.shot(f"dialog-{tool}", dialog)
        dialog.close()
        yield 0.3
    for tool in TOOLS:
        dialog = stage.dialog(tool)
        yield 0.3
        expand(dialog)
        dialog.resize(1150, 960)
        dialog.move(20, 20)
        yield 0.7
        stage.shot(f"dialog-{tool}-all", dialog)
        dialog.close()
        yield 0.3


@scene
def result(stage):
    """A run from the dialog: its log, the styled layers, the attribute tables."""
    from qgis.PyQt.QtWidgets import QApplication

    dialog = stage.dialog("partition", CUTTING)
    yield 0.7
    dialog.runButton().click()
    yield stage.finished(dialog)
    yield 2
    stage.shot("result-log")
    dialog.close()
    yield 2
    stage.shot("result-map")
    for name in ("Parts", "Cuts"):
        (layer,) = stage.project.mapLayersByName(name)
        before = set(QApplication.topLevelWidgets())
        stage.iface.showAttributeTable(layer)
        yield 1.5
        for table in set(QApplication.topLevelWidgets()) - before:
            if table.isVisible():
                table.resize(1100, 500)
                yield 0.5
                stage.shot(f"result-table-{name.lower()}", table)
                table.close()
    canvas = stage.iface.mapCanvas()
    for factor in (0.25, 0.1):
        canvas.zoomByFactor(factor)
        yield 2
    stage.shot("result-near")
    canvas.zoomByFactor(400)
    yield 2
    stage.shot("result-far")


@scene
def cancel(stage):
    """A polygon of a million vertices: the progress bar, and what Cancel does."""
    stage.project.addMapLayer(rough_polygon(1_000_000))
    dialog = stage.dialog("partition", {"INPUT": "rough polygon", "OBJECTIVE": "MinLength"})
    yield 0.7
    for share in (20, 80):
        layers = len(stage.project.mapLayers())
        dialog.runButton().click()
        yield lambda share=share: bar(dialog).value() >= share
        stage.shot(f"cancel-at-{share}", dialog)
        begun = time.monotonic()
        dialog.cancelButton().click()
        yield dialog.runButton().isEnabled
        stage.say(
            f"  cancelled at {share} %: stopped after {time.monotonic() - begun:.2f} s,",
            f"{len(stage.project.mapLayers()) - layers} new layers",
        )
        yield 1
        stage.shot(f"cancelled-at-{share}", dialog)


def bar(dialog):
    """The progress bar of a dialog."""
    from qgis.PyQt.QtWidgets import QProgressBar

    return dialog.findChild(QProgressBar)


def rough_polygon(count):
    """A layer of one polygon like an island."""
    from qgis.core import QgsFeature, QgsVectorLayer

    layer = QgsVectorLayer("Polygon?crs=EPSG:3035", "rough polygon", "memory")
    feature = QgsFeature()
    feature.setGeometry(rough_island(count))
    layer.dataProvider().addFeatures([feature])
    layer.updateExtents()
    return layer


def rough_island(count):
    """A circle with noise of all wave lengths."""
    import numpy as np
    from qgis.core import QgsGeometry

    random = np.random.default_rng(1)
    angle = np.linspace(0.0, 2 * np.pi, count, endpoint=False)
    wave = np.arange(count // 2 + 1.0)
    wave[1:] **= -1.2
    noise = np.fft.irfft(wave * np.exp(2j * np.pi * random.random(len(wave))), count)
    radius = 1e6 * np.exp(0.35 * noise / noise.std())  # positive, so that no edges cross
    xy = np.c_[radius * np.cos(angle), radius * np.sin(angle)]
    head = np.array([3, 1, count + 1], "<u4").tobytes()
    geometry = QgsGeometry()
    geometry.fromWkb(b"\x01" + head + np.vstack((xy, xy[:1])).tobytes())
    return geometry


@scene
def report(stage):
    """The report of the trade-off curves: where the window lists it, and as a browser shows it."""
    path = stage.out / "report.html"
    dialog = stage.dialog("tradeoff", {"MIN_LENGTH": 20_000, "MIN_HOLE": 1e8, "REPORT": str(path)})
    yield 0.7
    dialog.runButton().click()
    yield stage.finished(dialog)
    dialog.close()
    yield 1
    stage.shot("report-window")
    try:  # many builds of QGIS are without
        from qgis.PyQt.QtWebKitWidgets import QWebView
    except ImportError:
        return
    view = QWebView()
    view.resize(900, 950)
    view.setHtml(path.read_text(encoding="utf-8"))
    view.show()
    yield 2
    stage.shot("report", view)
    view.close()


@scene
def others(stage):
    """What the other tools leave on the map."""
    from qgis.core import QgsCoordinateReferenceSystem

    dialog = stage.dialog("prepareaggregation", {"CLASS": "NAME", "TAU": 4, "MIN_LENGTH": 20_000})
    yield 0.7
    dialog.runButton().click()
    yield stage.finished(dialog)
    dialog.close()
    yield 2
    stage.shot("pieces-map")
    import processing

    projected = processing.run(
        "native:reprojectlayer",
        {
            "INPUT": stage.countries,
            "TARGET_CRS": QgsCoordinateReferenceSystem("EPSG:3035"),
            "OUTPUT": "memory:countries in metres",
        },
    )["OUTPUT"]
    stage.project.addMapLayer(projected)
    dialog = stage.dialog("partition")
    yield 0.7
    stage.shot("dialog-metres", dialog)
    dialog.close()
    projected.selectByExpression("NAME = 'Greece'")
    dialog = stage.dialog("focusmap", {"INPUT": "countries in metres"})
    yield 1
    dialog.runButton().click()
    yield 2
    stage.shot("focusmap-said", dialog)
    dialog.close()


@scene
def menu(stage):
    """The menu, the example by its button, and the panel: how a slider moves the cuts, and the written layers."""
    from qgis.utils import plugins

    ours = plugins["isthmus"].menu
    ours.menu.popup(stage.window.mapToGlobal(stage.window.rect().center()))
    yield 1
    stage.shot("menu")
    ours.menu.close()
    ours.try_example()
    yield 2
    stage.shot("example")
    panel = ours.open_panel()
    panel.layer_box.setLayer(stage.countries)
    panel.find_button.click()
    yield lambda: panel.task is None
    for tau in (2, 5):
        panel.set_tau(tau)
        yield 1
        stage.shot(f"panel-tau-{tau}")
    panel.write_button.click()
    yield lambda: panel.writing is None
    yield 2
    stage.shot("panel-written")
    panel.forget()
    panel.close()
    dialog = ours.install_packages()
    yield 1
    stage.shot("packages", dialog)
    dialog.close()


@scene
def models(stage):
    """The example models in the designer, and their dialogs."""
    from processing.modeler.ModelerDialog import ModelerDialog
    from qgis.core import QgsApplication

    for model in QgsApplication.processingRegistry().providerById("model").algorithms():
        name = model.name().replace(" ", "_").lower()
        designer = ModelerDialog.create(model.create())
        designer.show()
        designer.showMaximized()
        yield 2
        stage.shot(f"model-{name}")
        designer.close()
        dialog = stage.dialog(model.id())
        expand(dialog)
        yield 1
        stage.shot(f"model-{name}-dialog", dialog)
        dialog.close()
        yield 0.5


@scene
def selected(stage):
    """Selected features only, tau by an expression, and what the history keeps of it."""
    from qgis.core import QgsProcessingFeatureSourceDefinition, QgsProperty

    stage.countries.selectByExpression("NAME IN ('Italy', 'Greece')")
    parameters = {
        **CUTTING,
        "INPUT": QgsProcessingFeatureSourceDefinition(stage.countries.id(), True),
        "TAU": QgsProperty.fromExpression("if(NAME = 'Italy', 8, 3)"),
    }
    dialog = stage.dialog("partition", parameters)
    yield 0.7
    stage.shot("selected", dialog)
    dialog.runButton().click()
    yield stage.finished(dialog)
    yield 1
    stage.shot("selected-map")
    if hasattr(dialog.algorithm(), "asQgisProcessCommand"):  # QGIS 3.24
        from qgis.core import QgsProcessingContext

        values = dialog.createProcessingParameters()
        stage.say(dialog.algorithm().asPythonCommand(values, QgsProcessingContext()))
        stage.say(dialog.algorithm().asQgisProcessCommand(values, QgsProcessingContext()))
    dialog.close()
    try:
        from processing.gui.HistoryDialog import HistoryDialog
    except ImportError:  # QGIS 3.26 has another
        return
    history = HistoryDialog()
    history.show()
    history.tree.setCurrentItem(history.tree.topLevelItem(0).child(0))
    yield 1
    stage.shot("history", history)
    history.close()


@scene
def batch(stage):
    """The batch window."""
    from processing.gui.BatchAlgorithmDialog import BatchAlgorithmDialog
    from qgis.core import QgsApplication

    tool = QgsApplication.processingRegistry().createAlgorithmById("isthmus:partition")
    window = BatchAlgorithmDialog(tool, parent=stage.window)
    window.show()
    yield 1
    stage.shot("batch", window)
    window.close()


@scene
def readme(stage):
    """The picture of the README, for a screen of 1280x720: the dialog beside what it made."""
    from qgis.core import QgsCoordinateReferenceSystem, QgsRectangle
    from qgis.PyQt.QtCore import Qt
    from qgis.PyQt.QtWidgets import QDockWidget, QSplitter, QToolBar

    for bar in stage.window.findChildren(QToolBar):
        bar.hide()
    canvas = stage.iface.mapCanvas()
    stage.project.setCrs(QgsCoordinateReferenceSystem("EPSG:3035"))
    layers = stage.window.findChild(QDockWidget, "Layers")
    stage.window.resizeDocks([layers], [180], Qt.Orientation.Horizontal)
    dialog = stage.dialog("partition", CUTTING)
    yield 0.7
    dialog.runButton().click()
    yield stage.finished(dialog)
    dialog.showParameters()
    dialog.findChild(QSplitter).setSizes([1, 0])
    yield 0.3
    dialog.resize(430, 600)
    yield 0.3
    dialog.move(stage.window.width() - dialog.width() - 12, 60)
    canvas.setExtent(QgsRectangle(4_070_000, 1_480_000, 6_700_000, 2_750_000))
    canvas.refresh()
    yield 3
    stage.shot("readme")
    dialog.close()


if __name__ == "__main__":
    main()
