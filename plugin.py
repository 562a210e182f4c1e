"""The plugin that QGIS loads: it registers the Processing provider and, in the window, a menu."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.core import QgsApplication

from .algorithms import packages, words
from .algorithms.provider import IsthmusProvider

if TYPE_CHECKING:
    from qgis.gui import QgisInterface

    from .gui.menu import Menu


class IsthmusPlugin:
    """Registers the provider. ``iface`` is None under qgis_process."""

    def __init__(self, iface: QgisInterface | None) -> None:
        self.iface = iface
        self.provider: IsthmusProvider | None = None
        self.menu: Menu | None = None
        self.translator = words.load_translation()
        packages.activate()

    def initProcessing(self) -> None:
        """Register the provider; qgis_process calls this without `initGui`."""
        self.provider = IsthmusProvider()
        QgsApplication.processingRegistry().addProvider(self.provider)

    def initGui(self) -> None:
        """Register the provider in the window, and add the menu."""
        from .gui.menu import Menu

        self.initProcessing()
        self.menu = Menu(self.iface)

    def unload(self) -> None:
        """Take the provider and the menu out again."""
        if self.menu is not None:
            self.menu.unload()
            self.menu = None
        if self.provider is not None:
            QgsApplication.processingRegistry().removeProvider(self.provider)
            self.provider = None
        if self.translator is not None:
            QgsApplication.instance().removeTranslator(self.translator)
            self.translator = None
