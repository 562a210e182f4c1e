"""What the tools that cut polygons declare in common; what they run is in `cutting_run` and `solving`."""

from __future__ import annotations

import math
import sys
from typing import Any, Callable

from qgis.core import (
    QgsExpression,
    QgsFeature,
    QgsFeatureRequest,
    QgsFields,
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingFeatureSource,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterExpression,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterNumber,
    QgsProcessingParameters,
    QgsProcessingUtils,
    QgsPropertyDefinition,
)

from ..base import LARGEST, IsthmusAlgorithm
from ..layers.fields import INTEGER, LONG, REAL, TEXT
from ..words import tr

BY_SIZE, BY_LENGTH, BY_WEIGHT = OBJECTIVES = ("MinSize", "MinLength", "MinWeight")
NATURAL, ANY = PLACES = ("Natural", "Any")
ROLES = ("SELF", "LEAF", "ROOT")
SMALLEST = 1.0  # default of the smallest part, per cent: see docs/choosing_tau.md
PART_FIELDS = (
    ("part", INTEGER), ("parts", INTEGER), ("status", TEXT), ("cost", REAL), ("gap", REAL),
    ("source", LONG),
)  # fmt: skip
CUT_FIELDS = (
    ("source", LONG), ("length", REAL), ("detour", REAL), ("part_a", INTEGER), ("part_b", INTEGER),
    ("share", REAL),
)  # fmt: skip
DIAGONAL_FIELDS = (("source", LONG), ("length", REAL), ("detour", REAL), ("dilation", REAL), ("role", TEXT))


def places_parameter(name: str, default: str) -> QgsProcessingParameterEnum:
    """Return the parameter that says where a cut may lie."""
    return QgsProcessingParameterEnum(
        name,
        "Where a cut may lie",
        list(PLACES),
        defaultValue=default,
        usesStaticStrings=True,
        optional=True,  # models of before do not give it
    )


