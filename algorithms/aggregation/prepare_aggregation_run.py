"""What ``isthmus:prepareaggregation`` runs."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingUtils,
    QgsWkbTypes,
)

from ...core import wkb as core_wkb
from ...core.aggregation.areas import arrange_pieces, joined_rings, neighbours
from ...core.aggregation.coverage import each_pair, faults
from ...core.errors import Cancelled, Sentence
from ...core.partition.features import pieces, weigh_by_length, without_vertex
from ...core.partition.solve import finish, select
from ...core.progress import checker
from ...core.rings import Rings, offsets_of
from ..base import counted
from ..layers import wkb
from ..layers.fields import make_fields
from ..layers.sinks import Sinks
from ..layers.source import Reader
from ..layers.styles import style_on_load
from ..partition.cutting import BY_LENGTH, NATURAL
from ..partition.cutting_run import report_short
from ..partition.solving import Settings, measure_of, prepare, read, reasons_of
from ..words import spoken, tr
from . import areas as layer
from .areas_tool import field_index
from .prepare_aggregation import PAIR_FIELDS, PIECE_FIELDS, PrepareAggregationAlgorithm


def prepare_aggregation(
    tool: PrepareAggregationAlgorithm,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    feedback: QgsProcessingFeedback,
) -> dict[str, Any]:
    """Run `isthmus:prepareaggregation`; return its results."""
    source = tool.source(parameters, context)
    with Sinks(tool, parameters, context, feedback) as sinks:
        numbers = _prepare(tool, parameters, context, feedback, source, sinks)
    style_on_load(context, sinks.destinations.get(tool.OUTPUT), "parts.qml")
    return {**sinks.destinations, **numbers} if numbers else {}


def _prepare(tool, parameters, context, feedback, source, sinks):
    """Cut the areas, write the pieces and the table; return the numbers, none if cancelled."""
    class_index = field_index(tool, parameters, context, source, tool.CLASS)
    crs, reader = source.sourceCrs(), Reader(source, feedback)
    own = QgsProcessingUtils.combineFields(source.fields(), make_fields(PIECE_FIELDS))
    sinks.open(tool.OUTPUT, own, reader.wkb_type, crs)
    with_table = sinks.open(
        tool.ADJACENCY, make_fields(PAIR_FIELDS), QgsWkbTypes.Type.NoGeometry,
        QgsCoordinateReferenceSystem(), False,
    )  # fmt: skip
    objective = tool.parameterAsEnumString(parameters, tool.OBJECTIVE, context)
    settings = Settings(
        measure=measure_of(crs),
        natural=tool.parameterAsEnumString(parameters, tool.PLACES, context) == NATURAL,
        floors=tool.floors(parameters, context, source),
        lines=None,
        new_vertices=tool.parameterAsBoolean(parameters, tool.NEW_VERTICES, context),
        weigh=weigh_by_length if objective == BY_LENGTH else None,
        all_dilations=False,
    )
    tau = tool.parameterAsDouble(parameters, tool.TAU, context)

    try:
        cut = _cut(reader, class_index, settings, tau, feedback)
    except Cancelled:
        return {}
    skipped = _tell_skipped(cut, feedback)
    if feedback.isCanceled():
        return {}

    feedback.setProgressText(tr("Finding shared boundaries"))
    found, rings, grown = arrange_pieces(cut.rings, cut.is_new, settings.measure, layer.metres_of(crs))
    layer.tell_scale(feedback, crs, found.coverage.xy, context)
    sinks.add_all(tool.OUTPUT, _pieces(reader.wkb_type, cut, rings, found.size, grown))
    empty = list(_without_pieces(cut))
    sinks.add_all(tool.OUTPUT, empty)
    if with_table:
        sinks.add_all(tool.ADJACENCY, _pairs(cut, *neighbours(found)))

    wrong = faults(found.coverage)
    overlaps = each_pair(cut.area[wrong.overlaps])
    _report(feedback, cut.features, overlaps, wrong.gaps, cut.classless)
    report_short(feedback, cut.short)
    return {
        tool.AREA_COUNT: len(cut.features),
        tool.PIECE_COUNT: len(cut.area) + len(empty),
        tool.SKIPPED_COUNT: skipped,
        tool.OVERLAP_COUNT: len(overlaps),
        tool.GAP_COUNT: len(wrong.gaps),
    }


class _Cut(NamedTuple):
    """The areas, and the pieces that they were cut into.

    features : list of QgsFeature
        The areas; those that were cut have lost their geometry.
    area : (q,) int
        The area of each piece, ascending.
    verdict : (q,) object
        For each piece '', or why its polygon was not cut.
    rings : Rings
    is_new : (k,) bool
        Which of their rows are new vertices.
    classless, short : int
        Areas without a class, and edges where a cut is missing for want of a vertex.
    """

    features: list
    area: np.ndarray
    verdict: np.ndarray
    rings: Rings
    is_new: np.ndarray
    classless: int
    short: int

    @property
    def bounds(self):
        """List of int: where the pieces of each area begin, and where those of the last one end."""
        return offsets_of(np.bincount(self.area, minlength=len(self.features))).tolist()


def _cut(reader, class_index, settings, tau, feedback):
    """Cut the areas, chunk by chunk; may raise Cancelled."""
    check = checker(reader.progress, feedback.isCanceled)
    kept, classless, short = [], 0, 0
    area, verdict, rings, is_new = [], [], [], []
    for features in reader.chunks():
        for feature in features:
            classless += layer.text(feature.attributes()[class_index]) is None
            feature.setGeometry(layer.with_dimensions(feature.geometry(), reader.wkb_type))
        for chunk in read(features, settings, feedback):
            problem = prepare(chunk, settings, check)
            selection = select(problem.prepared, tau, weight=problem.weight, check=check, with_dilation=False)
            short += without_vertex(problem, selection, np.full(len(chunk.features), tau))
            found = pieces(problem, finish(problem.prepared, selection, check=check).parts)
            coords = problem.chunk.rings.coords
            area.append(chunk.owner[found.polygon] + len(kept))
            verdict.append(problem.verdict[found.polygon])
            rings.append(Rings(coords[found.rows], found.offsets, found.ring_offsets))
            is_new.append(found.rows >= len(chunk.rings.coords))
            # others may come out as they came
            for number in np.setdiff1d(chunk.owner, chunk.owner[problem.verdict != ""]).tolist():
                chunk.features[number].clearGeometry()  # of 55,191 areas 0.03 GB
            kept += chunk.features
    return _Cut(
        features=kept,
        area=np.concatenate([np.empty(0, dtype=np.int64), *area]),
        verdict=np.concatenate([np.empty(0, dtype=object), *verdict]),
        rings=joined_rings(rings),
        is_new=np.concatenate([np.empty(0, dtype=bool), *is_new]),
        classless=classless,
        short=short,
    )


def _tell_skipped(cut, feedback):
    """Tell which areas were not cut, or not all of them, and why; return how many."""
    skipped, bounds = 0, cut.bounds
    for feature, lo, hi in zip(cut.features, bounds[:-1], bounds[1:]):
        problems = reasons_of(feature, cut.verdict[lo:hi])
        if problems:
            skipped += 1
            feedback.pushWarning(
                tr("Area {} was not cut: {}.").format(feature.id(), "; ".join(map(spoken, problems)))
            )
    return skipped


def _pieces(wkb_type, cut, rings, size, grown):
    """Geometry and values of each piece, numbered from 1, and which area it is of."""
    multi, bounds = QgsWkbTypes.isMultiType(wkb_type), cut.bounds
    geometries = core_wkb.polygons(
        rings.coords,
        np.arange(len(rings.coords)),
        rings.offsets,
        rings.polygon_offsets,
        [wkb.dimensions(wkb_type)] * len(cut.area),
        multi,
    )
    before = -1  # the pieces of an area stand together
    for k, (number, reason, own_size, geometry) in enumerate(
        zip(cut.area.tolist(), cut.verdict.tolist(), size.tolist(), geometries)
    ):
        if number != before:
            feature, before = cut.features[number], number
            attributes, origin = _of_area(feature)
        if reason and bounds[number + 1] - bounds[number] == 1 and not grown[k]:
            # as it came, even with a ring that is not closed
            own = feature.geometry()
            if not QgsWkbTypes.isCurvedType(own.wkbType()):
                geometry = own
                if multi:
                    geometry.convertToMultiType()
        yield geometry, [*attributes, k + 1, own_size, reason], origin


def _without_pieces(cut):
    """The same of the areas that have none."""
    for number in np.flatnonzero(np.diff(cut.bounds) == 0).tolist():
        feature = cut.features[number]
        attributes, origin = _of_area(feature)
        (reason,) = reasons_of(feature, ())
        yield feature.geometry(), [*attributes, layer.NULL, 0.0, reason], origin


def _of_area(feature):
    return [*feature.attributes(), feature.id()], Sentence("area {}", feature.id())


def _pairs(cut, pairs, length):
    """The rows of the table of neighbours."""
    virtual = (cut.area[pairs[:, 0]] == cut.area[pairs[:, 1]]).astype(int)
    for (a, b), shared, same in zip(pairs.tolist(), length.tolist(), virtual.tolist()):
        yield None, [a + 1, b + 1, shared, same], ""


def _report(feedback, kept, overlaps, gaps, classless, most=10):
    """Tell what is wrong with the coverage."""
    layer.tell_overlaps(feedback, kept, overlaps)
    if len(gaps):
        some = ", ".join(f"({x:.10g} {y:.10g})" for x, y in gaps[:most].tolist())
        feedback.pushWarning(
            tr(
                "{} inside the map without an area, at {}{}. Areas on both sides of a gap are no neighbours "
                "there."
            ).format(counted(len(gaps), "gap"), some, " ..." * (len(gaps) > most))
        )
    if classless:
        feedback.pushWarning(
            tr("Without a class: {}. Aggregation will leave such areas as they are.").format(
                counted(classless, "area")
            )
        )
