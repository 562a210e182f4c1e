"""The dialog that fetches what QGIS's Python lacks, if the user wants it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable

from qgis.core import QgsFeedback
from qgis.PyQt.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QLabel,
    QPlainTextEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from ..algorithms import packages
from ..algorithms.dependencies import dependency_problem, install_hint
from ..algorithms.words import tr
from .task import Task

if TYPE_CHECKING:
    from qgis.PyQt.QtGui import QCloseEvent


class PackagesDialog(QDialog):
    """Says what is missing, where it would come from and go to, and does it or undoes it."""

    def __init__(self, parent: QWidget | None = None, *, then: Callable[[], Any] | None = None) -> None:
        super().__init__(parent)
        self.then = then
        self.task: Task | None = None
        self.feedback: QgsFeedback | None = None
        self.setWindowTitle(tr("Isthmus: install packages"))
        self.resize(640, 420)
        layout = QVBoxLayout(self)
        self.text = QLabel()
        self.text.setWordWrap(True)
        layout.addWidget(self.text)
        self.choices = {}
        for name in packages.missing():
            purpose, licence, size = packages.PURPOSES[name], packages.LICENCES[name], packages.SIZES[name]
            box = QCheckBox(f"{name}: {tr(purpose)} ({tr('about {size}').format(size=size)}; {tr(licence)})")
            box.setChecked(True)
            self.choices[name] = box
            layout.addWidget(box)
        self.log = QPlainTextEdit()
        self.log.setReadOnly(True)
        layout.addWidget(self.log, 1)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        role = QDialogButtonBox.ButtonRole.ActionRole
        self.install_button = QPushButton(tr("Fetch and install"))
        self.remove_button = QPushButton(tr("Undo: remove them"))
        self.buttons.addButton(self.install_button, role)
        self.buttons.addButton(self.remove_button, role)
        self.buttons.rejected.connect(self.close)
        self.install_button.clicked.connect(self.install)
        self.remove_button.clicked.connect(self.remove)
        layout.addWidget(self.buttons)
        self.refresh()

    def refresh(self) -> None:
        """Say how things stand now."""
        names = packages.missing()
        for name, box in self.choices.items():
            box.setVisible(name in names)
        if names:
            self.text.setText(tr(
                "These Python packages are missing in QGIS. A click fetches them from pypi.org and puts "
                "them into the folder {folder}, which Isthmus alone adds to QGIS. The packages of QGIS, "
                "numpy above all, stay as they are."
            ).format(folder=packages.folder()))  # fmt: skip
        else:
            self.text.setText(tr("Nothing is missing: all tools can run."))
        self.install_button.setEnabled(bool(names) and self.task is None)
        self.remove_button.setEnabled(bool(packages.installed()) and self.task is None)
        if packages.installed():
            there = ", ".join(packages.installed())
            self.log.appendPlainText(tr("In the folder: {names}").format(names=there))

    def install(self) -> None:
        """Fetch what is chosen, in the background."""
        import numpy

        names = [name for name, box in self.choices.items() if box.isChecked() and name in packages.missing()]
        self.feedback = QgsFeedback()
        self.task = Task(
            tr("Isthmus: fetching packages"),
            lambda task: packages.install(names, numpy.__version__, task.said.emit, feedback=self.feedback),
            self.installed,
        )
        self.task.said.connect(self.log.appendPlainText)
        self.task.start()
        self.refresh()

    def installed(self, _result: Any, problem: Exception | None) -> None:
        """Say how it went, and go on with what was wanted."""
        self.task = None
        if problem is not None:
            import numpy

            known = isinstance(problem, packages.PackageError)
            said = str(problem) if known else f"{type(problem).__name__}: {problem}"
            self.log.appendPlainText(f"{said}\n\n{install_hint(numpy.__version__)}")
        elif dependency_problem():
            self.log.appendPlainText(tr("Please start QGIS again: an older shapely is in use."))
        self.refresh()
        if problem is None and not dependency_problem() and self.then is not None:
            then, self.then = self.then, None
            self.close()
            then()

    def remove(self) -> None:
        """Undo it."""
        done = packages.remove()
        self.log.appendPlainText(
            tr("Removed.") if done else tr("They are in use, and go when QGIS starts again.")
        )
        self.refresh()

    def closeEvent(self, event: QCloseEvent) -> None:
        if self.feedback is not None:
            self.feedback.cancel()
        super().closeEvent(event)
