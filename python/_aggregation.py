"""Areas of a map cut and joined: what the tools of the plugin's group *Area aggregation* do, for Python."""

from __future__ import annotations

from typing import Any, Iterable, Mapping, NamedTuple, Sequence

import numpy as np
import shapely

from . import _geometry, _kinds
from ._cutting import OBJECTIVES, PLACES, _nothing, _pieces, _plain, _problems, _reasons, _settings
from ._kinds import Source
from .core.aggregation import areas as core
from .core.aggregation.coverage import each_pair, faults, joined
from .core.aggregation.exact import Exact
from .core.aggregation.instance import Costs, Instance, Solution, costs
from .core.aggregation.methods import by_method
from .core.aggregation.outcome import Outcome, lost_areas, outcome
from .core.aggregation.presets import BOUNDARIES, DISTANCES, METHODS, PRESETS
from .core.aggregation.tables import distances as class_distances
from .core.aggregation.tables import text
from .core.aggregation.tables import thresholds as class_thresholds
from .core.partition import features
from .core.partition.solve import finish, select
from .core.rings import Rings


class Pieces(NamedTuple):
    """Areas cut at their bottlenecks.

    Attributes
    ----------
    pieces : GeometryCollection, array, GeoSeries or GeoDataFrame
        The kind that came in.
    piece_fields : dict of str to array
        area_id (the index label of the area, or its place), piece (a number from 1 on; NaN for an area
        without geometry), size (in square metres) and status.
    neighbours : dict of str to array
        Neighbouring pieces a and b, the length of their shared boundary in metres, and virtual: 1 for a cut
        between two pieces of one area.
    """

    pieces: Any
    piece_fields: dict[str, np.ndarray]
    neighbours: dict[str, np.ndarray]


class Regions(NamedTuple):
    """Areas aggregated to regions.

    Attributes
    ----------
    regions : GeometryCollection, array, GeoSeries or GeoDataFrame
        The kind that came in; each region has the index label of its core.
    region_fields : dict of str to array
        region (number), the class, size (square metres), areas (how many), core (the index label or place
        of the area whose class was kept) and status (why it is too small).
    assignment : GeometryCollection, array, GeoSeries or GeoDataFrame
        The areas; pieces of one area that ended in one region are one again.
    assignment_fields : dict of str to array
        region, new_class, changed (1 or 0) and status.
    costs : Costs
        Its ``total``, and of what it is made.
    lower_bound : float or None
        Of the exact method.
    lost : dict of str to (int, int)
        For each class, the areas above half of the smallest size that lost it, and how many there are.
    """

    regions: Any
    region_fields: dict[str, np.ndarray]
    assignment: Any
    assignment_fields: dict[str, np.ndarray]
    costs: Costs
    lower_bound: float | None
    lost: dict[str, tuple[int, int]]


