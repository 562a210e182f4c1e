"""What ``isthmus:tradeoff`` runs."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import Any

import numpy as np
from qgis.core import (
    NULL,
    QgsCoordinateReferenceSystem,
    QgsExpression,
    QgsExpressionContext,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsWkbTypes,
)

from ...core.errors import Cancelled, Sentence
from ...core.partition import features
from ...core.partition.solve import select
from ...core.partition.tradeoff import paying_steps
from ...core.progress import stretch
from ..layers.fields import make_fields
from ..layers.sinks import Sinks
from ..layers.source import Reader, shapeless
from ..words import spoken, tr
from . import report
from .cutting import BY_SIZE
from .cutting_run import report_short
from .solving import problems, settings_of
from .tradeoff import FIELDS, TradeoffAlgorithm

UNITS = {
    "MinSize": Sentence("number of cuts"),
    "MinLength": Sentence("length of the cuts"),
    "MinWeight": Sentence("weight"),
}


def run(
    tool: TradeoffAlgorithm,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    feedback: QgsProcessingFeedback,
) -> dict[str, Any]:
    """Run `isthmus:tradeoff`; return its results."""
    source = tool.source(parameters, context)
    low = tool.parameterAsDouble(parameters, tool.TAU_MIN, context)
    high = tool.parameterAsDouble(parameters, tool.TAU_MAX, context) or math.inf
    most = tool.parameterAsInt(parameters, tool.STEPS, context)
    objective = tool.parameterAsEnumString(parameters, tool.OBJECTIVE, context)
    settings = settings_of(tool, parameters, context, source, feedback)
    path = tool.parameterAsFileOutput(parameters, tool.REPORT, context)
    with Sinks(tool, parameters, context, feedback) as sinks:
        sinks.open(
            tool.OUTPUT, make_fields(FIELDS), QgsWkbTypes.Type.NoGeometry,
            QgsCoordinateReferenceSystem(),
        )  # fmt: skip
        curves, numbers = _curves(
            tool, source, settings, low, high, most, spoken(UNITS[objective]), sinks, feedback
        )
        if settings.lines:
            settings.lines.report(feedback)
        if path and not feedback.isCanceled():
            sinks.write_text(path, _report(source.sourceName(), objective, curves))
    results = {**sinks.destinations, **numbers}
    if path and not feedback.isCanceled():
        results[tool.REPORT] = path
    return results


def _curves(tool, source, settings, low, high, most, unit, sinks, feedback):
    """Write the steps of each feature; return the curves for the report, and the numbers."""
    name_of = _names(tool, sinks.parameters, sinks.context)
    curves, count, skipped, short = [], 0, 0, 0
    reader = Reader(source, feedback)
    with suppress(Cancelled):
        for problem, check in problems(reader, settings, feedback, 0.3):
            chunk, write = problem.chunk, stretch(check, 6 / 7, 1.0)
            found = features.curves(problem, low, high, most, stretch(check, 0.0, 6 / 7))
            # where the curves end, by the fewest cuts
            end = np.array(
                [max([low, *(step.dilation for step in curve.solutions[-1:])]) for curve, _ in found]
            )
            fewest = select(problem.prepared, end[problem.owner], with_dilation=False)
            short += features.without_vertex(problem, fewest, end)
            for f, feature in enumerate(chunk.features):
                write(f / len(chunk.features) if f % 8 == 0 else None)
                reasons = list(dict.fromkeys(problem.verdict[chunk.owner == f]))
                if not any(reason == "" for reason in reasons):
                    skipped += 1
                    reason = reasons[0] if reasons else shapeless(feature)
                    feedback.pushWarning(
                        tr("Feature {} has no curve: {}.").format(feature.id(), spoken(reason))
                    )
                    continue
                reasons.remove("")
                if reasons:
                    skipped += 1
                    feedback.pushWarning(
                        tr("Feature {}: parts of it were left out: {}.").format(
                            feature.id(), "; ".join(map(spoken, reasons))
                        )
                    )
                curve, rows = found[f]
                for *row, share in rows:
                    own = [feature.id(), *row, NULL if math.isnan(share) else share]
                    sinks.add(tool.OUTPUT, None, own, Sentence("feature {}", feature.id()))
                count += len(rows)
                tau, cuts, _, cost, share = map(list, zip(*rows))
                curves.append(
                    {
                        "name": name_of(feature),
                        "unit": unit,
                        "tau": tau,
                        "cost": cost,
                        "cuts": cuts,
                        "share": share,
                        "marked": paying_steps(tau, cost),
                        "complete": curve.complete,
                    }
                )
    report_short(feedback, short)
    return curves, {tool.STEP_COUNT: count, tool.SKIPPED_COUNT: skipped}


def _names(tool, parameters, context):
    """Return the function that names a feature: by the display name of its layer, and its id."""
    layer = tool.parameterAsVectorLayer(parameters, tool.INPUT, context)
    expression = QgsExpression(layer.displayExpression() if layer is not None else "")
    scopes = QgsExpressionContext()

    def name_of(feature):
        scopes.setFeature(feature)
        name = expression.evaluate(scopes)
        if isinstance(name, str) and name.strip():  # a number would be another id
            return tr("{} (feature {})").format(name.strip(), feature.id())
        return tr("Feature {}").format(feature.id())

    return name_of


def _report(name, objective, curves):
    """The page with the curves."""
    intro = [
        tr(
            "Each curve shows, for every value of tau, the least cost ({}) that keeps all detours "
            "within it ({})."
        ).format(spoken(UNITS[objective]), objective),
        tr(
            "A long flat stretch means that nothing more is to be gained for a while: good values "
            "of tau lie at its left end. Red dots mark the steps that pay off most, the largest "
            "fall of the detour (on a logarithmic scale) for what they cost more."
        ),
    ]
    if objective != BY_SIZE:
        intro.append(tr("Lengths are in the units of the layer, or metres for degrees."))
    return report.page(tr("Detour trade-off of {}").format(name), intro, curves)
