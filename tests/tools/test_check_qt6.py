"""The lint for Qt 6 finds faults that are planted, and none in this repository."""

from pathlib import Path

import pytest

pytest.importorskip("qgis.core", reason="these tests need QGIS")

ROOT = Path(__file__).resolve().parents[2]
CORE = "from qgis.core import Qgis, QgsProcessing, QgsProcessingAlgorithm, QgsWkbTypes\n"
QT = "from qgis.PyQt.QtCore import QDateTime, QDate, Qt, QVariant\n"

PLANTED = {
    "unscoped, QGIS": (CORE + "x = QgsWkbTypes.Polygon", "QgsWkbTypes.Type.Polygon"),
    "unscoped, in a call": (CORE + "f(a=[QgsProcessing.TypeVectorPolygon])", "SourceType"),
    "unscoped, Qt": (QT + "x = Qt.Horizontal", "Qt.Orientation.Horizontal"),
    "unscoped, by module": ("import qgis.core\nx = qgis.core.QgsWkbTypes.Polygon", "Type.Polygon"),
    "unscoped, by another name": (CORE.strip() + " as W\nx = W.Polygon", "Type.Polygon"),
    "unscoped, by an alias": (CORE + "a, w = 1, QgsWkbTypes\nx = w.Polygon", "Type.Polygon"),
    "unscoped, by getattr": (CORE + "x = getattr(QgsWkbTypes, 'Polygon')", "Type.Polygon"),
    "unscoped, of a base": (
        "from qgis.core import QgsProcessingParameterNumber as P\nx = P.FlagAdvanced",
        "QgsProcessingParameterNumber.Flag.FlagAdvanced",
    ),
    "unscoped, of self": (
        CORE + "class A(QgsProcessingAlgorithm):\n def flags(self):\n  return self.FlagHideFromModeler",
        "FlagHideFromModeler",
    ),
    "unscoped, of super": (
        "class A(B):\n def flags(self):\n  return super().flags() | super().FlagHideFromModeler",
        "FlagHideFromModeler",
    ),
    "unscoped, of an object": ("def f(parameter):\n return parameter.FlagAdvanced", "Flag.FlagAdvanced"),
    "no such member": (CORE + "x = QgsWkbTypes.Type.Polygone", "has no Polygone"),
    "no such class": ("from qgis.core import QgsNothing", "has no QgsNothing"),
    "PyQt5": ("from PyQt5.QtCore import Qt", "qgis.PyQt"),
    "PyQt6": ("import PyQt6.QtCore", "qgis.PyQt"),
    "PyQt5 in a function": ("def f():\n from PyQt5 import QtGui", "qgis.PyQt"),
    "all names": ("from qgis.core import *", "one by one"),
    "the module Qt": ("from qgis.PyQt.Qt import Qt", "gone in Qt 6"),
    "exec_": ("dialog.exec_()", "exec in Qt 6"),
    "def exec_": ("class A:\n def exec_(self):\n  pass", "exec in Qt 6"),
    "a null QVariant": (QT + "x = QVariant()", "NULL"),
    "a typed null QVariant": (QT + "x = QVariant(QVariant.Type.Int)", "NULL"),
    "a date and no time": (QT + "x = QDateTime(QDate(2026, 1, 1))", "QTime"),
    "eight numbers": (QT + "x = QDateTime(1, 2, 3, 4, 5, 6, 7, 8)", "QTime"),
    "qApp": ("from qgis.PyQt.QtWidgets import qApp\nqApp.quit()", "QApplication.instance()"),
    "compiled resources": ("from . import resources_rc", "compiled resources"),
    "activated[str]": ("box.activated[str].connect(f)", "textActivated"),
    "QFontMetrics.width": ("x = self.fontMetrics().width(text)", "horizontalAdvance"),
    "addAction": ("menu.addAction(icon, text, self, slot)", "QAction first"),
}  # fmt: skip

