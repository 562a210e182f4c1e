"""*Try it on an example*: countries that come with the plugin, and their parts and cuts on the map."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from qgis.core import QgsCoordinateTransform, QgsProcessing, QgsProject, QgsVectorLayer

from ..algorithms.base import RESOURCES, counted
from ..algorithms.words import tr

if TYPE_CHECKING:
    from qgis.gui import QgisInterface


EXAMPLE = RESOURCES / "example.geojson"  # of Natural Earth 1:10m, public domain


def try_example(iface: QgisInterface) -> dict[str, Any]:
    """Load the example, cut it with the defaults of ``isthmus:partition``, and show the result.

    Returns
    -------
    dict
        The results of the tool.
    """
    import processing

    project = QgsProject.instance()
    layer = QgsVectorLayer(str(EXAMPLE), tr("Isthmus example"), "ogr")
    project.addMapLayer(layer)
    results = processing.runAndLoadResults("isthmus:partition", {
        "INPUT": layer, "OUTPUT": QgsProcessing.TEMPORARY_OUTPUT, "CUTS": QgsProcessing.TEMPORARY_OUTPUT,
    })  # fmt: skip
    canvas = iface.mapCanvas()
    to_map = QgsCoordinateTransform(layer.crs(), canvas.mapSettings().destinationCrs(), project)
    canvas.setExtent(to_map.transformBoundingBox(layer.extent()))
    canvas.refresh()
    iface.messageBar().pushSuccess(
        "Isthmus",
        tr("{}, {}. Now try it on a layer of yours: Plugins > Isthmus.").format(
            counted(results["PART_COUNT"], "part"), counted(results["CUT_COUNT"], "cut")
        ),
    )
    return results
