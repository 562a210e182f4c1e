"""From the geometries of features to solved polygons: what all partition tools share."""

import math
from typing import Callable, NamedTuple

from qgis.core import (
    NULL,
    QgsEllipsoidUtils,
    QgsExpression,
    QgsExpressionContextScope,
    QgsFeature,
    QgsFeatureRequest,
    QgsProcessingUtils,
)

from ...core.progress import ignore
from ..layers import wkb


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

    measure: object
    natural: bool
    floors: dict
    lines: object
    new_vertices: bool
    weigh: Callable
    all_dilations: bool


class Chunk(NamedTuple):
    """Features as flat arrays.

    Attributes
    ----------
    features : list of QgsFeature
    rings : core.rings.Rings
        All their polygons. Behind the rows of the rings, ``coords`` may have new ones for the results.
    owner : (q,) int
        The feature of each polygon, as a place in ``features``.
    extra : list of int
        The `wkb.dimensions` of each feature.
    measure : core.metric.Metric
    """

    features: list
    rings: object
    owner: object
    extra: list
    measure: object


class Problem(NamedTuple):
    """A chunk, ready to be solved.

    Attributes
    ----------
    chunk : Chunk
    prepared : core.partition.solve.Prepared
    weight : (k,) float or None
        Weights of the candidates; None for MinSize.
    verdict : (q,) object
        For each polygon of the chunk '', or why it is not solved.
    shell_share : (p,) float
        Area of the shell of each prepared polygon, as a share of its feature's area.
    """

    chunk: Chunk
    prepared: object
    weight: object
    verdict: object
    shell_share: object

    @property
    def owner(self):
        """(p,) int: the feature of each prepared polygon."""
        return self.chunk.owner[self.prepared.polygons.number]

    def refuse(self, features, reason):
        """Note, for features, why none of their polygons is solved; those with a reason keep it."""
        import numpy as np

        own = np.isin(self.chunk.owner, features) & (self.verdict == "")
        self.verdict[own] = reason


class Pieces(NamedTuple):
    """What became of the polygons of a chunk: parts, and whole polygons that could not be solved.

    They come by feature, the largest first; a polygon in one piece has its rings as they were.

    Attributes
    ----------
    feature_offsets : (f + 1,) int
        Where the pieces of each feature start.
    polygon : (m,) int
        The polygon of each, as a place in the chunk.
    area : (m,) float
    rows, offsets, ring_offsets : (k,) int, (r + 1,) int, (m + 1,) int
        Rows of all rings, where each ring starts, and where the rings of each piece start.
    number : (m',) int
        The number within its feature, from 1, of each part of the solution.
    """

    feature_offsets: object
    polygon: object
    area: object
    rows: object
    offsets: object
    ring_offsets: object
    number: object


def measure_of(crs):
    """Return the metric of a layer: its own plane, or its ellipsoid where it is in degrees."""
    from ...core import metric

    if not crs.isGeographic():
        return metric.planar()
    ellipsoid = QgsEllipsoidUtils.ellipsoidParameters(crs.ellipsoidAcronym())
    if not ellipsoid.valid:
        return metric.ellipsoidal()
    return metric.ellipsoidal(ellipsoid.semiMajor, ellipsoid.semiMinor)


def read(features, settings, feedback):
    """Yield the chunks of some features: one, unless some of them are not what the CRS promises.

    Parameters
    ----------
    features : list of QgsFeature
    settings : Settings
    feedback : QgsProcessingFeedback
    """
    import numpy as np

    from ...core import metric

    rings, owner, extra = wkb.read_polygons(feature.geometry() for feature in features)
    whole = Chunk(features, rings, owner, extra, settings.measure)
    if not settings.measure.conformal or not len(rings.coords):
        yield whole
        return
    beyond = np.abs(rings.coords[:, 1]) > 90.0 + 1e-9
    strange = np.zeros(len(features), dtype=bool)
    strange[np.repeat(owner, np.diff(rings.offsets[rings.polygon_offsets]))[beyond]] = True
    if not strange.any():
        yield whole
        return
    for run in np.split(np.arange(len(features)), np.flatnonzero(np.diff(strange)) + 1):
        own = [features[k] for k in run.tolist()]
        rings, owner, extra = wkb.read_polygons(feature.geometry() for feature in own)
        measure = metric.planar() if strange[run[0]] else settings.measure
        for feature in own if strange[run[0]] else ():
            feedback.pushWarning(
                f"Feature {feature.id()} has a latitude beyond 90 degrees. Its coordinates are taken "
                "as those of a plane. Is the CRS of the layer right?"
            )
        yield Chunk(own, rings, owner, extra, measure)


