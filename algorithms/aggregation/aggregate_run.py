"""What ``isthmus:aggregate`` runs."""

from __future__ import annotations

import contextlib
import gc
from typing import Any

import numpy as np
from qgis.core import (
    NULL,
    QgsFeatureRequest,
    QgsFields,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingUtils,
    QgsWkbTypes,
)

from ...core.aggregation.areas import beside, flaws, piece_fields, posed, reasons_of
from ...core.aggregation.coverage import joined
from ...core.aggregation.exact import FEW
from ...core.aggregation.instance import components, costs
from ...core.aggregation.methods import by_method
from ...core.aggregation.outcome import balance, outcome
from ...core.aggregation.presets import PRESETS
from ...core.aggregation.tables import distances, thresholds
from ...core.errors import Cancelled, IsthmusError, Sentence
from ..base import amount, counted
from ..layers import wkb
from ..layers.fields import LONG, make_fields
from ..layers.sinks import Sinks
from ..layers.source import Reader, shapeless
from ..layers.styles import style_on_load
from ..words import as_sentence, spoken, tr
from . import areas as layer
from . import report, style
from .aggregate import ASSIGNED_FIELDS, REGION_FIELDS, AggregateAlgorithm
from .areas_tool import field_index


def aggregate(
    tool: AggregateAlgorithm,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    feedback: QgsProcessingFeedback,
) -> dict[str, Any]:
    """Run `isthmus:aggregate`; return its results."""
    source = tool.source(parameters, context)
    run = _Run(tool, parameters, context, feedback, source)
    with _uncollected():
        run.read()
    if feedback.isCanceled():
        return {}
    with _uncollected() if run.choice(tool.METHOD) == "greedy" else contextlib.nullcontext():
        found, bound = run.solve()
    if found is None:
        return {}
    with _uncollected(), Sinks(tool, parameters, context, feedback) as sinks:
        results = run.write(found, sinks)
        run.report(found, results, sinks)
    if feedback.isCanceled():  # it has been removed
        results.pop(tool.REPORT, None)
    results.update(sinks.destinations)
    style_on_load(context, sinks.destinations.get(tool.OUTPUT), "regions.qml", dress=run.legend)
    cost = costs(run.problem, found)
    size = float(np.sum(run.areas.size))
    results.update(
        {
            tool.TOTAL_COST: cost.total,
            tool.CHANGE_COST: cost.change,
            tool.BOUNDARY_COST: cost.boundary,
            tool.CENTRE_COST: cost.centre,
            tool.CHANGED_SHARE: cost.changed_size / size if size else 0.0,
        }
    )
    feedback.pushInfo(
        tr(
            "Cost {}: class change {}, boundary {}, centre distance {}. {}; {:.2f} % of the area changed its "
            "class."
        ).format(
            amount(cost.total),
            amount(cost.change),
            amount(cost.boundary),
            amount(cost.centre),
            counted(results[tool.REGION_COUNT], "region"),
            100 * results[tool.CHANGED_SHARE],
        )
    )
    if bound is not None:
        # where large areas must be cores, an exchange of cores afterwards may cost less than the bound
        results[tool.LOWER_BOUND] = float(min(bound, cost.total))
    return results


@contextlib.contextmanager
def _uncollected():
    """A few seconds in which Python does not search for cycles of garbage.

    Each search walks over all features again, and there are none to find: with 55,191 areas that was a
    sixth of the time.
    """
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def _region_fields(class_field):
    """Fields of the regions; where the class has one of their names, theirs gets a number."""
    own = QgsFields()
    own.append(class_field)
    names = QgsProcessingUtils.combineFields(own, make_fields(REGION_FIELDS)).names()[1:]
    own = make_fields(((names[0], LONG),))
    own.append(class_field)
    for field in make_fields([(name, kind) for name, (_, kind) in zip(names[1:], REGION_FIELDS[1:])]):
        own.append(field)
    return own


@contextlib.contextmanager
def _told():
    """Make what the core says an error of the tool."""
    try:
        yield
    except IsthmusError as problem:
        raise QgsProcessingException(as_sentence(spoken(problem.sentence))) from None


