"""Polygons with natural candidates, and what `natural` says of all diagonals."""

import numpy as np
import shapely

from isthmus.core import metric
from isthmus.core.partition import solve
from isthmus.core.partition.candidates import counted
from isthmus.core.partition.natural import natural
from isthmus.core.partition.polygon import boundary_components, from_rings, without_rings
from isthmus.core.partition.triangulation import diagonals, triangulate


def prepare(rings, smallest, measure=None):
    """(Prepared, Natural, index of the prepared edges among all diagonals, all diagonals).

    ``smallest`` is the area of the smallest part of each input polygon, or a function of the (p,) areas
    of the shells. Holes that are smaller do not count. Every polygon must be good.
    """
    measure = measure or metric.planar()
    polygons, verdict = from_rings(rings)
    assert not any(verdict), verdict
    if callable(smallest):
        smallest = smallest(shell_areas(polygons, measure))
    smallest = np.broadcast_to(np.asarray(smallest, dtype=float), len(polygons.unit))
    component = boundary_components(polygons)
    wanted, attachable = counted(polygons, component, measure.equal_area, smallest)
    free = ~wanted[component]
    rest, vertex = without_rings(polygons, free) if free.any() else (polygons, None)
    triangles, verdict, _ = triangulate(rest, conformal=measure.conformal)
    assert not any(verdict), verdict
    edges = diagonals(rest, triangles)
    if vertex is not None:
        edges, triangles = vertex[edges], vertex[triangles]
        lines = shapely.linearrings(polygons.xy[polygons.vertex], indices=polygons.ring_of_corner)
        small = shapely.STRtree(shapely.polygons(lines[free]))
        hit = small.query(shapely.linestrings(polygons.xy[edges]), predicate="intersects")[0]
        edges = np.delete(edges, hit, axis=0)
        edges = edges[attachable[edges].all(axis=1)]
    position = measure.positions(polygons.xy)
    found = natural(polygons, edges, triangles, position, measure, smallest)
    prepared = solve.prepare(rings, natural=True, smallest=smallest, measure=measure)
    number = {edge: k for k, edge in enumerate(map(tuple, edges.tolist()))}
    index = np.array([number[edge] for edge in map(tuple, prepared.edges.tolist())], dtype=int)
    assert np.array_equal(prepared.bounded, found.kept[index])
    return prepared, found, index, edges


def shell_areas(polygons, measure):
    """(p,) float: the area of each polygon without its holes."""
    plane = measure.equal_area(polygons.xy)[polygons.vertex]
    lines = shapely.linearrings(plane, indices=polygons.ring_of_corner)
    return shapely.area(shapely.polygons(lines[polygons.polygon_offsets[:-1]]))
