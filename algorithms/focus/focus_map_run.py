"""What ``isthmus:focusmap`` runs."""

from __future__ import annotations

import contextlib
import math
import time
from itertools import repeat
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely
from qgis.core import (
    QgsCoordinateTransform,
    QgsCsException,
    QgsFeatureRequest,
    QgsFeatureSink,
    QgsFields,
    QgsGeometry,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingUtils,
    QgsVectorFileWriter,
    QgsVectorLayer,
    QgsWkbTypes,
)

from ...core import wkb as core_wkb
from ...core.errors import Cancelled, IsthmusError, Sentence
from ...core.focus.carrying import Carrier, carried, placed
from ...core.focus.enlarge import enlarge
from ...core.focus.globe import is_on_the_globe, on_the_globe
from ...core.focus.graph import match
from ...core.focus.selection import rule_of
from ...core.metric import FARTHEST
from ..base import counted
from ..layers import wkb
from ..layers.fields import make_fields
from ..layers.sinks import Sinks
from ..layers.source import WITHOUT_VALIDITY_CHECK
from ..layers.styles import style_on_load
from ..partition.cutting import NATURAL
from ..partition.solving import degrees_of
from ..words import as_sentence, spoken, tr
from .focus_map import EDGE_FIELDS, FocusMapAlgorithm

AT_ONCE = 200_000  # points of further layers that are carried together


def _rule(tool, parameters, context):
    """The rule for relevant edges, as `selection.select` takes it."""
    return rule_of(
        tool.parameterAsEnumString(parameters, tool.SELECTION, context),
        natural=tool.parameterAsEnumString(parameters, tool.PLACES, context) == NATURAL,
        smallest=tool.parameterAsDouble(parameters, tool.SMALLEST_PART, context) / 100.0,
    )


def run(
    tool: FocusMapAlgorithm,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    feedback: QgsProcessingFeedback,
) -> dict[str, Any]:
    """Run `isthmus:focusmap`; return its results."""
    source = tool.source(parameters, context)
    focus_source = tool.parameterAsSource(parameters, tool.FOCUS, context)
    if focus_source is None:
        raise QgsProcessingException(tool.invalidSourceError(parameters, tool.FOCUS))
    begun = time.monotonic()
    given = _read(source, feedback)
    result = given and _solve(tool, parameters, context, feedback, given, focus_source, source.sourceCrs())
    if not result:  # cancelled
        return {}
    _tell(feedback, result)
    crs = source.sourceCrs()
    with Sinks(tool, parameters, context, feedback) as sinks:
        _write(tool, sinks, source, given, result, feedback)
        _write_edges(tool, sinks, crs, result)
        answer = _carry(tool, parameters, context, crs, result, feedback)
        feedback.setProgress(100)
    answer.update(sinks.destinations)
    style_on_load(context, answer.get(tool.OUTPUT), None, 2)
    style_on_load(context, answer.get(tool.EDGES_USED), "cuts.qml", 0)
    answer.update(
        {
            tool.SCALE_REACHED: result.scale,
            tool.FLIPPED_AREA: 100.0 * result.distortion.flipped,
            tool.MEDIAN_DISTORTION: result.distortion.median,
            tool.HIGH_DISTORTION: result.distortion.high,
            tool.CROSSINGS: 0,  # no triangle is turned
            tool.EDGE_COUNT: len(result.edges),
            tool.SECONDS: time.monotonic() - begun,
            tool.PROBLEM: "",  # or there is no map at all
        }
    )
    return answer


class _Map(NamedTuple):
    """The features of the map, the points of each, and all of them as `enlarge` takes them."""

    features: list
    runs: list
    rows: np.ndarray
    starts: np.ndarray
    polygons: list


def _read(source, feedback):
    """The map; None if cancelled."""
    held, runs = [], []
    for feature in source.getFeatures(QgsFeatureRequest(), WITHOUT_VALIDITY_CHECK):
        if feedback.isCanceled():
            return None
        held.append(feature)
        runs.append(wkb.Runs(feature.geometry()))
    wrong = [k for k, one in enumerate(runs) if not (np.abs(one.xy) <= FARTHEST).all()]
    for k in wrong:
        runs[k] = wkb.Runs(QgsGeometry())  # as if it had none
    if wrong:
        ids = ", ".join(str(held[k].id()) for k in wrong[:10]) + " ..." * (len(wrong) > 10)
        feedback.pushWarning(
            tr(
                "Left where they are, since coordinates are not finite (NaN or infinity) or larger than "
                "{:g}: feature {}."
            ).format(FARTHEST, ids)
        )
    rows, starts, polygons = core_wkb.joined(runs)
    if len(starts) == 1:
        raise QgsProcessingException(tr("The map has no features with a geometry that can be moved."))
    return _Map(held, runs, rows, starts, polygons)


