"""What the two aggregation tools declare in common: the areas and their classes."""

from qgis.core import (
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
)

from ..words import tr

__all__ = ["AreasTool", "field_index"]


class AreasTool:
    """A tool of the group *Area aggregation*; stands before `IsthmusAlgorithm` among the bases."""

    CLASS = "CLASS"

    def group(self):
        return tr("Area aggregation")

    def groupId(self):
        return "aggregation"

    def add_areas(self, areas_help, class_help):
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


def field_index(tool, parameters, context, source, name, needed=True):
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
