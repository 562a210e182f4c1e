"""Ways from shore to shore over islands that are too small to count: gates.

An island smaller than the smallest part is no place to cut to, but a row of them may close a bay that is
large enough: Saaremaa the Gulf of Riga. People see an edge that is there in pieces, and the better the
more of it is there (support ratio: Shipley and Kellman 1992, Perception & Psychophysics 52) and the less
it bends (relatability: Kellman and Shipley 1991, Cogn. Psychology 23).

A gate is one candidate, and one cut, from a corner of a shore to another. It is as long as its water: along
its islands there is an outline already, and nothing to cut. In the problem that is solved, the polygon has
none of these islands; only the parts have them: beside a gate that is cut they belong to both outlines.
"""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np

from ..metric import Metric
from ..progress import ignore
from ..rings import offsets_of, signed_areas
from .candidates import clear
from .carving import spanning_tree
from .natural import DETAIL
from .polygon import Polygons, select, without_rings
from .triangulation import diagonals, triangulate

__all__ = ["BULGE", "MOST", "SUPPORT", "Gates", "gates"]

SUPPORT = 0.5  # least share of a gate that islands fill
BULGE = 2.0**0.5  # a gate is at most so much longer than straight: as one that turns by a right angle
MOST = 30  # islands of a gate at most; so that there are O(n) in all