def _solve(tool, parameters, context, feedback, given, focus_source, crs):
    """The focus map; None if cancelled."""
    focus = _focus(focus_source, crs, context)
    edges = _given(tool, parameters, context, crs, given.rows, feedback)
    feedback.pushInfo(f"{counted(len(given.features), 'feature')}, {counted(len(given.rows), 'point')}.")
    growth, aspect = tool.parameterAsDouble(parameters, tool.GROWTH, context) / 100.0, 1.0
    degrees = degrees_of(crs)
    if degrees:
        _refuse_beyond_the_globe(degrees * given.rows, crs)
        growth, aspect = on_the_globe(degrees * given.rows, growth)
        feedback.pushInfo(
            tr(
                "The map is in degrees ({}). It is solved in the equidistant cylindrical projection with "
                "true lengths at latitude {:.1f}, and the result is in degrees."
            ).format(crs.authid(), math.degrees(math.acos(aspect)))
        )
    try:
        result = enlarge(
            given.rows, given.starts, given.polygons, focus,
            tool.parameterAsDouble(parameters, tool.SCALE, context),
            edges=edges,
            rule=_rule(tool, parameters, context),
            tau=tool.parameterAsDouble(parameters, tool.TAU, context),
            frame=tool.parameterAsBoolean(parameters, tool.FRAME, context),
            growth=growth,
            aspect=aspect,
            progress=lambda share: feedback.setProgress(95.0 * share),
            cancelled=feedback.isCanceled,
        )  # fmt: skip
    except Cancelled:
        return None
    except IsthmusError as problem:
        raise QgsProcessingException(as_sentence(spoken(problem.sentence))) from None
    if degrees and not is_on_the_globe(degrees * result.rows, degrees * given.rows):
        raise QgsProcessingException(
            tr("The map would grow beyond the globe. Keep its extent (switch the frame on).")
        )
    return result


def _refuse_beyond_the_globe(rows, crs):
    """Complain of what is in metres, most likely."""
    beyond = ~(np.abs(rows) <= (360.0, 90.0)).all(axis=1)
    if beyond.any():
        x, y = rows[np.argmax(beyond)].tolist()
        raise QgsProcessingException(
            tr("The map is in degrees ({}), and ({:g} {:g}) is beyond the globe. Is its CRS right?").format(
                crs.authid(), x, y
            )
        )


def _tell(feedback, result):
    """Say in the log what came out."""
    for reason in result.skipped[:20]:
        feedback.pushWarning(tr("No relevant edges for {}.").format(spoken(reason)))
    if len(result.skipped) > 20:
        feedback.pushWarning(tr("... and for {} more.").format(len(result.skipped) - 20))
    width, height = (100.0 * (result.growth - 1.0)).tolist()
    feedback.pushInfo(tr("The map becomes {:.0f} % wider and {:.0f} % higher.").format(width, height))
    if result.dented:
        feedback.pushInfo(
            tr("{} squares are no longer convex, as there was no room. Nothing crosses there.").format(
                result.dented
            )
        )
    if len(result.splits):
        feedback.pushInfo(
            tr("Put into lines where others meet, cross or nearly touch them: {}.").format(
                counted(len(result.splits), "point")
            )
        )


def _focus(source, crs, context):
    """The region in focus, in the CRS of the map."""
    found = []
    for geometry in _geometries(source, crs, context):
        data = bytes(_straight(geometry).asWkb())
        # a ring of two points is no region
        found.append(shapely.force_2d(shapely.from_wkb(data, on_invalid="ignore")))
    found = [
        one for one in found if one is not None and (np.abs(shapely.get_coordinates(one)) <= FARTHEST).all()
    ]
    if not found:
        raise QgsProcessingException(
            tr("The layer of the region to enlarge has no polygons whose coordinates are finite.")
        )
    return shapely.union_all(shapely.make_valid(found))