FINE = [
    CORE + "x = QgsWkbTypes.Type.Polygon, Qgis.QGIS_VERSION_INT, QgsWkbTypes.hasZ(3)",
    QT + "x = Qt.Orientation.Horizontal, QVariant",
    CORE
    + "class A(QgsProcessingAlgorithm):\n INPUT = 'INPUT'\n def f(self):\n  return self.INPUT, self.name()",
    "import shapely\nx = shapely.Polygon",
    "class A:\n Polygon = 1\n def f(self):\n  return self.Polygon",
    CORE + "w = QgsWkbTypes.Type\nx = w.Polygon",
]


@pytest.fixture(scope="module")
def check_qt6(tool):
    return tool("check_qt6")


@pytest.mark.parametrize("planted", PLANTED)
def test_planted_faults(check_qt6, planted):
    source, words = PLANTED[planted]
    faults = check_qt6.faults(source)
    assert any(words in text for _, text in faults), faults


@pytest.mark.parametrize("source", FINE)
def test_no_fault_where_there_is_none(check_qt6, source):
    assert check_qt6.faults(source) == []


@pytest.fixture
def stubs(check_qt6, tmp_path):
    """Stubs in the form of PyQt 6, of a few classes."""
    (tmp_path / "QtCore.pyi").write_text(
        "class QObject(PyQt6.sip.wrapper):\n    def parent(self, *a, /) -> int: ...\n"
        "class Qt(PyQt6.sip.simplewrapper):\n    class Orientation(enum.Flag):\n"
        "        Horizontal = ... # type: Qt.Orientation\n"
        "class QTimer(QObject):\n    timeout: typing.ClassVar[pyqtSignal]\n"
    )
    (tmp_path / "QtGui.pyi").write_text("class QAction(QtCore.QObject): ...\n")
    (tmp_path / "QtWidgets.pyi").write_text("class QWidget(QObject): ...\n")
    (tmp_path / "QtBroken.pyi").write_text("class : ...\n")
    return check_qt6.Stubs(tmp_path)


@pytest.mark.parametrize("source, words", [
    ("from qgis.PyQt.QtWidgets import QAction", "it is in QtGui"),
    ("from qgis.PyQt.QtCore import QRegExp", "no QtCore.QRegExp"),
    ("from qgis.PyQt import QtSvg", "no module QtSvg"),
    ("from qgis.PyQt import QtCore\nx = QtCore.QTimer.noSignal", "has no noSignal in this QGIS"),
    ("from qgis.PyQt.QtCore import QTimer\nx = QTimer.singleShot", "no QtCore.QTimer.singleShot"),
    ("from qgis.PyQt.QtCore import Qt\nx = Qt.Orientation.Vertical", "no QtCore.Qt.Orientation.Vertical"),
    ("from qgis.PyQt.QtCore import Qt\nx = Qt.Horizontal", "Qt.Orientation.Horizontal"),
    ("from qgis.PyQt.QtCore import QTimer\nx = QTimer.timeout, QTimer.parent", None),
    ("try:\n from qgis.PyQt.QtCore import QRegExp as R\nexcept ImportError:\n R = None", None),
    ("try:\n x = 1\nexcept ImportError:\n from qgis.PyQt.QtCore import QRegExp", "no QtCore.QRegExp"),
    ("from qgis.PyQt.QtCore import Qt\nx = Qt.Orientation.Horizontal", None),
])  # fmt: skip
def test_what_qt_6_lacks(check_qt6, stubs, source, words):
    faults = check_qt6.faults(source, stubs)
    if words is None:
        assert faults == []
    else:
        assert any(words in text for _, text in faults), faults


def test_this_repository(check_qt6):
    files = list(check_qt6.python_files([ROOT]))
    assert ROOT / "algorithms" / "base.py" in files
    assert not any({".venv", "build"} & set(path.relative_to(ROOT).parts) for path in files)
    faults = {str(path): check_qt6.faults(path.read_text(encoding="utf-8")) for path in files}
    assert not {path: found for path, found in faults.items() if found}
