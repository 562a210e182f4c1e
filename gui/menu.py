"""The menu Plugins > Isthmus, and the same menu as one button of the toolbar."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QUrl
from qgis.PyQt.QtGui import QDesktopServices, QIcon
from qgis.PyQt.QtWidgets import QMenu, QToolButton

from ..algorithms.base import ICON
from ..algorithms.dependencies import dependency_problem
from ..algorithms.words import help_url, tr

if TYPE_CHECKING:
    from qgis.gui import QgisInterface
    from qgis.PyQt.QtWidgets import QDialog

    from .packages_dialog import PackagesDialog
    from .panel import Panel


class Menu:
    """The tools, the panel, the example, the packages and the help, in the window of ``iface``."""

    def __init__(self, iface: QgisInterface) -> None:
        self.iface, self.dialogs = iface, {}
        self.panel: Panel | None = None
        icon = QIcon(ICON)
        self.menu = QMenu("Isthmus", iface.mainWindow())
        self.menu.setIcon(icon)
        self.menu.setToolTipsVisible(True)
        provider = QgsApplication.processingRegistry().providerById("isthmus")
        for tool in provider.algorithms():
            name = tool.id()
            action = self._add(
                f"{tool.displayName()}…", lambda _=False, name=name: self.open_tool(name), tool.icon()
            )
            action.setToolTip(tool.shortDescription())
        self.menu.addSeparator()
        self._add(tr("Try values of tau…"), self.open_panel)
        self._add(tr("Try it on an example"), self.try_example)
        self.menu.addSeparator()
        self._add(tr("Install packages…"), lambda _=False: self.install_packages())
        self._add(tr("Help"), lambda _=False: QDesktopServices.openUrl(QUrl(help_url())))
        iface.pluginMenu().addMenu(self.menu)

        button = QToolButton()
        button.setIcon(icon)
        button.setToolTip("Isthmus")
        button.setMenu(self.menu)
        button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.button = iface.addToolBarWidget(button)

    def _add(self, text, slot, icon=None):
        action = self.menu.addAction(text)
        if icon is not None:
            action.setIcon(icon)
        action.triggered.connect(slot)
        return action

    def open_tool(self, name: str, parameters: dict[str, Any] | None = None) -> QDialog | None:
        """Open the dialog of a tool as the toolbox does."""
        if dependency_problem():
            return self.install_packages(lambda: self.open_tool(name, parameters))
        import processing

        dialog = processing.createAlgorithmDialog(name, parameters or {})
        if dialog is not None:
            dialog.show()
        return dialog

    def open_panel(self, _checked: bool = False) -> Panel | PackagesDialog:
        """Show the panel to try tau."""
        if dependency_problem():
            return self.install_packages(self.open_panel)
        if self.panel is None:
            from .panel import Panel

            self.panel = Panel(self.iface)
        self.panel.show()
        self.panel.raise_()
        return self.panel

    def try_example(self, _checked: bool = False) -> dict[str, Any] | PackagesDialog:
        """Cut the countries that come with the plugin, with the defaults."""
        if dependency_problem():
            return self.install_packages(self.try_example)
        from .example import try_example

        return try_example(self.iface)

    def install_packages(self, then: Callable[[], Any] | None = None) -> PackagesDialog:
        """Open the dialog that fetches missing packages; ``then`` goes on where one was missing."""
        from .packages_dialog import PackagesDialog

        self.dialogs["packages"] = dialog = PackagesDialog(self.iface.mainWindow(), then=then)
        dialog.show()
        return dialog

    def unload(self) -> None:
        """Take everything out of the window again."""
        for dialog in self.dialogs.values():
            dialog.close()
        if self.panel is not None:
            self.panel.unload()
            self.panel = None
        self.iface.removeToolBarIcon(self.button)
        self.iface.pluginMenu().removeAction(self.menu.menuAction())
        self.menu.deleteLater()
