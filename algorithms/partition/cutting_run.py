"""What the tools that cut polygons run: from chunks of a layer to parts, cuts and numbers."""

from __future__ import annotations

import math
from contextlib import suppress
from itertools import repeat
from typing import Any, Callable, Collection

import numpy as np
from qgis.core import (
    NULL,
    QgsFeature,
    QgsFeatureRequest,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingUtils,
    QgsUnitTypes,
    QgsWkbTypes,
)

from ...core import wkb as core_wkb
from ...core.errors import Cancelled
from ...core.partition.features import Problem, costs, cuts, pieces, without_vertex
from ...core.partition.solve import Partition, Prepared, Selection, finish
from ...core.progress import stretch
from ..base import counted, grouped
from ..layers import wkb
from ..layers.fields import make_fields
from ..layers.sinks import Sinks
from ..layers.source import WITHOUT_VALIDITY_CHECK, Reader
from ..layers.styles import style_on_load
from ..words import spoken, tr
from .cutting import CUT_FIELDS, DIAGONAL_FIELDS, PART_FIELDS, ROLES, CuttingTool
from .solving import degrees_of, problems, reasons_of, settings_of


def cut(
    tool: CuttingTool,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    feedback: QgsProcessingFeedback,
    chooser: Callable[..., Callable[[Problem, Callable], tuple[Selection, np.ndarray]]],
    extra_values: Callable[[Problem, Partition], list[list]] | None = None,
) -> dict[str, Any]:
    """Run a tool that cuts polygons; return its results.

    Parameters
    ----------
    tool : CuttingTool
    chooser : callable
        ``(tool, parameters, context, source, feedback)`` to the function that chooses the cuts:
        ``(problem, check)`` to a Selection and each tau.
    extra_values : callable, optional
        ``(problem, solution)`` to the values of the tool's ``extra_fields`` for each feature, a list each.
    """
    source = tool.source(parameters, context)
    reader = Reader(source, feedback)
    with Sinks(tool, parameters, context, feedback) as sinks:
        writer = _Writer(tool, source, reader.wkb_type, sinks, extra_values)
        settings = settings_of(
            tool, parameters, context, source, feedback, all_dilations=writer.with_diagonals
        )
        choose = chooser(tool, parameters, context, source, feedback)
        with suppress(Cancelled):
            for problem, check in problems(reader, settings, feedback, 0.5):
                selection, tau = choose(problem, stretch(check, 0.0, 0.4))
                writer.told.short += without_vertex(problem, selection, tau)
                solution = finish(
                    problem.prepared,
                    selection,
                    all_dilations=settings.all_dilations,
                    check=stretch(check, 0.4, 0.6),
                )
                writer.write(problem, solution, feedback, stretch(check, 0.6, 1.0))
        if tool.in_place and feedback.isCanceled():
            writer.pass_on(source)
        if settings.lines:
            settings.lines.report(feedback)
    writer.report(feedback)
    destinations = sinks.destinations  # layers that are loaded get their styles
    style_on_load(context, destinations.get(tool.CUTS), "cuts.qml", 0)
    style_on_load(context, destinations.get(tool.DIAGONALS), None, 1)
    style_on_load(context, destinations.get(tool.OUTPUT), "parts.qml", 3)
    return {**destinations, **writer.numbers, tool.SKIPPED_COUNT: writer.told.skipped}


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

    def __init__(self) -> None:
        self.small, self.holes, self.rules, self.short, self.skipped = 0, 0, [0] * 5, 0, 0

    def count(self, prepared: Prepared) -> None:
        """Count what was set aside in a chunk."""
        self.rules = [a + b for a, b in zip(self.rules, prepared.set_aside.sum(axis=0).tolist())]
        self.holes += int((~prepared.wanted[prepared.component]).sum())

    def reason(self, feature: QgsFeature, verdicts: Collection[str], feedback: QgsProcessingFeedback) -> str:
        """Return why a feature was not cut, or not all of it, and warn of it; '' where it was."""
        reasons = reasons_of(feature, verdicts) if not verdicts or any(verdicts) else ()
        if reasons:
            self.skipped += 1
            said = "; ".join(map(spoken, reasons))
            feedback.pushWarning(tr("Feature {} was not cut: {}.").format(feature.id(), said))
        return "; ".join(reasons)

    def report(self, feedback: QgsProcessingFeedback, more: str = "") -> None:
        """Say it; ``more`` before what was not cut."""
        feedback.pushInfo(self._set_aside())
        report_short(feedback, self.short)
        if more:
            feedback.pushInfo(more)
        if self.skipped:
            feedback.pushInfo(
                tr("Not cut: {}; see the field status of the parts.").format(counted(self.skipped, "feature"))
            )

    def _set_aside(self):
        """What did not count, by which rule, and what to change if that is not wanted."""
        small = tr("{} smaller than 1 per cent of the feature.").format(counted(self.small, "part"))
        _, below, *by_place = self.rules
        if not (self.holes or below or any(by_place)):
            return f"{small} {tr('If these are too many, set PLACES to Natural or raise SMALLEST_PART.')}"
        aside = tr(
            "Set aside: {} and {} with less on one side than SMALLEST_PART (or MIN_HOLE); {} where the "
            "outline is not concave or the polygon does not open up (PLACES). If you miss cuts, lower TAU or "
            "SMALLEST_PART, or set PLACES to Any; if there are too many, raise TAU."
        ).format(counted(self.holes, "hole"), counted(below, "diagonal"), grouped(sum(by_place)))
        return f"{small} {aside}"


