"""A region of a map enlarged: what the plugin's tool ``isthmus:focusmap`` does, for Python."""

from __future__ import annotations

from typing import Any, Iterable, NamedTuple

import numpy as np
import shapely

from . import _kinds
from ._cutting import PLACES
from ._kinds import Source
from .core.errors import Unsolvable
from .core.metric import FARTHEST
from .core.wkb import Runs, joined

SELECTIONS = ("MinSize", "MinLength", "Greedy", "Proximity", "None")


class FocusMap(NamedTuple):
    """A map with a region enlarged.

    Attributes
    ----------
    map : shapely geometry, array, GeoSeries or GeoDataFrame
        What came in, moved; all that a table has beside geometries stays.
    edges : array of LineString
        The relevant edges where they are in the focus map.
    edge_fields : dict of str to array
        kind (selected, given, or join between islands), length before, and stretch (length after over length
        before).
    carried : list
        The further layers, each of the kind that it was.
    growth : (float, float)
        How many times as wide and as high the map is.
    median_distortion, high_distortion : float
        The change of angles that half, and 95 %, of the area of the polygons do not exceed, in degrees.
    """

    map: Any
    edges: np.ndarray
    edge_fields: dict[str, np.ndarray]
    carried: list
    growth: tuple[float, float]
    median_distortion: float
    high_distortion: float


def enlarge(
    map: Any,
    focus: Any,
    *,
    scale: float = 2.0,
    edges: Any = None,
    selection: str = "MinSize",
    tau: float = 2.0,
    places: str = "Any",
    smallest_part: float = 0.0,
    frame: bool = True,
    growth: float = 200.0,
    along: Iterable[Any] = (),
    crs: Any = None,
) -> FocusMap:
    """Enlarge a region of a map, and keep the shape of the rest.

    The tool ``isthmus:focusmap`` (Haunert and Sering 2011, with the relevant edges of Haunert and Meulemans
    2016). Needs scipy.

    Parameters
    ----------
    map : shapely geometry, sequence of these, GeoSeries or GeoDataFrame
        Polygons or lines, solved together.
    focus : shapely geometry, sequence of these, GeoSeries or GeoDataFrame
        Polygons around what is to become larger.
    scale : float
        How many times as large the region becomes, exactly; from 0.01 to 100.
    edges : lines, optional
        Relevant edges between points of the map, such as the cuts of `isthmus.partition`.
    selection : {'MinSize', 'MinLength', 'Greedy', 'Proximity', 'None'}
        The rule for relevant edges, where none are given.
    tau : float
        For the rule, and for the edges that join islands; at least 1.
    places, smallest_part
        For MinSize and MinLength, see `isthmus.partition`; one number for all polygons.
    frame : bool
        Whether the map stays within its extent, but for its growth.
    growth : float
        How much wider and higher the frame may become, in per cent.
    along : iterable of geometries, sequences, GeoSeries or GeoDataFrames
        Further layers, deformed as the map around them.
    crs : object, optional
        Of geometries that have none by themselves. A map in degrees is solved in an equidistant cylindrical
        projection, and comes back in degrees.

    Returns
    -------
    FocusMap
        No triangle is turned over: no lines cross that did not cross before.

    Raises
    ------
    TypeError, ValueError
        If an argument cannot be used; it says which and why.
    IsthmusError
        If there is nothing to enlarge, or no room for it, or a package is missing.

    Examples
    --------
    >>> lake, town = shapely.box(0, 0, 10, 10), shapely.box(4, 4, 6, 6)
    >>> found = enlarge([lake, town], town)
    >>> float(round(found.map[1].area, 9))
    16.0
    """
    _kinds.one_of(selection, "selection", SELECTIONS)
    _kinds.one_of(places, "places", PLACES)
    _kinds.least(smallest_part, "smallest_part", 0.0, 100.0)
    _kinds.least(scale, "scale", 0.01, 100.0)
    _kinds.least(tau, "tau", 1.0)
    _kinds.least(growth, "growth", 0.0, 1000.0)
    from .core.focus.carrying import Carrier  # these import scipy
    from .core.focus.enlarge import enlarge as solve
    from .core.focus.globe import is_on_the_globe, on_the_globe
    from .core.focus.graph import match
    from .core.focus.selection import rule_of

    origin = _kinds.source(map, crs, what="map")
    runs = _runs_of(origin)
    rows, starts, polygons = joined(runs)
    if len(starts) == 1:
        raise Unsolvable("The map has no features with a geometry that can be moved.")
    given = None
    if edges is not None:
        given = _given(_of_crs(edges, origin, "edges"), rows, match)
    share, aspect = growth / 100.0, 1.0
    measure = _kinds.measure_of(origin.crs)
    in_degrees = measure.conformal is not None
    if in_degrees:
        share, aspect = on_the_globe(measure.degrees * rows, share)
    rule = rule_of(selection, natural=places == "Natural", smallest=smallest_part / 100.0)
    result = solve(
        rows,
        starts,
        polygons,
        _region(_of_crs(focus, origin, "focus")),
        scale,
        edges=given,
        rule=rule,
        tau=tau,
        frame=frame,
        growth=share,
        aspect=aspect,
    )
    if in_degrees and not is_on_the_globe(measure.degrees * result.rows, measure.degrees * rows):
        raise Unsolvable("The map would grow beyond the globe. Keep its extent (frame).")
    if len(result.skipped):
        more = " ..." * (len(result.skipped) > _kinds.NAMED)
        _kinds.warn(f"No relevant edges for {'; '.join(result.skipped[: _kinds.NAMED])}{more}.")
    carrier = Carrier(result.points, result.moved, result.triangles)
    return _focus_map(origin, runs, result, [_carried(layer, origin, carrier) for layer in along])


