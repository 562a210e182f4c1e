"""Where people would cut: the diagonals that are candidates for natural parts.

Section 4.2 of the paper lets any set of diagonals be the candidates, and the solver's proof holds
for each. This stage chooses that set by what research on perception found, at one scale:

* **Smallest part.** A part too small to matter on the map is none (part salience grows with the
  relative area: Hoffman and Singh 1997, Cognition 63).
* **Minima rule** (Hoffman and Richards 1984, Cognition 18): parts meet where the outline is
  concave, here at the scale of the diagonal itself.
* **Short-cut rule** (Singh, Seyranian and Hoffman 1999, Perception & Psychophysics 61): of cuts
  that do the same, the shortest. Beside a base or a neck the polygon widens (the parts of Siddiqi
  and Kimia 1995, IEEE PAMI 17); in an even limb it does not, and there is nothing to cut.
* **A corner is used once.** Short and sharp cuts come first, as in the models of Luo et al. 2015
  and of Papanelopoulos and Avrithis 2015 (BMVC); what is left of the outline must still be concave
  for another cut. So a body is not cut across from the foot of one limb to that of another.
* **Islands close a bay** where they fill half of the way across (`gates.gates`). These ways come last, so
  that they change nothing for the diagonals; the minima rule and the smallest part hold for them, too.
* **A body is not halved** at a shallow corner. A wide cut that leaves a third of the area or more on
  both sides parts no limb from a body, so the outline must open up beside it much more than beside a
  limb's base. Else the cut is no smooth going on of the outline (good continuation: Kellman and
  Shipley 1991, Cogn. Psychology 23).

Everything along the outline, the detours of the solver too, is measured on an outline generalised
to the scale of the smallest part; cuts and triangulation are those of the original vertices.
"""

from __future__ import annotations

from bisect import bisect
from math import atan2, degrees, dist, hypot
from typing import NamedTuple

import numpy as np
import shapely

from ..metric import Metric
from ..predicates import crossing
from ..rings import following, groups, locate, offsets_of, previous, ranges, running, take
from .polygon import Polygons

__all__ = [
    "BENT",
    "DETAIL",
    "EVEN",
    "KEPT",
    "SMALL",
    "STRAIGHT",
    "Natural",
    "Outline",
    "RULES",
    "USED",
    "WIDER",
    "Ways",
    "bends",
    "edges_of_triangles",
    "generalised",
    "natural",
    "one_by_one",
    "opens",
]

# Why a diagonal is no candidate. Each diagonal has the first that holds.
RULES = KEPT, SMALL, STRAIGHT, EVEN, USED = range(5)

LEVELS = 8  # classes of small detail, each a quarter of the next
DETAIL = 0.02  # detail below this share of the smallest part is not measured ...
SCALES = 6  # ... and lengths along the outline are the mean over so many scales, each twice the last
REACH = 0.5  # bends and widening are measured within this share of the diagonal's length
BENT = 20.0  # degrees: least sum of the bends at both ends
LEFT = 2.0  # degrees: the least sum that earlier cuts must have left
WIDER = 1.15  # an edge of a triangle beside the diagonal is so much longer ...
STEP = 1.3  # ... or a diagonal within reach on one side is ...
TAPER = 0.7  # ... and none within reach on the other side is shorter than this
PLAIN = 8  # steps a diagonal before leaps are worth their tables
HALF = 1 / 3  # a cut that leaves more than this share of the area on both sides, ...
NARROW = 0.2  # ... and is longer than this share of the area's root, halves a body, and needs ...
OPEN = 80.0  # ... at its ends together so many degrees by which one side opens up, and half the other's


class Natural(NamedTuple):
    """The candidates for natural parts, and the outline's lengths at their scale.

    Attributes
    ----------
    kept : (k,) bool
        The diagonals that are candidates.
    edge_length : (c,) float
        Length of the polygon edge that leaves each corner, on the generalised outline.
    share : (k,) float
        Area of the smaller side as a share of the polygon's, holes included in both; NaN where a
        diagonal joins two rings and has no sides.
    why : (k,) int8
        KEPT, or the rule that sets the diagonal aside: SMALL (part), STRAIGHT (outline at its ends),
        EVEN (width beside it, or beside the piece that it would halve), USED (its corners, by shorter cuts).
    outline : Outline
        The finest one.
    way, way_share : (g,) bool, (g,) float
        For each of the ways over islands ``kept`` and ``share``.
    """

    kept: np.ndarray
    edge_length: np.ndarray
    share: np.ndarray
    why: np.ndarray
    outline: Outline
    way: np.ndarray
    way_share: np.ndarray


class Ways(NamedTuple):
    """Ways over islands that are no rings of the polygons (`gates.gates`).

    Attributes
    ----------
    ends : (g, 2) int
        The vertices where they begin and end.
    xy : (2 w, 2) float
        The ends of the stretches of water of all ways, one after the other.
    island : (2 w,) int
        The island of each of these, -1 at the ends of ways.
    offsets : (g + 1,) int
        Where those of each way start.
    """

    ends: np.ndarray
    xy: np.ndarray
    island: np.ndarray
    offsets: np.ndarray

    @property
    def toward(self) -> np.ndarray:
        """(g, 2, 2) float: where the ways first land, from either end."""
        return np.stack((self.xy[self.offsets[:-1] + 1], self.xy[self.offsets[1:] - 2]), axis=1)


