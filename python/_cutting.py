"""Polygons cut at their bottlenecks: what the tools of the plugin's group *Partition* do, for Python."""

from __future__ import annotations

import math
from typing import Any, Callable, Iterator, NamedTuple, Sequence

import numpy as np
import shapely

from . import _geometry, _kinds
from ._kinds import Source
from .core.partition import features, nesting
from .core.partition.features import Chunk, GivenLines, Problem
from .core.partition.solve import Prepared, finish

OBJECTIVES = ("MinSize", "MinLength", "MinWeight")
PLACES = ("Natural", "Any")
ROLES = np.array(("SELF", "LEAF", "ROOT"), dtype=object)


class Parts(NamedTuple):
    """Parts and cuts of polygons.

    Attributes
    ----------
    parts : GeometryCollection, array, GeoSeries or GeoDataFrame
        The kind that came in. A feature's parts follow one another, the largest first.
    cuts : GeometryCollection, array, GeoSeries or GeoDataFrame
        Lines.
    part_fields, cut_fields : dict of str to array
        What is told of each part and cut, by the names of the tools' fields; ``source`` is the index label
        of the polygon, or its place. A GeoDataFrame has them as columns as well.
    diagonals, diagonal_fields
        All candidates, where they are asked for.

    Notes
    -----
    What of a feature could not be cut comes through unchanged, with the reason in the field ``status``, and a
    warning. Numbers that there are not are NaN; a detour is NaN where only a cut connects the ends.
    """

    parts: Any
    cuts: Any
    part_fields: dict[str, np.ndarray]
    cut_fields: dict[str, np.ndarray]
    diagonals: Any = None
    diagonal_fields: dict[str, np.ndarray] | None = None


class Candidates(NamedTuple):
    """Possible cuts to be weighed; arrays with an entry for each.

    Attributes
    ----------
    length, detour : (k,) float
        The detour is infinite where only a cut connects the ends.
    ends : (k, 2, 2) float
    source : (k,)
        The polygon, by its index label or place.
    line : (k,)
        The line given as a candidate, by its index label or place; None of a triangulation.
    """

    length: np.ndarray
    detour: np.ndarray
    ends: np.ndarray
    source: np.ndarray
    line: np.ndarray