def _given(tool, parameters, context, crs, rows, feedback):
    """The rows at the ends of relevant edges that were given, or None."""
    source = tool.parameterAsSource(parameters, tool.EDGES, context)
    if source is None:
        return None
    ends = [np.empty((0, 2, 2))]
    for geometry in _geometries(source, crs, context):
        one, start = wkb.Runs(geometry), 0
        for count in one.counts:
            line = one.xy[start : start + count]
            line = np.where(np.isfinite(line), line, 1e300)  # where no point of the map is
            ends.append(np.stack((line[:-1], line[1:]), axis=1))
            start += count
    ends = np.concatenate(ends)
    found = match(rows, ends.reshape(-1, 2)).reshape(-1, 2)
    good = (found >= 0).all(axis=1)
    if not good.all():
        feedback.pushWarning(
            tr("{} of {} relevant edges were left out: an end is not a point of the map.").format(
                np.count_nonzero(~good), len(good)
            )
        )
    return found[good]


def _write(tool, sinks, source, given, result, feedback):
    spoiled = []
    kind = QgsWkbTypes.linearType(source.wkbType())
    sinks.open(tool.OUTPUT, source.fields(), kind, source.sourceCrs())
    moved = placed([one for one in given.runs if one.counts], result.rows, result.put_in)
    for feature, one in zip(given.features, given.runs):
        geometry = feature.geometry()
        if one.counts:
            geometry = next(moved)
            if not _is_valid(geometry) and _is_valid(feature.geometry()):
                spoiled.append(feature.id())
        sinks.add(tool.OUTPUT, geometry, feature.attributes(), Sentence("feature {}", feature.id()))
    if spoiled:
        feedback.pushWarning(
            tr(
                "No longer valid, since they are narrower than 1e-10 of the map's width where others meet "
                "them (Fix geometries mends them): feature {}."
            ).format(", ".join(map(str, spoiled[:10])) + " ..." * (len(spoiled) > 10))
        )


def _is_valid(geometry):
    if geometry.type() != QgsWkbTypes.GeometryType.PolygonGeometry:
        return True
    return shapely.is_valid(shapely.from_wkb(bytes(_straight(geometry).asWkb()), on_invalid="ignore"))


def _write_edges(tool, sinks, crs, result):
    fields, kind = make_fields(EDGE_FIELDS), QgsWkbTypes.Type.LineString
    if not sinks.open(tool.EDGES_USED, fields, kind, crs, False):
        return
    before, after = (
        np.hypot(*(xy[result.edges[:, 0]] - xy[result.edges[:, 1]]).T) for xy in (result.points, result.moved)
    )
    lines = core_wkb.lines(result.moved, result.edges, [0] * len(result.edges))
    values = map(list, zip(result.kind.tolist(), before.tolist(), (after / before).tolist()))
    sinks.add_all(tool.EDGES_USED, zip(lines, values, repeat("")))


def _carry(tool, parameters, context, crs, result, feedback):
    layers = tool.parameterAsLayerList(parameters, tool.ALONG, context)
    if not layers:
        return {tool.CARRIED_LAYERS: []}
    carrier = Carrier(result.points, result.moved, result.triangles)
    path = tool.parameterAsFileOutput(parameters, tool.CARRIED, context)
    path = path or QgsProcessingUtils.generateTempFilename("carried.gpkg")
    written, names = [], []
    try:
        for layer in layers:
            if feedback.isCanceled():
                break
            name = layer.name() or "layer"
            while name.lower() in names:  # to a GeoPackage, Roads and roads are one name
                name += "_2"
            names.append(name.lower())
            whole = QgsVectorFileWriter.ActionOnExistingFile
            action = whole.CreateOrOverwriteFile if len(names) == 1 else whole.CreateOrOverwriteLayer
            written.append(_carry_layer(layer, name, path, action, crs, carrier, context, feedback))
    except QgsProcessingException:
        _discard(path)
        raise
    if feedback.isCanceled():
        _discard(path)
        return {tool.CARRIED_LAYERS: []}
    return {tool.CARRIED: path, tool.CARRIED_LAYERS: written}


