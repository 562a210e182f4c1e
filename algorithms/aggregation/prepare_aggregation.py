"""The tool ``isthmus:prepareaggregation``."""

from functools import partial

import numpy as np
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsProcessing,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
    QgsProcessingUtils,
    QgsWkbTypes,
)

from ...core.progress import checker
from ..base import counted
from ..layers import wkb
from ..layers.sinks import Sinks, make_fields
from ..layers.source import Reader
from ..layers.styles import style_on_load
from ..layers.wkb import INTEGER, LONG, REAL, TEXT
from ..partition.cutting import ANY, BY_LENGTH, BY_SIZE, NATURAL, PartitionTool, report_short
from ..partition.solving import Settings, measure_of, prepare, read, reasons_of
from . import areas as layer
from .areas_tool import AreasTool, field_index

PIECE_FIELDS = (("area_id", LONG), ("piece", LONG), ("size", REAL), ("status", TEXT))
PAIR_FIELDS = (("a", LONG), ("b", LONG), ("length", REAL), ("virtual", INTEGER))

HELP = """
<p>Splits the areas of a land-cover map at their bottlenecks, so that <i>Aggregate areas</i> can give
the parts of one area to different regions. Less then has to change its class, and the regions become
more compact.</p>
<p>Run <i>Aggregate areas</i> with the pieces next: pieces of one area that end in one region are
merged again.</p>
{lists}
<h3>What the map should be like</h3>
<p>The areas should fill the map without overlaps and gaps; what is found of these is counted and
reported. Vertices of neighbours need not match: a vertex of one may lie inside an edge of the
other. No vertex is moved, and none is added unless you ask for it: then neighbours get it too. So what
neighbours share they still share. An area that
cannot be cut (invalid, for one) passes through in one piece, with the reason in <i>status</i>.</p>
<h3>Method</h3>
<p>J.-H. Haunert and W. Meulemans, Partitioning Polygons via Graph Augmentation,
GIScience 2016, section 5.2.</p>
"""


