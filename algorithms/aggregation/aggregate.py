"""The tool ``isthmus:aggregate``."""

from __future__ import annotations

from typing import Any

import numpy as np
from qgis.core import (
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterNumber,
    QgsProcessingParameterString,
)

from ...core.aggregation.presets import BOUNDARIES, DISTANCES, METHODS, PRESETS
from ..base import LARGEST
from ..dependencies import install_hint
from ..layers.fields import INTEGER, LONG, REAL, TEXT
from ..words import as_sentence, spoken, tr
from .areas_tool import AreasTool

REGION_FIELDS = (("region", LONG), ("size", REAL), ("areas", LONG), ("core", LONG), ("status", TEXT))
ASSIGNED_FIELDS = (("region", LONG), ("changed", INTEGER), ("status", TEXT))

HELP = """
<p>Aggregates the areas of a land-cover map for a smaller scale: every area is given to a region, and
every region is contiguous, at least as large as its class demands, and has the class of at least
one of its areas. Among all ways to do so the tool looks for one of least cost.</p>
<p>Takes the pieces of <i>Prepare areas for aggregation</i>, too: pieces of one area that end in one
region are merged again.</p>
<h3>Methods</h3>
<p><i>greedy</i>: the smallest area joins the neighbour that costs least; quick.<br/>
<i>annealing</i>: starts there and improves it, for a number of steps or seconds, then is heated again
several times, of which the best is kept place by place. The same seed and number of steps give the
same result. Parts of the map that hang together and have at most 20 areas are then solved by the exact
method, where scipy is there, unless steps, seconds or a number of regions are given.<br/>
<i>exact</i>: a mixed-integer programme (HiGHS, through scipy) for small maps, with a lower bound that
certifies how good the result is. Thirty areas take seconds, mostly; with hundreds the result is that
of a short annealing, with a bound.</p>
<h3>Cost</h3>
<p>The sum of three parts, each with a weight:<br/>
<i>class change</i>: size in square metres times the distance of the two classes;<br/>
<i>boundary length</i>: metres between regions, or only between regions of different class;<br/>
<i>centre distance</i>: size times the root mean square distance, in metres, of the points of an area
from the centroid of its region's core, the area that gives the region its class. Haunert and Wolff
measure from centroid to centroid; then the cost would depend on how an area is cut in pieces.</p>
<p>Three sets of weights have names: <i>balanced</i>; <i>keep classes</i>, with a quarter of its weights for
boundary and centre; <i>compact</i>, with twice its weight for boundary and four times that for centre.
A weight that is given wins. They are good for 40 hectares (1:250,000); for another minimum size
multiply that of the boundary length by the square root of the ratio, and divide that of the centre
distance by it.</p>
<p><i>Beware:</i> with a free number of regions and boundaries between <i>all</i> regions, neighbours of
one class are merged for their boundary alone. Choose boundaries between <i>classes</i>, raise the
weight of the centre distance, or fix the number of regions, if you do not want that.</p>
{lists}
<h3>What cannot be helped</h3>
<p>Areas on an island that is too small for any of their classes, and areas without a class, stay as
they are, with the reason in <i>status</i>.</p>
<h3>Problem</h3>
<p>J.-H. Haunert and A. Wolff, Area aggregation in map generalisation by mixed-integer
programming, IJGIS 24(12), 2010.</p>
"""