class Outline(NamedTuple):
    """The rings of a chunk, generalised: a subset of their corners, joined by straight edges.

    Attributes
    ----------
    corner : (g,) int
        The corners that stay, ascending.
    point : (g, d) float
        Where they are.
    passed : (g,) float
        Length of the edges before each of them on its ring.
    step : (g,) float
        Length of the edge that leaves each.
    perimeter : (r,) float
    following : (g,) int
        The next one on the same ring.
    ring_start : (r + 1,) int
        Ring k has the places ``ring_start[k]`` to ``ring_start[k + 1] - 1``.
    edge_length : (c,) float
        For each edge of the original outline, its share of the generalised edge it lies on.
    along : (c,) float
        Distance of each original corner from the ring's first place on the generalised outline.
    """

    corner: np.ndarray
    point: np.ndarray
    passed: np.ndarray
    step: np.ndarray
    perimeter: np.ndarray
    following: np.ndarray
    ring_start: np.ndarray
    edge_length: np.ndarray
    along: np.ndarray


def natural(
    polygons: Polygons,
    edges: np.ndarray,
    triangles: np.ndarray,
    position: np.ndarray,
    measure: Metric,
    smallest: np.ndarray,
    ways: Ways | None = None,
) -> Natural:
    """Choose the diagonals of polygons where people would cut.

    Parameters
    ----------
    polygons : Polygons
    edges : (k, 2) int
        Vertex indices u < v of the diagonals of a triangulation.
    triangles : (t, 3) int
        Vertex indices of its triangles.
    position : (n, 2 or 3) float
        Where the vertices are for ``measure.length``: in the plane, or geocentric.
    measure : metric.Metric
    smallest : (p,) float
        Area of the smallest part of each polygon, in the units of ``measure.equal_area`` of
        ``polygons.xy``; lengths in the result are those of ``position``: neither knows ``unit``.
    ways : Ways, optional
        Ways over islands, which are asked after all diagonals.

    Returns
    -------
    Natural

    Notes
    -----
    O(n log n), but for the diagonals within reach of those that only a step could keep.

    Examples
    --------
    Of the three diagonals of an hourglass, people would cut along the one at its neck.

    >>> from isthmus.core import metric
    >>> from isthmus.core.partition.polygon import one
    >>> hourglass = one(np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]]), [0, 6])
    >>> triangles = np.array([[0, 1, 5], [1, 4, 5], [1, 2, 3], [1, 3, 4]])
    >>> diagonals = np.array([[1, 3], [1, 4], [1, 5]])
    >>> found = natural(hourglass, diagonals, triangles, hourglass.xy, metric.planar(), np.array([1.0]))
    >>> found.kept.tolist(), found.share.round(3).tolist()
    ([False, True, False], [0.444, 0.333, 0.278])
    """
    ring, vertex, offsets = polygons.ring_of_corner, polygons.vertex, polygons.offsets
    polygon_offsets, polygon_of_ring = polygons.polygon_offsets, polygons.polygon_of_ring
    smallest = np.broadcast_to(np.asarray(smallest, dtype=float), len(polygon_offsets) - 1)
    corner = _corners(polygons, edges)
    plane = measure.equal_area(polygons.xy)[vertex]
    origin = plane[offsets[polygon_offsets[:-1]]]
    plane -= np.repeat(origin, np.diff(offsets[polygon_offsets]), axis=0)  # there terms of areas cancel least
    edge_length = measure.length(position, vertex, vertex[polygons.next_corner])
    terms = running(_term(plane, plane[following(offsets)]), offsets)  # a hole's are negative
    area = terms[1][polygon_offsets[:-1]]
    share = _shares(_term(*plane[corner.T]), terms, area, polygons, corner)
    outline, measured = _outlines(
        plane, position[vertex], offsets, edge_length, DETAIL * smallest[polygon_of_ring]
    )
    polygon = polygon_of_ring[ring[corner[:, 0]]]
    small = share * area[polygon] < smallest[polygon]
    why = np.where(small, SMALL, KEPT).astype(np.int8)

    # on from here with the large ones alone: of a dense coast a few in a thousand
    large = np.flatnonzero(~small)
    edges, corner, verdict = edges[large], corner[large], why[large]
    length = measure.length(position, edges[:, 0], edges[:, 1])
    bend = bends(outline, ring, corner, length).sum(axis=1)
    verdict[bend < BENT] = STRAIGHT

    left = np.flatnonzero(verdict == KEPT)
    beside, across = edges_of_triangles(triangles, edges, len(polygons.xy))
    around = beside[left]
    sides = np.stack(
        [
            measure.length(position, triangles[around, k].ravel(), triangles[around, k - 1].ravel())
            for k in range(3)
        ]
    ).reshape(3, -1, 2)
    longest = np.where(around >= 0, sides.max(axis=0), 0.0)
    even = left[longest.max(axis=1, initial=0.0) < WIDER * length[left]]
    middle = (position[edges[:, 0]] + position[edges[:, 1]]) / 2.0
    verdict[even[~opens(even, length, middle, beside, across)]] = EVEN

    left = np.flatnonzero(verdict == KEPT)
    order = left[_in_turn(length[left], bend[left], share[large[left]])]
    halves = (share[large] > HALF) & (length > NARROW * np.sqrt(area[polygon[large]]))
    edges, corner = edges[order], corner[order]
    turn = _turns(polygons, corner, polygons.xy[edges[:, ::-1]])
    tried = corner, length[order], halves[order], _term(*plane[corner.T]), turn
    barred, asked, way_share = {}, order[:0], share[:0]
    if ways is not None and len(ways.ends):
        corner, whole, water, term = _measured(polygons, ways, measure, origin)
        way_share = _shares(term, terms, area, polygons, corner)
        bend = bends(outline, ring, corner, whole).sum(axis=1)
        asked = np.flatnonzero(bend >= BENT)
        asked = asked[_in_turn(water[asked], bend[asked], way_share[asked])]
        barred = _barred(polygons, ways, edges, asked)
        halves, turn = np.zeros(len(corner), dtype=bool), _turns(polygons, corner, ways.toward)
        last = corner, whole, halves, term, turn
        tried = tuple(np.concatenate((x, y[asked])) for x, y in zip(tried, last))
    found = one_by_one(polygons, outline, *tried, terms, area, smallest, barred)
    verdict[order] = found[: len(order)]
    why[large] = verdict
    way = np.zeros(len(way_share), dtype=bool)
    way[asked] = found[len(order) :] == KEPT
    return Natural(why == KEPT, measured, share, why, outline, way, way_share)