def partition(
    polygons: Any,
    *,
    tau: Any = 3.0,
    objective: str = "MinSize",
    weight: Callable[[Candidates], Any] | None = None,
    places: str = "Natural",
    smallest_part: Any = 1.0,
    min_length: Any = 0.0,
    min_hole: Any = 0.0,
    candidates: Any = None,
    new_vertices: bool = False,
    max_gap: float = 0.1,
    diagonals: bool = False,
    crs: Any = None,
) -> Parts:
    """Cut polygons at their isthmuses, straits and necks into natural parts.

    The tool ``isthmus:partition``: the fewest cuts (or the shortest, or the cheapest) that leave no place
    with a detour above tau. Cuts join vertices; none is moved, and none added unless you allow it
    (``new_vertices``).

    Parameters
    ----------
    polygons : shapely geometry, sequence of these, GeoSeries or GeoDataFrame
        Polygons and multipolygons.
    tau : float, sequence of float or str
        Largest detour: how many times longer than the straight line across a neck the way along the outline
        may be, at least 1. One number, one for each feature, or a column of the table; likewise
        ``smallest_part``, ``min_length`` and ``min_hole``.
    objective : {'MinSize', 'MinLength', 'MinWeight'}
        What to minimize: number, length or weight of the cuts.
    weight : callable, optional
        For MinWeight: called with `Candidates`, it returns a weight of at least 0 for each.
    places : {'Natural', 'Any'}
        Where a cut may lie: where people see parts meet, or anywhere, as in the paper. A natural cut may
        lead over a row of small holes that fills half of the way; its length is that of the rest.
    smallest_part : float, sequence of float or str
        In per cent of the feature: smaller parts are not cut off, smaller holes attract no cuts, smaller
        detail is not measured.
    min_length : float, sequence of float or str
        Shorter cuts are left out; in units of the CRS, or metres if these are degrees.
    min_hole : float, sequence of float or str
        Holes with a smaller area attract no cuts; in squared units, or square metres.
    candidates : lines, optional
        Straight lines between two vertices to choose the cuts from, instead of a triangulation's diagonals:
        a geometry, a sequence, a GeoSeries or a GeoDataFrame.
    new_vertices : bool
        Whether a cut may also end at the foot of a perpendicular from a concave vertex on the edge opposite,
        where blocks and floor plans have no vertex. Only those that a cut uses are added, with Z and M
        interpolated; neighbours do not get them. No effect with ``candidates``.
    max_gap : float
        For MinLength and MinWeight: largest gap to the proven lower bound, in per cent.
    diagonals : bool
        Whether all candidates are wanted, too.
    crs : object, optional
        Of geometries that have no CRS by themselves: whatever pyproj knows. Degrees are measured in metres
        on the ellipsoid. 'EPSG:4326' needs no pyproj.

    Returns
    -------
    Parts
        Of the kind that came in, with the fields of the tool: part, parts, status, cost, gap and source of
        the parts; source, length, detour, part_a, part_b and share of the cuts.

    Raises
    ------
    TypeError, ValueError
        If an argument cannot be used; it says which and why.

    Warns
    -----
    UserWarning
        If a feature was not cut, or a search ended at its limit of time.

    Notes
    -----
    For polygons without holes and MinSize no solution has fewer cuts (theorem 1 of Haunert and Meulemans
    2016). O(n log n) for n vertices; polygons are solved together, some thousands at once.

    Examples
    --------
    >>> rooms = shapely.from_wkt("POLYGON ((0 0, 10 0, 10 4, 13 4, 13 0, 23 0, 23 10, 13 10, 13 6, 10 6,"
    ...                          " 10 10, 0 10, 0 0))")
    >>> found = partition(rooms, smallest_part=0)
    >>> [part.area for part in found.parts.geoms]
    [100.0, 100.0, 6.0]
    >>> found.cut_fields["detour"].round(1)
    array([19., 19.])
    """
    _kinds.least(tau, "tau", 1.0)
    _kinds.least(max_gap, "max_gap", 0.0, 100.0)
    origin = _kinds.source(polygons, crs)
    bound = _kinds.numbers(origin, tau, "tau")
    settings = _settings(
        origin, objective, weight, places, smallest_part, min_length, min_hole, candidates, new_vertices
    )

    def choose(problem: Problem) -> tuple[Any, dict[int, str]]:
        selection, gaps = features.for_tau(problem, bound[problem.chunk.features], max_gap=max_gap / 100.0)
        return selection, {
            f: f"a gap of {100.0 * gap:.3g} per cent to the lower bound" for f, gap in gaps.items()
        }

    return _cut(origin, settings, choose, diagonals)


def partition_within(
    polygons: Any,
    *,
    budget: Any = 10.0,
    objective: str = "MinSize",
    weight: Callable[[Candidates], Any] | None = None,
    places: str = "Natural",
    smallest_part: Any = 1.0,
    min_length: Any = 0.0,
    min_hole: Any = 0.0,
    candidates: Any = None,
    new_vertices: bool = False,
    diagonals: bool = False,
    crs: Any = None,
) -> Parts:
    """Cut polygons as far as a budget allows.

    The tool ``isthmus:partitionbudget``: the smallest largest detour that so many cuts, or so much length or
    weight of cuts, achieve in each feature.

    Parameters
    ----------
    polygons : shapely geometry, sequence of these, GeoSeries or GeoDataFrame
    budget : float, sequence of float or str
        The largest number of cuts of a feature (MinSize), their length (MinLength) or weight (MinWeight).
    objective, weight, places, smallest_part, min_length, min_hole, candidates, new_vertices, diagonals, crs
        See `partition`.

    Returns
    -------
    Parts
        As of `partition`, and for each part the field tau: the detour achieved in its feature.

    Raises
    ------
    TypeError, ValueError
        If an argument cannot be used; it says which and why.

    Notes
    -----
    Measured: 8 to 30 times the work of `partition`.

    Examples
    --------
    >>> rooms = shapely.from_wkt("POLYGON ((0 0, 10 0, 10 4, 13 4, 13 0, 23 0, 23 10, 13 10, 13 6, 10 6,"
    ...                          " 10 10, 0 10, 0 0))")
    >>> found = partition_within(rooms, budget=1)
    >>> [part.area for part in found.parts.geoms], found.part_fields["tau"].round(2)
    ([106.0, 100.0], array([4., 4.]))
    """
    _kinds.least(budget, "budget", 0.0)
    origin = _kinds.source(polygons, crs)
    most = _kinds.numbers(origin, budget, "budget")
    settings = _settings(
        origin, objective, weight, places, smallest_part, min_length, min_hole, candidates, new_vertices
    )

    def choose(problem: Problem) -> tuple[Any, dict[int, str]]:
        selection, unproven = features.within_budget(problem, most[problem.chunk.features].tolist())
        return selection, {
            f: f"a smaller detour than {dilation:.6g} could not be ruled out"
            for f, dilation in unproven.items()
        }

    return _cut(origin, settings, choose, diagonals, with_tau=True)


