"""The tool ``isthmus:partition``."""

from __future__ import annotations

from typing import Any

from qgis.core import (
    QgsMapLayer,
    QgsProcessingAlgorithm,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsVectorLayer,
    QgsWkbTypes,
)

from .cutting import CuttingTool

HELP = """
<p>Cuts polygons at their isthmuses, straits and necks into natural parts: a peninsula from its
continent, a bay from its sea.</p>
<p>You set one number, the <i>largest detour</i> (tau). Two points on opposite sides of a neck are
close to each other, but the way along the outline is long: many times longer than the straight
line. The tool finds the smallest number of cuts that leaves no place with a detour above tau.
Cuts join existing vertices: no vertex is moved, none is added unless you ask for it, and the parts fit
together exactly.</p>
<h3>Choosing tau</h3>
<p>3 is a good start; smaller values cut more. <i>Detour trade-off curve</i> shows what each value
costs, and <i>Hierarchy of natural parts</i> answers all of them at once.</p>
<p>Cuts lie at <i>natural</i> places only: where the outline is concave and the polygon opens up beside
the cut, as people see parts, and where no side is smaller than <i>Smallest part</i>. Lengths of the
outline are then measured without the detail that is much smaller. Choose <i>Any</i> and 0 for the problem
of the paper, where every diagonal counts; detours then grow with the detail of the outline, and tau
should be 4 or more.</p>
{lists}
<h3>Units</h3>
<p>Lengths and areas are in the units of the layer; if its coordinates are degrees, they are
metres and square metres on the ellipsoid. The results stay in the CRS of the layer.</p>
<h3>Guarantee</h3>
<p>Measured are the diagonals of a Delaunay triangulation of the polygon (in the Mercator projection,
if its coordinates are degrees) where a cut may lie, and the cuts are chosen from them.
In the result the way along the outline and the cuts is at most tau times as long as each diagonal.
For a polygon without holes no solution has fewer cuts. <i>MinLength</i> and <i>MinWeight</i> come with a
proven lower bound of the cost; the search ends where the gap to it is as small as you ask for, or after
nine minutes for each polygon on average. Holes are first joined by shortest cuts; what follows is a good
solution, not always the best, and the lower bound is that of the polygon opened along these cuts.</p>
<p>Multipart features are split part by part. What cannot be split (invalid geometry, for one)
passes through unchanged, with the reason in the field <i>status</i>.</p>
<h3>Method</h3>
<p>J.-H. Haunert and W. Meulemans, Partitioning Polygons via Graph Augmentation,
GIScience 2016.</p>
"""


class PartitionAlgorithm(CuttingTool):
    """Partition polygons so that every candidate is within tau."""

    help_text = HELP
    TAU = "TAU"

    def name(self) -> str:
        return "partition"

    def displayName(self) -> str:
        return "Partition polygons at bottlenecks"

    def tags(self) -> list[str]:
        return (
            "partition,split,cut,divide,bottleneck,isthmus,strait,neck,narrow,peninsula,bay,lake,"
            "dilation,detour,natural,part,subregion,generalize,tau"
        ).split(",")

    def shortDescription(self) -> str:
        return "Cuts polygons at isthmuses, straits and necks into natural parts."

    def flags(self) -> QgsProcessingAlgorithm.Flags:
        return super().flags() | QgsProcessingAlgorithm.Flag.FlagSupportsInPlaceEdits

    def supportInPlaceEdit(self, layer: QgsMapLayer | None) -> bool:
        return isinstance(layer, QgsVectorLayer) and (
            layer.geometryType() == QgsWkbTypes.GeometryType.PolygonGeometry
        )

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:
        self.in_place = bool((configuration or {}).get("IN_PLACE"))
        self.add_input()
        self.add_dynamic(
            self.TAU,
            "Largest detour (tau)",
            3.0,
            1.0,
            "How many times longer than the straight line across a neck the way along the outline may "
            "be; at least 1. Smaller values cut more. A field or expression can set it for each "
            "feature.",
        )
        self.add_objective()
        self.add_candidates()
        self.add_max_gap()
        self.add_outputs()

    def parameter_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        return self.dynamic_problem(parameters, self.TAU, context, 1.0) or self.objective_problem(
            parameters, context
        )

    def processAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        from .partition_run import partition  # what runs needs shapely, what declares must not

        return partition(self, parameters, context, feedback)
