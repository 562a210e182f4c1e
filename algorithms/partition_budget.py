"""The tool ``isthmus:partitionbudget``."""

import math

from ..core.errors import Unsolvable
from .base import one_line
from .cutting import CuttingTool
from .features import REAL

# Seconds that each trial may take to prove MinLength and MinWeight for a polygon
TIME_LIMIT = 60.0

HELP = """
<p>Cuts polygons at their bottlenecks as far as a budget allows: at most so many cuts, or so much
length or weight of cuts, for each feature. Instead of guessing tau, say "ten cuts".</p>
<p>The tool finds the smallest detour that is achievable within the budget. The field <i>tau</i> of
the parts tells it: the largest dilation that remains for any candidate of the feature. It is exact,
an achieved value: with any smaller one the budget would be exceeded.</p>
<p><b>Budget.</b> With <i>MinSize</i> it counts cuts, with <i>MinLength</i> it is their total length
(in the units of the layer; in metres if its coordinates are degrees), with <i>MinWeight</i> the sum
of the weights. Multipart features share one budget.</p>
<p>Holes must be connected by cuts, which count. A feature whose holes alone need more than the
budget passes through unchanged; its status tells the least budget possible.</p>
<p><b>Guarantee.</b> For polygons without holes the answer is exact for MinSize. For MinLength and
MinWeight it is so where each trial could be proven; where not, the tool says so. With holes it is the
best that the tool finds.</p>
<p>Method: the dual problem of J.-H. Haunert and W. Meulemans, Partitioning Polygons via Graph
Augmentation, GIScience 2016, section 2.</p>
"""


class PartitionBudgetAlgorithm(CuttingTool):
    """Partition polygons with the smallest dilation that a budget allows."""

    BUDGET = "BUDGET"
    extra_fields = (("tau", REAL),)

    def name(self):
        return "partitionbudget"

    def displayName(self):
        return "Partition polygons within a budget"

    def tags(self):
        return (
            "partition,split,cut,divide,bottleneck,isthmus,strait,neck,budget,number,count,limit,"
            "dual,dilation,detour,natural,part,subregion"
        ).split(",")

    def shortDescription(self):
        return "Cuts polygons at bottlenecks with at most so many cuts, or so much length of cuts."

    def shortHelpString(self):
        return one_line(HELP)

    def initAlgorithm(self, configuration=None):
        self.add_input()
        self.add_dynamic(
            self.BUDGET,
            "Budget of a feature (cuts, length or weight)",
            10.0,
            0.0,
            "The largest number of cuts (MinSize), total length (MinLength) or total weight "
            "(MinWeight) for each feature. A field or expression sets it for each feature.",
        )
        self.add_objective()
        self.add_candidates()
        self.add_outputs()

    def parameter_problem(self, parameters, context):
        return self.dynamic_problem(
            parameters, self.BUDGET, context, 0.0
        ) or self.objective_problem(parameters, context)

    def chooser(self, parameters, context, source, feedback):
        from ..core.budget import OverBudget, joint_solver, smallest_dilation

        budget_of = self.dynamic(parameters, self.BUDGET, context, source)

        def choose(feature, tasks, check):
            budget = budget_of(feature)
            if not 0.0 <= budget < math.inf:
                raise Unsolvable(f"the budget must be a number of at least 0, and is {budget:g}")
            solve = joint_solver(
                [task.prepared for task in tasks],
                [task.weight for task in tasks],
                time_limit=TIME_LIMIT,
                check=check,
            )
            answer, proven = smallest_dilation(solve, budget)
            if isinstance(answer, OverBudget):
                raise Unsolvable(
                    f"the budget of {budget:g} cannot be met: the least possible cost is "
                    f"{answer.least:.12g}, for the cuts that connect holes"
                )
            if not proven:
                feedback.pushWarning(
                    f"Feature {feature.id()}: a smaller detour than {answer.dilation:.6g} may be "
                    "possible within the budget, which could be neither shown nor ruled out."
                )
            return answer.selections

        return choose

    def extra_values(self, solved):
        return [max(p.partition.largest_dilation for p in solved if p.partition is not None)]
