"""What ``isthmus:hierarchy`` runs."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import Any

import numpy as np
from qgis.core import NULL, QgsProcessingContext, QgsProcessingFeedback, QgsProcessingUtils, QgsWkbTypes

from ...core import wkb as core_wkb
from ...core.errors import Cancelled
from ...core.partition.features import without_vertex
from ...core.partition.nesting import NO_END, cuts, items_of, nest, shapes
from ...core.progress import stretch
from ..base import counted
from ..layers import wkb
from ..layers.fields import make_fields
from ..layers.sinks import Sinks
from ..layers.source import Reader
from ..layers.styles import style_on_load
from ..words import tr
from .cutting_run import Told
from .hierarchy import LEVEL_FIELDS, RANKED_FIELDS, HierarchyAlgorithm
from .solving import problems, settings_of


def run(
    tool: HierarchyAlgorithm,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    feedback: QgsProcessingFeedback,
) -> dict[str, Any]:
    """Run `isthmus:hierarchy`; return its results."""
    source = tool.source(parameters, context)
    reader = Reader(source, feedback)
    tau_of = tool.dynamic(parameters, tool.TAU, context, source)
    parts_of = None
    if parameters.get(tool.PARTS) is not None:
        parts_of = tool.dynamic(parameters, tool.PARTS, context, source)
    with Sinks(tool, parameters, context, feedback) as sinks:
        writer = _Writer(tool, source, reader.wkb_type, sinks)
        settings = settings_of(tool, parameters, context, source, feedback)
        with suppress(Cancelled):
            for problem, check in problems(reader, settings, feedback, 0.4):
                tau, parts = (
                    of and np.array([of(feature) for feature in problem.chunk.features], dtype=float)
                    for of in (tau_of, parts_of)
                )
                nested = nest(problem, tau, count=parts, check=stretch(check, 0.0, 2 / 3))
                writer.told.short += without_vertex(problem, nested.selection, nested.tau)
                writer.write(problem, nested, feedback, stretch(check, 2 / 3, 1.0))
    writer.report(feedback)
    destinations = sinks.destinations
    style_on_load(context, destinations.get(tool.CUTS), "hierarchy_cuts.qml", 0)
    style = "hierarchy_parts.qml" if parts_of is None else "parts.qml"
    style_on_load(context, destinations.get(tool.OUTPUT), style, 3)
    return {**destinations, **writer.numbers, tool.SKIPPED_COUNT: writer.told.skipped}


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

        self.sinks.add_all(tool.OUTPUT, self._items(problem, nested, items, feedback, check))
        if self.with_cuts:
            self.sinks.add_all(tool.CUTS, self._cuts(problem, nested))

    def _items(self, problem, nested, items, feedback, check):
        """Geometry and values of each part of each level, and the id of its feature."""
        chunk, tool = problem.chunk, self.tool
        count = len(chunk.features)
        geometries = _geometries(problem, nested, items, self.multi)
        bounds = np.searchsorted(items.feature, np.arange(count + 1)).tolist()
        values = list(zip(*(x.tolist() for x in (
            items.number, items.parent, items.level, items.from_tau, items.to_tau
        ))))  # fmt: skip
        verdicts = np.where(items.whole >= 0, problem.verdict[items.whole], "").tolist()
        for f, feature in enumerate(chunk.features):
            lo, hi = bounds[f], bounds[f + 1]
            text = self.told.reason(feature, verdicts[lo:hi], feedback)
            attributes, number = feature.attributes(), feature.id()
            if all(verdicts[lo:hi]):  # nothing solved: the feature as it is
                for _ in range(lo, hi):
                    next(geometries)
                more = [1, NULL, 0, float(nested.tau[f]), NO_END, number, text]
                yield feature.geometry(), attributes + more, number
                self.numbers[tool.PART_COUNT] += 1
                continue
            for k in range(lo, hi):
                if k % 64 == 0:
                    check((f + (k - lo) / (hi - lo)) / count)
                part, parent, *rest = values[k]
                more = [part, parent or NULL, *rest, number, verdicts[k]]
                yield next(geometries), attributes + more, number
            self.numbers[tool.PART_COUNT] += hi - lo

    def _cuts(self, problem, nested):
        """Geometry and values of each cut, and the id of its feature, by feature and rank."""
        chunk = problem.chunk
        feature, edges, fields = cuts(problem, nested)
        feature = feature.tolist()
        rows, offsets = problem.prepared.way_rows(edges)
        geometries = core_wkb.lines(chunk.rings.coords, rows, [chunk.extra[f] for f in feature], offsets)
        columns = zip(*(x.tolist() for x in fields.values()))
        for f, geometry, (length, detour, *more) in zip(feature, geometries, columns):
            number = chunk.features[f].id()
            yield geometry, [number, length, detour if math.isfinite(detour) else NULL, *more], number

    def report(self, feedback):
        """Say in the log what was done."""
        if feedback.isCanceled():
            feedback.pushWarning(tr("Cancelled: the results are not complete."))
            return
        numbers, tool = self.numbers, self.tool
        feedback.pushInfo(
            tr("{} in at most {} of a feature, made by {}.").format(
                counted(numbers[tool.PART_COUNT], "part"),
                counted(self.most, "level"),
                counted(numbers[tool.CUT_COUNT], "cut"),
            )
        )
        more = ""
        if self.missed:
            more = tr(
                "{} cannot have so many or so few parts (PARTS), and got the next best number. A smaller TAU "
                "gives more cuts to choose from."
            ).format(counted(self.missed, "feature"))
        self.told.report(feedback, more)


def _geometries(problem, nested, items, multi):
    """Yield the geometry of each item."""
    chunk = problem.chunk
    extra = [chunk.extra[f] for f in items.feature.tolist()]

    def polygons(which, rows, offsets, ring_offsets):
        return core_wkb.polygons(
            chunk.rings.coords, rows, offsets, ring_offsets, [extra[k] for k in which.tolist()], multi
        )

    return shapes(problem, nested, items, polygons)
