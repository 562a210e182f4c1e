"""The areas of a map as arrays: size, place, spread and neighbours of each, and the problem they pose."""

from __future__ import annotations

import re
from typing import NamedTuple, Sequence

import numpy as np
import shapely

from ..errors import IsthmusError, Sentence
from ..metric import FARTHEST, Metric
from ..rings import Rings, groups, offsets_of, take
from .coverage import (
    Coverage,
    centroids,
    cover,
    each_pair,
    overlapping,
    shapes,
    shared,
    spreads,
    with_shared_vertices,
)
from .instance import Instance, build

__all__ = [
    "Areas",
    "arrange",
    "arrange_pieces",
    "beside",
    "flaws",
    "joined_rings",
    "neighbours",
    "piece_fields",
    "posed",
    "reasons_of",
]

EARTH_RADIUS = 6371008.8  # metres; for distances between centroids in layers in degrees
LARGEST_COST = 1e250  # beyond, sums and products of costs may overflow


class Areas(NamedTuple):
    """Areas of a layer, in its order.

    Attributes
    ----------
    features : sequence
        The areas themselves, as the caller has them.
    coverage : Coverage
    owner : (q,) int
        The area of each polygon; an area has several if it is multipart, none if it is empty.
    measured : (q,) bool
        Whether a polygon is in the coverage: all of its coordinates are numbers, and none is huge.
    size : (n,) float
        In square metres.
    place : (n,) complex
        Centroids, in metres.
    spread : (n,) float
        Mean squared distance of the points of an area from its centroid, in square metres.
    metre : float
        Metres in one unit of the measure.
    measure : Metric
    """

    features: Sequence
    coverage: Coverage
    owner: np.ndarray
    measured: np.ndarray
    size: np.ndarray
    place: np.ndarray
    spread: np.ndarray
    metre: float
    measure: Metric


def arrange_pieces(
    rings: Rings, is_new: np.ndarray, measure: Metric, metre: float
) -> tuple[Areas, Rings, np.ndarray]:
    """Return the areas of pieces, one polygon each, whose new vertices the neighbours get, too.

    Parameters
    ----------
    rings : Rings
    is_new : (k,) bool
        The rows of new vertices.
    measure, metre
        See `arrange`.

    Returns
    -------
    areas : Areas
    rings : Rings
        With the vertices of the neighbours.
    grown : (p,) bool
        The pieces that got some.

    Examples
    --------
    >>> from ..metric import planar
    >>> rings = Rings(np.array([[0, 0], [2, 0], [1, 1.0]]), np.array([0, 3]), np.array([0, 1]))
    >>> arrange_pieces(rings, np.zeros(3, dtype=bool), planar(), 1.0)[0].size
    array([1.])
    """
    count = len(rings.polygon_offsets) - 1
    areas, grown = arrange(range(count), rings, np.arange(count), measure, metre), np.zeros(count, dtype=bool)
    if is_new.any():
        row = take(rings.offsets, _measured_rings(rings, areas.measured))[0]
        rings, grown = with_shared_vertices(rings, is_new, areas.coverage, row)
        areas = arrange(range(count), rings, np.arange(count), measure, metre)
    return areas, rings, grown


def _measured_rings(rings: Rings, measured: np.ndarray) -> np.ndarray:
    """The rings that are in a coverage."""
    return np.flatnonzero(measured[groups(rings.polygon_offsets)] & (np.diff(rings.offsets) > 0))


