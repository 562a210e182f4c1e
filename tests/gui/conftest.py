"""A window with what the plugin asks of QGIS's own, on no screen."""

import pytest

pytest.importorskip("qgis.gui", reason="these tests need QGIS")

from qgis.core import Qgis, QgsLayerTreeModel, QgsProject  # noqa: E402
from qgis.gui import QgsLayerTreeView, QgsMapCanvas, QgsMessageBar  # noqa: E402
from qgis.PyQt.QtCore import QEventLoop, QTimer  # noqa: E402
from qgis.PyQt.QtWidgets import QMainWindow  # noqa: E402


class Iface:
    """The part of QgisInterface that is used, on real widgets."""

    def __init__(self):
        self.window = QMainWindow()
        self.canvas = QgsMapCanvas(self.window)
        self.window.setCentralWidget(self.canvas)
        self.menu = self.window.menuBar().addMenu("Plugins")
        self.toolbar = self.window.addToolBar("Plugins")
        self.bar = QgsMessageBar(self.window)

    def mainWindow(self):
        return self.window

    def mapCanvas(self):
        return self.canvas

    def pluginMenu(self):
        return self.menu

    def messageBar(self):
        return self.bar

    def addToolBarWidget(self, widget):
        return self.toolbar.addWidget(widget)

    def removeToolBarIcon(self, action):
        self.toolbar.removeAction(action)

    def addDockWidget(self, area, dock):
        self.window.addDockWidget(area, dock)

    def removeDockWidget(self, dock):
        self.window.removeDockWidget(dock)


@pytest.fixture
def iface(provider, monkeypatch):
    import qgis.utils

    QgsProject.instance().clear()
    if Qgis.QGIS_VERSION_INT >= 34400:
        # Processing asks for QGIS's own list of layers, and takes no stand-in for it any more
        view = QgsLayerTreeView()
        # the view does not hold its model
        view.setModel(QgsLayerTreeModel(QgsProject.instance().layerTreeRoot(), view))
        monkeypatch.setattr(qgis.utils.iface, "layerTreeView", lambda: view, raising=False)
    yield Iface()
    QgsProject.instance().clear()


@pytest.fixture
def wait():
    """Let the window live until something is so: ``wait(ask)``."""

    def wait(ask, seconds=60.0):
        loop, poll, end = QEventLoop(), QTimer(), QTimer()
        poll.timeout.connect(lambda: ask() and loop.quit())
        end.setSingleShot(True)
        end.timeout.connect(loop.quit)
        poll.start(10)
        end.start(int(1000 * seconds))
        loop.exec()
        poll.stop()
        assert ask(), "waited too long"

    return wait
