"""Isthmus: natural partitions of polygons, as QGIS Processing tools."""


def classFactory(iface):
    """Return the plugin; QGIS calls this. Nothing heavy is imported before a tool runs."""
    from .plugin import IsthmusPlugin

    return IsthmusPlugin(iface)
