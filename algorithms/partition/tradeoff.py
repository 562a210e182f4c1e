"""The tool ``isthmus:tradeoff``."""

import contextlib
import math
from pathlib import Path

import numpy as np
from qgis.core import (
    NULL,
    QgsCoordinateReferenceSystem,
    QgsExpression,
    QgsExpressionContext,
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingOutputNumber,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
    QgsWkbTypes,
)

from ...core.errors import Cancelled
from ...core.progress import checker, stretch
from ..layers.sinks import Sinks, make_fields
from ..layers.source import Reader
from ..layers.wkb import INTEGER, LONG, REAL
from . import report
from .cutting import BY_SIZE, PartitionTool, report_short
from .solving import prepare, read

FIELDS = (
    ("source", LONG),
    ("tau", REAL),
    ("cuts", INTEGER),
    ("length", REAL),
    ("cost", REAL),
    ("largest_part_share", REAL),
)
UNITS = {"MinSize": "number of cuts", "MinLength": "length of the cuts", "MinWeight": "weight"}

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

    def name(self):
        return "tradeoff"

    def displayName(self):
        return "Detour trade-off curve"

    def tags(self):
        return (
            "tau,choose,guide,trade-off,curve,pareto,step,plot,report,cost,dilation,detour,partition"
        ).split(",")

    def shortDescription(self):
        return "Shows what each value of tau costs, and marks the values that pay off."

    def initAlgorithm(self, configuration=None):
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
        self.addOutput(
            QgsProcessingOutputNumber(self.SKIPPED_COUNT, "Number of features not solved")
        )

    def parameter_problem(self, parameters, context):
        low = self.parameterAsDouble(parameters, self.TAU_MIN, context)
        high = self.parameterAsDouble(parameters, self.TAU_MAX, context)
        problem = self.number_problem(parameters, context, self.TAU_MIN, 1.0)
        if problem:
            return problem
        if not (high == 0.0 or high >= low):
            return f"TAU_MAX must be 0 or at least TAU_MIN ({low:g}), and is {high:g}."
        return self.objective_problem(parameters, context)

    def processAlgorithm(self, parameters, context, feedback):
        source = self.source(parameters, context)
        low = self.parameterAsDouble(parameters, self.TAU_MIN, context)
        high = self.parameterAsDouble(parameters, self.TAU_MAX, context) or math.inf
        most = self.parameterAsInt(parameters, self.STEPS, context)
        objective = self.parameterAsEnumString(parameters, self.OBJECTIVE, context)
        settings = self.settings(parameters, context, source, feedback)
        path = self.parameterAsFileOutput(parameters, self.REPORT, context)
        with Sinks(self, parameters, context, feedback) as sinks:
            sinks.open(
                self.OUTPUT, make_fields(FIELDS), QgsWkbTypes.Type.NoGeometry,
                QgsCoordinateReferenceSystem(),
            )  # fmt: skip
            curves, numbers = self._curves(
                source, settings, low, high, most, UNITS[objective], sinks, feedback
            )
            if settings.lines:
                settings.lines.report(feedback)
            if path and not feedback.isCanceled():
                self._write_report(path, source.sourceName(), objective, curves)
        results = {**sinks.destinations, **numbers}
        if path and not feedback.isCanceled():
            results[self.REPORT] = path
        return results

    def _curves(self, source, settings, low, high, most, unit, sinks, feedback):
        """Write the steps of each feature; return the curves for the report, and the numbers."""
        from ...core.partition.features import curves as follow
        from ...core.partition.features import without_vertex
        from ...core.partition.solve import select
        from ...core.partition.tradeoff import paying_steps

        name_of = self._names(sinks.parameters, sinks.context)
        curves, count, skipped, short = [], 0, 0, 0
        reader = Reader(source, feedback)
        check = checker(reader.progress, feedback.isCanceled)
        try:
            for features in reader.chunks():
                for chunk in read(features, settings, feedback):
                    problem = prepare(chunk, settings, stretch(check, 0.0, 0.3))
                    found = follow(problem, low, high, most, stretch(check, 0.3, 0.9))
                    # where the curves end, by the fewest cuts
                    end = np.array([
                        max([low, *(step.dilation for step in curve.solutions[-1:])]) for curve, _ in found
                    ])
                    fewest = select(problem.prepared, end[problem.owner], with_dilation=False)
                    short += without_vertex(problem, fewest, end)
                    for f, feature in enumerate(chunk.features):
                        check(0.9 + 0.1 * f / len(chunk.features) if f % 8 == 0 else None)
                        reasons = list(dict.fromkeys(problem.verdict[chunk.owner == f]))
                        if not any(reason == "" for reason in reasons):
                            skipped += 1
                            reason = reasons[0] if reasons else "it has no polygon"
                            feedback.pushWarning(f"Feature {feature.id()} has no curve: {reason}.")
                            continue
                        reasons.remove("")
                        if reasons:
                            skipped += 1
                            feedback.pushWarning(
                                f"Feature {feature.id()}: parts of it were left out: "
                                f"{'; '.join(reasons)}."
                            )
                        curve, rows = found[f]
                        for *row, share in rows:
                            own = [feature.id(), *row, NULL if math.isnan(share) else share]
                            sinks.add(self.OUTPUT, None, own, f"feature {feature.id()}")
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
        except Cancelled:
            pass
        report_short(feedback, short)
        return curves, {self.STEP_COUNT: count, self.SKIPPED_COUNT: skipped}

    def _names(self, parameters, context):
        """Return the function that names a feature: by the display name of its layer, and its id."""
        layer = self.parameterAsVectorLayer(parameters, self.INPUT, context)
        expression = QgsExpression(layer.displayExpression() if layer is not None else "")
        scopes = QgsExpressionContext()

        def name_of(feature):
            scopes.setFeature(feature)
            name = expression.evaluate(scopes)
            if isinstance(name, str) and name.strip():  # a number would be another id
                return f"{name.strip()} (feature {feature.id()})"
            return f"Feature {feature.id()}"

        return name_of

    def _write_report(self, path, name, objective, curves):
        intro = [
            f"Each curve shows, for every value of tau, the least {UNITS[objective]} that keeps all "
            f"detours within it ({objective}).",
            "A long flat stretch means that nothing more is to be gained for a while: good values "
            "of tau lie at its left end. Red dots mark the steps that pay off most, the largest "
            "fall of the detour (on a logarithmic scale) for what they cost more.",
        ]
        if objective != BY_SIZE:
            intro.append("Lengths are in the units of the layer, or metres for degrees.")
        try:
            Path(path).write_text(
                report.page(f"Detour trade-off of {name}", intro, curves), encoding="utf-8"
            )
        except OSError as error:
            with contextlib.suppress(OSError):
                Path(path).unlink()
            raise QgsProcessingException(f"The report could not be written: {error}") from error
