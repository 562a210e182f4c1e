"""The plugin that QGIS loads: it registers the Processing provider, and nothing else."""

from qgis.core import QgsApplication

from .algorithms.provider import IsthmusProvider


class IsthmusPlugin:
    """Registers the provider. ``iface`` is None under qgis_process."""

    def __init__(self, iface):
        self.iface = iface
        self.provider = None

    def initProcessing(self):
        """Register the provider; qgis_process calls this without `initGui`."""
        self.provider = IsthmusProvider()
        QgsApplication.processingRegistry().addProvider(self.provider)

    def initGui(self):
        """Register the provider in the window."""
        self.initProcessing()

    def unload(self):
        """Take the provider out again."""
        if self.provider is not None:
            QgsApplication.processingRegistry().removeProvider(self.provider)
            self.provider = None