class Gates(NamedTuple):
    """Ways over islands, the one with the least water first.

    Attributes
    ----------
    vertex : (2 w,) int
        The ends of the stretches of water of all ways, one after the other. Where one ends and the next
        one of the same way begins lies an island.
    offsets : (g + 1,) int
        Where the vertices of each way start.
    """

    vertex: np.ndarray
    offsets: np.ndarray

    def lengths(self, position: np.ndarray, measure: Metric) -> np.ndarray:
        """(g,) float: of the water on the ways."""
        water = measure.length(position, *self.vertex.reshape(-1, 2).T)
        return np.add.reduceat(water, self.offsets[:-1] // 2)


def gates(
    polygons: Polygons,
    component: np.ndarray,
    wanted: np.ndarray,
    smallest: np.ndarray,
    min_hole: np.ndarray,
    *,
    measure: Metric,
    engine: str | None = None,
    check: Callable = ignore,
) -> Gates:
    """Find ways from shore to shore over islands of which the islands fill enough.

    The islands are joined to the shores and to each other by the shortest diagonals (the minimum spanning
    forest whose roots are the shores), and every other diagonal closes a way.

    Parameters
    ----------
    polygons : Polygons
    component : (r,) int
        Component of each ring.
    wanted : (r,) bool
        The components that count by themselves, by their numbers: the shores.
    smallest, min_hole : (p,) float
        Area of the smallest part of each polygon, and of the smallest hole that the user wants to see.
        Islands below DETAIL of the smallest part, or that touch others, are not looked at.
    measure, engine, check
        See `triangulation.triangulate`.

    Returns
    -------
    Gates

    Notes
    -----
    A triangulation of the polygons that have such islands, and O(k log k) for its k diagonals.

    Examples
    --------
    A bay of 10 by 10 above a sea. The island in its mouth is 8 long, and leaves 1 on both sides.

    >>> from isthmus.core.metric import planar
    >>> from isthmus.core.partition.polygon import one
    >>> sea = [[-10, 0], [20, 0], [20, 10], [10, 10], [10, 20], [0, 20], [0, 10], [-10, 10]]
    >>> island = [[1, 10], [5, 10.5], [9, 10], [5, 9.5]]
    >>> polygon = one(np.array(sea + island, dtype=float), [0, 8, 12])
    >>> component, wanted = np.arange(2), np.array([True, False])
    >>> gates(polygon, component, wanted, np.array([50.0]), np.zeros(1), measure=planar()).vertex.tolist()
    [3, 10, 8, 6]
    """
    of_ring = polygons.polygon_of_ring
    none = Gates(np.empty(0, dtype=np.int64), np.zeros(1, dtype=np.int64))
    alone = (np.bincount(component, minlength=len(component)) == 1)[component] & ~wanted[component]
    if not alone.any() or not (smallest > 0.0).any():
        return none
    least = np.maximum(DETAIL * smallest, min_hole)
    plane = measure.equal_area(polygons.xy)[polygons.vertex]
    with np.errstate(over="ignore"):
        area = np.abs(signed_areas(plane, polygons.offsets)) * polygons.unit[of_ring] ** 2
    island = alone & (smallest > 0.0)[of_ring] & (area >= least[of_ring])
    which = np.unique(of_ring[island])
    if not len(which):
        return none
    some, vertex = select(polygons, which)
    ring = np.flatnonzero(np.isin(of_ring, which))
    kept = island[ring] | wanted[component[ring]]
    whole, shore = some, ~island[ring[kept]]
    some, of_whole = without_rings(whole, ~kept)
    triangles, verdict, _ = triangulate(
        some, conformal=measure.conformal, engine=engine, check=lambda share=None: check()
    )
    if (verdict != "").any():
        good = np.flatnonzero(verdict == "")
        shore = shore[np.isin(some.polygon_of_ring, good)]
        back = np.full(len(some.xy), -1)
        some, number = select(some, good)
        back[number] = np.arange(len(number))
        triangles, of_whole = back[triangles], of_whole[number]
    # all shores of a polygon are one node, its first ring; each island is one
    node = np.where(shore, some.polygon_offsets[:-1][some.polygon_of_ring], np.arange(len(shore)))
    edges, of_vertex = diagonals(some, triangles), _by_vertex(some, node)
    edges = edges[of_vertex[edges[:, 0]] != of_vertex[edges[:, 1]]]
    if not kept.all():
        edges = edges[clear(whole, ~kept, of_whole[edges])]
    found = _closed(some, node, edges, measure)
    return _from_lower_end(found._replace(vertex=vertex[of_whole[found.vertex]]))


def _from_lower_end(found):
    """Ways that begin where the number of the vertex is lower."""
    start, end = found.offsets[:-1], found.offsets[1:] - 1
    back = np.repeat(found.vertex[start] > found.vertex[end], np.diff(found.offsets))
    here = np.arange(len(back))
    turned = np.repeat(start + end, np.diff(found.offsets)) - here
    return found._replace(vertex=found.vertex[np.where(back, turned, here)])


def _by_vertex(polygons, of_ring):
    values = np.empty(len(polygons.xy), dtype=of_ring.dtype)
    values[polygons.vertex] = of_ring[polygons.ring_of_corner]
    return values


def _closed(polygons, node_of_ring, edges, measure):
    """The ways that diagonals between nodes close."""
    node = _by_vertex(polygons, node_of_ring)
    position = measure.positions(polygons.xy)

    def length(a, b):
        return measure.length(position, a, b)

    chord = length(*edges.T)
    tree, _ = spanning_tree(polygons, node_of_ring, edges, chord, np.ones(len(node_of_ring), dtype=bool))
    way = _ways(node, edges[tree], polygons.polygon_offsets[:-1], length)

    count, first = way.count[node[edges]], way.first[node[edges]]
    closing = (count >= 0).all(axis=1) & (count.sum(axis=1) <= MOST) & (first[:, 0] != first[:, 1])
    closing[tree] = False
    ends, chord = edges[closing], chord[closing]
    at = node[ends]
    # on a shore the way begins where the diagonal does
    from_shore, landing = (np.where(way.count[at] == 0, ends, x[at]) for x in (way.shore, way.landing))
    water = way.water[at].sum(axis=1) + chord
    water[(way.landing[at] == ends).any(axis=1)] = np.inf  # as in `_ways`
    whole = way.whole[at].sum(axis=1) + chord + sum(length(landing[:, k], ends[:, k]) for k in (0, 1))
    good = (from_shore[:, 0] != from_shore[:, 1]) & (water <= (1.0 - SUPPORT) * whole)
    good[good] = whole[good] <= BULGE * length(*from_shore[good].T)
    good = np.flatnonzero(good)
    return _listed(node, way, ends[good][np.argsort(water[good], kind="stable")])


class _Ways(NamedTuple):
    """How each node is reached from the shore along the forest.

    Attributes
    ----------
    first : (n,) int
        The first island on the way; -1 on the shore itself.
    count : (n,) int
        How many islands there are; -1 where they are more than MOST.
    shore, origin, landing : (n,) int
        The vertices where the way leaves the shore, and the node before, and where it lands.
    whole, water : (n,) float
        Lengths of the way, and of that in the water: infinite if it only touches an island, at one vertex.
    """

    first: np.ndarray
    count: np.ndarray
    shore: np.ndarray
    origin: np.ndarray
    landing: np.ndarray
    whole: np.ndarray
    water: np.ndarray


def _ways(node, links, shores, length):
    """The ways to nodes, one island further at a time."""
    size = int(node.max(initial=-1)) + 1
    first, count, shore, origin, landing = np.full((5, size), -1)
    whole, water = np.zeros((2, size))
    count[shores] = 0
    links = np.concatenate((links, links[:, ::-1]))
    for _ in range(MOST):
        links = links[count[node[links[:, 1]]] < 0]
        u, v = links[count[node[links[:, 0]]] >= 0].T
        if not len(u):
            break
        before, here = node[u], node[v]
        begins = count[before] == 0
        first[here] = np.where(begins, here, first[before])
        shore[here] = np.where(begins, u, shore[before])
        count[here] = count[before] + 1
        origin[here], landing[here] = u, v
        water[here] = np.where(landing[before] == u, np.inf, water[before] + length(u, v))
        whole[here] = whole[before] + length(np.where(begins, u, landing[before]), u) + length(u, v)
    return _Ways(first, count, shore, origin, landing, whole, water)


def _listed(node, way, ends):
    """The ways that diagonals close, with their vertices."""
    g = len(ends)
    which, place, links = [np.arange(g)], [np.zeros(g, dtype=np.int64)], [ends]
    for side in (0, 1):
        on, at, steps = np.arange(g), node[ends[:, side]], 0
        while True:
            left = way.count[at] > 0
            on, at, steps = on[left], at[left], steps + 1
            if not len(on):
                break
            link = np.column_stack((way.origin[at], way.landing[at]))
            which.append(on)
            place.append(np.full(len(on), steps if side else -steps))
            links.append(link[:, ::-1] if side else link)
            at = node[way.origin[at]]
    which, place = np.concatenate(which), np.concatenate(place)
    order = np.lexsort((place, which))
    return Gates(np.concatenate(links)[order].ravel(), 2 * offsets_of(np.bincount(which, minlength=g)))
