"""The tool ``isthmus:hierarchy``."""

import math
from typing import NamedTuple

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
from .cutting import PartitionTool, report_rules, report_short
from .solving import pieces, prepare, read, reasons_of, without_vertex

# "Without end": every format stores it, a shapefile's 24 characters too
NO_END = 1e9
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
                        nested = _nest(problem, tau_of, parts_of, stretch(check, 0.4, 0.8))
                        writer.short += without_vertex(problem, nested.selection, nested.tau)
                        writer.write(problem, nested, feedback, stretch(check, 0.8, 1.0))
            except Cancelled:
                pass
        writer.report(feedback)
        destinations = sinks.destinations
        style_on_load(context, destinations.get(self.CUTS), "hierarchy_cuts.qml", 0)
        style = "hierarchy_parts.qml" if parts_of is None else "parts.qml"
        style_on_load(context, destinations.get(self.OUTPUT), style, 3)
        return {**destinations, **writer.numbers}


class _Nested(NamedTuple):
    """The levels of a chunk.

    Attributes
    ----------
    selection, parts : core.partition.solve.Selection, core.partition.parts.Parts
        The finest partition of the prepared polygons.
    pieces : Pieces
        The same, and what could not be solved.
    persistence, rank : (s,) float, (s,) int
        Of each selected edge; rank in its feature.
    cuts : (s,) bool
        Those to write.
    levels : core.partition.hierarchy.Levels
        Of the finest parts.
    tau : (f,) float
        Where the levels of each feature begin.
    ranges : dict
        From and to which tau there is the only level of a feature that is wanted, by feature.
    missed : int
        Features that have no level with so many parts.
    """

    selection: object
    parts: object
    pieces: object
    persistence: object
    rank: object
    cuts: object
    levels: object
    tau: object
    ranges: dict
    missed: int


def _nest(problem, tau_of, parts_of, check):
    """Solve a chunk and order its cuts."""
    import numpy as np

    from ...core.partition.hierarchy import hierarchy, levels
    from ...core.partition.parts import build_parts
    from ...core.partition.solve import select

    prepared, features = problem.prepared, problem.chunk.features
    tau = np.array([tau_of(feature) for feature in features])
    bad = ~((tau >= 1.0) & (tau < NO_END))
    for f in np.flatnonzero(bad).tolist():
        problem.refuse(f, f"tau must be a number from 1 to below {NO_END:g}, and is {tau[f]:g}")
    tau[bad] = 1.0
    wanted = np.full(len(features), np.nan)
    if parts_of is not None:
        wanted = np.array([parts_of(feature) for feature in features])
        bad = (wanted < 1.0) | (wanted != np.floor(wanted)) & ~np.isnan(wanted) | np.isinf(wanted)
        for f in np.flatnonzero(bad).tolist():
            problem.refuse(f, f"PARTS must be a whole number of at least 1, and is {wanted[f]:g}")
            wanted[f] = np.nan

    selection = select(
        prepared, tau[problem.owner], check=stretch(check, 0.0, 0.2), with_dilation=False
    )
    found = hierarchy(prepared, selection, stretch(check, 0.2, 1.0))
    selected, tree = selection.selected, selection.carved.tree
    parts = build_parts(
        prepared.polygons, selection.carved.walk, selected, tree, prepared.measure.equal_area
    )

    owner = prepared.owner[selected]
    feature = problem.owner[owner]
    # the finest level has all cuts, though in another T one may turn out not to be needed
    persistence = np.clip(found.persistence, np.nextafter(tau[feature], np.inf), NO_END)
    by_rank = np.lexsort((found.rank, owner, -persistence, feature))
    cuts = problem.verdict[prepared.polygons.number[owner]] == ""
    by_rank = by_rank[cuts[by_rank]]
    rank = np.zeros(len(selected), dtype=np.int64)
    first = np.searchsorted(feature[by_rank], np.arange(len(features) + 1))
    rank[by_rank] = np.arange(len(by_rank)) - first[feature[by_rank]] + 1

    # a cut that goes at once parts nothing; one that never goes parts all levels
    goes = np.where(cuts, np.where(persistence < NO_END, persistence, np.inf), 0.0)
    ranges, missed = {}, 0
    in_tree = np.isin(selected, tree)
    polygons = np.bincount(problem.chunk.owner, minlength=len(features))
    for f in np.flatnonzero(wanted >= 1.0).tolist():
        own = by_rank[first[f]:first[f + 1]]
        own = own[~in_tree[own]]
        count = int(min(max(wanted[f] - polygons[f], 0), len(own)))
        missed += int(polygons[f] > 0 and polygons[f] + count != wanted[f])
        goes[own[:count]], goes[own[count:]] = np.inf, 0.0
        cuts[own[count:]] = False
        ranges[f] = (
            float(persistence[own[count]]) if count < len(own) else float(tau[f]),
            float(persistence[own[count - 1]]) if count else NO_END,
        )
    part_polygon = np.repeat(np.arange(len(prepared.polygons.unit)), np.diff(parts.part_offsets))
    return _Nested(
        selection=selection,
        parts=parts,
        pieces=pieces(problem, parts),
        persistence=persistence,
        rank=rank,
        cuts=cuts,
        levels=levels(
            found._replace(persistence=goes), parts.sides, len(part_polygon),
            tau[problem.owner[part_polygon]],
        ),
        tau=tau,
        ranges=ranges,
        missed=missed,
    )