def tradeoff(
    polygons: Any,
    *,
    objective: str = "MinSize",
    weight: Callable[[Candidates], Any] | None = None,
    tau_min: float = 4.0,
    tau_max: float = 0.0,
    steps: int = 50,
    places: str = "Natural",
    smallest_part: Any = 1.0,
    min_length: Any = 0.0,
    min_hole: Any = 0.0,
    candidates: Any = None,
    new_vertices: bool = False,
    crs: Any = None,
) -> Any:
    """Return what every value of tau costs.

    The tool ``isthmus:tradeoff``: a step function of each feature, from no cut at all down to a smallest tau.

    Parameters
    ----------
    polygons : shapely geometry, sequence of these, GeoSeries or GeoDataFrame
    tau_min, tau_max : float
        Where the curve ends and where it starts; 0 for ``tau_max`` starts with no cut but those that connect
        holes.
    steps : int
        The most steps of a feature.
    objective, weight, places, smallest_part, min_length, min_hole, candidates, new_vertices, crs
        See `partition`.

    Returns
    -------
    DataFrame, or dict of str to array
        A row for each step: source, tau (the least dilation achievable at this cost), cuts, length, cost and
        largest_part_share. A DataFrame has the index labels of the features.

    Raises
    ------
    TypeError, ValueError
        If an argument cannot be used; it says which and why.

    Examples
    --------
    >>> rooms = shapely.from_wkt("POLYGON ((0 0, 10 0, 10 4, 13 4, 13 0, 23 0, 23 10, 13 10, 13 6, 10 6,"
    ...                          " 10 10, 0 10, 0 0))")
    >>> steps = tradeoff(rooms, tau_min=1, smallest_part=0)
    >>> steps["tau"].round(2), steps["cuts"]
    (array([19.,  4.,  1.]), array([0, 1, 2]))
    """
    _kinds.least(tau_min, "tau_min", 1.0)
    if not (tau_max == 0.0 or tau_max >= tau_min):
        raise ValueError(f"tau_max must be 0 or at least tau_min ({tau_min:g}), and is {tau_max:g}.")
    steps = _kinds.whole(steps, "steps", 1)
    origin = _kinds.source(polygons, crs)
    settings = _settings(
        origin, objective, weight, places, smallest_part, min_length, min_hole, candidates, new_vertices
    )
    feature, rows, reasons = [], [], {}
    for problem, _ in _problems(origin, settings):
        found = features.curves(problem, tau_min, tau_max or math.inf, steps)
        why = _reasons(origin, problem)
        reasons.update(why)
        nothing = np.bincount(problem.chunk.owner[problem.verdict == ""], minlength=len(found)) == 0
        for f, (_, own) in enumerate(found):
            if not nothing[f]:
                feature += [int(problem.chunk.features[f])] * len(own)
                rows += own
    _kinds.tell(origin, reasons, "have no curve, or not of all their parts")
    settings.tell_lines()
    columns = [np.array(column) for column in zip(*rows)] or [np.empty(0)] * 5
    names = ("tau", "cuts", "length", "cost", "largest_part_share")
    of = np.array(feature, dtype=np.int64)
    return _kinds.table(origin, of, {"source": origin.ids[of], **dict(zip(names, columns))})