def _carry_layer(layer, name, path, action, crs, carrier, context, feedback):
    options = QgsVectorFileWriter.SaveVectorOptions()
    options.driverName, options.layerName = "GPKG", name
    options.actionOnExistingFile = action
    kind = QgsWkbTypes.linearType(layer.wkbType())
    fields = QgsFields(layer.fields())
    writer = QgsVectorFileWriter.create(
        path, fields, kind, crs, context.transformContext(), options,
        QgsFeatureSink.SinkFlag.RegeneratePrimaryKey,
    )  # fmt: skip
    if writer.hasError() != QgsVectorFileWriter.WriterError.NoError:
        raise QgsProcessingException(tr("{} cannot be written: {}").format(path, writer.errorMessage()))
    transform = QgsCoordinateTransform(layer.crs(), crs, context.transformContext())
    count, lost = 0, []
    for features, runs in _batches(layer, transform, feedback):
        count += len(features)
        lost += [feature.id() for feature, one in zip(features, runs) if one is None]
        moved = carried(carrier, [one for one in runs if one and one.counts])
        for feature, one in zip(features, runs):
            if one is None:
                feature.clearGeometry()
            elif one.counts:
                feature.setGeometry(next(moved))
            if not writer.addFeature(feature, QgsFeatureSink.Flag.FastInsert):
                raise QgsProcessingException(
                    tr("A feature of {} could not be written: {}").format(name, writer.errorMessage())
                )
    del writer
    if lost:
        feedback.pushWarning(
            tr(
                "{}: features {}{} have no place in the CRS of the map, and are carried without a geometry."
            ).format(name, ", ".join(map(str, lost[:10])), " ..." * (len(lost) > 10))
        )
    address = f"{path}|layername={name}"
    # what a full disk swallows, the writer may tell nobody
    if QgsVectorLayer(address, name, "ogr").featureCount() != count:
        raise QgsProcessingException(
            tr("{} could not be written to {} as a whole. Is the disk full?").format(name, path)
        )
    details = QgsProcessingContext.LayerDetails(name, context.project(), name)
    if context.project() is not None:
        written = QgsVectorLayer(address, name, "ogr")
        context.temporaryLayerStore().addMapLayer(written)
        context.addLayerToLoadOnCompletion(written.id(), details)
    return address


def _batches(layer, transform, feedback):
    """Features of a layer, many at a time, and their points; None of what has no place in the map."""
    features, runs, size = [], [], 0
    for feature in layer.getFeatures():
        if feedback.isCanceled():
            return
        geometry = feature.geometry()
        try:
            if not geometry.isNull():
                geometry.transform(transform)
            one = wkb.Runs(geometry)
        except QgsCsException:
            one = None
        if one and not np.isfinite(one.xy).all():
            one = None
        features.append(feature)
        runs.append(one)
        size += 1 + (sum(one.counts) if one else 0)
        if size > AT_ONCE:
            yield features, runs
            features, runs, size = [], [], 0
    if features:
        yield features, runs


def _discard(path):
    """Remove what is half written: it would look complete."""
    for end in ("", "-journal", "-wal", "-shm"):
        with contextlib.suppress(OSError):
            Path(path + end).unlink()


def _geometries(source, crs, context):
    """The geometries of a source in another CRS, none empty."""
    transform = QgsCoordinateTransform(source.sourceCrs(), crs, context.transformContext())
    request = QgsFeatureRequest().setSubsetOfAttributes([])
    for feature in source.getFeatures(request, WITHOUT_VALIDITY_CHECK):
        geometry = feature.geometry()
        if geometry.isNull() or geometry.isEmpty():
            continue
        if transform.isValid() and not transform.isShortCircuited():
            finite = geometry.boundingBox().isFinite()
            try:
                geometry.transform(transform)
                if finite and not geometry.boundingBox().isFinite():
                    raise QgsCsException("")
            except QgsCsException:
                raise QgsProcessingException(
                    tr(
                        "Feature {} of {} has no place in the CRS of the map ({}). Is the CRS of {} right?"
                    ).format(feature.id(), source.sourceName(), crs.authid(), source.sourceName())
                ) from None
        yield geometry


def _straight(geometry):
    abstract = geometry.constGet()
    curved = QgsWkbTypes.isCurvedType(abstract.wkbType())
    return abstract.segmentize() if curved else abstract
