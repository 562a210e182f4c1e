"""What the tools that cut polygons share: parameters, settings, and the writing of results."""

import math
import sys

import numpy as np
from qgis.core import (
    NULL,
    QgsExpressionContext,
    QgsFeatureRequest,
    QgsProcessing,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterExpression,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterNumber,
    QgsProcessingParameters,
    QgsProcessingUtils,
    QgsPropertyDefinition,
    QgsUnitTypes,
    QgsWkbTypes,
)

from ...core.errors import Cancelled
from ...core.progress import checker, stretch
from ..base import LARGEST, IsthmusAlgorithm, counted
from ..dependencies import slow_engine_note
from ..layers import wkb
from ..layers.sinks import Sinks, make_fields
from ..layers.source import WITHOUT_VALIDITY_CHECK, Reader
from ..layers.styles import style_on_load
from ..layers.wkb import INTEGER, LONG, REAL, TEXT
from .candidate_lines import CandidateLines
from .solving import (
    Settings,
    expression_problem,
    measure_of,
    prepare,
    read,
    reasons_of,
    weigh_by_expression,
)

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
DIAGONAL_FIELDS = (
    ("source", LONG), ("length", REAL), ("detour", REAL), ("dilation", REAL), ("role", TEXT)
)


def places_parameter(name, default):
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

    def add_input(self):
        self.add(
            QgsProcessingParameterFeatureSource(
                self.INPUT, "Polygons", [QgsProcessing.SourceType.TypeVectorPolygon]
            ),
            "The polygons to cut.",
        )

    def add_dynamic(
        self, name, label, default, least, help_text, most=LARGEST, decimals=2, optional=False
    ):
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

    def add_objective(self):
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

    def add_places(self, places=NATURAL, smallest=SMALLEST):
        """Add the parameters that say where a cut may lie."""
        self.add(
            places_parameter(self.PLACES, places),
            "Natural: only where people see parts meet, at places where the outline is concave and the "
            "polygon opens up beside the cut. Any: between any two vertices that a triangulation joins, "
            "as in the paper.",
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

    def add_candidates(self):
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

    def add_new_vertices(self, more):
        self.add(
            QgsProcessingParameterBoolean(
                self.NEW_VERTICES, "Cuts may end at new vertices on edges", False, True
            ),
            "Blocks, floor plans and generalised outlines often have no vertex opposite a neck. With this, "
            "a cut may also end at the foot of a perpendicular from a concave vertex on the edge opposite. "
            + more,
            advanced=True,
        )

    def add_max_gap(self):
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

    def objective_problem(self, parameters, context):
        """Return a sentence about a shared parameter that cannot be used, or ''."""
        for name in (self.SMALLEST_PART, self.MIN_LENGTH, self.MIN_HOLE, self.MAX_GAP):
            if self.parameterDefinition(name) is None or QgsProcessingParameters.isDynamic(
                parameters, name
            ):
                continue
            problem = self.limit_problem(parameters, context, name)
            if problem:
                return problem
        if self.parameterAsEnumString(parameters, self.OBJECTIVE, context) == BY_WEIGHT:
            sources = [
                self.parameterAsSource(parameters, name, context)
                for name in (self.INPUT, self.CANDIDATES)
            ]
            text = self.parameterAsString(parameters, self.WEIGHT, context)
            return expression_problem(text, [source.fields() for source in sources if source])
        return ""

    def dynamic_problem(self, parameters, name, context, least):
        """Return a sentence about a number that is not data-defined, or ''."""
        if QgsProcessingParameters.isDynamic(parameters, name):
            return ""
        return self.number_problem(parameters, context, name, least) or self.limit_problem(
            parameters, context, name
        )

    def settings(self, parameters, context, source, feedback, all_dilations=False):
        """Return how to solve."""
        from ...core.partition.features import weigh_by_length

        crs = source.sourceCrs()
        lines_source = self.parameterAsSource(parameters, self.CANDIDATES, context)
        lines = lines_source and CandidateLines(lines_source, crs, context)
        if not lines and slow_engine_note():
            feedback.pushInfo(slow_engine_note())
        objective = self.parameterAsEnumString(parameters, self.OBJECTIVE, context)
        weigh = weigh_by_length if objective == BY_LENGTH else None
        if objective == BY_WEIGHT:
            weigh = weigh_by_expression(
                self.parameterAsString(parameters, self.WEIGHT, context),
                source,
                lines,
                QgsExpressionContext(self.createExpressionContext(parameters, context, source)),
            )
        return Settings(
            measure=measure_of(crs),
            natural=self.parameterAsEnumString(parameters, self.PLACES, context) == NATURAL,
            floors=self.floors(parameters, context, source),
            lines=lines,
            new_vertices=self.parameterAsBoolean(parameters, self.NEW_VERTICES, context),
            weigh=weigh,
            all_dilations=all_dilations,
        )

    def floors(self, parameters, context, source):
        """Return the functions that say what is too small to count in a feature, by name."""
        return {
            name: self.dynamic(parameters, name, context, source)
            for name in (self.SMALLEST_PART, self.MIN_LENGTH, self.MIN_HOLE)
        }

    def dynamic(self, parameters, name, context, source):
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

    extra_fields = ()
    in_place = False  # whether the parts take the place of the features of an editable layer

    def chooser(self, parameters, context, source, feedback):
        """Return the function that chooses the cuts: ``(problem, check)`` to a Selection and each tau."""
        raise NotImplementedError

    def add_outputs(self):
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
            "The cuts, with the id of their polygon (source), length, detour (how many times longer "
            "the way along the outline was; empty if only a cut connects the ends), the parts "
            "on both sides (part_a, part_b; equal where a cut only connects a hole), and share (the "
            "smaller side as per cent of the feature's area; empty where that was not measured).",
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

    def processAlgorithm(self, parameters, context, feedback):
        from ...core.partition.features import without_vertex

        source = self.source(parameters, context)
        reader = Reader(source, feedback)
        with Sinks(self, parameters, context, feedback) as sinks:
            writer = _Writer(self, source, reader.wkb_type, sinks)
            settings = self.settings(
                parameters, context, source, feedback, all_dilations=writer.with_diagonals
            )
            choose = self.chooser(parameters, context, source, feedback)
            check = checker(reader.progress, feedback.isCanceled)
            try:
                for features in reader.chunks():
                    for chunk in read(features, settings, feedback):
                        problem = prepare(chunk, settings, stretch(check, 0.0, 0.5))
                        selection, tau = choose(problem, stretch(check, 0.5, 0.7))
                        writer.told.short += without_vertex(problem, selection, tau)
                        solution = finish(problem, selection, settings, stretch(check, 0.7, 0.8))
                        writer.write(problem, solution, feedback, stretch(check, 0.8, 1.0))
            except Cancelled:
                pass
            if self.in_place and feedback.isCanceled():
                writer.pass_on(source)
            if settings.lines:
                settings.lines.report(feedback)
        writer.report(feedback)
        destinations = sinks.destinations  # layers that are loaded get their styles
        style_on_load(context, destinations.get(self.CUTS), "cuts.qml", 0)
        style_on_load(context, destinations.get(self.DIAGONALS), None, 1)
        style_on_load(context, destinations.get(self.OUTPUT), "parts.qml", 3)
        return {**destinations, **writer.numbers, self.SKIPPED_COUNT: writer.told.skipped}

    def extra_values(self, problem, solution):
        """Return the values of `extra_fields` for each feature of a chunk, a list each."""
        return [[] for _ in problem.chunk.features]


def finish(problem, selection, settings, check):
    """Make the parts of the solution of a chunk."""
    from ...core.partition.solve import finish

    return finish(
        problem.prepared, selection, all_dilations=settings.all_dilations, check=check
    )


class Told:
    """What the log says of a run, chunk by chunk: what came out small, did not count, or was not cut.

    Attributes
    ----------
    small : int
        Parts smaller than 1 per cent of their feature.
    holes, rules : int, list of int
        Holes that were set aside, and the sums of `Prepared.set_aside`.
    short, skipped : int
        Places without a vertex to cut at; features of which something was not cut.
    """

    def __init__(self):
        self.small, self.holes, self.rules, self.short, self.skipped = 0, 0, [0] * 5, 0, 0

    def count(self, prepared):
        """Count what was set aside in a chunk."""
        self.rules = [a + b for a, b in zip(self.rules, prepared.set_aside.sum(axis=0).tolist())]
        self.holes += int((~prepared.wanted[prepared.component]).sum())

    def reason(self, feature, verdicts, feedback):
        """Return why a feature was not cut, or not all of it, and warn of it; '' where it was."""
        text = "; ".join(reasons_of(feature, verdicts))
        if text:
            self.skipped += 1
            feedback.pushWarning(f"Feature {feature.id()} was not cut: {text}.")
        return text

    def report(self, feedback, more=""):
        """Say it; ``more`` before what was not cut."""
        feedback.pushInfo(self._set_aside())
        report_short(feedback, self.short)
        if more:
            feedback.pushInfo(more)
        if self.skipped:
            feedback.pushInfo(
                f"Not cut: {counted(self.skipped, 'feature')}; see the field status of the parts."
            )

    def _set_aside(self):
        """What did not count, by which rule, and what to change if that is not wanted."""
        text = (
            f"{counted(self.small, 'part')} {'is' if self.small == 1 else 'are'} smaller than 1 per cent "
            "of the feature."
        )
        _, below, *by_place = self.rules
        if not (self.holes or below or any(by_place)):
            return text + " If these are too many, set PLACES to Natural or raise SMALLEST_PART."
        return text + (
            f" Set aside: {counted(self.holes, 'hole')} and {counted(below, 'diagonal')} with less on "
            f"one side than SMALLEST_PART (or MIN_HOLE); {sum(by_place):,} where the outline "
            "is not concave or the polygon does not open up (PLACES). If you miss cuts, lower TAU or "
            "SMALLEST_PART, or set PLACES to Any; if there are too many, raise TAU."
        )


class _Writer:
    """Writes what was solved, and counts it."""

    def __init__(self, tool, source, wkb_type, sinks):
        self.tool, self.sinks, self.told = tool, sinks, Told()
        fields, crs = source.fields(), source.sourceCrs()
        self.multi = QgsWkbTypes.isMultiType(wkb_type)
        self.unit = "m" if crs.isGeographic() else QgsUnitTypes.toAbbreviatedString(crs.mapUnits())
        line_type = wkb.line_type(wkb_type)
        part_fields = QgsProcessingUtils.combineFields(
            fields, make_fields(PART_FIELDS + tool.extra_fields)
        )
        sinks.open(tool.OUTPUT, part_fields, wkb_type, crs)
        self.with_cuts = not tool.in_place and sinks.open(
            tool.CUTS, make_fields(CUT_FIELDS), line_type, crs, False
        )
        self.with_diagonals = not tool.in_place and sinks.open(
            tool.DIAGONALS, make_fields(DIAGONAL_FIELDS), line_type, crs, False
        )
        self.numbers = {
            tool.PART_COUNT: 0,
            tool.CUT_COUNT: 0,
            tool.CUT_LENGTH: 0.0,
            tool.MAX_DILATION: 1.0,
            tool.COST: 0.0,
            tool.LOWER_BOUND: 0.0,
        }
        self.done = 0  # features that are written as a whole

    def write(self, problem, solution, feedback, check):
        """Write the solution of a chunk, and tell what of it could not be solved."""
        from ...core.partition.features import costs, pieces

        chunk, tool = problem.chunk, self.tool
        found = pieces(problem, solution.parts)
        cost, bound, gap = costs(problem, solution)
        solved = problem.solved
        some = np.bincount(problem.owner[solved], minlength=len(chunk.features)) > 0
        self.numbers[tool.COST] += float(cost.sum())
        self.numbers[tool.LOWER_BOUND] += float(bound.sum())
        self.numbers[tool.MAX_DILATION] = float(
            np.max(solution.largest_dilation[solved], initial=self.numbers[tool.MAX_DILATION])
        )
        per_feature = np.diff(found.feature_offsets)
        of = np.repeat(np.arange(len(chunk.features)), per_feature)
        total = np.bincount(of, weights=found.area, minlength=len(chunk.features))
        share = found.area < 0.01 * total[of]
        self.told.small += int((share & (per_feature[of] > 1)).sum())
        self.told.count(problem.prepared)
        own = solved[solution.owner]  # edges of polygons that are solved
        selected = own & (solution.role == 0)
        self.numbers[tool.CUT_COUNT] += int(selected.sum())
        self.numbers[tool.CUT_LENGTH] += float(solution.length[selected].sum())
        lines = [
            rows for rows, wanted in (
                (self._cuts(problem, solution, found), self.with_cuts),
                (self._diagonals(problem, solution, own), self.with_diagonals),
            ) if wanted
        ]

        geometries = wkb.polygon_geometries(
            chunk.rings.coords, found.rows, found.offsets, found.ring_offsets,
            [chunk.extra[f] for f in chunk.owner[found.polygon].tolist()], self.multi,
        )
        verdicts = problem.verdict[found.polygon].tolist()
        bounds = found.feature_offsets.tolist()
        values = zip(cost.tolist(), gap.tolist(), tool.extra_values(problem, solution))
        nothing = [NULL] * len(tool.extra_fields)
        for f, (feature, (own_cost, own_gap, more)) in enumerate(zip(chunk.features, values)):
            check(f / len(chunk.features) if f % 8 == 0 else None)
            lo, hi = bounds[f], bounds[f + 1]
            text = self.told.reason(feature, verdicts[lo:hi], feedback)
            attributes, origin = feature.attributes(), f"feature {feature.id()}"
            if not some[f]:  # nothing solved: the feature as it is
                for _ in range(lo, hi):
                    next(geometries)
                part = [1, 1, text, NULL, NULL, feature.id(), *nothing]
                self.sinks.add(tool.OUTPUT, feature.geometry(), attributes + part, origin)
                self.numbers[tool.PART_COUNT] += 1
                self.done += 1
                continue
            for k in range(lo, hi):
                part = [k - lo + 1, hi - lo, verdicts[k], own_cost, own_gap, feature.id(), *more]
                self.sinks.add(tool.OUTPUT, next(geometries), attributes + part, origin)
            self.numbers[tool.PART_COUNT] += hi - lo
            for name, of, rows in lines:
                while of and of[-1] == f:
                    of.pop()
                    geometry, line = next(rows)
                    self.sinks.add(name, geometry, [feature.id(), *line], origin)
            self.done += 1

    def pass_on(self, source):
        """Write the features that a cancelled run has not come to as they are: QGIS deletes all of them."""
        rest = [1, 1, "cancelled", NULL, NULL]
        for k, feature in enumerate(source.getFeatures(QgsFeatureRequest(), WITHOUT_VALIDITY_CHECK)):
            if k >= self.done:
                more = [*rest, feature.id(), *[NULL] * len(self.tool.extra_fields)]
                self.sinks.add(self.tool.OUTPUT, feature.geometry(), feature.attributes() + more)

    def _cuts(self, problem, solution, found):
        """Name of the layer; the feature of each cut, the last one first; geometries and values."""
        from ...core.partition.features import cuts

        chosen, fields = cuts(problem, solution, found)
        values = (
            [length, _or_null(detour), *parts, _or_null(share)]
            for length, detour, *parts, share in zip(*(x.tolist() for x in fields.values()))
        )
        return self._lines(self.tool.CUTS, problem, solution, chosen, values)

    def _diagonals(self, problem, solution, own):
        """The same of all candidates."""
        if not self.with_diagonals:
            return None
        chosen = np.flatnonzero(own)
        values = (
            [length, _or_null(detour), dilation, ROLES[role]]
            for length, detour, dilation, role in zip(
                *(x[chosen].tolist() for x in (
                    solution.length, solution.detour, solution.dilation, solution.role
                ))
            )
        )
        return self._lines(self.tool.DIAGONALS, problem, solution, chosen, values)

    @staticmethod
    def _lines(name, problem, solution, chosen, values):
        feature = problem.owner[solution.owner[chosen]].tolist()
        geometries = wkb.line_geometries(
            problem.chunk.rings.coords, solution.edge_rows[chosen],
            [problem.chunk.extra[f] for f in feature],
        )
        return name, feature[::-1], zip(geometries, values)

    def report(self, feedback):
        """Say in the log what was done."""
        if feedback.isCanceled():
            feedback.pushWarning("Cancelled: the results are not complete.")
            return
        tool, numbers = self.tool, self.numbers
        length = numbers[tool.CUT_LENGTH]
        text = f"{length:,.0f}" if length >= 100.0 else f"{length:.4g}"
        feedback.pushInfo(
            f"{counted(numbers[tool.PART_COUNT], 'part')}, made by "
            f"{counted(numbers[tool.CUT_COUNT], 'cut')} of "
            f"{f'{text} {self.unit}'.strip()} in all. The largest detour left is "
            f"{numbers[tool.MAX_DILATION]:.4g}."
        )
        self.told.report(feedback)


def report_short(feedback, short):
    """Say at how many places a cut is missing for want of a vertex."""
    if short:
        feedback.pushInfo(
            f"No vertex to end a cut at: {counted(short, 'place')}, edges opposite a concave corner, where "
            "the way around is more than tau times as long as the way across. Set NEW_VERTICES to cut there."
        )


def _or_null(value):
    return value if math.isfinite(value) else NULL