def _focus_map(origin: Source, runs: list[Runs], result: Any, carried: list) -> FocusMap:
    """What was found, for the caller."""
    before, after = (
        np.hypot(*(xy[result.edges[:, 0]] - xy[result.edges[:, 1]]).T) for xy in (result.points, result.moved)
    )
    width, height = result.growth.tolist()
    moved = _moved(origin.geometries, runs, result)
    spoiled = np.flatnonzero(~shapely.is_valid(moved) & shapely.is_valid(origin.geometries))
    _kinds.tell(
        origin,
        dict.fromkeys(spoiled.tolist(), "narrower than 1e-10 of the map's width where others meet it"),
        "are no longer valid (shapely.make_valid mends them)",
    )
    return FocusMap(
        map=_same(origin, moved),
        edges=shapely.linestrings(result.moved[result.edges]),
        edge_fields={"kind": result.kind, "length": before, "stretch": after / before},
        carried=carried,
        growth=(width, height),
        median_distortion=float(result.distortion.median),
        high_distortion=float(result.distortion.high),
    )


def _runs_of(origin: Source) -> list[Runs]:
    """The points of each geometry of the map; none of those that cannot be moved, with a warning."""
    runs = [_runs(one) for one in origin.geometries]
    wrong = [k for k, one in enumerate(runs) if not (np.abs(one.xy) <= FARTHEST).all()]
    for k in wrong:
        runs[k] = Runs(b"")
    _kinds.tell(
        origin,
        dict.fromkeys(wrong, f"coordinates that are not finite or larger than {FARTHEST:g}"),
        "are left where they are",
    )
    return runs


def _runs(geometry: Any) -> Runs:
    if geometry is None or geometry.is_empty:
        return Runs(b"")
    return Runs(shapely.to_wkb(geometry, byte_order=1, flavor="iso"))


def _moved(geometries: np.ndarray, runs: list[Runs], result: Any) -> np.ndarray:
    """The geometries of the map where they are now, with points where others meet them."""
    from .core.focus.carrying import placed  # this imports scipy

    made = geometries.copy()
    some = [k for k, one in enumerate(runs) if one.counts]
    made[some] = [
        shapely.from_wkb(one) for one in placed([runs[k] for k in some], result.rows, result.put_in)
    ]
    return made


def _of_crs(data: Any, origin: Source, what: str) -> Source:
    """A further layer, in the CRS of the map."""
    if hasattr(data, "to_crs") and data.crs is not None and hasattr(origin.crs, "is_geographic"):
        data = data.to_crs(origin.crs)
    return _kinds.source(data, what=what)


def _region(focus: Source) -> Any:
    """The region in focus."""
    found = [
        shapely.force_2d(one)
        for one in focus.geometries
        if one is not None and not one.is_empty and (np.abs(shapely.get_coordinates(one)) <= FARTHEST).all()
    ]
    if not found:
        raise Unsolvable("The region to enlarge has no polygons whose coordinates are finite.")
    return shapely.union_all(shapely.make_valid(found))


def _given(lines: Source, rows: np.ndarray, match: Any) -> np.ndarray:
    """The rows at the ends of relevant edges."""
    ends = [np.empty((0, 2, 2))]
    for geometry in lines.geometries:
        one, start = _runs(geometry), 0
        for count in one.counts:
            line = one.xy[start : start + count]
            line = np.where(np.isfinite(line), line, 1e300)  # where no point of the map is
            ends.append(np.stack((line[:-1], line[1:]), axis=1))
            start += count
    found = match(rows, np.concatenate(ends).reshape(-1, 2)).reshape(-1, 2)
    good = (found >= 0).all(axis=1)
    if not good.all():
        _kinds.warn(
            f"{np.count_nonzero(~good)} of {len(good)} relevant edges were left out: an end is not a point "
            "of the map."
        )
    return found[good]


def _carried(layer: Any, origin: Source, carrier: Any) -> Any:
    """A further layer, moved as the map around it."""
    from .core.focus.carrying import carried

    own = _of_crs(layer, origin, "along")
    made = own.geometries.copy()
    runs = [_runs(geometry) for geometry in made]
    placed = [k for k, one in enumerate(runs) if one.counts and np.isfinite(one.xy).all()]
    for k, data in zip(placed, carried(carrier, [runs[k] for k in placed])):
        made[k] = shapely.from_wkb(data)
    return _same(own, made)


def _same(origin: Source, geometries: np.ndarray) -> Any:
    """Other geometries in what was given."""
    if origin.kind == "geometry":
        return geometries[0]
    if origin.kind == "frame":
        given = origin.origin.geometry
        made = type(given)(geometries, index=given.index, crs=given.crs, name=given.name)
        return origin.origin.set_geometry(made)
    return _kinds.result(origin, geometries, np.arange(len(geometries)), {})
