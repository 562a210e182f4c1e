"""From the geometries of features to solved polygons: what all partition tools share."""

from __future__ import annotations

import math
import re
from typing import Any, Callable, Collection, Iterator, NamedTuple

import numpy as np
from qgis.core import (
    NULL,
    QgsCoordinateReferenceSystem,
    QgsEllipsoidUtils,
    QgsExpression,
    QgsExpressionContext,
    QgsExpressionContextScope,
    QgsFeature,
    QgsProcessingContext,
    QgsProcessingFeatureSource,
    QgsProcessingFeedback,
    QgsProcessingUtils,
    QgsUnitTypes,
)

from ...core import metric
from ...core import wkb as core_wkb
from ...core.errors import Sentence
from ...core.partition.engines import engine_name, only_engine
from ...core.partition.features import Chunk, Problem, beyond_the_poles, weigh_by_length
from ...core.partition.features import prepare as prepare_polygons
from ...core.progress import checker, ignore, stretch
from ..dependencies import engines_with_wheels
from ..layers import wkb
from ..layers.source import Reader, shapeless
from ..words import tr
from .candidate_lines import CandidateLines
from .cutting import BY_LENGTH, BY_WEIGHT, NATURAL, PartitionTool


class Settings(NamedTuple):
    """How to solve, the same for all features.

    Attributes
    ----------
    measure : core.metric.Metric
    natural : bool
        Whether cuts may only lie where people would cut.
    floors : dict
        The functions that give SMALLEST_PART, MIN_LENGTH and MIN_HOLE for a feature.
    lines : CandidateLines or None
    new_vertices : bool
        Whether cuts may end inside edges, at new vertices.
    weigh : callable or None
        ``(chunk, near, prepared)`` to the weights of the candidates, and {polygon of the chunk: why it has
        none}; None for MinSize. ``near`` has, for each polygon, the numbers of the lines given for it, or
        is None.
    all_dilations : bool
    """

    measure: metric.Metric
    natural: bool
    floors: dict[str, Callable[[QgsFeature], float]]
    lines: CandidateLines | None
    new_vertices: bool
    weigh: Callable | None
    all_dilations: bool


def settings_of(
    tool: PartitionTool,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    source: QgsProcessingFeatureSource,
    feedback: QgsProcessingFeedback,
    all_dilations: bool = False,
) -> Settings:
    """Return how a tool solves, by its parameters.

    Returns
    -------
    Settings
    """
    crs = source.sourceCrs()
    lines_source = tool.parameterAsSource(parameters, tool.CANDIDATES, context)
    lines = lines_source and CandidateLines(lines_source, crs, context)
    if not lines and slow_engine_note():
        feedback.pushInfo(slow_engine_note())
    objective = tool.parameterAsEnumString(parameters, tool.OBJECTIVE, context)
    weigh = weigh_by_length if objective == BY_LENGTH else None
    if objective == BY_WEIGHT:
        weigh = weigh_by_expression(
            tool.parameterAsString(parameters, tool.WEIGHT, context),
            source,
            lines,
            QgsExpressionContext(tool.createExpressionContext(parameters, context, source)),
        )
    return Settings(
        measure=measure_of(crs),
        natural=tool.parameterAsEnumString(parameters, tool.PLACES, context) == NATURAL,
        floors=tool.floors(parameters, context, source),
        lines=lines,
        new_vertices=tool.parameterAsBoolean(parameters, tool.NEW_VERTICES, context),
        weigh=weigh,
        all_dilations=all_dilations,
    )


def slow_engine_note() -> str:
    """Return what makes the tools faster where only shapely triangulates, or ''."""
    if engine_name() != "shapely" or only_engine():
        return ""
    note = tr("Shapely's triangulation is used: as good as others, but slower.")
    for name in engines_with_wheels()[:1]:
        note += " " + tr("The Python package {} is faster.").format(name)
        if name == "triangle":
            note += " " + tr("It may not be used commercially.")
    return note


def measure_of(crs: QgsCoordinateReferenceSystem) -> metric.Metric:
    """Return the metric of a layer: its own plane, or its ellipsoid where it is in degrees."""
    degrees = degrees_of(crs)
    if not degrees:
        return metric.planar()
    ellipsoid = QgsEllipsoidUtils.ellipsoidParameters(crs.ellipsoidAcronym())
    if not ellipsoid.valid:
        return metric.ellipsoidal(degrees=degrees)
    return metric.ellipsoidal(a=ellipsoid.semiMajor, b=ellipsoid.semiMinor, degrees=degrees)


def degrees_of(crs: QgsCoordinateReferenceSystem) -> float:
    """Return the degrees in one unit of a CRS; 0 where its coordinates are no angles.

    QGIS 3.22 calls no CRS geographic that is not in its database, such as one of Mars, and the unit of one
    in grads unknown.
    """
    if crs.mapUnits() == QgsUnitTypes.DistanceUnit.DistanceDegrees:
        return 1.0
    found = re.match(r'GEOGCS.*\bUNIT\["[^"]*",([^,\]]+)', crs.toWkt(), re.DOTALL)
    return round(math.degrees(float(found[1])), 9) if found else float(crs.isGeographic())  # of grads 0.9