def hierarchy(
    polygons: Any,
    *,
    tau: Any = 1.5,
    parts: Any = None,
    places: str = "Natural",
    smallest_part: Any = 1.0,
    min_length: Any = 0.0,
    min_hole: Any = 0.0,
    new_vertices: bool = False,
    crs: Any = None,
) -> Parts:
    """Cut polygons once for every tau, and for every number of parts.

    The tool ``isthmus:hierarchy``: nested parts. Those at one tau are the ones with from_tau <= tau < to_tau.

    Parameters
    ----------
    polygons : shapely geometry, sequence of these, GeoSeries or GeoDataFrame
    tau : float, sequence of float or str
        Smallest tau, where the finest level begins.
    parts : int, sequence of int or str, optional
        Only the level in which a feature has so many parts, or the next best.
    places, smallest_part, min_length, min_hole, new_vertices, crs
        See `partition`.

    Returns
    -------
    Parts
        Every part of every level once, with part, parent (NaN for those that stay), level, from_tau, to_tau
        (1e9: for ever), source and status; cuts with source, length, detour, persistence and rank.

    Raises
    ------
    TypeError, ValueError
        If an argument cannot be used; it says which and why.

    Examples
    --------
    >>> rooms = shapely.from_wkt("POLYGON ((0 0, 10 0, 10 4, 13 4, 13 0, 23 0, 23 10, 13 10, 13 6, 10 6,"
    ...                          " 10 10, 0 10, 0 0))")
    >>> found = hierarchy(rooms, smallest_part=0)
    >>> [part.area for part in found.parts.geoms]
    [100.0, 100.0, 6.0, 106.0, 206.0]
    >>> found.part_fields["level"]
    array([0, 0, 0, 1, 2])
    """
    _kinds.least(tau, "tau", 1.0, nesting.NO_END)
    _kinds.least(parts, "parts", 1.0)
    origin = _kinds.source(polygons, crs)
    begin = _kinds.numbers(origin, tau, "tau")
    count = None if parts is None else _kinds.numbers(origin, parts, "parts")
    settings = _settings(
        origin, "MinSize", None, places, smallest_part, min_length, min_hole, None, new_vertices
    )
    out = _Out(origin)
    for problem, shapes in _problems(origin, settings):
        chunk = problem.chunk
        own = None if count is None else count[chunk.features]
        nested = nesting.nest(problem, begin[chunk.features], count=own)
        items = nesting.items_of(problem, nested)
        extra = chunk.extra[items.feature]

        def made(
            which: np.ndarray,
            rows: np.ndarray,
            offsets: np.ndarray,
            ring_offsets: np.ndarray,
            chunk: Chunk = chunk,
            extra: np.ndarray = extra,
        ) -> Iterator:
            return iter(_geometry.polygons(chunk.rings.coords, rows, offsets, ring_offsets, extra[which]))

        geometry = _objects(nesting.shapes(problem, nested, items, made), len(items.feature))
        whole = items.whole >= 0
        geometry[whole] = shapes[items.whole[whole]]
        status = np.where(whole, _plain(problem.verdict[items.whole]), "")
        fields = {
            "part": items.number,
            "parent": np.where(items.parent, items.parent, np.nan),
            "level": items.level,
            "from_tau": items.from_tau,
            "to_tau": items.to_tau,
        }
        reasons = _reasons(origin, problem)
        # of a feature of which nothing is solved there is one piece, as it came
        nothing = _nothing(problem)
        kept = ~nothing[items.feature]
        alone = np.flatnonzero(nothing)
        ones = {
            "part": np.ones(len(alone), dtype=np.int64),
            "parent": np.full(len(alone), np.nan),
            "level": np.zeros(len(alone), dtype=np.int64),
            "from_tau": nested.tau[alone],
            "to_tau": np.full(len(alone), nesting.NO_END),
        }
        why = [reasons[int(f)] for f in chunk.features[alone]]
        out.add_parts(
            chunk,
            np.append(items.feature[kept], alone),
            np.append(geometry[kept], origin.geometries[chunk.features[alone]]),
            {name: np.append(values[kept], ones[name]) for name, values in fields.items()},
            np.append(status[kept], np.array(why, dtype=object)),
        )
        out.reasons.update(reasons)
        feature, edges, more = nesting.cuts(problem, nested)
        out.add_lines("cuts", problem, edges, feature, {**more, "detour": _finite(more["detour"])})
    names = ("part", "parent", "level", "from_tau", "to_tau", "source", "status")
    return out.results(settings, names)