class _Writer:
    """Writes what was solved, and counts it."""

    def __init__(self, tool, source, wkb_type, sinks, extra_values):
        self.tool, self.sinks, self.told, self.extra_values = tool, sinks, Told(), extra_values
        fields, crs = source.fields(), source.sourceCrs()
        self.multi = QgsWkbTypes.isMultiType(wkb_type)
        self.unit = "m" if degrees_of(crs) else QgsUnitTypes.toAbbreviatedString(crs.mapUnits())
        line_type = wkb.line_type(wkb_type)
        part_fields = QgsProcessingUtils.combineFields(fields, make_fields(PART_FIELDS + tool.extra_fields))
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
        chunk, tool = problem.chunk, self.tool
        found = pieces(problem, solution.parts)
        cost, bound, gap = costs(problem, solution)
        solved = problem.solved
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
        ids = [feature.id() for feature in chunk.features]
        self.sinks.add_all(
            tool.OUTPUT, self._parts(problem, solution, found, ids, cost, gap, feedback, check)
        )
        if self.with_cuts:
            self.sinks.add_all(tool.CUTS, self._cuts(problem, solution, found, ids))
        if self.with_diagonals:
            self.sinks.add_all(tool.DIAGONALS, self._diagonals(problem, solution, own, ids))

    def _parts(self, problem, solution, found, ids, cost, gap, feedback, check):
        """Geometry and values of each part, and the id of its feature."""
        chunk, tool = problem.chunk, self.tool
        geometries = core_wkb.polygons(
            chunk.rings.coords,
            found.rows,
            found.offsets,
            found.ring_offsets,
            [chunk.extra[f] for f in chunk.owner[found.polygon].tolist()],
            self.multi,
        )
        solved = np.bincount(problem.owner[problem.solved], minlength=len(chunk.features)) > 0
        verdicts = problem.verdict[found.polygon].tolist()
        bounds = found.feature_offsets.tolist()
        more = repeat([])
        if self.extra_values is not None:
            more = self.extra_values(problem, solution)
        values = zip(
            chunk.features, ids, bounds, bounds[1:], solved.tolist(), cost.tolist(), gap.tolist(), more
        )
        nothing = [NULL] * len(tool.extra_fields)
        for f, (feature, number, lo, hi, is_solved, *numbers, more) in enumerate(values):
            if f % 8 == 0:
                check(f / len(chunk.features))
            text = self.told.reason(feature, verdicts[lo:hi], feedback)
            attributes = feature.attributes()
            if is_solved:
                for k in range(lo, hi):
                    part = [k - lo + 1, hi - lo, verdicts[k], *numbers, number, *more]
                    yield next(geometries), attributes + part, number
                self.numbers[tool.PART_COUNT] += hi - lo
            else:  # nothing solved: the feature as it is
                for _ in range(lo, hi):
                    next(geometries)
                part = [1, 1, text, NULL, NULL, number, *nothing]
                yield feature.geometry(), attributes + part, number
                self.numbers[tool.PART_COUNT] += 1
            self.done += 1

    def pass_on(self, source):
        """Write the features that a cancelled run has not come to as they are: QGIS deletes all of them."""
        rest = [1, 1, "cancelled", NULL, NULL]
        for k, feature in enumerate(source.getFeatures(QgsFeatureRequest(), WITHOUT_VALIDITY_CHECK)):
            if k >= self.done:
                more = [*rest, feature.id(), *[NULL] * len(self.tool.extra_fields)]
                self.sinks.add(
                    self.tool.OUTPUT, feature.geometry(), feature.attributes() + more, feature.id()
                )

    def _cuts(self, problem, solution, found, ids):
        """Geometry and values of each cut, and the id of its feature."""
        chosen, fields = cuts(problem, solution, found)
        return self._lines(problem, solution, chosen, ids, map(_or_nulls, fields.values()))

    def _diagonals(self, problem, solution, own, ids):
        """The same of all candidates."""
        chosen = np.flatnonzero(own)
        fields = (_or_nulls(x[chosen]) for x in (solution.length, solution.detour, solution.dilation))
        roles = [ROLES[role] for role in solution.role[chosen].tolist()]
        return self._lines(problem, solution, chosen, ids, [*fields, roles])

    @staticmethod
    def _lines(problem, solution, chosen, ids, columns):
        chunk = problem.chunk
        feature = problem.owner[solution.owner[chosen]].tolist()
        rows, offsets = problem.prepared.way_rows(chosen)
        geometries = core_wkb.lines(chunk.rings.coords, rows, [chunk.extra[f] for f in feature], offsets)
        numbers = [ids[f] for f in feature]
        return zip(geometries, map(list, zip(numbers, *columns)), numbers)

    def report(self, feedback):
        """Say in the log what was done."""
        if feedback.isCanceled():
            feedback.pushWarning(tr("Cancelled: the results are not complete."))
            return
        tool, numbers = self.tool, self.numbers
        length = numbers[tool.CUT_LENGTH]
        text = f"{length:,.0f}" if length >= 100.0 else f"{length:.4g}"
        feedback.pushInfo(
            tr("{}, made by {} of {} in all. The largest detour left is {:.4g}.").format(
                counted(numbers[tool.PART_COUNT], "part"),
                counted(numbers[tool.CUT_COUNT], "cut"),
                f"{text} {self.unit}".strip(),
                numbers[tool.MAX_DILATION],
            )
        )
        self.told.report(feedback)


def report_short(feedback: QgsProcessingFeedback, short: int) -> None:
    """Say at how many places a cut is missing for want of a vertex."""
    if short:
        feedback.pushInfo(
            tr(
                "No vertex to end a cut at: {}, edges opposite a concave corner, where the way around is "
                "more than tau times as long as the way across. Set NEW_VERTICES to cut there."
            ).format(counted(short, "place"))
        )


def _or_nulls(values):
    """The values, with NULL for what is not finite."""
    if np.isfinite(values).all():
        return values.tolist()
    return [value if math.isfinite(value) else NULL for value in values.tolist()]