def arrange(
    features: Sequence, rings: Rings, owner: np.ndarray, measure: Metric, metre: float = 1.0
) -> Areas:
    """Return `Areas`.

    Parameters
    ----------
    features : sequence
        The areas themselves, as the caller has them.
    rings : Rings
        Their polygons.
    owner : (q,) int
        The area of each polygon.
    measure : Metric
    metre : float
        Metres in one unit of the measure.

    Examples
    --------
    A hall, and two rooms beside it that are one area.

    >>> from isthmus.core.metric import planar
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> coords = np.concatenate((2 * square, square + [2, 0], square + [2, 1]))
    >>> rings = Rings(coords, np.array([0, 4, 8, 12]), np.arange(4))
    >>> areas = arrange(["hall", "rooms"], rings, np.array([0, 1, 1]), planar())
    >>> areas.size.tolist(), areas.place.tolist()
    ([4.0, 2.0], [(1+1j), (2.5+1j)])
    """
    polygon_count = len(rings.polygon_offsets) - 1
    ring_polygon = groups(rings.polygon_offsets)
    row_polygon = np.repeat(ring_polygon, np.diff(rings.offsets))
    measured = np.ones(polygon_count, dtype=bool)
    measured[row_polygon[~(np.abs(rings.coords[:, :2]) <= FARTHEST).all(axis=1)]] = False
    kept = _measured_rings(rings, measured)
    row, offsets = take(rings.offsets, kept)
    coords = rings.coords[row]
    coverage = cover(coords, offsets, ring_polygon[kept])
    xy = coords[:, :2]
    area, moment = centroids(coverage, measure.equal_area(xy) if len(xy) else xy, polygon_count)
    if measure.conformal:  # the centroid in degrees, its metres near the middle of the layer
        flat, moment = centroids(coverage, xy, polygon_count)
        moment = moment * np.divide(area, flat, out=np.zeros(polygon_count), where=flat > 0)[:, None]
    n = len(features)
    size = np.bincount(owner, weights=area, minlength=n)
    weight = np.where(size > 0, size, 1.0)
    x = np.bincount(owner, weights=moment[:, 0], minlength=n) / weight
    y = np.bincount(owner, weights=moment[:, 1], minlength=n) / weight
    # of an area that crosses itself, parts count as negative: its centroid might be anywhere
    ring_area = owner[coverage.ring_polygon] if len(owner) else coverage.ring_polygon
    row_area = np.repeat(ring_area, np.diff(offsets))
    low, high = np.full((n, 2), np.inf), np.full((n, 2), -np.inf)
    if len(kept):  # ring by ring first: `at` is slow in older numpy
        np.minimum.at(low, ring_area, np.minimum.reduceat(xy, offsets[:-1]))
        np.maximum.at(high, ring_area, np.maximum.reduceat(xy, offsets[:-1]))
    shaped = np.isfinite(low[:, 0])
    x[shaped] = np.clip(x[shaped], low[shaped, 0], high[shaped, 0])
    y[shaped] = np.clip(y[shaped], low[shaped, 1], high[shaped, 1])
    around = xy - np.column_stack((x, y))[row_area]
    if measure.conformal and n:
        unit = measure.degrees
        around = EARTH_RADIUS * np.radians(around * unit)
        around[:, 0] *= np.cos(np.radians(xy[:, 1] * unit))
        middle = np.median(x)
        x = EARTH_RADIUS * np.cos(np.radians(y * unit)) * np.radians((x - middle) * unit)
        y = EARTH_RADIUS * np.radians(y * unit)
    spread = np.zeros(n)
    spread[: owner.max(initial=-1) + 1] = spreads(coverage, around, owner)
    return Areas(
        features,
        coverage,
        owner,
        measured,
        np.maximum(size, 0.0) * metre**2,
        (x + 1j * y) * metre,
        spread * metre**2,
        metre,
        measure,
    )