class _Settings(NamedTuple):
    """How to solve: options of all features."""

    natural: bool
    new_vertices: bool
    floors: dict[str, np.ndarray]
    lines: GivenLines | None
    bent: list
    weigh: Callable | None

    def tell_lines(self) -> None:
        """Warn of lines that are no candidates."""
        if self.lines is None:
            return
        left = [(k, "it is not one straight line between two points") for k in self.bent]
        left += self.lines.left_out()
        if left:
            some = "; ".join(f"{k}: {reason}" for k, reason in left[: _kinds.NAMED])
            more = " ..." if len(left) > _kinds.NAMED else ""
            _kinds.warn(f"{len(left)} candidate lines were left out: {some}{more}.")


def _settings(
    origin: Source,
    objective: str,
    weight: Callable | None,
    places: str,
    smallest_part: Any,
    min_length: Any,
    min_hole: Any,
    candidates: Any,
    new_vertices: bool,
) -> _Settings:
    _kinds.one_of(objective, "objective", OBJECTIVES)
    _kinds.one_of(places, "places", PLACES)
    _kinds.least(smallest_part, "smallest_part", 0.0, 100.0)
    _kinds.least(min_length, "min_length", 0.0)
    _kinds.least(min_hole, "min_hole", 0.0)
    lines, bent = None, []
    if candidates is not None:
        lines, bent = _given(origin, candidates)
    weigh = features.weigh_by_length if objective == "MinLength" else None
    if objective == "MinWeight":
        if not callable(weight):
            raise ValueError("MinWeight needs a function that weighs the candidates (weight).")
        weigh = _weigher(origin, lines, weight)
    floors = {
        name: _kinds.numbers(origin, value, name)
        for name, value in (
            ("smallest_part", smallest_part),
            ("min_length", min_length),
            ("min_hole", min_hole),
        )
    }
    return _Settings(places == "Natural", new_vertices, floors, lines, bent, weigh)


def _given(origin: Source, candidates: Any) -> tuple[GivenLines, list]:
    """Lines to choose from, in the CRS of the polygons, and those that are not straight."""
    if hasattr(candidates, "to_crs") and candidates.crs is not None and hasattr(origin.crs, "is_geographic"):
        candidates = candidates.to_crs(origin.crs)
    given = _kinds.source(candidates, what="candidates")
    parts, owner = shapely.get_parts(given.geometries, return_index=True)
    straight = (shapely.get_type_id(parts) == 1) & (shapely.get_num_coordinates(parts) == 2)
    ids = given.ids
    bent = np.bincount(owner[straight], minlength=len(ids)) != np.bincount(owner, minlength=len(ids))
    bent |= np.bincount(owner, minlength=len(ids)) == 0
    ends = shapely.get_coordinates(parts[straight]).reshape(-1, 2, 2)
    return GivenLines(ends, ids[owner[straight]].tolist()), ids[bent].tolist()


def _weigher(origin: Source, lines: GivenLines | None, weight: Callable) -> Callable:
    """The function that weighs the candidates of a chunk by the user's."""
    ids = origin.ids

    def weigh(chunk: Chunk, near: list | None, prepared: Prepared) -> tuple[np.ndarray, dict[int, str]]:
        polygon = prepared.polygons.number[prepared.owner]
        line = np.full(len(polygon), None, dtype=object)
        if lines is not None and near is not None and prepared.edge_line is not None:
            line[:] = [lines.ids[near[p][k]] for p, k in zip(polygon.tolist(), prepared.edge_line.tolist())]
        ends = chunk.rings.coords[prepared.edge_rows, :2]
        one = Candidates(
            prepared.chord, prepared.detour, ends, ids[chunk.features[chunk.owner[polygon]]], line
        )
        weights = np.array(weight(one), dtype=float)
        if weights.shape != polygon.shape:
            raise ValueError(
                f"weight must return a number for each of {len(polygon)} candidates, and returned an array "
                f"of shape {weights.shape}."
            )
        bad = ~((weights >= 0.0) & (weights < np.inf))
        reasons = {
            int(polygon[k]): f"the weight of candidate {shapely.linestrings(ends[k]).wkt} cannot be used: it "
            "must be a number of at least 0"
            for k in np.flatnonzero(bad)[::-1].tolist()
        }
        return np.where(bad, 0.0, weights), reasons

    return weigh


