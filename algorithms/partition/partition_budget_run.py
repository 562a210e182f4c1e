"""What ``isthmus:partitionbudget`` runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...core.partition.features import largest_dilations, within_budget
from ..words import tr
from .cutting_run import cut

if TYPE_CHECKING:
    from qgis.core import QgsProcessingContext, QgsProcessingFeedback

    from .partition_budget import PartitionBudgetAlgorithm


def partition_budget(
    tool: PartitionBudgetAlgorithm,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    feedback: QgsProcessingFeedback,
) -> dict[str, Any]:
    """Run `isthmus:partitionbudget`; return its results."""
    return cut(tool, parameters, context, feedback, _chooser, _extra_values)


def _chooser(tool, parameters, context, source, feedback):
    budget_of = tool.dynamic(parameters, tool.BUDGET, context, source)

    def choose(problem, check):
        features = problem.chunk.features
        selection, unproven = within_budget(problem, [budget_of(feature) for feature in features], check)
        for f, dilation in unproven.items():
            feedback.pushWarning(
                tr(
                    "Feature {}: a smaller detour than {:.6g} may be possible within the budget, which could "
                    "be neither shown nor ruled out."
                ).format(features[f].id(), dilation)
            )
        reached = np.ones(len(features))
        np.maximum.at(reached, problem.owner, selection.dilation)
        return selection, reached

    return choose


def _extra_values(problem, solution):
    return [[value] for value in largest_dilations(problem, solution).tolist()]
