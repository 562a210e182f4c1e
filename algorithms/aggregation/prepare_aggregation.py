"""The tool ``isthmus:prepareaggregation``."""

from __future__ import annotations

from typing import Any

from qgis.core import (
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
)

from ..layers.fields import INTEGER, LONG, REAL, TEXT
from ..partition.cutting import ANY, BY_LENGTH, BY_SIZE, PartitionTool
from .areas_tool import AreasTool

PIECE_FIELDS = (("area_id", LONG), ("piece", LONG), ("size", REAL), ("status", TEXT))
PAIR_FIELDS = (("a", LONG), ("b", LONG), ("length", REAL), ("virtual", INTEGER))

HELP = """
<p>Splits the areas of a land-cover map at their bottlenecks, so that <i>Aggregate areas</i> can give
the parts of one area to different regions. Less then has to change its class, and the regions become
more compact.</p>
<p>Run <i>Aggregate areas</i> with the pieces next: pieces of one area that end in one region are
merged again.</p>
{lists}
<h3>What the map should be like</h3>
<p>The areas should fill the map without overlaps and gaps; what is found of these is counted and
reported. Vertices of neighbours need not match: a vertex of one may lie inside an edge of the
other. No vertex is moved, and none is added unless you ask for it: then neighbours get it too. So what
neighbours share they still share. An area that
cannot be cut (invalid, for one) passes through in one piece, with the reason in <i>status</i>.</p>
<h3>Method</h3>
<p>J.-H. Haunert and W. Meulemans, Partitioning Polygons via Graph Augmentation,
GIScience 2016, section 5.2.</p>
"""


class PrepareAggregationAlgorithm(AreasTool, PartitionTool):
    """Split the areas of a coverage at bottlenecks."""

    help_text = HELP
    TAU = "TAU"
    OUTPUT = "OUTPUT"
    ADJACENCY = "ADJACENCY"
    AREA_COUNT = "AREA_COUNT"
    PIECE_COUNT = "PIECE_COUNT"
    SKIPPED_COUNT = "SKIPPED_COUNT"
    OVERLAP_COUNT = "OVERLAP_COUNT"
    GAP_COUNT = "GAP_COUNT"

    def name(self) -> str:
        return "prepareaggregation"

    def displayName(self) -> str:
        return "Prepare areas for aggregation"

    def tags(self) -> list[str]:
        return (
            "aggregation,generalize,generalization,land cover,land use,split,bottleneck,coverage,"
            "neighbours,adjacency,shared boundary,topology"
        ).split(",")

    def shortDescription(self) -> str:
        return "Splits land-cover areas at bottlenecks before they are aggregated."

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:
        add = self.add
        number = QgsProcessingParameterNumber.Type
        self.add_areas(
            "The areas of a map, which fill it without overlaps and gaps.",
            "The field with the class of each area. Areas without one are reported.",
        )
        add(
            QgsProcessingParameterNumber(
                self.TAU, "Largest detour (tau)", number.Double, defaultValue=4.0, minValue=1.0
            ),
            "How many times longer than the straight line across a neck the way along the outline may "
            "be; at least 1. Smaller values cut more.",
            decimals=2,
        )
        add(
            QgsProcessingParameterEnum(
                self.OBJECTIVE,
                "What to minimize: number or length of cuts",
                [BY_SIZE, BY_LENGTH],
                defaultValue=BY_SIZE,
                usesStaticStrings=True,
            ),
            "MinSize: as few cuts as possible. MinLength: as little length of cuts as possible.",
        )
        self.add_places(places=ANY, smallest=0.0)
        self.add_new_vertices(
            "Only those where a cut ends are added, with Z and M interpolated. Neighbours get the same "
            "vertices, so that shared boundaries stay shared."
        )
        add(
            QgsProcessingParameterFeatureSink(
                self.OUTPUT, "Pieces", QgsProcessing.SourceType.TypeVectorPolygon
            ),
            "All fields of the areas, and area_id (the id of the area), piece (a number for each "
            "piece), size (in square metres) and status (empty, or why an area was not cut).",
        )
        add(
            QgsProcessingParameterFeatureSink(
                self.ADJACENCY,
                "Neighbours",
                QgsProcessing.SourceType.TypeVector,
                optional=True,
                createByDefault=False,
            ),
            "A table of neighbouring pieces a and b, the length of their shared boundary in metres, "
            "and virtual: 1 for a cut between two pieces of one area.",
        )
        self.add_numbers(
            (
                (self.AREA_COUNT, "Number of areas"),
                (self.PIECE_COUNT, "Number of pieces"),
                (self.SKIPPED_COUNT, "Number of areas not cut for a reason"),
                (self.OVERLAP_COUNT, "Number of overlapping pairs of areas"),
                (self.GAP_COUNT, "Number of gaps"),
            )
        )

    def parameter_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        return self.number_problem(parameters, context, self.TAU, 1.0) or self.objective_problem(
            parameters, context
        )

    def processAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        from .prepare_aggregation_run import prepare_aggregation  # needs shapely, what declares must not

        return prepare_aggregation(self, parameters, context, feedback)
