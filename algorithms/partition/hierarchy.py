"""The tool ``isthmus:hierarchy``."""

import math

import numpy as np
from qgis.core import (
    NULL,
    QgsProcessing,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
    QgsProcessingUtils,
    QgsPropertyDefinition,
    QgsWkbTypes,
)

from ...core.errors import Cancelled
from ...core.progress import checker, stretch
from ..base import counted
from ..layers import wkb
from ..layers.sinks import Sinks, make_fields
from ..layers.source import Reader
from ..layers.styles import style_on_load
from ..layers.wkb import INTEGER, LONG, REAL, TEXT
from .cutting import PartitionTool, Told
from .solving import prepare, read

LEVEL_FIELDS = (
    ("part", INTEGER), ("parent", INTEGER), ("level", INTEGER), ("from_tau", REAL), ("to_tau", REAL),
    ("source", LONG), ("status", TEXT),
)  # fmt: skip
RANKED_FIELDS = (
    ("source", LONG), ("length", REAL), ("detour", REAL), ("persistence", REAL), ("rank", INTEGER)
)

HELP = """
<p>Cuts polygons once, for every <i>largest detour</i> (tau) from the smallest one on, and for every
number of parts: bays within seas, and seas within the ocean.</p>
<p>It begins with the fewest cuts at the smallest tau, as <i>Partition polygons at bottlenecks</i> finds
them, and takes cuts away one by one, always the one that is needed least: whose loss leaves the smallest
largest detour. That detour is the <i>persistence</i> of the cut: up to this tau it is needed. So the
parts are nested; for a single tau the fewest cuts may be one less here and there.</p>
<h3>To show one level</h3>
<p>The parts of all levels lie on top of each other. The filter <i>from_tau &lt;= 3 AND 3 &lt; to_tau</i>
shows the partition at tau = 3, and <i>persistence &gt; 3</i> its cuts. Parts that stay for ever have a
to_tau of 1,000,000,000, and cuts that only connect a hole have this persistence.</p>
<p>The style of the parts shows the level of the project variable <i>isthmus_tau</i> (Project, Properties,
Variables), or that of tau = 3. For a slider on it, enter this line in the Python console:</p>
<p>from qgis.PyQt.QtWidgets import QSlider; slider = QSlider(); slider.setRange(10, 300);
slider.valueChanged.connect(lambda value:
(QgsExpressionContextUtils.setProjectVariable(QgsProject.instance(), "isthmus_tau", value / 10),
iface.mapCanvas().refreshAllLayers())); slider.show()</p>
{lists}
<h3>Size of the result</h3>
<p>Each part of each level is written once. A large body that loses a thousand small parts comes a
thousand times: where there are so many cuts, as with PLACES = Any, give a number of parts or a larger
tau.</p>
<h3>Units</h3>
<p>Lengths and areas are in the units of the layer; if its coordinates are degrees, they are
metres and square metres on the ellipsoid. The results stay in the CRS of the layer.</p>
<h3>Guarantee</h3>
<p>At each tau, the way along the outline and the cuts that are left is at most tau times as long as each
possible cut. For a polygon without holes the persistences are exact, and at the smallest tau no
solution has fewer cuts. With holes the persistences are upper bounds, and cuts that connect holes stay.
No vertex is moved, and none is added unless you ask for it. What cannot be split passes through
unchanged, with the reason in the field <i>status</i>.</p>
"""