def _problems(origin: Source, settings: _Settings) -> Iterator[tuple[Problem, np.ndarray]]:
    """The chunks of a source, prepared, and their polygons as they are."""
    strange = {}
    measure = _kinds.measure_of(origin.crs)
    for chunk, shapes in _geometry.chunks(origin.geometries, measure):
        if chunk.measure is not measure:
            strange.update(dict.fromkeys(np.asarray(chunk.features).tolist(), "a latitude beyond 90 degrees"))
        floors = {name: values[chunk.features] for name, values in settings.floors.items()}
        yield (
            features.prepare(
                chunk,
                natural=settings.natural,
                lines=settings.lines,
                new_vertices=settings.new_vertices,
                weigh=settings.weigh,
                **floors,
            ),
            shapes,
        )
    _kinds.tell(origin, strange, "are measured in the plane (is the CRS right?)")


def _nothing(problem: Problem) -> np.ndarray:
    """(f,) bool: the features of which no polygon is solved."""
    good = problem.chunk.owner[problem.verdict == ""]
    return np.bincount(good, minlength=len(problem.chunk.features)) == 0


def _plain(sentences: np.ndarray) -> np.ndarray:
    """Sentences of the core as plain texts, as they stand in a table."""
    return sentences.astype(str).astype(object)


def _reasons(origin: Source, problem: Problem) -> dict[int, str]:
    """Why features of a chunk were not cut, or not all of their parts, by place in the source."""
    chunk, reasons = problem.chunk, {}
    for q in np.flatnonzero(problem.verdict != "").tolist():
        reasons.setdefault(int(chunk.features[chunk.owner[q]]), {})[problem.verdict[q]] = None
    found = {f: "; ".join(own) for f, own in reasons.items()}
    without = np.bincount(chunk.owner, minlength=len(chunk.features)) == 0
    for f in chunk.features[without].tolist():
        one = origin.geometries[f]
        found[f] = (
            "it has no geometry" if one is None else "it is empty" if one.is_empty else "it is no polygon"
        )
    return dict(sorted(found.items()))


def _cut(
    origin: Source, settings: _Settings, choose: Callable, diagonals: bool, with_tau: bool = False
) -> Parts:
    """Solve all features, and arrange what came of them."""
    out, ended = _Out(origin), {}
    for problem, shapes in _problems(origin, settings):
        chunk = problem.chunk
        selection, open_ends = choose(problem)
        ended.update({int(chunk.features[f]): what for f, what in open_ends.items()})
        solution = finish(problem.prepared, selection, all_dilations=diagonals)
        found = features.pieces(problem, solution.parts)
        cost, _, gap = features.costs(problem, solution)
        values = {"cost": cost, "gap": gap}
        if with_tau:
            values["tau"] = features.largest_dilations(problem, solution)
        feature, geometry = _pieces(problem, found, shapes)
        number = np.arange(len(feature)) - found.feature_offsets[feature] + 1
        reasons, nothing = _reasons(origin, problem), _nothing(problem)
        kept = ~nothing[feature]
        alone = np.flatnonzero(nothing)
        feature, total = np.append(feature[kept], alone), np.diff(found.feature_offsets)
        fields = {
            "part": np.append(number[kept], np.ones(len(alone), dtype=np.int64)),
            "parts": np.where(nothing, 1, total)[feature],
            **{name: np.where(nothing, np.nan, own)[feature] for name, own in values.items()},
        }
        why = [reasons[int(f)] for f in chunk.features[alone]]
        status = np.append(_plain(problem.verdict[found.polygon][kept]), np.array(why, dtype=object))
        as_it_came = origin.geometries[chunk.features[alone]]
        out.add_parts(chunk, feature, np.append(geometry[kept], as_it_came), fields, status)
        out.reasons.update(reasons)
        chosen, more = features.cuts(problem, solution, found)
        owner = problem.owner[solution.owner[chosen]]
        out.add_lines("cuts", problem, chosen, owner, {**more, "detour": _finite(more["detour"])})
        if diagonals:
            chosen = np.flatnonzero(problem.solved[solution.owner])
            out.add_lines(
                "diagonals",
                problem,
                chosen,
                problem.owner[solution.owner[chosen]],
                {
                    "length": solution.length[chosen],
                    "detour": _finite(solution.detour[chosen]),
                    "dilation": np.asarray(solution.dilation)[chosen],
                    "role": ROLES[solution.role[chosen]],
                },
            )
    _kinds.tell(origin, ended, "were solved to the limit of time")
    names = ("part", "parts", "status", "cost", "gap", "source") + ("tau",) * with_tau
    return out.results(settings, names)