def prepare_aggregation(
    areas: Any,
    *,
    class_: Any = None,
    tau: float = 4.0,
    objective: str = "MinSize",
    places: str = "Any",
    smallest_part: Any = 0.0,
    min_length: Any = 0.0,
    min_hole: Any = 0.0,
    new_vertices: bool = False,
    crs: Any = None,
) -> Pieces:
    """Cut the areas of a map at their bottlenecks, before they are aggregated.

    The tool ``isthmus:prepareaggregation``. No vertex is moved, and where new ones are allowed neighbours get
    them, too: what neighbours share they still share.

    Parameters
    ----------
    areas : shapely geometry, sequence of these, GeoSeries or GeoDataFrame
        They fill the map without overlaps and gaps; what is found of these is warned of.
    class_ : str or sequence, optional
        The class of each area, or its column: areas without one are warned of.
    tau : float
        See `isthmus.partition`, for all areas.
    objective : {'MinSize', 'MinLength'}
    places, smallest_part, min_length, min_hole, new_vertices, crs
        See `isthmus.partition`; places and smallest_part are those of the paper by default.

    Returns
    -------
    Pieces

    Raises
    ------
    TypeError, ValueError
        If an argument cannot be used; it says which and why.

    Examples
    --------
    >>> rooms = shapely.from_wkt("POLYGON ((0 0, 10 0, 10 4, 13 4, 13 0, 23 0, 23 10, 13 10, 13 6, 10 6,"
    ...                          " 10 10, 0 10, 0 0))")
    >>> found = prepare_aggregation([rooms, shapely.box(23, 0, 30, 10)])
    >>> found.piece_fields["size"], found.neighbours["length"]
    (array([106., 100.,  70.]), array([ 2., 10.]))
    """
    _kinds.least(tau, "tau", 1.0)
    _kinds.one_of(objective, "objective", OBJECTIVES[:2])
    _kinds.one_of(places, "places", PLACES)
    origin = _kinds.source(areas, crs, what="areas")
    settings = _settings(
        origin, objective, None, places, smallest_part, min_length, min_hole, None, new_vertices
    )
    measure, metre = _kinds.measure_of(origin.crs), _kinds.metres_of(origin.crs)
    area, geometry, status, rings, new, reasons = [], [], [], [], [], {}
    for problem, shapes in _problems(origin, settings):
        chunk = problem.chunk
        selection = select(problem.prepared, tau, weight=problem.weight, with_dilation=False)
        found = features.pieces(problem, finish(problem.prepared, selection).parts)
        feature, own = _pieces(problem, found, shapes)
        why, total = _reasons(origin, problem), np.diff(found.feature_offsets)
        reasons.update(why)
        as_it_came = (total == 1) & _nothing(problem)
        own[as_it_came[feature]] = origin.geometries[chunk.features[feature[as_it_came[feature]]]]
        area.append(chunk.features[feature])
        geometry.append(own)
        status.append(_plain(problem.verdict[found.polygon]))
        rings.append(Rings(chunk.rings.coords[found.rows], found.offsets, found.ring_offsets))
        new.append(found.rows >= len(chunk.rings.coords) - len(problem.prepared.new_rows))
    of = np.concatenate([np.empty(0, dtype=np.int64), *area])
    all_rings = core.joined_rings(_alike(rings))
    verdicts = np.concatenate([np.empty(0, dtype=object), *status])
    made = np.concatenate([np.empty(0, dtype=object), *geometry])
    is_new = np.concatenate([np.empty(0, dtype=bool), *new])
    arranged, all_rings, grown = core.arrange_pieces(all_rings, is_new, measure, metre)
    if is_new.any():
        extra = _geometry.extra_of(origin.geometries)[of]
        rows = np.arange(len(all_rings.coords))
        anew = _geometry.polygons(all_rings.coords, rows, all_rings.offsets, all_rings.polygon_offsets, extra)
        made = np.where(grown | (verdicts == ""), anew, made)
    pairs, length = core.neighbours(arranged)
    empty = np.setdiff1d(np.arange(len(origin.geometries)), of)
    everything = np.append(of, empty)
    fields = {
        "area_id": origin.ids[everything],
        "piece": np.append(np.arange(1.0, len(of) + 1.0), np.full(len(empty), np.nan))
        if len(empty)
        else np.arange(1, len(of) + 1),
        "size": np.append(arranged.size, np.zeros(len(empty))),
        "status": np.append(verdicts, np.array([reasons[int(k)] for k in empty], dtype=object)),
    }
    shapes = np.append(made, origin.geometries[empty])
    _kinds.tell(origin, reasons, "were not cut, or not all of their parts")
    _tell_faults(origin, arranged, of)
    if class_ is not None:
        without = [k for k, one in enumerate(_classes(origin, class_)[1]) if one is None]
        _kinds.tell(origin, dict.fromkeys(without, "no class"), "will be left as they are by aggregation")
    neighbours = {
        "a": pairs[:, 0] + 1,
        "b": pairs[:, 1] + 1,
        "length": length,
        "virtual": (of[pairs[:, 0]] == of[pairs[:, 1]]).astype(np.int64),
    }
    return Pieces(_kinds.result(origin, shapes, everything, fields), fields, neighbours)