class HierarchyAlgorithm(PartitionTool):
    """Nested partitions for every tau."""

    help_text = HELP
    TAU = "TAU"
    PARTS = "PARTS"
    OUTPUT = "OUTPUT"
    CUTS = "CUTS"
    PART_COUNT = "PART_COUNT"
    CUT_COUNT = "CUT_COUNT"
    SKIPPED_COUNT = "SKIPPED_COUNT"

    def name(self):
        return "hierarchy"

    def displayName(self):
        return "Hierarchy of natural parts"

    def tags(self):
        return (
            "hierarchy,level,nested,multiscale,scale,number,part,natural,partition,split,cut,bottleneck,"
            "neck,bay,peninsula,generalize,tau,persistence"
        ).split(",")

    def shortDescription(self):
        return "Cuts polygons into natural parts for every tau and every number of parts at once."

    def initAlgorithm(self, configuration=None):
        self.add_input()
        self.add_dynamic(
            self.TAU,
            "Smallest tau, where the finest level begins",
            1.5,
            1.0,
            "The largest detour in the finest level: how many times longer than the straight line across "
            "a neck the way along the outline may be; at least 1. Smaller values cut more. A field or "
            "expression can set it for each feature.",
        )
        parts = QgsProcessingParameterNumber(
            self.PARTS, "Only the level with so many parts",
            QgsProcessingParameterNumber.Type.Integer, None, True, 1,
        )  # fmt: skip
        parts.setIsDynamic(True)
        kind = QgsPropertyDefinition.DataType.DataTypeNumeric
        parts.setDynamicPropertyDefinition(
            QgsPropertyDefinition(self.PARTS, kind, parts.description(), "number [≥ 1]")
        )
        parts.setDynamicLayerParameterName(self.INPUT)
        self.add(
            parts,
            "Writes just the level in which a feature has this number of parts, or the next best: all "
            "that there are, or one for each polygon of a multipart feature. A field or expression can "
            "set it for each feature; where it is empty, all levels are written.",
        )
        self.add_places()
        self.add_new_vertices(
            "Only those where a cut ends are added, with Z and M interpolated, and the parts of the levels "
            "without this cut do not have them. Neighbours in the layer do not get them."
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                self.OUTPUT, "Parts of all levels", QgsProcessing.SourceType.TypeVectorPolygon
            ),
            "Every part of every level once, with all fields of the polygons, and part (its number in "
            "the feature, by level and size), parent (the part that it becomes a piece of; empty for "
            "those that stay), level (0 is the finest; that in which it comes up), from_tau and to_tau (it "
            "is there where from_tau <= tau < to_tau), source (the id of the feature) and status "
            "(empty, or why a polygon was not cut).",
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                self.CUTS, "Cuts by persistence", QgsProcessing.SourceType.TypeVectorLine, optional=True
            ),
            "The cuts, with the id of their polygon (source), length, detour (how many times longer the "
            "way along the outline was; empty if only a cut connects the ends), persistence (the tau up "
            "to which the cut is needed) and rank (1 for the most persistent of the feature).",
        )
        self.add_numbers(
            (
                (self.PART_COUNT, "Number of parts in all levels"),
                (self.CUT_COUNT, "Number of cuts"),
                (self.SKIPPED_COUNT, "Number of features not solved"),
            )
        )

    def parameter_problem(self, parameters, context):
        problem = self.dynamic_problem(parameters, self.TAU, context, 1.0)
        if not problem and parameters.get(self.PARTS) is not None:
            problem = self.dynamic_problem(parameters, self.PARTS, context, 1.0)
        return problem or self.objective_problem(parameters, context)

    def processAlgorithm(self, parameters, context, feedback):
        from ...core.partition.features import without_vertex
        from ...core.partition.nesting import nest

        source = self.source(parameters, context)
        reader = Reader(source, feedback)
        tau_of = self.dynamic(parameters, self.TAU, context, source)
        parts_of = None
        if parameters.get(self.PARTS) is not None:
            parts_of = self.dynamic(parameters, self.PARTS, context, source)
        with Sinks(self, parameters, context, feedback) as sinks:
            writer = _Writer(self, source, reader.wkb_type, sinks)
            settings = self.settings(parameters, context, source, feedback)
            check = checker(reader.progress, feedback.isCanceled)
            try:
                for features in reader.chunks():
                    for chunk in read(features, settings, feedback):
                        problem = prepare(chunk, settings, stretch(check, 0.0, 0.4))
                        tau, parts = (
                            of and np.array([of(feature) for feature in chunk.features], dtype=float)
                            for of in (tau_of, parts_of)
                        )
                        nested = nest(problem, tau, parts, stretch(check, 0.4, 0.8))
                        writer.told.short += without_vertex(problem, nested.selection, nested.tau)
                        writer.write(problem, nested, feedback, stretch(check, 0.8, 1.0))
            except Cancelled:
                pass
        writer.report(feedback)
        destinations = sinks.destinations
        style_on_load(context, destinations.get(self.CUTS), "hierarchy_cuts.qml", 0)
        style = "hierarchy_parts.qml" if parts_of is None else "parts.qml"
        style_on_load(context, destinations.get(self.OUTPUT), style, 3)
        return {**destinations, **writer.numbers, self.SKIPPED_COUNT: writer.told.skipped}