def read(features: list[QgsFeature], settings: Settings, feedback: QgsProcessingFeedback) -> Iterator[Chunk]:
    """Yield the chunks of some features: one, unless some of them are not what the CRS promises.

    Parameters
    ----------
    features : list of QgsFeature
    settings : Settings
    feedback : QgsProcessingFeedback
    """
    rings, owner, extra = wkb.read_polygons(feature.geometry() for feature in features)
    whole = Chunk(features, rings, owner, extra, settings.measure)
    if not settings.measure.conformal or not len(rings.coords):
        yield whole
        return
    strange = beyond_the_poles(rings, owner, len(features), settings.measure)
    if not strange.any():
        yield whole
        return
    for run in np.split(np.arange(len(features)), np.flatnonzero(np.diff(strange)) + 1):
        own = [features[k] for k in run.tolist()]
        rings, owner, extra = wkb.read_polygons(feature.geometry() for feature in own)
        measure = metric.planar() if strange[run[0]] else settings.measure
        for feature in own if strange[run[0]] else ():
            feedback.pushWarning(
                tr(
                    "Feature {} has a latitude beyond 90 degrees. Its coordinates are taken as those of a "
                    "plane. Is the CRS of the layer right?"
                ).format(feature.id())
            )
        yield Chunk(own, rings, owner, extra, measure)


def prepare(chunk: Chunk, settings: Settings, check: Callable = ignore) -> Problem:
    """Prepare the polygons of a chunk; may raise `Cancelled`.

    Returns
    -------
    core.partition.features.Problem
    """
    floors = {
        name.lower(): np.array([of(feature) for feature in chunk.features], dtype=float)
        for name, of in settings.floors.items()
    }
    return prepare_polygons(
        chunk,
        natural=settings.natural,
        lines=settings.lines.given if settings.lines else None,
        new_vertices=settings.new_vertices,
        weigh=settings.weigh,
        check=check,
        **floors,
    )


def problems(
    reader: Reader, settings: Settings, feedback: QgsProcessingFeedback, share: float
) -> Iterator[tuple[Problem, Callable]]:
    """Yield the chunks of a layer, prepared, each with the check of what is left to do for it.

    Parameters
    ----------
    reader : Reader
    settings : Settings
    feedback : QgsProcessingFeedback
    share : float
        What preparing a chunk takes of its progress.

    Raises
    ------
    Cancelled
    """
    check = checker(reader.progress, feedback.isCanceled)
    for features in reader.chunks():
        for chunk in read(features, settings, feedback):
            yield prepare(chunk, settings, stretch(check, 0.0, share)), stretch(check, share, 1.0)


def reasons_of(feature: QgsFeature, verdicts: Collection[str]) -> list[str]:
    """Return why polygons of a feature were not solved, each reason once, by the verdicts of all of them."""
    if not len(verdicts):
        return [shapeless(feature)]
    return list(dict.fromkeys(verdict for verdict in verdicts if verdict))


def weigh_by_expression(
    text: str, source: QgsProcessingFeatureSource, lines: CandidateLines | None, context: QgsExpressionContext
) -> Callable[..., tuple[np.ndarray, dict]]:
    """Return the function that weighs candidates by an expression, for MinWeight.

    Parameters
    ----------
    text : str
        The expression. It sees the line's geometry, @length, @detour, the polygon's fields and,
        with lines given, the line's.
    source : QgsProcessingFeatureSource
    lines : CandidateLines or None
    context : QgsExpressionContext
    """
    fields = source.fields()
    if lines:
        fields = QgsProcessingUtils.combineFields(fields, lines.fields)
    context.setFields(fields)
    scope = QgsExpressionContextScope()
    context.appendScope(scope)
    expression = QgsExpression(text)
    expression.prepare(context)

    def weigh(chunk, near, prepared):
        polygon = prepared.polygons.number[prepared.owner]
        feature_of = chunk.owner[polygon].tolist()
        rows, offsets = prepared.way_rows(np.arange(len(prepared.edges)))
        geometries = wkb.geometries(
            core_wkb.lines(chunk.rings.coords, rows, [chunk.extra[f] for f in feature_of], offsets)
        )
        weights, reasons = np.zeros(len(prepared.edges)), {}
        candidate = QgsFeature(fields)
        for k, (geometry, p, f, length, detour) in enumerate(
            zip(geometries, polygon.tolist(), feature_of, prepared.chord.tolist(), prepared.detour.tolist())
        ):
            if p in reasons:
                continue
            own, line = chunk.features[f].attributes(), None
            if near is not None:
                line = int(near[p][prepared.edge_line[k]])
                own = own + lines.attributes[line]
            candidate.setAttributes(own)
            candidate.setGeometry(geometry)
            scope.setVariable("length", length)
            scope.setVariable("detour", detour if math.isfinite(detour) else NULL)
            scope.setFeature(candidate)
            weight = _number(expression.evaluate(context))
            if 0.0 <= weight < math.inf:
                weights[k] = weight
                continue
            name = geometry.asWkt(6) if line is None else Sentence("line {}", lines.ids[line])
            reason = expression.evalErrorString() or Sentence("it must be a number of at least 0")
            reasons[p] = Sentence("the weight of candidate {} cannot be used: {}", name, reason)
        return weights, reasons

    return weigh


def _number(value):
    """The value as a float; NaN where it is none."""
    if value is None or value == NULL or isinstance(value, bool):
        return math.nan
    try:
        return float(value)
    except (TypeError, ValueError):
        return math.nan
