"""Work in the background."""

from qgis.core import QgsApplication, QgsTask
from qgis.PyQt.QtCore import pyqtSignal


class Task(QgsTask):
    """Runs ``work(task)`` in a thread of QGIS's, then ``done(result, problem)`` in that of the window.

    ``problem`` is the exception that the work ended with, if any; a cancelled task says nothing more.
    """

    said = pyqtSignal(str)

    def __init__(self, title, work, done):
        super().__init__(title, QgsTask.Flag.CanCancel)
        self.work, self.done = work, done
        self.result = self.problem = None

    def start(self):
        QgsApplication.taskManager().addTask(self)
        return self

    def run(self):
        try:
            self.result = self.work(self)
        except Exception as problem:  # whatever it is, the user has to be told
            self.problem = problem
        return self.problem is None

    def finished(self, _ok):
        done, self.done, self.work = self.done, None, None
        if done is not None and not self.isCanceled():
            done(self.result, self.problem)