def _in_turn(length, bend, share):
    """Short ones first, of about as short ones the sharp ones.

    How sharp a bend is changes with the detail of the data more than how long a cut is: by length / bend, of
    40 cuts of the ten largest land masses at one detail 88 % had the same ends at another, so 92 %. Powers of
    the bend from 0.3 to 0.6 do the same. Blocks have many that are equal but for rounding errors, which
    turning them changes: there the one with the larger part first (Hoffman and Singh: relative size), so that
    both ends of a U are cut alike.
    """
    first = np.round(np.log(length / np.sqrt(bend)), 9)
    return np.lexsort((np.arange(len(first)), -np.round(share, 9), first))


def _measured(polygons, ways, measure, origin):
    """Of ways over islands: corners at the ends, lengths, those of their water, and shoelace terms."""
    corner = _corners(polygons, ways.ends, ways.toward)
    polygon = polygons.polygon_of_ring[polygons.ring_of_corner[corner[:, 0]]]
    start, here = ways.offsets[:-1], np.arange(len(ways.xy) - 1)
    step = measure.length(measure.positions(ways.xy), here, here + 1)
    plane = measure.equal_area(ways.xy) - origin[polygon][groups(ways.offsets)]
    term = _term(plane[:-1], plane[1:])
    step[start[1:] - 1] = term[start[1:] - 1] = 0.0  # from one way to the next
    whole, water = np.add.reduceat(step, start), np.add.reduceat(step[::2], start // 2)
    return corner, whole, water, np.add.reduceat(term, start)


def _barred(polygons, ways, edges, asked):
    """{place of a way behind the diagonals: those that bar it, and -1 less what only one way may have}.

    It may not cross a diagonal, nor share its islands with another way, nor both ends with either: which of
    two lies on which side the solver would not know.
    """
    n = len(polygons.xy)
    pair, of_edge = (ends[:, 0] * n + ends[:, 1] for ends in (ways.ends, edges))
    _, number = np.unique(pair, return_inverse=True)
    first = int(ways.island.max()) + 1
    names = [
        [-1 - first - own, *(-1 - np.unique(island[island >= 0])).tolist()]
        for own, island in zip(number.ravel().tolist(), np.split(ways.island, ways.offsets[1:-1]))
    ]
    stretch, line = ways.xy.reshape(-1, 2, 2), polygons.xy[edges]
    k, d = shapely.STRtree(shapely.linestrings(line)).query(shapely.linestrings(stretch))
    way, owner = groups(ways.offsets // 2)[k], polygons.polygon_of_vertex
    bars = owner[edges[d, 0]] == owner[ways.ends[way, 0]]  # polygons of a layer may overlap
    bars &= crossing(stretch[k], line[d]) | (pair[way] == of_edge[d])
    for own, barring in zip(way[bars].tolist(), d[bars].tolist()):
        names[own].append(barring)
    return {len(edges) + place: names[own] for place, own in enumerate(asked.tolist())}


def _term(here, there):
    """Shoelace terms of lines."""
    (x, y), (x2, y2) = here.T, there.T
    return (x * y2 - x2 * y) / 2.0


def _shares(chord, terms, area, polygons, corner):
    """Area on the smaller side of each diagonal, as a share of its polygon's.

    A side is an interval of a ring: two entries of the prefix sums of the shoelace terms, and the
    term of the diagonal. NaN where the ends lie on two rings. Holes on the side count as part of it,
    and those of a polygon as part of that. O(n + k).
    """
    passed, whole = terms
    u, v = corner.T
    ring = polygons.ring_of_corner[u]
    side = passed[v] - passed[u] - chord
    side = np.where(u < v, side, side + whole[ring])
    smaller = np.minimum(np.abs(side), np.abs(whole[ring] - side))
    return np.where(
        ring == polygons.ring_of_corner[v], smaller / area[polygons.polygon_of_ring[ring]], np.nan
    )


def generalised(
    plane: np.ndarray,
    point: np.ndarray,
    offsets: np.ndarray,
    edge_length: np.ndarray,
    least: np.ndarray,
) -> Outline:
    """Generalise rings by the area that matters (Visvalingam and Whyatt 1993, Cartogr. J. 30).

    A corner goes where its triangle with its neighbours is smaller than ``least``; the smaller ones
    first, in LEVELS classes. Of a run of such corners every second goes at once, so the number of
    rounds is small whatever the rings look like.

    Parameters
    ----------
    plane : (c, 2) float
        The corners in a plane with true areas.
    point : (c, d) float
        The corners where lengths are measured.
    offsets : (r + 1,) int
    edge_length : (c,) float
        Length of the edge that leaves each corner.
    least : (r,) float
        Least area of a triangle for each ring.

    Returns
    -------
    Outline
        At least three corners of each ring are left.

    Notes
    -----
    O(n) a round, O(log n) rounds.

    Examples
    --------
    A square of 4 by 4 with a bump, which goes: its two edges share the length of the straight one.

    >>> xy = np.array([[0, 0], [2, -0.1], [4, 0], [4, 4], [0, 4]])
    >>> length = np.hypot(*(np.roll(xy, -1, axis=0) - xy).T)
    >>> outline = generalised(xy, xy, np.array([0, 5]), length, np.array([1.0]))
    >>> outline.corner.tolist(), outline.edge_length.round(9).tolist()
    ([0, 2, 3, 4], [2.0, 2.0, 4.0, 4.0, 4.0])
    """
    here = _large_corners(plane, offsets, least, None)
    start, step, new_length = _lengths(point, offsets, edge_length, here)
    ring = groups(offsets)
    along, perimeter = running(new_length, offsets)
    along = along - along[here[start[:-1]]][ring]
    passed, around = running(step, start)
    return Outline(
        corner=here,
        point=point[here],
        passed=passed,
        step=step,
        perimeter=around,
        following=following(start),
        ring_start=start,
        edge_length=new_length,
        along=np.where(along < 0.0, along + perimeter[ring], along),
    )


def _large_corners(plane, offsets, least, corner):
    """The corners that stay; of those of a finer outline, if any, in one class."""
    levels = LEVELS if corner is None else 1
    here = np.arange(len(plane)) if corner is None else corner
    start = offsets if corner is None else np.searchsorted(here, offsets)
    if not (least > 0.0).any():
        return here
    x, y = plane[here].T.copy()
    limit = np.repeat(least, np.diff(start))
    for level in range(levels):
        scale = 4.0 ** (level + 1 - levels)
        while True:
            x0, y0 = _shifted(x, start, 1), _shifted(y, start, 1)
            bx, by, cx, cy = x - x0, y - y0, _shifted(x, start, -1), _shifted(y, start, -1)
            cx -= x0
            cy -= y0
            area = np.abs(bx * cy - cx * by) / 2.0
            goes = _every_second(area, area < limit * scale, start)
            gone = np.add.reduceat(goes, start[:-1], dtype=np.int64)
            size = np.diff(start)
            few = size - gone < 3
            if few.any():
                goes &= ~np.repeat(few, size)
                gone[few] = 0
            if not gone.any():
                break
            stays = ~goes
            here, x, y, limit = here[stays], x[stays], y[stays], limit[stays]
            start = offsets_of(size - gone)
    return here


def _lengths(point, offsets, edge_length, here):
    """Where rings start among the corners that stay, their edges' lengths, and each original edge's."""
    start = np.searchsorted(here, offsets)
    at = point[here]
    step = np.sqrt(((at[following(start)] - at) ** 2).sum(axis=1))
    # a corner belongs to the edge of the last place up to it, a ring's first ones to its last edge
    edge = np.zeros(len(point), dtype=np.int64)
    edge[here] = 1
    edge = np.cumsum(edge) - 1
    before = here[start[:-1]] - offsets[:-1]
    edge[ranges(offsets[:-1], before)] = np.repeat(start[1:] - 1, before)
    whole = np.bincount(edge, weights=edge_length, minlength=len(here))
    return start, step, edge_length * (step / whole)[edge]


def _outlines(plane, point, offsets, edge_length, least):
    """The finest outline, and the (c,) lengths of the original edges, the mean over SCALES.

    How long a coast is depends on the stride it is measured with, and which corners stay on the
    chance of the data. Lengths of one scale made 33 cuts of the ten largest land masses at one
    detail and 28 at another; their mean over several makes as many at each.
    """
    finest = generalised(plane, point, offsets, edge_length, least)
    corner, total = finest.corner, finest.edge_length.copy()
    for scale in range(1, SCALES):
        corner = _large_corners(plane, offsets, least * 2.0**scale, corner)
        total += _lengths(point, offsets, edge_length, corner)[2]
    return finest, total / SCALES


def bends(outline: Outline, ring: np.ndarray, corner: np.ndarray, length: np.ndarray) -> np.ndarray:
    """How concave the generalised outline is at the ends of diagonals (the minima rule).

    Parameters
    ----------
    outline : Outline
    ring : (c,) int
        The ring of each corner.
    corner : (k, 2) int
    length : (k,) float

    Returns
    -------
    (k, 2) float
        Degrees: the interior angle between the points at REACH times the length before and after
        each end, less 180.

    Notes
    -----
    O(k log n).

    Examples
    --------
    The diagonal of an L leaves its outer corner, which is convex, and ends at the inner one.

    >>> xy = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2.0]])
    >>> length = np.hypot(*(np.roll(xy, -1, axis=0) - xy).T)
    >>> outline = generalised(xy, xy, np.array([0, 6]), length, np.array([0.0]))
    >>> bends(outline, np.zeros(6, dtype=int), np.array([[0, 3]]), np.array([2**0.5])).round(6).tolist()
    [[-90.0, 90.0]]
    """
    where = outline.along[corner]
    rings = ring[corner]
    perimeter = outline.perimeter
    reach = np.minimum(REACH * length[:, None], perimeter[rings] / 4.0)
    at, before, after = (_at(outline, rings, where + d) for d in (0.0, -reach, reach))
    return _bend(at, before, after)


def edges_of_triangles(triangles: np.ndarray, edges: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Which triangles lie beside each edge, and which edges bound each triangle.

    Parameters
    ----------
    triangles : (t, 3) int
    edges : (k, 2) int
        u < v; some or all of the diagonals.
    n : int
        Number of vertices.

    Returns
    -------
    beside : (k, 2) int
        -1 where there is none.
    across : (t + 1, 3) int
        The edge on each side, -1 where it is none of these; the last row is for triangle -1.

    Examples
    --------
    A square in two triangles, with the diagonal between them.

    >>> beside, across = edges_of_triangles(np.array([[0, 1, 2], [0, 2, 3]]), np.array([[0, 2]]), 4)
    >>> beside.tolist(), across.tolist()
    ([[0, 1]], [[-1, -1, 0], [0, -1, -1], [-1, -1, -1]])
    """
    across = np.full((len(triangles) + 1, 3), -1)
    beside = np.full((len(edges), 2), -1)
    if not len(edges):
        return beside, across
    end = np.zeros(n, dtype=bool)
    end[edges] = True
    end = end[triangles]
    side = np.flatnonzero(end & end[:, [1, 2, 0]])  # the others are none of these
    triangle = side // 3
    a = triangles.ravel()[side].astype(np.int64)
    b = triangles.ravel()[side + np.where(side % 3 == 2, -2, 1)].astype(np.int64)
    key = np.minimum(a, b) * n + np.maximum(a, b)
    wanted = edges[:, 0] * n + edges[:, 1]
    order = np.argsort(wanted)
    edge = order[np.minimum(np.searchsorted(wanted, key, sorter=order), len(order) - 1)]
    found = wanted[edge] == key
    edge, side, triangle = edge[found], side[found], triangle[found]
    across.ravel()[side] = edge
    order = np.argsort(edge, kind="stable")
    edge, triangle = edge[order], triangle[order]
    first = np.diff(edge, prepend=-1) != 0
    beside[edge[first], 0] = triangle[first]
    beside[edge[~first], 1] = triangle[~first]
    return beside, across


def opens(
    asked: np.ndarray,
    length: np.ndarray,
    middle: np.ndarray,
    beside: np.ndarray,
    across: np.ndarray,
) -> np.ndarray:
    """Whether the polygon gets wider by a step within reach of diagonals (necks and limbs).

    In a dense outline a neck widens triangle by triangle. From the diagonal, walk over the other
    diagonals on each side as long as the way over their middles is within REACH. On one side there
    must be one STEP times as long, on the other none shorter than TAPER times: else it is a place
    in a taper.

    Parameters
    ----------
    asked : (q,) int
        The diagonals, by their places in the following arrays of all large ones.
    length, middle : (k,) float, (k, d) float
    beside, across
        See `edges_of_triangles`.

    Returns
    -------
    (q,) bool

    Notes
    -----
    O(1) for each diagonal within reach of each one asked, one array call a step for all. In outlines that
    have far more vertices than corners these are too many; after PLAIN steps for each diagonal it goes by
    leaps of 1, 2, 4 ... steps where there is one way to go, so that O(n log n) are enough.

    Examples
    --------
    Diagonal 0 of a limb lies between the longer diagonal 1 and diagonal 2. Where diagonal 2 is about as long
    as 0, the limb begins there; where it is much shorter, the limb tapers.

    >>> middle, beside = np.array([[0.0], [0.4], [-0.4]]), np.array([[0, 1], [0, -1], [1, -1]])
    >>> across = np.array([[0, 1, -1], [0, 2, -1], [-1, -1, -1]])
    >>> [opens(np.array([0]), np.array([1, 1.5, x]), middle, beside, across).tolist() for x in (0.9, 0.5)]
    [[True], [False]]
    """
    longest, shortest = np.zeros((len(asked), 2)), np.full((len(asked), 2), np.inf)
    query = np.repeat(np.arange(len(asked)), 2)
    side = np.tile([0, 1], len(asked))
    edge, triangle = asked[query], beside[asked].ravel()
    way = np.zeros(len(query))
    # a bit more, for ways that are summed by steps or by leaps may differ by rounding
    reach = REACH * (1.0 + 1e-12) * length[asked]
    steps, leaps = 0, None
    while len(query):
        steps += len(query)
        if steps > PLAIN * len(length):
            if leaps is None:
                leaps = _leaps(length, middle, beside, across, reach.max())
            state = 2 * edge + (beside[edge, 0] != triangle)
            for to, far, high, low in reversed(leaps):
                on = np.flatnonzero((to[state] >= 0) & (way + far[state] <= reach[query]))
                begin, place, own = state[on], (query[on], side[on]), length[asked[query[on]]]
                np.maximum.at(longest, place, high[begin] / own)
                np.minimum.at(shortest, place, low[begin] / own)
                way[on] += far[begin]
                state[on] = to[begin]
            edge = state // 2
            triangle = beside[edge, state % 2]
        new = across[triangle]
        on = (new >= 0) & (new != edge[:, None])
        row, column = np.nonzero(on)
        new = new[row, column]
        query, side, triangle = query[row], side[row], triangle[row]
        way = way[row] + np.sqrt(((middle[new] - middle[edge[row]]) ** 2).sum(axis=1))
        near = way <= reach[query]
        query, side, triangle, way, edge = (x[near] for x in (query, side, triangle, way, new))
        ratio = length[edge] / length[asked[query]]
        np.maximum.at(longest, (query, side), ratio)
        np.minimum.at(shortest, (query, side), ratio)
        pair = beside[edge]
        triangle = np.where(pair[:, 0] == triangle, pair[:, 1], pair[:, 0])
    return ((longest >= STEP) & (shortest[:, ::-1] >= TAPER)).any(axis=1)


def _leaps(length, middle, beside, across, reach):
    """Where 1, 2, 4 ... steps lead where there is one way: to, how far, longest and shortest passed.

    A state is twice a diagonal, plus 1 if it is crossed into the second triangle beside it.
    """
    new = across[beside.ravel()]
    edge = np.arange(len(new)) // 2
    on = (new >= 0) & (new != edge[:, None])
    single = on.sum(axis=1) == 1
    into = np.where(single, new[np.arange(len(new)), on.argmax(axis=1)], edge)
    far = np.sqrt(((middle[into] - middle[edge]) ** 2).sum(axis=1))
    to = np.where(single & (far <= reach), 2 * into + (beside[into, 0] == beside.ravel()), -1)
    high = low = length[into]
    found = []
    while (to >= 0).any():
        found.append((to, far, high, low))
        far = far + far[to]
        high, low = np.maximum(high, high[to]), np.minimum(low, low[to])
        to = np.where((to >= 0) & (far <= reach), to[to], -1)
    return found


def one_by_one(
    polygons: Polygons,
    outline: Outline,
    corner: np.ndarray,
    length: np.ndarray,
    halves: np.ndarray,
    chord: np.ndarray,
    turn: np.ndarray,
    terms: tuple,
    area: np.ndarray,
    smallest: np.ndarray,
    barred: dict[int, list],
) -> np.ndarray:
    """Cut along one diagonal after the other, where what is left of the outline still allows it.

    A diagonal is cut if its bends, measured on the outline of the piece in which it lies, still sum
    to LEFT, if the outline opens up on one side of one that halves a body, and if both pieces that it leaves
    are large enough.

    Parameters
    ----------
    polygons : Polygons
    outline : Outline
    corner : (k, 2) int
        The ends of the diagonals, the first to cut first.
    length : (k,) float
    halves : (k,) bool
        Those that would halve a body: wide, and with much of the area on both sides.
    chord : (k,) float
        Shoelace terms of the diagonals.
    turn : (k, 2) float
        Angle at each end from the outline's way on to the diagonal.
    terms : (c,) float, (r,) float
        Shoelace terms of the outline before each corner on its ring, and of each ring.
    area, smallest : (p,) float
        Area of each polygon, holes included, and of its smallest part.
    barred : dict
        Which of the diagonals are ways over islands, and what must not be cut for them: earlier diagonals,
        or a way with the same number below 0. Such a way must part a piece in two.

    Returns
    -------
    (k,) int8
        KEPT where it is cut; USED, EVEN or SMALL.

    Notes
    -----
    For each diagonal a walk over the generalised outline within reach; for each cut one over the
    smaller of its pieces: O(n log n).

    Examples
    --------
    An L and two ways to cut it at its inner corner: after the first, nothing is concave for the second.

    >>> from isthmus.core.partition.polygon import one
    >>> xy = np.array([[0, 0], [1, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2], [0, 1.0]])
    >>> polygons, (x, y), (x2, y2) = one(xy, [0, 8]), xy.T, np.roll(xy, -1, axis=0).T
    >>> outline = generalised(xy, xy, polygons.offsets, np.ones(8), np.zeros(1))
    >>> terms = running((x * y2 - x2 * y) / 2.0, polygons.offsets)
    >>> ends = np.array([[1, 4], [4, 7]])
    >>> halves, area, smallest = np.zeros(2, dtype=bool), np.array([3.0]), np.array([0.1])
    >>> chord, turn = np.array([1.0, 0.5]), np.pi * np.array([[0.5, 1.0], [0.5, 1.5]])
    >>> why = one_by_one(
    ...     polygons, outline, ends, np.ones(2), halves, chord, turn, terms, area, smallest, {}
    ... )
    >>> why.tolist() == [KEPT, USED]
    True
    """
    ring = polygons.ring_of_corner
    places = np.union1d(outline.corner, corner.ravel())
    start = np.searchsorted(places, polygons.offsets)
    before, after = previous(start), following(start)
    passed, whole = terms
    term = passed[places[after]] - passed[places]
    term = np.where(places[after] <= places, term + whole[ring[places]], term)
    polygon = polygons.polygon_of_ring[ring[places]]
    label, area, smallest = polygon.tolist(), area.tolist(), smallest[polygon].tolist()
    before, after, term = before.tolist(), after.tolist(), term.tolist()
    point = list(map(tuple, _at(outline, ring[places], outline.along[places]).tolist()))
    chord, turn = chord.tolist(), turn.tolist()
    ends = np.searchsorted(places, corner).tolist()
    taken = set()  # what ways have
    cuts, pieces = {}, {}  # at each place: the directions of its cuts, and the place in each piece
    verdict = np.full(len(corner), KEPT, dtype=np.int8)
    for k, ((u, v), (at_u, at_v), reach) in enumerate(zip(ends, turn, (REACH * length).tolist())):
        i, j = bisect(cuts.get(u, ()), at_u), bisect(cuts.get(v, ()), at_v)
        a, b = pieces.get(u, (u,))[i], pieces.get(v, (v,))[j]
        (back_a, on_a), (back_b, on_b) = (
            (_walk(x, before, point, reach), _walk(x, after, point, reach)) for x in (a, b)
        )
        bend = _bend_at(point[a], back_a, on_a) + _bend_at(point[b], back_b, on_b)
        if bend < LEFT:
            verdict[k] = USED
            continue
        if halves[k]:
            # beside an even limb a side has two right angles; what both have more sums to the bends
            one = _bend_at(point[a], point[b], on_a) + _bend_at(point[b], back_b, point[a]) + 180.0
            if max(one, bend - one) + max(min(one, bend - one), 0.0) / 2.0 < OPEN:
                verdict[k] = EVEN
                continue
        # without holes the two labels are one; a hole may still have that of a larger piece
        piece = min(label[a], label[b], key=area.__getitem__)
        begin, of_piece = _shorter_way(a, b, after, term)
        if k in barred and (
            begin is None or any(x in taken if x < 0 else verdict[x] == KEPT for x in barred[k])
        ):
            verdict[k] = USED
            continue
        if begin is not None:
            of_piece += chord[k] if begin == b else -chord[k]
            if min(of_piece, area[piece] - of_piece) < smallest[u]:
                verdict[k] = SMALL
                continue
            area[piece] -= of_piece
            area.append(of_piece)
            for place in _way(begin, a + b - begin, after):
                label[place] = len(area) - 1
        taken.update(barred.get(k, ()))
        # one piece begins at a, runs on to b and back; the other at the copy of b, to that of a
        copy_a, copy_b = len(point), len(point) + 1
        point += [point[a], point[b]]
        label += [piece, piece]
        if begin is not None:
            at_a, at_b = (a, b) if begin == a else (copy_a, copy_b)
            rest_a, rest_b = (copy_a, copy_b) if begin == a else (a, b)
            label[at_a] = label[at_b] = len(area) - 1
            label[rest_a] = label[rest_b] = piece
        last, first = before[a], after[b]
        before += [copy_b if last == b else last, copy_a]
        after += [copy_b, copy_a if first == a else first]
        term += [chord[k], term[b]]
        term[b] = -chord[k]
        after[last], before[first] = copy_a, copy_b
        before[a], after[b] = b, a
        cuts.setdefault(u, []).insert(i, at_u)
        cuts.setdefault(v, []).insert(j, at_v)
        # the piece with the outline's way on comes first
        pieces.setdefault(u, [u])[i : i + 1] = [a, copy_a]
        pieces.setdefault(v, [v])[j : j + 1] = [copy_b, b]
    return verdict


def _shorter_way(a, b, after, term):
    """Go from a to b and from b to a at once: where the shorter way begins, and its summed terms.

    (None, 0) if they lie on two rings.
    """
    on, to, at_a, at_b = 0.0, 0.0, a, b
    while True:
        on, at_a = on + term[at_a], after[at_a]
        if at_a == b:
            return a, on
        to, at_b = to + term[at_b], after[at_b]
        if at_b == a:
            return b, to
        if at_a == a or at_b == b:
            return None, 0.0


def _way(begin, end, after):
    """The places from one to another."""
    while begin != end:
        yield begin
        begin = after[begin]
    yield end


def _shifted(values, start, by):
    """The value one place before (by = 1) or after (-1) each on rings that begin at ``start``."""
    moved = np.empty_like(values)
    if by > 0:
        moved[1:] = values[:-1]
        moved[start[:-1]] = values[start[1:] - 1]
    else:
        moved[:-1] = values[1:]
        moved[start[1:] - 1] = values[start[:-1]]
    return moved


def _every_second(area, small, start):
    """Every second of each run of true values on rings, so that it does not matter where rings begin.

    Of the two halves of a run of even length that goes whose triangles are smaller in sum, for then the
    direction does not matter either. If all of a ring are small, its run begins after the largest.
    """
    count = np.add.reduceat(small, start[:-1], dtype=np.int64)
    full = np.flatnonzero((count == np.diff(start)) & (count > 0))
    if len(full):
        small = small.copy()
        index, offsets = take(start, full)
        small[index[np.lexsort((area[index], groups(offsets)))[offsets[1:] - 1]]] = False
    index = np.flatnonzero(small)
    chosen = np.zeros(len(small), dtype=bool)
    if not len(index):
        return chosen
    opening = np.zeros(len(small) + 1, dtype=bool)
    opening[start] = True
    new = np.diff(index, prepend=-2) > 1
    new |= opening[index]
    run = np.flatnonzero(new)
    first, last = index[run], index[np.append(run[1:], len(index)) - 1]
    size = last - first + 1
    begun = np.zeros(len(run), dtype=np.int64)  # of the same run, at the ring's end
    ring = np.searchsorted(start, first, side="right") - 1
    at_end = np.flatnonzero(last + 1 == start[ring + 1])
    at_start = np.flatnonzero(first == start[ring])
    tail = at_end[np.isin(ring[at_end], ring[at_start])]
    head = at_start[np.isin(ring[at_start], ring[at_end])]
    begun[head] = size[tail]
    size[tail] = size[head] = size[tail] + size[head]
    length = np.diff(np.append(run, len(index)))
    odd = (np.arange(len(index)) - np.repeat(run - begun, length)) % 2 == 1
    less, total = (np.add.reduceat(x, run) for x in (np.where(odd, -area[index], area[index]), area[index]))
    for x in (less, total):
        x[tail] = x[head] = x[tail] + x[head]
    other = (size % 2 == 0) & (less > 1e-9 * total)
    chosen[index] = odd == np.repeat(other, length)
    return chosen


def _at(outline, ring, where):
    """Points at distances along generalised rings."""
    ring = np.broadcast_to(ring.reshape(ring.shape + (1,) * (where.ndim - ring.ndim)), where.shape)
    passed = np.mod(where, outline.perimeter[ring])
    edge = locate(outline.passed, outline.perimeter, outline.ring_start, ring, passed)
    share = np.clip((passed - outline.passed[edge]) / outline.step[edge], 0.0, 1.0)
    here, there = outline.point[edge], outline.point[outline.following[edge]]
    return here + (there - here) * share[..., None]


def _bend(at, before, after):
    """Interior angles less 180 degrees, seen from above: the interior is on the left."""
    on, back = after - at, before - at
    if at.shape[-1] == 2:
        cross = on[..., 0] * back[..., 1] - on[..., 1] * back[..., 0]
        dot = (on * back).sum(axis=-1)
    else:  # geocentric: in the plane that is level there
        up = at / np.sqrt((at * at).sum(axis=-1, keepdims=True))
        cross = (up * np.cross(on, back)).sum(axis=-1)
        dot = (on * back).sum(axis=-1) - (on * up).sum(axis=-1) * (back * up).sum(axis=-1)
    return np.degrees(np.arctan2(cross, dot)) % 360.0 - 180.0


def _bend_at(at, before, after):
    """The same at one place, from tuples: far quicker than arrays of one."""
    on = [x - y for x, y in zip(after, at)]
    back = [x - y for x, y in zip(before, at)]
    if len(at) == 2:
        cross = on[0] * back[1] - on[1] * back[0]
        dot = on[0] * back[0] + on[1] * back[1]
    else:
        size = hypot(*at)
        up = [x / size for x in at]
        cross = (
            up[0] * (on[1] * back[2] - on[2] * back[1])
            + up[1] * (on[2] * back[0] - on[0] * back[2])
            + up[2] * (on[0] * back[1] - on[1] * back[0])
        )
        level = sum(x * y for x, y in zip(on, up)) * sum(x * y for x, y in zip(back, up))
        dot = sum(x * y for x, y in zip(on, back)) - level
    return degrees(atan2(cross, dot)) % 360.0 - 180.0


def _walk(place, link, point, reach):
    """The point at a distance along the links from a place, or the place if they lead back to it."""
    here, step = place, 0.0
    while reach > 0.0:
        there = link[here]
        step = dist(point[here], point[there])
        if step >= reach:
            share = reach / step
            return tuple(x + (y - x) * share for x, y in zip(point[here], point[there]))
        reach -= step
        here = there
        if here == place:
            break
    return point[here]


def _corners(polygons, edges, toward=None):
    """(k, 2) int: the corners at the ends of diagonals; where rings touch, those they leave from.

    Those of ways are not straight: ``toward`` is where they first lead to, from either end.
    """
    corner_of = np.empty(len(polygons.xy), dtype=np.int64)
    corner_of[polygons.vertex] = np.arange(len(polygons.vertex))
    corner = corner_of[edges]
    if len(polygons.vertex) == len(polygons.xy):
        return corner
    shared = np.bincount(polygons.vertex, minlength=len(polygons.xy)) > 1
    order = np.argsort(polygons.vertex, kind="stable")
    first = np.searchsorted(polygons.vertex[order], np.arange(len(polygons.xy) + 1))
    before = np.empty(len(polygons.vertex), dtype=np.int64)
    before[polygons.next_corner] = np.arange(len(before))
    for k, end in np.argwhere(shared[edges]):
        u = edges[k, end]
        several = order[first[u] : first[u + 1]]
        to = (polygons.xy[edges[k, [1 - end]]] if toward is None else toward[k, [end]]) - polygons.xy[u]
        on = polygons.xy[polygons.vertex[polygons.next_corner[several]]] - polygons.xy[u]
        back = polygons.xy[polygons.vertex[before[several]]] - polygons.xy[u]
        corner[k, end] = several[np.argmax(_angle(on, back) - _angle(on, to))]
    return corner


def _turns(polygons, corner, toward):
    """(k, 2) float: angle at each end from the outline's way on to the diagonal, inside."""
    xy = polygons.xy[polygons.vertex]
    return _angle(xy[polygons.next_corner[corner]] - xy[corner], toward - xy[corner])


def _angle(a, b):
    """Angle from a to b in radians, counter-clockwise, 0 to 2 pi."""
    cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return np.arctan2(cross, (a * b).sum(axis=-1)) % (2.0 * np.pi)