def neighbours(areas: Areas) -> tuple[np.ndarray, np.ndarray]:
    """Return pairs of areas that share a boundary, and its length in metres, each pair once.

    Examples
    --------
    A hall, and two rooms beside it that are one area.

    >>> from isthmus.core.metric import planar
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> coords = np.concatenate((2 * square, square + [2, 0], square + [2, 1]))
    >>> rings = Rings(coords, np.array([0, 4, 8, 12]), np.arange(4))
    >>> pairs, length = neighbours(arrange(["hall", "rooms"], rings, np.array([0, 1, 1]), planar()))
    >>> pairs.tolist(), length.tolist()
    ([[0, 1]], [2.0])
    """
    pairs, length = shared(areas.coverage, areas.measure)
    pairs = np.sort(areas.owner[pairs], axis=1).reshape(-1, 2)
    apart = pairs[:, 0] != pairs[:, 1]
    pairs, length = pairs[apart], length[apart] * areas.metre
    n = max(len(areas.features), 1)
    key, group = np.unique(pairs[:, 0] * n + pairs[:, 1], return_inverse=True)
    total = np.bincount(group.ravel(), weights=length, minlength=len(key))
    return np.column_stack((key // n, key % n)), total


def flaws(areas: Areas) -> tuple[np.ndarray, np.ndarray]:
    """Return the areas that are not valid, and pairs of areas that overlap.

    Returns
    -------
    invalid : (m,) int
    overlaps : (o, 2) int
        Some of each place where areas overlap; see `coverage.overlapping`.

    Examples
    --------
    The second area crosses itself, and the last two overlap.

    >>> from isthmus.core.metric import planar
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    >>> bow_tie = np.array([[3, 0], [4, 1], [4, 0], [3, 1.0]])
    >>> coords = np.concatenate((square, bow_tie, square + 5, square + 5.5))
    >>> rings = Rings(coords, np.array([0, 4, 8, 12, 16]), np.arange(5))
    >>> invalid, overlaps = flaws(arrange(range(4), rings, np.arange(4), planar()))
    >>> invalid.tolist(), overlaps.tolist()
    ([1], [[2, 3]])
    """
    polygons = shapes(areas.coverage, len(areas.owner))
    valid = shapely.is_valid(polygons)
    overlaps = overlapping(areas.coverage, polygons, valid)
    return np.unique(areas.owner[~valid]), each_pair(areas.owner[overlaps])


def beside(areas: Areas, label: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return pairs of areas that lie side by side, though they have different labels.

    Parameters
    ----------
    areas : Areas
    label : (n,) int
        Equal for areas that hang together by shared boundaries; negative: not looked at.
    wanted : (n,) bool
        The areas whose neighbours are looked for.

    Returns
    -------
    (m, 2) int
        A wanted area, and another one that is no farther away than a thousandth of its own width.

    Examples
    --------
    Between the first two areas is a gap that is too narrow to be seen.

    >>> from isthmus.core.metric import planar
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    >>> coords = np.concatenate((square, square + [1.000001, 0], square + [3, 0]))
    >>> rings = Rings(coords, np.array([0, 4, 8, 12]), np.arange(4))
    >>> areas = arrange(range(3), rings, np.arange(3), planar())
    >>> beside(areas, np.arange(3), np.ones(3, dtype=bool)).tolist()
    [[0, 1], [1, 0]]
    """
    if not wanted[areas.owner].any():
        return np.zeros((0, 2), dtype=np.int64)
    polygons = shapes(areas.coverage, len(areas.owner))
    asking = np.flatnonzero(wanted[areas.owner])
    reach = 1e-3 * np.sqrt(shapely.area(polygons[asking]))
    one, other = shapely.STRtree(polygons).query(polygons[asking], predicate="dwithin", distance=reach)
    pairs = areas.owner[np.column_stack((asking[one], other))]
    apart = (label[pairs[:, 0]] != label[pairs[:, 1]]) & (label[pairs] >= 0).all(axis=1)
    return np.unique(pairs[apart], axis=0)


def reasons_of(areas: Areas, classes: Sequence[str | None], without: Sequence[str]) -> dict[int, str]:
    """Return why areas are left as they are, by number.

    Parameters
    ----------
    areas : Areas
    classes : sequence of str or None
    without : sequence of str
        Why each area has no polygon, if it has none.

    Examples
    --------
    Of three areas the second has no class, and the third no polygon.

    >>> from isthmus.core.metric import planar
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> rings = Rings(np.concatenate((square, square + 1)), np.array([0, 4, 8]), np.arange(3))
    >>> areas = arrange(range(3), rings, np.arange(2), planar())
    >>> reasons_of(areas, ["wood", None, "wood"], ["", "", "it is empty"])
    {1: 'it has no class', 2: 'it is empty'}
    """
    shaped = np.zeros(len(classes), dtype=bool)
    shaped[areas.owner] = True
    huge = set(areas.owner[~areas.measured].tolist())
    reason = {}
    for k, one in enumerate(classes):
        if not shaped[k]:
            reason[k] = without[k]
        elif k in huge:
            reason[k] = Sentence("it has coordinates that are not finite, or larger than {:g}", FARTHEST)
        elif one is None:
            reason[k] = Sentence("it has no class")
    return reason


def posed(
    areas: Areas,
    classes: Sequence[str | None],
    names: list[str],
    left: Sequence[int],
    theta: np.ndarray,
    distance: np.ndarray,
    weights: Sequence[float],
    between_classes: bool,
) -> Instance:
    """Return the problem of a map: that of Haunert and Wolff (2010), see `instance`.

    Parameters
    ----------
    areas : Areas
    classes : sequence of str or None
        Of each area.
    names : list of str
        The classes, in the order of ``theta`` and ``distance``.
    left : sequence of int
        Areas that stay as they are.
    theta, distance : (c,) float, (c, c) float
        See `tables.thresholds` and `tables.distances`.
    weights : sequence of float
        Of class change, boundary length and centre distance.
    between_classes : bool
        Whether only boundaries between classes count.

    Raises
    ------
    IsthmusError
        If costs would be no numbers any more.

    Examples
    --------
    A hall and two rooms, all next to each other. The first room has no class and stays as it is: it is
    nobody's neighbour in the problem, and its class gets the number after all others.

    >>> from isthmus.core.metric import planar
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> coords = np.concatenate((2 * square, square + [2, 0], square + [2, 1]))
    >>> rings = Rings(coords, np.array([0, 4, 8, 12]), np.arange(4))
    >>> areas = arrange(["hall", "room", "room"], rings, np.arange(3), planar())
    >>> classes, names = ["wood", None, "lake"], ["lake", "wood"]
    >>> problem = posed(areas, classes, names, [1], np.full(2, 3.0), 1 - np.eye(2), (1, 0, 0), False)
    >>> problem.cls.tolist(), np.column_stack((problem.owner, problem.neighbour)).tolist()
    ([1, 2, 0], [[0, 2], [2, 0]])
    """
    pairs, length = neighbours(areas)
    # the last class stands for none: nobody may get it, and who has it keeps it
    number = {one: k for k, one in enumerate(names)}
    none = len(names)
    cls = np.array([none if one is None else number[one] for one in classes], dtype=np.int64)
    stay = np.zeros(len(classes), dtype=bool)
    stay[list(left)] = True
    alone = stay[pairs].any(axis=1)
    padded = np.zeros((none + 1, none + 1))
    padded[:none, :none] = distance
    change, boundary, centre = weights
    problem = build(
        areas.size,
        cls,
        areas.place,
        pairs[~alone],
        length[~alone],
        padded,
        np.append(theta, np.inf),
        change=change,
        boundary=boundary,
        centre=centre,
        by_class=between_classes,
        spread=np.where(stay, 0.0, areas.spread),
    )
    size, place = problem.size.sum(), problem.place
    with np.errstate(over="ignore"):
        extent = np.ptp(place.real) + np.ptp(place.imag) if len(place) else 0.0
        most = {
            Sentence("class change"): size * problem.change * problem.distance.max(initial=0.0),
            Sentence("boundary length"): problem.boundary * problem.length.sum(),
            Sentence("centre distance"): size * problem.centre * extent,
        }
    for name, cost in most.items():
        if not cost < LARGEST_COST:
            large = Sentence(
                "The costs of {} cannot be computed: up to {:g}, they are too large. Give a "
                "smaller weight (or class distances), and see that no area is far away by mistake.",
                name, cost,
            )  # fmt: skip
            raise IsthmusError(large)
    return problem


def joined_rings(chunks: Sequence[Rings]) -> Rings:
    """Return the rings of several chunks as one.

    Examples
    --------
    >>> triangle = Rings(np.eye(3, 2), np.array([0, 3]), np.array([0, 1]))
    >>> joined_rings([triangle, triangle]).offsets
    array([0, 3, 6])
    """
    if not chunks:
        return Rings(np.empty((0, 2)), np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64))
    # Z and M were made alike before; a chunk without any polygon has none
    width = max(own.coords.shape[1] for own in chunks)
    return Rings(
        np.concatenate([own.coords.reshape(-1, width) for own in chunks]),
        offsets_of(np.concatenate([np.diff(own.offsets) for own in chunks])),
        offsets_of(np.concatenate([np.diff(own.polygon_offsets) for own in chunks])),
    )


def piece_fields(names: Sequence[str]) -> tuple[int, int]:
    """Return the places of the fields area_id and size of prepared pieces, whatever their numbers; or -1.

    The areas may have had fields of these names themselves: then those of the tool have a number
    (area_id_2), and come last, one after the other.

    Examples
    --------
    >>> piece_fields(["name", "area_id", "piece", "size", "status"])
    (1, 3)
    >>> piece_fields(["size", "area_id", "area_id_2", "piece", "size_2", "status"])
    (2, 4)
    >>> piece_fields(["name"])
    (-1, -1)
    """
    plain = [re.sub(r"_\d+$", "", name.lower()) for name in names]
    for k in range(len(names) - 4, -1, -1):
        if plain[k : k + 4] == ["area_id", "piece", "size", "status"]:
            return k, k + 2
    lower = [name.lower() for name in names]
    return (lower.index("area_id"), -1) if {"area_id", "piece"} <= set(lower) else (-1, -1)