class PrepareAggregationAlgorithm(AreasTool, PartitionTool):
    """Split the areas of a coverage at bottlenecks."""

    help_text = HELP
    TAU = "TAU"
    OUTPUT = "OUTPUT"
    ADJACENCY = "ADJACENCY"
    AREA_COUNT = "AREA_COUNT"
    PIECE_COUNT = "PIECE_COUNT"
    SKIPPED_COUNT = "SKIPPED_COUNT"
    OVERLAP_COUNT = "OVERLAP_COUNT"
    GAP_COUNT = "GAP_COUNT"

    def name(self):
        return "prepareaggregation"

    def displayName(self):
        return "Prepare areas for aggregation"

    def tags(self):
        return (
            "aggregation,generalize,generalization,land cover,land use,split,bottleneck,coverage,"
            "neighbours,adjacency,shared boundary,topology"
        ).split(",")

    def shortDescription(self):
        return "Splits land-cover areas at bottlenecks before they are aggregated."

    def initAlgorithm(self, configuration=None):
        add = self.add
        number = QgsProcessingParameterNumber.Type
        self.add_areas(
            "The areas of a map, which fill it without overlaps and gaps.",
            "The field with the class of each area. Areas without one are reported.",
        )
        add(
            QgsProcessingParameterNumber(
                self.TAU, "Largest detour (tau)", number.Double, defaultValue=4.0, minValue=1.0
            ),
            "How many times longer than the straight line across a neck the way along the outline may "
            "be; at least 1. Smaller values cut more.",
            decimals=2,
        )
        add(
            QgsProcessingParameterEnum(
                self.OBJECTIVE, "What to minimize: number or length of cuts", [BY_SIZE, BY_LENGTH],
                defaultValue=BY_SIZE, usesStaticStrings=True,
            ),
            "MinSize: as few cuts as possible. MinLength: as little length of cuts as possible.",
        )
        self.add_places(ANY, 0.0)
        self.add_new_vertices(
            "Only those where a cut ends are added, with Z and M interpolated. Neighbours get the same "
            "vertices, so that shared boundaries stay shared."
        )
        add(
            QgsProcessingParameterFeatureSink(
                self.OUTPUT, "Pieces", QgsProcessing.SourceType.TypeVectorPolygon
            ),
            "All fields of the areas, and area_id (the id of the area), piece (a number for each "
            "piece), size (in square metres) and status (empty, or why an area was not cut).",
        )
        add(
            QgsProcessingParameterFeatureSink(
                self.ADJACENCY,
                "Neighbours",
                QgsProcessing.SourceType.TypeVector,
                optional=True,
                createByDefault=False,
            ),
            "A table of neighbouring pieces a and b, the length of their shared boundary in metres, "
            "and virtual: 1 for a cut between two pieces of one area.",
        )
        self.add_numbers(
            (
                (self.AREA_COUNT, "Number of areas"),
                (self.PIECE_COUNT, "Number of pieces"),
                (self.SKIPPED_COUNT, "Number of areas not cut for a reason"),
                (self.OVERLAP_COUNT, "Number of overlapping pairs of areas"),
                (self.GAP_COUNT, "Number of gaps"),
            )
        )

    def parameter_problem(self, parameters, context):
        return (
            self.number_problem(parameters, context, self.TAU, 1.0)
            or self.objective_problem(parameters, context)
        )

    def processAlgorithm(self, parameters, context, feedback):
        source = self.source(parameters, context)
        with Sinks(self, parameters, context, feedback) as sinks:
            numbers = self._prepare(parameters, context, feedback, source, sinks)
        style_on_load(context, sinks.destinations.get(self.OUTPUT), "parts.qml")
        return {**sinks.destinations, **numbers} if numbers else {}

    def _prepare(self, parameters, context, feedback, source, sinks):
        """Cut the areas, write the pieces and the table; return the numbers, none if cancelled."""
        from ...core.aggregation.areas import arrange, joined_rings, neighbours, rows_of
        from ...core.aggregation.coverage import faults, with_shared_vertices
        from ...core.errors import Cancelled
        from ...core.partition.features import pieces, weigh_by_length, without_vertex
        from ...core.partition.solve import finish, select
        from ...core.rings import Rings, offsets_of

        class_index = field_index(self, parameters, context, source, self.CLASS)
        crs, reader = source.sourceCrs(), Reader(source, feedback)
        multi = QgsWkbTypes.isMultiType(reader.wkb_type)
        own = QgsProcessingUtils.combineFields(source.fields(), make_fields(PIECE_FIELDS))
        sinks.open(self.OUTPUT, own, reader.wkb_type, crs)
        with_table = sinks.open(
            self.ADJACENCY, make_fields(PAIR_FIELDS), QgsWkbTypes.Type.NoGeometry,
            QgsCoordinateReferenceSystem(), False,
        )  # fmt: skip
        tau = self.parameterAsDouble(parameters, self.TAU, context)
        objective = self.parameterAsEnumString(parameters, self.OBJECTIVE, context)
        settings = Settings(
            measure=measure_of(crs),
            natural=self.parameterAsEnumString(parameters, self.PLACES, context) == NATURAL,
            floors=self.floors(parameters, context, source),
            lines=None,
            new_vertices=self.parameterAsBoolean(parameters, self.NEW_VERTICES, context),
            weigh=weigh_by_length if objective == BY_LENGTH else None,
            all_dilations=False,
        )

        check = checker(reader.progress, feedback.isCanceled)
        kept, cut, classless, short = [], [], 0, 0  # areas, and their pieces chunk by chunk
        try:
            for features in reader.chunks():
                for feature in features:
                    classless += layer.text(feature.attributes()[class_index]) is None
                    feature.setGeometry(
                        layer.with_dimensions(feature.geometry(), reader.wkb_type)
                    )
                for chunk in read(features, settings, feedback):
                    problem = prepare(chunk, settings, check)
                    selection = select(
                        problem.prepared, tau, weight=problem.weight, check=check,
                        with_dilation=False,
                    )
                    short += without_vertex(problem, selection, np.full(len(chunk.features), tau))
                    parts = finish(problem.prepared, selection, check=check).parts
                    found = pieces(problem, parts)
                    coords = problem.chunk.rings.coords
                    cut.append((
                        chunk.owner[found.polygon] + len(kept),
                        problem.verdict[found.polygon],
                        Rings(coords[found.rows], found.offsets, found.ring_offsets),
                        found.rows >= len(chunk.rings.coords),
                    ))
                    whole = set(chunk.owner[problem.verdict != ""].tolist())  # may come out as they came
                    whole.update(set(range(len(chunk.features))).difference(chunk.owner.tolist()))
                    for number, feature in enumerate(chunk.features):
                        if number not in whole:
                            feature.clearGeometry()  # of 55,191 areas 0.03 GB
                    kept += chunk.features
        except Cancelled:
            return {}
        area = np.concatenate([np.empty(0, dtype=np.int64)] + [number for number, *_ in cut])
        status = np.concatenate([np.empty(0, dtype=object)] + [verdict for _, verdict, *_ in cut])
        of_area = offsets_of(np.bincount(area, minlength=len(kept))).tolist()
        skipped = 0
        for number, feature in enumerate(kept):
            lo, hi = of_area[number], of_area[number + 1]
            problems = reasons_of(feature, status[lo:hi])
            if problems:
                skipped += 1
                feedback.pushWarning(f"Area {feature.id()} was not cut: {'; '.join(problems)}.")
        if feedback.isCanceled():
            return {}

        feedback.setProgressText("Finding shared boundaries")
        rings = joined_rings([own for _, _, own, _ in cut])
        pieces_of = partial(
            arrange, range(len(area)), owner=np.arange(len(area)), measure=settings.measure,
            metre=layer.metres_of(crs),
        )
        found = pieces_of(rings)
        is_new = np.concatenate([np.empty(0, dtype=bool)] + [new for *_, new in cut])
        grown = np.zeros(len(area), dtype=bool)
        if is_new.any():
            rings, grown = with_shared_vertices(rings, is_new, found.coverage, rows_of(found, rings))
            found = pieces_of(rings)
        geometries = wkb.polygon_geometries(
            rings.coords, np.arange(len(rings.coords)), rings.offsets, rings.polygon_offsets,
            [wkb.dimensions(reader.wkb_type)] * len(area), multi,
        )
        for k, (number, reason, size, geometry) in enumerate(
            zip(area.tolist(), status.tolist(), found.size.tolist(), geometries)
        ):
            feature = kept[number]
            if reason and of_area[number + 1] - of_area[number] == 1 and not grown[k]:
                # as it came, even with a ring that is not closed
                own = feature.geometry()
                if not QgsWkbTypes.isCurvedType(own.wkbType()):
                    geometry = own
                    if multi:
                        geometry.convertToMultiType()
            values = [feature.id(), k + 1, size, reason]
            sinks.add(self.OUTPUT, geometry, feature.attributes() + values, f"area {feature.id()}")
        empty = [number for number in range(len(kept)) if of_area[number] == of_area[number + 1]]
        for number in empty:
            feature = kept[number]
            (reason,) = reasons_of(feature, ())
            values = [feature.id(), layer.NULL, 0.0, reason]
            sinks.add(
                self.OUTPUT, feature.geometry(), feature.attributes() + values, f"area {feature.id()}"
            )

        if with_table:
            pairs, length = neighbours(found)
            virtual = (area[pairs[:, 0]] == area[pairs[:, 1]]).astype(int)
            for (a, b), shared, cut in zip(pairs.tolist(), length.tolist(), virtual.tolist()):
                sinks.add(self.ADJACENCY, None, [a + 1, b + 1, shared, cut])

        wrong = faults(found.coverage)
        overlaps = np.unique(np.sort(area[wrong.overlaps], axis=1).reshape(-1, 2), axis=0)
        overlaps = overlaps[overlaps[:, 0] != overlaps[:, 1]]
        _report(feedback, kept, overlaps, wrong.gaps, classless)
        report_short(feedback, short)
        return {
            self.AREA_COUNT: len(kept),
            self.PIECE_COUNT: len(area) + len(empty),
            self.SKIPPED_COUNT: skipped,
            self.OVERLAP_COUNT: len(overlaps),
            self.GAP_COUNT: len(wrong.gaps),
        }


def _report(feedback, kept, overlaps, gaps, classless, most=10):
    """Tell what is wrong with the coverage."""
    if len(overlaps):
        some = ", ".join(
            f"{kept[a].id()} and {kept[b].id()}" for a, b in overlaps[:most].tolist()
        )
        feedback.pushWarning(
            f"{counted(len(overlaps), 'pair')} of areas overlap: {some}"
            f"{' ...' * (len(overlaps) > most)}. Nothing was changed about that; sizes count the common "
            "part twice."
        )
    if len(gaps):
        some = ", ".join(f"({x:.10g} {y:.10g})" for x, y in gaps[:most].tolist())
        feedback.pushWarning(
            f"{counted(len(gaps), 'gap')} inside the map without an area, at {some}"
            f"{' ...' * (len(gaps) > most)}. Areas on both sides of a gap are no neighbours there."
        )
    if classless:
        feedback.pushWarning(
            f"Without a class: {counted(classless, 'area')}. Aggregation will leave such areas as "
            "they are."
        )
