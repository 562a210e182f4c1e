"""The tool ``isthmus:partition``."""

import math

from qgis.core import (
    NULL,
    QgsFeature,
    QgsFeatureSink,
    QgsFields,
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingOutputNumber,
    QgsProcessingParameterDistance,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterNumber,
    QgsProcessingParameters,
    QgsProcessingUtils,
    QgsPropertyDefinition,
    QgsWkbTypes,
)

from . import features
from .base import IsthmusAlgorithm, Steps, style_on_load
from .candidate_lines import CandidateLines
from .features import INTEGER, LONG, REAL, TEXT
from .solving import measure_of, solve

PART_FIELDS = (("part", INTEGER), ("parts", INTEGER), ("status", TEXT))
CUT_FIELDS = (
    ("source", LONG), ("length", REAL), ("detour", REAL), ("part_a", INTEGER), ("part_b", INTEGER)
)
DIAGONAL_FIELDS = (
    ("source", LONG), ("length", REAL), ("detour", REAL), ("dilation", REAL), ("role", TEXT)
)
ROLES = ("SELF", "LEAF", "ROOT")

HELP = """
<p>Cuts polygons at their isthmuses, straits and necks into natural parts.</p>
<p>Two points on opposite sides of a neck are close to each other, but the way along the outline
is long. <i>Largest detour</i> (tau) says how many times longer than the straight line it may be:
the tool finds the smallest number of cuts so that, for every diagonal of a Delaunay triangulation
of the polygon, the way along the outline and the cuts is at most tau times as long as the
diagonal. Cuts join existing vertices: no vertex is moved or added, and the parts fit together
exactly.</p>
<p><b>Choosing tau.</b> 4 is a good start. Smaller values cut more. Necks that people have named
mostly have a detour between 5 and 30, and the more detailed an outline, the larger its detours.
If creeks and inlets are cut off that you do not care for, raise <i>Shortest diagonal that
counts</i>; if islands or lakes attract cuts, raise <i>Smallest hole that counts</i>.</p>
<p><b>Guarantee.</b> For a polygon without holes no solution has fewer cuts. With holes the tool
first joins them by shortest cuts; what follows is a good solution, not always the smallest. The
detour of every diagonal is kept within tau in either case.</p>
<p><b>Units.</b> Lengths and areas are in the units of the layer; if its coordinates are degrees,
they are metres, measured on the ellipsoid, and the triangulation is that of the Mercator
projection. The results stay in the CRS of the layer.</p>
<p>Multipart features are split part by part. What cannot be split (invalid geometry, for one)
passes through unchanged, with the reason in the field <i>status</i>.</p>
<p>Method: J.-H. Haunert and W. Meulemans, Partitioning Polygons via Graph Augmentation,
GIScience 2016.</p>
"""