def prepare(chunk, settings, check=ignore):
    """Prepare the polygons of a chunk; may raise `Cancelled`.

    Returns
    -------
    Problem
    """
    import numpy as np

    from ...core.partition import solve as core

    area, shell = _areas(chunk.rings, np.arange(len(chunk.owner)), chunk.measure)
    feature_area = np.bincount(chunk.owner, weights=area, minlength=len(chunk.features))
    floors, reasons = _floors(chunk, settings)
    near = None
    if settings.lines:
        bounds = chunk.rings.offsets[chunk.rings.polygon_offsets].tolist()
        near = [
            settings.lines.near(chunk.rings.coords[lo:hi])
            for lo, hi in zip(bounds[:-1], bounds[1:])
        ]
    prepared = core.prepare(
        chunk.rings,
        natural=settings.natural,
        smallest=floors["SMALLEST_PART"] / 100.0 * feature_area[chunk.owner],
        min_length=floors["MIN_LENGTH"],
        min_hole=floors["MIN_HOLE"],
        lines=None if near is None else [settings.lines.ends[own] for own in near],
        new_vertices=settings.new_vertices,
        measure=chunk.measure,
        check=check,
    )
    if len(prepared.new_rows):
        coords = np.concatenate((chunk.rings.coords, prepared.new_rows))
        chunk = chunk._replace(rings=chunk.rings._replace(coords=coords))
    verdict = prepared.verdict.copy()
    if near is not None:
        for own, lines in zip(near, prepared.lines):
            if lines is not None:
                settings.lines.note(own, lines)
    weight = None
    if settings.weigh:
        weight, more = settings.weigh(chunk, near, prepared)
        for polygon, reason in more.items():
            verdict[polygon] = reason
    number = prepared.polygons.number
    with np.errstate(invalid="ignore", divide="ignore"):
        shell_share = shell[number] / feature_area[chunk.owner[number]]
    problem = Problem(chunk, prepared, weight, verdict, shell_share)
    for feature, reason in reasons.items():
        problem.refuse(feature, reason)
    return problem


def _floors(chunk, settings):
    """For each polygon what is too small to count, by name; and {feature: why it has no such number}."""
    import numpy as np

    reasons, floors = {}, {}
    for name, of in settings.floors.items():
        most = 100.0 if name == "SMALLEST_PART" else math.inf
        values = np.array([of(feature) for feature in chunk.features])
        for f in np.flatnonzero(~((values >= 0.0) & (values <= most))).tolist():
            reasons[f] = f"{name} must be a number from 0 on, and is {values[f]:g}"
            values[f] = 0.0
        floors[name] = values[chunk.owner]
    return floors, reasons


def reasons_of(feature, verdicts):
    """Return why polygons of a feature were not solved, each reason once, by the verdicts of all of them."""
    if not len(verdicts):
        return ["it has no geometry" if not feature.hasGeometry() else "it is empty"]
    return list(dict.fromkeys(verdict for verdict in verdicts if verdict))


def without_vertex(problem, selection, tau):
    """Count the places where a cut is missing for want of a vertex; ``tau`` is that of each feature."""
    from ...core.partition.solve import without_vertex

    found = without_vertex(problem.prepared, selection, tau[problem.owner])
    return int(by_feature(problem, found).sum())


def by_feature(problem, values):
    """Sum up numbers of the prepared polygons that are solved, for each feature."""
    import numpy as np

    solved = problem.verdict[problem.prepared.polygons.number] == ""
    return np.bincount(
        problem.owner[solved], weights=values[solved], minlength=len(problem.chunk.features)
    )


