"""What ``isthmus:prepareaggregation`` runs."""

from typing import NamedTuple

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


class _Cut(NamedTuple):
    """Areas and their pieces, in the order of the layer.

    Attributes
    ----------
    areas : list of QgsFeature
        Those whose polygons were all solved have no geometry any more.
    area : (p,) int
        The area of each piece.
    status : (p,) object
        Why a piece is what came in.
    rings : Rings
    is_new : (k,) bool
        The rows of new vertices.
    offsets : list of int
        The pieces of area k are those from ``offsets[k]`` on.
    classless : int
        Areas without a class.
    short : int
        See `core.partition.features.without_vertex`.
    """

    areas: list
    area: np.ndarray
    status: np.ndarray
    rings: Rings
    is_new: np.ndarray
    offsets: list
    classless: int
    short: int


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
    tau = tool.parameterAsDouble(parameters, tool.TAU, context)
    settings = _settings(tool, parameters, context, source)
    try:
        cut = _cut(reader, settings, tau, class_index, feedback)
    except Cancelled:
        return {}
    skipped = _tell_uncut(feedback, cut)
    if feedback.isCanceled():
        return {}

    feedback.setProgressText(tr("Finding shared boundaries"))
    found, rings, grown = arrange_pieces(cut.rings, cut.is_new, settings.measure, layer.metres_of(crs))
    layer.tell_scale(feedback, crs, found.coverage.xy, context)
    _write_pieces(tool, sinks, reader.wkb_type, cut, rings, found.size, grown)
    without = _write_areas_without_pieces(tool, sinks, cut)
    if with_table:
        _write_neighbours(tool, sinks, cut.area, found)

    wrong = faults(found.coverage)
    overlaps = np.unique(np.sort(cut.area[wrong.overlaps], axis=1).reshape(-1, 2), axis=0)
    overlaps = overlaps[overlaps[:, 0] != overlaps[:, 1]]
    _report(feedback, cut.areas, overlaps, wrong.gaps, cut.classless)
    report_short(feedback, cut.short)
    return {
        tool.AREA_COUNT: len(cut.areas),
        tool.PIECE_COUNT: len(cut.area) + without,
        tool.SKIPPED_COUNT: skipped,
        tool.OVERLAP_COUNT: len(overlaps),
        tool.GAP_COUNT: len(wrong.gaps),
    }


def _settings(tool, parameters, context, source):
    """What the parameters say about cuts."""
    objective = tool.parameterAsEnumString(parameters, tool.OBJECTIVE, context)
    return Settings(
        measure=measure_of(source.sourceCrs()),
        natural=tool.parameterAsEnumString(parameters, tool.PLACES, context) == NATURAL,
        floors=tool.floors(parameters, context, source),
        lines=None,
        new_vertices=tool.parameterAsBoolean(parameters, tool.NEW_VERTICES, context),
        weigh=weigh_by_length if objective == BY_LENGTH else None,
        all_dilations=False,
    )


def _cut(reader, settings, tau, class_index, feedback):
    """Read the areas and cut them, chunk by chunk; may raise `Cancelled`."""
    check = checker(reader.progress, feedback.isCanceled)
    areas, classless, short = [], 0, 0
    area, status, rings, new = [], [], [], []  # of the pieces of each chunk
    for features in reader.chunks():
        for feature in features:
            classless += layer.text(feature.attributes()[class_index]) is None
            feature.setGeometry(layer.with_dimensions(feature.geometry(), reader.wkb_type))
        for chunk in read(features, settings, feedback):
            problem = prepare(chunk, settings, check)
            selection = select(problem.prepared, tau, weight=problem.weight, check=check, with_dilation=False)
            short += without_vertex(problem, selection, np.full(len(chunk.features), tau))
            found = pieces(problem, finish(problem.prepared, selection, check=check).parts)
            area.append(chunk.owner[found.polygon] + len(areas))
            status.append(problem.verdict[found.polygon])
            rings.append(Rings(problem.chunk.rings.coords[found.rows], found.offsets, found.ring_offsets))
            new.append(found.rows >= len(chunk.rings.coords))
            # others may come out as they came
            for number in np.setdiff1d(chunk.owner, chunk.owner[problem.verdict != ""]).tolist():
                chunk.features[number].clearGeometry()  # of 55,191 areas 0.03 GB
            areas += chunk.features
    area = np.concatenate([np.empty(0, dtype=np.int64), *area])
    return _Cut(
        areas,
        area,
        np.concatenate([np.empty(0, dtype=object), *status]),
        joined_rings(rings),
        np.concatenate([np.empty(0, dtype=bool), *new]),
        offsets_of(np.bincount(area, minlength=len(areas))).tolist(),
        classless,
        short,
    )


def _tell_uncut(feedback, cut):
    """Warn of areas that were not cut, or not all of their parts; return their number."""
    skipped = 0
    for feature, lo, hi in zip(cut.areas, cut.offsets, cut.offsets[1:]):
        problems = reasons_of(feature, cut.status[lo:hi])
        if problems:
            skipped += 1
            feedback.pushWarning(
                tr("Area {} was not cut: {}.").format(feature.id(), "; ".join(map(spoken, problems)))
            )
    return skipped


def _write_pieces(tool, sinks, wkb_type, cut, rings, size, grown):
    """Write the pieces; an area that was not cut, and got no vertices, as it came."""
    multi = QgsWkbTypes.isMultiType(wkb_type)
    geometries = wkb.polygon_geometries(
        rings.coords,
        np.arange(len(rings.coords)),
        rings.offsets,
        rings.polygon_offsets,
        [wkb.dimensions(wkb_type)] * len(cut.area),
        multi,
    )
    rows = zip(cut.area.tolist(), cut.status.tolist(), size.tolist(), grown.tolist(), geometries)
    for k, (number, reason, own_size, has_grown, geometry) in enumerate(rows):
        feature = cut.areas[number]
        if reason and cut.offsets[number + 1] - cut.offsets[number] == 1 and not has_grown:
            # even with a ring that is not closed
            own = feature.geometry()
            if not QgsWkbTypes.isCurvedType(own.wkbType()):
                geometry = own
                if multi:
                    geometry.convertToMultiType()
        values = [feature.id(), k + 1, own_size, reason]
        sinks.add(tool.OUTPUT, geometry, feature.attributes() + values, Sentence("area {}", feature.id()))


def _write_areas_without_pieces(tool, sinks, cut):
    """Write the areas that have no polygon; return their number."""
    empty = [feature for feature, lo, hi in zip(cut.areas, cut.offsets, cut.offsets[1:]) if lo == hi]
    for feature in empty:
        (reason,) = reasons_of(feature, ())
        values = [feature.id(), layer.NULL, 0.0, reason]
        sinks.add(
            tool.OUTPUT, feature.geometry(), feature.attributes() + values, Sentence("area {}", feature.id())
        )
    return len(empty)


def _write_neighbours(tool, sinks, area, found):
    """Write the table of neighbouring pieces."""
    pairs, length = neighbours(found)
    virtual = (area[pairs[:, 0]] == area[pairs[:, 1]]).astype(int)
    for (a, b), shared, is_cut in zip(pairs.tolist(), length.tolist(), virtual.tolist()):
        sinks.add(tool.ADJACENCY, None, [a + 1, b + 1, shared, is_cut])


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
