"""Work in the background."""

from __future__ import annotations

from typing import Any, Callable

from qgis.core import QgsApplication, QgsTask
from qgis.PyQt.QtCore import pyqtSignal


class Task(QgsTask):
    """Runs ``work(task)`` in a thread of QGIS's, then ``done(result, problem)`` in that of the window.

    ``problem`` is the exception that the work ended with, if any; a cancelled task says nothing more.
    """

    said = pyqtSignal(str)

    def __init__(
        self, title: str, work: Callable[[Task], Any], done: Callable[[Any, Exception | None], Any]
    ) -> None:
        super().__init__(title, QgsTask.Flag.CanCancel)
        self.work: Callable[[Task], Any] | None = work
        self.done: Callable[[Any, Exception | None], Any] | None = done
        self.result: Any = None
        self.problem: Exception | None = None

    def start(self) -> Task:
        QgsApplication.taskManager().addTask(self)
        return self

    def run(self) -> bool:
        try:
            if self.work is not None:
                self.result = self.work(self)
        except Exception as problem:  # whatever it is, the user has to be told
            self.problem = problem
        return self.problem is None

    def finished(self, _ok: bool) -> None:
        done, self.done, self.work = self.done, None, None
        if done is not None and not self.isCanceled():
            done(self.result, self.problem)