class AggregateAlgorithm(AreasTool):
    """Aggregate the areas of a coverage into large regions."""

    help_text = HELP
    THRESHOLD = "THRESHOLD"
    THRESHOLDS = "THRESHOLDS"
    EXCLUDED = "EXCLUDED"
    DISTANCE = "DISTANCE"
    DISTANCES = "DISTANCES"
    WEIGHTS = "WEIGHTS"
    WEIGHT_CHANGE = "WEIGHT_CHANGE"
    WEIGHT_BOUNDARY = "WEIGHT_BOUNDARY"
    BOUNDARY = "BOUNDARY"
    WEIGHT_CENTRE = "WEIGHT_CENTRE"
    METHOD = "METHOD"
    SEED = "SEED"
    ITERATIONS = "ITERATIONS"
    SECONDS = "SECONDS"
    REGIONS = "REGIONS"
    AREA_ID = "AREA_ID"
    DECOMPOSE = "DECOMPOSE"
    OUTPUT = "OUTPUT"
    ASSIGNMENT = "ASSIGNMENT"
    REPORT = "REPORT"
    TOTAL_COST = "TOTAL_COST"
    CHANGE_COST = "CHANGE_COST"
    BOUNDARY_COST = "BOUNDARY_COST"
    CENTRE_COST = "CENTRE_COST"
    REGION_COUNT = "REGION_COUNT"
    CHANGED_SHARE = "CHANGED_SHARE"
    TOO_SMALL_COUNT = "TOO_SMALL_COUNT"
    SKIPPED_COUNT = "SKIPPED_COUNT"
    LOST_COUNT = "LOST_COUNT"
    LOWER_BOUND = "LOWER_BOUND"

    def name(self) -> str:
        return "aggregate"

    def displayName(self) -> str:
        return "Aggregate areas"

    def tags(self) -> list[str]:
        return (
            "aggregation,aggregate,generalize,generalization,land cover,land use,merge,dissolve,"
            "eliminate,minimum size,minimum mapping unit,region,class,annealing,optimize"
        ).split(",")

    def shortDescription(self) -> str:
        return "Joins small land-cover areas to regions of a minimum size at least cost."

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:
        add = self.add
        number = QgsProcessingParameterNumber.Type
        table = [QgsProcessing.SourceType.TypeVector]

        def choice(name, label, options, default):
            return QgsProcessingParameterEnum(
                name, label, list(options), defaultValue=default, usesStaticStrings=True
            )

        def amount(name, label, default, kind=number.Double, **options):
            return QgsProcessingParameterNumber(
                name, label, kind, defaultValue=default, minValue=0, **options
            )

        self.add_areas(
            "Areas that fill a map, or the pieces of Prepare areas for aggregation.",
            "The field with the class of each area.",
        )
        add(
            amount(self.THRESHOLD, "Minimum size (square metres)", 400000.0, maxValue=LARGEST),
            "How large every region must be at least. Classes in the table of minimum sizes have their own.",
            decimals=2,
        )
        add(
            QgsProcessingParameterFeatureSource(
                self.THRESHOLDS, "Minimum sizes by class", table, optional=True
            ),
            "A table with the fields class and threshold (square metres). A class whose threshold is "
            "empty may not appear in the result.",
            advanced=True,
        )
        add(
            QgsProcessingParameterString(self.EXCLUDED, "Excluded classes", optional=True),
            "Classes that may not appear in the result, separated by commas.",
        )
        add(
            choice(self.DISTANCE, "Distance of classes", DISTANCES, "equal"),
            "equal: every change counts 1. code: hierarchical codes such as CORINE's; the share of "
            "the digits from the first differing one on (311 to 312: 1/3). table: from a table.",
        )
        add(
            QgsProcessingParameterFeatureSource(
                self.DISTANCES, "Table of class distances", table, optional=True
            ),
            "A table with the fields from, to and distance. Where only one direction is listed, it is "
            "used for both.",
        )
        add(
            choice(self.WEIGHTS, "Weights", PRESETS, "balanced"),
            "keep classes: as little as possible changes its class. compact: short boundaries, and areas "
            "near their region's core. balanced: between both.",
        )
        add(
            amount(self.WEIGHT_CHANGE, "Weight of class change", None, optional=True),
            "For each square metre times class distance. Not set: 1, as all named weights have it.",
            advanced=True,
        )
        add(
            amount(self.WEIGHT_BOUNDARY, "Weight of boundary length", None, optional=True),
            "For each metre of boundary. Not set: 45 (balanced), 11.25 (keep classes), 90 (compact).",
            advanced=True,
        )
        add(
            choice(self.BOUNDARY, "Boundaries that count: of regions or of classes", BOUNDARIES, "regions"),
            "regions: between all regions. classes: only between regions of different class.",
            advanced=True,
        )
        add(
            amount(self.WEIGHT_CENTRE, "Weight of centre distance", None, optional=True),
            "For each square metre times metre. Not set: 0.00014 (balanced), 0.000035 (keep classes), "
            "0.00056 (compact).",
            advanced=True,
        )
        add(
            choice(self.METHOD, "Method", METHODS, "annealing"),
            "greedy: quick. annealing: better the longer it runs. exact: best, for small maps.",
        )
        add(
            amount(self.SEED, "Seed of annealing", 1, number.Integer),
            "Another seed gives another result.",
            advanced=True,
        )
        add(
            amount(self.ITERATIONS, "Steps of annealing (0: 10,000 an area)", 0, number.Integer),
            "How many moves are tried.",
            advanced=True,
        )
        add(
            amount(self.SECONDS, "Seconds to search (0: not limited)", 0.0),
            "annealing: run this long instead of a number of steps; then two runs may differ. exact: "
            "the time limit, 60 if 0.",
            decimals=1,
        )
        add(
            amount(self.REGIONS, "Number of regions (0: free)", 0, number.Integer),
            "Wanted number of regions, for greedy and annealing. Said if it cannot be reached.",
            advanced=True,
        )
        add(
            QgsProcessingParameterField(
                self.AREA_ID,
                "Field with the area of a piece",
                parentLayerParameterName=self.INPUT,
                optional=True,
            ),
            "The field that is equal for the pieces of one area. Default: area_id, if there are "
            "fields area_id and piece.",
            advanced=True,
        )
        add(
            QgsProcessingParameterBoolean(
                self.DECOMPOSE, "Exact: large areas stay cores of their own", defaultValue=True
            ),
            "An area that is large enough by itself is always the core of a region. The map then "
            "falls into parts that are solved one by one; the lower bound is that of solutions with "
            "this property.",
            advanced=True,
        )
        add(
            QgsProcessingParameterFeatureSink(
                self.OUTPUT, "Regions", QgsProcessing.SourceType.TypeVectorPolygon
            ),
            "The regions with region (number), the class field, size (square metres), areas (how "
            "many), core (id of the area whose class was kept) and status (why it is too small).",
        )
        add(
            QgsProcessingParameterFeatureSink(
                self.ASSIGNMENT,
                "Areas with their regions",
                QgsProcessing.SourceType.TypeVectorPolygon,
                optional=True,
                createByDefault=False,
            ),
            "The areas with all fields, region, new_class, changed (1 or 0) and status.",
        )
        add(
            QgsProcessingParameterFileDestination(
                self.REPORT, "Report", "HTML files (*.html)", optional=True, createByDefault=False
            ),
            "A page with the cost by part, the classes before and after, and the areas above half of "
            "the minimum size that lost their class.",
        )
        self.add_numbers(
            (
                (self.TOTAL_COST, "Total cost"),
                (self.CHANGE_COST, "Cost of class change"),
                (self.BOUNDARY_COST, "Cost of boundary length"),
                (self.CENTRE_COST, "Cost of centre distance"),
                (self.REGION_COUNT, "Number of regions"),
                (self.CHANGED_SHARE, "Share of the area whose class changed"),
                (self.TOO_SMALL_COUNT, "Number of regions that are too small"),
                (self.SKIPPED_COUNT, "Number of areas without geometry or class"),
                (self.LOST_COUNT, "Number of areas above half of the minimum size that lost their class"),
                (self.LOWER_BOUND, "Lower bound of the total cost (exact)"),
            )
        )

    def parameter_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        method = self.parameterAsString(parameters, self.METHOD, context)
        if method == "exact":
            problem = highs_problem()
            if problem:
                return problem
        if self.parameterAsString(parameters, self.DISTANCE, context) == "table" and not (
            parameters.get(self.DISTANCES)
        ):
            return tr("A table of class distances (DISTANCES) is needed, or another way to measure them.")
        weights = (self.WEIGHT_CHANGE, self.WEIGHT_BOUNDARY, self.WEIGHT_CENTRE)
        for name in (
            self.THRESHOLD,
            *(one for one in weights if parameters.get(one) is not None),
            self.SECONDS,
            self.SEED,
            self.ITERATIONS,
            self.REGIONS,
        ):
            problem = self.number_problem(parameters, context, name, 0.0)
            if problem:
                return problem
        return ""

    def processAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        from .aggregate_run import aggregate  # what runs needs shapely, what declares must not

        return aggregate(self, parameters, context, feedback)


def highs_problem() -> str:
    """Return what is missing for the exact method and how to install it, or ''."""
    from ...core.aggregation.exact import require_highs
    from ...core.errors import MissingEngine

    try:
        require_highs()
    except MissingEngine as problem:
        hint = install_hint(np.__version__, ['"scipy>=1.9"'])
        return f"{as_sentence(spoken(problem.sentence))} {hint}"
    return ""
