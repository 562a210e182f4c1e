"""What the two aggregation tools declare in common: the areas and their classes."""

from __future__ import annotations

from typing import Any

from qgis.core import (
    QgsProcessing,
    QgsProcessingAlgorithm,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeatureSource,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
)

from ..base import IsthmusAlgorithm
from ..words import tr

__all__ = ["AreasTool", "field_index"]


class AreasTool(IsthmusAlgorithm):
    """A tool of the group *Area aggregation*; stands first among the bases."""

    CLASS = "CLASS"

    def group(self) -> str:
        return "Area aggregation"

    def groupId(self) -> str:
        return "aggregation"

    def add_areas(self, areas_help: str, class_help: str) -> None:
        """Add the layer of areas and the field of their classes."""
        self.add(
            QgsProcessingParameterFeatureSource(
                self.INPUT, "Areas", [QgsProcessing.SourceType.TypeVectorPolygon]
            ),
            areas_help,
        )
        self.add(
            QgsProcessingParameterField(self.CLASS, "Class field", parentLayerParameterName=self.INPUT),
            class_help,
        )


def field_index(
    tool: QgsProcessingAlgorithm,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    source: QgsProcessingFeatureSource,
    name: str,
    needed: bool = True,
) -> int:
    """Return the index of a field that a parameter names; -1 where it names none.

    Raises
    ------
    QgsProcessingException
        If there is no such field, or none is named and it is needed; it lists those that there are.
    """
    wanted = tool.parameterAsString(parameters, name, context)
    index = source.fields().lookupField(wanted) if wanted else -1
    if index < 0 and (needed or wanted):
        names = ", ".join(field.name() for field in source.fields())
        raise QgsProcessingException(
            tr("The areas have no field {!r} ({}). Their fields are: {}.").format(wanted, name, names)
        )
    return index