class _Writer:
    """Writes levels, and counts what is in them."""

    def __init__(self, tool, source, wkb_type, sinks):
        self.tool, self.sinks = tool, sinks
        fields, crs = source.fields(), source.sourceCrs()
        self.multi = QgsWkbTypes.isMultiType(wkb_type)
        sinks.open(
            tool.OUTPUT, QgsProcessingUtils.combineFields(fields, make_fields(LEVEL_FIELDS)), wkb_type,
            crs,
        )  # fmt: skip
        self.with_cuts = sinks.open(
            tool.CUTS, make_fields(RANKED_FIELDS), wkb.line_type(wkb_type), crs, False
        )
        self.numbers = dict.fromkeys((tool.PART_COUNT, tool.CUT_COUNT, tool.SKIPPED_COUNT), 0)
        self.most, self.missed, self.small, self.holes, self.rules = 0, 0, 0, 0, [0] * 5
        self.short = 0

    def write(self, problem, nested, feedback, check):
        """Write the levels of a chunk, and tell what of it could not be solved."""
        import numpy as np

        chunk, tool, prepared = problem.chunk, self.tool, problem.prepared
        count = len(chunk.features)
        items = _items(problem, nested)
        own = items.level == 0
        at_first = np.bincount(items.feature[own], minlength=count)
        total = np.bincount(items.feature[own], weights=items.area[own], minlength=count)
        small = own & (items.area < 0.01 * total[items.feature]) & (at_first[items.feature] > 1)
        self.small += int(small.sum())
        self.missed += nested.missed
        self.rules = [a + b for a, b in zip(self.rules, prepared.set_aside.sum(axis=0).tolist())]
        self.holes += int((~prepared.wanted[prepared.component]).sum())
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
            reasons = reasons_of(feature, verdicts[lo:hi])
            attributes, origin = feature.attributes(), f"feature {feature.id()}"
            if reasons:
                self.numbers[tool.SKIPPED_COUNT] += 1
                text = "; ".join(reasons)
                feedback.pushWarning(f"Feature {feature.id()} was not cut: {text}.")
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
        import numpy as np

        prepared, selected = problem.prepared, nested.selection.selected
        which = np.flatnonzero(nested.cuts)
        feature = problem.owner[prepared.owner[selected[which]]]
        order = np.lexsort((nested.rank[which], feature))
        which, feature = which[order], feature[order].tolist()
        edges = selected[which]
        values = (
            [length, detour if math.isfinite(detour) else NULL, *more]
            for length, detour, *more in zip(*(x.tolist() for x in (
                prepared.chord[edges], prepared.detour[edges], nested.persistence[which],
                nested.rank[which],
            )))
        )
        geometries = wkb.line_geometries(
            problem.chunk.rings.coords, prepared.edge_rows[edges],
            [problem.chunk.extra[f] for f in feature],
        )
        return feature[::-1], zip(geometries, values)

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
        report_rules(feedback, self.small, self.holes, self.rules)
        report_short(feedback, self.short)
        if self.missed:
            feedback.pushInfo(
                f"{counted(self.missed, 'feature')} cannot have so many or so few parts (PARTS), and got "
                "the next best number. A smaller TAU gives more cuts to choose from."
            )
        skipped = numbers[tool.SKIPPED_COUNT]
        if skipped:
            feedback.pushInfo(
                f"Not cut: {counted(skipped, 'feature')}; see the field status of the parts."
            )


class _Items(NamedTuple):
    """What to write of a chunk, by feature, level and size; arrays with an entry for each.

    Attributes
    ----------
    feature, number, parent, level : int
        The parent 0 for none.
    from_tau, to_tau, area : float
    part : int
        The part in the levels; -1 for a polygon that could not be solved.
    whole : int
        The polygon of the chunk that it is all of; -1 where it is not.
    """

    feature: object
    number: object
    parent: object
    level: object
    from_tau: object
    to_tau: object
    area: object
    part: object
    whole: object