def _pieces(problem: Problem, found: features.Pieces, shapes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The feature of each piece, and its geometry; a polygon in one piece is itself."""
    chunk = problem.chunk
    feature = chunk.owner[found.polygon]
    count = np.bincount(found.polygon, minlength=len(chunk.owner))
    geometry = shapes[found.polygon]
    cut = np.flatnonzero(count[found.polygon] > 1)
    ring, ring_offsets = features.take(found.ring_offsets, cut)
    row, offsets = features.take(found.offsets, ring)
    geometry[cut] = _geometry.polygons(
        chunk.rings.coords, found.rows[row], offsets, ring_offsets, chunk.extra[feature[cut]]
    )
    return feature, geometry


def _finite(values: np.ndarray) -> np.ndarray:
    return np.where(np.isfinite(values), values, np.nan)


def _objects(geometries: Iterator, count: int) -> np.ndarray:
    made = np.empty(count, dtype=object)
    made[:] = list(geometries)
    return made


class _Out:
    """Collects what comes of the chunks, and arranges it as the kind that came in."""

    def __init__(self, origin: Source) -> None:
        self.origin, self.ids = origin, origin.ids
        self.reasons: dict[int, str] = {}
        self.layers: dict[str, list[tuple]] = {"parts": [], "cuts": [], "diagonals": []}

    def add_parts(
        self, chunk: Chunk, feature: np.ndarray, geometry: np.ndarray, fields: dict, status: np.ndarray
    ) -> None:
        """Add parts, in any order of features; those of one stay together."""
        order = np.argsort(feature, kind="stable")
        fields = {name: values[order] for name, values in {**fields, "status": status}.items()}
        self.layers["parts"].append((chunk.features[feature[order]], geometry[order], fields))

    def add_lines(
        self, name: str, problem: Problem, edges: np.ndarray, feature: np.ndarray, fields: dict
    ) -> None:
        """Add cuts or diagonals."""
        chunk = problem.chunk
        rows, offsets = problem.prepared.way_rows(edges)
        made = _geometry.lines(chunk.rings.coords, rows, chunk.extra[feature], offsets)
        self.layers[name].append((chunk.features[feature], made, fields))

    def results(self, settings: _Settings, names: Sequence[str]) -> Parts:
        """Return what was collected, the fields of the parts by their names in order."""
        _kinds.tell(self.origin, self.reasons, "were not cut, or not all of their parts")
        settings.tell_lines()
        parts, part_fields = self._layer("parts", names)
        cuts, cut_fields = self._layer("cuts", None)
        found = Parts(parts, cuts, part_fields, cut_fields)
        if not self.layers["diagonals"]:
            return found
        diagonals, diagonal_fields = self._layer("diagonals", None)
        return found._replace(diagonals=diagonals, diagonal_fields=diagonal_fields)

    def _layer(self, name: str, names: Sequence[str] | None) -> tuple[Any, dict[str, np.ndarray]]:
        chunks = self.layers[name]
        feature = np.concatenate([of for of, _, _ in chunks] or [np.empty(0, dtype=np.int64)])
        geometry = np.concatenate([own for _, own, _ in chunks] or [np.empty(0, dtype=object)])
        fields = {"source": self.ids[feature]}
        for field in chunks[0][2] if chunks else ():
            fields[field] = np.concatenate([own[field] for _, _, own in chunks])
        if names is not None and chunks:
            fields = {field: fields[field] for field in names}
        return _kinds.result(self.origin, geometry, feature, fields, with_own=name == "parts"), fields