class PartitionTool(IsthmusAlgorithm):
    """Base of the tools that solve the partition problem for each feature."""

    OBJECTIVE = "OBJECTIVE"
    WEIGHT = "WEIGHT"
    PLACES = "PLACES"
    SMALLEST_PART = "SMALLEST_PART"
    MIN_LENGTH = "MIN_LENGTH"
    MIN_HOLE = "MIN_HOLE"
    CANDIDATES = "CANDIDATES"
    NEW_VERTICES = "NEW_VERTICES"
    MAX_GAP = "MAX_GAP"

    def add_input(self) -> None:
        self.add(
            QgsProcessingParameterFeatureSource(
                self.INPUT, "Polygons", [QgsProcessing.SourceType.TypeVectorPolygon]
            ),
            "The polygons to cut.",
        )

    def add_dynamic(
        self,
        name: str,
        label: str,
        default: float,
        least: float,
        help_text: str,
        *,
        most: float = LARGEST,
        decimals: int = 2,
        optional: bool = False,
    ) -> None:
        """Add a number that a field or an expression can set for each feature."""
        parameter = QgsProcessingParameterNumber(
            name, label, QgsProcessingParameterNumber.Type.Double, default, optional,
            minValue=least, maxValue=most,
        )  # fmt: skip
        parameter.setIsDynamic(True)
        kind = QgsPropertyDefinition.DataType.DataTypeNumeric
        expected = f"number [≥ {least:g}]"
        parameter.setDynamicPropertyDefinition(QgsPropertyDefinition(name, kind, label, expected))
        parameter.setDynamicLayerParameterName(self.INPUT)
        self.add(parameter, help_text, decimals=decimals)

    def add_objective(self) -> None:
        self.add(
            QgsProcessingParameterEnum(
                self.OBJECTIVE,
                "What to minimize: number, length or weight of cuts",
                list(OBJECTIVES),
                defaultValue=BY_SIZE,
                usesStaticStrings=True,
            ),
            "MinSize: the number of cuts. MinLength: their total length, which gives the most "
            "natural parts. MinWeight: the sum of the weights that you give them.",
        )
        self.add(
            QgsProcessingParameterExpression(
                self.WEIGHT,
                "Weight of a cut (for MinWeight)",
                parentLayerParameterName=self.INPUT,
                optional=True,
            ),
            "An expression for the weight of a possible cut, such as @length / @detour. It sees the "
            "line's geometry, @length, @detour, the fields of the polygon and, where you give lines "
            "to choose from, the fields of the line. Zero makes a cut free.",
            advanced=True,
        )

    def add_places(self, *, places: str = NATURAL, smallest: float = SMALLEST) -> None:
        """Add the parameters that say where a cut may lie."""
        self.add(
            places_parameter(self.PLACES, places),
            "Natural: only where people see parts meet, at places where the outline is concave and the "
            "polygon opens up beside the cut, or over a row of small holes that fills half of the way. Any: "
            "between any two vertices that a triangulation joins, as in the paper.",
        )
        self.add_dynamic(
            self.SMALLEST_PART,
            "Smallest part (per cent of the feature)",
            smallest,
            0.0,
            "Smaller parts are not cut off, smaller holes attract no cuts, and the length of the outline "
            "is measured without the detail that is much smaller. 0: everything counts. A field or "
            "expression can set it for each feature.",
            most=100.0,
            decimals=3,
            optional=True,  # models of before do not give it
        )
        self.add_dynamic(
            # no QgsProcessingParameterDistance: it would name degrees as the unit of layers in degrees
            self.MIN_LENGTH,
            "Ignore cuts below (layer units; metres if degrees)",
            0.0,
            0.0,
            "Possible cuts that are shorter than this are left out, whatever the detour: those of "
            "creeks and inlets you do not care for. A hole may still be connected by a shorter cut. "
            "In the units of the layer, or in metres if its coordinates are degrees. A field or "
            "expression can set it for each feature.",
            most=sys.float_info.max,
            decimals=3,
        )
        self.add_dynamic(
            self.MIN_HOLE,
            "Ignore holes below (layer units²; m² if degrees)",
            0.0,
            0.0,
            "Holes with a smaller area stay holes of a part, and no cut is attached to them. In the "
            "squared units of the layer, or in square metres if its coordinates are degrees. A field or "
            "expression can set it for each feature.",
            decimals=3,
        )

    def add_candidates(self) -> None:
        self.add_places()
        self.add(
            QgsProcessingParameterFeatureSource(
                self.CANDIDATES,
                "Lines to choose the cuts from",
                [QgsProcessing.SourceType.TypeVectorLine],
                optional=True,
            ),
            "Your own lines, instead of the diagonals of a triangulation: straight lines between two "
            "vertices of a polygon that stay inside it, wherever they lie. A line that is none is "
            "reported with its id; where two cross, the shorter one is used.",
            advanced=True,
        )
        self.add_new_vertices(
            "Only those where a cut ends are added, with Z and M interpolated; the rest of the outline stays "
            "as it is. Neighbours in the layer do not get them. No effect where you give lines to choose "
            "from."
        )

    def add_new_vertices(self, more: str) -> None:
        self.add(
            QgsProcessingParameterBoolean(
                self.NEW_VERTICES, "Cuts may end at new vertices on edges", False, True
            ),
            "Blocks, floor plans and generalised outlines often have no vertex opposite a neck. With this, "
            "a cut may also end at the foot of a perpendicular from a concave vertex on the edge opposite. "
            + more,
            advanced=True,
        )

    def add_max_gap(self) -> None:
        self.add(
            QgsProcessingParameterNumber(
                self.MAX_GAP,
                "Largest gap to the proven lower bound (per cent)",
                QgsProcessingParameterNumber.Type.Double,
                defaultValue=0.1,
                minValue=0.0,
                maxValue=100.0,
            ),
            "For MinLength and MinWeight, which are hard to solve exactly: how much more than the "
            "proven lower bound a solution may cost. 0 asks for a proof of optimality. MinSize is "
            "always optimal.",
            advanced=True,
            decimals=3,
        )

    def objective_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        """Return a sentence about a shared parameter that cannot be used, or ''."""
        for name in (self.SMALLEST_PART, self.MIN_LENGTH, self.MIN_HOLE, self.MAX_GAP):
            if self.parameterDefinition(name) is None:
                continue
            if QgsProcessingParameters.isDynamic(parameters, name):
                problem = self.property_problem(parameters, name, context)
            else:
                problem = self.limit_problem(parameters, context, name)
            if problem:
                return problem
        if self.parameterAsEnumString(parameters, self.OBJECTIVE, context) == BY_WEIGHT:
            sources = [
                self.parameterAsSource(parameters, name, context) for name in (self.INPUT, self.CANDIDATES)
            ]
            text = self.parameterAsString(parameters, self.WEIGHT, context)
            if not text.strip():
                return tr("MinWeight needs an expression for the weight of a candidate (WEIGHT).")
            return expression_problem(self.WEIGHT, text, [source.fields() for source in sources if source])
        return ""

    def property_problem(self, parameters: dict[str, Any], name: str, context: QgsProcessingContext) -> str:
        """Return a sentence about the field or expression of a data-defined number, or ''."""
        source = self.parameterAsSource(parameters, self.INPUT, context)
        return expression_problem(name, parameters[name].asExpression(), [source.fields()] if source else [])

    def dynamic_problem(
        self, parameters: dict[str, Any], name: str, context: QgsProcessingContext, least: float
    ) -> str:
        """Return a sentence about a number that cannot be used, or that no feature can have, or ''."""
        if QgsProcessingParameters.isDynamic(parameters, name):
            return self.property_problem(parameters, name, context)
        return self.number_problem(parameters, context, name, least) or self.limit_problem(
            parameters, context, name
        )

    def floors(
        self, parameters: dict[str, Any], context: QgsProcessingContext, source: QgsProcessingFeatureSource
    ) -> dict[str, Callable[[QgsFeature], float]]:
        """Return the functions that say what is too small to count in a feature, by name."""
        return {
            name: self.dynamic(parameters, name, context, source)
            for name in (self.SMALLEST_PART, self.MIN_LENGTH, self.MIN_HOLE)
        }

    def dynamic(
        self,
        parameters: dict[str, Any],
        name: str,
        context: QgsProcessingContext,
        source: QgsProcessingFeatureSource,
    ) -> Callable[[QgsFeature], float]:
        """Return the function that gives a data-defined number for a feature, NaN where none."""
        if not QgsProcessingParameters.isDynamic(parameters, name):
            value = self.parameterAsDouble(parameters, name, context)
            return lambda feature: value
        expressions = self.createExpressionContext(parameters, context, source)
        own = parameters[name]  # a QgsProperty: no parameterAs... evaluates it per feature

        def of(feature):
            expressions.setFeature(feature)
            value, valid = own.valueAsDouble(expressions, math.nan)
            return value if valid else math.nan

        return of