def _items(problem, nested):
    """List the parts of all levels of a chunk, and the polygons that could not be solved."""
    import numpy as np

    prepared, made, parts = problem.prepared, nested.levels, nested.parts
    count = len(parts.area)
    of_part = np.repeat(np.arange(len(prepared.polygons.unit)), np.diff(parts.part_offsets))
    area = [*parts.area.tolist(), *[0.0] * (len(made.parent) - count)]
    for k, parent in enumerate(made.parent.tolist()):  # comes after its pieces
        if parent >= 0:
            area[parent] += area[k]
    area = np.array(area)
    polygon = of_part[made.leaf[made.first]]
    number = prepared.polygons.number[polygon]
    shown = np.flatnonzero((made.from_tau < made.to_tau) & (problem.verdict[number] == ""))
    # those that could not be solved
    left = np.flatnonzero(problem.verdict != "")
    of_piece = problem.verdict[nested.pieces.polygon] != ""
    left_area = np.zeros(len(problem.verdict))
    left_area[nested.pieces.polygon[of_piece]] = nested.pieces.area[of_piece]

    part = np.append(shown, np.full(len(left), -1))
    all_of_it = (made.last - made.first == np.diff(parts.part_offsets)[polygon])[shown]
    whole = np.append(np.where(all_of_it, number[shown], -1), left)
    area = np.append(area[shown], left_area[left])
    feature = problem.chunk.owner[np.append(number[shown], left)]
    from_tau = np.append(made.from_tau[shown], nested.tau[problem.chunk.owner[left]])
    to_tau = np.append(np.minimum(made.to_tau[shown], NO_END), np.full(len(left), NO_END))
    order = np.lexsort((part, -area, from_tau, feature))
    part, whole, area, feature, from_tau, to_tau = (
        x[order] for x in (part, whole, area, feature, from_tau, to_tau)
    )

    new_feature = np.diff(feature, prepend=-1) != 0
    first = np.maximum.accumulate(np.where(new_feature, np.arange(len(order)), 0))
    place = np.arange(len(order)) - first + 1
    steps = np.cumsum((np.diff(from_tau, prepend=0.0) != 0) & ~new_feature)
    place_of = np.zeros(len(made.parent) + 1, dtype=np.int64)  # the last one is for no parent
    place_of[part[part >= 0]] = place[part >= 0]
    parent = np.append(made.parent, -1)[part]
    for f, (least, most) in nested.ranges.items():
        from_tau[feature == f], to_tau[feature == f] = least, most
    return _Items(
        feature, place, place_of[parent], steps - steps[first], from_tau, to_tau, area, part, whole
    )


def _geometries(problem, nested, items, multi):
    """Yield the geometry of each item."""
    import numpy as np

    from ...core.partition.parts import merged_parts
    from ...core.rings import offsets_of, ranges, take

    chunk, made, parts = problem.chunk, nested.levels, nested.parts
    rings, carved = chunk.rings, nested.selection.carved
    extra = [chunk.extra[f] for f in items.feature.tolist()]

    def polygons(which, rows, offsets, ring_offsets):
        return wkb.polygon_geometries(
            rings.coords, rows, offsets, ring_offsets, [extra[k] for k in which.tolist()], multi
        )

    def taken(which, groups, rows, offsets, ring_offsets):
        ring, ring_offsets = take(ring_offsets, groups)
        row, offsets = take(offsets, ring)
        return polygons(which, rows[row], offsets, ring_offsets)

    def unions(which):
        own = items.part[which]
        size = made.last[own] - made.first[own]
        lo = 0
        for rows, offsets, ring_offsets in merged_parts(
            problem.prepared.polygons, carved.walk, nested.selection.selected, carved.tree, parts,
            made.leaf[ranges(made.first[own], size)], offsets_of(size),
        ):
            hi = lo + len(ring_offsets) - 1
            yield from polygons(which[lo:hi], rows, offsets, ring_offsets)
            lo = hi

    kind = np.where(items.whole >= 0, 0, np.where(items.part < len(parts.area), 1, 2))
    whole, finest, merged = (np.flatnonzero(kind == k) for k in range(3))
    of_kind = (
        taken(whole, items.whole[whole], np.arange(len(rings.coords)), rings.offsets, rings.polygon_offsets),
        taken(finest, items.part[finest], parts.rows, parts.offsets, parts.ring_offsets),
        unions(merged),
    )
    for k in kind.tolist():
        yield next(of_kind[k])