def _alike(chunks: list[Rings]) -> list[Rings]:
    """Rings of chunks with as many ordinates in each; what one lacks is 0."""
    width = max((own.coords.shape[1] for own in chunks), default=2)
    return [
        own._replace(coords=np.pad(own.coords, ((0, 0), (0, width - own.coords.shape[1])))) for own in chunks
    ]


def aggregate(
    areas: Any,
    *,
    class_: Any,
    threshold: float = 400_000.0,
    thresholds: Mapping[Any, float | None] | None = None,
    excluded: Iterable[Any] = (),
    distance: str = "equal",
    distances: Mapping[tuple, float] | None = None,
    weights: str = "balanced",
    weight_change: float | None = None,
    weight_boundary: float | None = None,
    boundary: str = "regions",
    weight_centre: float | None = None,
    method: str = "annealing",
    seed: int = 1,
    iterations: int = 0,
    seconds: float = 0.0,
    regions: int = 0,
    area_id: Any = None,
    decompose: bool = True,
    crs: Any = None,
) -> Regions:
    """Join the areas of a map to regions of a minimum size, at least cost.

    The tool ``isthmus:aggregate``; the problem is that of Haunert and Wolff 2010. Takes the pieces of
    `prepare_aggregation`, too.

    Parameters
    ----------
    areas : sequence of shapely geometries, GeoSeries or GeoDataFrame
    class_ : str or sequence
        The class of each area, or its column.
    threshold : float
        How large every region must be at least, in square metres.
    thresholds : mapping, optional
        Classes with sizes of their own; with None a class may not appear in the result.
    excluded : iterable
        Classes that may not appear in the result.
    distance : {'equal', 'code', 'table'}
        equal: every change counts 1. code: hierarchical codes such as CORINE's. table: as ``distances`` say.
    distances : mapping, optional
        The distance for each (from, to); where one direction is missing, that of the other.
    weights : {'keep classes', 'balanced', 'compact'}
    weight_change, weight_boundary, weight_centre : float, optional
        Instead of those of the named weights.
    boundary : {'regions', 'classes'}
        Which boundaries count.
    method : {'annealing', 'greedy', 'exact'}
        'exact' needs scipy. 'annealing' uses it on parts of at most 20 areas, where it is there and nothing
        (steps, seconds, number of regions) is given.
    seed, iterations, seconds, regions : int, int, float, int
        Of annealing; steps (0: 10,000 an area), a limit of time instead (0: none; for 'exact' 60), and the
        number of regions wanted (0: free).
    area_id : str or sequence, optional
        What is equal for the pieces of one area, or its column. Default: the column area_id of pieces.
    decompose : bool
        Exact: an area that is large enough is always the core of a region.
    crs : object, optional
        See `isthmus.partition`.

    Returns
    -------
    Regions

    Raises
    ------
    TypeError, ValueError
        If an argument cannot be used; it says which and why.
    IsthmusError
        If a table lacks something, costs are too large, or scipy is missing for 'exact'.

    Examples
    --------
    >>> fields = [shapely.box(0, 0, 800, 600), shapely.box(800, 0, 900, 600), shapely.box(900, 0, 1800, 600)]
    >>> found = aggregate(fields, class_=["wood", "road", "meadow"], method="greedy")
    >>> found.region_fields["class"].tolist(), found.region_fields["areas"].tolist()
    (['wood', 'meadow'], [2, 1])
    """
    _kinds.one_of(distance, "distance", DISTANCES)
    _kinds.one_of(weights, "weights", tuple(PRESETS))
    _kinds.one_of(boundary, "boundary", BOUNDARIES)
    _kinds.one_of(method, "method", METHODS)
    if distance == "table" and distances is None:
        raise ValueError("A table of class distances (distances) is needed, or another way to measure them.")
    weight = _weights(weights, weight_change, weight_boundary, weight_centre)
    _kinds.number(threshold, "threshold", 0.0)
    _kinds.number(seconds, "seconds", 0.0)
    seed, iterations, regions = (
        _kinds.whole(value, name, 0)
        for value, name in ((seed, "seed"), (iterations, "iterations"), (regions, "regions"))
    )
    origin = _kinds.source(areas, crs, what="areas")
    values, texts = _classes(origin, class_)
    sources, size_column = _sources(origin, area_id)
    found, arranged, left = _read(origin, texts)
    names = sorted({one for one in texts if one is not None})
    theta, matrix = _tables(names, threshold, thresholds, excluded, distance, distances)
    problem = core.posed(arranged, texts, names, list(left), theta, matrix, weight, boundary == "classes")
    shaped = np.zeros(len(texts), dtype=bool)
    shaped[found.owner] = True
    options = {"seed": seed, "iterations": iterations, "seconds": seconds, "decompose": decompose}
    best, result = _solved(problem, method, regions, int((~shaped).sum()), options)
    out = outcome(problem, best, shaped, sources, left)
    made = _Regions(origin, values, texts, found, arranged, best, out)
    written, region_fields = made.regions(class_ if isinstance(class_, str) else "class", sources)
    assigned, assignment_fields = made.assignment(left, size_column)
    if out.small:
        some = {int(best.core[r]): out.faults[r] for r in out.small}
        _kinds.tell(origin, some, "are cores of a region that could not be helped")
    cost = costs(problem, best)
    return Regions(
        written,
        region_fields,
        assigned,
        assignment_fields,
        cost,
        None if result is None else float(min(result.bound, cost.total)),
        {name: (gone, of) for name, gone, of in lost_areas(problem, best, sources, names)},
    )