def _rows(source, parameter, wanted):
    """Values of some fields of a table, whatever their case; complains of a field it lacks."""
    if source is None:
        return
    names = [field.name().lower() for field in source.fields()]
    lacking = [name for name in wanted if name not in names]
    if lacking:
        raise QgsProcessingException(
            tr("The table {} has no field {}. It has: {}.").format(
                parameter, ", ".join(lacking), ", ".join(names)
            )
        )
    index = [names.index(name) for name in wanted]
    for feature in source.getFeatures(QgsFeatureRequest()):
        values = feature.attributes()
        yield tuple(None if values[k] == NULL else values[k] for k in index)


class _Run:
    """One run of the tool."""

    def __init__(self, tool, parameters, context, feedback, source):
        self.tool, self.parameters, self.context = tool, parameters, context
        self.feedback, self.source = feedback, source
        self.class_index = self.field(tool.CLASS)
        self.class_field = source.fields()[self.class_index]
        self.id_index = self.field(tool.AREA_ID, needed=False)
        self.size_index = -1
        found, size = piece_fields(source.fields().names())
        if self.id_index < 0 and found >= 0:
            self.id_index = found
            feedback.pushInfo(
                tr("The field {} tells which pieces belong to one area.").format(
                    source.fields()[found].name()
                )
            )
        if self.id_index == found:
            self.size_index = size

    def number(self, name):
        return self.tool.parameterAsDouble(self.parameters, name, self.context)

    def choice(self, name):
        return self.tool.parameterAsString(self.parameters, name, self.context)

    def weights(self):
        """The weights of the three costs: what is given, else that of the named set."""
        tool = self.tool
        names = (tool.WEIGHT_CHANGE, tool.WEIGHT_BOUNDARY, tool.WEIGHT_CENTRE)
        return [
            value if self.parameters.get(name) is None else self.number(name)
            for name, value in zip(names, PRESETS[self.choice(tool.WEIGHTS)])
        ]

    def field(self, name, needed=True):
        return field_index(self.tool, self.parameters, self.context, self.source, name, needed)

    def read(self):
        """Read the layer and the tables into a problem."""
        tool, feedback = self.tool, self.feedback
        crs = self.source.sourceCrs()
        self.reader = Reader(self.source, feedback, keep=True)
        feedback.setProgressText(tr("Reading the areas"))
        areas = self.areas = layer.read(self.reader, crs)
        layer.tell_scale(feedback, crs, areas.coverage.xy, self.context)
        feedback.setProgressText(tr("Finding shared boundaries"))
        texts = layer.texts(areas.features, self.class_index)
        self.reason = reasons_of(areas, texts, [shapeless(one) for one in areas.features])
        invalid, overlaps = flaws(areas)
        self._tell_invalid(set(invalid.tolist()) - set(self.reason))
        layer.tell_overlaps(feedback, areas.features, overlaps)
        self._tell_left()
        self.classes = sorted({one for one in texts if one is not None})
        if not self.classes and not feedback.isCanceled():
            feedback.pushWarning(tr("No area has a class: there is nothing to aggregate."))
        with _told():
            self.problem = posed(
                areas,
                texts,
                self.classes,
                list(self.reason),
                self._thresholds(),
                self._distances(),
                self.weights(),
                self.choice(tool.BOUNDARY) == "classes",
            )

    def _thresholds(self):
        """The smallest size of a region of each class."""
        tool, parameters, context = self.tool, self.parameters, self.context
        source = tool.parameterAsSource(parameters, tool.THRESHOLDS, context)
        text = tool.parameterAsString(parameters, tool.EXCLUDED, context) or ""
        theta, absent = thresholds(
            self.classes,
            self.number(tool.THRESHOLD),
            table=_rows(source, "THRESHOLDS", ("class", "threshold")),
            excluded=filter(None, (part.strip() for part in text.split(","))),
        )
        for one in absent:
            self.feedback.pushInfo(tr("The excluded class {} is not on the map.").format(one))
        return theta

    def _distances(self):
        """The distance of each class to each other."""
        tool, parameters, context = self.tool, self.parameters, self.context
        kind, table = self.choice(tool.DISTANCE), ()
        if kind == "table":
            source = tool.parameterAsSource(parameters, tool.DISTANCES, context)
            if source is None:
                raise QgsProcessingException(tool.invalidSourceError(parameters, tool.DISTANCES))
            table = _rows(source, "DISTANCES", ("from", "to", "distance"))
        elif parameters.get(tool.DISTANCES):
            self.feedback.pushWarning(
                tr(
                    "The table of class distances (DISTANCES) is not used, since DISTANCE is {}. To use it, "
                    "choose table."
                ).format(kind)
            )
        matrix, one_way = distances(self.classes, kind, table)
        if one_way:
            self.feedback.pushInfo(
                tr(
                    "{} class distances are listed in one direction only; the other way they are taken as "
                    "equal."
                ).format(one_way)
            )
        return matrix

    def _tell_left(self, most=20):
        """Warn of areas that are left as they are."""
        for k, reason in list(self.reason.items())[:most]:
            self.feedback.pushWarning(
                tr("Area {} is left as it is: {}.").format(self.areas.features[k].id(), spoken(reason))
            )
        if len(self.reason) > most:
            self.feedback.pushWarning(
                tr("... and {} more; see the field status.").format(len(self.reason) - most)
            )

    def _tell_invalid(self, numbers, most=10):
        """Warn of areas that are not valid."""
        if numbers:
            ids = [str(self.areas.features[k].id()) for k in sorted(numbers)]
            self.feedback.pushWarning(
                tr(
                    "Not valid (an outline crosses itself, for one): {}, {}{}. Their sizes and neighbours "
                    "may be wrong. Run Fix geometries on the layer first."
                ).format(counted(len(ids), "area"), ", ".join(ids[:most]), " ..." * (len(ids) > most))
            )

    def solve(self):
        """Return the regions and, of the exact method, a lower bound; (None, None) if cancelled."""
        tool, feedback, problem = self.tool, self.feedback, self.problem
        method, seconds = self.choice(tool.METHOD), self.number(tool.SECONDS)
        count = int(self.number(tool.REGIONS)) or None
        shapeless = len(problem.size) - len(set(self.areas.owner.tolist()))
        if count:  # for the core, an area without a geometry is a region, too
            count += shapeless

        def check(share):
            if feedback.isCanceled():
                raise Cancelled("cancelled")
            if share is not None:
                feedback.setProgress(100.0 * share)

        feedback.setProgressText(tr("Aggregating {} ({})").format(counted(len(problem.size), "area"), method))
        decompose = tool.parameterAsBoolean(self.parameters, tool.DECOMPOSE, self.context)
        try:
            found, result, islands = by_method(
                problem,
                method,
                seed=int(self.number(tool.SEED)),
                iterations=int(self.number(tool.ITERATIONS)),
                seconds=seconds,
                count=count,
                decompose=decompose,
                check=check,
            )
        except Cancelled:
            return None, None
        if islands:
            feedback.pushInfo(
                tr("Solved by the exact method, since they have at most {} areas: {}.").format(
                    FEW, counted(islands, "independent part")
                )
            )
        if result:
            self._tell_gap(result, decompose)
            if count:
                feedback.pushWarning(tr("The number of regions is not used by the exact method."))
        elif count and len(found.core) != count:
            feedback.pushWarning(
                tr(
                    "{} regions were wanted, and {} is as near as thresholds and neighbours allowed by "
                    "merging and splitting single regions."
                ).format(count - shapeless, len(found.core) - shapeless)
            )
        return found, result and result.bound

    def _tell_gap(self, result, decompose):
        total = costs(self.problem, result.found).total
        gap = max(0.0, 1.0 - result.bound / total) if total else 0.0
        if decompose:
            said = tr(
                "No solution in which every area that is large enough by itself is a core costs less than {}"
            )
        else:
            said = tr("No solution costs less than {}")
        said = said.format(amount(result.bound))
        if result.large:
            said = tr("Too large to be solved, and left as annealing found it: {}. {}").format(
                counted(result.large, "independent part"), said
            )
        elif not result.proven:
            said = tr("The time was over. {}").format(said)
        self.feedback.pushInfo(
            tr("{} (gap {:.2f} %; {}, {} solved).").format(
                said,
                100 * gap,
                counted(result.parts, "independent part"),
                counted(result.rounds, "programme"),
            )
        )

    def write(self, found, sinks):
        """Write the layers; return the numbers."""
        tool, areas = self.tool, self.areas
        shaped = np.zeros(len(areas.features), dtype=bool)
        shaped[areas.owner] = True
        self.sources = self._sources()
        out = outcome(self.problem, found, shaped, self.sources, self.reason)
        label = np.where(shaped, found.region, -1)
        shapes = joined(areas.coverage, label[areas.owner])
        merged_shapes = joined(areas.coverage, out.merged[areas.owner])

        # several polygons for one feature: of multipart areas, or where overlaps must be united
        wkb_type = self.reader.wkb_type
        united = sum(len(group) > 1 and r not in shapes for r, group in enumerate(out.members))
        united += len(set(out.merged[out.merged >= 0].tolist()) - set(merged_shapes))
        if united or any(len(one) > 1 for one in (*shapes.values(), *merged_shapes.values())):
            wkb_type = QgsWkbTypes.multiType(wkb_type)
        written = self._regions(found, out, shapes, wkb_type, sinks)
        self._report_small(out, found)
        self._assignment(found, out, merged_shapes, wkb_type, sinks)
        return {
            tool.REGION_COUNT: written,
            tool.TOO_SMALL_COUNT: len(out.small),
            tool.SKIPPED_COUNT: len(self.reason),
        }

    def _regions(self, found, out, shapes, wkb_type, sinks):
        """Write the regions; return their number."""
        tool = self.tool
        multi, extra = QgsWkbTypes.isMultiType(wkb_type), wkb.dimensions(wkb_type)
        sinks.open(tool.OUTPUT, _region_fields(self.class_field), wkb_type, self.source.sourceCrs())
        written = 0
        for r, group in enumerate(out.members):
            if not group:
                continue
            core = self.areas.features[int(found.core[r])]
            geometry = self._shape(group, shapes.get(r), extra, multi)
            values = [
                r + 1,
                core.attributes()[self.class_index],
                float(out.size[r]),
                len({self.sources[k] for k in group}),
                core.id(),
                out.faults.get(r, ""),
            ]
            sinks.add(tool.OUTPUT, geometry, values, Sentence("region {}", r + 1))
            written += 1
        return written

    def report(self, found, results, sinks):
        """Tell which areas lost their class, and write the report if one is wanted."""
        tool = self.tool
        made = balance(self.problem, found, self.sources, self.classes)
        lost, many = (sum(row[k] for row in made.lost) for k in (1, 2))
        results[tool.LOST_COUNT] = lost
        self._tell_lost(made, lost, many)
        path = tool.parameterAsFileOutput(self.parameters, tool.REPORT, self.context)
        if not path or self.feedback.isCanceled():
            return
        weights = [f"{weight:g}" for weight in self.weights()]
        theta, least = self.problem.theta, self.number(tool.THRESHOLD)
        intro = [
            tr("{} in {}, by {}.").format(
                counted(len(self.problem.size), "area"),
                counted(results[tool.REGION_COUNT], "region"),
                self.choice(tool.METHOD),
            ),
            tr("Weights: class change {}, boundary {}, centre distance {}.").format(*weights),
            tr("Minimum size: {} square metres; of some classes another.").format(amount(least))
            if (theta[np.isfinite(theta)] != least).any()
            else tr("Minimum size: {} square metres.").format(amount(least)),
        ]
        sinks.write_text(
            path, report.page(tr("Aggregation of {}").format(self.source.sourceName()), intro, made)
        )
        results[tool.REPORT] = path

    def _tell_lost(self, made, lost, many, most=20):
        """Tell which large areas lost their class, and which classes all of their areas."""
        if many:
            some = [tr("{}: {} of {}").format(name, gone, of) for name, gone, of in made.lost if gone]
            self.feedback.pushInfo(
                tr("Areas above half of the minimum size that lost their class: {} of {}{}.").format(
                    lost, many, f" ({'; '.join(some[:most])}{'; ...' * (len(some) > most)})" * bool(some)
                )
            )
        unwanted = np.isinf(self.problem.theta)
        gone = [
            tr("{} ({}, {} ha)").format(name, counted(areas, "area"), amount(size / 1e4))
            for (name, areas, size, regions, _), excluded in zip(made.classes, unwanted.tolist())
            if not regions and not excluded
        ]
        if gone:
            self.feedback.pushInfo(
                tr("Classes without any region: {}{}.").format(
                    ", ".join(gone[:most]), ", ..." * (len(gone) > most)
                )
            )

    def legend(self, regions):
        """Give the layer of regions a legend, with a colour for each class of the map."""
        values = [feature.attribute(self.class_index) for feature in self.areas.features]
        style.by_class(regions, _region_fields(self.class_field)[1].name(), values)

    def _sources(self):
        """What identifies the area of each feature: pieces of one area have the same."""
        if self.id_index < 0:
            return list(range(len(self.areas.features)))
        ids = layer.texts(self.areas.features, self.id_index)
        return [k if one is None else one for k, one in enumerate(ids)]

    def _shape(self, group, polygons, extra, multi):
        """Geometry of the areas of a region; of a single one its own, as it is."""
        if len(group) == 1:
            geometry = layer.with_dimensions(self.areas.features[group[0]].geometry(), self.reader.wkb_type)
            if multi:
                geometry.convertToMultiType()
            return geometry
        if polygons is None:
            return layer.union([self.areas.features[k].geometry() for k in group])
        return layer.joined_geometry(self.areas, polygons, extra, multi)

    def _report_small(self, out, found, most=20):
        small, size, faults = out.small, out.size, out.faults
        # an area that is left as it is has a region of its own, which says nothing about the threshold
        taking = sum(core not in self.reason for core in found.core.tolist())
        if len(small) == taking > 0:
            self.feedback.pushWarning(
                tr(
                    "No region reaches its minimum size: is the threshold larger than the map? Those that "
                    "hang together by shared boundaries have {} square metres at most."
                ).format(amount(self._largest()))
                if np.isfinite(self.problem.theta[:-1]).any()
                else tr("No region may have a class of the map: all of them are excluded.")
            )
            most = 0
        for r in small[:most]:
            core = self.areas.features[int(found.core[r])]
            said = tr("Region {} around area {} ({} square metres) could not be helped: {}.").format(
                r + 1, core.id(), amount(size[r]), spoken(faults[r])
            )
            if faults[r] == "too small":
                said += " " + tr("It has no neighbours that would make it large enough.")
            self.feedback.pushWarning(said)
        if len(small) > most > 0:
            self.feedback.pushWarning(tr("... and {} more; see the field status.").format(len(small) - most))
        self._tell_beside(np.isin(found.region, [r for r in small if faults[r] == "too small"]), found)

    def _largest(self):
        """The size of the areas that hang together, the most; not of those that are left as they are."""
        size = self.problem.size.copy()
        size[list(self.reason)] = 0.0
        return np.bincount(components(self.problem), weights=size).max(initial=0.0)

    def _tell_beside(self, wanted, found):
        """Say where areas are too small because a gap or an overlap keeps them from their neighbours."""
        if not wanted.any():
            return
        label = components(self.problem)
        label[list(self.reason)] = -1
        pairs = beside(self.areas, label, wanted)
        if len(pairs):
            a, b = (self.areas.features[k].id() for k in pairs[0].tolist())
            self.feedback.pushWarning(
                tr(
                    "Beside another area, but with no boundary in common because of a gap or an overlap: {}, "
                    "such as area {} beside area {}. Gaps may be too narrow to be seen. Close them first, by "
                    "v.clean or Snap geometries to layer."
                ).format(counted(len(set(found.region[pairs[:, 0]].tolist())), "region"), a, b)
            )

    def _assignment(self, found, out, shapes, wkb_type, sinks):
        """Write the areas with their regions, the pieces of one area that ended in one as one."""
        tool, areas = self.tool, self.areas
        new_class = type(self.class_field)(self.class_field)
        new_class.setName("new_class")
        added = make_fields(ASSIGNED_FIELDS[:1])
        added.append(new_class)
        for one in make_fields(ASSIGNED_FIELDS[1:]):
            added.append(one)
        own = QgsProcessingUtils.combineFields(self.source.fields(), added)
        if not sinks.open(tool.ASSIGNMENT, own, wkb_type, self.source.sourceCrs(), False):
            return
        multi, extra = QgsWkbTypes.isMultiType(wkb_type), wkb.dimensions(wkb_type)
        for number, ((_, r), group) in enumerate(out.groups.items()):
            first = areas.features[group[0]]
            values = first.attributes()
            if len(group) > 1 and self.size_index >= 0:
                values[self.size_index] = float(areas.size[group].sum())
            if r is None or group[0] in self.reason:
                region = NULL if r is None else r + 1
                values += [region, values[self.class_index], 0, self.reason.get(group[0], "")]
            else:
                core = int(found.core[r])
                kept = areas.features[core].attributes()[self.class_index]
                changed = int(self.problem.cls[core] != self.problem.cls[group[0]])
                values += [r + 1, kept, changed, out.faults.get(r, "")]
            if r is None:
                geometry = first.geometry()
            else:
                geometry = self._shape(group, shapes.get(number), extra, multi)
            sinks.add(tool.ASSIGNMENT, geometry, values, Sentence("area {}", first.id()))