def pieces(problem, parts):
    """Arrange what became of the polygons of a chunk.

    Parameters
    ----------
    problem : Problem
    parts : core.partition.parts.Parts
        Of the prepared polygons.

    Returns
    -------
    Pieces
    """
    import numpy as np

    from ...core.rings import offsets_of, take

    rings, owner = problem.chunk.rings, problem.chunk.owner
    number = problem.prepared.polygons.number
    count, part_count = len(owner), len(parts.area)
    part_polygon = np.repeat(number, np.diff(parts.part_offsets))
    solved = np.flatnonzero(problem.verdict[part_polygon] == "")
    whole = np.flatnonzero(problem.verdict != "")
    # the parts, and behind them the polygons as they came
    polygon = np.concatenate((part_polygon[solved], whole))
    piece = np.concatenate((solved, part_count + whole))
    area = np.concatenate((
        parts.area[solved], _areas(rings, whole, problem.chunk.measure)[0]
    ))
    order = np.lexsort((piece, polygon, -area, owner[polygon]))
    rank = np.empty(part_count, dtype=np.int64)
    feature_offsets = offsets_of(np.bincount(owner[polygon], minlength=len(problem.chunk.features)))
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order)) - feature_offsets[owner[polygon[order]]] + 1
    rank[solved] = place[:len(solved)]
    polygon, piece, area = polygon[order], piece[order], area[order]

    single = np.bincount(part_polygon, minlength=count)[polygon] == 1
    piece = np.where(single, part_count + polygon, piece)
    rows = np.concatenate((parts.rows, np.arange(len(rings.coords))))
    offsets = np.append(parts.offsets[:-1], parts.offsets[-1] + rings.offsets)
    ring_offsets = np.append(
        parts.ring_offsets[:-1], parts.ring_offsets[-1] + rings.polygon_offsets
    )
    ring, ring_offsets = take(ring_offsets, piece)
    row, offsets = take(offsets, ring)
    return Pieces(feature_offsets, polygon, area, rows[row], offsets, ring_offsets, rank)


def _areas(rings, which, measure):
    """Areas of some polygons, and of their shells; 0 where they have none."""
    import numpy as np

    from ...core.rings import signed_areas, take

    area, shell = np.zeros(len(which)), np.zeros(len(which))
    ring, polygon_offsets = take(rings.polygon_offsets, which)
    size = np.diff(rings.offsets)[ring]
    if not len(ring):
        return area, shell
    hollow = np.minimum.reduceat(size, polygon_offsets[:-1]) == 0
    if hollow.any():
        area[~hollow], shell[~hollow] = _areas(rings, which[~hollow], measure)
        return area, shell
    row, offsets = take(rings.offsets, ring)
    with np.errstate(all="ignore"):
        own = np.abs(signed_areas(measure.equal_area(rings.coords[row, :2]), offsets))
        shell = own[polygon_offsets[:-1]]
        area = np.nan_to_num(shell - (np.add.reduceat(own, polygon_offsets[:-1]) - shell))
        return np.minimum(np.maximum(area, 0.0), 1e300), np.minimum(np.nan_to_num(shell), 1e300)


def weigh_by_length(chunk, near, prepared):
    """Weights of MinLength."""
    return prepared.chord, {}


def weigh_by_expression(text, source, lines, context):
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
        import numpy as np

        polygon = prepared.polygons.number[prepared.owner]
        feature_of = chunk.owner[polygon].tolist()
        geometries = wkb.line_geometries(
            chunk.rings.coords, prepared.edge_rows, [chunk.extra[f] for f in feature_of]
        )
        weights, reasons = np.zeros(len(prepared.edges)), {}
        candidate = QgsFeature(fields)
        for k, (geometry, p, f, length, detour) in enumerate(
            zip(geometries, polygon.tolist(), feature_of, prepared.chord.tolist(),
                prepared.detour.tolist())
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
            name = geometry.asWkt(6) if line is None else f"line {lines.ids[line]}"
            reason = expression.evalErrorString() or "it must be a number of at least 0"
            reasons[p] = f"the weight of candidate {name} cannot be used: {reason}"
        return weights, reasons

    return weigh


def expression_problem(text, all_fields):
    """Return why an expression for the fields of polygons, and of lines, is of no use, or ''."""
    if not text.strip():
        return "MinWeight needs an expression for the weight of a candidate (WEIGHT)."
    expression = QgsExpression(text)
    if expression.hasParserError():
        return f"The expression for the weight (WEIGHT) is not valid: {expression.parserErrorString()}"
    known = set(all_fields[0].names())
    if len(all_fields) > 1:  # as the candidates have them
        known = set(QgsProcessingUtils.combineFields(*all_fields).names())
    unknown = expression.referencedColumns() - known - {QgsFeatureRequest.ALL_ATTRIBUTES}
    if unknown:
        return f"The expression for the weight (WEIGHT) uses an unknown field: {min(unknown)}."
    return ""


def _number(value):
    """The value as a float; NaN where it is none."""
    if value is None or value == NULL or isinstance(value, bool):
        return math.nan
    try:
        return float(value)
    except (TypeError, ValueError):
        return math.nan
