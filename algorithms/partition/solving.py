"""From the geometry of a feature to solved polygons: what all partition tools share."""

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

from ...core.errors import Unsolvable
from ...core.progress import checker, stretch
from ..layers import wkb


class Settings(NamedTuple):
    """How to solve, the same for all features.

    Attributes
    ----------
    measure : core.metric.Metric
    min_length, min_hole : float
    lines : CandidateLines or None
    weigh : callable or None
        ``(feature, coords, near, prepared)`` to the weights of the candidates; None for MinSize.
        ``near`` has the numbers of the lines given for this polygon, or is None.
    all_dilations : bool
    """

    measure: object
    min_length: float
    min_hole: float
    lines: object
    weigh: Callable
    all_dilations: bool


class Solved(NamedTuple):
    """One polygon of a feature.

    Attributes
    ----------
    coords : (k, d) float
        Its vertices.
    offsets : (r + 1,) int
        Where each of its rings starts.
    partition : core.partition.solve.Partition or None
    problem : str
        Why there is no partition, or ''.
    area : (m,) float
        Areas of its parts, the largest first.
    """

    coords: object
    offsets: object
    partition: object
    problem: str
    area: object

    def rings(self, part):
        """Rings of rows of a part; a polygon in one piece stays as it was."""
        if len(self.area) > 1:
            return self.partition.parts.rings[part]
        import numpy as np

        return [np.arange(lo, hi) for lo, hi in zip(self.offsets[:-1], self.offsets[1:])]


class Task(NamedTuple):
    """One polygon of a feature, ready to be solved.

    Attributes
    ----------
    coords, offsets
        See `Solved`.
    prepared : core.partition.solve.Prepared or None
    weight : (k,) float or None
        Weights of the candidates; None for MinSize.
    problem : str
        Why it is not ready, or ''.
    """

    coords: object
    offsets: object
    prepared: object
    weight: object
    problem: str


def measure_of(crs):
    """Return the metric of a layer: its own plane, or its ellipsoid where it is in degrees."""
    from ...core import metric

    if not crs.isGeographic():
        return metric.planar()
    ellipsoid = QgsEllipsoidUtils.ellipsoidParameters(crs.ellipsoidAcronym())
    if not ellipsoid.valid:
        return metric.ellipsoidal()
    return metric.ellipsoidal(ellipsoid.semiMajor, ellipsoid.semiMinor)


def solve(feature, settings, choose, feedback, progress):
    """Partition the polygons of a feature.

    Parameters
    ----------
    feature : QgsFeature
    settings : Settings
    choose : callable
        ``(tasks, check)`` to one Selection for each task.
    feedback : QgsProcessingFeedback
    progress : callable
        Called with the share done of this feature.

    Returns
    -------
    list of Solved
        Empty for a geometry without polygons.

    Raises
    ------
    Cancelled
    """
    from ...core.partition.solve import finish

    check = checker(progress, feedback.isCanceled)
    tasks = prepare_tasks(feature, settings, feedback, stretch(check, 0.0, 0.65))
    ready = [task for task in tasks if not task.problem]
    try:
        selections = choose(ready, stretch(check, 0.65, 0.9)) if ready else []
    except Unsolvable as problem:
        tasks = [task._replace(problem=task.problem or str(problem)) for task in tasks]
        selections = []
    remaining = iter(selections)
    solved = []
    for task in tasks:
        if task.problem:
            area = [_area(task.coords, task.offsets, settings.measure)]
            solved.append(Solved(task.coords, task.offsets, None, task.problem, area))
            continue
        result = finish(task.prepared, next(remaining), settings.all_dilations, check)
        solved.append(Solved(task.coords, task.offsets, result, "", result.parts.area))
    check(1.0)
    return solved


def prepare_tasks(feature, settings, feedback, check):
    """Prepare the polygons of a feature; see `solve`.

    Returns
    -------
    list of Task
    """
    import numpy as np

    from ...core import metric
    from ...core.partition.solve import prepare

    parts = wkb.polygons(feature.geometry())
    measure, lines = settings.measure, settings.lines
    if measure.conformal and any(np.nanmax(np.abs(c[:, 1])) > 90.0 + 1e-9 for c, _ in parts):
        feedback.pushWarning(
            f"Feature {feature.id()} has a latitude beyond 90 degrees. Its coordinates are taken as "
            "those of a plane. Is the CRS of the layer right?"
        )
        measure = metric.planar()
    total = sum(len(coords) for coords, _ in parts)
    done, tasks = 0, []
    for coords, offsets in parts:
        near = lines.near(coords) if lines else None
        try:
            prepared = prepare(
                coords,
                offsets,
                settings.min_length,
                settings.min_hole,
                None if near is None else lines.ends[near],
                measure,
                check=stretch(check, done / total, (done + len(coords)) / total),
            )
            if near is not None:
                lines.note(near, prepared.lines)
            weight = settings.weigh and settings.weigh(feature, coords, near, prepared)
            tasks.append(Task(coords, offsets, prepared, weight, ""))
        except Unsolvable as problem:
            tasks.append(Task(coords, offsets, None, None, str(problem)))
        done += len(coords)
    return tasks


def weigh_by_length(feature, coords, near, prepared):
    """Weights of MinLength."""
    return prepared.length * prepared.polygon.unit


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

    def weigh(feature, coords, near, prepared):
        import numpy as np

        extra = wkb.dimensions(feature.geometry().wkbType())
        attributes = feature.attributes()
        edge_lines = None if near is None else near[prepared.lines.edge_line].tolist()
        unit = prepared.polygon.unit
        weights = np.empty(len(prepared.edges))
        candidate = QgsFeature(fields)
        for k, (rows, length, detour) in enumerate(
            zip(prepared.edge_rows, prepared.length.tolist(), prepared.detour.tolist())
        ):
            own = attributes if edge_lines is None else attributes + lines.attributes[edge_lines[k]]
            candidate.setAttributes(own)
            candidate.setGeometry(wkb.line_geometry(coords, rows, extra))
            scope.setVariable("length", length * unit)
            scope.setVariable("detour", detour if math.isfinite(detour) else NULL)
            scope.setFeature(candidate)
            weight = _number(expression.evaluate(context))
            if not 0.0 <= weight < math.inf:
                name = (
                    f"line {lines.ids[edge_lines[k]]}"
                    if edge_lines is not None
                    else candidate.geometry().asWkt(6)
                )
                reason = expression.evalErrorString() or "it must be a number of at least 0"
                raise Unsolvable(f"the weight of candidate {name} cannot be used: {reason}")
            weights[k] = weight
        return weights

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


def _area(coords, offsets, measure):
    """Area of a polygon that could not be solved, for its place among the parts."""
    import numpy as np

    from ...core.partition.polygon import signed_areas

    if (np.diff(offsets) == 0).any():
        return 0.0
    with np.errstate(all="ignore"):
        area = np.abs(signed_areas(measure.equal_area(coords[:, :2]), offsets))
        return float(np.nan_to_num(area[0] - area[1:].sum()))