class _Writer:
    """Writes levels, and counts what is in them."""

    def __init__(self, tool, source, wkb_type, sinks):
        self.tool, self.sinks, self.told = tool, sinks, Told()
        fields, crs = source.fields(), source.sourceCrs()
        self.multi = QgsWkbTypes.isMultiType(wkb_type)
        sinks.open(
            tool.OUTPUT, QgsProcessingUtils.combineFields(fields, make_fields(LEVEL_FIELDS)), wkb_type,
            crs,
        )  # fmt: skip
        self.with_cuts = sinks.open(
            tool.CUTS, make_fields(RANKED_FIELDS), wkb.line_type(wkb_type), crs, False
        )
        self.numbers = dict.fromkeys((tool.PART_COUNT, tool.CUT_COUNT), 0)
        self.most, self.missed = 0, 0

    def write(self, problem, nested, feedback, check):
        """Write the levels of a chunk, and tell what of it could not be solved."""
        from ...core.partition.nesting import NO_END, items_of

        chunk, tool = problem.chunk, self.tool
        count = len(chunk.features)
        items = items_of(problem, nested)
        own = items.level == 0
        at_first = np.bincount(items.feature[own], minlength=count)
        total = np.bincount(items.feature[own], weights=items.area[own], minlength=count)
        small = own & (items.area < 0.01 * total[items.feature]) & (at_first[items.feature] > 1)
        self.told.small += int(small.sum())
        self.told.count(problem.prepared)
        self.missed += nested.missed
        self.most = max(self.most, int(items.level.max(initial=-1)) + 1)
        self.numbers[tool.CUT_COUNT] += int(nested.cuts.sum())

        geometries = _geometries(problem, nested, items, self.multi)
        bounds = np.searchsorted(items.feature, np.arange(count + 1)).tolist()
        values = list(zip(*(x.tolist() for x in (
            items.number, items.parent, items.level, items.from_tau, items.to_tau
        ))))  # fmt: skip
        verdicts = np.where(items.whole >= 0, problem.verdict[items.whole], "").tolist()
        cuts, lines = self._cuts(problem, nested) if self.with_cuts else ([], None)
        for f, feature in enumerate(chunk.features):
            lo, hi = bounds[f], bounds[f + 1]
            text = self.told.reason(feature, verdicts[lo:hi], feedback)
            attributes, origin = feature.attributes(), f"feature {feature.id()}"
            if all(verdicts[lo:hi]):  # nothing solved: the feature as it is
                for _ in range(lo, hi):
                    next(geometries)
                more = [1, NULL, 0, float(nested.tau[f]), NO_END, feature.id(), text]
                self.sinks.add(tool.OUTPUT, feature.geometry(), attributes + more, origin)
                self.numbers[tool.PART_COUNT] += 1
                continue
            for k in range(lo, hi):
                if k % 64 == 0:
                    check((f + (k - lo) / (hi - lo)) / count)
                number, parent, *rest = values[k]
                more = [number, parent or NULL, *rest, feature.id(), verdicts[k]]
                self.sinks.add(tool.OUTPUT, next(geometries), attributes + more, origin)
            self.numbers[tool.PART_COUNT] += hi - lo
            while cuts and cuts[-1] == f:
                cuts.pop()
                geometry, line = next(lines)
                self.sinks.add(tool.CUTS, geometry, [feature.id(), *line], origin)

    def _cuts(self, problem, nested):
        """The feature of each cut, the last one first; geometries and values, by feature and rank."""
        from ...core.partition.nesting import cuts

        feature, edges, fields = cuts(problem, nested)
        values = (
            [length, detour if math.isfinite(detour) else NULL, *more]
            for length, detour, *more in zip(*(x.tolist() for x in fields.values()))
        )
        geometries = wkb.line_geometries(
            problem.chunk.rings.coords, problem.prepared.edge_rows[edges],
            [problem.chunk.extra[f] for f in feature.tolist()],
        )
        return feature.tolist()[::-1], zip(geometries, values)

    def report(self, feedback):
        """Say in the log what was done."""
        if feedback.isCanceled():
            feedback.pushWarning("Cancelled: the results are not complete.")
            return
        numbers, tool = self.numbers, self.tool
        feedback.pushInfo(
            f"{counted(numbers[tool.PART_COUNT], 'part')} in at most {counted(self.most, 'level')} of a "
            f"feature, made by {counted(numbers[tool.CUT_COUNT], 'cut')}."
        )
        more = self.missed and (
            f"{counted(self.missed, 'feature')} cannot have so many or so few parts (PARTS), and got "
            "the next best number. A smaller TAU gives more cuts to choose from."
        )
        self.told.report(feedback, more)


def _geometries(problem, nested, items, multi):
    """Yield the geometry of each item."""
    from ...core.partition.nesting import shapes

    chunk = problem.chunk
    extra = [chunk.extra[f] for f in items.feature.tolist()]

    def polygons(which, rows, offsets, ring_offsets):
        return wkb.polygon_geometries(
            chunk.rings.coords, rows, offsets, ring_offsets, [extra[k] for k in which.tolist()], multi
        )

    return shapes(problem, nested, items, polygons)
