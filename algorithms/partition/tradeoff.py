"""The tool ``isthmus:tradeoff``."""

from __future__ import annotations

from typing import Any

from qgis.core import (
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
)

from ..layers.fields import INTEGER, LONG, REAL
from ..words import tr
from .cutting import PartitionTool

FIELDS = (
    ("source", LONG),
    ("tau", REAL),
    ("cuts", INTEGER),
    ("length", REAL),
    ("cost", REAL),
    ("largest_part_share", REAL),
)

HELP = """
<p>Shows, for each feature, what every value of tau costs: how many cuts, or how much length or
weight, <i>Partition polygons at bottlenecks</i> would need for it. Take a value from the report as its
tau, or a number of cuts as the budget of <i>Partition polygons within a budget</i>.</p>
<h3>How to read it</h3>
<p>Go through the curve from large tau to small. A step where the detour falls a lot for one more
cut has found a real neck; then follows a long stretch where nothing changes. Where steps come
thick and fast, the cuts no longer fall on necks but nibble at every bay. Good values of tau lie
at the end of a long stretch.</p>
<p>The report marks the five steps that pay off most: the largest fall of the detour (on a logarithmic
scale) for what they cost more.</p>
{lists}
<h3>Guarantee</h3>
<p>The table has one row for each step: from its tau up to that of the step before, its solution is
the cheapest. The steps are exact for polygons without holes and <i>MinSize</i>. <i>MinLength</i> and
<i>MinWeight</i> have very many steps and take longer. Lengths are in the units of the layer; if its
coordinates are degrees, they are metres.</p>
"""


class TradeoffAlgorithm(PartitionTool):
    """The step function cost(tau) of each feature."""

    help_text = HELP
    TAU_MIN = "TAU_MIN"
    TAU_MAX = "TAU_MAX"
    STEPS = "STEPS"
    OUTPUT = "OUTPUT"
    REPORT = "REPORT"
    STEP_COUNT = "STEP_COUNT"
    SKIPPED_COUNT = "SKIPPED_COUNT"

    def name(self) -> str:
        return "tradeoff"

    def displayName(self) -> str:
        return "Detour trade-off curve"

    def tags(self) -> list[str]:
        return (
            "tau,choose,guide,trade-off,curve,pareto,step,plot,report,cost,dilation,detour,partition"
        ).split(",")

    def shortDescription(self) -> str:
        return "Shows what each value of tau costs, and marks the values that pay off."

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:
        number = QgsProcessingParameterNumber
        self.add_input()
        self.add_objective()
        self.add(
            number(self.TAU_MIN, "Smallest tau", number.Type.Double, 4.0, minValue=1.0),
            "Where the curve ends, at least 1.",
            decimals=2,
        )
        self.add(
            number(self.TAU_MAX, "Largest tau (0: no bound)", number.Type.Double, 0.0, minValue=0.0),
            "Where the curve starts; 0 starts with no cut at all, but those that connect holes.",
            decimals=2,
        )
        self.add(
            number(self.STEPS, "Most steps of a feature", number.Type.Integer, 50, minValue=1),
            "The curve ends after so many steps, though the smallest tau may not be reached.",
        )
        self.add_candidates()
        self.add(
            QgsProcessingParameterFeatureSink(
                self.OUTPUT, "Trade-off steps", QgsProcessing.SourceType.TypeVector
            ),
            "A table with a row for each step: source (id of the feature), tau (the least dilation "
            "achievable at this cost), cuts, length, cost, largest_part_share (the area of the "
            "largest part in that of the feature).",
        )
        self.add(
            QgsProcessingParameterFileDestination(
                self.REPORT, "Trade-off report", "HTML files (*.html)", optional=True
            ),
            "A page with a plot for each feature and the steps that pay off most.",
        )
        self.addOutput(QgsProcessingOutputNumber(self.STEP_COUNT, "Number of steps"))
        self.addOutput(QgsProcessingOutputNumber(self.SKIPPED_COUNT, "Number of features not solved"))

    def parameter_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        low = self.parameterAsDouble(parameters, self.TAU_MIN, context)
        high = self.parameterAsDouble(parameters, self.TAU_MAX, context)
        problem = self.number_problem(parameters, context, self.TAU_MIN, 1.0)
        if problem:
            return problem
        if not (high == 0.0 or high >= low):
            return tr("TAU_MAX must be 0 or at least TAU_MIN ({:g}), and is {:g}.").format(low, high)
        return self.objective_problem(parameters, context)

    def processAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        from .tradeoff_run import run  # what runs needs shapely, what declares must not

        return run(self, parameters, context, feedback)