class CuttingTool(PartitionTool):
    """Base of the tools that cut polygons into parts."""

    OUTPUT = "OUTPUT"
    CUTS = "CUTS"
    DIAGONALS = "DIAGONALS"
    PART_COUNT = "PART_COUNT"
    CUT_COUNT = "CUT_COUNT"
    CUT_LENGTH = "CUT_LENGTH"
    MAX_DILATION = "MAX_DILATION"
    SKIPPED_COUNT = "SKIPPED_COUNT"
    COST = "COST"
    LOWER_BOUND = "LOWER_BOUND"

    extra_fields: tuple[tuple[str, str], ...] = ()  # of the parts, behind those of all
    in_place = False  # whether the parts take the place of the features of an editable layer

    def add_outputs(self) -> None:
        more = "".join(f", {name}" for name, _ in self.extra_fields)
        self.add(
            QgsProcessingParameterFeatureSink(
                self.OUTPUT, "Parts", QgsProcessing.SourceType.TypeVectorPolygon
            ),
            "All fields of the polygons, and part (1 for the largest of a feature), parts (their "
            "number), status (empty, or why a polygon was not cut), cost and gap of the "
            f"solution of the feature (gap in per cent), and source (the id of the feature){more}.",
        )
        if not self.in_place:  # there QGIS takes OUTPUT, and loads nothing else
            self._add_lines()
        self.add_numbers(
            (
                (self.PART_COUNT, "Number of parts"),
                (self.CUT_COUNT, "Number of cuts"),
                (self.CUT_LENGTH, "Total length of the cuts"),
                (self.MAX_DILATION, "Largest dilation of a candidate"),
                (self.SKIPPED_COUNT, "Number of features not solved"),
                (self.COST, "Cost of all solutions"),
                (self.LOWER_BOUND, "Proven lower bound of the cost"),
            )
        )

    def _add_lines(self):
        self.add(
            QgsProcessingParameterFeatureSink(
                self.CUTS, "Cuts", QgsProcessing.SourceType.TypeVectorLine, optional=True
            ),
            "The cuts, with the id of their polygon (source), length (without that over holes), detour "
            "(how many times longer the way along the outline was; empty if only a cut connects the "
            "ends), the parts on both sides (part_a, part_b; equal where a cut only connects a hole), and "
            "share (the smaller side as per cent of the feature's area; empty where that was not "
            "measured).",
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                self.DIAGONALS,
                "All candidate diagonals",
                QgsProcessing.SourceType.TypeVectorLine,
                optional=True,
                createByDefault=False,
            ),
            "Every candidate, with its detour before any cut, its dilation in the solution, and "
            "its role: SELF is a cut; LEAF and ROOT tell on which side the way around lies.",
        )


def expression_problem(name: str, text: str, all_fields: list[QgsFields]) -> str:
    """Return why an expression for the fields of polygons, and of lines, is of no use, or ''."""
    expression = QgsExpression(text)
    if expression.hasParserError():
        return tr("The expression for {} is not valid: {}").format(name, expression.parserErrorString())
    if not all_fields:
        return ""
    # as the candidates have them
    known = all_fields[0] if len(all_fields) == 1 else QgsProcessingUtils.combineFields(*all_fields)
    columns = expression.referencedColumns() - {QgsFeatureRequest.ALL_ATTRIBUTES}
    unknown = [column for column in columns if known.lookupField(column) < 0]
    if unknown:
        return tr("The expression for {} uses an unknown field: {}.").format(name, min(unknown))
    return ""
