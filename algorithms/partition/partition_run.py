"""What ``isthmus:partition`` runs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...core.partition.features import for_tau
from ..words import tr
from .cutting_run import cut

if TYPE_CHECKING:
    from qgis.core import QgsProcessingContext, QgsProcessingFeedback

    from .partition import PartitionAlgorithm


def partition(
    tool: PartitionAlgorithm,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    feedback: QgsProcessingFeedback,
) -> dict[str, Any]:
    """Run `isthmus:partition`; return its results."""
    return cut(tool, parameters, context, feedback, _chooser)


def _chooser(tool, parameters, context, source, feedback):
    tau_of = tool.dynamic(parameters, tool.TAU, context, source)
    max_gap = tool.parameterAsDouble(parameters, tool.MAX_GAP, context) / 100.0

    def choose(problem, check):
        features = problem.chunk.features
        tau = np.array([tau_of(feature) for feature in features])
        selection, open_gaps = for_tau(problem, tau, max_gap=max_gap, check=check)
        for f, gap in open_gaps.items():
            feedback.pushWarning(
                tr(
                    "Feature {}: the search ended at a gap of {:.3g} per cent between the cost and its "
                    "proven lower bound, its limit of time or memory being reached."
                ).format(features[f].id(), 100.0 * gap)
            )
        return selection, tau

    return choose
