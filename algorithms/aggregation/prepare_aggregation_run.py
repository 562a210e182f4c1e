"""What ``isthmus:prepareaggregation`` runs."""

import numpy as np
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsProcessingUtils,
    QgsWkbTypes,
)

from ...core.aggregation.areas import arrange_pieces, joined_rings, neighbours
from ...core.aggregation.coverage import faults
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
from .prepare_aggregation import PAIR_FIELDS, PIECE_FIELDS


def prepare_aggregation(tool, parameters, context, feedback):
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
    multi = QgsWkbTypes.isMultiType(reader.wkb_type)
    own = QgsProcessingUtils.combineFields(source.fields(), make_fields(PIECE_FIELDS))
    sinks.open(tool.OUTPUT, own, reader.wkb_type, crs)
    with_table = sinks.open(
        tool.ADJACENCY, make_fields(PAIR_FIELDS), QgsWkbTypes.Type.NoGeometry,
        QgsCoordinateReferenceSystem(), False,
    )  # fmt: skip
    tau = tool.parameterAsDouble(parameters, tool.TAU, context)
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

    check = checker(reader.progress, feedback.isCanceled)
    kept, cut, classless, short = [], [], 0, 0  # areas, and their pieces chunk by chunk
    try:
        for features in reader.chunks():
            for feature in features:
                classless += layer.text(feature.attributes()[class_index]) is None
                feature.setGeometry(layer.with_dimensions(feature.geometry(), reader.wkb_type))
            for chunk in read(features, settings, feedback):
                problem = prepare(chunk, settings, check)
                selection = select(
                    problem.prepared,
                    tau,
                    weight=problem.weight,
                    check=check,
                    with_dilation=False,
                )
                short += without_vertex(problem, selection, np.full(len(chunk.features), tau))
                parts = finish(problem.prepared, selection, check=check).parts
                found = pieces(problem, parts)
                coords = problem.chunk.rings.coords
                cut.append(
                    (
                        chunk.owner[found.polygon] + len(kept),
                        problem.verdict[found.polygon],
                        Rings(coords[found.rows], found.offsets, found.ring_offsets),
                        found.rows >= len(chunk.rings.coords),
                    )
                )
                # others may come out as they came
                for number in np.setdiff1d(chunk.owner, chunk.owner[problem.verdict != ""]).tolist():
                    chunk.features[number].clearGeometry()  # of 55,191 areas 0.03 GB
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
            feedback.pushWarning(
                tr("Area {} was not cut: {}.").format(feature.id(), "; ".join(map(spoken, problems)))
            )
    if feedback.isCanceled():
        return {}

    feedback.setProgressText(tr("Finding shared boundaries"))
    rings = joined_rings([own for _, _, own, _ in cut])
    is_new = np.concatenate([np.empty(0, dtype=bool)] + [new for *_, new in cut])
    found, rings, grown = arrange_pieces(rings, is_new, settings.measure, layer.metres_of(crs))
    layer.tell_scale(feedback, crs, found.coverage.xy, context)
    geometries = wkb.polygon_geometries(
        rings.coords,
        np.arange(len(rings.coords)),
        rings.offsets,
        rings.polygon_offsets,
        [wkb.dimensions(reader.wkb_type)] * len(area),
        multi,
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
        sinks.add(tool.OUTPUT, geometry, feature.attributes() + values, Sentence("area {}", feature.id()))
    empty = [number for number in range(len(kept)) if of_area[number] == of_area[number + 1]]
    for number in empty:
        feature = kept[number]
        (reason,) = reasons_of(feature, ())
        values = [feature.id(), layer.NULL, 0.0, reason]
        sinks.add(
            tool.OUTPUT, feature.geometry(), feature.attributes() + values, Sentence("area {}", feature.id())
        )

    if with_table:
        pairs, length = neighbours(found)
        virtual = (area[pairs[:, 0]] == area[pairs[:, 1]]).astype(int)
        for (a, b), shared, cut in zip(pairs.tolist(), length.tolist(), virtual.tolist()):
            sinks.add(tool.ADJACENCY, None, [a + 1, b + 1, shared, cut])

    wrong = faults(found.coverage)
    overlaps = np.unique(np.sort(area[wrong.overlaps], axis=1).reshape(-1, 2), axis=0)
    overlaps = overlaps[overlaps[:, 0] != overlaps[:, 1]]
    _report(feedback, kept, overlaps, wrong.gaps, classless)
    report_short(feedback, short)
    return {
        tool.AREA_COUNT: len(kept),
        tool.PIECE_COUNT: len(area) + len(empty),
        tool.SKIPPED_COUNT: skipped,
        tool.OVERLAP_COUNT: len(overlaps),
        tool.GAP_COUNT: len(wrong.gaps),
    }


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