def _weights(named: str, *given: float | None) -> list[float]:
    """The weights of class change, boundary and centre: what is given, else that of the named set."""
    weight = [usual if own is None else own for own, usual in zip(given, PRESETS[named])]
    for value, name in zip(weight, ("weight_change", "weight_boundary", "weight_centre")):
        _kinds.number(value, name, 0.0)
    return weight


def _tables(
    names: list[str],
    threshold: float,
    thresholds: Mapping[Any, float | None] | None,
    excluded: Iterable[Any],
    distance: str,
    distances: Mapping[tuple, float] | None,
) -> tuple[np.ndarray, np.ndarray]:
    """The smallest size of a region of each class, and the distance of each class to each other."""
    listed: list[tuple] = []
    if distance == "table" and distances is not None:
        try:
            listed = [(start, end, value) for (start, end), value in distances.items()]
        except (AttributeError, TypeError, ValueError):
            raise TypeError(
                "distances must be a mapping of pairs of classes (from, to) to numbers."
            ) from None
    elif distances is not None:
        _kinds.warn(f"distances are not used, since distance is {distance!r}. To use them, say 'table'.")
    theta, _ = class_thresholds(
        names,
        threshold,
        table=(thresholds or {}).items(),
        excluded=[text(one) or "" for one in excluded],
    )
    matrix, _ = class_distances(names, distance, listed)
    return theta, matrix


def _solved(
    problem: Instance, method: str, regions: int, shapeless: int, options: dict[str, Any]
) -> tuple[Solution, Exact | None]:
    """What a method finds; warns where that are not as many regions as wanted."""
    count = regions + shapeless if regions else None  # there, an area without a shape is a region
    best, result, _ = by_method(problem, method, count=count, **options)
    if count and result:
        _kinds.warn("The number of regions is not used by the exact method.")
    elif count and len(best.core) != count:
        _kinds.warn(
            f"{regions} regions were wanted, and {len(best.core) - shapeless} is as near as "
            "thresholds and neighbours allowed."
        )
    return best, result