class PartitionAlgorithm(IsthmusAlgorithm):
    """Partition polygons at bottlenecks (MinSize)."""

    INPUT = "INPUT"
    TAU = "TAU"
    MIN_LENGTH = "MIN_LENGTH"
    MIN_HOLE = "MIN_HOLE"
    CANDIDATES = "CANDIDATES"
    OUTPUT = "OUTPUT"
    CUTS = "CUTS"
    DIAGONALS = "DIAGONALS"
    PART_COUNT = "PART_COUNT"
    CUT_COUNT = "CUT_COUNT"
    CUT_LENGTH = "CUT_LENGTH"
    MAX_DILATION = "MAX_DILATION"
    SKIPPED_COUNT = "SKIPPED_COUNT"

    def name(self):
        return "partition"

    def displayName(self):
        return "Partition polygons at bottlenecks"

    def tags(self):
        return (
            "partition,split,cut,divide,bottleneck,isthmus,strait,neck,narrow,peninsula,bay,lake,"
            "dilation,detour,natural,part,subregion,generalize,tau"
        ).split(",")

    def shortDescription(self):
        return "Cuts polygons at isthmuses, straits and necks into natural parts."

    def shortHelpString(self):
        return HELP

    def initAlgorithm(self, configuration=None):
        def add(parameter, help_text):
            parameter.setHelp(help_text)
            self.addParameter(parameter)

        add(
            QgsProcessingParameterFeatureSource(
                self.INPUT, "Polygons", [QgsProcessing.SourceType.TypeVectorPolygon]
            ),
            "The polygons to cut.",
        )
        tau = QgsProcessingParameterNumber(
            self.TAU,
            "Largest detour (tau)",
            QgsProcessingParameterNumber.Type.Double,
            defaultValue=4.0,
            minValue=1.0,
        )
        tau.setIsDynamic(True)
        tau.setDynamicPropertyDefinition(
            QgsPropertyDefinition(
                self.TAU, "Largest detour (tau)", QgsPropertyDefinition.StandardPropertyTemplate.DoublePositive
            )
        )
        tau.setDynamicLayerParameterName(self.INPUT)
        add(
            tau,
            "How many times longer than a diagonal the way along outline and cuts may be; at least "
            "1. Smaller values cut more. A field or expression sets it for each feature.",
        )
        add(
            QgsProcessingParameterDistance(
                self.MIN_LENGTH,
                "Shortest diagonal that counts (layer units; metres for degrees)",
                defaultValue=0.0,
                minValue=0.0,
            ),
            "Diagonals shorter than this are neither cut nor bounded: creeks and inlets you do not "
            "care for. A hole may still be connected by a shorter cut. In the units of the layer, "
            "or in metres if its coordinates are degrees.",
        )
        add(
            QgsProcessingParameterNumber(
                self.MIN_HOLE,
                "Smallest hole that counts (area in square layer units; square metres for degrees)",
                QgsProcessingParameterNumber.Type.Double,
                defaultValue=0.0,
                minValue=0.0,
            ),
            "Holes with a smaller area stay holes of a part, and no cut is attached to them.",
        )
        add(
            QgsProcessingParameterFeatureSource(
                self.CANDIDATES,
                "Candidate lines",
                [QgsProcessing.SourceType.TypeVectorLine],
                optional=True,
            ),
            "Your own diagonals to choose the cuts from, instead of a triangulation's. Straight "
            "lines between two vertices of a polygon that stay inside it. A line that is none is "
            "reported with its id; where two cross, the shorter one is used.",
        )
        add(
            QgsProcessingParameterFeatureSink(
                self.OUTPUT, "Parts", QgsProcessing.SourceType.TypeVectorPolygon
            ),
            "All fields of the polygons, and part (1 for the largest of a feature), parts (their "
            "number) and status (empty, or why a polygon was not cut).",
        )
        add(
            QgsProcessingParameterFeatureSink(
                self.CUTS, "Cuts", QgsProcessing.SourceType.TypeVectorLine, optional=True
            ),
            "The cuts, with the id of their polygon (source), length, detour (how many times longer "
            "the way along the outline was; empty if only a cut connects the ends), and the parts "
            "on both sides (part_a, part_b; equal where a cut only connects a hole).",
        )
        add(
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
        for name, label in (
            (self.PART_COUNT, "Number of parts"),
            (self.CUT_COUNT, "Number of cuts"),
            (self.CUT_LENGTH, "Total length of the cuts"),
            (self.MAX_DILATION, "Largest dilation of a candidate"),
            (self.SKIPPED_COUNT, "Number of features not solved"),
        ):
            self.addOutput(QgsProcessingOutputNumber(name, label))

    def parameter_problem(self, parameters, context):
        if not QgsProcessingParameters.isDynamic(parameters, self.TAU):
            tau = self.parameterAsDouble(parameters, self.TAU, context)
            if not tau >= 1.0 or math.isinf(tau):
                return f"The largest detour (TAU) must be a number of at least 1, and is {tau:g}."
        for name in (self.MIN_LENGTH, self.MIN_HOLE):
            value = self.parameterAsDouble(parameters, name, context)
            if not value >= 0.0:
                return f"{name} must not be negative, and is {value:g}."
        return ""

    def processAlgorithm(self, parameters, context, feedback):
        source = self.parameterAsSource(parameters, self.INPUT, context)
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(parameters, self.INPUT))
        from ..core.errors import Cancelled, Unsolvable
        from ..core.partition import partition
        from ..core.triangulation import engine_name

        crs, steps = source.sourceCrs(), Steps(source, feedback)
        writer = _Writer(self, parameters, context, source.fields(), steps.wkb_type, crs)
        lines_source = self.parameterAsSource(parameters, self.CANDIDATES, context)
        lines = lines_source and CandidateLines(lines_source, crs, context)
        if engine_name() == "shapely" and not lines:
            feedback.pushInfo(
                "The package triangle is not installed. Shapely's triangulation is used instead: "
                "as good, but slower."
            )
        measure = measure_of(crs)
        fixed = {
            "min_length": self.parameterAsDouble(parameters, self.MIN_LENGTH, context),
            "min_hole": self.parameterAsDouble(parameters, self.MIN_HOLE, context),
            "all_dilations": writer.diagonals is not None,
        }
        tau_of = self._tau_of(parameters, context, source)
        for feature in steps:
            tau = tau_of(feature)

            def solver(coords, offsets, tau=tau, **arguments):
                if not tau >= 1.0 or math.isinf(tau):
                    raise Unsolvable(f"tau must be a number of at least 1, and is {tau:g}")
                return partition(coords, offsets, tau, **fixed, **arguments)

            try:
                solved = solve(feature, solver, measure, lines, feedback, steps.progress)
            except Cancelled:
                break
            for problem in writer.write(feature, solved):
                feedback.pushWarning(f"Feature {feature.id()} was not cut: {problem}.")
        if lines:
            lines.report(feedback)
        return writer.results()

    def _tau_of(self, parameters, context, source):
        """The function that gives tau for a feature."""
        if not QgsProcessingParameters.isDynamic(parameters, self.TAU):
            tau = self.parameterAsDouble(parameters, self.TAU, context)
            return lambda feature: tau
        expressions = self.createExpressionContext(parameters, context, source)
        own = parameters[self.TAU]  # a QgsProperty: no parameterAs... evaluates it per feature

        def tau_of(feature):
            expressions.setFeature(feature)
            value, valid = own.valueAsDouble(expressions, math.nan)
            return value if valid else math.nan

        return tau_of


