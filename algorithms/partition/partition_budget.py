"""The tool ``isthmus:partitionbudget``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..layers.fields import REAL
from .cutting import CuttingTool

if TYPE_CHECKING:
    from qgis.core import QgsProcessingContext, QgsProcessingFeedback


HELP = """
<p>Cuts polygons at their bottlenecks as far as a budget allows: at most so many cuts, or so much
length or weight of cuts, for each feature. Instead of guessing tau, say "ten cuts".</p>
<p>The tool finds the smallest detour that is achievable within the budget, and writes it to the
field <i>tau</i> of the parts. It is an achieved value: with any smaller one the budget would be
exceeded. What a detour is, the tool <i>Partition polygons at bottlenecks</i> explains.</p>
{lists}
<h3>Units</h3>
<p>Lengths and areas are in the units of the layer; if its coordinates are degrees, they are
metres and square metres on the ellipsoid.</p>
<h3>Guarantee</h3>
<p>For polygons without holes the answer is exact for <i>MinSize</i>. For <i>MinLength</i> and
<i>MinWeight</i> it is so where each trial could be proven; where not, the tool says so. With holes it
is the best that the tool finds. Holes must be connected by cuts, which count. A feature whose holes
alone need more than the budget passes through unchanged; its status tells the least budget
possible.</p>
<h3>Method</h3>
<p>The dual problem of J.-H. Haunert and W. Meulemans, Partitioning Polygons via Graph Augmentation,
GIScience 2016, section 2.</p>
"""


class PartitionBudgetAlgorithm(CuttingTool):
    """Partition polygons with the smallest dilation that a budget allows."""

    help_text = HELP
    BUDGET = "BUDGET"
    extra_fields = (("tau", REAL),)

    def name(self) -> str:
        return "partitionbudget"

    def displayName(self) -> str:
        return "Partition polygons within a budget"

    def tags(self) -> list[str]:
        return (
            "partition,split,cut,divide,bottleneck,isthmus,strait,neck,budget,number,count,limit,"
            "dual,dilation,detour,natural,part,subregion"
        ).split(",")

    def shortDescription(self) -> str:
        return "Cuts polygons at bottlenecks with at most so many cuts, or so much length of cuts."

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:
        self.add_input()
        self.add_dynamic(
            self.BUDGET,
            "Budget of a feature (cuts, length or weight)",
            10.0,
            0.0,
            "The largest number of cuts (MinSize), total length (MinLength) or total weight "
            "(MinWeight) for each feature; length in the units of the layer, or in metres if its "
            "coordinates are degrees. A field or expression can set it for each feature.",
        )
        self.add_objective()
        self.add_candidates()
        self.add_outputs()

    def parameter_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        return self.dynamic_problem(parameters, self.BUDGET, context, 0.0) or self.objective_problem(
            parameters, context
        )

    def processAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        from .partition_budget_run import partition_budget  # needs shapely, what declares must not

        return partition_budget(self, parameters, context, feedback)
