"""Isthmus: natural partitions of polygons, as QGIS Processing tools."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from qgis.gui import QgisInterface

    from .plugin import IsthmusPlugin


def classFactory(iface: QgisInterface | None) -> IsthmusPlugin:
    """Return the plugin; QGIS calls this. Nothing heavy is imported before a tool runs."""
    from .plugin import IsthmusPlugin

    return IsthmusPlugin(iface)