class _Writer:
    """The sinks, and what is counted while they fill."""

    def __init__(self, tool, parameters, context, fields, wkb_type, crs):
        self.tool, self.parameters, self.context = tool, parameters, context
        self.multi = QgsWkbTypes.isMultiType(wkb_type)
        line_type = features.line_type(wkb_type)
        self.part_fields = QgsProcessingUtils.combineFields(fields, _fields(PART_FIELDS))
        self.cut_fields, self.diagonal_fields = _fields(CUT_FIELDS), _fields(DIAGONAL_FIELDS)
        self.destinations = {}
        self.parts = self._open(tool.OUTPUT, self.part_fields, wkb_type, crs)
        self.cuts = self._open(tool.CUTS, self.cut_fields, line_type, crs)
        self.diagonals = self._open(tool.DIAGONALS, self.diagonal_fields, line_type, crs)
        self.numbers = {
            tool.PART_COUNT: 0,
            tool.CUT_COUNT: 0,
            tool.CUT_LENGTH: 0.0,
            tool.MAX_DILATION: 1.0,
            tool.SKIPPED_COUNT: 0,
        }

    def _open(self, name, fields, wkb_type, crs):
        sink, destination = self.tool.parameterAsSink(
            self.parameters, name, self.context, fields, wkb_type, crs,
            # several parts share the key of their feature
            QgsFeatureSink.SinkFlag.RegeneratePrimaryKey,
        )
        if sink is None:
            if name == self.tool.OUTPUT or self.parameters.get(name):
                raise QgsProcessingException(
                    self.tool.invalidSinkError(self.parameters, name)
                )
            return None
        self.destinations[name] = destination
        return sink

    def write(self, feature, solved):
        """Write a solved feature; return what could not be solved of it."""
        problems = [polygon.problem for polygon in solved if polygon.problem]
        if not solved:
            problems = ["it has no geometry" if not feature.hasGeometry() else "it is empty"]
        self.numbers[self.tool.SKIPPED_COUNT] += bool(problems)
        if len(problems) >= len(solved):  # nothing solved: the feature as it is
            self._add_part(feature, feature.geometry(), 1, 1, "; ".join(dict.fromkeys(problems)))
            return problems

        extra = features.dimensions(feature.geometry().wkbType())
        order = sorted(
            ((-area, k, part) for k, polygon in enumerate(solved)
             for part, area in enumerate(polygon.area))
        )
        number = {(k, part): rank for rank, (_, k, part) in enumerate(order, 1)}
        for (_, k, part), rank in zip(order, range(1, len(order) + 1)):
            polygon = solved[k]
            geometry = features.polygon_geometry(
                polygon.coords, polygon.rings(part), extra, self.multi
            )
            self._add_part(feature, geometry, rank, len(order), polygon.problem)
        for k, polygon in enumerate(solved):
            if polygon.partition is not None:
                self._write_lines(feature, polygon, extra, lambda part, k=k: number[k, part])
        return problems

    def _add_part(self, feature, geometry, part, parts, status):
        _add(
            self.tool, self.parts, self.part_fields, geometry,
            feature.attributes() + [part, parts, status],
        )
        self.numbers[self.tool.PART_COUNT] += 1

    def _write_lines(self, feature, polygon, extra, number):
        solution, source = polygon.partition, feature.id()
        selected = solution.role == 0
        self.numbers[self.tool.CUT_COUNT] += int(selected.sum())
        self.numbers[self.tool.CUT_LENGTH] += float(solution.length[selected].sum())
        self.numbers[self.tool.MAX_DILATION] = max(
            self.numbers[self.tool.MAX_DILATION], solution.largest_dilation
        )
        if self.cuts is not None:
            for rows, length, detour, (a, b) in zip(
                solution.edge_rows[selected],
                solution.length[selected].tolist(),
                solution.detour[selected].tolist(),
                solution.parts.sides.tolist(),
            ):
                line = features.line_geometry(polygon.coords, rows, extra)
                values = [source, length, _or_null(detour), *sorted((number(a), number(b)))]
                _add(self.tool, self.cuts, self.cut_fields, line, values)
        if self.diagonals is not None:
            for rows, length, detour, dilation, role in zip(
                solution.edge_rows,
                solution.length.tolist(),
                solution.detour.tolist(),
                solution.dilation.tolist(),
                solution.role.tolist(),
            ):
                line = features.line_geometry(polygon.coords, rows, extra)
                values = [source, length, _or_null(detour), dilation, ROLES[role]]
                _add(self.tool, self.diagonals, self.diagonal_fields, line, values)

    def results(self):
        """The outputs of the tool; loaded layers get their styles."""
        style_on_load(self.context, self.destinations.get(self.tool.OUTPUT), "parts.qml")
        style_on_load(self.context, self.destinations.get(self.tool.CUTS), "cuts.qml")
        return {**self.destinations, **self.numbers}


def _add(tool, sink, fields, geometry, values):
    feature = QgsFeature(fields)
    feature.setGeometry(geometry)
    feature.setAttributes(values)
    if not sink.addFeature(feature, QgsFeatureSink.Flag.FastInsert):
        raise QgsProcessingException(
            "A result could not be written (is the disk full, or a value too long for the "
            f"format?): {sink.lastError()}"
        )


def _fields(definition):
    fields = QgsFields()
    for name, kind in definition:
        fields.append(features.field(name, kind))
    return fields


def _or_null(value):
    return value if math.isfinite(value) else NULL