def _read(
    origin: Source, texts: Sequence[str | None]
) -> tuple[_geometry.Polygons, core.Areas, dict[int, str]]:
    """The polygons, the areas, and why some of these are left; warns of what is wrong with them."""
    found = _geometry.read_polygons(origin.geometries)
    areas = core.arrange(
        range(len(texts)),
        found.rings,
        found.owner,
        _kinds.measure_of(origin.crs),
        _kinds.metres_of(origin.crs),
    )
    left = core.reasons_of(
        areas, texts, ["it has no geometry" if one is None else "it is empty" for one in origin.geometries]
    )
    _kinds.tell(origin, left, "are left as they are")
    wrong, overlaps = core.flaws(areas)
    invalid = set(wrong.tolist()) - set(left)
    _kinds.tell(origin, dict.fromkeys(sorted(invalid), "not valid"), "may have a wrong size or neighbours")
    _tell_overlaps(origin, overlaps)
    return found, areas, left


class _Regions(NamedTuple):
    """What the results are made from."""

    origin: Source
    values: np.ndarray
    texts: list
    found: _geometry.Polygons
    areas: core.Areas
    best: Solution
    out: Outcome

    def regions(self, class_name: str, sources: Sequence) -> tuple[Any, dict[str, np.ndarray]]:
        """The regions, and their fields."""
        shapes = self._joined(np.where(self._shaped, self.best.region, -1))
        some = [r for r, group in enumerate(self.out.members) if group]
        geometry = self._shapes([(self.out.members[r], shapes.get(r)) for r in some])
        which = np.array(some, dtype=np.int64)
        core_of = self.best.core[which]
        fields = {
            "region": which + 1,
            class_name: self.values[core_of],
            "size": self.out.size[which],
            "areas": np.array([len({sources[k] for k in self.out.members[r]}) for r in some], dtype=np.int64),
            "core": self.origin.ids[core_of],
            "status": np.array([str(self.out.faults.get(r, "")) for r in some], dtype=object),
        }
        return _kinds.result(self.origin, geometry, core_of, fields, with_own=False), fields

    def assignment(self, left: dict[int, str], size_column: str | None) -> tuple[Any, dict[str, np.ndarray]]:
        """The areas, pieces of one area in one region as one, and their fields."""
        shapes = self._joined(self.out.merged)
        groups = list(self.out.groups.items())
        first = np.array([group[0] for _, group in groups], dtype=np.int64)
        geometry = self._shapes([(group, shapes.get(number)) for number, (_, group) in enumerate(groups)])
        rows = []
        for (_, r), group in groups:
            k = group[0]
            if r is None or k in left:
                rows.append((np.nan if r is None else r + 1, self.values[k], 0, left.get(k, "")))
            else:
                kept = int(self.best.core[r])
                changed = int(self.texts[kept] != self.texts[k])
                rows.append((r + 1, self.values[kept], changed, str(self.out.faults.get(r, ""))))
        region, kept_class, changed_class, status = zip(*rows) if rows else ((), (), (), ())
        fields = {
            "region": np.array(region),
            "new_class": _object_array(kept_class),
            "changed": np.array(changed_class, dtype=np.int64),
            "status": _object_array(status),
        }
        made = _kinds.result(self.origin, geometry, first, fields)
        if size_column is not None:
            made[size_column] = [
                float(self.areas.size[group].sum())
                if len(group) > 1
                else self.origin.origin[size_column].iloc[group[0]]
                for _, group in groups
            ]
        return made, fields

    @property
    def _shaped(self) -> np.ndarray:
        shaped = np.zeros(len(self.texts), dtype=bool)
        shaped[self.found.owner] = True
        return shaped

    def _joined(self, label: np.ndarray) -> dict:
        return joined(self.areas.coverage, label[self.areas.owner])

    def _shapes(self, groups: list[tuple[list[int], list | None]]) -> np.ndarray:
        """Geometry of groups of areas; of a single one its own, as it is."""
        made = np.empty(len(groups), dtype=object)
        extra = 1000 * int((self.found.extra % 2000 > 0).any()) + 2000 * int((self.found.extra >= 2000).any())
        coords = self.areas.coverage.coords
        for k, (group, polygons) in enumerate(groups):
            if len(group) == 1:
                made[k] = self.origin.geometries[group[0]]
            elif polygons is None:
                made[k] = _union(self.origin.geometries[group])
            else:
                rings = [ring for polygon in polygons for ring in polygon]
                parts = _geometry.polygons(
                    coords,
                    np.concatenate(rings),
                    core.offsets_of([len(ring) for ring in rings]),
                    core.offsets_of([len(polygon) for polygon in polygons]),
                    np.full(len(polygons), extra),
                )
                made[k] = parts[0] if len(parts) == 1 else shapely.multipolygons(parts)
        return made


def _union(geometries: np.ndarray) -> Any:
    """The union of geometries that do not fit together, repaired where they are not valid."""
    parts = shapely.get_parts(shapely.make_valid(geometries))
    whole = shapely.union_all(parts[shapely.get_dimensions(parts) == 2])
    return whole if not whole.is_empty else shapely.geometrycollections(list(geometries))


def _classes(origin: Source, class_: Any) -> tuple[np.ndarray, list[str | None]]:
    """The class of each area as it is, and as text; None where there is none."""
    values = _kinds.column(origin, class_, "class_")
    return values, [text(_present(one)) for one in values.tolist()]


def _present(value: Any) -> Any:
    """The value; None for what numpy or pandas have for none."""
    if value is None or type(value).__name__ in ("NAType", "NaTType"):
        return None
    return None if isinstance(value, float) and np.isnan(value) else value


def _sources(origin: Source, area_id: Any) -> tuple[list, str | None]:
    """What identifies the area of each feature, and the column with the size of pieces."""
    size_column = None
    if origin.kind == "frame" and (area_id is None or isinstance(area_id, str)):
        names = [str(name) for name in origin.origin.columns if name != origin.origin.geometry.name]
        found, size = core.piece_fields(names)
        if found >= 0 and area_id in (None, names[found]):
            area_id = names[found]
            size_column = names[size] if size >= 0 else None
    if area_id is None:
        return list(range(len(origin.geometries))), None
    ids = [text(_present(one)) for one in _kinds.column(origin, area_id, "area_id").tolist()]
    return [k if one is None else one for k, one in enumerate(ids)], size_column


def _tell_overlaps(origin: Source, overlaps: np.ndarray, most: int = _kinds.NAMED) -> None:
    """Warn of pairs of areas that overlap."""
    if len(overlaps):
        some = ", ".join(f"{a} and {b}" for a, b in origin.ids[overlaps[:most]].tolist())
        _kinds.warn(f"{len(overlaps)} pairs of areas overlap: {some}{' ...' * (len(overlaps) > most)}.")


def _tell_faults(origin: Source, areas: core.Areas, of: np.ndarray, most: int = _kinds.NAMED) -> None:
    """Warn of overlaps and gaps."""
    wrong = faults(areas.coverage)
    _tell_overlaps(origin, each_pair(of[wrong.overlaps]))
    if len(wrong.gaps):
        some = ", ".join(f"({x:.10g} {y:.10g})" for x, y in wrong.gaps[:most].tolist())
        _kinds.warn(
            f"{len(wrong.gaps)} gaps inside the map without an area, at {some}"
            f"{' ...' * (len(wrong.gaps) > most)}. Areas on both sides of a gap are no neighbours there."
        )


def _object_array(values: Sequence) -> np.ndarray:
    made = np.empty(len(values), dtype=object)
    made[:] = list(values)
    return made
